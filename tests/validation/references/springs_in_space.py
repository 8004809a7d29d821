"""A rod in space that springs hold against turning, soft about one axis and stiff about another.

The rod of `kirchhoff_rod.py`, drawn straight along x with d1 = y, d2 = z, carries a dead force at
its end. Its start is at rest, clamped or on a spring; more springs are along it. A spring measures
the rotation z of a section from the drawn one by the angle between the two tangents, towards the
directors of half the twist, and by the twist itself (docs/space.md), and has the energy
1/2 z . K z. On the section it exerts the opposite of M = dE/d(rotation), by which the moment of
the rod jumps. A moment of a load may act on the same section, fixed in space or turning with it.

Multiple shooting with rotation matrices: the unknowns are K z of all springs, which stays of the
size of the loads for springs of any stiffness, and the moment at a clamped start; the conditions
are that the section at each spring has its z, and that no moment is left at the end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .kirchhoff_rod import UPRIGHT, Rod, constant, march, rotation
from .record import Array, Problem, Reference, refined

# EI1 of a scene resists bending towards d1, which turns about d2.
TOWARDS_FIRST, TOWARDS_SECOND, TWISTING, STRETCHING = 1.0, 0.3, 0.4, 1e6
RIGID = 1e7
STEPS = 4


@dataclass(frozen=True)
class Spring:
    """Stiffnesses towards d1, towards d2 and about the tangent, at an arc length; a moment there,
    in the axes of the drawn shape."""

    place: float
    stiffness: tuple[float, float, float]
    moment: tuple[float, float, float] = (0.0, 0.0, 0.0)
    follows: bool = False

    def load(self, section: Array, share: float) -> Array:
        """The moment [N m] on the section."""
        drawn = share * np.asarray(self.moment)
        return section @ UPRIGHT.T @ drawn if self.follows else drawn


@dataclass(frozen=True)
class Case:
    """A rod of length 1; `natural`: curvatures towards d1 and d2, and twist."""

    springs: tuple[Spring, ...]
    force: tuple[float, float, float]
    clamped: bool = False
    natural: tuple[float, float, float] = (0.0, 0.0, 0.0)


CASES = {
    "twisting": Case((Spring(0.0, (RIGID, RIGID, 0.5)),), (0.0, -0.4, -0.5)),
    "bending": Case((Spring(0.0, (0.5, RIGID, RIGID)),), (0.0, -0.4, -0.5)),
    "soft": Case((Spring(0.0, (2.0, 24.0, 5.0)),), (0.2, -0.8, -1.0), natural=(0.6, -0.4, 1.1)),
    "ends": Case(
        (Spring(0.0, (RIGID, 0.4, 3.0)), Spring(1.0, (5.0, RIGID, 0.6))), (0.1, -0.6, 0.5)
    ),
    "inside": Case((Spring(0.5, (0.4, 30.0, RIGID)),), (0.0, 2.0, -1.5), clamped=True),
    "moment": Case((Spring(0.0, (6.0, 24.0, 4.0), (1.5, -2.0, 2.5)),), (0.2, -0.4, -0.5)),
    "moment that follows": Case(
        (
            Spring(0.0, (12.0, 5.0, 4.0), (-2.0, 1.5, 2.5), follows=True),
            Spring(1.0, (5.0, RIGID, 3.0), (0.6, 0.4, -0.8), follows=True),
        ),
        (0.1, -0.6, 0.5),
    ),
    "moment inside": Case(
        (Spring(0.5, (4.0, 30.0, 6.0), (1.0, -0.8, 1.2)),), (0.0, 0.6, -0.5), clamped=True
    ),
}


def turned(drawn: Array, z: Array) -> Array:
    """The section (columns d1, d2, d3) at the rotation z from the drawn one."""
    half = rotation(drawn[:, 2], 0.5 * float(z[2])) @ drawn
    bend = np.cross(drawn[:, 2], z[0] * half[:, 0] + z[1] * half[:, 1])
    angle = float(np.linalg.norm(bend))
    twisted = rotation(drawn[:, 2], float(z[2])) @ drawn
    return twisted if angle == 0.0 else rotation(bend / angle, angle) @ twisted


def rotation_between(drawn: Array, section: Array) -> Array:
    """z of a section, twisted by less than half a turn."""
    axis = np.cross(drawn[:, 2], section[:, 2])
    sine, cosine = float(np.linalg.norm(axis)), float(drawn[:, 2] @ section[:, 2])
    angle = np.arctan2(sine, cosine)
    back = drawn if sine == 0.0 else rotation(axis / sine, angle) @ drawn
    twist = np.arctan2(back[:, 1] @ section[:, 0], back[:, 0] @ section[:, 0])
    half = rotation(drawn[:, 2], 0.5 * float(twist)) @ drawn
    share = 1.0 if sine == 0.0 else angle / sine
    return np.array([*(share * (half[:, :2].T @ section[:, 2])), twist])


def moment_of(drawn: Array, section: Array, load: Array) -> Array:
    """dE/d(rotation) along fixed axes of a spring with K z = `load`: sixth-order differences of z,
    with an error of about 1e-11."""

    def slope(axis: Array, step: float = 1e-2) -> Array:
        def z(times: int) -> Array:
            return rotation_between(drawn, rotation(axis, times * step) @ section)

        far = 45.0 * (z(1) - z(-1)) - 9.0 * (z(2) - z(-2)) + (z(3) - z(-3))
        return np.asarray(far / (60.0 * step), dtype=float)

    return np.array([slope(axis) @ load for axis in np.eye(3)])


@dataclass(frozen=True)
class Section:
    """A section of the rod with the moment before its spring, or beyond that at the start."""

    position: Array
    frame: Array
    moment: Array

    def components(self) -> Array:
        """moment_1, moment_2 and torque, as a scene has them."""
        about = self.frame.T @ self.moment
        return np.array([about[1], -about[0], about[2]])


def shoot(
    case: Case, unknowns: Array, share: float, tolerance: float
) -> tuple[Array, list[Section]]:
    """The errors of the conditions, and the sections at both ends and at the springs."""
    force = share * np.asarray(case.force)
    curvature_1, curvature_2, twist = case.natural
    natural = constant(-curvature_2, curvature_1, twist)
    missing: list[Array] = []
    position, frame, moment = np.zeros(3), UPRIGHT, unknowns[0]
    springs, loads = list(case.springs), list(unknowns[1:])
    if not case.clamped:
        first = springs.pop(0)
        frame = turned(UPRIGHT, unknowns[0] / np.array(first.stiffness))
        moment = moment_of(UPRIGHT, frame, unknowns[0]) - first.load(frame, share)
    sections = [Section(position, frame, moment)]
    place = 0.0
    for to in [*(spring.place for spring in springs), 1.0]:
        if to > place:
            part = Rod(to - place, (TOWARDS_SECOND, TOWARDS_FIRST), TWISTING, STRETCHING, natural)
            start = np.concatenate([position, frame.ravel(), force @ frame, moment @ frame])
            last = march(part, np.zeros(3), start, tolerance)
            position, frame = last[:3], last[3:12].reshape(3, 3)
            moment = frame @ last[15:18]
            place = to
        sections.append(Section(position, frame, moment))
        if springs:
            spring, load = springs.pop(0), loads.pop(0)
            missing.append(rotation_between(UPRIGHT, frame) - load / np.array(spring.stiffness))
            moment = moment + moment_of(UPRIGHT, frame, load) - spring.load(frame, share)
    return np.concatenate([*missing, moment]), sections


def solve(case: Case, tolerance: float) -> list[Section]:
    """The equilibrium that grows from the unloaded rod."""
    count = len(case.springs) + int(case.clamped)
    found, before = np.zeros(3 * count), np.zeros(3 * count)
    for share in np.arange(1, STEPS + 1) / STEPS:

        def miss(x: Array, share: float = float(share)) -> Array:
            return shoot(case, x.reshape(-1, 3), share, tolerance)[0]

        trial = 2.0 * found - before
        for _ in range(8):
            gap = miss(trial)
            slopes = [(miss(trial + 1e-6 * unit) - gap) / 1e-6 for unit in np.eye(3 * count)]
            trial = trial - np.linalg.solve(np.column_stack(slopes), gap)
            if np.abs(gap).max() < 1e-11:
                break
        before, found = found, trial
    return shoot(case, found.reshape(-1, 3), 1.0, tolerance)[1]


def references() -> Problem:
    """Tips, and moments at springs at the ends."""
    values: dict[str, Reference] = {}
    for name, case in CASES.items():
        fine, coarse = solve(case, 1e-12), solve(case, 1e-9)

        def add(
            label: str,
            quantities: tuple[str, ...],
            of: Callable[[list[Section]], Array],
            unit: str,
            name: str = name,
            both: tuple[list[Section], list[Section]] = (fine, coarse),
        ) -> None:
            numbers = zip(quantities, of(both[0]), of(both[1]), strict=True)
            for quantity, value, other in numbers:
                values[f"{name}.{label}.{quantity}"] = refined(
                    float(value), float(other), unit, floor=1e-9
                )

        add("end", ("x", "y", "z"), lambda found: found[-1].position, "length")
        moments = ("moment_1", "moment_2", "torque")
        if not case.clamped:
            add("start", moments, lambda found: found[0].components(), "moment")
        if case.springs[-1].place == 1.0:
            # The section at the spring comes before that at the end, which lies beyond it.
            add("end", moments, lambda found: found[-2].components(), "moment")
    return Problem(
        "springs_in_space",
        "rod of length 1 along x, director y, EI1 1, EI2 0.3, GJ 0.4, EA 1e6, a dead force at its "
        "end; springs against turning and loads of each case in the module",
        "multiple shooting with rotation matrices (DOP853); error: twice the change from the "
        "tolerance 1e-9 to 1e-12",
        values,
    )
