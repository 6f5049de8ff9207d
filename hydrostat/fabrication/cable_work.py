"""`CableWork`: holes and minutes that the cables of a robot take, the same in its kit and in its design.

All times are assumed; none was measured. With them a cable of five holes is stitched in ten minutes.
"""

from dataclasses import dataclass

from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.lists.stitching import CableDepths, depth_table
from hydrostat.fabrication.parts.places import seam_of
from hydrostat.fabrication.patterns.pinholes import find_pinholes
from hydrostat.robot import Robot, sewn_robot, sewn_sides

CUT, BEGIN, HOLE, TIE = 3.0, 2.5, 1.5, 2.0
"""Minutes to cut a line or a tube, begin a cable at its winch, lead it through a hole, tie a tube at both its ends."""

THREAD, DRAW, SEW = 5.0, 15.0, 17.0
"""Minutes to draw a cable through the hole of a printed body, by a needle through a cast one; to sew it on its skin."""


@dataclass(frozen=True, kw_only=True)
class CableWork:
    """Work on all cables of a robot; cables in pairs, which only a plush body has, are sewn twice."""

    holes: int  # a flat plush body: holes in its cloth; else points that cables are led through, but at winches
    cut: float  # time to cut and mark lines and tubes [min]
    route: float  # time to stitch cables, or to draw them through the body [min]

    @property
    def minutes(self) -> float:
        """Time of all [min]."""
        return self.cut + self.route

    @staticmethod
    def of_robot(robot: Robot, options: KitOptions | None = None) -> "CableWork":
        """Count the work on a robot as it is drawn."""
        options = options or KitOptions()
        method, flat = options.method_for(robot.body), robot.body.mesh.dim == 2
        built = sewn_robot(robot) if method is Method.PLUSH else robot
        cables, sheaths = len(built.cables), sum(len(cable.sheathed) for cable in built.cables)
        points = holes = sum(len(cable.points) - 1 for cable in built.cables)
        cut = CUT * (cables + sheaths)
        if method is Method.PLUSH:
            if flat:
                sides = len(sewn_sides(robot))
                holes = sides * len(find_pinholes(robot, seam_of(robot.body), options.pattern))
            return CableWork(holes=holes, cut=cut, route=BEGIN * cables + HOLE * points + TIE * sheaths)
        if method is Method.PRINT:
            return CableWork(holes=holes, cut=cut, route=THREAD * cables)
        sewn = 0 if flat else len(CableDepths.of(depth_table(robot), cables).sewn)
        return CableWork(holes=holes, cut=cut, route=SEW * sewn + DRAW * (cables - sewn))
