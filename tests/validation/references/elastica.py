"""The inextensible planar elastica: EI theta'' + (forces) = 0, x' = cos theta, y' = sin theta.

Cantilever with a dead tip load P across it (Bisshopp and Drucker, Quart. Appl. Math. 3,
1945). With theta_L the tip angle, p = sqrt((1 + sin theta_L) / 2), phi_0 = asin(1/(p sqrt 2)):

    sqrt(P L^2 / EI) = K(p) - F(phi_0, p) =: a
    y_tip / L = 1 - 2/a (E(p) - E(phi_0, p)),      x_tip / L = 2 p cos(phi_0) / a

Buckled column (Timoshenko and Gere, Theory of Elastic Stability, 2.7; Love, 262-263), k the
sine of half the largest angle to the line of thrust:

    P / Pcr = (2 K(k) / pi)^2,   end distance / L = 2 E(k)/K(k) - 1

and the largest deflection is k/K(k) L for both ends pinned (at the middle) and for both ends
clamped (at the middle; four quarter waves), 2 k/K(k) L for one end clamped and one free (at
the tip). Pcr = pi^2 EI/L^2, 4 pi^2 EI/L^2, pi^2 EI/(4 L^2).

Heavy cantilever, clamped horizontally, weight q a unit length (no closed form):

    EI theta'' = -q (L - s) cos theta,   theta(0) = 0,   theta'(L) = 0,   theta positive downward

solved by Chebyshev collocation (`collocation.py`) with continuation in q from the straight rod.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import mpmath as mp
import numpy as np

from .collocation import Boundary, Numbers, Solution, constant_start
from .record import Array, Problem, Reference, exact, refined

_DIGITS = 40
Ends = Literal["pinned-pinned", "clamped-free", "clamped-clamped"]


@dataclass(frozen=True)
class Tip:
    """Tip of a cantilever of length 1: position (x along the wall's normal, y in the load's
    direction) and angle (rad) to the undeformed axis.
    """

    x: float
    y: float
    angle: float


def tip_loaded_cantilever(load: float) -> Tip:
    """Cantilever under a dead transverse tip load, `load` = P L^2 / EI > 0. Exact."""
    if not load > 0.0:
        raise ValueError(f"load is P L^2/EI and must be positive, got {load}")
    with mp.workdps(_DIGITS):
        root = mp.sqrt(mp.mpf(load))

        def start_angle(p: Any) -> Any:
            return mp.asin(1 / (p * mp.sqrt(2)))

        # p = 1 - exp(-z): the modulus nears 1 exponentially as the load grows.
        def mismatch(z: Any) -> Any:
            p = 1 - mp.exp(-z)
            first = mp.ellipk(p**2) - mp.ellipf(start_angle(p), p**2)
            return first - root

        low = -mp.log(1 - 1 / mp.sqrt(2)) + mp.mpf(10) ** (-25)
        high = 2 * root + 10
        z = mp.findroot(mismatch, (low, high), solver="anderson", tol=mp.mpf(10) ** -60)
        p = 1 - mp.exp(-z)
        phi = start_angle(p)
        second = mp.ellipe(p**2) - mp.ellipe(phi, p**2)
        return Tip(
            float(2 * p * mp.cos(phi) / root),
            float(1 - 2 / root * second),
            float(mp.asin(2 * p**2 - 1)),
        )


@dataclass(frozen=True)
class Buckled:
    """Post-buckled column of length 1: loss of end distance, largest deflection and largest
    angle (rad) to the line of thrust.
    """

    shortening: float
    deflection: float
    angle: float


def buckled_column(ratio: float, ends: Ends) -> Buckled:
    """First buckled branch at P = `ratio` times the critical load of `ends`. Exact."""
    if not ratio > 1.0:
        raise ValueError(f"ratio is P/Pcr and must exceed 1, got {ratio}")
    with mp.workdps(_DIGITS):
        target = mp.sqrt(mp.mpf(ratio)) * mp.pi / 2
        modulus2 = mp.findroot(
            lambda m: mp.ellipk(m) - target, (mp.mpf(10) ** -20, 1 - mp.mpf(10) ** -30),
            solver="anderson",
        )  # fmt: skip
        k = mp.sqrt(modulus2)
        first, second = mp.ellipk(modulus2), mp.ellipe(modulus2)
        rise = k / first * (2 if ends == "clamped-free" else 1)
        return Buckled(float(2 - 2 * second / first), float(rise), float(2 * mp.asin(k)))


def critical_load(ends: Ends) -> float:
    """Euler's critical load in units of EI/L^2."""
    waves = {"pinned-pinned": 1.0, "clamped-free": 0.5, "clamped-clamped": 2.0}[ends]
    return (waves * np.pi) ** 2


def heavy_cantilever_problem(weight: float) -> Boundary:
    """Components x, y (down), theta, theta' on two segments; `weight` = rho g A L^3 / EI."""

    def rate(_k: int, s: Array, y: Numbers, _p: Numbers) -> Numbers:
        theta, bend = y[2], y[3]
        return np.stack([np.cos(theta), np.sin(theta), bend, -weight * (1.0 - s) * np.cos(theta)])

    def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
        return np.concatenate([left[0, :3], right[1, 3:], right[0] - left[1]])

    return Boundary(rate, ends)


def heavy_cantilever_shape(weight: float, degree: int = 64) -> Solution:
    """Shape of the heavy cantilever, reached from the straight rod by raising the weight.

    Two segments meet where the boundary layer at the clamp, of width weight^(-1/2), has died.
    """
    solution = constant_start(np.array([0.0, 0.25, 1.0]), np.zeros(4), np.zeros(0), degree)
    steps = max(1, int(np.ceil(4.0 * np.log1p(weight))))
    for level in np.expm1(np.linspace(0.0, np.log1p(weight), steps + 1))[1:]:
        solution = heavy_cantilever_problem(float(level)).solve(solution)
    return solution


def heavy_cantilever(weight: float, degree: int = 64) -> Tip:
    """Tip of the heavy cantilever (y and angle positive downward)."""
    x, y, angle, _bend = heavy_cantilever_shape(weight, degree).values[-1, :, -1]
    return Tip(float(x), float(y), float(angle))


def references() -> Problem:
    """All reference numbers of the elastica (lengths in units of L)."""
    values: dict[str, Reference] = {}
    for load in (0.5, 1.0, 2.0, 5.0, 10.0, 100.0):
        tip = tip_loaded_cantilever(load)
        values[f"tip_load.{load:g}.x"] = exact(tip.x, "L")
        values[f"tip_load.{load:g}.y"] = exact(tip.y, "L")
        values[f"tip_load.{load:g}.angle"] = exact(tip.angle, "rad")
    columns: tuple[Ends, ...] = ("pinned-pinned", "clamped-free", "clamped-clamped")
    for ends in columns:
        values[f"critical.{ends}"] = exact(critical_load(ends), "EI/L^2")
        for ratio in (1.02, 1.1, 1.5, 2.0):
            shape = buckled_column(ratio, ends)
            label = f"buckled.{ends}.{ratio:g}"
            values[f"{label}.shortening"] = exact(shape.shortening, "L")
            values[f"{label}.deflection"] = exact(shape.deflection, "L")
            values[f"{label}.angle"] = exact(shape.angle, "rad")
    for weight in (1.0, 10.0, 100.0, 1000.0):
        fine, coarse = heavy_cantilever(weight, 80), heavy_cantilever(weight, 60)
        label = f"self_weight.{weight:g}"
        values[f"{label}.x"] = refined(fine.x, coarse.x, "L", 1e-13)
        values[f"{label}.y"] = refined(fine.y, coarse.y, "L", 1e-13)
        values[f"{label}.angle"] = refined(fine.angle, coarse.angle, "rad", 1e-13)
    return Problem(
        "elastica",
        "inextensible planar elastica of length 1: cantilever with dead tip load PL^2/EI, "
        "buckled columns at P/Pcr, heavy cantilever with rho g A L^3/EI; y along the load",
        "elliptic integrals with 40 digits; self weight by Chebyshev collocation, degree 80, "
        "error: twice the change from degree 60",
        values,
    )
