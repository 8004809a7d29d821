"""From where a picture shows a run in space: in perspective, or flat along an axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: How far the camera is from the middle of the scene, against the scene's diagonal.
_DISTANCE = 2.2
#: How high it stands [rad], and where around the scene: the first, or a better one. From all of
#: them the first horizontal axis runs to the right.
_ELEVATION = np.radians(24.0)
_AZIMUTHS = np.radians([-60.0, -30.0, -75.0, -120.0, -150.0, -15.0, -90.0])
#: A place is better if it shows so many times the area.
_BETTER = 1.4


@dataclass(frozen=True, eq=False)
class Camera:
    """A place and a direction to look from.

    Attributes
    ----------
    rotation
        Rows: unit vectors to the right, upwards and towards the viewer, shape (3, 3).
    focus
        The point [m] in the middle of the picture, which is shown true to scale, shape (3,).
    distance
        From there to the viewer [m]; infinite for a view without perspective.
    """

    rotation: Array
    focus: Array
    distance: float

    def turned(self, vectors: Array) -> Array:
        """Return vectors, shape (..., 3), by their parts to the right, upwards, to the viewer."""
        return np.asarray(vectors @ self.rotation.T)

    def project(self, points: Array) -> Array:
        """Return where points [m], shape (..., 3), are in the picture.

        The first two components are to the right and upwards [m], as long as at the focus; the
        third is how far the point lies before the focus [m].
        """
        seen = self.turned(points - self.focus)
        nearer = 1.0 if np.isinf(self.distance) else 1.0 / (1.0 - seen[..., 2:] / self.distance)
        return np.concatenate([seen[..., :2] * nearer, seen[..., 2:]], axis=-1)

    def sight(self, points: Array) -> Array:
        """Return vectors from points [m], shape (..., 3), towards the viewer."""
        if np.isinf(self.distance):
            return np.broadcast_to(self.rotation[2], points.shape)
        return np.asarray(self.focus + self.distance * self.rotation[2] - points)


def upright(up: Array) -> Array:
    """Return two horizontal unit vectors and the vertical one, a right-handed system, shape (3, 3).

    `up` is a unit vector along a coordinate axis, and so are the rows.
    """
    first = np.eye(3)[1 if abs(up[0]) > 0.5 else 0]
    return np.vstack([first, np.cross(up, first), up])


def perspective(points: Array, up: Array) -> Camera:
    """Return a camera that looks down a little on points [m], shape (points, 3).

    It stands where the shape does not hide itself: a ring or an arc in a plane is seen from a side.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    views = [_rotation(azimuth, up) for azimuth in _AZIMUTHS]
    areas = [float(np.linalg.det(np.cov((points @ view[:2].T).T))) for view in views]
    # A determinant is a square of an area; that of a straight line is 0 from everywhere.
    best = int(np.argmax(areas))
    chosen = views[best if areas[best] > _BETTER**2 * areas[0] else 0]
    distance = _DISTANCE * max(float(np.linalg.norm(high - low)), 1e-300)
    return Camera(chosen, 0.5 * (low + high), distance)


def along_axes(name: str) -> Camera:
    """Return a view without perspective, such as ``xz``: the axes to the right and upwards.

    Raises
    ------
    ValueError
        If the name is not that of two different axes.
    """
    if len(name) != 2 or not set(name) <= set("xyz") or name[0] == name[1]:
        raise ValueError(f"a view is two of x, y and z, such as xz, or 3d, not {name!r}")
    right, up = (np.eye(3)["xyz".index(axis)] for axis in name)
    return Camera(np.vstack([right, up, np.cross(right, up)]), np.zeros(3), np.inf)


def _rotation(azimuth: float, up: Array) -> Array:
    """Return the rows of a camera that stands at an angle about the vertical [rad]."""
    frame = upright(up)
    level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    towards = (np.cos(_ELEVATION) * level + np.sin(_ELEVATION) * np.eye(3)[2]) @ frame
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return np.vstack([right, np.cross(towards, right), towards])
