"""`ElementKind`, `Plane`, `Volume`: how the elements of a body are computed."""

from enum import StrEnum


class Volume(StrEnum):
    """Measure of volume change: in each element, or averaged over patches of elements (mean dilatation).

    Linear elements are too stiff when the material is nearly incompressible (volumetric locking); patches help.
    """

    ELEMENT = "element"
    PATCH = "patch"


class Plane(StrEnum):
    """Freedom of a flat body across its plane: of a slice of a long body, or of a sheet with free faces."""

    STRAIN = "strain"  # as thick as at rest everywhere
    STRESS = "stress"  # thicker where it is squeezed: no stress across


class ElementKind(StrEnum):
    """Shape functions of the elements: linear, or quadratic with a node in the middle of each edge.

    Linear elements are too stiff in bending unless many lie across a limb; two quadratic ones are enough.
    """

    LINEAR = "linear"
    QUADRATIC = "quadratic"


class MaterialLaw(StrEnum):
    """Elastic law of a material; also its key in robot.toml."""

    NEO_HOOKEAN = "neo-hookean"
    FOAM = "foam"  # Ogden and Storakers, a sum of terms
