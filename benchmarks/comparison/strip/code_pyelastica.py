"""The strip in PyElastica: a Cosserat rod, position Verlet, no damping.

Its rods are round; the stiffnesses and moments of inertia of a rod of the same area are replaced by
those of the strip. The rod starts half an element inside the wall, as in the swing.

Its rod is another continuum than the reference, for the reasons said there, and converges to one
2.5e-3 m from it; shear and axial stiffnesses several times as large bring it no closer than 1.8e-3
m. `limit` gives what it does converge to.

Its largest stable step is that of sections that tilt against their shear. ``tilting`` multiplies
their inertia, which permits longer steps and moves the limit.
"""

from __future__ import annotations

from itertools import product

import elastica
import numpy as np

from comparison import run_pyelastica
from comparison.scene import Config, Path
from comparison.strip import problem


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip."""
    return run_pyelastica.run(_rod(config), config, problem.GRAVITY, dimension=3)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried, each at its largest stable step."""
    if quick:
        return [_config(n, 1.0) for n in (10, 20)]
    coarse = product((8, 10, 12, 14, 16, 20, 24, 28, 32, 36, 40, 44, 48, 56), (1.0, 2.0, 3.0))
    fine = product((64, 80, 100, 120, 160, 200), (1.0,))
    return [_config(n, tilting) for n, tilting in (*coarse, *fine)]


def limit(quick: bool) -> Path:
    """Return the tip that its rod converges to."""
    return run_pyelastica.extrapolate(
        lambda n: run({**_config(n, 1.0), "steps": 2 * n + 100})[1], quick
    )


def _config(elements: int, tilting: float) -> Config:
    return {"elements": elements, "tilting": tilting, "steps": "fewest"}


def _rod(config: Config) -> elastica.CosseratRod:
    elements, tilting = int(config["elements"]), float(config["tilting"])
    edge = problem.LENGTH / (elements - 0.5)
    rod = elastica.CosseratRod.straight_rod(
        elements,
        start=np.array([-0.5 * edge, 0.0, 0.0]),
        direction=np.array([1.0, 0.0, 0.0]),
        normal=problem.ALONG_WIDTH,
        base_length=elements * edge,
        base_radius=np.sqrt(problem.AREA / np.pi),
        density=problem.DENSITY,
        youngs_modulus=problem.YOUNGS_MODULUS,
        shear_modulus=problem.SHEAR_MODULUS,
    )
    # Its axes: the width, the thickness, the tangent.
    for axis, (shearing, bending, inertia) in enumerate(
        (
            (problem.SHEAR_STIFFNESS, problem.WEAK_STIFFNESS, tilting * problem.WEAK),
            (problem.SHEAR_STIFFNESS, problem.STRONG_STIFFNESS, tilting * problem.STRONG),
            (problem.AXIAL_STIFFNESS, problem.TWISTING_STIFFNESS, problem.POLAR),
        )
    ):
        rod.shear_matrix[axis, axis] = shearing
        rod.bend_matrix[axis, axis] = bending
        rod.mass_second_moment_of_inertia[axis, axis] = problem.DENSITY * inertia * edge
        rod.inv_mass_second_moment_of_inertia[axis, axis] = 1.0 / (problem.DENSITY * inertia * edge)
    return rod
