"""Cables on the skin. Oracles: depths below the faces of a box, by hand."""

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_robot
from typer.testing import CliRunner

from hydrostat.cli.main import app
from hydrostat.errors import InputError
from hydrostat.robot import Cable, Mount, Pin, Robot, Winch, lay_cables_on_skin


def test_bare_points_lie_below_the_skin_and_sheaths_in_grooves() -> None:
    points = ((-0.05, 0.0, 0.02), (0.01, 0.02, 0.03), (0.05, 0.02, 0.03), (0.15, 0.025, 0.04))
    cable = Cable(winch="one", points=points, sheathed=((0, 2),))
    box = Robot(
        name="box",
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        body=mesh_body(box_mesh((4, 2, 2), size=(0.2, 0.05, 0.05))),
        winches=(Winch(name="one", at=points[0], mount=Mount.WORLD),),
        cables=(cable,),
        poses={},
    )
    laid = lay_cables_on_skin(box, depth=0.001).cables[0]
    places = np.array(laid.points)
    depths = np.minimum(places, np.array([0.2, 0.05, 0.05]) - places).min(axis=1)
    end = laid.sheathed[0][1]
    assert laid.points[0] == points[0]
    assert depths[1 : end + 1] == pytest.approx(np.full(end, 0.0027), abs=2e-4)
    assert depths[end + 1 :] == pytest.approx(np.full(len(places) - end - 1, 0.001), abs=2e-4)
    assert np.linalg.norm(np.diff(places[1:], axis=0), axis=1).max() < 0.02
    assert places[-1][2] == pytest.approx(0.049, abs=2e-4)


def test_flat_bodies_and_drawings_are_refused(tmp_path, monkeypatch) -> None:
    with pytest.raises(InputError, match="flat body"):
        lay_cables_on_skin(strip_robot())
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cat.svg").write_text("<svg/>")
    for source, told in (("cat.svg", "only for robots of the gallery"), ("gallery:starfish", "flat body")):
        result = CliRunner().invoke(app, ["new", "mine", "--from", source, "--cables-on-skin"])
        assert told in str(result.exception) + result.output
        assert not (tmp_path / "mine").exists()
