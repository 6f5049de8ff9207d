"""`SideBySide`: copies of an environment that take their steps together, in this process or in several."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.training.env_copies import EnvCopies, RemoteEnvCopies
from hydrostat.training.goal_env import GoalEnv
from hydrostat.version import install_command

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
