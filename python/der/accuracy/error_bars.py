"""Error bars from a value on a sequence of refined meshes or steps.

The bar is Roache's grid convergence index: the error by Richardson's extrapolation times a safety
factor (P. J. Roache, Perspective: a method for uniform reporting of grid refinement studies, J.
Fluids Eng. 116, 1994, 405-413). Factor and order follow the rule of W. L. Oberkampf and C. J. Roy
(Verification and Validation in Scientific Computing, 2010, section 8.7): 1.25 and the formal order
where the observed order is within 10 % of it, otherwise 3 and the observed order, held between 1/2
and the formal one. Where the values go to and fro, the bar is three times their range (L. Eca and
M. Hoekstra, J. Comput. Phys. 262, 2014, 104-130).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

#: What was found out about a sequence:
#:
#: - ``converged``: at the expected order or faster;
#: - ``exact``: refining changes nothing beyond rounding;
#: - ``two levels``: the order could not be measured, since only one refinement was done;
#: - ``slow``: converges at less than three quarters of the expected order;
#: - ``diverging``: the changes grow;
#: - ``oscillating``: the value goes to and fro;
#: - ``damped``: the stepper's own damping hides a motion;
#: - ``contradicted``: another stepper with much smaller steps comes to another value;
#: - ``failed``: a finer run failed;
#: - ``unmatched``: finer meshes find another number of its kind, such as folds of a path.
Verdict = Literal[
    "converged",
    "exact",
    "two levels",
    "slow",
    "diverging",
    "oscillating",
    "damped",
    "contradicted",
    "failed",
    "unmatched",
]

_FLAGGED = ("slow", "diverging", "oscillating", "damped", "contradicted", "failed", "unmatched")

_FACTOR_AT_ORDER = 1.25
_FACTOR_OFF_ORDER = 3.0
_NEAR_ORDER = 0.1  # of the expected order
_SLOW = 0.75  # of the expected order
_LEAST_ORDER = 0.5


@dataclass(frozen=True)
class ErrorEstimate:
    """The error of a value that comes from one kind of refinement, in space or in time.

    Attributes
    ----------
    correction
        Richardson's: what is to be added to the value to come to the limit of the sequence.
    bar
        The error is at most this large, with 95 % confidence; infinite if it is not known.
    order
        Observed order of convergence; None with fewer than two refinements, or without change.
    expected_order
        Order that the method has for smooth solutions.
    verdict
        What was found out; see `Verdict`.
    """

    correction: float
    bar: float
    order: float | None
    expected_order: float
    verdict: Verdict

    @property
    def flagged(self) -> bool:
        """Whether the sequence does not converge as it should."""
        return self.verdict in _FLAGGED

    def widened(self, bar: float, correction: float = 0.0) -> ErrorEstimate:
        """Return an estimate with a correction and a bar added."""
        return replace(self, bar=self.bar + bar, correction=self.correction + correction)


def estimate_error(
    values: Sequence[float], order: float, noise: float = 0.0, ratio: float = 2.0
) -> ErrorEstimate:
    """Estimate the error of the first of a sequence of values, each on a finer level.

    Parameters
    ----------
    values
        Two or three values, coarsest first.
    order
        Expected order of convergence.
    noise
        Differences up to this say nothing: rounding, and Newton's tolerance.
    ratio
        How many times finer each level is than the one before.

    Raises
    ------
    ValueError
        For fewer than two or more than three values.
    """
    if not 2 <= len(values) <= 3:
        raise ValueError(f"expected two or three values, got {len(values)}")
    first = values[1] - values[0]
    second = values[-1] - values[1]
    if max(abs(first), abs(second)) <= noise:
        return ErrorEstimate(first + second, noise, None, order, "exact")
    if len(values) == 2:
        correction = first + first / (ratio**order - 1.0)
        return ErrorEstimate(
            correction, _FACTOR_OFF_ORDER * abs(correction) + noise, None, order, "two levels"
        )
    if abs(second) <= noise:  # the first refinement has removed the error
        return ErrorEstimate(
            first + second, _FACTOR_OFF_ORDER * abs(first) + noise, None, order, "converged"
        )
    if first * second <= 0.0:
        bar = _FACTOR_OFF_ORDER * max(abs(first), abs(second)) + noise
        return ErrorEstimate(first + second, bar, None, order, "oscillating")
    return _monotone(first, second, order, noise, ratio)


def estimate_from_levels(
    by_level: Mapping[int, float], order: float, noise: float, ratio: float = 2.0
) -> ErrorEstimate:
    """Estimate the error of the value on level 0, as `estimate_error`.

    Levels behind one that is missing do not count; with less than two the error is not known.
    """
    values: list[float] = []
    while len(values) in by_level:
        values.append(by_level[len(values)])
    if len(values) < 2:
        return unknown_error("failed", order)
    return estimate_error(values, order, noise, ratio)


def unknown_error(verdict: Verdict, order: float) -> ErrorEstimate:
    """Return an estimate that says nothing but why it does not."""
    return ErrorEstimate(0.0, math.inf, None, order, verdict)


def _monotone(
    first: float, second: float, order: float, noise: float, ratio: float
) -> ErrorEstimate:
    observed = math.log(first / second) / math.log(ratio)
    near = abs(observed - order) <= _NEAR_ORDER * order
    used = order if near else min(max(observed, _LEAST_ORDER), order)
    factor = _FACTOR_AT_ORDER if near else _FACTOR_OFF_ORDER
    correction = first + second + second / (ratio**used - 1.0)
    verdict: Verdict = "converged"
    if observed <= 0.0:
        verdict = "diverging"
    elif observed < _SLOW * order:
        verdict = "slow"
    return ErrorEstimate(correction, factor * abs(correction) + noise, observed, order, verdict)
