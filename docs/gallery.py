"""Write the gallery robots that are made by formulas: python docs/gallery.py [NAME ...] [--poses].

Each is a folder in examples/ with robot.toml and the file of its body. With --poses the poses are simulated again:
the winches take in what the sheet of the robot says, and where its markers come to rest, in whole millimeters, is kept
in docs/bodies/poses.json. In none of them does a body feel itself: they are the same with `[contact]` and without.
"""

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from bodies.gripper import caging
from bodies.hands import cupping, extended
from bodies.hydrostats import arm_of_octopus, elephant_trunk, tail_of_fish, tongue_of_foam
from bodies.plush import bear
from bodies.servos import emio
from bodies.sheet import POSES, Sheet
from bodies.tendons import spine, spiral, tendon_finger

import hydrostat as hs

EXAMPLES = Path(__file__).parents[1] / "examples"

SHEETS: Mapping[str, Callable[[], Sheet]] = {
    "cupping_hand": cupping,
    "extended_hand": extended,
    "caging_gripper": caging,
    "trunk": elephant_trunk,
    "octopus_arm": arm_of_octopus,
    "tongue": tongue_of_foam,
    "fish_tail": tail_of_fish,
    "bear": bear,
}
"""What is written, by the names of the robots."""

TENDON_SHEETS: Mapping[str, Callable[[], Sheet]] = {
    "spiral": spiral,
    "finger": tendon_finger,
    "spine": spine,
    "emio": emio,
}
"""Robots whose body is a drawing or a mesh, with hinges, bones, disks or servos."""

ALL = {**SHEETS, **TENDON_SHEETS}


def write_robot(sheet: Sheet, examples: Path = EXAMPLES) -> Path:
    """The folder of a robot, with its robot.toml and the file of its body."""
    folder = examples / sheet.name
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in sheet.files().items():
        (folder / name).write_bytes(content)
    (folder / "robot.toml").write_text(sheet.text(), encoding="utf-8")
    return folder


def simulate_poses(sheet: Sheet, folder: Path) -> dict[str, dict[str, list[int]]]:
    """Where the markers come to rest in each pose [mm]."""
    simulation = hs.Simulation(hs.load_robot(folder))
    poses = {}
    for name, play in sheet.plays.items():
        pose = simulation.solve(play.controls(simulation.robot))
        poses[name] = {marker: [round(1e3 * float(value)) for value in place] for marker, place in pose.markers.items()}
    return poses


def keep_poses(name: str, poses: dict[str, dict[str, list[int]]]) -> None:
    """Poses of one robot written beside those of the others."""
    kept = json.loads(POSES.read_text(encoding="utf-8")) if POSES.exists() else {}
    lines = [f'"{robot}": {json.dumps(found)}' for robot, found in sorted({**kept, name: poses}.items())]
    POSES.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> None:
    """Write all robots, or those that are named."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="robots to write; all if left out")
    parser.add_argument("--poses", action="store_true", help="simulate the poses again")
    options = parser.parse_args(arguments)
    for name in options.names or ALL:
        sheet = ALL[name]()
        folder = write_robot(sheet)
        if options.poses:
            keep_poses(name, simulate_poses(sheet, folder))
            write_robot(sheet)


if __name__ == "__main__":
    main()
