"""Keyframes that give way to what is seen: a linear policy for the fingers of the flat gripper.

The gripper and what is asked look alike after a quarter turn, so all fingers follow one rule, each in its own frame. A
rule that gives all fingers the same corrections could make no use of where the disc is: to first order, a quarter turn
would take what is won away again.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from hydrostat.training import TwistEnv

OUTWARDS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
"""Where the fingers lie, seen from the disc: right, top, left, bottom, as the winches are in order."""

ALONG = np.column_stack([OUTWARDS[:, 1], -OUTWARDS[:, 0]])
"""From where each finger is held to its tip."""

TEN_DEGREES, START = np.deg2rad(10.0), 5e-3
"""Units of what is seen: of turns, and of places [m]."""


def rule(keys: np.ndarray) -> np.ndarray:
    """The rule that plays keyframes and nothing else, (keyframes, 2, 4).

    For each keyframe and each of the cables a and b: what is taken in [mm], and how much more for ten degrees that the
    disc has turned too far, for 5 mm that it lies towards the finger, and for 5 mm that it lies towards its tip.
    """
    made = np.zeros((*keys.shape, 4))
    made[..., 0] = keys
    return made


def corrected(numbers: np.ndarray, turned: float, place: np.ndarray) -> np.ndarray:
    """What the cables take in [mm], (4 fingers, 2), by the rule of a keyframe, (2, 4).

    Args:
        numbers: of the rule.
        turned: how much further than usual [rad].
        place: of the disc, from its usual one [m].
    """
    seen = np.column_stack(
        [np.ones(4), np.full(4, turned / TEN_DEGREES), OUTWARDS @ place / START, ALONG @ place / START]
    )
    return seen @ numbers.T


def usual_turns(env: TwistEnv, keys: np.ndarray, act: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """How far a usual disc has turned before each keyframe [rad]; `act` makes actions of millimeters."""
    env.reset(options={"goal": [0.5]})
    turned = []
    for key in keys:
        turned.append(env.world.turned)
        env.step(act(np.tile(key, 4)))
    return np.array(turned)


def seen_by(env: TwistEnv, seen: dict[str, Any], usual: float) -> tuple[float, np.ndarray]:
    """How much further than usual the disc has turned [rad], and where it is [m]."""
    _, (x, y, turned, _) = np.split(np.asarray(seen["observation"]), [-4])
    return np.pi * turned - usual, env.robot.body.mesh.size * np.array([x, y])
