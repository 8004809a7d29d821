"""Swinging rods: L = 1 m, clamped horizontally at x = 0, released straight at t = 0 under
g = 9.81 m/s^2, no damping, followed for 1 s. `soft`: radius 10 mm, E = 10 MPa, 1000 kg/m^3;
`wire`: radius 1 mm, E = 200 GPa, 7850 kg/m^3.

Continuum: extensible Euler-Bernoulli rod without rotary inertia (`rod_elements.py`), so that
it is the limit of the discrete rod with lumped translational masses.

Space: C1 elements of degree p. Time: collocation at s Gauss points (order 2s, keeps the
energy of linear motion) or Radau IIA points (order 2s - 1, damps what the step cannot
resolve), Hairer, Norsett and Wanner, Solving ODEs I, II.7, and II, IV.5. For M u'' = F(u) the
stage displacements Z_i = U_i - u - c_i h v solve

    h^-2 A^-2 Z = M^-1 F(U),

A the s by s matrix of the method, by simplified Newton; the eigenvalues of A^-2 turn one
linear system of size s n into s banded complex ones of size n, half of them conjugates.

The release is rough: at t = 0+ every point but the clamp falls, bending waves of all lengths
start at the clamp, and mode n keeps an amplitude of about n^-5. This sets how fast the
tip converges, in space and in time; see the error estimate in `reference_path`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.polynomial import Polynomial, legendre
from numpy.typing import NDArray
from scipy.linalg import lapack

from .record import Array, Problem, Reference
from .rod_elements import RodElements

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Collocation:
    """An implicit Runge-Kutta method by collocation: `gauss` or `radau`, s stages."""

    family: Literal["gauss", "radau"]
    stages: int

    @cached_property
    def nodes(self) -> Array:
        """Stage times as shares of the step, shape (s,)."""
        series = [0.0] * self.stages + [1.0]
        if self.family == "radau":
            series[-2] = -1.0
        roots: Array = np.sort(np.real(legendre.legroots(series)))
        nodes: Array = 0.5 * (roots + 1.0)
        return nodes

    def integrals(self, upto: Array) -> Array:
        """Integrals from 0 to `upto` of the Lagrange polynomials, shape (len(upto), s)."""
        columns = []
        for j, node in enumerate(self.nodes):
            others = np.delete(self.nodes, j)
            basis = Polynomial.fromroots(others) / np.prod(node - others)
            columns.append(basis.integ()(upto))
        return np.stack(columns, axis=1)

    @cached_property
    def matrix(self) -> Array:
        """A, shape (s, s)."""
        return self.integrals(self.nodes)

    @cached_property
    def weights(self) -> Array:
        """b, shape (s,)."""
        weights: Array = self.integrals(np.ones(1))[0]
        return weights

    @cached_property
    def ahead(self) -> Array:
        """Extrapolation: from displacements at the stages (zero at the step's start) to those
        at the stages of an equal next step, counted from that step's start, shape (s, s).
        """
        known = np.concatenate([[0.0], self.nodes])
        rows = []
        for j in range(1, len(known)):
            others = np.delete(known, j)
            basis = Polynomial.fromroots(others) / np.prod(known[j] - others)
            rows.append(basis(1.0 + self.nodes) - basis(1.0))
        return np.stack(rows, axis=1)

    @cached_property
    def spectrum(self) -> tuple[Complex, Complex, Complex, Array]:
        """Eigenvalues of A^-2 with non-negative imaginary part, the right and left vectors
        that belong to them, and how often each counts (twice for a conjugate pair).
        """
        values, right = np.linalg.eig(np.linalg.inv(self.matrix @ self.matrix).astype(complex))
        left = np.linalg.inv(right)
        keep = values.imag > -1e-8 * abs(values)
        times = np.where(values[keep].imag > 1e-8 * abs(values[keep]), 2.0, 1.0)
        return values[keep], right[:, keep], left[keep], times


def full_band(upper: Array) -> Array:
    """Symmetric upper band to the general band storage of LAPACK's gbtrf."""
    width = len(upper) - 1
    count = upper.shape[1]
    out = np.zeros((3 * width + 1, count))
    out[width : 2 * width + 1] = upper
    for k in range(1, width + 1):
        out[2 * width + k, : count - k] = upper[width - k, k:]
    return out


@dataclass
class Motion:
    """State of the rod and what a step needs; `step` advances it by `size`."""

    rod: RodElements
    method: Collocation
    size: float

    def __post_init__(self) -> None:
        """Start at rest, straight."""
        self.position: Array = self.rod.straight()
        self.velocity: Array = np.zeros(int(self.rod.free.sum()))
        self._mass: Array = full_band(self.rod.mass)
        self._guess: Array | None = None
        self.iterations = 0

    def _factors(self, state: Array) -> list[tuple[Complex, NDArray[np.int32]]]:
        stiffness = full_band(self.rod.hessian(state))
        width = self.rod.bandwidth
        factors = []
        for value in self.method.spectrum[0]:
            band = value / self.size**2 * self._mass + stiffness
            lu, pivots, info = lapack.zgbtrf(band, width, width)
            if info != 0:
                raise RuntimeError(f"swing: singular stage matrix, gbtrf says {info}")
            factors.append((lu, pivots))
        return factors

    def _solve(self, factors: list[tuple[Complex, NDArray[np.int32]]], rows: Array) -> Array:
        """Solve (h^-2 A^-2 x M + 1 x K) dZ = rows."""
        values, right, left, times = self.method.spectrum
        width = self.rod.bandwidth
        out = np.zeros_like(rows)
        for k in range(len(values)):
            lu, pivots = factors[k]
            x, _ = lapack.zgbtrs(lu, width, width, left[k] @ rows, pivots)
            out += times[k] * np.real(np.outer(right[:, k], x))
        return out

    def _multiply_mass(self, rows: Array) -> Array:
        upper = self.rod.mass
        width = len(upper) - 1
        out: Array = upper[width] * rows
        for k in range(1, width + 1):
            out[:, :-k] += upper[width - k, k:] * rows[:, k:]
            out[:, k:] += upper[width - k, k:] * rows[:, :-k]
        return out

    def step(self) -> None:
        """One step: simplified Newton until the correction stops falling at rounding level."""
        method, h, free = self.method, self.size, self.rod.free
        inverse = np.linalg.inv(method.matrix @ method.matrix) / h**2
        drift = h * method.nodes[:, None] * self.velocity
        change = np.zeros_like(drift) if self._guess is None else self._guess - drift
        start = self.position[free]
        states = np.broadcast_to(self.position, (method.stages, len(self.position))).copy()
        middle = self.position.copy()
        middle[free] += (drift + change)[method.stages // 2]
        factors = self._factors(middle)
        previous = np.inf
        for _ in range(60):
            states[:, free] = start + drift + change
            rows = self.rod.force(states) - self._multiply_mass(inverse @ change)
            correction = self._solve(factors, rows)
            change += correction
            self.iterations += 1
            size = float(np.abs(correction).max())
            if size < 1e-16 or (size < 1e-12 and size > 0.3 * previous):
                break
            previous = size
        else:
            raise RuntimeError(f"swing: Newton stalls at {size:.1e}; take a smaller step")
        acceleration = inverse @ change
        self._guess = method.ahead @ (drift + change)
        self.position = self.position.copy()
        self.position[free] += h * self.velocity + h**2 * (
            (method.weights @ method.matrix) @ acceleration
        )
        self.velocity = self.velocity + h * (method.weights @ acceleration)

    def energy(self) -> float:
        """Kinetic, elastic and potential energy (J)."""
        momentum = self._multiply_mass(self.velocity[None])[0]
        return float(0.5 * self.velocity @ momentum + self.rod.energy(self.position))


@dataclass(frozen=True)
class Case:
    """A round rod of 1 m (SI units)."""

    radius: float
    youngs_modulus: float
    density: float

    def rod(self, elements: int, degree: int) -> RodElements:
        """The rod under its weight, in finite elements."""
        area = float(np.pi) * self.radius**2
        inertia = float(np.pi) * self.radius**4 / 4.0
        line_density = self.density * area
        return RodElements(
            elements=elements,
            degree=degree,
            length=1.0,
            stretching=self.youngs_modulus * area,
            bending=self.youngs_modulus * inertia,
            mass_per_length=line_density,
            load=(0.0, -9.81 * line_density),
        )


CASES = {"soft": Case(0.01, 1e7, 1000.0), "wire": Case(0.001, 200e9, 7850.0)}
PLACES = {"tip": 1.0, "middle": 0.5}


@dataclass(frozen=True)
class Refinement:
    """Resolution in space (elements, degree) and time (method, steps a second)."""

    elements: int
    degree: int
    method: Collocation
    steps: int


FINE = Refinement(16, 12, Collocation("radau", 5), 4000)
OTHERS = (
    Refinement(24, 8, Collocation("radau", 5), 4000),  # space
    Refinement(16, 12, Collocation("radau", 5), 2000),  # time
    Refinement(16, 12, Collocation("gauss", 4), 4000),  # method
)


def paths(case: Case, resolution: Refinement, samples: int = 100) -> dict[str, Array]:
    """Positions of tip and middle at t = 0, 1/samples, .., 1 s, each (samples + 1, 2) (m).

    `samples` must divide the number of steps.
    """
    if resolution.steps % samples:
        raise ValueError(f"{samples} samples do not divide {resolution.steps} steps")
    rod = case.rod(resolution.elements, resolution.degree)
    motion = Motion(rod, resolution.method, 1.0 / resolution.steps)
    states = [motion.position]
    for k in range(resolution.steps):
        motion.step()
        if (k + 1) % (resolution.steps // samples) == 0:
            states.append(motion.position)
    table = np.array(states)
    return {name: rod.position(table, share) for name, share in PLACES.items()}


def reference_path(case: Case) -> tuple[dict[str, Array], float]:
    """Paths at the finest resolution and their error: the largest distance (in a coordinate)
    to runs with another mesh, half the steps, and another time integrator.
    """
    best = paths(case, FINE)
    error = 0.0
    for resolution in OTHERS:
        other = paths(case, resolution)
        error = max(error, *(float(np.abs(best[name] - other[name]).max()) for name in PLACES))
    return best, error


def references() -> Problem:
    """Tip and middle paths every 0.01 s."""
    values: dict[str, Reference] = {}
    for label, case in CASES.items():
        best, error = reference_path(case)
        for place, path in best.items():
            for axis, name in enumerate("xy"):
                series = path[:, axis]
                values[f"{label}.{place}.{name}.t1"] = Reference(float(series[-1]), error, "m")
                values[f"{label}.{place}.{name}"] = Reference(series.tolist(), error, "m")
    for name, quoted in (("x", -0.31392), ("y", -0.52705)):
        key = f"soft.tip.{name}.t1"
        old = values[key]
        values[key] = Reference(old.value, old.error, old.unit, quoted, 1e-5)
    return Problem(
        "swing",
        "rods clamped at the left and released horizontally, tip and middle (rest arc length "
        "0.5 m) positions at t = 0, 0.01, .., 1 s; 'soft' E 10 MPa, radius 10 mm, 1000 kg/m3; "
        "'wire' E 200 GPa, radius 1 mm, 7850 kg/m3; g 9.81; no rotary inertia",
        "16 C1 elements of degree 12, Radau IIA with 5 stages, 4000 steps; error: largest change "
        "against 24 elements of degree 8, against 2000 steps, and against Gauss with 4 stages",
        values,
    )
