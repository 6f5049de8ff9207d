"""STEP files. Oracles: volumes and boxes in closed form of what build123d, another user of Open CASCADE, wrote."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from hydrostat.errors import InputError, SeveralPartsError, SurfaceError
from hydrostat.geometry.files.surface_file import read_surface
from hydrostat.geometry.healing.heal import heal

needs_cad = pytest.mark.skipif(find_spec("OCP") is None, reason="the extra cad is not installed")


@pytest.mark.skipif(find_spec("OCP") is not None, reason="the extra cad is installed")
def test_without_the_extra_one_line_names_it() -> None:
    with pytest.raises(
        InputError, match=r"arm.step: STEP files need build123d, which is not installed: pip .*cad"
    ) as found:
        read_surface(b"ISO-10303-21;", name="arm.step")
    assert "\n" not in str(found.value)


def write_step(path: Path, *boxes: tuple[tuple[float, ...], tuple[float, ...]], unit: str = "MM") -> bytes:
    """Boxes by their sides and places as a STEP file."""
    import build123d as cad  # pyright: ignore[reportMissingImports]

    solids = [cad.Part(cad.Solid.make_box(*sides).translate(cad.Vector(*at)).wrapped) for sides, at in boxes]
    cad.export_step(cad.Compound(children=solids), str(path), unit=cad.Unit[unit])
    return path.read_bytes()


@needs_cad
@pytest.mark.parametrize(("unit", "scale"), [("MM", 1.0), ("IN", 25.4), ("M", 1000.0)])
def test_units_of_the_file(tmp_path: Path, unit: str, scale: float) -> None:
    """A box of 9 x 3 x 2.5 in each unit."""
    content = write_step(tmp_path / "arm.step", ((9, 3, 2.5), (0, 0, 0)), unit=unit)
    surface = read_surface(content, name="arm.stp")
    np.testing.assert_allclose(np.ptp(surface.box, axis=0), 1e-3 * scale * np.array([9, 3, 2.5]), rtol=1e-9)
    assert heal(surface, resolution=1e-3 * scale).clean


@needs_cad
def test_touching_solids_are_one_others_are_chosen(tmp_path: Path) -> None:
    """Two boxes that touch are one of their volumes; one apart is asked about, a screw is left out and told."""
    arm, palm = ((90, 30, 25), (0, 0, 0)), ((30, 30, 60), (90, 0, 0))
    surface = read_surface(write_step(tmp_path / "a.step", arm, palm), name="a.step")
    assert surface.volume == pytest.approx(90 * 30 * 25e-9 + 30 * 30 * 60e-9)
    assert surface.notes == ("2 solids, united where they touch",)
    content = write_step(tmp_path / "b.step", ((30, 30, 60), (120, 0, 0)), arm)
    with pytest.raises(
        SeveralPartsError, match=r"has 2 bodies \(1: 90 x 30 x 25 at \(0, 0, 0\); 2: 30 .*--part N"
    ) as found:
        read_surface(content, name="b.step")
    assert sorted(found.value.parts) == [1, 2]
    for part, volume in ((1, 90 * 30 * 25e-9), (2, 30 * 30 * 60e-9)):
        assert read_surface(content, name="b.step", part=part).volume == pytest.approx(volume)
    with pytest.raises(SurfaceError, match=r"part 3 is not there. Allowed: 1 to 2"):
        read_surface(content, name="b.step", part=3)
    screw = read_surface(write_step(tmp_path / "c.step", arm, ((4, 4, 9), (120, 0, 0))), name="c.step")
    assert screw.volume == pytest.approx(90 * 30 * 25e-9)
    assert screw.notes == ("1 solid apart from the body, left out",)


@needs_cad
@pytest.mark.parametrize("content", [b"hello", b"ISO-10303-21;", b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=("])
def test_damaged_files_are_one_line(content: bytes) -> None:
    with pytest.raises(SurfaceError) as found:
        read_surface(content, name="a.step")
    assert "\n" not in str(found.value)
