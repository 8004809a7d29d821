"""Final value and extremes of a probe over a run, better than its samples tell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from der.result import Result

Array = NDArray[np.float64]


#: A step closer to a frame than this share of the distance of frames is that frame.
_SAME_TIME = 1e-6


def probe_values(result: Result, name: str) -> dict[str, float]:
    """Return ``final``, ``min`` and ``max`` of a probe over time.

    Extremes inside the run are those of the parabola through the extreme step or frame and the
    saved frames beside it, so that they converge with the step instead of jumping with the samples.
    """
    probe = result.probes[name]
    series = np.asarray(probe)
    summary = probe.summary
    t_min, t_max = summary.get("t_min", 0.0), summary.get("t_max", 0.0)
    return {
        "final": summary["final"],
        "min": -_largest(result.times, -series, t_min, -summary["min"]),
        "max": _largest(result.times, series, t_max, summary["max"]),
    }


def _largest(times: Array, saved: Array, time: float, value: float) -> float:
    """Return the largest value over time; among the steps it is `value`, at `time`."""
    best = int(np.argmax(saved))
    if saved[best] > value:  # a frame between two steps
        time, value = times[best], float(saved[best])
    if not times[0] < time < times[-1]:
        return value
    after = int(np.searchsorted(times, time, side="right"))
    before = after - 1
    near = _SAME_TIME * (times[after] - times[before])
    before -= time - times[before] <= near
    after += times[after] - time <= near
    if before < 0 or after == len(times):
        return value
    return parabola_top(
        np.array([times[before], time, times[after]]),
        np.array([saved[before], value, saved[after]]),
    )


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
