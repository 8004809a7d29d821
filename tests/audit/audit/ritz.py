"""The rod in motion: polynomials for the whole rod, Gauss collocation in time.

The potential ``1/2 EA (|r'| - 1)^2 + 1/2 EI (theta' - kappa_0)^2`` and the kinetic energy are those
of the continuum; ``r`` is a polynomial of the arc length (Ritz' method), so smooth motions converge
faster than any power of its degree. Time: the Gauss method of three stages, order 6 (E. Hairer,
S. P. Norsett and G. Wanner, Solving ordinary differential equations I, II.7). Lengths are in units
of the rod's, forces in ``EI/L^2``, times in ``L^2 sqrt(mu/EI)``.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import lu_factor, lu_solve, null_space

from .rod import Array

_R = np.sqrt(15.0)
_STAGES = np.array([0.5 - _R / 10, 0.5, 0.5 + _R / 10])
_A = np.array(
    [
        [5 / 36, 2 / 9 - _R / 15, 5 / 36 - _R / 30],
        [5 / 36 + _R / 24, 2 / 9, 5 / 36 - _R / 24],
        [5 / 36 + _R / 30, 2 / 9 + _R / 15, 5 / 36],
    ]
)
_B = np.array([5 / 18, 4 / 9, 5 / 18])


@dataclasses.dataclass
class Motion:
    """A straight uniform rod along x, dimensionless, and what acts on it.

    ``hold`` is ``clamp``, ``pin`` or ``free`` (at the start); ``spin`` a constant rate at which the
    clamp turns; ``force(t)`` acts at the end. ``foundation`` is the stiffness matrix under the rod,
    zero where the clamp turns.
    """

    EA: float
    hold: str
    kappa: float = 0.0
    gravity: tuple[float, float] = (0.0, 0.0)
    line: tuple[float, float] = (0.0, 0.0)
    force: Callable[[float], Array] = lambda t: np.zeros(2)
    kinks: tuple[float, ...] = ()
    end_mass: float = 0.0
    damping: float = 0.0
    foundation: Array = dataclasses.field(default_factory=lambda: np.zeros((2, 2)))
    spin: float = 0.0
    velocity: tuple[float, float] = (0.0, 0.0)
    rate: float = 0.0  # of rotation about the start, at the start
    settled: bool = False  # starts in the equilibrium of the loads at time 0


class Ritz:
    """Polynomials of one degree for a motion."""

    def __init__(self, motion: Motion, degree: int):
        self.motion = motion
        n = degree + 1
        points, weights = legendre.leggauss(2 * degree)
        self.s, self.w = np.asarray((points + 1) / 2), np.asarray(weights / 2)
        self.n = n
        identity = np.eye(n)
        self.value = self.basis(self.s)
        self.first, self.second = self.basis(self.s, 1), self.basis(self.s, 2)
        end, start = self.basis(np.array([1.0])), self.basis(np.array([0.0]))
        zero = np.zeros((1, n))
        rows = []
        if motion.hold in ("clamp", "pin"):
            rows += [np.hstack([start, zero]), np.hstack([zero, start])]
        if motion.hold == "clamp":
            rows.append(np.hstack([zero, self.basis(np.array([0.0]), 1)]))
        self.free = null_space(np.vstack(rows)) if rows else np.eye(2 * n)
        self.rest = np.concatenate([(identity[0] + identity[1]) / 2, np.zeros(n)])  # x = s
        one = (self.value * self.w[:, None]).T @ self.value + motion.end_mass * end.T @ end
        bar = (self.value * self.w[:, None]).T @ self.value
        both = np.kron(np.eye(2), one)
        turn = np.kron(np.array([[0.0, -1.0], [1.0, 0.0]]), one)  # J of 2 w J v
        z = self.free
        self.mass = z.T @ both @ z
        self.drag = motion.damping * z.T @ np.kron(np.eye(2), bar) @ z
        self.bedding = z.T @ np.kron(motion.foundation, bar) @ z  # pulls to z = 0, the drawn shape
        self.coriolis = 2 * motion.spin * z.T @ turn @ z
        self.whole_mass = both
        self.end = end[0]
        self.sum = self.w @ self.value
        zeros = np.zeros_like(self.first)
        # r' and r'' at the Gauss points as linear functions of the free coefficients.
        self.slopes = (
            np.stack(
                [
                    np.hstack([self.first, zeros]),
                    np.hstack([zeros, self.first]),
                    np.hstack([self.second, zeros]),
                    np.hstack([zeros, self.second]),
                ]
            )
            @ z
        )
        self.slopes_at_rest = np.stack([np.ones(len(points)), *np.zeros((3, len(points)))])

    def basis(self, s: Array, derivative: int = 0) -> Array:
        """Legendre polynomials on (0, 1), or their derivatives, points x n."""
        columns = []
        for k in range(self.n):
            one = np.zeros(self.n)
            one[k] = 1.0
            coefficients = legendre.legder(one, derivative)
            columns.append(legendre.legval(2 * s - 1, coefficients) * 2.0**derivative)
        return np.stack(columns, axis=1)

    def strains(self, z: Array) -> tuple[Array, Array, Array]:
        """r', r'' as (4, points), |r'| and theta'."""
        u = self.slopes_at_rest + self.slopes @ z
        length = np.hypot(u[0], u[1])
        return u, length, (u[0] * u[3] - u[1] * u[2]) / length**2

    def elastic(self, z: Array, hessian: bool = True) -> tuple[Array, Array]:
        u, g, kappa = self.strains(z)
        G = g * g
        num = kappa * G
        zero = np.zeros_like(g)
        num_i = np.stack([u[3], -u[2], -u[1], u[0]])
        G_i = np.stack([2 * u[0], 2 * u[1], zero, zero])
        k_i = num_i / G - num * G_i / G**2
        moment, tension = kappa - self.motion.kappa, self.motion.EA * (g - 1)
        t_i = np.stack([u[0] / g, u[1] / g, zero, zero])
        gradient = np.einsum("ap,apn,p->n", tension * t_i + moment * k_i, self.slopes, self.w)
        gradient += self.bedding @ z
        if not hessian:
            return gradient, np.empty(0)
        k_ij = 2 * num * G_i[:, None] * G_i[None] / G**3
        k_ij -= (num_i[:, None] * G_i[None] + num_i[None] * G_i[:, None]) / G**2
        for i, j, sign in ((0, 3, 1.0), (1, 2, -1.0)):
            k_ij[i, j] += sign / G
            k_ij[j, i] += sign / G
        for i in (0, 1):
            k_ij[i, i] -= 2 * num / G**2
        second = k_i[:, None] * k_i[None] + moment * k_ij
        second += self.motion.EA * t_i[:, None] * t_i[None]
        across = -t_i[:, None] * t_i[None] * tension / g
        for i in (0, 1):
            across[i, i] += tension / g
        second += across
        half = np.einsum("abp,bpn,p->apn", second, self.slopes, self.w)
        n = self.slopes.shape[2]
        matrix = self.slopes.reshape(-1, n).T @ half.reshape(-1, n)
        return gradient, matrix + self.bedding

    def load(self, t: float, z: Array) -> tuple[Array, Array]:
        """Generalised force, and its derivative, centrifugal forces of a turning clamp included."""
        m = self.motion
        angle = m.spin * t
        back = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        pull = back @ (np.array(m.gravity) + np.array(m.line))
        at_end = back @ (m.force(t) + m.end_mass * np.array(m.gravity))
        force = np.concatenate([pull[v] * self.sum + at_end[v] * self.end for v in (0, 1)])
        whole = self.rest + self.free @ z
        force = force + m.spin**2 * (self.whole_mass @ whole)
        return self.free.T @ force, m.spin**2 * self.mass

    def equilibrium(self) -> Array:
        """The equilibrium of the loads at time 0, in steps."""
        z = np.zeros(self.free.shape[1])
        for share in np.linspace(0.1, 1.0, 10):
            for _ in range(30):
                gradient, matrix = self.elastic(z)
                force, slope = self.load(0.0, z)
                step = np.linalg.solve(matrix - share * slope, gradient - share * force)
                z = z - step
                if np.abs(step).max() < 1e-13:
                    break
        return z

    def run(self, duration: float, steps: int) -> tuple[Array, Array, Array]:
        """Times, free coefficients and their velocities (in the turning frame)."""
        m = self.motion
        n = self.free.shape[1]
        z = self.equilibrium() if m.settled else np.zeros(n)
        v = np.zeros(n)
        if m.rate or any(m.velocity):
            identity = np.eye(self.n)
            along, one = (identity[0] + identity[1]) / 2, identity[0]
            start = np.concatenate([m.velocity[0] * one, m.velocity[1] * one + m.rate * along])
            v = self.free.T @ start
        kinks = [k for k in m.kinks if 0 < k < duration]
        corners = [0.0, *kinks, duration]
        times, zs, vs = [0.0], [z], [v]
        acceleration = np.zeros((3, n))
        A2 = _A @ _A
        for a, b in itertools.pairwise(corners):
            count = max(1, int(np.ceil(steps * (b - a) / duration)))
            h = (b - a) / count
            for k in range(count):
                t = a + k * h
                z, v, acceleration = self._step(t, h, z, v, acceleration, A2)
                times.append(t + h)
                zs.append(z)
                vs.append(v)
        return np.array(times), np.array(zs), np.array(vs)

    def _step(
        self, t: float, h: float, z: Array, v: Array, guess: Array, A2: Array
    ) -> tuple[Array, Array, Array]:
        n = len(z)
        a = guess.copy()
        rate = self.drag + self.coriolis
        for _ in range(25):
            zs = z + h * _STAGES[:, None] * v + h * h * A2 @ a
            vs = v + h * _A @ a
            residual = np.empty((3, n))
            jacobian = np.zeros((3, n, 3, n))
            for i in range(3):
                gradient, matrix = self.elastic(zs[i])
                force, slope = self.load(t + _STAGES[i] * h, zs[i])
                residual[i] = self.mass @ a[i] + rate @ vs[i] + gradient - force
                for j in range(3):
                    jacobian[i, :, j] = h * h * A2[i, j] * (matrix - slope) + h * _A[i, j] * rate
                jacobian[i, :, i] += self.mass
            factor = lu_factor(jacobian.reshape(3 * n, 3 * n))
            step = lu_solve(factor, residual.ravel()).reshape(3, n)
            a -= step
            if h * h * np.abs(step).max() < 1e-14 * (1 + np.abs(z).max()):
                break
        new_z = z + h * v + h * h * (_B @ _A) @ a
        return new_z, v + h * _B @ a, a

    # -- reading, in the frame at rest ------------------------------------------------------------

    def read(self, t: float, z: Array, v: Array, name: str, s: float) -> float:
        """A dimensionless probe."""
        m = self.motion
        angle = m.spin * t
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        whole, rate = self.rest + self.free @ z, self.free @ v
        if name in ("x", "y", "vx", "vy", "speed"):
            row = self.basis(np.array([s]))[0]
            position = np.array([row @ whole[: self.n], row @ whole[self.n :]])
            if name in ("x", "y"):
                return float((turn @ position)[0 if name == "x" else 1])
            moving = np.array([row @ rate[: self.n], row @ rate[self.n :]])
            moving = turn @ (moving + m.spin * np.array([-position[1], position[0]]))
            return float(np.hypot(*moving) if name == "speed" else moving[0 if name == "vx" else 1])
        if name in ("moment", "curvature", "tension", "strain"):
            d1, d2 = self.basis(np.array([s]), 1)[0], self.basis(np.array([s]), 2)[0]
            n = self.n
            u = np.array([d1 @ whole[:n], d1 @ whole[n:], d2 @ whole[:n], d2 @ whole[n:]])
            g = np.hypot(u[0], u[1])
            kappa = (u[0] * u[3] - u[1] * u[2]) / g**2
            return float(
                {
                    "moment": kappa - m.kappa,
                    "curvature": kappa,
                    "strain": g - 1,
                    "tension": m.EA * (g - 1),
                }[name]
            )
        if name == "kinetic_energy":
            n = self.n
            full = rate + m.spin * np.concatenate([-whole[n:], whole[:n]])
            return float(full @ self.whole_mass @ full / 2)
        _, g, kappa = self.strains(z)
        stretch = float(self.w @ (g - 1) ** 2) * m.EA / 2
        bend = float(self.w @ (kappa - m.kappa) ** 2) / 2
        spring = float(z @ self.bedding @ z) / 2
        if name in ("stretch_energy", "bend_energy", "spring_energy", "elastic_energy"):
            parts = {"stretch_energy": stretch, "bend_energy": bend, "spring_energy": spring}
            return parts.get(name, stretch + bend + spring)
        center = [self.sum @ whole[: self.n], self.sum @ whole[self.n :]]
        end = [self.end @ whole[: self.n], self.end @ whole[self.n :]]
        here = turn @ (np.array(center) + m.end_mass * np.array(end))
        weight = -float(np.array(m.gravity) @ here)
        if name == "gravity_energy":
            return weight
        assert name == "total_energy"
        return stretch + bend + spring + weight + self.read(t, z, v, "kinetic_energy", s)
