"""Scripts outside the package. Oracle: the modules and names that their imports ask for, looked up one by one."""

import ast
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

from hydrostat.errors import InputError

_TOP = Path(__file__).parents[1]
_SCRIPTS = sorted(
    file
    for folder in ("benchmarks", "docs", "lab", "native", "examples", "integrations")
    for file in (_TOP / folder).rglob("*.py")
)


def _is_missing(module: str, name: str) -> bool:
    """True if a module of the package has neither the name nor a file of it."""
    try:
        return not hasattr(import_module(module), name) and find_spec(f"{module}.{name}") is None
    except (ImportError, InputError):  # an extra is missing here
        return find_spec(module) is None


def _defined_names(file: Path) -> set[str]:
    """Names that a script sets at its top level, also within conditions."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names |= {alias.asname or alias.name for alias in node.names}
    return names


def find_broken_imports(text: str, folder: Path) -> list[str]:
    """Imports of a script that lead nowhere: those of the package, and of files next to it."""
    broken = []
    homes = (folder, _TOP / "tests", _TOP / "benchmarks", _TOP / "lab")
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            broken += [
                name.name for name in node.names if name.name.startswith("hydrostat.") and not find_spec(name.name)
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
    )
    assert find_broken_imports(text, _TOP) == ["hydrostat.robot.no_such", "hydrostat.nowhere.a", "builders.nobody"]
