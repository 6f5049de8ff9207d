"""Photographs of a hidden starfish, rendered, for the page on measurement by photographs.

    python docs/rendered_photographs.py FOLDER            # photographs, from which the commands of the page start
    python docs/rendered_photographs.py FOLDER --picture  # after them: its picture
    python docs/rendered_photographs.py --errors          # errors of corners and markers over twenty pairs

The hidden starfish hangs before its board. It is softer than assumed, two of its spools have other radii, and its mesh
is finer than that of the robot that is fitted to it. Photographs go to FOLDER/photos, the robot as it is assumed to
FOLDER/my_starfish. Needs the extra `photos`. Takes about a minute.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

from hydrostat.robot import Load, Robot, gallery_folder, load_robot
from hydrostat.simulation import Simulation

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "camera"))
from photographs import Camera, Scene, board_plane, photograph, photograph_errors, wall_plane

YOUNG = 0.75
"""Young's modulus over that which is assumed."""

GAINS = {"right": 1.04, "left": 0.97, "feet": 1.0}
"""Spool radii over those that are assumed."""

HIDDEN, ASSUMED = "5 mm", "8 mm"
"""Size of the elements of the hidden and the assumed robot."""

POSES = (
    ({}, {}),
    ({"left": 20}, {}),
    ({"right": 25}, {}),
    ({"feet": 20}, {}),
    ({"left": 35, "right": 30}, {}),
    ({"right": 40, "feet": 10}, {}),
    ({"left": 15, "feet": 30}, {}),
    ({}, {"top": 50}),
    ({"left": 20}, {"left_foot": 50}),
    ({"right": 20}, {"right_foot": 50}),
)
"""Contractions [mm] and hung masses [g]."""

SHEETS = ((-0.108, 0.152, 0.4), (0.107, 0.151, -0.6), (-0.109, -0.150, 0.2), (0.109, -0.149, 0.9))
"""Place [m] and turn [degrees] of each sheet of the board."""


def write_starfish(folder: Path, element: str) -> Robot:
    """Starfish of the gallery that hangs, with elements of some size, in a folder of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in gallery_folder("starfish").iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    text = (folder / "robot.toml").read_text(encoding="utf-8")
    text = text.replace("format = 1", 'format = 1\ngravity = "-y"').replace('"12 mm"', f'"{element}"')
    (folder / "robot.toml").write_text(text, encoding="utf-8")
    return load_robot(folder)


def main() -> None:
    """Write the robot and its photographs."""
    out = Path(sys.argv[1])
    write_starfish(out / "my_starfish", ASSUMED)
    robot = write_starfish(out / "hidden", HIDDEN)
    material = replace(robot.body.material, young=YOUNG * robot.body.material.young)
    robot = replace(robot, body=replace(robot.body, material=material))
    scene = Scene(robot, (0.012, 0.02, 2.0), robot.body.thickness or 0.0)
    (out / "photos").mkdir(exist_ok=True)
    rng = np.random.default_rng(5)
    for number, (contractions, masses) in enumerate(POSES):
        loads = [Load(name=f"nut {name}", marker=name, mass=1e-3 * mass) for name, mass in masses.items()]
        pose = Simulation(replace(robot, loads=(*robot.loads, *loads))).solve(
            {winch: 1e-3 * GAINS[winch] * length for winch, length in contractions.items()}
        )
        camera = Camera.above(
            (0.0, 0.0), 0.62, rng.uniform(3, 18), rng.uniform(0, 360), rng.uniform(-6, 6),
            width=2016, height=1512, focal=1790.0, center=(1015.0, 748.0),
        )  # fmt: skip
        _, *body = scene.planes(pose.nodes, pose.markers)
        sheets = [board_plane(sheet, move, clutter=None) for sheet, move in enumerate(SHEETS)]
        words = [f"{winch}={length}mm" for winch, length in contractions.items()]
        words += [f"{marker}={mass}g" for marker, mass in masses.items()]
        file = out / "photos" / f"{','.join(words) or 'rest'}.jpg"
        Image.fromarray(photograph(camera, [wall_plane(), *sheets, *body], seed=number)).save(file, quality=92)
        print(f"Wrote {file}")
    print(f"Hidden: {YOUNG * 30:g} kPa in place of 30 kPa, spools {GAINS}, elements of {HIDDEN}")


def draw() -> None:
    """Write the picture of the page: a photograph compared with the assumed and the fitted robot."""
    file = "left=20mm,left_foot=50g.png"
    files = [Path(sys.argv[1]) / "build" / name / file for name in ("before", "after")]
    for path in files:
        if not path.exists():
            sys.exit(
                f"{path}: run hydrostat compare on the assumed robot with --out build/before, on the fitted one with "
                "--out build/after"
            )
    both = [Image.open(path).convert("RGB") for path in files]
    left, top, right, bottom = 490, 200, 1330, 940
    wide = Image.new("RGB", (2 * (right - left) + 12, bottom - top), "white")
    for index, picture in enumerate(both):
        wide.paste(picture.crop((left, top, right, bottom)), (index * (right - left + 12), 0))
    wide.save(Path(__file__).parent / "pictures" / "photographs.jpg", quality=85)


def print_errors(pairs: int = 20) -> None:
    """Print errors of tag corners and of markers of a flat robot over pairs of photographs."""
    results = [photograph_errors(seed) for seed in range(pairs)]
    corners = [float(np.sqrt((each**2).mean())) for each, _, _ in results]
    markers = 1e3 * np.concatenate([each for _, each, _ in results])
    print(f"{pairs} pairs: corners RMS {np.median(corners):.3f} pixels (median), {max(corners):.3f} (worst)")
    median, most = np.quantile(markers, [0.5, 0.95])
    print(f"markers {median:.3f} mm (median), {most:.3f} (95 %), {max(markers):.3f} (worst)")


if __name__ == "__main__":
    print_errors() if "--errors" in sys.argv else draw() if "--picture" in sys.argv else main()
