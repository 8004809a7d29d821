"""Quantities along rods at every saved frame: curvature, tension, speed.

The engine reads them off the frames as its probes would (``docs/results.md``); here they are
carried on to all nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from der._core import Rod
from der.run_data import RunData

Array = NDArray[np.float64]

#: Unit of each quantity along a rod.
FIELD_UNITS = {"curvature": "1/m", "tension": "N", "speed": "m/s"}


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
        Of the rod [1/m], shape (frames, nodes of the rod), as its probes have it; where it jumps
        at a node, the value after it. Without bending stiffness it is known at inner nodes and
        carried on linearly to the ends; 0 on such a rod of two nodes. Signed in the plane, positive
        counter-clockwise.
    tension
        Axial force [N], shape (frames, nodes of the rod), as its probes have it; where it jumps at
        a node, the value after it.
    edge_tension
        Axial force at the middle of each edge [N], shape (frames, edges of the rod).
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


def rod_fields(result: RunData) -> list[RodFields]:
    """Return the quantities along each rod of a result, in the order of `RunData.rods`."""
    return [_fields_of(rod, result) for rod in result.rods]


def _fields_of(rod: Rod, result: RunData) -> RodFields:
    bent, curvature = result.along(rod.name, "curvature")
    pulled, tension = result.along(rod.name, "tension")
    middles = 0.5 * (rod.arc_lengths[1:] + rod.arc_lengths[:-1])
    return RodFields(
        rod=rod,
        positions=result.positions[:, rod.nodes],
        velocities=result.velocities[:, rod.nodes],
        curvature=_carry(curvature, bent, rod.arc_lengths),
        tension=_carry(tension, pulled, rod.arc_lengths),
        edge_tension=_carry(tension, pulled, middles),
    )


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
