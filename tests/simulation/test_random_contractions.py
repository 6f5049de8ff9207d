"""Random contractions on every example: all converge. Oracle: residual, J and numbers judged afresh (benchmarks)."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot
from robustness import example_folders, fault, sweep  # pyright: ignore[reportMissingImports]

import hydrostat as hs
from hydrostat.robot import load_robot

QUADRATIC = ("finger", "spiral")


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize(
    "folder",
    [
        pytest.param(folder, id=folder.name)
        for folder in example_folders()
        if folder.name not in QUADRATIC and next(folder.glob("*.svg"), None)
    ],
)
def test_every_random_contraction_of_every_flat_example_converges(folder: Path) -> None:
    found = sweep(load_robot(folder), 50, seed=1)
    assert found.failures == []
    assert max(found.iterations) < 80


@pytest.mark.usefixtures("unchecked")
@pytest.mark.slow
def test_random_contractions_of_quadratic_elements_invert_none() -> None:
    """Three times as far as the finger bends, where corners inverted once; one draw, as these poses take seconds."""
    assert sweep(gallery_robot("finger"), 1, seed=1).failures == []


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("name", ["cupping_hand", "octopus_arm"])
@pytest.mark.slow
def test_random_contractions_of_a_body_in_space_converge(name: str) -> None:
    assert sweep(gallery_robot(name), 8, seed=1).failures == []


@pytest.mark.slow
def test_the_judge_can_find_fault() -> None:
    """Oracle: an equilibrium that is none: one node moved, one element turned over, one number lost."""
    folder = example_folders()[0]
    simulation = hs.Simulation(hs.load_robot(folder))
    pose = simulation.solve(np.full(len(simulation.robot.winches), 0.01))
    assert fault(simulation, pose) == ""
    moved, inverted, lost = (pose.nodes.copy() for _ in range(3))
    moved[0] += 1e-7
    inverted[simulation.robot.body.mesh.elements[0, 0]] += 1.0
    lost[0] = np.nan
    assert "residual" in fault(simulation, replace(pose, nodes=moved))
    assert "J =" in fault(simulation, replace(pose, nodes=inverted))
    assert "not finite" in fault(simulation, replace(pose, nodes=lost))
