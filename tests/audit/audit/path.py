"""Paths of equilibria by pseudo-arclength continuation of the boundary value problem.

H. B. Keller, Numerical solution of bifurcation and nonlinear eigenvalue problems (1977).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from scipy.interpolate import BarycentricInterpolator
from scipy.optimize import brentq

from .case import UnsolvedError
from .rod import Array, Mesh, NoSolutionError

Point = tuple[Array, float, Array]  # state, factor, tangent of both


@dataclasses.dataclass
class Event:
    """A fold, a bifurcation, or the end of a path."""

    kind: str
    state: Array
    factor: float


class Path:
    """The path that starts without load; ``vary`` is ``loads`` or ``supports``."""

    def __init__(self, mesh: Mesh, to: float, vary: str):
        self.mesh, self.to, self.vary = mesh, to, vary
        weights = np.zeros((mesh.pieces, mesh.order, 6))
        weights[..., :3] = 1.0
        drawn = (
            mesh.drawn()
        )  # the equations are affine in the factor, and the state has no part in it
        self.column = (
            mesh.equations(drawn, *self._factors(1.0))[0]
            - mesh.equations(drawn, *self._factors(0.0))[0]
        )
        self.weights = np.append(weights.ravel() / weights.sum(), 1.0 / to**2)

    def events(self, step: float = 0.08, limit: int = 400) -> list[Event]:
        """Folds and bifurcations in their order along the path, and the end."""
        point = self._start()
        count = self._unstable(point)
        found: list[Event] = []
        for _ in range(limit):
            trial = step
            while True:
                try:
                    after = self._next(point, trial)
                    if (self.weights * point[2]) @ after[2] > 0.95:
                        break
                except NoSolutionError:
                    pass
                trial /= 2
                if trial < 1e-6:
                    raise UnsolvedError("the path was lost")
            if abs(after[1]) >= self.to:
                goal = self.to if after[1] > 0 else -self.to
                at = self._where(point, trial, _beyond(goal))
                kind = "end" if goal > 0 else "opposite limit"
                # The last stretch may hold an event as well: it ends beyond the goal.
                last = [
                    e for e in self._between(point, trial, after, count) if abs(e.factor) < self.to
                ]
                return [*found, *last, Event(kind, at[0], goal)]
            found += self._between(point, trial, after, count)
            count = self._unstable(after)
            point = after
        raise UnsolvedError("the path does not end")

    def _between(self, point: Point, step: float, after: Point, count: int) -> list[Event]:
        folds = point[2][-1] * after[2][-1] < 0
        changed = self._unstable(after) - count
        found = []
        if folds:
            at = self._where(point, step, lambda p: float(p[2][-1]))
            found.append(Event("fold", at[0], at[1]))
            if abs(changed) != 1:
                raise UnsolvedError("events too close for the reference")
        elif changed:
            if abs(changed) != 1:
                raise UnsolvedError("events too close for the reference")
            index = min(count, self._unstable(after))
            at = self._where(point, step, lambda p: float(self._squares(p)[index]))
            found.append(Event("bifurcation", at[0], at[1]))
        return found

    def _where(self, point: Point, step: float, function: Callable[[Point], float]) -> Point:
        """Where the function is 0 within the step, by polynomials through Chebyshev points.

        None of them is likely to hit a bifurcation, where Newton's matrix is singular.
        """
        lengths = step * (1 - np.cos(np.pi * np.arange(9) / 8)) / 2
        points = [point] + [self._next(point, float(s)) for s in lengths[1:]]
        values = BarycentricInterpolator(lengths, [function(p) for p in points])
        length = float(brentq(lambda s: float(values(s)), 0.0, step, xtol=1e-14))
        states = BarycentricInterpolator(lengths, np.array([p[0] for p in points]))
        factors = BarycentricInterpolator(lengths, [p[1] for p in points])
        return states(length), float(factors(length)), point[2]

    def _squares(self, point: Point) -> Array:
        return self.mesh.vibrations(point[0], *self._factors(point[1]))

    def _unstable(self, point: Point) -> int:
        return int((self._squares(point) < 0).sum())

    def _factors(self, factor: float) -> tuple[float, float]:
        return (factor, 1.0) if self.vary == "loads" else (1.0, factor)

    def _system(self, state: Array, factor: float) -> tuple[Array, scipy.sparse.csc_matrix, Array]:
        residual, matrix = self.mesh.equations(state, *self._factors(factor))
        return residual, matrix, self.column

    def _start(self) -> Point:
        if self.vary == "loads":
            state = self.mesh.newton(self._supports_only(), 0.0, 1.0)
        else:
            state = self.mesh.follow(supports=False)
        _, matrix, column = self._system(state, 0.0)
        along = scipy.sparse.linalg.spsolve(matrix, -column)
        return state, 0.0, self._unit(np.append(along, 1.0))

    def _supports_only(self) -> Array:
        return self.mesh.follow(loads=False)

    def _unit(self, tangent: Array) -> Array:
        return np.asarray(tangent / np.sqrt((self.weights * tangent) @ tangent))

    def _next(self, point: Point, step: float) -> Point:
        before, factor, tangent = point
        state = before + step * tangent[:-1].reshape(before.shape)
        factor = factor + step * tangent[-1]
        row = self.weights * tangent
        last = np.inf
        for _ in range(15):
            residual, matrix, column = self._system(state, factor)
            gone = np.append((state - before).ravel(), factor - point[1])
            right = np.append(residual, row @ gone - step)
            bordered = scipy.sparse.bmat(
                [[matrix, column[:, None]], [row[None, :-1], row[None, -1:]]], format="csc"
            )
            solve = scipy.sparse.linalg.splu(bordered)
            change = solve.solve(right)
            if not np.isfinite(change).all():
                raise NoSolutionError
            state = state - change[:-1].reshape(state.shape)
            factor -= change[-1]
            size = float(np.sqrt((self.weights * change) @ change))
            if size < 1e-12 or (size < 1e-8 and size > 0.3 * last):
                unit = np.zeros(len(change))
                unit[-1] = 1.0
                after = self._unit(solve.solve(unit))
                sign = np.sign((self.weights * tangent) @ after)
                return state, float(factor), after * sign
            if size > 10 * last:
                raise NoSolutionError
            last = size
        raise NoSolutionError


def _beyond(goal: float) -> Callable[[Point], float]:
    return lambda point: point[1] - goal
