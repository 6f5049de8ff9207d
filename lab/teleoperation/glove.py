"""Error of contractions from -1 to 1 that are told by a noisy synthetic glove, after 120 poses were mimicked.

    python lab/teleoperation/glove.py

Readings of one pose are averaged: `hydrostat mimic` asks for 0.3 s of holding still, 25 or so at 90 a second.
Noise is a share of a step of the glove's 254; the thesis reports 0.0026 for its own hand and glove.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "teleop"))

from synthetic_hand import averaged, mimicked


def main() -> None:
    """Print a table."""
    print("| noise, steps | readings a pose | not straight | poses left out | five folds |")
    print("|---|---|---|---|---|")
    for bent in (0.0, 0.05):
        for noise in (0.0, 0.5, 1.0):
            for repeats in (1, 8, 25):
                made = averaged(mimicked(120, repeats=repeats, noise=noise / 254, bent=bent), repeats)
                one, folds = made.errors(made.learn())
                print(f"| {noise:g} | {repeats} | {bent:g} | {one:.4f} | {folds:.4f} |")


if __name__ == "__main__":
    main()
