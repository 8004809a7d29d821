"""What a player can set in a scene: names for it, and ranges of sliders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from der._core import Scenario
from der.scene_loads import kind_of
from der.simulation import Simulation

#: Kinds of loads with a value that can be set.
_SETTABLE = ("point_force", "distributed_force", "moment", "gravity")
#: Keys whose numbers are no values.
_NO_VALUES = frozenset(("at", "from", "to", "axis", "times", "frequency", "phase"))


@dataclass(frozen=True)
class Control:
    """A component of what has a name, with its unit and the largest value of its slider.

    The slider goes from minus that to that in steps of a power of ten.
    """

    name: str
    component: str
    unit: str
    reach: float
    step: float


def with_names(scenario: Scenario) -> Scenario:
    """Return the scene with a name for each support that moves, and load, that has none.

    It is the kind of the load, or ``support``, and from the second on with a number.
    """
    scene = scenario.to_dict()
    parts = {key: scene.get(key) or [] for key in ("supports", "loads", "actuation")}
    taken = {part.get("name") for items in parts.values() for part in items}
    names = {}
    for key in ("supports", "loads"):
        for number, part in enumerate(parts[key]):
            kind = "support" if key == "supports" else kind_of(part)[0]
            if "name" in part or not ("prescribe" in part or kind in _SETTABLE):
                continue
            numbered = (f"{kind}_{n}" if n > 1 else kind for n in range(1, len(taken) + 2))
            name = next(name for name in numbered if name not in taken)
            taken.add(name)
            names[f"{key}.{number}.name"] = name
    return scenario.with_(names) if names else scenario


def controls_of(simulation: Simulation) -> list[Control]:
    """Return what can be set, in the order of `Simulation.names`.

    A slider reaches twice as far as the scene goes by itself, or so far that it is seen.
    """
    scene = simulation.scenario.to_dict()
    parts = {
        part.get("name"): part
        for key in ("supports", "loads", "actuation")
        for part in scene.get(key) or []
    }
    found = []
    for name, components in simulation.names.items():
        moved = parts[name].get("prescribe", parts[name])
        for component, unit in components.items():
            part = moved.get(component, moved.get("rotation", moved))
            reach = 2.0 * _largest(part) or _natural_reach(simulation, unit)
            step = float(f"{10.0 ** np.floor(np.log10(reach / 100.0)):.0e}")
            reach = float(f"{step * np.ceil(reach / step - 1e-9):.12g}")
            found.append(Control(name, component, unit, reach, step))
    return found


def _largest(part: Any) -> float:
    """Return the size of the largest value in a part of a scene."""
    if isinstance(part, Mapping):
        return max((_largest(one) for key, one in part.items() if key not in _NO_VALUES), default=0)
    if isinstance(part, list):
        return max(map(_largest, part), default=0.0)
    return abs(float(part)) if isinstance(part, (int, float)) else 0.0


def natural_force(simulation: Simulation) -> float:
    """Return a force [N] that is seen: it bends the longest rod, or holds the weight of all."""
    rods = simulation.model.rods
    bending = 3.0 * max(rod.EI for rod in rods) / max(rod.length for rod in rods) ** 2
    return max(bending, 9.81 * float(simulation.node_masses.sum()))


def _natural_reach(simulation: Simulation, unit: str) -> float:
    """Return a value that is seen, for what is zero in the scene."""
    length = max(rod.length for rod in simulation.model.rods)
    force = natural_force(simulation)
    return {
        "N": force,
        "N/m": force / length,
        "N m": force * length,
        "m/s^2": 20.0,
        "m": 0.3 * length,
        "rad": np.pi,
        "1/m": 4.0 / length,
        "rad/m": 4.0 / length,
    }.get(unit, 0.2)
