"""Runs of MuJoCo: options of a model, and the timed loop."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray

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
        Its key ``steps`` is used.
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
    data = start(model)
    steps = scene.steps_per_frame(config)

    def advance() -> None:
        mujoco.mj_step(model, data, steps)
        mujoco.mj_kinematics(model, data)

    return scene.march(advance, lambda: tip(data, tip_body, tip_offset)[:dimension])


def start(model: mujoco.MjModel) -> mujoco.MjData:
    """Return the data of a model at rest."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER:
        # Semi-implicit Euler is the leapfrog scheme, of second order, if the velocities start
        # half a step before the positions.
        data.qvel[:] = -0.5 * model.opt.timestep * data.qacc
    return data


def roll_out(
    model: mujoco.MjModel,
    config: Config,
    tip_body: int,
    tip_offset: float,
    dimension: int,
    members: int,
) -> tuple[float, list[Path]]:
    """Run a model many times by `mujoco.rollout` on one thread.

    Parameters
    ----------
    model, config, tip_body, tip_offset, dimension
        As in `run`.
    members
        How many times.

    Returns
    -------
    seconds, paths
        CPU seconds of the rollout, which stores the state of each step, and the path of the tip of
        each member.
    """
    data = start(model)
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    initial = np.empty((1, mujoco.mj_stateSize(model, kind)))
    mujoco.mj_getState(model, data, initial[0], kind)
    steps = scene.steps_per_frame(config)
    with rollout.Rollout(nthread=1) as batch:
        # Made before the clock starts, as all that is not stepping.
        states = np.zeros((members, scene.FRAMES * steps, initial.shape[1]))
        begun = time.process_time()
        batch.rollout(model, [mujoco.MjData(model)], np.tile(initial, (members, 1)), state=states)
        seconds = time.process_time() - begun

    def place(state: NDArray[np.float64]) -> NDArray[np.float64]:
        mujoco.mj_setState(model, data, state, kind)
        mujoco.mj_kinematics(model, data)
        return np.array(tip(data, tip_body, tip_offset)[:dimension])

    frames = states[:, steps - 1 :: steps]
    return seconds, [np.array([place(initial[0]), *map(place, own)]) for own in frames]


def tip(data: mujoco.MjData, body: int, offset: float) -> Any:
    """Return a point on the x axis of a body, so far from its origin [m]."""
    return data.xpos[body] + offset * data.xmat[body].reshape(3, 3)[:, 0]
