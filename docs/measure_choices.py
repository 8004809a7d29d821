"""Measure what docs/choosing.md says about meshes, analyses and solvers.

    python docs/measure_choices.py [mesh] [modes] [analysis] [solver]

CPU times are those of whole runs in this process, the reading of the scene left out.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import der
import numpy as np
from make_figures import ARM, CONFIGS, TUBE
from measure_steppers import print_tables, reference, scene, tip_error

NODES = (11, 21, 41, 81)
# First natural frequency of a cantilever over sqrt(EI/(mu L^4)), squared: 1.8751...^2.
CANTILEVER = 1.875104068711961**2


def load(config: str, **changes: Any) -> der.Scenario:
    """Return a scene of configs/, varied."""
    return der.load(CONFIGS / config, **changes)


def measured(run: Callable[[], Any], times: int) -> tuple[Any, float]:
    """Return what the last of several calls gives, and the least CPU time of one [s]."""
    best = np.inf
    for _ in range(times):
        start = time.process_time()
        result = run()
        best = min(best, time.process_time() - start)
    return result, best


def tip(nodes: int, factor: float, curvature: str) -> float:
    """Return the error of the tip's height of a cantilever under factor EI/L^2, over L."""
    config, probe, path = ARM
    exact = {1.0: -0.3017207738, 10.0: -0.8106090249}[factor]
    varied = load(
        config,
        **{
            "rods.arm.nodes": nodes,
            "rods.arm.curvature": curvature,
            "rods.arm.cross_section.stiffness.EA": 1e8,  # the reference does not stretch
            path: -factor,
        },
    )
    return abs(float(der.equilibrium(varied).probes[probe][0]) - exact)


def tube(nodes: int) -> float:
    """Return the error of the deflection of the tube under 2 kN, over L."""
    config, probe, _ = TUBE
    found = der.equilibrium(load(config, **{"rods.beam.nodes": nodes})).probes[probe][0]
    return abs(float(found) + 0.03771401492)


def frequency(nodes: int) -> float:
    """Return the relative error of the first natural frequency of a cantilever."""
    modes = der.run(load("beam_modes.yaml", **{"rods.0.nodes": nodes})).modes
    rod = der.Model(load("beam_modes.yaml")).rods[0]
    masses = der.Simulation(load("beam_modes.yaml")).node_masses
    unit = np.sqrt(rod.EI / (masses.sum() / rod.length * rod.length**4)) / (2.0 * np.pi)
    assert modes is not None
    return abs(float(modes.frequencies[0]) / (CANTILEVER * unit) - 1.0)


def swing(nodes: int) -> float:
    """Return the largest error of the tip of the swinging rod, over L, steps of 0.2 ms."""
    fine = scene("soft", nodes, step=2e-4, integrator="implicit_midpoint")
    return tip_error(der.run(fine), reference("soft"))


def mesh() -> None:
    """Errors against elements, relative to the rod's length or frequency."""
    columns: dict[str, Callable[[int], float]] = {
        "P L^2/EI = 1": lambda n: tip(n, 1.0, "angle"),
        "= 10": lambda n: tip(n, 10.0, "angle"),
        "= 10, tangent": lambda n: tip(n, 10.0, "tangent"),
        "tube, 2 kN": tube,
        "frequency": frequency,
        "swing": swing,
    }
    print(f"{'elements':>8}" + "".join(f" {name:>14}" for name in columns))
    for nodes in NODES:
        print(f"{nodes - 1:8}" + "".join(f" {error(nodes):14.1e}" for error in columns.values()))


def modes() -> None:
    """Relative errors of the first bending frequencies of a cantilever, by elements."""

    def frequencies(elements: int) -> Any:
        found = der.run(load("beam_modes.yaml", **{"rods.0.nodes": elements + 1})).modes
        assert found is not None
        return found.frequencies[:4]

    exact = frequencies(320)
    print(f"{'elements':>8}" + "".join(f" {f'k = {k}':>8}" for k in range(1, 5)))
    for elements in (4, 8, 12, 16):
        errors = np.abs(frequencies(elements) / exact - 1.0)
        print(f"{elements:8}" + "".join(f" {error:8.1e}" for error in errors))


def analysis() -> None:
    """Compare ways to the tube at rest under 2 kN, 51 nodes: solved, damped out over time."""
    solved = load("simply_supported.yaml")
    start = load("simply_supported.yaml")
    runs: dict[str, Callable[[], Any]] = {
        "analysis: static": lambda: der.equilibrium(solved),
        "time, as in the scene (1 s)": lambda: der.run(start),
        "time, tr_bdf2, 5 s": lambda: der.run(
            start.with_(**{"time.integrator": "tr_bdf2", "time.duration": 5})
        ),
    }
    for name, run in runs.items():
        result, cost = measured(run, 5)
        error = abs(float(result.probes["deflection"][-1]) + 0.03773769469330)
        print(f"{name:30} off the equilibrium by {error:7.1e} m, CPU {1e3 * cost:7.2f} ms")


def solver() -> None:
    """CPU times of the tube's run over 1 s, by linear solver."""
    names = ("banded", "simplicial_ldlt", "cholmod")
    print(f"{'nodes':>8}" + "".join(f" {name:>16}" for name in names))
    for nodes in (51, 201, 801):
        line = f"{nodes:8}"
        for name in names:
            varied = load(
                "simply_supported.yaml", **{"rods.beam.nodes": nodes, "solver": {"linear": name}}
            )
            try:
                _, cost = measured(lambda varied=varied: der.run(varied), 3)
                line += f" {1e3 * cost:13.1f} ms"
            except der.DerError:
                line += f" {'not built in':>16}"
        print(line)


TABLES: dict[str, Callable[[], None]] = {
    "mesh": mesh,
    "modes": modes,
    "analysis": analysis,
    "solver": solver,
}


if __name__ == "__main__":
    print_tables(TABLES, __doc__)
