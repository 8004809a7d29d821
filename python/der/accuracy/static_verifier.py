"""The evaluation of the runs of a verification for a scene without time."""

from __future__ import annotations

import math
from collections.abc import Mapping

from der.accuracy.error_bars import (
    ErrorEstimate,
    estimate_drawing,
    estimate_from_levels,
    on_one_branch,
    unknown_error,
)
from der.accuracy.event_matching import numbered_as
from der.accuracy.noise import exact_below, noise_floor
from der.accuracy.refinement import SPACE_ORDER, belongs_to_its_mesh
from der.accuracy.static_readings import Reading, Readings, describe_counts, static_readings
from der.accuracy.verification_runs import OTHER_CURVES, VerificationRuns
from der.accuracy.verified_value import SOLVER_FACTOR, VerifiedValue
from der.result import Result


class StaticVerifier:
    """Puts error bars on the numbers of a scene without time.

    Parameters
    ----------
    runs
        The scene as written, and on finer meshes.
    """

    def __init__(self, runs: VerificationRuns) -> None:
        self._runs = runs
        self._base = static_readings(runs.base)
        self._finest = runs.finest
        tight = runs.time.get(0)
        self._tight = self._base if tight is None else self._read(tight)
        self._mirrored = {axis for axis in ("space", "drawing") if runs.is_mirrored(axis)}
        self._space = {level: self._read(run) for level, run in runs.space.items()}
        self._drawing = {level: self._read(run) for level, run in runs.drawing.items()}
        self._levels = [self._base, self._tight, *self._space.values(), *self._drawing.values()]

    def _read(self, run: Result) -> Readings:
        return numbered_as(self._base, static_readings(run), self._runs.base.model)

    def values(self) -> list[VerifiedValue]:
        """Return every number with its error bar, also those that only finer meshes find."""
        labels = dict.fromkeys(label for found in self._levels for label in found)
        return [
            self._value(label)
            if all(label in found for found in self._levels)
            else self._unmatched_value(label)
            for label in labels
        ]

    def notes(self) -> list[str]:
        """Return what differs between the runs."""
        runs = {"the scene as written": self._base, "a tight tolerance": self._tight}
        runs |= {self._runs.meshes[n]: self._space[n] for n in sorted(self._space) if n > 0}
        for found in self._drawing.values():
            runs[OTHER_CURVES] = found
        kinds = dict.fromkeys(
            reading.kind
            for found in self._levels
            for label, reading in found.items()
            if not all(label in other for other in self._levels)
        )
        return [f"{kind}: {describe_counts(kind, runs)}; not all are the same" for kind in kinds]

    def _value(self, label: str) -> VerifiedValue:
        reading = self._base[label]
        # The scene as written against the same with a tighter tolerance: Newton's doing.
        shift = self._tight[label].value - reading.value
        noise = self._noise(reading)
        return VerifiedValue(
            probe=reading.probe,
            what=reading.what,
            unit=reading.unit,
            value=reading.value,
            time_of_value=0.0,
            space=self._space_error(label, noise),
            time=None,
            drawing=self._drawing_error(label, noise),
            solver=noise + SOLVER_FACTOR * abs(shift),
            solver_correction=shift,
            exact_below=exact_below(self._finest, reading.unit, reading.largest),
        )

    def _unmatched_value(self, label: str) -> VerifiedValue:
        reading = next(found[label] for found in self._levels if label in found)
        return VerifiedValue(
            probe=reading.probe,
            what=reading.what,
            unit=reading.unit,
            value=self._base[label].value if label in self._base else math.nan,
            time_of_value=0.0,
            space=unknown_error("unmatched", SPACE_ORDER),
            time=None,
            solver=self._noise(reading),
        )

    def _space_error(self, label: str, noise: float) -> ErrorEstimate | None:
        if not self._has_limit(label):
            return None
        estimate = estimate_from_levels(_by_level(self._space, label), SPACE_ORDER, noise)
        return on_one_branch(estimate, "space" in self._mirrored, self._base[label].largest)

    def _drawing_error(self, label: str, noise: float) -> ErrorEstimate | None:
        if not self._runs.curves or not self._has_limit(label):
            return None
        values, others = (_by_level(found, label) for found in (self._space, self._drawing))
        estimate = estimate_drawing(values, others, noise)
        return on_one_branch(estimate, "drawing" in self._mirrored, self._base[label].largest)

    def _has_limit(self, label: str) -> bool:
        scenario = self._runs.base.scenario
        return self._runs.space_is_refined and not belongs_to_its_mesh(
            scenario, self._base[label].probe
        )

    def _noise(self, reading: Reading) -> float:
        return noise_floor(self._runs.base.model, reading.unit, math.inf, reading.largest)


def _by_level(found: Mapping[int, Readings], label: str) -> dict[int, float]:
    return {level: readings[label].value for level, readings in found.items()}
