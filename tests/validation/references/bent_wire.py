"""A wire of legs that meet at corners, clamped at its start, under dead forces: shooting.

The equations are those of `kirchhoff_rod.py`. Force n and moment m go through a corner unchanged;
the section behind it is the one before it, turned by the corner's drawn rotation. The frame is a
rotation matrix with the columns d1, d2, d3 (the tangent); the unknown is the moment at the clamp,
and its condition that there is none at the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from .kirchhoff_rod import rotation
from .record import Array
from .springs_in_space import moment_of, rotation_between


@dataclass(frozen=True)
class Leg:
    """A straight leg or an arc, after a corner."""

    length: float
    corner: tuple[tuple[float, float, float], float]
    """Unit vector about which the drawn wire turns before the leg, and by how much [rad]."""
    bent: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Curvature of the drawn leg as a vector across it, about which it turns [1/m]."""

    def turned(self, along: float) -> Array:
        """How the leg has turned the drawn frame a length `along` from its start."""
        curvature = float(np.linalg.norm(self.bent))
        axis = np.array(self.bent) / curvature if curvature else np.array([0.0, 0.0, 1.0])
        return rotation(axis, curvature * along)

    def chord(self, along: float, tangent: Array) -> Array:
        """From the start of the leg to a point on it, as drawn."""
        curvature = float(np.linalg.norm(self.bent))
        if curvature == 0.0:
            return along * tangent
        inward = np.cross(self.bent, tangent) / curvature
        angle = curvature * along
        chord: Array = (np.sin(angle) * tangent + (1.0 - np.cos(angle)) * inward) / curvature
        return chord


@dataclass(frozen=True)
class Wire:
    """`frame`: d1, d2, d3 at the clamp; `stiffness`: EI1, EI2 towards d1 and d2, GJ, EA."""

    legs: Sequence[Leg]
    frame: Array
    stiffness: tuple[float, float, float, float]
    tip: tuple[float, float, float]
    inside: dict[int, tuple[float, tuple[float, float, float]]] = field(default_factory=dict)
    """Forces within legs, one each at most: where, as a share of the leg, and what."""
    natural: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Curvatures towards d1 and d2 and twist without stress, beyond those that are drawn."""
    springs: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    """Stiffnesses of springs against turning of the section that a leg starts with, as in
    `springs_in_space.py`."""

    def frames(self) -> list[Array]:
        """Drawn frame at the start of each leg."""
        frames, frame = [], np.asarray(self.frame)
        for leg in self.legs:
            frame = rotation(*leg.corner) @ frame
            frames.append(frame)
            frame = leg.turned(leg.length) @ frame
        return frames

    def points(self, edges: int) -> Array:
        """Nodes of the drawn wire, `edges` in each leg."""
        points = [np.zeros(3)]
        for leg, frame in zip(self.legs, self.frames(), strict=True):
            start = points[-1]
            for k in range(1, edges + 1):
                points.append(start + leg.chord(leg.length * k / edges, frame[:, 2]))
        return np.array(points)

    def solve(self, places: Sequence[tuple[int, float]]) -> Array:
        """At places, each a leg and a share of it, shape (places, 13): x, y, z, curvatures towards
        d1 and d2, twist, their moments, tension, and the components of the tangent.
        """
        found = root(lambda m: self._march(m, ())[0], np.zeros(3), tol=1e-13)
        assert np.abs(found.fun).max() < 1e-9
        return np.array(self._march(found.x, places)[1])

    def _march(self, moment: Array, places: Sequence[tuple[int, float]]) -> tuple[Array, Array]:
        """The moment at the end, and the values at the places."""
        EI1, EI2, GJ, EA = self.stiffness
        compliance = np.array([1 / EI2, 1 / EI1, 1 / GJ])  # about d1, d2, d3
        drawn = self.frames()
        forces = [np.array(force) for _, force in self.inside.values()]
        n = np.array(self.tip) + sum(forces, np.zeros(3))
        point, frame, before = np.zeros(3), drawn[0], drawn[0]
        values = {}
        for i, leg in enumerate(self.legs):
            frame = frame @ before.T @ drawn[i]
            towards_1, towards_2, twist = self.natural
            natural = drawn[i].T @ np.array(leg.bent) + [-towards_2, towards_1, twist]
            if i in self.springs:
                z = rotation_between(drawn[i], frame)
                moment = moment + moment_of(drawn[i], frame, np.array(self.springs[i]) * z)
            cuts = [0.0, 1.0]
            if i in self.inside:
                cuts.insert(1, self.inside[i][0])
            for part, (a, b) in enumerate(pairwise(cuts)):
                if part == 1:
                    n = n - np.array(self.inside[i][1])

                def rate(_s: float, y: Array, n: Array = n, natural: Array = natural) -> Array:
                    d, m = y[3:12].reshape(3, 3), y[12:]
                    u = natural + compliance * (d.T @ m)
                    slope = (1.0 + n @ d[:, 2] / EA) * d[:, 2]
                    return np.concatenate(
                        [slope, np.cross((d @ u)[:, None], d, axis=0).ravel(), np.cross(n, slope)]
                    )

                y = np.concatenate([point, frame.ravel(), moment])
                run = solve_ivp(
                    rate,
                    (a * leg.length, b * leg.length),
                    y,
                    method="DOP853",
                    rtol=1e-11,
                    atol=1e-13,
                    dense_output=True,
                )
                for number, (which, share) in enumerate(places):
                    if which != i or not a <= share <= b:
                        continue
                    y = run.sol(share * leg.length)
                    d, m = y[3:12].reshape(3, 3), y[12:]
                    about = d.T @ m
                    u = natural + compliance * about
                    values[number] = [
                        *y[:3],
                        *(u[1], -u[0], u[2]),
                        *(about[1], -about[0], about[2]),
                        n @ d[:, 2],
                        *d[:, 2],
                    ]
                y = run.y[:, -1]
                point, frame, moment = y[:3], y[3:12].reshape(3, 3), y[12:]
            before = leg.turned(leg.length) @ drawn[i]
        return moment, np.array([values[k] for k in sorted(values)])
