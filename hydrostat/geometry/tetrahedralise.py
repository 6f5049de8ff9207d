"""`tetrahedralise`: good tetrahedra from a closed surface."""

import numpy as np

from hydrostat.geometry.improve import Stage, improve
from hydrostat.geometry.lattice import MEAN_EDGE, lattice
from hydrostat.geometry.manifold import manifold
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.solid import Solid
from hydrostat.geometry.stuffing import stuff
from hydrostat.geometry.surface import Surface

_STAGES = (
    Stage(rounds=4, sweeps=3, power=1.0, pull=30.0),
    Stage(rounds=6, sweeps=3, power=2.0, pull=300.0),
    Stage(rounds=8, sweeps=3, power=4.0, pull=5000.0),
)


def tetrahedralise(surface: Surface, element_size: float) -> Mesh:
    """Fill a closed surface with tetrahedra."""
    solid = Solid(surface)
    cell = element_size / MEAN_EDGE
    nodes, elements = stuff(solid, *lattice(surface.box, cell), cell=cell)
    return improve(manifold(nodes, elements), solid, element_size=element_size, stages=_STAGES)
