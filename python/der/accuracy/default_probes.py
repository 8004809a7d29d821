"""Probes for a scene that has none: where the free ends are, and how far the rods reach."""

from __future__ import annotations

from typing import Any

from der._core import Model, Scenario, held_nodes


def with_default_probes(scenario: Scenario) -> Scenario:
    """Return the scene with probes if it has none and its analysis finds no other numbers.

    For each rod: x, y and, in space, z of its ends, as far as no support holds them
    (``arm_end_y``), and the lowest and highest point (``arm_lowest``, ``arm_highest``). In space
    also how far it reaches along z (``arm_least_z``, ``arm_greatest_z``).
    """
    scene = scenario.to_dict()
    output = scene.setdefault("output", {})
    if output.get("probes") or scenario.analysis not in ("dynamic", "static"):
        return scenario
    output["probes"] = dict(_probes(scenario))
    return Scenario.from_dict(scene)


def _probes(scenario: Scenario) -> list[tuple[str, dict[str, Any]]]:
    held = {(h.rod, h.node, c) for h in held_nodes(scenario) for c in h.components}
    probes: list[tuple[str, dict[str, Any]]] = []
    model = Model(scenario)
    in_space = model.dimension == 3
    extremes = {"lowest": ("y", "min"), "highest": ("y", "max")}
    if in_space:
        extremes |= {"least_z": ("z", "min"), "greatest_z": ("z", "max")}
    for rod in model.rods:
        name = rod.name
        ends = [("start", rod.nodes[0]), ("end", rod.nodes[-1])]
        for end, node in ends[:1] if rod.closed else ends:
            probes += [
                (f"{name}_{end}_{c}", {"rod": name, "at": end, "quantity": c})
                for c in ("xyz" if in_space else "xy")
                if (name, int(node), c) not in held
            ]
        for word, (component, extreme) in extremes.items():
            whole = {"rod": name, "quantity": component, "over": "rod", "reduce": extreme}
            probes.append((f"{name}_{word}", whole))
    return probes
