"""The picture of a study: cost against error, and the sources of the error."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from matplotlib.typing import ColorType

from der._core import steppers
from der.accuracy.study_row import StudyRow
from der.plotting.style import FIGURE_TITLE, MUTED, axis_label, look, style, wrapped

_WIDTH = 10.0  # of the figure [inch]
_HEIGHT = 3.4  # of the panels of one probe [inch]
_MARGIN = 0.08  # of logarithmic axes [decades]


def plot_study(title: str, probes: Sequence[Sequence[StudyRow]]) -> Figure:
    """Draw, for each probe, cost against error, error in time against the step, and in space.

    The grey band holds errors below that of the reference, which cannot be measured. Lines
    trace the Pareto front of each stepper; other configurations are small dots. A static scene has
    no panel for time.

    Parameters
    ----------
    title
        Title of the figure.
    probes
        For each probe its rows, one for each configuration.

    Returns
    -------
    matplotlib.figure.Figure
        Made with pyplot, so that ``plt.show()`` shows it.
    """
    rows_of_all = [row for rows in probes for row in rows]
    static = not any(row.stepper for row in rows_of_all)
    draw = [_draw_cost]
    if not static:
        draw.append(_draw_time)
    if len({row.nodes for row in rows_of_all}) > 1:
        draw.append(_draw_space)
    with style():
        figure, panels = plt.subplots(
            len(probes),
            len(draw),
            squeeze=False,
            figsize=(_WIDTH * len(draw) / 3, _HEIGHT * len(probes)),
            layout="constrained",
        )
        for line, rows in zip(panels, probes, strict=True):
            for axes, function in zip(line, draw, strict=True):
                function(axes, [row for row in rows if row.completed])
        lines = wrapped(title, FIGURE_TITLE, 0.98 * figure.get_figwidth())
        figure.suptitle("\n".join(lines), x=0.01, ha="left", parse_math=False)
        if not static:
            handles, labels = panels[0][0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def _draw_cost(axes: Axes, rows: Sequence[StudyRow]) -> None:
    for stepper, colour, marker in _looks(rows):
        own = [row for row in rows if row.stepper == stepper]
        axes.plot(*_columns(own, "claimed_error", "cpu_seconds"), ".", color=colour, alpha=0.35)
        best = _frontier(own)
        axes.plot(
            *_columns(best, "claimed_error", "cpu_seconds"),
            color=colour,
            marker=marker,
            markersize=4,
            label=stepper or None,
        )
    _finish(axes, rows, "error", "CPU time [s]")
    left, right = _whole_decades(axes.dataLim.minposx, axes.dataLim.x1)
    if rows and rows[0].reference_error > left:
        axes.axvspan(left, rows[0].reference_error, color=MUTED, alpha=0.15, linewidth=0)
    axes.set_xlim(right, left)  # better is to the right
    axes.set_title(rows[0].probe if rows else "")


def _draw_time(axes: Axes, rows: Sequence[StudyRow]) -> None:
    """Draw the mesh on which most runs were done, the finest one where several have as many."""
    counts = Counter(row.nodes for row in rows)
    nodes = max(counts, key=lambda n: (counts[n], n), default=0)
    for stepper, colour, marker in _looks(rows):
        line = [row for row in rows if (row.stepper, row.nodes) == (stepper, nodes)]
        axes.plot(*_columns(line, "step", "time_error"), color=colour, marker=marker, markersize=4)
    _finish(axes, rows, "error in time", None)
    axes.set_xlim(_whole_decades(axes.dataLim.minposx, axes.dataLim.x1))
    axes.set_xlabel("step [s]")
    axes.set_title(f"{nodes} nodes")


def _draw_space(axes: Axes, rows: Sequence[StudyRow]) -> None:
    errors = {row.nodes - 1: row.space_error for row in rows}
    elements = np.array(sorted(errors))
    values = np.array([errors[n] for n in elements])
    axes.plot(elements, values, "o-", color=MUTED, markersize=4)
    if len(elements) and values[0] > 0.0:
        slope = values[0] * (elements[0] / elements) ** 2
        axes.plot(elements, slope, ":", color=MUTED, label="order 2")
        axes.legend()
    _finish(axes, rows, "error in space", None)
    axes.set_xlabel("elements")
    axes.set_xticks(elements, [str(n) for n in elements], minor=False)


def _looks(rows: Sequence[StudyRow]) -> list[tuple[str, ColorType, str]]:
    """Return each stepper with its colour and its marker: the same in every figure.

    They follow the order of the catalog. A static scene has no stepper, and one line.
    """
    catalog = [info.name for info in steppers()]
    names = dict.fromkeys(row.stepper for row in rows)
    return [(name, *look(catalog.index(name) if name else 0)) for name in names]


def _frontier(rows: Sequence[StudyRow]) -> list[StudyRow]:
    """Return the rows on the Pareto front of cost and error, cheapest first."""
    best: list[StudyRow] = []
    for row in sorted(rows, key=lambda row: (row.cpu_seconds, row.claimed_error)):
        if not best or row.claimed_error < best[-1].claimed_error:
            best.append(row)
    return best


def _columns(rows: Sequence[StudyRow], x: str, y: str) -> tuple[list[float], list[float]]:
    return [getattr(row, x) for row in rows], [getattr(row, y) for row in rows]


def _finish(axes: Axes, rows: Sequence[StudyRow], what: str, cost: str | None) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(_whole_decades(axes.dataLim.minposy, axes.dataLim.y1))
    unit = rows[0].unit if rows else ""
    if cost is None:
        axes.set_ylabel(axis_label(what, unit))
    else:
        axes.set_xlabel(axis_label(what, unit))
        axes.set_ylabel(cost)


def _whole_decades(low: float, high: float) -> tuple[float, float]:
    """Return limits around data that hold whole powers of ten, so that two ticks have labels."""
    if not 0.0 < low <= high < np.inf:
        return 0.1, 10.0
    first, last = np.floor(np.log10(low) + 0.02), np.ceil(np.log10(high) - 0.02)
    return float(10.0 ** (first - _MARGIN)), float(10.0 ** (max(last, first + 1.0) + _MARGIN))
