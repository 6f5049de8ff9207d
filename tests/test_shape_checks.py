"""Checks of shapes and types bite where they are meant to; oracle: calls that are plainly wrong, and a count."""

import ast
from inspect import getmodule, isfunction
from typing import Any

import numpy as np
import pytest
from builders import strip_mesh
from jaxtyping import Float, TypeCheckError
from shape_checks import CALLS, begin_test, checked, decorate, is_public

from hydrostat.geometry import Mesh, locate


@checked
def first_column(points: Float[np.ndarray, "points dim"]) -> Float[np.ndarray, " points"]:
    """Take the first column, or, wrongly, the whole of an array of three columns."""
    return points[:, 0] if points.shape[-1] == 2 else points


@pytest.fixture(autouse=True)
def fresh() -> None:
    """Check the first calls of a test again, also where this test began with many."""
    begin_test()


@pytest.mark.parametrize("wrong", [np.zeros(2), np.zeros((2, 2), dtype=int), [[0.0, 0.0]], None])
def test_a_wrong_argument_fails(wrong: Any) -> None:
    with pytest.raises(TypeCheckError, match="points"):
        first_column(wrong)


def test_a_wrong_answer_fails() -> None:
    with pytest.raises(TypeCheckError, match="return value"):
        first_column(np.zeros((4, 3)))


def test_what_agrees_passes() -> None:
    assert first_column(np.ones((4, 2))).tolist() == [1.0] * 4


def test_each_test_checks_the_first_calls() -> None:
    for _ in range(CALLS):
        first_column(np.ones((1, 2)))
    assert first_column(np.ones((1, 3))).shape == (1, 3)
    begin_test()
    with pytest.raises(TypeCheckError):
        first_column(np.ones((1, 3)))


def test_the_package_is_checked() -> None:
    mesh = strip_mesh(2, 1)
    with pytest.raises(TypeCheckError, match="elements"):
        Mesh(mesh.nodes, mesh.elements[0])
    with pytest.raises(TypeCheckError, match="points"):
        locate(mesh, mesh.nodes[0])


def test_what_is_private_is_called_as_it_is() -> None:
    assert hasattr(locate, "__wrapped__")
    anchors = getmodule(locate)
    private = [made for name, made in vars(anchors).items() if name.startswith("_") and isfunction(made)]
    assert private
    assert not any(hasattr(made, "__wrapped__") for made in private)


def test_methods_of_private_classes_are_called_as_they_are() -> None:
    source = "class _A:\n    def b(self): ...\n\nclass C:\n    def d(self): ...\n    def _e(self): ...\n"
    code = ast.parse(source)
    decorate(code.body)
    assert ast.unparse(code).split("@shape_checks.checked_public\n")[1:] == [
        "class C:\n\n    ",
        "    def d(self):\n        ...\n\n    def _e(self):\n        ...",
    ]


@pytest.mark.parametrize(("name", "public"), [("solve", True), ("__init__", True), ("_solve", False), ("_", False)])
def test_public_names(name: str, public: bool) -> None:
    assert is_public(name) == public
