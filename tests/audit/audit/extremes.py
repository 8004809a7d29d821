"""Scenes of extreme numbers, at rest and in motion, in the plane and in space.

Drawn in units of their own (length about 1, weakest EI = 1) and written in any others: lengths
from nanometres to kilometres, turned, far from the origin. `Drawn.written` gives the same problem
in other units, whose answer must be the same.

EA L^2/EI from 1e2 to 1e10; 2 to 120 nodes, edges up to 1e3 apart in length at rest and 10 in
motion; straight, wavy and crumpled shapes; natural curvature up to 10, as far as the mesh can carry
it; sections of two stiffnesses; forces up to 1000 EI/L^2 at rest and 10 in motion; stiff and soft
springs; every stepper, with a tolerance that it can keep in seconds, over up to a fifth of the time
scale of the stiffer bending.
"""

from __future__ import annotations

import copy
import dataclasses
from typing import Any

import der
import numpy as np

from .rod import Array
from .shapes import Random, power

Scene = dict[str, Any]


@dataclasses.dataclass(frozen=True)
class Units:
    """The length [m], force [N] and time [s] that 1 stands for; the axes, and the origin [1]."""

    length: float
    force: float
    time: float
    axes: Array
    origin: Array


@dataclasses.dataclass(frozen=True)
class Drawn:
    """A problem in units of its own."""

    dimension: int
    points: Array
    rod: Scene  # EA, EI or EI1 and EI2, GJ, mass_per_length, director, natural curvature
    supports: list[Scene]
    loads: list[Scene]
    time: Scene | None  # duration, tolerance and integrator of a motion

    @property
    def ratio(self) -> float:
        return float(self.rod["EA"])

    def written(self, units: Units) -> Scene:
        """The problem as a scene in these units."""
        a, f, t, axes = units.length, units.force, units.time, units.axes

        def vector(v: Array) -> list[float]:
            return (axes @ np.asarray(v)).tolist()  # type: ignore[no-any-return]

        size = {"EA": f, "EI": f * a**2, "EI1": f * a**2, "EI2": f * a**2, "GJ": f * a**2}
        size |= {"mass_per_length": f * t**2 / a**2, "rotary_inertia": f * t**2}
        section: Scene = {"stiffness": {k: self.rod[k] * size[k] for k in size if k in self.rod}}
        if "director" in self.rod:
            section["director"] = vector(self.rod["director"])
        rod: Scene = {
            "name": "rod",
            "points": (a * ((self.points + units.origin) @ axes.T)).tolist(),
            "cross_section": section,
        }
        if "natural" in self.rod:
            rod["natural_curvature"] = (np.asarray(self.rod["natural"]) / a).tolist()
        supports = copy.deepcopy(self.supports)
        for support in supports:
            support["rod"] = "rod"
            if "spring" in support:
                support["spring"]["stiffness"] *= f / a
                support["at"] = _place(support["at"], a)
        scale = {"point_force": f, "distributed_force": f / a, "gravity": a / t**2}
        loads: list[Scene] = []
        for load in self.loads:
            ((kind, what),) = load.items()
            if kind == "gravity":
                loads.append({kind: vector(np.asarray(what) * scale[kind])})
            elif kind == "damping":
                loads.append({kind: {"coefficient": what * f * t / a**2}})
            else:
                entry: Scene = {
                    "rod": "rod",
                    "force": vector(np.asarray(what["force"]) * scale[kind]),
                }
                if "at" in what:
                    entry["at"] = _place(what["at"], a)
                loads.append({kind: entry})
        scene: Scene = {"title": "Extremes", "rods": [rod], "supports": supports, "loads": loads}
        if self.time is None:
            return {**scene, "analysis": "static"}
        time = {**self.time, "duration": self.time["duration"] * t}
        return {**scene, "time": time, "output": {"every": time["duration"]}}

    def read(self, positions: Array, units: Units) -> Array:
        """Positions of that scene in the units of the drawing."""
        return np.asarray(positions / units.length @ units.axes) - units.origin


def _place(at: Any, length: float) -> Any:
    return at if isinstance(at, str) else at * length


def units(rng: Random, drawn: Drawn) -> Units:
    """Any units; far from the origin only where rounding leaves the rod its stretch."""
    axes, _ = np.linalg.qr(rng.standard_normal((drawn.dimension, drawn.dimension)))
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    origin = np.zeros(drawn.dimension)
    if rng.random() < 0.3:
        origin += rng.uniform(-1, 1, drawn.dimension) * min(1e3, 1e9 / drawn.ratio)
    return Units(power(rng, -9, 3), power(rng, -9, 6), power(rng, -6, 3), axes, origin)


def _stiffest(stepper: der.StepperInfo) -> float:
    """Exponent of the largest EA L^2/EI of motions that the stepper can be asked for in seconds.

    Explicit steps and steppers that do not damp have to resolve the waves along the rod.
    """
    if not stepper.implicit:
        return 3.0
    return 10.0 if stepper.stability.startswith("L-stable") else 4.0


def extremes(rng: Random) -> Drawn:
    """A problem at rest or in motion."""
    dimension = int(rng.choice([2, 3]))
    moves = bool(rng.random() < 0.4)
    nodes = round(power(rng, np.log10(2), np.log10(20 if moves else 120)))
    points = _points(rng, nodes, dimension, 10.0 if moves else 1e3)
    steppers = [s for s in der.steppers() if dimension == 2 or s.name != "energy_momentum"]
    stepper = steppers[rng.integers(len(steppers))]
    rod: Scene = {"EA": power(rng, 2, _stiffest(stepper) if moves else 10), "mass_per_length": 1.0}
    if dimension == 2:
        rod["EI"] = 1.0
    elif rng.random() < 0.5:
        strong = power(rng, 0, 3)
        rod |= {"EI1": strong, "EI2": 1.0, "GJ": power(rng, -1, 1), "rotary_inertia": 1e-4}
        rod["director"] = rng.standard_normal(3)
    else:
        rod |= {"EI": 1.0, "GJ": power(rng, -1, 1), "rotary_inertia": 1e-4}
    natural = rng.random() if nodes > 2 else 1.0  # two nodes do not bend
    if natural < 0.25:
        rod["natural"] = 0.0 if dimension == 2 else np.zeros(2)
    elif natural < 0.5:
        # What the mesh can carry: edges turn by less than half a turn.
        largest = min(3.0 if moves else 10.0, 1.0 / _longest_cell(points))
        rod["natural"] = rng.uniform(-1, 1, None if dimension == 2 else 2) * largest
    held = _supports(rng, dimension)
    if nodes == 2 and "spring" not in held[-1]:
        held = [{"at": "start", "clamp": True}]  # with both nodes held nothing could move
    largest = 1.0 if moves else 3.0
    loads = [_load(rng, dimension, power(rng, -1, largest)) for _ in range(rng.integers(1, 4))]
    time = None
    if moves:
        if rng.random() < 0.4:
            loads.append({"damping": power(rng, -1, 2)})
        tolerance = power(rng, -3, -2) * (10 if stepper.order == 1 else 1)
        duration = float(rng.uniform(0.02, 0.2)) / np.sqrt(rod.get("EI1", 1.0))
        time = {"duration": duration, "tolerance": tolerance, "integrator": stepper.name}
    if dimension == 3 and "natural" in rod:
        # The directors define the two components, so they are given and turn with the axes.
        rod.setdefault("director", rng.standard_normal(3))
    # At most one weight; the last load that the draw has is kept otherwise.
    weights = [load for load in loads if "gravity" in load]
    loads = [load for load in loads if "gravity" not in load] + weights[:1]
    return Drawn(dimension, points, rod, held, loads, time)


def _longest_cell(points: Array) -> float:
    """The largest Voronoi length of the inner nodes."""
    edges = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return float((edges[1:] + edges[:-1]).max() / 2)


def _points(rng: Random, nodes: int, dimension: int, uneven: float) -> Array:
    """A straight, wavy or crumpled line from the origin; one of five has very uneven edges."""
    edges = nodes - 1
    lengths = np.ones(edges)
    if rng.random() < 0.2:
        lengths = np.array([power(rng, -np.log10(uneven), 0) for _ in range(edges)])
    lengths /= lengths.sum()
    s = np.cumsum(lengths) - lengths / 2
    angle = np.full(edges, rng.uniform(-np.pi, np.pi))
    rise = np.full(edges, rng.uniform(-1, 1))
    kind = rng.choice(["straight", "wavy", "crumpled"])
    if kind == "wavy":
        angle = angle + rng.normal(0, 1.0) * np.sin(np.pi * s * rng.integers(1, 4))
        rise = rise + rng.normal(0, 0.5) * np.cos(np.pi * s * rng.integers(1, 4))
    elif kind == "crumpled":
        angle = angle + np.cumsum(rng.uniform(-0.8, 0.8, edges))
    along = np.column_stack([np.cos(angle), np.sin(angle)])
    if dimension == 3:
        along = np.column_stack([along * np.cos(rise)[:, None], np.sin(rise)])
    start = np.zeros((1, dimension))
    return np.concatenate([start, np.cumsum(along * lengths[:, None], axis=0)])


def _supports(rng: Random, dimension: int) -> list[Scene]:
    """Supports that hold against every translation, whatever the axes are."""
    clamp: Scene = {"at": "start", "clamp": True}
    pins = {"fix": ["x", "y", "z"][:dimension]}
    spring: Scene = {"at": "end", "spring": {"stiffness": power(rng, -1, 6)}}
    choices: list[list[Scene]] = [
        [clamp],
        [clamp, {"at": "end", **pins}],
        [clamp, {"at": "end", "clamp": True}],
        [{"at": "start", **pins}, {"at": "end", **pins}],
        [clamp, spring],
        [{"at": "start", **pins}, spring],
    ]
    return copy.deepcopy(choices[rng.integers(len(choices))])


def _load(rng: Random, dimension: int, size: float) -> Scene:
    direction = rng.standard_normal(dimension)
    force = size * direction / np.linalg.norm(direction)
    kind = str(rng.choice(["point_force", "distributed_force", "gravity"]))
    if kind == "gravity":
        return {kind: force}
    if kind == "distributed_force":
        return {kind: {"force": force}}
    return {kind: {"force": force, "at": str(rng.choice(["end", "start", "middle"]))}}
