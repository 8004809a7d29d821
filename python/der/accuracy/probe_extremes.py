"""Final value and extremes of a probe over a run, better than its samples tell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from der.result import Result

Array = NDArray[np.float64]


def probe_values(result: Result, name: str) -> dict[str, float]:
    """Return ``final``, ``min`` and ``max`` of a probe over time.

    Extremes inside the run are those of the parabola through the three saved frames around them, so
    that they converge with the step instead of jumping with the samples. That needs a run that has
    saved every step; where a step between the frames is farther out, that step counts.
    """
    probe = result.probes[name]
    series = np.asarray(probe)
    return {
        "final": probe.summary["final"],
        "min": -_largest(result.times, -series, -probe.summary["min"]),
        "max": _largest(result.times, series, probe.summary["max"]),
    }


def _largest(times: Array, saved: Array, of_all_steps: float) -> float:
    best = int(np.argmax(saved))
    if not 0 < best < len(saved) - 1 or saved[best] < of_all_steps:
        return of_all_steps
    return parabola_top(times[best - 1 : best + 2], saved[best - 1 : best + 2])


def parabola_top(times: Array, values: Array) -> float:
    """Return the largest value of the parabola through three points, the middle one the highest.

    Parameters
    ----------
    times
        Ascending, shape (3,).
    values
        Shape (3,).
    """
    left = (values[1] - values[0]) / (times[1] - times[0])
    right = (values[2] - values[1]) / (times[2] - times[1])
    second = (right - left) / (times[2] - times[0])
    if second == 0.0:
        return float(values[1])
    slope = left + second * (times[1] - times[0])
    return float(values[1] - 0.25 * slope**2 / second)
