"""`Runs`: the straight runs of all cables of a layout, to be kept apart."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Vector
from hydrostat.design.routes.layout import Layout
from hydrostat.robot import Mount


class Runs(NamedTuple):
    """Segments of all cables; the first one of a cable begins two spool radii from its winch."""

    ends: Float[np.ndarray, "runs 2 dim"]
    routes: Int[np.ndarray, " runs"]
    winches: Int[np.ndarray, " runs"]
    kept: np.ndarray
    whole: Float[np.ndarray, "runs 2 dim"]  # from point to point
    begins: Int[np.ndarray, "runs 2"]  # where the numbers of its two points begin

    def at(self, which: np.ndarray, shares: Vector) -> Float[np.ndarray, "_ dim"]:
        """Places so far along some of them [m]."""
        return self.ends[which, 0] + shares[:, None] * (self.ends[which, 1] - self.ends[which, 0])

    def parts(self, run: int, place: Vector, way: Vector) -> list[tuple[slice, Vector]]:
        """Slopes by the numbers of its points, of one along a way at a place."""
        start, end = self.whole[run]
        share = float(np.dot(place - start, end - start) / max(float(np.dot(end - start, end - start)), 1e-300))
        dim = len(way)
        first, last = (slice(int(begin), int(begin) + dim) for begin in self.begins[run])
        return [(first, (1 - share) * way), (last, share * way)]


def runs_of(layout: Layout) -> Runs:
    """The runs of all cables of a layout, but those outside the body."""
    ends, routes, winches, kept, whole, begins = [], [], [], [], [], []
    for index, route in enumerate(layout.routes):
        winch = layout.sites[route.winch].winch
        pairs = np.stack([route.points[:-1], route.points[1:]], axis=1)
        whole.append(pairs)
        pairs = pairs.copy()
        length = float(np.linalg.norm(pairs[0, 1] - pairs[0, 0]))
        if winch.mount is Mount.BODY and length > 0:
            pairs[0, 0] += min(1.0, 2 * winch.spool_radius / length) * (pairs[0, 1] - pairs[0, 0])
        ends.append(pairs)
        places = [layout.place_of(index, point).start for point in range(len(route.points))]
        begins.append(np.column_stack([places[:-1], places[1:]]))
        if winch.mount is Mount.WORLD:  # what is outside the body hangs in a tube of its own
            ends[-1], whole[-1], begins[-1], pairs = ends[-1][1:], whole[-1][1:], begins[-1][1:], pairs[1:]
        routes += [index] * len(pairs)
        winches += [route.winch] * len(pairs)
        kept += [route.kept is not None] * len(pairs)
    return Runs(
        np.concatenate(ends), np.array(routes), np.array(winches), np.array(kept), np.concatenate(whole),
        np.concatenate(begins),
    )  # fmt: skip
