"""Cost of one static solve, against a run over time in which the beam comes to rest.

    python benchmarks/static_against_dynamic.py

The tube of configs/simply_supported.yaml at 2 kN and 20 kN: the answer with the error bars of
`der.verify`, the time of a static solve from the undeformed shape, and that of runs until the
deflection stays within the error bar of the static one. A run with implicit Euler's method and
a long step is itself a kind of static solver. The line `as a run` is what a person does who wants
to see motion: steps of 1 ms, and a damping that stops the beam soon. Times are the best of several,
in CPU time, without building the model.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import der
import numpy as np

CONFIGS = Path(__file__).resolve().parents[1] / "configs"
SCENES = {"2 kN": "simply_supported", "20 kN": "simply_supported_20kN"}
LIMIT = 5e-3  # [s] a static solve, promised in the documentation
REPEATS = 15
STEPS = (1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 1.0)  # [s] of implicit Euler's method
MOST_STEPS = 20_000
DAMPING = {"damping": {"coefficient": 200.0}}  # [N s/m^2]


def cpu_seconds(simulation: der.Simulation, work: Callable[[], object], repeats: int) -> float:
    """Least CPU seconds of `work`, from the state of `simulation` each time."""
    start = simulation.save_state()
    best = np.inf
    for _ in range(repeats):
        simulation.restore_state(start)
        before = time.process_time()
        work()
        best = min(best, time.process_time() - before)
    return float(best)


def deflection(simulation: der.Simulation) -> float:
    """Largest downward displacement of a node [m]."""
    return -float(simulation.positions[:, 1].min())


def steps_to_rest(simulation: der.Simulation, target: float, error: float) -> int | None:
    """Count the steps until the deflection stays within `error` of `target` [m], if it does."""
    start = simulation.save_state()
    quiet, count, needed = 0, 0, 20
    while count < MOST_STEPS and quiet < needed:
        simulation.step()
        count += 1
        quiet = quiet + 1 if abs(deflection(simulation) - target) < error else 0
    simulation.restore_state(start)
    return count - needed + 1 if quiet == needed else None


def time_of_run(scene: der.Scenario, target: float, error: float) -> tuple[float, int] | None:
    """CPU seconds [s] and steps of a run to rest."""
    simulation = der.Simulation(scene)
    steps = steps_to_rest(simulation, target, error)
    if steps is None:
        return None
    return cpu_seconds(simulation, lambda: simulation.step(steps), 3), steps


def report(label: str, name: str) -> float:
    """Measure one load and print it; CPU seconds of the static solve."""
    scene = der.load(CONFIGS / f"{name}.yaml")
    static = scene.with_(time=None, analysis="static", **{"output.every": None})
    verified = der.verify(static)
    print(f"{label}: {static.title}\n")
    for value in verified.values:
        print(f"  {value.probe:22s} {value.value:.6f} +- {value.error_bar:.1e} {value.unit}")
    error = next(value.error_bar for value in verified.values if value.probe == "deflection")

    simulation = der.Simulation(static)
    seconds = cpu_seconds(simulation, simulation.equilibrium, REPEATS)
    simulation.equilibrium()
    target = deflection(simulation)
    print(f"  static solve           {1e3 * seconds:10.3f} ms")

    quick: dict[str, float] = {}
    for step in STEPS:
        keys = {"duration": MOST_STEPS * step, "step": step, "integrator": "implicit_euler"}
        run = scene.with_(time=keys, **{"output.every": step})
        quick |= timed(f"implicit_euler {step:g} s", run, target, error)
    damped = scene.to_dict()
    damped["loads"] = [*damped["loads"], DAMPING]
    damped["time"] = {"duration": MOST_STEPS * 1e-3, "step": 1e-3}
    damped["output"]["every"] = 1e-3
    motion = timed("as a run", der.Scenario.from_dict(damped), target, error)
    best = min(quick, key=quick.__getitem__)
    print(f"  cheapest run: {best}; {quick[best] / seconds:.0f} times the static solve")
    if motion:
        print(f"  as a run: {motion['as a run'] / seconds:.0f} times the static solve")
    print()
    return seconds


def timed(words: str, scene: der.Scenario, target: float, error: float) -> dict[str, float]:
    """Print the cost of a run to rest; return its CPU seconds by its name, or nothing if none."""
    found = time_of_run(scene, target, error)
    if found is None:
        print(f"  {words:22s}   not at rest after {MOST_STEPS} steps")
        return {}
    seconds, steps = found
    print(f"  {words:22s} {1e3 * seconds:10.3f} ms, {steps} steps")
    return {words: seconds}


def main() -> int:
    """Measure and print; returns 1 if a static solve takes longer than promised."""
    slowest = max([report(label, name) for label, name in SCENES.items()])
    return 0 if slowest < LIMIT else 1


if __name__ == "__main__":
    raise SystemExit(main())
