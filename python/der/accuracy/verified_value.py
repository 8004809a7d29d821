"""A number of a run with its error bar, and what its convergence tells."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from der.accuracy.error_bars import ErrorEstimate
from der.accuracy.noise import NOTHING, ExactBelow

#: Error from Newton's tolerance: at most this times the change under a 1000 times tighter one.
SOLVER_FACTOR = 2.0
#: A part of the error smaller than this fraction of the whole is exempt from the order check.
_COUNTS = 0.1


@dataclass(frozen=True)
class VerifiedValue:
    """A number of a run, its error bar and its extrapolated value.

    Attributes
    ----------
    probe, what, unit
        Name of the probe, or of what the analysis finds (``frequency 1``, ``load factor 1``,
        ``factor`` of a path); ``final``, ``min`` or ``max`` over the run, on a path where
        (``fold 1``, ``bifurcation 1``, ``end``); the SI unit.
    value
        As the scene gives it when it is run as written; NaN for an event that only finer meshes
        find.
    time_of_value
        When it is reached [s]; 0 without time.
    space, time
        Error by the mesh and by the step; None where there is nothing to refine.
    drawing
        Error by the curves that finer meshes put through the points of rods drawn by them; None
        where there is no such rod.
    solver
        Bar of the rest: Newton's tolerance, measured with a tolerance a thousand times tighter, and
        rounding.
    solver_correction
        Change of the value under the tighter tolerance.
    negligible
        Parts of the error up to this are exempt from the order check.
    exact_below
        Error bars that are no more than rounding.
    """

    probe: str
    what: str
    unit: str
    value: float
    time_of_value: float
    space: ErrorEstimate | None
    time: ErrorEstimate | None
    solver: float
    solver_correction: float = 0.0
    negligible: float = 0.0
    drawing: ErrorEstimate | None = None
    exact_below: ExactBelow = NOTHING

    @property
    def label(self) -> str:
        """Its label in the table: ``tip_y``, or ``tip_y, min``."""
        return self.probe if self.what == "final" else f"{self.probe}, {self.what}"

    @property
    def error_bar(self) -> float:
        """The whole error bar: the exact value is within value -bar .. +bar with 95 % confidence.

        The truth is that of the rod as a continuum and of exact time; errors of space, time,
        drawing and solver add up.
        """
        return self.solver + sum(part.error_bar for part in self._parts.values())

    @property
    def extrapolated(self) -> float:
        """Best estimate of the exact value: Richardson's extrapolation in space and time.

        NaN where a part of the error is unknown.
        """
        if math.isinf(self.error_bar):
            return math.nan
        corrections = sum(part.correction for part in self._parts.values())
        return self.value + self.solver_correction + corrections

    @property
    def is_exact(self) -> bool:
        """Whether refining changes nothing beyond rounding, whatever order that shows."""
        within_coordinates = self.error_bar <= self.exact_below.coordinates
        return bool(self._parts) and (within_coordinates or self._has_all_digits)

    @property
    def _has_all_digits(self) -> bool:
        bar, limits = self.error_bar, self.exact_below
        return bar <= limits.rounding or abs(self.value) <= bar <= limits.nothing

    @property
    def flagged(self) -> bool:
        """Whether what makes up its error does not converge at the expected order.

        A part of the error that is less than a tenth of the whole bar, or negligible, does not
        count. None does of a value that is exact.
        """
        return any(part.flagged for part in self._parts_that_count.values())

    @property
    def unsettled(self) -> set[str]:
        """In which of ``space`` and ``time`` a finer level may still show that it converges."""
        return {where for where, part in self._parts_that_count.items() if part.unsettled}

    @property
    def settled(self) -> bool:
        """Whether a part that counts converges without the expected order."""
        return any(part.verdict == "settled" for part in self._parts_that_count.values())

    @property
    def has_two_levels(self) -> bool:
        """Whether a part that counts was refined only once, so that its order is not known."""
        return any(part.verdict == "two levels" for part in self._parts_that_count.values())

    @property
    def is_limited_by_drawing(self) -> bool:
        """Whether half of the error bar or more is due to how the rods are drawn."""
        if self.drawing is None or self.is_exact:
            return False
        return 0.5 * self.error_bar <= self.drawing.error_bar < math.inf

    @property
    def verdict(self) -> str:
        """``converged``, or verdicts on parts of its error, such as ``slow in time``.

        ``exact`` where no part is more than rounding, and ``rounding`` where that of coordinates
        leaves less than nine digits.
        """
        if self.is_exact:
            return "exact" if self._has_all_digits else "rounding"
        found = [
            f"{part.verdict} in {where}"
            for where, part in self._parts_that_count.items()
            if part.flagged or part.verdict in ("two levels", "settled")
        ]
        return ", ".join(found) or "converged"

    @property
    def _parts_that_count(self) -> dict[str, ErrorEstimate]:
        if self.is_exact:
            return {}
        # Written so that an unknown bar, which is infinite, counts beside another one.
        return {
            where: part
            for where, part in self._parts.items()
            if part.error_bar > self.negligible and not part.error_bar < _COUNTS * self.error_bar
        }

    @property
    def _parts(self) -> dict[str, ErrorEstimate]:
        parts = {"space": self.space, "time": self.time, "drawing": self.drawing}
        return {where: part for where, part in parts.items() if part is not None}

    def to_dict(self) -> dict[str, Any]:
        """Return everything as JSON knows it; an unknown bar is null."""
        return {
            "probe": self.probe,
            "what": self.what,
            "unit": self.unit,
            "value": _finite(self.value),
            "time": self.time_of_value,
            "error_bar": _finite(self.error_bar),
            "extrapolated": _finite(self.extrapolated),
            "verdict": self.verdict,
            "flagged": self.flagged,
            "space_error": _part_to_dict(self.space),
            "time_error": _part_to_dict(self.time),
            "drawing_error": _part_to_dict(self.drawing),
            "solver_error": {"error_bar": self.solver, "correction": self.solver_correction},
        }


def _part_to_dict(part: ErrorEstimate | None) -> dict[str, Any] | None:
    if part is None:
        return None
    return {
        "error_bar": _finite(part.error_bar),
        "correction": part.correction,
        "order": part.order,
        "expected_order": part.expected_order,
        "verdict": part.verdict,
    }


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None
