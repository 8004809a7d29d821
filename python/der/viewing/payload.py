"""The content of a view, as numbers and texts for its script."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der._core import Rod, axial_springs, hinges, springs
from der.actuated_stretches import ActuatedStretch, actuated_stretches
from der.characteristic_scales import characteristic_scale
from der.fields import fields_of
from der.film import Film, failure_text, make_film, mode_shapes, round_speed, speed_text
from der.plotting.lengths import LengthScale
from der.plotting.style import quantity_text
from der.run_data import RunData
from der.scene_loads import ActingLoads, ground_direction
from der.sections import Section, sections_of

Array = NDArray[np.float64]

#: Most numbers that a page may hold; longer films leave out frames.
_BUDGET = 4_000_000
#: Size of the symbols of supports, against the structure's.
_SYMBOL = 0.035
#: Arrows of a distributed force.
_LINE_ARROWS = 9
#: Springs of an elastic foundation of a whole rod.
_FOUNDATION_SPRINGS = 15
#: The quantity that rods are coloured by at first.
_COLOURED = "curvature"
#: Speeds on offer, against the one that suits the run.
_SPEEDS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)


def make_payload(result: RunData) -> dict[str, Any]:
    """Return what ``view.js`` reads; arrays are base64 of 32-bit floats, positions have x, y, z.

    All lengths are in the unit of the axes, and positions count from where these begin: 32 bits
    are too few for a rod far from zero.
    """
    film = make_film(result)
    quantities = fields_of(result.model)
    frames = _kept_frames(film)
    in_metres = _in_space(film.positions[frames])
    scale = LengthScale.of(in_metres.min(axis=(0, 1)), in_metres.max(axis=(0, 1)))
    positions = scale.shown(in_metres)
    sections = sections_of(result)
    loads = _loads(result, film, frames)
    found_springs = _springs(result)
    found_axial_springs = [_places(result, ends) for ends in axial_springs(result.scenario)]
    symbols = any(loads["loads"]) or bool(found_springs) or bool(found_axial_springs)
    low, high, symbol = _limits(result.rods, sections, positions, scale.metres, symbols)
    span = 0.0 if film.times is None else float(film.times[-1] - film.times[0])
    notes = [failure_text(result), result.scenario.analysis if result.scenario.is_static else ""]
    if len(frames) < len(film.captions):
        notes.append(f"{len(frames)} of {len(film.captions)} saved frames")
    gravity = film.loads(result, 0).gravity
    if gravity is not None:
        notes.append(f"gravity {_vector_text(gravity)} m/s²")
    return {
        "title": result.scenario.title,
        "note": ", ".join(note for note in notes if note),
        "captions": _captions(film, frames),
        "times": None if film.times is None else film.times[frames].tolist(),
        "chapters": [
            {
                "title": chapter.title,
                "first": int(np.searchsorted(frames, chapter.first)),
                "last": int(np.searchsorted(frames, chapter.last)),
                "loops": chapter.loops,
            }
            for chapter in film.chapters
        ],
        "start": len(frames) - 1 if result.scenario.analysis == "static" else 0,
        "speeds": _speeds(span),
        "fields": {
            name: _field_range(quantities[name].unit, values, result.rods, span)
            for name, values in film.fields.items()
        },
        "probes": _probes(result, film, frames),
        "quantity": _COLOURED if _COLOURED in film.fields else "",
        "rods": [
            _rod(
                rod,
                positions,
                scale.metres,
                {name: rods[k][frames] for name, rods in film.fields.items()},
            )
            | _section(sections[k], film.directors[k], frames, scale.metres)
            for k, rod in enumerate(result.rods)
        ],
        "supports": _supports(result, film.source[frames]),
        "springs": found_springs,
        "axial_springs": found_axial_springs,
        "hinges": _places(result, hinges(result.scenario)),
        **loads,
        "actuation": _actuation(result, film.source[frames]),
        "symbol": symbol,
        "low": low.tolist(),
        "high": high.tolist(),
        "axes": [scale.label(axis) for axis in range(3)],
        "flat": bool(np.all(positions[:, :, 2] == 0.0)),
    }


def _vector_text(vector: Array) -> str:
    return f"({', '.join(f'{value:.4g}' for value in vector)})"


def _kept_frames(film: Film) -> NDArray[np.int64]:
    """Return the frames that a page has room for; a chapter keeps its first and its last."""
    numbers = film.positions[0].size + sum(len(rods[0][0]) for rods in film.fields.values())
    numbers += sum(one[0].size for one in film.directors if one is not None)
    stride = max(1, int(np.ceil(len(film.captions) * numbers / _BUDGET)))
    kept = set(range(0, len(film.captions), stride))
    kept |= {frame for chapter in film.chapters for frame in (chapter.first, chapter.last)}
    return np.array(sorted(kept), dtype=np.int64)


def _captions(film: Film, frames: NDArray[np.int64]) -> list[str]:
    if film.times is None:
        return [film.captions[frame] for frame in frames]
    steps = np.diff(film.times)
    least = float(steps[steps > 0.0].min()) if np.any(steps > 0.0) else 1.0
    decimals = int(np.clip(np.ceil(-np.log10(least) - 1e-9), 0, 12))
    return [f"t = {film.times[frame]:.{decimals}f} s" for frame in frames]


def _speeds(span: float) -> list[tuple[float, str]]:
    if span <= 0.0:
        return []
    speeds = [float(f"{round_speed(span) * factor:.3g}") for factor in _SPEEDS]
    return [(speed, speed_text(speed)) for speed in speeds]


def _noise(rods: list[Rod], unit: str, span: float) -> float:
    """Return how much of a quantity may be rounding, by the size of the rods.

    A strain of 1e-12, a curvature that turns the longest rod by a billionth, a speed that takes a
    rod a billionth of its length along in the whole run (`span` [s]).
    """
    share = 1e-12 if unit in ("", "N") else 1e-9
    return share * characteristic_scale(rods, unit, span)


def _field_range(unit: str, fields: list[Array], rods: list[Rod], span: float) -> dict[str, Any]:
    """Return unit and range of a quantity; one that is constant gets a range around it.

    A quantity that varies by no more than rounding is constant; one that is no larger is 0.
    """
    low = min(float(values.min()) for values in fields)
    high = max(float(values.max()) for values in fields)
    low, high = _wide(low, high, _noise(rods, unit, span))
    return {"unit": unit, "low": low, "high": high}


def _wide(low: float, high: float, noise: float) -> tuple[float, float]:
    """Return a range that is more than noise."""
    size = max(abs(low), abs(high))
    if size <= noise:
        return -1.0, 1.0
    room = max(0.01 * size, noise) if high - low <= max(1e-9 * size, noise) else 0.0
    return low - room, high + room


def _probes(result: RunData, film: Film, frames: NDArray[np.int64]) -> list[dict[str, Any]]:
    """Return the probes of a motion at the frames of the page, with the ranges of these."""
    if film.times is None or len(frames) < 2:
        return []
    found = []
    for name, probe in result.probes.items():
        values = np.asarray(probe)[frames]
        low, high = _wide(float(values.min()), float(values.max()), 0.0)
        found.append(
            {"name": name, "unit": probe.unit, "values": values.tolist(), "low": low, "high": high}
        )
    return found


def _rod(rod: Rod, positions: Array, unit: float, fields: dict[str, Array]) -> dict[str, Any]:
    radii = (rod.sphere_radii / unit).tolist()
    return {
        "name": rod.name,
        "nodes": len(rod.line_nodes),
        "spheres": [(i, radius) for i, radius in enumerate(radii) if radius > 0.0],
        "positions": _packed(positions[:, rod.line_nodes]),
        "fields": {name: _packed(values) for name, values in fields.items()},
    }


def _section(
    section: Section | None, directors: Array | None, frames: NDArray[np.int64], unit: float
) -> dict[str, Any]:
    """Return the corners of a rod's section and the director along its width.

    The director has three numbers for each frame and node, or three for all; there is none where a
    round section may lie in any way.
    """
    if directors is not None and len(directors[0]) > 1:
        directors = directors[frames]
    return {
        "outline": [] if section is None else (section.outline / unit).tolist(),
        "directors": "" if directors is None else _packed(directors),
    }


def _packed(values: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")


def _in_space(positions: Array) -> Array:
    """Return positions with three columns; those of planar runs have z = 0."""
    full = np.zeros((*positions.shape[:2], 3))
    full[:, :, : positions.shape[2]] = positions
    return full


def _vector_in_space(vector: Array) -> list[float]:
    return [*vector.tolist(), 0.0][:3]


def _limits(
    rods: list[Rod],
    sections: list[Section | None],
    positions: Array,
    unit: float,
    symbols: bool,
) -> tuple[Array, Array, float]:
    """Return the corners of all frames, symbols included, and the size of these, in the unit."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for rod, section in zip(rods, sections, strict=True):
        reach = 0.0 if section is None else float(np.linalg.norm(section.outline, axis=1).max())
        around = np.maximum(rod.sphere_radii, reach)[:, np.newaxis] / unit
        low = np.minimum(low, (positions[:, rod.nodes] - around).min(axis=(0, 1)))
        high = np.maximum(high, (positions[:, rod.nodes] + around).max(axis=(0, 1)))
    symbol = _SYMBOL * float(np.max(high - low))
    # Arrows are 4 symbols long, and texts beside them wider than high.
    room = np.array([7.0, 5.0, 5.0] if symbols else [2.0, 2.0, 2.0])
    if not positions[:, :, 2].any():
        room[2] = 2.0
    depth = symbol * room
    return low - depth, high + depth, symbol


def _loads(result: RunData, film: Film, frames: NDArray[np.int64]) -> dict[str, Any]:
    """Return the different sets of loads that there are, and which of them acts at each frame.

    A load has a ``kind``, its rod, the ``share`` of the edge after a ``place``, a unit vector
    ``along`` (of moments the axis, of foundations to the ground) and a ``text``. Modes are shown
    with foundations alone, and gravity stands in the page's note.
    """
    if mode_shapes(result).size:
        held = ActingLoads(foundations=film.loads(result, 0).foundations)
        return {"loads": [_load_symbols(result, held)], "load_set": [0] * len(frames)}
    sets: list[list[dict[str, Any]]] = []
    chosen = []
    known: dict[int, int] = {}  # of frames of the result
    for frame in frames:
        source = int(film.source[frame])
        if source not in known:
            found = _load_symbols(result, film.loads(result, int(frame)))
            if found not in sets:
                sets.append(found)
            known[source] = sets.index(found)
        chosen.append(known[source])
    return {"loads": sets, "load_set": chosen}


def _load_symbols(result: RunData, loads: ActingLoads) -> list[dict[str, Any]]:
    rods = {rod.name: (number, rod) for number, rod in enumerate(result.rods)}

    def symbol(kind: str, rod: str, at: float, value: Array, text: str) -> dict[str, Any]:
        number, own = rods[rod]
        full = np.zeros(3)
        if value.ndim:
            full[: len(value)] = value
        else:
            full[2] = value  # a planar moment acts about z
        places = own.line_arc_lengths
        right = int(np.clip(np.searchsorted(places, at), 1, len(places) - 1))
        left, length = places[right - 1], np.diff(places)[right - 1]
        return {
            "kind": kind,
            "rod": number,
            "place": right - 1,
            "share": float((at - left) / length),
            "along": (full / np.linalg.norm(full)).tolist(),
            "text": text,
        }

    def amount(value: Array, unit: str) -> str:
        return quantity_text(float(np.linalg.norm(value)), unit)

    found = [
        symbol("force", one.rod, one.at, one.value, amount(one.value, "N")) for one in loads.forces
    ]
    found += [
        symbol("moment", one.rod, one.at, one.value, amount(one.value, "N m"))
        for one in loads.moments
    ]
    for line in loads.lines:
        for number, at in enumerate(np.linspace(line.start, line.end, _LINE_ARROWS)):
            text = amount(line.value, "N/m") if number == _LINE_ARROWS // 2 else ""
            found.append(symbol("line", line.rod, float(at), line.value, text))
    for part in loads.foundations:
        own = rods[part.rod][1]
        down = ground_direction(part, own, result.model.initial_positions)
        count = max(2, round(_FOUNDATION_SPRINGS * (part.end - part.start) / own.length))
        for at in np.linspace(part.start, part.end, count):
            found.append(symbol("foundation", part.rod, float(at), down, ""))
    return found


def _places(result: RunData, nodes: list[int]) -> list[dict[str, int]]:
    """Return a rod and the place on it of each node."""
    places = {
        int(node): {"rod": number, "place": place}
        for number, rod in enumerate(result.rods)
        for place, node in enumerate(rod.nodes)
    }
    return [places[node] for node in nodes]


def _supports(result: RunData, source: NDArray[np.int64]) -> list[dict[str, Any]]:
    """Return the symbol of each held node.

    Clamps have the ``tangents`` that they hold, unit vectors: one for all frames, or one for each
    frame of the page, which are frames ``source`` of the result.
    """
    rods = {rod.name: (number, rod) for number, rod in enumerate(result.rods)}
    dimension = result.positions.shape[2]
    upright = 1 if dimension == 2 else 2  # the axis that points up
    found = []
    clamped = _clamp_tangents(result, source)
    for held, tangents in zip(result.held_nodes(0), clamped, strict=True):
        number, rod = rods[held.rod]
        down = np.zeros(3)
        fixed = ["xyz".index(component) for component in held.components]
        kind = "pin" if len(fixed) == dimension else "roller"
        down[upright if upright in fixed or not fixed else fixed[0]] = -1.0
        found.append(
            {
                "kind": "clamp" if held.tangent is not None else kind,
                "rod": number,
                "place": int(np.flatnonzero(rod.nodes == held.node)[0]),
                "down": down.tolist(),
                "tangents": tangents,
                "slides": held.slides,
            }
        )
    return found


def _clamp_tangents(result: RunData, source: NDArray[np.int64]) -> list[list[list[float]]]:
    """Return for each held node the tangents as `_supports` has them."""
    frames = {frame: result.held_nodes(frame) for frame in np.unique(source).tolist()}
    found: list[list[list[float]]] = []
    for number in range(len(result.held_nodes(0))):
        turned = [frames[frame][number].tangent for frame in source.tolist()]
        tangents = [_vector_in_space(tangent) for tangent in turned if tangent is not None]
        found.append(tangents if any(one != tangents[0] for one in tangents) else tangents[:1])
    return found


def _springs(result: RunData) -> list[dict[str, Any]]:
    """Return the symbol of each spring support.

    It stands where the ``weights`` of the rod's nodes put it, has a zigzag line along each of the
    unit vectors ``along``, and a spiral if it ``turns``, against rotation.
    """
    rods = {rod.name: (number, rod) for number, rod in enumerate(result.rods)}
    found = []
    for spring in springs(result.scenario):
        number, rod = rods[spring.rod]
        start = result.positions[0]
        place = spring.weights @ start[spring.nodes]
        along = np.zeros((len(spring.stiffness), 3))
        np.fill_diagonal(along, -1.0)
        if place[0] > start[rod.nodes, 0].mean():
            along[0] *= -1.0  # away from the middle of the rod
        found.append(
            {
                "rod": number,
                "nodes": np.searchsorted(rod.nodes, spring.nodes).tolist(),
                "weights": spring.weights.tolist(),
                "along": along[np.array(spring.stiffness) > 0.0].tolist(),
                "turns": spring.rotational_stiffness > 0.0,
            }
        )
    return found


def _actuation(result: RunData, source: NDArray[np.int64]) -> list[dict[str, Any]]:
    """Return the band of each actuated stretch.

    Its line goes through points at a ``share`` of the edge after a ``place``, each with the
    ``profile`` there. Every frame of the page, which is frame ``source`` of the result, has the
    value as a ``text`` and its ``size`` against the largest.
    """
    numbers = {rod.name: number for number, rod in enumerate(result.rods)}
    found = []
    for stretch in actuated_stretches(result):
        rod = numbers[stretch.rod]
        texts = [stretch.value_text(frame) for frame in source.tolist()]
        found.append(
            {
                "name": stretch.name,
                "rod": rod,
                "level": stretch.level,
                "points": _band(stretch, result.rods[rod]),
                "sizes": stretch.shares[source].tolist(),
                "texts": texts if any(text != texts[0] for text in texts) else texts[:1],
            }
        )
    return found


def _band(stretch: ActuatedStretch, rod: Rod) -> list[tuple[int, float, float]]:
    """Return place, share and profile of the points of a stretch."""
    at = stretch.samples(rod)
    nodes = rod.line_arc_lengths
    right = np.clip(np.searchsorted(nodes, at), 1, len(nodes) - 1)
    shares = (at - nodes[right - 1]) / np.diff(nodes)[right - 1]
    profile = stretch.profile_at(at)
    return list(zip((right - 1).tolist(), shares.tolist(), profile.tolist(), strict=True))
