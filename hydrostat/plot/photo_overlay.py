"""`draw_photo_overlay`: a photograph with the simulated outline and markers drawn in."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from hydrostat.camera import PhotoMeasurements, read_colors
from hydrostat.simulation import Equilibrium
from hydrostat.units import MILLIMETERS

WIDTH = 1600
"""Width of the picture [pixels]."""

OUTLINE, SIMULATED, MEASURED = "#00c2ff", "#ff2d87", "#ffe600"
"""Colors that differ from one another and from most bodies."""


def draw_photo_overlay(found: PhotoMeasurements, index: int) -> Figure:
    """Photograph with the outline of the simulated robot, its markers and those measured, with their distances [mm]."""
    measured = found.photos[index]
    picture = read_colors(measured.photo.file)
    height, width = picture.shape[:2]
    dpi = 100
    figure = Figure(figsize=(WIDTH / dpi, WIDTH / dpi * height / width), dpi=dpi)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    axes.imshow(picture, interpolation="antialiased")
    if measured.pose is not None:
        lines = found.project(index, measured.pose.nodes)[_outline(found, index, measured.pose)]
        axes.add_collection(LineCollection(list(lines), colors=OUTLINE, linewidths=2.0, capstyle="round"))
        _draw_markers(axes, found, index, measured.pose)
    halo = [withStroke(linewidth=3, foreground="black")]
    size = 15
    for line, (text, color) in enumerate(
        [("simulated outline", OUTLINE), ("simulated markers", SIMULATED), ("measured markers", MEASURED)]
    ):
        axes.text(
            0.012, 0.985 - 0.032 * line, text, transform=axes.transAxes, va="top", color=color, size=size,
            path_effects=halo,
        )  # fmt: skip
    axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5))
    return figure


def _draw_markers(axes: Axes, found: PhotoMeasurements, index: int, pose: Equilibrium) -> None:
    measured = found.photos[index]
    halo = [withStroke(linewidth=3, foreground="black")]
    names = list(pose.markers)
    simulated = found.project(index, np.array([pose.markers[name] for name in names]))
    for name, spot in zip(names, simulated, strict=True):
        axes.plot(*spot, "o", color=SIMULATED, markersize=7, markeredgecolor="black", markeredgewidth=0.8, zorder=4)
        words = name
        if name in measured.places and name in measured.corners:
            seen = found.project(index, measured.places[name][None])[0]
            axes.plot(*np.array([seen, spot]).T, color=SIMULATED, linewidth=2.0, zorder=3)
            axes.plot(*seen, "o", markersize=13, markerfacecolor="none", markeredgecolor=MEASURED, markeredgewidth=2.0)
            words = f"{name} {MILLIMETERS * measured.errors[name]:.1f} mm"
        axes.annotate(
            words, spot, xytext=(11, 9), textcoords="offset points", color="white", size=14, path_effects=halo, zorder=5
        )


def _outline(found: PhotoMeasurements, index: int, pose: Equilibrium) -> np.ndarray:
    """Edges of the body that its outline in a photograph consists of, by their nodes."""
    facets = pose.robot.body.mesh.boundary
    if facets.shape[1] == 2:
        return facets
    spots = found.project(index, pose.nodes)[facets]
    one, two = spots[:, 1] - spots[:, 0], spots[:, 2] - spots[:, 0]
    ahead = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0] > 0
    edges = np.sort(np.concatenate([facets[:, [0, 1]], facets[:, [1, 2]], facets[:, [2, 0]]]), axis=1)
    both, owner = np.unique(edges, axis=0, return_inverse=True)
    sides = np.bincount(owner.ravel(), weights=np.tile(np.where(ahead, 1.0, -1.0), 3), minlength=len(both))
    return both[sides == 0]
