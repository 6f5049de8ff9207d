"""A constraint is stated once and can be asked for everywhere. Oracle: the fields of `Constraints`."""

import ast
import inspect
from dataclasses import fields
from pathlib import Path

import pytest

import hydrostat
from hydrostat.cli.main import app
from hydrostat.design import Constraints
from hydrostat.design.constraints import RANGES
from hydrostat.design.constraints_file import ZONES, ConstraintsTable
from hydrostat.project import Paint, Wishes, read_project_file, write_project_file

COMMAND = next(each.callback for each in app.registered_commands if each.callback.__name__ == "design")  # type: ignore[union-attr]
FIELDS = [field.name for field in fields(Constraints)]

OPTIONS = {
    "spool_ratio": "stepped_spools",
    "mirror": "symmetric",
    "locked_winches": "lock_winch",
    "locked_cables": "lock_cable",
}
"""Options of the command line with names of their own."""

WISHES = {"spool_ratio": "stepped", "locked_winches": "kept_winches", "locked_cables": "kept_cables"}
"""Wishes in the studio with names of their own."""

ZONE = "a zone has several numbers: it is a table of the constraints file"
MAKING = "it follows from how the robot is made, not from what it should do: it stands in the constraints file"

NO_OPTION = {
    **dict.fromkeys(("winch_zones", "keep_out", "passive_zones"), ZONE),
    **dict.fromkeys(("mount", "built_in", "winch_clearance", "winch_gap", "hole_gap", "cable_gap", "max_turn"), MAKING),
    "drawing_gap": MAKING,
    **dict.fromkeys(("bend_radius", "max_length", "torque", "travel", "release", "spool_radius", "leads"), MAKING),
}
"""Constraints without an option of the command line, with the reason."""

NO_BOX = dict.fromkeys(
    ("mount", "built_in", "winch_clearance", "winch_gap", "hole_gap", "cable_gap", "drawing_gap", "max_turn",
     "bend_radius", "max_length", "travel", "release", "spool_radius", "leads"),
    MAKING,
)  # fmt: skip
"""Constraints that the studio does not show, with the reason."""


def named_in_panels() -> set[str]:
    """Texts and keyword names in the studio's panels of a design, where its boxes name the wishes that they set."""
    folder = Path(hydrostat.__file__).parent / "studio" / "face" / "panels"
    nodes = [
        node
        for file in ("design_limits.py", "design_panel.py")
        for node in ast.walk(ast.parse((folder / file).read_text()))
    ]
    texts = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    return texts | {node.arg for node in nodes if isinstance(node, ast.keyword) and node.arg is not None}


def test_every_constraint_is_a_key_of_the_file() -> None:
    assert {ZONES.get(key, key) for key in ConstraintsTable.model_fields} - {"tolerances"} == set(FIELDS)


def test_every_constraint_is_an_option_or_has_a_reason_not_to_be() -> None:
    options = inspect.signature(COMMAND).parameters
    given = {name for name in FIELDS if OPTIONS.get(name, name) in options}
    assert given | set(NO_OPTION) == set(FIELDS)
    assert not given & set(NO_OPTION)


def test_every_constraint_is_shown_in_the_studio_or_has_a_reason_not_to_be() -> None:
    named = named_in_panels() | {paint.constraint for paint in Paint}
    shown = {name for name in FIELDS if WISHES.get(name, name) in named}
    assert shown | set(NO_BOX) == set(FIELDS)
    assert not shown & set(NO_BOX)


@pytest.mark.parametrize("name", [name for name, allowed in RANGES.items() if name not in WISHES])
def test_every_number_can_be_wished_and_is_kept(name: str, tmp_path: Path) -> None:
    """Numbers that no box of the studio shows stand in its file only where they are not the usual ones."""
    from hydrostat.control import Timeline

    usual = Wishes()
    value = type(usual.value(name) or 1.0)(2) if RANGES[name].holds(2) else RANGES[name].most / 2
    write_project_file(tmp_path, Timeline(), Wishes.of(**{name: value}))
    assert read_project_file(tmp_path)[1] == Wishes.of(**{name: value}) != usual
    write_project_file(tmp_path, Timeline(), usual)
    assert (f'"{name}"' in (tmp_path / "studio.json").read_text()) == (name not in NO_BOX)


def test_every_default_in_help_is_read_from_a_record() -> None:
    """Words in place of a default stand where a record has None."""
    told = {}
    for name, parameter in inspect.signature(COMMAND).parameters.items():
        default = getattr(parameter.annotation.__metadata__[0], "show_default", True)
        if isinstance(default, str):
            told[name] = f"{default}"
            assert type(default) is not str or name in {"pose", "depth", "tolerance", "time", "budget"}
    assert told["clearance"] == f"{1e3 * Constraints.clearance:g} mm"
    assert told["tension"] == f"{Constraints.tension:g} N"
    assert told["cables_per_winch"] == str(Constraints.cables_per_winch)
