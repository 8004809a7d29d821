"""Random scenes of smooth curves that are drawn by points, and the same on finer drawings.

The points lie on the curve, more or less evenly. A finer drawing has further points on the same
curve, so that very fine ones give the true values of a rod that has the shape of the curve.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import der
import numpy as np
from der.accuracy.readings import read_run
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Scene: TypeAlias = dict[str, Any]
Random: TypeAlias = np.random.Generator

#: The curves turn by no more than this at a node [rad].
_LARGEST_TURN = 0.5
_IN_PLANE = ("x", "y", "slope", "curvature", "moment", "tension")
_IN_SPACE = ("x", "y", "z", "curvature_1", "moment_2", "torque", "twist", "tension")
_REACTIONS = {2: ("reaction_x", "reaction_moment"), 3: ("reaction_x", "reaction_moment_z")}
#: How fine the drawings are that true values come from, in elements for one of the scene.
_FINE = (8, 16, 32)


@dataclass(frozen=True)
class Place:
    """A share of an element of the scene as it is drawn."""

    element: int
    share: float

    def on(self, points: Array, factor: int) -> Any:
        """How a drawing with `factor` times the elements names the place."""
        first = self.element * factor
        if self.share == 0.0:
            return {"node": first}
        lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
        along = float(np.sum(lengths[first : first + factor]))
        return float(np.sum(lengths[:first])) + self.share * along


@dataclass(frozen=True)
class DrawnCurve:
    """A scene with one rod that has the shape of a smooth curve."""

    elements: int
    curve: Callable[[Array], Array]
    entries: Callable[[Callable[[Place], Any]], Scene]
    rod: Scene

    def scene(self, factor: int = 1) -> Scene:
        """The scene with `factor` times as many elements, whose nodes all lie on the curve."""
        points = self.curve(np.linspace(0.0, 1.0, factor * self.elements + 1))
        drawn = {**self.rod, "points": points.tolist()}
        return {"rods": [drawn], **self.entries(lambda place: place.on(points, factor))}

    def truths(self) -> dict[str, tuple[float, float]]:
        """By label, the value of the curve and how far off it may be.

        Extrapolated from the two finest drawings at the order of the rods, which is 2.
        """
        found = [read_run(der.run(self.scene(factor))) for factor in _FINE]
        truths = {}
        for label in found[0]:
            coarse, middle, fine = (readings[label].value for readings in found)
            best, second = fine + (fine - middle) / 3.0, middle + (middle - coarse) / 3.0
            truths[label] = best, abs(best - second)
        return truths


def drawn_curves(random: Random, elements: int | None = None) -> DrawnCurve:
    """A curve of a random kind, drawn by a random number of points, held and loaded at random.

    There are `elements` between the points, or some more where the curve turns too much for them.
    """
    in_space = bool(random.random() < 0.4)
    shape = _spatial(random) if in_space else _planar(random)
    uneven = random.uniform(0.0, 0.7) if random.random() < 0.5 else 0.0
    phase = random.uniform(0.0, 2.0 * np.pi)

    def curve(share: Array) -> Array:
        swing = np.sin(2.0 * np.pi * share + phase) - np.sin(phase)
        return shape(share + uneven * swing / (2.0 * np.pi))

    elements = elements or int(random.integers(8, 41))
    while _largest_turn(curve(np.linspace(0.0, 1.0, elements + 1))) > _LARGEST_TURN:
        elements += 1
    rod: Scene = {
        "name": "rod",
        "cross_section": {
            "stiffness": {
                "EA": float(10.0 ** random.uniform(2.5, 6.0)),
                "EI": 1.0,
                "mass_per_length": 1.0,
                **({"GJ": float(random.uniform(0.5, 1.5))} if in_space else {}),
            }
        },
    }
    if random.random() < 0.2:
        rod["natural_curvature"] = [0.0, 0.0] if in_space else 0.0
    return DrawnCurve(elements, curve, _entries(random, elements, 3 if in_space else 2), rod)


def _largest_turn(points: Array) -> float:
    edges = np.diff(points, axis=0)
    edges /= np.linalg.norm(edges, axis=1)[:, None]
    return float(np.max(np.arccos(np.clip(np.sum(edges[1:] * edges[:-1], axis=1), -1.0, 1.0))))


def _planar(random: Random) -> Callable[[Array], Array]:
    kind = random.choice(["arc", "ellipse", "sine", "spiral"])
    turn = random.uniform(0.5, 4.5)
    if kind == "arc":
        return lambda u: np.column_stack([np.sin(turn * u), 1.0 - np.cos(turn * u)]) / turn
    if kind == "ellipse":
        flat, start = random.uniform(0.3, 1.0), random.uniform(0.0, np.pi)
        angle = lambda u: start + turn * u  # noqa: E731
        return lambda u: np.column_stack([np.cos(angle(u)), flat * np.sin(angle(u))]) / 2.0
    if kind == "sine":
        height, half_waves = random.uniform(0.03, 0.25), random.uniform(0.5, 2.5)
        return lambda u: np.column_stack([u, height * np.sin(half_waves * np.pi * u)])
    growth = random.uniform(-0.8, 0.8)
    radius = lambda u: np.exp(growth * u)[:, None] / 2.0  # noqa: E731
    return lambda u: radius(u) * np.column_stack([np.cos(turn * u), np.sin(turn * u)])


def _spatial(random: Random) -> Callable[[Array], Array]:
    if random.random() < 0.6:
        turn, radius, pitch = random.uniform(2, 9), random.uniform(0.1, 0.3), random.uniform(0.2, 1)
        return lambda u: np.column_stack(
            [radius * np.cos(turn * u), radius * np.sin(turn * u), pitch * u]
        )
    heights, waves = random.uniform(0.03, 0.2, 2), random.uniform(0.5, 2.0, 2) * np.pi
    return lambda u: np.column_stack(
        [u, heights[0] * np.sin(waves[0] * u), heights[1] * np.cos(waves[1] * u)]
    )


def _entries(random: Random, elements: int, dim: int) -> Callable[[Callable[[Place], Any]], Scene]:
    """All of the scene but its rod, for the names of places."""
    held = random.choice(["start", "both", "pinned"], p=[0.6, 0.2, 0.2])
    supports: list[Scene] = [{"rod": "rod", "at": "start", "clamp": True}]
    if held != "start":
        end: Scene = {"clamp": True} if held == "both" else {"fix": ["x", "y", "z"][:dim]}
        supports.append({"rod": "rod", "at": "end", **end})
    strength = 1.0 if held == "start" else 5.0

    def vector() -> list[float]:
        return [float(part) for part in random.uniform(-strength, strength, dim)]

    def place() -> Place:
        share = 0.0 if random.random() < 0.6 else float(random.uniform(0.2, 0.8))
        return Place(int(random.integers(2, elements - 1)), share)

    kinds = random.choice(["end", "inner", "spread", "gravity", "moment"], 2, replace=False)
    places, forces = [place() for _ in range(6)], [vector() for _ in range(2)]
    moment = vector() if dim == 3 else float(random.uniform(-strength, strength))
    inner = Place(places[0].element, 0.0)
    has_modes = dim == 2 or "moment" not in kinds  # moments in space have no potential
    analysis = {"modes": {"count": 3}} if has_modes and random.random() < 0.2 else "static"
    asked = _IN_PLANE if dim == 2 else _IN_SPACE
    quantities = [str(q) for q in random.choice(asked, len(places))]

    def entries(at: Callable[[Place], Any]) -> Scene:
        on_rod: Scene = {"rod": "rod"}
        makers: dict[str, Callable[[Any], Scene]] = {
            "end": lambda force: {"point_force": {**on_rod, "at": "end", "force": force}},
            "inner": lambda force: {"point_force": {**on_rod, "at": at(inner), "force": force}},
            "spread": lambda force: {"distributed_force": {**on_rod, "force": force}},
            "gravity": lambda force: {"gravity": force},
            "moment": lambda _: {"moment": {**on_rod, "at": "end", "moment": moment}},
        }
        probes: dict[str, Scene] = {
            f"{name}_at_{number}": {**on_rod, "at": at(where), "quantity": name}
            for number, (name, where) in enumerate(zip(quantities, places, strict=True))
        }
        for name in ("x", "y"):
            probes[f"end_{name}"] = {**on_rod, "at": "end", "quantity": name}
        for name in _REACTIONS[dim]:
            probes[name] = {"support": 0, "quantity": name}
        near = "curvature" if dim == 2 else "curvature_1"
        probes["near_start"] = {**on_rod, "at": at(Place(1, 0.0)), "quantity": near}
        probes["energy"] = {"quantity": "elastic_energy"}
        return {
            **({"model": "spatial"} if dim == 3 else {}),
            "supports": supports,
            "loads": [makers[kind](force) for kind, force in zip(kinds, forces, strict=True)],
            "analysis": analysis,
            "output": {"probes": probes},
        }

    return entries
