"""Quantities along rods at every saved frame: curvature, tension, speed.

They are those of the engine's probes (``docs/results.md``), for all nodes and frames at once: a
probe at a node, or at the middle of an edge, gives the same number.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from der._core import HeldNode, Rod, Scenario, held_nodes
from der.scene_loads import continuation_settings, value_at

if TYPE_CHECKING:
    from der.result import Result

Array = NDArray[np.float64]

#: Unit of each quantity along a rod.
FIELD_UNITS = {"curvature": "1/m", "tension": "N", "speed": "m/s"}

# How the edge next to a clamp is set on (docs/mechanics.md): it starts from a pivot on the held
# tangent, it turns over a cell of its own, and the cell of the next node is shorter.
_PIVOT_SHARE = 1.0 / 5.0
_CELL_SHARE = 25.0 / 48.0
_NEXT_CELL_LOSS = 1.0 / 48.0


@dataclass(frozen=True, eq=False)
class RodFields:
    """What varies along one rod, at every frame.

    Attributes
    ----------
    rod
        The rod.
    positions, velocities
        Of its nodes [m], [m/s], shape (frames, nodes of the rod, dim).
    curvature
        Turning angle per length [1/m], shape (frames, nodes of the rod). Known where the rod bends
        (inner nodes and clamped ends), and carried on linearly to free ends; 0 on a rod that bends
        nowhere. Signed in the plane, positive counter-clockwise.
    tension
        Axial force [N], shape (frames, nodes of the rod): between the middles of the edges linear,
        and carried on linearly to the ends.
    edge_tension
        Axial force in each edge [N], shape (frames, edges of the rod).
    """

    rod: Rod
    positions: Array
    velocities: Array
    curvature: Array
    tension: Array
    edge_tension: Array

    @property
    def speed(self) -> Array:
        """Magnitude of the velocity [m/s], shape (frames, nodes of the rod)."""
        return np.asarray(np.linalg.norm(self.velocities, axis=2))

    def named(self) -> dict[str, Array]:
        """Return each quantity of `FIELD_UNITS`, shape (frames, nodes of the rod), by name."""
        return {"curvature": self.curvature, "tension": self.tension, "speed": self.speed}


def rod_fields(result: Result) -> list[RodFields]:
    """Return the quantities along each rod of a result, in the order of `Result.rods`."""
    tangents = clamp_tangents(result)
    return [
        make_rod_fields(
            rod,
            result.model.initial_positions[rod.nodes],
            result.positions[:, rod.nodes],
            result.velocities[:, rod.nodes],
            {
                int(np.flatnonzero(rod.nodes == node)[0]): angles
                for (name, node), angles in tangents.items()
                if name == rod.name
            },
        )
        for rod in result.rods
    ]


def make_rod_fields(
    rod: Rod,
    initial: Array,
    positions: Array,
    velocities: Array,
    tangents: Mapping[int, Array],
) -> RodFields:
    """Compute the quantities along one rod.

    Parameters
    ----------
    rod
        The rod.
    initial
        Its nodes as drawn [m], shape (nodes, dim).
    positions, velocities
        Of its nodes [m], [m/s], shape (frames, nodes, dim).
    tangents
        For each clamped place of the rod (its nodes counted from 0), the angle of the held tangent
        [rad] as drawn and at every frame, shape (1 + frames,). Planar rods only.
    """
    # The drawn shape goes first, so that rest and present lengths come from the same lines.
    links = np.diff(np.concatenate([initial[np.newaxis], positions]), axis=1)
    edges = np.diff(rod.arc_lengths)
    clamps = {place: _direction(angles) for place, angles in tangents.items()} if rod.EI else {}
    for place, direction in clamps.items():
        if place < len(edges):
            links[:, place] -= _PIVOT_SHARE * edges[place] * direction
        if place > 0:
            links[:, place - 1] -= _PIVOT_SHARE * edges[place - 1] * direction
    lengths = np.linalg.norm(links, axis=2)
    edge_tension = rod.EA * (lengths[1:] - lengths[0]) / edges
    middles = 0.5 * (rod.arc_lengths[1:] + rod.arc_lengths[:-1])
    return RodFields(
        rod=rod,
        positions=positions,
        velocities=velocities,
        curvature=_curvature(links[1:], edges, {p: d[1:] for p, d in clamps.items()}, rod),
        tension=_carry(edge_tension, middles, rod.arc_lengths),
        edge_tension=edge_tension,
    )


def _curvature(links: Array, edges: Array, clamps: Mapping[int, Array], rod: Rod) -> Array:
    places = [p for p in range(len(edges) + 1) if 0 < p < len(edges) or p in clamps]
    if not places:
        return np.zeros((len(links), len(edges) + 1))
    cells = []
    for place in places:
        before = links[:, place - 1] if place > 0 else clamps[place]
        after = links[:, place] if place < len(edges) else clamps[place]
        length = _cell_length(place, edges, clamps)
        cells.append(_angle(before, after) / length)
    values = np.stack(cells, axis=1)
    if len(places) > 1:
        # The value of a clamp's cell is that at its pivot; the clamp's own is carried on from it.
        share = _PIVOT_SHARE / (1.0 - _PIVOT_SHARE)
        ends = values[:, [0, -1]] + share * (values[:, [0, -1]] - values[:, [1, -2]])
        if places[0] == 0:
            values[:, 0] = ends[:, 0]
        if places[-1] == len(edges):
            values[:, -1] = ends[:, 1]
    return _carry(values, rod.arc_lengths[places], rod.arc_lengths)


def _cell_length(place: int, edges: Array, clamps: Mapping[int, Array]) -> float:
    """Return the length [m] over which the turning angle at a place acts."""
    if place in clamps:
        return float(_CELL_SHARE * edges[max(place - 1, 0) : place + 1].sum())
    length = 0.5 * (edges[place - 1] + edges[place])
    if place - 1 in clamps:
        length -= _NEXT_CELL_LOSS * edges[place - 1]
    if place + 1 in clamps:
        length -= _NEXT_CELL_LOSS * edges[place]
    return float(length)


def _direction(angles: Array) -> Array:
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _angle(before: Array, after: Array) -> Array:
    """Return the angle [rad] from one vector to the next, row by row; in space without a sign."""
    along = np.sum(before * after, axis=1)
    if before.shape[1] == 2:
        across = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    else:
        across = np.linalg.norm(np.cross(before, after), axis=1)
    return np.asarray(np.arctan2(across, along))


def _carry(values: Array, known: Array, wanted: Array) -> Array:
    """Return values between and beyond the places where they are known, linearly.

    `values` has the shape (frames, known places), `known` and `wanted` are ascending arc lengths.
    """
    if len(known) == 1:
        return np.repeat(values, len(wanted), axis=1)
    right = np.clip(np.searchsorted(known, wanted, side="right"), 1, len(known) - 1)
    share = (wanted - known[right - 1]) / (known[right] - known[right - 1])
    return (1.0 - share) * values[:, right - 1] + share * values[:, right]


def clamp_tangents(result: Result) -> dict[tuple[str, int], Array]:
    """Return the angle of every clamp's tangent [rad], as drawn and at every frame.

    Returns
    -------
    dict
        Arrays of shape (1 + frames,) by name of the rod and row number of the node. Of several
        clamps on a node the first counts.
    """
    found: dict[tuple[str, int], Array] = {}
    count = len(result.times)
    turns = _turns(result.scenario)
    frames = [held_at(result, k) for k in range(count)] if turns else [held_at(result, 0)] * count
    drawn = held_nodes(without_motion(result.scenario))
    for number, node in enumerate(drawn):
        if node.tangent_angle is not None and (node.rod, node.node) not in found:
            angles = [held[number].tangent_angle for held in (drawn, *frames)]
            found[node.rod, node.node] = np.array(angles, dtype=np.float64)
    return found


def held_at(result: Result, frame: int) -> list[HeldNode]:
    """Return the held nodes at a frame, with their clamps turned as they are then."""
    scenario = result.scenario
    if not _turns(scenario):
        return held_nodes(scenario)
    if result.path is None:
        return held_nodes(scenario, float(result.times[frame]))
    return held_nodes(_with_motion_scaled(scenario, float(result.path.factor[frame])))


def _turns(scenario: Scenario) -> bool:
    supports = scenario.to_dict().get("supports") or []
    return any("angle" in (support.get("prescribe") or {}) for support in supports)


def without_motion(scenario: Scenario) -> Scenario:
    """Return the scenario with its prescribed motions at zero: as drawn."""
    return _with_motion_scaled(scenario, 0.0, vary="supports") if _turns(scenario) else scenario


def _with_motion_scaled(scenario: Scenario, factor: float, vary: str | None = None) -> Scenario:
    """Scale the prescribed rotations that a continuation varies, or all with `vary` supports."""
    scene = scenario.to_dict()
    if vary is None:
        vary = continuation_settings(scene).get("vary", "loads")
    changes = {}
    for number, support in enumerate(scene.get("supports") or []):
        angle = (support.get("prescribe") or {}).get("angle")
        if angle is None or vary not in ("supports", f"supports.{number}"):
            continue
        changes[f"supports.{number}.prescribe.angle"] = factor * float(value_at(angle, 0.0))
    return scenario.with_(**changes)
