"""How much too stiff linear elements are in bending, by Poisson's ratio, and what volume in patches does about it.

    python lab/locking/locking.py [--robots FOLDER] [--repeat 7]

**Bending.** A strip or a bar, four times as long as high, whose two ends are held as in pure bending (Saint-Venant):
its energy then is half E I kappa^2 a length, in the plane with E / (1 - nu^2) for E, whatever the length. Linear
elements store more of it at the same curvature; how much more, in percent, is the error of the stiffness, at rest.
Under a given moment the tip of the body moves by 1 / (1 + error) of what it should.

**Locking alone.** The stiffness with the volume in each element over that with the volume in patches. What is left with
patches is the other fault of linear elements: they cannot bend (shear locking), even at Poisson's ratio 0.

**Stability.** The smallest singular value of the divergence from velocities, held at the border, to a pressure a patch,
less the constant one (the inf-sup constant); and how many pressures no velocity feels.

**Solves.** Of robots at a tenth of their cables (the finger at 20 mm): CPU time, iterations, entries of the Hessian;
where the first marker is.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations, permutations
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

from benchmark_bodies import ROBOTS, sofa_robots
from scipy.linalg import cholesky, solve_triangular
from scipy.sparse.linalg import splu

from hydrostat.geometry import Mesh, Outline, triangulate
from hydrostat.mechanics import PATCH_SIZE, Assembly, Energy, NeoHookean, PatchDilatation, grow_patches
from hydrostat.robot import Material, Robot, Volume, gallery_folder, load_robot
from hydrostat.simulation import Simulation

HEIGHT = 0.02
LENGTH = 4 * HEIGHT
YOUNG = 30e3

Kind = str | int
"""How the volume is measured: in the "element", about each node ("nodal"), or in patches of so many elements."""


def grid(cells: tuple[int, int, int], side: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of a grid of cubes [m], from the middle of an end, and their indices."""
    axes = [side * np.arange(count + 1) for count in cells]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return nodes - [0.0, side * cells[1] / 2, side * cells[2] / 2], np.arange(len(nodes)).reshape(np.add(cells, 1))


def kuhn(rows: int, length: float = LENGTH) -> Mesh:
    """Cubes cut into six tetrahedra about one diagonal, all the same way."""
    nodes, index = grid((round(length / HEIGHT * rows), rows, rows), HEIGHT / rows)
    elements = []
    for corner in np.ndindex(*np.subtract(index.shape, 1)):
        for order in permutations(np.eye(3, dtype=int)):
            path = np.cumsum([corner, *order], axis=0)
            elements.append(index[tuple(path.T)])
    return Mesh(nodes, upright(nodes, np.array(elements)))


def lattice(rows: int, length: float = LENGTH) -> Mesh:
    """Cubes with a node in the middle, joined to those of their neighbors (body-centered); halved at the border."""
    cells = (round(length / HEIGHT * rows), rows, rows)
    side = HEIGHT / rows
    corners, _ = grid(cells, side)
    number = {tuple(np.rint(2 * node / side + [0, rows, rows]).astype(int)): node for node in corners}
    index = {place: k for k, place in enumerate(number)}

    def node(place: np.ndarray) -> int:
        return index.setdefault(tuple(int(x) for x in place), len(index))

    elements = []
    for cell in np.ndindex(*cells):
        middle = 2 * np.array(cell) + 1
        for axis in range(3):
            one, two = np.delete(np.eye(3, dtype=int), axis, axis=0)
            for sign in (-1, 1):
                face = middle + sign * np.eye(3, dtype=int)[axis]
                beyond = 2 * face - middle
                inside = 0 < beyond[axis] < 2 * cells[axis]
                if inside and sign < 0:
                    continue
                ring = [face + s * one + t * two for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
                for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
                    elements.append([node(middle), node(beyond if inside else face), node(a), node(b)])
    nodes = 0.5 * side * (np.array(list(index)) - [0, rows, rows])
    return Mesh(nodes, upright(nodes, np.array(elements)))


def drawn(rows: int, length: float = LENGTH) -> Mesh:
    """A rectangle as hydrostat meshes it."""
    half = HEIGHT / 2
    corners = np.array([[0.0, -half], [length, -half], [length, half], [0.0, half]])
    return triangulate(Outline(corners), HEIGHT / rows)


def upright(nodes: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """The elements with their corners in positive order."""
    corners = nodes[elements]
    flipped = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
    elements[flipped, :2] = elements[flipped, 1::-1]
    return elements


MESHES: dict[str, tuple[Callable[..., Mesh], tuple[int, ...], tuple[Kind, ...]]] = {
    "triangles, as hydrostat makes them": (drawn, (2, 4, 8), ("element", "nodal", 2, 3, 4, 6, 8)),
    "tetrahedra, cubes cut in six": (kuhn, (2, 3, 4, 6), ("element", "nodal", 4, 6, 8, 12)),
    "tetrahedra, body-centered lattice": (lattice, (2, 3, 4), ("element", "nodal", 4, 6, 8, 12)),
}
"""Maker, numbers of elements across the height, and ways to measure the volume."""


def volume_energy(mesh: Mesh, kind: Kind, lame: float) -> PatchDilatation:
    """The volumetric term; the patch about a node has its share of each element there."""
    corners = mesh.dim + 1
    if kind == "nodal":
        shared = np.repeat(mesh.elements, corners, axis=0)
        return PatchDilatation(mesh.nodes, shared, mesh.elements.ravel(), lame=lame, thickness=1 / corners)
    patches = np.arange(len(mesh.elements)) if kind == "element" else grow_patches(mesh.elements, int(kind))
    return PatchDilatation(mesh.nodes, mesh.elements, patches, lame=lame)


def exact(mesh: Mesh, poisson: float) -> np.ndarray:
    """Displacements in pure bending of curvature 1 (Saint-Venant); in the plane of plane strain."""
    if mesh.dim == 2:
        x, y = mesh.nodes.T
        return np.column_stack([-x * y, (x**2 + poisson / (1 - poisson) * y**2) / 2])
    x, y, z = mesh.nodes.T
    return np.column_stack([-x * y, (x**2 + poisson * (y**2 - z**2)) / 2, poisson * y * z])


def stiffness_error(mesh: Mesh, poisson: float, kind: Kind) -> tuple[float, int]:
    """By how much the bending stiffness is too large, a fraction; and the entries of the Hessian."""
    mu, lame = Material(young=YOUNG, poisson=poisson, density=1.0).lame
    body: list[Energy] = [NeoHookean(mesh.nodes, mesh.elements, mu=mu, lame=0.0), volume_energy(mesh, kind, lame)]
    hessian = Assembly(body, rest=mesh.nodes, control_count=0).hessian(mesh.nodes, np.zeros(0))
    along = mesh.nodes[:, 0]
    held = np.repeat((along < 1e-9) | (along > LENGTH - 1e-9), mesh.dim)
    moved = np.where(held, exact(mesh, poisson).ravel(), 0.0)
    moved[~held] = splu(hessian[~held][:, ~held].tocsc()).solve(-(hessian @ moved)[~held])
    modulus, inertia = (YOUNG / (1 - poisson**2), HEIGHT**3 / 12) if mesh.dim == 2 else (YOUNG, HEIGHT**4 / 12)
    return float(moved @ (hessian @ moved)) / (modulus * inertia * LENGTH) - 1, hessian.nnz


def bending() -> None:
    ratios = (0.0, 0.3, 0.45, 0.49)
    for name, (make, rows, kinds) in MESHES.items():
        meshes = [make(count) for count in rows]
        across = " / ".join(map(str, rows))
        print(f"\n{name}: error of the bending stiffness [%] with {across} elements across\n")
        print("| volume in | " + " | ".join(f"nu {ratio:g}" for ratio in ratios) + " | entries of the finest |")
        print("|---" * (len(ratios) + 2) + "|")
        for kind in kinds:
            found = [[stiffness_error(mesh, ratio, kind) for mesh in meshes] for ratio in ratios]
            cells = [" / ".join(f"{100 * error:.1f}" for error, _ in row) for row in found]
            print(f"| {label(kind)} | " + " | ".join(cells) + f" | {found[-1][-1][1]} |", flush=True)


def label(kind: Kind) -> str:
    return {"element": "elements", "nodal": "nodal patches"}.get(str(kind), f"patches of {kind}")


def locking_alone() -> None:
    ratios = (0.2, 0.25, 0.3, 0.35, 0.4, 0.43, 0.45, 0.47, 0.49)
    print("\nwhat locking adds to the bending stiffness [%], 4 elements across\n")
    print("| mesh | " + " | ".join(f"nu {ratio:g}" for ratio in ratios) + " |")
    print("|---" * (len(ratios) + 1) + "|")
    for name, (make, _, _) in MESHES.items():
        mesh = make(4)
        pairs = [[stiffness_error(mesh, r, kind)[0] for kind in ("element", PATCH_SIZE[mesh.dim])] for r in ratios]
        print(f"| {name} | " + " | ".join(f"{100 * ((1 + a) / (1 + b) - 1):.1f}" for a, b in pairs) + " |", flush=True)


def inf_sup(mesh: Mesh, kind: Kind) -> tuple[float, int]:
    """The inf-sup constant, and how many pressures no velocity feels, besides the constant one."""
    body = NeoHookean(mesh.nodes, mesh.elements, mu=1.0, lame=0.0)
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    free = ~np.repeat(((mesh.nodes < low + 1e-9) | (mesh.nodes > high - 1e-9)).any(axis=1), mesh.dim)
    volume = volume_energy(mesh, kind, 1.0)
    size = 1e-7 * HEIGHT
    divergence = np.zeros((len(volume.volumes), mesh.nodes.size))
    for column in np.flatnonzero(free):
        step = np.zeros(mesh.nodes.size)
        step[column] = size
        divergence[:, column] = volume.changes(mesh.nodes + step.reshape(mesh.nodes.shape)) / size
    laplacian = np.zeros((len(mesh.nodes),) * 2)
    spread = body.volumes[:, None, None] * (body.shape_gradients @ body.shape_gradients.swapaxes(1, 2))
    np.add.at(laplacian, (mesh.elements[:, :, None], mesh.elements[:, None, :]), spread)
    norm = cholesky(np.kron(laplacian, np.eye(mesh.dim))[np.ix_(free, free)], lower=True)
    felt = np.sqrt(volume.volumes)[:, None] * divergence[:, free]
    values = np.linalg.svd(solve_triangular(norm, felt.T, lower=True), compute_uv=False)
    values = np.sort(np.concatenate([values, np.zeros(max(0, len(felt) - len(values)))]))
    return float(values[1]), int((values < 1e-7).sum()) - 1


def stability() -> None:
    for name, (make, _, kinds) in MESHES.items():
        rows = (4, 8, 12) if make is drawn else (3, 4, 5)
        print(f"\n{name}, a square or a cube: inf-sup constant (pressures that nothing feels), {rows} across\n")
        for kind in kinds:
            found = [inf_sup(make(count, HEIGHT), kind) for count in rows]
            print(f"- {label(kind)}: " + ", ".join(f"{value:.3f} ({lost})" for value, lost in found), flush=True)


@dataclass(frozen=True)
class Timed:
    """One solve: CPU time [ms], iterations, entries, and the place of the first marker [mm]."""

    time: float
    iterations: int
    entries: int
    tip: np.ndarray
    tension: float


def solve(robot: Robot, contractions: np.ndarray, repeat: int) -> Timed:
    simulation = Simulation(robot)
    pose = simulation.solve(contractions)
    times = []
    for _ in range(repeat):
        start = time.process_time()
        pose = simulation.solve(contractions)
        times.append(time.process_time() - start)
    entries = simulation.assembly.hessian(pose.nodes, contractions).nnz
    tip = 1e3 * next(iter(pose.markers.values()))
    return Timed(1e3 * float(np.median(times)), pose.result.iterations, entries, tip, float(pose.tensions.max()))


def refined(mesh: Mesh) -> Mesh:
    """Each tetrahedron cut into eight by the middles of its edges, each triangle into four."""
    middles = {tuple(edge): len(mesh.nodes) + k for k, edge in enumerate(np.sort(mesh.edges, axis=1).tolist())}
    nodes = np.concatenate([mesh.nodes, mesh.nodes[list(middles)].mean(axis=1)])
    elements = []
    for corners in mesh.elements.tolist():
        m = {pair: middles[tuple(sorted(corners[k] for k in pair))] for pair in combinations(range(len(corners)), 2)}
        if mesh.dim == 2:
            a, b, c = corners
            elements += [(a, m[0, 1], m[0, 2]), (b, m[1, 2], m[0, 1]), (c, m[0, 2], m[1, 2]), tuple(m.values())]
            continue
        for k, corner in enumerate(corners):
            elements.append((corner, *(m[pair] for pair in m if k in pair)))
        ring = [m[0, 1], m[0, 2], m[2, 3], m[1, 3]]
        elements += [(m[0, 3], m[1, 2], one, two) for one, two in zip(ring, ring[1:] + ring[:1], strict=True)]
    return Mesh(nodes, upright(nodes, np.array(elements)))


def refinement(folder: Path) -> None:
    """The finger, cut finer and finer: by elements it must come to what it is by patches."""
    readers = sofa_robots(folder)
    if "finger" not in readers:
        return
    robot = readers["finger"]()
    print("\nthe finger at 20 mm, nu 0.45\n\n| elements | volume in | tension N | marker mm |\n|---|---|---|---|")
    mesh = robot.body.mesh
    for _ in range(3):
        for volume in Volume:
            body = replace(robot.body, mesh=mesh, volume=volume)
            found = solve(replace(robot, body=body), np.array([0.02]), 1)
            tip = ", ".join(f"{x:.2f}" for x in found.tip)
            print(f"| {len(mesh.elements)} | {volume} | {found.tension:.3f} | {tip} |", flush=True)
        mesh = refined(mesh)


def robustness(count: int) -> None:
    """Solves of the starfish at random contractions, up to 40 % of a winch's shortest cable."""
    robot = load_robot(gallery_folder("starfish"))
    shortest = [min(c.segments.sum() for c in robot.cables if c.winch == w.name) for w in robot.winches]
    print(f"\n{count} random contractions of the starfish\n")
    print("| nu | volume in | converged | iterations median / max | CPU ms median |\n|---|---|---|---|---|")
    for poisson in (0.3, 0.45, 0.49):
        for volume in Volume:
            body = replace(robot.body, material=replace(robot.body.material, poisson=poisson), volume=volume)
            simulation = Simulation(replace(robot, body=body))
            random, results, times = np.random.default_rng(0), [], []
            for _ in range(count):
                goal = 0.4 * random.uniform(size=len(shortest)) * shortest
                start = time.process_time()
                results.append(simulation.solve(goal, strict=False).result)
                times.append(time.process_time() - start)
            iterations = [result.iterations for result in results]
            print(
                f"| {poisson:g} | {volume} | {sum(result.converged for result in results)} | "
                f"{np.median(iterations):.0f} / {max(iterations)} | {1e3 * np.median(times):.1f} |",
                flush=True,
            )


def solves(folder: Path, repeat: int) -> None:
    robots = {"starfish": load_robot(gallery_folder("starfish"))}
    robots |= {name: read() for name, read in sofa_robots(folder).items() if name in ("finger", "diamond")}
    print("\n| robot | nu | volume in | entries | iterations | CPU ms | tension N | first marker mm |")
    print("|---|---|---|---|---|---|---|---|")
    for name, robot in robots.items():
        shortest = [min(c.segments.sum() for c in robot.cables if c.winch == w.name) for w in robot.winches]
        goal = np.full(1, 0.02) if name == "finger" else 0.1 * np.array(shortest)
        for poisson in (0.3, 0.45, 0.49):
            for volume in Volume:
                body = replace(robot.body, material=replace(robot.body.material, poisson=poisson), volume=volume)
                found = solve(replace(robot, body=body), goal, repeat)
                tip = ", ".join(f"{x:.2f}" for x in found.tip)
                print(
                    f"| {name} | {poisson:g} | {volume} | {found.entries} | {found.iterations} | {found.time:.1f} | "
                    f"{found.tension:.3f} | {tip} |",
                    flush=True,
                )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=Path, default=ROBOTS, help="robots of SOFA's SoftRobots; left out if missing")
    parser.add_argument("--repeat", type=int, default=7, help="runs of each solve")
    parser.add_argument("--random", type=int, default=100, help="random contractions")
    options = parser.parse_args()
    print(machine())
    bending()
    locking_alone()
    stability()
    solves(options.robots, options.repeat)
    refinement(options.robots)
    robustness(options.random)


if __name__ == "__main__":
    main()
