"""Hysteresis of materials. Oracles: Prandtl's and Iwan's loops in closed form, work round closed paths, differences."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import FOAM, gallery_robot, strip_mesh, strip_robot

from hydrostat.design import DesignRequest
from hydrostat.errors import InputError
from hydrostat.mechanics import NeoHookean, PrandtlEnergy
from hydrostat.robot import Marker, PoseTarget, PrandtlElement, get_material, load_robot, robot_text, save_robot
from hydrostat.simulation import Simulation, find_modes

SLIDERS = (PrandtlElement(young=20e3, strain=0.01), PrandtlElement(young=10e3, strain=0.04))
NONE = np.zeros(0)


def strip() -> Simulation:
    robot = strip_robot(columns=8, rows=2)
    return Simulation(replace(robot, body=replace(robot.body, material=replace(FOAM, hysteresis=SLIDERS))))


def sliders() -> list[PrandtlEnergy]:
    mesh = strip_mesh(2, 1)
    solid = NeoHookean(mesh.nodes, mesh.elements, mu=0.0, lame=0.0, thickness=0.03)
    points = {"gradients": solid.shape_gradients[:, None], "volumes": solid.volumes[:, None]}
    kinds = [{"young": each.young, "strain": each.strain} for each in SLIDERS]
    return [PrandtlEnergy(mesh.nodes, mesh.elements, **points, **kind) for kind in kinds]


def test_a_stretched_bar_draws_the_loop_of_iwan() -> None:
    """Oracle: the play operator, stress k clip(e - p, -y, y) of each slider with p dragged along; Green's strain e."""
    energies, rest = sliders(), strip_mesh(2, 1).nodes
    slips = np.zeros(len(SLIDERS))
    for strain in (0.005, 0.03, 0.1, 0.06, -0.05, 0.02, 0.0):
        stretch = np.sqrt(1 + 2 * strain)
        nodes = rest * [stretch, 1.0]
        told = 0.0
        for index, each in enumerate(SLIDERS):
            span = np.clip(strain - slips[index], -each.strain, each.strain)
            slips[index], told = strain - span, told + each.young * span
        forces = [np.zeros(rest.shape) for _ in energies]
        for energy, total in zip(energies, forces, strict=True):
            energy.add_gradient(nodes, NONE, total)
        pull = sum(forces)[np.isclose(rest[:, 0], 0.2), 0].sum()  # type: ignore[index]
        assert pull == pytest.approx(stretch * told * 0.05 * 0.03, abs=1e-9)
        energies = [energy.with_advanced_history(nodes, NONE) for energy in energies]


def test_no_energy_is_created_on_closed_paths() -> None:
    """Oracle: what the increment costs is what is stored after it less what was stored, and never less."""
    random, rest = np.random.default_rng(3), strip_mesh(2, 1).nodes
    for energy in sliders():
        lost, end, now = [], rest + 0.01 * random.standard_normal(rest.shape), energy
        for nodes in (end, *(rest + 0.01 * random.standard_normal((12, *rest.shape))), end, end):
            after = now.with_advanced_history(nodes, NONE)
            lost.append(now.value(nodes, NONE) - after.value(nodes, NONE))
            drift = after.slip - now.slip
            slid = energy.young * energy.strain * np.sqrt((drift**2).sum(axis=(1, 2)))
            weights = now._weights / energy.young
            assert lost[-1] == pytest.approx(weights @ slid, abs=1e-12)
            now = after
        assert min(lost) >= -1e-15
        assert max(lost) > 1e-4
        turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
        assert now.value(end @ turn.T, NONE) == pytest.approx(now.value(end, NONE))


def test_up_and_down_strokes_differ_and_a_bend_is_kept() -> None:
    """Oracle: without sliders both strokes agree; derivatives by differences of going on, up and back."""
    simulation = strip()
    half = simulation.solve([0.01, 0.0])
    whole = simulation.solve([0.02, 0.0], start=half)
    back = simulation.solve([0.01, 0.0], start=whole)
    free = simulation.solve([0.0, 0.0], start=back)
    up, top, down, end = (pose.markers["tip"][1] for pose in (half, whole, back, free))
    assert 0 < up < down < top
    assert 0.01 * top < end < 0.5 * top
    step = 1e-5
    for pose, going in ((whole, step), (back, -step)):
        told, height = simulation.marker_jacobian(pose)[0, 1, 0], pose.markers["tip"][1]
        ends = [(way, simulation.solve([pose.contractions[0] + way, 0.0], start=pose)) for way in (going, -going)]
        on, turned = ((end.markers["tip"][1] - height) / way for way, end in ends)
        assert told == pytest.approx(on, rel=3e-4)
        assert abs(turned / on - 1) > 1e-3  # sliders that slipped stick as the motion turns
    bare = Simulation(strip_robot(columns=8, rows=2))
    again = bare.solve([0.0, 0.0], start=bare.solve([0.02, 0.0]))
    assert abs(again.markers["tip"][1]) < 1e-9


def test_files_and_bad_input(tmp_path: Path) -> None:
    robot = gallery_robot("starfish")
    robot = replace(robot, body=replace(robot.body, material=replace(FOAM, hysteresis=SLIDERS)))
    save_robot(robot, tmp_path)
    assert load_robot(tmp_path).body.material.hysteresis == SLIDERS
    file = tmp_path / "robot.toml"
    named = replace(robot.body, material=get_material("polyester fibre"))
    text = robot_text(replace(robot, body=named))
    plain, asked = 'material = "polyester fibre"', 'material = { name = "polyester fibre", hysteresis = "material" }'
    assert plain in text
    (tmp_path / "named").mkdir()
    save_robot(replace(robot, body=named), tmp_path / "named", text=text)
    (tmp_path / "named/robot.toml").write_text(text.replace(plain, asked))
    found = load_robot(tmp_path / "named").body.material
    assert [(slider.young / found.young, slider.strain) for slider in found.hysteresis] == [(0.4, 0.02), (0.6, 0.1)]
    (tmp_path / "named/robot.toml").write_text(text.replace(plain, asked.replace("polyester fibre", "pdms")))
    with pytest.raises(InputError, match=r"no hysteresis is known of pdms\. Write sliders\. Known"):
        load_robot(tmp_path / "named")
    file.write_text(file.read_text().replace("strain = 0.04", "strain = 4"))
    with pytest.raises(InputError, match=r"hysteresis\[1\].strain must be at most 1, not 4; 0.05 is 5 %"):
        load_robot(tmp_path)
    with pytest.raises(InputError, match="hysteresis has no linear model"):
        find_modes(strip())


def test_designs_refuse_hysteresis_before_they_search() -> None:
    target = PoseTarget(name="up", targets={"tip": (0.19, 0.02)})
    robot = replace(strip().robot, markers=(Marker(name="tip", at=(0.19, 0.0)),))
    with pytest.raises(InputError, match=r"material\.hysteresis: not known to designs"):
        DesignRequest(poses=(target,)).fit_robot(robot)


def test_with_friction_no_derivative_is_given() -> None:
    robot = strip_robot(columns=4, rows=1)
    robot = replace(robot, body=replace(robot.body, material=replace(FOAM, hysteresis=SLIDERS)))
    robot = robot.with_network(robot.winches, [replace(cable, friction=0.2) for cable in robot.cables])
    simulation = Simulation(robot)
    with pytest.raises(InputError, match="derivatives follow the history of cables with friction"):
        simulation.jacobian(simulation.solve([0.005, 0.0]))
