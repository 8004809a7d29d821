"""Many rods, side by side, as a vector environment of gymnasium."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from der.arguments import MOST, whole_number
from der.gym.episodes import Episodes
from der.gym.play import Outcome, Play
from der.gym.task import Task

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class RodVectorEnv(VectorEnv["NDArray[Any]", Any, "NDArray[Any]"]):
    """A vector environment of gymnasium: episodes of a task, stepped side by side by threads.

    Each environment has the observations and rewards that `RodEnv` has with its seed, to the last
    bit, whatever the number of threads, as long as the task's functions treat members apart. One
    whose simulation fails is terminated, as in `RodEnv`, and stops no other.

    Parameters
    ----------
    task
        What is played.
    num_envs
        How many.
    threads
        How many threads step them; as many as this process may use, unless given.
    vary
        Values of the scene that differ between the environments, as `Batch` takes them.
    autoreset_mode
        When an environment whose episode has ended begins the next: in the step after it, which
        takes no action and has the reward 0 (``NEXT_STEP``); in the same step, whose info then has
        ``final_obs`` and ``final_info`` (``SAME_STEP``); or by ``reset`` with the option
        ``reset_mask`` (``DISABLED``). ``metadata["autoreset_mode"]`` tells it.

    Raises
    ------
    SceneError, DerError
        Where the scene of an environment cannot be simulated from its start.
    ValueError
        Where a function of the task returns something of another shape than it should.
    """

    def __init__(
        self,
        task: Task,
        num_envs: int,
        threads: int | None = None,
        *,
        vary: Mapping[str, ArrayLike | Sequence[Any]] | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    ) -> None:
        num_envs = whole_number("num_envs", num_envs, 1, MOST)
        self._mode = _as_mode(autoreset_mode)
        self._play = Play(task, num_envs, threads, vary)
        self.metadata = {"autoreset_mode": self._mode}
        self.num_envs = num_envs
        self.single_action_space = task.action_space
        self.action_space = batch_space(task.action_space, num_envs)
        self.single_observation_space = self._play.space
        self.observation_space = batch_space(self._play.space, num_envs)
        self._generators: list[np.random.Generator] = []
        self._ended = np.zeros(num_envs, dtype=np.bool_)

    @property
    def batch(self) -> Episodes:
        """The simulations."""
        return self._play.batch

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        """Begin episodes.

        Parameters
        ----------
        seed
            Of what the environments draw: a list with one for each, or the number of the first,
            from which they count. None: each goes on drawing.
        options
            ``reset_mask``: which environments begin, shape (num_envs,); all, unless given.

        Returns
        -------
        tuple
            The observations of all environments, and an empty info.
        """
        chosen = self._chosen(options)
        for member, own in enumerate(self._seeds(seed)):
            if len(self._generators) == member:
                self._generators.append(seeding.np_random(own)[0])
            elif own is not None and chosen[member]:
                self._generators[member] = seeding.np_random(own)[0]
        self._begin(chosen)
        self._ended &= ~chosen
        return self._play.observations(), {}

    def step(
        self, actions: Any
    ) -> tuple[
        NDArray[Any], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]
    ]:
        """Take an action in every environment.

        Returns
        -------
        tuple
            Observations, rewards, which episodes are terminated, which truncated, infos.

        Raises
        ------
        gymnasium.error.ResetNeeded
            Before the first `reset`; without automatic resets also where an episode has ended.
        ValueError
            For actions of another shape than the action space has, with numbers that are not
            finite, or that are none of a space of choices.
        """
        if not self._generators:
            raise ResetNeeded("episodes begin with reset()")
        if self._mode is AutoresetMode.DISABLED and self._ended.any():
            raise ResetNeeded(
                f"the episodes of {np.flatnonzero(self._ended).tolist()} have ended: "
                'reset(options={"reset_mask": ...}) begins the next ones'
            )
        space = self.action_space.shape
        if space is not None and np.shape(actions) != space:
            raise ValueError(
                f"actions have the shape {space}, one of each environment, got {np.shape(actions)}"
            )
        outcome = self._play.step(np.asarray(actions))
        infos: dict[str, Any] = {}
        if self._mode is AutoresetMode.NEXT_STEP:
            self._begin_instead(self._ended, outcome)
        self._ended = outcome.terminated | outcome.truncated
        if self._mode is AutoresetMode.SAME_STEP:
            infos = self._begin_at_once(self._ended, outcome)
        for member, info in outcome.infos.items():
            infos = self._add_info(infos, info, member)
        return (
            outcome.observations,
            outcome.rewards,
            outcome.terminated,
            outcome.truncated,
            infos,
        )

    def _begin(self, chosen: NDArray[np.bool_]) -> None:
        self._play.begin(np.flatnonzero(chosen).tolist(), self._generators)

    def _begin_instead(self, chosen: NDArray[np.bool_], outcome: Outcome) -> None:
        """Let some begin episodes in place of the action that they took with all others."""
        if not chosen.any():
            return
        self._begin(chosen)
        outcome.observations[chosen] = self._play.observations()[chosen]
        outcome.rewards[chosen] = 0.0
        outcome.terminated[chosen] = outcome.truncated[chosen] = False
        for member in np.flatnonzero(chosen).tolist():
            outcome.infos.pop(member, None)

    def _begin_at_once(self, chosen: NDArray[np.bool_], outcome: Outcome) -> dict[str, Any]:
        """Let some begin episodes after the last action of the ones before; return its infos."""
        infos: dict[str, Any] = {}
        if not chosen.any():
            return infos
        for member in np.flatnonzero(chosen).tolist():
            last = {
                "final_obs": outcome.observations[member].copy(),
                "final_info": outcome.infos.pop(member, {}),
            }
            infos = self._add_info(infos, last, member)
        self._begin(chosen)
        outcome.observations[chosen] = self._play.observations()[chosen]
        return infos

    def _chosen(self, options: dict[str, Any] | None) -> NDArray[np.bool_]:
        if not (options is None or isinstance(options, Mapping)):
            raise TypeError(
                f'options must be a dict such as {{"reset_mask": ...}}, got {options!r}'
            )
        mask = (options or {}).get("reset_mask")
        if mask is None:
            return np.ones(self.num_envs, dtype=np.bool_)
        chosen = np.asarray(mask)
        if chosen.shape != (self.num_envs,) or chosen.dtype != np.bool_:
            raise ValueError(
                f"reset_mask is an array of {self.num_envs} truth values, one for each "
                f"environment, not one of {chosen.dtype} with the shape {chosen.shape}"
            )
        return chosen

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, (int, np.integer)):
            first = whole_number("seed", seed, 0)
            return [first + member for member in range(self.num_envs)]
        if isinstance(seed, str) or not isinstance(seed, Iterable):
            raise TypeError(f"seed must be a whole number or a list of them, got {seed!r}")
        seeds = [None if own is None else whole_number("a seed", own, 0) for own in seed]
        if len(seeds) != self.num_envs:
            raise ValueError(f"{len(seeds)} seeds for {self.num_envs} environments: give one each")
        return seeds


def _as_mode(given: AutoresetMode | str) -> AutoresetMode:
    try:
        return AutoresetMode(given)
    except ValueError:
        modes = ", ".join(repr(mode.value) for mode in AutoresetMode)
        raise ValueError(f"autoreset_mode must be one of {modes}, got {given!r}") from None
