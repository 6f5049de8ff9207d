"""`matched`: which entries of a file are still which, after a robot has changed."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any


def matched(old: Sequence[Mapping[str, Any]], new: Sequence[Mapping[str, Any]]) -> dict[int, int]:
    """Number of the old entry of each new one that has one: by name, else the same, else the most alike.

    Args:
        old: what the keys of each entry meant.
        new: what they mean now.
    """
    pairs: dict[int, int] = {}
    for likeness in (_same_name, _same, _alike):
        ranked = sorted(_ranked(old, new, pairs, likeness))
        for _, _, after, before in ranked:
            if after not in pairs and before not in pairs.values():
                pairs[after] = before
    return pairs


def _ranked(
    old: Sequence[Mapping[str, Any]], new: Sequence[Mapping[str, Any]], pairs: Mapping[int, int], likeness: Any
) -> Iterator[tuple[float, int, int, int]]:
    """Pairs that may belong together, the most likely and then the nearest in order first."""
    taken = set(pairs.values())
    for after, entry in enumerate(new):
        for before, other in enumerate(old):
            if after not in pairs and before not in taken:
                share = likeness(other, entry)
                if share > 0:
                    yield -share, abs(after - before), after, before


def _same_name(old: Mapping[str, Any], new: Mapping[str, Any]) -> float:
    return float(bool(new.get("name")) and old["name"] == new["name"])


def _same(old: Mapping[str, Any], new: Mapping[str, Any]) -> float:
    return float(old == new)


def _alike(old: Mapping[str, Any], new: Mapping[str, Any]) -> float:
    """Share of what two entries have in common; places weigh most, as many entries have the same numbers."""
    both = [key for key in new if new[key] is not None and old.get(key) is not None]
    places = [key for key in both if key in ("at", "box", "points", "targets")]
    if not places:
        return 0.0 if ("at" in new or "box" in new) else 1.0
    common = [_overlap(old[key], new[key]) for key in places]
    others = [key for key in new if key not in places]
    equal = sum(old.get(key) == new[key] for key in others) / max(len(others), 1)
    return sum(common) / len(common) + 0.1 * equal


def _overlap(old: Any, new: Any) -> float:
    """Share of the numbers or points of two values that are the same."""
    if isinstance(new, Mapping):
        return sum(old.get(key) == value for key, value in new.items()) / max(len(old), len(new), 1)
    if old == new:
        return 1.0
    return sum(entry in old for entry in new) / max(len(old), len(new), 1)
