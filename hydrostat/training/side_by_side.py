"""`SideBySide`: copies of an environment that take their steps together, in this process or in several."""

import signal
from collections.abc import Mapping, Sequence
from copy import deepcopy
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from hydrostat.errors import HydrostatError, InputError
from hydrostat.training.goal_env import GoalEnv
from hydrostat.version import install_command


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


try:
    from stable_baselines3.common.vec_env import VecEnv
except ModuleNotFoundError as error:
    raise InputError(f"training needs {error.name}; install it: {install_command('rl')}") from None


class SideBySide(VecEnv):
    """Copies of an environment, for stable-baselines3; what they do does not depend on how many processes work.

    Each copy has a generator of its own, begun with the seed and its number.
    """

    def __init__(self, env: GoalEnv, count: int, *, processes: int = 1) -> None:
        """So many copies of an environment, shared by some processes; with one, all is done in this."""
        made = EnvCopies if processes == 1 else RemoteEnvCopies
        self._env, self._parts = env, np.array_split(np.arange(count), processes)
        self._workers = [made(env, len(part)) for part in self._parts]
        super().__init__(count, env.observation_space, env.action_space)

    @property
    def equilibria(self) -> int:
        """Equilibria of the exact simulator that learning has cost in all copies."""
        return sum(kept["equilibria"] - kept["uncounted"] for kept in self.get_state())

    def get_state(self) -> list[dict[str, Any]]:
        """State that the next episodes depend on, of each copy."""
        return self._all("get_state", [()] * len(self._parts))

    def go_on(self, kept: Sequence[Mapping[str, Any]]) -> None:
        """Go on where copies were when they were kept."""
        self._all("go_on", [([kept[index] for index in part],) for part in self._parts])
        self._reset_seeds()  # or the next episodes would begin as the first

    def reset(self) -> dict[str, np.ndarray]:
        """Begin an episode in each copy."""
        rows = self._all("reset", [([self._seeds[index] for index in part],) for part in self._parts])
        self._reset_seeds()
        self._reset_options()
        self.reset_infos = [info for _, info in rows]
        return _stack_rows([seen for seen, _ in rows])

    def step_async(self, actions: np.ndarray) -> None:
        """Begin a step of each copy."""
        for worker, part in zip(self._workers, self._parts, strict=True):
            worker.ask("step", actions[part])

    def step_wait(self) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Wait for what came of it; copies whose episode is over have begun the next."""
        rows = [row for worker in self._workers for row in worker.answer()]
        seen, rewards, over, infos = zip(*rows, strict=True)
        return _stack_rows(seen), np.array(rewards, dtype=np.float32), np.array(over), list(infos)

    def close(self) -> None:
        """End the processes."""
        for worker in self._workers:
            worker.close()

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **more: Any) -> list[Any]:
        """Call a method that depends on no episode, such as compute_reward: once, for all."""
        return [getattr(self._env, method_name)(*args, **more)] * len(list(self._get_indices(indices)))

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Facts that are the same in all copies."""
        return [getattr(self._env, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: copies stay as they were made (NotImplementedError)."""
        raise NotImplementedError(f"{attr_name} of environments side by side cannot be set")

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Copies are as they are."""
        return [False] * len(list(self._get_indices(indices)))

    def _all(self, name: str, rows: Sequence[tuple[Any, ...]]) -> list[Any]:
        """Ask all workers at once; their answers, one for each copy."""
        for worker, row in zip(self._workers, rows, strict=True):
            worker.ask(name, *row)
        return [each for worker in self._workers for each in worker.answer()]


def _stack_rows(rows: Sequence[Mapping[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Observations of all copies, a row each."""
    return {name: np.stack([row[name] for row in rows]) for name in rows[0]}
