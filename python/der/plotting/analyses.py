"""Pictures of analyses: vibration and buckling modes, and paths of equilibria."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from der._core import springs
from der.plotting.lengths import label_positions
from der.plotting.shapes import draw_shapes, limits
from der.plotting.style import MUTED, PALETTE, axis_label
from der.plotting.supports import draw_springs, draw_supports

if TYPE_CHECKING:
    from der.result import Result

Array = NDArray[np.float64]

_SIZE = 0.12  # largest displacement drawn, against the structure's size
_ROW = 1.6  # height of a panel [inch]
_WIDTH = 7.2  # of the figure [inch]


def plot_modes(result: Result) -> Figure:
    """Draw each mode: the equilibrium, and the shape to both sides of it, not to scale."""
    labels: list[str] = []
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
    rest = result.positions[-1]
    low, high = limits(result.rods, [rest])
    size = _SIZE * float(np.max(high - low))
    figure, panels = plt.subplots(
        len(labels),
        1,
        figsize=(_WIDTH, _ROW * len(labels) + 0.6),
        squeeze=False,
        sharex=True,
        layout="constrained",
    )
    for axes, shape, label in zip(panels[:, 0], shapes, labels, strict=True):
        _draw_mode(axes, result, rest, shape * size / np.abs(shape).max(), label)
        label_positions(axes, low, high)
        axes.label_outer()
    return figure


def _draw_mode(axes: Axes, result: Result, rest: Array, shape: Array, label: str) -> None:
    draw_shapes(axes, result.rods, rest - shape, MUTED, linestyle=":")
    draw_shapes(axes, result.rods, rest, MUTED, linestyle="--")
    for rod in result.rods:
        line = (rest + shape)[rod.nodes]
        axes.plot(line[:, 0], line[:, 1], color=PALETTE[0], zorder=4)
    draw_supports(axes, result.rods, result.held_nodes(0), rest)
    draw_springs(axes, result.rods, springs(result.scenario), rest)
    axes.set_aspect("equal", adjustable="datalim")
    axes.text(1.01, 0.5, f"{label},\nnot to scale", transform=axes.transAxes, va="center")


def plot_path(result: Result, names: list[str]) -> Figure:
    """Draw the load factor against each probe: stable solid, unstable dashed, events marked."""
    path = result.path
    if path is None or not names:
        raise ValueError("a path is drawn against probes: add some under output.probes")
    figure, panels = plt.subplots(
        1, len(names), figsize=(_WIDTH, 4.2), squeeze=False, sharey=True, layout="constrained"
    )
    for axes, name in zip(panels[0], names, strict=True):
        probe = result.probes[name]
        values = np.asarray(probe)
        for branch in np.unique(path.branch):
            _draw_branch(axes, path.branch == branch, values, result)
        for event, marker, colour in (("fold", "o", PALETTE[1]), ("bifurcation", "D", PALETTE[2])):
            at = path.events == event
            if at.any():
                axes.plot(values[at], path.factor[at], marker, color=colour, label=event, zorder=5)
        axes.set_xlabel(axis_label(name, probe.unit))
    panels[0, 0].set_ylabel("load factor")
    panels[0, 0].plot([], [], color=PALETTE[0], label="stable")
    panels[0, 0].plot([], [], color=MUTED, linestyle="--", label="unstable")
    panels[0, 0].legend()
    return figure


def _draw_branch(axes: Axes, chosen: NDArray[np.bool_], values: Array, result: Result) -> None:
    path = result.path
    assert path is not None
    rows = np.flatnonzero(chosen)
    # An event is a point just behind the change, so that a piece between two points is as stable as
    # its earlier end; but a branch starts at the bifurcation itself, where nothing is.
    stable = path.stable[rows][:-1].copy()
    if len(rows) > 1 and path.branch[rows[0]] > 0:
        stable[0] = path.stable[rows[1]]
    starts = [0, *(np.flatnonzero(np.diff(stable)) + 1).tolist()]
    ends = [*starts[1:], len(rows) - 1]
    for start, end in zip(starts, ends, strict=True):
        piece = rows[start : end + 1]
        is_stable = bool(stable[start]) if len(stable) else bool(path.stable[rows[0]])
        axes.plot(
            values[piece],
            path.factor[piece],
            color=PALETTE[0] if is_stable else MUTED,
            linestyle="-" if is_stable else "--",
            zorder=3,
        )
