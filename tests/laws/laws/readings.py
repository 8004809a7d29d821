"""Everything that a run tells, as arrays by name."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import der
import numpy as np
from der import _core
from numpy.typing import NDArray

from .schema import Scene

Array = NDArray[np.float64]
#: What it is, and of which rod, support, quantity.
Name = tuple[Any, ...]

#: Quantities that are read as one vector.
VECTORS = {
    "position": ("x", "y", "z"),
    "velocity": ("vx", "vy", "vz"),
    "tangent": ("tx", "ty", "tz"),
}
_VECTOR_OF = {component: name for name, parts in VECTORS.items() for component in parts}
#: Kinds of quantities that may have two values at a place.
JUMPING = ("tangent", "bend", "edge", "section", "natural")
#: Kinds of quantities along rods, each with the sides of a place that it has.
_KINDS: dict[str, tuple[str | None, ...]] = {
    **dict.fromkeys(("position", "velocity", "turn"), (None,)),
    **dict.fromkeys(JUMPING, ("before", "after")),
}
#: Of the shapes v with v @ M @ v = 1; see test_unit_of_the_shapes_of_modes.
SHAPES_OF_MODES = "kg^-1/2"
#: Where probes read each rod, in lengths of it; none of them is a node of a law's scene.
_PLACES = (0.0, 0.31, 0.69, 1.0)


@dataclass(frozen=True)
class Reading:
    """Values and their unit; the last axis of a vector or a point has its components."""

    values: Array
    unit: str
    is_vector: bool = False
    is_point: bool = False

    def with_values(self, values: Array) -> Reading:
        return replace(self, values=values)


@dataclass(frozen=True)
class Answer:
    """What a run tells: numbers by name, and words."""

    numbers: dict[Name, Reading]
    words: dict[str, Any]


@functools.cache
def quantities() -> dict[str, der.Quantity]:
    """Quantities of probes by their names."""
    return {quantity.name: quantity for quantity in der.quantities()}


@dataclass(frozen=True)
class Place:
    """A probe that every rod gets: a quantity at a place, in lengths of the rod, from a side."""

    rod: str
    quantity: str
    at: float
    side: str | None

    @property
    def name(self) -> str:
        return f"law-{self.rod}-{self.quantity}-{round(100 * self.at)}-{self.side}"

    def probe(self, rod: der.Rod, length: float) -> Scene:
        ends = {0.0: "start", 1.0: "end"} if not rod.closed else {}
        at = ends.get(self.at, self.at * length)
        side = {} if self.side is None else {"side": self.side}
        return {"rod": self.rod, "at": at, "quantity": self.quantity, **side}


def lengths(scene: Scene, model: der.Model) -> dict[str, float]:
    """The lengths of all rods, along which places count: of the edges, or of a shape's curve.

    The edges of a shape are shorter by the square of their length.
    """
    found = {rod.name: rod.length for rod in model.rods}
    shapes = [rod["name"] for rod in scene["rods"] if "shape" in rod]
    if shapes:
        meshes = [_length_of_edges(scene, parts) for parts in (128, 256)]
        for name in shapes:
            coarse, fine = (mesh[name] for mesh in meshes)
            found[name] = fine + (fine - coarse) / 3.0
    return found


def _length_of_edges(scene: Scene, parts: int) -> dict[str, float]:
    """Length of the edges of each rod that is drawn by segments, its elements cut into `parts`."""
    drawn = ("name", "nodes", "from", "shape", "closed", "cross_section", "material")
    rods = [
        {key: rod[key] for key in drawn if key in rod} | {"subdivide": parts}
        for rod in scene["rods"]
        if "shape" in rod
    ]
    model = der.Model(der.Scenario.from_dict({"rods": rods, "time": {"duration": 1, "step": 1}}))
    return {rod.name: rod.length for rod in model.rods}


def read(scene: Scene) -> Answer:
    """Run a scene and read everything that it tells."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", der.DerWarning)
        scenario, places = _with_probes(scene)
        result = der.run(scenario, check=False)
        return Answer(dict(_on_first_branch(result, _numbers(result, places))), _words(result))


def _with_probes(scene: Scene) -> tuple[der.Scenario, list[Place]]:
    """The scene with probes at the places of all its rods and frames at the start and the end."""
    output: Scene = {} if "time" not in scene else {"every": scene["time"]["duration"]}
    own = scene.get("output", {}).get("probes", {})
    model = der.Model(der.Scenario.from_dict({**scene, "output": output}))
    rods = {rod.name: rod for rod in model.rods}
    along = lengths(scene, model)
    places = [
        Place(rod, quantity.name, at, side)
        for rod in rods
        for quantity in quantities().values()
        if quantity.kind in _KINDS and quantity.kind != "turn" and quantity.is_available(model)
        for at in (_PLACES if not rods[rod].closed else _PLACES[:-1])
        for side in _KINDS[quantity.kind]
    ]
    while True:
        probes = own | {
            place.name: place.probe(rods[place.rod], along[place.rod]) for place in places
        }
        try:
            full = {**scene, "output": {**output, "probes": probes}}
            return der.Scenario.from_dict(full), places
        except der.SceneError as error:
            # What a rod does not have, such as the curvature of a cable.
            refused = {d.path.split(".")[2] for d in error.diagnostics}
            kept = [place for place in places if place.name not in refused]
            if len(kept) == len(places):
                raise
            places = kept


def _words(result: der.Result) -> dict[str, Any]:
    words = {key: result.summary.get(key) for key in ("status", "model", "stability")}
    words["warnings"] = len(result.scenario.warnings)
    if result.path is not None:
        words["events"] = result.path.events.tolist()
        words["branches"] = result.path.branch.tolist()
        words["unstable"] = result.path.unstable_directions.tolist()
    return words


def _numbers(result: der.Result, places: list[Place]) -> Iterator[tuple[Name, Reading]]:
    units = _core.array_units()
    for rod in result.rods:
        nodes = rod.nodes
        positions, velocities = result.positions[:, nodes], result.velocities[:, nodes]
        yield ("positions", rod.name), Reading(positions, "m", is_point=True)
        yield ("velocities", rod.name), Reading(velocities, "m/s", is_vector=True)
    for name, energy in result.energies.items():
        yield ("energy", name), Reading(energy, units[f"energies/{name}"])
    for name, work in result.work.items():
        yield ("work", name), Reading(work, units[f"work/{name}"])
    for name, series in result.probes.items():
        if not name.startswith("law-"):
            yield ("probe", name), Reading(np.array(series), series.unit)
    yield from _places(result, places)
    yield from _fields(result)
    yield from _directors(result)
    yield from _forces(result)
    yield from _analysed(result, units)


def _on_first_branch(
    result: der.Result, numbers: Iterable[tuple[Name, Reading]]
) -> Iterator[tuple[Name, Reading]]:
    """Readings at the points of a path's first branch: to which side the next one goes off, and
    which of both is followed first, is open."""
    for name, reading in numbers:
        if result.path is not None and len(reading.values) == len(result.path.branch):
            reading = reading.with_values(reading.values[result.path.branch == 0])
        yield name, reading


def _merged(values: dict[str, Array], names: Name) -> Iterator[tuple[Name, Reading]]:
    """Readings of quantities, components of one vector together."""
    for quantity, array in values.items():
        vector = _VECTOR_OF.get(quantity)
        unit = quantities()[quantity].unit
        if vector is None:
            yield (*names, quantity), Reading(array, unit)
        elif quantity == VECTORS[vector][0]:
            parts = [values[part] for part in VECTORS[vector] if part in values]
            stacked = np.stack(parts, axis=-1)
            is_point = vector == "position"
            yield (*names, vector), Reading(stacked, unit, not is_point, is_point)


def _places(result: der.Result, places: list[Place]) -> Iterator[tuple[Name, Reading]]:
    at: dict[Name, dict[str, Array]] = {}
    for place in places:
        key = ("place", place.rod, place.at, place.side)
        at.setdefault(key, {})[place.quantity] = np.array(result.probes[place.name])
    for key, values in at.items():
        yield from _merged(values, key)


def _fields(result: der.Result) -> Iterator[tuple[Name, Reading]]:
    for rod in result.rods:
        values: dict[str, Array] = {}
        for quantity in quantities().values():
            if quantity.kind not in _KINDS or not quantity.is_available(result.model):
                continue
            try:
                arcs, field = result.along(rod.name, quantity.name)
            except der.DerError:  # as above: of cables, of rods that do not bend
                continue
            values[quantity.name] = field
            yield ("arcs", rod.name, quantity.name), Reading(arcs, "m")
        yield from _merged(values, ("along", rod.name))


def _directors(result: der.Result) -> Iterator[tuple[Name, Reading]]:
    if result.theta.shape[1] == 0:
        return
    first = 0
    for rod in result.rods:
        edges = len(rod.nodes) - (not rod.closed)
        directors = result.directors[:, first : first + edges]
        yield ("directors", rod.name), Reading(directors, "", is_vector=True)
        first += edges


def _forces(result: der.Result) -> Iterator[tuple[Name, Reading]]:
    found: dict[int, int] = {}
    in_space = result.positions.shape[2] == 3
    for reaction in result.reactions():
        number = found.setdefault(reaction.support, 0)
        found[reaction.support] += 1
        key = ("reaction", reaction.support, number)
        yield (*key, "point"), Reading(reaction.point, "m", is_point=True)
        yield (*key, "force"), Reading(reaction.force, "N", is_vector=True)
        yield (*key, "moment"), Reading(np.asarray(reaction.moment), "N m", is_vector=in_space)
    for force in result.actuation_forces():
        of = next(a for a in result.scenario.to_dict()["actuation"] if a["name"] == force.name)
        unit = "N" if "elongation" in of else "N m"
        yield ("actuation", force.name), Reading(np.asarray(force.force), unit)


def _analysed(result: der.Result, units: dict[str, str]) -> Iterator[tuple[Name, Reading]]:
    for name, values in result.data.items():
        if not name.endswith("/shapes"):
            yield ("data", name), Reading(values, units[name])
            continue
        # Of equal frequencies and factors any mixture is a shape, and so of the last one.
        of_modes = name.startswith("modes")
        numbers = result.data["modes/frequencies" if of_modes else "buckling/load_factors"]
        alone = np.diff(numbers) > 1e-3 * np.abs(numbers[:-1])
        distinct = np.append(alone, False) & np.append(True, alone)
        if not of_modes:  # their largest component is 1, whichever axis it is on
            values = values / np.linalg.norm(values, axis=(1, 2))[:, None, None]
        for rod in result.rods:
            shapes = np.where(distinct[:, None, None], values[:, rod.nodes], 0.0)
            unit = SHAPES_OF_MODES if of_modes else units[name]
            yield ("shapes", name, rod.name), Reading(shapes, unit, is_vector=True)
