"""A renderer of photographs: sheets, tags and bodies on planes, seen by a camera with distortion, blur and noise.

It shares only the drawing of tags with the package; rays, distortion and poses are its own.
"""

from dataclasses import dataclass, replace
from functools import cache, lru_cache

import cv2
import numpy as np

from hydrostat.camera.calibrate_camera import calibrate_camera
from hydrostat.camera.find_tags import find_tags
from hydrostat.camera.locate_tags import locate_on_plane
from hydrostat.camera.tags import BOX, ON_SHEET, PITCH, SIDE, board_corners, marker_tags, tag_cells
from hydrostat.robot import Robot

PIXEL = 0.25e-3  # pixel of a painted plane [m]
PER_CELL = 24  # pixels of a tag's cell in its picture


@dataclass(frozen=True)
class Camera:
    """A pinhole camera above the plane z = 0, with terms of radial distortion."""

    width: int = 1280
    height: int = 960
    focal: float = 1150.0
    center: tuple[float, float] = (655.0, 470.0)
    distortion: tuple[float, ...] = (0.06, -0.09)
    rotation: np.ndarray = None  # type: ignore[assignment]
    position: np.ndarray = None  # type: ignore[assignment]

    @classmethod
    def above(cls, target: tuple[float, float], distance: float, tilt: float, azimuth: float, roll: float = 0.0, **kw):
        """Camera that looks at a point of the plane from a distance; angles in degrees."""
        tilt, azimuth, roll = np.radians([tilt, azimuth, roll])
        away = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])
        position = np.array([*target, 0.0]) + distance * away
        forward = -away
        right = np.cross(forward, [-np.sin(roll), np.cos(roll), 0.0])
        right /= np.linalg.norm(right)
        return cls(rotation=np.array([right, np.cross(forward, right), forward]), position=position, **kw)

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixels of points in space."""
        seen = (np.atleast_2d(points) - self.position) @ self.rotation.T
        x = seen[:, :2] / seen[:, 2:]
        r2 = (x**2).sum(axis=1, keepdims=True)
        return self.focal * x * _stretch(r2, self.distortion) + np.array(self.center)

    def rays(self, over: int) -> tuple[np.ndarray, np.ndarray]:
        """Directions of all pixels in the frame of the camera, x and y at z = 1, each pixel cut into over x over."""
        return _rays(self.width, self.height, over, self.focal, self.center, self.distortion)


def _stretch(r2: np.ndarray, distortion: tuple[float, ...]) -> np.ndarray:
    """Radius in the picture over that without distortion, by the square of the latter."""
    return np.polynomial.polynomial.polyval(r2, (1.0, *distortion))


@lru_cache(maxsize=8)
def _rays(width, height, over, focal, center, distortion) -> tuple[np.ndarray, np.ndarray]:
    u = ((np.arange(width * over) + 0.5) / over - 0.5 - center[0]) / focal
    v = ((np.arange(height * over) + 0.5) / over - 0.5 - center[1]) / focal
    x, y = (each.astype(np.float32) for each in np.meshgrid(u, v))
    radius = np.sqrt(x**2 + y**2)
    table = np.linspace(0.0, 1.6 * float(radius.max()), 4000)  # radius without distortion, by that with it
    bent = _stretch(table**2, distortion)
    factor = np.interp(radius, table * bent, 1 / bent).astype(np.float32)
    return x * factor, y * factor


@dataclass(frozen=True)
class Plane:
    """A picture on a plane: pixel (0, 0) at `corner`, columns along `across`, rows along `down` [m a pixel]."""

    picture: np.ndarray
    cover: np.ndarray
    corner: np.ndarray
    across: np.ndarray
    down: np.ndarray


def tag_plane(number: int, center, side: float, turn: float = 0.0, tilt: np.ndarray | None = None) -> Plane:
    """A tag with a white rim, about its center in space; turn in degrees about its normal, tilt a rotation."""
    cells = np.pad(tag_cells(number), 1, constant_values=True)
    picture = np.kron(cells, np.ones((PER_CELL, PER_CELL))).astype(np.float32)
    cell = side / 8
    angle = np.radians(turn)
    frame = np.eye(3) if tilt is None else tilt
    x = frame @ np.array([np.cos(angle), np.sin(angle), 0.0])
    y = frame @ np.array([-np.sin(angle), np.cos(angle), 0.0])
    unit = cell / PER_CELL
    corner = np.asarray(center, float) + (-5 * cell + unit / 2) * x + (5 * cell - unit / 2) * y
    return Plane(0.05 + 0.8 * picture, np.ones_like(picture), corner, x * unit, -y * unit)


@cache
def board_plane(sheet: int = 0, move=(0.0, 0.0, 0.0), clutter: int | None = 0) -> Plane:
    """A sheet of the board, on a cluttered table or alone; move: x, y [m] and turn [degrees]."""
    unit = SIDE / 8 / 12  # whole pixels for each cell and pitch
    half = np.array([4 * PITCH, 5 * PITCH])
    rows, columns = np.round(2 * half[::-1] / unit).astype(int)
    rng = np.random.default_rng(clutter)
    picture = np.full((rows, columns), 0.9, np.float32)
    for index in range(ON_SHEET):
        corners = board_corners(sheet * ON_SHEET + index)
        cells = np.kron(tag_cells(sheet * ON_SHEET + index), np.ones((12, 12)))
        column = round((corners[0, 0] + half[0]) / unit)
        row = round((half[1] - corners[0, 1]) / unit)
        picture[row : row + len(cells), column : column + len(cells)] = 0.04 + 0.86 * cells
    edge = (half - np.array([0.105, 0.1485])) / unit
    c, r = edge.astype(int)
    table = np.full_like(picture, 0.35)
    for _ in range(60 if clutter is not None else 0):
        p = (int(rng.integers(columns)), int(rng.integers(rows)))
        cv2.circle(table, p, int(rng.integers(20, 90)), float(rng.uniform(0.05, 0.9)), int(rng.choice([-1, 6])))
    table[r:-r, c:-c] = picture[r:-r, c:-c]
    angle = np.radians(move[2])
    x = np.array([np.cos(angle), np.sin(angle), 0.0])
    y = np.array([-np.sin(angle), np.cos(angle), 0.0])
    corner = np.array([move[0], move[1], 0.0]) + (-half[0] + unit / 2) * x + (half[1] - unit / 2) * y
    cover = np.full_like(table, float(clutter is not None))
    cover[r:-r, c:-c] = 1.0
    return Plane(table, cover, corner, x * unit, -y * unit)


def wall_plane(half: float = 0.5, brightness: float = 0.42) -> Plane:
    """A plain wall behind sheets of the board [m]."""
    picture = np.full((8, 8), brightness, np.float32)
    unit = half / 4
    return Plane(
        picture, np.ones_like(picture), np.array([-half, half, 0]), np.array([unit, 0, 0]), np.array([0, -unit, 0])
    )


def body_plane(rings, height: float, brightness: float = 0.6) -> Plane:
    """A body by the rings of its outline [m], at a height above the plane."""
    points = np.concatenate(rings)
    low, high = points.min(axis=0) - 0.005, points.max(axis=0) + 0.005
    columns, rows = ((high - low) / PIXEL).astype(int)
    cover = np.zeros((rows, columns), np.float32)
    scaled = [np.round((ring - [low[0], high[1]]) / [PIXEL, -PIXEL]).astype(np.int32) for ring in rings]
    cv2.fillPoly(cover, scaled, 1.0)
    rng = np.random.default_rng(3)
    picture = brightness + 0.08 * cv2.resize(rng.standard_normal((rows // 8 + 1, columns // 8 + 1)), (columns, rows))
    corner = np.array([low[0], high[1], height])
    return Plane(picture.astype(np.float32), cover, corner, np.array([PIXEL, 0, 0]), np.array([0, -PIXEL, 0]))


def photograph(
    camera: Camera,
    planes,
    *,
    blur: float = 0.7,
    noise: float = 0.012,
    shadow: float = 0.35,
    seed: int = 0,
    over: int = 2,
) -> np.ndarray:
    """Photograph of planes, each over those before it; blur in pixels, noise and shadow as shares of white."""
    rays = camera.rays(over)
    height, width = rays[0].shape
    light = np.full((height, width), 0.3, np.float32)
    for plane in planes:
        _paint(camera, plane, rays, light)
    light = cv2.resize(light, (camera.width, camera.height), interpolation=cv2.INTER_AREA)
    light = cv2.GaussianBlur(light, (0, 0), blur) if blur else light
    v, u = np.mgrid[0 : camera.height, 0 : camera.width] / camera.height
    edge = 1 / (1 + np.exp(-40 * (u - 0.5 * v - 0.45)))
    light = light * (1 - shadow * edge) * (1 - 0.15 * v)
    light = light + noise * np.random.default_rng(seed).standard_normal(light.shape) * np.sqrt(0.2 + light)
    return np.round(255 * np.clip(light, 0, 1) ** (1 / 2.2)).astype(np.uint8)


def _paint(camera: Camera, plane: Plane, rays, light: np.ndarray) -> None:
    """Paint a plane over what is there, by where the ray of each pixel meets it."""
    rows, columns = plane.picture.shape
    frame = np.column_stack([plane.across, plane.down, plane.corner - camera.position])
    to_ray = camera.rotation @ frame
    corners = np.array([[-1, -1, 1], [columns, -1, 1], [columns, rows, 1], [-1, rows, 1]], float)
    over = light.shape[0] // camera.height
    spots = camera.project(corners @ np.column_stack([plane.across, plane.down, plane.corner]).T)
    low = np.clip((over * (spots.min(axis=0) - 8)).astype(int), 0, light.shape[::-1])
    high = np.clip((over * (spots.max(axis=0) + 8)).astype(int), 0, light.shape[::-1])
    if (high <= low).any():
        return
    part = (slice(low[1], high[1]), slice(low[0], high[0]))
    back = np.linalg.inv(to_ray).astype(np.float32)
    x, y = rays[0][part], rays[1][part]
    depth = 1 / (back[2, 0] * x + back[2, 1] * y + back[2, 2])
    maps = [(back[i, 0] * x + back[i, 1] * y + back[i, 2]) * depth for i in (0, 1)]
    picture = cv2.remap(plane.picture, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    cover = cv2.remap(plane.cover, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    light[part] = cover * picture + (1 - cover) * light[part]


def turned(camera: Camera, **changes) -> Camera:
    """A camera with some numbers changed."""
    return replace(camera, **changes)


def tag_corners(center, side: float, turn: float = 0.0) -> np.ndarray:
    """Corners of a tag on a plane in space."""
    angle = np.radians(turn)
    c, s = np.cos(angle), np.sin(angle)
    flat = side * BOX @ np.array([[c, s], [-s, c]])
    return np.asarray(center) + np.column_stack([flat, np.zeros(4)])


@dataclass(frozen=True)
class Scene:
    """A flat robot before a board: where its frame lies on the board (x, y [m], turn [degrees]) and at what height."""

    robot: Robot
    at: tuple[float, float, float] = (0.0, 0.0, 90.0)
    thickness: float = 0.02
    side: float = 0.015

    def to_board(self, points: np.ndarray) -> np.ndarray:
        angle = np.radians(self.at[2])
        c, s = np.cos(angle), np.sin(angle)
        return np.atleast_2d(points) @ np.array([[c, s], [-s, c]]) + self.at[:2]

    def planes(self, nodes: np.ndarray, markers: dict[str, np.ndarray], **board) -> list[Plane]:
        """The board, the body and the tags of its markers, each turned otherwise."""
        mesh = self.robot.body.mesh
        ring = [mesh.boundary[0, 0]]
        after = dict(mesh.boundary.tolist())
        while (node := after[ring[-1]]) != ring[0]:
            ring.append(node)
        planes = [board_plane(**board), body_plane([self.to_board(nodes[ring])], self.thickness)]
        for index, (name, number) in enumerate(marker_tags(self.robot).items()):
            if name in markers:
                place = self.to_board(markers[name])[0]
                planes.append(tag_plane(number, (*place, self.thickness), self.side, 25.0 * index))
        return planes


def photograph_errors(seed: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Errors of tag corners [pixels] and of markers [m] from two photographs of a flat robot, and the focal length.

    0.15 mm a pixel, tags 12 mm above the board, with distortion, blur, shadow, noise, clutter and covered tags. The
    true focal length is 1150 pixels.

    Args:
        seed: of the noise; 0 gives tilts of 3 and 18 degrees, others draw tilts up to 20 degrees.
    """
    rng = np.random.default_rng(seed)
    tilts = (
        ((3, 40), (18, 160)) if seed == 0 else zip(rng.uniform((1, 10), (8, 20)), rng.uniform(0, 360, 2), strict=True)
    )
    places = [(x, y, 0.012) for x in (-0.05, 0.0, 0.05) for y in (-0.03, 0.03)]
    cameras = [Camera.above((0.0, 0.0), 0.172, tilt, azimuth, roll=8) for tilt, azimuth in tilts]
    tags = []
    for number, camera in enumerate(cameras):
        planes = [board_plane(), *(tag_plane(300 + i, at, 0.012, 30 * i) for i, at in enumerate(places))]
        tags.append(find_tags(photograph(camera, planes, seed=2 * seed + number), "photo"))
    calibration = calibrate_camera(tags, (1280, 960))
    corner_errors, errors = [], []
    for camera, found, view in zip(cameras, tags, calibration.views, strict=True):
        for index, at in enumerate(places):
            corners = found[300 + index]
            corner_errors.append(corners - camera.project(tag_corners(at, 0.012, 30 * index)))
            errors.append(locate_on_plane(corners, calibration.lens, view, 0.012)[0] - at)
        for number in (each for each in found if each < 300):
            away = found[number] - camera.project(np.column_stack([board_corners(number), np.zeros(4)]))
            corner_errors.append(away[np.linalg.norm(away, axis=1) < 1.0])  # others are covered by a tag
    distances = np.linalg.norm(np.concatenate(corner_errors), axis=1)
    return distances, np.linalg.norm(errors, axis=1), calibration.lens.focal
