"""The front pages: code that runs, links that lead somewhere, and nothing left out. Oracle: the package itself."""

import re
from dataclasses import fields
from importlib import import_module
from pathlib import Path

import pytest
from typer.main import get_command

import hydrostat as hs
from hydrostat.cli.main import app
from hydrostat.design import BuildTolerances, Constraints

ROOT = Path(__file__).parents[1]
FRONT = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")
LONGEST = {"README.md": 1200, "ARCHITECTURE.md": 2500, "CHANGELOG.md": 800}  # words
WRITTEN = (ROOT / "docs/generated", ROOT / "docs/examples")  # by `make docs`, in no repository
PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]
    if path.parent not in WRITTEN
)


def read(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def blocks(page: str, language: str) -> list[str]:
    """Blocks of code of one language."""
    return re.findall(rf"```{language}\n(.*?)```", read(page), re.DOTALL)


def anchors(page: str) -> set[str]:
    """Anchors of a page: its headings as GitHub writes them, and those set by hand."""
    text = re.sub(r"```.*?```", "", read(page), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    slugs = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
    return slugs | set(re.findall(r'<a id="([^"]+)"', text))


def dead_links(page: str, text: str) -> list[str]:
    """Links of a text to files or anchors that do not exist."""
    dead = []
    for link in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"```.*?```", "", text, flags=re.DOTALL)):
        if link.startswith(("http", "mailto:")):
            continue
        path, _, anchor = link.partition("#")
        target = (ROOT / page).parent / path if path else ROOT / page
        found = target.exists()
        if found and anchor and target.suffix == ".md":
            found = anchor in anchors(str(target.resolve().relative_to(ROOT)))
        dead += [] if found else [link]
    return dead


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str) -> None:
    assert dead_links(page, read(page)) == []


def test_a_dead_link_is_found() -> None:
    text = "[a](LICENSE), [b](no_such.md), [c](CONTRIBUTING.md#voice), [d](CONTRIBUTING.md#no-such), [e](https://a.b)"
    assert dead_links("README.md", text) == ["no_such.md", "CONTRIBUTING.md#no-such"]


@pytest.mark.parametrize("page", LONGEST)
def test_front_pages_are_short(page: str) -> None:
    assert len(read(page).split()) <= LONGEST[page]


@pytest.mark.slow
@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_python_of_a_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the files that it says it writes. Designs take long and have tests of their own."""
    monkeypatch.chdir(tmp_path)
    code = "".join(block for block in blocks(page, "python") if "design_cables" not in block)
    assert code
    exec(compile(code, page, "exec"), {})
    written = {path.name for path in tmp_path.iterdir()}
    assert written == (
        {"pose.png", "starfish_kit"} if page == "README.md" else {"pose.png", "poses.csv", "arm", "pose", "samples"}
    )


def test_the_design_of_the_python_guide_names_what_there_is() -> None:
    """Oracle: the public names and the fields of their records."""
    code = "".join(block for block in blocks("docs/python.md", "python") if "design_cables" in block)
    assert code
    assert set(re.findall(r"hs\.(\w+)", code)) <= set(hs.__all__)
    known = {field.name for field in fields(hs.Network)} | set(dir(hs.Network))
    assert set(re.findall(r"network\.(\w+)", code)) <= known


def test_every_command_is_on_its_page() -> None:
    commands = set(getattr(get_command(app), "commands", {}))
    shown = set(re.findall(r"^hydrostat (\w+)", "".join(blocks("docs/commands.md", "sh")), re.MULTILINE))
    assert len(commands) > 20
    assert shown == commands
    assert set(re.findall(r"^hydrostat (\w+)", "".join(blocks("README.md", "sh")), re.MULTILINE)) <= commands


@pytest.mark.parametrize("page", ["README.md", "docs/commands.md", "docs/import.md"])
def test_options_on_pages_exist(page: str) -> None:
    for line in "".join(blocks(page, "sh")).splitlines():
        if match := re.match(r"hydrostat (\w+)(.*)", line.split("  #")[0]):
            command = get_command(app).commands[match[1]]  # type: ignore[attr-defined]
            if command.context_settings.get("ignore_unknown_options"):
                continue  # it passes its options on
            known = {name for parameter in command.params for name in (*parameter.opts, *parameter.secondary_opts)}
            assert set(re.findall(r"(?<= )--[\w-]+", match[2])) <= known, line


def keys(text: str) -> set[str]:
    """Keys and tables of a text in TOML, also within comments."""
    return {name for pair in re.findall(r"\b(\w+) = |\[\[?(\w+)\]", text) for name in pair if name}


def test_every_constraint_is_on_its_page() -> None:
    """Oracle: the fields of the records, where zones are tables of one each."""
    page = keys("".join(blocks("docs/constraints.md", "toml")))
    named = {field.name for field in fields(Constraints)} - {"winch_zones", "passive_zones"}
    named |= {"winch_zone", "passive_zone", "tolerances"}
    assert named - page == set()
    assert {"sewing", "friction", "young"} <= {field.name for field in fields(BuildTolerances)} & page
    text = blocks("docs/constraints.md", "toml")[0]
    assert all(re.search(rf"\b{field.name}\b", text) for field in fields(BuildTolerances))


def architecture_doors() -> list[tuple[str, list[str]]]:
    """Rooms of the architecture's table, with the names of their doors."""
    rows = re.findall(r"^\| `(\w+)` \|[^|]*\|([^|]*)\|$", read("ARCHITECTURE.md"), re.MULTILINE)
    rooms = {path.parent.name for path in (ROOT / "hydrostat").glob("*/__init__.py")}
    return [(room, re.findall(r"`(\w+)`", names)) for room, names in rows if room in rooms and room != "cli"]


def test_every_room_is_in_the_architecture() -> None:
    rooms = {path.parent.name for path in (ROOT / "hydrostat").glob("*/__init__.py")} - {"cli"}
    assert {room for room, _ in architecture_doors()} == rooms


@pytest.mark.parametrize(("room", "names"), architecture_doors())
def test_doors_in_the_architecture_open(room: str, names: list[str]) -> None:
    """Oracle: what the room exports."""
    if room == "training":
        pytest.importorskip("gymnasium")
    assert names
    assert set(names) <= set(import_module(f"hydrostat.{room}").__all__)


def test_files_in_the_architecture_exist() -> None:
    named = [name for name in re.findall(r"`([\w/.]+)`", read("ARCHITECTURE.md")) if re.search(r"/|\.(py|cpp)$", name)]
    assert len(named) > 40
    homes = ("", "hydrostat/", "hydrostat/fabrication/", "hydrostat/studio/", "hydrostat/robot/", "hydrostat/control/")
    gone = [
        name
        for name in named
        if not any((ROOT / home / name).exists() for home in homes)
        and not any(path for top in ("hydrostat", "native") for path in (ROOT / top).rglob(Path(name).name))
    ]
    assert gone == []


def test_the_citation_is_of_this_version() -> None:
    text = read("CITATION.cff")
    assert f'version: "{hs.__version__}"' in text
    assert 'license = "Apache-2.0"' in read("pyproject.toml")
    assert "license: Apache-2.0" in text
    assert all(f"*hydrostat*, version {hs.__version__}" in read(page) for page in ("README.md", "docs/licenses.md"))


def test_benchmarks_on_front_pages_exist() -> None:
    for page in (*FRONT, "docs/results.md"):
        named = re.findall(r"\b((?:benchmarks|lab)/[\w/]+\.py)", read(page))
        assert [name for name in named if not (ROOT / name).exists()] == []
