"""Lists that the compiled core takes as places. Oracle: a wrong one is a ValueError and writes nothing outside.

The calls are those of a body's analysis, Hessian and solve; then one number of one list is wrong.
"""

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
import pytest
from builders import box_mesh, strip_mesh

from hydrostat.geometry import Mesh
from hydrostat.kernel import native
from hydrostat.mechanics import Assembly, NeoHookean, supernodal
from hydrostat.mechanics.ordering import graph_coordinates

LISTS = {
    "value": {1: "a corner is no node"},
    "gradient": {1: "a corner is no node"},
    "turn": {2: "a corner is no node"},
    "hessian": {1: "a corner is no node", 8: "outside the matrix", 9: "longer than the matrix"},
    "block_graph": {0: "no such entries", 1: "in no row"},
    "distances": {0: "no such neighbors", 1: "no node"},
    "dissect": {0: "no such neighbors", 1: "no node", 3: "no such node", 7: "-1 before", 8: "0 before"},
    "elimination_tree": {0: "no such neighbors", 1: "no node", 2: "no such node", 3: "no such place", 5: "ancestor"},
    "column_counts": {0: "no such neighbors", 1: "no node", 2: "no such node", 3: "no such place", 4: "no such parent"},
    "postorder": {1: "no such child", 2: "no such sibling"},
    "merge": {0: "no such child", 1: "siblings", 4: "no such supernode"},
    "rows": {
        0: "a node has",
        1: "no node",
        2: "no such node",
        3: "no such place",
        4: "a supernode has",
        5: "no such child",
        6: "siblings do not rise",
        7: "a supernode has|sizes",
    },
    "stacks": {1: "a parent comes before"},
    "runs": {1: "a parent comes before"},
    "entries": {1: "degree of freedom", 2: "no such entries", 3: "in no row", 4: "no such place", 5: "no such column"},
    "factorise": {2: "no such runs", 3: "no such entries", 4: "a diagonal lies"},
    "factorise_together": {2: "no such runs", 3: "no such entries", 4: "a diagonal lies"},
    "solve": {1: "no degree of freedom", 2: "no such place"},
}
"""Places of lists in the arguments of each function, and a part of the message."""

TABLES = {"stacks": (5, 7), "runs": (1, 4), "entries": (0, 1, 2, 4), "solve": (0, 1, 2, 3, 4)}
TABLES |= dict.fromkeys(("factorise", "factorise_together"), range(11))
"""Columns of the table of fronts (fronts.py) that each function uses."""

GUARD = 512
"""Numbers before and behind each array."""

WRONG = -2, 10**9, 2**62, -(2**63)
MESHES = {"flat": strip_mesh(24, 6), "space": box_mesh((9, 4, 3))}
CALLS = [(name, place) for name, places in LISTS.items() for place in places]


def analyze(mesh: Mesh, patch: pytest.MonkeyPatch) -> None:
    """Make each call once."""
    elastic, none = NeoHookean(mesh.nodes, mesh.elements, mu=3e4, lame=1e5), np.zeros(0)
    assembly = Assembly([elastic], rest=mesh.nodes, control_count=0)
    assembly.value(mesh.nodes, none)
    assembly.gradient(mesh.nodes, none)
    matrix = assembly.hessian(mesh.nodes, none)
    matrix.data[assembly.pattern.diagonal] *= 1.1
    native.turn(mesh.nodes, 0.1 * mesh.nodes, *elastic._groups, np.zeros_like(mesh.nodes))
    analysis = assembly.pattern.analysis
    analysis.factorize(matrix.data).solve(np.ones((assembly.size, 3)))
    patch.setattr(supernodal, "THREADED_SECONDS", 0.0)
    patch.setattr(supernodal, "THREADS", 3)
    analysis.factorize(matrix.data)
    starts = np.append(0, np.cumsum(np.full(4, 2)))
    graph_coordinates(starts, np.array([1, 3, 0, 2, 1, 3, 2, 0]), 2)  # a ring


def copied(given: tuple) -> list:
    """Arguments in arrays of their own, amid numbers that no call may change."""
    return [_amid(each) if isinstance(each, np.ndarray) else each for each in given]


def _amid(array: np.ndarray) -> np.ndarray:
    wide = np.full(array.size + 2 * GUARD, 77, array.dtype)
    wide[GUARD : GUARD + array.size] = array.ravel()
    return wide[GUARD : GUARD + array.size].reshape(array.shape)


def assert_untouched(given: list) -> None:
    for array in (each for each in given if isinstance(each, np.ndarray)):
        wide = array.base if array.base.ndim == 1 else array.base.base
        assert (wide[:GUARD] == 77).all()
        assert (wide[-GUARD:] == 77).all()


@pytest.fixture(scope="module", params=MESHES)
def calls(request: pytest.FixtureRequest) -> dict[str, tuple[Callable, tuple]]:
    """First call of each function: the function and copies of its arguments."""
    found: dict[str, tuple[Callable, tuple]] = {}

    def watched(name: str, function: Callable) -> Callable:
        def call(*given: Any) -> Any:
            if name not in found:
                found[name] = function, tuple(each.copy() if isinstance(each, np.ndarray) else each for each in given)
            return function(*given)

        return call

    with pytest.MonkeyPatch.context() as patch:
        for name in LISTS:
            patch.setattr(native, name, watched(name, getattr(native, name)))
        patch.setattr(supernodal, "THREADS", 1)
        analyze(MESHES[request.param], patch)
    return found


def numbers(array: np.ndarray) -> list[int]:
    """Places in a list: the first, the last and some between."""
    return sorted({0, array.size - 1, *np.random.default_rng(0).integers(0, array.size, 4).tolist()})


@pytest.mark.parametrize(("name", "place"), CALLS)
def test_a_wrong_list_is_refused(calls: dict, name: str, place: int) -> None:
    function, given = calls[name]
    for at, wrong in product(numbers(given[place]), WRONG):
        changed = copied(given)
        info = np.iinfo(given[place].dtype)
        changed[place].flat[at] = min(max(wrong, info.min), info.max)
        with pytest.raises(ValueError, match=LISTS[name][place]):
            function(*changed)
        assert_untouched(changed)


@pytest.mark.parametrize(("name", "column"), [(name, column) for name, columns in TABLES.items() for column in columns])
def test_a_wrong_table_of_fronts_is_refused(calls: dict, name: str, column: int) -> None:
    function, given = calls[name]
    for at, wrong in product({0, (len(given[0]) - 1) // 2, len(given[0]) - 2}, WRONG):
        changed = copied(given)
        changed[0][at, column] = wrong
        with pytest.raises(ValueError, match=r"\w"):
            function(*changed)
        assert_untouched(changed)


def test_right_lists_are_taken(calls: dict) -> None:
    """The calls themselves, in arrays of which nothing around is changed."""
    assert set(calls) == set(LISTS)
    for function, given in calls.values():
        same = copied(given)
        function(*same)
        assert_untouched(same)


@pytest.mark.parametrize("name", ["factorise", "factorise_together", "solve"])
def test_lists_that_are_too_short_are_refused(calls: dict, name: str) -> None:
    """Every array, one number or row short at its end or without any."""
    function, given = calls[name]
    for place, array in enumerate(given):
        for length in {0, len(array) - 1} if isinstance(array, np.ndarray) else ():
            changed = copied(given)
            changed[place] = _amid(array[:length])
            with pytest.raises(ValueError, match=r"\w"):
                function(*changed)
            assert_untouched(changed)
