"""`best_errors`, `on_front`: what more winches and more cables gain (F2)."""

from collections.abc import Iterable, Mapping

from hydrostat.design.network import Alternative, Network

Size = tuple[int, int]
"""Numbers of winches and of cables."""


def size_of(network: Alternative | Network) -> Size:
    """Numbers of winches and cables of a network."""
    return len(network.robot.winches), len(network.robot.cables)


def best_errors(alternatives: Iterable[Alternative], chosen: Network) -> dict[Size, float]:
    """The least error of each size [m], in order of the sizes; where the chosen network is, its own."""
    found: dict[Size, float] = {}
    for network in alternatives:
        found[size_of(network)] = min(network.rms_error, found.get(size_of(network), float("inf")))
    found[size_of(chosen)] = chosen.rms_error
    return dict(sorted(found.items()))


def on_front(size: Size, errors: Mapping[Size, float]) -> bool:
    """Whether no network of as few winches and as few cables has an error as small."""
    winches, cables = size
    others = [error for other, error in errors.items() if other != size and other[0] <= winches and other[1] <= cables]
    return all(error > errors[size] for error in others)
