"""Simo and Vu-Quoc's elbow, a cantilever with a right angle, by the beam elements of Exudyn.

J. C. Simo and L. Vu-Quoc, On the dynamics in space of rods undergoing large motions (Computer
Methods in Applied Mechanics and Engineering 66, 1988). Exudyn's geometrically exact beam
(`ObjectBeamGeometricallyExact`, on nodes with rotation vectors) shears, and its sections have
inertia against tilting. Both go to zero here: with a scale `s`, the shear stiffness is
`SHEAR_STIFFNESS`/s and the tilting inertia `TILTING_INERTIA` s, and the motion is extrapolated to
s = 0. The inertia against spin about the tangent stays at `SPIN_INERTIA`. The paper's elbow shears
and resists all rotations of its sections, so that its numbers are others.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from itertools import pairwise
from typing import Any

import numpy as np

from .record import Array, Problem, Reference

LEG = 10.0  # two of them, along x and along y
AXIAL_STIFFNESS, STIFFNESS = 1e6, 1e3  # against stretching, and against bending and twisting
MASS, SPIN_INERTIA = 1.0, 0.02  # per length
SHEAR_STIFFNESS, TILTING_INERTIA = 1e6, 1e-2  # at the scale 1
FORCE = 50.0  # along z, at the elbow; it grows for a second and falls for a second
DURATION, FRAMES = 8.0, 16

FINE, COARSE = 80, 40  # elements of a leg, of the finer of two meshes
SMALL, LARGE = 0.5, 1.0  # smaller of two scales

#: Newton's method. In the first steps, with hardly bent elements, its residual stays above 1e-3
#: with 80 elements and the scale 1, and above 1e-5 with 20: with smaller tolerances it fails. A
#: tolerance of 1e-2 in place of 5e-2 changes the paths by less than 1e-8.
RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE = 1e-5, 5e-2


def force(time: float) -> float:
    """Force at the elbow."""
    return FORCE * max(0.0, 1.0 - abs(time - 1.0))


@cache
def path(elements: int, scale: float) -> Array:
    """Places of elbow and tip at even times, shape (FRAMES + 1, 2, 3).

    `elements` in each leg, five steps in the time of 1 over this number.
    """
    exudyn: Any = import_module("exudyn")
    items: Any = import_module("exudyn.itemInterface")
    system = exudyn.SystemContainer().AddSystem()
    section = exudyn.BeamSection()
    section.massPerLength = MASS
    section.inertia = np.diag([SPIN_INERTIA, TILTING_INERTIA * scale, TILTING_INERTIA * scale])
    shear = SHEAR_STIFFNESS / scale
    section.stiffnessMatrix = np.diag([AXIAL_STIFFNESS, shear, shear, *3 * [STIFFNESS]])

    def leg(place: Callable[[float], list[float]], turn: float) -> list[Any]:
        node = items.NodeRigidBodyRotVecLG
        nodes = [
            system.AddNode(node(referenceCoordinates=[*place(float(s)), 0.0, 0.0, turn]))
            for s in np.linspace(0.0, LEG, elements + 1)
        ]
        for ends in pairwise(nodes):
            system.AddObject(
                items.ObjectBeamGeometricallyExact(
                    nodeNumbers=list(ends), length=LEG / elements, sectionData=section
                )
            )
        return nodes

    first = leg(lambda s: [s, 0.0, 0.0], 0.0)
    second = leg(lambda s: [LEG, s, 0.0], 0.5 * np.pi)
    ground = system.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
    fixed = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for coordinate in range(6):
        held = items.MarkerNodeCoordinate(nodeNumber=first[0], coordinate=coordinate)
        system.AddObject(items.CoordinateConstraint(markerNumbers=[fixed, system.AddMarker(held)]))
    back = np.eye(4)  # from the section of the second leg to that of the first one
    back[:2, :2] = [[0.0, 1.0], [-1.0, 0.0]]
    ends = [
        system.AddMarker(items.MarkerNodeRigid(nodeNumber=first[-1])),
        system.AddMarker(items.MarkerNodeRigid(nodeNumber=second[0], localHT=back)),
    ]
    system.AddObject(items.GenericJoint(markerNumbers=ends, constrainedAxes=6 * [1]))
    elbow = system.AddMarker(items.MarkerNodePosition(nodeNumber=first[-1]))
    system.AddLoad(
        items.LoadForceVector(
            markerNumber=elbow,
            loadVector=[0.0, 0.0, 1.0],
            loadVectorUserFunction=lambda _, time, vector: [force(time) * x for x in vector],
        )
    )
    sensors = [
        system.AddSensor(
            items.SensorNode(
                nodeNumber=node,
                outputVariableType=exudyn.OutputVariableType.Position,
                storeInternal=True,
                writeToFile=False,
            )
        )
        for node in (first[-1], second[-1])
    ]
    system.Assemble()
    solved = exudyn.MainSolverImplicitSecondOrder().SolveSystem(system, _settings(exudyn, elements))
    paths = [np.asarray(system.GetSensorStoredData(sensor))[:, 1:] for sensor in sensors]
    if not solved or len(paths[0]) != FRAMES + 1:
        raise RuntimeError(f"elbow: Exudyn's Newton fails with {elements} elements, scale {scale}")
    return np.stack(paths, axis=1)


def _settings(exudyn: Any, elements: int) -> Any:
    settings = exudyn.SimulationSettings()
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = DURATION / FRAMES
    integration = settings.timeIntegration
    integration.endTime = DURATION
    integration.numberOfSteps = round(5 * elements * DURATION)
    integration.adaptiveStep = False
    integration.automaticStepSize = False
    integration.generalizedAlpha.spectralRadius = 0.95
    integration.newton.useModifiedNewton = False
    integration.newton.relativeTolerance = RELATIVE_TOLERANCE
    integration.newton.absoluteTolerance = ABSOLUTE_TOLERANCE
    return settings


def converged(elements: int, scale: float) -> Array:
    """Paths extrapolated to a fine mesh, of order 2, from two meshes; `elements`, of the finer."""
    return (4.0 * path(elements, scale) - path(elements // 2, scale)) / 3.0


def references() -> Problem:
    """Paths of elbow and tip."""
    small, large = converged(FINE, SMALL), converged(FINE, LARGE)
    fine = 2.0 * small - large
    coarse = 2.0 * converged(COARSE, SMALL) - converged(COARSE, LARGE)
    sheared = 2.0 * large - converged(FINE, 2.0 * LARGE)
    # Halving edges, steps or the scale makes the rest at least four times smaller.
    errors = (np.abs(fine - coarse) + np.abs(fine - sheared)) / 3.0
    times = np.linspace(0.0, DURATION, FRAMES + 1)
    values = {"times": Reference([float(t) for t in times], 1e-15, "s")}
    for k, place in enumerate(("elbow", "tip")):
        for i, axis in enumerate("xyz"):
            series = [float(x) for x in fine[:, k, i]]
            values[f"{place}.{axis}"] = Reference(series, float(errors[:, k].max()), "m")
    return Problem(
        "elbow",
        "rod from the origin along x to the elbow (10, 0, 0), and along y to the tip (10, 10, 0); "
        "clamped at the origin, EA 1e6, EI1 = EI2 = GJ = 1e3, mass 1 and inertia against spin 0.02 "
        "per length, no shear, no inertia against tilting; from rest, a force along z at the elbow "
        "of 0, 50, 0 at t = 0, 1, 2, linear in between, none after; elbow and tip at `times`",
        "Exudyn 1.13.6: 40 and 80 geometrically exact beams in each leg, generalized-alpha with "
        "spectral radius 0.95 and steps of 0.005 and 0.0025, extrapolated with order 2; shear "
        "stiffness 1e6 and 2e6 with tilting inertia 0.01 and 0.005, extrapolated linearly to none; "
        "error: a third of the largest changes from 20 and 40 beams, and from 5e5 and 1e6 with "
        "0.02 and 0.01, added",
        values,
    )
