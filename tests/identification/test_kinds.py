"""Names of parameters to fit. Oracle: the same names in a tuple."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from builders import box_robot, routed_strip

from hydrostat.errors import InputError
from hydrostat.identification import MarkerPredictor, Measurements, identify, named_model
from hydrostat.identification.kinds import KINDS
from hydrostat.robot import Marker, Robot

UPPER = ((0.0083, 0.0137), (0.0587, 0.0161), (0.1129, 0.0147), (0.1833, 0.0143))


def strip() -> Robot:
    """A flat strip with a cable and two markers."""
    markers = (Marker(name="tip", at=(0.2, 0.0)), Marker(name="middle", at=(0.1, 0.0)))
    return replace(routed_strip({"up": UPPER}, slack=0.001, travel=0.02), markers=markers)


def test_names_of_parameters_in_one_text(unchecked: None) -> None:
    """Oracle: the fit of the same names in a tuple; the thickness has the digits of a measurement."""
    empty = np.zeros((2, 2, 2))
    asked = Measurements(commands=np.array([[0.005], [0.008]]), markers=("tip", "middle"), places=empty)
    predictor = MarkerPredictor(named_model(strip(), ()), asked)
    seen = replace(asked, places=1.01 * predictor.predict(np.zeros(0), with_jacobian=False).places)
    texts, tuples = (identify(strip(), seen, fit=fit) for fit in ("thickness, gain", ("thickness", "gain")))
    assert texts.fitted.values == tuples.fitted.values
    thickness = texts.robot.body.thickness or 0.0
    assert thickness == float(f"{thickness:.6g}")
    rulers = replace(seen, places=np.full_like(seen.places, np.nan), pairs=((0, 1),), lengths=np.full((2, 1), 0.1))
    for fit, words in (
        ("gain,", "fit has an empty name"),
        (("gain", 3), "fit must be names"),
        (3, "fit must be names"),
    ):
        with pytest.raises(InputError, match=words):
            identify(strip(), seen, fit=cast("Any", fit))
    with pytest.raises(InputError, match="ruler distances are true"):
        identify(strip(), rulers, fit="frame,scale")


def test_unknown_kinds_are_refused() -> None:
    with pytest.raises(InputError, match='unknown parameter "yuong"'):
        named_model(strip(), ("yuong",))
    with pytest.raises(InputError, match='parameter "rods": this robot has no rods'):
        named_model(strip(), ("rods",))
    with pytest.raises(InputError, match='parameter "thickness": a 3D body has no thickness'):
        named_model(box_robot(), ("thickness",))
    assert [name for name, kind in KINDS.items() if kind.default] == [
        "young",
        "stiffness",
        "zero",
        "gain",
        "rods",
        "sheets",
        "frame",
    ]
