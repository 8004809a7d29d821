"""The task ``der/FingerReach-v0``: the tip of a soft finger is to reach a target and stay there.

docs/tutorials/learning.md describes it, and learns it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from der.gym.env import RodEnv
from der.gym.episodes import Episodes
from der.gym.task import Task
from der.gym.vector_env import RodVectorEnv

Array = NDArray[np.float64]

STEP = 0.01  # s
PERIOD = 5 * STEP  # s: the controller's
CURVATURE = 40.0  # 1/m: the largest of a chamber, either way
RATE = 400.0  # 1/(m s): how fast a valve can change it

FINGER: dict[str, Any] = {
    "title": "A finger of two chambers",
    "rods": [
        {
            "name": "finger",
            "nodes": 11,
            "from": [0, 0],
            "to": [0.12, 0],
            "cross_section": {"rectangle": {"width": 0.014, "height": 0.01}},
            "material": {"youngs_modulus": 1.5e6, "density": 1100},
        }
    ],
    "supports": [{"rod": "finger", "at": "start", "clamp": True}],
    "actuation": [
        {"name": "base", "rod": "finger", "from": 0.0, "to": 0.06, "natural_curvature": 0},
        {"name": "tip", "rod": "finger", "from": 0.06, "to": 0.12, "natural_curvature": 0},
    ],
    "loads": [{"gravity": [0, -9.81]}, {"damping": {"coefficient": 0.3}}],
    "start_from": "equilibrium",
    "time": {"duration": 1, "step": STEP, "integrator": "tr_bdf2"},
}


def curvatures(batch: Episodes) -> Array:
    """Return the natural curvatures of base and tip [1/m], shape (members, 2)."""
    return np.stack([batch.value("base"), batch.value("tip")], axis=1)


def act(batch: Episodes, actions: Array) -> None:
    """Open the valves: an action of 1 changes a curvature at the full rate."""
    change = RATE * PERIOD * np.clip(actions, -1.0, 1.0)
    aims = np.clip(curvatures(batch) + change, -CURVATURE, CURVATURE)
    batch.set("base", aims[:, 0], over=PERIOD)
    batch.set("tip", aims[:, 1], over=PERIOD)


def observe(batch: Episodes) -> Array:
    """Return the way to the target, the tip's velocity and place, the curvatures, all near 1."""
    tips, speeds = batch.positions[:, -1], batch.velocities[:, -1]
    parts = [(batch.drawn - tips) / 0.05, speeds, tips / 0.05, curvatures(batch) / CURVATURE]
    return np.concatenate(parts, axis=1)


def reward(batch: Episodes, actions: Array) -> Array:
    """Return minus the distance from the tip to the target [cm]."""
    return np.asarray(-100.0 * np.linalg.norm(batch.positions[:, -1] - batch.drawn, axis=1))


def draw(generator: np.random.Generator) -> Array:
    """Draw a target [m] that the tip can reach."""
    angle, distance = generator.uniform([-1.1, 0.075], [0.9, 0.105])
    return np.array([distance * np.cos(angle), distance * np.sin(angle)])


REACHING = Task(
    scene=FINGER,
    action_space=Box(-1.0, 1.0, (2,), np.float64),
    act=act,
    observe=observe,
    reward=reward,
    draw=draw,
    marks=lambda batch: batch.drawn[:, np.newaxis],
    steps_per_action=5,
)


def make_env(render_mode: str | None = None) -> RodEnv:
    """Return the environment that ``gymnasium.make`` makes."""
    return RodEnv(REACHING, render_mode)


def make_vector_env(num_envs: int, **options: Any) -> RodVectorEnv:
    """Return the environments that ``gymnasium.make_vec`` makes; options of `RodVectorEnv`."""
    return RodVectorEnv(REACHING, num_envs, **options)
