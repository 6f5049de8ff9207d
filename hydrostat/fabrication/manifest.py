"""`manifest`: what is in a kit, of which robot, made by what."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

from hydrostat.fabrication.kit_options import KitOptions
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Robot, robot_hash

NAME = "manifest.json"
"""Its file in a kit; written last, so that a kit without it is not whole."""

_MAKERS = ("hydrostat", "ezdxf", "libigl", "manifold3d", "numba", "numpy", "scipy", "shapely", "typst")
"""Packages on which the bytes of a kit depend."""


def manifest(
    robot: Robot, options: KitOptions, files: Mapping[str, bytes], *, checks: Sequence[Check], told: Mapping[str, Any]
) -> bytes:
    """The text of manifest.json.

    Args:
        robot: that is built.
        options: of the kit.
        files: content by path in the kit.
        checks: the self-check table.
        told: what else to keep, such as warnings and sizes.
    """
    told = {
        "robot": {"name": robot.name, "sha256": robot_hash(robot)},
        **told,
        "options": asdict(options),
        "checks": [asdict(check) for check in checks],
        "versions": {name: version(name) for name in _MAKERS},
        "files": {
            path: {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
            for path, content in sorted(files.items())
        },
    }
    return (json.dumps(told, indent=2, ensure_ascii=False) + "\n").encode()
