"""The benchmark of peers, with no peer installed: what it measures against, and what it says of one it cannot have."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from held_body import HeldBody, at_rest, follow
from laws import LAWS, Reference

import peers
from hydrostat.mechanics import Assembly, NeoHookean


def bar(pull: float) -> HeldBody:
    """A bar of 2 x 1 x 1 cm, a cube in six tetrahedra twice, held at one end and pulled to its side [N]."""
    grid = np.stack(np.meshgrid(range(3), range(2), range(2), indexing="ij"), axis=-1).reshape(-1, 3)
    corner = {tuple(place): node for node, place in enumerate(grid.tolist())}
    elements = []
    for start in range(2):
        for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
            path = np.vstack([np.zeros(3), np.cumsum(np.eye(3)[list(order)], axis=0)]) + np.array([start, 0, 0])
            elements.append([corner[tuple(place)] for place in path.astype(int).tolist()])
    nodes, corners = 0.01 * grid.astype(float), np.array(elements)
    turned = np.linalg.det(nodes[corners[:, 1:]] - nodes[corners[:, :1]]) < 0
    corners[turned] = corners[turned][:, [0, 2, 1, 3]]
    masses = np.bincount(corners.ravel(), minlength=len(nodes)) * 1e-4
    forces = masses[:, None] / masses.sum() * np.array([0.0, pull, 0.0])
    return HeldBody(nodes, corners, grid[:, 0] == 0, forces, 2.3e4, 3.5e4, masses)


def moved(body: HeldBody) -> np.ndarray:
    """Positions near rest at which no element is inverted."""
    return body.nodes + np.random.default_rng(3).normal(0, 5e-4, body.nodes.shape)


@pytest.mark.parametrize("name", LAWS)
def test_hessian_of_each_material(name: str) -> None:
    """Oracle: central differences of the forces."""
    body = bar(0.0)
    reference, nodes, step = Reference(body, LAWS[name]), moved(body), 1e-7
    along = np.zeros(body.nodes.size)
    along[reference.free] = np.random.default_rng(4).normal(size=len(reference.free))
    sides = [reference.left_over(nodes + sign * step * along.reshape(nodes.shape)) for sign in (1, -1)]
    expected = (sides[0] - sides[1]) / (2 * step)
    np.testing.assert_allclose(
        reference.hessian(nodes) @ along[reference.free], expected, atol=1e-6 * abs(expected).max()
    )


@pytest.mark.parametrize("name", LAWS)
def test_materials_agree_at_small_strain(name: str) -> None:
    """Oracle: linear elasticity; all have its Hessian at rest."""
    body = bar(0.0)
    found = Reference(body, LAWS[name]).hessian(body.nodes).toarray()
    expected = Reference(body, LAWS["Neo-Hookean"]).hessian(body.nodes).toarray()
    np.testing.assert_allclose(found, expected, atol=1e-12 * abs(expected).max())


def test_forces_are_those_of_hydrostat() -> None:
    """Oracle: hydrostat's own energy, of which the reference knows nothing."""
    body = bar(0.0)
    nodes = moved(body)
    energy = NeoHookean(body.nodes, body.elements, mu=body.mu, lame=body.lame)
    assembly = Assembly([energy], rest=body.nodes, control_count=0)
    reference = Reference(body, LAWS["Neo-Hookean"])
    expected = np.asarray(assembly.gradient(nodes, np.zeros(0))).ravel()[reference.free]
    np.testing.assert_allclose(reference.left_over(nodes), expected, atol=1e-12 * abs(expected).max())


def test_reference_is_balanced() -> None:
    """Oracle: forces at the held nodes carry the whole load, to rounding."""
    body = bar(0.5)
    nodes = Reference(body, LAWS["Neo-Hookean"]).loaded(5)
    assert nodes is not None
    free = replace(body, held=np.zeros(len(nodes), dtype=bool))
    left = Reference(free, LAWS["Neo-Hookean"]).left_over(nodes).reshape(-1, 3)
    assert np.abs(left[~body.held]).max() < 1e-12
    np.testing.assert_allclose(-left[body.held].sum(axis=0), [0.0, 0.5, 0.0], atol=1e-11)
    np.testing.assert_array_equal(nodes[body.held], body.nodes[body.held])


@pytest.mark.slow
def test_peer_that_cannot_be_had_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: pip, which looks into an empty folder only."""
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path))
    bar(0.5).save(tmp_path / "body.npz")
    nobody = peers.Peer("nobody", "scikit_fem.py", "", packages=("no-such-peer==1.0",))
    trail, reason = peers.run(nobody, tmp_path / "env", tmp_path / "body.npz", 1.0)
    assert trail is None
    assert "cannot be installed" in reason
    assert "no-such-peer" in reason


def test_peer_that_fails_is_told(tmp_path: Path) -> None:
    """Oracle: a file that is not there."""
    trail, reason = peers.run(peers.Peer("lost", "lost.py", ""), tmp_path, tmp_path / "body.npz", 1.0)
    assert trail is None
    assert "does not run" in reason


def test_body_comes_back_as_it_was_stored(tmp_path: Path) -> None:
    body = bar(0.5)
    body.save(tmp_path / "body.npz")
    back = HeldBody.load(tmp_path / "body.npz")
    np.testing.assert_array_equal(back.forces, body.forces)
    assert (back.mu, back.young) == (body.mu, body.young)


def test_row_tells_when_an_error_is_below_a_level_for_good() -> None:
    """Oracle: errors of 0.5, 50, 0.5 and 0 mm on a way of 100 mm, by hand."""
    body = bar(0.0)
    true = body.nodes + np.array([0.1, 0.0, 0.0])
    answers = np.array([true + np.array([error, 0.0, 0.0]) for error in (5e-4, 5e-2, 5e-4, 0.0)])
    trail = peers.Trail(np.array([1.0, 2.0, 3.0, 4.0]), answers, 0.0, done=True)
    line = peers.row(peers.PEERS[0], trail, body, {"Neo-Hookean": true})
    assert line.split(" | ")[2:6] == ["3000", "3000", "4000", "4000"]


def test_time_between_answers_counts_and_a_budget_ends_it() -> None:
    body = bar(0.0)
    seconds, answers, done = follow(lambda: iter([body.nodes, body.nodes]), 60.0)
    assert done
    assert len(answers) == 2
    assert 0 <= seconds[0] <= seconds[1]
    assert follow(lambda: iter([body.nodes, body.nodes]), -1.0)[2] is False
    assert at_rest(body, answers[0], answers[1], 0.0)
