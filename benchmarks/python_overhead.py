"""Overhead of a loop of `simulation.step()` in Python over the same steps in one C++ call.

    python benchmarks/python_overhead.py [SCENE]

Prints, for several numbers of nodes, the time of one step within `simulation.step(n)`, of one
`simulation.step()`, their difference and ratio, and the same for a loop that also reads and writes
the views. Every time is the best of many short batches, taken in turns, so that other work on the
machine disturbs all alike.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import der

STEPS = 200  # in one batch
BATCHES = 60
NODES = (3, 11, 51)
LIMIT = 2e-6  # [s] a step, promised in the documentation


def in_one_call(simulation: der.Simulation) -> None:
    """All steps within C++."""
    simulation.step(STEPS)


def in_a_loop(simulation: der.Simulation) -> None:
    """One call for each step."""
    step = simulation.step
    for _ in range(STEPS):
        step()


def in_a_loop_with_control(simulation: der.Simulation) -> None:
    """As a controller does: read a view and write a force before each step."""
    positions, force = simulation.positions, simulation.extra_force
    for _ in range(STEPS):
        force[-1, 1] = -1e-9 * positions[-1, 1]
        simulation.step()


def best_times(simulation: der.Simulation) -> list[float]:
    """Best seconds a step of the three ways."""
    ways: list[Callable[[der.Simulation], None]] = [in_one_call, in_a_loop, in_a_loop_with_control]
    best = [float("inf")] * len(ways)
    start = simulation.save_state()
    for _ in range(BATCHES):
        for i, way in enumerate(ways):
            simulation.restore_state(start)
            before = time.perf_counter()
            way(simulation)
            best[i] = min(best[i], (time.perf_counter() - before) / STEPS)
    return best


def main() -> int:
    """Print the table; return 1 if a loop costs more than it may."""
    default = Path(__file__).parents[1] / "configs" / "simply_supported.yaml"
    scene = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    print(f"{scene.name}: microseconds a step")
    print(f"{'nodes':>6} {'step(n)':>9} {'step()':>9} {'over':>7} {'ratio':>7} {'control':>9}")
    worst = 0.0
    for nodes in NODES:
        scenario = der.load(scene)
        rod = scenario.to_dict()["rods"][0]["name"]
        simulation = der.Simulation(scenario.with_(**{f"rods.{rod}.nodes": nodes}))
        one_call, loop, control = best_times(simulation)
        worst = max(worst, loop - one_call)
        print(
            f"{nodes:6d} {1e6 * one_call:9.3f} {1e6 * loop:9.3f} {1e6 * (loop - one_call):7.3f} "
            f"{loop / one_call:7.2f} {1e6 * control:9.3f}"
        )
    print(f"largest overhead {1e6 * worst:.2f} microseconds a step (limit {1e6 * LIMIT:.0f})")
    return int(worst > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
