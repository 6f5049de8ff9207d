"""Identification of hidden twins: error on held-out poses, and coverage of the intervals.

    python benchmarks/hidden_twins.py                     # 20 twins of each of two robots
    python benchmarks/hidden_twins.py --twins 100 --rows twins.csv   # restartable: rows that are in the file are kept

A twin has another discretization than the fitted robot (half the element size), another modulus (25 %) and Poisson's
ratio (0.15 to 0.42 for 0.3), routes 1 mm off, spools 4 % off, and noise of 0.3 mm. 20 poses are fitted (young, gain,
frame), five of them with a hung mass; 8 others are predicted. Seeds are the numbers of the twins.

With --forces, cables rub (friction 0 to 0.1, none in the fit), one pose alone has a hung mass, and ten poses have
motor currents: forces read to 3 %, of torque constants 10 % off.
"""

import argparse
import csv
import sys
import time
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

from hydrostat.identification import FittedModel, MarkerPredictor, Measurements, fit_model, named_model
from hydrostat.robot import Cable, Marker, Pin, Robot, Winch

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from builders import mesh_body, strip_mesh

FIT = ("young", "gain", "frame")
NOISE, ROUTES, SPOOLS, YOUNG = 3e-4, 1e-3, 0.04, 0.25
"""Standard deviations: a measured coordinate and a hole [m], logarithms of a spool and of Young's modulus."""

POISSON = (0.15, 0.42)
FITTED, HELD_OUT = 20, 8
HEAVY = 4e-3
"""Hung mass [kg]."""

FRICTION, CURRENTS, READ, TORQUE = (0.0, 0.1), 10, 0.03, 0.1
"""With forces: friction, poses with currents, deviations of the logarithms of a force and of the torque constant."""

SIZES = {"long": ((0.2, 0.05), (8, 2)), "short": ((0.15, 0.06), (7, 3))}
"""Length and height [m] of each robot, and its cells; a twin has twice as many along each side."""

HEAD = [
    "robot",
    "twin",
    "seconds",
    "held_out_mm",
    "points",
    *(f"{name}_{end}" for name in FIT for end in ("held", "of")),
]


def make_robot(name: str, times: int = 1) -> Robot:
    """A strip that sags, held at its left end, with a cable above and one below and four markers."""
    (length, height), (columns, rows) = SIZES[name]
    routes = [[(share * length, sign * 0.28 * height) for share in (0.05, 0.35, 0.65, 0.95)] for sign in (1, -1)]
    winches = ("up", "down")
    markers = (("root", 0.15, 0.0), ("middle", 0.55, 0.0), ("tip", 0.95, 0.0), ("upper", 0.75, 0.4))
    return Robot(
        name=name,
        body=mesh_body(strip_mesh(columns * times, rows * times, size=(length, height))),
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0)), stiffness=3e3),),
        gravity=(0.0, -9.81),
        winches=tuple(Winch(name=each, at=route[0], travel=0.02) for each, route in zip(winches, routes, strict=True)),
        cables=tuple(Cable(winch=each, points=tuple(route)) for each, route in zip(winches, routes, strict=True)),
        markers=tuple(Marker(name=each, at=(x * length, y * height)) for each, x, y in markers),
        poses={},
    )


def make_twin(name: str, seed: int, *, forces: bool = False) -> tuple[Robot, dict[str, float], Measurements]:
    """Hidden robot, its true values, and what is measured of it."""
    rng, robot = np.random.default_rng(seed), make_robot(name, 2)
    young = robot.body.material.young * float(np.exp(YOUNG * rng.standard_normal()))
    material = replace(robot.body.material, young=young, poisson=float(rng.uniform(*POISSON)))
    cables = []
    for cable, winch in zip(robot.cables, robot.winches, strict=True):
        moved = np.array(cable.points) + ROUTES * rng.standard_normal((len(cable.points), 2))
        cables.append(replace(cable, points=(winch.at, *(tuple(map(float, point)) for point in moved[1:]))))
    if forces:
        friction = float(rng.uniform(*FRICTION))
        cables = [replace(cable, friction=friction) for cable in cables]
    robot = replace(robot, body=replace(robot.body, material=material), cables=tuple(cables))
    gains, count = np.exp(SPOOLS * rng.standard_normal(2)), FITTED + HELD_OUT
    commands = rng.uniform(0.001, 0.012, (count, 2)) * (rng.random((count, 2)) < 0.6)
    masses = np.zeros((count, len(robot.markers)))
    heavy = np.arange(3, count, 4)[: 1 if forces else count]
    masses[heavy, rng.integers(len(robot.markers), size=len(heavy))] = HEAVY
    names = tuple(marker.name for marker in robot.markers)
    asked = Measurements(
        commands=gains * commands, markers=names, places=np.zeros((count, len(names), 2)), masses=masses
    )
    found = MarkerPredictor(named_model(robot, ()), asked).predict(np.zeros(0), slopes=False)
    places = found.places + NOISE * rng.standard_normal(found.places.shape)
    truth = {"body.young": young, "up.gain": float(gains[0]), "down.gain": float(gains[1])}
    if forces:
        truth["force.scale"] = float(np.exp(TORQUE * rng.standard_normal()))
        pulls = truth["force.scale"] * found.forces * np.exp(READ * rng.standard_normal(found.forces.shape))
        pulls[CURRENTS:] = np.nan
        asked = replace(asked, forces=pulls)
    return robot, truth, replace(asked, commands=commands, places=places)


def try_twin(name: str, seed: int, *, forces: bool) -> list[str]:
    """Row of one twin."""
    _, truth, measured = make_twin(name, seed, forces=forces)
    began = time.process_time()
    held = measured.rows(np.arange(FITTED, FITTED + HELD_OUT))
    kinds = (*FIT, "force") if forces else FIT
    fitted = fit_model(named_model(make_robot(name), kinds), measured.rows(np.arange(FITTED)))
    seconds = time.process_time() - began
    errors, share = predict_held_out(fitted, held)
    inside = dict.fromkeys(FIT, 0), dict.fromkeys(FIT, 0)
    for parameter, (low, high) in fitted.intervals.items():
        if parameter == "force.scale":
            continue
        kind = "frame" if parameter.startswith("frame") else parameter.rpartition(".")[2]
        inside[0][kind] += low <= truth.get(parameter, 0.0) <= high
        inside[1][kind] += 1
    counts = [str(inside[part][kind]) for kind in FIT for part in (0, 1)]
    return [name, str(seed), f"{seconds:.2f}", f"{1e3 * np.median(errors):.4f}", f"{share:.4f}", *counts]


def predict_held_out(fitted: FittedModel, held: Measurements) -> tuple[np.ndarray, float]:
    """Distances of predicted from measured markers [m], and the share of coordinates within their 95 % intervals."""
    found = MarkerPredictor(fitted.model, held).predict(fitted.numbers, slopes=True)
    variance = np.einsum("rmdi,ij,rmdj->rmd", found.jacobian, fitted.interval_covariance, found.jacobian)
    spread = np.sqrt(variance + fitted.noise**2)
    away = found.places - held.places
    known = np.isfinite(away)
    return np.linalg.norm(away, axis=2)[known.all(axis=2)], float((np.abs(away) <= 1.96 * spread)[known].mean())


def main() -> None:
    """Fit all twins and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--twins", type=int, default=20, help="twins of each robot; 0 prints the rows that are there")
    parser.add_argument("--rows", type=Path, help="file to keep rows in")
    parser.add_argument("--forces", action="store_true", help="rubbing cables, currents and one hung mass")
    given = parser.parse_args()
    rows = list(csv.reader(given.rows.open(encoding="utf-8")))[1:] if given.rows and given.rows.exists() else []
    done = {(row[0], int(row[1])) for row in rows}
    for seed in range(given.twins):
        for name in SIZES:
            if (name, seed) not in done:
                rows.append(try_twin(name, seed, forces=given.forces))
                if given.rows:
                    with given.rows.open("w", newline="", encoding="utf-8") as file:
                        csv.writer(file).writerows([HEAD, *rows])
    print(machine())
    kinds = "  ".join(f"{name:>6}" for name in FIT)
    print(f"{'robot':8} twins  held out, median   of size  points in 95 %  {kinds}   CPU")
    for name, ((length, _), _) in SIZES.items():
        own = np.array([row[2:] for row in rows if row[0] == name], dtype=float)
        error, inside = float(np.median(own[:, 1])), own[:, 3:].sum(axis=0).reshape(-1, 2)
        shares = "  ".join(f"{100 * held / count:5.0f}%" for held, count in inside)
        print(
            f"{name:8} {len(own):5}  {error:13.2f} mm  {error / length / 10:7.2f}%  {100 * own[:, 2].mean():13.1f}%  "
            f"{shares}  {np.median(own[:, 0]):.1f} s"
        )
        print(f"{'':8} all values within their 95 % intervals: {100 * inside[:, 0].sum() / inside[:, 1].sum():.1f}%")


if __name__ == "__main__":
    main()
