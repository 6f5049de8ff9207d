"""Photographs in the studio. Oracle: rendered photographs of a robot whose modulus is known."""

from collections.abc import Callable
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from builders import routed_strip

from hydrostat.errors import InputError
from hydrostat.project import Work
from hydrostat.robot import Load, Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing import MAX_BYTES, Photographs

UPPER = ((0.0083, 0.0137), (0.0587, 0.0161), (0.1129, 0.0147), (0.1833, 0.0143))


class Silent:
    """Report that nobody reads."""

    def progress(self, stage: str, done: int, total: int) -> None: ...

    def part(self, value: Any) -> None: ...

    def finish(self) -> None: ...


class DirectJobs(Jobs):
    """Jobs that are done at once, in this process."""

    def start(
        self,
        title: str,
        function: Callable[..., Any],
        *arguments: Any,
        on_part: Callable[[Any], None] | None = None,
        on_done: Callable[[Any], None] | None = None,
        on_end: Callable[[str], None] | None = None,
    ) -> None:
        assert on_done is not None
        assert on_end is not None
        try:
            on_done(function(Silent(), *arguments))
        except InputError as error:
            on_end(str(error))
        else:
            on_end("")


def strip() -> Robot:
    """A flat strip with weight and one cable."""
    return routed_strip({"up": UPPER}, gravity=(0.0, -9.81), slack=0.001)


def photographs() -> tuple[Document, Photographs]:
    """An open strip, and its photographs."""
    document = Document(Bell())
    document.open(Work(robot=strip()))
    return document, Photographs(document, DirectJobs(document.bell))


def test_photographs_are_kept_by_name() -> None:
    _, kept = photographs()
    for name in ("a.jpg", "b.jpg", "a.jpg"):
        kept.add(name, b"picture", {"up": 0.003})
    assert [file.name for file in kept.files] == ["b.jpg", "a.jpg"]
    kept.remove("b.jpg")
    assert [file.name for file in kept.files] == ["a.jpg"]
    with pytest.raises(InputError, match=r"c.jpg: larger than 25 MB"):
        kept.add("c.jpg", b"0" * (MAX_BYTES + 1), {})
    for name in ("..", "", "a/b.jpg", "a" * 300, "a\0.jpg"):
        with pytest.raises(InputError, match="not a file name"):
            kept.add(name, b"picture", {})
    with pytest.raises(InputError, match="compare the photographs first"):
        kept.start_fit()
    with pytest.raises(InputError, match="no fit of this robot"):
        kept.apply()
    for number in range(23):
        kept.add(f"{number}.jpg", b"", {})
    with pytest.raises(InputError, match="24 photographs are here already"):
        kept.add("last.jpg", b"", {})


@pytest.mark.slow
def test_photographs_are_compared_and_fitted(unchecked: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """A dropped photograph takes the pose on the screen, another that of its name; the fit is one step to undo."""
    pytest.importorskip("cv2", reason="extra photos (OpenCV) is not installed")
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "camera")
    from photographs import Camera, Scene, photograph
    from PIL import Image

    document, kept = photographs()
    assumed = document.robot
    material = replace(assumed.body.material, young=1.35 * assumed.body.material.young)
    hidden = replace(assumed, body=replace(assumed.body, material=material))
    cameras = [
        Camera.above((0.01, 0.0), 0.27, *at, roll=90, width=960, height=720, focal=862.0, center=(491.0, 352.0))
        for at in ((4, 30), (20, 100), (14, 220))
    ]
    scene = Scene(hidden, (0.01, -0.1, 90.0), hidden.body.thickness or 0.0)
    hung = (Load(name="nut", marker="tip", mass=0.006),)
    for index, (name, pulls, loads) in enumerate(
        (("IMG_1.png", {"up": 0.006}, ()), ("rest.png", {}, ()), ("tip=6g.png", {}, hung))
    ):
        pose = Simulation(replace(hidden, loads=loads)).solve(pulls)
        pixels = photograph(cameras[index], scene.planes(pose.nodes, dict(pose.markers)), seed=index, over=1)
        buffer = BytesIO()
        Image.fromarray(pixels).save(buffer, format="png")
        kept.add(name, buffer.getvalue(), pulls)
    kept.compare()
    assert kept.error == ""
    found = kept.comparison
    assert found is not None
    assert found.measurements.commands[:, 0].tolist() == [0.006, 0.0, 0.0]
    assert set(found.photographs[0].errors) == {"root", "middle", "tip"}
    assert found.photographs[1].overlay.startswith(b"\x89PNG")
    assert kept.find("rest.png") is found.photographs[1]
    kept.start_fit()
    assert kept.error == ""
    fit = kept.fit
    assert fit is not None
    assert fit.after < 0.6 * fit.before
    (young,) = (one for one in fit.values if one.name == "body.young")
    assert young.is_shown
    assert young.value == pytest.approx(material.young, rel=0.15)
    kept.apply()
    assert kept.is_applied
    assert document.robot.body.material.young == pytest.approx(young.value, rel=1e-5)
    assert kept.comparison is None
    document.undo()
    assert document.robot is assumed
    assert kept.comparison is found
    for name in ("IMG_1.png", "rest.png", "tip=6g.png"):
        kept.remove(name)
    kept.add("blank.png", b"no picture", {})
    kept.compare()
    assert "Save it as JPEG or PNG" in kept.error
    assert "/" not in kept.error
