"""Rods under a force and a moment at the end that turn with it: an initial value problem.

In the axes of the end's section the wrench at the end is known, and so is the rod from there on:
the equations of `kirchhoff_rod.py`, without force along the rod, are integrated from the end to the
start by DOP853. A rigid motion then takes the start to where it is held. No boundary condition is
left to solve for, and nothing is shared with the engine.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from .kirchhoff_rod import UPRIGHT, Rod, Vector
from .record import Array


def held_at_start(
    rod: Rod,
    force: Vector,
    moment: Vector = (0.0, 0.0, 0.0),
    shares: Vector = (1.0,),
    start: Array = UPRIGHT,
) -> Array:
    """Positions at shares of the length, shape (shares, 3), of a rod whose start is held at the
    origin with the frame `start` (columns d1, d2, d3). `force` and `moment` are components along
    the frame of the end."""
    stiffness = np.asarray(rod.stiffness)
    n = np.asarray(force, dtype=float)
    natural = rod.natural

    def slope(s: float, y: Array) -> Array:
        frame, m = y[3:12].reshape(3, 3), y[12:15]
        u = natural(np.array([s]))[:, 0] + frame.T @ m / stiffness
        turning = frame @ np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
        along = (1.0 + n @ frame[:, 2] / rod.stretching) * frame[:, 2]
        return np.concatenate([along, turning.ravel(), np.cross(n, along)])

    first = np.concatenate([np.zeros(3), np.eye(3).ravel(), np.asarray(moment, dtype=float)])
    places = rod.length * np.append(np.asarray(shares, dtype=float), 0.0)
    run = solve_ivp(
        slope,
        (rod.length, 0.0),
        first,
        method="DOP853",
        dense_output=True,
        rtol=1e-12,
        atol=1e-13,
    )
    found = run.sol(places)
    back = start @ found[3:12, -1].reshape(3, 3).T
    return np.asarray((found[:3, :-1] - found[:3, -1:]).T @ back.T, dtype=float)
