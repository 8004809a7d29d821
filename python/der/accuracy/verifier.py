"""Verifying a scene: runs on finer meshes and with smaller steps, and what they say."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from der.accuracy.cross_check import hidden_motion
from der.accuracy.default_probes import with_default_probes
from der.accuracy.error_bars import (
    ErrorEstimate,
    estimate_drawing,
    estimate_from_levels,
    on_one_branch,
    unknown_error,
)
from der.accuracy.event_matching import numbered_as
from der.accuracy.noise import exact_below, noise_floor
from der.accuracy.readings import Reading, describe_counts, read_run
from der.accuracy.refinement import SPACE_ORDER, belongs_to_its_mesh
from der.accuracy.verification import Verification
from der.accuracy.verification_runs import AXES, OTHER_CURVES, Axis, Runner, VerificationRuns
from der.accuracy.verified_value import SOLVER_FACTOR, VerifiedValue
from der.arguments import whole_number
from der.errors import warn
from der.parallel import Workers
from der.progress import ProgressFunction
from der.scenario import SceneLike, load

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
    runner = Runner(scene, levels, Workers(jobs, progress))
    runs = runner.runs
    if scene is not given:
        runs.notes.append("the scene has no probes: free ends and extreme points are shown")
    found = Evaluation(runs)
    values = found.values()
    while runs.levels > 2 and runner.refine(set().union(*(value.unsettled for value in values))):
        found = Evaluation(runs)
        values = found.values()
    return Verification(
        scenario=scene,
        values=tuple(values),
        meshes=tuple(runs.meshes),
        steps=tuple(runs.steps),
        warnings=tuple(runs.base.summary["warnings"]),
        notes=(*runs.notes, *found.notes(values)),
        cpu_seconds=runs.cpu_seconds,
    )


class Evaluation:
    """Puts error bars on the numbers of a scene, which was run as written and on all levels."""

    def __init__(self, runs: VerificationRuns) -> None:
        self._runs = runs
        self._base = read_run(runs.base)
        self._levels = {
            axis: {
                level: numbered_as(self._base, read_run(run), runs.base.model)
                for level, run in runs.of(axis).items()
            }
            for axis in AXES
        }
        self._all = [self._base]
        for axis, by_level in self._levels.items():
            self._all += by_level.values() if axis != "cross-check" else []
        self._mirrored = {axis for axis in AXES if runs.is_mirrored(axis)}
        self._hidden_motion = self._find_hidden_motion()

    def _find_hidden_motion(self) -> dict[str, float]:
        """Return how far each probe moves that levels in time agree to be at rest."""
        runs = self._runs
        # Levels that were added later may have shorter steps than the cross-check run.
        finest = sorted(level for level in self._levels["time"] if level < runs.levels)[-2:]
        if not self._levels["cross-check"] or len(finest) < 2:
            return {}
        coarse, fine = (runs.results["time", level] for level in finest)
        cross_check = runs.results["cross-check", 0]
        found = {
            probe: hidden_motion(coarse, fine, cross_check, probe, self._noise(self._base[probe]))
            for probe in runs.base.probes
        }
        return {probe: away for probe, away in found.items() if away is not None}

    def values(self) -> list[VerifiedValue]:
        """Return every number with its error bar, also those that only finer meshes find."""
        labels = dict.fromkeys(label for found in self._all for label in found)
        return [
            self._value(label)
            if all(label in found for found in self._all)
            else self._unmatched_value(label)
            for label in labels
        ]

    def _value(self, label: str) -> VerifiedValue:
        reading = self._base[label]
        noise = self._noise(reading)
        time = self._time_error(reading, noise)
        # The scene as written against the same with every step saved and a tighter tolerance. At
        # the end of the run that is Newton's doing, at an extreme mostly the step between samples.
        tight = self._by_level("time", label)
        shift = tight[0] - reading.at_steps if 0 in tight else 0.0
        correction = shift
        if time is not None and reading.what != "final":
            time = time.widened(abs(shift), shift)
            correction = 0.0
        return VerifiedValue(
            probe=reading.probe,
            what=reading.what,
            unit=reading.unit,
            value=reading.at_steps,
            time_of_value=reading.time,
            space=self._space_error(reading, noise),
            time=time,
            drawing=self._drawing_error(reading, noise),
            solver=noise + SOLVER_FACTOR * abs(correction),
            solver_correction=correction,
            exact_below=exact_below(self._runs.finest, reading.unit, reading.largest),
            negligible=_NEGLIGIBLE * reading.travelled,
        )

    def _unmatched_value(self, label: str) -> VerifiedValue:
        reading = next(found[label] for found in self._all if label in found)
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

    def _space_error(self, reading: Reading, noise: float) -> ErrorEstimate | None:
        if not self._has_limit(reading.probe):
            return None
        estimate = estimate_from_levels(self._by_level("space", reading.label), SPACE_ORDER, noise)
        return on_one_branch(estimate, "space" in self._mirrored, reading.largest)

    def _drawing_error(self, reading: Reading, noise: float) -> ErrorEstimate | None:
        if not self._runs.curves or not self._has_limit(reading.probe):
            return None
        values = self._by_level("space", reading.label)
        others = self._by_level("drawing", reading.label)
        estimate = estimate_drawing(values, others, noise, not self._runs.unresolved)
        return on_one_branch(estimate, "drawing" in self._mirrored, reading.largest)

    def _time_error(self, reading: Reading, noise: float) -> ErrorEstimate | None:
        levels = self._runs.time_levels
        if levels is None:
            return None
        values = self._by_level("time", reading.label)
        cross_check = self._by_level("cross-check", reading.label)
        estimate = estimate_from_levels(values, levels.order, noise, levels.ratio)
        estimate = on_one_branch(estimate, "time" in self._mirrored, reading.largest)
        if not cross_check or 0 not in values or "time" in self._mirrored:
            return estimate
        away = abs(cross_check[0] - values[0])
        hidden = self._hidden_motion.get(reading.probe)
        if reading.what == "final" and hidden is not None:
            away = max(away, hidden)
        elif away <= estimate.error_bar:
            return estimate
        error_bar = max(estimate.error_bar, _CROSS_CHECK_FACTOR * away)
        if away <= _LITTLE_NOISE * noise:
            return replace(estimate, error_bar=error_bar)
        return replace(
            estimate,
            error_bar=error_bar,
            verdict="contradicted" if hidden is None else "damped",
        )

    def _by_level(self, axis: Axis, label: str) -> dict[int, float]:
        return {level: found[label].value for level, found in self._levels[axis].items()}

    def _has_limit(self, probe: str) -> bool:
        runs = self._runs
        return runs.space_is_refined and not belongs_to_its_mesh(runs.base.scenario, probe)

    def _noise(self, reading: Reading) -> float:
        base, levels = self._runs.base, self._runs.time_levels
        step = math.inf
        if levels is not None:
            steps = int(base.summary["steps"]) * levels.cost(self._runs.levels - 1)
            step = base.scenario.duration / steps
        return noise_floor(base.model, reading.unit, step, reading.largest)

    def notes(self, values: list[VerifiedValue]) -> list[str]:
        """Return what is to be told of the values, beside the notes on the runs."""
        runs = self._runs
        notes = [
            f"'{probe}' is a turning angle, which belongs to its mesh: it has no error in space; "
            "'curvature' has one"
            for probe in runs.base.probes
            if runs.space_is_refined and not self._has_limit(probe)
        ]
        if limited := [value.label for value in values if value.is_limited_by_drawing]:
            more = f" and {len(limited) - _MOST_NAMED} more" if len(limited) > _MOST_NAMED else ""
            notes.append(
                f"the error of {_quoted(limited[:_MOST_NAMED])}{more} is mostly that of the "
                f"drawing: the points of {_quoted(runs.curves)} leave open how the curve runs "
                "between them. Draw more points of the curve; finer meshes do not tell"
            )
        if any("unresolved" in value.verdict for value in values):
            notes += [
                f"the points of '{rod}' do not resolve its curve beside node{_plural(nodes)} "
                f"{_listed(nodes)}: other curves through them bend otherwise by more than a "
                "quarter of the largest curvature. Draw more points there"
                for rod, nodes in runs.unresolved.items()
            ]
        notes += self._differences()
        if self._hidden_motion:
            notes.append(
                f"in {_quoted(self._hidden_motion)} {runs.base.summary['integrator']} damps a "
                "motion away that smaller steps keep: for the shape at rest use 'analysis: "
                "static', for the motion a smaller step"
            )
        if any("other branch" in value.verdict for value in values):
            notes.append(
                "it goes to one side, and on a finer level to the other, as its mirror image: "
                "nothing in the scene says to which, so that rounding decides. A small force to "
                "one side does, or a slight natural curvature"
            )
        return notes

    def _differences(self) -> list[str]:
        """Return what not all runs of a scene without time have found."""
        tight = self._levels["time"].get(0, self._base)
        runs = {"the scene as written": self._base, "a tight tolerance": tight}
        space = self._levels["space"]
        runs |= {self._runs.meshes[level]: space[level] for level in sorted(space) if level > 0}
        for found in self._levels["drawing"].values():
            runs[OTHER_CURVES] = found
        kinds = dict.fromkeys(
            reading.kind
            for found in self._all
            for label, reading in found.items()
            if not all(label in other for other in self._all)
        )
        return [f"{kind}: {describe_counts(kind, runs)}; not all are the same" for kind in kinds]


def _plural(items: list[int]) -> str:
    return "s" if len(items) > 1 else ""


def _listed(nodes: list[int]) -> str:
    more = f" and {len(nodes) - _MOST_NAMED} more" if len(nodes) > _MOST_NAMED else ""
    return ", ".join(map(str, nodes[:_MOST_NAMED])) + more


def _quoted(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
