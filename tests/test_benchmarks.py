"""The benchmarks that `make bench` runs. Oracle: their own arguments, as they stand in their text."""

import ast
import re
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


def test_make_bench_runs_what_needs_no_arguments() -> None:
    need = {file.stem for file in (_TOP / "benchmarks").glob("*.py") if _need_arguments(file.read_text())}
    found = re.search(r"^NEED_MORE := (.*)$", (_TOP / "Makefile").read_text(), re.M)
    assert found
    left_out = set(found[1].split())
    assert {"learned_ik", "sample_starts", "spool_layers"} <= need <= left_out
    assert all((_TOP / "benchmarks" / f"{name}.py").is_file() for name in left_out)
