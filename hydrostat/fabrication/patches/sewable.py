"""`find_sewing`: whether the skin of a body in space can be sewn from patches of cloth, before anything is designed."""

from dataclasses import dataclass

import numpy as np

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patches.cutting import cut_skin, patch_problems
from hydrostat.fabrication.patches.flatten import distortion
from hydrostat.fabrication.patches.seams import find_seams
from hydrostat.fabrication.patches.skin_mesh import SkinMesh, skin_mesh
from hydrostat.fabrication.patches.space_pattern import patch_skin
from hydrostat.robot import Body
from hydrostat.units import plural


@dataclass(frozen=True, kw_only=True)
class Sewing:
    """Sewing work for the skin of a body, without its cables."""

    patches: int  # number of patches of cloth; 0 if it cannot be cut at all
    give: float  # stretch of the cloth in 95 % of the worst patch: 0.1 for 10 %
    problems: tuple[str, ...]  # reasons why it cannot be sewn, one line each

    def __str__(self) -> str:
        """In words, such as "2 patches, cloth with 9 % stretch"."""
        return f"{plural(self.patches, 'patch')}, cloth with {100 * self.give:.0f} % stretch"


def find_sewing(body: Body, *, options: PatternOptions | None = None) -> Sewing:
    """Cut and flatten the skin of a body in space as its kit will, with the reasons if it cannot be sewn.

    It takes seconds. Raises InputError: a flat body.
    """
    if body.mesh.dim != 3:
        raise InputError("a flat body has a flat pattern of its own")
    try:
        mesh = skin_mesh(body)
    except InputError as error:
        return Sewing(patches=0, give=0.0, problems=(str(error),))
    return sewing_of(mesh, options or PatternOptions())


def sewing_of(mesh: SkinMesh, options: PatternOptions) -> Sewing:
    """Compute the sewing work of a skin, with the reasons if it cannot be sewn."""
    cutting = cut_skin(mesh)
    skins = tuple(patch_skin(patch, options) for patch in cutting.patches)
    seams = find_seams(cutting.mesh, cutting.patches, np.eye(3)[2])
    return Sewing(
        patches=len(cutting.patches),
        give=max(distortion(patch).give(0.95) for patch in cutting.patches),
        problems=patch_problems(cutting.names, cutting.patches, skins, seams),
    )
