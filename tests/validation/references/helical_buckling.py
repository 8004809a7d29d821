"""Localised helical buckling: a long straight rod whose clamped ends are turned against each
other and brought nearer.

With equal bending stiffnesses EI the angle phi between the tangent and the axis obeys, on an
infinite rod under the torque M and the tension T (Coyne, IEEE J. Oceanic Eng. 15, 1990; van der
Heijden and Thompson, Nonlinear Dynamics 21, 2000),

    cos phi = cos phi0 + (1 - cos phi0) tanh^2(s/w),     M^2 = 2 EI T (1 + cos phi0)
    w = sqrt(2 EI/(T (1 - cos phi0)))

so that the ends come nearer by 2 w (1 - cos phi0), and one turns against the other by
M L/GJ + 2 phi0. (The second term: the tangent goes round the axis at the rate
psi' = M/(EI (1 + cos phi)), and the integral of (1 - cos phi) psi' is 2 phi0.)

The finite rod is a boundary value problem on half of it, started from the closed form: half a turn
about an axis across the rod through its middle, here y, does not change the shape. In the middle
r and d1 lie on that axis, n and m are across it; the end is held.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from .collocation import Boundary, Numbers, Solution, constant_start
from .kirchhoff_rod import UPRIGHT, Held, Rod, directors, problem, quaternion, rotation
from .record import Array, Problem, Reference, exact, refined

LENGTH, BENDING, TWISTING = 100.0, 1.345, 0.789
TURNS, SHORTENING = 27.0, 3.0


@dataclass(frozen=True)
class Infinite:
    """The closed form: largest angle (rad), torque, tension and width of the envelope."""

    angle: float
    torque: float
    tension: float
    width: float


def infinite(turns: float, shortening: float) -> Infinite:
    """The localised shape with these ends."""

    def shape(angle: float) -> Infinite:
        width = 0.5 * shortening / (1.0 - np.cos(angle))
        tension = 2.0 * BENDING / (width**2 * (1.0 - np.cos(angle)))
        torque = np.sqrt(2.0 * BENDING * tension * (1.0 + np.cos(angle)))
        return Infinite(angle, float(torque), float(tension), float(width))

    def miss(angle: float) -> float:
        return shape(angle).torque * LENGTH / TWISTING + 2.0 * angle - 2.0 * np.pi * turns

    return shape(float(brentq(miss, 0.1, 1.5, xtol=1e-15, rtol=1e-15)))


@dataclass(frozen=True)
class Half:
    """The right half of the rod; the collocation is in the units of `rod`."""

    rod: Rod
    solution: Solution
    gap: float

    @property
    def angle(self) -> float:
        """Angle between tangent and axis in the middle."""
        tangent = directors(self.solution.values[0, 3:7, 0])[:, 2]
        return float(np.arccos(tangent[0]))

    @property
    def torque(self) -> float:
        """Moment along the tangent."""
        y = self.solution.values[0, :, 0]
        return float(y[10:13] @ directors(y[3:7])[:, 2] * self.rod.units[10])

    @property
    def tension(self) -> float:
        """Force along the axis."""
        return float(self.solution.values[0, 7, 0] * self.rod.units[7])

    def at(self, s: float) -> Array:
        """Position at the distance `s` from the middle."""
        return np.asarray(
            self.solution.at(np.array([s / self.rod.length]))[:3, 0] * self.rod.length
        )

    @property
    def end_moment(self) -> float:
        """Moment at the clamp along the axis."""
        return float(self.solution.values[-1, 10, -1] * self.rod.units[10])


def half_problem(rod: Rod, turns: float, shortening: float) -> Boundary:
    """From the middle to the held end at x = (length - shortening)/2."""
    middle = Held((0.0, 0.0, 0.0), UPRIGHT)
    turned = rotation((1.0, 0.0, 0.0), np.pi * turns) @ UPRIGHT
    whole = problem(rod, middle, Held((rod.length - 0.5 * shortening, 0.0, 0.0), turned))

    def ends(left: Numbers, right: Numbers, p: Numbers) -> Numbers:
        residual = whole.ends(left, right, p)
        y = left[0]
        d = directors(y[3:7])
        size = (y[3:7] * y[3:7]).sum() - 1.0
        residual[:7] = np.stack([y[0], y[2], d[0, 0], d[2, 0], y[8], y[11], size])
        return residual

    return Boundary(whole.rate, ends)


def start(rod: Rod, boundary: Boundary, closed: Infinite, segments: int, degree: int) -> Solution:
    """The closed form in the middle, carried outward by the equations."""
    tangent = np.array([np.cos(closed.angle), 0.0, np.sin(closed.angle)])
    across = np.array([0.0, 1.0, 0.0])
    spin = closed.torque / (BENDING * (1.0 + np.cos(closed.angle)))
    bend = spin * np.cross([1.0, 0.0, 0.0], tangent)
    moment = BENDING * np.cross(tangent, bend) + closed.torque * tangent
    # In the middle the distance from the axis is such that the force's couple keeps the moment
    # along the axis at the ends: m + T e_x x r has no part across it.
    offset = moment[2] / closed.tension
    frame = np.stack([across, np.cross(tangent, across), tangent], axis=1)
    first = np.concatenate(
        [
            offset * across / rod.length,
            quaternion(frame),
            np.array([closed.tension, 0.0, 0.0]) / rod.units[7],
            moment / rod.units[10],
        ]
    )
    out = constant_start(np.linspace(0.0, 1.0, segments + 1), first, np.zeros(0), degree)
    places = out.points().ravel()
    run = solve_ivp(
        lambda s, y: boundary.rate(0, np.array([s]), y[:, None], np.zeros(0))[:, 0],
        (0.0, 1.0),
        first,
        method="DOP853",
        t_eval=np.unique(places),
        rtol=1e-12,
        atol=1e-13,
    )
    values = run.y[:, np.searchsorted(run.t, places)].reshape(13, segments, -1)
    out.values[:] = values.swapaxes(0, 1)
    return out


def finite(stretching: float, segments: int = 5, degree: int = 28) -> Half:
    """The finite rod with EA = `stretching`."""
    rod = Rod(0.5 * LENGTH, (BENDING, BENDING), TWISTING)
    boundary = half_problem(rod, TURNS, SHORTENING)
    solution = start(rod, boundary, infinite(TURNS, SHORTENING), segments, degree)
    solution = boundary.solve(solution, tolerance=1e-11)
    if np.isfinite(stretching):
        rod = replace(rod, stretching=stretching)
        boundary = half_problem(rod, TURNS, SHORTENING)
        solution = boundary.solve(solution, tolerance=1e-11)
    return Half(rod, solution, boundary.shooting_gap(solution))


def references() -> Problem:
    """Angle, torque and tension, and places on the axis of symmetry and along the rod."""
    closed = infinite(TURNS, SHORTENING)
    values: dict[str, Reference] = {
        "infinite.angle": Reference(closed.angle, 1e-14, "rad", 0.8317, 5e-5),
        "infinite.torque": Reference(closed.torque, 1e-14, "1", 1.3254, 5e-5),
        "infinite.tension": Reference(closed.tension, 1e-14, "1", 0.3902, 5e-5),
        "infinite.width": exact(closed.width, "1"),
    }
    for label, stretching in (("inextensible", np.inf), ("EA1000", 1e3), ("EA10000", 1e4)):
        fine, coarse = finite(stretching, degree=34), finite(stretching)
        for name in ("angle", "torque", "tension", "end_moment"):
            new = refined(
                getattr(fine, name), getattr(coarse, name), "rad" if name == "angle" else "1"
            )
            error_bar = max(new.error, fine.gap, 1e-12)
            values[f"{label}.{name}"] = Reference(new.value, error_bar, new.unit)
        for s in (0.0, 5.0, 10.0, 20.0):
            here, there = fine.at(s), coarse.at(s)
            for k, axis in enumerate("xyz"):
                error_bar = max(2.0 * float(np.abs(here - there).max()), LENGTH * fine.gap, 1e-11)
                values[f"{label}.s{s:g}.{axis}"] = Reference(float(here[k]), error_bar, "1")
    return Problem(
        "helical_buckling",
        "straight rod of length 100, EI 1.345, GJ 0.789, clamped along x; one end turned by 27 "
        "turns against the other, and nearer by 3. infinite: closed form of the infinite rod; "
        "else the finite rod with this EA: angle of the tangent to the axis in the middle, "
        "torque in the rod, tension, moment of the end along x, and positions at distances s "
        "from the middle (x from there; r in the middle is on the y axis)",
        "closed form; Chebyshev collocation on half the rod, degree 34 in 5 segments; error: the "
        "larger of twice the change from degree 28 and the mismatch of shooting",
        values,
    )
