"""The swing in DiSMech-Newton."""

from __future__ import annotations

from comparison import run_dismech
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
    coarse, middle = (14, 20, 28, 36, 44, 56), (72, 88, 104, 120, 144, 176)
    return run_dismech.grid(quick, coarse, middle)
