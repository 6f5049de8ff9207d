"""Networks without torch. Oracles: differences, PyTorch in float64, SciPy's bounded least squares."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from hydrostat.learning.learn_options import LearnOptions
from hydrostat.learning.perceptrons import Perceptrons


def networks(sizes: tuple[int, ...], members: int, seed: int = 0) -> Perceptrons:
    draw = np.random.default_rng(seed)
    shape = np.array(sizes)
    numbers = 0.4 * draw.normal(size=(members, Perceptrons.count(shape)))
    return Perceptrons(sizes=shape, numbers=numbers)


@pytest.mark.parametrize("sizes", [(3, 13, 6, 5), (2, 4), (7, 17, 9)])
def test_slopes_are_those_of_the_values(sizes: tuple[int, ...]) -> None:
    """Oracle: central differences."""
    some, step = networks(sizes, 3), 1e-6
    point = np.random.default_rng(1).uniform(-1, 1, sizes[0])
    value, slopes = some.evaluate(point)
    assert value == pytest.approx(some.values(point).mean(axis=0), abs=1e-14)
    ways = step * np.eye(sizes[0])
    differences = [(some.values(point + way) - some.values(point - way)).mean(axis=0) / (2 * step) for way in ways]
    assert slopes == pytest.approx(np.array(differences).T, abs=1e-8)


@pytest.mark.filterwarnings("ignore:`torch.jit.script` is deprecated")
def test_the_kernel_is_what_was_trained() -> None:
    """Oracle: PyTorch in float64, its slopes by `torch.func.jacfwd`."""
    torch = pytest.importorskip("torch")
    from hydrostat.learning.train import answer, tensors_of

    some = networks((4, 33, 33, 7), 2)
    parts = tensors_of(some, torch.float64)
    points = np.random.default_rng(2).uniform(-1, 1, (20, 4))
    both = torch.tensor(points).expand(2, -1, -1)
    value, moved = answer(parts, both, torch.eye(4, dtype=torch.float64).expand(2, 20, 4, 4))
    assert moved is not None
    for place, point in enumerate(points):
        assert some.values(point) == pytest.approx(value[:, place].numpy(), abs=1e-12)
        agreed, spread = some.average_members(point)
        assert agreed == pytest.approx(value[:, place].mean(0).numpy(), abs=1e-6)
        assert spread == pytest.approx(value[:, place].numpy().std(axis=0), abs=1e-6)

        def mean(one: "torch.Tensor") -> "torch.Tensor":
            return answer(parts, one.expand(2, 1, 4), None)[0].mean((0, 1))

        slopes = torch.func.jacfwd(mean)(torch.tensor(point)).numpy()
        assert some.evaluate(point)[1] == pytest.approx(slopes, abs=1e-12)
        assert moved[:, place].mean(0).T.numpy() == pytest.approx(slopes, abs=1e-12)


@pytest.mark.parametrize("differentiated", [4, 6])
def test_gradients_of_the_loss(differentiated: int) -> None:
    """Oracle: central differences of the loss along random ways, values, slopes and tensions together."""
    torch = pytest.importorskip("torch")
    from hydrostat.learning.train import loss_weights, sobolev_loss, tensors_of

    draw = np.random.default_rng(3)
    some = networks((3, 8, 8, 6), 2)
    points, ways = torch.tensor(draw.normal(size=(2, 5, 3))), torch.tensor(draw.normal(size=(2, 5, 2, 3)))
    outputs, slopes = (
        torch.tensor(draw.normal(size=(2, 5, 6))),
        torch.tensor(draw.normal(size=(2, 5, differentiated, 3))),
    )

    def loss(numbers: np.ndarray, *, graph: bool = False) -> "tuple[torch.Tensor, list[torch.Tensor]]":
        parts = tensors_of(Perceptrons(sizes=some.sizes, numbers=numbers), torch.float64)
        for part in parts:
            part.requires_grad_(graph)
        weights = loss_weights(4, 6, LearnOptions(jacobians=0.7, tensions=0.3, tension_jacobians=0.2))
        return sobolev_loss(parts, points, ways, outputs, slopes, weights), parts

    value, parts = loss(some.numbers, graph=True)
    value.backward()
    gradient = torch.cat([part.grad.flatten(1) for part in parts if part.grad is not None], 1).numpy()
    for _ in range(5):
        way = draw.normal(size=some.numbers.shape)
        step = 1e-6
        above, below = (float(loss(some.numbers + sign * step * way)[0]) for sign in (1, -1))
        assert np.sum(gradient * way) == pytest.approx((above - below) / (2 * step), rel=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_a_descent_ends_at_an_optimum_within_limits(seed: int) -> None:
    """Oracle: SciPy's trust-region reflective search from the same start; goals out of reach, and narrow boxes, too."""
    some = networks((5, 16, 16, 8), 1, seed)
    draw = np.random.default_rng(100 + seed)
    weights = np.r_[np.ones(6), 0.0, 0.0]
    goal = some.values(draw.uniform(-1, 1, 5))[0] + (0.5 * (seed % 2)) * draw.normal(size=8)
    start = draw.uniform(-1, 1, 5)
    low, high = (np.full(5, -1.0), np.ones(5)) if seed < 4 else (np.minimum(start, -0.2), np.maximum(start, 0.1))
    found, left = some.descend(start, goal, weights, (low, high))
    assert ((low <= found) & (found <= high)).all()
    if seed < 4:
        assert np.array_equal(found, some.descend(start, goal, weights)[0])

    def residual(point: np.ndarray) -> np.ndarray:
        return weights * (some.values(point)[0] - goal)

    assert left == pytest.approx(np.square(residual(found)).sum(), rel=1e-9, abs=1e-20)
    begun = [np.clip(one, low + 1e-9, high - 1e-9) for one in (start, found)]
    best, further = (least_squares(residual, one, bounds=(low, high), xtol=1e-12, ftol=1e-12) for one in begun)
    assert left <= max(2 * further.cost, 1e-12) * 1.01, "nothing is to be gained from where it ended"
    assert left <= 4 * max(2 * best.cost, 1e-12) or left < 1e-3


def test_limits_hold_where_everything_pulls_beyond_them() -> None:
    """Oracle: a linear map, whose best point is a corner."""
    linear = Perceptrons(sizes=np.array([2, 2]), numbers=np.r_[np.eye(2).ravel(), 0, 0, 0, 0, 0, 0][None])
    found, left = linear.descend(np.zeros(2), np.array([3.0, -2.0]), np.ones(2))
    assert found == pytest.approx([1.0, -1.0], abs=1e-12)
    assert left == pytest.approx(4.0 + 1.0)
