"""The values that a player can set in a scene: their names, and how far their sliders go."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from der._core import Scenario
from der.scene_loads import kind_of
from der.simulation import Simulation

#: Lists of the scene whose parts have names that programs set.
_NAMED = ("joints", "springs", "supports", "loads", "actuation")
#: Kinds of loads with a value that can be set.
_SETTABLE = ("point_force", "distributed_force", "moment", "gravity")
#: Keys whose numbers are no values.
_NO_VALUES = frozenset(("at", "from", "to", "axis", "times", "frequency", "phase"))


@dataclass(frozen=True)
class Control:
    """A value that can be set, with its unit; its slider goes from `least` to `reach` in steps."""

    path: str
    unit: str
    least: float
    reach: float
    step: float


def with_names(scenario: Scenario) -> Scenario:
    """Return the scene with names for all that a program can set: ``gravity``, ``gravity_2``."""
    scene = scenario.to_dict()
    parts = [(key, part) for key in _NAMED for part in scene.get(key) or []]
    taken = {part.get("name") for _, part in parts}
    names = {}
    for key in ("supports", "loads"):
        for number, part in enumerate(scene.get(key) or []):
            kind = "support" if key == "supports" else kind_of(part)[0]
            if "name" not in part and ("prescribe" in part or kind in _SETTABLE):
                numbered = (f"{kind}_{n}" if n > 1 else kind for n in range(1, len(taken) + 2))
                name = next(name for name in numbered if name not in taken)
                taken.add(name)
                names[f"{key}.{number}.name"] = name
    return scenario.with_(names) if names else scenario


def controls_of(simulation: Simulation) -> list[Control]:
    """Return what can be set, with sliders twice as long as what the scene does by itself."""
    scene = simulation.scenario.to_dict()
    lists = (scene.get(key) or [] for key in _NAMED)
    parts = {part.get("name"): part for items in lists for part in items}
    found = []
    for name, components in simulation.names.items():
        moved = parts[name].get("prescribe", parts[name])
        for component, unit in components.items():
            is_length = component == "rest_length"
            part = moved.get(component, {} if is_length else moved.get("rotation", moved))
            reach = 2.0 * _largest(part) or _natural_reach(simulation, unit)
            if is_length:
                reach = max(reach, 2.0 * simulation.value(f"{name}.{component}"))
            step = float(f"{10.0 ** np.floor(np.log10(reach / 100.0)):.0e}")
            reach = float(f"{step * np.ceil(reach / step - 1e-9):.12g}")
            least = 0.0 if is_length else -reach
            found.append(Control(f"{name}.{component}", unit, least, reach, step))
    return found


def natural_force(simulation: Simulation) -> float:
    """Return a force [N] that is seen: it bends the longest rod, or holds the weight of all."""
    rods = simulation.model.rods
    bending = 3.0 * max(rod.EI for rod in rods) / max(rod.length for rod in rods) ** 2
    return max(bending, 9.81 * float(simulation.node_masses.sum()))


def _largest(part: Any) -> float:
    """Return the size of the largest value in a part of a scene."""
    if isinstance(part, Mapping):
        part = [one for key, one in part.items() if key not in _NO_VALUES]
    if isinstance(part, list):
        return max(map(_largest, part), default=0.0)
    return abs(float(part)) if isinstance(part, (int, float)) else 0.0


def _natural_reach(simulation: Simulation, unit: str) -> float:
    """Return a value that is seen, for what is zero in the scene."""
    length, force = max(rod.length for rod in simulation.model.rods), natural_force(simulation)
    values = {"N": force, "N/m": force / length, "N m": force * length, "m/s^2": 20.0}
    values |= {"m": 0.3 * length, "rad": np.pi, "1/m": 4.0 / length, "rad/m": 4.0 / length}
    return values.get(unit, 0.2)
