"""`EnvCopies`: copies of an environment, here or in a process of their own; light to import, as processes do it."""

import signal
from collections.abc import Mapping
from copy import deepcopy
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from hydrostat.errors import HydrostatError
from hydrostat.training.goal_env import GoalEnv


class EnvCopies:
    """Copies of an environment, one after another."""

    def __init__(self, env: GoalEnv, count: int) -> None:
        """So many."""
        self._envs, self._answer = [deepcopy(env) for _ in range(count)], list[Any]()
        for each in self._envs:
            each.render_mode = None  # a page for each would be no help to anybody

    def ask(self, name: str, *given: Any) -> None:
        """Do what is called so with something for each copy, if anything is given."""
        rows = zip(*given, strict=True) if given else [()] * len(self._envs)
        self._answer = [getattr(self, f"_{name}")(env, *row) for env, row in zip(self._envs, rows, strict=True)]

    def answer(self) -> list[Any]:
        """Return the outcome of the step."""
        return self._answer

    def close(self) -> None:
        """Nothing is open."""

    @staticmethod
    def _reset(env: GoalEnv, seed: int | None) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
        return env.reset(seed=seed)

    @staticmethod
    def _step(env: GoalEnv, action: np.ndarray) -> tuple[dict[str, np.ndarray], float, bool, dict[str, Any]]:
        seen, reward, _, over, info = env.step(action)
        told = {**info, "TimeLimit.truncated": over}
        if over:
            told["terminal_observation"] = seen
            seen, _ = env.reset()
        return seen, float(reward), over, told

    @staticmethod
    def _get_state(env: GoalEnv) -> dict[str, Any]:
        return env.get_state()

    @staticmethod
    def _go_on(env: GoalEnv, kept: Mapping[str, Any]) -> None:
        env.go_on(kept)


class RemoteEnvCopies:
    """Copies of an environment in a process of their own."""

    def __init__(self, env: GoalEnv, count: int) -> None:
        """So many, in a new process."""
        context = get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(theirs, env, count), daemon=True)
        self._process.start()
        theirs.close()

    def ask(self, name: str, *given: Any) -> None:
        """Have it done (HydrostatError: the process has died)."""
        try:
            self._pipe.send((name, given))
        except OSError:
            raise HydrostatError(_DIED) from None

    def answer(self) -> list[Any]:
        """Wait for what came of it (HydrostatError: it has died, or what it met)."""
        try:
            done, error = self._pipe.recv()
        except (EOFError, OSError):
            raise HydrostatError(_DIED) from None
        if error is not None:
            raise error
        return done

    def close(self) -> None:
        """End the process."""
        self._pipe.close()
        timeout = 5.0  # Seconds that a process has to end by itself
        self._process.join(timeout)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def _work(pipe: Connection, env: GoalEnv, count: int) -> None:
    """Do what is asked until nobody asks any more; Ctrl-C is for the one who asks."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    copies = EnvCopies(env, count)
    while True:
        try:
            name, given = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            copies.ask(name, *given)
            told = copies.answer(), None
        except HydrostatError as error:
            told = [], error
        try:
            pipe.send(told)
        except OSError:  # nobody waits for it any more
            return


_DIED = "a process that solves for poses has died; train again, with resume, to go on from the last checkpoint"
