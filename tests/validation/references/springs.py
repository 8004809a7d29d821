"""Elastic supports of the inextensible planar elastica (`elastica.py`) of length 1 with EI = 1.

A rod turns about its start against a spring of stiffness k and carries a dead load P at its tip,
across the direction in which the spring is without a moment (theta positive along the load):

    theta'' = -P cos theta,   theta'(0) = k theta(0),   theta'(1) = 0

by Chebyshev collocation, with continuation in P from the straight rod.
"""

from __future__ import annotations

import numpy as np

from .collocation import Boundary, Numbers, constant_start
from .record import Array, Problem, Reference, refined


def elastic_clamp(stiffness: float, load: float, degree: int) -> tuple[float, float]:
    """Tip of the rod, along its unloaded direction and along the load."""
    solution = constant_start(np.array([0.0, 1.0]), np.zeros(4), np.zeros(0), degree)

    def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
        return np.array([left[0, 0], left[0, 1], left[0, 3] - stiffness * left[0, 2], right[0, 3]])

    for level in np.linspace(0.0, load, max(2, int(4 * load)))[1:]:

        def rate(_k: int, _s: Array, y: Numbers, _p: Numbers, level: float = level) -> Numbers:
            theta, bend = y[2], y[3]
            return np.stack([np.cos(theta), np.sin(theta), bend, -level * np.cos(theta)])

        solution = Boundary(rate, ends).solve(solution)
    x, y, _angle, _bend = solution.values[-1, :, -1]
    return float(x), float(y)


def references() -> Problem:
    """Tips of elastically clamped rods."""
    values: dict[str, Reference] = {}
    for stiffness in (1.0, 20.0):
        for load in (1.0, 10.0):
            fine, coarse = (elastic_clamp(stiffness, load, degree) for degree in (60, 40))
            label = f"elastic_clamp.{stiffness:g}.load.{load:g}"
            for name, value, other in zip("xy", fine, coarse, strict=True):
                values[f"{label}.{name}"] = refined(value, other, "L", 1e-13)
    return Problem(
        "springs",
        "inextensible elastica of length 1 with EI = 1 that turns about its start against a spring "
        "of stiffness k (EI/L), dead load at the tip; y along the load",
        "Chebyshev collocation, degree 60, error: twice the change from degree 40",
        values,
    )
