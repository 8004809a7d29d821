"""Environments of gymnasium over batches of simulations: what a controller is learned in.

A `Task` makes a learner's problem of a scene by small functions; `RodEnv` plays one episode of it
at a time, `RodVectorEnv` many side by side, on threads::

    task = der.gym.Task(scene=..., action_space=..., act=..., observe=..., reward=...)
    envs = der.gym.RodVectorEnv(task, num_envs=500)

``gymnasium.make("der/FingerReach-v0")`` makes one of `der.gym.finger_reach`.

Requires the package gymnasium (the extra ``rl``).
"""

try:
    import gymnasium as _gymnasium
except ModuleNotFoundError:
    raise ModuleNotFoundError(
        "der.gym requires the package gymnasium: pip install gymnasium"
    ) from None

from der.gym.env import RodEnv
from der.gym.episodes import Episodes
from der.gym.task import Task
from der.gym.vector_env import RodVectorEnv

_gymnasium.register(
    id="der/FingerReach-v0",
    entry_point="der.gym.finger_reach:make_env",
    vector_entry_point="der.gym.finger_reach:make_vector_env",
)

__all__ = ["Episodes", "RodEnv", "RodVectorEnv", "Task"]
