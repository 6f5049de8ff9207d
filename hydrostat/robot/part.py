"""`BodyPart`: a region of a body with its own material, or rigid."""

from dataclasses import dataclass

from hydrostat.errors import InputError
from hydrostat.given import check_positive
from hydrostat.robot.material import Material
from hydrostat.robot.materials import get_material
from hydrostat.robot.region import PartRegion

RIGID_RATIO = 1e6
"""Young's modulus of a rigid part over that of the body: thin disks on a wire need more than bones in foam."""


@dataclass(frozen=True, kw_only=True)
class BodyPart(PartRegion):
    """Region of a body with its own material, such as a soft joint, a bone or a plate.

    An element belongs to the part that contains its center. Nodes near the border are moved onto it, see `conform`.

    Attributes:
        material: material of the part, or its name in the table; None for a rigid part.
        density: mass density of a rigid part [kg/m^3]; None for other parts, whose material has one.
        winch: name of the winch whose motor and housing form this part, for `fit_winch_bodies`; empty for other parts.

    Raises:
        InputError: as for `PartRegion`, both a material and a density, or neither.
    """

    material: Material | None = None
    density: float | None = None
    winch: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.shape is None:
            raise InputError("a part needs its shape, such as box")
        if isinstance(self.material, str):
            object.__setattr__(self, "material", get_material(self.material))
        if self.is_rigid and self.density is None:
            raise InputError('a rigid part needs its density, for example density = "1240 kg/m^3" for PLA')
        if not self.is_rigid and self.density is not None:
            raise InputError("density is for rigid parts, a material has its own; remove it")
        if self.density is not None:
            check_positive("density", self.density, "kg/m^3")

    @property
    def is_rigid(self) -> bool:
        """True if the part has no material and cannot deform."""
        return self.material is None

    def material_in(self, body: Material) -> Material:
        """Return the material of the part; that of a rigid part is `RIGID_RATIO` times as stiff as the body's."""
        if self.material is not None:
            return self.material
        return Material(young=RIGID_RATIO * body.young, poisson=0.3, density=self.density or 0.0)
