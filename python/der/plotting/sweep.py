"""The picture of a sweep: lines over one parameter, maps over two, parallel axes over more."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from der.errors import warn
from der.plotting.style import (
    FIGURE_TITLE,
    MUTED,
    PALETTE,
    WARNING,
    axis_label,
    style,
    wrapped,
)
from der.sweeps.sweep_data import SweepData
from der.sweeps.table import WARNINGS

Array = NDArray[np.float64]

_WIDTH = 7.2  # of the figure [inch]
_LINE_HEIGHT, _MAP_HEIGHT, _PARALLEL_HEIGHT = 1.9, 3.4, 3.6  # of a panel [inch]
_COLOURS = "viridis"
#: Columns that are drawn unless they are named.
_MOST_COLUMNS = 6
#: Lines on parallel axes: more hide one another.
_MOST_LINES = 5000
#: A positive parameter whose ends have at least this ratio may have a logarithmic axis.
_WIDE = 20.0
#: Letters of a line of an axis' name: on maps and parallel axes there is little room.
_MAP_LETTERS, _PARALLEL_LETTERS = 28, 14
_NOTE = 9.0  # font size of what parallel axes do not show [points]
#: How a failed member is marked, and one whose results are doubtful.
_CROSS: dict[str, Any] = {"marker": "x", "color": WARNING, "linestyle": "none", "markersize": 5.0}
_RING: dict[str, Any] = {
    "marker": "o",
    "color": PALETTE[1],
    "markerfacecolor": "none",
    "markeredgewidth": 1.2,
    "linestyle": "none",
    "markersize": 7.0,
}
#: How a member is marked that has not failed and has no value; the colour of its line.
_DOT: dict[str, Any] = {"marker": ".", "color": MUTED, "linestyle": "none", "markersize": 5.0}


class _Scale:
    """A parameter or a result as numbers along an axis."""

    def __init__(self, label: str, values: NDArray[Any]) -> None:
        self.label = label
        #: The words of a parameter that is not a number.
        self.words: list[str] = []
        numbers = values.dtype.kind in "if"
        self.at: Array = np.asarray(values, float) if numbers else self._places(values)
        self.log = not self.words and _is_logarithmic(np.unique(self.at[np.isfinite(self.at)]))

    def _places(self, values: NDArray[Any]) -> Array:
        words, places = np.unique(values.astype(str), return_inverse=True)
        self.words = words.tolist()
        return places.astype(float)

    def title(self, axes: Axes, across: bool = True) -> None:
        """Put its name and its kind of scale on an axis."""
        axis = axes.xaxis if across else axes.yaxis
        axis.set_label_text(_broken(self.label, _MAP_LETTERS))
        if self.log:
            (axes.set_xscale if across else axes.set_yscale)("log")
        if self.words:
            axis.set_ticks(range(len(self.words)), self.words)

    def shares(self) -> tuple[Array, float, float]:
        """Return places along an axis of length 1, and the ends of that axis."""
        finite = self.at[np.isfinite(self.at)]
        low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
        if high == low:
            return np.where(np.isfinite(self.at), 0.5, np.nan), low, high
        if self.log:
            return np.log(self.at / low) / np.log(high / low), low, high
        return (self.at - low) / (high - low), low, high


def plot_sweep(sweep: SweepData, columns: Sequence[str] | None = None) -> Figure:
    """Draw columns of a sweep over its parameters; see `Sweep.plot`.

    Returns
    -------
    matplotlib.figure.Figure
        Made with pyplot, so that ``plt.show()`` shows it.

    Raises
    ------
    ValueError
        For a sweep without a member, a column that there is not, or one that has no numbers.
    """
    if len(sweep) == 0:
        raise ValueError("the sweep has no member to draw yet")
    names = _names(sweep, columns)
    parameters = [_Scale(path, sweep[path]) for path in sweep.parameters]
    varied = [scale for scale in parameters if len(np.unique(scale.at)) > 1] or parameters[:1]
    with style():
        if len(varied) == 1:
            figure = _plot_lines(sweep, varied[0], names)
        elif len(varied) == 2:
            figure = _plot_maps(sweep, varied[0], varied[1], names)
        else:
            figure = _plot_parallel(sweep, varied, names)
        lines = wrapped(sweep.scenario.title, FIGURE_TITLE, _WIDTH - 0.2)
        figure.suptitle("\n".join(lines), x=0.01, ha="left", parse_math=False)
    return figure


def _names(sweep: SweepData, columns: Sequence[str] | None) -> list[str]:
    if columns is None:
        names = sweep.answers
        if len(names) > _MOST_COLUMNS:
            warn(
                [
                    f"the first {_MOST_COLUMNS} of {len(names)} columns are drawn, such as "
                    f"'{names[0]}': name others, as with --probes (columns=)"
                ]
            )
        return names[:_MOST_COLUMNS] or ["seconds"]
    if len(columns) == 0:
        raise ValueError("no column to draw is named: name one, or leave the names out")
    try:
        listed = [columns] if isinstance(columns, str) else columns
        names = [sweep.column(name).name for name in listed]
    except KeyError as error:
        raise ValueError(error.args[0]) from None
    for name in names:
        # Those of a probe may be missing because all members failed, and that is a picture.
        is_empty = sweep.column(name).kind == "run" and not any(
            value is not None for value in sweep.values[name]
        )
        if is_empty or not sweep.is_number(name):
            raise ValueError(f"the column '{name}' has no numbers to draw")
    return names


def _label(sweep: SweepData, name: str, room: float | None = None) -> str:
    return axis_label(name.removesuffix(".final"), sweep.column(name).unit, room)


class _Marks:
    """The members that are marked, and what the legend says of them."""

    def __init__(self, sweep: SweepData) -> None:
        self.failed = sweep.failed
        self.failures = f"failed: {int(self.failed.sum())} of {len(sweep)}"
        doubts = _doubts(sweep)
        self.doubtful = np.logical_or.reduce(list(doubts.values()))
        counts = ", ".join(f"{why} {int(own.sum())}" for why, own in doubts.items() if own.any())
        self.doubted = f"doubtful: {int(self.doubtful.sum())} of {len(sweep)} ({counts})"

    def draw_rings(self, axes: Axes, across: Array, up: Array, **options: Any) -> None:
        """Draw a ring about each of these places of doubtful members."""
        if len(across):
            axes.plot(across, up, **_RING, **options, label=self.doubted)

    def draw_crosses(self, axes: Axes, across: Array, up: Array, **options: Any) -> None:
        """Draw a cross at each of these places of failed members."""
        if len(across):
            axes.plot(across, up, **_CROSS, **options, label=self.failures)

    def draw_dots(self, axes: Axes, across: Array, up: Array, **options: Any) -> None:
        """Draw a dot at each of these places of members without a value."""
        if len(across):
            axes.plot(across, up, **_DOT, **options, label="no finite value")


def _legend_of(panels: NDArray[Any]) -> tuple[list[Artist], list[str]]:
    """Return what the panels have to explain, each once."""
    named: dict[str, Artist] = {}
    for axes in panels.flat:
        handles, labels = axes.get_legend_handles_labels()
        named |= dict(zip(labels, handles, strict=True))
    return list(named.values()), list(named)


def _doubts(sweep: SweepData) -> dict[str, NDArray[np.bool_]]:
    """Return, by reason, which members have not failed but have results that are doubtful."""
    unknown = [None] * len(sweep)

    def tells(column: str, nothing: Any = None) -> NDArray[np.bool_]:
        told = [value not in (None, nothing) for value in sweep.values.get(column, unknown)]
        return np.array(told, bool) & ~sweep.failed

    return {
        "unreliable": tells("unreliable_from"),
        "with warnings": tells(WARNINGS),
        "flagged": tells("flagged", nothing=0),
        "not verified": tells("message"),
    }


def _plot_lines(sweep: SweepData, over: _Scale, names: list[str]) -> Figure:
    figure, panels = plt.subplots(
        len(names),
        1,
        squeeze=False,
        sharex=True,
        figsize=(_WIDTH, _LINE_HEIGHT * len(names) + 0.7),
        layout="constrained",
    )
    order = np.argsort(over.at, kind="stable")
    marks = _Marks(sweep)
    failed = over.at[marks.failed]
    for axes, name in zip(panels[:, 0], names, strict=True):
        values = np.asarray(sweep[name], float)
        axes.plot(over.at[order], values[order], "o-", color=PALETTE[0], markersize=3.0)
        if f"{name}.error" in sweep.values:
            _draw_error_bars(axes, over.at, values, np.asarray(sweep[f"{name}.error"], float))
        known = np.isfinite(values)
        without = over.at[~marks.failed & ~known]
        doubtful_without = over.at[marks.doubtful & ~known]
        at_the_bottom = {"transform": axes.get_xaxis_transform(), "clip_on": False}
        marks.draw_rings(axes, over.at[marks.doubtful & known], values[marks.doubtful & known])
        marks.draw_rings(axes, doubtful_without, np.zeros(len(doubtful_without)), **at_the_bottom)
        marks.draw_dots(axes, without, np.zeros(len(without)), **at_the_bottom)
        marks.draw_crosses(axes, failed, np.zeros(len(failed)), **at_the_bottom)
        axes.set_ylabel(_label(sweep, name, _LINE_HEIGHT - 0.1))
        over.title(axes)
        axes.label_outer()
    handles, labels = _legend_of(panels)
    if handles:
        panels[0, 0].legend(handles, labels, loc="best")
    figure.align_ylabels()
    return figure


def _draw_error_bars(axes: Axes, at: Array, values: Array, bars: Array) -> None:
    """Draw error bars; one without bound goes across the panel."""
    known = np.isfinite(bars)
    axes.errorbar(
        at[known],
        values[known],
        bars[known],
        fmt="none",
        ecolor=PALETTE[0],
        capsize=2.0,
        elinewidth=1.0,
    )
    for place in at[np.isposinf(bars)]:
        axes.axvline(place, color=PALETTE[0], linewidth=1.0, alpha=0.5, label="error without bound")


def _plot_maps(sweep: SweepData, over: _Scale, up: _Scale, names: list[str]) -> Figure:
    across = min(len(names), 2)
    down = -(-len(names) // across)
    figure, panels = plt.subplots(
        down,
        across,
        squeeze=False,
        figsize=(_WIDTH, _MAP_HEIGHT * down / (1.0 if across == 1 else 1.25) + 0.5),
        layout="constrained",
    )
    for axes in panels.flat[len(names) :]:
        axes.set_axis_off()
    marks = _Marks(sweep)
    for axes, name in zip(panels.flat, names, strict=False):
        values = np.asarray(sweep[name], float)
        _draw_map(axes, over, up, values)
        axes.set_title(_label(sweep, name), fontsize=10.0)
        without = ~marks.failed & ~np.isfinite(values)
        marks.draw_rings(axes, over.at[marks.doubtful], up.at[marks.doubtful])
        marks.draw_dots(axes, over.at[without], up.at[without])
        marks.draw_crosses(axes, over.at[marks.failed], up.at[marks.failed])
        over.title(axes)
        up.title(axes, across=False)
        axes.label_outer()
        axes.grid(False)
    handles, labels = _legend_of(panels)
    if handles:
        figure.legend(handles, labels, loc="outside lower center")
    return figure


def _draw_map(axes: Axes, over: _Scale, up: _Scale, values: Array) -> None:
    """Draw cells where the members are a grid, and dots where they are scattered."""
    xs, columns = np.unique(over.at, return_inverse=True)
    ys, rows = np.unique(up.at, return_inverse=True)
    if 2 * len(values) >= len(xs) * len(ys):
        grid = np.full((len(ys), len(xs)), np.nan)
        grid[rows, columns] = values
        drawn: Any = axes.pcolormesh(
            _edges(xs, over.log), _edges(ys, up.log), grid, cmap=_COLOURS, rasterized=True
        )
    else:
        known = np.isfinite(values)
        size = float(np.clip(4000.0 / max(len(values), 1), 3.0, 40.0))
        drawn = axes.scatter(
            over.at[known], up.at[known], size, values[known], cmap=_COLOURS, rasterized=True
        )
    axes.figure.colorbar(drawn, ax=axes)


def _plot_parallel(sweep: SweepData, varied: list[_Scale], names: list[str]) -> Figure:
    results = [_Scale(_label(sweep, name), np.asarray(sweep[name], float)) for name in names[:3]]
    for scale in results:
        scale.log = False
    scales = [*varied, *results]
    along = [scale.shares() for scale in scales]
    lines = np.column_stack([places for places, _, _ in along])
    marks = _Marks(sweep)
    sound = _few(np.flatnonzero(~marks.failed & ~marks.doubtful))
    doubtful = _few(np.flatnonzero(marks.doubtful))
    failed = _few(np.flatnonzero(marks.failed))
    good = np.concatenate([sound, doubtful])
    figure, axes = plt.subplots(figsize=(_WIDTH, _PARALLEL_HEIGHT + 0.7), layout="constrained")
    x = np.arange(len(scales), dtype=float)
    _, low, high = along[len(varied)]
    drawn = LineCollection(
        [np.column_stack([x, line]) for line in lines[good]],
        cmap=mpl.colormaps[_COLOURS].with_extremes(bad=MUTED),
        norm=Normalize(low, high),
        linewidths=0.9,
        alpha=float(np.clip(30.0 / max(len(good), 1), 0.08, 0.7)),
        rasterized=True,
    )
    drawn.set_array(results[0].at[good])
    axes.add_collection(drawn)
    ends = _ends(lines[doubtful])
    marks.draw_rings(axes, x[ends], lines[doubtful, ends])
    # A failed member has parameters and no results.
    own = lines[failed, : len(varied)]
    segments = [np.column_stack([x[: len(varied)], line]) for line in own]
    axes.add_collection(LineCollection(segments, colors=WARNING, linewidths=0.9, alpha=0.7))
    marks.draw_crosses(axes, np.full(len(failed), len(varied) - 1.0), own[:, -1])
    _finish_parallel(axes, scales, along)
    with_gaps = int((~np.isfinite(lines[good])).any(axis=1).sum())
    note = _left_out(len(good) + len(failed), len(sweep), with_gaps)
    axes.set_title(note, fontsize=_NOTE)
    bar = figure.colorbar(drawn, ax=axes, label=results[0].label)
    if bar.solids is not None:
        bar.solids.set_alpha(1.0)
    if axes.get_legend_handles_labels()[0]:
        figure.legend(loc="outside lower center")
    return figure


def _ends(lines: Array) -> NDArray[np.intp]:
    """Return the last axis on which each line has a place."""
    known = np.isfinite(lines[:, ::-1])
    return np.asarray(lines.shape[1] - 1 - np.argmax(known, axis=1))


def _left_out(shown: int, members: int, with_gaps: int) -> str:
    """Return in words what parallel axes do not show."""
    told = []
    if shown < members:
        told.append(f"{shown} of {members} members are drawn: more lines would hide one another")
    if with_gaps:
        told.append(f"lines with gaps where a member has no value: {with_gaps}")
    return "\n".join(told)


def _finish_parallel(
    axes: Axes, scales: list[_Scale], along: list[tuple[Array, float, float]]
) -> None:
    """Draw each axis with its ends, and its name below it."""
    for at, (scale, (_, low, high)) in enumerate(zip(scales, along, strict=True)):
        axes.axvline(at, color="black", linewidth=0.8)
        ends = (scale.words[0], scale.words[-1]) if scale.words else (f"{low:.4g}", f"{high:.4g}")
        for place, text, side in ((0.0, ends[0], "top"), (1.0, ends[1], "bottom")):
            shift = -3.0 if side == "top" else 3.0
            axes.annotate(
                text, (at, place), (0.0, shift), textcoords="offset points", ha="center", va=side
            )
    axes.set_xlim(-0.3, len(scales) - 0.7)
    axes.set_ylim(-0.09, 1.09)
    names = [_broken(scale.label, _PARALLEL_LETTERS) for scale in scales]
    axes.set_xticks(range(len(scales)), names, fontsize=8.0)
    axes.set_yticks([])
    axes.grid(False)
    axes.spines[["left", "bottom"]].set_visible(False)
    axes.tick_params(length=0.0)


def _few(rows: NDArray[np.intp]) -> NDArray[np.intp]:
    if len(rows) <= _MOST_LINES:
        return rows
    return np.asarray(rows[np.linspace(0, len(rows) - 1, _MOST_LINES).astype(int)])


def _broken(name: str, letters: int) -> str:
    """Return a name in lines of at most so many letters, if its keys and words allow it."""
    lines = [""]
    for part in re.findall(r"(?:\[.*?\]|[^. ])+[. ]?", name):  # a unit in one piece
        if lines[-1] and len(lines[-1]) + len(part.rstrip()) > letters:
            lines.append("")
        lines[-1] += part
    return "\n".join(line.rstrip() for line in lines)


def _is_logarithmic(values: Array) -> bool:
    """Whether values, ascending, are spread more evenly in their ratios than in their distances."""
    if len(values) < 3 or values[0] <= 0.0 or values[-1] < _WIDE * values[0]:
        return False
    shares = (values - values[0]) / (values[-1] - values[0])
    ratios = np.log(values / values[0]) / np.log(values[-1] / values[0])
    return bool(abs(np.mean(ratios) - 0.5) < abs(np.mean(shares) - 0.5))


def _edges(centres: Array, log: bool) -> Array:
    """Return the edges of cells about centres, ascending."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    places = np.log(centres) if log else centres
    between = 0.5 * (places[1:] + places[:-1])
    edges = np.concatenate(
        [[2.0 * places[0] - between[0]], between, [2.0 * places[-1] - between[-1]]]
    )
    return np.exp(edges) if log else edges
