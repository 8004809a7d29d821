"""The loads on the rods at a frame, in numbers and arc lengths, for drawings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der._core import Rod, sine_value, table_value
from der.run_data import RunData

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PointLoad:
    """A force [N], shape (dim,), or a moment [N m] at an arc length [m].

    A moment in a plane is one about z, of shape (); in space it is a vector, of shape (3,).
    """

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
class FoundationPart:
    """An elastic foundation [N/m^2], shape (dim,), of a rod between two arc lengths [m]."""

    rod: str
    start: float
    end: float
    stiffness: Array


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
    foundations
        Elastic ones, of parts of rods.
    """

    forces: list[PointLoad] = field(default_factory=list)
    moments: list[PointLoad] = field(default_factory=list)
    lines: list[LineLoad] = field(default_factory=list)
    gravity: Array | None = None
    foundations: list[FoundationPart] = field(default_factory=list)


def acting_loads(result: RunData, frame: int) -> ActingLoads:
    """Return the loads of the scene at a frame of a result.

    Along a continuation those that its factor varies are scaled by it. Forces from Python are not
    known to the scene and not among them.
    """
    found = _Collected(
        float(result.times[frame]),
        result.positions.shape[2],
        lambda rod, at, value: _turned_with(result, frame, rod, at, value),
    )
    scene = result.scenario.to_dict()
    joined = {joint["name"]: joint["of"][0]["rod"] for joint in scene.get("joints") or []}
    for number, load in enumerate(scene.get("loads") or []):
        kind, content = kind_of(load)
        if isinstance(content, dict) and "joint" in content:
            content = {**content, "rod": joined[content["joint"]]}
        collect = _COLLECTORS[kind]
        if collect is not None:
            arc_lengths = result.load_arc_lengths(number)
            collect(found, _SceneLoad(content, _factor(result, frame, number), arc_lengths))
    total = np.sum(found.gravity, axis=0) if found.gravity else np.zeros(result.positions.shape[2])
    gravity = total if total.any() else None
    return ActingLoads(found.forces, found.moments, found.lines, gravity, found.foundations)


@dataclass(frozen=True)
class _SceneLoad:
    """A load as the scene has it, its factor, and its places [m], or the ends of its part."""

    content: Any
    factor: float
    arc_lengths: list[float]


class _Collected:
    """The loads that act at a time [s], with vectors of `dimension` components.

    `turn` turns a vector at an arc length of a rod as the rod is turned there.
    """

    def __init__(
        self, time: float, dimension: int, turn: Callable[[str, float, Array], Array]
    ) -> None:
        self._time = time
        self._dimension = dimension
        self._turn = turn
        self.forces: list[PointLoad] = []
        self.moments: list[PointLoad] = []
        self.lines: list[LineLoad] = []
        self.gravity: list[Array] = []
        self.foundations: list[FoundationPart] = []

    def add_gravity(self, load: _SceneLoad) -> None:
        gravity = load.factor * value_at(load.content, self._time)
        self.gravity.append(_in_space(gravity, self._dimension))

    def add_force(self, load: _SceneLoad) -> None:
        self.forces += self._at_places(load, "force")

    def add_moment(self, load: _SceneLoad) -> None:
        self.moments += self._at_places(load, "moment")

    def add_line(self, load: _SceneLoad) -> None:
        value = self._value(load, "force")
        if np.any(value):
            start, end = load.arc_lengths
            self.lines.append(LineLoad(load.content["rod"], start, end, value))

    def add_foundation(self, load: _SceneLoad) -> None:
        start, end = load.arc_lengths
        given = np.asarray(load.content["stiffness"], dtype=np.float64)
        if given.ndim:
            given = _in_space(given, self._dimension)
        stiffness = np.broadcast_to(given, (self._dimension,))
        self.foundations.append(FoundationPart(load.content["rod"], start, end, stiffness))

    def _at_places(self, load: _SceneLoad, amount: str) -> list[PointLoad]:
        value = self._value(load, amount)
        places = load.arc_lengths if np.any(value) else []
        rod = load.content["rod"]
        follows = bool(load.content.get("follower", False)) and value.ndim > 0
        return [
            PointLoad(rod, at, self._turn(rod, at, value) if follows else value) for at in places
        ]

    def _value(self, load: _SceneLoad, amount: str) -> Array:
        value = load.factor * value_at(load.content[amount], self._time)
        return _in_space(value, self._dimension)


#: Every kind of load with the function that collects it for a drawing; None: it has no symbol.
_COLLECTORS: dict[str, Callable[[_Collected, _SceneLoad], None] | None] = {
    "gravity": _Collected.add_gravity,
    "fluid": None,
    "damping": None,
    "point_force": _Collected.add_force,
    "moment": _Collected.add_moment,
    "distributed_force": _Collected.add_line,
    "foundation": _Collected.add_foundation,
}
#: The kinds that are not drawn.
WITHOUT_SYMBOL = frozenset(kind for kind, collect in _COLLECTORS.items() if collect is None)


def _in_space(value: Array, dimension: int) -> Array:
    """Return a vector with all components: in a scene of planar vectors those along z are 0.

    A planar moment is one about z.
    """
    if dimension == 2 or value.shape == (3,):
        return np.asarray(value)
    full = np.zeros(3)
    full[slice(None, 2) if value.ndim else 2] = value
    return full


def _turned_with(result: RunData, frame: int, name: str, at: float, value: Array) -> Array:
    """Return a vector turned as the tangent of a rod is, from the initial shape to a frame.

    The smallest such rotation: drawings leave out how the section turns about the tangent.
    """
    rod = next(rod for rod in result.rods if rod.name == name)
    before = np.zeros(3)
    after, turned = before.copy(), before.copy()
    before[: value.size] = _tangent(rod, result.model.initial_positions, at)
    after[: value.size] = _tangent(rod, result.positions[frame], at)
    turned[: value.size] = value
    axis, cosine = np.cross(before, after), float(before @ after)
    if cosine < -1.0 + 1e-9:  # half a turn: about z in a plane, about any axis across in space
        if value.size == 2:
            return np.asarray(-value)
        axis = np.cross(before, np.eye(3)[int(np.argmin(np.abs(before)))])
        return np.asarray(2.0 * axis * (axis @ turned) / (axis @ axis) - turned)
    moved = cosine * turned + np.cross(axis, turned) + axis * (axis @ turned) / (1.0 + cosine)
    return np.asarray(moved[: value.size])


def _tangent(rod: Rod, positions: Array, at: float) -> Array:
    """Return the direction of the edges beside an arc length, shape (dim,)."""
    edges = np.diff(positions[rod.line_nodes], axis=0)
    edges /= np.linalg.norm(edges, axis=1)[:, np.newaxis]
    middles = 0.5 * (rod.line_arc_lengths[1:] + rod.line_arc_lengths[:-1])
    if len(edges) == 1:
        return np.asarray(edges[0])
    first = max(0, min(int(np.searchsorted(middles, at)) - 1, len(edges) - 2))
    share = (at - middles[first]) / (middles[first + 1] - middles[first])
    tangent = (1.0 - share) * edges[first] + share * edges[first + 1]
    return np.asarray(tangent / np.linalg.norm(tangent))


def kind_of(load: Mapping[str, Any]) -> tuple[str, Any]:
    """Return the kind of a load of a scene file, and what stands under it."""
    ((kind, content),) = ((key, value) for key, value in load.items() if key != "name")
    return kind, content


def follows_time(part: Any) -> bool:
    """Whether a part of a scene file is a table or a sine, which `value_at` reads."""
    return isinstance(part, Mapping) and ("times" in part or "sine" in part)


def value_at(series: Any, time: float) -> Array:
    """Return a value of a scene file at a time [s], as the engine reads it.

    Parameters
    ----------
    series
        A number, a vector, a mapping of ``times`` and ``values``, or one with a ``sine``.
    time
        When [s].
    """
    if not isinstance(series, Mapping):
        return np.asarray(series, dtype=np.float64)
    if "sine" in series:
        sine = {"phase": 0.0, **series["sine"]}
        amplitudes = np.asarray(sine["amplitude"], dtype=np.float64)
        offsets = np.broadcast_to(np.asarray(sine.get("offset", 0.0)), amplitudes.shape)
        swing = [
            sine_value(amplitude, sine["frequency"], sine["phase"], offset, time)
            for amplitude, offset in zip(amplitudes.flat, offsets.flat, strict=True)
        ]
        return np.reshape(swing, amplitudes.shape)
    values = np.array(series["values"], dtype=np.float64)
    columns = values.reshape(len(values), -1).T
    smooth = series.get("smooth", False)
    found = np.array([table_value(series["times"], column, time, smooth) for column in columns])
    return found.reshape(values.shape[1:])


def place_on(rod: Rod, positions: Array, at: float) -> Array:
    """Return the point [m], shape (dim,), at an arc length of a rod in the shape `positions`."""
    line = positions[rod.line_nodes]
    return np.array([np.interp(at, rod.line_arc_lengths, column) for column in line.T])


def ground_direction(part: FoundationPart, rod: Rod, positions: Array) -> Array:
    """Return the unit vector, shape (dim,), from a rod to the ground of its foundation.

    It is down, or to the left where the springs across the rod act along x. `positions` are those
    of all nodes [m], shape (nodes, dim).
    """
    chord = place_on(rod, positions, part.end) - place_on(rod, positions, part.start)
    # An axis is across where the others are along.
    across = np.array([np.linalg.norm(np.delete(chord, axis)) for axis in range(len(chord))])
    held = part.stiffness[: len(chord)] > 0.0
    axis = int(np.argmax(np.where(held, across + 1e-9 * rod.length, 0.0)))
    return np.asarray(-np.eye(len(chord))[axis])


def _factor(result: RunData, frame: int, number: int) -> float:
    """Return the factor of a load at a frame: other than 1 only along a continuation."""
    if result.path is None or not result.scenario.varies_load(number):
        return 1.0
    return float(result.path.factor[frame])
