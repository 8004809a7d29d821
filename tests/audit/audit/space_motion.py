"""Motions of clamped rods in space: C1 elements of high degree, Gauss collocation in time.

The reference is ``tests/validation/references/spatial_motion.py``, whose rods start along z.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from references.spatial_motion import Angle, Motion, Spin, still
from references.spatial_motion import Case as Problem
from references.swing import Collocation

from .case import Case, Label, Truth, UnsolvedError
from .motions import compare
from .rod import Array
from .shapes import Random, power
from .space import Placed, place, probes, share

QUANTITIES = (
    *("x", "y", "z", "x", "y", "z", "vx", "vy", "vz"),
    *("curvature_1", "curvature_2", "twist", "torque"),
)
STEPPERS = (
    "tr_bdf2",
    "implicit_midpoint",
    "generalized_alpha",
    "newmark",
    "bdf2",
    "sdirk4",
    "implicit_euler",
)
_GAUSS = Collocation("gauss", 3)
_ROUGH, _FINE = (9, 80), (13, 200)  # degree, steps
_TABLE = 401  # entries of the angle of a clamp


def space_motion(rng: Random) -> Case:
    bow = rng.uniform(-1.5, 1.5, 2)
    if rng.random() < 0.4:
        bow = 1e-9 * bow  # straight
    drawn = np.array([*bow, 0.0])
    placed = place(rng, drawn, (2.7, 4))
    nodes = int(rng.choice([9, 13, 21, 31]))
    duration = float(rng.uniform(0.1, 0.4))
    line = rng.uniform(-8, 8, 3)
    angle: Angle = still
    support: dict[str, Any] = {"rod": "rod", "at": "start", "clamp": True}
    if rng.random() < 0.3:
        angle = Spin(float(rng.uniform(-3, 3)), float(rng.uniform(0.5, 1.5) * duration))
        times = np.linspace(0, duration, _TABLE)
        turned = [angle(float(t))[0] for t in times]
        table = {"times": (times * placed.period).tolist(), "values": turned}
        support["prescribe"] = {"twist": table}
    problem = Problem(
        placed.rod, 1.0, placed.spin, tuple(line.tolist()), tuple(drawn.tolist()), angle, duration
    )
    points = problem.positions(np.linspace(0, 1, nodes)) @ placed.frame.T
    chords = placed.length * float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    push = placed.frame @ line * placed.force / placed.length
    load: dict[str, Any] = {"distributed_force": {"rod": "rod", "force": push.tolist()}}
    if rng.random() < 0.5:
        load = {"gravity": (push / placed.mass).tolist()}
    read = probes(rng, nodes, chords, QUANTITIES)
    scene = {
        "title": "Audit: motion in space",
        "model": "spatial",
        "rods": [{**placed.entry(), "points": (placed.origin + placed.length * points).tolist()}],
        "supports": [support],
        "loads": [load],
        "time": _stepping(rng, duration * placed.period),
        "output": {"probes": read},
    }

    def series(degree: int, steps: int) -> tuple[Array, dict[str, Array]]:
        dynamics, start = problem.start(1, degree)
        motion = Motion(problem, dynamics, start, _GAUSS, duration / steps)
        states = [_Snapshot(motion)]
        for _ in range(steps):
            motion.step()
            states.append(_Snapshot(motion))
        found = {
            name: np.array(
                [
                    state.read(placed, probe["quantity"], share(probe["at"], nodes, chords))
                    for state in states
                ]
            )
            for name, probe in read.items()
        }
        return np.linspace(0, duration * placed.period, steps + 1), found

    def truths(_: dict[str, Any]) -> Mapping[Label, Truth]:
        try:
            return compare(series(*_ROUGH), series(*_FINE), read)
        except RuntimeError as error:
            raise UnsolvedError(str(error)) from error

    return Case("space_motion", scene, truths)


class _Snapshot:
    """The reference at one instant."""

    def __init__(self, motion: Motion) -> None:
        self.dynamics, self.position = motion.dynamics, motion.position
        self.velocity = motion.velocity

    def read(self, placed: Placed, quantity: str, s: float) -> float:
        """A probe of the scene."""
        mesh = self.dynamics.mesh
        if quantity in ("x", "y", "z"):
            axis = "xyz".index(quantity)
            there = placed.frame @ mesh.position(self.position, s)
            return float(placed.origin[axis] + placed.length * there[axis])
        if quantity in ("vx", "vy", "vz"):
            there = placed.frame @ mesh.position(self.velocity, s)
            return float(there["xyz".index(quantity[1])] * placed.length / placed.period)
        row, factor = {
            "curvature_1": (1, 1.0),
            "curvature_2": (0, -1.0),
            "twist": (2, 1.0),
            "torque": (2, placed.rod.twisting * placed.moment * placed.length),
        }[quantity]
        places, _ = mesh.quadrature
        strains = self.dynamics.strained(self.position).strains[:, row]
        fit = legendre.legfit(2 * places - 1, strains, len(places) // 2)
        return float(legendre.legval(2 * s - 1, fit) * factor / placed.length)


def _stepping(rng: Random, duration: float) -> dict[str, Any]:
    if rng.random() < 0.2:
        return {"duration": duration, "tolerance": power(rng, -4, -2.3)}
    steps = int(rng.choice([40, 80, 160]))
    stepper = str(rng.choice(STEPPERS))
    return {"duration": duration, "step": duration / steps, "integrator": stepper}
