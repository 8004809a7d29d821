"""Quantities against time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from der.plotting.style import MUTED, PALETTE, WARNING, axis_label

PROBE_HEIGHT = 1.55  # of its panel [inch]


def draw_probe(
    axes: Axes,
    times: NDArray[np.float64],
    values: NDArray[np.float64],
    name: str,
    unit: str,
) -> None:
    """Draw one probe against time.

    Parameters
    ----------
    axes
        Where to draw.
    times
        Times of the saved frames [s], shape (frames,).
    values
        The probe at these times, shape (frames,).
    name, unit
        For the label.
    """
    axes.plot(times, values, color=PALETTE[0])
    axes.set_ylabel(axis_label(name, unit, PROBE_HEIGHT - 0.1))
    axes.margins(x=0.01)
    _keep_rounding_flat(axes, values)


def mark_times(
    axes: Axes,
    times: NDArray[np.float64],
    values: NDArray[np.float64],
    marks: NDArray[np.float64],
) -> None:
    """Put a dot on a probe's curve at the times `marks` [s], such as those of the shapes shown."""
    at_marks = np.interp(marks, times, values)
    axes.plot(marks, at_marks, "o", color=MUTED, markersize=3.5, linestyle="none")


def shade_unreliable(axes: Axes, since: float, last: float) -> None:
    """Shade the times from `since` to `last` [s], in which the integrator had created energy."""
    axes.axvspan(since, last, color=WARNING, alpha=0.12, linewidth=0.0)
    axes.text(
        since,
        1.0,
        " unreliable",
        transform=axes.get_xaxis_transform(),
        va="top",
        color=WARNING,
        clip_on=True,
    )


def _keep_rounding_flat(axes: Axes, values: NDArray[np.float64]) -> None:
    """Do not blow up a constant's rounding errors until they fill the axes."""
    low, high = float(np.min(values)), float(np.max(values))
    size = max(abs(low), abs(high))
    if size > 0.0 and high - low < 1e-9 * size:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.01 * size, middle + 0.01 * size)
