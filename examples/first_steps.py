"""First steps: load a robot, pull a winch, and let it find the contractions of a pose.

Run it from the top of the repository: python examples/first_steps.py
It prints how far the markers of the starfish's `wave` are from their targets, before and after.
"""

from pathlib import Path

import numpy as np

import hydrostat as hs


def main() -> float:
    """Root of the mean squared marker error of the reached pose [mm]."""
    robot = hs.load_robot(Path(__file__).parent / "starfish")
    simulation = hs.Simulation(robot)

    # Forward: take in 12 mm of cable on one winch, and see where the tip of the left arm goes.
    pose = simulation.solve({"left": 0.012})
    rest = next(marker.at for marker in robot.markers if marker.name == "left")
    print(f"left arm moves {1e3 * np.linalg.norm(pose.markers['left'] - rest):.1f} mm")
    print(f"tensions: {np.round(pose.tensions, 2)} N, {pose.result.status}")

    # How every node follows every winch, exactly: (nodes, dim, winches).
    jacobian = simulation.jacobian(pose)
    print(f"d nodes / d contractions: {jacobian.shape}")

    # Inverse: which contractions bring the markers to the targets of a pose?
    reached = hs.solve_ik(simulation, robot.poses["wave"])
    for winch, contraction in zip(robot.winches, reached.pose.contractions, strict=True):
        print(f"{winch.name:<6} takes in {1e3 * contraction:5.1f} mm")
    print(f"error: {1e3 * reached.rms_error:.2f} mm rms")
    return 1e3 * reached.rms_error


if __name__ == "__main__":
    main()
