"""Snap-through under a dead load at the middle: a shallow arch and a pushed buckled beam.

Rod as in `extensible_beam.py`, with natural curvature: energy 1/2 EA eps^2 +
1/2 EI (theta' - k0)^2 per rest length, no other load. Lengths in units of the span of the
arch (of the straight beam's length for the buckled beam), forces in EI/length^2, so that EI = 1
and EA = `stretching`.

    arch      stress-free circular arc through (0, 0), (1/2, rise), (1, 0); both ends pinned
    buckled   straight beam of length 1 whose ends, pinned or clamped, are 1 - shortening
              apart, buckled upward

A shape symmetric about the middle is held on its left half, 0 <= s <= l/2, with

    x(0) = y(0) = 0, moment(0) = 0 or theta(0) = 0;   x(l/2) = half the span, theta(l/2) = 0

and n_y = -load/2 (load positive down). The curve (shape, n_x, load) is followed with
`continuation.py`; a limit load is where the load turns. The symmetric shape loses its
stability to a skew one where the linearised problem has a skew solution,

    dx(0) = dy(0) = 0, dmoment(0) or dtheta(0) = 0;   dy(l/2) = dmoment(l/2) = 0,   dn_x = 0

found as a zero of its determinant: a bifurcation. Under a dead load the rod snaps at whichever
comes first.

Each half of the clamped buckled beam has equal conditions at its ends but for the load (theta = 0),
so that its shape is unchanged by half a turn about its quarter point s = 1/4:

    x(1/4) = span/4,   moment(1/4) = 0

It loses this symmetry, but not that about the middle, where the linearised problem has a solution
with dtheta(1/4) = 0 and dx(0) = dy(0) = dtheta(0) = 0, dn_x = 0: the load does no work on it. In
the theory of small slopes that is at a thrust of 16 pi^2, wherever the load is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from .collocation import Boundary, Numbers, Solution, constant_start
from .continuation import Curve, Point
from .extensible_beam import rod_rate
from .record import Array, Problem, Reference

Ends = Literal["pinned", "clamped"]


@dataclass(frozen=True)
class Snap:
    """A symmetric snap-through problem (lengths and forces as above)."""

    stretching: float
    curvature: float  # natural, of the arc; negative turns the rod downward
    span: float
    ends: Ends
    start: Solution
    height: float  # of the middle, before the load

    def _rate(self, y: Numbers, nx: Numbers, ny: Numbers) -> Numbers:
        rates = rod_rate(y, nx, ny, self.stretching)
        rates[2] = rates[2] + self.curvature
        return rates

    @property
    def held(self) -> int:
        """The component besides x and y that is zero at the end."""
        return 3 if self.ends == "pinned" else 2

    def problem(self) -> Boundary:
        """The curve; parameters n_x and load."""

        def rate(_k: int, _s: Array, y: Numbers, p: Numbers) -> Numbers:
            return self._rate(y, p[0], -0.5 * p[1])

        def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
            fixed = [left[0, 0], left[0, 1], left[0, self.held]]
            return np.array([*fixed, right[0, 0] - 0.5 * self.span, right[0, 2]])

        return Boundary(rate, ends)

    def skew_determinant(self, point: Point) -> tuple[float, float]:
        """Sign and logarithm of the determinant of the skew linearised problem."""
        nx = point.solution.parameters[0]

        def rate(_k: int, _s: Array, y: Numbers, p: Numbers) -> Numbers:
            return self._rate(y, nx, p[0])

        def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
            fixed = [left[0, 0], left[0, 1], left[0, self.held]]
            return np.array([*fixed, right[0, 1], right[0, 3]])

        symmetric = replace(point.solution, parameters=-0.5 * point.solution.parameters[1:])
        _, jacobian = Boundary(rate, ends).residual(symmetric)
        sign, size = np.linalg.slogdet(jacobian)
        return float(sign), float(size)

    def quarter(self) -> Curve:
        """The curve of a quarter of a clamped beam; parameters n_x and load."""

        def rate(_k: int, _s: Array, y: Numbers, p: Numbers) -> Numbers:
            return self._rate(y, p[0], -0.5 * p[1])

        def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
            return np.array([*left[0, :3], right[0, 0] - 0.25 * self.span, right[0, 3]])

        return Curve(Boundary(rate, ends), np.array([100.0, 100.0]))

    def half_turn_determinant(self, point: Point) -> tuple[float, float]:
        """Sign and logarithm of the determinant of the problem linearised about a quarter, for
        shapes that half a turn about its end changes.
        """
        nx, load = point.solution.parameters

        def rate(_k: int, _s: Array, y: Numbers, _p: Numbers) -> Numbers:
            return self._rate(y, nx, -0.5 * load)

        def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
            return np.array([*left[0, :3], right[0, 2]])

        _, jacobian = Boundary(rate, ends).residual(replace(point.solution, parameters=np.zeros(0)))
        sign, size = np.linalg.slogdet(jacobian)
        return float(sign), float(size)

    def half_turn_bifurcations(self) -> list[Event]:
        """Where the symmetric curve of a clamped beam loses its symmetry under half a turn."""
        degree = self.start.values.shape[2] - 1
        start = constant_start(np.array([0.0, 0.25]), np.zeros(4), self.start.parameters, degree)
        start.values[0] = self.start.at(start.points()[0])
        curve = self.quarter()

        def drop(point: Point) -> float:
            return self.height - 2.0 * float(point.solution.values[0, 1, -1])

        points = curve.trace(
            curve.begin(start, np.array([0.0, 1.0])), 0.05, lambda p: drop(p) > 2.3 * self.height
        )
        _, reference = self.half_turn_determinant(points[0])

        def broken(point: Point) -> float:
            sign, size = self.half_turn_determinant(point)
            return sign * float(np.exp(size - reference))

        return [
            Event(float(p.solution.parameters[1]), drop(p), -float(p.solution.parameters[0]))
            for p in curve.zeros(points, broken)
        ]

    def drop(self, point: Point) -> float:
        """How far the load has pushed the middle down."""
        return self.height - float(point.solution.values[0, 1, -1])

    def follow(self) -> Path:
        """The curve from the unloaded shape until the middle is 2.3 heights down."""
        curve = Curve(self.problem(), np.array([100.0, 100.0]))
        begin = curve.begin(self.start, np.array([0.0, 1.0]))
        points = curve.trace(begin, 0.05, lambda point: self.drop(point) > 2.3 * self.height)
        _, reference = self.skew_determinant(begin)

        def skew(point: Point) -> float:
            sign, size = self.skew_determinant(point)
            return sign * float(np.exp(size - reference))

        return Path(
            [self._event(p) for p in points],
            [self._event(p) for p in curve.zeros(points, lambda point: point.rate(1))],
            [self._event(p) for p in curve.zeros(points, skew)],
            self.half_turn_bifurcations() if self.ends == "clamped" else [],
            max(curve.problem.shooting_gap(p.solution) for p in points[:: len(points) // 6]),
        )

    def _event(self, point: Point) -> Event:
        thrust, load = point.solution.parameters
        return Event(float(load), self.drop(point), float(-thrust))


@dataclass(frozen=True)
class Event:
    """A point of the curve: load (down), drop of the middle, horizontal thrust at the ends."""

    load: float
    drop: float
    thrust: float


@dataclass(frozen=True)
class Path:
    """The symmetric curve in order, its limit points, its bifurcations to skew shapes and those to
    symmetric ones; `shooting_gap` is an independent error of coordinates on it.
    """

    points: list[Event]
    limits: list[Event]
    bifurcations: list[Event]
    symmetric_bifurcations: list[Event]
    shooting_gap: float


def circular_arch(rise: float, stretching: float, degree: int = 40) -> Snap:
    """Pinned, stress-free circular arch of span 1."""
    radius = (0.25 + rise**2) / (2.0 * rise)
    slope = float(np.arcsin(0.5 / radius))
    length = 2.0 * radius * slope
    start = constant_start(np.array([0.0, 0.5 * length]), np.zeros(4), np.zeros(2), degree)
    theta = slope - start.points() / radius
    start.values[:, 0] = radius * (np.sin(slope) - np.sin(theta))
    start.values[:, 1] = radius * (np.cos(theta) - np.cos(slope))
    start.values[:, 2] = theta
    return Snap(stretching, -1.0 / radius, 1.0, "pinned", start, rise)


def buckled_beam(shortening: float, stretching: float, ends: Ends, degree: int = 40) -> Snap:
    """Straight beam of length 1 buckled upward by moving its ends together."""
    critical = np.pi**2 if ends == "pinned" else 4.0 * np.pi**2
    if shortening * stretching <= critical:
        raise ValueError(f"a shortening of {shortening:g} does not buckle this beam")
    # The start: the first mode, of the amplitude that takes up the length.
    amplitude = 2.0 / np.pi * np.sqrt(shortening - critical / stretching)
    flat = constant_start(np.array([0.0, 0.5]), np.zeros(4), np.array([-critical, 0.0]), degree)
    s = flat.points()
    waves = np.pi * s if ends == "pinned" else 2.0 * np.pi * s
    flat.values[:, 0] = s * (1.0 - shortening)
    if ends == "pinned":
        flat.values[:, 1] = amplitude * np.sin(waves)
        flat.values[:, 2] = amplitude * np.pi * np.cos(waves)
        flat.values[:, 3] = -amplitude * np.pi**2 * np.sin(waves)
    else:
        flat.values[:, 1] = 0.5 * amplitude * (1.0 - np.cos(waves))
        flat.values[:, 2] = amplitude * np.pi * np.sin(waves)
        flat.values[:, 3] = 2.0 * amplitude * np.pi**2 * np.cos(waves)
    guess = Snap(stretching, 0.0, 1.0 - shortening, ends, flat, 0.0)
    curve = guess.problem()

    def unloaded(left: Numbers, right: Numbers, p: Numbers) -> Numbers:
        return np.append(curve.ends(left, right, p), p[1])

    start = Boundary(curve.rate, unloaded).solve(flat)
    return replace(guess, start=start, height=float(start.values[0, 1, -1]))


def _add(values: dict[str, Reference], label: str, fine: Snap, coarse: Snap) -> None:
    best, other = fine.follow(), coarse.follow()
    # A coordinate off by `gap` is worth about EA gap of load.
    gap = max(best.shooting_gap, 1e-14)
    floors = {"load": gap * fine.stretching, "drop": 10.0 * gap, "thrust": gap * fine.stretching}
    values[f"{label}.height"] = Reference(fine.height, 10.0 * gap, "length")
    values[f"{label}.thrust"] = Reference(best.points[0].thrust, floors["thrust"], "EI/length^2")
    for kind in ("limits", "bifurcations", "symmetric_bifurcations"):
        pairs = zip(getattr(best, kind), getattr(other, kind), strict=True)
        for number, (event, again) in enumerate(pairs, 1):
            for name, floor in floors.items():
                value = getattr(event, name)
                error = max(2.0 * abs(value - getattr(again, name)), floor)
                unit = "length" if name == "drop" else "EI/length^2"
                values[f"{label}.{kind}.{number}.{name}"] = Reference(value, error, unit)
    loads = [event.load for event in best.points]
    drops = [event.drop for event in best.points]
    values[f"{label}.path.load"] = Reference(loads, floors["load"], "EI/length^2")
    values[f"{label}.path.drop"] = Reference(drops, floors["drop"], "length")


def references() -> Problem:
    """Limit loads, bifurcations and whole symmetric curves."""
    values: dict[str, Reference] = {}
    for rise in (0.03, 0.05):
        label = f"arch.rise{rise:g}"
        _add(values, label, circular_arch(rise, 1e4, 40), circular_arch(rise, 1e4, 30))
    kinds: tuple[Ends, ...] = ("clamped", "pinned")
    for ends in kinds:
        fine, coarse = (buckled_beam(0.02, 1e4, ends, degree) for degree in (40, 30))
        _add(values, f"buckled.{ends}.shortening0.02", fine, coarse)
    return Problem(
        "arch",
        "dead load at the middle, positive down, of a stress-free circular arch of span 1 with "
        "pinned ends, and of a straight beam of length 1 buckled upward by moving its ends "
        "together; EI = 1, EA = 1e4; symmetric curve with limit points (in order along it) and "
        "bifurcations to skew shapes, and to symmetric ones; drop is of the middle from the "
        "unloaded height",
        "pseudo-arclength continuation of the extensible rod by Chebyshev collocation, degree 40 "
        "on half the rod; error: the larger of twice the change from degree 30 and the mismatch "
        "of shooting (for forces, times EA)",
        values,
    )
