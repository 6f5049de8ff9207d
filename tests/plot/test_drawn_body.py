"""Cables of a drawn body are hidden as they lie. Oracle: a box of known faces."""

import numpy as np
import pytest
from builders import box_mesh

from hydrostat.drawing import Camera, render
from hydrostat.plot.drawn_body import DrawnBody


def test_a_run_is_cut_where_it_enters_the_body() -> None:
    """Oracle: a straight cable from 40 mm before the box to 40 mm inside it is covered beyond the corner x = 0."""
    mesh, camera = box_mesh((4, 3, 2), size=(0.1, 0.05, 0.03)), Camera.towards(np.array([0.0, -1.0, 0.0]))
    image = render(camera.see(1e3 * mesh.nodes), mesh.boundary, pixel=0.25)
    surface = DrawnBody(image.rings(), (camera, np.array([7.0, 3.0]), image, 100.0))
    run = surface.cable(np.array([[-0.04, 0.01, 0.015], [0.04, 0.01, 0.015]]))
    (free, none), (covered, fade) = run.parts
    assert none == 0
    assert 0 < fade < 1
    assert free[0] == pytest.approx([-33, 18])
    assert free[-1] == pytest.approx([7, 18], abs=2 * image.buffer.pixel)
    assert covered[-1] == pytest.approx([47, 18])
    assert run.fades.tolist() == [0.0, fade]


def test_cables_on_the_skin_are_seen() -> None:
    """Oracle: depths below the front face; cables of at most 4 mm are sewn to the skin."""
    mesh, camera = box_mesh((4, 3, 2), size=(0.1, 0.05, 0.03)), Camera.towards(np.array([0.0, -1.0, 0.0]))
    image = render(camera.see(1e3 * mesh.nodes), mesh.boundary, pixel=0.25)
    surface = DrawnBody(image.rings(), (camera, np.zeros(2), image, 100.0))
    fades = surface.fades(np.array([[0.05, y, 0.015] for y in (0.001, 0.0035, 0.005)]))
    assert fades[:2].tolist() == [0.0, 0.0]
    assert fades[2] > 0


def test_deeper_things_fade_more() -> None:
    mesh, camera = box_mesh((4, 3, 2), size=(0.1, 0.05, 0.03)), Camera.towards(np.array([0.0, -1.0, 0.0]))
    image = render(camera.see(1e3 * mesh.nodes), mesh.boundary, pixel=0.25)
    surface = DrawnBody(image.rings(), (camera, np.zeros(2), image, 100.0))
    fades = surface.fades(np.array([[0.05, y, 0.015] for y in (-0.01, 0.005, 0.02, 0.045)]))
    assert (np.diff(fades) > 0).all()
