"""The core at every level of vector instructions that the processor has. Oracle: the other levels."""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from hydrostat.kernel import native

ANSWERS = """
import sys
import numpy as np
from builders import box_mesh, strip_robot
from hydrostat.kernel import native
from hydrostat.mechanics import Assembly, NeoHookean, PinEnergy
from hydrostat.simulation import Simulation

random, mesh, none, found = np.random.default_rng(0), box_mesh((5, 4, 3)), np.zeros(0), []
held = np.arange(24)[:, None]
pins = PinEnergy(stencils=held, weights=np.ones((24, 1)), targets=mesh.nodes[:24], stiffness=np.full(24, 1e4))
elastic = NeoHookean(mesh.nodes, mesh.elements, mu=3e4, lame=1e5)
assembly = Assembly([elastic, pins], rest=mesh.nodes, control_count=0)
nodes = mesh.nodes + 0.2 * np.ptp(mesh.nodes, axis=0).min() / 4 * random.uniform(-1, 1, mesh.nodes.shape)
found += [np.array([assembly.value(nodes, none)]), assembly.gradient(nodes, none)]
for share in (0.0, 1.0):
    found.append(assembly.hessian(nodes, none, projection=share).data)
factors = assembly.pattern.analysis.factorize(assembly.hessian(mesh.nodes, none).data)
for sides in (1, 4, 7, 12, 20):
    found.append(factors.solve(random.standard_normal((assembly.size, sides))))
turned = np.zeros_like(nodes)
native.turn(mesh.nodes, nodes - mesh.nodes, *elastic._groups, turned)
found.append(turned)
simulation = Simulation(strip_robot(columns=20, rows=4))
pose = simulation.solve({"up": 0.01})
found += [pose.nodes, pose.tensions, simulation.jacobian(pose)]
assert native.instructions == sys.argv[2], native.instructions
np.savez(sys.argv[1], *found)
"""


def run(level: str, *arguments: str, code: str = ANSWERS) -> subprocess.CompletedProcess[str]:
    folders = [str(Path(__file__).parents[1]), *sys.path]
    environment = os.environ | {"HYDROSTAT_LEVEL": level, "PYTHONPATH": os.pathsep.join(folders)}
    command = [sys.executable, "-c", code, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


@cache
def answers(level: str, folder: Path) -> list[np.ndarray]:
    file = folder / f"{level}.npz"
    ended = run(level, str(file), level)
    assert ended.returncode == 0, ended.stderr
    with np.load(file) as arrays:
        return [arrays[name] for name in arrays.files]


@pytest.mark.parametrize("level", native.levels[:-1])
def test_levels_agree(level: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Elements, factors, right-hand sides, arcs, a pose and its slopes, to 1e-10 of the largest number."""
    folder = tmp_path_factory.getbasetemp()
    for one, other in zip(answers(level, folder), answers(native.levels[-1], folder), strict=True):
        assert np.abs(one - other).max() <= 1e-10 * np.abs(other).max()


def test_an_unknown_level_is_refused_in_one_line() -> None:
    code = "import sys; sys.argv[1:] = ['check', 'gallery:starfish']; from hydrostat.cli.main import main; main()"
    ended = run("v9", code=code)
    assert ended.returncode == 2
    assert ended.stderr.startswith('hydrostat: error: HYDROSTAT_LEVEL: unknown level "v9". This processor has: base')
    assert ended.stderr.count("\n") == 1
