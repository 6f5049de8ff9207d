"""Moments on a body. Oracles: a bar bent to a circle, the moment of the pins, differences."""

from dataclasses import replace

import numpy as np
import pytest
from builders import FOAM, box_mesh, mesh_body, strip_mesh

from hydrostat.errors import InputError
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Load, Marker, Pin, Robot
from hydrostat.simulation import Simulation
from hydrostat.simulation.sensitivities.adjoint import Sensitivity

LENGTH, HEIGHT = 0.2, 0.005
MATERIAL = replace(FOAM, poisson=0.0)
NONE = np.zeros(0)


def bar(moment: float) -> Robot:
    """A thin bar of quadratic elements, clamped at its left end."""
    body = mesh_body(strip_mesh(60, 2, size=(LENGTH, HEIGHT)), thickness=0.01, material=MATERIAL)
    places = {"end": LENGTH - 0.002, "late": 0.9 * LENGTH, "middle": 0.5 * LENGTH}
    return Robot(
        name="bar",
        body=body.with_elements("quadratic"),
        pins=(Pin(box=((-1e-4, -1.0), (1e-4, 1.0))),),
        winches=(),
        cables=(),
        markers=tuple(Marker(name=name, at=(x, 0.0)) for name, x in places.items()),
        poses={},
        loads=(Load(name="turn", marker="end", moment=(moment,)),),
    )


@pytest.mark.parametrize("turn", [-1.0, 4.0, 2 * np.pi])
def test_a_bar_bends_to_a_circle(turn: float) -> None:
    """Oracle: the elastica with a moment at its end, up to a full circle: an arc of curvature M / EI."""
    stiffness = MATERIAL.young * 0.01 * HEIGHT**3 / 12
    pose = Simulation(bar(stiffness * turn / LENGTH)).solve(NONE)
    curvature = turn / LENGTH
    for name, length in (("middle", 0.5 * LENGTH), ("late", 0.9 * LENGTH)):
        angle = curvature * length
        told = np.array([np.sin(angle), 1 - np.cos(angle)]) / curvature
        assert pose.markers[name] == pytest.approx(told, abs=0.005 * LENGTH)


def block(moment: tuple[float, float, float]) -> Robot:
    return Robot(
        name="block",
        body=mesh_body(box_mesh((6, 2, 2), size=(0.12, 0.04, 0.04))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0)), stiffness=1e4),),
        winches=(),
        cables=(),
        markers=(Marker(name="tip", at=(0.11, 0.02, 0.02)),),
        poses={},
        loads=(Load(name="turn", marker="tip", moment=moment),),
    )


@pytest.mark.parametrize("moment", [(0.2, 0.0, 0.0), (0.0, -0.15, 0.0), (0.1, 0.15, -0.1)])
def test_the_pins_withstand_the_moment(moment: tuple[float, float, float]) -> None:
    """Oracle: balance of moments about its axis, through any point, in a pose that is far from rest."""
    simulation = Simulation(block(moment), options=NewtonOptions(tolerance=1e-13))
    pose = simulation.solve(NONE)
    assert np.abs(pose.nodes - simulation.robot.body.mesh.nodes).max() > 0.01
    pins = simulation.body.pins
    forces = -pins.gradient(pose.nodes, NONE)
    turned = np.cross(pose.nodes[pins.stencils], forces).sum(axis=(0, 1))
    size = np.linalg.norm(moment)
    assert turned @ moment / size == pytest.approx(-size, rel=1e-8)
    assert forces.sum(axis=(0, 1)) == pytest.approx(np.zeros(3), abs=1e-8)


@pytest.mark.parametrize("make", [lambda size: bar(4e-4 * size), lambda size: block((0.1 * size, 0.1 * size, 0.0))])
def test_sensitivity(make) -> None:  # type: ignore[no-untyped-def]
    """Oracle: central differences of solves."""
    options, step = NewtonOptions(tolerance=1e-13), 1e-4
    simulation = Simulation(make(1.0), options=options)
    pose = simulation.solve(NONE)
    direction = np.random.default_rng(0).standard_normal(pose.nodes.shape)
    found: Sensitivity = simulation.adjoint(pose, direction)
    sizes = [np.linalg.norm(make(1.0 + side).loads[0].moment) for side in (step, -step)]
    ends = [Simulation(make(1.0 + side), options=options).solve(NONE, start=pose).nodes for side in (step, -step)]
    told = float(((ends[0] - ends[1]) * direction).sum()) / (sizes[0] - sizes[1])
    assert found.moments[0] == pytest.approx(told, rel=1e-5)
    assert not found.loads.any()


@pytest.mark.parametrize(
    ("load", "told"),
    [
        ({"moment": (0.0,)}, "moment must not be 0; remove this load"),
        ({"moment": (0.1,), "force": (0.0, 1.0)}, "give either force, or mass"),
        ({"moment": (np.nan,)}, r"moment\[0\] must be"),
        ({"moment": (0.1, 0.0, 0.0)}, r"load\[0\].moment has 3 entries; this body needs one in the plane"),
    ],
)
def test_wrong_moments(load: dict, told: str) -> None:
    with pytest.raises(InputError, match=told):
        replace(bar(1e-3), loads=(Load(name="turn", marker="end", **load),))
