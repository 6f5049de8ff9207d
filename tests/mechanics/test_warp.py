"""Steps along arcs. Oracles: rotations in closed form (scipy), the order at which bent and straight steps part."""

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from scipy.linalg import expm
from states import deform, rough_mesh

from hydrostat.geometry import Mesh
from hydrostat.mechanics import NeoHookean, Warp


def made(mesh: Mesh, held: list[int]) -> Warp:
    count = mesh.dim + 1
    body = NeoHookean(mesh.nodes, mesh.elements, mu=1.0, lame=1.0)
    return Warp(
        stencils=body.stencils,
        shape_gradients=body.shape_gradients,
        volumes=body.volumes,
        rest=mesh.nodes,
        held=(np.array(held, dtype=int)[:, None] + np.arange(count)) % len(mesh.nodes),
        holds=np.tile(np.eye(count)[0], (len(held), 1)),
    )


def spin(dim: int, random: np.random.Generator, angle: float) -> np.ndarray:
    """A skew matrix that turns by an angle."""
    skew = random.standard_normal((dim, dim))
    skew -= skew.T
    return angle * skew / np.linalg.norm(skew) * np.sqrt(2)


def block(dim: int) -> Mesh:
    return rough_mesh(dim, np.random.default_rng(dim))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("angle", [1e-5, 0.3, 1.5, 4.0])
@pytest.mark.parametrize("deformed", [False, True])
def test_a_rigid_spin_becomes_a_rotation(dim: int, angle: float, deformed: bool) -> None:
    """The step W x about a held node ends at exp(W) x, whatever shape the body has taken."""
    random = np.random.default_rng(int(10 * angle) + dim)
    mesh = block(dim)
    nodes = deform(mesh, random) if deformed else mesh.nodes
    turn, center = spin(dim, random, angle), nodes[2]
    found = made(mesh, [2])(nodes, (nodes - center) @ turn.T)
    expected = (nodes - center) @ expm(turn).T + center
    assert np.abs(found - expected).max() < 1e-11 * np.ptp(nodes)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_free_body_turns_about_its_middle(dim: int) -> None:
    """Held nowhere, so its middle goes where the straight step leads it."""
    nodes, turn = block(dim).nodes, spin(dim, np.random.default_rng(dim), 0.3)
    middle, drift = nodes.mean(axis=0), 0.02
    found = made(block(dim), [])(nodes, (nodes - middle) @ turn.T + drift)
    assert np.abs(found - ((nodes - middle) @ expm(turn).T + middle + drift)).max() < 1e-6 * np.ptp(nodes)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_stretch_is_followed_straight(dim: int) -> None:
    """A symmetric gradient spins nothing, so the bent step is the straight one."""
    random = np.random.default_rng(dim)
    mesh = block(dim)
    half = 0.2 * random.standard_normal((dim, dim))
    step = mesh.nodes @ (half + half.T) + 0.01
    assert made(mesh, [0, 3])(mesh.nodes, step) == pytest.approx(mesh.nodes + step, abs=1e-13)


@pytest.mark.parametrize("dim", [2, 3])
def test_held_points_that_spin_and_stretch_agree(dim: int) -> None:
    """A spin and a stretch about the held node: each element goes to exp(W) (I + S) x."""
    random = np.random.default_rng(dim)
    mesh = block(dim)
    half, turn = 0.2 * random.standard_normal((dim, dim)), spin(dim, random, 0.8)
    from_held = mesh.nodes - mesh.nodes[1]
    found = made(mesh, [1])(mesh.nodes, from_held @ (half + half.T + turn).T)
    expected = from_held @ (expm(turn) @ (np.eye(dim) + half + half.T)).T + mesh.nodes[1]
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_to_first_order_the_step_is_the_same(dim: int) -> None:
    """What a bent step differs from a straight one by falls as the square of its length, and as no higher power."""
    random = np.random.default_rng(dim)
    mesh = block(dim)
    nodes, warp = deform(mesh, random), made(mesh, [0, 1])
    step = 0.2 * np.ptp(nodes) * random.standard_normal(nodes.shape)
    lengths = 1e-2 * 0.5 ** np.arange(5)
    apart = np.array([np.abs(warp(nodes, length * step) - nodes - length * step).max() for length in lengths])
    orders = np.log2(apart[:-1] / apart[1:])
    assert orders == pytest.approx(2.0, abs=0.1)
    assert orders[-1] == pytest.approx(2.0, abs=0.02)


@pytest.mark.parametrize("mesh", [strip_mesh(7, 3), box_mesh((3, 2, 2))], ids=["plane", "space"])
def test_no_step_stays_where_it_is(mesh: Mesh) -> None:
    nodes = deform(mesh, np.random.default_rng(0))
    assert made(mesh, [0])(nodes, np.zeros_like(nodes)) == pytest.approx(nodes, abs=1e-14)


def test_a_bar_that_curls_keeps_its_length() -> None:
    """Why it is there: the sections of a bar spin, at its end by a right angle. Oracle: its length."""
    mesh = strip_mesh(40, 2, size=(0.2, 0.01))
    curvature = np.pi / 2 / 0.2
    x, y = mesh.nodes.T
    step = np.column_stack([-curvature * x * y, 0.5 * curvature * x**2])
    middle = np.flatnonzero(np.abs(y) < 1e-12)
    bent = made(mesh, [int(node) for node in np.flatnonzero(x == 0.0)])(mesh.nodes, step)
    lengths = [np.linalg.norm(np.diff(nodes[middle], axis=0), axis=1).sum() for nodes in (mesh.nodes + step, bent)]
    assert lengths[0] > 1.3 * 0.2
    assert lengths[1] == pytest.approx(0.2, rel=0.01)
