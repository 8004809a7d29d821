"""Studying a scene: many meshes, steppers and steps, measured against a reference."""

from __future__ import annotations

from collections.abc import Sequence

from der._core import Scenario
from der.accuracy.default_probes import with_default_probes
from der.accuracy.refinement import belongs_to_its_mesh, count_elements
from der.accuracy.study_arguments import check_arguments
from der.accuracy.study_comparison import Comparison, compare_over_time, compare_static
from der.accuracy.study_costs import StudyCosts
from der.accuracy.study_notes import (
    DEFAULT_PROBES,
    angle_note,
    costly_step_note,
    interval_note,
    mesh_name,
    missing_notes,
    one_mesh_note,
)
from der.accuracy.study_plan import (
    Mesh,
    choose_meshes,
    choose_steppers,
    choose_steps,
    find_leading_rod,
    frame_interval,
    reference_interval,
    reference_meshes,
    reference_step,
)
from der.accuracy.study_reference import REFERENCE_STEPPER, reference_tasks
from der.accuracy.study_result import Study
from der.accuracy.study_runs import DynamicRuns, StaticRuns
from der.accuracy.study_trial import Trial
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
    notes = [] if scene is given else [DEFAULT_PROBES]
    if scene.is_static and (steps is not None or steppers is not None):
        raise ValueError("a static scene has neither steps nor steppers: only nodes can be varied")
    meshes = choose_meshes(scene, nodes)
    names = choose_steppers(steppers, scene)
    workers = Workers(jobs, progress)
    workers.expect(1.0, later=_COST_OF_STUDY)
    outcome = workers.run({0: Task([scene])})[0]
    study_ = _Study(
        meshes,
        outcome.value(),
        StudyCosts(outcome.value(), outcome.cpu_seconds, max_seconds),
        workers,
        notes,
    )
    if scene.is_static:
        return study_.of_statics()
    return study_.of_motion(names, steps)


class _Study:
    """The order of the work: plan, run, compare, and put together what was found."""

    def __init__(
        self,
        meshes: list[Mesh],
        base: Result,
        costs: StudyCosts,
        workers: Workers,
        notes: list[str],
    ) -> None:
        self._scenario = base.scenario
        self._meshes = meshes
        self._base = base
        self._costs = costs
        self._workers = workers
        self._notes = notes
        self._left_out = self._leave_out_angles()

    def of_statics(self) -> Study:
        """Run every mesh, and the reference."""
        finer = self._reference_meshes()
        runs = StaticRuns(self._meshes, self._costs)
        references = reference_tasks(finer, None, 0.0, 0.0, self._costs.static_weight_per_node)
        self._workers.expect(runs.weight + total_weight(references.values()))
        trials = runs.run(self._workers)
        comparison, disagreements = compare_static(
            self._workers.run(references),
            len(self._meshes),
            [mesh_name(scenario) for scenario in finer.values()],
            self._left_out,
        )
        self._notes += disagreements
        return self._put_together(comparison, trials)

    def of_motion(self, steppers: Sequence[str], steps: Sequence[float] | None) -> Study:
        """Run every configuration, and the reference."""
        finer = self._reference_meshes()
        chosen = choose_steps(self._base, steps)
        if steps is None:
            chosen = self._leave_out_costly_steps(chosen, list(finer.values())[-1])
        every = reference_interval(self._base, chosen)
        self._notes.append(interval_note(chosen, every, frame_interval(self._base)))
        finest = reference_step(chosen[-1], every)
        references = reference_tasks(
            finer,
            REFERENCE_STEPPER,
            finest,
            every,
            self._costs.weight_per_node(REFERENCE_STEPPER, finest),
        )
        runs = DynamicRuns(self._meshes, steppers, chosen, steps is not None, every, self._costs)
        self._workers.expect(total_weight(references.values()) + runs.weight)
        trials = runs.run(self._workers)
        units = {
            name: probe.unit
            for name, probe in self._base.probes.items()
            if name not in self._left_out
        }
        outcomes = self._workers.run(references)
        return self._put_together(
            compare_over_time(outcomes, len(self._meshes), units, every), trials
        )

    def _leave_out_angles(self) -> list[str]:
        """Return the probes that cannot be compared: a turning angle belongs to its mesh."""
        if find_leading_rod(self._scenario) is None:
            self._notes.append(one_mesh_note(self._scenario))
            return []
        probes = list(self._base.probes)
        angles = [name for name in probes if belongs_to_its_mesh(self._scenario, name)]
        self._notes += map(angle_note, angles)
        if len(angles) == len(probes) and not self._scenario.is_static:
            raise ValueError("no probe can be compared between meshes; add one under output.probes")
        return angles

    def _reference_meshes(self) -> dict[int, Scenario]:
        return reference_meshes(self._scenario, self._meshes)

    def _leave_out_costly_steps(self, steps: list[float], finest: Scenario) -> list[float]:
        kept = self._costs.affordable_steps(steps, sum(count_elements(finest).values()))
        self._notes += map(costly_step_note, reversed(steps[len(kept) :]))
        return kept

    def _put_together(self, comparison: Comparison, trials: Sequence[Trial]) -> Study:
        self._notes += missing_notes(trials, self._meshes, self._costs.max_seconds)
        return Study(
            self._scenario,
            tuple(comparison.rows(trials, self._meshes)),
            comparison.sizes(),
            tuple(self._notes),
            comparison.noise(self._base.model, trials),
        )
