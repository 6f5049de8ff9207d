"""`body_region`: where in a body, flat or in space, cables and winches may be."""

from hydrostat.design.flat_region import flat_region
from hydrostat.design.region import Region
from hydrostat.design.space_region import space_region
from hydrostat.errors import InputError
from hydrostat.robot import Body


def body_region(body: Body, clearance: float) -> Region:
    """The region of a body, as it was drawn or scanned; of its mesh where there is no such thing.

    Raises:
        InputError: the body is too thin for the clearance everywhere.
    """
    region = (flat_region if body.mesh.dim == 2 else space_region)(body, clearance)
    if region is None:
        depth = f"{1e3 * clearance:g} mm inside its {'edge' if body.mesh.dim == 2 else 'surface'}"
        raise InputError(f"the body is too thin for cables {depth}; lower the clearance")
    return region
