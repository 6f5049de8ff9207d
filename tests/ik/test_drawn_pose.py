"""Poses drawn over the body's drawing. Oracles: the same rectangle moved on its page, hidden contractions."""

from pathlib import Path

import numpy as np
import pytest
from builders import FOAM, strip_robot
from scipy.optimize import least_squares

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry import Outline
from hydrostat.ik.objectives.objective import EquilibriumState, StateJacobian
from hydrostat.ik.objectives.shape_target import ShapeTarget, load_target_outline
from hydrostat.robot import Body, Pin, Robot
from hydrostat.simulation import Simulation


def svg(x: float, y: float, length: float = 200.0, unit: float = 1.0, height: float = 200.0) -> bytes:
    """A rectangle with its upper left corner at (x, y), on a page of 300 x 200 units."""
    page = f'width="{300 * unit}mm" height="{height * unit}mm" viewBox="0 0 300 {height}"'
    drawn = f'<rect x="{x}" y="{y}" width="{length}" height="50"/>'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {page}>{drawn}</svg>'.encode()


def drawn(size: float | None = None) -> Robot:
    content = svg(30, 40)
    body = Body.from_outline(
        content, file="a.svg", material=FOAM, element_size=0.1 * (size or 0.2), thickness=0.03, size=size
    )
    return Robot(
        name="drawn", body=body, pins=(Pin(at=(0.0, 0.0), radius=0.05),), winches=(), cables=(), markers=(), poses={}
    )


@pytest.mark.parametrize("size", [None, 0.4])
def test_a_pose_stays_where_it_was_drawn(size: float | None, tmp_path: Path) -> None:
    """Moved by 10 to the right and 30 down the page, and 20 longer, all times the scale of the body."""
    (tmp_path / "pose.svg").write_bytes(svg(40, 70, 220))
    found = load_target_outline(drawn(size), tmp_path / "pose.svg").polygon.bounds
    scale = (size or 0.2) / 200
    np.testing.assert_allclose(found, np.array([-90, -55, 130, -5]) * scale, atol=1e-12)


def test_an_enlarged_page_is_refused(tmp_path: Path) -> None:
    """A page that grew by 100 at its top, so that a program counts all heights from there; the unit is the same."""
    (tmp_path / "pose.svg").write_bytes(svg(30, 140, height=300.0))
    with pytest.raises(
        OutlineError, match=r"300 x 300 units from \(0, 0\), the drawing .* 300 x 200 units from"
    ) as told:
        load_target_outline(drawn(), tmp_path / "pose.svg")
    assert "\n" not in str(told.value)


def test_what_cannot_be_a_pose_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"a\.svg: a pose can be drawn over a drawing only, the body is of a mesh file"
    ):
        load_target_outline(strip_robot(), tmp_path / "a.svg")
    with pytest.raises(InputError, match=r"missing\.svg: there is no such file"):
        load_target_outline(drawn(), tmp_path / "missing.svg")
    (tmp_path / "pose.svg").write_bytes(svg(30, 40, unit=2.0))
    with pytest.raises(OutlineError, match=r"pose\.svg: is an SVG drawing in units of 2 x 2 mm on a page of"):
        load_target_outline(drawn(), tmp_path / "pose.svg")


@pytest.mark.usefixtures("unchecked")
def test_contractions_are_found_from_the_drawing_of_a_pose() -> None:
    """The boundary of a solved pose and nothing else leads from rest to the contractions behind it."""
    simulation = Simulation(strip_robot(columns=12, rows=3))
    mesh, hidden = simulation.robot.body.mesh, np.array([0.02, 0.006])
    after = dict(mesh.boundary.tolist())
    ring = [int(mesh.boundary[0, 0])]
    while (node := after[ring[-1]]) != ring[0]:
        ring.append(node)
    term = ShapeTarget(outline=Outline(simulation.solve(hidden).nodes[ring])).bind(simulation)
    found = least_squares(
        lambda a: term.residual(EquilibriumState.at(simulation, simulation.solve(a))),
        [0.003, 0.003],
        jac=lambda a: term.jacobian(
            EquilibriumState.at(simulation, pose := simulation.solve(a)), StateJacobian.at(simulation, pose)
        ),
        bounds=(0, 0.05),
        xtol=1e-14,
        ftol=1e-14,
        gtol=1e-14,
    )
    np.testing.assert_allclose(found.x, hidden, atol=1e-7)
    assert found.nfev < 25
    assert term.errors(EquilibriumState.at(simulation, simulation.solve(found.x)))["outline"] < 1e-7
