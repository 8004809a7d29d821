"""The numbers of a scene without time by which meshes can be compared.

Points of a path of equilibria cannot be: where the steps of a continuation end is its own affair.
Its events can, and the place where the factor comes to its end.
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

_UNITS = array_units()
#: Results of modes and linear buckling of a plane for motion out of it, with their units.
_OUT_OF_PLANE = {"growth_rate": _UNITS["modes/growth_rates"], "load_factor": ""}
#: The factor is where the scene wants it, to this share of its range.
_SAME_FACTOR = 1e-9


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
        ``final``; on a path the place: ``fold 1``, ``bifurcation 1``, ``out_of_plane 1``, where
        directions out of the plane lose or regain their stability, counted along it, ``end``
        where the factor reaches its last value, ``opposite limit`` where it reaches twice the
        first value less the last.
    unit
        In SI.
    value
        The number.
    largest
        Largest absolute value of the probe in the run.
    """

    probe: str
    what: str
    unit: str
    value: float
    largest: float

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


def static_readings(result: Result) -> Readings:
    """Return the comparable numbers of a run without time."""
    path = result.path
    found = _finals(result) if path is None else _on_path(result, path)
    return {reading.label: reading for reading in found}


def _finals(result: Result) -> Iterator[Reading]:
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


def _final(name: str, unit: str, value: float) -> Reading:
    return Reading(name, "final", unit, float(value), abs(float(value)))


def _on_path(result: Result, path: Path) -> Iterator[Reading]:
    series: dict[str, tuple[str, NDArray[np.float64]]] = {"factor": ("", path.factor)}
    series |= {name: (probe.unit, np.asarray(probe)) for name, probe in result.probes.items()}
    for what, row in _places(result, path):
        for name, (unit, values) in series.items():
            if name != "factor" or path.events[row]:  # at its end the scene gives it
                largest = float(np.max(np.abs(values)))
                yield Reading(name, what, unit, float(values[row]), largest)


def _places(result: Result, path: Path) -> list[tuple[str, int]]:
    """Return the places of the first branch with their rows, in the order of the path."""
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
    return sorted(places, key=lambda place: place[1])


def count_kind(readings: Readings, kind: str) -> int:
    """Return how many places or numbers of a kind there are."""
    return len({reading.what for reading in readings.values() if reading.kind == kind})


def differing_kinds(levels: Sequence[Readings]) -> list[str]:
    """Return the kinds of which not all runs have as many, so that which is which is not known."""
    kinds = dict.fromkeys(reading.kind for level in levels for reading in level.values())
    return [kind for kind in kinds if len({count_kind(level, kind) for level in levels}) > 1]


def describe_difference(kind: str, runs: Mapping[str, Readings]) -> str:
    """Return how often a kind is found in each run, in words."""
    return f"{kind}: {describe_counts(kind, runs)}; which are the same is not known"


def describe_counts(kind: str, runs: Mapping[str, Readings]) -> str:
    """Return how often a kind is found in each run: ``2 with 41 nodes, 3 with 81 nodes``."""
    return ", ".join(f"{count_kind(found, kind)} with {run}" for run, found in runs.items())
