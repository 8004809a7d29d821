"""The runs that a verification is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from der._core import Scenario
from der.accuracy.cross_check import WITNESS, witness_halvings, witness_scenario
from der.accuracy.refinement import (
    count_elements,
    rods_that_cannot_be_refined,
    with_elements,
)
from der.accuracy.time_levels import TimeLevels, stepper_of, time_levels
from der.errors import SceneError, error_for
from der.parallel import Task, Workers, total_weight
from der.result import Result

#: CPU time [s] up to which a third level is added, which measures the order, unless asked for.
_BUDGET = 60.0
#: Newton's tolerances are tightened by this, down to the least that rounding allows.
_TIGHTER = 1e-3
_LEAST_TOLERANCE = 1e-13

Axis = Literal["space", "time", "witness"]
Key = tuple[Axis, int]


@dataclass
class VerificationRuns:
    """What was run.

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
    witness
        The run with another stepper and much smaller steps (`der.accuracy.cross_check`); None for
        static scenes and explicit steppers, whose steps are small already.
    meshes, notes
        As in `Verification`.
    cpu_seconds
        Of all runs [s].
    """

    base: Result
    levels: int = 3
    time_levels: TimeLevels | None = None
    time: dict[int, Result] = field(default_factory=dict)
    space: dict[int, Result] = field(default_factory=dict)
    witness: Result | None = None
    meshes: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    cpu_seconds: float = 0.0

    @property
    def space_is_refined(self) -> bool:
        """Whether there is a finer mesh."""
        return len(self.meshes) > 1


def run_levels(scenario: Scenario, levels: int | None, workers: Workers) -> VerificationRuns:
    """Run a scene as written, and then on all levels in space and in time.

    Parameters
    ----------
    scenario
        With probes.
    levels
        2 or 3; None: 3 if that is affordable.
    workers
        Who runs them.

    Raises
    ------
    SceneError, NotConvergedError, DivergedError
        If the scene as written does not run to its end.
    """
    runs = _run_base(scenario, workers, _guess_rest(scenario, levels))
    refined = _can_refine_space(runs)
    runs.levels = levels or _affordable_levels(runs, refined)
    if refined:
        runs.meshes = [_mesh_label(scenario, 2**level) for level in range(runs.levels)]
    Runner(runs, workers).run()
    return runs


def _guess_rest(scenario: Scenario, levels: int | None) -> float:
    """Return about how many times the cost of the scene as written all other runs have."""
    finest = (levels or 3) - 1
    doubled = 2.0 ** (finest + 1) - 1.0  # 1 + 2 + ... over all levels
    if scenario.is_static:
        return doubled
    return doubled + (doubled - 1.0) + 2.0**finest  # in time, in space, and the witness


def _run_base(scenario: Scenario, workers: Workers, rest: float) -> VerificationRuns:
    workers.expect(1.0, later=rest)
    outcome = workers.run({0: Task([scenario])})[0]
    failure = outcome.error
    if failure is not None and not isinstance(failure, SceneError):
        message = f"the scene itself fails, so there is nothing to verify: {failure}"
        named = error_for(failure.status, message)
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
    if runs.time_levels is not None:
        times_base += 2.0 * runs.time_levels.cost(2)
    if runs.cpu_seconds * times_base <= _BUDGET:
        return 3
    runs.notes.append("one refinement only, for its cost: the order is not measured")
    return 2


def _mesh_label(scenario: Scenario, factor: int) -> str:
    counts = count_elements(with_elements(scenario, factor))
    return " + ".join(str(count + 1) for count in counts.values()) + " nodes"


class Runner:
    """Fills in the runs of all levels.

    Parameters
    ----------
    runs
        With the base; the rest is filled in.
    workers
        Who runs them.
    """

    def __init__(self, runs: VerificationRuns, workers: Workers) -> None:
        self._runs = runs
        self._scenario = runs.base.scenario
        self._workers = workers
        self._finest = runs.levels - 1

    def run(self) -> None:
        """Run all levels."""
        explicit = self._runs.time_levels is not None and not stepper_of(self._runs.base).implicit
        tasks = self._time_tasks()
        if not explicit:
            tasks |= {("space", n): self._task(n, 0) for n in self._space_levels() if n > 0}
        spaces = self._space_of_explicit(self._finest) if explicit else {}
        self._run(tasks, later=total_weight(spaces.values()))
        if explicit:
            self._run_space_of_explicit()
        elif self._runs.space_is_refined and 0 in self._runs.time:
            self._runs.space[0] = self._runs.time[0]

    def _space_levels(self) -> range:
        return range(self._runs.levels if self._runs.space_is_refined else 0)

    def _time_tasks(self) -> dict[Key, Task]:
        tasks: dict[Key, Task] = {("time", 0): self._task(0, 0)}
        if self._runs.time_levels is None:
            return tasks
        tasks |= {("time", n): self._task(0, n) for n in range(1, self._runs.levels)}
        if stepper_of(self._runs.base).implicit:
            tasks["witness", 0] = self._witness(self._runs.time_levels)
        return tasks

    def _task(self, space: int, time: int) -> Task:
        scenario = with_elements(self._scenario, 2**space)
        levels = self._runs.time_levels
        if levels is None:
            return Task([_with_tight_newton(scenario), scenario], 2.0**space)
        scenario = levels.at(scenario, time)
        return Task([_with_tight_newton(scenario), scenario], 2.0**space * levels.cost(time))

    def _witness(self, levels: TimeLevels) -> Task:
        times_base = levels.cost(self._finest)
        halvings = witness_halvings(times_base * self._runs.cpu_seconds)
        times_base *= 2.0**halvings
        step = self._scenario.duration / int(self._runs.base.summary["steps"]) / times_base
        return Task([witness_scenario(self._scenario, step)], times_base)

    def _run_space_of_explicit(self) -> None:
        """Compare meshes at a step that is stable on the finest one.

        It shrinks with the elements where stretching sets it, with their square where bending does.
        """
        if not self._runs.space_is_refined:
            return
        for time in (self._finest, 2 * self._finest):
            tasks = self._space_of_explicit(time)
            finest: Key = ("space", self._finest)
            task = {finest: tasks.pop(finest)}
            rest = total_weight(tasks.values())
            if self._run(task, report=time > self._finest, later=rest):
                self._run(tasks)
                break

    def _space_of_explicit(self, time: int) -> dict[Key, Task]:
        return {("space", n): self._task(n, time) for n in self._space_levels()}

    def _run(self, tasks: Mapping[Key, Task], report: bool = True, later: float = 0.0) -> bool:
        """Run tasks and keep the results of those that succeed; tell whether all did.

        What will be run `later` counts in the progress already.
        """
        self._workers.expect(total_weight(tasks.values()), later)
        outcomes = self._workers.run(tasks)
        self._runs.cpu_seconds += sum(outcome.cpu_seconds for outcome in outcomes.values())
        for (axis, level), outcome in outcomes.items():
            if outcome.error is not None:
                if report:
                    self._runs.notes.append(f"{self._describe(axis, level)}: {outcome.error}")
            elif axis == "witness":
                self._runs.witness = outcome.value()
            else:
                getattr(self._runs, axis)[level] = outcome.value()
        return all(outcome.error is None for outcome in outcomes.values())

    def _describe(self, axis: Axis, level: int) -> str:
        if axis == "space":
            return f"the run with {self._runs.meshes[level]} failed"
        if axis == "witness" or self._runs.time_levels is None:
            return f"the run with {WITNESS if axis == 'witness' else 'a tight tolerance'} failed"
        return f"the run with {self._runs.time_levels.label(level)} failed"


def _with_tight_newton(scenario: Scenario) -> Scenario:
    solver = scenario.to_dict().get("solver") or {}
    changes = {}
    for key in ("residual_tolerance", "step_tolerance"):
        given = float(solver.get(key, 1e-9))
        changes[f"solver.{key}"] = min(given, max(_LEAST_TOLERANCE, _TIGHTER * given))
    return scenario.with_(**changes)
