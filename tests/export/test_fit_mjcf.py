"""Fits of MuJoCo models: a model with a known other modulus, equilibria of MuJoCo in time, poses held out."""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.errors import InputError
from hydrostat.export import fit_mjcf, mjcf_text
from hydrostat.export.mjcf_statics import MjcfStatics
from hydrostat.export.mjcf_tuning import MjcfTuning
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.sobol import draw_sobol
from hydrostat.units import plural


def _strip() -> Robot:
    """Strip whose soft cables pull little, so that its modulus counts and its strains are small."""
    robot = strip_robot(columns=12, rows=4)
    cables = tuple(replace(cable, smoothing=5e-5, stiffness=200.0) for cable in robot.cables)
    return replace(robot, cables=cables, winches=tuple(replace(winch, travel=0.01) for winch in robot.winches))


def test_numbers_of_a_tuning_are_in_the_model() -> None:
    robot = _strip()
    gains = np.full(len(robot.winches), 0.5)
    own, tuned = mjcf_text(robot), mjcf_text(robot, tuning=MjcfTuning(young=2.0, poisson=0.01, gains=gains))
    for name, factor in (("young", 2.0), ("gainprm", 0.5)):
        first, second = (float(text.split(f'{name}="')[1].split('"')[0]) for text in (own, tuned))
        assert second == pytest.approx(factor * first, rel=1e-8)
    assert mjcf_text(robot, tuning=MjcfTuning.none(robot)) == own


def test_a_fit_rejects_what_it_cannot_use() -> None:
    pytest.importorskip("mujoco")
    with pytest.raises(InputError, match="3 poses or more"):
        fit_mjcf(_strip(), 2)
    with pytest.raises(InputError, match="a share within 0 and 1"):
        fit_mjcf(_strip(), 5, share=1.5)
    with pytest.raises(InputError, match="needs a \\[\\[marker\\]\\]"):
        fit_mjcf(replace(_strip(), markers=(), poses={}), 5)


def _lossy(monkeypatch: pytest.MonkeyPatch, is_lost: Callable[[MjcfTuning, np.ndarray], bool]) -> None:
    """Let searches fail for some models and contractions."""

    class Lossy(MjcfStatics):
        def __init__(self, robot: Robot, simulation: Simulation, tuning: MjcfTuning) -> None:
            super().__init__(robot, simulation, tuning)
            self._tuning = tuning

        def find_markers(self, pose: Equilibrium, contractions: Vector, begin: Nodes) -> tuple[Points, Nodes] | None:
            return None if is_lost(self._tuning, contractions) else super().find_markers(pose, contractions, begin)

    monkeypatch.setattr(import_module("hydrostat.export.fit_mjcf"), "MjcfStatics", Lossy)


def test_lost_poses_are_counted_and_leave_errors_finite(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fitted model that loses held-out poses is judged on the others, and so is the unfitted one."""
    pytest.importorskip("mujoco")
    _lossy(monkeypatch, lambda tuning, contractions: tuning.young != 1.0 and contractions[0] > 0.007)
    found = fit_mjcf(_strip(), 4, share=1.0)
    assert found.num_lost > 0
    assert found.num_held_out + found.num_lost == 12
    lines = found.describe()
    assert f"{plural(found.num_lost, 'held-out pose')} lost: no equilibrium in one of the models" in lines
    assert not any(word in line for line in lines for word in ("inf", "nan"))


def test_poses_that_the_unfitted_model_loses_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    counts: dict[float, int] = {}

    def is_lost(tuning: MjcfTuning, contractions: np.ndarray) -> bool:
        """Fail the second search of poses that contract the first winch much."""
        counts[contractions[0]] = counts.get(contractions[0], 0) + 1
        return contractions[0] > 0.007 and counts[contractions[0]] > 1

    _lossy(monkeypatch, is_lost)
    found = fit_mjcf(_strip(), 6, share=1.0)
    assert found.num_left_out > 0
    assert found.num_poses + found.num_held_out + found.num_lost + found.num_left_out == 18
    _lossy(monkeypatch, lambda tuning, contractions: contractions[0] > 0.001)
    with pytest.raises(InputError, match=r"poses have no equilibrium in MuJoCo\. Fit a smaller share"):
        fit_mjcf(_strip(), 6, share=1.0)


def test_a_fit_without_common_poses_is_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    fitted = draw_sobol(2, 6, np.random.default_rng(0)) * [winch.travel for winch in _strip().winches]

    def is_lost(tuning: MjcfTuning, contractions: np.ndarray) -> bool:
        """Fail where a fitted model is held out."""
        return tuning.young != 1.0 and not np.isclose(fitted, contractions).all(axis=1).any()

    _lossy(monkeypatch, is_lost)
    with pytest.raises(InputError, match="no held-out pose has an equilibrium in both models"):
        fit_mjcf(_strip(), 6, share=1.0)


def test_held_out_poses_are_the_same_for_each_number_of_fitted_poses() -> None:
    """The unfitted model has equal errors, and no control is clamped for a Jacobian: it would be off by half."""
    pytest.importorskip("mujoco")
    first, second = (fit_mjcf(_strip(), number, share=1.0) for number in (3, 5))
    assert first.before == second.before
    assert (first.travel, first.num_held_out) == (second.travel, 12)
    assert first.after.jacobian_largest < 0.05


@pytest.mark.slow
def test_equilibria_are_those_in_which_mujoco_settles() -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = _strip()
    simulation, model = Simulation(robot), mujoco.MjModel.from_xml_string(mjcf_text(robot))
    contractions = np.array([1.0, 0.5]) * [winch.travel for winch in robot.winches]
    pose, data = simulation.solve(contractions), mujoco.MjData(model)
    found = MjcfStatics(robot, simulation).find_markers(pose, contractions, pose.nodes)
    data.ctrl[:] = contractions
    for _ in range(4000):
        mujoco.mj_step(model, data)
    assert found is not None
    assert found[0][0] == pytest.approx(data.site("marker tip").xpos[:2], abs=2e-5)


@pytest.mark.slow
def test_a_known_other_modulus_is_recovered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: MuJoCo gets a body that is 1.4 times as stiff; the fit must take that back, and the error must fall."""
    pytest.importorskip("mujoco")
    robot = replace(_strip(), gravity=(0.0, -9.81))  # its sag tells the modulus from the gains of the winches
    own = fit_mjcf(robot, 6, share=1.0)
    stiff = robot.with_material(young=1.4 * robot.body.material.young)

    def other(_: Robot, simulation: Simulation, tuning: MjcfTuning) -> MjcfStatics:
        return MjcfStatics(stiff, simulation, tuning)

    monkeypatch.setattr(import_module("hydrostat.export.fit_mjcf"), "MjcfStatics", other)
    found = fit_mjcf(robot, 6, share=1.0)
    assert found.is_worth_it
    assert found.after.rms < 0.3 * found.before.rms
    assert found.after.jacobian < found.before.jacobian
    assert found.tuning.young / own.tuning.young == pytest.approx(1 / 1.4, rel=0.05)
