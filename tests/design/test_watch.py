"""Networks told of on the way. Oracles: the stages that the design keeps; errors of all that were judged."""

import pytest
from builders import strip_robot
from test_design_routes import DOWN, SMALL, UP, bare
from test_judge import POSES, shifted

from hydrostat.design import DesignStage, RouteTrace, design_cables
from hydrostat.design.network import Better
from hydrostat.design.trees.judge_robots import judge
from hydrostat.progress import no_progress


def test_routes_tell_each_stage_that_is_better_than_all_before(unchecked: None) -> None:
    told: list[DesignStage] = []
    network = design_cables(bare(), [UP], winches=1, cables=1, options=SMALL, watch=told.append)
    assert isinstance(network.trace, RouteTrace)
    least, expected = float("inf"), []
    for stage in network.trace.stages:
        if stage.error < least:
            least, expected = stage.error, [*expected, stage]
    assert told == expected
    assert len(told) > 1


def test_a_second_search_tells_only_what_is_better_than_the_first(unchecked: None) -> None:
    """Oracle: the errors that are reported; with two cables allowed and one used, fewer cables are searched too."""
    told: list[DesignStage] = []
    design_cables(bare(), [UP], winches=1, cables=2, options=SMALL, watch=told.append)
    errors = [stage.error for stage in told]
    assert errors == sorted(set(errors), reverse=True)


def test_the_watched_may_stop_the_search(unchecked: None) -> None:
    def stop(stage: DesignStage) -> None:
        raise KeyboardInterrupt

    network = design_cables(bare(), [UP, DOWN], winches=2, cables=2, options=SMALL, watch=stop)
    assert not network.complete


@pytest.mark.parametrize("tension", [100.0, 1e-3])
def test_judges_tell_what_is_better_and_bears_it(tension: float) -> None:
    robots = [shifted(-0.008), strip_robot(columns=10, rows=3), shifted(0.006)]
    told: list[DesignStage] = []
    judge(robots, POSES, tension=tension, progress=no_progress, watch=told.append)
    errors = [stage.error for stage in told]
    assert errors == sorted(set(errors), reverse=True)
    assert bool(told) is (tension == 100.0)


def test_better_passes_on_what_is_better() -> None:
    told: list[DesignStage] = []
    better = Better(told.append)
    stages = [DesignStage(words="", robot=bare(), error=error) for error in (3.0, 4.0, 2.0, 2.0, 1.0)]
    for stage in stages:
        better(stage)
    assert told == [stages[0], stages[2], stages[4]]
