"""Quantities along rods at every saved frame: curvature, tension, speed.

The engine reads them off the frames as its probes would (``docs/results.md``); here they are
carried on to all nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from der._core import Model, Quantity, Rod, quantities
from der.run_data import RunData

Array = NDArray[np.float64]


def fields_of(model: Model) -> dict[str, Quantity]:
    """Return the quantities along rods that exports and views have of a model, by name.

    They have a value at every arc length; those of the motion come last. Components of positions
    and velocities are left out, as the vectors are exported; the shape without stress is one of
    them where actuations change it.
    """
    left_out = {"turn", "ring", "support", "actuation", "joint", "spring", "energy"}
    if not model.is_actuated:
        left_out.add("natural")
    along_rods = [
        quantity
        for quantity in quantities()
        if quantity.is_available(model)
        and quantity.kind not in left_out
        and not quantity.is_component
    ]
    along_rods.sort(key=is_motion)
    return {quantity.name: quantity for quantity in along_rods}


def is_motion(quantity: Quantity) -> bool:
    """Return whether a quantity is zero where nothing moves."""
    return quantity.kind == "velocity"


@dataclass(frozen=True, eq=False)
class RodFields:
    """The quantities along one rod, at every frame.

    Attributes
    ----------
    rod
        The rod.
    positions, velocities
        Positions [m] and velocities [m/s] of the nodes of its line (`Rod.line_nodes`), shape
        (frames, nodes, dim): a ring comes back to its first node.
    at_nodes
        Each quantity of `fields_of` by name, in its SI unit, shape (frames, nodes), as
        its probes have it; where it jumps at a node, the value after it. Without bending stiffness
        curvature and moment are known at inner nodes and carried on linearly to the ends; 0 on such
        a rod of two nodes. Signed in a scene of two components, positive counter-clockwise; the
        total one in a scene of three.
    at_edges
        Those that belong to edges (strain and tension) at the middle of each, shape (frames, edges
        of the rod).
    """

    rod: Rod
    positions: Array
    velocities: Array
    at_nodes: dict[str, Array]
    at_edges: dict[str, Array]


def rod_fields(result: RunData) -> list[RodFields]:
    """Return the quantities along each rod of a result, in the order of `RunData.rods`."""
    return [_fields_along(rod, result) for rod in result.rods]


def _fields_along(rod: Rod, result: RunData) -> RodFields:
    middles = 0.5 * (rod.line_arc_lengths[1:] + rod.line_arc_lengths[:-1])
    at_nodes, at_edges = {}, {}
    for name, quantity in fields_of(result.model).items():
        known, values = result.along(rod.name, name)
        at_nodes[name] = _carry(values, known, rod.line_arc_lengths)
        if quantity.kind == "edge":
            at_edges[name] = _carry(values, known, middles)
    return RodFields(
        rod=rod,
        positions=result.positions[:, rod.line_nodes],
        velocities=result.velocities[:, rod.line_nodes],
        at_nodes=at_nodes,
        at_edges=at_edges,
    )


def along_line(values: Array, rod: Rod) -> Array:
    """Return values of the nodes of a rod at the nodes of its line: those of a ring come back."""
    return np.resize(values, len(rod.line_nodes))


def _carry(values: Array, known: Array, wanted: Array) -> Array:
    """Return values between and beyond the places where they are known, linearly; 0 without any.

    `values` has the shape (frames, known places), `known` and `wanted` are ascending arc lengths
    [m].
    """
    if len(known) < 2:
        return np.repeat(values.sum(axis=1, keepdims=True), len(wanted), axis=1)
    right = np.clip(np.searchsorted(known, wanted, side="right"), 1, len(known) - 1)
    share = (wanted - known[right - 1]) / (known[right] - known[right - 1])
    return (1.0 - share) * values[:, right - 1] + share * values[:, right]
