"""Running the configurations of a study one by one, so that their costs are measured."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

from der._core import Scenario
from der.accuracy.study_plan import (
    Mesh,
    common_interval,
    find_leading_rod,
    longest_of_halvings,
    with_step,
)
from der.accuracy.time_levels import find_stepper
from der.errors import DerError
from der.parallel import TOO_LONG, Task, Workers
from der.result import Result
from der.simulation import Simulation

UNSTABLE, SKIPPED = "unstable", "skipped"
#: Halvings of the scene's step in search of one that is stable for an explicit stepper.
_MOST_HALVINGS = 30
#: Steps that are tried for an explicit stepper from the longest stable one on.
_EXPLICIT_STEPS = 2
#: Runs are repeated while all of them together take less than this [s].
_MEASURING_TIME = 0.3
_MOST_REPEATS = 5
#: The costliest run of the reference may take this many times what a configuration may.
_REFERENCE_COST = 5.0


@dataclass(frozen=True)
class Configuration:
    """A mesh, by its place in the list of meshes, a stepper and a step [s].

    Stepper and step are empty and 0 for a scene without time.
    """

    mesh: int
    stepper: str
    step: float


@dataclass(frozen=True)
class Trial:
    """A configuration and how its run went.

    Attributes
    ----------
    status
        As in ``summary.json``, ``unstable`` of an explicit stepper that failed, or ``skipped``.
    result
        None if it did not run to its end.
    cpu_seconds
        CPU time [s]; NaN if it did not run to its end.
    """

    tried: Configuration
    status: str
    result: Result | None = None
    cpu_seconds: float = math.nan


class StudyCosts:
    """Predicts CPU times: they grow with the number of nodes and of steps.

    The run of the scene as written took `cpu_seconds` [s], which is the unit of weights; a
    configuration may take `max_seconds` [s].
    """

    def __init__(self, base: Result, cpu_seconds: float, max_seconds: float) -> None:
        self.cpu_seconds = cpu_seconds
        self.max_seconds = max_seconds
        self._base = base
        static = base.scenario.is_static
        steps = 1 if static else max(1, int(base.summary.get("steps", 1)))
        cost = 1.0 if static else find_stepper(str(base.summary["integrator"])).step_cost
        self._seconds_per_step = cpu_seconds / (base.model.num_nodes * steps) / cost

    def seconds(self, nodes: float, stepper: str, step: float) -> float:
        """Return the expected CPU time [s] of a run with so many nodes in all."""
        per_node = self._seconds_per_step
        if stepper:
            per_node *= find_stepper(stepper).step_cost * (self._base.scenario.duration / step)
        return per_node * nodes

    def affordable_steps(self, steps: Sequence[float], nodes: int) -> list[float]:
        """Return the longest steps, given longest first, whose reference is affordable.

        It is four times finer, on a mesh with this number of nodes. At least two are kept.
        """
        kept = list(steps)
        per_step = self._seconds_per_step * nodes * self._base.scenario.duration
        while len(kept) > 2 and 4.0 * per_step / kept[-1] > _REFERENCE_COST * self.max_seconds:
            kept.pop()
        return kept

    def total_nodes(self, mesh: Mesh) -> float:
        """Return the nodes of all rods, if all are refined as the one is that names the mesh."""
        rod = find_leading_rod(self._base.scenario)
        own_nodes = len(next(r for r in self._base.rods if rod in (None, r.name)).nodes)
        return self._base.model.num_nodes * mesh.nodes / own_nodes


class StudyRuns:
    """Every mesh with every stepper and its steps.

    Steps [s] are longest first; a scene without time has a stepper without a name and a step of 0.
    Explicit steppers are run with these steps only if `explicit_too`, otherwise with the longest
    stable step among the halvings of the longest, and the next. The reference has the multiples of
    the interval `every` [s].
    """

    def __init__(
        self,
        meshes: Sequence[Mesh],
        steppers: Sequence[str],
        steps: Sequence[float],
        explicit_too: bool,
        every: float,
        costs: StudyCosts,
    ) -> None:
        self._meshes = meshes
        self._every = every
        self._costs = costs
        searched = [s for s in steppers if s and not explicit_too and not find_stepper(s).implicit]
        self._planned = [
            Configuration(mesh, stepper, step)
            for mesh in range(len(meshes))
            for stepper in steppers
            if stepper not in searched
            for step in steps
        ]
        longest = longest_of_halvings(steps[0], every) if searched else 0.0
        self._searched = [
            [Configuration(mesh, s, longest / 2**count) for count in range(_MOST_HALVINGS)]
            for mesh in range(len(meshes))
            for s in searched
        ]
        #: Of each search, the steps that are likely stable and so measured.
        self._likely_stable = [self._stable_at_the_start(halvings) for halvings in self._searched]

    @property
    def weight(self) -> float:
        """The predicted cost of all of them, in the unit of `Task.weight`."""
        return sum(map(self._weight, chain(self._planned, *self._likely_stable)))

    def run(self, workers: Workers) -> list[Trial]:
        """Run them, one at a time."""
        trials = [self._measure(tried, self._weight(tried), workers) for tried in self._planned]
        for halvings, announced in zip(self._searched, self._likely_stable, strict=True):
            stable = 0
            for tried in halvings:
                weight = self._weight(tried) if tried in announced else 0.0
                trials.append(self._measure(tried, weight, workers))
                stable += trials[-1].result is not None
                if stable == _EXPLICIT_STEPS or trials[-1].status == SKIPPED:
                    break
        return trials

    def _stable_at_the_start(self, halvings: list[Configuration]) -> list[Configuration]:
        refused = 0
        while refused < len(halvings) and self._is_refused(halvings[refused]):
            refused += 1
        return halvings[refused : refused + _EXPLICIT_STEPS]

    def _is_refused(self, tried: Configuration) -> bool:
        try:
            Simulation(self._scenario(tried))
        except DerError:
            return True
        return False

    def _scenario(self, tried: Configuration) -> Scenario:
        scenario = self._meshes[tried.mesh].scenario
        if not tried.stepper:
            return scenario
        every = common_interval(tried.step, self._every)
        return with_step(scenario, tried.stepper, tried.step, every)

    def _seconds(self, tried: Configuration) -> float:
        nodes = self._costs.total_nodes(self._meshes[tried.mesh])
        return self._costs.seconds(nodes, tried.stepper, tried.step)

    def _takes_too_long(self, tried: Configuration) -> bool:
        return bool(tried.stepper) and self._seconds(tried) > self._costs.max_seconds

    def _weight(self, tried: Configuration) -> float:
        """Return the expected weight of all repeats; 0 of a run that takes too long."""
        if self._takes_too_long(tried):
            return 0.0
        return self._seconds(tried) * self._repeats(tried) / self._costs.cpu_seconds

    def _repeats(self, tried: Configuration) -> int:
        return max(1, min(_MOST_REPEATS, int(_MEASURING_TIME / self._seconds(tried))))

    def _measure(self, tried: Configuration, weight: float, workers: Workers) -> Trial:
        if self._takes_too_long(tried):
            return Trial(tried, SKIPPED)
        task = Task(
            [self._scenario(tried)],
            weight,
            self._repeats(tried),
            keep_motion=False,
            max_seconds=self._costs.max_seconds if tried.stepper else math.inf,
        )
        outcome = workers.run({0: task}, jobs=1)[0]
        if outcome.error is None:
            result = outcome.value()
            return Trial(tried, result.status, result, outcome.cpu_seconds)
        status = outcome.error.status
        if status == TOO_LONG:
            status = SKIPPED
        elif tried.stepper and not find_stepper(tried.stepper).implicit:
            status = UNSTABLE
        return Trial(tried, status)
