"""The core at each level of vector instructions of the processor. Oracles: the other levels, LAPACK, formulas."""

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
from dataclasses import replace
from builders import box_mesh, strip_robot
from hydrostat.kernel import native
from hydrostat.mechanics import Assembly, NeoHookean, NewtonOptions, PinEnergy, QuadraticSolid
from hydrostat.simulation import Simulation, cable_sensitivities, find_contacts
from touching import fork_robot

random, mesh, none, found = np.random.default_rng(0), box_mesh((5, 4, 3)), np.zeros(0), []
held = np.arange(24)[:, None]
pins = PinEnergy(stencils=held, weights=np.ones((24, 1)), targets=mesh.nodes[:24], stiffness=np.full(24, 1e4))
elastic = NeoHookean(mesh.nodes, mesh.elements, mu=3e4, lame=1e5)
assembly = Assembly([elastic, pins], rest=mesh.nodes, control_count=0)
nodes = mesh.nodes + 0.2 * np.ptp(mesh.nodes, axis=0).min() / 4 * random.uniform(-1, 1, mesh.nodes.shape)
found += [np.array([assembly.value(nodes, none)]), assembly.gradient(nodes, none)]
for share in (0.0, 1.0):
    found.append(assembly.hessian(nodes, none, projection=share).data)
bent = mesh.to_quadratic()
curved = QuadraticSolid(bent.nodes, bent.quadratic, mu=3e4, lame=1e6)
moved = bent.nodes + 0.02 * np.ptp(bent.nodes, axis=0).min() / 4 * random.uniform(-1, 1, bent.nodes.shape)
found += [np.array([curved.value(moved, none), curved.min_volume_ratio(moved)]), curved.gradient(moved, none)]
found += [curved.projected_hessian(moved, none, share) for share in (0.0, 1.0)]
factors = assembly.pattern.analysis.factorize(assembly.hessian(mesh.nodes, none).data)
for sides in (1, 4, 7, 12, 20):
    found.append(factors.solve(random.standard_normal((assembly.size, sides))))
turned = np.zeros_like(nodes)
native.turn(mesh.nodes, nodes - mesh.nodes, *elastic._groups, turned)
found.append(turned)
simulation = Simulation(strip_robot(columns=20, rows=4))
pose = simulation.solve({"up": 0.01})
found += [pose.nodes, pose.tensions, simulation.jacobian(pose)]
for dim in (2, 3):
    fork = fork_robot(dim)
    for friction in (0.0, 0.2):
        cables = tuple(replace(cable, friction=friction) for cable in fork.cables)
        simulation = Simulation(replace(fork, cables=cables), options=NewtonOptions(tolerance=1e-13))
        pose = simulation.solve([0.012, 0.011])
        slopes = cable_sensitivities(simulation, pose, [0])
        assert find_contacts(simulation, pose)
        found += [pose.nodes, pose.tensions, simulation.jacobian(pose)]
        found += [slopes.contractions, slopes.slack, slopes.ratios, slopes.points]
        if not friction:
            touching = simulation.assembly.with_active_terms(pose.unknowns)
            adjoint = simulation.adjoint(pose, pose.nodes)
            found += [touching.hessian(pose.unknowns, pose.contractions).data, adjoint.pin_stiffness]
            found += [np.array([each]) for each in (adjoint.young, adjoint.poisson)]
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
    """Elements, factors, right-hand sides, arcs; poses with contact and friction and their slopes: to 1e-10."""
    folder = tmp_path_factory.getbasetemp()
    for one, other in zip(answers(level, folder), answers(native.levels[-1], folder), strict=True):
        assert np.abs(one - other).max() <= 1e-10 * np.abs(other).max()


@pytest.mark.slow
@pytest.mark.parametrize("level", native.levels[:-1])
@pytest.mark.skipif("HYDROSTAT_LEVEL" in os.environ, reason="one level was asked for")
def test_the_tests_of_the_core_at_lower_levels(level: str) -> None:
    """Elements, factors and threads against the oracles of these tests."""
    file = Path(__file__).with_name("test_compiled_core.py")
    code = f"import pytest, sys; sys.exit(pytest.main(['-q', '-n', '0', {str(file)!r}]))"
    ended = run(level, code=code)
    assert ended.returncode == 0, ended.stdout


def test_an_unknown_level_is_refused_in_one_line() -> None:
    code = "import sys; sys.argv[1:] = ['check', 'gallery:starfish']; from hydrostat.cli.main import main; main()"
    ended = run("v9", code=code)
    assert ended.returncode == 2
    assert ended.stderr.startswith('hydrostat: error: HYDROSTAT_LEVEL: unknown level "v9". This processor has: base')
    assert ended.stderr.count("\n") == 1
