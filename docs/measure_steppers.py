"""Measure every stepper on the swinging rod of the quick start: the table of docs/steppers.md.

    python docs/measure_steppers.py

Prints the largest distance of the tip from the continuum's over 1 s, the energy that the scheme
gained or lost, and the CPU time.
"""

from __future__ import annotations

import json
import time

import der
import numpy as np
from make_figures import DOCS, SWING

NODES = 101
STEPPERS = (
    "implicit_euler",
    "implicit_midpoint",
    "generalized_alpha",
    "bdf2",
    "tr_bdf2",
    "verlet",
    "explicit_euler",
)


def main() -> None:
    """Print the table."""
    values = json.loads(
        (DOCS.parent / "tests/validation/references/values.json").read_text(encoding="utf-8")
    )["swing"]["values"]
    exact = np.column_stack([values[f"soft.tip.{c}"]["value"] for c in "xy"])
    scene = der.Scenario.from_dict(SWING)
    print(f"{'stepper':18} {'step [s]':>9} {'error [m]':>10} {'energy [J]':>11} {'CPU [s]':>8}")
    for stepper in STEPPERS:
        for step in (1e-3, 1e-4):
            varied = scene.with_(
                **{"rods.rod.nodes": NODES, "time.step": step, "time.integrator": stepper}
            )
            start = time.process_time()
            result = der.run(varied, check=False)
            cost = time.process_time() - start
            if result.status != "completed":
                print(f"{stepper:18} {step:9g} {result.status:>10}")
                continue
            error = np.linalg.norm(result.positions[:, -1] - exact, axis=1).max()
            energy = sum(result.energies.values())
            gained = energy[-1] - energy[0]
            print(f"{stepper:18} {step:9g} {error:10.2e} {gained:11.2e} {cost:8.3f}")


if __name__ == "__main__":
    main()
