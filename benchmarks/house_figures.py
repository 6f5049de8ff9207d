"""Size and legibility of the source tree: lines, words, doors, names and constants, for one or several revisions.

    python benchmarks/house_figures.py [REVISION ...] [--cases]

Prints one column for each revision of this repository, and one for the working tree. Everything is read off the text,
so old revisions need not be installed; --cases counts the test cases of the working tree, which collects them (about
30 s). A door is the `__init__` of a room (a folder directly in the package); an import goes past a door where a file of
another room imports from a file behind it.
"""

import argparse
import ast
import io
import re
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
OPENINGS = ("What", "How", "Whether", "Where", "Which", "Of", "That", "As")
ENTRANCES = ("hydrostat.cli.main", "hydrostat.cli.start")  # programs start there
"""First words that make a docstring lean on the code beside it."""

PARTICIPLE = re.compile(
    "begun|bent|borne|bought|bound|broken|built|cast|caught|chosen|cut|drawn|driven|fallen|felt|found|given|gone|grown|"
    "held|hidden|hit|hung|kept|known|laid|left|lit|lost|made|meant|met|paid|put|said|seen|sent|sewn|shown|shut|spent|"
    "split|spread|stuck|sunk|taken|taught|thought|thrown|told|torn|understood|won|worn|woven|wound|written|[a-z]+ed"
)
NO_PARTICIPLE = re.compile("need|feed|seed|speed|embed|bed|exceed|proceed|succeed|hundred|indeed")


def parsed(folder: Path) -> dict[Path, ast.Module]:
    """Return the syntax trees of all Python files below a folder."""
    return {file: ast.parse(file.read_text(encoding="utf-8")) for file in sorted(folder.rglob("*.py"))}


def line_count(files: list[Path]) -> int:
    """Return the number of lines of text files."""
    return sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files)


def word_count(path: Path) -> int:
    """Return the number of words of a text file, or of all Markdown files in a folder."""
    files = sorted(path.glob("*.md")) if path.is_dir() else [path]
    return sum(len(file.read_text(encoding="utf-8").split()) for file in files if file.is_file())


def door_names(module: ast.Module) -> int:
    """Return the number of names in `__all__`, or of names imported where there is none."""
    for node in module.body:
        if isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if any(isinstance(name, ast.Name) and name.id == "__all__" for name in targets):
                value = node.value
                return len(value.elts) if isinstance(value, ast.List | ast.Tuple) else 0
    return 0


def past_doors(tree: Path, folder: str) -> int:
    """Return the number of names that files take from behind the door of another room.

    Tests may enter the room whose folder they are in, and all files the entrance of the command line.
    """
    count, package = 0, tree / "hydrostat"
    for file, module in parsed(tree / folder).items():
        own = file.relative_to(tree / folder).parts
        for node in ast.walk(module):
            if not isinstance(node, ast.ImportFrom) or node.level or not node.module:
                continue
            parts = node.module.split(".")
            inside = parts[0] == "hydrostat" and len(parts) > 2 and (package / parts[1]).is_dir()
            if inside and (len(own) == 1 or own[0] != parts[1]) and node.module not in ENTRANCES:
                count += len(node.names)
    return count


def is_participle(name: str) -> bool:
    """Return True if a function's name is one bare participle, such as `solved` or `_kept`."""
    word = name.strip("_")
    return bool(PARTICIPLE.fullmatch(word)) and not NO_PARTICIPLE.fullmatch(word)


def functions(module: ast.Module) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Yield all functions and methods of a module."""
    return (node for node in ast.walk(module) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))


def leaning_docstrings(module: ast.Module) -> int:
    """Return the number of docstrings that begin with one of `OPENINGS`."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    texts = (ast.get_docstring(node) for node in ast.walk(module) if isinstance(node, documented))
    return sum(bool(text) and re.split(r"\W", str(text))[0] in OPENINGS for text in texts)


def numeric_constants(module: ast.Module) -> int:
    """Return the number of names at module level that are given a number."""
    return sum(
        isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None and is_number(node.value)
        for node in module.body
    )


def is_number(value: ast.expr) -> bool:
    """Return True if an expression is written in numbers alone."""
    leaves = [node for node in ast.walk(value) if isinstance(node, ast.expr)]
    allowed = (ast.Constant, ast.UnaryOp, ast.BinOp, ast.Tuple)
    constants = [node.value for node in leaves if isinstance(node, ast.Constant)]
    return all(isinstance(node, allowed) for node in leaves) and all(type(value) in (int, float) for value in constants)


def figures(tree: Path) -> dict[str, str]:
    """Return the rows of the table for one tree."""
    package = tree / "hydrostat"
    modules = parsed(package)
    tests, benchmarks = sorted((tree / "tests").rglob("*.py")), sorted((tree / "benchmarks").rglob("*.py"))
    doors = [module for file, module in modules.items() if file.name == "__init__.py" and file.parent.parent == package]
    names = [node.name for module in modules.values() for node in functions(module)]
    words = [word_count(tree / name) for name in ("docs/decisions", "ARCHITECTURE.md", "README.md", "CHANGELOG.md")]
    without_init = sum(file.name != "__init__.py" for file in modules)
    return {
        "package: lines / modules": f"{line_count(list(modules)):,} / {without_init}",
        "benchmarks: files / lines": f"{len(benchmarks)} / {line_count(benchmarks):,}",
        "tests: lines / functions": f"{line_count(tests):,} / {sum(map(test_count, tests)):,}",
        "words: decisions, ARCHITECTURE, README, CHANGELOG": ", ".join(map("{:,}".format, words)),
        "public names of doors / imports past doors, in tests": (
            f"{sum(map(door_names, doors))} / {past_doors(tree, 'hydrostat')}, {past_doors(tree, 'tests')}"
        ),
        "names of the top package": str(door_names(modules[package / "__init__.py"])),
        "bare participles / docstrings with What, How ...": (
            f"{sum(map(is_participle, names))} / {sum(map(leaning_docstrings, modules.values()))}"
        ),
        "numeric constants at module level": f"{sum(map(numeric_constants, modules.values())):,}",
    }


def test_count(file: Path) -> int:
    """Return the number of test functions in a file."""
    return sum(node.name.startswith("test_") for node in functions(ast.parse(file.read_text(encoding="utf-8"))))


def case_count() -> str:
    """Return the last line of a collection of the tests."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q"]
    done = subprocess.run(command, cwd=HERE, capture_output=True, text=True, check=False)
    return (done.stdout.strip().splitlines() or ["none"])[-1].strip("= ")


def unpacked(revision: str, folder: Path) -> Path:
    """Write the files of a revision of this repository into a folder, and return it."""
    made = subprocess.run(["git", "archive", revision], cwd=HERE, capture_output=True, check=True).stdout
    with tarfile.open(fileobj=io.BytesIO(made)) as archive:
        archive.extractall(folder / revision, filter="data")
    return folder / revision


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revisions", nargs="*", metavar="REVISION")
    parser.add_argument("--cases", action="store_true", help="count the test cases of the working tree")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        columns = {revision: figures(unpacked(revision, Path(folder))) for revision in options.revisions}
    columns["working tree"] = figures(HERE)
    print("| | " + " | ".join(columns) + " |\n|---|" + "---|" * len(columns))
    for row in columns["working tree"]:
        print(f"| {row} | " + " | ".join(column[row] for column in columns.values()) + " |")
    if options.cases:
        print(case_count())


if __name__ == "__main__":
    main()
