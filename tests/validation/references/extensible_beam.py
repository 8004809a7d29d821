"""The geometrically exact, shear-free, extensible planar rod under dead loads.

Per rest length s: energy 1/2 EA eps^2 + 1/2 EI (theta')^2, centreline
r' = (1 + eps)(cos theta, sin theta). With n the force that the part beyond s exerts on the
part before it, equilibrium reads (Antman, Nonlinear Problems of Elasticity, ch. IV; Magnusson,
Ristinmaa and Ljung, Int. J. Solids Struct. 38, 2001)

    n' = 0 between point loads, n jumps by -F at a load F
    EA eps = n . t,     EI theta'' = (1 + eps) (n_x sin theta - n_y cos theta)

Here lengths are in L and forces in EI/L^2, so that one number is left, the slenderness
EA L^2 / EI: eps = (n . t) / slenderness. Solved by Chebyshev collocation in segments between
the loads, load by load from the straight rod; every solution can be checked by shooting
(`Boundary.shooting_gap`). This is the limit of the discrete rod for vanishing edge length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .collocation import Boundary, Numbers, Solution, constant_start
from .record import Array, Problem, Reference, exact, refined


@dataclass(frozen=True)
class Beam:
    """A uniform straight beam (SI units)."""

    length: float
    stretching: float  # EA (N)
    bending: float  # EI (N m^2)

    @property
    def slenderness(self) -> float:
        """EA L^2 / EI."""
        return self.stretching * self.length**2 / self.bending

    @property
    def force_unit(self) -> float:
        """EI / L^2 (N)."""
        return self.bending / self.length**2


def tube(length: float, modulus: float, inner: float, outer: float) -> Beam:
    """A beam with a circular tube for cross-section (radii in m, modulus in Pa)."""
    area = np.pi * (outer**2 - inner**2)
    inertia = np.pi * (outer**4 - inner**4) / 4.0
    return Beam(length, modulus * area, modulus * inertia)


REPORT_TUBE = tube(1.0, 70e9, 0.011, 0.013)


def rod_rate(y: Numbers, nx: Numbers, ny: Numbers, slenderness: float) -> Numbers:
    """d/ds of (x, y, theta, moment) of the scaled rod with internal force (nx, ny)."""
    cosine, sine = np.cos(y[2]), np.sin(y[2])
    stretch = 1.0 + (nx * cosine + ny * sine) / slenderness
    return np.stack([stretch * cosine, stretch * sine, y[3], stretch * (nx * sine - ny * cosine)])


def straight_start(breaks: Array, parameters: Array, degree: int) -> Solution:
    """The undeformed straight rod along x."""
    start = constant_start(breaks, np.zeros(4), parameters, degree)
    start.values[:, 0, :] = start.points()
    return start


def _load_steps(load: float) -> Array:
    """Loads from small to `load`, no step larger than about EI/L^2."""
    count = max(1, int(np.ceil(abs(load))))
    return load * np.arange(1, count + 1) / count


@dataclass(frozen=True)
class Deflection:
    """Largest deflection (m, positive down), where it is (rest arc length, m), the deflection at
    half the rest length, and the x displacement of the roller (m); `shooting_gap` is an
    independent error (m).
    """

    largest: float
    position: float
    middle: float
    roller: float
    shooting_gap: float


def simply_supported_problem(slenderness: float, at: float, load: float) -> Boundary:
    """Left end pinned, right end free in x only; `load` (EI/L^2) down at rest arc length
    `at` (L). The parameter is n_y left of the load; n_x is zero, for nothing holds x.
    """

    def rate(k: int, _s: Array, y: Numbers, p: Numbers) -> Numbers:
        return rod_rate(y, np.zeros(1), p[0] + (load if k == 1 else 0.0), slenderness)

    def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
        fixed = np.array([left[0, 0], left[0, 1], left[0, 3], right[1, 1], right[1, 3]])
        return np.concatenate([fixed, right[0] - left[1]])

    return Boundary(rate, ends)


def simply_supported(beam: Beam, load: float, at: float, degree: int = 40) -> Deflection:
    """Deflection under `load` (N, positive down) at rest arc length `at` (m)."""
    share = at / beam.length
    solution = straight_start(np.array([0.0, share, 1.0]), np.zeros(1), degree)
    for level in _load_steps(load / beam.force_unit):
        problem = simply_supported_problem(beam.slenderness, share, level)
        solution = problem.solve(solution)
    low, lowest = _lowest(solution)
    return Deflection(
        -lowest * beam.length,
        low * beam.length,
        -float(solution.at(np.array([0.5]))[1, 0]) * beam.length,
        float(solution.values[-1, 0, -1] - 1.0) * beam.length,
        problem.shooting_gap(solution) * beam.length,
    )


def _lowest(solution: Solution) -> tuple[float, float]:
    """Rest position and height of the lowest point: theta = 0, by Newton."""
    grid = np.linspace(0.0, 1.0, 1001)
    s = float(grid[int(np.argmin(solution.at(grid)[1]))])
    for _ in range(20):
        _, _, theta, bend = solution.at(np.array([s]))[:, 0]
        s = float(np.clip(s - theta / bend, 0.0, 1.0))
    return s, float(solution.at(np.array([s]))[1, 0])


def euler_bernoulli_simply_supported(beam: Beam, load: float, at: float) -> float:
    """Largest deflection (m) of the linear beam: P b (L^2 - b^2)^(3/2) / (9 sqrt(3) L EI),
    b the distance from the load to the nearer support.
    """
    b = min(at, beam.length - at)
    span = beam.length
    return float(load * b * (span**2 - b**2) ** 1.5 / (9.0 * 3.0**0.5 * span * beam.bending))


@dataclass(frozen=True)
class CantileverTip:
    """Tip position (L) and angle (rad) of a cantilever of length 1 along x."""

    x: float
    y: float
    angle: float
    shooting_gap: float


def cantilever_problem(slenderness: float, load: tuple[float, float]) -> Boundary:
    """Rod of length 1 clamped along x, dead tip load in EI/L^2; two segments, no parameter."""

    def rate(_k: int, _s: Array, y: Numbers, _p: Numbers) -> Numbers:
        return rod_rate(y, np.full(1, load[0]), np.full(1, load[1]), slenderness)

    def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
        return np.concatenate([left[0, :3], right[1, 3:], right[0] - left[1]])

    return Boundary(rate, ends)


def cantilever(slenderness: float, load: tuple[float, float], degree: int = 40) -> CantileverTip:
    """Extensible cantilever, clamped at x = 0, with a dead tip load (EI/L^2).

    With slenderness to infinity and load (0, p) it is `elastica.tip_loaded_cantilever(p)`.
    """
    solution = straight_start(np.array([0.0, 0.25, 1.0]), np.zeros(0), degree)
    size = float(np.hypot(*load))
    for share in _load_steps(size) / size:
        problem = cantilever_problem(slenderness, (share * load[0], share * load[1]))
        solution = problem.solve(solution)
    x, y, angle, _moment = solution.values[-1, :, -1]
    return CantileverTip(float(x), float(y), float(angle), problem.shooting_gap(solution))


ROUNDING = 1e-13  # of a coordinate of a rod of length 1, as seen between degrees

QUOTED = {
    "tube.2000.deflection": (0.0377140, 5e-8),
    "tube.20000.deflection": (0.238006, 5e-7),
    "tube.20000.roller": (-0.160832, 5e-7),
    "euler_bernoulli.2000.deflection": (0.038045, 5e-7),
    "euler_bernoulli.20000.deflection": (0.380449, 5e-7),
}


def references() -> Problem:
    """All reference numbers of the extensible beam."""
    values: dict[str, Reference] = {}
    for load in (20.0, 63.0, 200.0, 632.0, 2000.0, 6325.0, 20000.0):
        fine = simply_supported(REPORT_TUBE, load, 0.75, 48)
        coarse = simply_supported(REPORT_TUBE, load, 0.75, 36)
        label = f"tube.{load:g}"
        floor = max(fine.shooting_gap, ROUNDING)
        for name, unit in (("largest", "m"), ("roller", "m"), ("position", "m")):
            new = refined(getattr(fine, name), getattr(coarse, name), unit, 1e-13)
            key = "deflection" if name == "largest" else name
            values[f"{label}.{key}"] = Reference(new.value, max(new.error, floor), unit)
        linear = euler_bernoulli_simply_supported(REPORT_TUBE, load, 0.75)
        values[f"euler_bernoulli.{load:g}.deflection"] = exact(linear, "m")
    for slenderness in (1e2, 1e3, 1e4, 1e6):
        for load in (1.0, 10.0):
            tip = cantilever(slenderness, (0.0, load), 48)
            rough = cantilever(slenderness, (0.0, load), 36)
            label = f"cantilever.slenderness{slenderness:g}.load{load:g}"
            for name, unit in (("x", "L"), ("y", "L"), ("angle", "rad")):
                new = refined(getattr(tip, name), getattr(rough, name), unit, 1e-13)
                values[f"{label}.{name}"] = Reference(
                    new.value, max(new.error, tip.shooting_gap, ROUNDING), unit
                )
    for key, (number, error) in QUOTED.items():
        old = values[key]
        values[key] = Reference(old.value, old.error, old.unit, number, error)
    return Problem(
        "extensible_beam",
        "simply supported aluminium tube (E 70 GPa, radii 11 and 13 mm, L 1 m), load in N down "
        "at rest arc length 0.75 m: largest deflection (positive down), its rest arc length, x "
        "displacement of the roller; cantilever of slenderness EA L^2/EI with tip load P L^2/EI",
        "Chebyshev collocation of the extensible rod, degree 48 a segment; error: the larger of "
        "twice the change from degree 36 and the mismatch of shooting with DOP853 at rtol 1e-13",
        values,
    )
