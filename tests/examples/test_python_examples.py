"""The Python examples: each runs in a folder of its own, draws its figure, and prints a number that an oracle holds."""

import csv
import warnings
from collections.abc import Callable
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

import ezdxf
import ezdxf.bbox
import numpy as np
import pytest

import hydrostat as hs
from hydrostat.simulation import Simulation

EXAMPLES = sorted((Path(__file__).parents[2] / "examples" / "python").glob("[0-9]*.py"))


def left_tip(names: dict[str, Any]) -> float:
    """Distance that the left tip moves for 12 mm, by the integral of the Jacobian [m]."""
    simulation = names["simulation"]
    row = [marker.name for marker in names["robot"].markers].index("left")
    poses = [simulation.solve({"left": 0.001 * (step + 0.5)}) for step in range(12)]
    return float(np.linalg.norm(sum(0.001 * simulation.marker_jacobian(pose)[row, :, 1] for pose in poses)))


def step(targets: np.ndarray) -> float:
    """Largest step of a moving target from one update to the next."""
    return float(np.linalg.norm(np.diff(targets, axis=0), axis=1).max())


def is_inside_grid(names: dict[str, Any]) -> bool:
    """Areas: the box of the places, and the hull of half of them."""
    spans = np.ptp(names["places"], axis=0)
    half = names["ConvexHull"](names["places"][::2]).volume / 100.0
    return half <= names["area"] < spans[0] * spans[1] / 100.0


HELD: dict[str, tuple[str, Callable[[dict[str, Any]], bool]]] = {
    "01_bend": ("integral of the Jacobian", lambda names: abs(names["travel"] / left_tip(names) - 1) < 0.01),
    "02_workspace": ("areas", is_inside_grid),
    "03_beam_theory": ("Timoshenko", lambda names: abs(names["ratio"] - 1) < 0.02),
    "04_inverse_kinematics": ("limit", lambda names: 1.9 < names["limited"].pose.tensions.max() < 2.002),
    "05_own_objective": ("markers", lambda names: names["level"] < 1e-6 and feet_differ(names) < 1e-6),
    "06_load_and_compliance": ("a solve with the load", lambda names: names["error"] < 0.01),
    "07_bone_in_an_arm": ("rigid", lambda names: names["strain"] < 1e-3 < names["with_bone"] < names["soft"]),
    "08_dynamics": ("statics", lambda names: names["off"] < 1e-4),
    "09_tracker": ("twice the target's step", lambda names: names["error"] < 2 * step(names["targets"])),
    "10_contact": ("distance of nodes", lambda names: 0.0 < names["gap"] < 3e-3),
    "11_snap_through": ("two poses between two folds", lambda names: names["folds"] == names["stable"] == 2),
    "12_friction": ("none without friction", lambda names: 1e4 * abs(work_without(names)) < names["work"]),
    "13_design": ("as built is worse", lambda names: names["network"].rms_error < names["built"] < 6e-3),
    "14_build_kit": ("lengths of cables, panels of the body", lambda names: fits_the_robot(names["kit"])),
    "15_drawing_to_robot": ("size asked for", lambda names: abs(names["size"] - 0.24) < 1e-3),
    "16_gradients": ("central difference", lambda names: names["error"] < 1e-6),
    "17_identify": ("hidden modulus", lambda names: abs(names["young"] / names["true"] - 1) < 0.03),
    "18_trajectory": ("speed limit", lambda names: 0.045 < names["fastest"] <= 0.05 * (1 + 1e-6)),
    "19_pulls": ("tensions at contractions", lambda names: names["error"] < 0.05),
    "20_environment": ("a solve of its own", lambda names: names["steps"] == 40 and reward_differs(names) < 1e-6),
    "21_own_energy": ("a load in its place", lambda names: names["error"] < 1e-9 and names["moved"] > 0.01),
    "22_grasp": ("balance", lambda names: names["error"] < 1e-5 and names["pull"].peak > 1.0),
    "23_scan": ("volume of an ellipsoid", lambda names: 0.98 < names["volume"] / names["true"] < 1.0),
    "24_learn_and_certify": ("a fresh solve", lambda names: certificate_differs(names) < 1e-6 and names["left"] < 1e-3),
    "25_motors": ("a step of the clock at 16 mm/s", lambda names: names["error"] < 0.016 / 30),
    "26_torch": ("hidden modulus", lambda names: abs(names["young"] / names["true"] - 1) < 1e-4),
    "27_policy": ("its environment", lambda names: names["error"] < 3e-3 and policy_differs(names) < 1e-6),
    "28_hysteresis": ("none without sliders", lambda names: keeps_a_bend(names) and names["work"].sum() > 0.02),
}
"""Number of each example: its oracle, and whether it holds."""


NEEDS = {
    "20_environment": "gymnasium",
    "24_learn_and_certify": "torch",
    "26_torch": "torch",
    "27_policy": "gymnasium",  # for its oracle
}
"""Packages of extras that examples need."""


def fits_the_robot(kit: hs.Kit) -> bool:
    """Tell whether cables are cut for the robot's lengths, and the pattern is as large as its mesh and a seam."""
    cuts = list(csv.DictReader(StringIO(kit.files["lists/cable_cuts.csv"].decode())))
    lengths = [float(cut["body [mm]"]) for cut in cuts]
    lines = ezdxf.read(StringIO(kit.files["pattern/pattern.dxf"].decode())).modelspace()
    panel = max((ezdxf.bbox.extents([line]).size for line in lines), key=lambda size: size.x * size.y)
    seams = np.array([panel.x, panel.y]) - 1e3 * np.ptp(kit.robot.body.mesh.nodes, axis=0)
    exact = all(abs(1e3 * cable.length - cut) < 0.06 for cable, cut in zip(kit.robot.cables, lengths, strict=True))
    return exact and bool((seams > 0).all()) and bool((seams < 40).all())


def reward_differs(names: dict[str, Any]) -> float:
    """Difference of the last reward from that of the markers of a fresh solve, in tolerances."""
    env, seen = names["environment"], names["observation"]
    least, most = np.array([(-winch.release, winch.travel) for winch in env.robot.winches]).T
    contractions = least + (seen["observation"] + 1) / 2 * (most - least)
    markers = np.array(list(Simulation(env.robot).solve(contractions).markers.values()))
    goals = (env.rest + env.unit * seen["desired_goal"]).reshape(markers.shape)
    return float(abs(names["rewards"][-1] + np.linalg.norm(markers - goals, axis=1).mean() / env.options.tolerance))


def policy_differs(names: dict[str, Any]) -> float:
    """Difference of the error from that in the environment that the policy was trained in [m]."""
    from hydrostat.training import ReachEnv, ReachOptions

    env = ReachEnv(names["robot"], options=ReachOptions(steps=10, incremental=True))
    seen, told = env.reset(options={"goal": names["goal"].ravel()})
    for _ in range(10):
        seen, _, _, _, told = env.step(names["policy"].act(seen))
    return float(abs(told["distance"] - names["error"]))


def certificate_differs(names: dict[str, Any]) -> float:
    """Difference of the certified error of the networks' answer from that of a fresh solve [m]."""
    pose = names["simulation"].solve(names["answer"].contractions)
    return float(abs(np.linalg.norm(pose.markers["left"] - [-0.105, 0.052]) - names["sure"].certified["left"]))


def keeps_a_bend(names: dict[str, Any]) -> bool:
    """Tell whether loop and bend are those of the sliders: none without, no slack cable pulls, figures of the page."""
    before, after, tips = names["without"][:10], names["without"][:10:-1], names["elastic_tips"]
    page = (Path(__file__).parents[2] / "docs" / "materials.md").read_text(encoding="utf-8")
    share, moves = names["work"].sum() / names["work"][:10].sum(), names["moves"]
    assert f"{share:.0%} of the work is lost".replace("%", " %") in page
    assert f"{moves[-1]:.1f} of\n{moves.max():.1f} mm" in page
    back = float(np.ptp(tips[[0, -1]], axis=0).max())
    return max(float(np.abs(before - after).max()), names["tensions"][-1]) < 1e-6 and back < 1e-9


def work_without(names: dict[str, Any]) -> float:
    """Area of the loop without friction [J]."""
    bare = replace(names["robot"], cables=tuple(replace(cable, friction=0.0) for cable in names["robot"].cables))
    tensions = names["tension_on_the_way"](Simulation(bare))
    return float((tensions[1:] + tensions[:-1]) / 2 @ np.diff(names["there_and_back"]))


def feet_differ(names: dict[str, Any]) -> float:
    """Difference in height of the feet, from the markers of a new solve [m]."""
    again = Simulation(names["simulation"].robot).solve(names["found"].pose.contractions)
    return float(abs(again.markers["left_foot"][1] - again.markers["right_foot"][1]))


def test_every_example_is_held() -> None:
    assert [path.stem for path in EXAMPLES] == list(HELD)


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, unchecked: None) -> None:
    if path.stem in NEEDS:
        pytest.importorskip(NEEDS[path.stem])
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        names: dict[str, Any] = {"__name__": "example"}  # without a `__file__`, as the site runs them
        exec(compile(path.read_bytes(), path, "exec"), names)
    oracle, holds = HELD[path.stem]
    assert holds(names), oracle
    names["figure"].savefig(tmp_path / "figure.png", dpi=40)
    assert not set(tmp_path.iterdir()) - {tmp_path / "figure.png"}  # it leaves nothing else
    assert 8 <= len(path.read_text(encoding="utf-8").splitlines()) <= 70
