"""Runs of PyElastica: a clamped rod under its weight, position Verlet, no damping."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import elastica
import numpy as np
from numpy.typing import NDArray

from comparison import scene
from comparison.scene import Config, Path


class _Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing):
    """The simulation as PyElastica needs it: systems, constraints and forces."""


def run(
    rod: elastica.CosseratRod, config: Config, gravity: Sequence[float], dimension: int
) -> tuple[float, Path]:
    """Run a rod that is clamped at its start.

    Parameters
    ----------
    rod
        Not part of a simulation yet.
    config
        Its key ``steps`` is used.
    gravity
        x, y, z [m/s^2].
    dimension
        How many coordinates of the tip are kept.

    Returns
    -------
    seconds, path
        CPU seconds of the time loop and the path of the last node.
    """
    compile_kernels()
    seconds, paths = march([rod], config, gravity, dimension)
    return seconds, paths[0]


def extrapolate(path: Callable[[int], Path], quick: bool) -> Path:
    """Return what the paths of the tip for growing numbers of elements tend to, at order two."""
    fine, finest = (40, 80) if quick else (160, 320)
    coarser, finer = path(fine), path(finest)
    return finer + (finer - coarser) / 3.0


@cache
def compile_kernels() -> None:
    """Let Numba compile everything before anything is timed."""
    rod = elastica.CosseratRod.straight_rod(
        4,
        start=np.zeros(3),
        direction=np.array([1.0, 0.0, 0.0]),
        normal=np.array([0.0, 1.0, 0.0]),
        base_length=1.0,
        base_radius=0.01,
        density=1000.0,
        youngs_modulus=1e6,
        shear_modulus=4e5,
    )
    march([rod], {"steps": 200}, (0.0, 0.0, 0.0), 3)


def march(
    rods: Sequence[elastica.CosseratRod], config: Config, gravity: Sequence[float], dimension: int
) -> tuple[float, list[Path]]:
    """Run rods of one simulation, which PyElastica steps as one block of memory.

    Returns
    -------
    seconds, paths
        CPU seconds of the time loop, and the path of the last node of each rod.
    """
    simulator = _simulator(rods, gravity)
    stepper, step = elastica.PositionVerlet(), np.float64(scene.time_step(config))
    time, steps = np.float64(0.0), scene.steps_per_frame(config)

    def advance() -> None:
        nonlocal time
        for _ in range(steps):
            time = stepper.step(simulator, time, step)

    def tips() -> NDArray[np.float64]:
        return np.concatenate([rod.position_collection[:dimension, -1] for rod in rods])

    with np.errstate(all="ignore"):  # an unstable run is found out by where the tip is
        seconds, joined = scene.march(advance, tips)
    return seconds, np.split(joined, len(rods), axis=1)


def _simulator(rods: Sequence[elastica.CosseratRod], gravity: Sequence[float]) -> _Simulator:
    simulator = _Simulator()
    for rod in rods:
        simulator.append(rod)
        simulator.constrain(rod).using(
            elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
        )
        simulator.add_forcing_to(rod).using(elastica.GravityForces, acc_gravity=np.array(gravity))
    simulator.finalize()
    return simulator
