"""Spheres on an elastic rod that falls through a viscous fluid, as an ordinary differential
equation solved to rounding.

The model is the discrete one (N nodes, no continuum limit), so the numbers are the limit of
a simulation at the same N when its time step goes to zero:

    m_i x_i'' = -dE/dx_i + (rho_s - rho_f) V_i g - 6 pi mu R_i x_i',   V_i = 4/3 pi R_i^3

    E = sum_edges 1/2 EA (|e|/l - 1)^2 l  +  sum_inner 1/2 EI kappa^2 / l

with kappa = 2 tan(phi/2) (`tangent`) or kappa = phi (`angle`), phi the turning angle, and
the rod itself without mass. Sphere 'middle' has radius 25 mm, all others a tenth of an edge.

Unknowns are displacements, not positions: the strain is then formed without cancellation,
(|e|^2 - l^2) = 2 E.du + du.du with E the undeformed edge. Forces are the analytic gradient,
written so that it holds for complex arguments; its Jacobian is the complex step (Squire and
Trapp, SIAM Review 40, 1998), exact to rounding. Time integration: Radau IIA of order 5
(Hairer and Wanner, Solving ODEs II, IV.8) as in SciPy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from .record import Array, Problem, Reference, exact, refined

Curvature = Literal["tangent", "angle"]


@dataclass(frozen=True)
class FallingRod:
    """A straight horizontal rod at rest with a sphere on every node (SI units)."""

    nodes: int = 3
    fluid_density: float = 1000.0
    curvature: Curvature = "tangent"
    length: float = 0.1
    rod_radius: float = 1e-3
    youngs_modulus: float = 1e9
    sphere_density: float = 7000.0
    middle_radius: float = 0.025
    viscosity: float = 1000.0
    gravity: float = 9.8

    @property
    def edge(self) -> float:
        """Rest length of every edge (m)."""
        return self.length / (self.nodes - 1)

    @property
    def middle(self) -> int:
        """Index of the middle node."""
        return self.nodes // 2

    def radii(self) -> Array:
        """Sphere radii, shape (N,) (m)."""
        radii = np.full(self.nodes, self.edge / 10.0)
        radii[self.middle] = self.middle_radius
        return radii

    def masses(self) -> Array:
        """Sphere masses, shape (N,) (kg)."""
        masses: Array = self.sphere_density * 4.0 / 3.0 * np.pi * self.radii() ** 3
        return masses

    def weights(self) -> Array:
        """Weight less buoyancy, downward, shape (N,) (N)."""
        share = 1.0 - self.fluid_density / self.sphere_density
        weights: Array = share * self.masses() * self.gravity
        return weights

    def drag(self) -> Array:
        """Stokes drag coefficients, shape (N,) (N s/m)."""
        drag: Array = 6.0 * np.pi * self.viscosity * self.radii()
        return drag

    def terminal_velocity(self) -> float:
        """Vertical velocity of the settled fall (m/s): weight and drag of all spheres in balance.

        -(2/9) (rho_s - rho_f) g sum(R^3) / (mu sum R); elastic forces cancel in the sum.
        """
        radii = self.radii()
        excess = self.sphere_density - self.fluid_density
        cubes, total = float(np.sum(radii**3)), float(np.sum(radii))
        return -2.0 / 9.0 * excess * self.gravity * cubes / (self.viscosity * total)

    def axial_noise(self, duration: float) -> float:
        """Rounding error of an axial force (N): EA/l times the rounding of a displacement."""
        stiffness = self.youngs_modulus * np.pi * self.rod_radius**2 / self.edge
        reach = self.length + abs(self.terminal_velocity()) * duration
        return float(stiffness * np.finfo(float).eps * reach)

    def elastic_gradient(self, u: NDArray[Any]) -> NDArray[Any]:
        """dE/du (N) for displacements `u`, shape (..., N, 2), real or complex."""
        area = np.pi * self.rod_radius**2
        inertia = np.pi * self.rod_radius**4 / 4.0
        length = self.edge
        du = u[..., 1:, :] - u[..., :-1, :]
        dx, dy = du[..., 0], du[..., 1]
        ex, ey = length + dx, dy
        norm = np.sqrt(ex * ex + ey * ey)
        strain = (2.0 * length * dx + dx * dx + dy * dy) / (length * (norm + length))
        tension = self.youngs_modulus * area * strain

        cross = ex[..., :-1] * ey[..., 1:] - ey[..., :-1] * ex[..., 1:]
        dot = ex[..., :-1] * ex[..., 1:] + ey[..., :-1] * ey[..., 1:]
        half = cross / (norm[..., :-1] * norm[..., 1:] + dot)  # tan(phi/2)
        if self.curvature == "tangent":
            kappa, slope = 2.0 * half, 1.0 + half * half
        else:
            kappa, slope = 2.0 * np.arctan(half), 1.0
        torque = self.youngs_modulus * inertia / length * kappa * slope  # dE/dphi, inner nodes

        # dE/de per edge: tension along it, and the torques through the edge's direction,
        # phi = angle(next) - angle(previous), d(angle)/de = (-ey, ex)/|e|^2.
        turn = np.zeros_like(ex)
        turn[..., 1:] += torque
        turn[..., :-1] -= torque
        per_edge = np.stack(
            [
                tension * ex / norm - turn * ey / norm**2,
                tension * ey / norm + turn * ex / norm**2,
            ],
            axis=-1,
        )
        gradient = np.zeros_like(u)
        gradient[..., 1:, :] += per_edge
        gradient[..., :-1, :] -= per_edge
        return gradient

    def elastic_hessian(self, u: Array) -> Array:
        """d2E/du2 (N/m) by complex step, all columns at once, shape (2N, 2N)."""
        size, step = u.size, 1e-40
        bumped = u + 1j * step * np.eye(size).reshape(size, *u.shape)
        columns = self.elastic_gradient(bumped).imag / step
        hessian: Array = columns.reshape(size, size).T
        return hessian


@dataclass(frozen=True)
class Fall:
    """Displacements and velocities at the asked times: shapes (T,), (T, N, 2), (T, N, 2)."""

    times: Array
    displacements: Array
    velocities: Array


def simulate(
    rod: FallingRod, times: Sequence[float] | Array, rtol: float = 1e-9, *, curve: bool = False
) -> Fall:
    """Integrate from rest at t = 0 and return the states at `times` (increasing, s).

    With `curve` the states at all times but the last are interpolated between the steps: quick
    for a thousand times, and good to about `rtol`.

    `rtol` also sets the absolute tolerances, in units of the rod's length (times 1e-3) and
    of its terminal speed (times 1e-3), so that the tiny early displacements count too; the
    speed tolerance stays above what rounding of the stiff axial forces does to speeds, else
    the step size fights rounding. Radau's estimate is pessimistic here: 1e-9 gives 13 digits.
    """
    count = 2 * rod.nodes
    masses = np.repeat(rod.masses(), 2)
    drag = np.repeat(rod.drag(), 2)
    load = np.zeros(count)
    load[1::2] = -rod.weights()

    def rate(_t: float, z: Array) -> Array:
        force = load - drag * z[count:] - rod.elastic_gradient(z[:count].reshape(-1, 2)).ravel()
        return np.concatenate([z[count:], force / masses])

    def jacobian(_t: float, z: Array) -> Array:
        out = np.zeros((2 * count, 2 * count))
        out[:count, count:] = np.eye(count)
        out[count:, :count] = -rod.elastic_hessian(z[:count].reshape(-1, 2)) / masses[:, None]
        out[count:, count:] = -np.diag(drag / masses)
        return out

    small = 1e-3 * rtol
    noise = 10.0 * rod.axial_noise(times[-1]) / float(rod.drag().min())
    atol = np.repeat([small * rod.length, max(small * abs(rod.terminal_velocity()), noise)], count)
    # One leg a time asked for, so that no interpolation error enters.
    state, start = np.zeros(2 * count), 0.0
    states: list[Array] = []
    for leg in [times] if curve else [[time] for time in times]:
        end = leg[-1]
        run = solve_ivp(
            rate, (start, end), state, method="Radau", jac=jacobian, rtol=rtol, atol=atol,
            t_eval=leg, first_step=min(1e-8, end - start) if start == 0.0 else None,
        )  # fmt: skip
        if not run.success:
            raise RuntimeError(f"falling rod, N={rod.nodes}: {run.message}")
        state, start = run.y[:, -1], end
        states.extend(run.y.T)
    table = np.array(states)
    shape = (len(table), rod.nodes, 2)
    return Fall(
        np.asarray(times, dtype=float),
        table[:, :count].reshape(shape),
        table[:, count:].reshape(shape),
    )


def equal_spheres(rod: FallingRod, radius: float, times: Sequence[float]) -> tuple[Array, Array]:
    """Height (m) and vertical velocity (m/s) of every node when all spheres have `radius`.

    Nothing bends: v = v_inf (1 - exp(-t/tau)), tau = m / (6 pi mu R) = 2 rho_s R^2 / (9 mu).
    """
    t = np.asarray(times, dtype=float)
    excess = rod.sphere_density - rod.fluid_density
    final = -2.0 / 9.0 * excess * rod.gravity * radius**2 / rod.viscosity
    tau = 2.0 * rod.sphere_density * radius**2 / (9.0 * rod.viscosity)
    decay = -np.expm1(-t / tau)
    return final * (t - tau * decay), final * decay


def _add(values: dict[str, Reference], rod: FallingRod, label: str, times: Sequence[float]) -> None:
    fine = simulate(rod, times, 1e-9)
    coarse = simulate(rod, times, 1e-8)
    mid = rod.middle
    for k, t in enumerate(times):
        for name, a, b, unit in (
            ("y_mid", fine.displacements, coarse.displacements, "m"),
            ("vy_mid", fine.velocities, coarse.velocities, "m/s"),
        ):
            values[f"{label}.{name}.t{t:g}"] = refined(a[k, mid, 1], b[k, mid, 1], unit, 1e-13)
        values[f"{label}.y_end.t{t:g}"] = refined(
            fine.displacements[k, 0, 1], coarse.displacements[k, 0, 1], "m", 1e-13
        )
        values[f"{label}.x_end.t{t:g}"] = refined(
            fine.displacements[k, 0, 0], coarse.displacements[k, 0, 0], "m", 1e-13
        )


QUOTED = {
    "n3.buoyant.tangent.y_mid.t0.01": (-7.37133e-5, 5e-11),
    "n3.buoyant.tangent.y_mid.t0.1": (-8.06707e-4, 5e-10),
    "n3.buoyant.tangent.y_mid.t1": (-7.94083e-3, 5e-9),
    "n3.buoyant.tangent.y_mid.t10": (-6.615386e-2, 5e-9),
    "n3.buoyant.tangent.vy_mid.t10": (-0.00596569, 5e-9),
    "terminal.n3.buoyant": (-0.0059267, 5e-8),
    "terminal.n21.buoyant": (-0.005834, 5e-7),
    "terminal.n21.dry": (-0.0068, 5e-5),
}


def references() -> Problem:
    """All reference numbers of the falling rod."""
    values: dict[str, Reference] = {}
    names = {1000.0: "buoyant", 0.0: "dry"}
    for density, name in names.items():
        for nodes in (3, 5, 21, 51):
            speed = FallingRod(nodes, density).terminal_velocity()
            values[f"terminal.n{nodes}.{name}"] = exact(speed, "m/s")
    long = (0.01, 0.1, 1.0, 10.0, 50.0)
    for density, name in names.items():
        for curvature in ("tangent", "angle"):
            for nodes in (3, 5, 21, 51):
                rod = FallingRod(nodes, density, curvature)
                label = f"n{nodes}.{name}.{curvature}"
                _add(values, rod, label, long if nodes == 3 else (1.0, 10.0, 50.0))
    for key, (number, error) in QUOTED.items():
        old = values[key]
        values[key] = Reference(old.value, old.error, old.unit, number, error)
    return Problem(
        "falling_spheres",
        "N-node falling rod, displacement of nodes from the straight horizontal start at rest; "
        "'buoyant' has fluid density 1000 kg/m3, 'dry' 0; end node is node 0",
        "semi-discrete ODE, Radau IIA order 5, rtol 1e-9; error: twice the change from rtol "
        "1e-8. Terminal velocity: exact force balance",
        values,
    )
