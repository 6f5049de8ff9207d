"""`StageCallback`: callback that reports the networks found in a search; `Progress` reports how far it is."""

from collections.abc import Callable

from hydrostat.design.network import DesignStage

StageCallback = Callable[[DesignStage], None]  # called with each better network


def ignore_stage(stage: DesignStage) -> None:
    """Nobody watches."""


class Better:
    """Passes on what has a smaller error than all before."""

    def __init__(self, watch: StageCallback) -> None:
        self._watch, self._least = watch, float("inf")

    def __call__(self, stage: DesignStage) -> None:
        """Hear of a network."""
        if stage.error < self._least:
            self._least = stage.error
            self._watch(stage)
