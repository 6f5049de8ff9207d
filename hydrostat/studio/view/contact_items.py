"""`with_touches`, `touch_items`: where a body touches itself and obstacles, or passes through itself, as shown."""

from dataclasses import replace

import numpy as np

from hydrostat.drawing import Color
from hydrostat.geometry import find_crossings
from hydrostat.simulation import Equilibrium, Simulation, find_contacts
from hydrostat.studio.view.scene_items import Dot, Look, RobotShape, SceneItem, Strand, Stroke

OFF = "contact off: the body intersects itself here"
TOUCH = "#8a2be2"


def with_touches(simulation: Simulation, pose: Equilibrium, shape: RobotShape, *, settled: bool) -> RobotShape:
    """A shape with what its pose touches and carries; without contact where it crosses itself, with a note of that.

    Crossings of a body in space take longer than a step of its pose: they are looked for once it has `settled`.
    """
    robot = simulation.robot
    notes, crossing = shape.notes, None
    if robot.contact is None and (settled or robot.body.mesh.dim == 2):
        places = find_crossings(robot.body.mesh, pose.nodes).places
        if len(places):
            crossing, notes = tuple(places[len(places) // 2].tolist()), (*notes, OFF.removesuffix(" here"))
    return replace(shape, notes=notes, touches=find_contacts(simulation, pose), carried=pose.carried, crossing=crossing)


def contact_items(shape: RobotShape, size: float) -> list[SceneItem]:
    """A dot where it touches, with an arrow along the force, longer for more; a ring where it crosses itself.

    Args:
        shape: shape of the body.
        size: size of the body [m].
    """
    items: list[SceneItem] = []
    hardest = max((touch.strength for touch in shape.touches), default=0.0)
    most = 8  # places that are shown, the hardest
    longest = 0.05  # arrow at the hardest, in sizes of the body
    faintest = 0.02  # what presses with less than this share of the hardest is not shown
    for touch in shape.touches[:most]:
        if touch.strength < faintest * hardest:
            continue
        way = longest * size * np.sqrt(touch.strength / hardest) * touch.force / touch.strength
        ends = (touch.place - way, touch.place + way) if touch.obstacle is None else (touch.place, touch.place + way)
        line = tuple(tuple(end.tolist()) for end in ends)
        items.append(Strand(points=line, stroke=Stroke.RIM, color=TOUCH, loose=-1))
        items.append(Dot(at=tuple(touch.place.tolist()), look=Look.TOUCH, color=TOUCH, stuck=False))
    if shape.crossing is not None:
        items.append(Dot(at=shape.crossing, look=Look.FLAG, color=Color.ERROR, label=OFF, stuck=False, chosen=True))
    return items
