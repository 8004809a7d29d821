"""The picture of a result: its shapes on top, its probes against time below."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from der._core import Scenario, ended_as_asked
from der.film import title_of
from der.plotting.actuation import add_actuation_to_legend
from der.plotting.analyses import plot_modes, plot_path
from der.plotting.picture import Picture
from der.plotting.probes import PROBE_HEIGHT, draw_probe, mark_times, shade_unreliable
from der.plotting.shapes import Shape, make_exactly_equal, pick_frames
from der.plotting.space import make_picture
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
from der.probe_series import Probes
from der.run_data import RunData
from der.scene_loads import ActingLoads
from der.sections import directors_along

Array = NDArray[np.float64]
What = Literal["overview", "shapes", "probes"]

_WIDTH = 7.2  # of the figure [inch]
_LEFT = 0.9  # of it, at most, is left of the axes [inch]
_SHAPE_WIDTH = 5.6  # of the axes of the shapes, beside their legend [inch]
_SHAPE_HEIGHT = (1.7, 5.5)  # least and most [inch]


def plot(
    result: RunData,
    what: What = "overview",
    *,
    times: Sequence[float] | None = None,
    probes: Sequence[str] | None = None,
    views: Sequence[str] | None = None,
    scale: float = 1.0,
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
        Views of a run in space, one below the other: ``"3d"``, in perspective, as without it; or
        the axis to the right and the one upwards, such as ``"xz"``. Modes and the shapes of a path
        have one.
    scale
        How many times as large as they are displacements are drawn, from the shape as drawn in the
        scene: for structures so stiff that nothing is seen otherwise. The title says so. Modes have
        a size of their own.
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
        view that is none, or several of modes or of a path, and a scale that is not positive or of
        modes.
    """
    names = _probe_names(result, probes) if what != "shapes" else []
    kind = result.scenario.analysis
    if times is not None and result.scenario.is_static:
        raise ValueError(f"a {kind} run has no time, and so no shapes at times")
    if what == "probes" and not names:
        raise ValueError("the scene has no probes to plot; add some under output.probes")
    if not 0.0 < scale < np.inf:
        raise ValueError(f"the scale of displacements is a positive number, not {scale!r}")
    if scale != 1.0 and kind in ("modes", "buckling"):
        raise ValueError(f"the shapes of a {kind} run have no scale: their size means nothing")
    wanted: Sequence[str | None] = views or [None]
    pictures = [make_picture(result, view, scale) for view in wanted]
    if len(pictures) > 1 and kind in ("continuation", "modes", "buckling"):
        raise ValueError(f"a {kind} run is drawn in one view, not in {len(pictures)}")
    frames = [] if result.scenario.is_static else _frames_to_draw(pictures[0], times)
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
        if scale != 1.0 and what != "probes":
            text += f" (displacements drawn {scale:g} times as large)"
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
    directors: Array | None = None,
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
    directors
        Director 1 of the edges of each shape, shape (shapes, edges, 3), in the model ``spatial``.
    time
        When supports and loads stand as they are drawn [s].
    title
        In place of the scene's title.
    """
    count = len(positions)
    states = RunData(
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
    picture = make_picture(states)
    along = directors_along(states, directors)
    shapes = [
        replace(
            picture.shape(number, colour, label),
            directors=[one if one is None else one[number % len(one)] for one in along],
        )
        for number, (colour, label) in enumerate(zip(time_colours(count), labels, strict=True))
    ]
    with style():
        figure, (axes,) = _figure([_shape_height(picture, shapes)])
        _draw_shape_panel(axes, picture, shapes)
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


def _frames_to_draw(picture: Picture, times: Sequence[float] | None) -> list[int]:
    result = picture.result
    if times is None:
        return pick_frames(result.positions, picture.instants)
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
    heights = [PROBE_HEIGHT] * len(names)
    if what == "probes":
        figure, panels = _figure(heights)
    else:
        seen = [
            [
                picture.shape(frame, colour, _time_label(result, float(result.times[frame])))
                for frame, colour in zip(frames, time_colours(len(frames)), strict=True)
            ]
            for picture in pictures
        ]
        views = [_shape_height(*each) for each in zip(pictures, seen, strict=True)]
        figure, panels = _figure([*views, *heights])
        for picture, shapes in zip(pictures, seen, strict=True):
            _draw_shape_panel(panels.pop(0), picture, shapes)
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
    positions = picture.positions
    path = picture.result.path
    if path is None:
        raise ValueError("the run has found no path to draw")
    branches = np.unique(path.branch)
    shapes = []
    if len(branches) == 1:
        frames = pick_frames(positions, picture.instants)
        for frame, colour in zip(frames, time_colours(len(frames)), strict=True):
            shapes.append(picture.shape(frame, colour, f"load factor {path.factor[frame]:.3g}"))
        figure, (axes,) = _figure([_shape_height(picture, shapes)])
        _draw_shape_panel(axes, picture, shapes)
        return figure
    for branch in branches:
        rows = np.flatnonzero(path.branch == branch)
        first, last = path.factor[rows[0]], path.factor[rows[-1]]
        label: str | None = f"branch {branch}: load factor\n{first:.3g} to {last:.3g}"
        for row in rows[pick_frames(positions[rows], 4)]:
            colour = PALETTE[branch % len(PALETTE)]
            shapes.append(picture.shape(int(row), colour, label))
            label = None
    # At the start, where the branches still are together, and without the loads, which grow.
    start = picture.shape(0, MUTED)
    loads = ActingLoads(foundations=picture.loads(0).foundations)
    figure, (axes,) = _figure([_shape_height(picture, shapes, loads)])
    _draw_shape_panel(axes, picture, shapes, start, loads)
    return figure


def _plot_static(pictures: list[Picture], what: What, names: list[str]) -> Figure:
    result = pictures[0].result
    last = len(result.times) - 1
    table_height = 0.25 + 0.2 * len(names)
    if what == "probes":
        figure, panels = _figure([table_height])
    else:
        label = "equilibrium" if ended_as_asked(result.status) else "where it ended"
        found = [picture.shape(last, time_colours(1)[0], label) for picture in pictures]
        views = [
            _shape_height(picture, [shape]) for picture, shape in zip(pictures, found, strict=True)
        ]
        figure, panels = _figure([*views, *([table_height] if names else [])])
        drawn = result.model.initial_positions
        for picture, shape in zip(pictures, found, strict=True):
            before = replace(shape, positions=drawn, colour=MUTED, label="as drawn", linestyle="--")
            _draw_shape_panel(panels.pop(0), picture, [before, shape])
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


def _solid(shapes: Sequence[Shape]) -> list[Shape]:
    """Return the shapes that the axes have to hold: not the dashed one."""
    return [shape for shape in shapes if shape.linestyle == "-"]


def _shape_height(
    picture: Picture, shapes: Sequence[Shape], loads: ActingLoads | None = None
) -> float:
    """Return the height [inch] at which the shapes fill the width, within bounds."""
    loads = loads or picture.loads(shapes[-1].frame)
    low, high = picture.corners(shapes, loads, (_SHAPE_WIDTH, _SHAPE_HEIGHT[1] - 0.5))
    width, height = high - low
    fitting = _SHAPE_WIDTH * height / max(width, 1e-300) + (0.5 if picture.has_axes else 0.0)
    return float(np.clip(fitting, *_SHAPE_HEIGHT))


def _draw_shape_panel(
    axes: Axes,
    picture: Picture,
    shapes: Sequence[Shape],
    at: Shape | None = None,
    loads: ActingLoads | None = None,
) -> None:
    """Draw shapes, with supports, actuation and loads at one of them: by default the last."""
    at = at or shapes[-1]
    loads = loads or picture.loads(at.frame)
    picture.draw(axes, shapes, at, loads)
    add_actuation_to_legend(axes, picture.actuated, at.frame)
    room = (_SHAPE_WIDTH, _SHAPE_HEIGHT[1] - 0.5)
    low, high = picture.corners(_solid(shapes), loads, room)
    axes.update_datalim(np.array([low, high]))
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.06 if picture.has_axes else 0.0)
    axes.autoscale_view()
    picture.finish(axes, low, high, float(np.max((high - low) / room)) / 72.0)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)


def _write_values(axes: Axes, result: RunData, names: list[str]) -> None:
    axes.set_axis_off()
    lines = [f"{name} = {result.probes[name][-1]:.6g} {result.probes[name].unit}" for name in names]
    axes.text(0.0, 1.0, "\n".join(lines), transform=axes.transAxes, va="top", linespacing=1.4)
