"""Finite elements for the motion of the rod of `kirchhoff_rod.py` (no shear, stretch EA).

    kinetic energy  integral of 1/2 mu |r_t|^2 + 1/2 j w^2   ds

w is the section's spin about the tangent t = r'/|r'|, mu the mass a rest length, j rho times the
polar moment of area. r is C1: cubic Hermite functions and bubbles (`rod_elements.py`); the angle
phi is C0: Lagrange functions at Lobatto points. phi turns the section against a chart, a fixed
frame (T, D1, D2) at each quadrature point, carried from T to t by the shortest rotation:

    d1 = cos phi R D1 + sin phi R D2,     R v = v - (t.v)/(1 + t.T) (T + t)
    spin   w  = phi_t + a.t_t             a = (t x T)/(1 + t.T)
    twist  u3 = phi' + D1'.D2 + a.(t' + T')

Sections turn by the virtual rotation dtheta = t x dt + (dphi + a.dt) t, and du_i = dtheta'.d_i,
dw = dtheta_t.t. Hence, with N the tension and m the moment,

    integral of N t.dr' + m.dtheta' + mu r_tt.dr + (j w t)_t.dtheta - f.dr  ds = 0.

(j w t)_t has the part j w t_t across the tangent: the couple on the centre line by which a
spinning section resists being tilted. All functions are smooth, so that the error falls faster
than any power of the degree. A chart is replaced (`rebased`) when a tangent has turned by a right
angle from it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from .collocation import differentiation, interpolation, lobatto
from .kirchhoff_rod import Rod
from .record import Array
from .rod_elements import shape_functions


def cross(a: Array, b: Array) -> Array:
    """a x b along the last axis."""
    return np.stack(
        [
            a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
            a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
            a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0],
        ],
        axis=-1,
    )


def dot(a: Array, b: Array) -> Array:
    """a . b along the last axis, which is kept."""
    return np.asarray((a * b).sum(axis=-1, keepdims=True))


@dataclass(frozen=True)
class Chart:
    """T, T', D1, D2 (points, 3) and D1'.D2 (points, 1) at the quadrature points."""

    tangent: Array
    slope: Array
    first: Array
    second: Array
    twist: Array


@dataclass(frozen=True)
class SpatialElements:
    """Uniform mesh of `elements` on `rod`; r of degree `degree`, phi of one less.

    States are vectors: the coefficients of r, three for each function, then those of phi.
    """

    rod: Rod
    mass: float  # mu
    spin: float  # j
    load: tuple[float, float, float]  # force a length
    elements: int
    degree: int

    @property
    def half(self) -> float:
        """Half the length of an element."""
        return 0.5 * self.rod.length / self.elements

    @cached_property
    def quadrature(self) -> tuple[Array, Array]:
        """Rest arc lengths of the Gauss points, and weights, shape (points,)."""
        points, weights = legendre.leggauss(2 * self.degree)
        middles = self.half * (2.0 * np.arange(self.elements) + 1.0)
        places = middles[:, None] + self.half * points
        return places.ravel(), np.tile(self.half * weights, self.elements)

    def functions(self, places: Array, order: int) -> Array:
        """Derivatives of the functions of r at rest arc lengths, shape (len(places), functions).

        Function 2 k is the value at node k, 2 k + 1 its slope times `half`; bubbles follow.
        """
        element = np.minimum(places / (2.0 * self.half), self.elements - 1).astype(int)
        local = places / self.half - 2.0 * element - 1.0
        shapes = shape_functions(self.degree, local, order) / self.half**order
        bubbles = self.degree - 3
        out = np.zeros((len(places), 2 * (self.elements + 1) + self.elements * bubbles))
        rows = np.arange(len(places))
        for k in range(4):
            out[rows, 2 * element + k] = shapes[k]
        for k in range(bubbles):
            out[rows, 2 * (self.elements + 1) + bubbles * element + k] = shapes[4 + k]
        return out

    def angle_functions(self, places: Array, order: int) -> Array:
        """Values (order 0) or derivatives (1) of the functions of phi, in order along the rod."""
        degree = self.degree - 1
        element = np.minimum(places / (2.0 * self.half), self.elements - 1).astype(int)
        shares = 0.5 * places / self.half - element
        shapes = interpolation(degree, shares)
        if order == 1:
            shapes = shapes @ differentiation(degree) / (2.0 * self.half)
        out = np.zeros((len(places), degree * self.elements + 1))
        rows = np.arange(len(places))
        for k in range(degree + 1):
            out[rows, degree * element + k] = shapes[:, k]
        return out

    @cached_property
    def tables(self) -> tuple[Array, Array, Array, Array, Array]:
        """Functions of r (value, first, second derivative) and phi (value, first)."""
        s, _ = self.quadrature
        value, first, second = (self.functions(s, order) for order in range(3))
        return value, first, second, self.angle_functions(s, 0), self.angle_functions(s, 1)

    @property
    def split(self) -> int:
        """How many numbers of a state belong to r."""
        return 3 * len(self.tables[0].T)

    @property
    def count(self) -> int:
        """Length of a state."""
        return self.split + len(self.tables[3].T)

    def parts(self, states: Array) -> tuple[Array, Array]:
        """Coefficients of r (..., functions, 3) and phi (..., functions, 1)."""
        r, phi = states[..., : self.split], states[..., self.split :]
        return r.reshape(*r.shape[:-1], -1, 3), phi[..., None]

    def shape(self, position: Array, slope: Array, at: Array) -> Array:
        """State with phi = 0 whose r agrees with values and slopes given at `at`, which must hold
        the nodes; the bubbles by least squares of the slopes.
        """
        out = np.zeros((self.tables[0].shape[1], 3))
        nodes = 2 * (self.elements + 1)
        places = np.linspace(0.0, self.rod.length, self.elements + 1)
        index = np.array([int(np.argmin(np.abs(at - s))) for s in places])
        out[0:nodes:2], out[1:nodes:2] = position[index], slope[index] * self.half
        rates = self.functions(at, 1)
        rest = slope - rates[:, :nodes] @ out[:nodes]
        out[nodes:] = np.linalg.lstsq(rates[:, nodes:], rest, rcond=None)[0]
        return np.concatenate([out.ravel(), np.zeros(self.tables[3].shape[1])])

    def position(self, states: Array, s: float) -> Array:
        """r at rest arc length `s`, shape (..., 3)."""
        r, _ = self.parts(states)
        return np.asarray((self.functions(np.array([s]), 0) @ r)[..., 0, :])


@dataclass(frozen=True)
class Strained:
    """The strains of a batch of states at the quadrature points, shapes (..., points, 3 or 1)."""

    stretch: Array  # |r'|
    tangent: Array
    bend: Array  # t'
    along: Array  # r''.t
    carry: Array  # a
    first: Array  # d1
    second: Array  # d2
    strains: Array  # u


@dataclass(frozen=True)
class Dynamics:
    """Mesh and chart."""

    mesh: SpatialElements
    chart: Chart

    def strained(self, states: Array) -> Strained:
        """Tangents, frames and strains."""
        _, first, second, value, rate = self.mesh.tables
        r, phi = self.mesh.parts(states)
        slope, curve = first @ r, second @ r
        stretch = np.sqrt(dot(slope, slope))
        t = slope / stretch
        along = dot(curve, t)
        bend = (curve - along * t) / stretch
        base = self.chart
        gap = 1.0 + dot(t, base.tangent)
        carry = cross(t, np.broadcast_to(base.tangent, t.shape)) / gap
        carried = [d - dot(t, d) / gap * (base.tangent + t) for d in (base.first, base.second)]
        angle = value @ phi
        c, s = np.cos(angle), np.sin(angle)
        d1, d2 = c * carried[0] + s * carried[1], c * carried[1] - s * carried[0]
        twist = rate @ phi + base.twist + dot(carry, bend + base.slope)
        strains = np.concatenate([-dot(bend, d2), dot(bend, d1), twist], axis=-1)
        return Strained(stretch, t, bend, along, carry, d1, d2, strains)

    def energy(self, states: Array) -> Array:
        """Elastic energy and potential of the load."""
        rod, (s, weights) = self.mesh.rod, self.mesh.quadrature
        here = self.strained(states)
        gap = here.strains - rod.natural(s).T
        density = 0.5 * rod.stretching * (here.stretch - 1.0) ** 2
        density = density + 0.5 * (rod.stiffness * gap**2).sum(axis=-1, keepdims=True)
        r, _ = self.mesh.parts(states)
        density = density - dot(self.mesh.tables[0] @ r, np.asarray(self.mesh.load))
        return np.asarray(density[..., 0] @ weights)

    def _spin_rate(self, here: Strained, velocity: Array) -> tuple[Array, Array, Array]:
        """t_t, the rate of |r'| over |r'|, and w."""
        _, first, _, value, _ = self.mesh.tables
        v, turning = self.mesh.parts(velocity)
        slope = first @ v / here.stretch
        growth = dot(slope, here.tangent)
        tilt = slope - growth * here.tangent
        return tilt, growth, value @ turning + dot(here.carry, tilt)

    def kinetic(self, states: Array, velocity: Array) -> Array:
        """Kinetic energy."""
        here = self.strained(states)
        _, _, w = self._spin_rate(here, velocity)
        v = self.mesh.tables[0] @ self.mesh.parts(velocity)[0]
        density = 0.5 * self.mesh.mass * dot(v, v) + 0.5 * self.mesh.spin * w * w
        return np.asarray(density[..., 0] @ self.mesh.quadrature[1])

    def momentum(self, states: Array, velocity: Array) -> tuple[Array, Array]:
        """Linear and angular momentum (about the origin)."""
        here = self.strained(states)
        _, _, w = self._spin_rate(here, velocity)
        zero = self.mesh.tables[0]
        x, v = zero @ self.mesh.parts(states)[0], zero @ self.mesh.parts(velocity)[0]
        weights = self.mesh.quadrature[1][:, None]
        turning = self.mesh.mass * cross(x, v) + self.mesh.spin * w * here.tangent
        return (self.mesh.mass * v * weights).sum(axis=-2), (turning * weights).sum(axis=-2)

    def residual(self, states: Array, velocity: Array, acceleration: Array) -> Array:
        """The left side of the equations of motion for each function, shape of the states."""
        mesh, rod = self.mesh, self.mesh.rod
        s, weights = mesh.quadrature
        here = self.strained(states)
        t, a, bend = here.tangent, here.carry, here.bend
        m = rod.stiffness * (here.strains - rod.natural(s).T)
        moment = m[..., :1] * here.first + m[..., 1:2] * here.second + m[..., 2:] * t
        base = self.chart
        gap = 1.0 + dot(t, base.tangent)
        turned = dot(t, base.slope) + dot(bend, base.tangent)
        carry_slope = cross(t, np.broadcast_to(base.slope, t.shape))
        carry_slope = carry_slope + cross(bend, np.broadcast_to(base.tangent, t.shape))
        carry_slope = (carry_slope - a * turned) / gap

        tilt, growth, w = self._spin_rate(here, velocity)
        zero, first, second, value, rate = mesh.tables
        push, spin_up = mesh.parts(acceleration)
        tilting = first @ push / here.stretch
        w_rate = value @ spin_up + dot(a, tilting) - 2.0 * growth * dot(a, tilt)
        w_rate = w_rate - dot(a, tilt) * dot(tilt, base.tangent) / gap

        # by dt, by dt' and by dpsi = dphi + a.dt
        by_bend = cross(moment, t) + m[..., 2:] * a
        by_spin = dot(moment, bend) + mesh.spin * w_rate
        by_tilt = cross(moment, bend) + m[..., 2:] * carry_slope + by_spin * a
        by_tilt = by_tilt + mesh.spin * w * cross(tilt, t)

        def across(x: Array) -> Array:
            return (x - dot(x, t) * t) / here.stretch

        # dt' = P dr''/|r'| + P' dr'/|r'| - P dr' (|r'|)'/|r'|^2 with P = 1 - t t
        skewed = -(dot(by_bend, t) * bend + dot(by_bend, bend) * t) / here.stretch
        skewed = skewed - across(by_bend) * here.along / here.stretch
        by_second = across(by_bend)
        by_first = rod.stretching * (here.stretch - 1.0) * t + across(by_tilt) + skewed
        by_value = mesh.mass * (zero @ push) - np.asarray(mesh.load)
        column = weights[:, None]
        r = zero.T @ (column * by_value) + first.T @ (column * by_first)
        r = r + second.T @ (column * by_second)
        phi = value.T @ (column * by_spin) + rate.T @ (column * m[..., 2:])
        shape = states.shape[:-1]
        return np.concatenate([r.reshape(*shape, -1), phi.reshape(*shape, -1)], axis=-1)

    def rebased(self, state: Array, velocity: Array) -> tuple[Dynamics, Array, Array]:
        """The same state and velocity with the present frame as chart; phi is zero there."""
        here = self.strained(state)
        _, _, w = self._spin_rate(here, velocity)
        chart = Chart(here.tangent, here.bend, here.first, here.second, here.strains[..., 2:])
        value = self.mesh.tables[3]
        root = np.sqrt(self.mesh.quadrature[1])[:, None]
        turning = np.linalg.lstsq(root * value, root * w, rcond=None)[0][:, 0]
        split = self.mesh.split
        still = np.concatenate([state[:split], np.zeros(self.mesh.count - split)])
        return replace(self, chart=chart), still, np.concatenate([velocity[:split], turning])

    def least_cosine(self, state: Array) -> float:
        """Smallest t.T."""
        return float(dot(self.strained(state).tangent, self.chart.tangent).min())


def lagrange_gap(dynamics: Dynamics, state: Array, velocity: Array, acceleration: Array) -> float:
    """Largest difference between the residual and Lagrange's equations, d/dt dT/dv - dT/dq + dV/dq,
    by central differences of the energies, relative to the largest entry.
    """
    eye = np.eye(len(state))

    def slope(function: Callable[[Array], Array], at: Array, width: float) -> Array:
        return np.asarray((function(at + width * eye) - function(at - width * eye)) / (2.0 * width))

    def momentum(time: float) -> Array:
        q = state + time * velocity + 0.5 * time**2 * acceleration
        v = velocity + time * acceleration
        return slope(lambda w: dynamics.kinetic(q + 0.0 * w, w), v, 1e-4)

    lagrange = (momentum(1e-5) - momentum(-1e-5)) / 2e-5
    lagrange -= slope(lambda q: dynamics.kinetic(q, velocity + 0.0 * q), state, 1e-6)
    lagrange += slope(dynamics.energy, state, 1e-6)
    exact = dynamics.residual(state, velocity, acceleration)
    return float(np.abs(exact - lagrange).max() / np.abs(exact).max())


def lobatto_places(mesh: SpatialElements) -> Array:
    """Places with all nodes, dense enough to fit bubbles."""
    inner = lobatto(2 * mesh.degree)
    ends = 2.0 * mesh.half * np.arange(mesh.elements)
    return np.append((ends[:, None] + 2.0 * mesh.half * inner[:-1]).ravel(), mesh.rod.length)
