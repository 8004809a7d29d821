"""Error bars from a value on a sequence of refined meshes or steps.

The bar is Roache's grid convergence index: the error by Richardson's extrapolation times a safety
factor (P. J. Roache, Perspective: a method for uniform reporting of grid refinement studies, J.
Fluids Eng. 116, 1994, 405-413). Factor and order follow the rule of W. L. Oberkampf and C. J. Roy
(Verification and Validation in Scientific Computing, 2010, section 8.7): 1.25 and the formal order
where the observed order is within 10 % of it, otherwise 3 and the observed order, held between 1/2
and the formal one. Where the values go to and fro, the bar is three times their range (L. Eca and
M. Hoekstra, J. Comput. Phys. 262, 2014, 104-130).

A value may converge and yet show no order on three levels: two errors of opposite sign are enough.
Its changes still shrink, and three times their range contains the exact value. Such a value is
called settled and not flagged.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

#: The verdict on a sequence.
Verdict = Literal[
    "converged",  # at the expected order or faster
    "exact",  # refining changes nothing beyond rounding
    "compared",  # with one other way to draw the rods, which shows no order
    "unresolved",  # the same, but the points do not tell how the curve of a rod bends
    "two levels",  # the order could not be measured, since only one refinement was done
    "settled",  # the changes shrink by as much as order 1 would have it, but not as expected
    "slow",  # the changes shrink by less, at less than three quarters of the expected order
    "diverging",  # the changes grow
    "oscillating",  # the value oscillates, and the changes hardly shrink
    "damped",  # the stepper's own damping hides a motion
    "contradicted",  # another stepper with much smaller steps gives another value
    "failed",  # a finer run failed
    "other branch",  # a finer run ends in the mirror image of the shape, another solution
    "unmatched",  # not all meshes find it, such as a fold of a path
]

#: No order is seen, and the changes do not shrink: another level may tell more.
_UNSETTLED = ("slow", "diverging", "oscillating")
_FLAGGED = (
    *_UNSETTLED,
    "unresolved",
    "damped",
    "contradicted",
    "failed",
    "other branch",
    "unmatched",
)

_FACTOR_AT_ORDER = 1.25
_FACTOR_OFF_ORDER = 3.0
#: Where the changes shrink at no order, what is left of them may be more than at order 1.
_FACTOR_SETTLED = 4.0
_NEAR_ORDER = 0.1  # of the expected order
_SLOW = 0.75  # of the expected order
_LEAST_ORDER = 0.5
#: The last change is at most this share of the largest one: a half, as of order 1, and a little.
_SETTLED = 0.55
#: Of the curvature of the splines through points, the least of all quantities.
_ORDER_OF_SPLINES = 4.0
#: A value whose bar is less than this share of it does not tell on which side the structure is.
_SAME_ON_BOTH_SIDES = 0.1


@dataclass(frozen=True)
class ErrorEstimate:
    """The error of a value of one origin: space, time, or how the rods are drawn.

    Attributes
    ----------
    correction
        Richardson's correction: added to the value it gives the limit of the sequence.
    error_bar
        The error is at most this large, with 95 % confidence; infinite if it is not known.
    order
        Observed order of convergence; None with fewer than two refinements, or without change.
    expected_order
        Order that the method has for smooth solutions.
    verdict
        See `Verdict`.
    """

    correction: float
    error_bar: float
    order: float | None
    expected_order: float
    verdict: Verdict

    @property
    def flagged(self) -> bool:
        """Whether the sequence does not converge as it should."""
        return self.verdict in _FLAGGED

    @property
    def unsettled(self) -> bool:
        """Whether a finer level may still show that the sequence converges."""
        return self.verdict in _UNSETTLED

    def widened(self, error_bar: float, correction: float = 0.0) -> ErrorEstimate:
        """Return an estimate with a correction and a bar added."""
        return replace(
            self, error_bar=self.error_bar + error_bar, correction=self.correction + correction
        )


def estimate_error(
    values: Sequence[float], order: float, noise: float = 0.0, ratio: float = 2.0
) -> ErrorEstimate:
    """Estimate the error of the first of a sequence of values, each on a finer level.

    Parameters
    ----------
    values
        Two or more values, coarsest first. The last three tell the order.
    order
        Expected order of convergence.
    noise
        Differences up to this are not significant: rounding, and Newton's tolerance.
    ratio
        How many times finer each level is than the one before.

    Raises
    ------
    ValueError
        For fewer than two values.
    """
    if len(values) < 2:
        raise ValueError(f"expected two or more values, got {len(values)}")
    changes = [abs(fine - coarse) for coarse, fine in pairwise(values)]
    if max(changes) <= noise:
        return ErrorEstimate(values[-1] - values[0], noise, None, order, "exact")
    if len(values) == 2:
        correction = (values[1] - values[0]) * (1.0 + 1.0 / (ratio**order - 1.0))
        return ErrorEstimate(
            correction, _FACTOR_OFF_ORDER * abs(correction) + noise, None, order, "two levels"
        )
    limit = values[-1]
    observed: float | None = None
    verdict: Verdict = "converged"
    factor = _FACTOR_OFF_ORDER
    before, last = values[-2] - values[-3], values[-1] - values[-2]
    if abs(last) <= noise:
        pass  # the refinements before have removed the error
    elif before * last <= 0.0:
        verdict = "oscillating"
    else:
        observed = math.log(before / last) / math.log(ratio)
        at_order = abs(observed - order) <= _NEAR_ORDER * order
        used = order if at_order else min(max(observed, _LEAST_ORDER), order)
        limit = values[-1] + last / (ratio**used - 1.0)
        if at_order and len(values) == 3:
            factor = _FACTOR_AT_ORDER
        if observed <= 0.0:
            verdict = "diverging"
        elif observed < _SLOW * order:
            verdict = "slow"
    if verdict in _UNSETTLED and changes[-1] <= _SETTLED * max(changes[:-1]):
        verdict, factor = "settled", _FACTOR_SETTLED
    reached = (*values, limit)
    error_bar = factor * (max(reached) - min(reached)) + noise
    return ErrorEstimate(limit - values[0], error_bar, observed, order, verdict)


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


def estimate_drawing(
    by_level: Mapping[int, float],
    others: Mapping[int, float],
    noise: float,
    resolved: bool = True,
) -> ErrorEstimate:
    """Estimate the error from splines through points that are not the curve that they sample.

    On the meshes of `others` the nodes lie on splines of another degree, whose own error is of a
    higher order where the curve is `resolved` by its points.
    """
    levels = by_level.keys() & others.keys()
    if not levels:
        return unknown_error("failed", _ORDER_OF_SPLINES)
    apart = max(abs(by_level[level] - others[level]) for level in levels)
    if apart <= noise:
        return ErrorEstimate(0.0, noise, None, _ORDER_OF_SPLINES, "exact")
    error_bar = noise + _FACTOR_OFF_ORDER * apart
    verdict: Verdict = "compared" if resolved else "unresolved"
    return ErrorEstimate(0.0, error_bar, None, _ORDER_OF_SPLINES, verdict)


def on_one_branch(estimate: ErrorEstimate, mirrored: bool, largest: float) -> ErrorEstimate:
    """Say that the error is not known where levels end on different sides and the value shows it.

    `mirrored` says that a level ends in the mirror image of the shape of another, `largest` is the
    largest absolute value in the run.
    """
    if not mirrored or not _SAME_ON_BOTH_SIDES * largest < estimate.error_bar < math.inf:
        return estimate
    return unknown_error("other branch", estimate.expected_order)


def unknown_error(verdict: Verdict, order: float) -> ErrorEstimate:
    """Return an estimate without an error bar, with the reason."""
    return ErrorEstimate(0.0, math.inf, None, order, verdict)
