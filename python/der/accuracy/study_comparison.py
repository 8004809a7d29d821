"""Comparing the runs of a study with a reference, extrapolated in time and in space."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import astuple, dataclass

import numpy as np
from numpy.typing import NDArray

from der._core import Model
from der.accuracy.noise import noise_floor
from der.accuracy.readings import Readings, describe_counts, differing_kinds, read_run
from der.accuracy.refinement import count_elements
from der.accuracy.study_plan import Mesh, common_interval, with_step
from der.accuracy.study_row import StudyRow
from der.accuracy.study_runs import StudyCosts, Trial
from der.parallel import Outcome, Task
from der.result import Result

Array = NDArray[np.float64]
#: Numbers of a run by name, at the times that runs are compared at, each of shape (times,).
Series = dict[str, Array]

#: Stepper of references: second order with a small error, and stable in the hardest scenes.
REFERENCE_STEPPER = "tr_bdf2"
_TIME_LEVELS = 3
#: The finest meshes, which the reference is extrapolated from.
_REFERENCE_MESHES = 3
#: Newton's tolerances of references, far below the errors that are measured.
_TIGHT = {"solver.residual_tolerance": 1e-12, "solver.step_tolerance": 1e-13}

UNMATCHED = "unmatched"


def reference_tasks(
    meshes: Sequence[Mesh], step: float, every: float, costs: StudyCosts
) -> dict[tuple[int, int], Task]:
    """Return the runs that references on these meshes are made of, by mesh and level.

    The coarsest level has this `step` [s], which two more halve; it is 0 for a scene without time.
    """
    stepper = REFERENCE_STEPPER if step > 0.0 else ""
    per_node = costs.seconds(1.0, stepper, step) / costs.cpu_seconds
    tasks = {}
    for number, mesh in enumerate(meshes):
        size = sum(count_elements(mesh.scenario).values())
        for level in range(_TIME_LEVELS if stepper else 1):
            varied = mesh.scenario
            if stepper:
                varied = with_step(varied, stepper, step / 2**level, every)
            weight = per_node * size * 2.0**level
            scenarios = [varied.with_(**_TIGHT), varied]
            tasks[number, level] = Task(scenarios, weight, keep_motion=False)
    return tasks


@dataclass(frozen=True)
class Reference:
    """What runs are compared with, and by name its estimated largest error over all times."""

    probes: Series
    errors: dict[str, float]


def extrapolate(levels: Sequence[Series], inherited: Mapping[str, float]) -> Reference:
    """Extrapolate at second order from the first two and from the last two of three levels.

    Each level halves the step, or the elements, of the one before. By how much the two differ
    bounds the error of the better one; errors that the levels have themselves come on top, enlarged
    as the extrapolation enlarges them.
    """
    probes, errors = {}, {}
    for name in levels[0]:
        coarse, middle, fine = (level[name] for level in levels)
        better = fine + (fine - middle) / 3.0
        worse = middle + (middle - coarse) / 3.0
        probes[name] = better
        errors[name] = float(np.max(np.abs(better - worse))) + 5.0 / 3.0 * inherited[name]
    return Reference(probes, errors)


def converge_in_space(meshes: Sequence[Reference]) -> Reference:
    """Extrapolate references on three meshes, each with twice the elements of the one before."""
    inherited = {name: max(mesh.errors[name] for mesh in meshes[1:]) for name in meshes[0].probes}
    return extrapolate([mesh.probes for mesh in meshes], inherited)


def _converge_in_time(levels: Sequence[Series]) -> Reference:
    """Extrapolate a mesh from its levels in time; without time it has no error of its own."""
    exact = dict.fromkeys(levels[0], 0.0)
    return extrapolate(levels, exact) if len(levels) > 1 else Reference(levels[0], exact)


class Comparison:
    """Compares the runs of a study with its reference.

    It is made of the outcomes of `reference_tasks`, by mesh and level. The study itself has the
    first `varied` of the meshes, which are coarsest first; the further ones are of the reference
    only. The reference has the multiples of the interval `every` [s], which is 0 without time.

    Attributes
    ----------
    notes
        What meshes disagree on.
    units
        Units of the compared probes or numbers, by name.

    Raises
    ------
    ValueError
        If nothing can be compared.
    """

    def __init__(
        self,
        outcomes: Mapping[tuple[int, int], Outcome[Result]],
        meshes: Sequence[Mesh],
        varied: int,
        left_out: Collection[str],
        every: float,
    ) -> None:
        self.notes: list[str] = []
        self._meshes = meshes
        self._every = every
        several = len(meshes) > varied
        by_mesh = [
            [outcomes[key].value() for key in sorted(outcomes) if key[0] == mesh]
            for mesh in range(len(meshes))
        ]
        if every > 0.0:
            probes = by_mesh[0][0].probes.items()
            self.units = {name: probe.unit for name, probe in probes if name not in left_out}
        else:
            found = [read_run(result) for (result,) in by_mesh]
            self._agreed = found[-1]
            finest = found[-_REFERENCE_MESHES:] if several else found[-1:]
            self.units = self._units_of_agreed(found, differing_kinds(finest), left_out)
        on_meshes = [_converge_in_time([self._series(run) for run in runs]) for runs in by_mesh]
        self._on_mesh = on_meshes[:varied]
        # A scene with one mesh is its own reference.
        finest_three = on_meshes[-_REFERENCE_MESHES:]
        self._reference = converge_in_space(finest_three) if several else on_meshes[0]

    def _units_of_agreed(
        self, found: Sequence[Readings], apart: Collection[str], left_out: Collection[str]
    ) -> dict[str, str]:
        """Return the units of the numbers that the finest meshes agree to have found."""
        runs = {mesh.name: own for mesh, own in zip(self._meshes, found, strict=True)}
        self.notes = [
            f"{'left out: ' if kind in apart else ''}{kind}: {describe_counts(kind, runs)}; which "
            "are the same is not known"
            for kind in differing_kinds(found)
        ]
        units = {
            label: reading.unit
            for label, reading in self._agreed.items()
            if reading.kind not in apart and reading.probe not in left_out
        }
        if not units:
            raise ValueError(
                "nothing can be compared between meshes; add a probe under output.probes, or finer "
                "meshes: " + "; ".join(self.notes)
            )
        return units

    def _series(self, result: Result) -> Series:
        """Return what can be compared of a run."""
        if self._every > 0.0:
            return {name: np.asarray(result.probes[name]) for name in self.units}
        found = read_run(result)
        apart = differing_kinds([found, self._agreed])
        return {
            label: np.array([found[label].value])
            for label in self.units
            if self._agreed[label].kind not in apart
        }

    def sizes(self) -> dict[str, float]:
        """Return the scale of errors: a probe that hardly moves still has a magnitude."""
        exact = self._reference.probes
        return {
            name: float(max(np.ptp(exact[name]), np.max(np.abs(exact[name]))))
            for name in self.units
        }

    def noise(self, model: Model, trials: Sequence[Trial]) -> dict[str, float]:
        """Return what rounding leaves, by name."""
        steps = [trial.tried.step for trial in trials if trial.tried.step > 0.0]
        step = min(steps, default=math.inf)
        exact = self._reference.probes
        return {
            name: noise_floor(model, unit, step, float(np.max(np.abs(exact[name]))))
            for name, unit in self.units.items()
        }

    def rows(self, trials: Sequence[Trial]) -> list[StudyRow]:
        """Return a row for each probe and trial."""
        found = [{} if t.result is None else self._series(t.result) for t in trials]
        return [
            self._row(name, trial, values.get(name))
            for name in self.units
            for trial, values in zip(trials, found, strict=True)
        ]

    def _row(self, probe: str, trial: Trial, values: Array | None) -> StudyRow:
        mesh, stepper, step = astuple(trial.tried)
        exact = self._reference.probes[probe]
        on_mesh = self._on_mesh[mesh].probes.get(probe)
        missing = trial.result is not None and (values is None or on_mesh is None)
        time_error = _largest_difference(values, self._at_frames_of(trial, on_mesh))
        return StudyRow(
            probe=probe,
            unit=self.units[probe],
            nodes=self._meshes[mesh].nodes,
            stepper=stepper,
            step=step,
            status=UNMATCHED if missing else trial.status,
            cpu_seconds=trial.cpu_seconds,
            error=_largest_difference(values, self._at_frames_of(trial, exact)),
            space_error=_largest_difference(on_mesh, exact),
            time_error=time_error if stepper else math.nan,
            reference_error=self._reference.errors[probe],
            interval=common_interval(step, self._every) if stepper else 0.0,
        )

    def _at_frames_of(self, trial: Trial, series: Array | None) -> Array | None:
        """Return what a reference has at the times that the run of a trial was saved at."""
        if trial.result is None or series is None or not trial.tried.stepper:
            return series
        frames = np.rint(trial.result.times / self._every).astype(int)
        frames[-1] = len(series) - 1  # the end of the run, be it a multiple or not
        at_frames: Array = series[frames]
        return at_frames


def _largest_difference(a: Array | None, b: Array | None) -> float:
    return math.nan if a is None or b is None else float(np.max(np.abs(a - b)))
