"""How far coarse limbs lead astray: the same robots, the same cables taken in, on meshes two and four times as fine.

    python lab/coarseness/coarseness.py

For each robot: how many elements are across its thinnest limb (`hydrostat check` warns below MIN_ELEMENTS_ACROSS);
how far its markers move when every winch takes in 15 mm, with the finest mesh; how far from there they are with the
coarser ones; and the largest tension. The hand takes in its flexors.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from benchmark_bodies import ELEMENT_SIZE, hand_robot
from machine import machine

from hydrostat.geometry import Thickness
from hydrostat.robot import MIN_ELEMENTS_ACROSS, Body, Robot, Source, gallery_folder, list_gallery, load_robot
from hydrostat.simulation import Simulation

TAKEN_IN = 0.015
"""Contraction of every winch [m]."""


def drawn(name: str, finer: float) -> Robot:
    """A flat robot of the gallery with elements so many times as fine."""
    robot = load_robot(gallery_folder(name))
    body = robot.body
    assert body.element_size is not None
    assert body.thickness is not None
    finer_body = Body.from_outline(
        body.content,
        file=body.file,
        material=body.material,
        element_size=body.element_size / finer,
        thickness=body.thickness,
        size=body.size,
    )
    return replace(robot, body=finer_body)


def cases() -> Iterator[tuple[str, Callable[[float], Robot], tuple[float, ...]]]:
    """Name, maker and how many times as fine."""
    for name in list_gallery():
        if load_robot(gallery_folder(name)).body.source is Source.OUTLINE:
            yield name, lambda finer, name=name: drawn(name, finer), (1, 2, 4)
    yield "hand", lambda finer: hand_robot(ELEMENT_SIZE / finer), (1, 1.5, 2.2)


def pose(robot: Robot) -> tuple[np.ndarray, float]:
    """Where the markers are [m] and the largest tension [N]."""
    pulled = [winch.name for winch in robot.winches if "extensor" not in winch.name]
    solved = Simulation(robot).solve(dict.fromkeys(pulled, TAKEN_IN))
    return np.array(list(solved.markers.values())), float(solved.tensions.max())


def row(name: str, make: Callable[[float], Robot], finenesses: tuple[float, ...]) -> str:
    robots = [make(finer) for finer in finenesses]
    mesh = robots[0].body.mesh
    parts = Thickness.measure(mesh).thin_parts(5.0)
    places, tensions = zip(*map(pose, robots), strict=True)
    rest = np.array([marker.at for marker in robots[0].markers])
    moved = np.linalg.norm(places[-1] - rest, axis=1).max()
    off = [np.linalg.norm(place - places[-1], axis=1).max() for place in places[:-1]]
    return (
        f"| {name} | {' / '.join(str(len(robot.body.mesh.nodes)) for robot in robots)} "
        f"| {f'{parts[0].across:.1f}' if parts else '5 or more'} "
        f"| {'yes' if Thickness.measure(mesh).thin_parts(MIN_ELEMENTS_ACROSS[mesh.dim]) else 'no'} | {1e3 * moved:.1f} "
        f"| {' / '.join(f'{1e3 * far:.1f}' for far in off)} | {' / '.join(f'{tension:.2f}' for tension in tensions)} |"
    )


def main() -> None:
    print(machine())
    print()
    print("| robot | nodes | elements across | check warns | moves mm | off mm | tension N |")
    print("|---|---|---|---|---|---|---|")
    for case in cases():
        print(row(*case), flush=True)


if __name__ == "__main__":
    main()
