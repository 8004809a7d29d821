"""The laws: each is a scene written another way, and what its answers are then.

A law changes a scene by the units of its keys (`schema.py`) and by the few tables at the top of
this file; a new key whose value is a number, or a vector of the kinds below, needs no line here.
"""

from __future__ import annotations

import copy
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import der
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from .readings import JUMPING, Array, Name, Reading, lengths, quantities
from .schema import Scene, mapped, subject

#: Keys of vectors of a scene: places, which move along, and directions and the like, which turn.
POINTS = {"from", "to", "points", "anchor", "line", "through", "centre", "spline"}
DIRECTIONS = {"axis", "director", "force", "gravity", "initial_velocity", "moment"}
#: Keys whose values go with the axes of the scene; with those of the sections, which move along.
ALONG_AXES = {"stiffness"}
OF_SECTIONS = {"rotational_stiffness"}

AXES = ("x", "y", "z")
_OF_AXES = re.compile(r"(v|t|force_|reaction_moment_|reaction_)?([xyz])")
_BASES = {"kg": (1, 0, 0), "m": (0, 1, 0), "s": (0, 0, 1), "Hz": (0, 0, -1), "rad": (0, 0, 0),
          "N": (1, 1, -2), "Pa": (1, -1, -2), "J": (1, 2, -2)}  # fmt: skip

Readings = Mapping[Name, Reading]


class NotApplicableError(Exception):
    """A scene that a law says nothing about, with the reason."""


@dataclass(frozen=True)
class Law:
    """How a scene is written another way, and how its readings follow.

    `write` raises `NotApplicableError` where the law says nothing. `follow` turns the readings of
    the scene as it was into those expected; what it leaves out is not compared.
    """

    write: Callable[[Scene], Scene]
    follow: Callable[[Scene, Readings], dict[Name, Reading]]
    #: Readings that follow to the order of the method only, not to rounding.
    by_order: Callable[[Scene, Name], bool] = lambda scene, name: False
    #: Words of an answer that the law changes.
    other_words: frozenset[str] = frozenset()


def is_planar(scene: Scene) -> bool:
    """Whether its vectors have two components."""
    rod = scene["rods"][0]
    return len(rod["points"][0] if "points" in rod else rod["from"]) == 2


def model_of(scene: Scene) -> der.Model:
    """The model of the shape as drawn."""
    return der.Model(der.Scenario.from_dict({**scene, "output": {}}))


def drop_probes(scene: Scene, keep: Callable[[Scene], bool]) -> Scene:
    """The scene with those of its own probes."""
    output = scene.get("output", {})
    probes = {name: probe for name, probe in output.get("probes", {}).items() if keep(probe)}
    return {**scene, "output": {**output, "probes": probes}}


def _is_vector(path: tuple[str, ...], value: Any) -> bool:
    return isinstance(value, list) and path[-1] not in ("values", "times")


# ---- rigid motions


def moved(rotation: NDArray[np.float64], shift: NDArray[np.float64]) -> Law:
    """Everything turned about the origin and then moved, in the plane or in space."""
    turn = np.asarray(rotation, float)
    on_axes = bool(np.all(np.abs(turn).sum(axis=0) == 1.0))
    translated = bool(np.any(shift))

    def write(scene: Scene) -> Scene:
        if not on_axes:
            _refuse_axes(scene)
        scene = _with_directors(scene)

        def change(path: tuple[str, ...], value: Any, unit: str) -> Any:
            key = subject(path)
            if not _is_vector(path, value):
                return value
            if key in POINTS:
                return (turn @ value + shift).tolist()
            if key in DIRECTIONS:
                return (turn @ value).tolist()
            if key in ALONG_AXES:
                return (np.abs(turn) @ value).tolist()
            return value

        scene = mapped(scene, change)
        for support in scene.get("supports", ()):
            for key in {"fix", "free"} & support.keys() if on_axes else ():
                support[key] = [AXES[_target(turn, AXES.index(axis))[0]] for axis in support[key]]
            if "prescribe" in support:
                support["prescribe"] = _moved_along(support["prescribe"], turn)
        return drop_probes(scene, lambda probe: _stays(probe, translated))

    def follow(scene: Scene, readings: Readings) -> dict[Name, Reading]:
        weight = translated and any("gravity" in load for load in scene.get("loads", ()))
        expected = {}
        for name, reading in readings.items():
            if name[0] == "probe" and not _stays(scene["output"]["probes"][name[1]], translated):
                continue
            # The weight has its potential from the origin, and a weight that changes does its work
            # by the height above it.
            if weight and (
                name in (("energy", "gravity"), ("work", "loads")) or on_a_path(scene, name)
            ):
                continue
            values = reading.values
            if reading.is_vector or reading.is_point:
                values = values @ turn.T + (shift if reading.is_point else 0.0)
            elif name[-1] == "slope" and name[0] != "arcs":
                values = values + np.arctan2(turn[1, 0], turn[0, 0])
            expected[name] = reading.with_values(values)
        if not on_axes and is_adaptive(scene):
            return {name: each for name, each in expected.items() if name[0] == "positions"}
        return expected

    return Law(write, follow, lambda scene, name: not on_axes and is_adaptive(scene))


def is_adaptive(scene: Scene) -> bool:
    """Whether the steps have the lengths that errors of components along the axes ask for: on other
    axes, only the tolerance of the positions is promised."""
    return "tolerance" in scene.get("time", {})


def on_a_path(scene: Scene, name: Name) -> bool:
    """Whether it is the numerical loss of a path, which is what else its energies lack: between
    equilibria the loads do a work that no account has."""
    analysis = scene.get("analysis", {})
    return name == ("work", "numerical") and "continuation" in analysis


def _stays(probe: Scene, translated: bool) -> bool:
    """Whether a probe reads what no rigid motion changes."""
    quantity = probe["quantity"]
    if quantity in ("gravity_energy", "total_energy"):
        return not translated
    return quantity != "slope" and _OF_AXES.fullmatch(quantity) is None


def _target(turn: NDArray[np.float64], axis: int) -> tuple[int, float]:
    """The axis that an axis is turned to, and the sign."""
    target = int(np.argmax(np.abs(turn[:, axis])))
    return target, float(turn[target, axis])


def _refuse_axes(scene: Scene) -> None:
    """Refuse what goes with some axes of the scene only."""
    size = 2 if is_planar(scene) else 3
    for support in scene.get("supports", ()):
        for components in (support.get("fix"), support.get("free")):
            if components and len(components) < size:
                raise NotApplicableError("a support holds components along axes of the scene")
        if set(AXES) & support.get("prescribe", {}).keys() and "clamp" not in support:
            raise NotApplicableError("a support moves components along axes of the scene")

    def change(path: tuple[str, ...], value: Any, unit: str) -> Any:
        if subject(path) in ALONG_AXES and isinstance(value, list):
            raise NotApplicableError("a stiffness goes with the axes of the scene")
        return value

    mapped(scene, change)


def _with_directors(scene: Scene) -> Scene:
    """The scene with what follows from the z axis written out."""
    scene = copy.deepcopy(scene)
    if is_planar(scene):
        return scene
    for rod in scene["rods"]:
        rod["cross_section"].setdefault("director", [0.0, 0.0, 1.0])
    for thing in (*scene["rods"], *scene.get("actuation", ())):
        given = thing.get("natural_curvature")
        if isinstance(given, int | float | dict) and given != 0:
            rod = next(r for r in scene["rods"] if r["name"] == thing.get("rod", r["name"]))
            if rod["cross_section"]["director"] != [0.0, 0.0, 1.0]:
                raise NotApplicableError("a number for a curvature about z, with a director")
            # Director 2 is t x z, and a curvature about z bends towards z x t.
            thing["natural_curvature"] = [0.0, _negated(given)]
    return scene


def _negated(course: Any) -> Any:
    """A number or a table with the opposite sign."""
    return _combined([course], [-1.0])


def _combined(courses: list[Any], factors: list[float]) -> Any:
    """A linear combination of numbers and of tables that have their times in common."""
    tables = [course for course in courses if isinstance(course, dict)]
    if not tables:
        return float(np.dot(courses, factors))
    if "sine" in tables[0]:
        if len(courses) > 1:
            raise NotApplicableError("sines along several axes")
        sine = tables[0]["sine"]
        scaled = {key: factors[0] * sine[key] for key in ("amplitude", "offset") if key in sine}
        return {"sine": {**sine, **scaled}}
    frame = {key: value for key, value in tables[0].items() if key != "values"}
    if any({k: v for k, v in table.items() if k != "values"} != frame for table in tables):
        raise NotApplicableError("motions along several axes at times of their own")
    values = sum(
        factor * np.array(course["values"] if isinstance(course, dict) else course, float)
        for course, factor in zip(courses, factors, strict=True)
    )
    return {**frame, "values": np.broadcast_to(values, len(frame["times"])).tolist()}


def _moved_along(prescribed: Scene, turn: NDArray[np.float64]) -> Scene:
    """Displacements along other axes."""
    others = {key: course for key, course in prescribed.items() if key not in AXES}
    old = [axis for axis in range(len(turn)) if AXES[axis] in prescribed]
    for new in range(len(turn)):
        parts = [
            (prescribed[AXES[axis]], float(turn[new, axis])) for axis in old if turn[new, axis]
        ]
        if parts:
            others[AXES[new]] = _combined([c for c, _ in parts], [f for _, f in parts])
    return others


# ---- units


def in_units(mass: float, length: float, time: float) -> Law:
    """All numbers as multiples of other units: of a kg, an m and an s multiplied by these."""

    def factor(unit: str) -> float:
        return float(np.prod(np.power([mass, length, time], dimension(unit))))

    def write(scene: Scene) -> Scene:
        def change(path: tuple[str, ...], value: Any, unit: str) -> Any:
            if unit == "":
                return value
            scaled = np.asarray(value, float) * factor(unit)
            return scaled.tolist() if isinstance(value, list) else float(scaled)

        return mapped(scene, change)

    def follow(scene: Scene, readings: Readings) -> dict[Name, Reading]:
        return {
            name: reading.with_values(reading.values * factor(reading.unit))
            for name, reading in readings.items()
        }

    return Law(write, follow)


def dimension(unit: str) -> Array:
    """Exponents of mass, length and time of a unit such as ``N s/m^2``."""
    exponents = np.zeros(3)
    for slash, base, power in re.findall(r"(/?)\s*([A-Za-z]+)(?:\^(-?\d+(?:/\d+)?))?", unit):
        sign = -1.0 if slash else 1.0
        exponents += sign * float(Fraction(power or "1")) * np.array(_BASES[base], float)
    return exponents


# ---- reversal of arc length

#: Quantities that change their sign where a rod is drawn from its other end: in the plane all
#: curvatures, in space those towards director 2, the tangent times director 1.
_REVERSED = {
    True: {"curvature", "moment", "turning_angle", "natural_curvature", "actuation_moment"},
    False: {"curvature_2", "moment_2", "natural_curvature_2", "actuation_moment_2"},
}
_OTHER_SIDE = {"before": "after", "after": "before", None: None}


def reversed_rods() -> Law:
    """Every rod drawn from its other end."""
    return Law(_reversed_scene, _reversed_readings, _reversed_by_order)


def is_recovered(scene: Scene, name: Name) -> bool:
    """Whether it is read off neighbouring nodes and edges: all along rods but places and speeds."""
    if name[0] == "probe":
        return der_kind(scene["output"]["probes"][name[1]]["quantity"]) in JUMPING
    return name[0] in ("along", "place") and name[-1] not in ("position", "velocity", "speed")


def _reversed_by_order(scene: Scene, name: Name) -> bool:
    """Besides, in space, the energy of a rod that a moment bends; and a moment that follows turns
    with a section that its neighbours tell."""
    moments = [load["moment"] for load in scene.get("loads", ()) if "moment" in load]
    if moments and model_of(scene).name == "spatial":
        follows = any(moment.get("follower") for moment in moments)
        if follows or name in (("energy", "bend"), ("work", "loads"), ("work", "numerical")):
            return True
    return is_recovered(scene, name)


@dataclass(frozen=True)
class _Built:
    """A rod, and the length along which its places count."""

    rod: der.Rod
    length: float


def _reversed_scene(scene: Scene) -> Scene:
    planar = is_planar(scene)
    model = model_of(scene)
    along = lengths(scene, model)
    rods = {rod.name: _Built(rod, along[rod.name]) for rod in model.rods}
    scene = copy.deepcopy(scene)
    ends = _end_directors(scene, model)
    for rod in scene["rods"]:
        _reverse_rod(rod, rods[rod["name"]], planar, ends.get(rod["name"]))
    members = [member for joint in scene.get("joints", ()) for member in joint["of"]]
    for part in (*members, *scene.get("supports", ())):
        if "at" in part:
            part["at"] = _other_place(part["at"], rods[part["rod"]])
    for support in scene.get("supports", ()):
        if "twist" in support.get("prescribe", {}):
            support["prescribe"]["twist"] = _negated(support["prescribe"]["twist"])
    for load in scene.get("loads", ()):
        for part in load.values():
            if isinstance(part, dict) and "at" in part:
                part["at"] = _other_place(part["at"], rods[part["rod"]])
            elif isinstance(part, dict) and "rod" in part:
                _reverse_part(part, rods[part["rod"]])
    if "actuation" in scene:
        scene["actuation"] = [
            part
            for actuation in scene["actuation"]
            for part in _reversed_actuation(actuation, rods[actuation["rod"]], planar)
        ]
    for probe in scene.get("output", {}).get("probes", {}).values():
        if "at" in probe:
            probe["at"] = _other_place(probe["at"], rods[probe["rod"]])
            if der_kind(probe["quantity"]) in JUMPING:
                # Without a side the one after the place is read.
                probe["side"] = _OTHER_SIDE[probe.get("side", "after")]
        if probe["quantity"] in _REVERSED[planar] | {"tx", "ty", "tz"} and "reduce" in probe:
            probe["reduce"] = {"min": "max", "max": "min"}[probe["reduce"]]
    return scene


def _reverse_rod(rod: Scene, built: _Built, planar: bool, director: list[float] | None) -> None:
    def backward(items: list[Any]) -> list[Any]:
        return items[:1] + items[:0:-1] if rod.get("closed") else items[::-1]

    if "points" in rod:
        rod["points"] = backward(rod["points"])
    elif "shape" in rod:
        ends = _segment_ends(rod)
        starts = zip(reversed(rod["shape"]), ends[-2::-1], strict=True)
        rod["shape"] = [_reversed_segment(segment, start) for segment, start in starts]
        rod["from"] = ends[-1]
    else:
        rod["from"], rod["to"] = rod["to"], rod["from"]
    velocity = rod.get("initial_velocity")
    if velocity is not None and isinstance(velocity[0], list):
        rod["initial_velocity"] = backward(velocity)
    if "natural_curvature" in rod:
        given = rod["natural_curvature"]
        one = not isinstance(given, list) or (not planar and not isinstance(given[0], list))
        changed = _reversed_curvature(given, planar, one=one)
        rod["natural_curvature"] = changed if one else backward(changed)
    if isinstance(rod.get("natural_twist"), list):
        rod["natural_twist"] = backward(rod["natural_twist"])
    for sphere in rod.get("spheres", ()):
        sphere["at"] = _other_place(sphere["at"], built)
    if director is not None:
        rod["cross_section"]["director"] = director


def _segment_ends(rod: Scene) -> list[list[float]]:
    """Where the shape begins, and where each of its segments ends."""
    ends = [rod["from"]]
    for segment in rod["shape"]:
        ((kind, what),) = segment.items()
        if kind == "helix":
            axis = np.array(what["axis"], float)
            axis /= np.linalg.norm(axis)
            arm = np.array(ends[-1]) - what["centre"]
            turn = Rotation.from_rotvec(2.0 * np.pi * what["turns"] * axis)
            climb = what["pitch"] * what["turns"] * axis
            ends.append((what["centre"] + turn.apply(arm) + climb).tolist())
        else:
            ends.append(what if kind == "line" else what[-1] if kind == "spline" else what["to"])
    return ends


def _reversed_segment(segment: Scene, start: list[float]) -> Scene:
    """A segment drawn from its other end, to its start."""
    ((kind, what),) = segment.items()
    if kind == "line":
        return {"line": start}
    if kind == "spline":
        return {"spline": [*what[-2::-1], start]}
    if kind == "helix":
        return {"helix": {**what, "axis": [-each for each in what["axis"]]}}
    turn = {"radius": -what["radius"]} if "radius" in what else {}
    return {"arc": {**what, "to": start, **turn}}


def cut_segments() -> Law:
    """Each line, helix and arc about a centre drawn as two."""

    def halves(start: list[float], segment: Scene) -> list[Scene]:
        ((kind, what),) = segment.items()
        if kind == "line":
            return [{"line": ((np.array(start) + what) / 2.0).tolist()}, segment]
        if kind == "helix":
            return [{"helix": {**what, "turns": what["turns"] / 2.0}}] * 2
        if kind != "arc" or "centre" not in what or what.get("longer"):
            return [segment]
        centre = np.array(what["centre"])
        out = (np.array(start) - centre) + (np.array(what["to"]) - centre)
        out *= np.linalg.norm(np.array(start) - centre) / np.linalg.norm(out)
        return [{"arc": {**what, "to": (centre + out).tolist()}}, segment]

    def write(scene: Scene) -> Scene:
        if not any("shape" in rod for rod in scene["rods"]):
            raise NotApplicableError("no rod is drawn by segments")
        scene = copy.deepcopy(scene)
        for rod in scene["rods"]:
            if "shape" in rod:
                starts = zip(_segment_ends(rod), rod["shape"], strict=False)
                rod["shape"] = [half for each in starts for half in halves(*each)]
        return scene

    return Law(write, lambda scene, readings: dict(readings))


def _reversed_curvature(given: Any, planar: bool, *, one: bool) -> Any:
    """The same curvature on the way back; `one`, or a list with one for each node."""
    if not one:
        return [_reversed_curvature(each, planar, one=True) for each in given]
    if isinstance(given, list):
        return [given[0], _negated(given[1])]
    return _negated(given)


def _other_place(at: Any, rod: _Built) -> Any:
    if isinstance(at, dict):
        node, count = at["node"], len(rod.rod.nodes)
        return {"node": -node % count if rod.rod.closed else count - 1 - node % count}
    if isinstance(at, str):
        return at if rod.rod.closed else {"start": "end", "end": "start"}.get(at, at)
    return rod.length - at


def _reverse_part(part: Scene, rod: _Built) -> None:
    """Begin at the other end of a part; where it reaches an end of the rod, that stays unsaid."""
    begin, end = part.pop("from", 0.0), part.pop("to", rod.length)
    if end < rod.length:
        part["from"] = rod.length - end
    if begin > 0.0:
        part["to"] = rod.length - begin


#: What an actuation changes: as in the schema, but for where and how.
_ACTUATED = ("natural_curvature", "natural_twist", "elongation")


def _reversed_actuation(actuation: Scene, rod: _Built, planar: bool) -> list[Scene]:
    """What falls along the rod, a linear profile has as a constant less what rises."""
    _reverse_part(actuation, rod)
    if "natural_curvature" in actuation:
        actuation["natural_curvature"] = _reversed_curvature(
            actuation["natural_curvature"], planar, one=True
        )
    if actuation.get("profile") != "linear":
        return [actuation]
    (key,) = set(_ACTUATED) & actuation.keys()
    value = actuation[key]
    less = [_negated(part) for part in value] if isinstance(value, list) else _negated(value)
    return [
        {**actuation, "profile": "constant"},
        {**actuation, key: less, "name": f"{actuation['name']}-less"},
    ]


def _end_directors(scene: Scene, model: der.Model) -> dict[str, list[float]]:
    """Director 1 at the end of each rod, as drawn: that of its last edge, half an edge on."""
    if model.name != "spatial":
        return {}
    drawn = {"model": "spatial", "rods": scene["rods"], "analysis": "static"}
    if "joints" in scene:
        drawn = {**scene, "output": {}}  # the mesh depends on what acts on the rods
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", der.DerWarning)
        directors = der.Simulation(drawn).directors
    ends, first = {}, 0
    for rod, given in zip(model.rods, scene["rods"], strict=True):
        points = model.initial_positions[rod.nodes]
        if rod.closed:
            points = np.vstack([points, points[:2]])
            edge, end = _unit(points[-2] - points[-3]), _middle_tangent(*points[-3:])
        else:
            edge = _unit(points[-1] - points[-2])
            end = edge
            if len(points) > 3:  # with three, the last edge is a leg of its own
                # Of the circle through the last three nodes, the last edge being its chord.
                tangent = _middle_tangent(*points[-3:])
                end = 2.0 * (edge @ tangent) * edge - tangent
        count = len(rod.nodes) - (not rod.closed)
        half = 0.5 * np.diff(rod.line_arc_lengths)[-1] * given.get("initial_twist", 0.0)
        director = _along(directors[first + count - 1], edge, end)
        ends[rod.name] = (np.cos(half) * director + np.sin(half) * np.cross(end, director)).tolist()
        first += count
    return ends


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


def _middle_tangent(a: Array, b: Array, c: Array) -> Array:
    """Tangent at `b` of the circle through three points."""
    before, after = b - a, c - b
    return _unit(before * (after @ after) + after * (before @ before))


def _along(director: Array, before: Array, after: Array) -> Array:
    """A director turned by the smallest rotation from one tangent to another."""
    binormal = np.cross(before, after)
    cosine = before @ after
    return np.asarray(
        cosine * director
        + np.cross(binormal, director)
        + binormal * (binormal @ director) / (1.0 + cosine)
    )


def _reversed_readings(scene: Scene, readings: Readings) -> dict[Name, Reading]:
    planar = is_planar(scene)
    rods = {rod.name: rod for rod in model_of(scene).rods}
    expected = {}
    for name, reading in readings.items():
        new_name, values = name, reading.values
        kind, rod = name[0], rods.get(name[1]) if len(name) > 1 else None
        if kind in ("positions", "velocities"):
            values = _backward(values, rod, axis=1)
        elif kind == "shapes":
            values = _backward(values, rods[name[2]], axis=1)
        elif kind == "directors":
            values = values[:, ::-1]
        elif kind in ("arcs", "along"):
            values = np.flip(values, axis=-1 if kind == "arcs" else 1)
            if kind == "arcs":
                values = rods[name[1]].length - values
            if rods[name[1]].closed and name[-1] == "turning_angle":  # the first node has it once
                values = np.roll(values, 1, axis=-1)
                if kind == "arcs":
                    values = values % rods[name[1]].length
        elif kind == "place":
            assert rod is not None
            at = round(1.0 - name[2], 12) % 1.0 if rod.closed else round(1.0 - name[2], 12)
            new_name = ("place", name[1], at, _OTHER_SIDE[name[3]], name[4])
        if kind in ("along", "place"):
            if name[-1] == "tangent" or name[-1] in _REVERSED[planar]:
                values = -values
            elif name[-1] == "slope":
                values = values + np.pi
        if kind == "probe" and _sign_of(scene["output"]["probes"][name[1]], planar) < 0:
            values = -values
        if kind == "actuation":
            actuation = next(each for each in scene["actuation"] if each["name"] == name[1])
            if "natural_curvature" in actuation:
                values = -values if planar else values * [1.0, -1.0]
        expected[new_name] = reading.with_values(values)
    if any(each.get("profile") == "linear" for each in scene.get("actuation", ())):
        # It is two actuations now, with other forces, and the fields have the places of both.
        kept = ("positions", "velocities", "energy", "work", "reaction")
        expected = {name: each for name, each in expected.items() if name[0] in kept}
    return _reversed_reactions(expected)


def _sign_of(probe: Scene, planar: bool) -> int:
    return -1 if probe["quantity"] in _REVERSED[planar] | {"tx", "ty", "tz"} else 1


def _backward(values: Array, rod: der.Rod | None, axis: int) -> Array:
    """Nodes of a rod from its other end; a ring keeps its first one."""
    assert rod is not None
    flipped = np.flip(values, axis)
    return np.roll(flipped, 1, axis) if rod.closed else flipped


def _reversed_reactions(readings: dict[Name, Reading]) -> dict[Name, Reading]:
    """The places of a support that has several, in the other order."""
    counts: dict[int, int] = {}
    for name in readings:
        if name[0] == "reaction":
            counts[name[1]] = max(counts.get(name[1], 0), name[2] + 1)
    return {
        ("reaction", name[1], counts[name[1]] - 1 - name[2], name[3])
        if name[0] == "reaction"
        else name: reading
        for name, reading in readings.items()
    }


# ---- order in the file


def shuffled() -> Law:
    """Rods, supports, loads, actuations and probes in the opposite order."""

    def write(scene: Scene) -> Scene:
        scene = copy.deepcopy(scene)
        loads, supports = len(scene.get("loads", ())), len(scene.get("supports", ()))
        # A moment between two rods acts on the second, and an angle is its.
        motors = {load.get("moment", {}).get("joint") for load in scene.get("loads", ())}
        probes = scene.get("output", {}).get("probes", {}).values()
        motors |= {probe["joint"] for probe in probes if probe["quantity"] == "angle"}
        for joint in scene.get("joints", ()):
            if "prescribe" not in joint and joint["name"] not in motors:
                joint["of"] = joint["of"][::-1]
        for key in ("rods", "joints", "supports", "loads", "actuation"):
            if key in scene:
                scene[key] = scene[key][::-1]
        for probe in scene.get("output", {}).get("probes", {}).values():
            if isinstance(probe.get("support"), int):
                probe["support"] = supports - 1 - probe["support"]
        path = scene.get("analysis", {})
        if isinstance(path, dict) and isinstance(path.get("continuation"), dict):
            kind, _, number = path["continuation"].get("vary", "").partition(".")
            if kind == "loads" and number.isdigit():
                path["continuation"]["vary"] = f"loads.{loads - 1 - int(number)}"
        return scene

    def follow(scene: Scene, readings: Readings) -> dict[Name, Reading]:
        last = len(scene.get("supports", ())) - 1
        return {
            ("reaction", last - name[1], *name[2:]) if name[0] == "reaction" else name: reading
            for name, reading in readings.items()
        }

    return Law(write, follow)


# ---- planar scenes in space


def in_space(model: str) -> Law:
    """A planar scene as a model of space; what holds a node holds it in the plane, too."""

    def write(scene: Scene) -> Scene:
        if not is_planar(scene):
            raise NotApplicableError("the scene is not planar")
        if "joints" in scene:
            raise NotApplicableError("joints in scenes of two components are planar")
        analysis = scene.get("analysis", "static")
        if analysis != "static" and "static" not in analysis:
            raise NotApplicableError("motions out of the plane are among its answers")
        if scene.get("time", {}).get("integrator") == "energy_momentum":
            raise NotApplicableError("the integrator is planar")
        for support in scene.get("supports", ()):
            if support.get("clamp") == "tangent" and support["at"] not in ("start", "end"):
                raise NotApplicableError("a bearing inside a rod is a clamp in the plane")
        scene = {**copy.deepcopy(scene), "model": model}
        for rod in scene["rods"]:
            if "stiffness" in rod["cross_section"]:
                rod["cross_section"]["stiffness"].setdefault("GJ", 1.0)
            elif not {"poissons_ratio", "shear_modulus"} & rod["material"].keys():
                rod["material"]["poissons_ratio"] = 0.3
        for support in scene.get("supports", ()):
            if "fix" in support:
                support["fix"] = [*support["fix"], "z"]
        scene = drop_probes(scene, _is_the_same_in_space)
        try:
            model_of(scene)
        except der.DerError as error:
            reason = re.search(
                r"cannot represent this scene: .*?\.|have no inertia.*?,", str(error)
            )
            if reason is None:
                raise
            raise NotApplicableError(reason[0]) from error
        return scene

    return Law(write, _in_space_readings, _in_space_by_order, frozenset({"model", "stability"}))


def _in_space_by_order(scene: Scene, name: Name) -> bool:
    """Besides, the energies where moments and springs against turning act: in the plane they have
    cells of their own. A force and a moment that follow at one place have an element of their own
    in space, which ends its own iterations."""
    if turns_in_stages(scene) or _followers(scene) > 1:
        return True
    turned = any("moment" in load for load in scene.get("loads", ())) or any(
        "rotational_stiffness" in support.get("spring", {}) for support in scene.get("supports", ())
    )
    return is_recovered(scene, name) or (turned and name[0] in ("energy", "work"))


def unbent(scene: Scene) -> Scene:
    """The scene with rods that are straight without stress, where they are as drawn."""
    if any(rod.get("closed") for rod in scene["rods"]):
        raise NotApplicableError("a ring that is straight without stress has many equilibria")
    if any(rod.get("curvature") == "tangent" and _has_a_kink(rod) for rod in scene["rods"]):
        raise NotApplicableError("the tangent measure of a kink that is bent is not its angle")
    rods = [{"natural_curvature": 0.0, **rod} for rod in scene["rods"]]
    return {**scene, "rods": rods}


def _has_a_kink(rod: Scene) -> bool:
    edges = np.diff(rod.get("points", [[0.0, 0.0], [0.0, 0.0]]), axis=0)
    edges = edges / np.maximum(np.linalg.norm(edges, axis=1), 1e-300)[:, None]
    return bool(np.any(np.sum(edges[1:] * edges[:-1], axis=1) < 0.5))


def _followers(scene: Scene) -> int:
    parts = (part for load in scene.get("loads", ()) for part in load.values())
    return sum(isinstance(part, dict) and part.get("follower", False) for part in parts)


def turns_in_stages(scene: Scene) -> bool:
    """Whether a clamp turns during the stages of a step: as an angle in the plane, as a vector in
    space, which differ by the error of the scheme there."""
    stepper = scene.get("time", {}).get("integrator", "tr_bdf2")
    turns = any("angle" in each.get("prescribe", {}) for each in scene.get("supports", ()))
    one_stage = ("implicit_euler", "implicit_midpoint", "newmark", "bdf2", "verlet")
    return "time" in scene and turns and stepper not in (*one_stage, "explicit_euler")


def _is_the_same_in_space(probe: Scene) -> bool:
    return der_kind(probe["quantity"]) in ("position", "velocity", "edge", "energy")


def der_kind(quantity: str) -> str:
    """The kind of a quantity of probes."""
    return quantities()[quantity].kind


def _in_space_readings(scene: Scene, readings: Readings) -> dict[Name, Reading]:
    # Space asks for the sections, which a cable does not have. The curvature of the plane is wrong
    # at kinks in the tangent measure: test_curvature_at_a_corner_in_the_tangent_measure.
    cables = {rod.name for rod in model_of(scene).rods if rod.EI == 0.0}
    kinked = {
        rod["name"]
        for rod in scene["rods"]
        if rod.get("curvature") == "tangent" and _has_a_kink(rod)
    }
    expected = {}
    for name, reading in readings.items():
        values = reading.values
        if name[-1] in ("curvature", "moment") and name[1] in cables:
            continue
        if name[-1] == "curvature" and name[1] in kinked:
            continue
        if reading.is_vector or reading.is_point:
            values = np.concatenate([values, np.zeros((*values.shape[:-1], 1))], axis=-1)
        elif name[0] == "reaction":  # a moment about z
            values = np.stack([0.0 * values, 0.0 * values, values], axis=-1)
        elif name[-1] in ("curvature", "moment"):  # what the plane has with a sign
            values = np.abs(values)
        elif name[-1] in ("turning_angle", "slope", "natural_curvature"):
            continue
        elif name[0] == "actuation" and reading.unit == "N m":
            # Director 1 is the z axis: a curvature about it bends away from director 2.
            values = np.stack([0.0 * values, -values], axis=-1)
        if name[0] == "probe" and not _is_the_same_in_space(scene["output"]["probes"][name[1]]):
            continue
        expected[name] = reading.with_values(values)
    return expected
