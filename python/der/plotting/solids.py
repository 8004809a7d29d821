"""Surfaces in space, and their picture: shaded, the farthest first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.typing import ColorType
from numpy.typing import NDArray

from der.plotting.camera import Camera
from der.sections import swept

Array = NDArray[np.float64]

_SIDES = 20  # of a round thing
#: Where the light comes from (right, up, towards the viewer), and half of the way to the viewer.
_LIGHT = np.array([-0.428, 0.713, 0.556])
_AMBIENT, _GLOSS = 0.62, 0.35
_HALFWAY = np.array([-0.243, 0.404, 0.882])


@dataclass(frozen=True, eq=False)
class Faces:
    """Flat faces of the surfaces of solids.

    Attributes
    ----------
    corners
        [m], shape (faces, 4, 3), counter-clockwise as seen from outside; a triangle has one twice.
    colours
        Red, green and blue, shape (faces, 3), before light falls on them.
    nearer
        By how much [m] they are taken to be nearer to the viewer than they are, so that of two
        surfaces in one place one wins everywhere.
    """

    corners: Array
    colours: Array
    nearer: float | Array = 0.0

    @classmethod
    def joined(cls, parts: Sequence[Faces]) -> Faces:
        """Return all faces of several parts."""
        if not parts:
            return cls(np.zeros((0, 4, 3)), np.zeros((0, 3)))
        return cls(
            np.concatenate([part.corners for part in parts]),
            np.concatenate([part.colours for part in parts]),
            np.concatenate([np.broadcast_to(part.nearer, len(part.corners)) for part in parts]),
        )


def circle(sides: int = _SIDES) -> Array:
    """Return corners of a circle of radius 1, shape (sides, 2)."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    return np.column_stack([np.cos(angles), np.sin(angles)])


def tube(line: Array, directors: Array | None, outline: Array, colours: Array) -> Faces:
    """Return the surface that a section sweeps along a line.

    Parameters
    ----------
    line
        Centre line [m], shape (nodes, 3). That of a ring ends with its first node.
    directors
        Director 1 at the nodes, shape (nodes, 3); None for a round section that may lie in any way.
    outline
        Corners of the section along directors 1 and 2 [m], shape (sides, 2), counter-clockwise.
        With shape (nodes, sides, 2) it changes along the line.
    colours
        For the side from each corner to the next, shape (sides, 3). The ends have that of the side
        opposite to director 1, so that no stripe runs across them.
    """
    rings = swept(line, directors, outline)
    after = np.roll(rings, -1, axis=1)
    sides = np.stack([rings[:-1], after[:-1], after[1:], rings[1:]], axis=2)
    corners = [sides.reshape(-1, 4, 3)]
    shades = [np.tile(colours, (len(line) - 1, 1))]
    if not np.array_equal(line[0], line[-1]):
        first = outline.reshape(-1, *outline.shape[-2:])[0]
        opposite = int(np.argmin(first[:, 0] + np.roll(first[:, 0], -1)))
        for at, one, two in ((0, after[0], rings[0]), (-1, rings[-1], after[-1])):
            middle = np.broadcast_to(line[at], one.shape)
            corners.append(np.stack([middle, one, two, two], axis=1))
            shades.append(np.tile(colours[opposite], (len(colours), 1)))
    return Faces(np.concatenate(corners), np.concatenate(shades))


def sphere(middle: Array, radius: float, colour: ColorType) -> Faces:
    """Return a sphere around a point [m]."""
    angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, _SIDES // 2 + 1)
    rings = np.empty((len(angles), _SIDES, 3))
    rings[..., :2] = np.cos(angles)[:, None, None] * circle()
    rings[..., 2] = np.sin(angles)[:, None]
    after = np.roll(rings, -1, axis=1)
    unit = np.stack([rings[:-1], after[:-1], after[1:], rings[1:]], axis=2).reshape(-1, 4, 3)
    return Faces(middle + radius * unit, np.tile(to_rgb(colour), (len(unit), 1)))


def turned_profile(start: Array, end: Array, profile: Array, colour: ColorType) -> Faces:
    """Return what a profile makes that turns about the line between two points [m].

    `profile` has rows of a share of the way from start to end and a radius [m]: a cone, a cylinder,
    an arrow.
    """
    line = start + profile[:, :1] * (end - start)
    along = (end - start) / np.linalg.norm(end - start)
    first = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    first /= np.linalg.norm(first)
    across = circle() @ np.vstack([first, np.cross(along, first)])
    rings = line[:, None, :] + profile[:, 1, None, None] * across
    after = np.roll(rings, -1, axis=1)
    corners = np.stack([rings[:-1], after[:-1], after[1:], rings[1:]], axis=2).reshape(-1, 4, 3)
    return Faces(corners, np.tile(to_rgb(colour), (len(corners), 1)))


def box(middle: Array, axes: Array, colour: ColorType) -> Faces:
    """Return a box around a point [m]; the rows of `axes` [m], shape (3, 3), are half its edges."""
    found = []
    for k in range(3):
        one, two = axes[(k + 1) % 3], axes[(k + 2) % 3]
        square = np.array([-one - two, one - two, one + two, two - one])
        found += [square + axes[k], square[::-1] - axes[k]]
    return Faces(middle + np.array(found), np.tile(to_rgb(colour), (6, 1)))


def draw_faces(axes: Axes, camera: Camera, faces: Faces, zorder: float = 3.0) -> None:
    """Draw the faces that are seen, in the light, the farthest first."""
    corners = faces.corners
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    middles = corners.mean(axis=1)
    seen = np.sum(normals * camera.sight(middles), axis=1) > 0.0
    order = np.flatnonzero(seen)
    # By distance from the viewer, not by depth: a face at the edge of the picture is farther.
    if np.isinf(camera.distance):
        far = -camera.turned(middles)[:, 2]
    else:
        far = np.linalg.norm(camera.sight(middles), axis=1)
    order = order[np.argsort((faces.nearer - far)[order], kind="stable")]
    unit = camera.turned(normals[order])
    unit /= np.maximum(np.linalg.norm(unit, axis=1, keepdims=True), 1e-300)
    light = _AMBIENT + (1.0 - _AMBIENT) * np.maximum(unit @ _LIGHT, 0.0)
    gloss = _GLOSS * np.maximum(unit @ _HALFWAY, 0.0) ** 24
    shaded = light[:, None] * faces.colours[order]
    shaded += gloss[:, None] * (1.0 - shaded)
    # A thin rim in the same colour closes the seams between neighbours.
    axes.add_collection(
        PolyCollection(
            list(camera.project(corners[order])[..., :2]),
            facecolors=shaded,
            edgecolors=shaded,
            linewidths=0.4,
            zorder=zorder,
        ),
        autolim=False,
    )
