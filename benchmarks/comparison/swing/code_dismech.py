"""The swing in DiSMech-Newton."""

from __future__ import annotations

from itertools import chain, product

from comparison import run_dismech
from comparison.run_dismech import configuration
from comparison.scene import Config, Path
from comparison.swing import problem

# It stays in its plane: its resistance to twist does not count.
BENDING_STIFFNESS = problem.YOUNGS_MODULUS * problem.SECOND_MOMENT
ROD = run_dismech.Rod(
    length=problem.LENGTH,
    radius=problem.RADIUS,
    axial_stiffness=problem.YOUNGS_MODULUS * problem.AREA,
    bending_stiffness=BENDING_STIFFNESS,
    second_bending_stiffness=BENDING_STIFFNESS,
    twisting_stiffness=BENDING_STIFFNESS,
    mass_per_length=problem.DENSITY * problem.AREA,
    spin_inertia=problem.DENSITY * 2.0 * problem.SECOND_MOMENT,
    first_director=(0.0, 1.0, 0.0),
    gravity=(*problem.GRAVITY, 0.0),
)


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip."""
    return run_dismech.run(ROD, config, dimension=2)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried."""
    if quick:
        return [configuration(n, m, 2, 1) for n, m in ((20, 1), (40, 1))]
    coarse = product((14, 20, 28, 36, 44, 56), (1, 2), (2, 3), (1, 4))
    middle = product((72, 88, 104, 120, 144, 176), (2, 3, 4), (2, 3), (1,))
    fine = product((160, 240, 320), (4, 8), (2,), (1,))
    return [configuration(*parameters) for parameters in dict.fromkeys(chain(coarse, middle, fine))]
