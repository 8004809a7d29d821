"""Predicted costs of the runs of a study, from the run of the scene itself."""

from __future__ import annotations

from collections.abc import Sequence

from der._core import steppers
from der.accuracy.study_plan import Mesh, find_leading_rod
from der.result import Result

#: Runs are repeated while all of them together take less than this [s].
_MEASURING_TIME = 0.3
_MOST_REPEATS = 5
#: The costliest run of the reference may take this many times what a configuration may.
_REFERENCE_COST = 5.0


class StudyCosts:
    """Predicts CPU times: they grow with the number of nodes and of steps.

    Parameters
    ----------
    base
        The run of the scene as written.
    cpu_seconds
        CPU time of the scene itself [s]: the unit of weights.
    max_seconds
        CPU time allowed for a configuration [s].
    """

    def __init__(self, base: Result, cpu_seconds: float, max_seconds: float) -> None:
        self._base = base
        self._cpu_seconds = cpu_seconds
        self._max_seconds = max_seconds
        static = base.scenario.is_static
        stepper = "" if static else str(base.summary["integrator"])
        work = base.model.num_nodes * max(1, int(base.summary.get("steps", 1)))
        self._seconds_per_step = cpu_seconds / work / _cost_of_step(stepper)

    @property
    def max_seconds(self) -> float:
        """The CPU time [s] allowed for a configuration."""
        return self._max_seconds

    def seconds(self, mesh: Mesh, stepper: str, step: float) -> float:
        """Return the expected CPU time of a run over time [s]."""
        return self._seconds_per_node(stepper, step) * self._total_nodes(mesh)

    def measuring_weight(self, mesh: Mesh, stepper: str, step: float) -> float:
        """Return the expected weight of all repeats; 0 of a run that takes too long."""
        expected = self.seconds(mesh, stepper, step)
        if expected > self._max_seconds:
            return 0.0
        return expected * repeats(expected) / self._cpu_seconds

    def weight_per_node(self, stepper: str, step: float) -> float:
        """Return the expected weight of a run over time, divided by its number of nodes."""
        return self._seconds_per_node(stepper, step) / self._cpu_seconds

    @property
    def static_weight_per_node(self) -> float:
        """The weight of a static run, divided by its number of nodes."""
        return 1.0 / self._base.model.num_nodes

    def static_repeats(self, mesh: Mesh) -> int:
        """Return how many times a static run is repeated."""
        return repeats(self._seconds_per_step * self._total_nodes(mesh))

    def static_weight(self, mesh: Mesh) -> float:
        """Return the expected weight of all repeats of a static run."""
        nodes = self._total_nodes(mesh)
        return self.static_weight_per_node * nodes * self.static_repeats(mesh)

    def affordable_steps(self, steps: Sequence[float], nodes: int) -> list[float]:
        """Return the longest steps whose reference, four times finer, is affordable.

        At least two are kept.

        Parameters
        ----------
        steps
            Longest first [s].
        nodes
            Number of nodes of the finest mesh of the reference.
        """
        kept = list(steps)
        per_step = self._seconds_per_step * nodes * self._base.scenario.duration
        while len(kept) > 2 and 4.0 * per_step / kept[-1] > _REFERENCE_COST * self._max_seconds:
            kept.pop()
        return kept

    def _seconds_per_node(self, stepper: str, step: float) -> float:
        steps = self._base.scenario.duration / step
        return self._seconds_per_step * _cost_of_step(stepper) * steps

    def _total_nodes(self, mesh: Mesh) -> float:
        """Return the nodes of all rods, if all are refined as the one is that names the mesh."""
        rod = find_leading_rod(self._base.scenario)
        own_nodes = len(next(r for r in self._base.rods if rod in (None, r.name)).nodes)
        return self._base.model.num_nodes * mesh.nodes / own_nodes


def repeats(seconds: float) -> int:
    """Return how many times a run of so many seconds is repeated to measure its cost."""
    return max(1, min(_MOST_REPEATS, int(_MEASURING_TIME / seconds)))


def _cost_of_step(stepper: str) -> float:
    """Return the cost of a step as the catalog has it; 1 for a static scene, without a stepper."""
    return next((info.step_cost for info in steppers() if info.name == stepper), 1.0)
