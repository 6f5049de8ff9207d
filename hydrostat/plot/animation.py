"""Animations of any robot: GIF files, whose frames hold only what changes, and MP4 files where ffmpeg is at hand."""

import subprocess
import zlib
from collections.abc import Iterable, Iterator, Sequence
from io import BytesIO
from itertools import chain, pairwise
from pathlib import Path

import numpy as np

from hydrostat.arrays import Bool, UInt8
from hydrostat.drawing import Color
from hydrostat.errors import HydrostatError, InputError
from hydrostat.files import replace_file
from hydrostat.plot.frame import Frame, check_frames
from hydrostat.plot.frame_pictures import FramePictures, Picture
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.progress import Progress
from hydrostat.robot import Robot

STAYS = 3.0
"""A pixel keeps its color until it is off by more than this (of 255, in the channel that differs most): no eye tells,
and smooth shades of a body that moves do not flicker."""

Palette = UInt8[np.ndarray, "colors 3"]
Indices = UInt8[np.ndarray, "_ _"]


def gif_bytes(pictures: Iterable[Picture], palette: Palette, times: Sequence[int]) -> bytes:
    """A GIF of pictures of one size and their times [1/100 s] that plays for ever, in at most 255 colors.

    Pillow's own writer would repeat the palette in every frame and store pixels that stay, which makes files of this
    kind two to three times as large; the pixels of a frame are packed by it.
    """
    height = width = 0
    parts: list[bytes] = []
    last: Indices | None = None
    colors, before, nearest = _NearestColors(palette), None, None
    for picture, time in zip(pictures, times, strict=True):
        height, width, _ = picture.shape
        if before is None or nearest is None:
            nearest = colors.find(picture.reshape(-1, 3)).reshape(height, width)
        else:
            new = _differs(picture, before)
            nearest[new] = colors.find(picture[new])
        before, indices = picture, nearest.copy()
        if last is None:
            box, shown = (0, 0, width, height), indices
        else:
            other = np.nonzero(indices != last)
            near = np.abs(palette[last[other]].astype(np.int16) - picture[other]).max(axis=1) <= STAYS
            still = tuple(places[near] for places in other)
            indices[still] = last[still]
            box, shown = _changed_box(indices, last, len(palette))
        parts.append(_frame(shown, box, time, palette))
        last = indices
    return b"".join(chain([_head(width, height, palette)], parts, [b";"]))


def _differs(one: Picture, two: Picture) -> Bool[np.ndarray, "_ _"]:
    """Mask of the pixels that differ."""
    other = one != two
    return other[..., 0] | other[..., 1] | other[..., 2]


class _NearestColors:
    """Number of the nearest color of a palette; without dithering, so that what rests keeps its pixels."""

    def __init__(self, palette: Palette) -> None:
        from scipy.spatial import KDTree

        self._tree = KDTree(palette.astype(float))
        self._found = np.zeros(1 << 24, dtype=np.uint8)
        self._is_known = np.zeros(1 << 24, dtype=np.bool_)

    def find(self, pixels: UInt8[np.ndarray, "pixels 3"]) -> UInt8[np.ndarray, " pixels"]:
        """Number of the nearest color for each pixel."""
        packed = pixels.astype(np.int32) @ np.array([65536, 256, 1], dtype=np.int32)
        values = np.unique(packed[~self._is_known[packed]])
        colors = np.stack([values >> 16, (values >> 8) & 255, values & 255], axis=1)
        self._found[values], self._is_known[values] = self._tree.query(colors.astype(float))[1], True
        return self._found[packed]


def _changed_box(indices: Indices, last: Indices, clear: int) -> tuple[tuple[int, int, int, int], Indices]:
    """The box of what changes: left, upper, right and lower end; and in it `clear` where a pixel stays."""
    rows, columns = np.nonzero(indices != last)
    if not len(rows):
        return (0, 0, 1, 1), np.full((1, 1), clear, dtype=np.uint8)
    left, upper, right, lower = columns.min(), rows.min(), columns.max() + 1, rows.max() + 1
    inside = slice(upper, lower), slice(left, right)
    shown = np.where(indices[inside] == last[inside], clear, indices[inside]).astype(np.uint8)
    return (int(left), int(upper), int(right), int(lower)), shown


def _head(width: int, height: int, palette: Palette) -> bytes:
    """Size, palette, and that it plays for ever."""
    bits = max(int(np.ceil(np.log2(len(palette) + 1))), 2)  # one number more than colors, for pixels that stay
    table = palette.tobytes().ljust(3 << bits, b"\0")
    size = width.to_bytes(2, "little") + height.to_bytes(2, "little")
    return b"GIF89a" + size + bytes([0x80 | (bits - 1), 0, 0]) + table + b"!\xff\x0bNETSCAPE2.0\x03\x01\0\0\0"


def _frame(shown: Indices, box: tuple[int, int, int, int], time: int, palette: Palette) -> bytes:
    left, upper, right, lower = box
    control = b"!\xf9\x04" + bytes([0x05]) + time.to_bytes(2, "little") + bytes([len(palette), 0])
    sides = [left, upper, right - left, lower - upper]
    return control + b"," + b"".join(side.to_bytes(2, "little") for side in sides) + b"\0" + _pack_frame(shown)


def _pack_frame(shown: Indices) -> bytes:
    """Pixels packed by Pillow: what follows the description of the image in a GIF of its own."""
    from PIL import Image

    image = Image.fromarray(np.ascontiguousarray(shown), mode="L")
    buffer = BytesIO()
    image.save(buffer, format="GIF", optimize=False, interlace=False)
    whole = buffer.getvalue()
    start = 13 + (3 << ((whole[10] & 7) + 1))
    while whole[start : start + 1] == b"!":
        start = _after_blocks(whole, start + 2)
    return whole[start + 10 : _after_blocks(whole, start + 11)]


def _after_blocks(whole: bytes, start: int) -> int:
    """Place behind a chain of blocks that begins at `start`."""
    while whole[start]:
        start += whole[start] + 1
    return start + 1


WIDTHS = (160, 1920)  # least and largest width of a picture [pixels]


def save_gif(
    robot: Robot,
    frames: Sequence[Frame],
    path: str | Path,
    *,
    step: float,
    width: int = 640,
    progress: Progress | None = None,
) -> Path:
    """Write frames at equal times as a GIF that plays for ever, whole or not at all; returns its path.

    One eye, one frame and one scale of tension for all, and one palette, so that nothing trembles or flickers. Frames
    that look the same as the one before are stored once and shown longer. The same frames give the same bytes. The step
    is the time of a frame [s], which a GIF counts in hundredths of a second; the width is in pixels.

    Raises:
        InputError: frames that do not fit the robot, a time or width out of range, a file that cannot be written.
    """
    _check(robot, frames, step, width)
    pictures = list(_draw_frames(robot, frames, width, progress))
    samples = 10  # so many frames, evenly chosen, tell which colors are needed
    some = sorted({int(index) for index in np.linspace(0, len(frames) - 1, samples).round()})
    palette = _palette(robot, [_unpack_frame(pictures[index]) for index in some])
    runs = _runs(pictures)
    ends = np.round(100 * step * np.cumsum([count for _, count in runs])).astype(int)
    times = [int(end - start) for start, end in pairwise([0, *ends])]
    content = gif_bytes((_unpack_frame(packed) for packed, _ in runs), palette, times)
    return replace_file(Path(path), content)


def save_mp4(
    robot: Robot,
    frames: Sequence[Frame],
    path: str | Path,
    *,
    step: float,
    width: int = 640,
    progress: Progress | None = None,
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
    drawn = (_even(_unpack_frame(packed)) for packed in _draw_frames(robot, frames, width, progress))
    first = next(drawn)
    height, wide, _ = first.shape
    with TemporaryDirectory() as folder:
        part = Path(folder) / "part.mp4"
        command = [
            program, "-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
            "-s", f"{wide}x{height}", "-r", f"{1 / step:.9g}", "-i", "-", "-an", "-c:v", "libx264", "-crf", "20",
            "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-fflags", "+bitexact", "-threads", "1", str(part),
        ]  # fmt: skip
        words = _run_ffmpeg(command, first, drawn)
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
    shortest = 0.02  # shortest time of a frame [s]: browsers play shorter ones of a GIF slowly
    if not shortest <= step <= 10:
        raise InputError(f"the time of a frame must be {shortest:g} to 10 s, not {step:g} s")
    if not WIDTHS[0] <= width <= WIDTHS[1]:
        raise InputError(f"the width of a picture must be {WIDTHS[0]} to {WIDTHS[1]} pixels, not {width}")


def _draw_frames(
    robot: Robot, frames: Sequence[Frame], width: int, progress: Progress | None
) -> Iterator[tuple[bytes, tuple]]:
    """Every picture, packed where many are kept: a long film would not fit into memory otherwise."""
    few = len(frames) * width**2 < 1e8
    sheet = FramePictures(robot, frames, width=width)
    last, packed = None, (b"", ())
    for index, frame in enumerate(frames):
        picture = sheet.draw(frame)
        if picture is not last:
            last, packed = picture, (zlib.compress(picture.tobytes(), 0 if few else 1), picture.shape)
        yield packed
        if progress is not None:
            progress("drawing", index + 1, len(frames))


def _unpack_frame(packed: tuple[bytes, tuple]) -> Picture:
    return np.frombuffer(zlib.decompress(packed[0]), dtype=np.uint8).reshape(packed[1])


def _runs(pictures: Sequence[tuple[bytes, tuple]]) -> list[tuple[tuple[bytes, tuple], int]]:
    """Every picture that differs from the one before, and for how many frames it is shown."""
    starts = [index for index in range(len(pictures)) if index == 0 or pictures[index] != pictures[index - 1]]
    return [(pictures[start], end - start) for start, end in pairwise([*starts, len(pictures)])]


def _palette(robot: Robot, pictures: Sequence[Picture]) -> Palette:
    """Colors that suit all pictures: those that tell something as they are, the rest by what is there."""
    from PIL import Image

    scale = TensionScale(most=1.0)
    fixed = [Color.PAPER, Color.INK, Color.MUTED, Color.DARK, Color.ERROR, *Color.of_winches(robot.winches).values()]
    fixed += [scale.color(share) for share in np.linspace(0, 1, 9)]
    told = np.array([Color.channels(color) for color in fixed], dtype=np.uint8)
    told = np.unique(told, axis=0)
    strip = Image.fromarray(np.concatenate([picture[::2, ::2].reshape(-1, 3) for picture in pictures])[None])
    colors = 72  # colors of a GIF, all frames together: what lies between two of felt is not to be told
    found = strip.quantize(colors - len(told), method=Image.Quantize.MEDIANCUT).getpalette() or []
    return np.unique(np.concatenate([told, np.array(found, dtype=np.uint8).reshape(-1, 3)])[:colors], axis=0)


def _even(picture: Picture) -> Picture:
    """A picture whose sides are even, as H.264 wants them: with a white row or column more."""
    height, width, _ = picture.shape
    return np.pad(picture, ((0, height % 2), (0, width % 2), (0, 0)), constant_values=255)


def _run_ffmpeg(command: list[str], first: Picture, rest: Iterator[Picture]) -> str | None:
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
