"""Verifying a scene: runs on finer meshes and with smaller steps, and what they say."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from der._core import Scenario
from der.accuracy.cross_check import hidden_motion
from der.accuracy.default_probes import with_default_probes
from der.accuracy.error_bars import (
    ErrorEstimate,
    estimate_drawing,
    estimate_from_levels,
    on_one_branch,
)
from der.accuracy.noise import exact_below, noise_floor
from der.accuracy.probe_extremes import probe_values
from der.accuracy.refinement import SPACE_ORDER, belongs_to_its_mesh
from der.accuracy.static_verifier import StaticVerifier
from der.accuracy.time_levels import TimeLevels
from der.accuracy.verification import Verification
from der.accuracy.verification_runs import VerificationRuns, run_levels
from der.accuracy.verified_value import SOLVER_FACTOR, VerifiedValue
from der.errors import warn
from der.parallel import Workers
from der.progress import ProgressFunction
from der.result import Result
from der.scenario import SceneLike, load
from der.whole_numbers import whole_number

#: Where the cross-check run contradicts, the error is at most this times the difference to it.
_CROSS_CHECK_FACTOR = 1.25
#: Errors smaller than this fraction of the range of the probe in the run are exempt from the order
#: check: seven digits are more than anyone needs.
_NEGLIGIBLE = 1e-7
#: A note names no more values than this.
_MOST_NAMED = 4
#: A contradiction by less than this times the noise is none.
_LITTLE_NOISE = 10.0


def verify(
    scenario: SceneLike,
    *,
    levels: int | None = None,
    jobs: int | None = None,
    progress: ProgressFunction | None = None,
) -> Verification:
    """Run a scene on finer meshes and with smaller steps, and put an error bar on each probe.

    The scene is run as written, then with 2 and 4 times as many elements, and with a half and a
    quarter of the step; of a scene with ``time.tolerance`` the tolerance is refined. Frequencies,
    buckling loads, and factor and probes at the folds and bifurcations of a path get bars as well.
    A scene without probes is given some: positions of free ends, lowest and highest points.

    Parameters
    ----------
    scenario
        A scenario, the path of a scene file, or a dict with the keys of a scene file.
    levels
        2 or 3, the scene itself included. Three measure the order of convergence; without this, two
        are done where three would take more than a minute.
    jobs
        Runs at once; as many as the machine has cores, unless given.
    progress
        Told now and then how much is done, from 0 to 1.

    Returns
    -------
    Verification
        Print it for a table.

    Raises
    ------
    SceneError, NotConvergedError, DivergedError
        If the scene itself does not run to its end. A finer run that fails is noted and flagged.
    ValueError
        For any other number of levels or less than one job.
    TypeError
        For what is no scene, or no whole number of levels or jobs.

    Examples
    --------
    >>> verification = der.verify("configs/cantilever.yaml")
    >>> verification["tip_y"].value, verification["tip_y"].error_bar
    """
    if levels is not None and (levels := whole_number("levels", levels)) not in (2, 3):
        raise ValueError(f"levels must be 2 or 3, got {levels}")
    given = load(scenario)
    warn(given.warnings)
    scene = with_default_probes(given)
    runner = run_levels(scene, levels, Workers(jobs, progress))
    runs = runner.runs
    if scene is not given:
        runs.notes.append("the scene has no probes: free ends and extreme points are shown")
    values, notes = _evaluate(runs, scene)
    while runs.levels > 2 and runner.refine(set().union(*(value.unsettled for value in values))):
        values, notes = _evaluate(runs, scene)
    return Verification(
        scenario=scene,
        values=tuple(values),
        meshes=tuple(runs.meshes),
        steps=tuple(runs.steps),
        warnings=tuple(runs.base.summary["warnings"]),
        notes=(
            *runs.notes,
            *_notes_on_angles(runs, scene),
            *_notes_on_drawing(runs, values),
            *notes,
        ),
        cpu_seconds=runs.cpu_seconds,
    )


def _evaluate(runs: VerificationRuns, scene: Scenario) -> tuple[list[VerifiedValue], list[str]]:
    if runs.time_levels is None:
        found = StaticVerifier(runs)
        values = found.values()
        return values, [*found.notes(), *_notes_on_branches(values)]
    mirrored = {axis for axis in ("space", "time", "drawing") if runs.is_mirrored(axis)}
    evaluated = [
        _Evaluation(
            runs,
            runs.time_levels,
            probe,
            runs.space_is_refined and not belongs_to_its_mesh(scene, probe),
            mirrored,
        )
        for probe in runs.base.probes
    ]
    values = [value for evaluation in evaluated for value in evaluation.values()]
    return values, [*_notes_on_damping(runs, evaluated), *_notes_on_branches(values)]


def _notes_on_branches(values: list[VerifiedValue]) -> list[str]:
    if not any("other branch" in value.verdict for value in values):
        return []
    return [
        "it goes to one side, and on a finer level to the other, as its mirror image: nothing in "
        "the scene says to which, so that rounding decides. A small force to one side does, or a "
        "slight natural curvature"
    ]


def _notes_on_angles(runs: VerificationRuns, scene: Scenario) -> list[str]:
    return [
        f"'{probe}' is a turning angle, which belongs to its mesh: it has no error in space; "
        "'curvature' has one"
        for probe in runs.base.probes
        if runs.space_is_refined and belongs_to_its_mesh(scene, probe)
    ]


def _notes_on_drawing(runs: VerificationRuns, values: list[VerifiedValue]) -> list[str]:
    limited = [value.label for value in values if value.is_limited_by_drawing]
    if not limited:
        return []
    named = ", ".join(f"'{label}'" for label in limited[:_MOST_NAMED])
    more = f" and {len(limited) - _MOST_NAMED} more" if len(limited) > _MOST_NAMED else ""
    rods = ", ".join(f"'{rod}'" for rod in runs.curves)
    return [
        f"the error of {named}{more} is mostly that of the drawing: the points of {rods} leave "
        "open how the curve runs between them. Draw more points of the curve; finer meshes do not "
        "tell"
    ]


def _notes_on_damping(runs: VerificationRuns, evaluated: list[_Evaluation]) -> list[str]:
    notes = []
    damped = [f"'{evaluation.probe}'" for evaluation in evaluated if evaluation.hidden_motion]
    if damped:
        notes.append(
            f"in {', '.join(damped)} {runs.base.summary['integrator']} damps a motion away that "
            "smaller steps keep: for the shape at rest use 'analysis: static', for the motion a "
            "smaller step"
        )
    return notes


class _Evaluation:
    """The evaluation of the runs for one probe over time."""

    def __init__(
        self,
        runs: VerificationRuns,
        levels: TimeLevels,
        probe: str,
        measures_space: bool,
        mirrored: Collection[str],
    ) -> None:
        self._runs = runs
        self._levels = levels
        self._mirrored = mirrored
        self.probe = probe
        self._series = runs.base.probes[probe]
        self._space = self._by_level(runs.space) if measures_space else None
        self._drawing = self._by_level(runs.drawing)
        self._time = self._by_level(runs.time)
        summary = self._series.summary
        self._largest = max(abs(summary["min"]), abs(summary["max"]))
        self._noise = self._find_noise()
        self.hidden_motion = self._find_hidden_motion()

    def _by_level(self, results: dict[int, Result]) -> dict[int, dict[str, float]]:
        return {level: probe_values(results[level], self.probe) for level in results}

    def _find_noise(self) -> float:
        base = self._runs.base
        steps = int(base.summary["steps"]) * self._levels.cost(self._runs.levels - 1)
        step = base.scenario.duration / steps
        return noise_floor(base.model, self._series.unit, step, self._largest)

    def _find_hidden_motion(self) -> float | None:
        # Levels that were added later may have shorter steps than the cross-check run.
        finest = sorted(level for level in self._runs.time if level < self._runs.levels)[-2:]
        if self._runs.cross_check is None or len(finest) < 2:
            return None
        coarse, fine = (self._runs.time[level] for level in finest)
        return hidden_motion(coarse, fine, self._runs.cross_check, self.probe, self._noise)

    def values(self) -> list[VerifiedValue]:
        """Return the final value and the extremes with their error bars."""
        return [self._value(what) for what in probe_values(self._runs.base, self.probe)]

    def _value(self, what: str) -> VerifiedValue:
        summary = self._series.summary
        # The scene as written against the same with every step saved and a tighter tolerance. At
        # the end of the run that is Newton's doing, at an extreme mostly the step between samples.
        shift = self._time[0][what] - summary[what] if 0 in self._time else 0.0
        time = self._time_error(what)
        solver = self._noise
        if what != "final":
            time = time.widened(abs(shift), shift)
            shift = 0.0
        return VerifiedValue(
            probe=self.probe,
            what=what,
            unit=self._series.unit,
            value=summary[what],
            time_of_value=summary.get(f"t_{what}", self._runs.base.summary["time"]),
            space=self._space_error(what),
            time=time,
            drawing=self._drawing_error(what),
            solver=solver + SOLVER_FACTOR * abs(shift),
            solver_correction=shift,
            exact_below=exact_below(self._runs.finest, self._series.unit, self._largest),
            negligible=_NEGLIGIBLE * (summary["max"] - summary["min"]),
        )

    def _space_error(self, what: str) -> ErrorEstimate | None:
        if self._space is None:
            return None
        by_level = {level: values[what] for level, values in self._space.items()}
        estimate = estimate_from_levels(by_level, SPACE_ORDER, self._noise)
        return on_one_branch(estimate, "space" in self._mirrored, self._largest)

    def _drawing_error(self, what: str) -> ErrorEstimate | None:
        if self._space is None or not self._runs.curves:
            return None
        values, others = (
            {level: found[what] for level, found in levels.items()}
            for levels in (self._space, self._drawing)
        )
        estimate = estimate_drawing(values, others, self._noise)
        return on_one_branch(estimate, "drawing" in self._mirrored, self._largest)

    def _time_error(self, what: str) -> ErrorEstimate:
        by_level = {level: values[what] for level, values in self._time.items()}
        estimate = estimate_from_levels(
            by_level, self._levels.order, self._noise, self._levels.ratio
        )
        estimate = on_one_branch(estimate, "time" in self._mirrored, self._largest)
        if self._runs.cross_check is None or 0 not in self._time or "time" in self._mirrored:
            return estimate
        away = abs(probe_values(self._runs.cross_check, self.probe)[what] - self._time[0][what])
        damped = self.hidden_motion is not None
        if what == "final" and self.hidden_motion is not None:
            away = max(away, self.hidden_motion)
        elif away <= estimate.error_bar:
            return estimate
        error_bar = max(estimate.error_bar, _CROSS_CHECK_FACTOR * away)
        if away <= _LITTLE_NOISE * self._noise:
            return replace(estimate, error_bar=error_bar)
        return replace(
            estimate, error_bar=error_bar, verdict="damped" if damped else "contradicted"
        )
