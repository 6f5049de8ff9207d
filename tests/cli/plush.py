"""A flat robot that cannot be sewn."""

import hydrostat as hs
from hydrostat.robot import MATERIALS, Body

_PAGE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">'
    '<path d="M0 0H100V100H0Z"/></svg>'
)


def near_the_edge() -> hs.Robot:
    """A square of 100 mm with two cables whose last holes are half a millimeter from its edge."""
    body = Body.from_outline(
        _PAGE.encode(), file="body.svg", material=MATERIALS["polyester fibre"], element_size=0.02, thickness=0.03
    )
    routes = (((-0.02, -0.01), (0.0495, 0.022)), ((-0.02, -0.01), (-0.0495, 0.02)))
    return hs.Robot(
        name="near_the_edge",
        body=body,
        pins=(hs.Pin(at=(0.0, 0.0), radius=1.0),),
        winches=(hs.Winch(name="pull", at=(-0.02, -0.01), travel=0.004),),
        cables=tuple(hs.Cable(winch="pull", points=route) for route in routes),
        poses={},
    )
