"""Equilibria of the spatial rod that stretches, bends and twists, but does not shear.

With s the rest arc length, d1, d2, d3 the section's frame (d3 the tangent) and u its rate of
turning, d_i' = (u1 d1 + u2 d2 + u3 d3) x d_i, the energy a rest length is

    1/2 EI1 (u1 - k1)^2 + 1/2 EI2 (u2 - k2)^2 + 1/2 GJ (u3 - k3)^2 + 1/2 EA eps^2,

where k is the natural value of u, and EI1 resists turning about d1. Equilibrium under a dead load
f a rest length, n and m being the force and the moment that the part beyond s exerts on the part
before it (Antman, Nonlinear Problems of Elasticity, ch. VIII):

    r' = (1 + n.d3/EA) d3     n' = -f     m' = n x r'     u_i = k_i + m.d_i/K_i

(with shear, r' = d3 + (n.d1/GA) d1 + (n.d2/GA) d2 + (n.d3/EA) d3).

A unit quaternion q = (w, x, y, z) holds the frame: q' = 1/2 q (0, u1, u2, u3). The 13 unknowns
(r, q, n, m) are found by Chebyshev collocation (`collocation.py`) in units of the rod's length
and of EI1. A second formulation checks each solution (`shooting_error`): rotation matrix
instead of quaternion, components along d_i instead of fixed axes, DOP853 and Newton on the
wrench at the start instead of collocation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from scipy.integrate import solve_ivp

from .collocation import Boundary, Numbers, Rate, Solution, constant_start
from .record import Array, Reference

Vector: TypeAlias = Sequence[float] | Array
Wrench: TypeAlias = Callable[[Numbers, float], Numbers]
"""Force and moment (6 numbers, fixed axes) on a section with the frame d, columns d1, d2, d3, at a
share of the loads."""
Inside: TypeAlias = Sequence[tuple[int, Vector | Wrench]]
"""Loads inside a rod, each at the border with that number between segments, from 0 on: a dead
force, or a wrench."""
UPRIGHT = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Frame of a rod along x: columns d1 = y, d2 = z, d3 = x."""


def cross(a: Numbers, b: Numbers) -> Numbers:
    """a x b along the first axis; complex numbers as real ones."""
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def directors(q: Numbers) -> Numbers:
    """Frames of quaternions (4, ...): [i, k] is component i of d_(k+1), shape (3, 3, ...)."""
    w, x, y, z = q
    return np.stack(
        [
            np.stack([w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)]),
            np.stack([2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)]),
            np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]),
        ]
    )


def quaternion(frame: Array) -> Array:
    """Unit quaternion of a frame (columns d1, d2, d3), w >= 0."""
    trace = frame.trace()
    squares = np.array([1.0 + trace, *(1.0 + 2.0 * np.diag(frame) - trace)]) / 4.0
    k = int(np.argmax(squares))
    skew = np.array(
        [frame[2, 1] - frame[1, 2], frame[0, 2] - frame[2, 0], frame[1, 0] - frame[0, 1]]
    )
    if k == 0:
        q = np.array([squares[0], *(skew / 4.0)])
    else:
        q = np.array([skew[k - 1] / 4.0, *((frame[k - 1] + frame[:, k - 1]) / 4.0)])
        q[k] = squares[k]
    q = q / np.linalg.norm(q)
    return np.asarray(q if q[0] >= 0.0 else -q, dtype=float)


def rotation(axis: Vector, angle: float) -> Array:
    """Matrix that turns vectors about the unit vector `axis` by `angle` (rad)."""
    e = np.asarray(axis, dtype=float)
    matrix = np.array([[0.0, -e[2], e[1]], [e[2], 0.0, -e[0]], [-e[1], e[0], 0.0]])
    turned: Array = np.eye(3) + np.sin(angle) * matrix + (1.0 - np.cos(angle)) * matrix @ matrix
    return turned


def turn(q: Numbers, u: Numbers) -> Numbers:
    """1/2 q (0, u): the rate of a quaternion whose frame turns at u, along d_i."""
    w, x, y, z = q
    a, b, c = u
    return 0.5 * np.stack(
        [
            -x * a - y * b - z * c,
            w * a + y * c - z * b,
            w * b + z * a - x * c,
            w * c + x * b - y * a,
        ]
    )


@dataclass(frozen=True)
class Held:
    """A clamped end: position and frame (columns d1, d2, d3)."""

    position: Vector
    frame: Array


@dataclass(frozen=True)
class HeldTangent:
    """An end whose position and tangent (a unit vector) are held, but not its turn about that: a
    torque acts there."""

    position: Vector
    tangent: Vector
    torque: float = 0.0


@dataclass(frozen=True)
class Loaded:
    """A free end with a dead force, a dead moment (fixed axes) and a moment that follows the
    section (components along d1, d2, d3).
    """

    force: Vector = (0.0, 0.0, 0.0)
    moment: Vector = (0.0, 0.0, 0.0)
    follower: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Rod:
    """A uniform rod of rest length `length`; `natural(s)` is k, shape (3, len(s)), along d_i."""

    length: float
    bending: tuple[float, float]  # EI1, EI2
    twisting: float  # GJ
    stretching: float = np.inf  # EA
    natural: Callable[[Array], Array] = lambda s: np.zeros((3, len(s)))
    shearing: float = np.inf  # GA, to see what neglecting shear changes

    @property
    def stiffness(self) -> Array:
        """EI1, EI2, GJ."""
        return np.array([*self.bending, self.twisting])

    @property
    def compliance(self) -> Array:
        """1/GA, 1/GA, 1/EA."""
        return 1.0 / np.array([self.shearing, self.shearing, self.stretching])

    @property
    def units(self) -> Array:
        """Units of the 13 unknowns: length, 1, EI1/length^2, EI1/length."""
        force = self.bending[0] / self.length**2
        sizes = [self.length, 1.0, force, force * self.length]
        return np.repeat(sizes, [3, 4, 3, 3])


def constant(k1: float, k2: float, k3: float) -> Callable[[Array], Array]:
    """Natural curvatures and twist that do not change along the rod."""
    return lambda s: np.repeat(np.array([[k1], [k2], [k3]]), len(s), axis=1)


def problem(
    rod: Rod,
    start: Held,
    end: Held | HeldTangent | Loaded,
    weight: Vector = (0, 0, 0),
    inside: Inside = (),
    share: float = 1.0,
) -> Boundary:
    """The boundary value problem in the units of `rod.units`; `weight` is f, and the loads inside
    are at this share.
    """
    first = np.concatenate([np.asarray(start.position) / rod.length, quaternion(start.frame)])

    def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
        joints = right[:-1] - left[1:]
        for border, load in inside:
            if callable(load):
                wrench = load(directors(right[border, 3:7]), share)
                joints[border, 7:] -= wrench / rod.units[7:]
            else:
                joints[border, 7:10] -= share * np.asarray(load) / rod.units[7]
        joints = joints.ravel()
        return np.concatenate([left[0, :7] - first, _end(rod, end, right[-1]), joints])

    return Boundary(rates(rod, weight), ends)


def rates(rod: Rod, weight: Vector) -> Rate:
    """y' of the 13 unknowns by the share of the length, in the units of `rod.units`."""
    length = rod.length
    stiffness = (rod.stiffness / rod.bending[0])[:, None]
    compliance = rod.compliance[:, None] * rod.bending[0] / length**2
    load = np.asarray(weight, dtype=float)[:, None] * length**3 / rod.bending[0]

    def rate(_k: int, s: Array, y: Numbers, _p: Numbers) -> Numbers:
        q, n, m = y[3:7], y[7:10], y[10:13]
        d = directors(q)
        slope = d[:, 2] + (d * compliance * (n[:, None] * d).sum(axis=0)).sum(axis=1)
        u = rod.natural(s * length) * length + (m[:, None] * d).sum(axis=0) / stiffness
        return np.concatenate([slope, turn(q, u), np.broadcast_to(-load, n.shape), cross(n, slope)])

    return rate


def _end(rod: Rod, end: Held | HeldTangent | Loaded, y: Numbers) -> Numbers:
    """The six conditions at the end s = length."""
    d = directors(y[3:7])
    if isinstance(end, Held):
        # The frames agree if d_i . e_k is symmetric (and its trace positive).
        product = np.asarray(end.frame).T @ d
        skew = [product[2, 1] - product[1, 2], product[0, 2] - product[2, 0]]
        skew.append(product[1, 0] - product[0, 1])
        return np.concatenate([y[:3] - np.asarray(end.position) / rod.length, np.stack(skew)])
    if isinstance(end, HeldTangent):
        # The tangent lies across two directions.
        across = np.linalg.svd(np.asarray(end.tangent, dtype=float)[None])[2][1:]
        torque = (y[10:13] * d[:, 2]).sum() - end.torque / rod.units[10]
        turns = np.concatenate([across @ d[:, 2], torque[None]])
        return np.concatenate([y[:3] - np.asarray(end.position) / rod.length, turns])
    force = np.asarray(end.force) / rod.units[7]
    moment = (np.asarray(end.moment) + 0.0) / rod.units[10]
    follower = np.asarray(end.follower) / rod.units[10]
    return np.concatenate([y[7:10] - force, y[10:13] - moment - d @ follower])


@dataclass(frozen=True)
class Equilibrium:
    """A solution: the rod, its problem, and the collocation solution in the rod's units."""

    rod: Rod
    boundary: Boundary
    solution: Solution
    weight: Array

    def at(self, s: Array) -> Array:
        """(r, q, n, m) at rest arc lengths `s`, shape (13, len(s))."""
        values = self.solution.at(np.asarray(s, dtype=float) / self.rod.length)
        return np.asarray(values * self.rod.units[:, None], dtype=float)

    @property
    def tip(self) -> Array:
        """Position of the end s = length."""
        return np.asarray(self.solution.values[-1, :3, -1] * self.rod.length, dtype=float)

    @property
    def tip_frame(self) -> Array:
        """Frame at the end s = length, columns d1, d2, d3."""
        return np.asarray(directors(self.solution.values[-1, 3:7, -1]), dtype=float)

    def strains(self, s: Array) -> Array:
        """u1, u2, u3 and eps at rest arc lengths `s`, shape (4, len(s))."""
        values = self.at(s)
        d = directors(values[3:7])
        m = (values[10:13, None] * d).sum(axis=0)
        u = self.rod.natural(np.asarray(s)) + m / self.rod.stiffness[:, None]
        stretch = (values[7:10] * d[:, 2]).sum(axis=0) / self.rod.stretching
        return np.vstack([u, stretch])

    def shooting_error(self) -> float:
        """Distance of a second solution at the tip, and of its frame times the length."""
        position, frame, _ = shoot(self)
        gap = np.abs(position - self.tip).max()
        return float(max(gap, self.rod.length * np.abs(frame - self.tip_frame).max()))


def natural_shape(rod: Rod, start: Held, breaks: Array, degree: int) -> Solution:
    """The unloaded rod from its clamp, a start for Newton."""
    empty = constant_start(breaks, np.zeros(13), np.zeros(0), degree)
    first = np.concatenate([np.asarray(start.position) / rod.length, quaternion(start.frame)])

    def slope(s: float, y: Array) -> Array:
        u = rod.natural(np.array([s * rod.length]))[:, 0] * rod.length
        return np.concatenate([directors(y[3:7])[:, 2], turn(y[3:7], u)])

    places = empty.points().ravel()
    run = solve_ivp(
        slope, (0.0, 1.0), first, method="DOP853", t_eval=np.unique(places), rtol=1e-12, atol=1e-14
    )
    order = np.searchsorted(run.t, places)
    empty.values[:, :7] = run.y[:, order].reshape(7, len(breaks) - 1, -1).swapaxes(0, 1)
    return empty


def solve(
    rod: Rod,
    start: Held,
    end: Held | HeldTangent | Loaded,
    guess: Solution,
    weight: Vector = (0.0, 0.0, 0.0),
    inside: Inside = (),
    share: float = 1.0,
) -> Equilibrium:
    """The equilibrium near `guess`."""
    boundary = problem(rod, start, end, weight, inside, share)
    load = np.asarray(weight, dtype=float)
    return Equilibrium(rod, boundary, boundary.solve(guess, tolerance=1e-11), load)


def follow(
    rod: Rod,
    start: Held,
    end: Callable[[float], Held | HeldTangent | Loaded],
    steps: int,
    weight: Vector = (0.0, 0.0, 0.0),
    segments: int | Array = 3,
    degree: int = 24,
    inside: Inside = (),
) -> Equilibrium:
    """The equilibrium reached from the natural shape when `end(share)`, `share * weight` and that
    share of the loads `inside` go from share 0 to 1 in `steps` steps.

    `segments`: their number, or their borders as shares of the length, the ends among them.
    Shooting, and so `checked`, does not know the loads inside.
    """
    borders = np.linspace(0.0, 1.0, segments + 1) if isinstance(segments, int) else segments
    solution = natural_shape(rod, start, borders, degree)
    previous = solution
    load = np.asarray(weight, dtype=float)
    for share in np.arange(1, steps + 1) / steps:
        ahead = replace(solution, values=2.0 * solution.values - previous.values)
        previous = solution
        part = float(share)
        found = solve(rod, start, end(part), ahead, part * load, inside, part)
        solution = found.solution
    return found


def refine(equilibrium: Equilibrium, degree: int) -> Equilibrium:
    """The same equilibrium with another degree."""
    solution = equilibrium.boundary.solve(equilibrium.solution.resampled(degree), tolerance=1e-11)
    return replace(equilibrium, solution=solution)


@dataclass(frozen=True)
class Checked:
    """An equilibrium with the bar of its lengths: the larger of twice the change from the given
    degree to 1.4 times of it, the distance to the solution by shooting, and rounding.
    """

    equilibrium: Equilibrium
    coarse: Equilibrium
    error: float

    @property
    def angle_error(self) -> float:
        """Bar of angles and of components of unit vectors."""
        return self.error / self.equilibrium.rod.length

    def point(self, s: float | None = None, unit: str = "length") -> list[Reference]:
        """x, y, z at rest arc length `s` (default: at the end)."""
        r = self.equilibrium.tip if s is None else self.equilibrium.at(np.array([s]))[:3, 0]
        return [Reference(float(x), self.error, unit) for x in r]


def checked(equilibrium: Equilibrium) -> Checked:
    """Refine an equilibrium and compare it with itself and with shooting."""
    degree = equilibrium.solution.values.shape[2] - 1
    fine = refine(equilibrium, int(1.4 * degree))
    s = np.linspace(0.0, 1.0, 33) * fine.rod.length
    change = 2.0 * float(np.abs(fine.at(s)[:3] - equilibrium.at(s)[:3]).max())
    error = max(change, fine.shooting_error(), 1e-13 * fine.rod.length)
    return Checked(fine, equilibrium, error)


def march(rod: Rod, weight: Array, first: Numbers, tolerance: float = 1e-12) -> Numbers:
    """Position, rotation matrix, force and moment along d_i at the end, from those at the start:
    (r, D by rows, n.d_i, m.d_i), 18 numbers, in the units of the caller.
    """
    stiffness, compliance = rod.stiffness, rod.compliance

    def rate(s: float, y: Numbers) -> Numbers:
        d, n, m = y[3:12].reshape(3, 3), y[12:15], y[15:18]
        u = rod.natural(np.array([s]))[:, 0] + m / stiffness
        slope = compliance * n + np.array([0.0, 0.0, 1.0])
        spin = np.array([[0.0 * u[0], -u[2], u[1]], [u[2], 0.0 * u[0], -u[0]], [-u[1], u[0], 0.0]])
        force = -cross(u, n) - weight @ d
        moment = -cross(u, m) - cross(slope, n)
        return np.concatenate([d @ slope, (d @ spin).ravel(), force, moment])

    run = solve_ivp(
        rate, (0.0, rod.length), first, method="DOP853", rtol=tolerance, atol=1e-2 * tolerance
    )
    return np.asarray(run.y[:, -1])


def shoot(equilibrium: Equilibrium, iterations: int = 6) -> tuple[Array, Array, Array]:
    """Tip position, tip frame and Jacobian (6, 6) of the end's conditions by the wrench at the
    start, of the solution found by shooting from the start in the rod's own units.
    """
    rod = equilibrium.rod
    scaled = replace(
        rod,
        length=1.0,
        bending=(1.0, rod.bending[1] / rod.bending[0]),
        twisting=rod.twisting / rod.bending[0],
        stretching=rod.stretching * rod.length**2 / rod.bending[0],
        shearing=rod.shearing * rod.length**2 / rod.bending[0],
        natural=lambda s: rod.natural(s * rod.length) * rod.length,
    )
    load = equilibrium.weight * rod.length**3 / rod.bending[0]
    y = equilibrium.solution.values[0, :, 0]
    frame = directors(y[3:7])
    wrench = np.concatenate([y[7:10] @ frame, y[10:13] @ frame])
    fixed = np.concatenate([y[:3], frame.ravel()])

    def miss(trial: Numbers) -> tuple[Numbers, Numbers]:
        last = march(scaled, load, np.concatenate([fixed, trial]))
        d = last[3:12].reshape(3, 3)
        unknowns = np.concatenate([last[:3], _quaternion_of(d), d @ last[12:15], d @ last[15:18]])
        left, right = np.zeros((1, 13), dtype=complex), unknowns[None]
        return equilibrium.boundary.ends(left, right, np.zeros(0))[7:13], last

    jacobian = np.empty((6, 6))
    for _ in range(iterations):
        for k in range(6):
            bump = wrench.astype(complex)
            bump[k] += 1e-30j
            jacobian[:, k] = miss(bump)[0].imag / 1e-30
        gap, last = miss(wrench + 0j)
        step = np.linalg.solve(jacobian, -gap.real)
        wrench = wrench + step
        if np.abs(step).max() < 1e-10 * max(1.0, float(np.abs(wrench).max())):
            break
    last = miss(wrench + 0j)[1].real
    return last[:3] * rod.length, last[3:12].reshape(3, 3), jacobian


def _quaternion_of(frame: Numbers) -> Numbers:
    """Quaternion of a frame, of any sign, for real frames and for their complex bumps."""
    real = quaternion(frame.real)
    # q = 1/4 (sum of E_k frame) is linear in the frame: project it on the real quaternion.
    spin = frame.real.T @ frame.imag  # skew
    u = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    return np.asarray(real + 1j * turn(real, u))
