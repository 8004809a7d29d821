"""A check on the levels in time, which can agree with each other and be wrong together.

A stepper with damping of its own, run with steps longer than a vibration, lets the vibration die at
once, and does so again with half the step. A run with another stepper and much smaller steps
shows that: the cross-check run.
"""

from __future__ import annotations

import math

import numpy as np

from der._core import Scenario
from der.accuracy.refinement import with_time
from der.accuracy.time_levels import save_every_step
from der.result import Result

#: Stepper of the cross-check run: second order, stable in the hardest scenes, hardly any damping of
#: motion that its steps resolve.
CROSS_CHECK_STEPPER = "tr_bdf2"

#: CPU time [s] that its steps are chosen for; they are never longer than those of the finest level.
_BUDGET = 1.0
#: A step costs about this many times one of another implicit stepper, which solves once, not twice.
_COST = 2.0
_MOST_HALVINGS = 10

#: It contradicts if it differs this many times more than the two finest runs do ...
_CONTRADICTION = 5.0
#: ... and by more than this share of what the probe goes through in the run.
_NOTABLE = 0.005


def cross_check_halvings(cpu_seconds: float) -> int:
    """Return how many times to halve the step of the finest level, which costs so much [s]."""
    affordable = _BUDGET / (_COST * max(cpu_seconds, 1e-6))
    return min(max(0, math.floor(math.log2(affordable))), _MOST_HALVINGS)


def cross_check_scenario(scenario: Scenario, step: float) -> Scenario:
    """Return the scene with the stepper of the cross-check run and this step [s]."""
    own = ("tolerance", "minimum_step", "spectral_radius", "allow_unstable", "every")
    changed = with_time(scenario, integrator=CROSS_CHECK_STEPPER, step=step, **dict.fromkeys(own))
    return save_every_step(changed, step)


def hidden_motion(
    coarse: Result, fine: Result, cross_check: Result, probe: str, noise: float
) -> float | None:
    """Return how far the cross-check run is from where the levels agree; None if it is not.

    That is the largest difference in the second half of the run, in the unit of the probe, to the
    finer of the two finest levels.
    """
    late = fine.times >= 0.5 * fine.times[-1]

    def largest_difference(other: Result) -> float:
        values = np.interp(fine.times[late], other.times, np.asarray(other.probes[probe]))
        return float(np.max(np.abs(values - np.asarray(fine.probes[probe])[late])))

    away = largest_difference(cross_check)
    travelled = float(np.ptp(np.asarray(cross_check.probes[probe])))
    least = max(_CONTRADICTION * largest_difference(coarse), _NOTABLE * travelled, noise)
    return away if away > least else None
