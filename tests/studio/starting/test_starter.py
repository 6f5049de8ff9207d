"""How work begins, without a screen."""

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.robot import gallery_folder, list_gallery, load_robot, save_robot
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.starting.draft import new_draft
from hydrostat.studio.starting.shelf import PICTURES, draw_picture, gallery_cards, robots_in, suggestions
from hydrostat.studio.starting.sketch import make_sketch
from hydrostat.studio.starting.starter import Starter

SQUARE = b'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">%s</svg>'
BAR = SQUARE % b'<rect width="100" height="60"/>'


class Desk:
    """A starter, and a way to wait for what it does in another process."""

    def __init__(self, state: Path | None = None) -> None:
        self.bell = Bell()
        self.document = Document(self.bell)
        self.jobs = Jobs(self.bell)
        self.starter = Starter(self.document, self.jobs, state)
        self._rung = threading.Condition()
        self.bell.listen(self._hear)

    def _hear(self, topic: Topic) -> None:
        with self._rung:
            self._rung.notify_all()

    def wait(self, ready: Callable[[], bool]) -> None:
        with self._rung:
            assert self._rung.wait_for(ready, timeout=300)

    def settle(self) -> None:
        self.wait(lambda: not self.starter.is_meshing)


@pytest.fixture
def desk() -> Iterator[Desk]:
    made = Desk()
    yield made
    made.jobs.close()
    made.document.judge.skins.close()


TWO = SQUARE % b'<rect x="2" y="2" width="50" height="50"/><rect x="60" y="5" width="35" height="40"/>'


@pytest.mark.slow
def test_a_drawing_of_two_parts_offers_both(desk: Desk) -> None:
    """Oracle: the sizes of both rectangles; the choice stays when another number is asked for."""
    desk.starter.bring("two.svg", TWO)
    desk.settle()
    assert desk.starter.problem.endswith("Click the one that is the body")
    choice = desk.starter.choice
    assert choice is not None
    assert sorted(round(float((ring.max(axis=0) - ring.min(axis=0)).max())) for ring in choice.rings.values()) == [
        40,
        50,
    ]
    desk.starter.revise(part=2)
    desk.settle()
    desk.starter.revise(thickness=0.02)
    desk.settle()
    assert desk.starter.sketch is not None
    assert desk.starter.sketch.robot.body.drawing_part == 2
    assert desk.starter.sketch.robot.body.outline.size == pytest.approx(0.04)
    assert 'data-part="2" class="start-part-chosen"' in choice.picture(2)


def test_each_gallery_robot_has_a_small_picture_and_words() -> None:
    """Oracle: the gallery itself."""
    cards = gallery_cards()
    assert sorted(card.name for card in cards) == list_gallery()
    for card in cards:
        assert card.picture is not None, f"run python -m hydrostat.studio.starting.shelf for {card.name}"
        assert 500 < card.picture.stat().st_size <= 15_000
        robot = load_robot(card.folder) if card.name == "starfish" else None
        if robot is not None:
            assert card.words == f"flat, {len(robot.winches)} winches, {len(robot.cables)} cables"
    assert {path.stem for path in PICTURES.glob("*.webp")} == set(list_gallery())


@pytest.mark.slow
def test_pictures_are_of_the_robots_as_they_are() -> None:
    """Oracle: the picture drawn again; another robot's differs a lot."""
    from io import BytesIO

    import numpy as np
    from PIL import Image

    drawn = draw_picture(gallery_robot("starfish"))

    def pixels(content: bytes) -> np.ndarray:
        return np.asarray(Image.open(BytesIO(content)).convert("RGBA"), dtype=float)

    fresh = pixels(drawn)
    assert np.abs(fresh - pixels((PICTURES / "starfish.webp").read_bytes())).mean() < 3
    assert np.abs(fresh - pixels((PICTURES / "pig.webp").read_bytes())).mean() > 10


def test_a_gallery_robot_is_opened_as_a_copy(desk: Desk) -> None:
    """Oracle: the robot read from its folder; there is no folder to save to."""
    desk.starter.open_gallery(gallery_folder("starfish"))
    assert desk.document.robot == gallery_robot("starfish")
    assert desk.document.folder is None
    assert desk.document.is_saved


def test_a_folder_is_opened_and_remembered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: what was saved; another studio later lists it first."""
    robot = gallery_robot("letter_e")
    save_robot(robot, tmp_path / "shelf" / "mine")
    save_robot(robot, tmp_path / "shelf" / "other")
    monkeypatch.chdir(tmp_path / "shelf")
    desk = Desk(tmp_path / "state")
    assert [card.name for card in desk.starter.recent()] == ["mine", "other"]
    desk.starter.open_folder(str(tmp_path / "shelf" / "other" / "robot.toml"))
    assert desk.document.folder == tmp_path / "shelf" / "other"
    assert desk.document.robot == robot
    assert [card.name for card in Desk(tmp_path / "state").starter.recent()] == ["other", "mine"]


@pytest.mark.slow
def test_robots_are_listed_once_and_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: three folders, one of which has a second way to it, two of which have one name."""
    robot = gallery_robot("letter_e")
    for place in ("here/mine", "there/mine", "there/other"):
        save_robot(robot, tmp_path / place)
    (tmp_path / "here" / "also").symlink_to(tmp_path / "there" / "mine")
    monkeypatch.chdir(tmp_path / "here")
    desk = Desk(tmp_path / "state")
    desk.starter.open_folder(str(tmp_path / "there" / "other"))
    desk.starter.open_folder(str(tmp_path / "there" / "mine"))
    assert [card.name for card in desk.starter.recent()] == ["there/mine", "other", "here/mine"]


@pytest.mark.parametrize("text", ["", "  ", "/no/such/folder", "a\0b", "x" * 5000, "~nobody_here/x"])
def test_a_folder_that_is_none_is_one_line(desk: Desk, text: str) -> None:
    """Oracle: one line, and nothing is open."""
    with pytest.raises(InputError) as error:
        desk.starter.open_folder(text)
    assert "\n" not in str(error.value)
    assert not desk.document.is_open


def test_a_broken_list_of_recent_robots_is_no_reason_to_stop(tmp_path: Path) -> None:
    """Oracle: an empty list."""
    (tmp_path / "recent.json").write_text('{"a": ')
    assert Desk(tmp_path).starter.recent() == robots_in(Path.cwd())


def test_suggestions_show_robots_first(tmp_path: Path) -> None:
    """Oracle: the folders that were made."""
    for name in ("aa", "ab", "zz"):
        (tmp_path / name).mkdir()
    save_robot(gallery_robot("letter_e"), tmp_path / "ac")
    assert suggestions(str(tmp_path / "a")) == [str(tmp_path / name) for name in ("ac", "aa", "ab")]
    assert suggestions("/no/such/place/a") == []
    assert suggestions("a\0b") == []


@pytest.mark.slow
def test_a_drawing_becomes_a_robot(desk: Desk) -> None:
    """Oracle: the drawing's own size, and what was asked for."""
    desk.starter.bring("My bar.svg", BAR)
    desk.settle()
    sketch = desk.starter.sketch
    assert desk.starter.problem == ""
    assert sketch is not None
    assert "<svg" in sketch.picture
    assert sketch.robot.body.mesh.size == pytest.approx(0.1)
    desk.starter.revise(material="ecoflex 00-30")
    assert not desk.starter.is_meshing, "a material needs no new mesh"
    desk.starter.revise(thickness=0.02, nodes=120, size=0.3)
    desk.settle()
    desk.starter.make()
    robot = desk.document.robot
    assert (robot.body.thickness, robot.body.material.name) == (0.02, "ecoflex 00-30")
    assert robot.body.mesh.size == pytest.approx(0.3)
    assert abs(len(robot.body.mesh.nodes) / 120 - 1) < 0.15
    assert robot.name == "My_bar"
    assert not desk.document.is_saved
    assert desk.document.folder is None
    assert desk.starter.draft is None


def test_the_gallery_is_opened_by_name_as_a_copy(desk: Desk) -> None:
    """Oracle: the gallery; Save would ask for a folder."""
    desk.starter.open_folder(" gallery:letter_e ")
    assert desk.document.robot == load_robot("gallery:letter_e")
    assert desk.document.folder is None
    with pytest.raises(InputError, match='unknown gallery robot "nobody"'):
        desk.starter.open_folder("gallery:nobody")


@pytest.mark.slow
def test_other_numbers_in_a_row_end_with_the_last(desk: Desk) -> None:
    """Oracle: the last size asked for, while the first mesh is still made."""
    desk.starter.bring("bar.svg", BAR)
    desk.starter.revise(size=0.2)
    desk.starter.revise(size=0.4)
    with pytest.raises(InputError, match="Wait a moment"):
        desk.starter.make()
    desk.settle()
    assert desk.starter.is_current
    assert desk.starter.sketch is not None
    assert desk.starter.sketch.robot.body.mesh.size == pytest.approx(0.4)


@pytest.mark.slow
def test_a_dirty_surface_comes_with_its_repair(desk: Desk) -> None:
    """Oracle: a gallery body with a hole cut into it; the report names it, and a picture shows it."""
    lines = _tetrahedron_text()
    desk.starter.bring("dirty.stl", lines)
    desk.settle()
    sketch = desk.starter.sketch
    assert desk.starter.problem == ""
    assert sketch is not None
    assert not sketch.clean
    assert any("flipped" in line or "turned" in line for line in sketch.lines), sketch.lines
    assert "<svg" in sketch.repair
    assert desk.starter.skin is None, "foam has no skin"
    desk.starter.revise(material="polyester fibre")
    skin = desk.starter.skin
    assert skin is not None, "it is being laid flat"
    desk.starter.make()
    assert desk.document.judge.skin(desk.document.robot) is skin
    assert desk.document.robot.body.mesh.dim == 3
    assert desk.document.robot.poses == {}, "poses are made by a person"


@pytest.mark.slow
def test_a_wrong_number_is_refused_and_nothing_is_lost(desk: Desk) -> None:
    """Oracle: the sketch is as it was."""
    desk.starter.bring("bar.svg", BAR)
    desk.settle()
    sketch = desk.starter.sketch
    for wrong in ({"size": 0.0}, {"size": -1.0}, {"size": 1e9}, {"nodes": 3}, {"material": "cheese"}):
        with pytest.raises(InputError):
            desk.starter.revise(**wrong)
    assert desk.starter.sketch is sketch
    desk.starter.make()


def test_another_job_is_told_of(desk: Desk) -> None:
    """Oracle: the problem names what is in progress."""
    desk.jobs.start("Designing cables", make_sketch, new_draft("other.svg", BAR))
    desk.starter.bring("bar.svg", BAR)
    assert "Designing cables is still running" in desk.starter.problem
    assert not desk.starter.is_meshing


def _tetrahedron_text() -> bytes:
    """A box 60 x 40 x 40 mm of twelve triangles, one of which is turned over."""
    from itertools import product

    import numpy as np

    corners = np.array(list(product((0, 60), (0, 40), (0, 40))), dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    triangles[3] = triangles[3][::-1]
    text = ["solid box"]
    for triangle in triangles:
        text += ["facet normal 0 0 0", "outer loop", *("vertex {} {} {}".format(*corners[i]) for i in triangle)]
        text += ["endloop", "endfacet"]
    return "\n".join([*text, "endsolid box"]).encode()
