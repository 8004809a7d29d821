"""Answers that share no code with der: elastica, mode shapes, pendulum."""

from __future__ import annotations

import functools

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from .setting import Array

#: First root of cos(x) cosh(x) = -1, and the ratio of its mode shape.
BETA = 1.8751040687119611
_RATIO = (np.cosh(BETA) + np.cos(BETA)) / (np.sinh(BETA) + np.sin(BETA))

#: [rad/s] First vibration of a cantilever with EI = L = mass = 1 that does not stretch.
CANTILEVER = BETA**2


def cantilever_mode(x: Array) -> Array:
    """The shape of that vibration, 1 at the tip."""
    shape = np.cosh(BETA * x) - np.cos(BETA * x) - _RATIO * (np.sinh(BETA * x) - np.sin(BETA * x))
    return np.asarray(shape / 2.0)


@functools.cache
def cantilever_tip(force: float, EA: float) -> tuple[float, float]:
    """Tip of a cantilever of EI = L = 1 along x under a dead force across it.

    The extensible elastica, solved by shooting from the tip: r' = (1 + N/EA) t with the tension N
    along t, EI theta' = M, M' = -(r' x F).
    """

    def rates(s: float, at: Array) -> list[float]:
        theta, moment = at[2], at[3]
        stretch = 1.0 + force * np.sin(theta) / EA
        x, y = stretch * np.cos(theta), stretch * np.sin(theta)
        return [x, y, moment, -x * force]

    def from_tip(theta: float) -> Array:
        path = solve_ivp(rates, (1.0, 0.0), [0, 0, theta, 0], "DOP853", rtol=1e-12, atol=1e-13)
        return np.asarray(path.y[:, -1])

    tip = brentq(lambda theta: from_tip(theta)[2], 0.0, np.pi / 2, xtol=1e-14)
    start = from_tip(float(tip))
    return -float(start[0]), -float(start[1])


@functools.cache
def pendulum_angle(rate_squared: float, start: float, time: float) -> float:
    """Angle from the vertical of theta'' = -rate_squared sin(theta), from rest at `start`."""

    def rates(t: float, at: Array) -> list[float]:
        return [at[1], -rate_squared * np.sin(at[0])]

    path = solve_ivp(rates, (0.0, time), [start, 0.0], "DOP853", rtol=1e-12, atol=1e-13)
    return float(path.y[0, -1])
