"""Intervals by profile likelihood. Oracle: a toy in closed form, minimized on a grid; a kink of a slack cable."""

from dataclasses import replace

import numpy as np
import pytest
from builders import mesh_body, strip_mesh

from hydrostat.identification import (
    IdentificationModel,
    MarkerPredictor,
    Measurements,
    Parameter,
    fit_model,
    named_model,
)
from hydrostat.identification.profile_intervals import profile_intervals
from hydrostat.robot import Cable, Marker, Pin, Robot, Winch

ROUTE = ((0.01, 0.01), (0.1, 0.01), (0.19, 0.01))
STRIP = Robot(
    name="strip",
    body=mesh_body(strip_mesh(4, 1)),
    pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0)), stiffness=3e3),),
    winches=(Winch(name="up", at=ROUTE[0]),),
    cables=(Cable(winch="up", points=ROUTE, slack=0.001),),
    markers=(Marker(name="tip", at=(0.2, 0.0)),),
    poses={},
)
TIP = np.array(STRIP.markers[0].at)
NOISE = 1e-3


def rows(places: np.ndarray, pull: float = 0.0) -> Measurements:
    return Measurements(commands=np.full((len(places), 1), pull), markers=("tip",), places=places[:, None])


@pytest.mark.parametrize("spread", [1.0, 4.0])
def test_ends_are_those_of_a_closed_form(spread: float) -> None:
    """A square has two roots: the linearized interval holds one, the profile both. The sum b is nearly linear."""
    model = IdentificationModel(
        parameters=(
            Parameter(name="a", start=1.0, spread=2.0, high=1.2),
            Parameter(name="b", start=0.0, spread=1.0),
        ),
        robot=lambda _: STRIP,
        places=lambda values, at: at + NOISE * np.array([values["a"] ** 2 + values["b"], 3 * values["b"]]),
    )
    misses = np.array([[0.9, 0.4], [0.3, 1.0], [1.1, 0.5], [-0.2, 0.8]])  # of the tip, in standard deviations
    measured = rows(TIP + NOISE * misses)
    fitted = replace(fit_model(model, measured, noise=NOISE, refine=False), spread=spread)
    ends = profile_intervals(fitted, measured).intervals

    steps = np.linspace(-2.0, 2.0, 1601)
    a, b = np.meshgrid(steps, steps, indexing="ij")
    predicted = np.stack([a**2 + b, 3 * b], axis=-1)[:, :, None]
    squares = 18 * (np.sqrt(1 + (predicted - misses) ** 2 / 9) - 1)
    at = fitted.numbers
    middle = at - at / np.sqrt(1 + at**2 / 9) / spread
    deviance = squares.sum(axis=(2, 3)) / spread + ((a - 1) / 2 - middle[0]) ** 2 + (b - middle[1]) ** 2
    for name, profile in (("a", deviance.min(axis=1)), ("b", deviance[steps <= 1.2].min(axis=0))):
        within = steps[profile <= deviance[steps <= 1.2].min() + 1.96**2]
        low, high = within.min(), min(within.max(), 1.2 if name == "a" else 2.0)
        assert ends[name][0] == pytest.approx(low, abs=0.04 * (high - low))
        assert ends[name][1] == pytest.approx(high, abs=0.04 * (high - low))
    assert fitted.intervals["a"][0] > ends["a"][0] + 0.4
    assert fitted.intervals["a"][1] > 1.2 or spread == 1.0


def test_a_slack_cable_has_a_wide_side() -> None:
    """Oracle: the definition, by places at both ends: a cable that moves nothing may be slack by any length."""
    model, at_rest = named_model(STRIP, ("zero",)), rows(np.tile(TIP, (3, 1)), pull=1.5e-3)
    fitted = fit_model(model, at_rest, noise=3e-4, refine=False)
    predictor = MarkerPredictor(model, at_rest)

    def deviance(number: float) -> float:
        errors = (predictor.predict(np.array([number]), with_jacobian=False).places - at_rest.places) / 3e-4
        return float(np.sum(18 * (np.sqrt(1 + errors**2 / 9) - 1)) + (number - middle) ** 2)

    number = fitted.numbers[0]
    middle = number - number / np.sqrt(1 + number**2 / 9)
    least = deviance(number)
    low, high = (model.parameters[0].to_fitted(end) for end in profile_intervals(fitted, at_rest).intervals["up.zero"])
    assert [np.sqrt(deviance(end) - least) for end in (low, high)] == pytest.approx([1.96, 1.96], rel=0.16)
    assert number - low > 2 * (high - number)
