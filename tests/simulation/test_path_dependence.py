"""Poses at the same contractions. Oracles: load steps from both sides, the mirror, distances taken directly."""

from dataclasses import replace

import numpy as np
import pytest
from arches import arch
from builders import strip_robot
from test_buckling import column, mirrored  # pyright: ignore[reportMissingImports]

from hydrostat.errors import InputError
from hydrostat.mechanics import NewtonOptions
from hydrostat.simulation import Equilibrium, Simulation, find_equilibria

pytestmark = pytest.mark.usefixtures("unchecked")


def stepped(simulation: Simulation, first: float, last: float) -> Equilibrium:
    """The pose after small load steps between contractions of the arch [m]."""
    pose = simulation.solve({"down": first})
    for contraction in np.linspace(first, last, 61)[1:]:
        pose = simulation.solve({"down": float(contraction)}, start=pose)
    return pose


def test_an_arch_rests_up_or_down() -> None:
    simulation = Simulation(arch())
    found = find_equilibria(simulation, {"down": 0.145})
    both = [stepped(simulation, 0.0, 0.145), stepped(simulation, 0.3, 0.145)]
    both.sort(key=lambda pose: pose.energy)
    assert len(found.poses) == 2
    for known, pose in zip(both, found.poses, strict=True):
        assert np.abs(known.nodes - pose.pose.nodes).max() < 1e-8
    apart = np.linalg.norm(both[0].markers["top"] - both[1].markers["top"])
    assert apart == pytest.approx(15.5e-3, abs=5e-5)  # as docs/theory/multistability.md says
    assert found.spread == {"top": pytest.approx(apart, abs=1e-8)}
    assert found.node_spread >= apart - 1e-8
    assert not found.unique
    assert found.starts == 16
    assert found.lines()[0] == f"2 poses on 16 loading paths, up to {1e3 * apart:.3g} mm apart at top"
    assert found.lines()[1].startswith("pose 1: energy 0.00199")
    down = next(pose for pose in found.poses if pose.pose.markers["top"][1] < 0)
    assert "back from full travel" in down.ways


@pytest.mark.parametrize("contraction", [0.13, 0.16])
def test_beyond_its_folds_the_arch_has_one_pose(contraction: float) -> None:
    found = find_equilibria(Simulation(arch()), {"down": contraction})
    assert found.unique
    assert found.lines() == ["unique pose on 16 loading paths"]


def test_a_column_is_straight_or_bent_to_either_side() -> None:
    """At 9 mm it is straight on the way there and bent on the way back; the bent ones are mirror images."""
    simulation = Simulation(column(4))
    found = find_equilibria(simulation, np.full(2, 0.009))
    bent = [pose.pose for pose in found.poses if np.abs(pose.pose.nodes[:, 1]).mean() > 0.012]
    straight = [pose.pose for pose in found.poses if pose.pose not in bent]
    assert len(straight) == 1
    assert len(bent) == 2
    assert np.abs(mirrored(simulation.robot, straight[0].nodes) - straight[0].nodes).max() < 1e-6
    assert np.abs(mirrored(simulation.robot, bent[0].nodes) - bent[1].nodes).max() < 1e-6
    assert bent[0].energy == pytest.approx(bent[1].energy, rel=1e-9)
    assert found.spread == {}
    assert found.largest == ("a node", found.node_spread)


def test_a_beam_has_one_pose() -> None:
    simulation = Simulation(strip_robot())
    found = find_equilibria(simulation, {"up": 0.03, "down": 0.01})
    assert found.unique
    assert found.lost == ()
    assert found.spread == {"tip": 0.0}
    assert np.abs(found.poses[0].pose.nodes - simulation.solve({"up": 0.03, "down": 0.01}).nodes).max() < 1e-8
    kinds = {way.partition(":")[0] for way in found.poses[0].ways}
    assert kinds == {
        "from rest in one step",
        "from rest, all winches together",
        "back from full travel",
        "one winch after the other",
        "pushed aside and let go",
        "from other contractions",
    }
    assert {way for way in found.poses[0].ways if ":" in way} == {
        "one winch after the other: up, down",
        "one winch after the other: down, up",
    }


def test_the_tolerance_tells_poses_apart() -> None:
    """What is one pose at the usual tolerance are many at one below the solver's own."""
    simulation = Simulation(strip_robot(), options=NewtonOptions(tolerance=1e-5))
    goal = {"up": 0.03, "down": 0.01}
    assert find_equilibria(simulation, goal, count=8).unique
    assert len(find_equilibria(simulation, goal, count=8, tolerance=1e-15).poses) > 1


def test_the_same_seed_gives_the_same_ways() -> None:
    simulation = Simulation(arch())
    one, same, other = (find_equilibria(simulation, {"down": 0.145}, count=9, seed=seed) for seed in (0, 0, 3))
    assert [pose.ways for pose in one.poses] == [pose.ways for pose in same.poses]
    assert one.starts == other.starts == 9


def test_with_friction_the_way_matters() -> None:
    robot = strip_robot(columns=8, rows=2)
    rubbing = Simulation(replace(robot, cables=tuple(replace(cable, friction=0.3) for cable in robot.cables)))
    found = find_equilibria(rubbing, {"up": 0.02, "down": 0.005}, count=5)
    assert found.friction
    assert len(found.poses) > 1
    assert "cable friction is on: the pose depends on the loading path" in found.lines()
    assert find_equilibria(Simulation(robot), {"up": 0.02, "down": 0.005}, count=5).unique


def test_ways_that_lead_nowhere_are_told() -> None:
    simulation = Simulation(arch(), options=NewtonOptions(iterations=1))
    found = find_equilibria(simulation, {"down": 0.145}, count=4)
    assert len(found.lost) + found.starts == 4
    assert found.lost
    assert found.lines()[-1].startswith(f"no stable pose on {len(found.lost)} loading path")


def test_progress_is_told() -> None:
    told = []
    find_equilibria(Simulation(arch()), {}, count=3, progress=lambda *given: told.append(given))
    assert told == [("solving loading paths", done, 3) for done in (1, 2, 3)]


@pytest.mark.parametrize(("count", "tolerance", "words"), [(0, 1e-4, "count"), (3, 0.0, "tolerance")])
def test_bad_options_are_refused(count: int, tolerance: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        find_equilibria(Simulation(arch()), {}, count=count, tolerance=tolerance)


def test_a_seed_below_zero_is_refused(unchecked: None) -> None:
    simulation = Simulation(strip_robot())
    for seed in (-1, 0.5, "a"):
        with pytest.raises(InputError, match="seed must be a whole number"):
            find_equilibria(simulation, np.zeros(2), seed=seed)  # type: ignore[arg-type]
