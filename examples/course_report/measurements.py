"""All runs behind the report, their error bars, and the exact solutions beside them."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import der
import numpy as np
from der.simulation import as_static
from references.extensible_beam import Deflection as ExactDeflection
from references.falling_spheres import Fall, FallingRod

from . import exact

SCENES = Path(__file__).resolve().parents[2] / "configs"

#: Density of the fluid that the report's first problem is run with [kg/m^3].
WATER = 1000.0
#: With and without buoyancy [kg/m^3].
DENSITIES = (0.0, WATER)
#: The varied parameters: nodes, steps [s], loads [N].
NODES = (3, 5, 7, 9, 11, 15, 21, 31, 51, 101)
STEPS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
LOADS = (20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0, 20000.0)

Changes = dict[str, Any]
_REPEATS = 3  # of the runs whose cost is measured
_TIMES = ("time.step", "time.duration", "output.every")
_DENSITY = "loads.1.fluid.density"
_LONG: Changes = {"time.duration": 50.0, "output.every": 0.05}
#: Run by name: its scene in ``configs/``, and what is changed in it.
_NAMED: dict[str, tuple[str, Changes]] = {
    "three": ("falling_beam_3", {}),
    "three_equal": ("falling_beam_3_equal", {}),
    "three_dry": ("falling_beam_3", {_DENSITY: 0}),
    "three_long": ("falling_beam_3", _LONG),
    "three_unstable": ("falling_beam_3_explicit_unstable", {"output.every": 1e-4}),
    "five": ("falling_beam_5", {}),
    "five_buoyant": ("falling_beam_5", {_DENSITY: WATER}),
    "five_long": ("falling_beam_5", _LONG),
    "twenty_one": ("falling_beam_21", {}),
    "twenty_one_buoyant": ("falling_beam_21", {_DENSITY: WATER}),
    "twenty_one_coarse": ("falling_beam_21", {"time.step": STEPS[-1], "output.every": STEPS[-1]}),
    "fifty_one": ("falling_beam_51", {}),
    "fifty_one_buoyant": ("falling_beam_51", {_DENSITY: WATER}),
    "beam": ("simply_supported", {}),
    "beam_20kN": ("simply_supported_20kN", {}),
    # The motion that the equations have, with a step that resolves it.
    "beam_swing": (
        "simply_supported",
        {
            "time.integrator": "implicit_midpoint",
            "time.step": 1e-4,
            "time.duration": 0.3,
            "output.every": 5e-4,
        },
    ),
}
#: The runs whose cost is measured.
_COSTS: dict[str, tuple[str, Changes]] = {
    "three_explicit": ("falling_beam_3_explicit", {}),
    "three_implicit": ("falling_beam_3", {}),
}
#: The runs of which numbers stand in the table.
_VERIFIED = (
    "three",
    "three_equal",
    "three_long",
    "five",
    "five_buoyant",
    "five_long",
    "twenty_one",
    "twenty_one_buoyant",
    "twenty_one_coarse",
)


class Deflection(NamedTuple):
    """A deflection of the tube at the end of a run, downward, with its error bar [m].

    The bar is that of the equilibrium by `der.verify`, plus what the run is off from it.
    """

    value: float
    error_bar: float


@dataclass(frozen=True)
class Measurements:
    """The runs and solutions behind the report.

    Attributes
    ----------
    runs
        Results by name.
    verifications
        Error bars by `der.verify` for the scenes of some of them.
    speeds_by_nodes, speeds_by_step
        Speed of the middle sphere after 50 s [m/s], downward, by number of nodes or step [s], and
        density of the fluid [kg/m^3].
    deflections, middles
        Largest deflection, and that of the centre node, by load [N].
    explicit_seconds, implicit_seconds
        Least wall time of the two schemes of the first problem [s].
    stable_step
        Largest step [s] that der takes for the explicit scheme.
    exact_falls
        Exact solutions by the name of the run.
    exact_start
        The exact first milliseconds of the unstable run.
    exact_beams
        Exact deflections by place of the load [m] and load [N].
    """

    runs: dict[str, der.Result]
    verifications: dict[str, der.Verification]
    speeds_by_nodes: dict[tuple[int, float], float]
    speeds_by_step: dict[tuple[float, float], float]
    deflections: dict[float, Deflection]
    middles: dict[float, Deflection]
    explicit_seconds: float
    implicit_seconds: float
    stable_step: float
    exact_falls: dict[str, Fall]
    exact_start: Fall
    exact_beams: dict[float, dict[float, ExactDeflection]]


def measure(begin: Callable[[str], None]) -> Measurements:
    """Run and solve everything; `begin` is told the name of each stage."""
    begin("costs of the schemes")
    costs = {name: min((_run(name) for _ in range(_REPEATS)), key=_seconds) for name in _COSTS}
    begin("runs")
    done = {key: _run(key) for key in _all_runs() if key not in _COSTS}
    runs = {name: done[name] for name in _NAMED} | {"three_explicit": costs["three_explicit"]}
    begin("error bars")
    verifications = {name: der.verify(runs[name].scenario) for name in _VERIFIED}
    deflections, middles = _deflections({load: done["load", load] for load in LOADS})
    begin("exact solutions")
    chains = {
        "three": FallingRod(3, WATER),
        "five": FallingRod(5, 0.0),
        "five_buoyant": FallingRod(5, WATER),
    }
    start = np.linspace(0.0, runs["three_unstable"].times[-1], 200)
    return Measurements(
        runs=runs,
        verifications=verifications,
        speeds_by_nodes={(n, d): _speed(done["nodes", n, d]) for n in NODES for d in DENSITIES},
        speeds_by_step={(s, d): _speed(done["step", s, d]) for s in STEPS for d in DENSITIES},
        deflections=deflections,
        middles=middles,
        explicit_seconds=_seconds(costs["three_explicit"]),
        implicit_seconds=_seconds(costs["three_implicit"]),
        stable_step=_largest_accepted_step(),
        exact_falls={name: exact.fall(chain, runs[name].times) for name, chain in chains.items()},
        exact_start=exact.fall(chains["three"], start),
        exact_beams={
            place: exact.deflections(LOADS, place)
            for place in (exact.LOAD_AT, *nodes_beside_the_load())
        },
    )


def _all_runs() -> dict[Hashable, tuple[str, Changes]]:
    """Return scene and changes of every run: of those with a name, and of those that vary."""
    runs: dict[Hashable, tuple[str, Changes]] = dict([*_NAMED.items(), *_COSTS.items()])
    for density in DENSITIES:
        for nodes in NODES:
            radius = 0.1 * FallingRod(nodes).edge
            chain = {"rods.rod.nodes": nodes, "rods.rod.spheres.0.radius": radius}
            runs["nodes", nodes, density] = (
                "falling_beam_5",
                {**chain, _DENSITY: density, **_LONG},
            )
        for step in STEPS:
            every = step * max(1, round(0.05 / step))
            changes = {"time.step": step, "output.every": every, _DENSITY: density}
            runs["step", step, density] = ("falling_beam_21", changes)
    for load in LOADS:
        runs["load", load] = ("simply_supported", {"loads.0.point_force.force": [0, -load]})
    return runs


def command_of(run: Hashable) -> str:
    """Return the command that does a run in a checkout.

    Runs have a name, or are of the sets ``("nodes", nodes, density)``, ``("step", step, density)``
    and ``("load", load)``.
    """
    scene, changes = _all_runs()[run]
    sets = [shlex.quote(f"{path}={value}") for path, value in changes.items()]
    return " ".join([f"der run configs/{scene}.yaml", *(f"--set {change}" for change in sets)])


def scene_of(run: Hashable) -> der.Scenario:
    """Return the scene of a run, as `command_of` names it."""
    scene, changes = _all_runs()[run]
    return der.Scenario.load(SCENES / f"{scene}.yaml", **changes)


def _run(run: Hashable) -> der.Result:
    fails = run == "three_unstable"
    result = der.Simulation(scene_of(run)).run(check=not fails, warns=False)
    if fails and result.status != "diverged":
        raise der.DerError("the explicit scheme with steps of 1e-4 s should diverge and has not")
    return result


def _seconds(result: der.Result) -> float:
    return float(result.summary["wall_seconds"])


def _speed(result: der.Result) -> float:
    return -float(result.summary["probes"]["v_mid"]["final"])


def _deflections(
    runs: dict[float, der.Result],
) -> tuple[dict[float, Deflection], dict[float, Deflection]]:
    """Return the largest deflection, and that of the centre node, by load."""
    largest: dict[float, Deflection] = {}
    middle: dict[float, Deflection] = {}
    for load, run in runs.items():
        verified = der.verify(as_static(run.scenario))
        for probe, found in (("deflection", largest), ("middle", middle)):
            value = -float(run.summary["probes"][probe]["final"])
            rest = verified[probe]
            found[load] = Deflection(value, rest.error_bar + abs(value + rest.value))
    return largest, middle


def _largest_accepted_step() -> float:
    """Return the largest step [s] of the explicit scheme that der does not refuse, by bisection."""
    scene = scene_of("three_explicit")
    low, high = 1e-5, 1e-3  # taken, refused
    while high - low > 1e-6 * low:
        middle = 0.5 * (low + high)
        try:
            der.Simulation(scene.with_(**dict.fromkeys(_TIMES, middle)))
        except der.DerError as error:
            if error.status != "unstable_step":
                raise
            high = middle
        else:
            low = middle
    return low


def nodes_beside_the_load() -> tuple[float, float]:
    """Return the arc lengths [m] of the nodes of the report's mesh between which the load acts."""
    rod = scene_of("beam").to_dict()["rods"][0]
    edge = (rod["to"][0] - rod["from"][0]) / (rod["nodes"] - 1)
    left = edge * np.floor(exact.LOAD_AT / edge)
    return float(left), float(left + edge)
