"""A configuration of a study and how its run went."""

from __future__ import annotations

import math
from dataclasses import dataclass

from der.accuracy.time_levels import find_stepper
from der.parallel import TOO_LONG, Outcome
from der.result import Result

UNSTABLE = "unstable"
SKIPPED = "skipped"


@dataclass(frozen=True)
class Trial:
    """A configuration and how its run went.

    Attributes
    ----------
    mesh
        Its place in the list of meshes.
    stepper, step
        Time integrator and step [s]; empty and 0 for a static scene.
    status
        As in ``summary.json``, ``unstable`` of an explicit stepper that failed, or ``skipped``.
    result
        None if it did not run to its end.
    cpu_seconds
        CPU time [s]; NaN if it did not run to its end.
    """

    mesh: int
    stepper: str
    step: float
    status: str
    result: Result | None
    cpu_seconds: float


def skipped_trial(mesh: int, stepper: str, step: float) -> Trial:
    """Return a configuration that is not run."""
    return Trial(mesh, stepper, step, SKIPPED, None, math.nan)


def trial_of(mesh: int, stepper: str, step: float, outcome: Outcome[Result]) -> Trial:
    """Return a configuration that was run."""
    if outcome.error is None:
        assert outcome.result is not None
        result = outcome.result
        return Trial(mesh, stepper, step, result.status, result, outcome.cpu_seconds)
    status = outcome.error.status
    if status == TOO_LONG:
        status = SKIPPED
    elif stepper and not find_stepper(stepper).implicit:
        status = UNSTABLE
    return Trial(mesh, stepper, step, status, None, math.nan)
