"""Rooms are entered by their doors, and doors hold no idle names. Oracle: the import statements of all files."""

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

_TOP = Path(__file__).parents[1]
_HERE = Path(__file__).relative_to(_TOP)
_FOLDERS = ["hydrostat", "tests", "benchmarks", "docs", "examples", "integrations", "lab", "native"]
_ROOMS = {
    door.parent.name: set(import_module(f"hydrostat.{door.parent.name}").__all__)
    for door in (_TOP / "hydrostat").glob("*/__init__.py")
}
_ENTRANCES = {"hydrostat.cli.main", "hydrostat.cli.start"}
"""Where programs start the command line."""

_IMPORT = re.compile(r"^[ \t]*((?:from|import) hydrostat\b[^\n(]*(?:\([^)]*\))?[^\n#]*)", re.MULTILINE)
_PATCHED = re.compile(r"(?:setattr|import_module)\(\s*[\"'](hydrostat\.\w+\.\w+)")
_CODE = re.compile(r"```.*?```|`[^`\n]+`", re.DOTALL)


def _files(*folders: str) -> list[Path]:
    return [path.relative_to(_TOP) for folder in folders for path in sorted((_TOP / folder).rglob("*.py"))]


def _text(path: Path) -> str:
    return (_TOP / path).read_text(encoding="utf-8")


def _home(path: Path) -> str:
    """Room of a file, or the room that a test belongs to."""
    top, *folders, _ = path.parts
    return folders[0] if folders and top in {"hydrostat", "tests"} else ""


def _imports(text: str) -> Iterator[ast.Import | ast.ImportFrom]:
    """Import statements of the package, also those within functions and within texts of programs."""
    for statement in _IMPORT.findall(text):
        node = ast.parse(statement).body[0]
        assert isinstance(node, ast.Import | ast.ImportFrom)
        yield node


def _modules(text: str) -> Iterator[str]:
    """Modules of the package that are imported, and names in them that monkeypatch replaces."""
    for node in _imports(text):
        if isinstance(node, ast.ImportFrom):
            yield str(node.module)
        below = f"{node.module}." if isinstance(node, ast.ImportFrom) else ""
        yield from (below + alias.name for alias in node.names)
    yield from _PATCHED.findall(text)


def _past_doors(path: Path, text: str) -> list[str]:
    """Files and folders of other rooms that a file imports or changes, by their modules."""
    behind = set()
    for top, room, name in (module.split(".")[:3] for module in _modules(text) if module.count(".") > 1):
        if room in _ROOMS and room != _home(path) and name not in _ROOMS[room]:
            behind.add(f"{top}.{room}.{name}")
    places = {module: _TOP / Path(*module.split(".")) for module in behind - _ENTRANCES}
    return sorted(module for module, place in places.items() if place.is_dir() or place.with_suffix(".py").is_file())


@pytest.mark.parametrize("folder", _FOLDERS)
def test_rooms_are_entered_by_their_doors(folder: str) -> None:
    past = {path: found for path in _files(folder) if path != _HERE and (found := _past_doors(path, _text(path)))}
    assert not past


@pytest.mark.parametrize(
    ("text", "past"),
    [
        ("from hydrostat.geometry.mesh import Mesh", "hydrostat.geometry.mesh"),
        ("from hydrostat.geometry import mesh", "hydrostat.geometry.mesh"),
        ("    from hydrostat.geometry import (\n    Mesh,\n    mesh,\n)", "hydrostat.geometry.mesh"),
        ("from hydrostat.geometry.files import outline_file", "hydrostat.geometry.files"),
        ("import hydrostat.geometry.mesh as mesh", "hydrostat.geometry.mesh"),
        ('monkeypatch.setattr("hydrostat.geometry.mesh.Mesh", None)', "hydrostat.geometry.mesh"),
        ("from hydrostat.geometry import Mesh", None),
        ('monkeypatch.setattr("hydrostat.geometry.Mesh", None)', None),
        ("from hydrostat.cli.main import app", None),
        ("from hydrostat import units", None),
    ],
)
def test_the_check_can_fail(text: str, past: str | None) -> None:
    assert _past_doors(Path("tests/ik/test_solve_ik.py"), text) == ([past] if past else [])
    assert _past_doors(Path("tests/builders.py"), text) == ([past] if past else [])
    assert _past_doors(Path("hydrostat/geometry/heal.py"), text) == []


def _used_names(path: Path, text: str) -> Iterator[tuple[str, str]]:
    """Room and name of all that a file takes from doors of other rooms."""
    for node in _imports(text):
        top, _, room = str(getattr(node, "module", "")).partition(".")
        for alias in node.names if top == "hydrostat" else ():
            if room:
                yield from [(room, alias.name)] * (room in _ROOMS and room != _home(path))
            else:
                yield from ((alias.name, name) for name in re.findall(rf"\b{alias.asname or alias.name}\.(\w+)", text))


@pytest.mark.parametrize("folder", _FOLDERS)
def test_names_taken_from_doors_are_there(folder: str) -> None:
    """Also those that a test takes from the door of its own room."""
    taken = [(path, node) for path in _files(folder) if path != _HERE for node in _imports(_text(path))]
    missing = [
        f"{path}: {node.module}.{alias.name}"
        for path, node in taken
        if isinstance(node, ast.ImportFrom) and (room := str(node.module).removeprefix("hydrostat.")) in _ROOMS
        for alias in node.names
        if alias.name not in _ROOMS[room] and not (_TOP / "hydrostat" / room / f"{alias.name}.py").is_file()
    ]
    assert missing == []


def test_doors_hold_no_idle_names() -> None:
    """A name is used by another room, a script or a test, is part of hs, or is code in a document for users."""
    used = {pair for path in _files(*_FOLDERS) for pair in _used_names(path, _text(path))}
    pages = [_TOP / "README.md", _TOP / "ARCHITECTURE.md", *(_TOP / "docs").rglob("*.md")]
    code = [span for page in pages for span in _CODE.findall(page.read_text(encoding="utf-8"))]
    known = {*re.findall(r"\w+", " ".join(code)), *import_module("hydrostat").__all__}
    idle = {(room, name) for room, names in _ROOMS.items() for name in names} - used
    assert sorted(pair for pair in idle if pair[1] not in known) == []
    assert {("geometry", "Mesh"), ("drawing", "Color")} <= used
