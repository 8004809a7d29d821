"""Motions of rods in space, clamped at the start, by the elements of `spatial_elements.py`.

In time: collocation (`swing.Collocation`) with the accelerations A_i at the stages as unknowns,

    V_i = v + h sum a_ij A_j,    Q_i = q + h c_i v + h^2 sum (a^2)_ij A_j,
    residual(Q_i, V_i, A_i) = 0,

by simplified Newton: mass, damping (of the gyroscopic couple) and stiffness matrices are
differences of the residual at the start of a step, renewed now and then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from .kirchhoff_rod import Rod, constant, rotation
from .princeton_beam import torsion_constant
from .record import Array, Mask, Problem, Reference
from .spatial_elements import (
    Chart,
    Dynamics,
    SpatialElements,
    lagrange_gap,
    lobatto_places,
)
from .swing import Collocation

Angle = Callable[[float], tuple[float, float, float]]
RENEW = 10  # steps with the same matrices


def still(_time: float) -> tuple[float, float, float]:
    """A clamp that does not turn."""
    return 0.0, 0.0, 0.0


@dataclass(frozen=True)
class Spin:
    """A clamp turned about its tangent by `angle` within `duration`, as sin^2; angle, rate,
    acceleration.
    """

    angle: float
    duration: float

    def __call__(self, time: float) -> tuple[float, float, float]:
        rate = np.pi / self.duration
        c, s = np.cos(rate * time), np.sin(rate * time)
        half = 0.5 * self.angle
        return float(half * (1.0 - c)), float(half * rate * s), float(half * rate**2 * c)


@dataclass(frozen=True)
class Case:
    """A rod from the origin along z with d1 = x, d2 = y, drawn as the helix, arc or line of the
    strains `drawn`; it starts from rest.
    """

    rod: Rod
    mass: float
    spin: float
    load: tuple[float, float, float]
    drawn: tuple[float, float, float]
    angle: Angle
    duration: float

    def frames(self, s: Array) -> Array:
        """Drawn frames (len(s), 3, 3), columns d1, d2, d3."""
        axis, rate = self._turning()
        return np.array([rotation(axis, rate * x) for x in s])

    def positions(self, s: Array) -> Array:
        """Drawn places (len(s), 3)."""
        axis, rate = self._turning()
        tangent = np.array([0.0, 0.0, 1.0])
        if rate == 0.0:
            return np.asarray(s[:, None] * tangent)
        along = axis * (axis @ tangent)
        angle = rate * s[:, None]
        swept = (tangent - along) * np.sin(angle) + np.cross(axis, tangent) * (1 - np.cos(angle))
        return np.asarray(s[:, None] * along + swept / rate)

    def _turning(self) -> tuple[Array, float]:
        """Axis about which the drawn frame turns along the rod (any if it does not), and rate."""
        u = np.array(self.drawn)
        rate = float(np.linalg.norm(u))
        return (u / rate if rate > 0.0 else np.array([0.0, 0.0, 1.0])), rate

    def start(self, elements: int, degree: int) -> tuple[Dynamics, Array]:
        """Mesh with the drawn frames as chart, and the drawn state."""
        mesh = SpatialElements(self.rod, self.mass, self.spin, self.load, elements, degree)
        frames = self.frames(mesh.quadrature[0])
        d1, d2, t = (frames[:, :, k] for k in range(3))
        bend = self.drawn[1] * d1 - self.drawn[0] * d2
        twist = np.full((len(frames), 1), self.drawn[2])
        places = lobatto_places(mesh)
        state = mesh.shape(self.positions(places), self.frames(places)[:, :, 2], places)
        return Dynamics(mesh, Chart(t, bend, d1, d2, twist)), state


@dataclass
class Motion:
    """A motion under way; `step` advances it by `size`."""

    case: Case
    dynamics: Dynamics
    position: Array
    method: Collocation
    size: float

    def __post_init__(self) -> None:
        """Start from rest."""
        self.time = 0.0
        self.velocity: Array = np.zeros_like(self.position)
        self.velocity[self._section] = self.case.angle(0.0)[1]
        self.free: Mask = np.ones(len(self.position), dtype=bool)
        # r(0) is held, and the slope there is along z (its size is free); phi(0) is prescribed.
        self.free[[0, 1, 2, 3, 4, self._section]] = False
        self._turned = 0.0  # angle of the clamp when the chart was made
        self._guess: Array = np.zeros((self.method.stages, len(self.position)))
        self._age = RENEW
        self._factors: list[tuple[Array, Array]] = []

    @property
    def _section(self) -> int:
        """Index of phi(0)."""
        return self.dynamics.mesh.split

    def _renew(self) -> None:
        """Factors of M + h l C + h^2 l^2 K for the eigenvalues l of the method's matrix."""
        q, v = self.position, self.velocity
        count = len(q)
        zero = np.zeros((count, count))
        eye = np.eye(count)
        base = self.dynamics.residual(q, v, zero[0])
        length = self.dynamics.mesh.rod.length
        mass = self.dynamics.residual(zero + q, zero + v, eye) - base
        bump = 1e-7 * length
        stiff = (self.dynamics.residual(q + bump * eye, zero + v, zero) - base) / bump
        speed = 1e-4 * length
        damping = (self.dynamics.residual(zero + q, v + speed * eye, zero) - base) / speed
        keep = np.ix_(self.free, self.free)
        m, c, k = mass.T[keep], damping.T[keep], stiff.T[keep]
        values = np.linalg.eigvals(self.method.matrix) * self.size
        self._factors = [lu_factor(m + x * c + x * x * k) for x in values]
        self._age = 0

    def step(self) -> None:
        """One step."""
        method, h = self.method, self.size
        if self._age >= RENEW:
            self._renew()
        self._age += 1
        matrix, nodes = method.matrix, method.nodes
        vectors = np.linalg.eig(matrix).eigenvectors
        back = np.linalg.inv(vectors)
        prescribed = np.array([self.case.angle(self.time + h * c) for c in nodes])
        change = self._guess.copy()
        previous = np.inf
        for _ in range(40):
            q = (
                self.position
                + h * nodes[:, None] * self.velocity
                + h * h * (matrix @ (matrix @ change))
            )
            v = self.velocity + h * matrix @ change
            q[:, self._section] = prescribed[:, 0] - self._turned
            v[:, self._section] = prescribed[:, 1]
            change[:, self._section] = prescribed[:, 2]
            rows = back @ self.dynamics.residual(q, v, change)[:, self.free]
            solved = np.array([lu_solve(f, r) for f, r in zip(self._factors, rows, strict=True)])
            correction = -np.real(vectors @ solved)
            change[:, self.free] += correction
            size = h * h * float(np.abs(correction).max())
            if size < 1e-15 or (size < 1e-12 and size > 0.3 * previous):
                break
            if size > 0.5 * previous and self._age > 1:
                self._renew()
            previous = size
        else:
            raise RuntimeError(f"motion: Newton stalls at {size:.1e} at time {self.time}")
        self.position = (
            self.position + h * self.velocity + h * h * (method.weights @ matrix @ change)
        )
        self.velocity = self.velocity + h * method.weights @ change
        self.time += h
        angle, rate, _ = self.case.angle(self.time)
        self.position[self._section] = angle - self._turned
        self.velocity[self._section] = rate
        ahead = np.array([np.polyfit(nodes, column, method.stages - 1) for column in change.T])
        self._guess = np.array([np.polyval(ahead.T, 1.0 + c) for c in nodes])
        if self.dynamics.least_cosine(self.position) < 0.0:
            self.dynamics, self.position, self.velocity = self.dynamics.rebased(
                self.position, self.velocity
            )
            self._turned = angle
            self._age = RENEW

    def energy(self) -> float:
        """Kinetic, elastic and potential energy."""
        kinetic = self.dynamics.kinetic(self.position, self.velocity)
        return float(kinetic + self.dynamics.energy(self.position))


LENGTH = 0.5
GRAVITY = 9.81


def strip(curvatures: tuple[float, float], gravity: float, angle: Angle, duration: float) -> Case:
    """A soft strip, 30 mm wide along x and 10 mm thick along y where it is clamped."""
    width, thickness, modulus, poisson, density = 0.03, 0.01, 5e6, 0.45, 1100.0
    area = width * thickness
    weak, strong = area * thickness**2 / 12.0, area * width**2 / 12.0
    twisting = modulus / (2.0 + 2.0 * poisson) * torsion_constant(width, thickness)
    natural = (*curvatures, 0.0)
    bending = (modulus * weak, modulus * strong)
    return Case(
        Rod(LENGTH, bending, twisting, modulus * area, constant(*natural)),
        density * area,
        density * (weak + strong),
        (0.0, -gravity * density * area, 0.0),
        natural,
        angle,
        duration,
    )


def untwisting(twist: float, curvature: float, duration: float) -> Case:
    """A soft round rod of radius 10 mm, drawn as an arc without twist; its natural twist is
    `twist` cos(pi s/(2 L)), so that nothing is released at once at its free end.
    """
    radius, modulus, poisson, density = 0.01, 1e6, 0.3, 1000.0
    area = float(np.pi) * radius**2
    inertia = area * radius**2 / 4.0

    def natural(s: Array) -> Array:
        turning = twist * np.cos(0.5 * np.pi * s / LENGTH)
        return np.stack([0.0 * s, curvature + 0.0 * s, turning])

    bending = modulus * inertia
    return Case(
        Rod(LENGTH, (bending, bending), bending / (1.0 + poisson), modulus * area, natural),
        density * area,
        2.0 * density * inertia,
        (0.0, 0.0, 0.0),
        (0.0, curvature, 0.0),
        still,
        duration,
    )


CASES = {
    "dropped": strip((0.0, 3.0), GRAVITY, still, 0.4),
    "released": untwisting(-4.0 * np.pi, 2.0, 0.24),
    "spun": strip((3.0, 0.0), 0.0, Spin(2.0 * np.pi, 1.0), 0.8),
}


@dataclass(frozen=True)
class Refinement:
    """Mesh and time integration."""

    elements: int
    degree: int
    method: Collocation
    steps: int


FINE = Refinement(2, 11, Collocation("gauss", 3), 320)
OTHER = Refinement(3, 9, Collocation("radau", 3), 400)
SAMPLES = 8


def path(case: Case, resolution: Refinement) -> Array:
    """Places of middle and tip at even times from 0, shape (SAMPLES + 1, 2, 3)."""
    dynamics, start = case.start(resolution.elements, resolution.degree)
    motion = Motion(case, dynamics, start, resolution.method, case.duration / resolution.steps)
    mesh = dynamics.mesh
    states = [motion.position]
    for k in range(resolution.steps):
        motion.step()
        if (k + 1) % (resolution.steps // SAMPLES) == 0:
            states.append(motion.position)
    table = np.array(states)
    return np.stack([mesh.position(table, 0.5 * LENGTH), mesh.position(table, LENGTH)], axis=1)


def entries(label: str, fine: Array, other: Array) -> dict[str, Reference]:
    """Paths with their error: the change from another mesh and method."""
    values: dict[str, Reference] = {}
    times = CASES[label].duration * np.arange(SAMPLES + 1) / SAMPLES
    values[f"{label}.times"] = Reference([float(t) for t in times], 1e-15, "s")
    for k, place in enumerate(("middle", "tip")):
        for i, axis in enumerate("xyz"):
            error = max(float(np.abs(fine[:, k] - other[:, k]).max()), 1e-9)
            series = [float(x) for x in fine[:, k, i]]
            values[f"{label}.{place}.{axis}"] = Reference(series, error, "m")
    return values


def references() -> Problem:
    """Paths of middle and tip."""
    random = np.random.default_rng(0)
    values: dict[str, Reference] = {}
    for label, case in CASES.items():
        dynamics, state = case.start(1, 5)
        bumps = 0.02 * random.standard_normal((3, len(state)))
        gap = lagrange_gap(dynamics, state + bumps[0], bumps[1], bumps[2])
        if gap > 1e-5:
            raise RuntimeError(f"motion: {label} is off Lagrange's equations by {gap:.1e}")
        values |= entries(label, path(case, FINE), path(case, OTHER))
    return Problem(
        "spatial_motion",
        "rods of rest length 0.5 m clamped at the origin with d1, d2, d3 along x, y, z; from "
        "rest, paths of middle (rest arc length 0.25 m) and tip at `times`. dropped: strip 30 mm "
        "(along d1) by 10 mm, E 5 MPa, nu 0.45, 1100 kg/m3, natural curvature 3/m about d2 (in "
        "its own plane), drawn so, falls along -y with g = 9.81. released: round rod, radius 10 "
        "mm, E 1 MPa, nu 0.3, 1000 kg/m3, natural curvature 2/m about d2 and natural twist -4 pi "
        "cos(pi s/(2 L))/m, drawn with this curvature and without twist; no weight. spun: the "
        "strip with natural curvature 3/m about d1, drawn so, no weight; the clamp turns about "
        "its tangent by pi (1 - cos(pi t/(1 s))). Spin has the inertia rho times the polar "
        "moment of area, with the couple j w t_t on the centre line; other rotations have none",
        "C1 elements for r and C0 elements for the angle of the section: 2 of degree 11, Gauss "
        "with 3 stages, 320 steps; error: largest change from 3 elements of degree 9 with Radau "
        "IIA of 3 stages and 400 steps. The equations agree with Lagrange's, by differences of "
        "the energies",
        values,
    )
