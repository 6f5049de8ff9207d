"""`Progress` and `Watch`: callbacks that report the progress of a search, and the networks found on the way."""

from collections.abc import Callable

from hydrostat.design.network import DesignStage

Progress = Callable[[str, int, int], None]  # told the stage, how much of it is done, and how much there is


def silent(stage: str, done: int, total: int) -> None:
    """No progress wanted."""


Watch = Callable[[DesignStage], None]  # told a network on the way, each better than the ones told before


def unseen(stage: DesignStage) -> None:
    """Nobody watches."""


class Better:
    """Passes on what has a smaller error than all before."""

    def __init__(self, watch: Watch) -> None:
        self._watch, self._least = watch, float("inf")

    def __call__(self, stage: DesignStage) -> None:
        """Hear of a network."""
        if stage.error < self._least:
            self._least = stage.error
            self._watch(stage)
