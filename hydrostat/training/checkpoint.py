"""Checkpoints of training: numbers alone (JSON, NumPy arrays, weights), so that no file of a folder can run code."""

import io
import json
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from warnings import catch_warnings

import numpy as np

from hydrostat.errors import InputError
from hydrostat.files import replace_file

COUNTS = ("num_timesteps", "_n_updates", "_episode_num")
"""Counters of a model of stable-baselines3 that its next step depends on."""

REPLAY_FILE, STATE_FILE, WEIGHTS_FILE = "experience.npz", "state.json", "weights.pt"


@contextmanager
def name_damage(path: Path) -> Iterator[None]:
    """Tell that what is read within is damaged, whatever the loaders of others say of it (InputError: it is)."""
    try:
        yield
    except Exception:  # noqa: BLE001 archives that were cut short raise what they like
        raise InputError(f"{path}: is missing or damaged; begin again, without --resume") from None


def save_checkpoint(model: Any, folder: Path) -> None:
    """Write all that the next step of a model of stable-baselines3 depends on into a folder.

    Args:
        model: off-policy model with hindsight experience replay; its environment is a `SideBySide`.
        folder: folder, made if need be.

    Raises:
        InputError: a file cannot be written.
    """
    import torch

    folder.mkdir(exist_ok=True)
    tensors = {name: getattr(model, name).detach() for name in _tensor_names(model)}
    content = io.BytesIO()
    torch.save({"parameters": model.get_parameters(), "tensors": tensors}, content)
    replace_file(folder / WEIGHTS_FILE, content.getvalue())
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, **_replay_arrays(model.replay_buffer))
    replace_file(folder / REPLAY_FILE, content.getvalue())
    state = {
        "counts": {name: getattr(model, name) for name in COUNTS},
        "numpy": np.random.get_state(legacy=False),  # noqa: NPY002
        "torch": torch.get_rng_state().tolist(),
        "actions": model.action_space.np_random.bit_generator.state,
        "copies": model.env.get_state(),
    }
    replace_file(folder / STATE_FILE, json.dumps(state, default=_as_json).encode())


def restore_checkpoint(model: Any, folder: Path) -> None:
    """Set a fresh model of stable-baselines3 to the state that `save_checkpoint` wrote.

    Args:
        model: model made with the same options as the one that was saved.
        folder: folder of the checkpoint. It may come from others: nothing in it is executed.

    Raises:
        InputError: a file is missing or damaged, or the folder holds pickles of an earlier version.
    """
    import torch

    if (folder / "state.pkl").exists():
        raise InputError(
            f"{folder}: holds a pickle, as an earlier version wrote; it could run code and is not read. "
            "Begin again, without --resume"
        )
    with name_damage(folder), catch_warnings(action="ignore"):  # PyTorch's, about another pickle
        kept = torch.load(folder / WEIGHTS_FILE, weights_only=True)
        model.set_parameters(kept["parameters"], exact_match=True, device="cpu")
        for name in _tensor_names(model):
            getattr(model, name).data.copy_(kept["tensors"][name])
        with np.load(folder / REPLAY_FILE, allow_pickle=False) as arrays:
            _fill_replay(_sized_replay(model, len(arrays["ep_start"])), arrays)
        state = json.loads((folder / STATE_FILE).read_text())
        for name in COUNTS:
            setattr(model, name, int(state["counts"][name]))
        state["numpy"]["state"]["key"] = np.array(state["numpy"]["state"]["key"], dtype=np.uint32)
        np.random.set_state(state["numpy"])  # noqa: NPY002
        torch.set_rng_state(torch.tensor(state["torch"], dtype=torch.uint8))
        model.action_space.np_random.bit_generator.state = state["actions"]
        model.env.go_on(state["copies"])


def drop_others(folder: Path) -> None:
    """Remove the other checkpoints beside one."""
    for old in folder.parent.glob("checkpoint-*"):
        if old != folder:
            shutil.rmtree(old)


def _tensor_names(model: Any) -> list[str]:
    """Attributes of a model that are tensors of their own, such as SAC's logarithm of the entropy's weight."""
    return list(model._get_torch_save_params()[1])


def _replay_arrays(buffer: Any) -> dict[str, np.ndarray]:
    """Arrays of a replay buffer, by the path of their attribute, and where it is written next."""
    arrays = {"at": np.array([buffer.pos, int(buffer.full)])}
    for name, value in vars(buffer).items():
        if isinstance(value, np.ndarray) and value.dtype != object:
            arrays[name] = value
        elif isinstance(value, dict):
            arrays |= {f"{name}/{key}": rows for key, rows in value.items() if isinstance(rows, np.ndarray)}
    return arrays


def _sized_replay(model: Any, rows: int) -> Any:
    """The model's replay buffer; a new one where it needs another number of rows, as where steps were added."""
    if rows != model.replay_buffer.buffer_size:
        model.replay_buffer = model.replay_buffer_class(
            rows * model.n_envs,
            model.observation_space,
            model.action_space,
            env=model.env,
            device=model.device,
            n_envs=model.n_envs,
            **model.replay_buffer_kwargs,
        )
    return model.replay_buffer


def _fill_replay(buffer: Any, arrays: Mapping[str, np.ndarray]) -> None:
    """Copy saved arrays into a fresh replay buffer of the same shape (KeyError, ValueError: of another)."""
    for name, rows in _replay_arrays(buffer).items():
        if name != "at":
            if rows.shape != arrays[name].shape:
                raise ValueError(name)
            rows[...] = arrays[name]
    position, full = arrays["at"].tolist()
    buffer.pos, buffer.full = int(position), bool(full)


def _as_json(value: Any) -> Any:
    """Convert NumPy arrays and numbers, for which JSON has no form, to lists and plain numbers."""
    return value.tolist()
