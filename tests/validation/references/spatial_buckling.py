"""Loads at which straight rods and rings leave their shape into space.

Lateral buckling of a cantilever under a dead tip force P across its weak direction. If it does not
bend before (EI_strong infinite), J_(-1/4)(beta/2) = 0 with beta = P L^2/sqrt(EI_weak GJ)
(Timoshenko and Gere, Theory of Elastic Stability, 6.3). Else the planar elastica is followed up to
the load where the linearised spatial problem is singular: a zero of the determinant of the
collocation, and of the 6 x 6 matrix from the wrench at the clamp to the conditions at the tip.

Twist buckling (Greenhill) of a straight rod with equal bending stiffnesses that carries the torque
M and the thrust P. The transverse displacements u = y + i z obey

    EI u'''' - i M u''' + P u'' = 0,   moment across the axis  i EI u'' + M u',

with u = 0 at both ends, and there

    clamped     u' = 0
    axial       EI u'' - i M u' = 0   the end turns freely, its moment is a vector along the axis
    tangential  u'' = 0               the end turns freely, its moment follows the tangent

axial and tangential both have the closed form M^2/(4 EI^2) + P/EI = pi^2/L^2. (These moments are
not conservative; it is where a second shape of equilibrium appears. `clamped` is conservative.)

Ring of radius R, naturally straight, with total twist Tw and the torque GJ Tw/(2 pi R): leaves its
plane in the mode n = 2 at Tw = 2 pi sqrt(n^2 - 1) EI/GJ (Michell, Messenger of Mathematics 11,
1889; Goriely, J. Elasticity 84, 2006).
"""

from __future__ import annotations

from typing import Literal

import mpmath as mp
import numpy as np
from scipy.linalg import eigvals
from scipy.optimize import brentq

from .kirchhoff_rod import (
    Checked,
    Equilibrium,
    Held,
    Loaded,
    Rod,
    checked,
    natural_shape,
    shoot,
    solve,
)
from .princeton_beam import torsion_constant
from .record import Array, Problem, Reference, exact

Ends = Literal["clamped", "axial", "tangential"]
ENDS: tuple[Ends, ...] = ("clamped", "axial", "tangential")
THRUSTS = {
    "clamped": (-20.0, 0.0, 10.0, 20.0, 30.0),
    "axial": (-5.0, 0.0, 2.0, 5.0, 8.0),
    "tangential": (-5.0, 0.0, 2.0, 5.0, 8.0),
}


def lateral_limit() -> float:
    """P L^2/sqrt(EI_weak GJ) at which a cantilever that does not bend before buckles."""
    with mp.workdps(40):
        root = mp.findroot(lambda x: mp.besselj(mp.mpf(-1) / 4, x), 2.0)
        return float(2 * root)


def lateral_rod(weak: float, twisting: float) -> Rod:
    """Inextensible cantilever of length 1 with EI_strong = 1, d1 along the force."""
    return Rod(1.0, (weak, 1.0), twisting)


CLAMP = Held((0.0, 0.0, 0.0), np.eye(3))
"""Along z, with d1 = x: what is zero by symmetry in the plane is zero to the last bit."""


def bent_in_plane(rod: Rod, load: float, degree: int) -> Equilibrium:
    """The planar equilibrium under the force `load` along x = d1."""
    solution = natural_shape(rod, CLAMP, np.array([0.0, 0.5, 1.0]), degree)
    steps = int(np.ceil(load))
    for level in load * np.arange(1, steps + 1) / steps:
        found = solve(rod, CLAMP, Loaded((float(level), 0.0, 0.0)), solution)
        solution = found.solution
    return found


def lateral_load(rod: Rod, degree: int, shooting: bool = False) -> float:
    """P L^2/sqrt(EI_weak GJ) at which the planar shape buckles sideways."""
    unit = float(np.sqrt(rod.bending[0] * rod.twisting))
    base = bent_in_plane(rod, 3.0 * unit, degree)
    scale: list[float] = []

    def determinant(level: float) -> float:
        load = Loaded((level * unit, 0.0, 0.0))
        found = solve(rod, CLAMP, load, base.solution)
        matrix = shoot(found)[2] if shooting else found.boundary.residual(found.solution)[1]
        sign, size = np.linalg.slogdet(matrix)
        scale.append(float(size))
        return float(sign * np.exp(size - scale[0]))

    low = 3.0
    first = determinant(low)
    while first * determinant(low + 0.5) > 0.0:
        low += 0.5
    return float(brentq(determinant, low, low + 0.5, xtol=1e-13, rtol=1e-13))


def sideways(rod: Rod, load: float, degree: int) -> Checked:
    """The equilibrium beside the planar one beyond that load, under the same force. A force across
    leads off the plane, and is then taken away.
    """
    solution = natural_shape(rod, CLAMP, np.array([0.0, 0.5, 1.0]), degree)
    ways = [(share, 0.1 * share) for share in np.linspace(0.1, 1.0, 10)]
    for share, seed in (*ways, (1.0, 0.05), (1.0, 0.02), (1.0, 0.01), (1.0, 0.003), (1.0, 0.0)):
        found = solve(rod, CLAMP, Loaded((load * share, load * seed, 0.0)), solution)
        solution = found.solution
    return checked(found)


def _conditions(ends: Ends, u: Array, torque: float) -> Array:
    """Rows of the conditions at an end; `u` are value, slope, second derivative, (3, n)."""
    if ends == "clamped":
        return u[:2]
    return np.asarray([u[0], u[2] - 1j * torque * u[1] if ends == "axial" else u[2]])


def _twist_determinant(ends: Ends, thrust: float, torque: float) -> complex:
    """Determinant of the conditions for 1, s, exp(i a s), exp(i b s); EI = L = 1."""
    half = np.sqrt(0.25 * torque**2 + thrust + 0j)
    waves = 0.5 * torque + np.array([half, -half])
    rows = []
    for s in (-0.5, 0.5):
        e = np.exp(1j * waves * s)
        u = np.array([[1.0, s, *e], [0.0, 1.0, *(1j * waves * e)], [0.0, 0.0, *(-(waves**2) * e)]])
        if thrust == 0.0:  # the wave of length infinity is s^2
            u[:, 3] = [s**2, 2.0 * s, 2.0]
        rows.append(_conditions(ends, u, torque))
    return complex(np.linalg.det(np.concatenate(rows)) / (waves[0] - waves[1]))


def twist_torque(ends: Ends, thrust: float) -> float:
    """Least critical torque M L/EI under the thrust P L^2/EI (tension negative)."""

    def real(torque: float) -> float:
        value = _twist_determinant(ends, thrust, torque)
        # The conditions are those of a selfadjoint problem but for a constant phase.
        return value.real if abs(value.real) >= abs(value.imag) else value.imag

    low, step = 1e-3, 0.05
    while real(low) * real(low + step) > 0.0:
        low += step
    return float(brentq(real, low, low + step, xtol=1e-14, rtol=1e-14))


def clamped_torque_by_polynomials(thrust: float, degree: int = 40) -> float:
    """The same for clamped ends as an eigenvalue: Chebyshev polynomials, residuals at points."""
    identity = np.eye(degree + 1)
    series = [np.polynomial.Chebyshev(row, domain=[-0.5, 0.5]) for row in identity]
    points = 0.5 * np.cos(np.pi * (np.arange(degree - 3) + 0.5) / (degree - 3))
    tips = np.array([-0.5, 0.5])

    def rows(order: int, at: Array) -> Array:
        values = [p.deriv(order)(at) if order else p(at) for p in series]
        table: Array = np.array(values, dtype=float).T
        return table

    held = np.concatenate([rows(0, tips), rows(1, tips)])
    left = np.concatenate([rows(4, points) + thrust * rows(2, points), held])
    right = np.concatenate([1j * rows(3, points), 0.0 * held])
    found = eigvals(left, right)
    real = np.isfinite(found) & (np.abs(found.imag) < 1e-5 * np.abs(found)) & (found.real > 0.1)
    return float(found[real].real.min())


def ring_determinant(torque: float, mode: int) -> float:
    """Determinant of the linearised equations of a ring with EI = R = 1 under a torque C,

        EI t x t'' + C t' + t x n = 0,   n' = 0,   |r'| = 1,   t = e_theta,   n = C e_z,

    for displacements and forces that vary as exp(i mode theta) along (e_r, e_theta, e_z).
    """

    def wedge(a: Array) -> Array:
        x, y, z = (float(c) for c in a)
        return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])

    _, e_t, e_z = np.eye(3)
    rate = 1j * mode * np.eye(3) + wedge(e_z)
    by_tangent = wedge(e_t) + wedge(e_t) @ rate @ rate + torque * rate - torque * wedge(e_z)
    matrix = np.zeros((6, 6), dtype=complex)
    across = [0, 2]  # the component along the tangent is no condition: the torque is constant
    matrix[:2, :3] = (by_tangent @ rate)[across]
    matrix[:2, 3:] = wedge(e_t)[across]
    matrix[2, :3] = e_t @ rate
    matrix[3:, 3:] = rate
    value = complex(np.linalg.det(matrix))
    return value.real if abs(value.real) > abs(value.imag) else value.imag


def references() -> Problem:
    """Critical loads, torques and twists."""
    values: dict[str, Reference] = {
        "lateral.limit": Reference(lateral_limit(), 1e-15, "sqrt(EI_weak GJ)/L^2", 4.0126, 5e-5)
    }
    rectangle = 4.0 * torsion_constant(4.0, 1.0) * 12.0 / (4.0**4 * 2.6)  # GJ/EI_strong, nu 0.3
    cases = {
        "weak0.01.GJ0.01": (0.01, 0.01),
        "weak0.1.GJ0.1": (0.1, 0.1),
        "weak0.1.GJ0.2": (0.1, 0.2),
        "rectangle4": (1.0 / 16.0, rectangle),
    }
    for label, (weak, twisting) in cases.items():
        rod = lateral_rod(weak, twisting)
        best = lateral_load(rod, 22)
        others = (lateral_load(rod, 16), lateral_load(rod, 16, shooting=True))
        error = max(2.0 * abs(best - others[0]), abs(best - others[1]), 1e-12)
        values[f"lateral.{label}"] = Reference(best, error, "sqrt(EI_weak GJ)/L^2")
        values[f"lateral.{label}.GJ"] = exact(twisting, "EI_strong")
        values[f"lateral.{label}.EI_weak"] = exact(weak, "EI_strong")
    buckled = sideways(lateral_rod(0.1, 0.1), 0.6, 16)
    across, aside, along = buckled.point()
    values |= {"sideways.x": along, "sideways.y": across, "sideways.z": aside}
    for ends in ENDS:
        for thrust in THRUSTS[ends]:
            torque = twist_torque(ends, thrust)
            if ends == "clamped":
                other = clamped_torque_by_polynomials(thrust)
            else:
                other = float(2.0 * np.sqrt(np.pi**2 - thrust))
            error = max(abs(torque - other), 1e-13)
            values[f"twist.{ends}.thrust{thrust:g}"] = Reference(torque, error, "EI/L")
    for ratio in (0.75, 1.0, 1.5):
        torque = brentq(lambda c: ring_determinant(c, 2), 1.2, 2.2, xtol=1e-15)
        closed = 2.0 * np.pi * np.sqrt(3.0) * ratio
        error = max(abs(2.0 * np.pi * torque * ratio - closed), 1e-14)
        values[f"ring.{ratio:g}.twist"] = Reference(float(closed), float(error), "rad")
    return Problem(
        "spatial_buckling",
        "lateral.*: critical tip force of an inextensible cantilever bent across its weak "
        "direction, with the bending before buckling (limit: without), EI and GJ in units of "
        "EI_strong, rectangle4: sides 4 to 1, nu 0.3; sideways.*: its tip under 0.6 EI_strong/L^2 "
        "along y, EI_weak = GJ = EI_strong/10; twist.ENDS.thrustP: critical torque of a straight "
        "rod under the thrust P L^2/EI, ends clamped (may approach each other), axial (pinned, "
        "moment a vector along the axis), tangential (pinned, moment along the tangent); "
        "ring.R.twist: critical total twist of a naturally straight ring with EI/GJ = R",
        "singular determinants of the linearised collocation, checked by shooting; "
        "characteristic determinants, checked by Chebyshev polynomials, and closed forms",
        values,
    )
