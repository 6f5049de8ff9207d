"""Ways to learn a strip, side by side. Oracles: the simulator, the samples themselves, learning by hand."""

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel, LearnOptions, SamplePlan, Samples, learn_model, sample_robot, verify
from hydrostat_lab.compare import METHODS, WAYS, compare, targets_of

pytestmark = pytest.mark.usefixtures("unchecked")

OPTIONS = LearnOptions(members=2, width=24, depth=2, steps=400, inverse_steps=300, batch=32)


@pytest.fixture(scope="module")
def simulation() -> hs.Simulation:
    return hs.Simulation(strip_robot(columns=8, rows=2))


@pytest.fixture(scope="module")
def samples(simulation: hs.Simulation, tmp_path_factory: pytest.TempPathFactory) -> Samples:
    return Samples.read(
        sample_robot(SamplePlan.of_robot(simulation.robot, 80), tmp_path_factory.mktemp("learned")).path
    )


@pytest.fixture(scope="module")
def model(samples: Samples) -> LearnedModel:
    pytest.importorskip("torch")
    return learn_model(samples.first(60), options=OPTIONS)


@pytest.mark.slow
def test_ways_to_learn_side_by_side(samples: Samples, simulation: hs.Simulation, model: LearnedModel) -> None:
    """Oracles: the samples themselves, whose nearest are rolled out to where they were; learning by hand."""
    known, new = samples.first(60), samples.only(np.arange(60, 66))
    rows = {found.method: found for found in compare(simulation, known, new, METHODS, options=OPTIONS)}
    assert list(rows) == list(METHODS)
    assert all(found.distances.shape == (6, 1) and found.lost == 0 for found in rows.values())
    near = np.linalg.norm(known.markers[:, 0] - new.markers, axis=-1).min(axis=1)
    assert rows["1-NN"].distances[:, 0] == pytest.approx(near, abs=1e-9)
    means = {name: found.found.mean() for name, found in rows.items()}
    assert means["1-NN"] < means["constant"]
    assert means["1-NN, Jacobian"] < means["1-NN"]
    assert means["search"] < min(means[name] for name in ("constant", "1-NN", "ridge", "thesis"))
    assert all(means[way + ", step"] < means[way] for way in WAYS)
    assert means["search, steps"] <= means["search, step"]
    assert 0 < rows["search, step"].facts["steps"] <= 1
    assert [name for name, found in rows.items() if found.curve is not None] == ["thesis"]
    answer = verify(simulation, model, model.solve(targets_of(new)[0]))
    assert rows["search"].distances[0, 0] == pytest.approx(answer.error, rel=1e-6)
    with pytest.raises(InputError, match='unknown method "magic"'):
        next(compare(simulation, known, new, ["magic"]))
