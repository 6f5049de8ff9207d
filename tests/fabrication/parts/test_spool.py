"""Spools: how much cable they take, and that the solid has the radii, the bore and the holes that it should have."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import trimesh
from manifold3d import Manifold
from overhang import overhang

from hydrostat.fabrication.checks.solid_checks import watertight_problems
from hydrostat.fabrication.parts.motor import MOTORS
from hydrostat.fabrication.parts.spool import LAY, Groove, Spool, capacity, spool_turns, width_for
from hydrostat.fabrication.solids.construct import solid_of
from hydrostat.fabrication.solids.printed import Printed

SHAFTS = [(MOTORS[0].shaft, 5.7), (MOTORS[1].shaft, 8.0), (MOTORS[2].shaft, 8.2)]
GROOVES = [
    (Groove(radius=6, width=2.5),),
    (Groove(radius=6, width=2.5), Groove(radius=6, width=2.5), Groove(radius=6, width=2.5)),
    (Groove(radius=5.5, width=1.5, layers=3), Groove(radius=11, width=4), Groove(radius=7, width=2)),
]


def spools(*, cable: float = 0.4, play: float = 0.15) -> list[Spool]:
    """Each shaft with its own grooves, and the first with all."""
    return [
        Spool(grooves=grooves, cable=cable, shaft=shaft, inside=inside, play=play, wall=1.6, journal=2.1)
        for number, (shaft, inside) in enumerate(SHAFTS)
        for grooves in (GROOVES if number == 0 else GROOVES[number:][:1])
    ]


@cache
def printed(spool: Spool) -> Printed:
    return Printed(name="spool", title="Spool", solid=solid_of(spool.construction()))


@pytest.mark.parametrize("layers", [1, 2, 5])
def test_capacity_is_the_sum_over_turns(layers: int):
    """Oracle: circles of each layer, added one by one."""
    width, radius, cable = 3.4, 6.0, 0.4
    turns = (width - cable) / (LAY * cable)
    circles = sum(turns * 2 * math.pi * (radius + layer * cable) for layer in range(layers))
    assert capacity(width, radius, cable, layers) == pytest.approx(circles)


@pytest.mark.parametrize("length", [37.0, 70.0, 150.0, 200.0])
@pytest.mark.parametrize(("radius", "cable"), [(6.0, 0.4), (4.0, 0.8), (11.5, 0.25)])
def test_a_groove_of_the_width_takes_the_length_and_what_is_spare(length: float, radius: float, cable: float):
    """Oracle: the closed form of the capacity; the next narrower width does not."""
    width = width_for(spool_turns(length, radius, 2.0), cable)
    needed = length + 2.0 * 2 * math.pi * radius
    assert capacity(width, radius, cable, 1) >= needed - 1e-9
    assert capacity(width - 0.5, radius, cable, 1) < needed
    assert width == pytest.approx(0.5 * round(width / 0.5))


def test_turns_of_a_known_length():
    assert spool_turns(2 * math.pi * 6.0 * 3, 6.0, 2.0) == pytest.approx(5.0)


@pytest.mark.parametrize("spool", spools())
def test_drums_and_flanges_measured_on_the_solid(spool: Spool):
    """Oracle: slices of the solid: half a cable above the drum is the radius of the robot file."""
    solid = printed(spool).solid
    for middle, groove in zip(spool.middles, spool.grooves, strict=True):
        rings = solid.slice(middle).to_polygons()
        assert max(np.linalg.norm(ring, axis=1).max() for ring in rings) == pytest.approx(groove.radius - 0.2, abs=1e-6)
    for floor, flange in zip(spool.floors, spool.flanges, strict=True):
        rings = solid.slice(floor - 0.1).to_polygons()
        assert max(np.linalg.norm(ring, axis=1).max() for ring in rings) == pytest.approx(flange, abs=1e-6)


@pytest.mark.parametrize("spool", spools())
def test_a_flange_stands_above_all_layers(spool: Spool):
    for index, groove in enumerate(spool.grooves):
        outer = groove.radius + (groove.layers - 0.5) * spool.cable
        assert min(spool.flanges[index : index + 2]) >= outer + 1.5 * spool.cable


@pytest.mark.parametrize("spool", [*spools(), *spools(cable=0.8, play=0.25)])
def test_it_is_one_watertight_body_that_prints_without_support(spool: Spool):
    """Oracle: the triangles of the files; a slicer would need support under what leans further than 45 degrees."""
    part = printed(spool)
    assert watertight_problems(part) == ()
    through = spool.inside + 0.5 + spool.pin > spool.body + spool.journal - 0.4
    assert part.solid.genus() == len(spool.grooves) + through
    assert overhang(part) < 0.5


def test_volume_agrees_with_trimesh():
    """Oracle: trimesh."""
    for spool in spools()[:3]:
        part = printed(spool)
        mesh = trimesh.Trimesh(*part.file_mesh, process=False)
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(part.volume, rel=1e-4)


@pytest.mark.parametrize("spool", spools(play=0.2))
def test_the_shaft_goes_in_with_its_play_and_turns_the_spool(spool: Spool):
    """Oracle: least gap between solids; turned by 30 degrees the shaft cuts into the flat."""
    shaft = solid_of(spool.shaft.shape(spool.inside + 5).move(0, 0, -5))
    solid = printed(spool).solid
    assert solid.min_gap(shaft, 1.0) == pytest.approx(0.2, abs=0.03)
    assert (solid ^ shaft.rotate((0, 0, 30))).volume() > 0.05


@pytest.mark.parametrize("spool", spools())
def test_the_wall_round_the_bore_is_thick_enough(spool: Spool):
    """Oracle: a shaft thicker by the wall, without its flat, stays inside the drums."""
    thick = Manifold.cylinder(spool.body, spool.shaft.diameter / 2 + spool.play + spool.wall, -1, 64)
    drums = Manifold.cylinder(spool.body, min(spool.drums), -1, 64)
    assert (thick - drums).volume() < 1e-6


@pytest.mark.parametrize("spool", spools())
def test_a_cable_goes_through_each_tie_hole_and_its_knot_is_hidden(spool: Spool):
    """Oracle: a straight cable from the groove to above its flange touches nothing; beside the hole it does."""
    solid = printed(spool).solid
    for tie, knot, floor, groove, end in zip(
        spool.ties, spool.knots, spool.floors, spool.grooves, spool.floors[1:], strict=False
    ):
        low = floor + groove.width
        cable = Manifold.cylinder(end - low + 0.2, spool.cable / 2, -1, 16).translate((tie, 0, low))
        assert (solid ^ cable).volume() < 1e-9
        assert (solid ^ cable.rotate((0, 0, 40))).volume() > 0.05
        knot = Manifold.cylinder(0.9, knot - 0.02, -1, 16).translate((tie, 0, end - 0.9))
        assert (solid ^ knot).volume() < 1e-9


def test_a_short_spool_is_padded_so_that_the_shaft_does_not_look_out():
    long = replace(spools()[0], inside=20.0)
    assert long.body + long.journal >= 20.0
    assert long.body > spools()[0].body
