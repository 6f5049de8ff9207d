"""Reference pages of the documentation site: commands as the command line describes them, and the Python API."""

import ast
import os
import re
import subprocess
import sys
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

from typer.cli import get_docs_for_click
from typer.main import get_command

import hydrostat as hs
from hydrostat.cli.main import app

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
GENERATED = DOCS / "generated"
COPIES = {
    ROOT / f"{name.upper()}.md": GENERATED / f"{name}.md" for name in ("architecture", "contributing", "changelog")
}
"""Pages at the top of the repository, and where the site has them."""

PAGES = COPIES | {ROOT / "README.md": DOCS / "index.md", ROOT / "examples" / "python": DOCS / "examples" / "index.rst"}
"""Files and folders beside docs/ that the site has as pages."""

GROUPS = {
    "Robot": ("hydrostat.robot", "hydrostat.geometry"),
    "Simulation": ("hydrostat.simulation", "hydrostat.mechanics"),
    "Inverse kinematics": ("hydrostat.ik",),
    "Identification": ("hydrostat.identification",),
    "Cable design": ("hydrostat.design",),
    "Build kit": ("hydrostat.fabrication",),
    "Pictures": ("hydrostat.plot",),
    "Tables and errors": ("hydrostat.result_table", "hydrostat.errors"),
}
"""Headings of the page of `import hydrostat as hs`, with the rooms whose names stand below them."""

ROOMS = ("learning", "training", "control", "teleop", "camera", "grasp", "export", "testing")
"""Rooms with a page of their own: their names are not in the top package."""


def command_page() -> str:
    """Return the page of all commands with their options and defaults."""
    command = get_command(app)
    text = get_docs_for_click(obj=command, ctx=command.make_context("hydrostat", [], resilient_parsing=True))
    body = text.split("**Commands**")[1].split("\n## ", 1)[1]
    body = "## " + body.replace("$ hydrostat", "hydrostat").replace("```console", "```sh")
    body = re.sub(r"^Example: (hydrostat .*?)\n\n", _shell_block, body, flags=re.MULTILINE | re.DOTALL)
    return f"# Command reference\n\nAll commands with their options. [Commands by task](../commands.md)\n\n{body}"


def _shell_block(match: re.Match[str]) -> str:
    """Return an example of a command, which help texts wrap, as a block of one line."""
    return f"```sh\n{' '.join(match[1].split())}\n```\n\n"


def entry(module: str, name: str) -> str:
    """Return the directive that documents one public name: classes, functions, constants differ in case."""
    if name.isupper():
        return f".. py:data:: {module}.{name}\n\n   {constant_docstring(module, name)}\n"
    if name[0].islower():
        return f".. autofunction:: {module}.{name}\n"
    return f".. autoclass:: {module}.{name}\n   :members:\n"


def constant_docstring(door: str, name: str) -> str:
    """Return the text below a constant where it is set: Sphinx would take that of its type."""
    imports = [node for node in ast.walk(_read_module(door)) if isinstance(node, ast.ImportFrom)]
    home = next((node.module or door for node in imports if name in {one.name for one in node.names}), door)
    for statement, text in pairwise(_read_module(home).body):
        names = [node for node in ast.walk(statement) if isinstance(node, ast.Name)]
        is_set = any(node.id == name and isinstance(node.ctx, ast.Store) for node in names)
        if is_set and isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant):
            return " ".join(str(text.value.value).split())
    return ""


def _read_module(name: str) -> ast.Module:
    """Return the syntax of a module, which is read, not run, as extras may be missing."""
    spec = find_spec(name)
    assert spec is not None
    assert spec.origin is not None
    return ast.parse(Path(spec.origin).read_text(encoding="utf-8"))


def top_page() -> str:
    """Return the page of the top package, in groups."""
    homes = {name: getattr(getattr(hs, name), "__module__", "") for name in hs.__all__}
    lines = ["hydrostat", "=========", "", "``import hydrostat as hs``. Lengths in meters, forces in newtons.", ""]
    for heading, rooms in GROUPS.items():
        names = [name for name, home in sorted(homes.items()) if home.startswith(rooms)]
        lines += [heading, "-" * len(heading), "", *(entry("hydrostat", name) for name in names)]
    return "\n".join(lines)


def room_page(room: str) -> str:
    """Return the page of one room."""
    title = f"hydrostat.{room}"
    module = _read_module(title)
    lists = [
        node.value for node in module.body if isinstance(node, ast.Assign) and "__all__" in ast.dump(node.targets[0])
    ]
    first = (ast.get_docstring(module) or "").splitlines()[0]
    entries = [entry(title, name) for name in ast.literal_eval(lists[0])]
    return "\n".join([title, "=" * len(title), "", first, "", *entries])


def on_site(text: str, home: Path, page: Path) -> str:
    """Return a page's Markdown with links that lead within the site.

    A link to a file that the site does not have becomes the name of the file.

    Args:
        text: Markdown of the page.
        home: file whose folder its links start from.
        page: file that the site has it in.
    """

    def lead(match: re.Match[str]) -> str:
        label, target, anchor = match.groups()
        file = (home.parent / target).resolve()
        if target.startswith(("http", "mailto:")) or not file.exists():
            return match[0]
        file = PAGES.get(file, file)
        if file.is_relative_to(DOCS) and file.suffix in (".md", ".rst", ".png", ".jpg"):
            return f"[{label}]({Path(os.path.relpath(file, page.parent)).as_posix()}{anchor or ''})"
        return f"{label} (`{file.relative_to(ROOT).as_posix()}`)"

    return re.sub(r"(?<!`)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#]+)(#[^)\s]*)?\)", lead, text)


def write_reference(folder: Path) -> None:
    """Write the reference pages into a folder, each only where its text has changed."""
    pages = {"commands.md": command_page(), "hydrostat.rst": top_page()}
    pages |= {f"{room}.rst": room_page(room) for room in ROOMS}
    pages |= {copy.name: on_site(page.read_text(encoding="utf-8"), page, copy) for page, copy in COPIES.items()}
    folder.mkdir(exist_ok=True)
    for name, text in pages.items():
        path = folder / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def write_toy(folder: Path, options: str = "") -> None:
    """Write the starfish of the first page: `hydrostat share gallery:starfish`, 8 s of CPU time without options."""
    folder.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "hydrostat", "share", "gallery:starfish", "--out", str(folder / "starfish.html")]
    subprocess.run([*command, *options.split()], check=True, cwd=ROOT)
