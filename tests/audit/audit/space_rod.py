"""Equilibria of rods in space that supports, loads and corners divide into parts: collocation.

The equations along a part, the unknowns and the units are those of
`tests/validation/references/kirchhoff_rod.py`, for a rod of length 1. A part ends at an end of the
rod, at a corner, and where something holds or loads the rod. A ring is a rod whose last part goes
on in its first one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from references.bent_wire import Leg
from references.collocation import Boundary, Numbers, Solution, moved
from references.kirchhoff_rod import (
    Equilibrium,
    Rod,
    cross,
    directors,
    quaternion,
    rates,
    rotation,
)

from .rod import Array

_ALONG = (0.0, 0.0, 1.0)
_STEP = 1e-40  # of derivatives along the imaginary axis
_LONGEST = 0.4  # parts of a solution


def _zero() -> Array:
    return np.zeros(3)


@dataclass(frozen=True)
class Drawn:
    """The shape as it is drawn: legs that meet at corners, from the origin on. ``frame`` has the
    directors and the tangent at the start in its columns; sections turn by ``twist`` a length.
    """

    legs: Sequence[Leg]
    frame: Array
    twist: float = 0.0
    closed: bool = False

    @property
    def starts(self) -> Array:
        """Where the legs start, and the end."""
        return np.concatenate([[0.0], np.cumsum([leg.length for leg in self.legs])])

    def pose(self, s: float, side: int = 1) -> tuple[Array, Array]:
        """Position and section; at a corner before it (``side`` -1) or after it."""
        starts = self.starts
        far = len(self.legs) - 1
        number = int(np.clip(np.searchsorted(starts, s + 1e-12 * side, side="right") - 1, 0, far))
        position, frame = np.zeros(3), self.frame
        for k, leg in enumerate(self.legs[: number + 1]):
            frame = rotation(*leg.corner) @ frame
            along = leg.length if k < number else s - float(starts[k])
            position = position + leg.chord(along, frame[:, 2])
            frame = leg.turned(along) @ frame
        return position, np.asarray(frame @ rotation(_ALONG, self.twist * s))

    def turning(self, s: Array) -> Array:
        """Rates at which the sections turn about d1, d2 and the tangent, shape (3, len(s))."""
        number = np.searchsorted(self.starts, s, side="right") - 1
        number = np.clip(number, 0, len(self.legs) - 1)
        about_1, about_2, _ = self._bends[number].T
        angle = self.twist * (s - self.starts[number])
        c, d = np.cos(angle), np.sin(angle)
        return np.stack(
            [c * about_1 + d * about_2, c * about_2 - d * about_1, np.full(len(s), self.twist)]
        )

    @cached_property
    def _bends(self) -> Array:
        """Vectors about which the legs bend, among the directors at their starts; they stay there
        among directors without twist.
        """
        poses = [self.pose(float(start)) for start in self.starts[:-1]]
        bends = [section.T @ leg.bent for (_, section), leg in zip(poses, self.legs, strict=True)]
        return np.array(bends)

    def points(self, edges: int) -> Array:
        """Even nodes; that at the end of a ring is its first one, and is left out."""
        count = edges if self.closed else edges + 1
        return np.array([self.pose(k / edges)[0] for k in range(count)])


@dataclass
class Place:
    """The supports and loads of the rod at a place. Vectors along fixed axes; those of loads that
    follow as they are in the drawn shape.
    """

    s: float
    hold: Literal["", "clamp", "bearing"] = ""  # a bearing lets the section turn in it
    shift: Array = field(default_factory=_zero)  # of a clamp
    turn: tuple[Sequence[float], float] = (_ALONG, 0.0)  # of a clamp: unit vector, angle
    twist: float = 0.0  # of a clamp, about its tangent
    force: Array = field(default_factory=_zero)
    moment: Array = field(default_factory=_zero)
    following_force: Array = field(default_factory=_zero)
    following_moment: Array = field(default_factory=_zero)
    spring: Array = field(default_factory=_zero)  # along the axes
    turning_spring: Array = field(default_factory=_zero)  # towards d1, towards d2, about d3


@dataclass(frozen=True)
class _Border:
    """A place as the parts beside it see it, at a share of the motions and loads."""

    place: Place
    share: float
    position: Array
    before: Array
    """Drawn section before the place, and after it: at a corner they differ."""
    after: Array

    @cached_property
    def corner(self) -> Array:
        """The rotation from the section before the place to that after it, along the former's axes,
        as a quaternion.
        """
        return quaternion(self.before.T @ self.after)

    @cached_property
    def held(self) -> tuple[Array, Array, Array]:
        """Position that a clamp holds, and sections before and after it, as quaternions."""
        axis, angle = self.place.turn
        turned = rotation(axis, self.share * angle)
        spun = rotation(_ALONG, self.share * self.place.twist)
        before, after = (quaternion(turned @ drawn @ spun) for drawn in (self.before, self.after))
        return self.position + self.share * self.place.shift, before, after

    @cached_property
    def _back(self) -> Array:
        """The rotation from the drawn section, as a quaternion."""
        return _conjugate(quaternion(self.after))

    def turned(self, q: Numbers) -> tuple[Any, Numbers]:
        """Energy of the spring against turning at the section ``q``, and its moment along the drawn
        axes.
        """
        return _turning(_product(self._back, q), self.place.turning_spring)

    def wrench(self, y: Numbers) -> Numbers:
        """Force and moment on the rod where its state is ``y``, after the place."""
        place, share = self.place, self.share
        force, moment = share * place.force, share * place.moment
        if place.following_force.any() or place.following_moment.any():
            carried = share * directors(y[3:7]) @ self.after.T
            force = force + carried @ place.following_force
            moment = moment + carried @ place.following_moment
        force = force - place.spring * (y[:3] - self.position)
        if place.turning_spring.any():
            moment = moment - self.after @ self.turned(y[3:7])[1]
        return np.concatenate([force, moment])


def _product(a: Numbers, b: Numbers) -> Numbers:
    """The product of two quaternions."""
    vector = a[0] * b[1:] + b[0] * a[1:] + cross(a[1:], b[1:])
    return np.concatenate([[a[0] * b[0] - (a[1:] * b[1:]).sum()], vector])


def _conjugate(q: Numbers) -> Numbers:
    return np.concatenate([q[:1], -q[1:]])


def _turning(relative: Numbers, stiffness: Array) -> tuple[Any, Numbers]:
    """Energy of a spring against turning, and the moment dE/d(rotation) in the drawn axes.

    The quaternion (w, x, y, z) of the rotation from the drawn axes is one by ``twist`` about the
    tangent and then a swing of the tangent by an angle b: z/w = tan(twist/2) and (x^2 + y^2)^(1/2)
    = sin(b/2). In axes turned by half the twist the swing goes towards (y, -x).
    """
    w, x, y, z = relative if relative[0].real > 0 else -relative
    square = x * x + y * y
    cosine = np.sqrt(w * w + z * z)
    if abs(square) < 1e-12:
        times, slope = 2.0 + square / 3.0, -4.0 / 3.0
    else:
        sine = np.sqrt(square)
        times = 2.0 * np.arctan(sine / cosine) / sine  # b / sin(b/2)
        slope = (2.0 * cosine - times) / square  # its derivative by x is x slope
    swing = np.stack([times * y, -times * x])
    twist = 2.0 * np.arctan(z / w)
    k1, k2, kt = stiffness
    energy = 0.5 * (k1 * swing[0] ** 2 + k2 * swing[1] ** 2 + kt * twist**2)
    bend = k1 * swing[0] * y - k2 * swing[1] * x
    by_w = -2.0 * bend * w / cosine - 2.0 * kt * twist * z / cosine**2
    by_x = bend * x * slope - k2 * swing[1] * times
    by_y = bend * y * slope + k1 * swing[0] * times
    by_z = -2.0 * bend * z / cosine + 2.0 * kt * twist * w / cosine**2
    vector, by_vector = np.stack([x, y, z]), np.stack([by_x, by_y, by_z])
    # A rotation d changes the quaternion by 1/2 (0, d) times it.
    return energy, 0.5 * (w * by_vector - by_w * vector + cross(vector, by_vector))


@dataclass(frozen=True)
class Problem:
    """A rod of length 1 in its drawn shape, what it is without stress, its places and the dead
    force ``line`` a length.
    """

    rod: Rod  # its natural rates are those that it has when the loads are whole
    drawn: Drawn
    places: Sequence[Place]
    line: Array

    def follow(self, steps: int, degree: int) -> Equilibrium:
        """The equilibrium that grows from the drawn shape without stress, in so many steps."""
        borders = self._borders()
        solution = previous = self._start(borders, degree)
        for step in range(1, steps + 1):
            ahead = replace(solution, values=2.0 * solution.values - previous.values)
            previous = solution
            boundary = self._boundary(borders, step / steps)
            # Two iterations keep to the way; its end is solved for.
            solution = boundary.full_steps(ahead, 2 if step < steps else 5)
        return Equilibrium(self.rod, boundary, boundary.solve(solution, 1e-10), self.line)

    def spring_energy(self, solved: Equilibrium) -> float:
        """The energy of all springs."""
        total = 0.0
        for border in self._borders():
            place = border.place
            y = solved.at(np.array([border.place.s]))[:, 0]
            total += 0.5 * float(place.spring @ (y[:3] - border.position) ** 2)
            total += float(border.turned(y[3:7])[0])
        return total

    def _borders(self) -> list[_Border]:
        given = np.array([place.s for place in self.places])
        corners = [float(s) for s in self.drawn.starts if np.abs(given - s).min() > 1e-12]
        places = sorted([*self.places, *(Place(s) for s in corners)], key=lambda place: place.s)
        for a, b in pairwise([*places]):
            parts = int(np.ceil((b.s - a.s) / _LONGEST))
            places += [Place(a.s + k / parts * (b.s - a.s)) for k in range(1, parts)]
        borders = []
        for place in sorted(places, key=lambda place: place.s):
            position, after = self.drawn.pose(place.s)
            before = self.drawn.pose(place.s, -1)[1]
            if self.drawn.closed and place.s == 0.0:
                before = self.drawn.pose(1.0, -1)[1]
            borders.append(_Border(place, 1.0, position, before, after))
        return borders

    def _start(self, borders: Sequence[_Border], degree: int) -> Solution:
        """The drawn shape, without force and moment."""
        breaks = np.array([border.place.s for border in borders])
        start = Solution(breaks, np.zeros((len(breaks) - 1, 13, degree + 1)), np.zeros(0))
        for part, places in enumerate(start.points()):
            for k, s in enumerate(places):
                position, section = self.drawn.pose(float(s), -1 if k == degree else 1)
                q = quaternion(section)
                if k > 0 and q @ start.values[part, 3:7, k - 1] < 0.0:
                    q = -q
                start.values[part, :7, k] = [*position, *q]
        # Parts go on with the sign of those before them.
        for part, border in enumerate(borders[1:-1]):
            q = _product(start.values[part, 3:7, -1], border.corner)
            if q @ start.values[part + 1, 3:7, 0] < 0.0:
                start.values[part + 1, 3:7] *= -1.0
        return start

    def _boundary(self, borders: Sequence[_Border], share: float) -> _Chain:
        here = [replace(border, share=share) for border in borders]
        closed = self.drawn.closed

        def natural(s: Array) -> Array:
            drawn = self.drawn.turning(s)
            return np.asarray(drawn + share * (self.rod.natural(s) - drawn))

        joints = []
        for number, border in enumerate(here[:-1] if closed else here):
            before = number - 1 if number > 0 else (len(here) - 2 if closed else None)
            after = number if number < len(here) - 1 else None
            joins = not (closed and number == 0)
            joints.append(_Joint(before, after, border, self.rod.units[7:], joins))

        def ends(left: Numbers, right: Numbers, _p: Numbers) -> Numbers:
            return np.concatenate([joint.of(left, right) for joint in joints])

        rate = rates(replace(self.rod, natural=natural), share * self.line)
        return _Chain(rate, ends, joints)


@dataclass(frozen=True)
class _Joint:
    """The conditions between the parts before and after a border: 13 of them, 7 at the start of the
    rod, 6 at its end. A ring ``joins`` its parts at all borders but the first.
    """

    before: int | None
    after: int | None
    border: _Border
    units: Array
    joins: bool

    def of(self, left: Numbers, right: Numbers) -> Numbers:
        """The residuals, from the states at both ends of all parts."""
        before = None if self.before is None else right[self.before]
        after = None if self.after is None else left[self.after]
        return np.concatenate(self._rows(before, after))

    def _rows(self, before: Numbers | None, after: Numbers | None) -> list[Numbers]:
        border = self.border
        here = after if after is not None else before
        assert here is not None
        rows: list[Numbers] = []
        size = [] if after is None else [((after[3:7] ** 2).sum() - 1.0)[None]]
        if border.place.hold == "clamp":
            position, *sections = border.held
            for y, section in zip((before, after), sections, strict=True):
                if y is not None:
                    rows += [y[:3] - position, _apart(section, y[3:7])]
            return rows + size
        # Force and moment jump by what acts at the place.
        jump = border.wrench(here) / self.units
        for y, sign in ((after, 1.0), (before, -1.0)):
            jump = jump if y is None else jump + sign * y[7:]
        if border.place.hold == "bearing":
            rows += [y[:3] - border.position for y in (before, after) if y is not None]
            tangent = directors(here[3:7])[:, 2]
            rows += [border.after[:, :2].T @ tangent, (jump[3:] * tangent).sum()[None]]
        else:
            rows.append(jump)
            if before is not None and after is not None:
                rows.append(after[:3] - before[:3])
        if before is None or after is None:
            return rows + size
        expected = _product(before[3:7], border.corner)
        if self.joins:
            return [*rows, after[3:7] - expected]
        # The size of the quaternion is the same all around a ring, and a condition of its own.
        return [*rows, _apart(expected, after[3:7]), *size]


@dataclass(frozen=True)
class _Chain(Boundary):
    """Parts whose conditions are each of two neighbours: they take few derivatives."""

    joints: Sequence[_Joint]

    def full_steps(self, start: Solution, iterations: int) -> Solution:
        """After some iterations of Newton's method whose steps nothing shortens: on the way to the
        solution a rod that turns also stretches.
        """
        for _ in range(iterations):
            residual, jacobian = self.residual(start)
            start = moved(start, np.asarray(np.linalg.solve(jacobian, -residual), dtype=float))
        return start

    def _end_rows(self, trial: Solution) -> Array:
        _, m, points = trial.values.shape
        left, right = (trial.values[:, :, end].astype(complex) for end in (0, -1))
        blocks = []
        for joint in self.joints:
            columns = {}
            for states, part, end in ((left, joint.after, 0), (right, joint.before, points - 1)):
                if part is None:
                    continue
                for c in range(m):
                    states[part, c] += 1j * _STEP
                    place = (part * m + c) * points + end
                    columns[place] = joint.of(left, right).imag / _STEP
                    states[part, c] -= 1j * _STEP
            block = np.zeros((len(columns[place]), trial.values.size))
            for place, column in columns.items():
                block[:, place] = column
            blocks.append(block)
        return np.concatenate(blocks)


def _apart(q: Numbers, other: Numbers) -> Numbers:
    """Half the rotation between two sections, 0 for equal ones."""
    return _product(_conjugate(q), other)[1:]
