"""What the runs of a verification say about a scene without time."""

from __future__ import annotations

import math

from der.accuracy.error_bars import ErrorEstimate, estimate_from_levels, unknown_error
from der.accuracy.noise import noise_floor
from der.accuracy.refinement import SPACE_ORDER, belongs_to_its_mesh
from der.accuracy.static_readings import (
    Readings,
    describe_difference,
    differing_kinds,
    static_readings,
)
from der.accuracy.verification import SOLVER_FACTOR, VerifiedValue
from der.accuracy.verification_runs import VerificationRuns


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
        tight = runs.time.get(0)
        self._tight = self._base if tight is None else static_readings(tight)
        self._space = {level: static_readings(run) for level, run in runs.space.items()}
        self._unmatched = differing_kinds([self._base, self._tight, *self._space.values()])

    def values(self) -> list[VerifiedValue]:
        """Return every number with its error bar, also those that only finer meshes find."""
        values = [self._value(label) for label in self._base]
        for found in self._space.values():
            known = {value.label for value in values}
            values += [self._unmatched_value(found, label) for label in found if label not in known]
        return values

    def notes(self) -> list[str]:
        """Return what differs between the runs."""
        runs = {"the scene as written": self._base, "a tight tolerance": self._tight}
        runs |= {self._runs.meshes[n]: self._space[n] for n in sorted(self._space) if n > 0}
        return [describe_difference(kind, runs) for kind in self._unmatched]

    def _value(self, label: str) -> VerifiedValue:
        reading = self._base[label]
        if reading.kind in self._unmatched:
            return self._unmatched_value(self._base, label)
        # The scene as written against the same with a tighter tolerance: Newton's doing.
        shift = self._tight[label].value - reading.value
        noise = self._noise(self._base, label)
        return VerifiedValue(
            probe=reading.probe,
            what=reading.what,
            unit=reading.unit,
            value=reading.value,
            time_of_value=0.0,
            space=self._space_error(label, noise),
            time=None,
            solver=noise + SOLVER_FACTOR * abs(shift),
            solver_correction=shift,
        )

    def _unmatched_value(self, found: Readings, label: str) -> VerifiedValue:
        reading = found[label]
        return VerifiedValue(
            probe=reading.probe,
            what=reading.what,
            unit=reading.unit,
            value=self._base[label].value if label in self._base else math.nan,
            time_of_value=0.0,
            space=unknown_error("unmatched", SPACE_ORDER),
            time=None,
            solver=self._noise(found, label),
        )

    def _space_error(self, label: str, noise: float) -> ErrorEstimate | None:
        scenario = self._runs.base.scenario
        if not self._runs.space_is_refined or belongs_to_its_mesh(
            scenario, self._base[label].probe
        ):
            return None
        by_level = {level: found[label].value for level, found in self._space.items()}
        return estimate_from_levels(by_level, SPACE_ORDER, noise)

    def _noise(self, found: Readings, label: str) -> float:
        reading = found[label]
        return noise_floor(self._runs.base.model, reading.unit, math.inf, reading.largest)
