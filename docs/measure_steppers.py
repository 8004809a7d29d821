"""Measure every stepper: the tables of docs/steppers.md.

    python docs/measure_steppers.py [swing] [tolerance] [energy] [wire] [drag]

CPU times are those of the whole run in this process, the reading of the scene left out.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from typing import Any

import der
import numpy as np
from make_figures import DOCS, SWING
from numpy.typing import NDArray

Floats = NDArray[np.float64]
IMPLICIT = [info.name for info in der.steppers() if info.implicit]
EVERY = 0.01


def reference(case: str) -> Floats:
    """Tip of the continuum at 0, 0.01 .. 1 s [m], shape (101, 2)."""
    path = DOCS.parent / "tests/validation/references/values.json"
    values = json.loads(path.read_text(encoding="utf-8"))["swing"]["values"]
    return np.column_stack([values[f"{case}.tip.{c}"]["value"] for c in "xy"])


def scene(case: str, nodes: int, **timing: Any) -> der.Scenario:
    """Return a clamped rod that swings down from horizontal: ``soft`` or ``wire``."""
    swing = {**SWING, "time": {"duration": 1.0, **timing}, "output": {"every": EVERY}}
    rod = {**SWING["rods"][0], "nodes": nodes}
    if case == "wire":
        rod["cross_section"] = {"circle": {"radius": 0.001}}
        rod["material"] = {"youngs_modulus": 200e9, "density": 7850}
    return der.Scenario.from_dict({**swing, "rods": [rod]})


def measured(scenario: der.Scenario) -> tuple[der.Result, float]:
    """Run it; the result, and the CPU seconds that it took."""
    start = time.process_time()
    result = der.run(scenario, check=False)
    return result, time.process_time() - start


def tip_error(result: der.Result, exact: Floats) -> float:
    """Largest distance of the tip from `exact` [m]."""
    return float(np.linalg.norm(result.positions[:, -1] - exact, axis=1).max())


def swing() -> None:
    """Error and cost on the soft rod, 51 nodes."""
    exact = reference("soft")
    print(f"{'stepper':18} {'step [s]':>9} {'error [m]':>10} {'lost [J]':>10} {'CPU [s]':>8}")
    for info in der.steppers():
        steps: tuple[float | str, ...] = (5e-3, 1e-3, 2e-4) if info.implicit else ("auto",)
        for step in steps:
            result, cost = measured(scene("soft", 51, step=step, integrator=info.name))
            print(
                f"{info.name:18} {result.summary['step']:9.2g} {tip_error(result, exact):10.1e} "
                f"{result.work['numerical'][-1]:10.1e} {cost:8.4f}"
            )


def tolerance() -> None:
    """Error in time against the requested tolerance, 51 nodes."""
    fine = scene("soft", 51, step=1e-4, integrator="sdirk5")
    tight = {"solver.residual_tolerance": 1e-12, "solver.step_tolerance": 1e-13}
    exact = der.run(fine.with_(**tight)).positions[:, -1]
    head = f"{'stepper':18} {'tolerance':>9} {'error [m]':>10} {'steps':>6} {'again':>6}"
    print(f"{head} {'CPU [s]':>8}")
    for name in IMPLICIT[1:]:
        for asked in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
            result, cost = measured(scene("soft", 51, tolerance=asked, integrator=name))
            counts = result.summary
            print(
                f"{name:18} {asked:9.0e} {tip_error(result, exact):10.1e} {counts['steps']:6} "
                f"{counts['rejected_steps']:6} {cost:8.4f}"
            )


def energy() -> None:
    """Energy that the steppers take from the undamped swing, 21 nodes, 2e-4 s.

    100 s, and 1000 s for those of second order that do not damp.
    """
    print("energy gone from the sum of all [J], largest so far; negative: made")
    times = (1.0, 10.0, 30.0, 100.0, 300.0, 1000.0)
    print(f"{'stepper':18}" + "".join(f" {f'{t:g} s':>9}" for t in times))
    for info in der.steppers():
        duration = 1000.0 if info.order == 2 and info.damping == "none" else 100.0
        scenario = scene("soft", 21, step=2e-4, integrator=info.name)
        result, _ = measured(scenario.with_(**{"time.duration": duration, "output.every": 0.1}))
        lost = result.work["numerical"]
        extremes = [max(lost[result.times <= t + 1e-9], key=abs) for t in times if t <= duration]
        print(f"{info.name:18}" + "".join(f" {e:9.1e}" for e in extremes))


def wire() -> None:
    """Cost and error on a steel wire, 41 nodes: implicit at 1 ms, explicit at its stable step."""
    exact = reference("wire")
    print(f"{'stepper':18} {'step [s]':>9} {'error [m]':>10} {'CPU [s]':>8}")
    for info in der.steppers():
        step: float | str = 1e-3 if info.implicit else "auto"
        result, cost = measured(scene("wire", 41, step=step, integrator=info.name))
        print(
            f"{info.name:18} {result.summary['step']:9.2g} {tip_error(result, exact):10.1e} "
            f"{cost:8.3f}"
        )


def drag() -> None:
    """Error on 21 spheres that sink in a stiff fluid for 2 s (configs/falling_beam_21.yaml)."""
    spheres = der.load(DOCS.parent / "configs/falling_beam_21.yaml").with_(
        **{"time.duration": 2.0, "output.every": 0.1}
    )
    fine = der.run(spheres.with_(**{"time.integrator": "tr_bdf2", "time.step": 1e-4}))
    print(f"{'stepper':18} {'step [s]':>9} {'y [m]':>8} {'v [m/s]':>8}")
    for name in IMPLICIT:
        for step in (0.1, 0.01):
            result = der.run(spheres.with_(**{"time.integrator": name, "time.step": step}))
            off = {
                p: np.abs(result.probes[p] - fine.probes[p])[2:].max() for p in ("y_mid", "v_mid")
            }
            print(f"{name:18} {step:9g} {off['y_mid']:8.1e} {off['v_mid']:8.1e}")


TABLES: dict[str, Callable[[], None]] = {
    "swing": swing,
    "tolerance": tolerance,
    "energy": energy,
    "wire": wire,
    "drag": drag,
}


def print_tables(tables: dict[str, Callable[[], None]], description: str | None) -> None:
    """Print those of the tables that the command line names, or all, under what they say."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"of {', '.join(tables)}")
    names = parser.parse_args().tables
    if unknown := set(names) - set(tables):
        parser.error(f"no table {', '.join(sorted(unknown))}; there is {', '.join(tables)}")
    for name in names or tables:
        print(f"\n{tables[name].__doc__}\n")
        tables[name]()


if __name__ == "__main__":
    print_tables(TABLES, __doc__)
