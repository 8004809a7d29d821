"""The strip in DiSMech-Newton."""

from __future__ import annotations

from comparison import run_dismech
from comparison.scene import Config, Path
from comparison.strip import problem

ROD = run_dismech.Rod(
    length=problem.LENGTH,
    radius=0.5 * problem.THICKNESS,
    axial_stiffness=problem.AXIAL_STIFFNESS,
    bending_stiffness=problem.WEAK_STIFFNESS,
    second_bending_stiffness=problem.STRONG_STIFFNESS,
    twisting_stiffness=problem.TWISTING_STIFFNESS,
    mass_per_length=problem.DENSITY * problem.AREA,
    spin_inertia=problem.DENSITY * problem.POLAR,
    first_director=tuple(problem.ALONG_WIDTH),
    gravity=problem.GRAVITY,
)


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip."""
    return run_dismech.run(ROD, config, dimension=3)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried."""
    coarse, middle = (28, 36, 40, 44, 48, 56), (120, 136, 144, 152, 160, 176)
    return run_dismech.grid(quick, coarse, middle)
