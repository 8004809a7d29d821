"""Figures of the loaded tube: problem 3 of the report."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from der.plotting import PALETTE, draw_shapes, draw_supports
from der.plotting.style import LOAD, MUTED
from matplotlib.figure import Figure

from .exact import LOAD_AT, linear_deflection
from .measurements import LOADS, Measurements


def loaded_beam(m: Measurements) -> Figure:
    """Draw the tube at rest under 2 kN, with its supports and its load."""
    run = m.runs["beam"]
    figure, axes = plt.subplots(figsize=(7.0, 2.1), layout="constrained")
    draw_shapes(axes, run.rods, run.positions[0], MUTED, "unloaded", "--")
    shape = run.positions[-1]
    draw_shapes(axes, run.rods, shape, PALETTE[0], "under 2 kN")
    draw_supports(axes, run.rods, run.held_nodes(len(run.times) - 1), shape)
    arc = run.rods[0].arc_lengths
    x, y = (float(np.interp(LOAD_AT, arc, shape[:, axis])) for axis in (0, 1))
    axes.annotate(
        "2 kN",
        (x, y),
        xytext=(x, y + 0.13),
        ha="center",
        color=LOAD,
        arrowprops={"arrowstyle": "-|>", "color": LOAD, "linewidth": 1.8, "shrinkB": 0},
    )
    axes.set_aspect("equal")
    axes.set_xlim(-0.06, 1.06)
    axes.set_ylim(-0.11, 0.16)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.legend(loc="upper left", ncols=2)
    return figure


def deflection_history(m: Measurements) -> Figure:
    """Draw the deflection of the centre node against time, as run and as the equations have it.

    The largest deflection, which the report takes it for, is drawn beside it.
    """
    run, swing = m.runs["beam"], m.runs["beam_swing"]
    figure, axes = plt.subplots(figsize=(7.0, 3.9), layout="constrained")
    axes.plot(
        swing.times,
        -swing.probes["middle"],
        color=PALETTE[5],
        linewidth=1.0,
        label="centre, nothing damped (implicit midpoint, 0.0001 s)",
    )
    axes.plot(
        run.times,
        -run.probes["middle"],
        "o-",
        color=PALETTE[0],
        markersize=3.0,
        label="centre, as in the report (implicit Euler, 0.01 s)",
    )
    axes.plot(
        run.times,
        -run.probes["deflection"],
        color=PALETTE[1],
        linewidth=1.0,
        label="the largest along the tube, likewise",
    )
    exact = m.exact_beams[LOAD_AT][2000.0]
    for value, label in ((exact.middle, "exact, at rest"), (exact.largest, None)):
        axes.axhline(value, color="black", linestyle="--", linewidth=0.8, label=label)
    axes.set_xlim(-0.005, float(swing.times[-1]))
    axes.set_ylim(-0.002, 0.11)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("deflection [m]")
    axes.legend(loc="upper right")
    return figure


def deflection_by_load(m: Measurements) -> Figure:
    """Draw deflection against load, on logarithmic axes, and how far each theory is off."""
    loads = np.array(LOADS)
    exact = np.array([m.exact_beams[LOAD_AT][load].largest for load in LOADS])
    ours = np.array([m.deflections[load].value for load in LOADS])
    linear = np.array([linear_deflection(load) for load in LOADS])
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.8, 4.2), layout="constrained")
    left.loglog(loads, linear, color=MUTED, linestyle="--", label="Euler-Bernoulli")
    left.loglog(loads, exact, color="black", linewidth=1.0, label="exact elastica")
    left.loglog(loads, ours, "o", color=PALETTE[0], markerfacecolor="white", label="ours")
    left.set_ylabel("largest deflection [m]")
    left.legend()
    right.loglog(
        loads, linear / exact - 1.0, "s--", color=MUTED, markersize=4, label="Euler-Bernoulli"
    )
    right.loglog(
        loads,
        np.abs(ours / exact - 1.0),
        "o-",
        color=PALETTE[0],
        markerfacecolor="white",
        label="ours",
    )
    error_bars = np.array([m.deflections[load].error_bar for load in LOADS])
    right.loglog(loads, error_bars / exact, ":", color=PALETTE[0], label="our error bar")
    right.set_ylabel("relative error [-]")
    right.legend()
    for axes in (left, right):
        axes.set_xlabel("load [N]")
    return figure
