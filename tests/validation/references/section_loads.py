"""Rods under forces and moments at several places: an initial value problem.

The wrenches at all places are given in the axes of the section there. The rod is then known from
its free end on: the equations of `kirchhoff_rod.py` are integrated from the end to the start by
DOP853, each place adding its wrench. A rigid motion takes the start to where it is held, and with
it the sections at the places: what a load of a fixed direction is in space follows from there. No
boundary condition is left to solve for, and nothing is shared with the engine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

from .kirchhoff_rod import UPRIGHT, Rod
from .record import Array


@dataclass(frozen=True)
class Wrench:
    """At the arc length s, along d1, d2, d3 of the section there. At a corner it is that before the
    corner, and `corner` has the directors and the tangent beyond it in its columns, along those
    before it."""

    s: float
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)
    moment: tuple[float, float, float] = (0.0, 0.0, 0.0)
    corner: Array = field(default_factory=lambda: np.eye(3))


def held_at_start(
    rod: Rod, wrenches: Sequence[Wrench], start: Array = UPRIGHT
) -> tuple[Array, Array, Array]:
    """The end, shape (3,), and the positions and the frames (columns d1, d2, d3) at the places of
    the wrenches, in their order along the rod, the last of them at the end."""
    stiffness = np.asarray(rod.stiffness)

    def slope(s: float, y: Array) -> Array:
        frame, n, m = y[3:12].reshape(3, 3), y[12:15], y[15:18]
        u = rod.natural(np.array([s]))[:, 0] + frame.T @ m / stiffness
        turning = frame @ np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
        along = (1.0 + n @ frame[:, 2] / rod.stretching) * frame[:, 2]
        return np.concatenate([along, turning.ravel(), np.zeros(3), np.cross(n, along)])

    y = np.concatenate([np.zeros(3), np.eye(3).ravel(), np.zeros(6)])
    positions: list[Array] = []
    frames: list[Array] = []
    places = sorted(wrenches, key=lambda wrench: wrench.s, reverse=True)
    assert places[0].s == rod.length
    for wrench, before in zip(places, [*(place.s for place in places[1:]), 0.0], strict=True):
        frame = y[3:12].reshape(3, 3) @ wrench.corner.T
        y[3:12] = frame.ravel()
        y[12:15] += frame @ wrench.force
        y[15:18] += frame @ wrench.moment
        positions.insert(0, y[:3].copy())
        frames.insert(0, frame.copy())
        run = solve_ivp(slope, (wrench.s, before), y, method="DOP853", rtol=1e-12, atol=1e-13)
        y = run.y[:, -1].copy()
    back = start @ y[3:12].reshape(3, 3).T
    there = (np.array(positions) - y[:3]) @ back.T
    return there[-1], there, back @ np.array(frames)
