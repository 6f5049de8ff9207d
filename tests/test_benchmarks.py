"""The files that `make bench` and `make studies` run. Oracle: their own arguments, as they stand in their text."""

import ast
import re
from pathlib import Path

import pytest

_TOP = Path(__file__).parents[1]


def _asks(call: ast.Call) -> bool:
    """Whether a parser wants an argument that has to be given."""
    given = {word.arg: word.value for word in call.keywords}
    name = call.args[0].value if call.args and isinstance(call.args[0], ast.Constant) else ""
    if str(name).startswith("-"):
        return isinstance(given.get("required"), ast.Constant)
    free = given.get("nargs")
    return not (isinstance(free, ast.Constant) and free.value in ("?", "*"))


def _need_arguments(text: str) -> bool:
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    return any(
        isinstance(call.func, ast.Attribute) and call.func.attr == "add_argument" and _asks(call) for call in calls
    )


@pytest.mark.parametrize(
    ("names", "folder", "known"),
    [
        ("NEED_MORE", "benchmarks", set()),
        ("STUDIES_NEED_MORE", "lab/*", {"learned_ik", "sample_starts", "spool_layers"}),
    ],
)
def test_make_runs_what_needs_no_arguments(names: str, folder: str, known: set[str]) -> None:
    files = {file.stem: file.read_text() for file in _TOP.glob(f"{folder}/*.py")}
    found = re.search(rf"^{names} := (.*)$", (_TOP / "Makefile").read_text(), re.M)
    assert found
    need, left_out = {name for name, text in files.items() if _need_arguments(text)}, set(found[1].split())
    assert known <= need <= left_out <= set(files)
