"""Runs of MuJoCo: options of a model, and the timed loop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco

from comparison import scene
from comparison.scene import Config, Path

# Nothing touches anything, and an unstable run must stay visible as one.
FLAGS = '<flag contact="disable" autoreset="disable"/>'

mujoco.set_mju_user_warning(lambda _: None)  # else it writes a log file beside the user's work


def option(config: Config, gravity: Sequence[float]) -> str:
    """Return the element ``option``: time step, ``integrator``, gravity (x, y, z) [m/s^2]."""
    return (
        f'<option timestep="{scene.time_step(config)!r}" integrator="{config["integrator"]}" '
        f'gravity="{" ".join(map(repr, gravity))}">{FLAGS}</option>'
    )


def run(
    model: mujoco.MjModel, config: Config, tip_body: int, tip_offset: float, dimension: int
) -> tuple[float, Path]:
    """Run a model.

    Parameters
    ----------
    model
        With the ``option`` of the same configuration.
    config
        Its keys ``steps`` and ``integrator`` are used.
    tip_body
        The last body.
    tip_offset
        Distance of the tip from the origin of that body, along its x axis [m].
    dimension
        How many coordinates of the tip are kept.

    Returns
    -------
    seconds, path
        CPU seconds of the time loop and the path of the tip.
    """
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    if config["integrator"] == "Euler":
        # Semi-implicit Euler is the leapfrog scheme, of second order, if the velocities start
        # half a step before the positions.
        data.qvel[:] = -0.5 * model.opt.timestep * data.qacc
    steps = scene.steps_per_frame(config)

    def advance() -> None:
        mujoco.mj_step(model, data, steps)
        mujoco.mj_kinematics(model, data)

    def tip() -> Any:
        axis = data.xmat[tip_body].reshape(3, 3)[:, 0]
        return (data.xpos[tip_body] + tip_offset * axis)[:dimension]

    return scene.march(advance, tip)
