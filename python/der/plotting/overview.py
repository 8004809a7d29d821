"""The picture of a result: its shapes on top, its probes against time below."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from der._core import Scenario, ended_as_asked
from der.film import title_of
from der.plotting.actuation import add_actuation_to_legend, draw_actuation
from der.plotting.analyses import plot_modes, plot_path
from der.plotting.loads import draw_loads, room_for_loads
from der.plotting.picture import Picture
from der.plotting.probes import draw_probe, mark_times, shade_unreliable
from der.plotting.shapes import draw_shapes, limits, make_exactly_equal, pick_frames
from der.plotting.style import (
    AXES_TITLE,
    FIGURE_TITLE,
    MUTED,
    PALETTE,
    style,
    time_colours,
    time_text,
    wrapped,
)
from der.plotting.supports import draw_foundations, draw_springs, draw_supports
from der.probe_series import Probes
from der.run_data import RunData

Array = NDArray[np.float64]
What = Literal["overview", "shapes", "probes"]

_WIDTH = 7.2  # of the figure [inch]
_LEFT = 0.9  # of it, at most, is left of the axes [inch]
_SHAPE_WIDTH = 5.6  # of the axes of the shapes, beside their legend [inch]
_SHAPE_HEIGHT = (1.7, 5.5)  # least and most [inch]
_PROBE_HEIGHT = 1.55  # [inch]


def plot(
    result: RunData,
    what: What = "overview",
    *,
    times: Sequence[float] | None = None,
    probes: Sequence[str] | None = None,
    views: Sequence[str] | None = None,
    title: str | None = None,
) -> Figure:
    """Draw a result: shapes coloured by time, and probes against time.

    Parameters
    ----------
    result
        A result of ``der.run`` or ``der.open_run``.
    what
        ``"shapes"``, ``"probes"``, or both: ``"overview"``.
    times
        Times [s] of the shapes; the nearest saved frame of each is drawn. Without it, up to six
        frames that are evenly spaced along the way that the nodes travel.
    probes
        Names of the probes to draw; without it, all.
    views
        Views of a run in space, one below the other: each names the axis to the right and the one
        upwards, such as ``"xz"``. Without it, the view that shows the shapes best. Modes and the
        shapes of a path have one.
    title
        In place of the scene's title.

    Returns
    -------
    matplotlib.figure.Figure
        Made with pyplot, so that ``plt.show()`` shows it.

    Raises
    ------
    ValueError
        For a time outside of the run or of a run without time, a probe that the scene has not, a
        view that is none, or several of modes or of a path.
    """
    names = _probe_names(result, probes) if what != "shapes" else []
    kind = result.scenario.analysis
    if times is not None and result.scenario.is_static:
        raise ValueError(f"a {kind} run has no time, and so no shapes at times")
    frames = [] if kind == "continuation" else _frames_to_draw(result, times)
    if what == "probes" and not names:
        raise ValueError("the scene has no probes to plot; add some under output.probes")
    pictures = [Picture(result, view) for view in views] if views else [Picture(result)]
    if len(pictures) > 1 and kind in ("continuation", "modes", "buckling"):
        raise ValueError(f"a {kind} run is drawn in one view, not in {len(pictures)}")
    with style():
        if kind == "continuation" and what != "shapes":
            figure = plot_path(result, names)
        elif kind in ("modes", "buckling") and what != "probes":
            figure = plot_modes(pictures[0])
        elif kind == "continuation":
            figure = _plot_path_shapes(pictures[0])
        elif result.scenario.is_static:
            figure = _plot_static(pictures, what, names)
        else:
            figure = _plot_motion(pictures, what, names, frames)
        text = title_of(result) if title is None else title
        figure.align_ylabels()
        if kind == "continuation" and what != "shapes":
            lines = wrapped(text, FIGURE_TITLE, _WIDTH - 0.2)
            figure.suptitle("\n".join(lines), x=0.01, ha="left", parse_math=False)
        else:
            lines = wrapped(text, AXES_TITLE, _WIDTH - _LEFT)
            figure.axes[0].set_title("\n".join(lines), pad=10, parse_math=False)
        for axes in figure.axes[: len(pictures)]:
            if axes.get_aspect() == 1.0 and kind not in ("modes", "buckling"):
                make_exactly_equal(figure, axes)
    return figure


def plot_states(
    scenario: Scenario,
    positions: Array,
    labels: Sequence[str],
    *,
    time: float = 0.0,
    title: str | None = None,
) -> Figure:
    """Draw shapes of a scene that are not those of a run, with its supports and loads.

    Parameters
    ----------
    scenario
        The scene.
    positions
        Positions of the nodes [m], shape (shapes, nodes, dim).
    labels
        What the legend calls each shape.
    time
        When supports and loads stand as they are drawn [s].
    title
        In place of the scene's title.
    """
    count = len(positions)
    picture = Picture(
        RunData(
            scenario=scenario,
            times=np.full(count, time),
            steps=np.zeros(count, dtype=np.int64),
            positions=positions,
            velocities=np.zeros_like(positions),
            energies={},
            work={},
            probes=Probes(),
            summary={},
        )
    )
    shapes = list(picture.positions)
    with style():
        figure, (axes,) = _figure([_shape_height(picture, shapes, count - 1)])
        _draw_shape_panel(axes, picture, shapes, labels, range(count))
        lines = wrapped(scenario.title if title is None else title, AXES_TITLE, _WIDTH - _LEFT)
        axes.set_title("\n".join(lines), pad=10, parse_math=False)
        make_exactly_equal(figure, axes)
    return figure


def _probe_names(result: RunData, probes: Sequence[str] | None) -> list[str]:
    if probes is None:
        return list(result.probes)
    if isinstance(probes, str):
        probes = [probes]
    unknown = [name for name in probes if name not in result.probes]
    if unknown:
        raise ValueError(
            f"the scene has no probe {unknown[0]!r}; it has: {', '.join(result.probes) or 'none'}"
        )
    return list(probes)


def _frames_to_draw(result: RunData, times: Sequence[float] | None) -> list[int]:
    if times is None:
        return pick_frames(result.positions, 6)
    first, last = float(result.times[0]), float(result.times[-1])
    slack = 1e-9 * max(abs(first), abs(last))
    for time in times:
        if not first - slack <= time <= last + slack:
            raise ValueError(f"no frame at {time} s: the run goes from {first:g} s to {last:g} s")
    return sorted({int(np.argmin(np.abs(result.times - time))) for time in times})


def _plot_motion(
    pictures: list[Picture], what: What, names: list[str], frames: list[int]
) -> Figure:
    result = pictures[0].result
    marks = result.times[frames]
    heights = [_PROBE_HEIGHT] * len(names)
    if what == "probes":
        figure, panels = _figure(heights)
    else:
        shapes = [[picture.positions[frame] for frame in frames] for picture in pictures]
        seen = list(zip(pictures, shapes, strict=True))
        views = [_shape_height(picture, own, frames[-1]) for picture, own in seen]
        figure, panels = _figure([*views, *heights])
        labels = [_time_label(result, time) for time in marks]
        for picture, own in seen:
            _draw_shape_panel(panels.pop(0), picture, own, labels, frames)
    for axes, name in zip(panels, names, strict=True):
        probe = result.probes[name]
        draw_probe(axes, result.times, probe, name, probe.unit)
        if what == "overview":
            mark_times(axes, result.times, probe, marks)
        if result.unreliable_from is not None:
            shade_unreliable(axes, result.unreliable_from, float(result.times[-1]))
        axes.sharex(panels[0])
        axes.label_outer()
    if panels:
        panels[-1].set_xlabel("time [s]")
    return figure


def _time_label(result: RunData, time: float) -> str:
    since = result.unreliable_from
    trusted = since is None or time < since
    return time_text(time) if trusted else f"{time_text(time)}, unreliable"


def _plot_path_shapes(picture: Picture) -> Figure:
    """Draw shapes along a path: coloured by load factor, or by branch where there are several."""
    rods, positions = picture.rods, picture.positions
    path = picture.result.path
    if path is None:
        raise ValueError("the run has found no path to draw")
    if len(np.unique(path.branch)) == 1:
        frames = pick_frames(positions, 6)
        labels = [f"load factor {path.factor[frame]:.3g}" for frame in frames]
        shapes = [positions[frame] for frame in frames]
        figure, (axes,) = _figure([_shape_height(picture, shapes, frames[-1])])
        _draw_shape_panel(axes, picture, shapes, labels, frames)
        return figure
    low, high = limits(rods, list(positions))
    figure, (axes,) = _figure([_panel_height(*(high - low))])
    for branch in np.unique(path.branch):
        rows = np.flatnonzero(path.branch == branch)
        first, last = path.factor[rows[0]], path.factor[rows[-1]]
        label: str | None = f"branch {branch}: load factor\n{first:.3g} to {last:.3g}"
        for row in rows[pick_frames(positions[rows], 4)]:
            colour = PALETTE[branch % len(PALETTE)]
            half_widths = picture.half_widths(int(row), positions[row])
            draw_shapes(axes, rods, positions[row], colour, label, half_widths=half_widths)
            label = None
    draw_supports(axes, rods, picture.held_nodes(0), positions[0])
    draw_springs(axes, rods, picture.springs, positions[0])
    draw_foundations(axes, rods, picture.loads(0).foundations, positions[0])
    draw_actuation(axes, rods, picture.actuated, 0, positions[0])
    add_actuation_to_legend(axes, picture.actuated)
    _finish_shape_panel(axes, picture)
    return figure


def _plot_static(pictures: list[Picture], what: What, names: list[str]) -> Figure:
    result = pictures[0].result
    last = len(result.times) - 1
    table_height = 0.25 + 0.2 * len(names)
    if what == "probes":
        figure, panels = _figure([table_height])
    else:
        views = [
            _shape_height(picture, [picture.initial_positions, picture.positions[-1]], last)
            for picture in pictures
        ]
        figure, panels = _figure([*views, *([table_height] if names else [])])
        label = "equilibrium" if ended_as_asked(result.status) else "where it ended"
        for picture in pictures:
            axes = panels.pop(0)
            draw_shapes(axes, picture.rods, picture.initial_positions, MUTED, "undeformed", "--")
            _draw_shape_panel(axes, picture, [picture.positions[-1]], [label], [last])
    if panels:
        _write_values(panels[0], result, names)
    return figure


def _figure(heights: list[float]) -> tuple[Figure, list[Axes]]:
    figure, axes = plt.subplots(
        len(heights),
        1,
        squeeze=False,
        figsize=(_WIDTH, sum(heights) + 0.7),
        height_ratios=heights,
        layout="constrained",
    )
    return figure, list(axes[:, 0])


def _shape_height(picture: Picture, shapes: Sequence[Array], frame: int) -> float:
    """Return the height [inch] at which the shapes fill the width, within bounds."""
    low, high = _corners(picture, shapes, frame)
    return _panel_height(*(high - low))


def _panel_height(width: float, height: float) -> float:
    return float(np.clip(_SHAPE_WIDTH * height / max(width, 1e-300) + 0.5, *_SHAPE_HEIGHT))


def _corners(picture: Picture, shapes: Sequence[Array], frame: int) -> tuple[Array, Array]:
    """Return the lower left and upper right corner [m] of shapes and the symbols of loads."""
    low, high = limits(picture.rods, shapes)
    width, height = high - low
    point = max(width / (72.0 * _SHAPE_WIDTH), height / (72.0 * (_SHAPE_HEIGHT[1] - 0.5)))
    room = room_for_loads(picture.rods, picture.loads(frame), shapes[-1], float(point))
    return np.vstack([low, room]).min(axis=0), np.vstack([high, room]).max(axis=0)


def _draw_shape_panel(
    axes: Axes,
    picture: Picture,
    shapes: Sequence[Array],
    labels: Sequence[str],
    frames: Sequence[int],
) -> None:
    """Draw the shapes at some frames, with supports, loads and actuation at the last."""
    colours = time_colours(len(shapes))
    for positions, label, colour, at in zip(shapes, labels, colours, frames, strict=True):
        half_widths = picture.half_widths(at, positions)
        draw_shapes(axes, picture.rods, positions, colour, label, half_widths=half_widths)
    frame = frames[-1]
    draw_actuation(axes, picture.rods, picture.actuated, frame, shapes[-1])
    draw_supports(axes, picture.rods, picture.held_nodes(frame), shapes[-1])
    draw_springs(axes, picture.rods, picture.springs, shapes[-1])
    draw_loads(axes, picture.rods, picture.loads(frame), shapes[-1])
    add_actuation_to_legend(axes, picture.actuated, frame)
    axes.update_datalim(np.array(_corners(picture, shapes, frame)))
    _finish_shape_panel(axes, picture)


def _finish_shape_panel(axes: Axes, picture: Picture) -> None:
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.06)
    axes.autoscale_view()
    picture.label(axes, np.array(axes.dataLim.min), np.array(axes.dataLim.max))
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)


def _write_values(axes: Axes, result: RunData, names: list[str]) -> None:
    axes.set_axis_off()
    lines = [f"{name} = {result.probes[name][-1]:.6g} {result.probes[name].unit}" for name in names]
    axes.text(0.0, 1.0, "\n".join(lines), transform=axes.transAxes, va="top", linespacing=1.4)
