"""Scripts outside the package. Oracle: the files and names that their imports ask for, looked up one by one."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

_TOP = Path(__file__).parents[1]
_SCRIPTS = sorted(
    file
    for folder in ("benchmarks", "docs", "lab", "native", "examples", "integrations")
    for file in (_TOP / folder).rglob("*.py")
)


def _top_level(node: ast.AST) -> Iterator[ast.AST]:
    """Nodes of a file that are not inside its functions and classes."""
    for child in ast.iter_child_nodes(node):
        yield child
        if not isinstance(child, ast.FunctionDef | ast.ClassDef | ast.Lambda):
            yield from _top_level(child)


@cache
def _defined_names(file: Path) -> frozenset[str]:
    """Names that a file sets at its top level, also within conditions."""
    names: set[str] = set()
    for node in _top_level(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names |= {alias.asname or alias.name for alias in node.names}
    return frozenset(names)


def _file_of(module: str) -> Path | None:
    """File of a module of the package; None if there is none."""
    path = _TOP.joinpath(*module.split("."))
    files = path / "__init__.py", path.with_suffix(".py")
    return next((file for file in files if file.is_file()), None)


def _is_missing(module: str, name: str) -> bool:
    """True if a module of the package has neither the name nor a file of it. Nothing is imported: that takes 10 s."""
    file = _file_of(module)
    return file is None or (name not in _defined_names(file) and _file_of(f"{module}.{name}") is None)


def find_broken_imports(text: str, folder: Path) -> list[str]:
    """Imports of a script that lead nowhere: those of the package, and of files next to it."""
    broken = []
    homes = (folder, _TOP / "tests", _TOP / "benchmarks", _TOP / "lab")
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            broken += [
                name.name for name in node.names if name.name.startswith("hydrostat.") and not _file_of(name.name)
            ]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            if node.module.partition(".")[0] == "hydrostat":
                broken += [f"{node.module}.{name.name}" for name in node.names if _is_missing(node.module, name.name)]
                continue
            file = Path(*node.module.split("."))
            for home in homes:
                if (home / file).with_suffix(".py").is_file():
                    names = {name.name for name in node.names} - _defined_names((home / file).with_suffix(".py"))
                    broken += [f"{node.module}.{name}" for name in sorted(names)]
                    break
    return broken


@pytest.mark.parametrize("script", _SCRIPTS, ids=lambda file: str(file.relative_to(_TOP)))
def test_imports_of_a_script_lead_somewhere(script: Path) -> None:
    assert find_broken_imports(script.read_text(encoding="utf-8"), script.parent) == []


def test_a_broken_import_is_found() -> None:
    text = (
        "from hydrostat.robot import load_robot, no_such\nfrom hydrostat.nowhere import a\nfrom builders import nobody"
        "\nimport hydrostat.robot.no_file\nfrom hydrostat.robot.read import package\nfrom hydrostat import robot"
    )
    assert find_broken_imports(text, _TOP) == [
        *("hydrostat.robot.no_such", "hydrostat.nowhere.a", "builders.nobody"),
        *("hydrostat.robot.no_file", "hydrostat.robot.read.package"),
    ]


def test_no_script_hides_another() -> None:
    """Folders that tests put on the path: a file of one with the name of a package of another was imported for it."""
    names = [
        path.stem
        for folder in ("tests", "tests/fabrication", "benchmarks", "docs", "lab")
        for path in (_TOP / folder).iterdir()
        if (path.suffix == ".py" and path.stem != "conftest") or (path / "__init__.py").is_file()
    ]
    assert {name for name in names if names.count(name) > 1} == set()
