"""Pictures of analyses: vibration and buckling modes, and paths of equilibria."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from der.film import MODE_SIZE
from der.plotting.picture import Picture
from der.plotting.style import MUTED, PALETTE, axis_label
from der.scene_loads import ActingLoads

if TYPE_CHECKING:
    from der.analyses import Path
    from der.run_data import RunData

Array = NDArray[np.float64]

_SAME = 2e-3  # lines nearer than this, against the extent of the picture, are one
_ROW = (1.6, 3.2)  # height of a panel [inch]
_WIDTH = 7.2  # of the figure [inch]


def plot_modes(picture: Picture) -> Figure:
    """Draw each mode: the equilibrium, and the shape to both sides of it, not to scale."""
    labels: list[str] = []
    result = picture.result
    if result.modes is not None:
        shapes = result.modes.shapes
        for frequency, growth in zip(
            result.modes.frequencies, result.modes.growth_rates, strict=True
        ):
            labels.append(f"grows at {growth:.4g} 1/s" if growth > 0.0 else f"{frequency:.4g} Hz")
    elif result.buckling is not None:
        shapes = result.buckling.shapes
        labels = [f"load factor {factor:.5g}" for factor in result.buckling.load_factors]
    else:
        raise ValueError("the run has found no modes to draw")
    last = len(result.times) - 1
    rest = picture.shape(last, MUTED)
    size = MODE_SIZE * float(np.ptp(rest.positions, axis=0).max())
    swings = [shape * size / np.abs(shape).max() for shape in shapes]
    loads = ActingLoads(foundations=picture.loads(0).foundations)
    all_sides = [
        replace(rest, positions=rest.positions + sign * swing)
        for swing in swings
        for sign in (-1, 1)
    ]
    room = (_WIDTH - 2.0, _ROW[1])
    low, high = picture.corners(all_sides, loads, room)
    fitting = room[0] * (high - low)[1] / (high - low)[0]
    row = float(np.clip(fitting, *_ROW))
    figure, panels = plt.subplots(
        len(labels),
        1,
        figsize=(_WIDTH, row * len(labels) + 0.6),
        squeeze=False,
        sharex=picture.has_axes and row == _ROW[0],
        layout="constrained",
    )
    for axes, swing, label in zip(panels[:, 0], swings, labels, strict=True):
        moved = rest.positions + swing
        drawn = [
            replace(rest, positions=rest.positions - swing, linestyle=":"),
            replace(rest, linestyle="--"),
            replace(rest, positions=moved, colour=PALETTE[0]),
        ]
        picture.draw(axes, drawn, rest, loads)
        axes.update_datalim(np.array([low, high]))
        axes.set_aspect("equal", adjustable="datalim")
        axes.margins(0.06 if picture.has_axes else 0.0)
        axes.autoscale_view()
        axes.text(1.01, 0.5, f"{label},\nnot to scale", transform=axes.transAxes, va="center")
        picture.finish(axes, low, high, float(np.max((high - low) / room)) / 72.0)
        if picture.has_axes:
            axes.label_outer()
    return figure


def plot_path(result: RunData, names: list[str]) -> Figure:
    """Draw the load factor against each probe: stable solid, unstable thin and dashed.

    Branches that look the same there, such as shapes that are mirror images, are drawn once: dashes
    upon dashes would make a solid line.
    """
    path = result.path
    if path is None or not names:
        raise ValueError("a path is drawn against probes: add some under output.probes")
    figure, panels = plt.subplots(
        1, len(names), figsize=(_WIDTH, 4.2), squeeze=False, sharey=True, layout="constrained"
    )
    for axes, name in zip(panels[0], names, strict=True):
        probe = result.probes[name]
        values = np.asarray(probe)
        _draw_branches(axes, np.column_stack([values, path.factor]), path)
        for event, marker, colour in (
            ("fold", "o", PALETTE[1]),
            ("bifurcation", "D", PALETTE[2]),
            ("out_of_plane", "^", PALETTE[3]),
        ):
            at = path.events == event
            if at.any():
                label = event.replace("_", " ")
                axes.plot(values[at], path.factor[at], marker, color=colour, label=label, zorder=5)
        axes.set_xlabel(axis_label(name, probe.unit, (_WIDTH - 0.9) / len(names)))
    panels[0, 0].set_ylabel("load factor")
    panels[0, 0].plot([], [], label="stable", **_line(stable=True))
    panels[0, 0].plot([], [], label="unstable", **_line(stable=False))
    panels[0, 0].legend()
    return figure


def _line(*, stable: bool) -> dict[str, Any]:
    if stable:
        return {"color": PALETTE[0], "linestyle": "-", "linewidth": 2.2, "zorder": 3}
    return {"color": MUTED, "linestyle": (0, (4, 3)), "linewidth": 1.1, "zorder": 2.5}


def _draw_branches(axes: Axes, points: Array, path: Path) -> None:
    """Draw a path, `points` being its places in the picture, shape (points, 2)."""
    extent = np.ptp(points, axis=0)
    extent[extent == 0.0] = 1.0
    drawn: dict[bool, list[Array]] = {True: [], False: []}
    for branch in np.unique(path.branch):
        rows = np.flatnonzero(path.branch == branch)
        scaled = points[rows] / extent
        stable = _stable_steps(path, rows)
        for start, end in _runs(2 * _turns(scaled) + stable):
            piece = scaled[start : end + 1]
            seen = _covered(piece, drawn[stable[start]])
            for first, last in _runs(seen):
                if not seen[first]:
                    line = points[rows[start + first : start + last + 1]]
                    axes.plot(*line.T, **_line(stable=stable[start]))
            drawn[stable[start]].append(piece)


def _stable_steps(path: Path, rows: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return whether the path is stable from each point of a branch to the next.

    An event is a point just behind the change, so that a step is as stable as its earlier end; but
    a branch starts at the bifurcation itself, where nothing is.
    """
    stable: NDArray[np.bool_] = path.stable[rows][:-1].copy()
    if len(stable) and path.branch[rows[0]] > 0:
        stable[0] = path.stable[rows[1]]
    return stable


def _turns(line: Array) -> NDArray[np.int64]:
    """Return how often a line has turned back before each of its steps.

    Where a path goes on as the mirror image of how it came, its picture goes back on itself.
    """
    steps = np.diff(line, axis=0)
    back = np.sum(steps[1:] * steps[:-1], axis=1) < 0.0
    return np.concatenate([np.zeros(min(1, len(steps)), dtype=np.int64), np.cumsum(back)])


def _runs(labels: NDArray[Any]) -> list[tuple[int, int]]:
    """Return first step, and step behind the last one, of each run of equal labels."""
    if len(labels) == 0:
        return []
    starts = [0, *(np.flatnonzero(labels[1:] != labels[:-1]) + 1).tolist()]
    return list(zip(starts, [*starts[1:], len(labels)], strict=True))


def _covered(line: Array, drawn: list[Array]) -> NDArray[np.bool_]:
    """Return which steps of a line lie on lines that are drawn already."""
    middles = 0.5 * (line[1:] + line[:-1])
    covered = np.zeros(len(middles), dtype=bool)
    for other in drawn:
        start, step = other[:-1], np.diff(other, axis=0)
        square = np.maximum(np.sum(step**2, axis=1), np.finfo(float).tiny)
        gap = middles[:, np.newaxis] - start
        along = np.clip(np.sum(gap * step, axis=2) / square, 0.0, 1.0)
        nearest = np.linalg.norm(gap - along[..., np.newaxis] * step, axis=2).min(axis=1)
        covered |= nearest < _SAME
    return covered
