"""The exact solutions of the report's problems: those of the validation tests, without the engine.

The spheres are `references.falling_spheres`, the tube is `references.extensible_beam`; here is what
only the report asks for.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from references.extensible_beam import (
    REPORT_TUBE,
    Deflection,
    euler_bernoulli_simply_supported,
    simply_supported,
)
from references.falling_spheres import Fall, FallingRod, simulate

Array = NDArray[np.float64]

LOAD_AT = 0.75  # arc length from the pinned end [m]


def terminal_speed(chain: FallingRod) -> float:
    """Return the speed at which the drag of the whole chain bears its weight [m/s]."""
    return -chain.terminal_velocity()


def lone_sphere_speed(chain: FallingRod) -> float:
    """Return the terminal speed of the middle sphere without the others [m/s]."""
    middle = chain.middle
    return float(chain.weights()[middle] / chain.drag()[middle])


def many_nodes_speed(chain: FallingRod) -> float:
    """Return the terminal speed in the limit of many nodes [m/s].

    The small spheres lose their weight, but not their drag: their radii sum up to a tenth of the
    rod's length.
    """
    return lone_sphere_speed(chain) / (1.0 + 0.1 * chain.length / chain.middle_radius)


def fall(chain: FallingRod, times: Array) -> Fall:
    """Return the motion from rest at some times [s]."""
    return simulate(chain, times, curve=True)


def fallen(motion: Fall) -> Array:
    """Return how far the middle node has fallen [m], shape (times,)."""
    return -motion.displacements[:, motion.displacements.shape[1] // 2, 1]


def speed(motion: Fall) -> Array:
    """Return the speed of the middle node, downward [m/s], shape (times,)."""
    return -motion.velocities[:, motion.velocities.shape[1] // 2, 1]


def turning_angle(motion: Fall, edge: float) -> Array:
    """Return the turning angle of the middle node [rad], shape (times,); edges at rest in m."""
    middle = motion.displacements.shape[1] // 2
    around = np.diff(motion.displacements[:, middle - 1 : middle + 2], axis=1)
    angles = np.arctan2(around[..., 1], edge + around[..., 0])
    return np.asarray(angles[:, 1] - angles[:, 0])


def longest_stable_step(chain: FallingRod) -> float:
    """Return the largest step [s] at which the explicit scheme about the rest shape is stable.

    The scheme takes all forces at the old state, then moves with the new velocity. A step is stable
    where no eigenvalue of the matrix that advances (u, u') is larger than one.
    """
    size = 2 * chain.nodes
    inverse_mass = np.repeat(1.0 / chain.masses(), 2)
    stiffness = chain.elastic_hessian(np.zeros((chain.nodes, 2)))
    damping = np.diag(inverse_mass * np.repeat(chain.drag(), 2))
    rate = np.hstack([-inverse_mass[:, None] * stiffness, -damping])

    def is_stable(step: float) -> bool:
        velocity = np.hstack([np.zeros((size, size)), np.eye(size)]) + step * rate
        position = np.hstack([np.eye(size), np.zeros((size, size))]) + step * velocity
        largest = np.abs(np.linalg.eigvals(np.vstack([position, velocity]))).max()
        return bool(largest < 1.0 + 1e-6)  # rigid motions have a double eigenvalue of 1

    low, high = 0.0, 4.0 * float((chain.masses() / chain.drag()).min())
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return low


def deflections(loads: Iterable[float], load_at: float = LOAD_AT) -> dict[float, Deflection]:
    """Return the deflections of the tube by load [N], which acts at an arc length [m]."""
    return {load: simply_supported(REPORT_TUBE, load, load_at) for load in loads}


def linear_deflection(load: float) -> float:
    """Return the largest deflection [m] of the tube by Euler-Bernoulli theory."""
    return euler_bernoulli_simply_supported(REPORT_TUBE, load, LOAD_AT)
