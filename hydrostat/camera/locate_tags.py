"""Places of the tags of markers: on a plane above the board, or in space by the size of the tags."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from hydrostat.arrays import Float
from hydrostat.camera.find_tags import Corners, load_opencv
from hydrostat.camera.lens import Lens, View
from hydrostat.camera.tags import BOX

Place = Float[np.ndarray, " 3"]


def locate_on_plane(corners: Corners, lens: Lens, view: View, height: float) -> tuple[Place, float, float]:
    """Find a tag at a height above the board.

    Returns:
        Its center in the board's frame [m], its side at that height [m], and the root mean square distance of its
        corners from those of a square [m].
    """
    places = view.meet_plane(lens.rays(corners), height)
    side = float(np.linalg.norm(places - np.roll(places, 1, axis=0), axis=1).mean())
    turn, shift = align_places(side * BOX, places[:, :2])
    away = side * BOX @ turn.T + shift - places[:, :2]
    return places.mean(axis=0), side, float(np.sqrt((away**2).sum(axis=1).mean()))


def locate_in_space(seen: Sequence[tuple[Corners, View]], lens: Lens, side: float) -> tuple[Place, float]:
    """Center of a tag of known side in the board's frame [m], from all photographs of one pose.

    Returns:
        The center, and the root mean square distance of its corners [pixels].
    """
    square = side * np.column_stack([BOX, np.zeros(4)])
    best: tuple[float, np.ndarray] = (np.inf, np.zeros(6))
    for corners, view in seen:
        for start in _poses(corners, lens, view, side):
            found = least_squares(_misses, start, args=(square, seen, lens), x_scale="jac", max_nfev=40)
            if found.cost < best[0]:
                best = (float(found.cost), found.x)
    return best[1][3:], float(np.sqrt(2 * best[0] / (4 * len(seen))))


def _misses(numbers: np.ndarray, square: np.ndarray, seen: Sequence[tuple[Corners, View]], lens: Lens) -> np.ndarray:
    points = square @ Rotation.from_rotvec(numbers[:3]).as_matrix().T + numbers[3:]
    return np.concatenate([(lens.project(view.to_camera(points)) - corners).ravel() for corners, view in seen])


def _poses(corners: Corners, lens: Lens, view: View, side: float) -> list[np.ndarray]:
    """The two poses of a square that one photograph leaves open, in the board's frame."""
    cv2 = load_opencv()
    flat = np.ascontiguousarray(lens.rays(corners)[:, :2])
    square = side * np.column_stack([BOX, np.zeros(4)])
    _, turns, moves, _ = cv2.solvePnPGeneric(square, flat, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    poses = []
    for turn, move in zip(turns, moves, strict=True):
        rotation = view.rotation.T @ cv2.Rodrigues(turn)[0]
        place = view.rotation.T @ (move.ravel() - view.translation)
        poses.append(np.concatenate([Rotation.from_matrix(rotation).as_rotvec(), place]))
    return poses


def align_places(
    places: Float[np.ndarray, "points dim"], targets: Float[np.ndarray, "points dim"], *, mirror: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Rotation and shift that bring places closest to targets (Kabsch); with `mirror` a reflection."""
    middle, goal = places.mean(axis=0), targets.mean(axis=0)
    u, _, vt = np.linalg.svd((places - middle).T @ (targets - goal))
    signs = np.ones(places.shape[1])
    signs[-1] = np.sign(np.linalg.det(u @ vt)) * (-1.0 if mirror else 1.0)
    turn = (u * signs @ vt).T
    return turn, goal - turn @ middle


def pairs_of(found: Mapping[str, np.ndarray], targets: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Places and targets of the markers that both have."""
    names = [name for name in targets if name in found]
    return np.array([found[name] for name in names]), np.array([targets[name] for name in names])
