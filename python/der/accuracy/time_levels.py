"""A scene with steps, or tolerances, that get finer level by level."""

from __future__ import annotations

import math
from typing import Any, Protocol

from der._core import Model, Scenario, StepperInfo, steppers
from der.accuracy.refinement import with_time
from der.result import Result

#: Saved frames of one run take no more memory than this [bytes].
_FRAME_MEMORY = 64e6
#: Frames of a run whose steps are not known beforehand.
_ADAPTIVE_FRAMES = 2000


class TimeLevels(Protocol):
    """Finer and finer ways to run a scene over time; level 0 is the scene as written.

    Attributes
    ----------
    order, ratio
        From one level to the next, the error is expected to shrink by ``ratio ** order``.
    """

    order: float
    ratio: float

    def at(self, scenario: Scenario, level: int) -> Scenario:
        """Return the scene with the step or tolerance of a level, and frames to find extremes."""
        ...

    def label(self, level: int) -> str:
        """Return what is varied, with its unit."""
        ...

    def cost(self, level: int) -> float:
        """Return how many times the cost of level 0 a level costs."""
        ...


class StepLevels:
    """Steps of half the length from level to level."""

    ratio = 2.0

    def __init__(self, result: Result) -> None:
        self._step = fixed_step(result)
        self.order = float(stepper_of(result).order)

    def at(self, scenario: Scenario, level: int) -> Scenario:
        """Return the scene with the step of a level; it saves every step if memory allows."""
        return save_every_step(scenario, self.step(level))

    def label(self, level: int) -> str:
        """Return the step."""
        return f"{self.step(level):.4g} s"

    def cost(self, level: int) -> float:
        """Return how many times as many steps there are."""
        return self.ratio**level

    def step(self, level: int) -> float:
        """Return the step of a level [s]."""
        return self._step / self.ratio**level


class ToleranceLevels:
    """Tolerances a quarter as large from level to level.

    The step control is there to keep the error proportional to the tolerance, so order 1 of the
    tolerance is expected, whatever the stepper's own.
    """

    ratio = 4.0
    order = 1.0

    def __init__(self, result: Result, tolerance: float) -> None:
        self._tolerance = tolerance
        self._stepper_order = stepper_of(result).order

    def at(self, scenario: Scenario, level: int) -> Scenario:
        """Return the scene with the tolerance of a level."""
        every = scenario.duration / _ADAPTIVE_FRAMES
        return with_time(scenario, tolerance=self._tolerance / self.ratio**level, every=every)

    def label(self, level: int) -> str:
        """Return the tolerance."""
        return f"tolerance {self._tolerance / self.ratio**level:.3g}"

    def cost(self, level: int) -> float:
        """Return how many times as many steps there are about."""
        return float(self.ratio ** (level / self._stepper_order))


def time_levels(result: Result) -> TimeLevels:
    """Return the levels of the scene that a result comes from; not for a static one."""
    tolerance = result.scenario.to_dict()["time"].get("tolerance")
    return StepLevels(result) if tolerance is None else ToleranceLevels(result, float(tolerance))


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
    """Return a stepper by its name.

    Raises
    ------
    ValueError
        If there is none.
    """
    for info in steppers():
        if info.name == name:
            return info
    names = ", ".join(info.name for info in steppers())
    raise ValueError(f"there is no stepper {name!r}; there are: {names}")


def save_every_step(scenario: Scenario, step: float) -> Scenario:
    """Return the scene with this step [s], saving every one, or as many as memory allows."""
    values_per_frame = 4 * Model(scenario).num_nodes + 32
    most = max(1.0, _FRAME_MEMORY / (8 * values_per_frame))
    every = step * max(1, math.ceil(scenario.duration / step / most))
    # A floor for retries that was meant for the scene's own step may lie above this one.
    return with_time(scenario, step=step, every=every, minimum_step=None)
