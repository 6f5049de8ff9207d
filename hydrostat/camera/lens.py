"""`Lens` and `View`: a camera, and from where it looks at the board."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float

Pixels = Float[np.ndarray, "points 2"]
Space = Float[np.ndarray, "points 3"]


@dataclass(frozen=True)
class Lens:
    """Pinhole camera with radial distortion, the same for all photographs.

    Attributes:
        focal: focal length [pixels].
        center: principal point [pixels].
        distortion: coefficients of the second and fourth power of the distance from the axis.
    """

    focal: float
    center: tuple[float, float]
    distortion: tuple[float, float]

    def project(self, points: Space) -> Pixels:
        """Pixels of points in the frame of the camera: x right, y down, z ahead."""
        flat = points[:, :2] / points[:, 2:]
        squared = (flat**2).sum(axis=1, keepdims=True)
        first, second = self.distortion
        return self.focal * flat * (1 + first * squared + second * squared**2) + np.array(self.center)

    def rays(self, pixels: Pixels) -> Space:
        """Directions of pixels in the frame of the camera, with z = 1."""
        bent = (pixels - np.array(self.center)) / self.focal
        first, second = self.distortion
        flat = bent
        for _ in range(20):
            squared = (flat**2).sum(axis=1, keepdims=True)
            flat = bent / (1 + first * squared + second * squared**2)
        return np.column_stack([flat, np.ones(len(flat))])


@dataclass(frozen=True, eq=False)
class View:
    """Frame of the board as one photograph shows it.

    Attributes:
        rotation: from the frame of the board to that of the camera.
        translation: place of the board's origin in the frame of the camera [m].
    """

    rotation: Float[np.ndarray, "3 3"]
    translation: Float[np.ndarray, " 3"]

    def to_camera(self, points: Space) -> Space:
        """Points of the board's frame in that of the camera."""
        return points @ self.rotation.T + self.translation

    def meet_plane(self, rays: Space, height: float) -> Space:
        """Points where rays of the camera meet the plane at a height above the board [m], in the board's frame."""
        eye = -self.rotation.T @ self.translation
        directions = rays @ self.rotation
        return eye + directions * ((height - eye[2]) / directions[:, 2])[:, None]
