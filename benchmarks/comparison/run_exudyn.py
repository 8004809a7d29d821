"""Runs of Exudyn: its time integration, and the parts of a model that all scenes have.

Set for speed: its build without range checks, sparse matrices, and loose tolerances where they do
not harm. Tried and slower: dense matrices (above 16 elements), its explicit solvers (a stable RK44
costs more than ten times as much).
"""

from __future__ import annotations

import contextlib
import io
import sys
import time
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from comparison.scene import (
    DURATION,
    FRAME_TIME,
    FRAMES,
    Config,
    Path,
    RunFailedError,
    steps_per_frame,
)

__all__ = ("add_sensor", "add_weight", "exudyn", "hold", "items", "run")

sys.exudynFast = True  # type: ignore[attr-defined]  # read by the import: no range checks
with contextlib.redirect_stdout(io.StringIO()):  # it greets
    import exudyn
    from exudyn import itemInterface as items


def run(system: Any, tip: Any, config: Config, dimension: int) -> tuple[float, Path]:
    """Run an assembled system with a sensor of its tip.

    Keys of a configuration besides ``elements`` and ``steps``: ``tolerance``, relative, of Newton's
    method; ``contractivity`` above which modified Newton renews its matrix (0: full Newton, which
    renews it in each iteration); ``spectral_radius``.

    Returns
    -------
    seconds, path
        CPU seconds of the time loop and the first `dimension` coordinates of the tip.
    """
    settings = _settings(config)
    solver = exudyn.MainSolverImplicitSecondOrder()
    start = time.process_time()
    try:
        solved = solver.SolveSystem(system, settings)
    except exudyn.SolverError as error:
        raise RunFailedError(str(error).strip().splitlines()[0]) from error
    seconds = time.process_time() - start
    if not solved:
        raise RunFailedError("Newton's method did not converge")
    path = np.asarray(system.GetSensorStoredData(tip))[:, 1 : 1 + dimension]
    if len(path) != FRAMES + 1:
        raise RunFailedError(f"stopped after {len(path) - 1} frames")
    return seconds, path


def add_weight(system: Any, beam: Any, gravity: Sequence[float]) -> None:
    """Let an element fall, with the acceleration `gravity` [m/s^2] (x, y, z)."""
    body = system.AddMarker(items.MarkerBodyMass(bodyNumber=beam))
    system.AddLoad(items.LoadMassProportional(markerNumber=body, loadVector=list(gravity)))


def hold(system: Any, node: Any, coordinates: Iterable[int]) -> None:
    """Keep coordinates of a node as they are."""
    ground = system.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
    fixed = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for coordinate in coordinates:
        held = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        system.AddObject(items.CoordinateConstraint(markerNumbers=[fixed, held]))


def add_sensor(system: Any, node: Any) -> Any:
    """Return a sensor of the place of a node."""
    return system.AddSensor(
        items.SensorNode(
            nodeNumber=node,
            outputVariableType=exudyn.OutputVariableType.Position,
            storeInternal=True,
            writeToFile=False,
        )
    )


def _settings(config: Config) -> Any:
    settings = exudyn.SimulationSettings()
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    settings.linearSolver.reuseAnalyzedPattern = True
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = FRAME_TIME
    integration = settings.timeIntegration
    integration.endTime = DURATION
    integration.numberOfSteps = FRAMES * steps_per_frame(config)
    integration.adaptiveStep = False
    integration.automaticStepSize = False
    integration.generalizedAlpha.spectralRadius = config["spectral_radius"]
    if config["contractivity"] == 0.0:
        integration.newton.useModifiedNewton = False
    else:
        integration.newton.useModifiedNewton = True
        integration.newton.modifiedNewtonContractivity = config["contractivity"]
    integration.newton.relativeTolerance = config["tolerance"]
    integration.newton.absoluteTolerance = 0.1 * float(config["tolerance"])
    return settings
