"""The usual symbols of supports, at a fixed size on paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from der._core import HeldNode, Rod
from der.plotting.style import MUTED

#: Length on paper [points] of one unit of the paths below.
_UNIT = 9.0


def _strokes(*lines: Sequence[tuple[float, float]]) -> Path:
    """Return a path of separate lines; one that ends where it begins encloses an area."""
    return Path.make_compound_path(*(Path(np.array(line)) for line in lines))


def _hatching(y: float) -> list[Sequence[tuple[float, float]]]:
    """Return the ground: a line at height `y` with strokes below it."""
    strokes = [[(x, y), (x - 0.25, y - 0.3)] for x in np.linspace(-0.65, 0.9, 5)]
    return [[(-0.9, y), (0.9, y)], *strokes]


# The held node is at the origin. The ground lies below, for the clamp's wall to the left of it.
_TRIANGLE = [(0.0, 0.0), (-0.6, -1.0), (0.6, -1.0), (0.0, 0.0)]
_PINNED = _strokes(_TRIANGLE, *_hatching(-1.0))
_ROLLER = _strokes(_TRIANGLE, *_hatching(-1.3))
_WALL = _strokes(*_hatching(0.0)).transformed(Affine2D().rotate_deg(-90))
_SLEEVE = _strokes([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)])


def draw_supports(
    axes: Axes, rods: Iterable[Rod], held: Iterable[HeldNode], positions: NDArray[np.float64]
) -> None:
    """Draw the usual symbol at each held node.

    A triangle on the ground for a node held in x and y, on a gap where it can roll, a hatched wall
    for a clamped end, a square for a clamp between the ends.

    Parameters
    ----------
    axes
        Where to draw.
    rods
        The rods.
    held
        The held nodes, from ``der.held_nodes(scenario, time)``.
    positions
        Positions of all nodes at that time [m], shape (nodes, 2).
    """
    ends = {(rod.name, int(rod.nodes[i])): i for rod in rods for i in (0, -1)}
    for node in held:
        symbol, angle = _symbol(node, ends.get((node.rod, node.node)))
        path = symbol.transformed(Affine2D().rotate(angle))
        x, y = positions[node.node]
        axes.plot(
            [x],
            [y],
            marker=path,
            # Matplotlib scales a path until its farthest coordinate reaches half the marker size.
            markersize=2.0 * _UNIT * float(np.abs(path.vertices).max()),
            markerfacecolor="white",
            markeredgecolor=MUTED,
            markeredgewidth=0.9,
            linestyle="none",
            zorder=2.5,
            clip_on=False,
            gid=f"support-{node.rod}-{node.node}",
        )


def _symbol(held: HeldNode, end: int | None) -> tuple[Path, float]:
    """Return a symbol and its turn [rad]; `end` is 0 at a rod's start, -1 at its end."""
    if held.tangent_angle is not None:
        if end is None:
            return _SLEEVE, held.tangent_angle
        return _WALL, held.tangent_angle + (0.0 if end == 0 else np.pi)
    if {"x", "y"} <= set(held.components):
        return _PINNED, 0.0
    return _ROLLER, 0.0 if "y" in held.components else -0.5 * np.pi
