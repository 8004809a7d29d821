"""The runs that a verification is made of."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from der._core import Scenario
from der.accuracy.branches import are_far_apart, are_mirrored, distance, shape_on
from der.accuracy.cross_check import CROSS_CHECK_STEPPER, cross_check_halvings, cross_check_scenario
from der.accuracy.refinement import (
    count_nodes,
    curves_between_points,
    rods_that_cannot_be_refined,
    with_elements,
)
from der.accuracy.time_levels import TimeLevels, stepper_of, time_levels
from der.errors import SceneError
from der.parallel import Task, Workers, total_weight
from der.result import Result

#: CPU time [s] up to which a third level is added, which measures the order, unless asked for, and
#: further ones where it shows no order.
_BUDGET = 60.0
#: Level in space at which curves through points are compared: new nodes lie between the points.
_DRAWING_LEVEL = 1
#: What the run with these is called.
OTHER_CURVES = "other curves through the points"
#: No level is finer than this many times doubled.
_FINEST = 4
#: Newton's tolerances are tightened by this, down to the least that rounding allows.
_TIGHTER = 1e-3
_LEAST_TOLERANCE = 1e-13

Axis = Literal["space", "time", "drawing", "cross-check"]
#: Analyses of an equilibrium, which is one near the shape that they start from.
_AT_REST = ("static", "modes")
Key = tuple[Axis, int]


@dataclass
class VerificationRuns:
    """The runs of a verification, and notes on them.

    Attributes
    ----------
    base
        The scene as written.
    levels
        How many levels were asked for, the scene itself included.
    time_levels
        How time is refined; None for a static scene.
    time, space
        Results by level, with a tighter tolerance of Newton's method than the scene's. Space is
        empty where no rod can be refined; levels that failed are missing.
    drawing
        One result by its level in space: with other curves through the points of rods that are
        drawn by them; empty where that failed, or where there is none.
    curves
        Names of these rods.
    cross_check
        The run with another stepper and much smaller steps (`der.accuracy.cross_check`); None for
        static scenes and explicit steppers, whose steps are small already.
    meshes, steps, notes
        As in `Verification`.
    cpu_seconds
        CPU time of all runs [s].
    """

    base: Result
    levels: int = 3
    time_levels: TimeLevels | None = None
    time: dict[int, Result] = field(default_factory=dict)
    space: dict[int, Result] = field(default_factory=dict)
    drawing: dict[int, Result] = field(default_factory=dict)
    curves: list[str] = field(default_factory=list)
    cross_check: Result | None = None
    meshes: list[str] = field(default_factory=list)
    steps: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    cpu_seconds: float = 0.0

    @property
    def space_is_refined(self) -> bool:
        """Whether there is a finer mesh."""
        return len(self.meshes) > 1

    @property
    def finest(self) -> Result:
        """The run on the finest mesh that did not fail."""
        return self.space[max(self.space)] if self.space else self.base

    def is_mirrored(self, axis: str) -> bool:
        """Whether a level of an axis ends in the mirror image of the scene's shape.

        The axes are ``space``, ``time`` and ``drawing``.
        """
        if self.base.path is not None or self.base.buckling is not None:
            return False  # what they find does not depend on the side
        results: list[Result] = list(getattr(self, axis).values())
        if axis == "time" and self.cross_check is not None:
            results.append(self.cross_check)
        return any(are_mirrored(self.base, found) for found in results)


def run_levels(scenario: Scenario, levels: int | None, workers: Workers) -> Runner:
    """Run a scene as written, and then on all levels in space and in time.

    Parameters
    ----------
    scenario
        With probes.
    levels
        2 or 3; None: 3 if that is affordable.
    workers
        Who runs them.

    Returns
    -------
    Runner
        With what was run, and for more levels (`Runner.refine`).

    Raises
    ------
    SceneError, NotConvergedError, DivergedError
        If the scene as written does not run to its end.
    """
    runs = _run_base(scenario, workers, _guess_rest(scenario, levels))
    refined = _can_refine_space(runs)
    if refined:
        runs.curves = curves_between_points(scenario)
    runs.levels = levels or _affordable_levels(runs, refined)
    if refined:
        runs.meshes = [_mesh_label(scenario, 2**level) for level in range(runs.levels)]
    if runs.time_levels is not None:
        runs.steps = [runs.time_levels.label(level) for level in range(runs.levels)]
    runner = Runner(runs, workers)
    runner.run()
    return runner


def _guess_rest(scenario: Scenario, levels: int | None) -> float:
    """Return about how many times the cost of the scene as written all other runs have."""
    finest = (levels or 3) - 1
    doubled = 2.0 ** (finest + 1) - 1.0  # 1 + 2 + ... over all levels
    if scenario.is_static:
        return doubled
    return doubled + (doubled - 1.0) + 2.0**finest  # in time, in space, and the cross-check run


def _run_base(scenario: Scenario, workers: Workers, rest: float) -> VerificationRuns:
    workers.expect(1.0, later=rest)
    outcome = workers.run({0: Task([scenario])})[0]
    failure = outcome.error
    if failure is not None and not isinstance(failure, SceneError):
        message = f"the scene itself fails, so there is nothing to verify: {failure}"
        named = type(failure)(message, failure.status)
        named.result = outcome.result
        raise named from failure
    base = outcome.value()
    finest = None if scenario.is_static else time_levels(base)
    return VerificationRuns(base, time_levels=finest, cpu_seconds=outcome.cpu_seconds)


def _can_refine_space(runs: VerificationRuns) -> bool:
    scenario = runs.base.scenario
    fixed = rods_that_cannot_be_refined(scenario)
    for rod, reason in fixed.items():
        runs.notes.append(f"space not refined: {reason} (rod '{rod}')")
    if len(fixed) == len(scenario.to_dict()["rods"]):
        return False
    try:
        with_elements(scenario, 2)
    except ValueError as error:
        runs.notes.append(f"space not refined: {error}")
        return False
    return True


def _affordable_levels(runs: VerificationRuns, refined: bool) -> int:
    times_base = 4.0 if refined else 0.0
    if runs.curves:
        times_base += 2.0**_DRAWING_LEVEL
    if runs.time_levels is not None:
        times_base += 2.0 * runs.time_levels.cost(2)
    if runs.cpu_seconds * times_base <= _BUDGET:
        return 3
    runs.notes.append("one refinement only, for its cost: the order is not measured")
    return 2


def _mesh_label(scenario: Scenario, factor: int) -> str:
    counts = count_nodes(with_elements(scenario, factor))
    return " + ".join(str(count) for count in counts.values()) + " nodes"


class Runner:
    """Fills in the runs of all levels.

    Parameters
    ----------
    runs
        With the base; the rest is filled in.
    workers
        Who runs them.

    Attributes
    ----------
    runs
        The runs so far, which are extended.
    """

    def __init__(self, runs: VerificationRuns, workers: Workers) -> None:
        self.runs = runs
        self._scenario = runs.base.scenario
        self._workers = workers
        self._finest = runs.levels - 1
        self._explicit = runs.time_levels is not None and not stepper_of(runs.base).implicit
        self._base_seconds = runs.cpu_seconds

    def run(self) -> None:
        """Run all levels."""
        tasks = self._time_tasks()
        if not self._explicit:
            tasks |= {key: self._task(key[1], 0) for key in self._space_keys() if key[1] > 0}
            tasks |= self._drawing_tasks(0)
        spaces = self._space_of_explicit(self._finest, self._finest) if self._explicit else {}
        self._run(tasks, later=total_weight(spaces.values()))
        if self._explicit:
            if self.runs.space_is_refined:
                self._run_space_of_explicit(self._finest)
        elif self.runs.space_is_refined and 0 in self.runs.time:
            self.runs.space[0] = self.runs.time[0]
        self._follow_the_branch([*self._space_keys(), *self._drawing_tasks(0)])

    def refine(self, axes: Collection[str]) -> bool:
        """Run one more level in space, in time or both; tell whether there is one more now.

        There is none where it costs more than what is left of the budget, where the one before has
        failed, or where it fails itself.
        """
        return any([self._refine_time("time" in axes), self._refine_space("space" in axes)])

    def _refine_time(self, wanted: bool) -> bool:
        level = len(self.runs.steps)
        levels = self.runs.time_levels
        if not wanted or levels is None or level - 1 not in self.runs.time:
            return False
        tasks: dict[Key, Task] = {("time", level): self._task(0, level)}
        if not self._is_affordable(tasks, level) or not self._run(tasks, report=False):
            return False
        self.runs.steps.append(levels.label(level))
        return True

    def _refine_space(self, wanted: bool) -> bool:
        level = len(self.runs.meshes)
        if not wanted or level - 1 not in self.runs.space:
            return False
        if self._explicit:
            tasks = self._space_of_explicit(level, level)
            done = self._is_affordable(tasks, level) and self._run_space_of_explicit(level, False)
        else:
            tasks = {("space", level): self._task(level, 0)}
            done = self._is_affordable(tasks, level) and self._run(tasks, report=False)
        if done:
            self.runs.meshes.append(_mesh_label(self._scenario, 2**level))
            self._follow_the_branch([("space", level)])
        return done

    def _is_affordable(self, tasks: Mapping[Key, Task], level: int) -> bool:
        seconds = self._base_seconds * total_weight(tasks.values())
        return level <= _FINEST and self.runs.cpu_seconds + seconds <= _BUDGET

    def _space_keys(self) -> list[Key]:
        return [("space", n) for n in range(self.runs.levels)] if self.runs.space_is_refined else []

    def _time_tasks(self) -> dict[Key, Task]:
        tasks: dict[Key, Task] = {("time", 0): self._task(0, 0)}
        if self.runs.time_levels is None:
            return tasks
        tasks |= {("time", n): self._task(0, n) for n in range(1, self.runs.levels)}
        if not self._explicit:
            tasks["cross-check", 0] = self._cross_check(self.runs.time_levels)
        return tasks

    def _drawing_tasks(self, time: int) -> dict[Key, Task]:
        if not self.runs.curves:
            return {}
        return {("drawing", _DRAWING_LEVEL): self._task(_DRAWING_LEVEL, time, True)}

    def _task(self, space: int, time: int, other_curve: bool = False) -> Task:
        scenario = with_elements(self._scenario, 2**space, other_curve=other_curve)
        levels = self.runs.time_levels
        if levels is None:
            return Task([_with_tight_newton(scenario), scenario], 2.0**space)
        scenario = levels.at(scenario, time)
        return Task([_with_tight_newton(scenario), scenario], 2.0**space * levels.cost(time))

    def _cross_check(self, levels: TimeLevels) -> Task:
        times_base = levels.cost(self._finest)
        halvings = cross_check_halvings(times_base * self.runs.cpu_seconds)
        times_base *= 2.0**halvings
        step = self._scenario.duration / int(self.runs.base.summary["steps"]) / times_base
        return Task([cross_check_scenario(self._scenario, step)], times_base)

    def _run_space_of_explicit(self, finest: int, report: bool = True) -> bool:
        """Compare meshes at a step that is stable on the finest one; tell whether there is one.

        It shrinks with the elements where stretching sets it, with their square where bending does.
        """
        for time in (finest, 2 * finest):
            tasks = self._space_of_explicit(finest, time)
            key: Key = ("space", finest)
            task = {key: tasks.pop(key)}
            rest = total_weight(tasks.values())
            if self._run(task, report=report and time > finest, later=rest):
                return self._run(tasks)
        return False

    def _space_of_explicit(self, finest: int, time: int) -> dict[Key, Task]:
        tasks: dict[Key, Task] = {("space", n): self._task(n, time) for n in range(finest + 1)}
        return tasks | self._drawing_tasks(time)

    def _follow_the_branch(self, keys: Iterable[Key]) -> None:
        """Start levels that have come to another equilibrium from the shape of the scene's run."""
        base = self.runs.base
        if self.runs.time_levels is not None or base.scenario.analysis not in _AT_REST:
            return
        runs = {(axis, n): getattr(self.runs, axis).get(n) for axis, n in keys}
        apart = {key: run for key, run in runs.items() if run and are_far_apart(base, run)}
        outcomes = self._workers.run({key: self._task_from_the_shape(*key) for key in apart})
        for (axis, level), outcome in outcomes.items():
            self.runs.cpu_seconds += outcome.cpu_seconds
            found = outcome.result
            if outcome.error is not None or found is None:
                continue
            if distance(base, found) < 0.5 * distance(base, apart[axis, level]):
                getattr(self.runs, axis)[level] = found
                self.runs.notes.append(
                    f"the run with {self._name(axis, level)} reached another equilibrium; it was "
                    "started again from the shape of the scene's own mesh, whose branch it follows"
                )

    def _task_from_the_shape(self, axis: Axis, level: int) -> Task:
        task = self._drawing_tasks(0)[axis, level] if axis == "drawing" else self._task(level, 0)
        return replace(task, weight=0.0, start=shape_on(self.runs.base, task.scenarios[0]))

    def _run(self, tasks: Mapping[Key, Task], report: bool = True, later: float = 0.0) -> bool:
        """Run tasks and keep the results of those that succeed; tell whether all did.

        Tasks that will be run `later` count in the progress already.
        """
        self._workers.expect(total_weight(tasks.values()), later)
        outcomes = self._workers.run(tasks)
        self.runs.cpu_seconds += sum(outcome.cpu_seconds for outcome in outcomes.values())
        for (axis, level), outcome in outcomes.items():
            if outcome.error is not None:
                if report:
                    name = self._name(axis, level)
                    self.runs.notes.append(f"the run with {name} failed: {outcome.error}")
            elif axis == "cross-check":
                self.runs.cross_check = outcome.value()
            else:
                getattr(self.runs, axis)[level] = outcome.value()
        return all(outcome.error is None for outcome in outcomes.values())

    def _name(self, axis: Axis, level: int) -> str:
        if axis == "space":
            return self.runs.meshes[level]
        if axis == "drawing":
            return OTHER_CURVES
        if axis == "cross-check":
            return CROSS_CHECK_STEPPER
        levels = self.runs.time_levels
        return "a tight tolerance" if levels is None else levels.label(level)


def _with_tight_newton(scenario: Scenario) -> Scenario:
    solver = scenario.to_dict().get("solver") or {}
    changes = {}
    for key in ("residual_tolerance", "step_tolerance"):
        given = float(solver.get(key, 1e-9))
        changes[f"solver.{key}"] = min(given, max(_LEAST_TOLERANCE, _TIGHTER * given))
    return scenario.with_(**changes)
