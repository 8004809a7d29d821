"""Two-point boundary value problems to rounding error: Chebyshev collocation on segments.

    y_k'(s) = f_k(s, y_k, p)   on segment k,      g(y at all segment ends, p) = 0

Every y_k (m components) is a polynomial of degree n on its segment, held at the n + 1
Chebyshev-Lobatto points; the equation is imposed at the n Chebyshev points of the first kind,
so that m conditions a segment are left for `g`, plus one for each unknown parameter p
(rectangular collocation: Driscoll and Hale, IMA J. Numer. Anal. 36, 2016). Newton with
complex-step Jacobians. Converges faster than any power of n for smooth solutions: the
error bar of a number is its change when n grows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from .record import Array

Numbers = NDArray[Any]  # real, or complex while a Jacobian is taken
Rate = Callable[[int, Array, Numbers, Numbers], Numbers]
Ends = Callable[[Numbers, Numbers, Numbers], Numbers]

_STEP = 1e-40


def lobatto(degree: int) -> Array:
    """Chebyshev-Lobatto points on [0, 1], increasing, shape (degree + 1,)."""
    points: Array = 0.5 - 0.5 * np.cos(np.pi * np.arange(degree + 1) / degree)
    return points


def _weights(degree: int) -> Array:
    """Barycentric weights of the Lobatto points."""
    weights: Array = np.where(np.arange(degree + 1) % 2 == 0, 1.0, -1.0)
    weights[0] *= 0.5
    weights[-1] *= 0.5
    return weights


def interpolation(degree: int, at: Array) -> Array:
    """Matrix from values at the Lobatto points to values at `at` in [0, 1]."""
    gap = at[:, None] - lobatto(degree)[None, :]
    hit = gap == 0.0
    terms = _weights(degree) / np.where(hit, 1.0, gap)
    rows: Array = np.asarray(terms / terms.sum(axis=1, keepdims=True), dtype=float)
    exact_row = hit.any(axis=1)
    rows[exact_row] = hit[exact_row]
    return rows


def differentiation(degree: int) -> Array:
    """Matrix from values to derivatives, both at the Lobatto points of [0, 1]."""
    weights = _weights(degree)
    angle = np.pi * np.arange(degree + 1) / degree
    # x_i - x_j without cancellation
    gap = np.sin((angle[:, None] + angle) / 2.0) * np.sin((angle[:, None] - angle) / 2.0)
    np.fill_diagonal(gap, 1.0)
    matrix: Array = weights[None, :] / weights[:, None] / gap
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


@dataclass(frozen=True)
class Solution:
    """Values at the Lobatto points, shape (segments, m, n + 1), and the parameters (p,)."""

    breaks: Array
    values: Array
    parameters: Array

    def at(self, s: Array) -> Array:
        """The m components at positions `s`, shape (m, len(s))."""
        k = np.clip(np.searchsorted(self.breaks, s, side="right") - 1, 0, len(self.values) - 1)
        out = np.empty((self.values.shape[1], len(s)))
        for segment in range(len(self.values)):
            mine = k == segment
            left, right = self.breaks[segment], self.breaks[segment + 1]
            rows = interpolation(self.values.shape[2] - 1, (s[mine] - left) / (right - left))
            out[:, mine] = self.values[segment] @ rows.T
        return out

    def points(self) -> Array:
        """Positions of all Lobatto points, shape (segments, n + 1)."""
        fractions = lobatto(self.values.shape[2] - 1)
        points: Array = self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * fractions
        return points

    def resampled(self, degree: int) -> Solution:
        """The same polynomials held at more (or fewer) points: a start for another degree."""
        rows = interpolation(self.values.shape[2] - 1, lobatto(degree))
        return replace(self, values=self.values @ rows.T)


@dataclass(frozen=True)
class Boundary:
    """The problem: `rate(k, s, y, p)` with y of shape (m, points) returns y' (m, points);
    `ends(left, right, p)`, with values at both ends of the segments, shape (segments, m),
    returns its segments * m + len(p) residuals (one fewer for a curve, `continuation.py`).
    """

    rate: Rate
    ends: Ends

    def residual(self, trial: Solution) -> tuple[Array, Array]:
        """Residual and Jacobian with respect to (values, parameters), flattened."""
        parts = [self._segment_rows(trial, k) for k in range(len(trial.values))]
        first, last = trial.values[:, :, 0], trial.values[:, :, -1]
        parts.append((self.ends(first, last, trial.parameters), self._end_rows(trial)))
        return np.concatenate([r for r, _ in parts]), np.concatenate([j for _, j in parts])

    def _segment_rows(self, trial: Solution, k: int) -> tuple[Array, Array]:
        """y' - f on segment k and its derivatives, equation by equation."""
        segments, m, points = trial.values.shape
        degree = points - 1
        nodes = 0.5 - 0.5 * np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
        sample = interpolation(degree, nodes)
        slope = sample @ differentiation(degree)
        left, length = trial.breaks[k], trial.breaks[k + 1] - trial.breaks[k]
        s = left + length * nodes
        p = trial.parameters
        y = trial.values[k] @ sample.T
        residual = trial.values[k] @ slope.T - length * self.rate(k, s, y, p)

        # All components are bumped at once, each in a copy of the points.
        bumped = np.repeat(y.astype(complex)[:, None], m, axis=1)
        bumped[np.arange(m), np.arange(m)] += 1j * _STEP
        partial = self.rate(k, np.tile(s, m), bumped.reshape(m, -1), p).imag / _STEP
        partial = partial.reshape(m, m, degree)
        by_values = np.zeros((m, degree, segments, m, points))
        for c in range(m):
            by_values[:, :, k, c, :] -= length * partial[:, c, :, None] * sample
            by_values[c, :, k, c, :] += slope
        by_parameters = np.zeros((m, degree, len(p)))
        for j in range(len(p)):
            bumped_p = p.astype(complex)
            bumped_p[j] += 1j * _STEP
            partial = self.rate(k, s, y.astype(complex), bumped_p).imag / _STEP
            by_parameters[:, :, j] = -length * partial
        rows = m * degree
        jacobian = np.hstack([by_values.reshape(rows, -1), by_parameters.reshape(rows, -1)])
        return residual.ravel(), jacobian

    def _end_rows(self, trial: Solution) -> Array:
        segments, m, points = trial.values.shape
        first, last = trial.values[:, :, 0], trial.values[:, :, -1]
        p = trial.parameters
        columns: dict[int, Array] = {}
        for k in range(segments):
            for c in range(m):
                bump = np.zeros((segments, m), dtype=complex)
                bump[k, c] = 1j * _STEP
                place = (k * m + c) * points
                columns[place] = self.ends(first + bump, last + 0j, p + 0j).imag / _STEP
                columns[place + points - 1] = (
                    self.ends(first + 0j, last + bump, p + 0j).imag / _STEP
                )
        for j in range(len(p)):
            bump_p = np.zeros(len(p), dtype=complex)
            bump_p[j] = 1j * _STEP
            columns[trial.values.size + j] = (
                self.ends(first + 0j, last + 0j, p + bump_p).imag / _STEP
            )
        out = np.zeros((len(columns[0]), trial.values.size + len(p)))
        for place, column in columns.items():
            out[:, place] = column
        return out

    def shooting_gap(self, solution: Solution) -> float:
        """An independent check: integrate every segment from its left end with DOP853 at
        rtol 1e-13; the largest mismatch at the right ends.
        """
        worst = 0.0
        for k, values in enumerate(solution.values):

            def slope(s: float, y: Array, k: int = k) -> Array:
                rate: Array = self.rate(k, np.array([s]), y[:, None], solution.parameters)[:, 0]
                return rate

            span = (solution.breaks[k], solution.breaks[k + 1])
            run = solve_ivp(slope, span, values[:, 0], method="DOP853", rtol=1e-13, atol=1e-15)
            worst = max(worst, float(np.abs(run.y[:, -1] - values[:, -1]).max()))
        return worst

    def solve(self, start: Solution, tolerance: float = 1e-12, iterations: int = 60) -> Solution:
        """Newton with step halving until the step is below `tolerance`, relative to the
        largest unknown, and stops shrinking (rounding).
        """
        trial, previous = start, np.inf
        residual, jacobian = self.residual(trial)
        for _ in range(iterations):
            step: Array = np.asarray(np.linalg.solve(jacobian, -residual), dtype=float)
            size = float(np.abs(step).max())
            scale = max(1.0, float(np.abs(flat(trial)).max()))
            if size < tolerance * scale and size > 0.5 * previous:
                return trial
            previous = size
            share, norm = 1.0, float(np.linalg.norm(residual))
            while True:
                candidate = moved(trial, share * step)
                residual, jacobian = self.residual(candidate)
                if np.linalg.norm(residual) < norm or size < 1e-6 * scale or share < 1e-3:
                    break
                share *= 0.5
            trial = candidate
        if previous < tolerance * scale:
            return trial
        raise RuntimeError(f"collocation: Newton step {previous:.1e} after {iterations} iterations")


def flat(solution: Solution) -> Array:
    """All unknowns in one vector: values, then parameters."""
    return np.concatenate([solution.values.ravel(), solution.parameters])


def moved(solution: Solution, step: Array) -> Solution:
    """The solution with `step` added to its unknowns."""
    count = solution.values.size
    return replace(
        solution,
        values=solution.values + step[:count].reshape(solution.values.shape),
        parameters=solution.parameters + step[count:],
    )


def constant_start(breaks: Array, value: Array, parameters: Array, degree: int) -> Solution:
    """A start whose components are constant along s."""
    values = np.empty((len(breaks) - 1, len(value), degree + 1))
    values[:] = value[None, :, None]
    return Solution(np.asarray(breaks, dtype=float), values, np.asarray(parameters, dtype=float))
