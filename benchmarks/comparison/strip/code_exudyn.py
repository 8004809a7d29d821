"""The strip in Exudyn: geometrically exact beams on nodes with rotation vectors, generalized-alpha.

Its beam shears, and its sections have inertia against all rotations. ``shear`` is the shear
stiffness over EA, ``tilting`` the share of the inertia against tilting. With the strip's own values
it converges to a continuum 8e-4 m from the reference, with (10, 0.01) to one within 1e-4 m of it;
without inertia its mass matrix is singular. Full Newton is the fastest here. Nodes with Euler
parameters cost the same; those with three angles meet their singularity.
"""

from __future__ import annotations

from itertools import chain, pairwise, product
from typing import Any

import numpy as np

from comparison import run_exudyn
from comparison.run_exudyn import exudyn, items
from comparison.scene import Config, Path
from comparison.strip import problem

#: Pairs of `shear` and `tilting`, the strip's own ones last.
SECTIONS = ((10.0, 0.01), (1.0, 0.1), (problem.SHEAR_STIFFNESS / problem.AXIAL_STIFFNESS, 1.0))


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip.

    Keys besides those of `run_exudyn.run`: ``shear`` and ``tilting``.
    """
    return run_exudyn.run(*_model(config), config, dimension=3)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried."""
    if quick:
        return [_config(n, m, 3e-2, 0.0, 0.9, (1.0, 0.1)) for n, m in ((16, 2), (38, 2))]
    coarse = product((10, 12, 14, 16, 18, 20), (1, 2))
    middle = product((34, 36, 38, 40, 44, 48), (2, 3))
    fine = product((128, 144, 160, 176), (4, 6, 10))
    schemes = list(product((0.0, 0.5), (0.9, 0.7), SECTIONS))
    fine_schemes = product((0.0,), (0.9, 0.7), SECTIONS[:2])
    return [
        *(_config(n, m, 3e-2, *s) for (n, m), s in product(chain(coarse, middle), schemes)),
        *(_config(n, m, 1e-3, *s) for (n, m), s in product(fine, fine_schemes)),
    ]


def _config(
    elements: int,
    steps: int,
    tolerance: float,
    contractivity: float,
    spectral_radius: float,
    section: tuple[float, float],
) -> Config:
    return {
        "elements": elements,
        "steps": steps,
        "tolerance": tolerance,
        "contractivity": contractivity,
        "spectral_radius": spectral_radius,
        "shear": section[0],
        "tilting": section[1],
    }


def _model(config: Config) -> tuple[Any, Any]:
    """Return the system and its sensor of the tip."""
    system = exudyn.SystemContainer().AddSystem()
    elements = int(config["elements"])
    edge = problem.LENGTH / elements
    nodes = [
        system.AddNode(
            items.NodeRigidBodyRotVecLG(referenceCoordinates=[i * edge, 0, 0, problem.TILT, 0, 0])
        )
        for i in range(elements + 1)
    ]
    section = _section(float(config["shear"]), float(config["tilting"]))
    for ends in pairwise(nodes):
        beam = system.AddObject(
            items.ObjectBeamGeometricallyExact(
                nodeNumbers=list(ends), length=edge, sectionData=section
            )
        )
        run_exudyn.add_weight(system, beam, problem.GRAVITY)
    run_exudyn.hold(system, nodes[0], range(6))
    tip = run_exudyn.add_sensor(system, nodes[-1])
    system.Assemble()
    return system, tip


def _section(shear: float, tilting: float) -> Any:
    """Return the section; its axes are the tangent, the width and the thickness."""
    section = exudyn.BeamSection()
    section.massPerLength = problem.DENSITY * problem.AREA
    section.inertia = problem.DENSITY * np.diag(
        [problem.POLAR, tilting * problem.WEAK, tilting * problem.STRONG]
    )
    shear_stiffness = shear * problem.AXIAL_STIFFNESS
    section.stiffnessMatrix = np.diag(
        [
            problem.AXIAL_STIFFNESS,
            shear_stiffness,
            shear_stiffness,
            problem.TWISTING_STIFFNESS,
            problem.WEAK_STIFFNESS,
            problem.STRONG_STIFFNESS,
        ]
    )
    return section
