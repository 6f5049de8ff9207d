"""`ModelCard`: the robot, the samples and the training of a learned model, as its file records them."""

import sys
from collections.abc import Mapping
from dataclasses import MISSING, asdict, dataclass, fields
from typing import Any

from hydrostat.learning.known_contact import KnownContact, contact_in_model
from hydrostat.learning.portable_file import check_fact


@dataclass(frozen=True, kw_only=True)
class ModelCard:
    """Metadata of a learned model. In the file, each value has the name of its field.

    Attributes:
        robot: name of the robot.
        physics: SHA-256 hash of the robot, from `physics_hash`.
        draws: sampling schemes, which take turns from sample to sample.
        winches: winch names, in the order of the contractions.
        markers: marker names, in the order of the coordinates.
        cables: cable names, in the order of the tensions.
        dim: number of dimensions, 2 or 3.
        node_count: number of mesh nodes.
        size: size of the body [m].
        pairs: winch names of each antagonistic pair, and of each winch without a partner. Empty unless
            `SamplingScheme.ANTAGONIST` drew every sample.
        contact: True if the samples include self-contact.
        contact_distance: distance at which contact begins [m]; None without contact.
        contact_friction: Coulomb friction coefficient of the contact; None without contact.
        version: version of hydrostat that trained the model.
        samples: number of samples.
        lost: number of samples without a stable equilibrium or its derivatives.
        error: mean marker error of the forward networks on held-out samples [m].
        inverse_error: mean marker error of the inverse network on held-out samples [m]; None without one.
        displacement: mean distance of the markers from their mean position in the samples [m].
        stopped: True if training was interrupted.
        options: values of the `LearnOptions` fields that this version had.
        seconds: CPU time of the training [s].
        corrected: number of samples that `correct_model` used; None if it was not called.
        policy: training method of the policy that replaces the inverse network; None without a policy.
    """

    robot: str
    physics: str
    draws: tuple[str, ...]
    winches: tuple[str, ...]
    markers: tuple[str, ...]
    cables: tuple[str, ...]
    dim: int
    node_count: int
    size: float
    pairs: tuple[tuple[str, ...], ...] = ()
    contact: bool
    contact_distance: float | None = None
    contact_friction: float | None = None
    version: str
    samples: int
    lost: int
    error: float
    inverse_error: float | None = None
    displacement: float
    stopped: bool
    options: Mapping[str, Any]
    seconds: float
    corrected: int | None = None
    policy: str | None = None

    @classmethod
    def from_json(cls, facts: Mapping[str, Any]) -> "ModelCard":
        """Return the card from the values in a file; keys of other versions are ignored.

        Raises:
            ValueError: a value is missing, of the wrong type or out of range. The message names its key.
        """
        known: dict[str, Any] = {}
        for field in fields(cls):
            name, value = field.name, facts.get(field.name)
            if value is None and field.default is not MISSING:
                continue
            check_fact(name, value, _KINDS[name])
            known[name] = _parse(name, value)
        _check_names(known)
        return cls(**known | contact_in_model(known)._asdict())

    def as_json(self) -> dict[str, Any]:
        """Return the values by key, for the file."""
        return {name: _as_lists(value) for name, value in asdict(self).items() if value is not None or name in _NULL}

    @property
    def coordinates(self) -> int:
        """Number of marker coordinates."""
        return len(self.markers) * self.dim

    @property
    def known_contact(self) -> KnownContact:
        """Self-contact settings of the samples."""
        return KnownContact(self.contact, self.contact_distance, self.contact_friction)


def _as_lists(value: Any) -> Any:
    """Return tuples as lists, all the way down."""
    return [_as_lists(one) for one in value] if isinstance(value, tuple) else value


def _parse(name: str, value: Any) -> Any:
    """Return the value of a field (ValueError: a number out of range, or a list that does not hold names)."""
    if name == "pairs":
        return tuple(_parse_names(name, group) for group in value)
    if isinstance(value, list):
        return _parse_names(name, value)
    if isinstance(value, int | float) and not 0 <= value <= sys.float_info.max:
        raise ValueError(f'"{name}" is {value!r:.60}, not a number of 0 or more')
    return value


def _parse_names(name: str, value: Any) -> tuple[str, ...]:
    """Return a list of names as a tuple (ValueError: it is none)."""
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise ValueError(f'"{name}" does not hold names')
    return tuple(value)


def _check_names(known: Mapping[str, Any]) -> None:
    """Check that names are unique and pairs are of winches (ValueError: they are not, or dim is neither 2 nor 3)."""
    for name in ("winches", "markers", "cables"):
        if len(set(known[name])) != len(known[name]):
            raise ValueError(f'"{name}" holds a name twice')
    paired = [name for group in known.get("pairs", ()) for name in group]
    if len(set(paired)) != len(paired) or not set(paired) <= set(known["winches"]):
        raise ValueError("its pairs are none of its winches")
    if known["dim"] not in {2, 3}:
        raise ValueError(f'"dim" is {known["dim"]}, neither 2 nor 3')


_NUMBER = (int, float)

_KINDS: Mapping[str, Any] = {
    **dict.fromkeys(("robot", "physics", "version", "policy"), str),
    **dict.fromkeys(("draws", "winches", "markers", "cables", "pairs"), list),
    **dict.fromkeys(("dim", "node_count", "samples", "lost", "corrected"), int),
    **dict.fromkeys(("size", "contact_distance", "contact_friction"), _NUMBER),
    **dict.fromkeys(("error", "inverse_error", "displacement", "seconds"), _NUMBER),
    **dict.fromkeys(("contact", "stopped"), bool),
    "options": dict,
}
"""Kind of each fact in the file."""

_NULL = ("contact_distance", "contact_friction", "inverse_error")
"""Facts that the file holds as null; others of no value are left out."""
