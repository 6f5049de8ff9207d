"""GIF and MP4 files of robots that move, read by Pillow and by a program that stands for ffmpeg."""

import os
import stat
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from plot.films import flat_film, frames_of, space_film

from hydrostat.drawing import Color
from hydrostat.errors import HydrostatError, InputError
from hydrostat.plot import Film, Frame, Stop, save_gif, save_mp4
from hydrostat.plot.animation import gif_bytes
from hydrostat.plot.frame_pictures import FramePictures
from hydrostat.robot import Load, Robot
from hydrostat.simulation import Simulation

FILMS = {"space": space_film, "flat": flat_film}


def shown(path: Path) -> list[np.ndarray]:
    """What is to be seen in every hundredth of a second, by Pillow's decoder."""
    pictures = []
    with Image.open(path) as image:
        for number in range(getattr(image, "n_frames", 1)):
            image.seek(number)
            pixels = np.asarray(image.convert("RGB")).astype(int)
            pictures += [pixels] * round(image.info["duration"] / 10)
    return pictures


@pytest.mark.parametrize("kind", FILMS)
@pytest.mark.slow
def test_a_gif_lasts_as_long_as_asked_and_moves_when_the_body_does(kind: str, tmp_path: Path) -> None:
    """Oracle: the frames; pixels differ from one to the next just where nodes or words do."""
    robot, made = FILMS[kind]()
    path = save_gif(robot, made.frames, tmp_path / "a.gif", step=made.step, width=320)
    seen = shown(path)
    assert len(seen) == round(100 * made.step * len(made.frames)) == 130
    each = [seen[round(100 * made.step * (number + 0.5))] for number in range(len(made.frames))]
    for one, two, before, after in zip(made.frames, made.frames[1:], each, each[1:], strict=False):
        same = np.array_equal(one.nodes, two.nodes) and one.words == two.words and one.target == two.target
        assert np.array_equal(before, after) == same
    with Image.open(path) as image:
        assert image.info["loop"] == 0
        assert image.size[0] == 320


@pytest.mark.slow
def test_the_same_frames_give_the_same_bytes(tmp_path: Path) -> None:
    robot, made = space_film()
    one = save_gif(robot, made.frames[:4], tmp_path / "one.gif", step=0.1, width=200).read_bytes()
    assert one == save_gif(robot, made.frames[:4], tmp_path / "two.gif", step=0.1, width=200).read_bytes()


@pytest.mark.slow
def test_what_is_held_does_not_tremble() -> None:
    """Oracle: pinned nodes do not move, so neither do pixels of the hatched end, which is at the left; the tip does."""
    robot, made = space_film()
    pictures = FramePictures(robot, made.frames, width=320)
    drawn = np.array([pictures.draw(frame).astype(int) for frame in made.frames])
    moves = np.abs(drawn - drawn[0]).max(axis=(0, 3))[60:]
    body = (drawn[0][60:] < 250).any(axis=2)
    left = int(np.flatnonzero(body.any(axis=0))[0])
    rows = np.flatnonzero(body[:, left + 3 : left + 12].all(axis=1))[4:-4]
    held = slice(rows[0], rows[-1]), slice(left + 3, left + 12)
    assert np.ptp(drawn[0][60:][held]) > 30
    assert moves[held].max() <= 6  # of 255: shade from neighbors that move
    assert moves.max() > 100


def test_a_gif_shows_the_pictures_that_were_drawn() -> None:
    """Oracle: the drawn pixels; with every color in the palette nothing but the tolerance is lost."""
    import io

    rng = np.random.default_rng(3)
    palette = rng.integers(0, 256, (40, 3), dtype=np.uint8)
    pictures = [palette[rng.integers(0, 40, (37, 53))] for _ in range(3)]
    pictures.insert(1, pictures[0].copy())
    pictures[2][:20] = pictures[1][:20]
    with Image.open(io.BytesIO(gif_bytes(pictures, palette, [7, 8, 9, 10]))) as image:
        assert getattr(image, "n_frames", 1) == 4
        for number, (picture, time) in enumerate(zip(pictures, (7, 8, 9, 10), strict=True)):
            image.seek(number)
            assert image.info["duration"] == 10 * time
            assert np.abs(np.asarray(image.convert("RGB")).astype(int) - picture).max() <= 3


def test_a_pixel_stays_while_no_eye_tells() -> None:
    """Oracle: a ramp of single steps is shown within the tolerance, with fewer changes than it has steps."""
    import io

    palette = np.repeat(np.arange(0, 60, dtype=np.uint8)[:, None], 3, axis=1)
    pictures = [np.full((4, 4, 3), level, dtype=np.uint8) for level in range(10, 30)]
    with Image.open(io.BytesIO(gif_bytes(pictures, palette, [5] * 20))) as image:
        levels = []
        for number in range(20):
            image.seek(number)
            levels.append(int(np.asarray(image.convert("RGB"))[0, 0, 0]))
    assert np.abs(np.array(levels) - np.arange(10, 30)).max() <= 3
    assert len(set(levels)) < 8


@pytest.mark.slow
def test_sixty_frames_are_a_small_file(tmp_path: Path) -> None:
    """Oracle: 60 frames of 640 pixels, all of them different, are below 2 MB."""
    robot, made = flat_film()
    way = made.frames[8].nodes - made.frames[0].nodes
    frames = [replace(made.frames[0], nodes=made.frames[0].nodes + share * way) for share in np.linspace(0, 1, 60)]
    path = save_gif(robot, frames, tmp_path / "a.gif", step=0.04)
    assert path.stat().st_size < 2e6
    with Image.open(path) as image:
        assert getattr(image, "n_frames", 1) == 60
        assert image.size[0] == 640


def test_targets_are_shown_while_a_pose_is_approached_and_errors_are_red() -> None:
    robot, made = space_film()
    pictures = FramePictures(robot, made.frames, width=320)
    red = np.array([int(Color.ERROR[start : start + 2], 16) for start in (1, 3, 5)])
    counts = {}
    for frame in made.frames[:4]:
        off = np.abs(pictures.draw(frame).astype(int) - red).max(axis=2)
        counts[frame.target is not None] = int((off < 40).sum())
    assert counts[True] > counts[False] + 5  # the scale of tension has a few of about that color


def test_loads_are_shown() -> None:
    """Oracle: the picture of the robot without its load, which differs."""
    robot, made = flat_film()
    node = robot.body.mesh.nodes[int(np.argmax(robot.body.mesh.nodes[:, 0]))]
    loaded = replace(robot, loads=(Load(name="weight", at=tuple(node.tolist()), force=(0.0, 1e-9)),))
    plain, arrow = (FramePictures(one, made.frames[:1], width=200).draw(made.frames[0]) for one in (robot, loaded))
    assert plain.shape != arrow.shape or not np.array_equal(plain, arrow)


def test_a_frame_is_drawn_alike_whatever_was_drawn_before() -> None:
    robot, made = space_film()
    pictures = FramePictures(robot, made.frames, width=200)
    first = pictures.draw(made.frames[0])
    pictures.draw(made.frames[6])
    assert np.array_equal(pictures.draw(made.frames[0]), first)


def test_a_film_is_made_of_equilibria() -> None:
    """Oracle: the forces left over at each frame's nodes, and no inverted element."""
    robot, made = space_film()
    simulation = Simulation(robot)
    assert made.missing == ()
    assert len(made.frames) == 13
    for frame in made.frames:
        assert frame.contractions is not None
        force = simulation.assembly.gradient(frame.nodes, frame.contractions)
        assert np.abs(force).max() < 1e-6
        corners = frame.nodes[robot.body.mesh.elements]
        assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all()
    assert made.frames[0].nodes == pytest.approx(robot.body.mesh.nodes, abs=1e-12)
    assert made.frames[-1].nodes == pytest.approx(robot.body.mesh.nodes, abs=1e-6)
    furthest = max(made.frames, key=lambda frame: float(np.abs(frame.nodes - robot.body.mesh.nodes).max()))
    assert furthest.contractions == pytest.approx([0.012, 0.0])


def test_where_there_is_no_equilibrium_the_frame_before_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: a solver that never ends beyond 6 mm."""
    robot, _ = space_film()
    solve = Simulation.solve

    def failing(self: Simulation, contractions, **options):
        pose = solve(self, contractions, **options)
        from hydrostat.mechanics import NewtonStatus

        if self.as_contractions(contractions).max() <= 0.006:
            return pose
        return replace(pose, nodes=pose.nodes + 1.0, result=replace(pose.result, status=NewtonStatus.NO_DESCENT))

    monkeypatch.setattr(Simulation, "solve", failing)
    stop = Stop.for_winches(robot)[0]
    made = Film.of_stops(Simulation(robot), [stop], seconds=1.3, step=0.1)
    assert made.missing
    for number in made.missing:
        assert np.array_equal(made.frames[number].nodes, made.frames[number - 1].nodes)
    assert max(np.abs(frame.nodes - robot.body.mesh.nodes).max() for frame in made.frames) < 0.1


def test_without_poses_each_winch_in_turn() -> None:
    """Oracle: half the travel, but never less than 70 % of the cable left."""
    robot = space_film()[0]
    stops = Stop.for_winches(robot)
    assert len(stops) == 2
    for index, (stop, winch) in enumerate(zip(stops, robot.winches, strict=True)):
        assert stop.contractions[index] == pytest.approx(min(winch.travel / 2, 0.3 * robot.cables[index].length))
        assert np.count_nonzero(stop.contractions) == 1


def bad_frames(robot: Robot) -> dict[str, tuple[list[Frame], dict[str, float]]]:
    good = frames_of(robot, 2)
    return {
        "at least one frame": ([], {}),
        "frame 1: its nodes": ([good[0], replace(good[0], nodes=np.zeros((3, 3)))], {}),
        "frame 0: its tensions": ([replace(good[0], tensions=np.array([np.nan, 0.0]))], {}),
        "frame 0: its contractions": ([replace(good[0], contractions=np.zeros(5))], {}),
        "0.02 to 10 s": (good, {"step": 0.001}),
        "160 to 1920": (good, {"width": 5}),
    }


@pytest.mark.parametrize("fragment", bad_frames(space_film()[0]))
def test_one_clear_line(fragment: str, tmp_path: Path) -> None:
    robot = space_film()[0]
    frames, options = bad_frames(robot)[fragment]
    with pytest.raises(InputError, match=fragment):
        save_gif(robot, frames, tmp_path / "a.gif", **{"step": 0.1, **options})  # pyright: ignore[reportArgumentType]
    assert not list(tmp_path.iterdir())


FAKE = """#!{python}
import pathlib, sys
count = len(sys.stdin.buffer.read())
if "{fails}":
    sys.stderr.write("line one\\nno encoder of that name\\n")
    sys.exit(3)
size = sys.argv[sys.argv.index("-s") + 1]
rate = sys.argv[sys.argv.index("-r") + 1]
pathlib.Path(sys.argv[-1]).write_text(f"{{count}} {{size}} {{rate}}")
"""


def fake_ffmpeg(folder: Path, monkeypatch: pytest.MonkeyPatch, *, fails: str = "") -> None:
    program = folder / "ffmpeg"
    program.write_text(FAKE.format(python=sys.executable, fails=fails))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(folder) + os.pathsep + os.environ["PATH"])


@pytest.mark.slow
def test_every_frame_goes_to_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: bytes are frames x height x width x 3, all sides even; the rate is that of the frames."""
    fake_ffmpeg(tmp_path, monkeypatch)
    robot, made = flat_film()
    count, size, rate = save_mp4(robot, made.frames, tmp_path / "a.mp4", step=0.1, width=321).read_text().split()
    width, height = map(int, size.split("x"))
    assert width == 322
    assert height % 2 == 0
    assert int(count) == len(made.frames) * width * height * 3
    assert float(rate) == 10


def test_ffmpegs_last_word_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake_ffmpeg(tmp_path, monkeypatch, fails="yes")
    robot = flat_film()[0]
    with pytest.raises(HydrostatError, match="no encoder of that name"):
        save_mp4(robot, frames_of(robot, 2), tmp_path / "a.mp4", step=0.1, width=160)
    assert not (tmp_path / "a.mp4").exists()


def test_without_ffmpeg_the_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    robot = flat_film()[0]
    with pytest.raises(InputError, match="apt-get install ffmpeg"):
        save_mp4(robot, frames_of(robot, 2), tmp_path / "a.mp4", step=0.1)
