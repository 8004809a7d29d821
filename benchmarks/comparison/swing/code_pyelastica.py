"""The swing in PyElastica: a Cosserat rod, position Verlet, no damping.

Its clamp holds the first node and the direction of the first element, which so acts as a rigid
piece of half its length. The rod therefore starts half an element inside the wall; without that its
error is 20 to 40 times larger.

Its rod is another continuum than the reference: it shears, has rotary inertia, and its stiffness
falls as it stretches, since its volume is kept. That moves its limit by 2.5e-3 m (2.0e-3 m with a
shear modulus four times as large, at a shorter stable step), so it cannot come closer to the
reference. `limit` gives what it does converge to.
"""

from __future__ import annotations

import elastica
import numpy as np

from comparison import run_pyelastica
from comparison.scene import Config, Path
from comparison.swing import problem

GRAVITY = (*problem.GRAVITY, 0.0)


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip."""
    return run_pyelastica.run(rod(int(config["elements"])), config, GRAVITY, dimension=2)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried, each at its largest stable step."""
    elements = (10, 20, 30) if quick else (8, 10, 12, 16, 20, 24, 30, 40, 50, 60, 80, 120, 160, 200)
    return [{"elements": n, "steps": "fewest"} for n in elements]


def limit(quick: bool) -> Path:
    """Return the tip that its rod converges to."""
    return run_pyelastica.extrapolate(lambda n: run({"elements": n, "steps": 2 * n + 60})[1], quick)


def rod(elements: int) -> elastica.CosseratRod:
    """Return the rod, which is not part of a simulation yet."""
    edge = problem.LENGTH / (elements - 0.5)
    return elastica.CosseratRod.straight_rod(
        elements,
        start=np.array([-0.5 * edge, 0.0, 0.0]),
        direction=np.array([1.0, 0.0, 0.0]),
        normal=np.array([0.0, 1.0, 0.0]),
        base_length=elements * edge,
        base_radius=problem.RADIUS,
        density=problem.DENSITY,
        youngs_modulus=problem.YOUNGS_MODULUS,
        shear_modulus=problem.YOUNGS_MODULUS / 3.0,  # incompressible, as its stretching is
    )
