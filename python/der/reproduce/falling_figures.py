"""Figures of the falling spheres: problems 1 and 2 of the report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from der.plotting import PALETTE, draw_shapes, time_colours
from der.plotting.shapes import limits
from der.plotting.style import MUTED, time_text
from der.reproduce.falling_exact import FallingChain
from der.reproduce.measurements import NODES, STEPS, WATER, Measurements
from der.reproduce.report_claims import EXPLICIT_SECONDS, IMPLICIT_SECONDS
from der.result import Result

Array = NDArray[np.float64]

#: Times at which the report shows the three spheres [s].
TIMES = (0.0, 0.01, 0.05, 0.1, 1.0, 10.0)

_WIDTH, _HEIGHT = 7.0, 3.7  # of a figure [inch]
_THREE, _MANY, _MORE = PALETTE[0], PALETTE[1], PALETTE[2]
_DISPLACEMENT = "displacement, upward [m]"
_VELOCITY = "velocity, upward [m/s]"


def initial_configuration(m: Measurements) -> Figure:
    """Draw the three spheres at rest."""
    run = m.runs["three"]
    figure, axes = _axes(height=3.0)
    colours = (PALETTE[0], PALETTE[4], PALETTE[2])
    positions = run.positions[0]
    rod = run.rods[0]
    draw_shapes(axes, [rod], positions, "black")
    for i, ((x, y), radius, colour) in enumerate(
        zip(positions, rod.sphere_radii, colours, strict=True)
    ):
        axes.add_patch(Circle((x, y), radius, color=colour, zorder=4))
        axes.annotate(
            f"R{i + 1} = {1e3 * radius:g} mm",
            (x, y + radius),
            xytext=(0, 6),
            textcoords="offset points",
            ha="center",
        )
    _finish_shapes(axes, run, [positions], pad=0.12)
    return figure


def shapes(m: Measurements) -> Figure:
    """Draw the three spheres at the report's times."""
    run = m.runs["three"]
    frames = [int(np.argmin(np.abs(run.times - time))) for time in TIMES]
    figure, axes = _axes(height=5.6)
    for frame, colour in zip(frames, time_colours(len(frames)), strict=True):
        draw_shapes(axes, run.rods, run.positions[frame], colour, time_text(run.times[frame]))
    _finish_shapes(axes, run, [run.positions[frame] for frame in frames])
    _legend_beside(axes)
    return figure


def displacement(m: Measurements) -> Figure:
    """Draw how far the middle sphere falls in 10 s."""
    run, exact = m.runs["three"], m.exact_falls["three"]
    figure, axes = _axes()
    axes.plot(run.times, run.probes["y_mid"], color=_THREE, label="ours, implicit, 0.01 s")
    _mark_exact(axes, exact.times, -exact.fallen)
    _finish(axes, _DISPLACEMENT)
    return figure


def velocity(m: Measurements) -> Figure:
    """Draw the velocity of the middle sphere over 10 s, and where it tends to."""
    run, exact = m.runs["three"], m.exact_falls["three"]
    figure, axes = _axes()
    axes.plot(run.times, run.probes["v_mid"], color=_THREE, label="ours, implicit, 0.01 s")
    _mark_exact(axes, exact.times, -exact.speed)
    axes.axhline(
        -FallingChain(3).terminal_speed, color=MUTED, linestyle="--", label="weight equals drag"
    )
    _finish(axes, _VELOCITY)
    return figure


def equal_spheres_angle(m: Measurements) -> Figure:
    """Draw the turning angle of three equal spheres, at the scale of rounding."""
    run = m.runs["three_equal"]
    figure, axes = _axes()
    axes.plot(run.times, run.probes["angle"], color=_THREE, label="ours")
    rounding = _angle_rounding(run)
    axes.axhspan(
        -rounding,
        rounding,
        color=MUTED,
        alpha=0.15,
        linewidth=0.0,
        label="what rounding of the positions is worth",
    )
    axes.set_ylim(-4.0 * rounding, 4.0 * rounding)
    _finish(axes, "turning angle [rad]")
    return figure


def _angle_rounding(run: Result) -> float:
    """Return what half a unit of the last digit of positions changes a turning angle by [rad]."""
    edge = float(np.diff(run.rods[0].arc_lengths)[0])
    return 4.0 * float(np.spacing(np.abs(run.positions).max())) / edge


def schemes(m: Measurements) -> Figure:
    """Draw the errors in time of both schemes, and what they cost."""
    exact = m.exact_falls["three"]
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(8.4, _HEIGHT), width_ratios=(3, 2), layout="constrained"
    )
    for name, colour, label in (
        ("three", _MANY, "implicit, 0.01 s"),
        ("three_explicit", _THREE, "explicit, 0.00001 s"),
    ):
        error = np.abs(m.runs[name].probes["y_mid"] + exact.fallen)
        left.semilogy(exact.times[1:], error[1:], color=colour, label=label)
    left.set_ylabel("error of the displacement [m]")
    left.set_xlabel("time [s]")
    left.set_title("Against the exact motion")
    left.legend()
    ours = (m.explicit_seconds, m.implicit_seconds)
    theirs = (EXPLICIT_SECONDS.value, IMPLICIT_SECONDS.value)
    places = np.array([1.0, 0.0])
    right.plot(theirs, places, "o", color=MUTED, label="report, about")
    right.plot(ours, places, "o", color=PALETTE[2], label="ours")
    right.set_xscale("log")
    right.set_ylim(-0.6, 1.6)
    right.set_yticks(places, ["explicit", "implicit"])
    right.set_xlabel("wall time of 10 s [s]")
    right.set_title("Cost")
    right.legend(loc="upper center", bbox_to_anchor=(0.4, -0.2), ncols=2)
    return figure


def unstable_angle(m: Measurements) -> Figure:
    """Draw the turning angle that explicit steps of 1e-4 s give."""
    exact = m.exact_start.turning_angle(FallingChain(3).edge)
    return _blow_up(m, "angle", exact, 1e-3, "turning angle [rad]")


def unstable_velocity(m: Measurements) -> Figure:
    """Draw the velocity that explicit steps of 1e-4 s give."""
    return _blow_up(m, "v_mid", -m.exact_start.speed, 1e-2, _VELOCITY)


def unstable_displacement(m: Measurements) -> Figure:
    """Draw the displacement that explicit steps of 1e-4 s give."""
    return _blow_up(m, "y_mid", -m.exact_start.fallen, 1e-4, _DISPLACEMENT)


def _blow_up(m: Measurements, probe: str, exact: Array, linear: float, label: str) -> Figure:
    """Draw a probe of the unstable run against the exact motion; linear to `linear`, then log."""
    run = m.runs["three_unstable"]
    figure, axes = _axes()
    milliseconds = 1e3 * run.times
    axes.plot(
        milliseconds,
        run.probes[probe],
        "o-",
        color=_MANY,
        markersize=3.5,
        label="ours, explicit, 0.0001 s",
    )
    axes.plot(1e3 * m.exact_start.times, exact, color="black", linestyle="--", label="exact")
    axes.set_yscale("symlog", linthresh=linear)
    axes.set_ylabel(label)
    axes.set_xlabel("time [ms]")
    axes.legend()
    return figure


def five_shapes(m: Measurements) -> Figure:
    """Draw 5 nodes over 3 nodes at 10 s."""
    figure, axes = _axes(height=4.6)
    _overlay_shapes(axes, m, "five", "5 nodes", 10.0)
    _legend_beside(axes)
    return figure


def five_velocity(m: Measurements) -> Figure:
    """Draw the velocity with 5 nodes over that with 3."""
    return _overlay(m, "v_mid", "five", "5 nodes", "three", _VELOCITY)


def twenty_one_displacement(m: Measurements) -> Figure:
    """Draw how far the middle sphere of 21 nodes falls in 50 s."""
    return _both_densities(m, "y_mid", _DISPLACEMENT)


def twenty_one_velocity(m: Measurements) -> Figure:
    """Draw its velocity."""
    return _both_densities(m, "v_mid", _VELOCITY)


def twenty_one_shapes(m: Measurements) -> Figure:
    """Draw 21 nodes over 3 nodes at 10 s and at 50 s."""
    figure, panels = plt.subplots(1, 2, figsize=(8.6, 3.5), layout="constrained")
    for axes, time in zip(panels, (10.0, 50.0), strict=True):
        _overlay_shapes(axes, m, "twenty_one", "21 nodes", time)
        axes.set_title(time_text(time))
    # Both panels to one scale.
    tallest = max(np.ptp(axes.get_ylim()) for axes in panels)
    for axes in panels:
        middle = float(np.mean(axes.get_ylim()))
        axes.set_ylim(middle - 0.5 * tallest, middle + 0.5 * tallest)
    _legend_beside(panels[1])
    return figure


def twenty_one_over_three(m: Measurements) -> Figure:
    """Draw the velocity with 21 nodes over that with 3."""
    return _overlay(m, "v_mid", "twenty_one", "21 nodes", "three_long", _VELOCITY)


def fifty_one_over_twenty_one(m: Measurements) -> Figure:
    """Draw displacement and velocity with 51 nodes over those with 21."""
    figure, panels = plt.subplots(2, 1, figsize=(_WIDTH, 5.2), sharex=True, layout="constrained")
    coarse, fine = m.runs["twenty_one"], m.runs["fifty_one"]
    for axes, probe, label in zip(
        panels, ("y_mid", "v_mid"), (_DISPLACEMENT, _VELOCITY), strict=True
    ):
        axes.plot(
            coarse.times,
            coarse.probes[probe],
            color=_MANY,
            linewidth=4,
            alpha=0.5,
            label="21 nodes",
        )
        axes.plot(fine.times, fine.probes[probe], color=_MORE, label="51 nodes")
        axes.set_ylabel(label)
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
        balance = [FallingChain(n, density).terminal_speed for n in NODES]
        axes.semilogx(NODES, balance, color=colour, label=f"weight equals drag, {label}")
        axes.semilogx(
            NODES, speeds, marker, color=colour, markerfacecolor="white", label=f"ours, {label}"
        )
        axes.axhline(
            FallingChain(3, density).many_nodes_speed, color=MUTED, linestyle=":", linewidth=1.0
        )
    axes.plot([], [], color=MUTED, linestyle=":", label="limit of many nodes")
    axes.set_xticks(NODES, [str(n) for n in NODES], minor=False)
    axes.minorticks_off()
    axes.set_xlabel("nodes")
    axes.set_ylabel("speed after 50 s [m/s]")
    axes.margins(y=0.12)
    _legend_below(axes)
    return figure


def terminal_by_step(m: Measurements) -> Figure:
    """Draw the speed after 50 s against the step, and how far it is off."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.9), layout="constrained")
    for density, colour, marker, label in _DENSITY_LOOKS:
        speeds = np.array([m.speeds_by_step[step, density] for step in STEPS])
        balance = FallingChain(21, density).terminal_speed
        look = {"color": colour, "marker": marker, "markerfacecolor": "white", "label": label}
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


def _both_densities(m: Measurements, probe: str, label: str) -> Figure:
    figure, axes = _axes()
    for name, (_, colour, _, what) in zip(
        ("twenty_one", "twenty_one_buoyant"), _DENSITY_LOOKS, strict=True
    ):
        run = m.runs[name]
        axes.plot(run.times, run.probes[probe], color=colour, label=f"21 nodes, {what}")
    _finish(axes, label)
    return figure


def _overlay(m: Measurements, probe: str, name: str, nodes: str, three: str, label: str) -> Figure:
    """Draw a probe of a chain over that of three nodes; with buoyancy it is dashed."""
    figure, axes = _axes()
    under = m.runs[three]
    axes.plot(
        under.times,
        under.probes[probe],
        color=_THREE,
        alpha=0.45,
        linewidth=4.0,
        label="3 nodes, with buoyancy",
    )
    for key, line, what in ((name, "-", "without"), (f"{name}_buoyant", "--", "with")):
        run = m.runs[key]
        axes.plot(
            run.times, run.probes[probe], line, color=_MANY, label=f"{nodes}, {what} buoyancy"
        )
    _finish(axes, label)
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


def _finish_shapes(axes: Axes, run: Result, drawn: Sequence[Array], pad: float = 0.06) -> None:
    _set_limits(axes, *limits(run.rods, drawn), pad)


def _set_limits(axes: Axes, low: Array, high: Array, pad: float = 0.06) -> None:
    margin = pad * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


def _mark_exact(axes: Axes, times: Array, values: Array) -> None:
    some = np.linspace(0, len(times) - 1, 15).round().astype(int)
    axes.plot(
        times[some],
        values[some],
        "o",
        color="black",
        markerfacecolor="white",
        markersize=4.5,
        label="exact",
    )


def _legend_beside(axes: Axes) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)


def _legend_below(axes: Axes) -> None:
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2)
