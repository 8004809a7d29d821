"""Random static scenes: hard ones, but such that an equilibrium exists.

Lengths about 1, EI = 1, so that loads are in EI/L^2: forces and weights up to 1000, moments up to
30, EA L^2/EI from 1e2 to 1e10, natural curvature up to 10, shapes from straight to crumpled. Two of
three rods have springs, some hang from nothing else: 1e-2 to 1e8 EI/L^3 against moving, 1e-3 to 1e6
EI/L against turning.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Random = np.random.Generator
Scene = dict[str, Any]


def log_uniform(random: Random, low: float, high: float) -> float:
    """A number whose logarithm is evenly spread."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def drawn_points(random: Random, nodes: int) -> list[list[float]]:
    """A straight, wavy or crumpled line of nodes from the origin."""
    edges = nodes - 1
    s = (np.arange(edges) + 0.5) / edges
    angle = np.full(edges, random.uniform(-np.pi, np.pi))
    kind = random.choice(["straight", "wavy", "crumpled"])
    if kind == "wavy":
        for k in range(1, 4):
            angle += random.normal(0.0, 2.0 / k) * np.sin(np.pi * k * s + random.uniform(0, np.pi))
    elif kind == "crumpled":
        angle += np.cumsum(random.uniform(-0.8, 0.8, edges))
    steps = np.column_stack([np.cos(angle), np.sin(angle)]) * random.uniform(0.5, 2.0) / edges
    return [[0.0, 0.0], *np.cumsum(steps, axis=0).tolist()]


def supports(random: Random) -> list[Scene]:
    """Supports that leave no free translation."""
    start, end = {"rod": "rod", "at": "start"}, {"rod": "rod", "at": "end"}
    choices: list[list[Scene]] = [
        [{**start, "clamp": True}],
        [{**start, "clamp": True}, {**end, "fix": ["x", "y"]}],
        [{**start, "clamp": True}, {**end, "clamp": True}],
        [{**start, "clamp": True}, {**end, "fix": ["y"]}],
        [{**start, "fix": ["x", "y"]}, {**end, "fix": ["x", "y"]}],
        [{**start, "fix": ["x", "y"]}, {**end, "fix": ["y"]}],
        [{**start, "fix": ["x", "y"]}, {**end, "fix": ["x"]}],
        [{**start, "fix": ["x", "y"]}],
    ]
    return choices[random.integers(len(choices))]


def springs(random: Random, length: float) -> list[Scene]:
    """Up to three springs, soft and stiff, at any place."""
    result: list[Scene] = []
    for _ in range(random.integers(4)):
        spring: Scene = {}
        if random.random() < 0.7:
            pair = [log_uniform(random, 1e-2, 1e8) for _ in range(2)]
            spring["stiffness"] = pair if random.random() < 0.5 else pair[0]
            if random.random() < 0.3:
                spring["anchor"] = random.uniform(-1.0, 1.0, 2).tolist()
        if not spring or random.random() < 0.3:
            spring["rotational_stiffness"] = log_uniform(random, 1e-3, 1e6)
        place = random.choice(["start", "middle", "end", "inside"])
        at = float(random.uniform(0.0, length)) if place == "inside" else str(place)
        result.append({"rod": "rod", "at": at, "spring": spring})
    return result


def with_springs(random: Random, held: list[Scene], length: float) -> list[Scene]:
    """The supports and some springs, or springs in their place."""
    added = springs(random, length)
    pulls = sum("stiffness" in support["spring"] for support in added)
    clamped = any("clamp" in support for support in held)
    if pulls > 1 and not clamped and random.random() < 0.5:
        return added
    components = {str(s["at"]): {*s.get("fix", []), *("xya" if "clamp" in s else "")} for s in held}
    for support in added:
        there = components.get(support["at"], set())
        spring = support["spring"]
        if there & {"x", "y"}:
            spring.pop("stiffness", None)
            spring.pop("anchor", None)
        if "a" in there:
            spring.pop("rotational_stiffness", None)
    return [*held, *(support for support in added if support["spring"])]


def direction(random: Random) -> Any:
    """A unit vector; often along an axis, where symmetry breeds saddles."""
    angle = random.choice([0.0, 0.5, 1.0, 1.5, random.uniform(0.0, 2.0)]) * np.pi
    return np.array([np.cos(angle), np.sin(angle)]).round(15)


def loads(random: Random, length: float, clamped: bool) -> list[Scene]:
    """One to three loads; a moment only where a clamp holds against it."""
    result: list[Scene] = []
    wanted = random.integers(1, 4)
    while len(result) < wanted:
        size = log_uniform(random, 0.1, 1000.0)
        kind = random.choice(["point", "distributed", "gravity", "moment"])
        if kind == "point":
            at = random.choice(["middle", "end", "inside"])
            place = float(random.uniform(0.1, 0.9) * length) if at == "inside" else str(at)
            force = (size * direction(random)).tolist()
            result.append({"point_force": {"rod": "rod", "at": place, "force": force}})
        elif kind == "distributed":
            force = (size * direction(random)).tolist()
            result.append({"distributed_force": {"rod": "rod", "force": force}})
        elif kind == "gravity" and not any("gravity" in load for load in result):
            result.append({"gravity": (size * direction(random)).tolist()})
        elif kind == "moment" and clamped:
            moment = log_uniform(random, 0.1, 30.0) * float(random.choice([-1.0, 1.0]))
            result.append({"moment": {"rod": "rod", "at": "middle", "moment": moment}})
    return result


def random_scene(seed: int) -> Scene:
    """The scene of a seed."""
    random = np.random.default_rng(seed)
    nodes = int(random.integers(8, 61))
    points = drawn_points(random, nodes)
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    rod: Scene = {
        "name": "rod",
        "points": points,
        "cross_section": {
            "stiffness": {"EA": log_uniform(random, 1e2, 1e10), "EI": 1.0, "mass_per_length": 1.0}
        },
        "curvature": str(random.choice(["angle", "angle", "tangent"])),
    }
    natural = random.choice(["drawn", "straight", "constant", "nodes"])
    if natural == "straight":
        rod["natural_curvature"] = 0.0
    elif natural == "constant":
        rod["natural_curvature"] = float(random.uniform(-10.0, 10.0))
    elif natural == "nodes":
        rod["natural_curvature"] = random.uniform(-10.0, 10.0, nodes).tolist()
    held = supports(random)
    clamped = any("clamp" in support for support in held)
    acting = loads(random, length, clamped)
    return {
        "title": f"Random scene {seed}",
        "rods": [rod],
        "supports": with_springs(random, held, length),
        "loads": acting,
        "analysis": "static",
    }
