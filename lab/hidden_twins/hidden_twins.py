"""Identification of hidden twins: error on held-out poses, and coverage of the intervals.

    python lab/hidden_twins/hidden_twins.py                     # 20 twins of each of two robots
    python lab/hidden_twins/hidden_twins.py --twins 100 --rows twins.csv   # restartable: rows in the file are kept

A twin has another discretization than the fitted robot (half the element size), another modulus (25 %) and Poisson's
ratio (0.15 to 0.42 for 0.3), routes 1 mm off, spools 4 % off, and noise of 0.3 mm. 20 poses are fitted (young, gain,
frame), five of them with a hung mass; 8 others are predicted. Seeds are the numbers of the twins, from --first on.

With --forces, cables rub (friction 0 to 0.1, none in the fit), one pose alone has a hung mass, and ten poses have
motor currents: forces read to 3 %, of torque constants 10 % off. With --profile, intervals by profile likelihood are
counted next to the linear ones.

With --photos, each pose is a rendered photograph with its pose in its name, in place of noise of 0.3 mm: perspective,
distortion, blur, noise, shadow, clutter, JPEG, and a lens whose corners are 0.3 pixels off any that is fitted.
`hydrostat.camera` finds the tags and measures the markers. Forces are as with --forces. Needs the extra `photos`.
"""

import argparse
import csv
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

from hydrostat.identification import (
    FittedModel,
    MarkerPredictor,
    Measurements,
    fit_model,
    named_model,
    profile_intervals,
)
from hydrostat.robot import Cable, Marker, Pin, Robot, Winch
from hydrostat.simulation import Equilibrium

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
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

LENS = 0.3
"""Standard deviation of a third term of distortion, at the corners of a photograph [pixels]."""

SIZES = {"long": ((0.2, 0.05), (8, 2)), "short": ((0.15, 0.06), (7, 3))}
"""Length and height [m] of each robot, and its cells; a twin has twice as many along each side."""

COUNTS = [f"{name}_{end}" for name in FIT for end in ("held", "of")]
HEAD = ["robot", "twin", "seconds", "held_out_mm", "points", *COUNTS, *(f"profile_{count}" for count in COUNTS)]


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


def make_twin(name: str, seed: int, *, forces: bool, photos: bool) -> tuple[dict[str, float], Measurements, float]:
    """True values of a hidden robot, what is measured of it, and CPU time to measure photographs [s]."""
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
    predictor = MarkerPredictor(named_model(robot, ()), asked)
    found = predictor.predict(np.zeros(0), with_jacobian=False)
    places = found.places + NOISE * rng.standard_normal(found.places.shape)
    truth = {"body.young": young, "up.gain": float(gains[0]), "down.gain": float(gains[1])}
    if forces:
        truth["force.scale"] = float(np.exp(TORQUE * rng.standard_normal()))
        pulls = truth["force.scale"] * found.forces * np.exp(READ * rng.standard_normal(found.forces.shape))
        pulls[CURRENTS:] = np.nan
        asked = replace(asked, forces=pulls)
    measured = replace(asked, commands=commands, places=places)
    if not photos:
        return truth, measured, 0.0
    measured, frame, seconds = photograph_twin(robot, make_robot(name), measured, predictor.poses, seed)
    return truth | frame, measured, seconds


def photograph_twin(
    robot: Robot, assumed: Robot, measured: Measurements, poses: Sequence[Equilibrium | None], seed: int
) -> tuple[Measurements, dict[str, float], float]:
    """Measurements with places from photographs of the poses of a twin, their true frame, and seconds to measure."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "camera"))
    from photographs import Camera, Scene, photograph
    from PIL import Image

    from hydrostat.camera import Photo, measure_photos

    rng, files = np.random.default_rng((seed, 1)), []
    across, along = rng.uniform(-0.02, 0.0, 2)
    at = (across, along + 0.01 - 0.5 * robot.body.mesh.size, rng.uniform(87, 93))
    scene = Scene(robot, at, robot.body.thickness or 0.0)
    focal = 862.0 * np.exp(0.03 * rng.standard_normal())
    bent = (*(0.06, -0.09) * rng.uniform(0.5, 1.5, 2), LENS * rng.standard_normal() / focal / (600 / focal) ** 7)
    lens = {"focal": focal, "center": tuple((480.0, 360.0) + 10 * rng.standard_normal(2)), "distortion": bent}
    with tempfile.TemporaryDirectory() as folder:
        for row, (pose, command, masses) in enumerate(
            zip(poses, 1e3 * measured.commands, 1e3 * measured.hung_masses, strict=True)
        ):
            assert pose is not None
            target, (tilt, azimuth, roll) = rng.uniform(-0.01, 0.01, 2), rng.uniform((3, 0, 84), (18, 360, 96))
            camera = Camera.above(tuple(target), 0.28, tilt, azimuth, roll=roll, width=960, height=720, **lens)
            words = [f"{each.name}={pull:.4f}mm" for each, pull in zip(robot.winches, command, strict=True) if pull]
            words += [f"{each}={mass:g}g" for each, mass in zip(measured.markers, masses, strict=True) if mass]
            files.append(Path(folder) / f"{','.join(words) or 'rest'} ({row}).jpg")
            picture = photograph(camera, scene.planes(pose.nodes, pose.markers), seed=100 * seed + row)
            Image.fromarray(picture).save(files[-1], quality=92)
        began = time.process_time()
        found = measure_photos(assumed, Photo.read_all(files, assumed))
        seconds = time.process_time() - began
    angle, middle = np.radians(at[2]), assumed.body.mesh.nodes.mean(axis=0)
    turn = found.turn @ np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    shift = 1e3 * (found.turn @ at[:2] + found.shift + turn @ middle - middle)
    frame = {"frame.x": shift[0], "frame.y": shift[1], "frame.about z": np.degrees(np.arctan2(turn[1, 0], turn[0, 0]))}
    return replace(found.measurements, forces=measured.forces), frame, seconds


def try_twin(name: str, seed: int, *, forces: bool, profile: bool, photos: bool) -> list[str]:
    """Row of one twin."""
    truth, measured, seconds = make_twin(name, seed, forces=forces, photos=photos)
    began = time.process_time() - seconds
    held = measured.rows(np.arange(FITTED, FITTED + HELD_OUT))
    kinds = (*FIT, "force") if forces else FIT
    known = measured.rows(np.arange(FITTED))
    fitted = fit_model(named_model(make_robot(name), kinds), known)
    counts = count_inside(fitted, truth)
    if profile:
        counts += count_inside(profile_intervals(fitted, known), truth)
    seconds = time.process_time() - began
    errors, share = predict_held_out(fitted, held)
    return [name, str(seed), f"{seconds:.2f}", f"{1e3 * np.median(errors):.4f}", f"{share:.4f}", *map(str, counts)]


def count_inside(fitted: FittedModel, truth: dict[str, float]) -> list[int]:
    """Values within their 95 % intervals, and all values, of each kind."""
    inside = {kind: [0, 0] for kind in FIT}
    for parameter, (low, high) in fitted.intervals.items():
        if parameter == "force.scale":
            continue
        kind = "frame" if parameter.startswith("frame") else parameter.rpartition(".")[2]
        inside[kind][0] += low <= truth.get(parameter, 0.0) <= high
        inside[kind][1] += 1
    return [count for counts in inside.values() for count in counts]


def predict_held_out(fitted: FittedModel, held: Measurements) -> tuple[np.ndarray, float]:
    """Distances of predicted from measured markers [m], and the share of coordinates within their 95 % intervals."""
    found = MarkerPredictor(fitted.model, held).predict(fitted.numbers, with_jacobian=True)
    assert found.jacobian is not None
    variance = np.einsum("rmdi,ij,rmdj->rmd", found.jacobian, fitted.interval_covariance, found.jacobian)
    spread = np.sqrt(variance + fitted.noise**2)
    away = found.places - held.places
    known = np.isfinite(away)
    return np.linalg.norm(away, axis=2)[known.all(axis=2)], float((np.abs(away) <= 1.96 * spread)[known].mean())


def main() -> None:
    """Fit all twins and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--twins", type=int, default=20, help="twins of each robot; 0 prints the rows that are there")
    parser.add_argument("--first", type=int, default=0, help="number of the first twin")
    parser.add_argument("--rows", type=Path, help="file to keep rows in")
    parser.add_argument("--forces", action="store_true", help="rubbing cables, currents and one hung mass")
    parser.add_argument("--profile", action="store_true", help="intervals by profile likelihood, where doubtful")
    parser.add_argument("--photos", action="store_true", help="photographs, currents and one hung mass")
    given = parser.parse_args()
    forces = given.forces or given.photos
    rows = list(csv.reader(given.rows.open(encoding="utf-8")))[1:] if given.rows and given.rows.exists() else []
    done = {(row[0], int(row[1])) for row in rows}
    for seed in range(given.first, given.first + given.twins):
        for name in SIZES:
            if (name, seed) not in done:
                rows.append(try_twin(name, seed, forces=forces, profile=given.profile, photos=given.photos))
                if given.rows:
                    with given.rows.open("w", newline="", encoding="utf-8") as file:
                        csv.writer(file).writerows([HEAD[: len(rows[0])], *rows])
    print(machine())
    kinds = "  ".join(f"{name:>6}" for name in FIT)
    print(f"{'robot':8} twins  held out, median   of size  points in 95 %  {kinds}   CPU")
    for name, ((length, _), _) in SIZES.items():
        own = np.array([row[2:] for row in rows if row[0] == name], dtype=float)
        error = float(np.median(own[:, 1]))
        inside = own[:, 3:].sum(axis=0).reshape(-1, len(FIT), 2)
        shares = "  ".join(f"{100 * held / count:5.0f}%" for held, count in inside[0])
        print(
            f"{name:8} {len(own):5}  {error:13.2f} mm  {error / length / 10:7.2f}%  {100 * own[:, 2].mean():13.1f}%  "
            f"{shares}  {np.median(own[:, 0]):.1f} s"
        )
        for what, each in zip(("linear", "profile"), inside, strict=False):
            held, count = each.sum(axis=0)
            shares = ", ".join(f"{kind} {one:.0f} of {of:.0f}" for kind, (one, of) in zip(FIT, each, strict=True))
            print(f"{'':8} {what} intervals hold {100 * held / count:.1f}% of values: {shares}")


if __name__ == "__main__":
    main()
