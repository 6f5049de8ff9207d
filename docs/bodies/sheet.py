"""`Sheet`: all that is written of one robot in space, as robot.toml with words for people."""

import json
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bodies.field import Place
from bodies.ply import decimated, ply_bytes
from hydrostat.geometry import Surface
from hydrostat.robot import Robot

POSES = Path(__file__).parent / "poses.json"
"""Where the markers of each robot are in its poses [mm], as simulated."""

SQUEEZE = 0.55
"""Foam is not known to bear more than 60 % along the whole of a cable."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """A cable with its winch; of several with the same name the first one tells where the winch is.

    Attributes:
        name: of the winch.
        words: what it does.
        points: from the winch to the stopper [m].
        sheath: index of the point up to which the cable runs in a tube; 0 if there is none.
        travel: the most the winch can take in [mm]; if left out as much as foam can be squeezed along the cable.
        mount: where the winch sits, "world" or "body".
        stiffness: of the cable [N/mm]; if left out that of `Cable`.
        release: the most the winch can pay out beyond the rest length [mm].
    """

    name: str
    words: str
    points: Sequence[Place]
    sheath: int = 1
    travel: float | None = None
    mount: str = "world"
    stiffness: float | None = None
    release: float = 0.0

    @property
    def most(self) -> float:
        """The travel of the winch [mm]."""
        bare = np.linalg.norm(np.diff(np.array(self.points)[self.sheath :], axis=0), axis=1).sum()
        return int(1e3 * SQUEEZE * bare) if self.travel is None else self.travel


@dataclass(frozen=True, kw_only=True)
class Play:
    """A pose by what the winches take in.

    Attributes:
        words: what it looks like.
        contractions: of some winches [mm], below 0 for payout, and angles of drives [degrees]; the others stay at rest.
    """

    words: str
    contractions: Mapping[str, float]

    def controls(self, robot: Robot) -> dict[str, float]:
        """Values by name [m or rad]."""
        drives = {drive.name for drive in robot.drives}
        return {
            name: np.radians(value) if name in drives else 1e-3 * value for name, value in self.contractions.items()
        }


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """A robot in space.

    Attributes:
        name: of the robot and of its folder.
        words: what the file begins with.
        surface: makes that of the body [m]; None for another kind of body.
        faces: triangles that are kept of it.
        material: a name of the table.
        volume: how its change is measured, for materials that keep it.
        element_size: length of a mesh edge [mm].
        held: words about the pin, and two corners of its box [mm].
        winch_words: about all winches.
        lines: winches and cables.
        markers: by name [m].
        marker_words: about the markers.
        plays: poses by name.
    """

    name: str
    words: str
    surface: Callable[[], Surface] | None = None
    faces: int = 7000
    material: str = "flexfoam-it x"
    volume: str | None = None
    element_size: float = 10.0
    held: tuple[str, Sequence[float], Sequence[float]]
    winch_words: str
    lines: Sequence[Line]
    markers: Mapping[str, Place]
    marker_words: str
    plays: Mapping[str, Play]

    def files(self) -> dict[str, bytes]:
        """Files of the folder next to robot.toml."""
        return {} if self.surface is None else {f"{self.name}.ply": ply_bytes(decimated(self.surface(), self.faces))}

    def text(self) -> str:
        """The whole robot.toml."""
        blocks = [*self._body(), self._pin(), *self._winches(), *self._cables(), *self._markers(), *self._poses()]
        return "\n\n".join(blocks) + "\n"

    def _body(self) -> list[str]:
        return [
            f'{comment(self.words)}\nformat = 1\nname = "{self.name}"',
            "# The body: a closed surface, filled with tetrahedra. A smaller element_size is finer but slower.\n"
            f'[body]\nsurface = "{self.name}.ply"\nelement_size = "{_number(self.element_size)} mm"\n'
            f'material = "{self.material}"' + (f'\nvolume = "{self.volume}"' if self.volume else ""),
        ]

    def _pin(self) -> str:
        words, low, high = self.held
        return f"{comment(f'Where you hold it: {words}')}\n[[pin]]\nbox = [{_row(low)}, {_row(high)}]"

    def _winches(self) -> list[str]:
        first, *rest = [
            f'[[winch]]\nname = "{line.name}"\nat = {_point(line.points[0])}\nspool_radius = "6 mm"\n'
            f'travel = "{_number(line.most)} mm"'
            + (f'\nrelease = "{_number(line.release)} mm"' if line.release else "")
            + ('\nmount = "world"' if line.mount == "world" else "")
            for line in {line.name: line for line in reversed(self.lines)}.values()
        ][::-1]
        return [f"{comment(f'The winches: {self.winch_words}')}\n{first}", *rest]

    def _cables(self) -> list[str]:
        first, *rest = [
            f'[[cable]]                       # {line.words}\nwinch = "{line.name}"\n'
            f"points = [{', '.join(map(_point, line.points))}]"
            + (f'\nstiffness = "{_number(line.stiffness)} N/mm"' if line.stiffness else "")
            + (f"\nsheathed = [[0, {line.sheath}]]" if line.sheath else "")
            for line in self.lines
        ]
        tube = (
            " They run in a tube as far as the sheathed points; beyond,"
            if any(line.sheath for line in self.lines)
            else ""
        )
        opening = (
            f"The cables: from the winch (first point) to a stopper (last point).{tube} "
            f"{'the' if tube else 'The'} body bends towards the side on which a cable runs."
        )
        return [f"{comment(opening)}\n{first}", *rest]

    def _markers(self) -> list[str]:
        first, *rest = [f'[[marker]]\nname = "{name}"\nat = {_point(place)}' for name, place in self.markers.items()]
        return [f"{comment(f'The markers: {self.marker_words}')}\n{first}", *rest]

    def _poses(self) -> list[str]:
        targets = json.loads(POSES.read_text(encoding="utf-8")).get(self.name, {}) if POSES.exists() else {}
        blocks = []
        for name, play in self.plays.items():
            if name in targets:
                places = "\n".join(f"{marker} = {_row(place)}" for marker, place in targets[name].items())
                blocks.append(f'[[pose]]\n# {play.words}\nname = "{name}"\n[pose.targets]\n{places}')
        if blocks:
            blocks[0] = "# The poses: where the markers should go.\n" + blocks[0]
        return blocks


def comment(words: str) -> str:
    """Words as lines of comment."""
    return "\n".join(textwrap.wrap(words, 120, initial_indent="# ", subsequent_indent="# "))


def _point(place: Place) -> str:
    """Meters as millimeters to a tenth."""
    return _row([1e3 * value for value in place])


def _row(values: Sequence[float]) -> str:
    return f"[{', '.join(map(_number, values))}]"


def _number(value: float) -> str:
    return f"{np.round(value, 1) + 0.0:g}"
