"""Actuated stretches as bands along the rods, at a fixed width on paper."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import NDArray

from der._core import Rod
from der.actuated_stretches import ActuatedStretch
from der.plotting.style import actuated_colour

Array = NDArray[np.float64]

_WIDTHS = (2.5, 7.0)  # of a band [points]: of a value of 0, and of the largest
_WIDER = 4.0  # that each further one is where they overlap [points]


def draw_actuation(
    axes: Axes,
    rods: Iterable[Rod],
    stretches: Iterable[ActuatedStretch],
    frame: int,
    positions: Array,
) -> None:
    """Draw each actuated stretch as a band under the centre line.

    It is the wider the larger the value is, and dark where it is negative. Bands that overlap lie
    one upon the other.

    Parameters
    ----------
    axes
        Where to draw.
    rods
        The rods.
    stretches
        From ``der.actuated_stretches.actuated_stretches(result)``.
    frame
        The frame whose values they have.
    positions
        Positions of all nodes [m], shape (nodes, 2).
    """
    by_name = {rod.name: rod for rod in rods}
    for number, stretch in enumerate(stretches):
        rod = by_name[stretch.rod]
        places = stretch.samples(rod)
        line = stretch.line(rod, positions)
        middles = 0.5 * (places[1:] + places[:-1])
        shares = stretch.shares[frame] * stretch.profile_at(middles)
        # Each piece reaches over the next, so that no gaps show between them.
        pieces = [line[first : first + 3] for first in range(len(middles))]
        band = LineCollection(
            pieces,
            colors=[actuated_colour(number, share < 0.0) for share in shares.tolist()],
            linewidths=_width(shares) + _WIDER * stretch.level,
            capstyle="butt",
            zorder=2.2 - 0.01 * stretch.level,  # above the rod's thickness
            gid=f"actuation-{stretch.name}",
        )
        axes.add_collection(band, autolim=False)


def add_actuation_to_legend(
    axes: Axes, stretches: Iterable[ActuatedStretch], frame: int | None = None
) -> None:
    """Add the name of each actuation to the legend, as wide as at a frame if that is given."""
    for number, stretch in enumerate(stretches):
        share = 1.0 if frame is None else float(stretch.shares[frame])
        axes.plot(
            [],
            [],
            color=actuated_colour(number, share < 0.0),
            linewidth=_width(share),
            solid_capstyle="butt",
            label=stretch.name + ("" if frame is None else f": {stretch.value_text(frame)}"),
            gid=f"actuation-{stretch.name}",
        )


def _width(share: float | Array) -> Any:
    """Return the width [points] for a share of the largest value."""
    return _WIDTHS[0] + (_WIDTHS[1] - _WIDTHS[0]) * np.abs(share)
