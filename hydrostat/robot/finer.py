"""`finer_size`: a smaller element size for a body with too few elements across some limbs."""

from hydrostat.geometry import thin_parts
from hydrostat.robot.body import Body
from hydrostat.robot.risks.body_risks import LEAST_ACROSS


def finer_size(body: Body, most: int) -> float | None:
    """Element size [m] with which limbs should have enough elements across.

    None where they have, where the body is a ready mesh, or where it would have more nodes than `most`.
    """
    least, dim = LEAST_ACROSS[body.mesh.dim], body.mesh.dim
    parts = thin_parts(body.measured_thickness, least) if body.element_size else []
    if not parts or body.element_size is None:
        return None
    few = min(part.across for part in parts)
    size = body.element_size * max(few / (_SPARE * least), 0.5)
    nodes = len(body.mesh.nodes) * (body.element_size / size) ** dim
    return size if nodes <= most else None


_SPARE = 1.15  # as meshes differ, so much more than is needed is aimed at
