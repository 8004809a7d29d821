"""The usual symbols of supports, at a fixed size on paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from der._core import HeldNode, Rod, SpringSupport
from der.plotting.style import MUTED
from der.scene_loads import FoundationPart, ground_direction, place_on

#: Length on paper [points] of one unit of the paths below.
_UNIT = 9.0
#: Height of the springs of a foundation [points], their ground included.
FOUNDATION_HEIGHT = 12.0
#: Springs of a foundation of a whole rod.
_FOUNDATION_SPRINGS = 15


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
_GUIDE = _strokes([(-0.9, 0.0), (0.9, 0.0)], *_hatching(-0.3)).transformed(
    Affine2D().rotate_deg(-90)
)
_SLEEVE = _strokes([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)])

_ZIGZAG = [(0.3 * (-1) ** k, -0.45 - 0.2 * k) for k in range(5)]
_SPRING = _strokes(
    [(0.0, 0.0), (0.0, -0.35), *_ZIGZAG, (0.0, -1.35), (0.0, -1.65)], *_hatching(-1.65)
)
#: Along a spring of length 1, and across it.
_ZIGZAG_BETWEEN = np.pad([(0.325 + 0.05 * k, 0.04 * (-1) ** k) for k in range(8)], ((2, 2), (0, 0)))
_ZIGZAG_BETWEEN[[0, 1, -2, -1], 0] = [0.0, 0.3, 0.7, 1.0]
_FOUNDATION = _SPRING.transformed(Affine2D().scale(FOUNDATION_HEIGHT / (1.95 * _UNIT)))
_TURNS = np.linspace(0.0, 4.5 * np.pi, 60)
_SPIRAL = _strokes(
    [(0.055 * t * np.cos(t), 0.055 * t * np.sin(t)) for t in _TURNS],
    [(-0.35, 1.1), (0.35, 1.1)],
    [(0.0, 0.055 * _TURNS[-1]), (0.0, 1.1)],
)


def draw_supports(
    axes: Axes,
    rods: Iterable[Rod],
    held: Iterable[HeldNode],
    positions: NDArray[np.float64],
) -> None:
    """Draw the usual symbol at each held node.

    A triangle on the ground for a node held in x and y, on a gap where it can roll, a hatched wall
    for a clamped end, on a gap where it can move across, a square for a clamp that slides along the
    rod, or between the ends.

    Parameters
    ----------
    axes
        Where to draw.
    rods
        The rods.
    held
        The held nodes, from `Result.held_nodes` or ``der.held_nodes(scenario, time)``.
    positions
        Positions of all nodes at that time [m], shape (nodes, 2).
    """
    ends = {(rod.name, int(rod.nodes[i])): i for rod in rods if not rod.closed for i in (0, -1)}
    for node in held:
        symbol, angle = _symbol(node, ends.get((node.rod, node.node)))
        _draw_symbol(axes, symbol, angle, positions[node.node], f"support-{node.rod}-{node.node}")


def draw_springs(
    axes: Axes,
    rods: Iterable[Rod],
    springs: Iterable[SpringSupport],
    positions: NDArray[np.float64],
) -> None:
    """Draw a zigzag line to the ground for each spring, and a spiral for one against turning.

    A horizontal spring lies on the side that is away from the middle of its rod.

    Parameters
    ----------
    axes
        Where to draw.
    rods
        The rods.
    springs
        The spring supports, from ``der.springs(scenario)``.
    positions
        Positions of all nodes [m], shape (nodes, 2).
    """
    middle = {rod.name: float(positions[rod.nodes, 0].mean()) for rod in rods}
    for number, spring in enumerate(springs):
        place = spring.weights @ positions[spring.nodes]
        outwards = 0.5 * np.pi if place[0] > middle[spring.rod] else -0.5 * np.pi
        drawn = [
            (_SPRING, outwards, spring.stiffness[0]),
            (_SPRING, 0.0, spring.stiffness[1]),
            (_SPIRAL, 0.0, spring.rotational_stiffness),
        ]
        for symbol, angle, stiffness in drawn:
            if stiffness > 0.0:
                _draw_symbol(axes, symbol, angle, place, f"spring-{spring.rod}-{number}")


def draw_axial_springs(axes: Axes, ends: Iterable[NDArray[np.float64]]) -> None:
    """Draw a zigzag line for each spring between joints, whose ends [m] have the shape (2, 2)."""
    for number, (start, end) in enumerate(ends):
        along = end - start
        places = start + _ZIGZAG_BETWEEN[:, :1] * along
        across = np.array([-along[1], along[0]])
        axes.plot(
            *(places + _ZIGZAG_BETWEEN[:, 1:] * across).T,
            color=MUTED,
            linewidth=0.9,
            zorder=1.5,
            gid=f"axial-spring-{number}",
        )


def draw_hinges(axes: Axes, places: NDArray[np.float64]) -> None:
    """Draw a circle at each hinge, at positions [m], shape (hinges, 2)."""
    axes.plot(
        *places.T,
        "o",
        markersize=0.6 * _UNIT,
        markerfacecolor="white",
        markeredgecolor=MUTED,
        markeredgewidth=0.9,
        zorder=3.5,
        gid="hinges",
    )


def draw_foundations(
    axes: Axes,
    rods: Iterable[Rod],
    parts: Iterable[FoundationPart],
    positions: NDArray[np.float64],
) -> None:
    """Draw each elastic foundation as a row of springs to the ground.

    Parameters
    ----------
    axes
        Where to draw.
    rods
        The rods.
    parts
        From ``der.scene_loads.acting_loads(result, frame).foundations``.
    positions
        Positions of all nodes [m], shape (nodes, 2).
    """
    by_name = {rod.name: rod for rod in rods}
    for part in parts:
        rod = by_name[part.rod]
        down = ground_direction(part, rod, positions)
        angle = float(np.arctan2(down[0], -down[1]))
        count = max(2, round(_FOUNDATION_SPRINGS * (part.end - part.start) / rod.length))
        for number, at in enumerate(np.linspace(part.start, part.end, count)):
            place = place_on(rod, positions, float(at))
            gid = f"load-{rod.name}-foundation-{number}"
            _draw_symbol(axes, _FOUNDATION, angle, place, gid)


def _draw_symbol(
    axes: Axes, symbol: Path, angle: float, place: NDArray[np.float64], gid: str
) -> None:
    path = symbol.transformed(Affine2D().rotate(angle))
    axes.plot(
        [place[0]],
        [place[1]],
        marker=path,
        # Matplotlib scales a path until its farthest coordinate reaches half the marker size.
        markersize=2.0 * _UNIT * float(np.abs(path.vertices).max()),
        markerfacecolor="none" if symbol in (_SPRING, _SPIRAL, _FOUNDATION) else "white",
        markeredgecolor=MUTED,
        markeredgewidth=0.9,
        linestyle="none",
        zorder=2.5,
        clip_on=False,
        gid=gid,
    )


def _symbol(held: HeldNode, end: int | None) -> tuple[Path, float]:
    """Return a symbol and its turn [rad]; `end` is 0 at a rod's start, -1 at its end."""
    if held.tangent_angle is not None:
        if end is None or held.slides:
            return _SLEEVE, held.tangent_angle
        symbol = _WALL if {"x", "y"} <= set(held.components) else _GUIDE
        return symbol, held.tangent_angle + (0.0 if end == 0 else np.pi)
    if {"x", "y"} <= set(held.components):
        return _PINNED, 0.0
    return _ROLLER, 0.0 if "y" in held.components else -0.5 * np.pi
