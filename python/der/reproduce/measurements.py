"""All runs behind the report, their error bars, and the exact solutions beside them."""

from __future__ import annotations

import shlex
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der._core import Scenario
from der.accuracy import Verification, verify
from der.errors import DerError, DivergedError
from der.parallel import Outcome, Task, Workers, total_weight
from der.reproduce import beam_exact
from der.reproduce.beam_exact import Tube
from der.reproduce.falling_exact import Fall, FallingChain, fall
from der.reproduce.stages import Stages
from der.result import Result
from der.scene_files import scene_file
from der.simulation import Simulation, as_static

Array = NDArray[np.float64]
Key = Hashable

#: Density of the fluid that the report's first problem is run with [kg/m^3].
WATER = 1000.0
#: With and without buoyancy [kg/m^3].
DENSITIES = (0.0, WATER)
#: The varied parameters: nodes, steps [s], loads [N].
NODES = (3, 5, 7, 9, 11, 15, 21, 31, 51, 101)
STEPS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
LOADS = (20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0, 20000.0)

#: The stages of the work, and about how many seconds each takes.
STAGES = {
    "costs of the schemes": 1.5,
    "runs": 3.0,
    "error bars": 7.0,
    "exact solutions": 4.0,
    "figures": 8.0,
}

_LONG = 50.0  # duration of the long falls [s]
_REPEATS = 3  # of the runs whose cost is measured
_TIMES = ("time.step", "time.duration", "output.every")
_DENSITY, _FORCE = "loads.1.fluid.density", "loads.0.point_force.force"
#: Run by name: a scene that comes with der, and what is changed in it.
_RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    "three": ("falling_beam_3", {}),
    "three_equal": ("falling_beam_3_equal", {}),
    "three_dry": ("falling_beam_3", {_DENSITY: 0}),
    "three_long": ("falling_beam_3", {"time.duration": _LONG, "output.every": 0.05}),
    "three_unstable": ("falling_beam_3_explicit_unstable", {"output.every": 1e-4}),
    "five": ("falling_beam_5", {}),
    "five_buoyant": ("falling_beam_5", {_DENSITY: WATER}),
    "five_long": ("falling_beam_5", {"time.duration": _LONG, "output.every": 0.05}),
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
_FAILS = "three_unstable"
#: The runs whose cost is measured, one at a time.
_COSTS: dict[str, tuple[str, dict[str, Any]]] = {
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


@dataclass(frozen=True)
class Deflection:
    """A deflection of the tube at the end of a run, downward, with its error bar [m].

    The bar is that of the equilibrium by `der.verify`, plus what the run is off from it.
    """

    value: float
    error_bar: float


@dataclass(frozen=True)
class Speed:
    """The speed of the middle sphere at the end of a run, downward, and its error bar [m/s]."""

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
    exact_deflections, exact_middles
        The same of the continuum [m] by place of the load [m] and load [N].
    """

    runs: dict[str, Result]
    verifications: dict[str, Verification]
    speeds_by_nodes: dict[tuple[int, float], float]
    speeds_by_step: dict[tuple[float, float], float]
    deflections: dict[float, Deflection]
    middles: dict[float, Deflection]
    explicit_seconds: float
    implicit_seconds: float
    stable_step: float
    exact_falls: dict[str, Fall]
    exact_start: Fall
    exact_deflections: dict[float, dict[float, float]]
    exact_middles: dict[float, dict[float, float]]


def measure(jobs: int | None, stages: Stages) -> Measurements:
    """Run and solve everything.

    Parameters
    ----------
    jobs
        Runs at once; as many as the machine has cores, unless given.
    stages
        Told how far it is.

    Raises
    ------
    ValueError
        For less than one job.
    """
    workers = Workers(jobs, stages.of("runs"))
    explicit, implicit = _measure_costs(stages)
    outcomes = _run_all(workers)
    runs = {name: _result(outcomes[name], fails=name == _FAILS) for name in _RUNS}
    runs["three_explicit"] = explicit
    tell = stages.of("error bars", 0, 2)
    verifications = {}
    for i, name in enumerate(_VERIFIED):
        verifications[name] = verify(_scene(*_RUNS[name]), jobs=jobs)
        tell((i + 1) / len(_VERIFIED))
    deflections, middles = _deflections(outcomes, jobs, stages)
    exact_falls, exact_start = _solve_falls(runs, stages)
    exact_beams = _solve_beams(stages)
    return Measurements(
        runs=runs,
        verifications=verifications,
        speeds_by_nodes={
            (n, density): _speed(outcomes["nodes", n, density])
            for n in NODES
            for density in DENSITIES
        },
        speeds_by_step={
            (step, density): _speed(outcomes["step", step, density])
            for step in STEPS
            for density in DENSITIES
        },
        deflections=deflections,
        middles=middles,
        explicit_seconds=float(explicit.summary["wall_seconds"]),
        implicit_seconds=float(implicit.summary["wall_seconds"]),
        stable_step=_largest_accepted_step(),
        exact_falls=exact_falls,
        exact_start=exact_start,
        exact_deflections={
            place: {load: sag.largest for load, sag in sags.items()}
            for place, sags in exact_beams.items()
        },
        exact_middles={
            place: {load: sag.middle for load, sag in sags.items()}
            for place, sags in exact_beams.items()
        },
    )


def _scene(name: str, changes: Mapping[str, Any]) -> Scenario:
    return Scenario.load(scene_file(name), **changes)


def _result(outcome: Outcome[Result], *, fails: bool = False) -> Result:
    if not fails:
        return outcome.value()
    if not isinstance(outcome.error, DivergedError) or outcome.result is None:
        raise DerError("the explicit scheme with steps of 1e-4 s should diverge and has not")
    return outcome.result


def _speed(outcome: Outcome[Result]) -> float:
    return -float(outcome.value().summary["probes"]["v_mid"]["final"])


def _measure_costs(stages: Stages) -> tuple[Result, Result]:
    """Run both schemes of the first problem, one at a time; return explicit and implicit."""
    workers = Workers(1, stages.of("costs of the schemes"))
    tasks = {
        name: Task([_scene(*_COSTS[name])], weight=weight, repeats=_REPEATS)
        for name, weight in (("three_explicit", 1.0), ("three_implicit", 0.01))
    }
    workers.expect(total_weight(tasks.values()))
    outcomes = workers.run(tasks)
    return outcomes["three_explicit"].value(), outcomes["three_implicit"].value()


def _all_runs() -> dict[Key, tuple[str, dict[str, Any]]]:
    """Return scene and changes of every run: of those with a name, and of those that vary."""
    runs: dict[Key, tuple[str, dict[str, Any]]] = {}
    for name, run in (_RUNS | _COSTS).items():
        runs[name] = run
    for density in DENSITIES:
        for nodes in NODES:
            runs["nodes", nodes, density] = ("falling_beam_5", _chain(nodes, density))
        for step in STEPS:
            every = step * max(1, round(0.05 / step))
            changes = {"time.step": step, "output.every": every, _DENSITY: density}
            runs["step", step, density] = ("falling_beam_21", changes)
    for load in LOADS:
        runs["load", load] = ("simply_supported", {_FORCE: [0, -load]})
    return runs


def _run_all(workers: Workers) -> dict[Key, Outcome[Result]]:
    scenes = {key: _scene(*run) for key, run in _all_runs().items() if key not in _COSTS}
    tasks = {key: Task([scene], weight=_weight(scene)) for key, scene in scenes.items()}
    workers.expect(total_weight(tasks.values()))
    return workers.run(tasks)


def _chain(nodes: int, density: float) -> dict[str, Any]:
    """Return what makes the scene with 5 nodes one with any number of nodes, over 50 s."""
    return {
        "rods.rod.nodes": nodes,
        "rods.rod.spheres.0.radius": 0.1 * FallingChain(nodes).edge,
        _DENSITY: density,
        "time.duration": _LONG,
        "output.every": 0.05,
    }


def _weight(scene: Scenario) -> float:
    tree = scene.to_dict()
    return float(tree["rods"][0]["nodes"] * scene.duration / tree["time"]["step"])


def _deflections(
    outcomes: Mapping[Key, Outcome[Result]], jobs: int | None, stages: Stages
) -> tuple[dict[float, Deflection], dict[float, Deflection]]:
    """Return the largest deflection, and that of the centre node, by load."""
    tell = stages.of("error bars", 1, 2)
    by_probe: dict[str, dict[float, Deflection]] = {"deflection": {}, "middle": {}}
    for i, load in enumerate(LOADS):
        run = outcomes["load", load].value()
        verified = verify(as_static(run.scenario), jobs=jobs)
        for probe, found in by_probe.items():
            value = -float(run.summary["probes"][probe]["final"])
            rest = verified[probe]
            found[load] = Deflection(value, rest.error_bar + abs(value + rest.value))
        tell((i + 1) / len(LOADS))
    return by_probe["deflection"], by_probe["middle"]


def _largest_accepted_step() -> float:
    """Return the largest step [s] of the explicit scheme that der does not refuse, by bisection."""
    scene = _scene("falling_beam_3_explicit", {})
    low, high = 1e-5, 1e-3  # taken, refused
    while high - low > 1e-6 * low:
        middle = 0.5 * (low + high)
        try:
            Simulation(scene.with_(**dict.fromkeys(_TIMES, middle)))
        except DerError as error:
            if error.status != "unstable_step":
                raise
            high = middle
        else:
            low = middle
    return low


def _solve_falls(runs: Mapping[str, Result], stages: Stages) -> tuple[dict[str, Fall], Fall]:
    chains = {
        "three": FallingChain(3, WATER),
        "five": FallingChain(5, 0.0),
        "five_buoyant": FallingChain(5, WATER),
    }
    falls = {}
    for i, (name, chain) in enumerate(chains.items()):
        falls[name] = fall(chain, runs[name].times)
        stages.of("exact solutions", i, len(chains) + 1)(1.0)
    return falls, fall(chains["three"], np.linspace(0.0, runs[_FAILS].times[-1], 200))


def _solve_beams(stages: Stages) -> dict[float, dict[float, beam_exact.Deflection]]:
    """Solve for the load at its place, and at the nodes of the mesh to both sides of it."""
    places = (Tube().load_at, *nodes_beside_the_load())
    found = {
        place: dict(
            zip(LOADS, beam_exact.elastica_deflections(Tube(load_at=place), LOADS), strict=True)
        )
        for place in places
    }
    stages.of("exact solutions")(1.0)
    return found


def nodes_beside_the_load() -> tuple[float, float]:
    """Return the arc lengths [m] of the nodes of the report's mesh between which the load acts."""
    tree = _scene("simply_supported", {}).to_dict()
    edge = Tube().length / (tree["rods"][0]["nodes"] - 1)
    left = edge * np.floor(Tube().load_at / edge)
    return float(left), float(left + edge)


def command_of(run: Key) -> str:
    """Return the command that does a run in a checkout.

    Runs have a name, or are of the sets ``("nodes", nodes, density)``, ``("step", step, density)``
    and ``("load", load)``.
    """
    scene, changes = _all_runs()[run]
    sets = [shlex.quote(f"{path}={value}") for path, value in changes.items()]
    return " ".join([f"der_run configs/{scene}.yaml", *(f"--set {change}" for change in sets)])
