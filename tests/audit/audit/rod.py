"""The planar extensible elastica as a boundary value problem, solved by spectral collocation.

Nothing here is shared with ``der``: no nodes, no turning angles, no energies. The rod is a curve
``(x, y, theta)(s)`` with the force ``n`` and the moment ``M`` across its sections:

    r' = (1 + T/EA) t,  T = n . t,   theta' = kappa_0 + M/EI,   n' = -q,   M' = -(r' x n)_z,

the equations of the energy ``1/2 EA (|r'| - 1)^2 + 1/2 EI (theta' - kappa_0)^2`` per rest length;
``q`` includes the pull ``k (r_0 - r)`` of foundations to the drawn shape
(S. S. Antman, Nonlinear Problems of Elasticity, 2nd ed., chapter 4, without shear). Pieces end
where something acts; in each, the unknowns are polynomials through Chebyshev-Lobatto points that
satisfy the equations at Gauss-Legendre points. Lengths are in units of the rod's, forces in
``EI/L^2``.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg

Array = npt.NDArray[np.float64]
X, Y, THETA, NX, NY, M = range(6)


class NoSolutionError(RuntimeError):
    """Newton's method did not come to an end."""


@dataclasses.dataclass
class Place:
    """Loads and supports at one arc length; in SI units, displacements from the initial place."""

    force: tuple[float, float] = (0.0, 0.0)
    moment: float = 0.0
    mass: float = 0.0
    fix: tuple[bool, bool] = (False, False)
    shift: tuple[float, float] = (0.0, 0.0)
    clamp: bool = False
    turn: float = 0.0
    spring: tuple[float, float] = (0.0, 0.0)
    anchor_shift: tuple[float, float] = (0.0, 0.0)
    torsion: float = 0.0


@dataclasses.dataclass
class Rod:
    """A rod and all that acts on it.

    ``curve(u)`` gives position (..., 2), direction (...), curvature (...) and ``ds/du`` (...) of
    the drawn shape; ``u`` runs through ``knots``, at which the curve may be rough.
    """

    knots: Array
    curve: Callable[[Array], tuple[Array, Array, Array, Array]]
    EA: float
    EI: float
    mass_per_length: float = 0.0
    natural: Callable[[Array], Array] | None = None
    line_loads: list[tuple[float, float, tuple[float, float]]] = dataclasses.field(
        default_factory=list
    )
    foundations: list[tuple[float, float, tuple[float, float]]] = dataclasses.field(
        default_factory=list
    )
    gravity: tuple[float, float] = (0.0, 0.0)
    places: dict[float, Place] = dataclasses.field(default_factory=dict)

    def place(self, u: float) -> Place:
        for known, there in self.places.items():
            if abs(known - u) <= 1e-12 * abs(self.knots[-1]):
                return there
        return self.places.setdefault(u, Place())


def straight(start: npt.ArrayLike, end: npt.ArrayLike) -> tuple[Array, Callable[[Array], Any]]:
    """Knots and curve of a straight rod, by its arc length."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    length = float(np.hypot(*(b - a)))
    direction = (b - a) / length

    def curve(u: Array) -> tuple[Array, Array, Array, Array]:
        position = a + u[..., None] * direction
        angle = np.full_like(u, np.arctan2(direction[1], direction[0]))
        return position, angle, np.zeros_like(u), np.ones_like(u)

    return np.array([0.0, length]), curve


def _barycentric(nodes: Array) -> Array:
    gaps = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(gaps, 1.0)
    weights: Array = 1.0 / gaps.prod(axis=1)
    return np.asarray(weights / np.abs(weights).max())


def _interpolation(nodes: Array, weights: Array, at: Array) -> Array:
    gap = at[:, None] - nodes[None, :]
    exact = np.abs(gap) < 1e-15
    gap[exact] = 1.0
    terms = weights / gap
    matrix: Array = terms / terms.sum(axis=1, keepdims=True)
    for row in np.nonzero(exact.any(axis=1))[0]:
        matrix[row] = exact[row]
    return matrix


def _differentiation(nodes: Array, weights: Array) -> Array:
    gap = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(gap, 1.0)
    matrix: Array = weights[None, :] / weights[:, None] / gap
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


class Mesh:
    """The pieces of one rod, and the collocation equations on them."""

    def __init__(self, rod: Rod, degree: int, longest: float = 0.25):
        self.rod = rod
        ends = {float(k) for k in rod.knots} | set(rod.places)
        ends |= {u for load in (*rod.line_loads, *rod.foundations) for u in load[:2]}
        ends_sorted = sorted(ends)
        span = rod.knots[-1] - rod.knots[0]
        merged = [ends_sorted[0]]
        for u in ends_sorted[1:]:
            if u - merged[-1] > 1e-12 * span:
                merged.append(u)
        breaks = [merged[0]]
        for left, right in itertools.pairwise(merged):
            count = int(np.ceil((right - left) / (longest * span) - 1e-9))
            breaks += list(np.linspace(left, right, count + 1)[1:])
        self.breaks = np.array(breaks)
        self.pieces = len(self.breaks) - 1
        self.order = degree + 1

        k = np.arange(degree + 1)
        self.nodes = -np.cos(np.pi * k / degree)
        self.weights = _barycentric(self.nodes)
        gauss, self.quadrature = np.polynomial.legendre.leggauss(degree)
        self.at_gauss = _interpolation(self.nodes, self.weights, gauss)
        self.slope_at_gauss = self.at_gauss @ _differentiation(self.nodes, self.weights)

        mid, half = (self.breaks[1:] + self.breaks[:-1]) / 2, np.diff(self.breaks) / 2
        self.half = half
        self.u_gauss = mid[:, None] + half[:, None] * gauss
        self.u_nodes = mid[:, None] + half[:, None] * self.nodes
        position, _, drawn, speed = rod.curve(self.u_gauss)
        self.length = float((speed * half[:, None] * self.quadrature).sum())
        self.L, self.F = self.length, rod.EI / self.length**2
        self.metric = speed * half[:, None] / self.L  # d(s/L)/dxi
        self.kappa_drawn = drawn * self.L
        natural = drawn if rod.natural is None else rod.natural(self.u_gauss)
        self.kappa_rest = natural * self.L
        self.stretch = self.F / rod.EA
        self.q_dead = np.zeros((*self.u_gauss.shape, 2))
        for lo, hi, q in rod.line_loads:
            inside = (self.u_gauss > lo) & (self.u_gauss < hi)
            self.q_dead[inside] += np.array(q) * self.L / self.F
        weight = rod.mass_per_length * np.array(rod.gravity)
        self.q_dead += weight * self.L / self.F
        self.position_drawn = position / self.L
        self.bedding = np.zeros((*self.u_gauss.shape, 2))  # stiffness of foundations
        for lo, hi, bed in rod.foundations:
            inside = (self.u_gauss > lo) & (self.u_gauss < hi)
            self.bedding[inside] += np.array(bed) * self.L**2 / self.F
        self._index()
        self._held, self._constants = self._conditions()

    # -- the equations ----------------------------------------------------------------------------

    def _index(self) -> None:
        n, k = self.pieces, self.order
        unknown = np.arange(n * k * 6).reshape(n, k, 6)
        row = np.arange(n * (k - 1) * 6).reshape(n, k - 1, 6)
        shape = (n, k - 1, 6, k, 6)
        self._rows = np.broadcast_to(row[:, :, :, None, None], shape).ravel()
        self._columns = np.broadcast_to(unknown[:, None, None, :, :], shape).ravel()
        self._unknown = unknown
        self.size = n * k * 6

    def drawn(self) -> Array:
        position, angle, _, _ = self.rod.curve(self.u_nodes)
        state = np.zeros((self.pieces, self.order, 6))
        state[..., :2] = position / self.L
        state[..., THETA] = np.unwrap(angle.ravel()).reshape(angle.shape)
        return state

    def _places(self) -> list[tuple[int, Place]]:
        """The breaks, with what acts there."""
        return [
            (
                i,
                self.rod.place(u)
                if any(abs(u - v) <= 1e-12 * abs(self.breaks[-1]) for v in self.rod.places)
                else Place(),
            )
            for i, u in enumerate(self.breaks)
        ]

    def equations(self, state: Array, t: float, supports: float) -> tuple[Array, Any]:
        """Residual and its Jacobian with all loads times ``t``, prescribed motions ``supports``."""
        g = np.einsum("ik,nkv->niv", self.at_gauss, state)
        slope = np.einsum("ik,nkv->niv", self.slope_at_gauss, state)
        h = self.metric
        c, s = np.cos(g[..., THETA]), np.sin(g[..., THETA])
        nx, ny = g[..., NX], g[..., NY]
        tension, shear = nx * c + ny * s, ny * c - nx * s
        long = 1.0 + self.stretch * tension
        rest = self.kappa_drawn + supports * (self.kappa_rest - self.kappa_drawn)
        residual = np.empty_like(g)
        residual[..., X] = slope[..., X] - h * long * c
        residual[..., Y] = slope[..., Y] - h * long * s
        residual[..., THETA] = slope[..., THETA] - h * (rest + g[..., M])
        pull = self.bedding * (self.position_drawn - g[..., :2])
        residual[..., NX] = slope[..., NX] + h * (t * self.q_dead[..., 0] + pull[..., 0])
        residual[..., NY] = slope[..., NY] + h * (t * self.q_dead[..., 1] + pull[..., 1])
        residual[..., M] = slope[..., M] + h * long * shear

        a = np.zeros((*g.shape, 6))
        e = self.stretch
        # dT/dtheta = shear, dshear/dtheta = -tension
        a[..., X, THETA] = -h * (e * shear * c - long * s)
        a[..., X, NX], a[..., X, NY] = -h * e * c * c, -h * e * s * c
        a[..., Y, THETA] = -h * (e * shear * s + long * c)
        a[..., Y, NX], a[..., Y, NY] = -h * e * c * s, -h * e * s * s
        a[..., THETA, M] = -h
        a[..., NX, X], a[..., NY, Y] = -h * self.bedding[..., 0], -h * self.bedding[..., 1]
        a[..., M, THETA] = h * (e * shear * shear - long * tension)
        a[..., M, NX] = h * (e * c * shear - long * s)
        a[..., M, NY] = h * (e * s * shear + long * c)
        block = a[:, :, :, None, :] * self.at_gauss[None, :, None, :, None]
        diagonal = np.arange(6)
        block[:, :, diagonal, :, diagonal] += self.slope_at_gauss[None, None, :, :]

        matrix = scipy.sparse.csc_matrix(
            (
                np.concatenate([block.ravel(), self._held.data]),
                (
                    np.concatenate([self._rows, self._held.row]),
                    np.concatenate([self._columns, self._held.col]),
                ),
            ),
            shape=(self.size, self.size),
        )
        constant, with_loads, with_supports = self._constants
        held = self._held @ state.ravel() + constant + t * with_loads + supports * with_supports
        held[: residual.size] = residual.ravel()
        return held, matrix

    def _conditions(self) -> tuple[scipy.sparse.coo_matrix, Array]:
        """Continuity and balance at the breaks, supports in place of balance where they hold.

        They are linear: a matrix, and what is added to its product with the state: always, times
        the loads' factor, times the supports'.
        """
        row = self.pieces * (self.order - 1) * 6
        entries: list[tuple[int, int, float]] = []
        constants = np.zeros((3, self.size))
        angles = self.drawn()[..., THETA]
        unit = self.F * self.L
        for i, place in self._places():
            left = (i - 1, self.order - 1) if i > 0 else None
            after = (i, 0) if i < self.pieces else None
            here = left if left is not None else after
            assert here is not None
            position = self.rod.curve(self.breaks[i : i + 1])[0][0] / self.L
            angle = angles[here]

            def add(terms: list[tuple[tuple[int, int] | None, int, float]], *right: float) -> None:
                nonlocal row
                for where, variable, factor in terms:
                    if where is not None:
                        entries.append((row, self._unknown[where][variable], factor))
                constants[:, row] = right
                row += 1

            if left is not None and after is not None:
                for v in (X, Y, THETA):
                    add([(left, v, 1.0), (after, v, -1.0)], 0.0, 0.0, 0.0)
            for v, n in ((X, NX), (Y, NY)):
                if place.fix[v]:
                    add([(here, v, 1.0)], -position[v], 0.0, -place.shift[v] / self.L)
                    continue
                k = place.spring[v] * self.L / self.F
                # The weight of a point mass acts like a force.
                force = (place.force[v] + place.mass * self.rod.gravity[v]) / self.F
                balance = [(here, v, -k), (after, n, 1.0), (left, n, -1.0)]
                add(balance, k * position[v], force, k * place.anchor_shift[v] / self.L)
            if place.clamp:
                add([(here, THETA, 1.0)], -angle, 0.0, -place.turn)
            else:
                k = place.torsion / unit
                balance = [(here, THETA, -k), (after, M, 1.0), (left, M, -1.0)]
                add(balance, k * angle, place.moment / unit, 0.0)
        rows, columns, values = zip(*entries, strict=True)
        shape = (self.size, self.size)
        return scipy.sparse.coo_matrix((values, (rows, columns)), shape=shape), constants

    def drawn_angle(self, i: int) -> float:
        """The direction of the drawn shape at break ``i``, counted continuously along the rod."""
        angles = self.drawn()[..., THETA]
        return float(angles[i, 0] if i < self.pieces else angles[-1, -1])

    # -- solving ----------------------------------------------------------------------------------

    def newton(
        self,
        state: Array,
        t: float = 1.0,
        supports: float = 1.0,
        limit: int = 12,
        longest: float = np.inf,
    ) -> Array:
        """The solution near ``state``, in steps that turn no section by more than ``longest``."""
        state = state.copy()
        last = np.inf
        for _ in range(limit):
            residual, matrix = self.equations(state, t, supports)
            if not np.isfinite(residual).all():
                raise NoSolutionError
            try:
                step = scipy.sparse.linalg.splu(matrix).solve(residual)
            except RuntimeError as error:
                raise NoSolutionError from error
            step = step.reshape(state.shape)
            size = float(
                (np.abs(step).max(axis=(0, 1)) / (1 + np.abs(state).max(axis=(0, 1)))).max()
            )
            turn = float(np.abs(step[..., THETA]).max())
            if not np.isfinite(size) or turn > max(6.0, 100 * longest):
                raise NoSolutionError
            state -= step * min(1.0, longest / max(turn, 1e-300))
            if size < 1e-13 or (size < 1e-9 and size >= 0.3 * last):
                return state
            last = size
        if last < 1e-10:
            return state
        raise NoSolutionError

    def follow(self, *, loads: bool = True, supports: bool = True) -> Array:
        """The solution that loads and motions, growing together from nothing, lead to."""
        state = self.drawn()
        t, step = 0.0, 0.25
        before: tuple[float, Array] | None = None
        while t < 1.0:
            trial = min(1.0, t + step)
            guess = state
            if before is not None:
                guess = state + (state - before[1]) * (trial - t) / (t - before[0])
            try:
                new = self.newton(guess, trial * loads, trial * supports, limit=8)
                if np.abs(new - state)[..., :3].max() > 0.5:
                    raise NoSolutionError
            except NoSolutionError:
                step /= 2
                if step < 1e-4:
                    raise
                continue
            before, t, state = (t, state), trial, new
            step *= 1.6
        return state

    def vibrations(self, state: Array, t: float = 1.0, supports: float = 1.0) -> Array:
        """The squares of all angular frequencies [1/s^2] about the equilibrium ``state``, rising.

        From ``J v = -w^2 B v``, ``J`` the Jacobian above and ``B`` the inertia in the balance.
        """
        _, matrix = self.equations(state, t, supports)
        whole = self.rod.mass_per_length * self.length
        n, k = self.pieces, self.order
        row = np.arange(n * (k - 1) * 6).reshape(n, k - 1, 6)
        rows, columns, values = [], [], []  # inertia
        for v, balance in ((X, NX), (Y, NY)):
            shape = (n, k - 1, k)
            rows.append(np.broadcast_to(row[:, :, balance, None], shape).ravel())
            columns.append(np.broadcast_to(self._unknown[:, None, :, v], shape).ravel())
            weights = self.metric[:, :, None] * self.at_gauss[None]
            values.append(weights.ravel())
        at = n * (k - 1) * 6
        for i, place in self._places():
            at += 3 if 0 < i < n else 0
            here = (i - 1, k - 1) if i > 0 else (i, 0)
            for v in (X, Y):
                if place.mass and not place.fix[v]:
                    rows.append(np.array([at + v]))
                    columns.append(np.array([self._unknown[here][v]]))
                    values.append(np.array([place.mass / whole]))
            at += 3
        inertia = scipy.sparse.csc_matrix(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
            shape=matrix.shape,
        )
        # Arnoldi's method on (J - shift B)^-1 B; the largest eigenvalues are the lowest squares.
        shift = 1.0
        factor = scipy.sparse.linalg.splu((matrix - shift * inertia).tocsc())
        moving = np.unique(np.concatenate(columns))
        operator = scipy.sparse.linalg.LinearOperator(
            (len(moving), len(moving)),
            matvec=lambda v: factor.solve(inertia[:, moving] @ np.ravel(v))[moving],
            dtype=np.float64,
        )
        start = np.sin(1.0 + np.arange(len(moving)))  # the same on every run
        eigenvalues = scipy.sparse.linalg.eigs(
            operator, k=min(14, len(moving) - 2), v0=start, return_eigenvectors=False
        )
        squares = -1.0 / eigenvalues - shift
        real = np.abs(squares.imag) < 1e-6 * (1 + np.abs(squares))
        return np.asarray(np.sort(squares[real].real) * self.F / (whole * self.L))

    # -- reading ----------------------------------------------------------------------------------

    def read(self, state: Array, u: float, side: int = 1) -> Array:
        """``x, y, theta, nx, ny, M`` in SI units at ``u``; at a break, on that ``side`` of it."""
        i = int(np.searchsorted(self.breaks, u, side="right" if side > 0 else "left")) - 1
        i = min(max(i, 0), self.pieces - 1)
        middle = (self.breaks[i] + self.breaks[i + 1]) / 2
        at = np.array([(u - middle) / self.half[i]])
        row = _interpolation(self.nodes, self.weights, np.clip(at, -1, 1))[0]
        units = np.array([self.L, self.L, 1.0, self.F, self.F, self.F * self.L])
        return np.asarray((row @ state[i]) * units)

    def quantity(self, state: Array, name: str, u: float, side: int = 1) -> float:
        x, y, theta, nx, ny, moment = self.read(state, u, side)
        tension = nx * np.cos(theta) + ny * np.sin(theta)
        if name in ("x", "y"):
            return float(x if name == "x" else y)
        if name in ("strain", "tension"):
            return float(tension if name == "tension" else tension / self.rod.EA)
        if name == "moment":
            return float(moment)
        assert name == "curvature"
        at = np.array([u])
        rest = self.rod.curve(at)[2] if self.rod.natural is None else self.rod.natural(at)
        return float(moment / self.rod.EI + rest[0])

    def extreme(self, state: Array, name: str, reduce: str) -> float:
        """The least or greatest value along the rod: fine samples, then a parabola."""
        sign = 1.0 if reduce == "max" else -1.0
        best = -np.inf
        for i in range(self.pieces):
            a, b = self.breaks[i], self.breaks[i + 1]
            grid = np.linspace(a, b, 25)
            inner = [self.quantity(state, name, u, 1) for u in grid[:-1]]
            values = sign * np.array([*inner, self.quantity(state, name, b, -1)])
            k = int(values.argmax())
            best = max(best, float(values[k]))
            if 0 < k < 24:
                from scipy.optimize import minimize_scalar

                found = minimize_scalar(
                    lambda u: -sign * self.quantity(state, name, float(u)),
                    bounds=(grid[k - 1], grid[k + 1]),
                    method="bounded",
                    options={"xatol": 1e-9 * (b - a)},
                )
                best = max(best, -float(found.fun))
        return sign * best

    def energy(self, state: Array, name: str, weight_factor: float = 1.0) -> float:
        """Energies in J, by Gauss quadrature; gravity times ``weight_factor``."""
        g = np.einsum("ik,nkv->niv", self.at_gauss, state)
        weight = self.metric * self.quadrature
        unit = self.F * self.L
        if name == "stretch_energy":
            tension = g[..., NX] * np.cos(g[..., THETA]) + g[..., NY] * np.sin(g[..., THETA])
            return float((weight * tension**2).sum() / 2 * self.stretch * unit)
        if name == "bend_energy":
            return float((weight * g[..., M] ** 2).sum() / 2 * unit)
        if name == "spring_energy":
            return self._spring_energy(state)
        if name == "gravity_energy":
            pull = weight_factor * np.array(self.rod.gravity)
            mass = self.rod.mass_per_length * self.L
            total = -mass * self.L * float((weight[..., None] * g[..., :2] * pull).sum())
            for i, place in self._places():
                if place.mass:
                    total -= place.mass * float(self.read(state, self.breaks[i])[:2] @ pull)
            return total
        elastic = ("stretch_energy", "bend_energy", "spring_energy")
        if name == "elastic_energy":
            return sum(self.energy(state, part) for part in elastic)
        assert name == "total_energy"
        everything = (*elastic, "gravity_energy")
        return sum(self.energy(state, part, weight_factor) for part in everything)

    def _spring_energy(self, state: Array) -> float:
        g = np.einsum("ik,nkv->niv", self.at_gauss, state)
        moved = self.bedding * (g[..., :2] - self.position_drawn) ** 2
        weight = self.metric * self.quadrature
        total = float((weight[..., None] * moved).sum() / 2 * self.F * self.L)
        for i, place in self._places():
            x, y, theta, *_ = self.read(state, self.breaks[i])
            position, *_ = self.rod.curve(np.array([self.breaks[i]]))
            for v, now in ((X, x), (Y, y)):
                gap = now - float(position[0, v]) - place.anchor_shift[v]
                total += place.spring[v] * gap**2 / 2
            total += place.torsion * (theta - self.drawn_angle(i)) ** 2 / 2
        return total
