"""Moulds of all gallery robots: undercut, size, pieces, amounts and time.

    python lab/moulds/moulds.py [--silicone] [ROBOT ...]

prints for each body the pull, the share of its surface that is undercut, the closed mould, the printed pieces, the
foam to pour and CPU time without reading the robot. Winches in the body get pockets of the size of a small gearmotor.
"""

import argparse
from time import process_time

from machine import machine

from hydrostat.fabrication import MoldKind, MoldOptions, make_mold
from hydrostat.robot import Mount, gallery_folder, list_gallery, load_robot

POCKET = (40.0, 20.0, 16.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robots", nargs="*", metavar="ROBOT")
    parser.add_argument("--silicone", action="store_true")
    args = parser.parse_args()
    options = MoldOptions(kind=MoldKind.SILICONE if args.silicone else MoldKind.PRINTED)
    print(machine())
    print("robot           pull                undercut  closed mould [mm]  pieces  vents  foam [cm^3]  [g]  CPU [s]")
    for name in args.robots or list_gallery():
        robot = load_robot(gallery_folder(name))
        pockets = {winch.name: POCKET for winch in robot.winches if winch.mount is Mount.BODY}
        start = process_time()
        mould = make_mold(robot, options, pockets=pockets)
        seconds = process_time() - start
        held = 100 * mould.pull.share
        pull = " ".join(f"{value:+.2f}" for value in mould.pull.direction)
        box = " x ".join(f"{side:.0f}" for side in mould.box)
        mix = mould.casting.body
        print(
            f"{name:<15} {pull:<19} {held:7.1f} %  {box:<17}  {len(mould.printed):>6}  {mould.vents:>5}"
            f"  {mix.volume / 1e3:>11.0f}  {mix.mass:>3.0f}  {seconds:>7.1f}"
        )
        for sentence in mould.problems:
            print(f"    {sentence}")


if __name__ == "__main__":
    main()
