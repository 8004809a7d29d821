"""Pictures of an environment, all of one size and with the same axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from der.gym.episodes import Episodes

_SIZE, _DPI = 4.8, 100  # [inch], and points of the picture to one


class Screen:
    """What `RodEnv.render` draws on.

    Parameters
    ----------
    batch
        The simulation at its start, with as much room around it as half the length of all rods.
    """

    def __init__(self, batch: Episodes) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg  # here: takes long to load
        from matplotlib.figure import Figure

        from der.plotting.space import make_picture

        self._first = make_picture(batch.result(0))
        start = self._first.seen(batch.positions[0])
        low, high = start.min(axis=0), start.max(axis=0)
        reach = 0.5 * (float(np.max(high - low)) + sum(rod.length for rod in batch.model.rods))
        figure = Figure(figsize=(_SIZE, _SIZE), dpi=_DPI)
        self._canvas: Any = FigureCanvasAgg(figure)
        self._axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        (x, y), ends = 0.5 * (low + high), np.array([-reach, reach])
        self._limits = {"xlim": x + ends, "ylim": y + ends}

    def draw(self, batch: Episodes, points: NDArray[np.float64]) -> NDArray[np.uint8]:
        """Return the picture of the present state, RGB, shape (height, width, 3).

        Parameters
        ----------
        batch
            The simulation.
        points
            Points [m] that are marked, shape (points, dim).
        """
        from der.plotting import PALETTE, style
        from der.plotting.space import make_picture
        from der.scene_loads import ActingLoads

        picture, axes = make_picture(batch.result(0)), self._axes
        picture.look_as(self._first)
        shape = picture.shape(0, PALETTE[0])
        with style():
            axes.clear()
            axes.set_axis_off()
            picture.draw(axes, [shape], shape, ActingLoads())
            axes.set(**self._limits)
            marked = picture.seen(points)
            # Before the rods, which have solid sections in space.
            axes.plot(*marked.T, "o", color=PALETTE[1], fillstyle="none", zorder=10.0)
            self._canvas.draw()
        drawn: NDArray[np.uint8] = np.array(self._canvas.buffer_rgba())[:, :, :3]
        return drawn
