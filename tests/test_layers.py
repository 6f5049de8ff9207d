"""The layers that import-linter proves. Oracles: the figure in ARCHITECTURE.md, and the folders of the house."""

import ast
import re
import tomllib
from pathlib import Path

_TOP = Path(__file__).parents[1]
_CONTRACTS = [
    contract
    for contract in tomllib.loads((_TOP / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    if contract["type"] == "layers"
]


def _rooms(contract: dict) -> list[set[str]]:
    """Rooms of each layer, with their full names; without those that are yet to come."""
    parent = contract["containers"][0]
    lines = [{room.strip() for room in line.split("|")} for line in contract["layers"]]
    return [{f"{parent}.{room}" for room in line if not room.startswith("(")} for line in lines]


def _drawn(text: str) -> list[set[str]]:
    """Rooms of each line of the figure, whose first words they are; what else is said there are remarks."""
    figure = re.search(r"\n\n((?: {3,}\S.*\n)+)\n\| room", text)
    assert figure
    lines = [re.sub(r" {3,}never import.*| {3,}the one.*", "", line) for line in figure[1].splitlines()]
    return [{f"hydrostat.{room.strip()}" for room in line.split("|")} for line in lines]


def test_the_figure_shows_the_layers_that_are_proven() -> None:
    text = (_TOP / "ARCHITECTURE.md").read_text()
    assert _drawn(text) == _rooms(_CONTRACTS[0])
    assert _drawn(text.replace("               geometry\n", "")) != _rooms(_CONTRACTS[0])


def test_every_folder_stands_in_a_layer() -> None:
    """Rooms within rooms, too: one that is new has to say what it may import."""
    folders = [path.parent.relative_to(_TOP) for path in (_TOP / "hydrostat").rglob("__init__.py")]
    named = set().union(*(line for contract in _CONTRACTS for line in _rooms(contract)))
    assert {".".join(folder.parts) for folder in folders} - {"hydrostat"} - named == set()
    assert _CONTRACTS[0]["exhaustive"]


_BY_NAME = {"__init__.py", "kernel.py", "lazy.py", "studio/work_process.py"}
"""Files that may import a module whose name is no constant: what only the top package and the studio decide."""


def _hidden_imports(text: str) -> list[str]:
    """Imports that import-linter cannot see: by a string, and of a name from the top package itself."""
    found = []
    if not re.search("import_module|__import__|from hydrostat import", text):  # as nearly all: parsing takes longest
        return found
    for node in ast.walk(ast.parse(text)):
        called = getattr(node, "func", None)
        if getattr(called, "attr", getattr(called, "id", "")) in {"import_module", "__import__"}:
            assert isinstance(node, ast.Call)
            name = node.args[0]
            if not isinstance(name, ast.Constant) or str(name.value).startswith("hydrostat"):
                found.append(ast.unparse(node))
        if isinstance(node, ast.ImportFrom) and node.module == "hydrostat":
            modules = {path.stem for path in (_TOP / "hydrostat").iterdir()}
            found += [alias.name for alias in node.names if alias.name not in modules]
    return found


def test_no_import_is_hidden_from_the_layers() -> None:
    package = _TOP / "hydrostat"
    files = {str(path.relative_to(package)): path.read_text() for path in package.rglob("*.py")}
    assert {
        name: found for name, text in files.items() if name not in _BY_NAME and (found := _hidden_imports(text))
    } == {}
    assert _hidden_imports('import_module("hydrostat.plot")')
    assert _hidden_imports("import_module(name)")
    assert _hidden_imports("from hydrostat import __version__")
    assert not _hidden_imports('from hydrostat import units\nimport_module("nicegui.elements.scene")')


def _of_the_laboratory(text: str) -> bool:
    """Whether a file imports the shared code of the studies."""
    if "hydrostat_lab" not in text:
        return False
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)]
    return any("hydrostat_lab" in ast.unparse(node) for node in nodes)


def test_only_one_command_knows_the_laboratory() -> None:
    files = [path for top in ("hydrostat", "benchmarks", "examples") for path in (_TOP / top).rglob("*.py")]
    knows = [str(path.relative_to(_TOP)) for path in files if _of_the_laboratory(path.read_text())]
    assert knows == ["hydrostat/cli/reproduce.py"]
