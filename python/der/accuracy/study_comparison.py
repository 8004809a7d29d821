"""Comparing the runs of a study with its reference."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from der._core import Model
from der.accuracy.noise import noise_floor
from der.accuracy.static_comparison import StaticComparison
from der.accuracy.static_readings import static_readings
from der.accuracy.study_plan import Mesh, common_interval
from der.accuracy.study_reference import (
    Reference,
    converge_in_space,
    converge_in_time,
    static_reference,
)
from der.accuracy.study_row import StudyRow
from der.accuracy.study_trial import Trial
from der.parallel import Outcome
from der.result import Result

Array = NDArray[np.float64]

#: The finest meshes, which the reference is extrapolated from.
_REFERENCE_MESHES = 3

UNMATCHED = "unmatched"


@dataclass(frozen=True)
class Comparison:
    """The reference of a study, and how runs are compared with it.

    Attributes
    ----------
    units
        Units of the compared probes or numbers, by name.
    on_mesh
        For each mesh of the study, what it gives with time converged.
    reference
        Extrapolated in space as well.
    series_of
        Returns what can be compared of a run, by name.
    every
        The interval [s] whose multiples the reference has; 0 without time.
    """

    units: Mapping[str, str]
    on_mesh: Sequence[Reference]
    reference: Reference
    series_of: Callable[[Result], Mapping[str, Array]]
    every: float = 0.0

    def sizes(self) -> dict[str, float]:
        """Return the scale of errors: a probe that hardly moves still has a magnitude."""
        exact = self.reference.probes
        return {
            name: float(max(np.ptp(exact[name]), np.max(np.abs(exact[name]))))
            for name in self.units
        }

    def noise(self, model: Model, trials: Sequence[Trial]) -> dict[str, float]:
        """Return what rounding leaves, by name."""
        step = min((trial.step for trial in trials if trial.step > 0.0), default=math.inf)
        exact = self.reference.probes
        return {
            name: noise_floor(model, unit, step, float(np.max(np.abs(exact[name]))))
            for name, unit in self.units.items()
        }

    def rows(self, trials: Sequence[Trial], meshes: Sequence[Mesh]) -> list[StudyRow]:
        """Return a row for each probe and trial."""
        found = [{} if t.result is None else self.series_of(t.result) for t in trials]
        return [
            self._row(name, trial, meshes[trial.mesh].nodes, values.get(name))
            for name in self.units
            for trial, values in zip(trials, found, strict=True)
        ]

    def _row(self, probe: str, trial: Trial, nodes: int, values: Array | None) -> StudyRow:
        exact = self.reference.probes[probe]
        on_mesh = self.on_mesh[trial.mesh].probes.get(probe)
        missing = trial.result is not None and (values is None or on_mesh is None)
        return StudyRow(
            probe=probe,
            unit=self.units[probe],
            nodes=nodes,
            stepper=trial.stepper,
            step=trial.step,
            status=UNMATCHED if missing else trial.status,
            cpu_seconds=trial.cpu_seconds,
            error=_largest_difference(values, self._at_frames_of(trial, exact)),
            space_error=_largest_difference(on_mesh, exact),
            time_error=(
                _largest_difference(values, self._at_frames_of(trial, on_mesh))
                if trial.stepper
                else math.nan
            ),
            reference_error=self.reference.errors[probe],
            interval=common_interval(trial.step, self.every) if trial.step > 0.0 else 0.0,
        )

    def _at_frames_of(self, trial: Trial, series: Array | None) -> Array | None:
        """Return what a reference has at the times that the run of a trial was saved at."""
        if trial.result is None or series is None or not trial.stepper:
            return series
        frames = np.rint(trial.result.times / self.every).astype(int)
        frames[-1] = len(series) - 1  # the end of the run, be it a multiple or not
        at_frames: Array = series[frames]
        return at_frames


def compare_over_time(
    outcomes: Mapping[tuple[int, int], Outcome[Result]],
    meshes: int,
    units: Mapping[str, str],
    every: float,
) -> Comparison:
    """Return the comparison of probes over time.

    Parameters
    ----------
    outcomes
        Outcomes of the runs of the reference, by mesh and level.
    meshes
        How many meshes the study has; the further ones are of the reference only.
    units
        Units of the probes that are compared, by name.
    every
        Between frames of the reference [s].
    """
    by_mesh = [
        [outcomes[key].value() for key in sorted(outcomes) if key[0] == mesh]
        for mesh in range(1 + max(mesh for mesh, _ in outcomes))
    ]
    converged = [converge_in_time(results, list(units)) for results in by_mesh]

    def series_of(result: Result) -> dict[str, Array]:
        return {name: np.asarray(result.probes[name]) for name in units}

    return Comparison(units, converged[:meshes], _in_space(converged, meshes), series_of, every)


def compare_static(
    outcomes: Mapping[tuple[int, int], Outcome[Result]],
    meshes: int,
    names: Sequence[str],
    left_out: Sequence[str],
) -> tuple[Comparison, list[str]]:
    """Return the comparison of numbers without time, and notes on what the meshes disagree on.

    Parameters
    ----------
    outcomes
        Outcomes of the runs of the reference, by mesh and level.
    meshes
        How many meshes the study has; the further ones are of the reference only.
    names
        Names of all meshes, for the notes.
    left_out
        Probes that are not compared.
    """
    found = [static_readings(outcomes[key].value()) for key in sorted(outcomes)]
    reference_meshes = 1 if len(found) == meshes else _REFERENCE_MESHES
    agreed = StaticComparison(dict(zip(names, found, strict=True)), reference_meshes, left_out)
    converged = [static_reference(agreed.series(readings)) for readings in found]

    def series_of(result: Result) -> dict[str, Array]:
        return agreed.series(static_readings(result))

    comparison = Comparison(
        agreed.units, converged[:meshes], _in_space(converged, meshes), series_of
    )
    return comparison, agreed.notes


def _in_space(converged: Sequence[Reference], meshes: int) -> Reference:
    """Extrapolate from the finest meshes; a scene with one mesh is its own reference."""
    varied = len(converged) > meshes
    return converge_in_space(converged[-_REFERENCE_MESHES:]) if varied else converged[0]


def _largest_difference(a: Array | None, b: Array | None) -> float:
    return math.nan if a is None or b is None else float(np.max(np.abs(a - b)))
