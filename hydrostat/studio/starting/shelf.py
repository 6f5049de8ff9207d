"""`Recent`, `gallery_cards`, `robots_in`: robots to choose from, told without reading their bodies."""

import io
import json
import os
import sys
import tomllib
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from PIL import Image

from hydrostat.errors import HydrostatError
from hydrostat.files import replace_file
from hydrostat.plot import draw_portrait, drawing
from hydrostat.robot import Robot, gallery_folder, list_gallery, load_robot
from hydrostat.units import plural

PICTURES = Path(__file__).parent / "pictures"  # where the pictures are, as NAME.webp


def draw_picture(robot: Robot) -> bytes:
    """The robot at rest on clear ground, so that it may stand on light and dark pages, as WebP."""
    buffer = io.BytesIO()
    figure = draw_portrait(robot, robot.body.mesh.nodes)
    with drawing():
        figure.savefig(buffer, format="png", dpi=300, transparent=True)
    image = Image.open(buffer).convert("RGBA")
    image = image.crop(image.getchannel("A").getbbox())
    wide, high = 400, 300  # pixels of a picture; it is shown half as large
    border = 16  # pixels that are left free all round
    image.thumbnail((wide - 2 * border, high - 2 * border), Image.Resampling.LANCZOS)
    sheet = Image.new("RGBA", (wide, high), (0, 0, 0, 0))
    sheet.paste(image, ((wide - image.width) // 2, (high - image.height) // 2))
    result = io.BytesIO()
    sheet.save(result, format="WEBP", quality=70, method=6)
    return result.getvalue()


def main() -> None:
    """Draw all robots of the gallery."""
    PICTURES.mkdir(exist_ok=True)
    for name in list_gallery():
        replace_file(PICTURES / f"{name}.webp", draw_picture(load_robot(gallery_folder(name))))


if __name__ == "__main__":
    main()


MAX_SEEN, MAX_SHOWN = 500, 24  # entries of a folder that are searched, and robots in it that are shown


@dataclass(frozen=True, kw_only=True)
class Card:
    """A robot to choose."""

    name: str  # of the robot
    folder: Path  # where it is
    words: str  # what it is, such as "flat, 4 winches, 8 cables"
    picture: Path | None = None  # WebP file of it; None: there is none


def gallery_cards() -> list[Card]:
    """All robots that come with hydrostat, flat ones first."""
    cards = [
        Card(name=name, folder=gallery_folder(name), words=_words(gallery_folder(name)), picture=_picture(name))
        for name in list_gallery()
    ]
    return sorted(cards, key=lambda card: (not card.words.startswith("flat"), card.name))


def robots_in(folder: Path) -> list[Card]:
    """Robots in the folders of a folder, or the robot that it is; none if it cannot be read."""
    if is_robot(folder):
        return [card_of(folder)]
    found: list[Path] = []
    with suppress(OSError):
        found = sorted(path for path in islice(folder.iterdir(), MAX_SEEN) if is_robot(path))
    return [card_of(path) for path in found[:MAX_SHOWN]]


def distinguish_cards(cards: list[Card]) -> list[Card]:
    """Each folder once, the first place counts; those of one name are told with the folder they are in."""
    once: dict[Path, Card] = {}
    for card in cards:
        once.setdefault(card.folder.resolve(), card)
    names = Counter(card.name for card in once.values())
    return [
        replace(card, name=f"{folder.parent.name}/{card.name}") if names[card.name] > 1 else card
        for folder, card in once.items()
    ]


def suggestions(text: str) -> list[str]:
    """Folders that a path which is being typed may mean: those with a robot, and those on the way."""
    path = Path(text).expanduser() if text.strip() else Path.cwd()
    parent, start = (path, "") if text.endswith(("/", "\\")) or not text.strip() else (path.parent, path.name)
    found: list[Path] = []
    with suppress(OSError, ValueError):
        entries = (entry for entry in islice(parent.iterdir(), MAX_SEEN) if not entry.name.startswith("."))
        found = [entry for entry in entries if entry.name.startswith(start) and entry.is_dir()]
    found.sort(key=lambda entry: (not is_robot(entry), entry.name))
    return [str(entry) for entry in found[:MAX_SHOWN]]


def is_robot(folder: Path) -> bool:
    """Return True if a folder holds a robot."""
    try:
        return (folder / "robot.toml").is_file()
    except (OSError, ValueError):
        return False


def card_of(folder: Path) -> Card:
    """Return the card of a robot's folder."""
    return Card(name=folder.name, folder=folder, words=_words(folder))


def _picture(name: str) -> Path | None:
    path = PICTURES / f"{name}.webp"
    return path if path.is_file() else None


def _words(folder: Path) -> str:
    """Summary of robot.toml in a few words; "" if it cannot be read."""
    try:
        table = tomllib.loads((folder / "robot.toml").read_text(encoding="utf-8"))
        kind = "flat" if "outline" in table["body"] else "in space"
        parts = [plural(len(table.get(key, [])), key) for key in ("winch", "cable", "drive")]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return ""
    return ", ".join([kind, *(part for part in parts if not part.startswith("0 "))])


MAX_RECENT = 12  # robots in the list of recent ones


class Recent:
    """A short list in a file."""

    def __init__(self, file: Path | None) -> None:
        """Remember in a file; None: nowhere."""
        self._file = file

    def folders(self) -> list[Path]:
        """Folders that still hold a robot, the latest first."""
        return [folder for folder in self._read() if (folder / "robot.toml").is_file()]

    def add(self, folder: Path) -> None:
        """Put a folder first; that it cannot be remembered is no reason to stop."""
        if self._file is None:
            return
        folder = folder.resolve()
        folders = [folder, *(other for other in self._read() if other != folder)][:MAX_RECENT]
        with suppress(OSError, HydrostatError):
            self._file.parent.mkdir(parents=True, exist_ok=True)
            replace_file(self._file, json.dumps([str(folder) for folder in folders]).encode())

    def _read(self) -> list[Path]:
        if self._file is None:
            return []
        with suppress(OSError, ValueError):
            known = json.loads(self._file.read_text(encoding="utf-8"))
            if isinstance(known, list):
                return [Path(path) for path in known if isinstance(path, str)][:MAX_RECENT]
        return []


def state_folder() -> Path:
    """The folder of this person's studio; it need not be there yet."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(Path.home() / "AppData" / "Local")
    else:
        base = os.environ.get("XDG_STATE_HOME") or str(Path.home() / ".local" / "state")
    return Path(base) / "hydrostat" / "studio"
