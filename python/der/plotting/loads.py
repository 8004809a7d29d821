"""The usual symbols of loads, at a fixed size on paper: force arrows, moment arcs, gravity."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from der._core import Rod
from der.plotting.style import LOAD, quantity_text
from der.plotting.supports import FOUNDATION_HEIGHT, draw_foundations
from der.scene_loads import ActingLoads, LineLoad, PointLoad, ground_direction, place_on

Array = NDArray[np.float64]

_FORCE = 30.0  # length of an arrow [points]
_LINE_FORCE = 15.0  # length of the arrows of a distributed force [points]
_LINE_ARROWS = 13  # arrows of a distributed force on a whole rod
_MOMENT = 12.0  # radius of the arc [points]
_TEXT = 26.0  # room for what stands beside an arrow [points]

_HEAD = Path(np.array([(0.0, 0.0), (-1.0, 0.38), (-1.0, -0.38), (0.0, 0.0)]))
_GRAVITY = Path.make_compound_path(Path(np.array([(-1.6, 0.0), (-0.6, 0.0)])), _HEAD)


def draw_loads(
    axes: Axes, rods: Iterable[Rod], loads: ActingLoads, positions: Array, *, labels: bool = True
) -> None:
    """Draw the symbols of the loads at one instant; gravity becomes an entry of the legend.

    Arrows show directions; what they amount to stands beside them.

    Parameters
    ----------
    axes
        Where to draw, with equal axes.
    rods
        The rods.
    loads
        From ``der.scene_loads.acting_loads(result, frame)``.
    positions
        Positions of all nodes at that frame [m], shape (nodes, 2).
    labels
        Whether to write their amounts.
    """
    by_name = {rod.name: rod for rod in rods}
    # Many equal loads, as with `at: all`, are labelled once.
    labelled: set[str] = set()

    def label(text: str) -> str:
        if not labels or text in labelled:
            return ""
        labelled.add(text)
        return text

    for force in loads.forces:
        text = quantity_text(float(np.linalg.norm(force.value)), "N")
        _draw_force(axes, by_name[force.rod], force, positions, label(text))
    for line in loads.lines:
        text = quantity_text(float(np.linalg.norm(line.value)), "N/m")
        _draw_line(axes, by_name[line.rod], line, positions, label(text))
    draw_foundations(axes, by_name.values(), loads.foundations, positions)
    for moment in loads.moments:
        text = quantity_text(float(np.linalg.norm(moment.value)), "N m")
        _draw_moment(axes, by_name[moment.rod], moment, positions, label(text))
    if loads.gravity is not None:
        add_gravity_to_legend(axes, loads.gravity, loads.gravity)


def room_for_loads(
    rods: Iterable[Rod], loads: ActingLoads, positions: Array, metres_per_point: float
) -> Array:
    """Return corners [m], shape (corners, 2), that the axes need to hold for the symbols to fit.

    Parameters
    ----------
    rods, loads, positions
        As for `draw_loads`.
    metres_per_point
        How many metres a point on paper is.
    """
    by_name = {rod.name: rod for rod in rods}
    corners = [np.zeros((0, 2))]
    for force in loads.forces:
        rod = by_name[force.rod]
        direction, pulls = _aim(rod, force, positions)
        outer = (_FORCE + _TEXT) * (direction if pulls else -direction)
        corners.append(place_on(rod, positions, force.at) + metres_per_point * outer)
    for line in loads.lines:
        rod = by_name[line.rod]
        outer = -(_LINE_FORCE + _TEXT) * line.value / np.linalg.norm(line.value)
        middle = place_on(rod, positions, 0.5 * (line.start + line.end))
        corners.append(middle + metres_per_point * outer)
    for part in loads.foundations:
        rod = by_name[part.rod]
        ground = metres_per_point * FOUNDATION_HEIGHT * ground_direction(part, rod, positions)
        ends = [place_on(rod, positions, at) for at in (part.start, part.end)]
        corners.append(np.array(ends) + ground)
    for moment in loads.moments:
        point = place_on(by_name[moment.rod], positions, moment.at)
        around = np.array([[-_MOMENT, -_MOMENT], [_MOMENT, _MOMENT + 0.5 * _TEXT]])
        corners.append(point + metres_per_point * around)
    return np.vstack(corners)


def _aim(rod: Rod, load: PointLoad, positions: Array) -> tuple[Array, bool]:
    """Return the direction of a force, and whether its arrow begins at its point.

    An arrow ends at its point, but one that pulls an end along the rod begins there.
    """
    direction = load.value / np.linalg.norm(load.value)
    return direction, float(direction @ _outwards(rod, load.at, positions)) > 0.5


def _draw_force(axes: Axes, rod: Rod, load: PointLoad, positions: Array, text: str) -> None:
    point = place_on(rod, positions, load.at)
    direction, pulls = _aim(rod, load, positions)
    tail = np.zeros(2) if pulls else -_FORCE * direction
    tip = _FORCE * direction if pulls else np.zeros(2)
    _arrow(axes, point, tail, tip, 1.5, f"load-{rod.name}-{load.at:g}")
    if text:
        outer = tip if pulls else tail
        write_beside(axes, point, outer, direction if pulls else -direction, text)


def _outwards(rod: Rod, at: float, positions: Array) -> Array:
    """Return the unit vector that leads out of the rod at one of its ends, else zero."""
    if rod.closed:
        return np.zeros(2)
    line = positions[rod.nodes]
    if at <= 1e-9 * rod.length:
        edge = line[0] - line[1]
    elif at >= (1.0 - 1e-9) * rod.length:
        edge = line[-1] - line[-2]
    else:
        return np.zeros(2)
    return np.asarray(edge / np.linalg.norm(edge))


def _draw_line(axes: Axes, rod: Rod, load: LineLoad, positions: Array, text: str) -> None:
    count = max(3, round(_LINE_ARROWS * (load.end - load.start) / rod.length))
    direction = load.value / np.linalg.norm(load.value)
    tail = -_LINE_FORCE * direction
    for number, at in enumerate(np.linspace(load.start, load.end, count)):
        point = place_on(rod, positions, float(at))
        _arrow(axes, point, tail, np.zeros(2), 0.8, f"load-{rod.name}-line-{number}")
    middle = place_on(rod, positions, 0.5 * (load.start + load.end))
    if text:
        write_beside(axes, middle, tail, -direction, text)


def _draw_moment(axes: Axes, rod: Rod, load: PointLoad, positions: Array, text: str) -> None:
    point = place_on(rod, positions, load.at)
    x, y = point
    angles = np.radians(np.linspace(-150.0, 90.0, 40))
    vertices = np.column_stack([np.cos(angles), np.sign(load.value) * np.sin(angles)])
    arc = Path(vertices)
    # The head begins where the arc ends, at its top or its bottom, and is tangent to it.
    head = _HEAD.transformed(
        Affine2D()
        .translate(0.5, 0.0)
        .scale(0.62)
        .rotate(np.pi)
        .translate(0.0, float(vertices[-1, 1]))
    )
    for path, face in ((arc, "none"), (head, LOAD)):
        axes.plot(
            [x],
            [y],
            marker=path,
            markersize=2.0 * _MOMENT * float(np.abs(path.vertices).max()),
            markerfacecolor=face,
            markeredgecolor=LOAD,
            markeredgewidth=1.5 if face == "none" else 0.0,
            linestyle="none",
            zorder=4.5,
            clip_on=False,
            gid=f"load-{rod.name}-{load.at:g}",
        )
    if text:
        write_beside(axes, np.array([x, y]), np.array([0.0, _MOMENT]), np.array([0.0, 1.0]), text)


def _arrow(axes: Axes, point: Array, tail: Array, tip: Array, width: float, gid: str) -> None:
    """Draw an arrow whose tail and tip lie at offsets [points] from a point [m]."""
    x, y = point
    length = float(np.linalg.norm(tip - tail))
    angle = float(np.arctan2(*(tip - tail)[::-1]))
    head = min(0.42 * length, 9.0)
    place = Affine2D().rotate(angle).translate(*tip)
    shaft = Path(np.array([(-length, 0.0), (-0.8 * head, 0.0)])).transformed(place)
    point_ = _HEAD.transformed(Affine2D().scale(head) + place)
    for path, face, edge in ((shaft, "none", width), (point_, LOAD, 0.0)):
        axes.plot(
            [x],
            [y],
            marker=path,
            markersize=2.0 * float(np.abs(path.vertices).max()),
            markerfacecolor=face,
            markeredgecolor=LOAD,
            markeredgewidth=edge,
            linestyle="none",
            zorder=4.5,
            clip_on=False,
            gid=gid,
        )


def write_beside(axes: Axes, point: Array, offset: Array, away: Array, text: str) -> None:
    """Write beside a symbol at an offset [points], on its side that looks `away` from the rod."""
    gap = 3.0
    sideways = abs(away[0]) > abs(away[1])
    axes.annotate(
        text,
        (float(point[0]), float(point[1])),
        xytext=tuple(offset + gap * away),
        textcoords="offset points",
        color=LOAD,
        ha=("left" if away[0] > 0.0 else "right") if sideways else "center",
        va="center" if sideways else ("bottom" if away[1] > 0.0 else "top"),
        annotation_clip=False,
        zorder=5,
        # A white rim, so that it can be read where it lies on a support or a rod.
        path_effects=[withStroke(linewidth=3.0, foreground="white")],
    )


def add_gravity_to_legend(axes: Axes, gravity: Array, seen: Array) -> None:
    """Add gravity [m/s^2] to the legend, with an arrow along it as it is seen."""
    angle = float(np.arctan2(seen[1], seen[0]))
    path = _GRAVITY.transformed(Affine2D().translate(0.8, 0.0).rotate(angle))
    text = f"gravity {quantity_text(float(np.linalg.norm(gravity)), 'm/s²')}"
    if np.linalg.norm(seen[:2]) < 0.01 * np.linalg.norm(seen):
        path = Path.circle(radius=0.4)
        text += ", towards you" if seen[2] > 0.0 else ", away from you"
    axes.plot(
        [],
        [],
        marker=path,
        markersize=14.0,
        markerfacecolor=LOAD,
        markeredgecolor=LOAD,
        markeredgewidth=1.2,
        linestyle="none",
        label=text,
        gid="load-gravity",
    )
