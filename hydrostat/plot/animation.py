"""Animations of any robot: GIF files, and MP4 files where ffmpeg is at hand."""

import subprocess
import zlib
from collections.abc import Callable, Iterator, Sequence
from itertools import chain, pairwise
from pathlib import Path

import numpy as np

from hydrostat.drawing.palette import DARK, ERROR, INK, MUTED, PAPER, channels, winch_colours
from hydrostat.errors import HydrostatError, InputError
from hydrostat.plot.frame import Frame, check_frames
from hydrostat.plot.frame_pictures import FramePictures, Picture
from hydrostat.plot.gif import Palette, gif_bytes
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import Robot, replace_file

Tell = Callable[[str, int, int], None]  # is told the stage, how much of it is done, and how much there is
COLOURS = 72  # colours of a GIF, all frames together: what lies between two of felt is not to be told
SAMPLES = 10  # so many frames, evenly chosen, tell which colours are needed
WIDTHS = (160, 1920)  # least and largest width of a picture [pixels]
SHORTEST = 0.02  # shortest time of a frame [s]: browsers play shorter ones of a GIF slowly


def save_gif(
    robot: Robot,
    frames: Sequence[Frame],
    path: str | Path,
    *,
    step: float,
    width: int = 640,
    tell: Tell | None = None,
) -> Path:
    """Write frames as a GIF that plays for ever, whole or not at all; returns its path.

    One eye, one frame and one scale of tension for all, and one palette, so that nothing trembles or flickers. Frames
    that look the same as the one before are stored once and shown longer. The same frames give the same bytes.

    Args:
        robot: to draw.
        frames: at equal times.
        path: of the file.
        step: time of a frame [s]; a GIF counts in hundredths of a second.
        width: of the picture [pixels].
        tell: is told how far the work is.

    Raises:
        InputError: frames that do not fit the robot, a time or width out of range, a file that cannot be written.
    """
    _check(robot, frames, step, width)
    pictures = list(_drawn(robot, frames, width, tell))
    some = sorted({int(index) for index in np.linspace(0, len(frames) - 1, SAMPLES).round()})
    palette = _palette(robot, [_unpacked(pictures[index]) for index in some])
    runs = _runs(pictures)
    ends = np.round(100 * step * np.cumsum([count for _, count in runs])).astype(int)
    times = [int(end - start) for start, end in pairwise([0, *ends])]
    content = gif_bytes((_unpacked(packed) for packed, _ in runs), palette, times)
    return replace_file(Path(path), content)


def save_mp4(
    robot: Robot,
    frames: Sequence[Frame],
    path: str | Path,
    *,
    step: float,
    width: int = 640,
    tell: Tell | None = None,
) -> Path:
    """Write frames as an MP4 (H.264), whole or not at all; returns its path. It needs the program ffmpeg.

    Arguments are those of `save_gif`, and so are errors, but for these.

    Raises:
        InputError: there is no ffmpeg.
        HydrostatError: ffmpeg failed; its last line says why.
    """
    from tempfile import TemporaryDirectory

    program = find_ffmpeg()
    _check(robot, frames, step, width)
    drawn = (_even(_unpacked(packed)) for packed in _drawn(robot, frames, width, tell))
    first = next(drawn)
    height, wide, _ = first.shape
    with TemporaryDirectory() as folder:
        part = Path(folder) / "part.mp4"
        command = [
            program, "-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
            "-s", f"{wide}x{height}", "-r", f"{1 / step:.9g}", "-i", "-", "-an", "-c:v", "libx264", "-crf", "20",
            "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-fflags", "+bitexact", "-threads", "1", str(part),
        ]  # fmt: skip
        words = _piped(command, first, drawn)
        if words is not None or not part.is_file():
            raise HydrostatError(f"ffmpeg could not write the film: {words or 'it left no file'}")
        return replace_file(Path(path), part.read_bytes())


def find_ffmpeg() -> str:
    """Find the program ffmpeg; returns its path (InputError: it is not there)."""
    import shutil

    program = shutil.which("ffmpeg")
    if program is None:
        raise InputError("an MP4 needs the program ffmpeg (on Debian: apt-get install ffmpeg); GIF and GLB do without")
    return program


def _check(robot: Robot, frames: Sequence[Frame], step: float, width: int) -> None:
    check_frames(robot, frames)
    if not SHORTEST <= step <= 10:
        raise InputError(f"the time of a frame must be {SHORTEST:g} to 10 s, not {step:g} s")
    if not WIDTHS[0] <= width <= WIDTHS[1]:
        raise InputError(f"the width of a picture must be {WIDTHS[0]} to {WIDTHS[1]} pixels, not {width}")


def _drawn(robot: Robot, frames: Sequence[Frame], width: int, tell: Tell | None) -> Iterator[tuple[bytes, tuple]]:
    """Every picture, packed: a long film would not fit into memory otherwise."""
    sheet = FramePictures(robot, frames, width=width)
    last, packed = None, (b"", ())
    for index, frame in enumerate(frames):
        picture = sheet.draw(frame)
        if picture is not last:
            last, packed = picture, (zlib.compress(picture.tobytes(), 1), picture.shape)
        yield packed
        if tell is not None:
            tell("drawing", index + 1, len(frames))


def _unpacked(packed: tuple[bytes, tuple]) -> Picture:
    return np.frombuffer(zlib.decompress(packed[0]), dtype=np.uint8).reshape(packed[1])


def _runs(pictures: Sequence[tuple[bytes, tuple]]) -> list[tuple[tuple[bytes, tuple], int]]:
    """Every picture that differs from the one before, and for how many frames it is shown."""
    starts = [index for index in range(len(pictures)) if index == 0 or pictures[index] != pictures[index - 1]]
    return [(pictures[start], end - start) for start, end in pairwise([*starts, len(pictures)])]


def _palette(robot: Robot, pictures: Sequence[Picture]) -> Palette:
    """Colours that suit all pictures: those that tell something as they are, the rest by what is there."""
    from PIL import Image

    scale = TensionScale(most=1.0)
    fixed = [PAPER, INK, MUTED, DARK, ERROR, *winch_colours(robot.winches).values()]
    fixed += [scale.colour(share) for share in np.linspace(0, 1, 9)]
    told = np.array([channels(colour) for colour in fixed], dtype=np.uint8)
    told = np.unique(told, axis=0)
    strip = Image.fromarray(np.concatenate([picture[::2, ::2].reshape(-1, 3) for picture in pictures])[None])
    found = strip.quantize(COLOURS - len(told), method=Image.Quantize.MEDIANCUT).getpalette() or []
    return np.unique(np.concatenate([told, np.array(found, dtype=np.uint8).reshape(-1, 3)])[:COLOURS], axis=0)


def _even(picture: Picture) -> Picture:
    """A picture whose sides are even, as H.264 wants them: with a white row or column more."""
    height, width, _ = picture.shape
    return np.pad(picture, ((0, height % 2), (0, width % 2), (0, 0)), constant_values=255)


def _piped(command: list[str], first: Picture, rest: Iterator[Picture]) -> str | None:
    """Run ffmpeg on pictures; its last words where it failed."""
    from tempfile import TemporaryFile

    with TemporaryFile() as log:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=log)
        try:
            assert process.stdin is not None
            for picture in chain([first], rest):
                process.stdin.write(np.ascontiguousarray(picture).tobytes())
            process.stdin.close()
            code = process.wait()
        except BrokenPipeError:
            code = process.wait() or 1
        except BaseException:
            process.kill()
            process.wait()
            raise
        log.seek(0)
        lines = log.read().decode(errors="replace").strip().splitlines()
    return None if code == 0 else (lines[-1] if lines else f"exit code {code}")
