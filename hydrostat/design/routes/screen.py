"""`screen_sketches`: sketches refined in rounds, each for fewer of them."""

from collections.abc import Callable, Sequence
from contextlib import closing

from hydrostat.design.routes.evaluator import Trial
from hydrostat.design.routes.growth import Growth, unlike
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.search_rules import RULES


def screen_sketches(
    growth: Growth, drawn: Sequence[Layout], *, found: Callable[[Trial], None] = lambda _: None, count: int
) -> list[Trial]:
    """Refine sketches by a few steps, the best ones by some more, and return the best `count` of them.

    Sketches come in the order of the linear model. Those that are left are not solved after several in a row were no
    better than the best by a few percent. `found` receives each network that is solved.
    """

    def solve(layout: Layout) -> Trial | None:
        trial = growth.evaluator.reach_poses(layout, None, iterations=RULES.screen_ik_steps, rough=True)
        return trial and growth.refine_briefly(trial, directions=0, steps=RULES.screen_steps)

    rough: list[Trial] = []
    least, idle = float("inf"), 0
    with closing(growth.evaluator.keep_each("sketch", solve, drawn)) as trials:
        for trial in trials:
            if trial is None:
                continue
            rough.append(trial)
            found(trial)
            idle = 0 if trial.cost < (1 - RULES.screen_gain) * least else idle + 1
            least = min(least, trial.cost)
            if idle >= RULES.max_stalled_sketches:
                break
    kept = unlike(rough, count)
    better = growth.refine_each(kept[: RULES.screen_kept], directions=0, steps=RULES.screen_more_steps)
    for trial in better:
        found(trial)
    return [*better, *kept[RULES.screen_kept :]]
