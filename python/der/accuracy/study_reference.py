"""The reference of a study: extrapolated in time on each mesh, and in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from der._core import Scenario
from der.accuracy.refinement import count_elements
from der.accuracy.study_plan import with_step
from der.parallel import Task
from der.result import Result

Array = NDArray[np.float64]

#: Stepper of references: second order with a small error, and stable in the hardest scenes.
REFERENCE_STEPPER = "tr_bdf2"
_TIME_LEVELS = 3
#: Newton's tolerances of references, far below the errors that are measured.
_TIGHT = {"solver.residual_tolerance": 1e-12, "solver.step_tolerance": 1e-13}


@dataclass(frozen=True)
class Reference:
    """Probes over time, and their errors.

    Attributes
    ----------
    probes
        By name, values at the times that runs are compared at, shape (times,).
    errors
        By name, the estimated largest error over these times.
    """

    probes: dict[str, Array]
    errors: dict[str, float]


def reference_tasks(
    meshes: Mapping[int, Scenario],
    stepper: str | None,
    step: float,
    every: float,
    cost_per_node: float,
) -> dict[tuple[int, int], Task]:
    """Return the runs that references on these meshes are made of, by mesh and level.

    Parameters
    ----------
    meshes
        Scenes by any key.
    stepper
        Stepper of the references; None for static scenes.
    step
        Step of the coarsest level [s]; two more levels halve it.
    every
        Between frames [s].
    cost_per_node
        Cost of the coarsest level, over the number of nodes, in the unit of `Task.weight`.
    """
    tasks = {}
    for mesh, scenario in meshes.items():
        size = sum(count_elements(scenario).values())
        for level in range(_TIME_LEVELS if stepper else 1):
            varied = scenario
            if stepper:
                varied = with_step(scenario, stepper, step / 2**level, every)
            weight = cost_per_node * size * 2.0**level
            scenarios = [varied.with_(**_TIGHT), varied]
            tasks[mesh, level] = Task(scenarios, weight, keep_motion=False)
    return tasks


def converge_in_time(results: Sequence[Result], probes: Sequence[str]) -> Reference:
    """Extrapolate runs with steps h, h/2 and h/4 by a second-order stepper."""
    series = [{name: np.asarray(result.probes[name]) for name in probes} for result in results]
    return _extrapolate(series, dict.fromkeys(probes, 0.0))


def static_reference(series: dict[str, Array]) -> Reference:
    """Return the numbers of a run without time, which has no error but that of its mesh."""
    return Reference(series, dict.fromkeys(series, 0.0))


def converge_in_space(meshes: Sequence[Reference]) -> Reference:
    """Extrapolate references on three meshes, each with twice the elements of the one before."""
    inherited = {name: max(mesh.errors[name] for mesh in meshes[1:]) for name in meshes[0].probes}
    return _extrapolate([mesh.probes for mesh in meshes], inherited)


def _extrapolate(series: Sequence[dict[str, Array]], inherited: Mapping[str, float]) -> Reference:
    """Extrapolate at second order from the first two and from the last two of three levels.

    By how much these differ bounds the error of the better one; errors that the levels have
    themselves come on top, enlarged as the extrapolation enlarges them.
    """
    probes, errors = {}, {}
    for name in series[0]:
        coarse, middle, fine = (level[name] for level in series)
        better = fine + (fine - middle) / 3.0
        worse = middle + (middle - coarse) / 3.0
        probes[name] = better
        errors[name] = float(np.max(np.abs(better - worse))) + 5.0 / 3.0 * inherited[name]
    return Reference(probes, errors)
