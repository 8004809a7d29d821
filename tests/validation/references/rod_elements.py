"""Finite elements for the extensible Euler-Bernoulli rod in the plane (no rotary inertia).

    energy  integral of 1/2 EA (|r'| - 1)^2 + 1/2 EI ((r' x r'') / |r'|^2)^2 - r . q   ds
    kinetic energy  integral of 1/2 rho A |r_t|^2 ds

(r' x r'')/|r'|^2 is d(theta)/ds, so this is the energy of the discrete rod in the limit. r is
C1: cubic Hermite shape functions in position and slope at the element ends (the absolute
nodal coordinate cable, Gerstmayr and Shabana, Nonlinear Dynamics 45, 2006), and in each
element the bubbles up to degree p that vanish with their slope at both ends, the twofold
integrals of Legendre polynomials P_2 .. P_(p-2). p = 3 is the classic cubic element; raising p
converges faster than any power of the size for smooth shapes. Integrals by Gauss
quadrature with 2 p points, mass consistent, gradient and Hessian exact.

Unknowns of node k: x, L_e x', y, L_e y' (L_e half an element's length), then the bubbles of
the element to its right (x, y alternating); matrices are banded.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Polynomial, legendre
from scipy.linalg import solveh_banded

from .record import Array, Integers, Mask


def shape_functions(degree: int, at: Array, derivative: int) -> Array:
    """Shape functions on [-1, 1], shape (degree + 1, len(at)).

    Order: value and slope at -1, value and slope at +1, bubbles.
    """
    cubics = [
        [0.5, -0.75, 0.0, 0.25],
        [0.25, -0.25, -0.25, 0.25],
        [0.5, 0.75, 0.0, -0.25],
        [-0.25, -0.25, 0.25, 0.25],
    ]
    rows = [Polynomial(c).deriv(derivative)(at) for c in cubics]
    for n in range(2, degree - 1):
        twice = legendre.legint([0.0] * n + [1.0], 2, lbnd=-1)
        rows.append(legendre.legval(at, legendre.legder(twice, derivative)))
    return np.array(rows)


@dataclass(frozen=True)
class RodElements:
    """Uniform mesh on a straight rod from (0, 0) to (length, 0), clamped at s = 0.

    `load` is the force a unit length (N/m). States are vectors of all unknowns less the
    three held by the clamp: x, y and y' at the first node (x' is free: the end may stretch).
    """

    elements: int
    degree: int
    length: float
    stretching: float  # EA (N)
    bending: float  # EI (N m^2)
    mass_per_length: float  # kg/m
    load: tuple[float, float]

    @property
    def half(self) -> float:
        """Half the length of an element."""
        return 0.5 * self.length / self.elements

    @property
    def per_element(self) -> int:
        """Unknowns from one node to the next."""
        return 2 * (self.degree - 1)

    @property
    def count(self) -> int:
        """Unknowns with those of the clamp."""
        return self.per_element * self.elements + 4

    @property
    def bandwidth(self) -> int:
        """Upper (and lower) bandwidth of mass and stiffness."""
        return self.per_element + 3

    @cached_property
    def free(self) -> Mask:
        """Mask of the unknowns the clamp leaves free."""
        mask = np.ones(self.count, dtype=bool)
        mask[[0, 2, 3]] = False
        return mask

    @cached_property
    def scatter(self) -> Integers:
        """Unknowns of each element, shape (elements, 2, degree + 1): component, function."""
        bubbles = self.degree - 3
        after = self.per_element
        local = [
            [2 * c, 2 * c + 1, after + 2 * c, after + 2 * c + 1]
            + [4 + 2 * j + c for j in range(bubbles)]
            for c in (0, 1)
        ]
        index: Integers = (
            np.array(local)[None] + self.per_element * np.arange(self.elements)[:, None, None]
        )
        return index

    @cached_property
    def quadrature(self) -> tuple[Array, Array]:
        """Gauss points on [-1, 1] and weights in metres."""
        points, weights = legendre.leggauss(2 * self.degree)
        return points, weights * self.half

    @cached_property
    def slopes(self) -> tuple[Array, Array]:
        """First and second derivative of the shape functions by s, (degree + 1, points)."""
        points, _ = self.quadrature
        first = shape_functions(self.degree, points, 1) / self.half
        second = shape_functions(self.degree, points, 2) / self.half**2
        return first, second

    def straight(self) -> Array:
        """All unknowns of the undeformed rod."""
        state = np.zeros(self.count)
        nodes = np.arange(self.elements + 1) * self.per_element
        state[nodes] = np.linspace(0.0, self.length, self.elements + 1)
        state[nodes + 1] = self.half
        return state

    def position(self, states: Array, share: float) -> Array:
        """Positions at rest arc length `share` * length, shape (..., 2)."""
        place = share * self.elements
        element = min(int(place), self.elements - 1)
        at = np.array([2.0 * (place - element) - 1.0])
        shapes = shape_functions(self.degree, at, 0)[:, 0]
        positions: Array = states[..., self.scatter[element]] @ shapes
        return positions

    def _banded(self, blocks: Array) -> Array:
        """Element blocks, shape (elements, 2, n, 2, n), to symmetric LAPACK upper storage of
        the free unknowns, shape (bandwidth + 1, free).
        """
        index = np.cumsum(self.free) - 1
        index[~self.free] = -1
        flat = index[self.scatter].reshape(self.elements, -1)
        rows = np.broadcast_to(flat[:, :, None], (self.elements, flat.shape[1], flat.shape[1]))
        columns = rows.transpose(0, 2, 1)
        keep = (rows >= 0) & (columns >= rows)
        count = int(self.free.sum())
        place = (self.bandwidth + rows - columns)[keep] * count + columns[keep]
        values = blocks.reshape(rows.shape)[keep]
        size = (self.bandwidth + 1) * count
        band = np.asarray(np.bincount(place, values, size), dtype=float)
        return band.reshape(self.bandwidth + 1, count)

    @cached_property
    def mass(self) -> Array:
        """Consistent mass, symmetric upper band of the free unknowns."""
        points, weights = self.quadrature
        shapes = shape_functions(self.degree, points, 0)
        one = self.mass_per_length * (shapes * weights) @ shapes.T
        blocks = np.zeros((self.elements, 2, self.degree + 1, 2, self.degree + 1))
        blocks[:, 0, :, 0, :] = one
        blocks[:, 1, :, 1, :] = one
        return self._banded(blocks)

    @cached_property
    def weight(self) -> Array:
        """Generalised force of `load`, all unknowns."""
        points, weights = self.quadrature
        one = shape_functions(self.degree, points, 0) @ weights
        local = np.tile(np.outer(self.load, one), (self.elements, 1, 1))
        total = np.bincount(self.scatter.ravel(), local.ravel(), self.count)
        return np.asarray(total, dtype=float)

    def _rates(self, states: Array) -> tuple[Array, Array, Array, Array]:
        """r' (ax, ay) and r'' (bx, by) at all points, each (..., elements, points)."""
        first, second = self.slopes
        local = states[..., self.scatter]
        a, b = local @ first, local @ second
        return a[..., 0, :], a[..., 1, :], b[..., 0, :], b[..., 1, :]

    def energy(self, state: Array) -> float:
        """Elastic and load potential energy (J)."""
        ax, ay, bx, by = self._rates(state)
        q = ax * ax + ay * ay
        density = 0.5 * self.stretching * (np.sqrt(q) - 1.0) ** 2
        density = density + 0.5 * self.bending * ((ax * by - ay * bx) / q) ** 2
        return float((density @ self.quadrature[1]).sum() - self.weight @ state)

    def force(self, states: Array) -> Array:
        """Minus the gradient of the energy at the free unknowns; `states` (k, count)."""
        ax, ay, bx, by = self._rates(states)
        q = ax * ax + ay * ay
        norm = np.sqrt(q)
        tension = self.stretching * (norm - 1.0) / norm
        kappa = (ax * by - ay * bx) / q
        moment = self.bending * kappa / q
        weights = self.quadrature[1]
        by_first = np.stack(
            [
                tension * ax + moment * (by - 2.0 * kappa * ax),
                tension * ay + moment * (-bx - 2.0 * kappa * ay),
            ],
            axis=-2,
        )
        by_second = np.stack([-moment * ay, moment * ax], axis=-2)
        first, second = self.slopes
        local = (by_first * weights) @ first.T + (by_second * weights) @ second.T
        # Neighbouring elements share a node's four unknowns only: add the two ends apart.
        out = np.zeros((len(states), self.count))
        step, n = self.per_element, self.elements
        window = out[:, : step * n].reshape(len(states), n, step)
        order = self.scatter[0]
        inner = order < step
        window[:, :, order[inner]] = local[:, :, inner]
        tail = out[:, step:].reshape(len(states), -1)
        shared = local[:, :, ~inner]
        places = (order[~inner] - step)[None, :] + step * np.arange(n)[:, None]
        tail[:, places.ravel()] += shared.reshape(len(states), -1)
        forces: Array = (self.weight - out)[:, self.free]
        return forces

    def hessian(self, state: Array) -> Array:
        """Second derivative of the energy at one state, symmetric upper band, free unknowns."""
        ax, ay, bx, by = self._rates(state)
        q = ax * ax + ay * ay
        norm = np.sqrt(q)
        kappa = (ax * by - ay * bx) / q
        zero = np.zeros_like(q)
        a = np.stack([ax, ay, zero, zero])
        c1 = np.stack([by, -bx, -ay, ax])
        q1 = 2.0 * a
        c2 = np.zeros((4, 4, 1, 1))
        c2[0, 3] = c2[3, 0] = 1.0
        c2[1, 2] = c2[2, 1] = -1.0
        q2 = np.zeros((4, 4, 1, 1))
        q2[0, 0] = q2[1, 1] = 2.0
        k1 = (c1 - kappa * q1) / q
        mixed = c1[:, None] * q1[None]
        k2 = c2 / q - (mixed + mixed.swapaxes(0, 1)) / q**2
        k2 = k2 + 2.0 * kappa * q1[:, None] * q1[None] / q**2 - kappa * q2 / q
        second = self.bending * (k1[:, None] * k1[None] + kappa * k2)
        # 1/2 EA (norm - 1)^2: EA [ (1 - 1/norm) I + a a^T / norm^3 ]
        second = second + self.stretching * (
            (1.0 - 1.0 / norm) * 0.5 * q2 + a[:, None] * a[None] / norm**3
        )
        second = second * self.quadrature[1]
        # rows of the strain-like vector (r', r'') by unknowns: component c uses rows c, 2 + c
        first, curve = self.slopes
        rows = np.stack([first, curve])
        size = self.degree + 1
        blocks = np.empty((self.elements, 2, size, 2, size))
        for c in (0, 1):
            for d in (0, 1):
                part = second[c::2, d::2]  # (2, 2, elements, points)
                inner = np.einsum("ijep,jmp->iemp", part, rows, optimize=True)
                blocks[:, c, :, d, :] = np.einsum("inp,iemp->enm", rows, inner, optimize=True)
        return self._banded(blocks)

    def accelerations(self, state: Array) -> Array:
        """M^-1 F at the free unknowns."""
        result: Array = solveh_banded(self.mass, self.force(state[None])[0])
        return result
