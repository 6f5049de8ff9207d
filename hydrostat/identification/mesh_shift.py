"""`estimate_mesh_shift`: changes of fitted values that a finer mesh would make."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import locate
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.identification.measurements import Measurements
from hydrostat.identification.model import IdentificationModel
from hydrostat.identification.residuals import Residuals
from hydrostat.robot import Body, ElementKind, Mount, Robot

ROWS = 8
"""Rows that are solved again, at most."""


def estimate_mesh_shift(
    model: IdentificationModel, measurements: Measurements, numbers: Vector, noises: tuple[float, float]
) -> Float[np.ndarray, "shifts parameters"]:
    """Changes of the coordinates of a fit that a finer mesh would make, to first order.

    The error of a mesh is the same in all rows, so that it moves values and shows in no residual. The first row is the
    change by quadratic elements; 0 for bodies that have none, or have them already. The second adds the dents of
    cables in elements of half the size: a cable pulls at points, whose displacement grows without end as elements
    become smaller.

    Args:
        model: robot and measurement.
        measurements: rows of the fit.
        numbers: coordinates of the fit.
        noises: standard deviation of a measured coordinate or length [m], and of a force [N].
    """
    if not len(numbers):
        return np.zeros((2, 0))
    rows = measurements.rows(choose_rows(measurements))
    found = MarkerPredictor(model, rows).predict(numbers, with_jacobian=True)
    coarse = Residuals.of(found, rows)
    scales = np.where(coarse.is_force, noises[1], noises[0])

    def shift(change: Callable[[Robot], Robot]) -> Vector:
        changed = replace(model, robot=lambda values: change(model.robot(values)))
        finer = MarkerPredictor(changed, rows).predict(numbers, with_jacobian=False)
        finer = replace(finer, jacobian=found.jacobian, force_jacobian=found.force_jacobian)
        moved = Residuals.of(finer, rows).errors - coarse.errors
        known = np.isfinite(moved)
        jacobian = (coarse.jacobian / scales[:, None])[known]
        return -np.linalg.solve(jacobian.T @ jacobian + np.eye(len(numbers)), jacobian.T @ (moved / scales)[known])

    by_elements = np.zeros(len(numbers))
    if model.robot(model.values(numbers)).body.mesh.quadratic is None:
        with suppress(InputError):  # a body that has no quadratic elements
            by_elements = shift(_refine)
    return np.stack([by_elements, by_elements + shift(soften_cables)])


def choose_rows(measurements: Measurements) -> np.ndarray:
    """Indices of up to eight rows, evenly spread, and of as many with hung masses, which alone may show the modulus."""
    spread = np.linspace(0, len(measurements.commands) - 1, ROWS).astype(int)
    return np.union1d(spread, np.flatnonzero(measurements.hung_masses.any(axis=1))[:ROWS])


def soften_cables(robot: Robot) -> Robot:
    """Robot whose cables yield by the dents that half as large elements add where they press on the body.

    By Kelvin's solution for a point force the displacement grows by (3 - 4 nu) ln 2 / (8 pi mu (1 - nu) t) of the force
    in a flat body of thickness t, in space by (10/3 - 4 nu) / (8 pi mu (1 - nu) h) with the length h of edges, averaged
    over directions and taken half an edge from the point. A cable of tension T presses by T times the change of its
    direction; it presses with all of T at the end of a sheath.
    """
    compliances = _dent_compliances(robot.body)
    cables = []
    for cable in robot.cables:
        points = np.array(cable.points)
        spans = np.diff(points, axis=0)
        spans /= np.linalg.norm(spans, axis=1)[:, None]
        for first, last in cable.sheathed:
            spans[first:last] = 0.0
        presses = (np.concatenate([spans[:1], np.diff(spans, axis=0), -spans[-1:]]) ** 2).sum(axis=1)
        if robot.winch(cable.winch).mount is Mount.WORLD:
            presses[0] = 0.0
        anchors = locate(robot.body.mesh, points)
        yields = (anchors.weights * compliances[anchors.stencils]).sum(axis=1)
        cables.append(replace(cable, stiffness=1.0 / (1.0 / cable.stiffness + float(presses @ yields))))
    return replace(robot, cables=tuple(cables))


def _dent_compliances(body: Body) -> Vector:
    """Displacement per force that halved elements add at each node, by the stiffest element around it [m/N]."""
    mesh, (mu, lame) = body.mesh, (body.stiffness_factors * modulus for modulus in body.lame())
    poisson = 0.5 * lame / (lame + mu)
    scale = 8 * np.pi * mu * (1 - poisson)
    if body.thickness is not None:
        each = np.log(2) * (3 - 4 * poisson) / (scale * body.thickness)
    else:
        edges = mesh.nodes[mesh.elements[:, 1:]] - mesh.nodes[mesh.elements[:, :1]]
        each = (10 / 3 - 4 * poisson) / (scale * np.linalg.norm(edges, axis=2).mean(axis=1))
    least = np.full(len(mesh.nodes), np.inf)
    np.minimum.at(least, mesh.elements, np.broadcast_to(each[:, None], mesh.elements.shape))
    return np.where(np.isfinite(least), least, 0.0)


def _refine(robot: Robot) -> Robot:
    """Robot with quadratic elements."""
    return replace(robot, body=robot.body.with_elements(ElementKind.QUADRATIC))
