"""Reactions: the forces and moments that supports exert on the rods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reaction:
    """The force and the moment that a support exerts on the rod at one of its places.

    Of a simulation they are those at its present state; of a result they have the frames as their
    first axis.

    Attributes
    ----------
    support
        Number of the support in the scene, counted from 0. A support ``at: all`` has a reaction for
        each node.
    rod
        Name of the rod.
    arc_length
        Rest arc length of the place [m].
    point
        Where the force acts [m], shape (dim,) or (frames, dim).
    force
        Force on the rod [N], of the shape of `point`.
    moment
        Moment on the rod [N m], of clamps and springs against turning: counter-clockwise in a
        plane, a number or shape (frames,); a vector in space, of the shape of `point`.
    """

    support: int
    rod: str
    arc_length: float
    point: Array
    force: Array
    moment: Array | np.float64


def make_reactions(
    places: Sequence[tuple[int, str, float]],
    points: Array,
    forces: Array,
    moments: Array,
    dimension: int,
) -> list[Reaction]:
    """Return reactions from what the engine gives: vectors in space, shape (..., places, 3)."""

    def moment_of(vector: Array) -> Any:
        return vector[..., 2] if dimension == 2 else vector

    return [
        Reaction(
            support=support,
            rod=rod,
            arc_length=arc_length,
            point=points[..., i, :dimension],
            force=forces[..., i, :dimension],
            moment=moment_of(moments[..., i, :]),
        )
        for i, (support, rod, arc_length) in enumerate(places)
    ]
