"""Energies that the house does not know plug in by list. Oracles: their contract, balance, finite differences."""

import numpy as np
import pytest
from builders import strip_robot
from toy_energies import Floor, Magnet, YieldingTie

from hydrostat.mechanics import Assembly, Energy
from hydrostat.simulation import Simulation
from hydrostat.testing import check_energy

ROBOT = strip_robot(columns=12, rows=3)
NODES = ROBOT.body.mesh.nodes
PULL = np.array([0.01, 0.0])
TIP = int(np.argmax(NODES[:, 0] + NODES[:, 1]))
ROOT = int(np.argmin(NODES[:, 0] - NODES[:, 1]))
FLOOR = float(NODES[:, 1].min()) - 0.002


def toys() -> dict[str, Energy]:
    return {
        "magnet": Magnet(TIP, ROOT, strength=1e-3, control=0),
        "floor": Floor(FLOOR, reach=0.01, stiffness=1e-2),
        "tie": YieldingTie(NODES, TIP, stiffness=5.0, limit=0.02),
    }


@pytest.mark.parametrize("name", toys())
def test_the_toys_keep_the_contract(name: str) -> None:
    bent = NODES + np.array([0.0, 0.02]) * (NODES[:, :1] / NODES[:, 0].max()) ** 2
    energy = toys()[name].near(bent)
    check_energy(energy, bent, np.array([0.3, 0.1]), tolerance=1e-5)


def test_a_magnet_pulls_the_tip_and_has_exact_slopes() -> None:
    """Oracles: forces balance; D nodes / d contractions, to which the magnet's own control adds, by differences."""
    plain, pulled = Simulation(ROBOT), Simulation(ROBOT, energies=[toys()["magnet"]])
    pose = pulled.solve(PULL)
    apart = [np.linalg.norm(found.nodes[TIP] - found.nodes[ROOT]) for found in (plain.solve(PULL), pose)]
    assert apart[1] < apart[0] - 1e-4
    assert np.abs(pulled.forces(pose.nodes, pose.contractions)).max() <= pose.result.allowed
    step = np.array([1e-6, 0.0])
    found = (pulled.solve(PULL + step).nodes - pulled.solve(PULL - step).nodes) / 2e-6
    exact = pulled.jacobian(pose)[:, :, 0]
    assert np.abs(found - exact).max() < 1e-5 * np.abs(exact).max()
    assert np.abs(plain.jacobian(plain.solve(PULL))[:, :, 0] - exact).max() > 1e-2 * np.abs(exact).max()


def test_a_floor_holds_and_its_terms_come_and_go() -> None:
    """Oracle: the same floor with a term for every node. The lower cable would pull the tip far below it."""
    down = np.array([0.0, 0.02])
    floor, every = toys()["floor"], Floor(FLOOR, reach=0.01, stiffness=1e-2, every=True, count=len(NODES))
    assert isinstance(floor, Floor)
    simulation = Simulation(ROBOT, energies=[floor])
    pose, other = simulation.solve(down), Simulation(ROBOT, energies=[every]).solve(down)
    assert Simulation(ROBOT).solve(down).nodes[:, 1].min() < FLOOR - 0.01
    assert FLOOR < pose.nodes[:, 1].min() < FLOOR + 0.01
    assert np.abs(pose.nodes - other.nodes).max() < 1e-8
    touching = simulation.assembly.near(pose.nodes)
    assert 0 < len(touching.energies[-1].stencils) < len(NODES)
    assert touching.pattern.analysis is simulation.assembly.pattern.analysis  # nodes alone are no new pairs
    exact, h = simulation.jacobian(pose)[:, :, 1], np.array([0.0, 1e-6])
    found = (simulation.solve(down + h, start=pose).nodes - simulation.solve(down - h, start=pose).nodes) / 2e-6
    assert np.abs(found - exact).max() < 1e-4 * np.abs(exact).max()


def test_no_step_passes_through_a_floor() -> None:
    """Oracle: a floor so thin that a free step from high above leads far below it, where it would not be felt."""
    floor = Floor(FLOOR, reach=1e-4, stiffness=1e2)
    pose = Simulation(ROBOT, energies=[floor]).solve(np.array([0.0, 0.02]), strict=False)
    assert floor.asked > 0
    assert pose.nodes[:, 1].min() > FLOOR


def test_a_pair_that_never_met_is_analysed_anew() -> None:
    """Oracle: an assembly made with it from the start."""
    simulation, magnet = Simulation(ROBOT), toys()["magnet"]

    class Reach(Magnet):
        """It is there only while the tip is above its rest."""

        def near(self, nodes: np.ndarray) -> Energy:
            return magnet if nodes[TIP, 1] > NODES[TIP, 1] else far

    far = Reach(TIP, TIP, strength=0.0, control=0)
    far.stencils = far.stencils[:0]
    far.controls = far.controls[:0]
    assembly = simulation.assembly.extended([far], control_count=2)
    raised = NODES + np.array([0.0, 1e-3])
    near, below = assembly.near(raised), assembly.near(NODES - np.array([0.0, 1e-3]))
    assert below is assembly
    assert near.pattern.analysis is not assembly.pattern.analysis
    fresh = Assembly(near.energies, rest=NODES, control_count=2)
    expected, right = fresh.hessian(raised, PULL).toarray(), np.arange(NODES.size, dtype=float)
    assert near.hessian(raised, PULL).toarray() == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    solved, wanted = near.stiffness(raised, PULL).solve(right), fresh.stiffness(raised, PULL).solve(right)
    assert solved == pytest.approx(wanted, abs=1e-8 * np.abs(wanted).max())


def test_a_tie_that_yields_remembers_the_way() -> None:
    """Oracles: the force of the tie never exceeds its limit, and after a pull and back the body is not as before."""
    tie = toys()["tie"]
    simulation = Simulation(ROBOT, energies=[tie])
    there = simulation.solve(np.array([0.03, 0.0]))
    back = simulation.solve(np.zeros(2), start=there)
    assert isinstance(tie, YieldingTie)
    for pose in (there, back):
        assert pose.result.converged
        slipped = tie.resumed(pose.history, pose.nodes, pose.contractions)
        assert tie.stiffness * np.linalg.norm(slipped._off(pose.nodes)) <= 1.0001 * tie.limit
    assert np.linalg.norm(there.history) > 1e-3
    assert np.linalg.norm(back.nodes[TIP] - simulation.rest.nodes[TIP]) > 1e-4
    assert (simulation.rest.history == 0).all()
