"""Help texts speak plainly: they begin with a verb or a quantity, and leave defaults to the command line."""

import re
from collections.abc import Callable, Iterator

import click
import pytest
from typer.main import get_command

from hydrostat.cli.main import app

DANGLING = {"Of", "What", "How", "That", "Whether", "Where", "Which", "To", "In", "As", "From", "With", "For", "So"}
"""First words of fragments."""
BANNED = re.compile(
    r"\b(anew|hereabouts|shall|mends?|bears?|all the same|indeed|rather|to mind|beside|tells?|told|knows?|known|feels?|"
    r"felt|things?|at once|if left out)\b|\bthere (is|are) no\b",
    re.IGNORECASE,
)
LONGEST = 25  # words of a sentence


def _texts(command: click.Command, name: str) -> Iterator[tuple[str, str]]:
    """Each help text of a command and its subcommands, with the place where it stands."""
    yield name, command.help or ""
    for parameter in command.params:
        yield f"{name} {'/'.join(parameter.opts)}", getattr(parameter, "help", None) or ""
    for key, one in getattr(command, "commands", {}).items():
        yield from _texts(one, f"{name} {key}")


TEXTS = dict(_texts(get_command(app), "hydrostat"))


def _faults(text: str) -> list[str]:
    """What is wrong with a help text."""
    first = text.split("\n\n", maxsplit=1)[0].strip()
    if not first:
        return ["empty"]
    word = re.split(r"\W", first)[0]
    faults = [] if first[0].isupper() else ["no capital letter first"]
    faults += [f"first word {word}"] if word in DANGLING else []
    faults += [f"banned: {match[0]}" for match in BANNED.finditer(text)]
    return faults + ([f"more than {LONGEST} words"] if len(first.split()) > LONGEST else [])


@pytest.mark.parametrize("place", TEXTS)
def test_help_speaks_plainly(place: str) -> None:
    assert _faults(TEXTS[place]) == []


def test_an_option_takes_one_kind_of_value() -> None:
    """An option means the same in all commands: what it takes has one name, `None` for a switch."""
    kinds: dict[str, set[str | None]] = {}
    for command in get_command(app).commands.values():  # type: ignore[attr-defined]
        for parameter in command.params:
            for name in parameter.opts:
                kinds.setdefault(name, set()).add(getattr(parameter, "metavar", None))
    several = {name: kind for name, kind in kinds.items() if name.startswith("--") and len(kind) > 1}
    assert set(several) <= {"--out", "--method"}, several  # a folder or a file to write; names of a closed set


def test_all_commands_are_read() -> None:
    """Oracle: the commands and an option that the README uses."""
    assert {"hydrostat pose", "hydrostat pose --pose", "hydrostat design --winches", "hydrostat new name"} <= set(TEXTS)
    assert len(TEXTS) > 150


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "empty"),
        ("winches of one contraction.", "no capital letter first"),
        ("Of the draws.", "first word Of"),
        ("The most that a cable bears.", "banned: bears"),
        ("Minimum distance; 5 mm if left out.", "banned: if left out"),
        (" ".join(["Word"] * 26), "more than 25 words"),
    ],
)
def test_a_bad_text_is_found(text: str, fault: str) -> None:
    assert _faults(text) == [fault]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("studio", "--port", "abc"), "error: --port abc: not a whole number. See hydrostat studio -h."),
        (
            ("new", "bear.svg"),
            "error: Missing option '--from'. Did you mean: hydrostat new bear --from bear.svg? See hydrostat new -h.",
        ),
        (
            ("studio", "--port", "99999"),
            "error: --port 99999: too large. Allowed: at most 65535. See hydrostat",
        ),
        (("export", "--fit-poses", "-4"), "error: --fit-poses -4: too small. Allowed: 0 or more. See hydrostat export"),
        (("export", "--fit-poses", "100000"), "error: --fit-poses 100000: too large. Allowed: at most 1000. See"),
        (("share",), "Missing argument 'ROBOT'. See hydrostat share -h."),
    ],
)
def test_an_error_of_usage_is_one_line(
    run: Callable[..., tuple[int, str, str]], words: tuple[str, ...], told: str
) -> None:
    code, out, err = run(*words)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("hydrostat: error: ")
    assert told in err
