"""Figures of the falling spheres: problems 1 and 2 of the report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from der.plotting import PALETTE, draw_shapes, time_colours
from der.plotting.shapes import limits
from der.plotting.style import MUTED, time_text
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray
from references.falling_spheres import Fall, FallingRod

from . import exact
from .comparison import EXPLICIT_SECONDS, IMPLICIT_SECONDS
from .measurements import NODES, STEPS, WATER, Measurements

Array = NDArray[np.float64]
Look = dict[str, Any]

#: Times at which the report shows the three spheres [s].
TIMES = (0.0, 0.01, 0.05, 0.1, 1.0, 10.0)

_WIDTH, _HEIGHT = 7.0, 3.7  # of a figure [inch]
_THREE, _MANY, _MORE = PALETTE[0], PALETTE[1], PALETTE[2]
_LABELS = {
    "y_mid": "displacement, upward [m]",
    "v_mid": "velocity, upward [m/s]",
    "angle": "turning angle [rad]",
}
_LINEAR = {"y_mid": 1e-4, "v_mid": 1e-2, "angle": 1e-3}  # of axes that are logarithmic beyond


def initial_configuration(m: Measurements) -> Figure:
    """Draw the three spheres at rest."""
    run = m.runs["three"]
    figure, axes = _axes(height=3.0)
    colours = (PALETTE[0], PALETTE[4], PALETTE[2])
    positions = run.positions[0]
    rod = run.rods[0]
    draw_shapes(axes, [rod], positions, "black")
    above: Look = {"xytext": (0, 6), "textcoords": "offset points", "ha": "center"}
    for i, ((x, y), radius) in enumerate(zip(positions, rod.sphere_radii, strict=True)):
        axes.add_patch(Circle((x, y), radius, color=colours[i], zorder=4))
        axes.annotate(f"R{i + 1} = {1e3 * radius:g} mm", (x, y + radius), **above)
    _set_limits(axes, *limits(run.rods, [positions]), pad=0.12)
    return figure


def over_time(m: Measurements, probe: str) -> Figure:
    """Draw a probe of the middle sphere over 10 s, and of its velocity where it tends to."""
    run, true = m.runs["three"], m.exact_falls["three"]
    figure, axes = _axes()
    axes.plot(run.times, run.probes[probe], color=_THREE, label="ours, implicit, 0.01 s")
    some = np.linspace(0, len(true.times) - 1, 15).round().astype(int)
    look: Look = {"color": "black", "markerfacecolor": "white", "markersize": 4.5, "label": "exact"}
    axes.plot(true.times[some], _exact(true, probe)[some], "o", **look)
    if probe == "v_mid":
        balance = FallingRod().terminal_velocity()
        axes.axhline(balance, color=MUTED, linestyle="--", label="weight equals drag")
    _finish(axes, _LABELS[probe])
    return figure


def _exact(motion: Fall, probe: str) -> Array:
    """Return the exact values of a probe."""
    if probe == "angle":
        return exact.turning_angle(motion, FallingRod().edge)
    return -(exact.fallen(motion) if probe == "y_mid" else exact.speed(motion))


def shapes(m: Measurements) -> Figure:
    """Draw the three spheres at the report's times."""
    run = m.runs["three"]
    frames = [int(np.argmin(np.abs(run.times - time))) for time in TIMES]
    figure, axes = _axes(height=5.6)
    for frame, colour in zip(frames, time_colours(len(frames)), strict=True):
        draw_shapes(axes, run.rods, run.positions[frame], colour, time_text(run.times[frame]))
    _set_limits(axes, *limits(run.rods, [run.positions[frame] for frame in frames]))
    _legend_beside(axes)
    return figure


def equal_spheres_angle(m: Measurements) -> Figure:
    """Draw the turning angle of three equal spheres, at the scale of rounding."""
    run = m.runs["three_equal"]
    figure, axes = _axes()
    axes.plot(run.times, run.probes["angle"], color=_THREE, label="ours")
    # What half a unit of the last digit of positions changes a turning angle by [rad].
    edge = float(np.diff(run.rods[0].arc_lengths)[0])
    rounding = 4.0 * float(np.spacing(np.abs(run.positions).max())) / edge
    band: Look = {
        "alpha": 0.15,
        "linewidth": 0.0,
        "label": "what rounding of the positions is worth",
    }
    axes.axhspan(-rounding, rounding, color=MUTED, **band)
    axes.set_ylim(-4.0 * rounding, 4.0 * rounding)
    _finish(axes, _LABELS["angle"])
    return figure


def schemes(m: Measurements) -> Figure:
    """Draw the errors in time of both schemes, and what they cost."""
    true = m.exact_falls["three"]
    size: Look = {"figsize": (8.4, _HEIGHT), "width_ratios": (3, 2)}
    figure, (left, right) = plt.subplots(1, 2, layout="constrained", **size)
    implicit = ("three", _MANY, "implicit, 0.01 s")
    explicit = ("three_explicit", _THREE, "explicit, 0.00001 s")
    for name, colour, label in (implicit, explicit):
        error = np.abs(m.runs[name].probes["y_mid"] + exact.fallen(true))
        left.semilogy(true.times[1:], error[1:], color=colour, label=label)
    left.set_ylabel("error of the displacement [m]")
    left.set_xlabel("time [s]")
    left.set_title("Against the exact motion")
    left.legend()
    ours = (m.explicit_seconds, m.implicit_seconds)
    places = np.array([1.0, 0.0])
    right.plot(
        (EXPLICIT_SECONDS, IMPLICIT_SECONDS), places, "o", color=MUTED, label="report, about"
    )
    right.plot(ours, places, "o", color=PALETTE[2], label="ours")
    right.set_xscale("log")
    right.set_ylim(-0.6, 1.6)
    right.set_yticks(places, ["explicit", "implicit"])
    right.set_xlabel("wall time of 10 s [s]")
    right.set_title("Cost")
    right.legend(loc="upper center", bbox_to_anchor=(0.4, -0.2), ncols=2)
    return figure


def blow_up(m: Measurements, probe: str) -> Figure:
    """Draw a probe of the unstable run against the exact motion."""
    run, true = m.runs["three_unstable"], m.exact_start
    figure, axes = _axes()
    look: Look = {"color": _MANY, "markersize": 3.5, "label": "ours, explicit, 0.0001 s"}
    axes.plot(1e3 * run.times, run.probes[probe], "o-", **look)
    axes.plot(1e3 * true.times, _exact(true, probe), color="black", linestyle="--", label="exact")
    axes.set_yscale("symlog", linthresh=_LINEAR[probe])
    axes.set_ylabel(_LABELS[probe])
    axes.set_xlabel("time [ms]")
    axes.legend()
    return figure


def chain_shapes(m: Measurements, name: str, nodes: str, times: Sequence[float]) -> Figure:
    """Draw a chain over 3 nodes, with a panel for each time, all to one scale."""
    size = (_WIDTH, 4.6) if len(times) == 1 else (8.6, 3.5)
    figure, grid = plt.subplots(1, len(times), figsize=size, layout="constrained", squeeze=False)
    panels = grid[0]
    for axes, time in zip(panels, times, strict=True):
        _overlay_shapes(axes, m, name, nodes, time)
        if len(times) > 1:
            axes.set_title(time_text(time))
    tallest = max(np.ptp(axes.get_ylim()) for axes in panels)
    for axes in panels:
        middle = float(np.mean(axes.get_ylim()))
        axes.set_ylim(middle - 0.5 * tallest, middle + 0.5 * tallest)
    _legend_beside(panels[-1])
    return figure


def fifty_one_over_twenty_one(m: Measurements) -> Figure:
    """Draw displacement and velocity with 51 nodes over those with 21."""
    figure, panels = plt.subplots(2, 1, figsize=(_WIDTH, 5.2), sharex=True, layout="constrained")
    coarse, fine = m.runs["twenty_one"], m.runs["fifty_one"]
    under: Look = {"color": _MANY, "linewidth": 4, "alpha": 0.5, "label": "21 nodes"}
    for axes, probe in zip(panels, ("y_mid", "v_mid"), strict=True):
        axes.plot(coarse.times, coarse.probes[probe], **under)
        axes.plot(fine.times, fine.probes[probe], color=_MORE, label="51 nodes")
        axes.set_ylabel(_LABELS[probe])
        axes.margins(x=0.01)
    panels[0].legend()
    panels[1].set_xlabel("time [s]")
    figure.align_ylabels()
    return figure


def terminal_by_nodes(m: Measurements) -> Figure:
    """Draw the speed after 50 s against the number of nodes."""
    figure, axes = _axes()
    for density, colour, marker, label in _DENSITY_LOOKS:
        speeds = [m.speeds_by_nodes[n, density] for n in NODES]
        balance = [exact.terminal_speed(FallingRod(n, density)) for n in NODES]
        axes.semilogx(NODES, balance, color=colour, label=f"weight equals drag, {label}")
        look: Look = {"color": colour, "markerfacecolor": "white", "label": f"ours, {label}"}
        axes.semilogx(NODES, speeds, marker, **look)
        limit = exact.many_nodes_speed(FallingRod(3, density))
        axes.axhline(limit, color=MUTED, linestyle=":", linewidth=1.0)
    axes.plot([], [], color=MUTED, linestyle=":", label="limit of many nodes")
    axes.set_xticks(NODES, [str(n) for n in NODES], minor=False)
    axes.minorticks_off()
    axes.set_xlabel("nodes")
    axes.set_ylabel("speed after 50 s [m/s]")
    axes.margins(y=0.12)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2)
    return figure


def terminal_by_step(m: Measurements) -> Figure:
    """Draw the speed after 50 s against the step, and how far it is off."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.9), layout="constrained")
    for density, colour, marker, label in _DENSITY_LOOKS:
        speeds = np.array([m.speeds_by_step[step, density] for step in STEPS])
        balance = exact.terminal_speed(FallingRod(21, density))
        look: Look = {"color": colour, "marker": marker, "markerfacecolor": "white", "label": label}
        left.semilogx(STEPS, speeds, **look)
        # At the level of rounding there is nothing to tell; the floor keeps it on the axes.
        off = np.maximum(np.abs(speeds / balance - 1.0), float(np.finfo(float).eps))
        right.loglog(STEPS, off, **look)
    left.set_ylim(0.0, 0.008)
    left.set_ylabel("speed after 50 s [m/s]")
    right.set_ylabel("relative distance to the terminal speed [-]")
    for axes in (left, right):
        axes.set_xlabel("step [s]")
    left.legend(loc="lower left")
    return figure


_DENSITY_LOOKS: Sequence[tuple[float, Any, str, str]] = (
    (0.0, _MANY, "o", "without buoyancy"),
    (WATER, _THREE, "s", "with buoyancy"),
)


def both_densities(m: Measurements, probe: str) -> Figure:
    """Draw a probe of 21 nodes over 50 s, without buoyancy and with it."""
    figure, axes = _axes()
    names = ("twenty_one", "twenty_one_buoyant")
    for name, (_, colour, _, what) in zip(names, _DENSITY_LOOKS, strict=True):
        run = m.runs[name]
        axes.plot(run.times, run.probes[probe], color=colour, label=f"21 nodes, {what}")
    _finish(axes, _LABELS[probe])
    return figure


def chain_velocity(m: Measurements, name: str, nodes: str, three: str) -> Figure:
    """Draw the velocity of a chain over that of three nodes; with buoyancy it is dashed."""
    figure, axes = _axes()
    under: Look = {
        "color": _THREE,
        "alpha": 0.45,
        "linewidth": 4.0,
        "label": "3 nodes, with buoyancy",
    }
    axes.plot(m.runs[three].times, m.runs[three].probes["v_mid"], **under)
    for key, line, what in ((name, "-", "without"), (f"{name}_buoyant", "--", "with")):
        run, label = m.runs[key], f"{nodes}, {what} buoyancy"
        axes.plot(run.times, run.probes["v_mid"], line, color=_MANY, label=label)
    _finish(axes, _LABELS["v_mid"])
    return figure


def _overlay_shapes(axes: Axes, m: Measurements, name: str, nodes: str, time: float) -> None:
    corners = []
    for key, colour, label, line in (
        ("three_long", _THREE, "3 nodes,\nwith buoyancy", "-"),
        (name, _MANY, f"{nodes},\nwithout buoyancy", "-"),
        (f"{name}_buoyant", _MANY, f"{nodes},\nwith buoyancy", "--"),
    ):
        run = m.runs[key]
        positions = run.positions[int(np.argmin(np.abs(run.times - time)))]
        draw_shapes(axes, run.rods, positions, colour, label, line)
        corners.append(limits(run.rods, [positions]))
    low, high = np.min(corners, axis=0)[0], np.max(corners, axis=0)[1]
    _set_limits(axes, low, high)


def _axes(height: float = _HEIGHT) -> tuple[Figure, Axes]:
    return plt.subplots(figsize=(_WIDTH, height), layout="constrained")


def _finish(axes: Axes, label: str) -> None:
    axes.set_xlabel("time [s]")
    axes.set_ylabel(label)
    axes.margins(x=0.01)
    axes.legend()


def _set_limits(axes: Axes, low: Array, high: Array, pad: float = 0.06) -> None:
    margin = pad * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


def _legend_beside(axes: Axes) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
