"""The same scene with more elements, a smaller time step, or another stepper."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np

from der._core import Scenario
from der.accuracy.resampling import (
    Array,
    arc_lengths,
    resample,
    resample_list,
    unresolved_nodes,
)
from der.scene_loads import kind_of

#: Order of the rods in the length of their elements, and of every probe but the turning angle.
SPACE_ORDER = 2.0

#: Two places along a rod closer than this share of its length are the same.
_SAME_PLACE = 1e-9
#: Two curves through the points of a rod are the same if they differ by no more than this share of
#: its size.
_SAME_CURVE = 1e-13


def rods_that_cannot_be_refined(scenario: Scenario) -> dict[str, str]:
    """Return the rods whose number of nodes is part of the model, with the reason for each.

    Spheres or loads on every node are: more nodes would mean more of them. So are all rods
    of a scene that starts from the last frame of a run, whose nodes they take over.
    """
    scene = scenario.to_dict()
    reasons = {}
    if scene.get("start_from", "equilibrium") != "equilibrium":
        reason = f"it starts from '{scene['start_from']}', a run with as many nodes"
        reasons = {rod["name"]: reason for rod in scene["rods"]}
    for rod in scene["rods"]:
        name = rod["name"]
        if any(sphere["at"] == "all" for sphere in rod.get("spheres") or []):
            reasons[name] = "spheres at every node are part of the model"
        for kind, load in _loads(scene):
            if load.get("rod") == name and load.get("at") == "all":
                reasons[name] = f"a {kind.replace('_', ' ')} at every node is part of the model"
    return reasons


def belongs_to_its_mesh(scenario: Scenario, probe: str) -> bool:
    """Whether a probe has no limit on finer meshes: a turning angle, of a rod that is refined."""
    asked = (scenario.to_dict().get("output") or {}).get("probes", {}).get(probe)
    if asked is None:
        return False  # what an analysis finds besides
    fixed = rods_that_cannot_be_refined(scenario)
    return asked["quantity"] == "turning_angle" and asked["rod"] not in fixed


def curves_between_points(scenario: Scenario) -> list[str]:
    """Return the rods whose points leave open by which curve finer meshes are to go through them.

    They are rods drawn by points, and refined; not those whose parts between corners are straight.
    """
    fixed = rods_that_cannot_be_refined(scenario)
    found = []
    for rod in scenario.to_dict()["rods"]:
        if "points" not in rod or rod["name"] in fixed:
            continue
        points, others = (_resampled(rod, Fraction(2), other) for other in (False, True))
        if np.max(np.abs(points - others)) > _SAME_CURVE * np.max(np.ptp(points, axis=0)):
            found.append(rod["name"])
    return found


def unresolved_curves(scenario: Scenario) -> dict[str, list[int]]:
    """Return the nodes beside which points do not resolve the curve of a rod, by its name."""
    curves = curves_between_points(scenario)
    found = {}
    for rod in scenario.to_dict()["rods"]:
        if rod["name"] in curves:
            points = np.array(rod["points"], dtype=float)
            nodes = unresolved_nodes(points, closed=bool(rod.get("closed")))
            if nodes:
                found[rod["name"]] = nodes
    return found


def with_elements(
    scenario: Scenario, factor: Fraction | int, *, other_curve: bool = False
) -> Scenario:
    """Return the scene with `factor` times as many elements in every rod that allows it.

    Old nodes stay where they are when `factor` is a whole number: supports, loads and probes keep
    their places, `{node: k}` becomes `{node: factor * k}`. Rods drawn by a `shape` get new nodes on
    it. Rods drawn by points get new nodes on a smooth curve between corners
    (`der.accuracy.resampling`), or on another one to compare with; lists with a value for each node
    are interpolated. A factor less than 1 makes the mesh coarser.

    Raises
    ------
    ValueError
        If a rod, or a node that the scene names, does not fit the new number of elements. A
        `SceneError`, which is one too, if the scene is no longer valid.
    """
    factor = Fraction(factor)
    if factor == 1:
        return scenario
    scene = scenario.to_dict()
    fixed = rods_that_cannot_be_refined(scenario)
    for rod in scene["rods"]:
        if rod["name"] not in fixed:
            _refine_rod(scene, rod, factor, other_curve)
    return Scenario.from_dict(scene)


def count_elements(scenario: Scenario) -> dict[str, int]:
    """Return the number of elements of each rod, by its name."""
    return {rod["name"]: _count_elements(rod) for rod in scenario.to_dict()["rods"]}


def count_nodes(scenario: Scenario) -> dict[str, int]:
    """Return the number of nodes of every rod: one more than its elements, of a ring as many."""
    return {rod["name"]: _count_nodes(rod) for rod in scenario.to_dict()["rods"]}


def with_time(scenario: Scenario, **changes: Any) -> Scenario:
    """Return the scene with some keys of `time` replaced; None removes a key.

    `every` stands for ``output.every``.
    """
    scene = scenario.to_dict()
    for key, value in changes.items():
        table = scene.setdefault("output", {}) if key == "every" else scene["time"]
        table.pop(key, None)
        if value is not None:
            table[key] = value
    return Scenario.from_dict(scene)


def _count_nodes(rod: dict[str, Any]) -> int:
    if "points" in rod:
        return len(rod["points"])
    more = 0 if rod.get("closed") else 1  # nodes than elements
    return (int(rod["nodes"]) - more) * int(rod.get("subdivide", 1)) + more


def _count_elements(rod: dict[str, Any]) -> int:
    return _count_nodes(rod) - (0 if rod.get("closed") else 1)


def _loads(scene: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for load in scene.get("loads") or []:
        kind, what = kind_of(load)
        if isinstance(what, dict):
            yield kind, what


def _refine_rod(
    scene: dict[str, Any], rod: dict[str, Any], factor: Fraction, other_curve: bool
) -> None:
    places = _Places(rod, factor, other_curve)
    if "points" not in rod and (scene.get("joints") or "shape" in rod):
        # Each element is cut alike, so that its ends stay where they are.
        parts = factor * int(rod.get("subdivide", 1))
        if parts.denominator != 1:
            raise ValueError(f"the elements of rod {rod['name']!r} cannot be cut into {parts}")
        rod["subdivide"] = int(parts)
        if scene.get("joints"):
            return  # nodes and lists count the elements of `nodes`
    for key in ("natural_curvature", "natural_twist", "initial_velocity"):
        if _is_per_node(rod, key):
            values = np.array(rod[key], dtype=float)
            closed = bool(rod.get("closed"))
            rod[key] = resample_list(values, places.elements, closed=closed).tolist()
    if places.points is not None:
        rod["points"] = places.points.tolist()
    elif "shape" not in rod:
        rod["nodes"] = places.elements + 1
    probes = _probes(scene).values()
    for item in _what_stands_on(scene, rod):
        if other_curve and any(item is probe for probe in probes) and "side" not in item:
            places.leave_open(item)
        for key in ("at", "from", "to"):
            if key in item:
                item[key] = places.moved(item[key])


def _is_per_node(rod: dict[str, Any], key: str) -> bool:
    """Whether a key holds a list with a value for each node."""
    depth = np.ndim(rod[key]) if key in rod else 0
    if key == "natural_twist":
        return depth == 1
    # Numbers in a row are a pair of curvatures where vectors have three components.
    in_plane = len(rod["points"][0] if "points" in rod else rod["from"]) == 2
    return depth == 2 or (depth == 1 and key == "natural_curvature" and in_plane)


def _what_stands_on(scene: dict[str, Any], rod: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield everything that has a place along the rod."""
    yield from rod.get("spheres") or []
    loads = (what for _, what in _loads(scene))
    members = (member for joint in scene.get("joints") or [] for member in joint["of"])
    for item in (*(scene.get("supports") or []), *loads, *members, *_probes(scene).values()):
        if item.get("rod") == rod["name"]:
            yield item


def _probes(scene: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return (scene.get("output") or {}).get("probes") or {}


def _resampled(rod: dict[str, Any], factor: Fraction, other_curve: bool) -> Array:
    points = np.array(rod["points"], dtype=float)
    return resample(points, factor, closed=bool(rod.get("closed")), other_curve=other_curve)


def _rest_arcs(rod: dict[str, Any], drawn: Array) -> Array:
    """Return the rest arc lengths of nodes that are drawn at these arc lengths."""
    return drawn * (float(rod["rest_length"]) / drawn[-1]) if "rest_length" in rod else drawn


class _Places:
    """Where the nodes of a rod are before and after a refinement."""

    def __init__(self, rod: dict[str, Any], factor: Fraction, other_curve: bool) -> None:
        before = _count_elements(rod)
        self._name = rod["name"]
        self._factor = factor
        self._closed = bool(rod.get("closed"))
        self.elements = max(1, round(before * factor))
        self.points = None
        if "points" in rod:
            old = np.array(rod["points"], dtype=float)
            self.points = _resampled(rod, factor, other_curve)
            self._old_arc = _rest_arcs(rod, arc_lengths(old, closed=self._closed))
            self._new_arc = _rest_arcs(rod, arc_lengths(self.points, closed=self._closed))

    def moved(self, place: Any) -> Any:
        """Return what names, on the new mesh, the place that `place` names on the old one."""
        if isinstance(place, dict):
            return {"node": self._moved_node(int(place["node"]))}
        if self.points is None or place in ("start", "end", "all"):
            return place
        # On a curve the arc length grows a little with each refinement: the place stays with its
        # node, or with its share of an element.
        length = self._old_arc[-1]
        s = 0.5 * length if place == "middle" else float(place)
        nearest = int(np.argmin(np.abs(self._old_arc - s)))
        if abs(self._old_arc[nearest] - s) <= _SAME_PLACE * length:
            at_node = self._moved_node(nearest)
            return {"node": at_node} if place == "middle" else float(self._new_arc[at_node])
        if self._factor.denominator != 1:
            return place
        return float(np.interp(s, self._old_arc, self._new_arc[:: self._factor.numerator]))

    def leave_open(self, probe: dict[str, Any]) -> None:
        """Move a probe between nodes to where its share of the old length is on the new curve.

        Points tell neither where it is on the curve between them: by its element, or by its length.
        """
        place = probe.get("at")
        if self.points is None or self._factor.denominator != 1:
            return
        if not (place == "middle" or isinstance(place, float | int)):
            return
        share = 0.5 if place == "middle" else float(place) / self._old_arc[-1]
        if np.min(np.abs(self._old_arc / self._old_arc[-1] - share)) > _SAME_PLACE:
            at = np.interp(
                share * self._new_arc[-1], self._new_arc[:: self._factor.numerator], self._old_arc
            )
            probe["at"] = float(at)

    def _moved_node(self, node: int) -> int:
        # A negative number counts from the end: -1 is the last, which in a ring is no end.
        from_end = 1 if node < 0 and not self._closed else 0
        moved = (node + from_end) * self._factor
        if moved.denominator != 1:
            raise ValueError(f"node {node} of rod {self._name!r} falls between two nodes")
        return int(moved) - from_end
