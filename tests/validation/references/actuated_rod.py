"""Equilibria of a planar rod whose rest shape is changed on parts of it, by `solve_bvp`.

The energy a rest length is 1/2 EI (theta' - k)^2 + 1/2 EA e^2 with |r'| = 1 + a + e, where k is the
natural curvature, a the elongation and e the strain, so that, with the force n and the moment m
that the part beyond s exerts (Antman, Nonlinear Problems of Elasticity, ch. IV; the elongation is
a thermal strain),

    theta' = k + m/EI,  m' = -(1 + a + e) (n_y cos - n_x sin),  EA e = n_x cos + n_y sin,
    x' = (1 + a + e) cos,  y' = (1 + a + e) sin.

Each segment between borders has its six unknowns (theta, m, x, y, n_x, n_y) over 0 .. 1, so that
neither a jump of the rest shape nor a support is smeared.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_bvp

Array: TypeAlias = NDArray[np.float64]
Values: TypeAlias = Callable[[Array], Any]
Condition: TypeAlias = Callable[[Array], Sequence[float]]

ANGLE, MOMENT, X, Y = range(4)


def zero(_s: Array) -> float:
    return 0.0


def clamped(x: float = 0.0, y: float = 0.0, angle: float = 0.0) -> Condition:
    """The end of a segment at a clamp."""
    return lambda u: [u[ANGLE] - angle, u[X] - x, u[Y] - y]


def pinned(x: float, y: float = 0.0) -> Condition:
    """An end that may turn."""
    return lambda u: [u[MOMENT], u[X] - x, u[Y] - y]


def pulled(force: Sequence[float] = (0.0, 0.0), moment: float = 0.0) -> Condition:
    """A free end with a dead force and a moment."""
    return lambda u: [u[MOMENT] - moment, u[4] - force[0], u[5] - force[1]]


@dataclass(frozen=True)
class Segment:
    """A part of the rod, from border to border, and the smooth rest shape on it."""

    start: float
    end: float
    curvature: Values = zero
    elongation: Values = zero


@dataclass(frozen=True)
class Equilibrium:
    """The answer of a boundary value problem."""

    segments: Sequence[Segment]
    EI: float
    EA: float
    values: Callable[[float], Array]  # of a share of each segment

    def at(self, s: float, side: str = "after") -> dict[str, float]:
        """Everything at a rest arc length."""
        inside = [
            i for i, part in enumerate(self.segments) if part.start - 1e-12 <= s <= part.end + 1e-12
        ]
        number = inside[0] if side == "before" else inside[-1]
        part = self.segments[number]
        u = self.values((s - part.start) / (part.end - part.start))[6 * number : 6 * number + 6]
        tension = u[4] * np.cos(u[ANGLE]) + u[5] * np.sin(u[ANGLE])
        curvature = float(part.curvature(np.array(s))) + u[MOMENT] / self.EI
        found = {"x": u[X], "y": u[Y], "moment": u[MOMENT], "curvature": curvature}
        return found | {"tension": tension}


def solve(
    segments: Sequence[Segment],
    start: Condition,
    end: Condition,
    EA: float = np.inf,
    EI: float = 1.0,
    held: dict[int, Condition] | None = None,
    guess: Callable[[Array], Array] | None = None,
) -> Equilibrium:
    """The equilibrium; `held` are interior clamps, by the number of the segment that follows.

    `guess(s)` are values of (theta, m, x, y, n_x, n_y), shape (6, len(s)); without it the straight
    rod along x.
    """
    count = len(segments)

    def slopes(t: Array, u: Array) -> Array:
        rate = np.empty_like(u)
        for i, part in enumerate(segments):
            s = part.start + (part.end - part.start) * t
            rate[6 * i : 6 * i + 6] = (part.end - part.start) * rod_slopes(
                u[6 * i : 6 * i + 6], part.curvature(s), part.elongation(s), EA, EI
            )
        return rate

    def conditions(first: Array, last: Array) -> Array:
        rest = [*start(first[:6]), *end(last[-6:])]
        for i in range(1, count):
            before, after = last[6 * i - 6 : 6 * i], first[6 * i : 6 * i + 6]
            clamp = (held or {}).get(i)
            rest += [*clamp(before), *clamp(after)] if clamp else list(after - before)
        return np.array(rest)

    t = np.linspace(0.0, 1.0, 21)
    straight = guess or (lambda s: np.array([0 * s, 0 * s, s, 0 * s, 0 * s, 0 * s]))
    first = np.vstack([straight(part.start + (part.end - part.start) * t) for part in segments])
    found = solve_bvp(slopes, conditions, t, first, tol=1e-9, bc_tol=1e-12, max_nodes=20000)
    assert found.success, found.message
    return Equilibrium(segments, EI, EA, found.sol)


def rod_slopes(u: Array, curvature: Any, elongation: Any, EA: float, EI: float) -> Array:
    """Derivatives of the six unknowns with respect to rest arc length."""
    angle, moment, _, _, pull_x, pull_y = u
    cos, sin = np.cos(angle), np.sin(angle)
    length = 1.0 + elongation + (pull_x * cos + pull_y * sin) / EA
    return np.array(
        [
            curvature + moment / EI,
            -length * (pull_y * cos - pull_x * sin),
            length * cos,
            length * sin,
            0 * angle,
            0 * angle,
        ]
    )
