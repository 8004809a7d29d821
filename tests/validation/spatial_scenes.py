"""Scenes in space that several validation tests vary: one rod named 'rod', and probes on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import der
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scenes import START

Scene = dict[str, Any]
Place = str | float

#: Everything that a rod in space tells at a place.
QUANTITIES = (
    *("x", "y", "z", "curvature_1", "curvature_2", "twist"),
    *("moment_1", "moment_2", "torque", "tension"),
)
CLAMPED: list[Scene] = [{**START, "clamp": True}]


def section(director: ArrayLike | None = None, **stiffnesses: float) -> Scene:
    """Stiffnesses by their keys; EA = 1e6 and a mass of 1 a length unless given."""
    cross_section: Scene = {"stiffness": {"EA": 1e6, "mass_per_length": 1.0, **stiffnesses}}
    if director is not None:
        cross_section["director"] = np.asarray(director).tolist()
    return cross_section


def rod_through(
    points: ArrayLike, cross_section: Scene, supports: list[Scene] = CLAMPED, **more: Any
) -> Scene:
    """A rod with these nodes; `rod` in `more` has other keys of it."""
    rod = {"name": "rod", "points": np.asarray(points).tolist(), "cross_section": cross_section}
    rod |= more.pop("rod", {})
    scene: Scene = {"model": "spatial", "rods": [rod], "supports": supports, **more}
    if "time" not in scene:
        scene.setdefault("analysis", "static")
    return scene


def straight_rod(edges: int, cross_section: Scene, to: ArrayLike = (1, 0, 0), **more: Any) -> Scene:
    """A straight rod from the origin."""
    return rod_through(np.linspace(np.zeros(3), to, edges + 1), cross_section, **more)


def measured(
    scene: Scene, places: Sequence[Place], quantities: Sequence[str] = QUANTITIES
) -> tuple[NDArray[np.float64], der.Result]:
    """Final values at the places, shape (places, quantities), and the whole result."""
    probes = {
        f"{quantity}_{i}": {"rod": "rod", "at": place, "quantity": quantity}
        for i, place in enumerate(places)
        for quantity in quantities
    }
    output = {**scene.get("output", {}), "probes": probes}
    if "time" in scene:
        output.setdefault("every", scene["time"]["duration"])
    result = der.run(der.Scenario.from_dict({**scene, "output": output}))
    values = [[result.probes[f"{q}_{i}"][-1] for q in quantities] for i in range(len(places))]
    return np.array(values), result


def critical(is_unstable: Callable[[float], bool], low: float, high: float, digits: float) -> float:
    """The load between `low` and `high` where a verdict changes, to `digits`."""
    assert not is_unstable(low)
    assert is_unstable(high)
    while high - low > digits:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if is_unstable(middle) else (middle, high)
    return 0.5 * (low + high)
