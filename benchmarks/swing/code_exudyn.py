"""The swing in Exudyn: cubic elements ANCFCable2D, generalized-alpha.

Set for speed: its build without range checks, sparse matrices, modified Newton, and loose
tolerances where they do not harm. Tried and slower: dense matrices (above 16 elements), full
Newton, its explicit solvers (a stable RK44 costs more than ten times as much).
"""

from __future__ import annotations

import contextlib
import io
import sys
import time
from itertools import pairwise, product
from typing import Any

import numpy as np

from swing import problem
from swing.problem import Config, Path2D, RunFailedError

sys.exudynFast = True  # type: ignore[attr-defined]  # read by the import: no range checks
with contextlib.redirect_stdout(io.StringIO()):  # it greets
    import exudyn
    from exudyn import itemInterface as items

# Coordinates of a node, in its order, that a clamp holds: x, y and the slope's y. The slope's x
# stays free, since the rod stretches at the wall too.
CLAMPED = (0, 1, 3)


def run(config: Config) -> tuple[float, Path2D]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip.

    Keys besides ``elements`` and ``steps``: ``tolerance``, relative, of Newton's method;
    ``contractivity`` above which modified Newton renews its matrix; ``spectral_radius``;
    ``integration``, of the elements' energies (0: full, 2: mixed Lobatto and Gauss).
    """
    system, tip = _model(config)
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
    path = np.asarray(system.GetSensorStoredData(tip))[:, 1:3]
    if path.shape != (problem.FRAMES + 1, 2):
        raise RunFailedError(f"stopped after {len(path) - 1} frames")
    return seconds, path


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried."""
    if quick:
        return [_config(n, m, 1e-3, 0.5, 1.0, 0) for n, m in ((12, 2), (20, 3), (24, 5), (32, 10))]
    coarse = product((10, 11, 12, 14, 16, 18, 20, 22, 24), (2, 3, 4, 5))
    middle = product((24, 28, 32, 36), (4, 5, 7, 10, 14))
    fine = product((32, 34, 36, 40, 48), (10, 12, 14, 17, 20, 30, 40))
    finest = product((48, 52, 56, 64), (40, 50, 60, 80))
    schemes = list(product((1e-2, 1e-3), (0.3, 0.5), (1.0, 0.9)))
    return [
        *(_config(n, m, *s, i) for (n, m), s, i in product(coarse, schemes, (0, 2))),
        *(_config(n, m, *s, 0) for (n, m), s in product(middle, schemes)),
        *(_config(n, m, t, 0.3, r, 0) for (n, m), t, r in product(fine, (1e-3, 1e-4), (1.0, 0.9))),
        *(_config(n, m, t, 0.3, 1.0, 0) for (n, m), t in product(finest, (1e-3, 1e-4))),
    ]


def _config(
    elements: int,
    steps: int,
    tolerance: float,
    contractivity: float,
    spectral_radius: float,
    integration: int,
) -> Config:
    return {
        "elements": elements,
        "steps": steps,
        "tolerance": tolerance,
        "contractivity": contractivity,
        "spectral_radius": spectral_radius,
        "integration": integration,
    }


def _model(config: Config) -> tuple[Any, Any]:
    """Return the system and its sensor of the tip."""
    system = exudyn.SystemContainer().AddSystem()
    elements = int(config["elements"])
    edge = problem.LENGTH / elements
    nodes = [
        system.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[i * edge, 0, 1, 0]))
        for i in range(elements + 1)
    ]
    for ends in pairwise(nodes):
        cable = system.AddObject(
            items.ObjectANCFCable2D(
                nodeNumbers=list(ends),
                length=edge,
                massPerLength=problem.DENSITY * problem.AREA,
                axialStiffness=problem.YOUNGS_MODULUS * problem.AREA,
                bendingStiffness=problem.YOUNGS_MODULUS * problem.SECOND_MOMENT,
                useReducedOrderIntegration=int(config["integration"]),
            )
        )
        body = system.AddMarker(items.MarkerBodyMass(bodyNumber=cable))
        system.AddLoad(
            items.LoadMassProportional(markerNumber=body, loadVector=[0, -problem.GRAVITY, 0])
        )
    _clamp(system, nodes[0])
    tip = system.AddSensor(
        items.SensorNode(
            nodeNumber=nodes[-1],
            outputVariableType=exudyn.OutputVariableType.Position,
            storeInternal=True,
            writeToFile=False,
        )
    )
    system.Assemble()
    return system, tip


def _clamp(system: Any, node: Any) -> None:
    ground = system.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
    fixed = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for coordinate in CLAMPED:
        held = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        system.AddObject(items.CoordinateConstraint(markerNumbers=[fixed, held]))


def _settings(config: Config) -> Any:
    settings = exudyn.SimulationSettings()
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    settings.linearSolver.reuseAnalyzedPattern = True
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = problem.FRAME_TIME
    integration = settings.timeIntegration
    integration.endTime = problem.FRAMES * problem.FRAME_TIME
    integration.numberOfSteps = problem.FRAMES * problem.steps_per_frame(config)
    integration.adaptiveStep = False
    integration.automaticStepSize = False
    integration.generalizedAlpha.spectralRadius = config["spectral_radius"]
    integration.newton.useModifiedNewton = True
    integration.newton.modifiedNewtonContractivity = config["contractivity"]
    integration.newton.relativeTolerance = config["tolerance"]
    integration.newton.absoluteTolerance = 0.1 * float(config["tolerance"])
    return settings
