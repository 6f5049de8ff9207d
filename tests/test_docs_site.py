"""The documentation site: its reference, its links, its list of pages, its tutorials. Oracle: the package itself."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.main import get_command

import hydrostat as hs
from hydrostat.cli.main import app

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
sys.path.append(str(DOCS))

import run_tutorials  # noqa: E402
from site_reference import GENERATED, ROOMS, on_site, write_reference  # noqa: E402


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("reference")
    write_reference(folder)
    return folder


def test_every_command_has_a_reference(reference: Path) -> None:
    text = (reference / "commands.md").read_text(encoding="utf-8")
    assert re.findall(r"^## `hydrostat (\w+)`$", text, re.MULTILINE) == list(get_command(app).commands)  # type: ignore[attr-defined]
    assert "hydrostat new my_hand --from scan.stl --size" in text
    assert "Example:" not in text


def test_every_public_name_has_a_reference(reference: Path) -> None:
    text = (reference / "hydrostat.rst").read_text(encoding="utf-8")
    found = re.findall(r"^\.\. auto\w+:: hydrostat\.(\w+)$", text, re.MULTILINE)
    assert sorted(found) == sorted(set(hs.__all__) - {"__version__"})


def test_rooms_of_the_python_guide_have_a_reference(reference: Path) -> None:
    text = (DOCS / "python.md").read_text(encoding="utf-8")
    named = set(re.findall(r"hydrostat\.(learning|training|control|teleop|camera|grasp|export|testing)\b", text))
    assert named <= set(ROOMS)
    assert {path.stem for path in reference.iterdir()} >= set(ROOMS)


def test_reference_pages_are_not_written_again(reference: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in reference.iterdir()}
    write_reference(reference)
    assert {path: path.stat().st_mtime_ns for path in reference.iterdir()} == before


def test_links_lead_within_the_site() -> None:
    page, text = (
        DOCS / "page.md",
        (
            "[a](../README.md) [b](../ARCHITECTURE.md#rules) [c](../hydrostat/lazy.py) [d](limits.md#design) [e](https://a.b)"
        ),
    )
    assert on_site(text, page, page) == (
        "[a](index.md) [b](generated/architecture.md#rules) c (`hydrostat/lazy.py`) [d](limits.md#design) [e](https://a.b)"
    )
    assert (
        on_site("[a](docs/limits.md)", ROOT / "ARCHITECTURE.md", GENERATED / "architecture.md") == "[a](../limits.md)"
    )


def test_every_page_is_listed() -> None:
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^(?:\w+/)*\w+$", index, re.MULTILINE))
    pages = {str(path.relative_to(DOCS).with_suffix("")) for path in DOCS.rglob("*.md")}
    pages -= {page for page in pages if page.startswith(("decisions/", "generated/", "examples/"))} | {"index"}
    assert pages - listed == set()


def written_names(script: str) -> set[str]:
    """Names of pictures that a script writes: whole, or as f"studio_{name}.png" with the strings that it holds."""
    names = set(re.findall(r"\w+\.(?:png|jpg|gif)", script))
    for start, end in re.findall(r'f"(\w+)\{[^"]*\}(\.png)', script):
        names |= {start + word + end for word in ["", *re.findall(r'"(\w+)"', script)]}
    return names


def test_every_picture_is_shown_and_has_its_command() -> None:
    scripts = {
        path: path.read_text(encoding="utf-8")
        for room in ("docs", "lab", "benchmarks")
        for path in (ROOT / room).rglob("*.py")
    }
    written = set[str]()
    for path, text in scripts.items():
        if f"python {path.relative_to(ROOT)}" in text:
            written |= written_names(text)
    pages = "".join(
        path.read_text(encoding="utf-8") for path in [ROOT / "README.md", *DOCS.rglob("*.md"), *ROOT.glob("lab/*/*.md")]
    )
    pictures = {path.name for path in (DOCS / "pictures").iterdir()} - {"demo.json"}
    assert pictures - written == set()
    assert pictures - set(re.findall(r"pictures/(\w+\.\w+)", pages)) == set()


@pytest.mark.slow
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    """Pages are read and links followed. None is written but a toy of few poses; examples have tests of their own."""
    pytest.importorskip("sphinx_gallery")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-q",
        "-W",
        "-b",
        "dummy",
        "-D",
        "plot_gallery=0",
        "-D",
        "toy_options=--samples 24",
        str(DOCS),
        str(tmp_path),
    ]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert (tmp_path / ".doctrees" / "tutorials" / "first_plush.doctree").is_file()
    assert "<canvas" in (tmp_path / "starfish.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["first_plush", "own_cables"])
def test_files_of_a_tutorial_are_robots(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands up to the first check run; the others run by `python docs/run_tutorials.py`."""
    text = (DOCS / "tutorials" / f"{name}.md").read_text(encoding="utf-8")
    start = (
        text[: text.index("hydrostat check")]
        + "hydrostat check"
        + text.split("hydrostat check")[1].split("\n")[0]
        + "\n```\n"
    )
    page = tmp_path / "page.md"
    page.write_text(start.replace(" --thorough", ""), encoding="utf-8")
    run_tutorials.run_page(page, tmp_path)
    assert list(tmp_path.glob("*/robot.toml"))


def options(command: str) -> set[str]:
    parameters = get_command(app).commands[command].params  # type: ignore[attr-defined]
    return {name for parameter in parameters for name in (*parameter.opts, *parameter.secondary_opts)}


@pytest.mark.parametrize("page", sorted((DOCS / "tutorials").glob("*.md")), ids=lambda path: path.stem)
def test_commands_of_a_tutorial_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    lines = [match for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL) for match in block.splitlines()]
    assert any(line.startswith("hydrostat") for line in lines)
    for line in lines:
        if match := re.match(r"hydrostat (\w+)(.*)", line):
            assert set(re.findall(r"(?<= )--[\w-]+", match[2])) <= options(match[1]), line
