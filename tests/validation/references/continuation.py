"""Curves of solutions of a boundary value problem with one parameter more than conditions:
pseudo-arclength continuation (Keller, in Applications of Bifurcation Theory, 1977).

`Boundary.ends` returns one residual fewer than `collocation` asks for; the distance along the
tangent closes the system. Folds and other special points are found on the curve to
rounding, as zeros of a function of the arclength.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from .collocation import Boundary, Solution, flat, moved
from .record import Array

_LEAST_COSINE = 0.95  # between tangents of neighbouring points


@dataclass(frozen=True)
class Point:
    """A solution on the curve and the unit tangent there (values, then parameters)."""

    solution: Solution
    tangent: Array

    def rate(self, parameter: int) -> float:
        """Component of the tangent along a parameter: zero at its folds."""
        count = len(self.solution.parameters)
        return float(self.tangent[len(self.tangent) - count + parameter])


@dataclass(frozen=True)
class Curve:
    """The curve of `problem`; `scales` are typical sizes of the parameters, so that the
    arclength weighs the mean square of the values and of the scaled parameters alike.
    """

    problem: Boundary
    scales: Array

    def _metric(self, solution: Solution) -> Array:
        values = np.full(solution.values.size, 1.0 / solution.values.size)
        return np.concatenate([values, 1.0 / self.scales**2])

    def begin(self, solution: Solution, towards: Array) -> Point:
        """Point at a solution; the tangent has a positive product with `towards`, a change
        of the parameters.
        """
        guess = np.concatenate([np.zeros(solution.values.size), towards])
        return Point(solution, self._tangent(solution, guess))

    def _tangent(self, solution: Solution, guess: Array) -> Array:
        _, jacobian = self.problem.residual(solution)
        metric = self._metric(solution)
        matrix = np.vstack([jacobian, metric * guess])
        right = np.zeros(len(matrix))
        right[-1] = 1.0
        tangent = np.linalg.solve(matrix, right)
        return np.asarray(tangent / np.sqrt(np.sum(metric * tangent**2)), dtype=float)

    def advance(self, point: Point, distance: float, tolerance: float = 1e-10) -> Point:
        """The point of the curve at `distance` along the tangent of `point`."""
        metric = self._metric(point.solution)
        row = metric * point.tangent
        trial = moved(point.solution, distance * point.tangent)
        previous = np.inf
        for _ in range(12):
            residual, jacobian = self.problem.residual(trial)
            gap = row @ (flat(trial) - flat(point.solution)) - distance
            change = np.linalg.solve(np.vstack([jacobian, row]), -np.append(residual, gap))
            step: Array = np.asarray(change, dtype=float)
            trial = moved(trial, step)
            size = float(np.sqrt(np.sum(metric * step**2)))
            if size < tolerance and size > 0.1 * previous:
                return Point(trial, self._tangent(trial, point.tangent))
            previous = size
        if previous < tolerance:
            return Point(trial, self._tangent(trial, point.tangent))
        raise RuntimeError(f"continuation: step of {distance:.1e} does not converge")

    def trace(self, start: Point, distance: float, until: Callable[[Point], bool]) -> list[Point]:
        """Points from `start` on, up to the first where `until` holds; `distance` apart, less
        where Newton or the turn of the tangent asks for it.
        """
        points, step = [start], distance
        while not until(points[-1]):
            metric = self._metric(points[-1].solution)
            try:
                new = self.advance(points[-1], step)
                bent = float(metric * new.tangent @ points[-1].tangent) < _LEAST_COSINE
            except RuntimeError:
                bent = True
            if bent:
                step *= 0.5
                if step < 1e-6 * distance:
                    raise RuntimeError("continuation: cannot go on along the curve")
                continue
            points.append(new)
            step = min(distance, 1.5 * step)
        return points

    def zeros(self, points: list[Point], of: Callable[[Point], float]) -> list[Point]:
        """Points of the curve where the function `of` changes sign."""
        found = []
        for left, right in pairwise(points):
            if of(left) * of(right) < 0.0:
                metric = self._metric(left.solution)
                gap = flat(right.solution) - flat(left.solution)
                reach = float(metric * left.tangent @ gap)

                def along(distance: float, base: Point = left) -> float:
                    return of(self.advance(base, distance))

                where = float(brentq(along, 0.0, reach, xtol=1e-13, rtol=1e-14))
                found.append(self.advance(left, where))
        return found
