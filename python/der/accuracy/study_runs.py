"""Running the configurations of a study one by one, so that their costs are measured."""

from __future__ import annotations

from collections.abc import Sequence

from der._core import Scenario
from der.accuracy.study_costs import StudyCosts, repeats
from der.accuracy.study_plan import Mesh, common_interval, longest_of_halvings, with_step
from der.accuracy.study_trial import SKIPPED, Trial, skipped_trial, trial_of
from der.accuracy.time_levels import find_stepper
from der.errors import DerError
from der.parallel import Task, Workers, total_weight
from der.simulation import Simulation

#: Halvings of the scene's step in search of one that is stable for an explicit stepper.
_MOST_HALVINGS = 30
#: Steps that are tried for an explicit stepper from the longest stable one on.
_EXPLICIT_STEPS = 2


class StaticRuns:
    """The runs of a scene without time, one for each mesh.

    Parameters
    ----------
    meshes
        The meshes to try.
    costs
        Predicted costs of the runs.
    """

    def __init__(self, meshes: Sequence[Mesh], costs: StudyCosts) -> None:
        self._tasks = {
            i: Task(
                [mesh.scenario],
                costs.static_weight(mesh),
                costs.static_repeats(mesh),
                keep_motion=False,
            )
            for i, mesh in enumerate(meshes)
        }

    @property
    def weight(self) -> float:
        """The predicted cost of all of them, in the unit of `Task.weight`."""
        return total_weight(self._tasks.values())

    def run(self, workers: Workers) -> list[Trial]:
        """Run them, one at a time."""
        outcomes = workers.run(self._tasks, jobs=1)
        return [trial_of(i, "", 0.0, outcome) for i, outcome in outcomes.items()]


class DynamicRuns:
    """The runs of a scene over time: every mesh with every stepper and its steps.

    Parameters
    ----------
    meshes
        The meshes to try.
    steppers
        Names of the steppers to try.
    steps
        Steps to try [s], longest first.
    explicit_too
        Whether explicit steppers are run with `steps` as well; otherwise with the longest stable
        step among the halvings of the longest, and the next.
    every
        The interval [s] whose multiples the reference has.
    costs
        Predicted costs of the runs.
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
        first = longest_of_halvings(steps[0], every)
        self._halvings = [first / 2**count for count in range(_MOST_HALVINGS)]
        given = [name for name in steppers if explicit_too or find_stepper(name).implicit]
        self._planned = [
            (mesh, name, step) for mesh in range(len(meshes)) for name in given for step in steps
        ]
        #: The steps that are likely stable and so measured, by mesh and explicit stepper.
        self._likely_stable = {
            (mesh, name): self._stable_steps(mesh, name)
            for mesh in range(len(meshes))
            for name in steppers
            if name not in given
        }

    @property
    def weight(self) -> float:
        """The predicted cost of all of them, in the unit of `Task.weight`."""
        likely = [(*key, step) for key, steps in self._likely_stable.items() for step in steps]
        return sum(self._weight(*configuration) for configuration in (*self._planned, *likely))

    def run(self, workers: Workers) -> list[Trial]:
        """Run them, one at a time."""
        trials = [
            self._measure(*configuration, self._weight(*configuration), workers)
            for configuration in self._planned
        ]
        for mesh, name in self._likely_stable:
            trials += self._measure_explicit(mesh, name, workers)
        return trials

    def _stable_steps(self, mesh: int, stepper: str) -> list[float]:
        """Return the first halvings that are stable at the start of the run."""
        steps = self._halvings
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

    def _with_step(self, mesh: int, stepper: str, step: float) -> Scenario:
        every = common_interval(step, self._every)
        return with_step(self._meshes[mesh].scenario, stepper, step, every)

    def _weight(self, mesh: int, stepper: str, step: float) -> float:
        return self._costs.measuring_weight(self._meshes[mesh], stepper, step)

    def _measure(
        self, mesh: int, stepper: str, step: float, weight: float, workers: Workers
    ) -> Trial:
        expected = self._costs.seconds(self._meshes[mesh], stepper, step)
        if expected > self._costs.max_seconds:
            return skipped_trial(mesh, stepper, step)
        task = Task(
            [self._with_step(mesh, stepper, step)],
            weight,
            repeats(expected),
            keep_motion=False,
            max_seconds=self._costs.max_seconds,
        )
        return trial_of(mesh, stepper, step, workers.run({0: task}, jobs=1)[0])

    def _measure_explicit(self, mesh: int, stepper: str, workers: Workers) -> list[Trial]:
        """Halve the step until it is stable; measure that and the next ones."""
        announced = self._likely_stable[mesh, stepper]
        trials: list[Trial] = []
        stable = 0
        for step in self._halvings:
            weight = self._weight(mesh, stepper, step) if step in announced else 0.0
            trials.append(self._measure(mesh, stepper, step, weight, workers))
            stable += trials[-1].result is not None
            if stable == _EXPLICIT_STEPS or trials[-1].status == SKIPPED:
                break
        return trials
