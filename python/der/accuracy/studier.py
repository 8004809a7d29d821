"""Studying a scene: many meshes, steppers and steps, measured against a reference."""

from __future__ import annotations

import math
from collections.abc import Sequence

from der._core import Scenario
from der.accuracy.default_probes import with_default_probes
from der.accuracy.refinement import belongs_to_its_mesh, count_elements
from der.accuracy.study_comparison import Comparison, reference_tasks
from der.accuracy.study_plan import (
    Mesh,
    check_arguments,
    choose_meshes,
    choose_steppers,
    choose_steps,
    common_interval,
    find_leading_rod,
    frame_interval,
    reference_interval,
    reference_step,
    why_one_mesh,
    with_finer_meshes,
)
from der.accuracy.study_result import Study
from der.accuracy.study_row import seconds_text
from der.accuracy.study_runs import SKIPPED, StudyCosts, StudyRuns, Trial
from der.errors import warn
from der.parallel import Task, Workers, total_weight
from der.progress import ProgressFunction
from der.result import Result
from der.scenario import SceneLike, load

#: All runs cost about this many times what the scene itself does, where that takes long enough for
#: its progress to be seen: before it has run, no one knows.
_COST_OF_STUDY = 20.0


def study(
    scenario: SceneLike,
    *,
    nodes: Sequence[int] | None = None,
    steps: Sequence[float] | None = None,
    steppers: Sequence[str] | None = None,
    max_seconds: float = 2.0,
    jobs: int | None = None,
    progress: ProgressFunction | None = None,
) -> Study:
    """Measure cost against error over meshes, steppers and steps.

    The error of a probe is its largest difference to a reference over the frames that the scene
    saves, as far as the step of a configuration reaches them. The reference is extrapolated from
    finer meshes and smaller steps, and states its own error. The frequencies of modes and
    the load factors of buckling are compared as well. On a path of equilibria, the study compares
    the factor and the probes at folds and bifurcations, and the probes at the end.

    Parameters
    ----------
    scenario
        A scenario, the path of a scene file, or a dict with the keys of a scene file.
    nodes
        Nodes of the first rod whose mesh can be varied; those of other rods follow in proportion.
        Without it, about half, once, twice and four times the scene's elements.
    steps
        Time steps [s]. Without them, four times to an eighth of the scene's step, or if its step is
        explicit, ``auto`` or set by a tolerance, a fiftieth to a 1600th of the duration, rounded to
        parts and multiples of ``output.every``; for an explicit stepper, the longest stable step
        among the halvings of the longest and the next.
    steppers
        Names of time integrators; without them, all.
    max_seconds
        Configurations that would take longer are skipped.
    jobs
        Runs at once for the reference; as many as the machine has cores, unless given. Runs
        whose cost is measured run one at a time.
    progress
        Told now and then how much is done, from 0 to 1.

    Returns
    -------
    Study
        With a table, a plot and advice.

    Raises
    ------
    SceneError, NotConvergedError, DivergedError
        If the scene itself, or a run that the reference needs, does not run to its end.
    ValueError
        For nodes, steps or steppers that the scene cannot take, and for empty lists.
    TypeError
        For jobs that are no whole number.
    """
    check_arguments(nodes, steps, steppers, max_seconds)
    given = load(scenario)
    warn(given.warnings)
    scene = with_default_probes(given)
    notes = []
    if scene is not given:
        notes.append("the scene has no probes: free ends and extreme points are shown")
    if scene.is_static and (steps is not None or steppers is not None):
        raise ValueError("a static scene has neither steps nor steppers: only nodes can be varied")
    meshes = choose_meshes(scene, nodes)
    tried = [""] if scene.is_static else choose_steppers(steppers, scene)
    workers = Workers(jobs, progress)
    workers.expect(1.0, later=_COST_OF_STUDY)
    outcome = workers.run({0: Task([scene])})[0]
    base = outcome.value()
    costs = StudyCosts(base, outcome.cpu_seconds, max_seconds)
    left_out = _leave_out_angles(base, notes)
    finer = with_finer_meshes(meshes)
    chosen, every, finest = [0.0], 0.0, 0.0
    if not scene.is_static:
        chosen = choose_steps(base, steps)
        if steps is None:
            chosen = _leave_out_costly_steps(chosen, costs, finer[-1].scenario, notes)
        every = reference_interval(base, chosen)
        notes.append(_interval_note(chosen, every, frame_interval(base)))
        finest = reference_step(chosen[-1], every)
    references = reference_tasks(finer, finest, every, costs)
    runs = StudyRuns(meshes, tried, chosen, steps is not None, every, costs)
    workers.expect(total_weight(references.values()) + runs.weight)
    trials = runs.run(workers)
    comparison = Comparison(workers.run(references), finer, len(meshes), left_out, every)
    notes += [*comparison.notes, *_missing_notes(trials, meshes, max_seconds)]
    return Study(
        scene,
        tuple(comparison.rows(trials)),
        comparison.sizes(),
        tuple(notes),
        comparison.noise(base.model, trials),
    )


def _leave_out_angles(base: Result, notes: list[str]) -> list[str]:
    """Return the probes that cannot be compared: a turning angle belongs to its mesh."""
    scene = base.scenario
    if find_leading_rod(scene) is None:
        notes.append(f"nodes are not varied: {why_one_mesh(scene)}")
        return []
    angles = [name for name in base.probes if belongs_to_its_mesh(scene, name)]
    notes += [
        f"'{probe}' is left out: a turning angle belongs to its mesh; 'curvature' does not"
        for probe in angles
    ]
    if len(angles) == len(base.probes) and not scene.is_static:
        raise ValueError("no probe can be compared between meshes; add one under output.probes")
    return angles


def _leave_out_costly_steps(
    steps: list[float], costs: StudyCosts, finest: Scenario, notes: list[str]
) -> list[float]:
    kept = costs.affordable_steps(steps, sum(count_elements(finest).values()))
    notes += [
        f"steps of {seconds_text(step)} are left out, for their cost"
        for step in reversed(steps[len(kept) :])
    ]
    return kept


def _interval_note(steps: Sequence[float], every: float, frames: float) -> str:
    """Return when errors are measured: `every`, where the scene has `frames` so far apart [s]."""
    note = f"errors are measured every {seconds_text(every)}"
    if math.isclose(every, frames):
        note += ", as the scene saves frames"
    intervals = [(step, common_interval(step, every)) for step in steps]
    rarer = [
        f"with {seconds_text(step)} every {seconds_text(interval)}"
        for step, interval in intervals
        if not math.isclose(interval, every)
    ]
    if rarer:
        note += ", or where a step does not reach all of these: " + ", ".join(rarer)
    return note


def _missing_notes(
    trials: Sequence[Trial], meshes: Sequence[Mesh], max_seconds: float
) -> list[str]:
    """Return which configurations did not run to their end, and why."""
    steps: dict[tuple[int, str, str], list[float]] = {}
    for trial in sorted(trials, key=lambda trial: trial.tried.mesh):
        if trial.result is None:
            key = (trial.tried.mesh, trial.tried.stepper, trial.status)
            steps.setdefault(key, []).append(trial.tried.step)
    notes = []
    for (mesh, stepper, status), own in steps.items():
        what, when = meshes[mesh].name, ""
        if stepper:
            longest, shortest = seconds_text(max(own)), seconds_text(min(own))
            what = f"{what}, {stepper}"
            when = f" at {longest}" if longest == shortest else f" from {longest} to {shortest}"
        if status == SKIPPED:
            status = f"skipped, for more than {max_seconds:g} s of CPU time each"
        notes.append(f"{what}: {status}{when}")
    return notes
