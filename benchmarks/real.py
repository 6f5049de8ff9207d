"""Real robots: errors of hydrostat against published measurements of robots that others built.

    python benchmarks/real.py FOLDER [--only NAME] [--samples N] [--plot FOLDER] [--profile]

FOLDER holds opencr_v4/ (a tendon continuum robot of three segments with nine tendons; Continuum Robotics Laboratory,
opencr-mujoco), trunk_payload/ (a vacuum-hose trunk of six motors with hung masses; Stanford ASL, trunk-stack) and emio/
(four printed legs on four servos; SofaComplianceRobotics, Emio.validation), all MIT. Parameters are fitted to some
rows (`hydrostat.identification`) and judged on rows that the fit never saw: val.csv of the first robot, every third
block of the second. Errors are distances in the frame of the measurement [mm]; a row whose equilibrium is not found
counts as the mean of the fitted rows' places.

The angles of Emio's servos were not stored. Rods of the measured modulus find angles that lead the connector to the
places that its makers' model predicts; volumes of the same modulus are turned by them. Fitted are the sensor's offset,
then its place on the connector, then the angle by which servos and clamps yield to a torque; the last two are judged on
rows that their fit did not see, in folds.
"""

import argparse
import csv
import json
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from emio import RodLegs, SolidLegs, read_emio, rotation
from machine import machine
from real_robots import MM, opencr, trunk, with_hysteresis, with_play

from hydrostat.identification import (
    FittedModel,
    IdentificationModel,
    MarkerPredictor,
    Measurements,
    fit_model,
    profile_intervals,
)

HEAD = "| {} | mean | median | RMSE | 90 % | rows, parameters, CPU |\n|---|---|---|---|---|---|"
SKIPPED = 0.5  # head of a block of the trunk that is not scored [s]
LOADS = (0, 100)  # hung masses of the trunk [g]
EVERY = 6  # rows of OpenCR's train.csv of which one is in the loading path that a fit with hysteresis follows
DELAY = 0.012  # motor angles of the trunk lag behind its places, by cross-validation in the fitted blocks [s]


def numbers(file: Path) -> tuple[list[str], np.ndarray]:
    """Names and values of the columns that hold numbers."""
    with file.open(encoding="utf-8") as lines:
        rows = list(csv.reader(lines))
    kept = [index for index, name in enumerate(rows[0]) if name != "run"]
    values = np.array([[float(row[index]) for index in kept] for row in rows[1:]])
    return [rows[0][index] for index in kept], values


def ridge(pulls: np.ndarray, places: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Ridge regression by all products of two inputs."""
    middle, spread = pulls.mean(axis=0), pulls.std(axis=0)

    def features(rows: np.ndarray) -> np.ndarray:
        full = np.column_stack([np.ones(len(rows)), (rows - middle) / spread])
        pairs = np.triu_indices(full.shape[1])
        return full[:, pairs[0]] * full[:, pairs[1]]

    known = features(pulls)
    scale = np.sqrt((known**2).mean(axis=0))
    known = known / scale
    normal = known.T @ known + 1e-4 * len(known) * np.eye(known.shape[1])
    return features(asked) / scale @ np.linalg.solve(normal, known.T @ places)


def line(what: str, found: np.ndarray, places: np.ndarray, more: str = "") -> str:
    """Row of the table."""
    errors = np.linalg.norm(found - places, axis=1)
    root = float(np.sqrt((errors**2).mean()))
    return (
        f"| {what} | {errors.mean():.2f} | {np.median(errors):.2f} | **{root:.2f}** | {np.percentile(errors, 90):.2f} |"
        f" {more} |"
    )


def identified(
    model: IdentificationModel, measured: Measurements, *, evaluations: int = 30, profile: bool = False
) -> tuple[FittedModel, str]:
    """Fit, and its rows, parameters and time; with intervals by profile likelihood if asked."""
    began = time.process_time()
    fitted = fit_model(
        model,
        measured,
        evaluations=evaluations,
        refine=not measured.in_order,
        progress=lambda text, *_: print(f"  {text}", end="\r", flush=True),
    )
    fitted = profile_intervals(fitted, measured, progress=print) if profile else fitted
    seconds = time.process_time() - began
    return fitted, f"{len(measured.commands)}, {len(model.parameters)}, {seconds:.0f} s"


def judged(fitted: FittedModel, asked: Measurements, known: Measurements, marker: int) -> tuple[np.ndarray, int]:
    """Predicted places of one marker [mm], and how many rows had no equilibrium."""
    found = fitted.predict(asked)[:, marker]
    missing = ~np.isfinite(found).all(axis=1)
    found[missing] = known.places[:, marker].mean(axis=0)
    return found / MM, int(missing.sum())


def covered(fitted: FittedModel, asked: Measurements) -> float:
    """Share of the measured coordinates within their 95 % intervals."""
    found = MarkerPredictor(fitted.model, asked).predict(fitted.numbers, with_jacobian=True)
    assert found.jacobian is not None
    variance = np.einsum("rmdi,ij,rmdj->rmd", found.jacobian, fitted.interval_covariance, found.jacobian)
    away = np.abs(found.places - asked.places)
    known = np.isfinite(away)
    return float((away <= 1.96 * np.sqrt(variance + fitted.noise**2))[known].mean())


def run_opencr(
    folder: Path,
    samples: int,
    pictures: Path | None,
    *,
    history: str = "",
    resists_twist: bool = True,
    profile: bool = False,
) -> None:
    """OpenCR v4: fitted on train.csv, judged on val.csv; `history` is "play" of tendons or "hysteresis" of the gaps."""
    facts: dict[str, Any] = json.loads((folder / "robot.json").read_text(encoding="utf-8"))
    model = opencr(
        facts["segment_lengths_mm"],
        facts["tendon_angles"]["segment_offset_rad_authors_fit_2026_03"],
        facts["tendon_circle_radius_mm"],
        resists_twist=resists_twist,
    )
    train, val = (numbers(folder / f"{name}.csv")[1] for name in ("train", "val"))
    known, asked = (
        Measurements(commands=MM * rows[:, 1:10], markers=("tip",), places=MM * rows[:, None, 10:13])
        for rows in (train, val)
    )
    if history == "play":
        model = with_play(model, np.concatenate([known.commands, asked.commands]))
    chosen = np.sort(np.random.default_rng(0).choice(len(train), samples, replace=False))
    fitted, cost = identified(model, known.rows(chosen), profile=profile and history != "hysteresis")
    if history == "hysteresis":
        path = known.rows(np.arange(0, len(train), EVERY))
        fitted, more = identified(
            with_hysteresis(model, fitted.values), replace(path, in_order=True), evaluations=10, profile=profile
        )
        cost, asked = f"{cost}; then {more}", replace(joined([path, asked]), in_order=True)
    found, missing = judged(fitted, asked, known, 0)
    found = found[-len(val) :]
    print(HEAD.format("OpenCR v4, val.csv, tip [mm]"))
    print(line("quadratic", ridge(train[:, 1:10], train[:, 10:13], val[:, 1:10]), val[:, 10:13], f"{len(train)}, 165"))
    authors = folder / "val_authors_mujoco.csv"
    if authors.exists():
        tips = numbers(authors)[1][:, -3:]
        print(line("MuJoCo model of the authors", tips, val[:, 10:13], "calibrated on another day"))
    print(line(f"hydrostat {history}".strip(), found, val[:, 10:13], f"{cost}; {missing} not converged"))
    if history != "hysteresis":
        print(f"  within 95 % intervals: {100 * covered(fitted, asked):.1f} % of coordinates")
    print_parameters(fitted)
    if pictures:
        plot(pictures / f"opencr{history and '_' + history}.png", val[:, 10:13], found, ("x", "z"))


def run_trunk(folder: Path, samples: int, pictures: Path | None, *, profile: bool = False) -> None:
    """Trunk: fitted on two thirds of the blocks of all loads, and on those without a load; judged on the others."""
    facts: dict[str, Any] = json.loads((folder / "robot.json").read_text(encoding="utf-8"))
    base = np.array(facts["base_about_mm"])
    disks = np.array(facts["disks_near_zero_angles_mm"]).reshape(3, 3)
    lengths = np.diff(np.concatenate([[0.0], -disks[:, 1]])).tolist()
    x, y, z = base.tolist()
    model = trunk(lengths, (x, -z, y))
    rows = {load: trunk_rows(numbers(folder / f"load_{load:03d}g.csv")) for load in LOADS}
    tests = {load: np.isin(one[0], np.unique(one[0])[::3]) for load, one in rows.items()}
    rng = np.random.default_rng(0)
    known = {load: trunk_measured(rows[load], load, ~tests[load]) for load in LOADS}
    asked = {load: trunk_measured(rows[load], load, tests[load]) for load in LOADS}
    mixed = joined(
        [one.rows(np.sort(rng.choice(len(one.commands), samples // 2, replace=False))) for one in known.values()]
    )
    print(HEAD.format("Trunk, every third block, disk 3 [mm]"))
    for load in LOADS:
        places = asked[load].places[:, 2] / MM
        every = joined(list(known.values()))
        inputs = [np.column_stack([one.commands[:, ::2] / MM, one.hung_masses[:, 2]]) for one in (every, asked[load])]
        more = f"{len(every.commands)}, 108"
        print(line(f"quadratic, {load} g", ridge(inputs[0], every.places[:, 2] / MM, inputs[1]), places, more))
    fitted, cost = identified(model, mixed, profile=profile)
    for load in LOADS:
        found, missing = judged(fitted, asked[load], mixed, 2)
        places = asked[load].places[:, 2] / MM
        print(line(f"hydrostat, {load} g", found, places, f"{cost}; {missing} not converged"))
        share = covered(fitted, asked[load].rows(np.arange(0, len(places), 10)))
        print(f"  within 95 % intervals, every tenth row: {100 * share:.1f} % of coordinates")
        if pictures:
            plot(pictures / f"trunk_{load}.png", places, found, ("x", "z"))
    print_parameters(fitted)


def trunk_rows(table: tuple[list[str], np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Blocks, motor angles [degrees] and places of the disks [mm] with z up, of the rows that are scored."""
    names, values = table
    column = {name: index for index, name in enumerate(names)}
    motors = values[:, [column[f"motor{number}_deg"] for number in range(1, 7)]]
    for block in np.unique(values[:, column["block"]]):
        inside = values[:, column["block"]] == block
        motors[inside] += DELAY * np.gradient(motors[inside], values[inside, column["t_s"]], axis=0)
    scored = (values[:, column["t_s"]] >= SKIPPED) & (values[:, column["bad"]] == 0)
    values, motors = values[scored], motors[scored]
    disks = values[:, [column[f"d{disk}_{axis}_mm"] for disk in (1, 2, 3) for axis in "xzy"]].reshape(-1, 3, 3)
    return values[:, column["block"]], motors, disks * np.array([1.0, -1.0, 1.0])


def trunk_measured(rows: tuple[np.ndarray, np.ndarray, np.ndarray], load: int, chosen: np.ndarray) -> Measurements:
    """Measurements of some rows; both winches of a motor have its angle as their command."""
    _, motors, disks = (part[chosen] for part in rows)
    masses = np.zeros((len(motors), 3))
    masses[:, 2] = 1e-3 * load
    names = ("disk 1", "disk 2", "disk 3")
    return Measurements(commands=np.repeat(motors, 2, axis=1), markers=names, places=MM * disks, masses=masses)


def joined(parts: list[Measurements]) -> Measurements:
    """All rows of some measurements."""
    return Measurements(
        commands=np.concatenate([part.commands for part in parts]),
        markers=parts[0].markers,
        places=np.concatenate([part.places for part in parts]),
        masses=np.concatenate([part.hung_masses for part in parts]),
    )


def run_emio(folder: Path, samples: int, pictures: Path | None, *, yielded: tuple[float, ...] = (0.0,)) -> None:
    """Emio: volumes turned by the angles of rods, against tips in beam.csv; `yielded`: compliances of the roots."""
    values = numbers(folder / "beam.csv")[1]
    values = values[:: max(len(values) // samples, 1) if samples else 1]
    predicted, measured = values[:, 4:7], values[:, 7:10]
    facts = read_emio(folder)
    began = time.process_time()
    rods = RodLegs(facts)
    states = rods.find_states(MM * predicted)
    asked = [rods.yielding(states, MM * predicted, compliance)[:, 24:28] for compliance in yielded]
    print(f"angles by rods: {time.process_time() - began:.0f} s of CPU")
    print(HEAD.format("Emio, beam.csv, tip [mm]"))
    found = [("SOFA's beam of the makers", predicted, "")]
    for elements, runs in (("linear", asked[:1]), ("quadratic", asked)):
        began = time.process_time()
        legs = SolidLegs(folder, facts, elements)
        poses = [legs.find_tips(angles) for angles in runs]
        nodes = f", {len(poses[0][2].nodes)} nodes, {time.process_time() - began:.0f} s"
        found.append((f"hydrostat, {elements} elements, 35 MPa", poses[0][0] / MM, nodes))
    for what, tips, nodes in found:
        print(line(what, tips + (measured - tips).mean(axis=0), measured, f"{len(tips)}, 3{nodes}"))
        apart = tips + (predicted - tips).mean(axis=0) - predicted
        print(f"  from SOFA's beam, offset removed: RMSE {np.sqrt((apart**2).sum(axis=1).mean()):.2f} mm")
    tips, turns = np.array([pose[0] for pose in poses]) / MM, np.array([pose[1] for pose in poses])
    number = np.arange(len(measured))
    for what, places, axes in (
        ("rods, sensor on the connector", predicted[None], rotation(states[None, :, 28:])),
        ("quadratic elements, sensor on the connector", tips[:1], turns[:1]),
        ("the same, servos yield", tips, turns),
    )[: 1 + len(yielded)]:
        held, fits = held_out((places, axes), measured, number % 8, yielded)
        print(line(what, held, measured, f"{len(held)} in 8 folds, {6 if len(places) == 1 else 7}"))
        away = held_out((places, axes), measured, 4 * number // len(number), yielded)[0] - measured
        print(f"  whole quarters of the time left out: RMSE {np.sqrt((away**2).sum(axis=1).mean()):.2f} mm")
        for name, part in (("offset, mm", fits[:, :3]), ("place, mm", fits[:, 3:6]), ("rad/(N m)", fits[:, 6:])):
            low, middle, high = part.min(axis=0).round(2), part.mean(axis=0).round(2), part.max(axis=0).round(2)
            print(f"  {name}: {middle}, from {low} to {high}")
    if pictures:
        plot(pictures / "emio.png", measured, held, ("z", "y"))
        plot_legs(pictures / "emio_legs.png", legs.simulation.robot.body.mesh.boundary, poses[0][2].nodes)


def held_out(
    runs: tuple[np.ndarray, np.ndarray], measured: np.ndarray, folds: np.ndarray, yielded: tuple[float, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Places [mm] of the sensor, each by a fit to the rows of the other folds, and the fits.

    A fit is an offset and a place on the connector [mm], by least squares, and a compliance [rad/(N m)] on the line
    through two `runs`, which hold places and turns of the connector at two `yielded`; 0 if there is only one.
    """
    found, fits = np.empty_like(measured), []
    for fold in np.unique(folds):
        kept, out, tried = folds != fold, folds == fold, []
        for share in np.linspace(0, 1, 76) if len(runs[0]) > 1 else [0.0]:
            places, axes = ((1 - share) * run[0] + share * run[-1] for run in runs)
            columns = np.concatenate([np.broadcast_to(np.eye(3), axes.shape), axes], axis=2)
            fit, *_ = np.linalg.lstsq(columns[kept].reshape(-1, 6), (measured - places)[kept].ravel(), rcond=None)
            predicted = places + columns @ fit
            error = float(((predicted - measured)[kept] ** 2).sum())
            tried.append((error, np.append(fit, share * yielded[-1]), predicted[out]))
        _, fit, found[out] = min(tried, key=lambda one: one[0])
        fits.append(fit)
    return found, np.array(fits)


def plot_legs(file: Path, faces: np.ndarray, nodes: np.ndarray) -> None:
    """Draw the skin of a pose, y up [mm]."""
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure = Figure(figsize=(6, 5), dpi=130, layout="constrained")
    axes = figure.add_subplot(projection="3d")
    corners = nodes[faces][..., [0, 2, 1]] / MM
    skin = Poly3DCollection(corners, facecolor="#8fb8d8", edgecolor="#2b2833", linewidth=0.1)
    axes.add_collection3d(skin)
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set(xlabel="x [mm]", ylabel="z [mm]", zlabel="y [mm]", box_aspect=high - low)
    figure.savefig(file)


def print_parameters(fitted: FittedModel) -> None:
    """Print values with 95 % intervals."""
    texts = [
        f"{parameter.name} {fitted.values[parameter.name]:.3g} ({low:.3g} to {high:.3g})"
        for parameter, (low, high) in zip(fitted.model.parameters, fitted.intervals.values(), strict=True)
    ]
    print(f"\nfitted to {1e3 * fitted.error:.2f} mm RMSE; {fitted.message}\n{'; '.join(texts)}\n")


def plot(file: Path, places: np.ndarray, found: np.ndarray, side: tuple[str, str]) -> None:
    """Draw measured and predicted places from the side and from above [mm]."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4.2), dpi=130, layout="constrained")
    for axes, (one, two) in zip(figure.subplots(1, 2), (side, ("x", "y")), strict=True):
        first, second = "xyz".index(one), "xyz".index(two)
        for measured, predicted in zip(places, found, strict=True):
            ends = np.array([measured, predicted])
            axes.plot(ends[:, first], ends[:, second], color="#c8243f", linewidth=0.6, zorder=1)
        axes.scatter(places[:, first], places[:, second], s=9, color="#2b2833", label="measured", zorder=2)
        axes.scatter(found[:, first], found[:, second], s=9, color="#2a7fb8", label="hydrostat", zorder=3)
        axes.set(xlabel=f"{one} [mm]", ylabel=f"{two} [mm]", aspect="equal")
        axes.grid(color="#ebe8ee")
    figure.axes[0].legend(frameon=False)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


RUNS = {
    "emio": (run_emio, "emio", 0),
    "emio_yielding": (partial(run_emio, yielded=(0.0, 1.5)), "emio", 0),
    "opencr": (run_opencr, "opencr_v4", 90),
    "opencr_no_twist": (partial(run_opencr, resists_twist=False), "opencr_v4", 90),
    "opencr_play": (partial(run_opencr, history="play", resists_twist=False), "opencr_v4", 90),
    "opencr_hysteresis": (partial(run_opencr, history="hysteresis", resists_twist=False), "opencr_v4", 90),
    "trunk": (run_trunk, "trunk_payload", 200),
}
"""Function, folder and number of rows that a model is fitted to."""


def main() -> None:
    """Fit and print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", choices=sorted(RUNS), help="one of the robots")
    parser.add_argument(
        "--samples", type=int, help="rows that a model is fitted to (default 90 OpenCR, 200 trunk, all Emio)"
    )
    parser.add_argument("--plot", type=Path, metavar="FOLDER", help="pictures of measured and predicted places")
    parser.add_argument("--profile", action="store_true", help="intervals by profile likelihood, where doubtful")
    options = parser.parse_args()
    print(f"{machine()}\n")
    for name, (run, place, rows) in RUNS.items():
        if options.only not in (None, name):
            continue
        if (folder := options.folder / place).is_dir():
            more = {"profile": True} if options.profile and rows else {}
            run(folder, options.samples or rows, options.plot, **more)
        else:
            print(f"{name}: no folder {folder}, left out")


if __name__ == "__main__":
    main()
