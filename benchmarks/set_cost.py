"""Cost of `simulation.set` from Python, in microseconds and over that of an empty call.

    python benchmarks/set_cost.py

Prints, for each form of a value, the best time of a call over many batches, and its ratio to
reading `simulation.time`, which is as little as a call of the engine can be.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import der

CALLS = 1000  # in one batch
BATCHES = 200
LIMIT = 0.5e-6  # [s] a call, promised in the documentation

SCENE = {
    "rods": [
        {
            "name": "rod",
            "nodes": 11,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"circle": {"radius": 0.01}},
            "material": {"youngs_modulus": 1e7, "density": 1000},
        }
    ],
    "supports": [
        {"name": "wall", "rod": "rod", "at": "start", "clamp": True, "prescribe": {"x": 0, "y": 0}}
    ],
    "loads": [
        {"name": "gravity", "gravity": [0, -9.81]},
        {"name": "push", "point_force": {"rod": "rod", "at": "end", "force": [0, 0]}},
        {"name": "bend", "moment": {"rod": "rod", "at": 0.5, "moment": 0}},
    ],
    "actuation": [
        {"name": "curl", "rod": "rod", "from": 0.2, "to": 0.8, "natural_curvature": 0},
        {"name": "longer", "rod": "rod", "elongation": 0},
        {"name": "shorter", "rod": "rod", "from": 0.13, "profile": "smooth", "elongation": 0},
    ],
    "time": {"duration": 1, "step": 0.001},
}


def best_time(call: Callable[[], object]) -> float:
    """Best seconds of a call, with those of an empty loop taken off."""

    def best(what: Callable[[], object]) -> float:
        shortest = float("inf")
        for _ in range(BATCHES):
            before = time.perf_counter()
            for _ in range(CALLS):
                what()
            shortest = min(shortest, (time.perf_counter() - before) / CALLS)
        return shortest

    return best(call) - best(lambda: None)


def main() -> int:
    """Print the table; return 1 if a call costs more than it may."""
    simulation = der.Simulation(SCENE)
    set_value, pull = simulation.set, [0.0, -3.0]
    for name in simulation.names:
        set_value(name, simulation.value(name))
    empty = best_time(lambda: simulation.step_count)
    ways: dict[str, Callable[[], object]] = {
        'set("bend", 0.1)': lambda: set_value("bend", 0.1),
        'set("wall.x", 0.1)': lambda: set_value("wall.x", 0.1),
        'set("curl", 0.1)': lambda: set_value("curl", 0.1),
        'set("longer", 0.1)': lambda: set_value("longer", 0.1),
        'set("push", [0, -3])': lambda: set_value("push", pull),
        'set("wall", {"x": 0.1})': lambda: set_value("wall", {"x": 0.1}),
        'value("bend")': lambda: simulation.value("bend"),
    }
    print(f"reading a number of the engine: {1e6 * empty:.3f} microseconds")
    print(f"{'call':26} {'us':>7} {'ratio':>7}")
    worst = 0.0
    for name, call in ways.items():
        took = best_time(call)
        if "{" not in name:
            worst = max(worst, took)
        print(f"{name:26} {1e6 * took:7.3f} {took / empty:7.1f}")
    print(f"largest but for a dict: {1e6 * worst:.2f} microseconds (limit {1e6 * LIMIT:.1f})")
    return int(worst > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
