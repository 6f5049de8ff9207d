"""Kits against reference files: what a change of the code changes in a kit is seen, and refreshed by a flag only.

python -m pytest tests/fabrication/test_reference_kits.py --refresh-references
"""

import json
from pathlib import Path

import pytest
from fingerprint import differences, fingerprint
from plush_robots import crossed

from hydrostat.fabrication import Kit, plush_pattern
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.fabrication.solids.print_files import stl_bytes
from hydrostat.fabrication.solids.printed import Printed

pytestmark = pytest.mark.slow

REFERENCES = Path(__file__).parent / "references"


def compare(kit: Kit, name: str, *, refresh: bool) -> list[str]:
    """Differences to the reference of this name; none after it is refreshed."""
    told = fingerprint(kit.files)
    path = REFERENCES / f"{name}.json"
    if refresh:
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return differences(json.loads(path.read_text(encoding="utf-8")), told)


def test_the_kit_of_the_starfish_is_as_it_was(plush_kit, refresh_references):
    """Oracle: the reference file."""
    assert compare(plush_kit, "starfish_plush", refresh=refresh_references) == []


def test_the_kit_of_the_fish_tail_is_as_it_was(foam_kit, refresh_references):
    """Oracle: the reference file."""
    assert compare(foam_kit, "fish_tail_foam", refresh=refresh_references) == []


@pytest.mark.parametrize("ending", ["svg", "dxf", "pdf", "stl", "3mf", "csv", "json"])
def test_the_comparison_can_fail(plush_kit, foam_kit, ending):
    """Oracle: a file of each kind, and that of another robot under its name."""
    path, mine = next(item for item in plush_kit.files.items() if item[0].endswith(ending))
    theirs = next(content for path, content in _other(foam_kit).items() if path.endswith(ending))
    assert differences(fingerprint({path: mine}), fingerprint({path: theirs}))


def test_a_missing_file_is_seen(plush_kit):
    """Oracle: a kit without its last file."""
    fewer = dict(sorted(plush_kit.files.items())[:-1])
    assert len(differences(fingerprint(plush_kit.files), fingerprint(fewer))) == 1


def test_a_part_that_is_half_a_millimeter_longer_is_seen(plush_kit):
    """Oracle: a spool moved up by an additional slab of half a millimeter."""
    spool = next(part for part in plush_kit.printed if "spool" in part.name)
    longer = Printed(name=spool.name, title=spool.title, solid=spool.solid.scale((1.0, 1.0, 1 + 0.5 / spool.size[2])))
    path = f"parts/{spool.name}.stl"
    assert path in plush_kit.files
    assert differences(fingerprint({path: plush_kit.files[path]}), fingerprint({path: stl_bytes(longer)}))


def _other(foam_kit: Kit) -> dict[str, bytes]:
    """Files of other robots: drawings of a square, all else of foam."""
    pattern = plush_pattern(crossed())
    return {
        "pattern.svg": pattern_svg(pattern),
        "pattern.dxf": pattern_dxf(pattern),
        **dict(sorted(foam_kit.files.items())),
    }
