"""`BodyDraft`: what a robot is to be made of, and with which numbers."""

import re
from dataclasses import dataclass, field
from pathlib import PurePath

from hydrostat.errors import InputError
from hydrostat.geometry import OUTLINE_SUFFIXES, STEP_SUFFIXES, SURFACE_SUFFIXES, Inner
from hydrostat.given import check_name
from hydrostat.robot import Material, get_material
from hydrostat.units import quote

UPLOAD_SUFFIXES = (*OUTLINE_SUFFIXES, *SURFACE_SUFFIXES, *STEP_SUFFIXES)  # endings of files that may be brought
MAX_BYTES = 190_000_000  # of a file that is brought; with what goes round it, no request has more than 200 MB
PICTURES = (".png", ".jpg", ".jpeg")  # endings of files of pixels
_CAD = (".iges", ".igs", ".f3d", ".sldprt")

THRESHOLDS = (5.0, 250.0)  # least and most difference in color from the ground that may be asked for, of 441
SMOOTHINGS = (0.0, 20.0)  # likewise how far the edge is smoothed [pixels]


@dataclass(frozen=True, kw_only=True)
class PhotoReading:
    """Settings for tracing a picture; automatic by default."""

    threshold: float | None = None  # what differs from the ground by more is body; None: found in the picture
    smoothing: float = 0.0  # edges are smoothed over so many pixels of at most 1600

    @property
    def plain(self) -> bool:
        """True if all settings are automatic."""
        return self.threshold is None and self.smoothing == 0


@dataclass(frozen=True, kw_only=True)
class BodyDraft:
    """A drawing or a surface, and what is asked of the robot made of it; None where nothing is asked.

    Raises:
        InputError: a number out of its range, or an unknown material.
    """

    file: str  # name of the file, made safe by `safe_name`
    content: bytes = field(repr=False)  # its bytes
    name: str  # of the robot
    material: str  # a name of the table
    size: float | None = None  # longest side [m]
    element_size: float | None = None  # length of a mesh edge [m]
    nodes: int | None = None  # about so many; not used with an element size
    thickness: float | None = None  # of a flat body [m]
    inflate: float | None = None  # thickness to blow a drawing up to [m]
    inner: Inner = Inner.HOLES  # what shapes within a drawing are
    part: int | None = None  # number of the shape of a drawing or STEP file that is the body; 1 is the largest
    reading: PhotoReading = PhotoReading()  # of a picture

    def __post_init__(self) -> None:
        get_material(self.material)
        check_name(self.name)
        longest, shortest = 20.0, 1e-4  # lengths that a person may ask for [m]
        for key in ("size", "element_size", "thickness", "inflate"):
            value = getattr(self, key)
            if value is not None and not shortest <= value <= longest:
                raise InputError(
                    f"{key.replace('_', ' ')}: must be from {1e3 * shortest:g} mm to {longest:g} m, "
                    f"not {1e3 * value:g} mm"
                )
        asked = (("threshold", self.reading.threshold, THRESHOLDS), ("smoothing", self.reading.smoothing, SMOOTHINGS))
        for key, value, (least, most) in asked:
            if value is not None and not least <= value <= most:
                raise InputError(f"{key}: must be from {least:g} to {most:g}, not {value:g}")
        nodes = (20, 20_000)  # so few and so many nodes may be asked for
        if self.nodes is not None and not nodes[0] <= self.nodes <= nodes[1]:
            raise InputError(f"nodes: must be from {nodes[0]} to {nodes[1]}, not {self.nodes}")

    @property
    def is_picture(self) -> bool:
        """True if the file is a photograph or another picture of pixels."""
        return self.file.endswith(PICTURES)

    @property
    def is_drawing(self) -> bool:
        """True if the file is a drawing or picture, not a surface in space."""
        return self.file.endswith(OUTLINE_SUFFIXES)


def new_draft(name: str, content: bytes) -> BodyDraft:
    """A draft of a file that a person brings, nothing asked yet (InputError: empty, too large, or of no known kind)."""
    file = safe_name(name)
    if not content:
        raise InputError(f"{file}: file is empty. Export it again")
    if len(content) > MAX_BYTES:
        raise InputError(f"{file}: has {len(content) / 1e6:.0f} MB, at most {MAX_BYTES / 1e6:.0f} MB are read")
    material = "polyester fibre" if file.endswith(OUTLINE_SUFFIXES) else "flexfoam-it x"
    picture_size = 0.2  # of a body from a picture, which says no size, until another is asked for [m]
    size = picture_size if file.endswith(PICTURES) else None
    return BodyDraft(file=file, content=content, name=_robot_name(PurePath(file).stem), material=material, size=size)


def safe_name(name: str) -> str:
    """A plain file name of what a browser says: no folder, no strange letters, short (InputError: a wrong ending)."""
    plain = re.split(r"[/\\]", name)[-1]
    stem, dot, ending = plain.rpartition(".")
    suffix = (dot + ending).lower()
    if suffix not in UPLOAD_SUFFIXES:
        shown = quote(plain if len(plain) <= 60 else plain[:28] + "..." + plain[-28:])
        if suffix in _CAD:
            raise InputError(f"{shown}: this CAD format is not supported. Export it as STEP, STL or 3MF")
        raise InputError(f"{shown}: file type not supported. Available: {', '.join(UPLOAD_SUFFIXES)}")
    longest_stem = 40
    stem = re.sub(r"[^\w-]+", "_", stem)[:longest_stem].strip("_-")
    return (stem or "body") + suffix


def _robot_name(stem: str) -> str:
    try:
        return check_name(stem)
    except InputError:
        return "robot"


_SOFTNESS = ((20e3, "as soft as jelly"), (100e3, "soft"), (500e3, "rather firm"), (2e6, "firm"))


def material_words(material: Material) -> str:
    """Describe a material: "soft, Young's modulus 30 kPa, 40 kg/m3, may be squeezed by 60 % and stretched by 50 %"."""
    feel = next((words for most, words in _SOFTNESS if material.young < most), "stiff")
    words = f"{feel}, Young's modulus {material.young_text}, {material.density:.0f} kg/m³"
    if material.largest_squeeze is None or material.largest_stretch is None:
        return words
    squeeze, stretch = 100 * material.largest_squeeze, 100 * (material.largest_stretch - 1)
    return f"{words}, may be squeezed by {squeeze:.0f} % and stretched by {stretch:.0f} %"
