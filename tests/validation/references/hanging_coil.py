"""A naturally curved heavy rod that hangs from a clamp whose tangent points down.

Inextensible, equal bending stiffnesses EI, natural curvature k in the plane of x and z (z down),
weight f a length; lengths in 1/k, forces in EI k^2, so that the length, f/(EI k^3) and GJ/EI are
left (Miller, Lazarus, Audoly and Reis, Phys. Rev. Lett. 112, 2014). The short rod hangs in its
plane. Followed in its length it leaves the plane where the linearised spatial problem is
singular: a zero of the determinant of the collocation, and of the matrix of shooting. The shape
in space is reached with a small force across the plane, which is taken away at the end; its
energy is compared with that of the shape in the plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from scipy.optimize import brentq

from .collocation import Solution
from .kirchhoff_rod import (
    Equilibrium,
    Held,
    Loaded,
    Rod,
    checked,
    constant,
    natural_shape,
    shoot,
    solve,
)
from .record import Problem, Reference

RATIO = 1.0 / 1.3  # GJ/EI of a round section with Poisson's ratio 0.3
CLAMP = Held((0.0, 0.0, 0.0), np.eye(3))
WEIGHT, LENGTH = 0.1, 6.0
PUSH = 3e-3  # force at the tip along y, in EI k^2


def rod(length: float) -> Rod:
    """Along z with d1 = x, d2 = y; it bends towards x."""
    return Rod(length, (1.0, 1.0), RATIO, natural=constant(0.0, 1.0, 0.0))


@dataclass(frozen=True)
class Coil:
    """The rod under the weight f/(EI k^3)."""

    weight: float
    degree: int = 16
    segments: int = 3

    def near(self, length: float, guess: Solution, push: float = 0.0) -> Equilibrium:
        """The equilibrium of this length near `guess`, under a tip force along y."""
        load = np.array([0.0, 0.0, self.weight])
        return solve(rod(length), CLAMP, Loaded((0.0, push, 0.0)), guess, load)

    def followed(self, length: float, push: float = 0.0) -> Equilibrium:
        """The equilibrium reached from a length of 1."""
        breaks = np.linspace(0.0, 1.0, self.segments + 1)
        guess = natural_shape(rod(1.0), CLAMP, breaks, self.degree)
        for step in np.linspace(1.0, length, int(3.0 * length)):
            found = self.near(float(step), guess, push)
            guess = found.solution
        return found

    def in_space(self, length: float) -> Equilibrium:
        """The equilibrium out of the plane."""
        pushed = self.followed(length, PUSH)
        return self.near(length, pushed.solution)

    def critical_length(self) -> tuple[float, float]:
        """The least length, above 4, at which the shape in the plane is singular, and its
        distance to that of shooting.
        """
        low, base = 4.0, self.followed(4.0)
        sizes: list[float] = []

        def determinant(length: float) -> float:
            found = self.near(length, base.solution)
            sign, size = np.linalg.slogdet(found.boundary.residual(found.solution)[1])
            sizes.append(float(size))
            return float(sign * np.exp(size - sizes[0]))

        start = determinant(low)
        while start * determinant(low + 0.25) > 0.0:
            low += 0.25
            base = self.near(low, base.solution)
        critical = float(brentq(determinant, low, low + 0.25, xtol=1e-12, rtol=1e-12))
        return critical, shooting_zero(self, critical, base.solution) - critical


def shooting_zero(coil: Coil, length: float, guess: Solution) -> float:
    """The zero of the determinant of shooting, by a chord of +-1e-4 about `length`."""
    ends = np.array([length - 1e-4, length + 1e-4])
    logs = [np.linalg.slogdet(shoot(coil.near(float(end), guess))[2]) for end in ends]
    values = np.array([sign * np.exp(size - logs[0][1]) for sign, size in logs])
    if values[0] * values[1] > 0.0:
        raise RuntimeError(f"hanging coil: shooting is not singular near {length}")
    return float((ends[0] * values[1] - ends[1] * values[0]) / (values[1] - values[0]))


def energy(coil: Coil, found: Equilibrium) -> float:
    """Elastic energy and potential of the weight, in EI k."""
    points, weights = legendre.leggauss(60)
    length = found.rod.length
    s = 0.5 * length * (points + 1.0)
    strain = found.strains(s)[:3] - found.rod.natural(s)
    elastic = 0.5 * (found.rod.stiffness[:, None] * strain**2).sum(axis=0)
    return float(0.5 * length * weights @ (elastic - coil.weight * found.at(s)[2]))


def references() -> Problem:
    """Tips in the plane, critical lengths, and shapes in space."""
    coil = Coil(WEIGHT)
    plane, space = checked(coil.followed(LENGTH)), checked(coil.in_space(LENGTH))
    critical, gap = coil.critical_length()
    gain = energy(coil, space.equilibrium) - energy(coil, plane.equilibrium)
    values = {
        "critical_length": Reference(critical, max(abs(gap), 1e-10), "1/k"),
        f"space.{LENGTH:g}.energy_above_plane": Reference(gain, 1e-10, "EI k"),
    }
    for label, found in (("plane", plane), ("space", space)):
        for share in (0.5, 1.0):
            for axis, entry in zip("xyz", found.point(share * LENGTH, "1/k"), strict=True):
                values[f"{label}.{LENGTH:g}.s{share:g}.{axis}"] = entry
    return Problem(
        "hanging_coil",
        "inextensible rod clamped with the tangent along z (down), natural curvature k towards "
        "x, GJ/EI = 1/1.3, weight a length 0.1 EI k^3: critical length at which the shape in the "
        "plane is unstable out of it; places at shares of the length 6/k in the plane and in "
        "space (its mirror image y to -y is another one), and how much lower the energy is there",
        "Chebyshev collocation of the 13 equations with quaternions; error: the larger of twice "
        "the change with the degree and the distance to shooting with rotation matrices",
        values,
    )
