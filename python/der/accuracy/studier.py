"""Studying a scene: many meshes, steppers and steps, measured against a reference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from der._core import Scenario
from der.accuracy.default_probes import with_default_probes
from der.accuracy.noise import noise_floor
from der.accuracy.refinement import belongs_to_its_mesh, count_elements
from der.accuracy.static_comparison import StaticComparison
from der.accuracy.static_readings import static_readings
from der.accuracy.study_arguments import check_arguments
from der.accuracy.study_plan import (
    Mesh,
    choose_meshes,
    choose_steppers,
    choose_steps,
    common_interval,
    find_leading_rod,
    finer,
    frame_interval,
    longest_of_halvings,
    reference_interval,
    reference_step,
    why_one_mesh,
    with_step,
)
from der.accuracy.study_reference import (
    REFERENCE_STEPPER,
    Reference,
    converge_in_space,
    converge_in_time,
    reference_tasks,
    static_reference,
)
from der.accuracy.study_result import Study
from der.accuracy.study_row import StudyRow, seconds_text
from der.accuracy.time_levels import find_stepper
from der.errors import DerError
from der.parallel import TOO_LONG, Outcome, Task, Workers, total_weight
from der.progress import ProgressFunction
from der.result import Result
from der.simulation import SceneLike, Simulation, as_scenario

#: Runs are repeated while all of them together take less than this [s].
_MEASURING_TIME = 0.3
_MOST_REPEATS = 5
#: The costliest run of the reference may take this many times what a configuration may.
_REFERENCE_COST = 5.0
#: Halvings of the scene's step in search of one that is stable for an explicit stepper.
_MOST_HALVINGS = 30
#: Steps that are tried for an explicit stepper from the longest stable one on.
_EXPLICIT_STEPS = 2
#: The finest meshes, which the reference is extrapolated from.
_REFERENCE_MESHES = 3
#: All runs cost about this many times what the scene itself does, where that takes long enough for
#: its progress to be seen: before it has run, no one knows.
_COST_OF_STUDY = 20.0
#: Cost of a step, against one of another implicit stepper.
_COST_OF_STEP = {
    "tr_bdf2": 2.0,
    "sdirk4": 5.0,
    "sdirk5": 5.0,
    "verlet": 0.05,
    "explicit_euler": 0.05,
}

UNSTABLE = "unstable"
SKIPPED = "skipped"
UNMATCHED = "unmatched"


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
    finer meshes and smaller steps, and states its own error. Of modes the frequencies are compared
    as well, of buckling the load factors; of a path of equilibria the factor and the probes at its
    folds and bifurcations, and the probes where it ends.

    Parameters
    ----------
    scenario
        A scenario, the path of a scene file, or a dict with the keys of a scene file.
    nodes
        Of the first rod whose mesh can be varied; those of other rods follow in proportion. Without
        it, about half, once, twice and four times the scene's elements.
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
        Runs at once for the reference; as many as the machine has cores, unless given. What is
        measured runs alone.
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
    """
    check_arguments(nodes, steps, steppers, max_seconds)
    given = as_scenario(scenario)
    scene = with_default_probes(given)
    notes = []
    if scene is not given:
        notes.append("the scene has no probes: free ends and extreme points are shown")
    if scene.is_static and (steps is not None or steppers is not None):
        raise ValueError("a static scene has neither steps nor steppers: only nodes can be varied")
    meshes = choose_meshes(scene, nodes)
    names = choose_steppers(steppers)
    workers = Workers(jobs, progress)
    workers.expect(1.0, later=_COST_OF_STUDY)
    base = workers.run({0: Task([scene])})[0]
    study_ = _Study(scene, meshes, base, max_seconds, workers, notes)
    if scene.is_static:
        study_.run_static()
    else:
        study_.run_dynamic(names, steps)
    return study_.finish()


def _largest_difference(a: NDArray[np.float64] | None, b: NDArray[np.float64] | None) -> float:
    return math.nan if a is None or b is None else float(np.max(np.abs(a - b)))


def _size(values: NDArray[np.float64]) -> float:
    """Return what errors are set against: a probe that hardly moves still has a magnitude."""
    return float(max(np.ptp(values), np.max(np.abs(values))))


def _repeats(seconds: float) -> int:
    return max(1, min(_MOST_REPEATS, int(_MEASURING_TIME / seconds)))


@dataclass(frozen=True)
class _Trial:
    """A configuration and how its run went."""

    mesh: int  # its place in the list of meshes
    stepper: str
    step: float
    status: str
    result: Result | None
    cpu_seconds: float


class _Study:
    def __init__(
        self,
        scenario: Scenario,
        meshes: list[Mesh],
        base: Outcome,
        max_seconds: float,
        workers: Workers,
        notes: list[str],
    ) -> None:
        self._scenario = scenario
        self._meshes = meshes
        self._base = base.value()
        self._max_seconds = max_seconds
        self._workers = workers
        self._notes = notes
        self._left_out = self._leave_out_angles()
        self._units = {
            name: probe.unit
            for name, probe in self._base.probes.items()
            if name not in self._left_out
        }
        self._compared: StaticComparison | None = None
        self._trials: list[_Trial] = []
        self._every = 0.0
        work = self._base.model.num_nodes * max(1, int(self._base.summary.get("steps", 1)))
        self._base_seconds = base.cpu_seconds  # the unit of weights: the base itself weighs 1
        self._seconds_per_step = base.cpu_seconds / work / self._cost_of_step(self._base_stepper)
        self._on_mesh: list[Reference] = []
        self._reference = Reference({}, {})

    @property
    def _base_stepper(self) -> str:
        return "" if self._scenario.is_static else str(self._base.summary["integrator"])

    def _leave_out_angles(self) -> list[str]:
        """Return the probes that cannot be compared: a turning angle belongs to its mesh."""
        probes = list(self._base.probes)
        if find_leading_rod(self._scenario) is None:
            self._notes.append(f"nodes are not varied: {why_one_mesh(self._scenario)}")
            return []
        angles = [name for name in probes if belongs_to_its_mesh(self._scenario, name)]
        for name in angles:
            self._notes.append(
                f"'{name}' is left out: a turning angle belongs to its mesh; 'curvature' does not"
            )
        if len(angles) == len(probes) and not self._scenario.is_static:
            raise ValueError("no probe can be compared between meshes; add one under output.probes")
        return angles

    # Runs.

    def run_static(self) -> None:
        """Run every mesh, and the reference."""
        per_node = 1.0 / self._base.model.num_nodes
        tasks = {i: self._static_task(mesh, per_node) for i, mesh in enumerate(self._meshes)}
        references = reference_tasks(self._reference_meshes(), None, 0.0, 0.0, per_node)
        self._workers.expect(total_weight([*tasks.values(), *references.values()]))
        for i, outcome in self._workers.run(tasks, jobs=1).items():
            self._add_trial(i, "", 0.0, outcome)
        self._converge_static(self._workers.run(references))

    def _static_task(self, mesh: Mesh, cost_per_node: float) -> Task:
        nodes = self._total_nodes(mesh)
        repeats = _repeats(self._seconds_per_step * nodes)
        return Task([mesh.scenario], cost_per_node * nodes * repeats, repeats, keep_motion=False)

    def run_dynamic(self, steppers: Sequence[str], steps: Sequence[float] | None) -> None:
        """Run every configuration, and the reference."""
        chosen = choose_steps(self._base, steps)
        if steps is None:
            self._leave_out_costly_steps(chosen)
        self._every = reference_interval(self._base, chosen)
        self._note_interval(chosen)
        finest = reference_step(chosen[-1], self._every)
        cost_per_node = self._cost(self._seconds_per_node(REFERENCE_STEPPER, finest))
        references = reference_tasks(
            self._reference_meshes(), REFERENCE_STEPPER, finest, self._every, cost_per_node
        )
        plan = self._plan(steppers, chosen, explicit=steps is not None)
        halvings = {} if steps is not None else self._plan_halvings(steppers, chosen[0])
        self._workers.expect(
            total_weight(references.values())
            + sum(self._measuring_cost(*configuration) for configuration in plan)
            + sum(self._measuring_cost(*key, step) for key in halvings for step in halvings[key])
        )
        for configuration in plan:
            self._measure(*configuration, self._measuring_cost(*configuration))
        for (mesh, name), announced in halvings.items():
            self._measure_explicit(mesh, name, chosen[0], announced)
        self._converge(self._workers.run(references))

    def _plan(
        self, steppers: Sequence[str], steps: Sequence[float], explicit: bool
    ) -> list[tuple[int, str, float]]:
        """Return mesh, stepper and step of what is measured, explicit steppers only if wanted."""
        names = [name for name in steppers if explicit or find_stepper(name).implicit]
        return [
            (mesh, name, step)
            for mesh in range(len(self._meshes))
            for name in names
            for step in steps
        ]

    def _plan_halvings(
        self, steppers: Sequence[str], longest: float
    ) -> dict[tuple[int, str], list[float]]:
        """Return the steps that are likely stable and so measured, by mesh and explicit stepper."""
        return {
            (mesh, name): self._stable_steps(mesh, name, longest)
            for mesh in range(len(self._meshes))
            for name in steppers
            if not find_stepper(name).implicit
        }

    def _stable_steps(self, mesh: int, stepper: str, longest: float) -> list[float]:
        """Return the first halvings that are stable at the start of the run."""
        steps = self._halvings(longest)
        refused = 0
        while refused < len(steps) and self._is_refused(mesh, stepper, steps[refused]):
            refused += 1
        return steps[refused : refused + _EXPLICIT_STEPS]

    def _is_refused(self, mesh: int, stepper: str, step: float) -> bool:
        try:
            Simulation(self._with_step(mesh, stepper, step))
        except DerError:
            return True
        return False

    def _halvings(self, longest: float) -> list[float]:
        first = longest_of_halvings(longest, self._every)
        return [first / 2**count for count in range(_MOST_HALVINGS)]

    def _with_step(self, mesh: int, stepper: str, step: float) -> Scenario:
        return with_step(self._meshes[mesh].scenario, stepper, step, self._interval(step))

    def _note_interval(self, steps: Sequence[float]) -> None:
        note = f"errors are measured every {seconds_text(self._every)}"
        if math.isclose(self._every, frame_interval(self._base)):
            note += ", as the scene saves frames"
        rarer = [
            f"with {seconds_text(step)} every {seconds_text(self._interval(step))}"
            for step in steps
            if not math.isclose(self._interval(step), self._every)
        ]
        if rarer:
            note += ", or where a step does not reach all of these: " + ", ".join(rarer)
        self._notes.append(note)

    def _interval(self, step: float) -> float:
        """Return the interval [s] at which a run with this step is compared; 0 without time."""
        return common_interval(step, self._every) if step > 0.0 else 0.0

    def _leave_out_costly_steps(self, steps: list[float]) -> None:
        """Drop the shortest steps until the reference, four times finer, is affordable."""
        finest = list(self._reference_meshes().values())[-1]
        nodes = sum(count_elements(finest).values())
        per_step = self._seconds_per_step * nodes * self._scenario.duration
        while len(steps) > 2 and 4.0 * per_step / steps[-1] > _REFERENCE_COST * self._max_seconds:
            left_out = steps.pop()
            self._notes.append(f"steps of {seconds_text(left_out)} are left out, for their cost")

    def _measure(self, mesh: int, stepper: str, step: float, weight: float) -> _Trial:
        expected = self._expected_seconds(mesh, stepper, step)
        if expected > self._max_seconds:
            trial = _Trial(mesh, stepper, step, SKIPPED, None, math.nan)
            self._trials.append(trial)
            return trial
        scenario = self._with_step(mesh, stepper, step)
        task = Task(
            [scenario],
            weight,
            _repeats(expected),
            keep_motion=False,
            max_seconds=self._max_seconds,
        )
        return self._add_trial(mesh, stepper, step, self._workers.run({0: task}, jobs=1)[0])

    def _measure_explicit(
        self, mesh: int, stepper: str, longest: float, announced: Sequence[float]
    ) -> None:
        """Halve the step until it is stable; measure that and the next ones."""
        stable = 0
        for step in self._halvings(longest):
            cost = self._measuring_cost(mesh, stepper, step) if step in announced else 0.0
            trial = self._measure(mesh, stepper, step, cost)
            stable += trial.result is not None
            if stable == _EXPLICIT_STEPS or trial.status == SKIPPED:
                return

    def _measuring_cost(self, mesh: int, stepper: str, step: float) -> float:
        """Return the expected cost of all repeats; 0 of what will be skipped."""
        expected = self._expected_seconds(mesh, stepper, step)
        return 0.0 if expected > self._max_seconds else self._cost(expected * _repeats(expected))

    def _cost(self, seconds: float) -> float:
        """Return CPU time in the unit of weights."""
        return seconds / self._base_seconds

    def _expected_seconds(self, mesh: int, stepper: str, step: float) -> float:
        return self._seconds_per_node(stepper, step) * self._total_nodes(self._meshes[mesh])

    def _seconds_per_node(self, stepper: str, step: float) -> float:
        steps = self._scenario.duration / step
        return self._seconds_per_step * self._cost_of_step(stepper) * steps

    def _total_nodes(self, mesh: Mesh) -> float:
        """Return the nodes of all rods, if all are refined as the one is that names the mesh."""
        rod = find_leading_rod(self._scenario)
        rods = self._base.rods
        own_nodes = len(next(r for r in rods if rod in (None, r.name)).nodes)
        return self._base.model.num_nodes * mesh.nodes / own_nodes

    @staticmethod
    def _cost_of_step(stepper: str) -> float:
        return _COST_OF_STEP.get(stepper, 1.0)

    def _add_trial(self, mesh: int, stepper: str, step: float, outcome: Outcome) -> _Trial:
        result, status = outcome.result, ""
        if outcome.error is not None:
            explicit = stepper != "" and not find_stepper(stepper).implicit
            status = outcome.error.status
            if status == TOO_LONG:
                status = SKIPPED
            elif explicit:
                status = UNSTABLE
            result = None
        elif result is not None:
            status = result.status
        cost = outcome.cpu_seconds if result is not None else math.nan
        trial = _Trial(mesh, stepper, step, status, result, cost)
        self._trials.append(trial)
        return trial

    # References.

    def _reference_meshes(self) -> dict[int, Scenario]:
        """Return the study's meshes by their place, and after them two finer ones."""
        scenarios = [mesh.scenario for mesh in self._meshes]
        if find_leading_rod(self._scenario) is not None:
            scenarios += [finer(self._meshes[-1], factor).scenario for factor in (2, 4)]
        return dict(enumerate(scenarios))

    def _converge(self, outcomes: dict[tuple[int, int], Outcome]) -> None:
        count = 1 + max(mesh for mesh, _ in outcomes)
        by_mesh = [
            [outcomes[key].value() for key in sorted(outcomes) if key[0] == mesh]
            for mesh in range(count)
        ]
        self._settle([converge_in_time(results, list(self._units)) for results in by_mesh])

    def _converge_static(self, outcomes: dict[tuple[int, int], Outcome]) -> None:
        found = [static_readings(outcomes[key].value()) for key in sorted(outcomes)]
        names = [self._mesh_name(scenario) for scenario in self._reference_meshes().values()]
        reference_meshes = 1 if len(found) == len(self._meshes) else _REFERENCE_MESHES
        self._compared = StaticComparison(
            dict(zip(names, found, strict=True)), reference_meshes, self._left_out
        )
        self._notes += self._compared.notes
        self._units = self._compared.units
        self._settle([static_reference(self._compared.series(readings)) for readings in found])

    def _settle(self, converged: list[Reference]) -> None:
        """Take what is converged on every mesh, the finer ones of the reference included."""
        self._on_mesh = converged[: len(self._meshes)]
        varied = len(converged) > len(self._meshes)
        self._reference = (
            converge_in_space(converged[-_REFERENCE_MESHES:]) if varied else converged[0]
        )

    @staticmethod
    def _mesh_name(scenario: Scenario) -> str:
        rod = find_leading_rod(scenario)
        counts = count_elements(scenario)
        return f"{(counts[rod] if rod else next(iter(counts.values()))) + 1} nodes"

    # What came out.

    def finish(self) -> Study:
        """Return what was found."""
        self._note_what_is_missing()
        exact = self._reference.probes
        sizes = {name: _size(exact[name]) for name in self._units}
        values = [self._values(trial) for trial in self._trials]
        rows = [
            self._row(name, trial, found.get(name))
            for name in self._units
            for trial, found in zip(self._trials, values, strict=True)
        ]
        noise = {name: self._noise(name, exact[name]) for name in self._units}
        return Study(self._scenario, tuple(rows), sizes, tuple(self._notes), noise)

    def _noise(self, name: str, exact: NDArray[np.float64]) -> float:
        step = min((trial.step for trial in self._trials if trial.step > 0.0), default=math.inf)
        largest = float(np.max(np.abs(exact)))
        return noise_floor(self._base.model, self._units[name], step, largest)

    def _values(self, trial: _Trial) -> dict[str, NDArray[np.float64]]:
        """Return what can be compared of a trial, by name."""
        if trial.result is None:
            return {}
        if self._compared is not None:
            return self._compared.series(static_readings(trial.result))
        return {name: np.asarray(trial.result.probes[name]) for name in self._units}

    def _row(self, probe: str, trial: _Trial, values: NDArray[np.float64] | None) -> StudyRow:
        exact = self._reference.probes[probe]
        on_mesh = self._on_mesh[trial.mesh].probes.get(probe)
        missing = trial.result is not None and (values is None or on_mesh is None)
        return StudyRow(
            probe=probe,
            unit=self._units[probe],
            nodes=self._meshes[trial.mesh].nodes,
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
            reference_error=self._reference.errors[probe],
            interval=self._interval(trial.step),
        )

    def _at_frames_of(
        self, trial: _Trial, series: NDArray[np.float64] | None
    ) -> NDArray[np.float64] | None:
        """Return what a reference has at the times that the run of a trial was saved at."""
        if trial.result is None or series is None or not trial.stepper:
            return series
        frames = np.rint(trial.result.times / self._every).astype(int)
        frames[-1] = len(series) - 1  # the end of the run, be it a multiple or not
        at_frames: NDArray[np.float64] = series[frames]
        return at_frames

    def _note_what_is_missing(self) -> None:
        for i, mesh in enumerate(self._meshes):
            for stepper in dict.fromkeys(trial.stepper for trial in self._trials):
                tried = [t for t in self._trials if (t.mesh, t.stepper) == (i, stepper)]
                for status in dict.fromkeys(t.status for t in tried if t.result is None):
                    steps = [t.step for t in tried if t.status == status]
                    self._notes.append(self._missing(mesh, stepper, status, steps))

    def _missing(self, mesh: Mesh, stepper: str, status: str, steps: list[float]) -> str:
        what = f"{mesh.nodes} nodes, {stepper}" if stepper else f"{mesh.nodes} nodes"
        longest, shortest = seconds_text(max(steps)), seconds_text(min(steps))
        when = f" at {longest}" if longest == shortest else f" from {longest} to {shortest}"
        if status == SKIPPED:
            status = f"skipped, for more than {self._max_seconds:g} s of CPU time each"
        return f"{what}: {status}{when if stepper else ''}"
