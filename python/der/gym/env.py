"""One rod as an environment of gymnasium."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded

from der.gym.episodes import Episodes
from der.gym.play import Play
from der.gym.screen import Screen
from der.gym.task import Task

if TYPE_CHECKING:
    from numpy.typing import NDArray


class RodEnv(gymnasium.Env["NDArray[Any]", Any]):
    """An environment of gymnasium that plays one episode of a task at a time.

    An episode is terminated where the task says so, and where the simulation fails: the info then
    has ``failure``, the short name of why, and ``failure_message``. It is truncated at the scene's
    duration, or after `Task.max_steps`.

    Parameters
    ----------
    task
        What is played.
    render_mode
        ``"rgb_array"``, or None for an environment that draws no pictures.

    Raises
    ------
    SceneError, DerError
        Where the scene cannot be simulated from its start.
    ValueError
        Where a function of the task returns something of another shape than it should.
    """

    metadata = {"render_modes": ["rgb_array"]}  # noqa: RUF012, as in the base

    def __init__(self, task: Task, render_mode: str | None = None) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode must be 'rgb_array' or None, got {render_mode!r}")
        self._play = Play(task, members=1, threads=1)
        self.action_space = task.action_space
        self.observation_space = self._play.space
        self._running = False
        self._marks = task.marks
        self._screen: Screen | None = None
        self.render_mode = render_mode
        actions = int(self.batch.total_steps[0]) / task.steps_per_action
        self.metadata = {**self.metadata, "render_fps": actions / self.batch.scenario(0).duration}

    @property
    def batch(self) -> Episodes:
        """The simulation, a batch of one member."""
        return self._play.batch

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        """Begin an episode.

        Parameters
        ----------
        seed
            Of what is drawn, in this episode and those after it; None: go on drawing.
        options
            Not used.

        Returns
        -------
        tuple
            The observation, and an empty info.
        """
        super().reset(seed=seed)
        self._play.begin([0], [self.np_random])
        self._running = True
        return self._play.observations()[0], {}

    def render(self) -> NDArray[np.uint8] | None:
        """Return the picture of the present state, shape (height, width, 3).

        The axes never change: there is as much room around the start as half the length of all
        rods. Points of `Task.marks` are rings. None without a `render_mode`.
        """
        if self.render_mode is None:
            return None
        if self._screen is None:
            self._screen = Screen(self.batch)
        marked = np.empty(0) if self._marks is None else np.asarray(self._marks(self.batch))
        return self._screen.draw(self.batch, marked.reshape(-1, self.batch.model.dimension))

    def step(self, action: Any) -> tuple[NDArray[Any], float, bool, bool, dict[str, Any]]:
        """Take an action.

        Returns
        -------
        tuple
            Observation, reward, whether the episode is terminated, whether truncated, info.

        Raises
        ------
        gymnasium.error.ResetNeeded
            Before the first `reset`, and after the end of an episode.
        ValueError
            For an action of another shape than the action space has, with numbers that are not
            finite, or that is none of a space of choices.
        """
        if not self._running:
            raise ResetNeeded("an episode begins with reset()")
        space = self.action_space.shape
        if space is not None and np.shape(action) != space:
            raise ValueError(f"an action has the shape {space}, got {np.shape(action)}")
        outcome = self._play.step(np.asarray(action)[np.newaxis])
        terminated, truncated = bool(outcome.terminated[0]), bool(outcome.truncated[0])
        self._running = not (terminated or truncated)
        return (
            outcome.observations[0],
            float(outcome.rewards[0]),
            terminated,
            truncated,
            outcome.infos.get(0, {}),
        )
