"""Every file that the assembly sheet names is in the kit."""

import re

import pytest
from page_words import read_words
from plush_robots import crossed

from hydrostat.fabrication import Kit, KitOptions, Method, MoldKind, MoldOptions, build_kit

NAMED = re.compile(r"[\w/]*\w\.(?:pdf|csv|svg|dxf|3mf|stl|json|toml|step)\b")
FOLDER = re.compile(r"\b(?:lists|parts|pattern|mould|positive)/(?=\W|$)")


OTHERS = {"robot.toml", "dance/trajectory.csv"}
"""Files of the robot and of a command in First start, not of the kit."""


def named(kit: Kit) -> set[str]:
    """All paths of the kit on the pages, by another program."""
    text = read_words(kit.files["assembly_sheet.pdf"])
    return {*NAMED.findall(text), *FOLDER.findall(text)} - OTHERS


def wrong(kit: Kit) -> set[str]:
    """Paths on the pages that are not there."""
    there = {*kit.files, *(f"{path.rpartition('/')[0]}/" for path in kit.files)}
    return named(kit) - there


@pytest.mark.parametrize("which", ["plush_kit", "foam_kit"])
@pytest.mark.slow
def test_files_that_are_named_are_there(which, request):
    """Oracle: the paths of the kit."""
    kit = request.getfixturevalue(which)
    assert len(named(kit)) >= 5
    assert wrong(kit) == set()


@pytest.mark.slow
def test_files_of_a_mould_of_silicone_are_there():
    """Oracle: the paths of the kit."""
    options = KitOptions(method=Method.FOAM, force=True, mould=MoldOptions(kind=MoldKind.SILICONE))
    kit = build_kit(crossed(), options=options)
    assert "mould/plate_1.3mf" in named(kit)
    assert wrong(kit) == set()


@pytest.mark.slow
def test_the_check_of_names_can_fail(plush_kit):
    """Oracle: a kit without its list of cables."""
    files = {path: content for path, content in plush_kit.files.items() if path != "lists/cable_cuts.csv"}
    kit = Kit(**{**vars(plush_kit), "files": files})
    assert wrong(kit) == {"lists/cable_cuts.csv"}
