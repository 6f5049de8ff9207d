"""The thesis's experiments with reinforcement learning. Oracles: numbers made by hand, the simulator itself."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot

torch = pytest.importorskip("torch")

from hydrostat.learning import LearnedModel, LearnOptions, SamplePlan, Samples, learn_model, sample_robot  # noqa: E402
from hydrostat.robot import Robot  # noqa: E402
from hydrostat.simulation import Simulation  # noqa: E402
from hydrostat_lab import experiments as room  # noqa: E402
from hydrostat_lab import reproduce_trials as command  # noqa: E402
from hydrostat_lab import run_experiment as runs  # noqa: E402
from hydrostat_lab.experiments import EXPERIMENTS, Ran, error, final, least, speed  # noqa: E402
from hydrostat_lab.hindsight_ddpg import Epochs, HindsightDdpg  # noqa: E402
from hydrostat_lab.run_experiment import certified_distances, exact_distances, exact_goals, finger_pairs  # noqa: E402
from hydrostat_lab.trials import NetworkReach  # noqa: E402

pytestmark = pytest.mark.usefixtures("unchecked")


@pytest.fixture(scope="module")
def robot() -> Robot:
    return strip_robot(columns=8, rows=2)


@pytest.fixture(scope="module")
def model(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> LearnedModel:
    folder = tmp_path_factory.mktemp("samples") / "strip"
    sample_robot(SamplePlan.of_robot(robot, 60), folder)
    return learn_model(Samples.read(folder), options=LearnOptions(steps=400, inverse_steps=10, width=24, members=1))


def test_networks_place_markers_as_the_model_does(model: LearnedModel) -> None:
    trials = NetworkReach(model)
    acts = torch.rand(1, 4, trials.actions, generator=torch.Generator().manual_seed(1)) * 2 - 1
    taken = trials.contractions(acts)[0].double().numpy()
    assert (taken >= model.low - 1e-9).all()
    assert (taken <= model.high + 1e-9).all()
    wanted = np.array([model.predict(row)[0][: trials.goals] for row in taken])
    np.testing.assert_allclose(trials.reach(acts)[0].numpy(), 100 * wanted, atol=1e-4)


def test_one_number_moves_the_one_or_the_other_winch(model: LearnedModel) -> None:
    trials = NetworkReach(model, groups=[(0, 1)])
    taken = trials.contractions(torch.tensor([[[0.5], [-0.25], [0.0]]]))[0].numpy()
    high = model.high.astype(np.float32)
    np.testing.assert_allclose(taken[:, :2], [[0.5 * high[0], 0], [0, 0.25 * high[1]], [0, 0]], rtol=1e-6)


def test_the_simulator_judges_where_contractions_lead(model: LearnedModel, robot: Robot) -> None:
    """Oracle: poses solved one by one from rest, for a policy of two seeds that always does the same."""
    simulation, trials = Simulation(robot), NetworkReach(model, groups=finger_pairs(model))
    acts = torch.full((2, 3, trials.actions), 0.3)

    asked = exact_goals(simulation, trials, 3)
    found = exact_distances(simulation, trials, lambda states, goals: acts, 2, asked)
    pose = simulation.solve(trials.contractions(acts)[0, 0].double().numpy())
    draw = torch.Generator().manual_seed(31_415)
    trials.begin(draw, (1, 3))
    rows = trials.contractions(2.0 * torch.rand(1, 3, trials.actions, generator=draw) - 1.0)[0].double().numpy()
    goals = [np.array(list(simulation.solve(row).markers.values())) for row in rows]
    wanted = [100 * np.linalg.norm(np.array(list(pose.markers.values())) - goal, axis=1).mean() for goal in goals]
    np.testing.assert_allclose(found, [wanted, wanted], rtol=1e-4)


def test_certified_answers_reach_the_same_goals(model: LearnedModel, robot: Robot) -> None:
    """Oracle: the goals are places that the robot has been in, so exact steps arrive; without them networks miss."""
    simulation, trials = Simulation(robot), NetworkReach(model, groups=finger_pairs(model))
    asked = exact_goals(simulation, trials, 3)
    rough, sure = (certified_distances(simulation, model, asked, steps=steps) for steps in (0, 3))
    assert sure.shape == (1, 3)
    assert 10.0 * sure.max() < 0.05 < 10.0 * rough.max()  # [mm]


def test_a_goal_that_is_no_equilibrium_is_lost_and_the_others_count(model: LearnedModel, robot: Robot) -> None:
    simulation, trials = Simulation(robot), NetworkReach(model, groups=finger_pairs(model))
    begun, goal = exact_goals(simulation, trials, 2)
    goal[0, 0] = torch.nan
    found = certified_distances(simulation, model, (begun, goal), steps=0)
    assert np.isnan(found).tolist() == [[True, False]]


def test_measures_by_hand() -> None:
    """Ten epochs of two seeds: the first succeeds from the fifth on, the second never."""
    success = np.zeros((10, 2))
    success[5:, 0] = 0.95
    tolerance = np.ones((10, 2))
    tolerance[7:, 0] = 0.9
    epochs = Epochs(actions=np.arange(10), success=success, distance=1.1 - success, tolerance=tolerance)
    ran = Ran(run=next(iter(EXPERIMENTS["figure-5.8"].runs.values())), epochs=epochs, best=np.full((2, 2, 4), 0.4))
    assert speed(ran).tolist() == pytest.approx([0.475, 0.0])
    assert final(ran).tolist() == pytest.approx([0.95, 0.0])
    assert least(ran).tolist() == [0.9, np.inf]
    assert error(ran).tolist() == pytest.approx([0.4, 0.4])


def test_every_claim_can_be_judged() -> None:
    """Oracle: runs of equal seeds; no claim fails on them, and each names runs that there are."""
    assert tuple(EXPERIMENTS) == command.TRIALS
    epochs = Epochs(actions=np.arange(3), success=np.ones((3, 2)), distance=np.ones((3, 2)), tolerance=np.ones((3, 2)))
    for experiment in EXPERIMENTS.values():
        done = {name: Ran(run=run, epochs=epochs, best=np.ones((10, 2, 4))) for name, run in experiment.runs.items()}
        for claim in experiment.claims:
            assert np.isfinite(claim.measure(done)).all()


def test_an_experiment_writes_its_table_picture_and_verdicts(
    model: LearnedModel,
    robot: Robot,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    model.save(tmp_path / "strip.model")
    short = EXPERIMENTS["table-noise"]
    runs = {
        name: replace(run, options=replace(run.options, cycles=2, updates=2, batch=16))
        for name, run in short.runs.items()
    }
    monkeypatch.setattr(room, "EXPERIMENTS", {"table-noise": replace(short, runs=runs)})
    much = command.HowMuch("minutes", seeds=2, epochs=3)
    command.reproduce_trials(["table-noise"], robot, tmp_path, much, model=tmp_path / "strip.model", jobs=1)
    told = capsys.readouterr().out
    assert "0.1 ends nearer than 0.01 (E47): " in told
    assert told.count("\nnoise 0") == 3
    kept = json.loads((tmp_path / "table-noise.json").read_text())
    assert len(kept["claims"]) == 2
    assert np.array(kept["runs"]["noise 0.1"]["success"]).shape == (3, 2)
    assert (tmp_path / "table-noise.png").stat().st_size > 10_000


def test_equal_runs_are_learned_once_and_episodes_are_shown(
    model: LearnedModel, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: counted runs, and the goals that the simulator was asked for."""
    options = replace(room.SMALL, cycles=1, updates=1, batch=4)
    run, other = (room.Run(options=options, horizon=2, random_start=start) for start in (True, False))
    learned = []
    monkeypatch.setattr(
        runs, "HindsightDdpg", lambda *given, **more: learned.append(1) or HindsightDdpg(*given, **more)
    )
    wait_for = runs.judge_runs([run, other, run], model, robot, seeds=2, epochs=lambda _: 1, goals=5)
    assert wait_for(other).shown["start"].any() == 0
    shown = wait_for(run).shown
    assert len(learned) == 2
    trials = NetworkReach(model, groups=finger_pairs(model), random_start=True)
    begun, wanted = exact_goals(Simulation(robot), trials, 5)
    for name, rows in (("start", begun), ("target", wanted)):
        reached = np.array([100 * np.ravel(list(Simulation(robot).solve(row).markers.values())) for row in shown[name]])
        np.testing.assert_allclose(reached, rows[0, :4].numpy(), atol=1.0)
