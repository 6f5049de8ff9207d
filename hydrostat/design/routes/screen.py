"""`screen_sketches`: sketches refined in rounds, each for fewer of them."""

from collections.abc import Callable, Sequence
from contextlib import closing

from hydrostat.design.routes.bench import Trial
from hydrostat.design.routes.growth import Growth, unlike
from hydrostat.design.routes.layout import Layout


def screen_sketches(
    growth: Growth, drawn: Sequence[Layout], *, found: Callable[[Trial], None] = lambda _: None, count: int
) -> list[Trial]:
    """Refine sketches by a few steps, the best ones by some more, and return the best `count` of them.

    Sketches come in the order of the linear model. Those that are left are not solved after several in a row were no
    better than the best by a few percent. `found` receives each network that is solved.
    """

    def solve(layout: Layout) -> Trial | None:
        trial = growth.bench.reach_poses(layout, None, iterations=_GLANCE, rough=True)
        return trial and growth.refine_briefly(trial, directions=0, steps=_FIRST)

    rough: list[Trial] = []
    least, idle = float("inf"), 0
    with closing(growth.bench.map(solve, drawn)) as trials:
        for trial in trials:
            if trial is None:
                continue
            rough.append(trial)
            found(trial)
            idle = 0 if trial.cost < (1 - _BETTER) * least else idle + 1
            least = min(least, trial.cost)
            if idle >= _PATIENCE:
                break
    kept = unlike(rough, count)
    better = growth.refine_each(kept[:_KEPT], directions=0, steps=_SECOND)
    for trial in better:
        found(trial)
    return [*better, *kept[_KEPT:]]


_GLANCE = 5  # steps of inverse kinematics before a sketch is refined
_FIRST = 3  # steps of refinement of each
_SECOND = 2  # more steps of the best ones
_KEPT = 4  # sketches that get them
_PATIENCE = 6  # sketches in a row that are no better end the screening
_BETTER = 0.02  # a sketch that lowers the cost by less than this share is no better
