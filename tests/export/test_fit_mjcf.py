"""Fits of MuJoCo models: a model with a known other modulus, equilibria of MuJoCo in time, poses held out."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.export import fit_mjcf, mjcf_text
from hydrostat.export.mjcf_statics import MjcfStatics
from hydrostat.export.mjcf_tuning import MjcfTuning
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation


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
    assert found.after < 0.3 * found.before
    assert found.jacobian_after < found.jacobian_before
    assert found.tuning.young / own.tuning.young == pytest.approx(1 / 1.4, rel=0.05)
