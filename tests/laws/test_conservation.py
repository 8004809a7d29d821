"""Momentum, angular momentum and energy of rods that nothing holds, with every stepper.

What the table of docs/steppers.md promises is kept to rounding: momentum by all, angular momentum
by some where sections do not twist, energy by `energy_momentum`. What is not is lost with the order
of the stepper, 2 at most where sections twist.
"""

from __future__ import annotations

import copy
import functools

import der
import numpy as np
import pytest
from laws.scenes import SOLVER, free_rods

DURATION = 0.1
#: Of its size: roundings of some hundred steps, and what Newton's method leaves of their forces.
KEPT = 2e-12
#: Of its size: what is less may change its sign from step to step, and has no order.
LITTLE = 1e-7
ROOM = 0.3

CASES = [
    pytest.param(name, stepper, id=f"{name}-{stepper.name}")
    for name in free_rods()
    for stepper in der.steppers()
    if "planar" in name or stepper.name != "energy_momentum"
]


@functools.cache
def lost(name: str, stepper: str, steps: int) -> dict[str, float]:
    """By how much a free rod has changed after the duration, over the sizes of what it has."""
    scene = copy.deepcopy(free_rods()[name])
    scene["time"] = {"duration": DURATION, "step": DURATION / steps, "integrator": stepper}
    simulation = der.Simulation(der.Scenario.from_dict({**scene, "solver": SOLVER}))
    momentum, angular = np.array(simulation.momentum), np.array(simulation.angular_momentum)
    energy = simulation.energies.total
    simulation.step(steps)
    size = float(simulation.node_masses @ np.linalg.norm(simulation.velocities, axis=1))
    reach = float(np.linalg.norm(simulation.positions, axis=1).max())
    return {
        "momentum": float(np.abs(simulation.momentum - momentum).max()) / size,
        "angular momentum": float(np.abs(simulation.angular_momentum - angular).max())
        / (size * reach),
        "energy": abs(simulation.energies.total - energy) / energy,
    }


def steps(stepper: der.StepperInfo) -> int:
    return 1000 if stepper.name == "implicit_euler" else 200 if stepper.implicit else 400


@pytest.mark.parametrize(("name", "stepper"), CASES)
def test_what_is_promised_is_kept(name: str, stepper: der.StepperInfo) -> None:
    loss = lost(name, stepper.name, steps(stepper))
    assert loss["momentum"] < KEPT
    if stepper.keeps_angular_momentum and not name.endswith("-spatial"):
        assert loss["angular momentum"] < KEPT
    if stepper.name == "energy_momentum":
        assert loss["energy"] < KEPT


@pytest.mark.parametrize(("name", "stepper"), CASES)
def test_what_is_lost_falls_with_the_order_of_the_stepper(
    name: str, stepper: der.StepperInfo
) -> None:
    coarse, fine = (lost(name, stepper.name, k * steps(stepper)) for k in (1, 4))
    for what in ("angular momentum", "energy"):
        if fine[what] > LITTLE:
            order = np.log(coarse[what] / fine[what]) / np.log(4)
            assert order > min(stepper.order, 2) - ROOM, what


def test_the_rods_turn_and_vibrate() -> None:
    """So that there is something to lose: each exchanges its energies, and has angular momentum."""
    for name, scene in free_rods().items():
        time = {"duration": DURATION, "step": DURATION / 100}
        simulation = der.Simulation(der.Scenario.from_dict({**scene, "time": time}))
        kinetic = simulation.energies.kinetic
        assert np.abs(simulation.angular_momentum).max() > 1e-2, name
        simulation.step(50)
        assert abs(simulation.energies.kinetic / kinetic - 1.0) > 1e-4, name
