"""Probes for a scene that has none: where the free ends are, and how far the rods reach."""

from __future__ import annotations

from typing import Any

from der._core import Model, Scenario, held_nodes


def with_default_probes(scenario: Scenario) -> Scenario:
    """Return the scene with probes if it has none and its analysis finds no other numbers.

    For each rod: x and y of its ends, as far as no support holds them (``arm_end_y``), and the
    lowest and highest point (``arm_lowest``, ``arm_highest``).
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
    for rod in Model(scenario).rods:
        name = rod.name
        ends = [("start", rod.nodes[0]), ("end", rod.nodes[-1])]
        for end, node in ends[:1] if rod.closed else ends:
            probes += [
                (f"{name}_{end}_{c}", {"rod": name, "at": end, "quantity": c})
                for c in ("x", "y")
                if (name, int(node), c) not in held
            ]
        for word, extreme in (("lowest", "min"), ("highest", "max")):
            whole = {"rod": name, "quantity": "y", "over": "rod", "reduce": extreme}
            probes.append((f"{name}_{word}", whole))
    return probes
