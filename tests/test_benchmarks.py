"""The files that `make bench` and `make studies` run. Oracle: their own arguments, as they stand in their text."""

import ast
import re
import runpy
from pathlib import Path

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


def test_make_runs_benchmarks_that_need_no_arguments() -> None:
    files = {file.stem: file.read_text() for file in _TOP.glob("benchmarks/*.py")}
    found = re.search(r"^NEED_MORE := (.*)$", (_TOP / "Makefile").read_text(), re.M)
    assert found
    assert {name for name, text in files.items() if _need_arguments(text)} <= set(found[1].split()) <= set(files)


def test_each_study_runs_by_make_or_says_what_it_needs() -> None:
    runner = runpy.run_path(str(_TOP / "lab/run_studies.py"))
    by_make, by_hand = set(runner["STUDIES"]), set(runner["NEED_MORE"])
    texts = {file.relative_to(_TOP / "lab").with_suffix("").as_posix(): file for file in _TOP.glob("lab/*/*.py")}
    programs = {name: file.read_text() for name, file in texts.items() if "__main__" in file.read_text()}
    need = {name for name, text in programs.items() if _need_arguments(text)}
    assert {"learned_ik/learned_ik", "spool_layers/spool_layers"} <= need <= by_hand
    assert not by_make & by_hand
    assert by_make | by_hand == set(programs)
