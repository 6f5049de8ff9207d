"""The page on kits: its code runs, its table of files is true, its flags are there."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from hydrostat.cli.main import app
from hydrostat.fabrication import Kit

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "fabrication.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_its_code_writes_a_kit(tmp_path: Path) -> None:
    """Oracle: the folder's listing."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    (block,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    names: dict[str, object] = {"__name__": "page"}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        exec(block, names)
    kit = names["kit"]
    assert isinstance(kit, Kit)
    written = {path.relative_to(tmp_path / "build/starfish_kit").as_posix() for path in tmp_path.rglob("*.*")}
    assert set(kit.files) <= written


@pytest.mark.slow
def test_its_table_names_every_kind_of_file(plush_kit: Kit, foam_kit: Kit) -> None:
    """Oracle: the kits' own files, against the patterns in the first column."""
    table = [line for line in PAGE.splitlines() if line.startswith("| `")]
    kinds = [word for line in table for word in re.findall(r"`([^`]+)`", line.split("|")[1])]
    patterns = []
    for kind in kinds:
        if kind.startswith("."):
            kind = patterns[-1].rpartition(".")[0] + kind
        elif "/" not in kind and "/" in (patterns[-1] if patterns else ""):
            kind = patterns[-1].rpartition("/")[0] + "/" + kind
        patterns.append(kind)
    top = {"assembly_sheet.pdf", "manifest.json"}
    patterns = [kind.rpartition("/")[2] if kind.rpartition("/")[2] in top else kind for kind in patterns]
    # of printed bodies: test_print_work.py; of cables on a skin, which these have not: test_channel_strips.py
    patterns = [kind for kind in patterns if not kind.startswith(("body/", "pattern/channels"))]
    patterns.remove("lists/tags.pdf")  # which commands add: test_fabricate.py
    files = {*plush_kit.files, *foam_kit.files}
    unknown = {file for file in files if not any(Path(file).match(pattern) for pattern in patterns)}
    assert {file for file in unknown if not file.startswith("positive/")} == set()
    for pattern in patterns:
        assert any(Path(file).match(pattern) for file in files), pattern


def test_its_commands_have_the_flags_that_they_use() -> None:
    """Oracle: the help of each command; a flag alone is of `fabricate`."""
    others = re.findall(r"`hydrostat (?!fabricate)([a-z]+)([^`]*)`", PAGE)
    assert others
    alone = re.sub(r"`hydrostat (?!fabricate)[^`]*`", "", PAGE)
    for command, text in (("fabricate", alone), *others):
        said = CliRunner().invoke(app, [command, "--help"]).output
        flags = set(re.findall(r"(?<!-)--[a-z]+", text))
        assert {flag for flag in flags if flag not in said} == set(), command
