"""Discrete elastic rods: fast, accurate simulation of slender elastic structures.

Run a scene file and look at what came out::

    import der

    result = der.run("configs/simply_supported.yaml")
    print(result.probes["deflection"][-1], result.probes["deflection"].unit)
    result.plot().savefig("beam.png")

Or drive the same engine step by step::

    simulation = der.Simulation(der.load("configs/cantilever.yaml"))
    while not simulation.finished:
        simulation.extra_force[-1, 1] = -1.0
        simulation.step()

All quantities are in SI units.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from der._core import (
    Counters,
    Energies,
    EquilibriumReport,
    HeldNode,
    Model,
    OutOfPlane,
    Quantity,
    Rod,
    Scenario,
    SpringSupport,
    State,
    StepperInfo,
    __version__,
    held_nodes,
    json_schema,
    loops,
    quantities,
    scene_reference,
    springs,
    steppers,
)
from der.accuracy import (
    ErrorEstimate,
    Study,
    StudyRow,
    Verification,
    VerifiedValue,
    study,
    verify,
)
from der.actuation_forces import ActuationForce
from der.analyses import BucklingModes, Modes, Path
from der.batch import Batch, MemberFailure
from der.errors import (
    DerError,
    DerWarning,
    Diagnostic,
    DivergedError,
    NotConvergedError,
    SceneError,
    UnreliableResultWarning,
)
from der.examples import examples
from der.exporting import export
from der.playing import play
from der.probe_series import ProbeSeries
from der.reactions import Reaction
from der.recording import Recording
from der.result import Result
from der.run_folder_reader import open_run
from der.scenario import load
from der.simulation import Simulation, continuation, equilibrium, run
from der.sweeps import Sweep, load_sweep, sweep
from der.viewing import view

if TYPE_CHECKING:
    from der.animation import animate
    from der.plotting import plot

__all__ = [
    "ActuationForce",
    "Batch",
    "BucklingModes",
    "Counters",
    "DerError",
    "DerWarning",
    "Diagnostic",
    "DivergedError",
    "Energies",
    "EquilibriumReport",
    "ErrorEstimate",
    "HeldNode",
    "MemberFailure",
    "Model",
    "Modes",
    "NotConvergedError",
    "OutOfPlane",
    "Path",
    "ProbeSeries",
    "Quantity",
    "Reaction",
    "Recording",
    "Result",
    "Rod",
    "Scenario",
    "SceneError",
    "Simulation",
    "SpringSupport",
    "State",
    "StepperInfo",
    "Study",
    "StudyRow",
    "Sweep",
    "UnreliableResultWarning",
    "Verification",
    "VerifiedValue",
    "__version__",
    "animate",
    "continuation",
    "equilibrium",
    "examples",
    "export",
    "held_nodes",
    "json_schema",
    "load",
    "load_sweep",
    "loops",
    "open_run",
    "play",
    "plot",
    "quantities",
    "run",
    "scene_reference",
    "springs",
    "steppers",
    "study",
    "sweep",
    "verify",
    "view",
]


def __getattr__(name: str) -> Any:
    """Load matplotlib, which takes long, only when something is drawn."""
    if name == "plot":
        from der.plotting import plot

        return plot
    if name == "animate":
        from der.animation import animate

        return animate
    raise AttributeError(f"module 'der' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
