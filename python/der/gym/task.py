"""The problem that a learner solves: a scene, and the functions that make a task of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import Space
from gymnasium.spaces import Box

from der.gym.episodes import Episodes
from der.simulation import SceneLike

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, kw_only=True)
class Task:
    """A scene and the functions that make a learner's task of it.

    The functions take all members of a batch at once, with members as the first axis of every
    array: the batch has one member in `RodEnv`, and as many as there are environments in
    `RodVectorEnv`. They read and set it as any `Batch`.

    Attributes
    ----------
    scene
        A scene over time with equal steps: its duration ends an episode.
    action_space
        Of one member; its samples are arrays or numbers.
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
        ``terminate(batch)`` tells whose episode ends after this action, shape (members,), beside
        those that failed.
    observation_space
        Of one member; unbounded numbers of double precision, unless given.
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
    observation_space: Box | None = None
    steps_per_action: int = 1
    max_steps: int | None = None

    def __post_init__(self) -> None:
        """Refuse numbers of steps below one.

        Raises
        ------
        ValueError
            If there is one.
        """
        for name in ("steps_per_action", "max_steps"):
            number = getattr(self, name)
            if number is not None and number < 1:
                raise ValueError(f"{name} must be at least 1, not {number}")
