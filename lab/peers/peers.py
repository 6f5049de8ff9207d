"""Other programs on our bodies, in one run on one machine: error against CPU time.

    python lab/peers/peers.py [--env FOLDER] [--only scikit-fem ...] [--budget 20]

Two bodies of the gallery, held where their pins are, bend under their own weight across, once and five times. All get
the same tetrahedra, the same held nodes, the same force on each node and Lame's parameters of the same foam. Each peer
runs in a process of its own, on one core, from a virtual environment of its own in FOLDER (in the cache of the user
unless told otherwise); one that cannot be had, or fails, costs a line and not the run. What is true is what plain NumPy
and SciPy find by Newton's method, for each peer with its own material (solvers/laws.py).
"""

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import venv
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

sys.path.append(str(Path(__file__).parent / "solvers"))
from held_body import HeldBody, Trail
from laws import LAWS, Reference

FOLDER = Path(__file__).parent / "solvers"

BODIES = {"cupping_hand": (0.0, -1.0, 0.0), "fish_tail": (0.0, 1.0, 0.0)}
"""Which way each is bent."""

WEIGHTS = (1, 5)
"""How many times its own weight pulls a body."""

LEVELS = (0.1, 1e-2, 1e-4)
"""Errors, as a share of the farthest way of a node, whose CPU time is told."""

INSTALL_LIMIT, RUN_LIMIT = 300, 240
"""Of the clock [s], of an installation and of one process."""


@dataclass(frozen=True)
class Peer:
    """A method that is timed.

    Attributes:
        name: in the table.
        file: in solvers.
        variant: which of its methods.
        law: its material, one of LAWS.
        packages: what pip installs, with versions; none for hydrostat itself.
    """

    name: str
    file: str
    variant: str
    law: str = "Neo-Hookean"
    packages: tuple[str, ...] = ()


SCIPY = ("scipy==1.17.1", "numpy==2.4.6")
JAX_FEM = (
    "jax-fem==0.0.11",
    "jax==0.10.2",
    "jaxlib==0.10.2",
    "fenics-basix==0.11.0",
    "gmsh==4.15.2",
    "pyfiglet==1.0.4",
)
MUJOCO = ("mujoco==4.0.0", "numpy==2.4.6")
NEWTON = ("newton==1.8.0", "warp-lang==1.19.0", "numpy==2.4.6")

PEERS = (
    Peer("hydrostat", "ours.py", "kept"),
    Peer("hydrostat, body made again", "ours.py", "again"),
    Peer("scikit-fem, SuperLU", "scikit_fem.py", "", packages=("scikit-fem==12.0.2", *SCIPY)),
    Peer("jax-fem, SuperLU", "jax_fem_assembly.py", "", packages=(*JAX_FEM, "meshio==5.3.5", *SCIPY)),
    Peer("MuJoCo flex", "mujoco_flex.py", "svk", "St. Venant-Kirchhoff", MUJOCO),
    Peer("MuJoCo flex, SNH", "mujoco_flex.py", "snh", "stable Neo-Hookean", MUJOCO),
    Peer("Newton, VBD", "newton_warp.py", "vbd", "stable Neo-Hookean", NEWTON),
    Peer("Newton, semi-implicit", "newton_warp.py", "semi", "stable, with logarithm", NEWTON),
)

LEFT_OUT = (
    "jax-fem's own solver: it needs petsc4py, of which there is no wheel; SciPy solves what jax-fem assembles.",
    "jax-fem 0.0.12: needs Python 3.12; ours is 3.11.",
    "Newton, XPBD: no such material. Its distortion is tr C - 3 squared, which no small shear stiffens.",
    "Cables: no peer here has one that slides through a body and goes slack; so the loads are dead.",
    "Flat bodies: the flexes of MuJoCo and the triangles of Newton are shells, not plane strain; so both are in space.",
)


def one_thread() -> dict[str, str]:
    """Variables of a process that has one thread and knows no other environment."""
    kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    threads = ("OMP", "OPENBLAS", "MKL")
    kept |= {f"{name}_NUM_THREADS": "1" for name in threads}
    return kept | {
        "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false",
        "JAX_PLATFORMS": "cpu",
        "CUDA_VISIBLE_DEVICES": "",
    }


def last_line(text: str) -> str:
    """The last line that says something, shortened."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and "notice" not in line.lower()]
    return lines[-1][:160] if lines else "it said nothing"


def installed(peer: Peer, folder: Path) -> tuple[Path, str]:
    """Python of the environment of a peer, made if it is not there; and why it cannot be had, empty if it can."""
    if not peer.packages:
        return Path(sys.executable), ""
    home = folder / Path(peer.file).stem
    python = home / ("Scripts" if platform.system() == "Windows" else "bin") / "python"
    stamp = home / "installed.txt"
    if stamp.is_file() and stamp.read_text() == "\n".join(peer.packages):
        return python, ""
    try:
        venv.create(home, clear=True)  # without a pip of its own, which takes seconds: ours installs
        command = [
            sys.executable,
            "-m",
            "pip",
            "--python",
            str(python),
            "install",
            "--quiet",
            "--no-compile",
            "--only-binary=:all:",
            *peer.packages,
        ]
        found = subprocess.run(command, capture_output=True, text=True, timeout=INSTALL_LIMIT, check=False)
    except (OSError, subprocess.SubprocessError) as error:
        return python, last_line(str(error))
    if found.returncode != 0:
        return python, last_line(found.stderr)
    stamp.write_text("\n".join(peer.packages))
    return python, ""


def run(peer: Peer, folder: Path, body: Path, budget: float, *, fresh: bool = False) -> tuple[Trail | None, str]:
    """What a peer gave on a stored body, or why it gave nothing; `fresh`: without kernels compiled before."""
    python, reason = installed(peer, folder)
    if reason:
        return None, f"cannot be installed: {reason}"
    variables = one_thread()
    if not peer.packages:
        variables["PYTHONPATH"] = os.pathsep.join(filter(None, [str(FOLDER.parents[2]), os.environ.get("PYTHONPATH")]))
    with tempfile.TemporaryDirectory() as empty:
        result = Path(empty) / "trail.npz"
        if fresh:
            variables |= {name: str(Path(empty) / name) for name in ("HYDROSTAT_CACHE", "WARP_CACHE_PATH")}
        command = [str(python), str(FOLDER / peer.file), str(body), peer.variant, str(budget), str(result)]
        try:
            found = subprocess.run(
                command, capture_output=True, text=True, timeout=RUN_LIMIT, check=False, cwd=empty, env=variables
            )
        except (OSError, subprocess.SubprocessError) as error:
            return None, f"does not run: {last_line(str(error))}"
        if found.returncode != 0 or not result.is_file():
            return None, f"does not run: {last_line(found.stderr)}"
        with np.load(result) as stored:
            return Trail(stored["seconds"], stored["answers"], float(stored["ready"]), bool(stored["done"])), ""


def gallery_body(name: str, weight: float) -> HeldBody:
    """A body of the gallery under some times its own weight, held where its pins are."""
    from hydrostat import Simulation
    from hydrostat.robot import gallery_folder, load_robot

    robot = load_robot(gallery_folder(name))
    pull = tuple(9.81 * weight * part for part in BODIES[name])
    robot = replace(robot, winches=(), cables=(), markers=(), poses={}, gravity=pull)
    mesh, masses = robot.body.mesh, Simulation(robot).body.masses
    held = np.any([pin.holds(mesh) for pin in robot.pins], axis=0)
    mu, lame = robot.body.material.lame
    return HeldBody(mesh.nodes, mesh.elements, held, masses[:, None] * np.array(pull), mu, lame, masses)


def truths(body: HeldBody, laws: set[str]) -> dict[str, np.ndarray]:
    """Equilibrium by each law that has one that can be reached.

    Raises:
        RuntimeError: our own law has none.
    """
    steps = 5 * round(np.linalg.norm(body.forces.sum(axis=0)) / (9.81 * body.masses.sum()))
    found = {law: Reference(body, LAWS[law]).loaded(steps) for law in laws}
    if found["Neo-Hookean"] is None:
        raise RuntimeError("no equilibrium was found to measure against")
    return {law: nodes for law, nodes in found.items() if nodes is not None}


def apart(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Largest distance of a node from where it should be [m]; infinite where a number is none."""
    far = np.linalg.norm(one - other, axis=-1).max(axis=-1)
    return np.where(np.isfinite(far), far, np.inf)


def row(peer: Peer, trail: Trail, body: HeldBody, true: dict[str, np.ndarray]) -> str:
    """A line of the table: when the errors went below each level for good, and what was left in the end."""
    ours = true["Neo-Hookean"]
    own = true.get(peer.law)
    way = float(apart(ours, body.nodes))
    errors = apart(trail.answers, ours if own is None else own)
    cells = []
    for level in LEVELS:
        above = np.flatnonzero(errors > level * way)
        first = above[-1] + 1 if above.size else 0
        cells.append(f"{1e3 * trail.seconds[first]:.0f}" if first < len(errors) else "never")
    end = "" if trail.done else ", time up"
    law_apart = "none found" if own is None else f"{1e3 * float(apart(own, ours)):.3g}"
    last = errors[-1] if np.isfinite(errors[-1]) and errors[-1] < 10 * way else np.inf
    left = f"{1e3 * last:.1e} | {1e3 * float(apart(trail.answers[-1], ours)):.1e}"
    cells += [f"{1e3 * trail.seconds[-1]:.0f}{end}", "flew apart | -" if np.isinf(last) else left, law_apart]
    return f"| {peer.name} | {peer.law} | {' | '.join(cells)} |"


def print_case(name: str, weight: float, peers: Sequence[Peer], folder: Path, budget: float) -> None:
    """The table of one body under one load."""
    body = gallery_body(name, weight)
    true = truths(body, {peer.law for peer in peers} | {"Neo-Hookean"})
    ours = true["Neo-Hookean"]
    load = np.linalg.norm(body.forces.sum(axis=0))
    left = np.abs(Reference(body, LAWS["Neo-Hookean"]).left_over(ours)).max() / load
    print(
        f"{name}, {len(body.nodes)} nodes, {len(body.elements)} tetrahedra, {weight} times its weight "
        f"({load:.2f} N): a node moves by up to {1e3 * float(apart(ours, body.nodes)):.1f} mm; "
        f"force left over by the reference: {left:.0e} of the load\n"
    )
    heads = [f"CPU ms to {100 * level:g} %" for level in LEVELS]
    head = ["by", "material", *heads, "CPU ms in all", "error mm", "from ours mm", "materials apart mm"]
    print(f"| {' | '.join(head)} |\n{'|---' * len(head)}|")
    with tempfile.TemporaryDirectory() as place:
        stored = Path(place) / "body.npz"
        body.save(stored)
        for peer in peers:
            trail, reason = run(peer, folder, stored, budget)
            print(row(peer, trail, body, true) if trail else f"| {peer.name} | {reason} |", flush=True)
    print()


def print_ready(peers: Sequence[Peer], folder: Path) -> None:
    """What it takes from a new process to the first answer on the first body, without and with kernels stored."""
    head = ["by", "nothing compiled before s", "kernels stored s"]
    print("CPU time of a process until it has a first answer (imports, model, compiling):\n")
    print(f"| {' | '.join(head)} |\n{'|---' * len(head)}|")
    with tempfile.TemporaryDirectory() as place:
        stored = Path(place) / "body.npz"
        gallery_body(next(iter(BODIES)), WEIGHTS[0]).save(stored)
        for peer in peers:
            found = [run(peer, folder, stored, 0.0, fresh=fresh) for fresh in (True, False, False)]
            told = [f"{trail.ready:.1f}" if trail else reason for trail, reason in (found[0], found[2])]
            print(f"| {peer.name} | {' | '.join(told)} |", flush=True)
    print()


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    cache = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "hydrostat" / "peers"
    parser.add_argument("--env", type=Path, default=cache, help="where the environments of the peers are made")
    parser.add_argument("--only", nargs="+", default=[""], help="peers whose names begin like this")
    parser.add_argument("--budget", type=float, default=20.0, help="CPU time of one run of a peer [s]")
    options = parser.parse_args(arguments)
    peers = [peer for peer in PEERS if any(peer.name.startswith(name) for name in options.only)]
    print(f"{machine()}\n")
    print_ready(peers, options.env.absolute())
    for name in BODIES:
        for weight in WEIGHTS:
            print_case(name, weight, peers, options.env.absolute(), options.budget)
    print("Told, not timed:\n")
    print("\n".join(f"- {line}" for line in LEFT_OUT))


if __name__ == "__main__":
    main()
