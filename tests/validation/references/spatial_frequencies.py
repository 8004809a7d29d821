"""Natural frequencies of stress-free rods in space: bars in torsion, rings, arcs, twisted blades.

Along the section's frame, of constant natural curvature and twist k, the displacement w, the
rotation phi, the force n and the moment m of a small vibration exp(i omega t) obey

    w'   = -k x w + phi x e3 + (n3/EA) e3        n' = -k x n - mu omega^2 w
    phi' = -k x phi + m_i/K_i e_i                m' = -k x m - e3 x n - j omega^2 phi_3 e3

with mu the mass a length and j the moment of inertia of the section's spin about the tangent (rho
times the polar moment of area); the sections' rotation about other axes has no inertia. Written
y' = (A0 + omega^2 A1) y, this gives

    rings   the 12 x 12 pencil i n/R - A0 - omega^2 A1 of the mode with n waves
    others  the pencil of Chebyshev collocation with the conditions at the ends; checked by the
            determinant of the conditions for exp((A0 + omega^2 A1) L)

Closed forms: torsion of a bar, omega = (i - 1/2) pi sqrt(GJ/(j L^2)) clamped-free, i pi free-free;
the inextensible ring without inertia of spin (Love, Mathematical Theory of Elasticity, 293),

    in its plane      omega^2 = EI/(mu R^4) n^2 (n^2 - 1)^2/(n^2 + 1)
    out of its plane  omega^2 = EI/(mu R^4) n^2 (n^2 - 1)^2/(n^2 + EI/GJ)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.linalg import eig, expm
from scipy.optimize import brentq

from .collocation import Numbers, differentiation, interpolation
from .princeton_beam import torsion_constant
from .record import Array, Integers, Mask, Problem, Reference, exact

Ends = Literal["clamped-clamped", "clamped-free", "free-free"]
IN_PLANE = np.array([0, 2, 4, 6, 8, 10])  # w1, w3, phi2, n1, n3, m2
OUT_OF_PLANE = np.array([1, 3, 5, 7, 9, 11])  # w2, phi1, phi3, n2, m1, m3
UNIT = "sqrt(EI/(mu L^4))"


@dataclass(frozen=True)
class Vibration:
    """A uniform rod; mass a length mu = 1."""

    length: float
    natural: tuple[float, float, float]  # k1, k2, k3
    bending: tuple[float, float]
    twisting: float
    compliance: float  # 1/EA
    spin: float  # j

    def matrices(self) -> tuple[Array, Array]:
        """A0 and A1 for (w, phi, n, m)."""
        k1, k2, k3 = self.natural
        turn = np.array([[0.0, -k3, k2], [k3, 0.0, -k1], [-k2, k1, 0.0]])
        along = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # e3 x
        a0, a1 = np.zeros((12, 12)), np.zeros((12, 12))
        for k in range(4):
            a0[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = -turn
        a0[0:3, 3:6] = -along
        a0[2, 8] = self.compliance
        a0[3:6, 9:12] = np.diag(1.0 / np.array([*self.bending, self.twisting]))
        a0[9:12, 6:9] = -along
        a1[6:9, 0:3] = -np.eye(3)
        a1[11, 5] = -self.spin
        return a0, a1


def round_section(length: float, curvature: float, radius: float) -> Vibration:
    """Round section of this radius, EI = 1, Poisson's ratio 0.3, bent about d2."""
    natural = (0.0, curvature, 0.0)
    return Vibration(length, natural, (1.0, 1.0), 1.0 / 1.3, radius**2 / 4.0, radius**2 / 2.0)


def blade(twist: float, width: float = 0.1, thickness: float = 0.02) -> Vibration:
    """Rectangular section, length 1, EI_weak = 1 (about d1), Poisson's ratio 0.3, with the total
    pre-twist `twist` (rad).
    """
    ratio = width / thickness
    twisting = 12.0 * torsion_constant(ratio, 1.0) / (2.6 * ratio)
    spin = (width**2 + thickness**2) / 12.0
    return Vibration(1.0, (0.0, 0.0, twist), (1.0, ratio**2), twisting, thickness**2 / 12.0, spin)


def squares(left: Numbers, right: Numbers) -> Array:
    """Positive eigenvalues omega^2 of left y = omega^2 right y, increasing."""
    found = eig(right, left, right=False)  # 1/omega^2, so that those at infinity are zeros
    found = found[np.abs(found) > 1e-13 * np.abs(found).max()]
    real = found[np.abs(found.imag) < 1e-6 * np.abs(found)].real
    return np.sort(1.0 / real[real > 0.0])


def ring(vibration: Vibration, waves: int, components: Integers) -> float:
    """Least frequency of a ring (radius 1/k2) with this number of waves."""
    a0, a1 = (m[np.ix_(components, components)] for m in vibration.matrices())
    left = 1j * waves * vibration.natural[1] * np.eye(len(components)) - a0
    return float(np.sqrt(squares(left, a1)[0]))


def ring_closed(waves: int, ratio: float) -> float:
    """Inextensible, without spin, in sqrt(EI/(mu R^4)); `ratio` EI/GJ (1 in the plane)."""
    square = waves**2 * (waves**2 - 1) ** 2 / (waves**2 + ratio)
    return float(np.sqrt(square))


def _held(ends: Ends, components: Integers) -> tuple[Mask, Mask]:
    """Which of the chosen components vanish at the start and at the end."""
    kinematic = components < 6
    start, end = (kinematic if kind == "clamped" else ~kinematic for kind in ends.split("-"))
    return start, end


def frequencies(
    vibration: Vibration, ends: Ends, components: Integers, count: int, degree: int
) -> Array:
    """The lowest frequencies, by collocation."""
    a0, a1 = (m[np.ix_(components, components)] for m in vibration.matrices())
    size = len(components)
    nodes = 0.5 - 0.5 * np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
    sample = interpolation(degree, nodes)
    slope = sample @ differentiation(degree) / vibration.length
    start, end = _held(ends, components)
    conditions = np.zeros((size, size, degree + 1))
    for row, column in enumerate(np.flatnonzero(start)):
        conditions[row, column, 0] = 1.0
    for row, column in enumerate(np.flatnonzero(end), int(start.sum())):
        conditions[row, column, -1] = 1.0
    rows = np.kron(np.eye(size), slope) - np.kron(a0, sample)
    left = np.vstack([rows, conditions.reshape(size, -1)])
    right = np.vstack([np.kron(a1, sample), np.zeros((size, left.shape[1]))])
    return np.asarray(np.sqrt(squares(left, right)[:count]), dtype=float)


def by_exponential(vibration: Vibration, ends: Ends, components: Integers, near: float) -> float:
    """The frequency nearest to `near`, from the solution operator along the rod."""
    a0, a1 = (m[np.ix_(components, components)] for m in vibration.matrices())
    start, end = _held(ends, components)

    def determinant(omega: float) -> float:
        carried = expm((a0 + omega**2 * a1) * vibration.length)
        return float(np.linalg.det(carried[np.ix_(end, ~start)]))

    width = 1e-6
    while determinant(near * (1.0 - width)) * determinant(near * (1.0 + width)) > 0.0:
        width *= 2.0
        if width > 1e-2:
            raise RuntimeError(f"frequencies: no zero of the determinant near {near}")
    return float(brentq(determinant, near * (1.0 - width), near * (1.0 + width), xtol=1e-14))


def _add(
    values: dict[str, Reference], label: str, vibration: Vibration, ends: Ends, components: Integers
) -> None:
    fine = frequencies(vibration, ends, components, 4, 36)
    coarse = frequencies(vibration, ends, components, 4, 28)
    for mode, (omega, other) in enumerate(zip(fine, coarse, strict=True), 1):
        exponential = by_exponential(vibration, ends, components, float(omega))
        error = max(2.0 * abs(omega - other), abs(omega - exponential), 1e-12 * omega)
        values[f"{label}.{mode}.omega"] = Reference(exponential, float(error), UNIT)


def references() -> Problem:
    """Frequencies of the lowest modes."""
    values: dict[str, Reference] = {}
    for mode in (1, 2, 3):
        values[f"torsion.clamped-free.{mode}.omega"] = exact(
            (mode - 0.5) * np.pi, "sqrt(GJ/(j L^2))"
        )
        values[f"torsion.free-free.{mode}.omega"] = exact(mode * np.pi, "sqrt(GJ/(j L^2))")
    thick = round_section(2.0 * np.pi, 1.0, 0.01)
    thin = replace(thick, compliance=0.0, spin=0.0)
    planes = (("in_plane", IN_PLANE, 1.0), ("out_of_plane", OUT_OF_PLANE, 1.3))
    for name, components, ratio in planes:
        for waves in (2, 3, 4):
            closed = ring_closed(waves, ratio)
            error = max(2.0 * abs(ring(thin, waves, components) - closed), 1e-12)
            label = f"ring.{name}.{waves}"
            values[f"{label}.thin.omega"] = Reference(closed, error, "sqrt(EI/(mu R^4))")
            omega = ring(thick, waves, components)
            values[f"{label}.radius0.01.omega"] = Reference(omega, error, "sqrt(EI/(mu R^4))")
    kinds: tuple[Ends, ...] = ("clamped-clamped", "clamped-free")
    for ends in kinds:
        for angle in (90, 180):
            opening = np.deg2rad(angle)
            arc = round_section(1.0, float(opening), 0.005)
            for name, components, _ in planes:
                label = f"arc{angle}.{ends}.{name}"
                _add(values, f"{label}.radius0.005", arc, ends, components)
                _add(
                    values,
                    f"{label}.thin",
                    replace(arc, compliance=0.0, spin=0.0),
                    ends,
                    components,
                )
    everything = np.arange(12)
    for angle in (0, 45, 90):
        _add(values, f"blade{angle}", blade(float(np.deg2rad(angle))), "clamped-free", everything)
    return Problem(
        "spatial_frequencies",
        "angular frequencies of modes 1, 2, ..; ring: by the number of waves, R = 1, round "
        "section of radius 0.01 R, nu 0.3, with stretch and inertia of spin, and thin: without; "
        "arc of 90 or 180 degrees, length L, round section of radius 0.005 L, nu 0.3, and thin; "
        "blade: cantilever of rectangular section 0.1 L by 0.02 L, nu 0.3, twisted evenly by 0, "
        "45 or 90 degrees over its length, EI the weak stiffness, j = mu (width^2 + "
        "thickness^2)/12; no inertia of other rotations",
        "12 linear equations along the natural frame: pencil of a wave (ring), Chebyshev pencil "
        "of degree 36 (error: the larger of twice the change from degree 28 and the distance to "
        "the determinant of the matrix exponential)",
        values,
    )
