"""The runs that a verification is made of."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, get_args

from der._core import Scenario
from der.accuracy.branches import are_far_apart, are_mirrored, distance, shape_on
from der.accuracy.cross_check import CROSS_CHECK_STEPPER, cross_check_halvings, cross_check_scenario
from der.accuracy.refinement import (
    count_nodes,
    curves_between_points,
    rods_that_cannot_be_refined,
    unresolved_curves,
    with_elements,
)
from der.accuracy.time_levels import TimeLevels, stepper_of
from der.errors import SceneError
from der.parallel import Task, Workers, total_weight
from der.result import Result

#: CPU time [s] up to which a third level is added, which measures the order, unless asked for, and
#: further ones where it shows no order.
_BUDGET = 60.0
#: Level in space at which curves through points are compared, or the finest there is. Their peaks
#: lie between the points, and more of them is seen with three nodes there than with one.
_DRAWING_LEVEL = 2
#: What the run with these is called.
OTHER_CURVES = "other curves through the points"
#: No level is finer than this many times doubled.
_FINEST = 4
#: Newton's tolerances are tightened by this, down to the least that rounding allows.
_TIGHTER = 1e-3
_LEAST_TOLERANCE = 1e-13
#: Analyses of an equilibrium, which is one near the shape that they start from.
_AT_REST = ("static", "modes")

Axis = Literal["time", "space", "drawing", "cross-check"]
AXES: tuple[Axis, ...] = get_args(Axis)
#: A run of a verification: what it varies, and its level.
Key = tuple[Axis, int]


@dataclass
class VerificationRuns:
    """The runs of a verification, and notes on them.

    Attributes
    ----------
    base
        The scene as written.
    time_levels
        How time is refined; None for a static scene.
    levels
        How many levels were asked for, the scene itself included.
    results
        The other runs that did not fail, with a tighter tolerance of Newton's method than the
        scene's: ``space`` and ``time`` by level; ``drawing``, with other curves through the points
        of rods, by its level in space; ``cross-check`` with another stepper and much smaller steps
        (`der.accuracy.cross_check`), unless the scene is static or has an explicit stepper, whose
        steps are small already.
    curves
        Names of the rods that are drawn by points.
    unresolved
        The nodes beside which these do not resolve the curve of a rod, by its name.
    meshes, steps, notes
        As in `Verification`.
    cpu_seconds
        CPU time of all runs [s].
    """

    base: Result
    time_levels: TimeLevels | None = None
    levels: int = 3
    results: dict[Key, Result] = field(default_factory=dict)
    curves: list[str] = field(default_factory=list)
    unresolved: dict[str, list[int]] = field(default_factory=dict)
    meshes: list[str] = field(default_factory=list)
    steps: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    cpu_seconds: float = 0.0

    @property
    def space_is_refined(self) -> bool:
        """Whether there is a finer mesh."""
        return len(self.meshes) > 1

    def of(self, axis: Axis) -> dict[int, Result]:
        """Return the results of an axis by level."""
        return {level: result for (own, level), result in self.results.items() if own == axis}

    @property
    def finest(self) -> Result:
        """The run on the finest mesh that did not fail."""
        space = self.of("space")
        return space[max(space)] if space else self.base

    def is_mirrored(self, axis: Axis) -> bool:
        """Whether a level of an axis ends in the mirror image of the scene's shape."""
        if self.base.path is not None or self.base.buckling is not None:
            return False  # what they find does not depend on the side
        results = [*self.of(axis).values()]
        if axis == "time":
            results += self.of("cross-check").values()
        return any(are_mirrored(self.base, found) for found in results)


class Runner:
    """Runs a scene with probes as written, and then on all levels in space and in time.

    These are 2 or 3 levels; 3 without a number, if that is affordable. An error of the scene as
    written is raised, those of other runs are noted.

    Attributes
    ----------
    runs
        The runs so far, which `refine` extends.
    """

    def __init__(self, scenario: Scenario, levels: int | None, workers: Workers) -> None:
        self._scenario = scenario
        self._workers = workers
        self.runs = runs = self._run_base(levels)
        self._base_seconds = runs.cpu_seconds
        self._explicit = runs.time_levels is not None and not stepper_of(runs.base).implicit
        refined = self._can_refine_space()
        if refined:
            runs.curves = curves_between_points(scenario)
            runs.unresolved = unresolved_curves(scenario)
        runs.levels = levels or self._affordable_levels(refined)
        if refined:
            runs.meshes = [self._name("space", level) for level in range(runs.levels)]
        if runs.time_levels is not None:
            runs.steps = [self._name("time", level) for level in range(runs.levels)]
        self._run_levels()

    def _run_base(self, levels: int | None) -> VerificationRuns:
        static = self._scenario.is_static
        finest = (levels or 3) - 1
        rest = 2.0 ** (finest + 1) - 1.0  # about the cost of all other runs: 1 + 2 + ... in space
        if not static:
            rest += (rest - 1.0) + 2.0**finest  # in time, and the cross-check run
        self._workers.expect(1.0, later=rest)
        outcome = self._workers.run({0: Task([self._scenario])})[0]
        failure = outcome.error
        if failure is not None and not isinstance(failure, SceneError):
            message = f"the scene itself fails, so there is nothing to verify: {failure}"
            named = type(failure)(message, failure.status)
            named.result = outcome.result
            raise named from failure
        base = outcome.value()
        time_levels = None if static else TimeLevels(base)
        return VerificationRuns(base, time_levels, cpu_seconds=outcome.cpu_seconds)

    def _can_refine_space(self) -> bool:
        fixed = rods_that_cannot_be_refined(self._scenario)
        for rod, reason in fixed.items():
            self.runs.notes.append(f"space not refined: {reason} (rod '{rod}')")
        if len(fixed) == len(self._scenario.to_dict()["rods"]):
            return False
        try:
            with_elements(self._scenario, 2)
        except ValueError as error:
            self.runs.notes.append(f"space not refined: {error}")
            return False
        return True

    def _affordable_levels(self, refined: bool) -> int:
        times_base = 4.0 if refined else 0.0
        if self.runs.curves:
            times_base += 2.0**_DRAWING_LEVEL
        if self.runs.time_levels is not None:
            times_base += 2.0 * self.runs.time_levels.cost(2)
        if self._base_seconds * times_base <= _BUDGET:
            return 3
        self.runs.notes.append("one refinement only, for its cost: the order is not measured")
        return 2

    def _run_levels(self) -> None:
        runs = self.runs
        finest = runs.levels - 1
        time_levels = range(runs.levels if runs.time_levels is not None else 1)
        tasks = self._tasks([("time", level) for level in time_levels])
        if self._explicit:
            spaces = self._tasks(self._space_keys(finest), finest)
            self._run(tasks, later=total_weight(spaces.values()))
            if spaces:
                self._run_explicit_spaces(finest)
        else:
            if runs.time_levels is not None:
                tasks["cross-check", 0] = self._cross_check(runs.time_levels)
            tasks |= self._tasks([key for key in self._space_keys(finest) if key[1] > 0])
            self._run(tasks)
            if runs.space_is_refined and ("time", 0) in runs.results:
                runs.results["space", 0] = runs.results["time", 0]
        self._follow_the_branch(self._space_keys(finest))

    def refine(self, axes: Collection[str]) -> bool:
        """Run one more level in space, in time or both; tell whether there is one more now.

        There is none where it costs more than what is left of the budget, where the one before has
        failed, or where it fails itself.
        """
        names: dict[Axis, list[str]] = {"time": self.runs.steps, "space": self.runs.meshes}
        added = [self._add_level(axis, own) for axis, own in names.items() if axis in axes]
        return any(added)

    def _add_level(self, axis: Axis, names: list[str]) -> bool:
        level = len(names)
        if level > _FINEST or (axis, level - 1) not in self.runs.results:
            return False
        many = self._explicit and axis == "space"
        tasks = (
            self._tasks(self._space_keys(level), level) if many else self._tasks([(axis, level)])
        )
        cost = self._base_seconds * total_weight(tasks.values())
        if self.runs.cpu_seconds + cost > _BUDGET:
            return False
        if not (self._run_explicit_spaces(level, False) if many else self._run(tasks, False)):
            return False
        names.append(self._name(axis, level))
        if axis == "space":
            self._follow_the_branch([(axis, level)])
        return True

    def _space_keys(self, finest: int) -> list[Key]:
        """Return the runs by which meshes are compared, and curves through points."""
        if not self.runs.space_is_refined:
            return []
        drawing: list[Key] = [("drawing", min(_DRAWING_LEVEL, finest))] if self.runs.curves else []
        return [*(("space", level) for level in range(finest + 1)), *drawing]

    def _tasks(self, keys: Iterable[Key], time: int = 0) -> dict[Key, Task]:
        """Return how runs are done, those that vary the mesh on a level in time."""
        return {key: self._task(*key, time) for key in keys}

    def _task(self, axis: Axis, level: int, time: int) -> Task:
        space, time = (0, level) if axis == "time" else (level, time)
        scenario = with_elements(self._scenario, 2**space, other_curve=axis == "drawing")
        cost = 2.0**space
        if self.runs.time_levels is not None:
            scenario = self.runs.time_levels.at(scenario, time)
            cost *= self.runs.time_levels.cost(time)
        return Task([_with_tight_newton(scenario), scenario], cost)

    def _cross_check(self, levels: TimeLevels) -> Task:
        times_base = levels.cost(self.runs.levels - 1)
        times_base *= 2.0 ** cross_check_halvings(times_base * self._base_seconds)
        step = self._scenario.duration / int(self.runs.base.summary["steps"]) / times_base
        return Task([cross_check_scenario(self._scenario, step)], times_base)

    def _run_explicit_spaces(self, finest: int, report: bool = True) -> bool:
        """Compare meshes at a step that is stable on the finest one; tell whether there is one.

        It shrinks with the elements where stretching sets it, with their square where bending does.
        """
        for time in (finest, 2 * finest):
            tasks = self._tasks(self._space_keys(finest), time)
            hardest: Key = ("space", finest)
            first = {hardest: tasks.pop(hardest)}
            later = total_weight(tasks.values())
            if self._run(first, report=report and time > finest, later=later):
                return self._run(tasks)
        return False

    def _follow_the_branch(self, keys: Iterable[Key]) -> None:
        """Start levels that have come to another equilibrium from the shape of the scene's run."""
        base, results = self.runs.base, self.runs.results
        if self.runs.time_levels is not None or base.scenario.analysis not in _AT_REST:
            return
        apart = [key for key in keys if key in results and are_far_apart(base, results[key])]
        tasks = {
            key: replace(task, weight=0.0, start=shape_on(base, task.scenarios[0]))
            for key, task in self._tasks(apart).items()
        }
        for key, outcome in self._workers.run(tasks).items():
            self.runs.cpu_seconds += outcome.cpu_seconds
            found = outcome.result
            if outcome.error is not None or found is None:
                continue
            if distance(base, found) < 0.5 * distance(base, results[key]):
                results[key] = found
                self.runs.notes.append(
                    f"the run with {self._name(*key)} reached another equilibrium; it was "
                    "started again from the shape of the scene's own mesh, whose branch it follows"
                )

    def _run(self, tasks: Mapping[Key, Task], report: bool = True, later: float = 0.0) -> bool:
        """Run tasks and keep the results of those that succeed; tell whether all did.

        Tasks that will be run `later` count in the progress already.
        """
        self._workers.expect(total_weight(tasks.values()), later)
        outcomes = self._workers.run(tasks)
        self.runs.cpu_seconds += sum(outcome.cpu_seconds for outcome in outcomes.values())
        for key, outcome in outcomes.items():
            if outcome.error is None:
                self.runs.results[key] = outcome.value()
            elif report:
                self.runs.notes.append(f"the run with {self._name(*key)} failed: {outcome.error}")
        return all(outcome.error is None for outcome in outcomes.values())

    def _name(self, axis: Axis, level: int) -> str:
        if axis == "space":
            counts = count_nodes(with_elements(self._scenario, 2**level))
            return " + ".join(map(str, counts.values())) + " nodes"
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
