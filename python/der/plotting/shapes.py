"""Rods at some instants, drawn to scale, with their spheres."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.typing import ColorType
from numpy.typing import NDArray

from der._core import Rod

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Shape:
    """All rods at one instant, as a picture shows them.

    Attributes
    ----------
    positions
        Positions of all nodes [m], shape (nodes, dim).
    frame
        The frame of the result whose supports, loads and actuation it has.
    colour, linestyle
        Of the centre line; rods with another line than ``-`` are that line alone.
    label
        For the legend.
    directors
        Director 1 at the nodes of each rod, as ``der.sections.directors_along`` has it.
    """

    positions: Array
    frame: int
    colour: ColorType
    label: str | None
    directors: Sequence[Array | None]
    linestyle: str = "-"


def pick_frames(positions: Array, count: int) -> list[int]:
    """Pick frames that tell a motion: evenly spaced along the way that the nodes travel.

    Parameters
    ----------
    positions
        Node positions [m], shape (frames, nodes, dim).
    count
        How many frames at most; the first and the last are always among them.

    Returns
    -------
    list of int
        Frame numbers, ascending. Fewer than `count` where the motion has not that many frames.
    """
    steps = np.sqrt(np.mean(np.sum(np.diff(positions, axis=0) ** 2, axis=2), axis=1))
    way = np.concatenate([[0.0], np.cumsum(steps)])
    targets = np.linspace(0.0, way[-1], count)[:-1]
    frames = {int(np.argmin(np.abs(way - target))) for target in targets}
    return sorted(frames | {len(positions) - 1})


def outline(positions: Array, radius: float) -> Array:
    """Return the outline of a rod as a polygon.

    Parameters
    ----------
    positions
        Centre line [m], shape (nodes, 2); that of a ring ends with its first node.
    radius
        Half the thickness [m].

    Returns
    -------
    array
        Corners [m], shape (2 * nodes, 2): along the left side and back along the right side.
    """
    edges = np.diff(positions, axis=0)
    tangents = edges / np.linalg.norm(edges, axis=1, keepdims=True)
    # At a node the sides of the two edges meet on the bisector, at 1 / cos(half the turning angle);
    # no farther than twice the radius, or a fold would have an endless spike.
    ends = [2.0 * tangents[:1], 2.0 * tangents[-1:]]
    if np.array_equal(positions[0], positions[-1]):
        ends = [tangents[:1] + tangents[-1:]] * 2
    sums = np.vstack([ends[0], tangents[:-1] + tangents[1:], ends[1]])
    along = 2.0 * sums / np.maximum(np.sum(sums**2, axis=1, keepdims=True), 1.0)
    offsets = radius * np.column_stack([-along[:, 1], along[:, 0]])
    return np.vstack([positions + offsets, (positions - offsets)[::-1]])


def draw_shapes(
    axes: Axes,
    rods: Iterable[Rod],
    positions: Array,
    colour: ColorType,
    label: str | None = None,
    linestyle: str = "-",
) -> None:
    """Draw all rods at one instant.

    The centre line is a thin line, so that it shows at any zoom; the rod's thickness and the
    spheres are true to scale.

    Parameters
    ----------
    axes
        Where to draw; equal axes are left to the caller.
    rods
        The rods; their `nodes` pick rows of `positions`.
    positions
        Positions of all nodes [m], shape (nodes, 2).
    colour, linestyle
        Style of the centre line; thickness and spheres are a pale tone of the colour.
    label
        For the legend.
    """
    for rod in rods:
        line = positions[rod.line_nodes]
        (drawn,) = axes.plot([], [], color=colour, linestyle=linestyle, label=label, zorder=3)
        drawn.set_data(line[:, 0], line[:, 1])
        label = None  # once for all rods of the instant
        if linestyle == "-":
            axes.update_datalim(line)  # another shape does not stretch the axes
            _draw_thickness(axes, line, rod.radius, colour)
            _draw_spheres(axes, rod, line, colour)


def _draw_thickness(axes: Axes, line: Array, radius: float, colour: ColorType) -> None:
    if radius > 0.0:
        body = PolyCollection(
            [outline(line, radius)], facecolor=colour, alpha=0.3, linewidth=0.0, zorder=2
        )
        axes.add_collection(body)


def _draw_spheres(axes: Axes, rod: Rod, line: Array, colour: ColorType) -> None:
    radii = rod.sphere_radii
    nodes = line[: len(radii)]
    circles = [Circle((x, y), r) for (x, y), r in zip(nodes, radii, strict=True) if r > 0.0]
    if circles:
        axes.add_collection(
            PatchCollection(circles, facecolor=(*to_rgb(colour), 0.12), edgecolor=colour, zorder=1)
        )


def limits(rods: Sequence[Rod], shapes: Sequence[Array]) -> tuple[Array, Array]:
    """Return the lower left and upper right corner [m] of what `draw_shapes` draws."""
    low = np.full(2, np.inf)
    high = np.full(2, -np.inf)
    for positions in shapes:
        for rod in rods:
            around = np.maximum(rod.sphere_radii, rod.radius)[:, np.newaxis]
            line = positions[rod.nodes]
            low = np.minimum(low, (line - around).min(axis=0))
            high = np.maximum(high, (line + around).max(axis=0))
    return low, high


def make_exactly_equal(figure: Figure, axes: Axes) -> None:
    """Widen the limits of axes that are set to be equal until they are.

    Matplotlib leaves them up to half a percent apart where that saves it an adjustment.
    """
    figure.draw_without_rendering()
    box = axes.get_window_extent()
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    x, y = box.width / (right - left), box.height / (top - bottom)  # pixels a metre
    more_x, more_y = 0.5 * (right - left) * (x / y - 1.0), 0.5 * (top - bottom) * (y / x - 1.0)
    if more_x > 0.0:
        axes.set_xlim(left - more_x, right + more_x, auto=None)
    else:
        axes.set_ylim(bottom - more_y, top + more_y, auto=None)
