"""docs/thesis.md keeps both ends: each code that is cited stands in it, each place that it names exists."""

import inspect
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
CODE = re.compile(r"\b[RNEMF][1-9][0-9]?\b")
ROW = re.compile(r"^\| ([A-Z][0-9]+) \| (.+) \| (.+) \|$", re.MULTILINE)
LOOK_ALIKE = {
    "N20": "a motor",
    "M60": "a drawing's path",
    "M30": "a drawing's path",
    "F11": "a block of a matrix",
    "F21": "a block of a matrix",
    "F22": "a block of a matrix",
    "F33": "an entry of a matrix",
}
"""What looks like a code and is none; screws M2, M3 and M4 look like codes that exist."""

SOURCES = (
    "hydrostat/**/*.py",
    "benchmarks/*.py",
    "lab/**/*.py",
    "lab/**/*.md",
    "tests/**/*.py",
    "docs/**/*.md",
    "docs/*.py",
    "*.md",
)
COUNTS = {"R": 90, "N": 17, "E": 66, "M": 20, "F": 13}


def rows(text: str) -> dict[str, tuple[str, str]]:
    """Sentence and place of each code."""
    return {code: (sentence, place) for code, sentence, place in ROW.findall(text)}


def cited(pattern: str) -> dict[str, str]:
    """Each code that files cite, and one of the files."""
    found: dict[str, str] = {}
    for file in sorted(ROOT.glob(pattern)):
        if file.name not in {"thesis.md", Path(__file__).name}:
            found |= dict.fromkeys(CODE.findall(file.read_text(encoding="utf-8")), str(file.relative_to(ROOT)))
    return {code: file for code, file in found.items() if code not in LOOK_ALIKE}


def unknown(cited: dict[str, str], listed: dict[str, tuple[str, str]]) -> list[str]:
    return [f"{code} in {file}" for code, file in cited.items() if code not in listed]


def wrong_places(listed: dict[str, tuple[str, str]]) -> list[str]:
    """Codes whose place is neither "not yet" nor made of files that exist."""
    wrong = []
    for code, (_, place) in listed.items():
        files = re.findall(r"`([^`]+)`", place)
        if not all((ROOT / file).is_file() for file in files) or not (files or "not yet" in place):
            wrong.append(f"{code}: {place}")
    return wrong


@pytest.fixture(scope="module")
def listed() -> dict[str, tuple[str, str]]:
    return rows((ROOT / "docs" / "thesis.md").read_text(encoding="utf-8"))


def test_the_list_is_whole(listed: dict[str, tuple[str, str]]) -> None:
    assert list(listed) == [f"{kind}{number}" for kind, count in COUNTS.items() for number in range(1, count + 1)]
    assert all(sentence.endswith(".") for sentence, _ in listed.values())


@pytest.mark.parametrize("pattern", SOURCES)
def test_what_is_cited_is_listed(pattern: str, listed: dict[str, tuple[str, str]]) -> None:
    assert coded({"a": "as told (R31)", "b": "an N20 motor"}) == ["a: R31"]
    assert unknown(cited(pattern), listed) == []


def test_places_exist(listed: dict[str, tuple[str, str]]) -> None:
    assert wrong_places(listed) == []


def test_what_the_package_cites_has_a_place(listed: dict[str, tuple[str, str]]) -> None:
    assert [code for code in cited("hydrostat/**/*.py") if listed[code][1] == "not yet"] == []


def coded(texts: dict[str, str]) -> list[str]:
    """Which of some texts hold codes."""
    return [f"{name}: {code}" for name, text in texts.items() for code in set(CODE.findall(text)) - set(LOOK_ALIKE)]


def test_what_users_read_in_python_has_no_codes() -> None:
    """`help()` of all that is public, and of its methods: a code without its key means nothing there (finding 45)."""
    import hydrostat as hs

    texts = {}
    for name in hs.__all__:
        thing = getattr(hs, name)
        texts[name] = inspect.getdoc(thing) or ""
        if inspect.isclass(thing):
            texts |= {
                f"{name}.{key}": inspect.getdoc(value) or "" for key, value in vars(thing).items() if callable(value)
            }
    assert len(texts) > 100
    assert coded(texts) == []


def test_what_the_command_line_says_has_no_codes() -> None:
    from typer.main import get_command

    from hydrostat.cli.main import app
    from hydrostat.robot import MATERIALS

    commands = get_command(app).commands  # type: ignore[attr-defined]
    texts = {
        name: " ".join([command.help or "", *(getattr(each, "help", "") or "" for each in command.params)])
        for name, command in commands.items()
    }
    texts |= {name: f"{material.source} {material.note}" for name, material in MATERIALS.items()}
    assert coded(texts) == []


def test_the_checks_can_fail() -> None:
    text = "| R1 | It is so. | `README.md` |\n| R2 | It is so. | `no_such.py` |\n| R3 | It is so. | somewhere |\n"
    assert wrong_places(rows(text)) == ["R2: `no_such.py`", "R3: somewhere"]
    assert unknown({"R3": "a.py", "E99": "b.py"}, rows(text)) == ["E99 in b.py"]
    assert CODE.findall("as said (R31, E19; R1 to M4)") == ["R31", "E19", "R1", "M4"]
    assert len(cited("hydrostat/**/*.py")) > 60
