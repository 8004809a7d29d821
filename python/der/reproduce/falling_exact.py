"""Spheres on an elastic rod in a viscous fluid, solved without the engine.

The chain of the report: N nodes at equal distances l on a straight rod at rest, a sphere on each,
the middle one large and the others of a tenth of an edge. With displacements u_i,

    m_i u_i'' = -dE/du_i - (rho_s - rho_f) V_i g - 6 pi mu R_i u_i',        V_i = 4/3 pi R_i^3
    E = sum over edges  EA/2 (|e|/l - 1)^2 l  +  sum over inner nodes  EI/2 (2 tan(phi/2))^2 / l

with phi the turning angle. This module is derived from these equations alone, in terms of edge
angles: the torque dE/dphi of an inner node turns its two edges against each other, and turning an
edge by a force f across it takes the torque |e| f. Time is left to SciPy's Radau, an implicit
Runge-Kutta method of order 5 (Hairer and Wanner, Solving Ordinary Differential Equations II).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_COMPLEX_STEP = 1e-30


@dataclass(frozen=True)
class FallingChain:
    """The report's chain; all in SI units.

    Attributes
    ----------
    nodes
        How many, odd.
    fluid_density
        0 leaves buoyancy out.
    equal
        Whether the middle sphere is as small as the others.
    """

    nodes: int = 3
    fluid_density: float = 1000.0
    equal: bool = False
    length: float = 0.1
    rod_radius: float = 1e-3
    youngs_modulus: float = 1e9
    sphere_density: float = 7000.0
    middle_radius: float = 0.025
    viscosity: float = 1000.0
    gravity: float = 9.8

    @property
    def edge(self) -> float:
        """Length of an edge at rest [m]."""
        return self.length / (self.nodes - 1)

    @property
    def radii(self) -> Array:
        """Radii of the spheres [m], shape (nodes,)."""
        radii = np.full(self.nodes, 0.1 * self.edge)
        if not self.equal:
            radii[self.nodes // 2] = self.middle_radius
        return radii

    @property
    def masses(self) -> Array:
        """Masses of the spheres [kg], shape (nodes,)."""
        return self.sphere_density * 4.0 / 3.0 * np.pi * self.radii**3

    @property
    def weights(self) -> Array:
        """Weight less buoyancy of the spheres [N], shape (nodes,)."""
        share = (self.sphere_density - self.fluid_density) / self.sphere_density
        return self.masses * self.gravity * share

    @property
    def drag(self) -> Array:
        """Stokes drag per speed of the spheres [N s/m], shape (nodes,)."""
        return 6.0 * np.pi * self.viscosity * self.radii

    @property
    def terminal_speed(self) -> float:
        """Speed at which the drag of the whole chain bears its weight [m/s]."""
        return float(self.weights.sum() / self.drag.sum())

    @property
    def lone_sphere_speed(self) -> float:
        """Terminal speed of the middle sphere without the others [m/s]."""
        excess = self.sphere_density - self.fluid_density
        return 2.0 / 9.0 * excess * self.gravity * self.middle_radius**2 / self.viscosity

    @property
    def many_nodes_speed(self) -> float:
        """Terminal speed in the limit of many nodes [m/s].

        The small spheres lose their weight, but not their drag: their radii sum up to a tenth of
        the rod's length.
        """
        return self.lone_sphere_speed / (1.0 + 0.1 * self.length / self.middle_radius)

    def elastic_force(self, displacements: NDArray[Any]) -> NDArray[Any]:
        """Return -dE/du, shape (..., nodes, 2), of displacements of that shape.

        Complex displacements are welcome: every line is an analytic function.
        """
        edge = self.edge
        stretching = self.youngs_modulus * np.pi * self.rod_radius**2
        bending = self.youngs_modulus * np.pi * self.rod_radius**4 / 4.0
        difference = np.diff(displacements, axis=-2)
        dx, dy = difference[..., 0], difference[..., 1]
        # Strain without the difference of two nearly equal lengths.
        growth = (2.0 * edge * dx + dx**2 + dy**2) / edge**2
        ratio = np.sqrt(1.0 + growth)
        length = edge * ratio
        cosine, sine = (edge + dx) / length, dy / length
        tension = stretching * growth / (1.0 + ratio)
        along = cosine[..., 1:] * cosine[..., :-1] + sine[..., 1:] * sine[..., :-1]
        across = cosine[..., :-1] * sine[..., 1:] - sine[..., :-1] * cosine[..., 1:]
        curvature = 2.0 * across / (1.0 + along)
        # dE/dphi, since d(2 tan(phi/2))/dphi = 1 + tan(phi/2)^2.
        torque = bending / edge * curvature * (1.0 + 0.25 * curvature**2)
        turning = np.zeros_like(dx)
        turning[..., 1:] += torque
        turning[..., :-1] -= torque
        shear = turning / length
        pull = np.stack([tension * cosine - shear * sine, tension * sine + shear * cosine], axis=-1)
        force = np.zeros_like(displacements)
        force[..., :-1, :] += pull
        force[..., 1:, :] -= pull
        return force

    def stiffness(self, displacements: Array) -> Array:
        """Return d(-force)/du, shape (2 nodes, 2 nodes), by complex steps: exact to rounding."""
        size = 2 * self.nodes
        nudges = 1j * _COMPLEX_STEP * np.eye(size).reshape(size, self.nodes, 2)
        forces = self.elastic_force(displacements + nudges).reshape(size, size)
        return np.asarray(-forces.imag.T / _COMPLEX_STEP)

    def longest_stable_step(self) -> float:
        """Return the largest step [s] at which the explicit scheme about the rest shape is stable.

        The scheme takes all forces at the old state, then moves with the new velocity. A step is
        stable where no eigenvalue of the matrix that advances (u, u') is larger than one.
        """
        size = 2 * self.nodes
        inverse_mass = np.repeat(1.0 / self.masses, 2)
        rate = np.hstack(
            [
                -inverse_mass[:, None] * self.stiffness(np.zeros((self.nodes, 2))),
                -np.diag(inverse_mass * np.repeat(self.drag, 2)),
            ]
        )

        def is_stable(step: float) -> bool:
            velocity = np.hstack([np.zeros((size, size)), np.eye(size)]) + step * rate
            position = np.hstack([np.eye(size), np.zeros((size, size))]) + step * velocity
            largest = np.abs(np.linalg.eigvals(np.vstack([position, velocity]))).max()
            return bool(largest < 1.0 + 1e-6)  # rigid motions have a double eigenvalue of 1

        low, high = 0.0, 4.0 * float((self.masses / self.drag).min())
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if is_stable(middle) else (low, middle)
        return low


@dataclass(frozen=True)
class Fall:
    """The motion of a chain from rest.

    Attributes
    ----------
    times
        [s], shape (times,).
    displacements
        From the straight shape [m], shape (times, nodes, 2).
    velocities
        [m/s], shape (times, nodes, 2).
    """

    times: Array
    displacements: Array
    velocities: Array

    @property
    def fallen(self) -> Array:
        """How far the middle node has fallen [m], shape (times,)."""
        return -self.displacements[:, self.displacements.shape[1] // 2, 1]

    @property
    def speed(self) -> Array:
        """Speed of the middle node, downward [m/s], shape (times,)."""
        return -self.velocities[:, self.velocities.shape[1] // 2, 1]

    def turning_angle(self, edge: float) -> Array:
        """Return the turning angle of the middle node [rad], shape (times,)."""
        middle = self.displacements.shape[1] // 2
        around = np.diff(self.displacements[:, middle - 1 : middle + 2], axis=1)
        angles = np.arctan2(around[..., 1], edge + around[..., 0])
        return np.asarray(angles[:, 1] - angles[:, 0])


def fall(chain: FallingChain, times: Array, tolerance: float = 1e-8) -> Fall:
    """Let a chain fall from rest.

    Parameters
    ----------
    chain
        The chain that falls.
    times
        When to look at it [s], ascending.
    tolerance
        Relative error that each step may make; those of single displacements and velocities are as
        small against the chain's length and its terminal speed. Radau's estimate is pessimistic:
        1e-8 gives eleven digits. Much smaller ones fight the rounding of the stiff axial forces.

    Raises
    ------
    RuntimeError
        If the integrator gives up.
    """
    from scipy.integrate import solve_ivp  # here, because it takes long to load

    size = 2 * chain.nodes
    masses, drag = np.repeat(chain.masses, 2), np.repeat(chain.drag, 2)
    load = np.zeros(size)
    load[1::2] = -chain.weights

    def rate(_time: float, state: Array) -> Array:
        force = chain.elastic_force(state[:size].reshape(-1, 2)).ravel()
        return np.concatenate([state[size:], (force + load - drag * state[size:]) / masses])

    def jacobian(_time: float, state: Array) -> Array:
        stiffness = chain.stiffness(state[:size].reshape(-1, 2))
        upper = np.hstack([np.zeros((size, size)), np.eye(size)])
        lower = np.hstack([-stiffness / masses[:, None], -np.diag(drag / masses)])
        return np.vstack([upper, lower])

    small = 1e-2 * tolerance
    solution = solve_ivp(
        rate,
        (0.0, float(times[-1])),
        np.zeros(2 * size),
        method="Radau",
        t_eval=times,
        jac=jacobian,
        rtol=tolerance,
        atol=np.repeat([small * chain.length, small * chain.terminal_speed], size),
        first_step=1e-8,
    )
    if not solution.success:
        raise RuntimeError(f"the chain of {chain.nodes} nodes: {solution.message}")
    states = solution.y.T.reshape(len(times), 2, chain.nodes, 2)
    return Fall(times, states[:, 0], states[:, 1])
