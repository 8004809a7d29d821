"""Forces of actuations: the moments, torques and forces on the rods that do their work."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ActuationForce:
    """The moment, torque or force that an actuation exerts on its rod.

    It is conjugate to what the actuation changes: its integral over ``length`` times the value, a
    turning angle, a twist or an elongation, is the work of the actuation. So it is the mean of the
    rod's moment, torque or tension over the stretch, weighted by the profile, with the opposite
    sign. A simulation gives that at its present state; a result has the frames as its first axis.

    Attributes
    ----------
    name
        Name of the actuation.
    rod
        Name of the rod.
    length
        Integral of the profile over the stretch [m].
    force
        The moment [N m] of a natural curvature, the torque [N m] of a twist, or the force [N] of an
        elongation: a number or shape (frames,). A curvature in space has two moments, towards the
        directors: shape (2,) or (frames, 2).
    """

    name: str
    rod: str
    length: float
    force: Array | np.float64


def make_actuation_forces(
    stretches: Sequence[tuple[str, str, float, int]], values: Array
) -> list[ActuationForce]:
    """Return forces from what the engine gives: values of shape (..., actuations, 2)."""
    return [
        ActuationForce(
            name=name,
            rod=rod,
            length=length,
            force=values[..., i, 0] if count == 1 else values[..., i, :],
        )
        for i, (name, rod, length, count) in enumerate(stretches)
    ]
