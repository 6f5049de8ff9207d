"""Real robots: errors of hydrostat against published measurements of a robot that others built.

    python benchmarks/real.py FOLDER [--samples 90] [--plot FILE.png]

FOLDER holds opencr_v4/robot.json, train.csv and val.csv: a tendon continuum robot of three segments with nine tendons
(Continuum Robotics Laboratory, opencr-mujoco, MIT). The model is fitted to some rows of train.csv by Gauss-Newton steps
with exact adjoint sensitivities, and judged on val.csv, which it never saw. Errors are distances of the tip in the
frame of the measurement [mm]; a row whose equilibrium is not found counts as the mean of train. Beside it stands a
quadratic regression on all rows of train.csv, and predictions of the authors if FOLDER has them.
"""

import argparse
import csv
import json
import time
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from machine import machine
from scipy.optimize import least_squares

from hydrostat.geometry import Mesh
from hydrostat.robot import Body, BodyPart, Cable, Marker, Material, Mount, Pin, Robot, Rod, Source, Winch
from hydrostat.simulation import Equilibrium, Simulation

MM = 1e-3
DISKS = 10  # of a segment
SHIFT = 10.0  # slack of every tendon at zero [mm]: measured pulls are from -10 mm on
DISK = 2.0  # thickness of a disk [mm]
BENDING = 1e-3  # EI of the rod in the middle [N m^2]; stiffness of tendons and solid are fitted beside it
AXIAL = 2e4  # EA of the rod [N]
SIDE = 11.0  # of the square section of the body that carries disks and tendons [mm]


def read(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Pulls of the tendons and places of the tip [mm]."""
    with file.open(encoding="utf-8") as lines:
        rows = list(csv.reader(lines))
    numbers = np.array([[float(value) for value in [row[0], *row[2:]]] for row in rows[1:]])
    return numbers[:, 1:10], numbers[:, 10:13]


def read_tips(file: Path) -> np.ndarray:
    """Places of the tip in the last three columns [mm]."""
    return np.loadtxt(file, delimiter=",", skiprows=1, usecols=(-3, -2, -1))


@dataclass(frozen=True)
class Spine:
    """Tendon robot as a body: rigid disks on an elastic rod."""

    lengths: tuple[float, ...]  # of the segments [mm]

    @cached_property
    def disks(self) -> np.ndarray:
        """Lower and upper side of each disk [mm], (disks, 2); the upper side of the last of a segment is its end."""
        ends = np.cumsum([0.0, *self.lengths])
        tops = np.concatenate([np.linspace(a, b, DISKS + 1)[1:] for a, b in pairwise(ends)])
        return np.stack([tops - DISK, tops], axis=1)

    @cached_property
    def body(self) -> Body:
        """Body with its disks; a solid between them resists twist, which the rod does not."""
        planes = np.concatenate([[0.0], self.disks.ravel()])
        parts = tuple(
            BodyPart(
                name=f"disk {index + 1}", shape="box", at=(-1.0, -1.0, MM * low), to=(1.0, 1.0, MM * high), density=1e3
            )
            for index, (low, high) in enumerate(self.disks)
        )
        material = Material(young=1e6, poisson=0.0, density=10.0)
        mesh = layered_mesh(planes)
        return Body(source=Source.MESH, file="spine.vtk", content=b"", material=material, mesh=mesh, parts=parts)

    def robot(self, given: "Parameters") -> Robot:
        """Robot with these parameters."""
        middles, count = self.disks.mean(axis=1), DISKS
        winches, cables = [], []
        for segment in range(3):
            for tendon in range(3):
                angle = given.angles[segment] + 2 * np.pi / 3 * tendon
                place = given.radii[segment] * np.array([np.cos(angle), np.sin(angle)])
                heights = np.concatenate([[-5.0], middles[: count * (segment + 1)]])
                points = tuple((MM * place[0], MM * place[1], MM * height) for height in heights.tolist())
                name = f"s{segment + 1}t{tendon + 1}"
                winches.append(Winch(name=name, at=points[0], mount=Mount.WORLD, travel=0.1, release=0.1))
                cables.append(
                    Cable(
                        winch=name,
                        points=points,
                        stiffness=1e3 * given.stiffness,
                        slack=MM * (SHIFT + given.slack[segment]),
                        smoothing=5e-5,
                    )
                )
        top = MM * float(self.disks[-1, 1])
        return Robot(
            name="spine",
            body=replace(self.body, material=replace(self.body.material, young=given.young)),
            pins=(Pin(box=((-1.0, -1.0, -1e-4), (1.0, 1.0, 1e-4)), stiffness=1e6),),
            rods=(
                Rod(
                    name="backbone",
                    points=((0.0, 0.0, 0.0), (0.0, 0.0, top)),
                    axial_stiffness=AXIAL,
                    bending_stiffness=BENDING,
                ),
            ),
            winches=tuple(winches),
            cables=tuple(cables),
            markers=(Marker(name="tip", at=(0.0, 0.0, top)),),
            poses={},
        )


def layered_mesh(planes: np.ndarray) -> Mesh:
    """Tetrahedra of a square prism about the z axis, two cells across, with nodes on planes [mm]."""
    across = np.array([-0.5, 0.0, 0.5]) * SIDE
    nodes = np.array([(x, y, z) for z in planes for y in across for x in across])
    number = np.arange(len(nodes)).reshape(len(planes), 3, 3)
    elements = []
    corners = ((0, 0, 0), (0, 0, 1), (0, 1, 0), (0, 1, 1), (1, 0, 0), (1, 0, 1), (1, 1, 0), (1, 1, 1))
    for k, j, i in np.ndindex(len(planes) - 1, 2, 2):
        cube = [int(number[k + dk, j + dj, i + di]) for dk, dj, di in corners]
        for a, b in ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)):
            elements.append([cube[0], cube[a], cube[b], cube[7]])
    tetrahedra = np.array(elements)
    spans = nodes[tetrahedra[:, 1:]] - nodes[tetrahedra[:, :1]]
    turned = np.linalg.det(spans) < 0
    tetrahedra[turned, 1:3] = tetrahedra[turned, 2:0:-1]
    return Mesh(MM * nodes, tetrahedra)


@dataclass(frozen=True)
class Parameters:
    """Parameters of the fit."""

    angles: np.ndarray  # of the first tendon of each segment [rad]
    radii: np.ndarray  # of the circle of the tendons of each segment [mm]
    slack: np.ndarray  # of the tendons of each segment at rest [mm]; below 0: pretension
    stiffness: float  # of the tendons [N/mm]
    young: float  # of the solid between the disks [Pa]
    base: np.ndarray  # place of the base [mm]
    tilt: np.ndarray  # of the base about x and y [rad]

    @classmethod
    def of(cls, numbers: np.ndarray) -> "Parameters":
        """Parameters from one vector."""
        return cls(
            numbers[:3], numbers[3:6], numbers[6:9], *np.exp(numbers[9:11]).tolist(), numbers[11:14], numbers[14:]
        )

    def turn(self) -> np.ndarray:
        """Rotation of the base."""
        (a, b), one = self.tilt, np.eye(3)
        x = np.array([one[0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
        y = np.array([[np.cos(b), 0, np.sin(b)], one[1], [-np.sin(b), 0, np.cos(b)]])
        return x @ y


class Fit:
    """Residuals of some rows and their slopes, with poses kept from step to step."""

    def __init__(self, spine: Spine, pulls: np.ndarray, tips: np.ndarray) -> None:
        """Rows of measured pulls and tips [mm]."""
        self.spine, self.pulls, self.tips = spine, pulls, tips
        self.poses: list[Equilibrium | None] = [None] * len(pulls)
        self.asked: np.ndarray | None = None
        self.failed = 0

    def residuals(self, numbers: np.ndarray) -> np.ndarray:
        """Predicted less measured tips [mm]."""
        self._ask(numbers)
        return (self.found - self.tips).ravel()

    def slopes(self, numbers: np.ndarray) -> np.ndarray:
        """Derivatives of the residuals."""
        self._ask(numbers)
        return self.jacobian.reshape(-1, len(numbers))

    def _ask(self, numbers: np.ndarray) -> None:
        if self.asked is not None and (self.asked == numbers).all():
            return
        given = Parameters.of(numbers)
        simulation = Simulation(self.spine.robot(given))
        turn, h = given.turn(), 1e-6
        turns = [(Parameters.of(numbers + h * row).turn() - turn) / h for row in np.eye(len(numbers))[14:]]
        self.found, self.jacobian = np.empty_like(self.tips), np.zeros((*self.tips.shape, len(numbers)))
        self.failed = 0
        for row, pull in enumerate(self.pulls):
            pose = simulation.solve(MM * (SHIFT + pull), start=self._start(simulation, row), strict=False)
            if not pose.result.converged:
                pose = simulation.solve(MM * (SHIFT + pull), strict=False)
            self.failed += not pose.result.converged
            self.poses[row] = pose if pose.result.converged else None
            tip = pose.markers["tip"] / MM
            self.found[row] = given.base + turn @ tip
            self.jacobian[row, :, 11:14] = np.eye(3)
            self.jacobian[row, :, 14:] = np.stack([part @ tip for part in turns], axis=1)
            if pose.result.converged:
                self.jacobian[row, :, :11] = turn @ self._by_robot(simulation, pose, given)
        self.asked = numbers.copy()

    def _start(self, simulation: Simulation, row: int) -> Equilibrium | None:
        pose = self.poses[row]
        return None if pose is None else simulation.make_pose(pose.contractions, pose.result)

    def _by_robot(self, simulation: Simulation, pose: Equilibrium, given: Parameters) -> np.ndarray:
        """Derivatives of the tip [mm] by angles, radii [mm], slack [mm], logarithms of stiffness and modulus."""
        anchors = simulation.marker_anchors
        found = np.zeros((3, 11))
        for axis in range(3):
            nodes = np.zeros_like(pose.nodes)
            np.add.at(nodes[:, axis], anchors.stencils[0], anchors.weights[0])
            slopes = simulation.adjoint(pose, nodes)
            found[axis, 10] = slopes.young * given.young / MM
            for index, cable in enumerate(simulation.robot.cables):
                segment, places = index // 3, np.array(cable.points)
                around = np.stack([-places[:, 1], places[:, 0], 0 * places[:, 2]], axis=1)
                found[axis, segment] += float((slopes.routes[index] * around).sum()) / MM
                outward = np.array([*places[0, :2], 0.0]) / np.linalg.norm(places[0, :2])
                found[axis, 3 + segment] += float(slopes.routes[index].sum(axis=0) @ outward)
                found[axis, 6 + segment] += slopes.slack[index]
                found[axis, 9] += slopes.cable_stiffness[index] * 1e3 * given.stiffness / MM
        return found


def quadratic(pulls: np.ndarray, tips: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Ridge regression by all products of two pulls."""
    middle, spread, ridge = pulls.mean(axis=0), pulls.std(axis=0), 1e-4

    def features(rows: np.ndarray) -> np.ndarray:
        full = np.column_stack([np.ones(len(rows)), (rows - middle) / spread])
        pairs = np.triu_indices(full.shape[1])
        return full[:, pairs[0]] * full[:, pairs[1]]

    known = features(pulls)
    scale = np.sqrt((known**2).mean(axis=0))
    known = known / scale
    normal = known.T @ known + ridge * len(known) * np.eye(known.shape[1])
    return features(asked) / scale @ np.linalg.solve(normal, known.T @ tips)


def line(what: str, found: np.ndarray, tips: np.ndarray, more: str = "") -> str:
    """Row of the table."""
    errors = np.linalg.norm(found - tips, axis=1)
    root = float(np.sqrt((errors**2).mean()))
    return (
        f"| {what} | {errors.mean():.2f} | {np.median(errors):.2f} | **{root:.2f}** | {np.percentile(errors, 90):.2f} |"
        f" {more} |"
    )


def main() -> None:
    """Fit and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--samples", type=int, default=90, help="rows of train.csv that the model is fitted to")
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="measured and predicted tips")
    options = parser.parse_args()
    folder = options.folder / "opencr_v4"
    facts: dict[str, Any] = json.loads((folder / "robot.json").read_text(encoding="utf-8"))
    spine = Spine(tuple(facts["segment_lengths_mm"]))
    (pulls, tips), (asked, held_out) = read(folder / "train.csv"), read(folder / "val.csv")
    chosen = np.sort(np.random.default_rng(0).choice(len(pulls), options.samples, replace=False))
    began = time.process_time()
    fit = Fit(spine, pulls[chosen], tips[chosen])
    angles = facts["tendon_angles"]["segment_offset_rad_authors_fit_2026_03"]
    circle = [facts["tendon_circle_radius_mm"]] * 3
    begin = np.array([*angles, *circle, -0.3, -0.3, -0.3, np.log(200.0), np.log(5e5), 0.0, 0.0, 0.0, 0.0, 0.0])
    solved = least_squares(fit.residuals, begin, jac=fit.slopes, x_scale="jac", max_nfev=20)
    seconds = time.process_time() - began
    judged = Fit(spine, asked, held_out)
    judged.residuals(solved.x)
    found = judged.found
    for row, pose in enumerate(judged.poses):
        if pose is None:
            found[row] = tips.mean(axis=0)
    given = Parameters.of(solved.x)
    print(f"{machine()}\n")
    print("| OpenCR v4, val.csv, tip [mm] | mean | median | RMSE | 90 % | rows, parameters, CPU |")
    print("|---|---|---|---|---|---|")
    print(line("quadratic", quadratic(pulls, tips, asked), held_out, f"{len(pulls)}, 165"))
    authors = folder / "val_authors_mujoco.csv"
    if authors.exists():
        print(line("MuJoCo model of the authors", read_tips(authors), held_out, "calibrated on another day"))
    print(line("hydrostat, on the fitted rows", fit.found, fit.tips, f"{options.samples}, 16, {seconds:.0f} s"))
    print(line("hydrostat", found, held_out, f"{options.samples}, 16; {judged.failed} not converged"))
    print(
        f"\ntendons {given.stiffness:.0f} N/mm on circles of {given.radii.round(2)} mm, slack {given.slack.round(2)} mm"
    )
    print(f"solid of {given.young / 1e6:.2f} MPa beside a rod of EI {BENDING:g} N m^2")
    print(f"base {np.round(given.base, 2)} mm, tilt {np.round(np.degrees(given.tilt), 2)} degrees; {solved.message}")
    if options.plot:
        plot(options.plot, held_out, found)


def plot(file: Path, tips: np.ndarray, found: np.ndarray) -> None:
    """Draw measured and predicted tips from the side and from above [mm]."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4.2), dpi=130, layout="constrained")
    for axes, (one, two) in zip(figure.subplots(1, 2), (("x", "z"), ("x", "y")), strict=True):
        first, second = "xyz".index(one), "xyz".index(two)
        for measured, predicted in zip(tips, found, strict=True):
            ends = np.array([measured, predicted])
            axes.plot(ends[:, first], ends[:, second], color="#c8243f", linewidth=0.6, zorder=1)
        axes.scatter(tips[:, first], tips[:, second], s=9, color="#2b2833", label="measured", zorder=2)
        axes.scatter(found[:, first], found[:, second], s=9, color="#2a7fb8", label="hydrostat", zorder=3)
        axes.set(xlabel=f"{one} [mm]", ylabel=f"{two} [mm]", aspect="equal")
        axes.grid(color="#ebe8ee")
    figure.axes[0].legend(frameon=False)
    figure.savefig(file)


if __name__ == "__main__":
    main()
