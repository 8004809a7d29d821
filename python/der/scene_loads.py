"""What acts on the rods at a frame, in numbers and arc lengths, for drawings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der._core import Rod
from der.run_data import RunData

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PointLoad:
    """A force [N], shape (dim,), or a moment about z [N m], shape (), at an arc length [m]."""

    rod: str
    at: float
    value: Array


@dataclass(frozen=True, eq=False)
class LineLoad:
    """A force per length [N/m], shape (dim,), on a rod between two arc lengths [m]."""

    rod: str
    start: float
    end: float
    value: Array


@dataclass(frozen=True, eq=False)
class ActingLoads:
    """The loads at one frame; those that are zero are left out.

    Attributes
    ----------
    forces, moments
        At places.
    lines
        Along parts of rods.
    gravity
        Acceleration [m/s^2], shape (dim,); None without.
    """

    forces: list[PointLoad] = field(default_factory=list)
    moments: list[PointLoad] = field(default_factory=list)
    lines: list[LineLoad] = field(default_factory=list)
    gravity: Array | None = None


def acting_loads(result: RunData, frame: int) -> ActingLoads:
    """Return the loads of the scene at a frame of a result.

    Along a continuation those that its factor varies are scaled by it. Forces from Python are not
    known to the scene and not among them.
    """
    scene = result.scenario.to_dict()
    rods = {rod.name: rod for rod in result.rods}
    time = float(result.times[frame])
    found = ActingLoads()
    gravity: list[Array] = []
    for number, load in enumerate(scene.get("loads") or []):
        ((kind, content),) = load.items()
        factor = _factor(result, frame, number)
        if kind == "gravity":
            gravity.append(factor * value_at(content, time))
        elif kind in ("point_force", "moment"):
            key, into = ("force", found.forces) if kind == "point_force" else (kind, found.moments)
            value = factor * value_at(content[key], time)
            rod = rods[content["rod"]]
            into.extend(
                PointLoad(rod.name, at, value)
                for at in arc_lengths_of(content["at"], rod)
                if np.any(value)
            )
        elif kind == "distributed_force":
            rod = rods[content["rod"]]
            value = factor * value_at(content["force"], time)
            start, end = content.get("from", 0.0), content.get("to", rod.length)
            if np.any(value):
                found.lines.append(LineLoad(rod.name, float(start), float(end), value))
    total = np.sum(gravity, axis=0) if gravity else None
    return ActingLoads(
        found.forces,
        found.moments,
        found.lines,
        total if total is not None and np.any(total) else None,
    )


def value_at(series: Any, time: float) -> Array:
    """Return a value of a scene file at a time [s].

    Parameters
    ----------
    series
        A number, a vector, or a mapping of ``times`` and ``values``: linear between the times and
        constant outside, as the engine reads it.
    time
        When [s].
    """
    if not isinstance(series, Mapping):
        return np.asarray(series, dtype=np.float64)
    values = np.array(series["values"], dtype=np.float64)
    columns = values.reshape(len(values), -1).T
    found = np.array([np.interp(time, series["times"], column) for column in columns])
    return found.reshape(values.shape[1:])


def arc_lengths_of(at: Any, rod: Rod) -> list[float]:
    """Return the arc lengths [m] that an ``at`` of a scene file names; several for ``all``."""
    if isinstance(at, Mapping):
        return [float(rod.arc_lengths[at["node"]])]
    if at == "all":
        return [float(s) for s in rod.arc_lengths]
    places = {"start": 0.0, "middle": 0.5 * rod.length, "end": rod.length}
    return [float(places.get(at, at)) if isinstance(at, str) else float(at)]


def place_on(rod: Rod, positions: Array, at: float) -> Array:
    """Return the point [m], shape (dim,), at an arc length of a rod in the shape `positions`."""
    line = positions[rod.nodes]
    return np.array([np.interp(at, rod.arc_lengths, column) for column in line.T])


def _factor(result: RunData, frame: int, number: int) -> float:
    """Return the factor of a load at a frame: other than 1 only along a continuation."""
    if result.path is None or not result.scenario.varies_load(number):
        return 1.0
    return float(result.path.factor[frame])
