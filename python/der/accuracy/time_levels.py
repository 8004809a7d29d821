"""A scene with steps, or tolerances, that get finer level by level."""

from __future__ import annotations

import math
from typing import Any

from der._core import Model, Scenario, StepperInfo, steppers
from der.accuracy.refinement import with_time
from der.result import Result

#: Saved frames of one run take no more memory than this [bytes].
_FRAME_MEMORY = 64e6
#: Frames of a run whose steps are not known beforehand.
_ADAPTIVE_FRAMES = 2000


class TimeLevels:
    """Finer and finer ways to run a scene over time; level 0 is the scene as written.

    Steps halve from level to level; of a scene with a tolerance that is a quarter each time. The
    step control is there to keep the error proportional to the tolerance, so order 1 of the
    tolerance is expected, whatever the stepper's own.

    Attributes
    ----------
    order, ratio
        From one level to the next, the error is expected to shrink by ``ratio ** order``.
    """

    def __init__(self, result: Result) -> None:
        tolerance = result.scenario.to_dict()["time"].get("tolerance")
        self._adaptive = tolerance is not None
        self._coarsest = float(tolerance) if self._adaptive else fixed_step(result)
        self._stepper_order = stepper_of(result).order
        self.ratio = 4.0 if self._adaptive else 2.0
        self.order = 1.0 if self._adaptive else float(self._stepper_order)

    def at(self, scenario: Scenario, level: int) -> Scenario:
        """Return the scene with the step or tolerance of a level, and frames to find extremes."""
        finer = self._coarsest / self.ratio**level
        if self._adaptive:
            return with_time(scenario, tolerance=finer, every=scenario.duration / _ADAPTIVE_FRAMES)
        return save_every_step(scenario, finer)

    def label(self, level: int) -> str:
        """Return what is varied, with its unit."""
        finer = self._coarsest / self.ratio**level
        return f"tolerance {finer:.3g}" if self._adaptive else f"{finer:.4g} s"

    def cost(self, level: int) -> float:
        """Return how many times as many steps there are, of a tolerance about."""
        return float(self.ratio ** (level / self._stepper_order if self._adaptive else level))


def fixed_step(result: Result) -> float:
    """Return the time step of a run [s]; of one whose scene says ``step: auto`` the shortest."""
    given: Any = result.scenario.to_dict()["time"].get("step")
    if isinstance(given, (int, float)):
        return float(given)
    mean = result.scenario.duration / result.summary["steps"]
    return float(result.summary.get("shortest_step", mean))


def stepper_of(result: Result) -> StepperInfo:
    """Return the stepper that a run was done with."""
    return find_stepper(str(result.summary["integrator"]))


def find_stepper(name: str) -> StepperInfo:
    """Return a stepper by its name; if there is none, a `ValueError` says which there are."""
    by_name = {info.name: info for info in steppers()}
    if name not in by_name:
        raise ValueError(f"there is no stepper {name!r}; there are: {', '.join(by_name)}")
    return by_name[name]


def save_every_step(scenario: Scenario, step: float) -> Scenario:
    """Return the scene with this step [s], saving every one, or as many as memory allows."""
    values_per_frame = 4 * Model(scenario).num_nodes + 32
    most = max(1.0, _FRAME_MEMORY / (8 * values_per_frame))
    every = step * max(1, math.ceil(scenario.duration / step / most))
    # A floor for retries that was meant for the scene's own step may lie above this one.
    return with_time(scenario, step=step, every=every, minimum_step=None)
