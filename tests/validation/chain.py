"""A chain of bars and hinges of its own, in NumPy alone: paths and equilibria to count against.

Energy of a stress-free chain, with rest lengths l_i, lengths |e_i|, turning angles phi_j at the
inner nodes, Voronoi lengths v_j = (l_j + l_j+1) / 2 and one or more dead forces:

    sum EA / (2 l_i) (|e_i| - l_i)^2 + sum EI / (2 v_j) (phi_j - phi0_j)^2 - load * force . x

Its path is followed by tangents from a singular value decomposition, short steps and a Newton
iteration on the plane across the tangent; inertia comes from eigenvalues. Nothing of that is shared
with `der`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Chain:
    """Stress-free at `points`, shape (nodes, 2); `free` degrees of freedom are not held."""

    points: Array
    EA: float
    EI: float
    free: Array
    force: Array  # (nodes, 2), at load 1

    def gradient(self, x: Array) -> Array:
        """Gradient of the elastic energy, shape (..., dofs), at `x` (..., nodes, 2), or complex."""
        rest = np.diff(self.points, axis=0)
        rest_length = np.hypot(*rest.T)
        edge = np.diff(x, axis=-2)
        square = edge[..., 0] ** 2 + edge[..., 1] ** 2
        pull = (self.EA * (1 / rest_length - 1 / np.sqrt(square)))[..., np.newaxis] * edge
        voronoi = 0.5 * (rest_length[1:] + rest_length[:-1])
        moment = (self.EI / voronoi * (_turning(edge) - _turning(rest)))[..., np.newaxis]
        turn = np.stack([-edge[..., 1], edge[..., 0]], axis=-1) / square[..., np.newaxis]
        # Each moment turns the edge behind its node forward and the one before it back.
        pull[..., 1:, :] += moment * turn[..., 1:, :]
        pull[..., :-1, :] -= moment * turn[..., :-1, :]
        total = np.zeros_like(x)
        total[..., 1:, :] += pull
        total[..., :-1, :] -= pull
        return total.reshape(*x.shape[:-2], -1)

    def residual(self, u: Array, load: float) -> Array:
        """Unbalanced forces over the free degrees of freedom."""
        return (self.gradient(self.place(u)) - load * self.force.ravel())[self.free]

    def stiffness(self, u: Array) -> Array:
        """By complex steps, which lose no digits."""
        tiny = 1e-30
        moved = u + 1j * tiny * np.eye(len(u))
        return np.asarray(self.gradient(self.place(moved))[:, self.free].imag.T / tiny)

    def place(self, u: Array) -> Array:
        """All positions from the free ones, shape (..., nodes, 2)."""
        x = np.empty((*u.shape[:-1], self.points.size), dtype=u.dtype)
        x[...] = self.points.ravel()
        x[..., self.free] = u
        return x.reshape(*u.shape[:-1], -1, 2)

    @property
    def start(self) -> Array:
        return self.points.ravel()[self.free]

    def follow(self, to: float, step: float, scale: float, points: int = 4000) -> Path:
        """From the stress-free shape to load `to`; the load counts as load / `scale`."""
        u, load = self.start, 0.0
        tangent = np.zeros(len(u) + 1)
        tangent[-1] = 1.0
        path = []
        for _ in range(points):
            stiffness = self.stiffness(u)
            slope = np.column_stack([stiffness, -scale * self.force.ravel()[self.free]])
            null = np.linalg.svd(slope)[2][-1]
            tangent = null if null @ tangent > 0.0 else -null
            unstable = int(np.sum(np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T)) < 0.0))
            path.append((load, unstable, bool(tangent[-1] > 0.0), u))
            if load > to or load < -to:
                break
            u, load = self._next(u, load, tangent, step, scale)
        return Path(*map(list, zip(*path, strict=True)))

    def _next(
        self, u: Array, load: float, tangent: Array, step: float, scale: float
    ) -> tuple[Array, float]:
        """The next point, `step` ahead or, where Newton does not find it, less."""
        start = np.append(u, load / scale)
        now = start + step * tangent
        for _ in range(8):
            pushed = -scale * self.force.ravel()[self.free]
            slope = np.column_stack([self.stiffness(now[:-1]), pushed])
            miss = np.append(
                self.residual(now[:-1], scale * now[-1]), tangent @ (now - start) - step
            )
            change = np.linalg.solve(np.vstack([slope, tangent]), miss)
            now = now - change
            if np.linalg.norm(change) < 1e-8:  # the next one would be its square
                return now[:-1], float(scale * now[-1])
        return self._next(u, load, tangent, 0.5 * step, scale)

    def equilibria(self, load: float, starts: list[Array]) -> list[Array]:
        """All different ones that Newton finds from `starts`."""
        found: list[Array] = []
        for u in starts:
            for _ in range(60):
                change = np.linalg.solve(self.stiffness(u), self.residual(u, load))
                u = u - min(1.0, 0.1 / np.abs(change).max()) * change
                if np.abs(change).max() < 1e-12:
                    if all(np.abs(u - other).max() > 1e-6 for other in found):
                        found.append(u)
                    break
        return found


@dataclass(frozen=True)
class Path:
    """Points of a path in order."""

    load: list[float]
    unstable: list[int]
    rising: list[bool]
    shape: list[Array]

    def events(self) -> list[tuple[str, float]]:
        """Kind and load of each place where the load turns or the inertia changes.

        The load is that of a point near it; where both happen in one step, the fold comes first.
        """
        found = []
        for i in range(1, len(self.load)):
            turned = self.rising[i] != self.rising[i - 1]
            changes = abs(self.unstable[i] - self.unstable[i - 1])
            kinds = ["fold"] * turned + ["bifurcation"] * (changes - turned)
            found += [(kind, self.load[i]) for kind in kinds]
        return found


def _turning(edge: Array) -> Array:
    """Angles between neighbouring edges, below a quarter turn, so that they may be complex."""
    before, after = edge[..., :-1, :], edge[..., 1:, :]
    cross = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    return np.asarray(np.arctan(cross / np.sum(before * after, axis=-1)))


def pinned_chain(
    points: Array, EA: float, EI: float, force: dict[int, tuple[float, float]]
) -> Chain:
    """Both ends pinned, forces on nodes."""
    forces = np.zeros_like(points)
    for node, value in force.items():
        forces[node] = value
    return Chain(points, EA, EI, np.arange(2, points.size - 2), forces)
