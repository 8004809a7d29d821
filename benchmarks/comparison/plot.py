"""The plot of cost against error."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
from der.plotting import PALETTE, style

from comparison.report import Run, Series, pareto_front

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MARKERS = ("o", "s", "^", "D", "v", "P")


def draw(series: Sequence[Series]) -> Figure:
    """Draw the front of each series; all runs of a code faintly behind its line."""
    mpl.use("agg")
    import matplotlib.pyplot as plt

    codes = list(dict.fromkeys(s.code for s in series))
    with style():
        figure, axes = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
        for s in series:
            number = codes.index(s.code)
            colour = PALETTE[number % len(PALETTE)]
            front = pareto_front(s.runs)
            if not s.own_limit:
                axes.plot(*_columns(s.runs), ".", color=colour, markersize=3, alpha=0.18)
            axes.plot(
                *_columns(front),
                color=colour,
                marker=MARKERS[number % len(MARKERS)],
                markersize=4,
                linestyle="--" if s.own_limit else "-",
                markerfacecolor="white" if s.own_limit else colour,
                label=s.title,
            )
        axes.set(
            xscale="log",
            yscale="log",
            xlabel="largest error of the tip in 1 s [m]",
            ylabel="CPU time of the time loop [s]",
            xlim=(1e-1, 3e-6),
        )
        axes.legend()
    return figure


def write(path: Path, series: Sequence[Series]) -> None:
    """Draw and save."""
    figure = draw(series)
    with style():
        figure.savefig(path)


def _columns(runs: Sequence[Run]) -> tuple[list[float], list[float]]:
    return [run.error for run in runs], [run.seconds for run in runs]
