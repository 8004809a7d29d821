"""The problem that a learner solves: a scene, and the functions that make a task of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import Space
from gymnasium.spaces import Box

from der.arguments import MOST, whole_number
from der.gym.episodes import Episodes
from der.scenario import SceneLike

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


#: Functions that a task can do without.
_OPTIONAL = ("draw", "noise", "terminate", "marks")


@dataclass(frozen=True, kw_only=True)
class Task:
    """A scene and the functions that make a learner's task of it.

    The functions take all members of a batch at once, with members as the first axis of every
    array: the batch has one member in `RodEnv`, and as many as there are environments in
    `RodVectorEnv`. They read and set it as any `Batch`.

    Attributes
    ----------
    scene
        A scene over time with equal steps, without a ``tolerance``: its duration ends an episode.
    action_space
        The space of one member. Its samples are arrays or numbers: Dict and Tuple are refused.
        Actions must be finite, and whole numbers of the space if it is one of choices, such as
        Discrete; those of a Box may lie outside of it.
    act
        ``act(batch, actions)`` sets what the actions say, before the steps of an action: by
        ``batch.set``, ``batch.prescribe``, or into ``batch.extra_force``.
    observe
        ``observe(batch)`` returns the observations, shape (members, ...).
    reward
        ``reward(batch, actions)`` returns the rewards, shape (members,), after the steps of an
        action. A member that has failed (``batch.failed``) is in its last good state.
    draw
        ``draw(generator)`` returns what differs from episode to episode, such as a target, for
        one member: ``batch.drawn`` has it.
    noise
        ``noise(batch, member, generator)`` changes the state that the episode of a member begins
        with, by ``batch.positions[member]`` and ``batch.velocities[member]``.
    terminate
        ``terminate(batch)`` tells whose episode ends after this action, truth values of shape
        (members,), beside those that failed.
    observation_space
        Of one member; unbounded numbers of double precision, unless given.
    marks
        ``marks(batch)`` returns points [m] that pictures mark, such as targets, shape (members,
        points, dim).
    steps_per_action
        How many time steps of the scene an action lasts.
    max_steps
        After how many actions an episode is truncated; at the scene's duration, unless given.
    """

    scene: SceneLike
    action_space: Space[Any]
    act: Callable[[Episodes, Any], None]
    observe: Callable[[Episodes], ArrayLike]
    reward: Callable[[Episodes, Any], ArrayLike]
    draw: Callable[[np.random.Generator], ArrayLike] | None = None
    noise: Callable[[Episodes, int, np.random.Generator], None] | None = None
    terminate: Callable[[Episodes], ArrayLike] | None = None
    marks: Callable[[Episodes], ArrayLike] | None = None
    observation_space: Box | None = None
    steps_per_action: int = 1
    max_steps: int | None = None

    def __post_init__(self) -> None:
        """Refuse numbers of steps that are none, and what is no space or no function.

        Raises
        ------
        ValueError
            If a number of steps is below 1.
        TypeError
            If one is no whole number, or anything else is of another kind.
        """
        whole_number("steps_per_action", self.steps_per_action, 1, MOST)
        if self.max_steps is not None:
            whole_number("max_steps", self.max_steps, 1, MOST)
        if not isinstance(self.action_space, Space):
            raise TypeError(
                "action_space must be a space of gymnasium, such as Box(-1.0, 1.0, (2,)), got "
                f"{self.action_space!r}"
            )
        if self.action_space.shape is None:
            raise TypeError(
                "action_space must be one of arrays or numbers, such as Box(-1.0, 1.0, (2,)), got "
                f"{self.action_space!r}: put its parts side by side in one Box, as "
                "gymnasium.spaces.flatten_space does"
            )
        if self.observation_space is not None and not isinstance(self.observation_space, Box):
            raise TypeError(
                f"observation_space must be a Box of gymnasium, got {self.observation_space!r}"
            )
        for name in ("act", "observe", "reward", *_OPTIONAL):
            function = getattr(self, name)
            if not callable(function) and not (name in _OPTIONAL and function is None):
                raise TypeError(f"{name} must be a function, got {function!r}")
