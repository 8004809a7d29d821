"""The numbers of a run by which runs are compared.

Points of a path of equilibria cannot be: where the steps of a continuation end is its own affair.
Its events can, and the place where the factor comes to its end. Of a run over time, they are the
final value and the extremes of each probe, better than its samples tell.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from der._core import array_units
from der.analyses import Path
from der.result import Result

Array = NDArray[np.float64]

_UNITS = array_units()
#: Results of modes and linear buckling of a plane for motion out of it, with their units.
_OUT_OF_PLANE = {"growth_rate": _UNITS["modes/growth_rates"], "load_factor": ""}
#: The factor is where the scene wants it, to this share of its range.
_SAME_FACTOR = 1e-9
#: A step closer to a frame than this share of the distance of frames is that frame.
_SAME_TIME = 1e-6


@dataclass(frozen=True)
class Reading:
    """A number of a run.

    Attributes
    ----------
    probe
        Name of a probe, or of what an analysis itself finds: ``factor`` on a path, ``frequency 1``
        and ``growth rate 1`` of modes, ``load factor 1`` of buckling; ``growth rate out of plane``
        and ``load factor out of plane`` of planar models.
    what
        ``final``, ``min`` or ``max`` over time; on a path the place: ``fold 1``, ``bifurcation 1``,
        ``out_of_plane 1``, where directions out of the plane lose or regain their stability,
        counted along it, ``end`` where the factor reaches its last value, ``opposite limit`` where
        it reaches twice the first value less the last.
    unit
        In SI.
    value
        The number.
    largest
        Largest absolute value of the probe in the run.
    at_steps
        The number as the run itself tells it, which knows extremes at its steps only.
    time
        When it is reached [s]; 0 without time.
    travelled
        What the probe goes through in time, largest less smallest value.
    """

    probe: str
    what: str
    unit: str
    value: float
    largest: float
    at_steps: float
    time: float = 0.0
    travelled: float = 0.0

    @property
    def label(self) -> str:
        """Its label: ``tip_y``, or ``tip_y, fold 1``."""
        return self.probe if self.what == "final" else f"{self.probe}, {self.what}"

    @property
    def kind(self) -> str:
        """The kind that it is counted with: ``fold``; its own name if it is not on a path."""
        return self.probe if self.what == "final" else self.what.rstrip(" 0123456789")


#: By their label, in the order in which they are told.
Readings: TypeAlias = dict[str, Reading]


def read_run(result: Result) -> Readings:
    """Return the comparable numbers of a run."""
    if not result.scenario.is_static:
        found = _over_time(result)
    else:
        found = _at_rest(result) if result.path is None else _on_path(result, result.path)
    return {reading.label: reading for reading in found}


def _over_time(result: Result) -> Iterator[Reading]:
    for name, probe in result.probes.items():
        summary = probe.summary
        largest = max(abs(summary["min"]), abs(summary["max"]))
        travelled = summary["max"] - summary["min"]
        for what, value in probe_values(result, name).items():
            time = summary.get(f"t_{what}", result.summary["time"])
            yield Reading(name, what, probe.unit, value, largest, summary[what], time, travelled)


def _at_rest(result: Result) -> Iterator[Reading]:
    for name, probe in result.probes.items():
        yield _final(name, probe.unit, probe.summary["final"])
    if result.modes is not None:
        rates = zip(result.modes.frequencies, result.modes.growth_rates, strict=True)
        for number, (frequency, growth) in enumerate(rates, 1):
            if growth > 0.0:
                yield _final(f"growth rate {number}", _UNITS["modes/growth_rates"], growth)
            else:
                yield _final(f"frequency {number}", _UNITS["modes/frequencies"], frequency)
    if result.buckling is not None:
        for number, factor in enumerate(result.buckling.load_factors, 1):
            yield _final(f"load factor {number}", "", factor)
    if result.scenario.analysis in ("modes", "buckling"):
        out_of_plane = result.summary.get("out_of_plane", {})
        for key, unit in _OUT_OF_PLANE.items():
            if (found := out_of_plane.get(key)) is not None:  # there may be no such number
                yield _final(f"{key.replace('_', ' ')} out of plane", unit, found)


def _final(name: str, unit: str, number: float) -> Reading:
    value = float(number)
    return Reading(name, "final", unit, value, abs(value), value)


def _on_path(result: Result, path: Path) -> Iterator[Reading]:
    """Read the first branch at its events and where it ends, in the order of the path."""
    places = [
        (f"{event} {number}", int(row))
        for event in ("fold", "bifurcation", "out_of_plane")
        for number, row in enumerate(path.rows(event), 1)
    ]
    last = int(np.flatnonzero(path.branch == 0)[-1])
    assert result.scenario.factor_range is not None
    start, to = result.scenario.factor_range
    for what, factor in (("end", to), ("opposite limit", 2.0 * start - to)):
        if abs(path.factor[last] - factor) <= _SAME_FACTOR * abs(to - start):
            places.append((what, last))
    series: dict[str, tuple[str, Array]] = {"factor": ("", path.factor)}
    series |= {name: (probe.unit, np.asarray(probe)) for name, probe in result.probes.items()}
    for what, row in sorted(places, key=lambda place: place[1]):
        for name, (unit, values) in series.items():
            if name != "factor" or path.events[row]:  # at its end the scene gives it
                value = float(values[row])
                yield Reading(name, what, unit, value, float(np.max(np.abs(values))), value)


def count_kind(readings: Readings, kind: str) -> int:
    """Return how many places or numbers of a kind there are."""
    return len({reading.what for reading in readings.values() if reading.kind == kind})


def differing_kinds(levels: Sequence[Readings]) -> list[str]:
    """Return the kinds of which not all runs have as many, so that which is which is not known."""
    kinds = dict.fromkeys(reading.kind for level in levels for reading in level.values())
    return [kind for kind in kinds if len({count_kind(level, kind) for level in levels}) > 1]


def describe_counts(kind: str, runs: Mapping[str, Readings]) -> str:
    """Return how often a kind is found in each run: ``2 with 41 nodes, 3 with 81 nodes``."""
    return ", ".join(f"{count_kind(found, kind)} with {run}" for run, found in runs.items())


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
    """Return the largest value of the parabola through three points, the middle one the highest."""
    left = (values[1] - values[0]) / (times[1] - times[0])
    right = (values[2] - values[1]) / (times[2] - times[1])
    second = (right - left) / (times[2] - times[0])
    if second == 0.0:
        return float(values[1])
    slope = left + second * (times[1] - times[0])
    return float(values[1] - 0.25 * slope**2 / second)
