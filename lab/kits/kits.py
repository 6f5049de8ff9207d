"""Kits of all gallery robots in one run: what is in them, whether they hold, and how long they take.

    python lab/kits/kits.py [--robots starfish,bear] [--out DIR]

CPU time on one thread, kernels compiled before; reading (and meshing) the robot is told apart from making its kit.
"""

import argparse
import os
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import hydrostat as hs
from hydrostat.fabrication import KitOptions, UnbuildableError, build_kit
from hydrostat.robot import gallery_folder, list_gallery

HEAD = (
    f"{'robot':<16}{'method':<7}{'motor':<7}{'files':>6}{'MB':>7}{'checks':>8}{'problems':>9}{'warnings':>9}"
    f"{'read s':>8}{'kit s':>7}"
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default=",".join(list_gallery()))
    parser.add_argument("--out", type=Path, help="also write the kits there")
    given = parser.parse_args()
    build_kit(hs.load_robot(gallery_folder("starfish")))
    print(HEAD)
    for name in given.robots.split(","):
        print(row(name, given.out), flush=True)


def row(name: str, out: Path | None) -> str:
    began = time.process_time()
    robot = hs.load_robot(gallery_folder(name))
    read = time.process_time() - began
    began = time.process_time()
    try:
        kit = build_kit(robot)
        refused = ""
    except UnbuildableError as error:
        kit = build_kit(robot, options=KitOptions(force=True))
        refused = f"  forced: {error.reasons[0]}"
    took = time.process_time() - began
    if out is not None:
        kit.write(out / name)
    held = f"{sum(check.passed for check in kit.checks)}/{len(kit.checks)}"
    size = sum(map(len, kit.files.values())) / 1e6
    return (
        f"{name:<16}{kit.method:<7}{kit.motor:<7}{len(kit.files):>6}{size:>7.1f}{held:>8}{len(kit.problems):>9}"
        f"{len(kit.warnings):>9}{read:>8.1f}{took:>7.1f}{refused}"
    )


if __name__ == "__main__":
    main()
