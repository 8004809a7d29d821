"""Episodes of a task, side by side: what both kinds of environment share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.spaces import Box

from der.gym.actions import check_actions
from der.gym.episodes import Episodes
from der.gym.task import Task
from der.scenario import load

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Outcome:
    """The outcome of an action; the first axis of each array is that of members.

    Attributes
    ----------
    observations, rewards, terminated, truncated
        As gymnasium defines them.
    infos
        By member, for those that have something to tell.
    """

    observations: NDArray[Any]
    rewards: NDArray[np.float64]
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    infos: dict[int, dict[str, Any]]


class Play:
    """Episodes of a task, one for each member of a batch.

    Attributes
    ----------
    batch
        The episodes.
    space
        Of the observations of one member.
    limits
        The numbers of actions after which the episodes of each member are truncated, shape
        (members,).
    """

    def __init__(
        self,
        task: Task,
        members: int,
        threads: int | None = None,
        vary: Mapping[str, ArrayLike | Sequence[Any]] | None = None,
    ) -> None:
        if not isinstance(task, Task):
            raise TypeError(f"an environment plays a der.gym.Task, got {task!r}")
        self._task = task
        scenario = load(task.scene)
        if scenario.is_static:
            raise ValueError(
                "an episode is a run over time, and the scene is static: give it a time with a "
                "duration and a step in place of its analysis"
            )
        any_generator = np.random.default_rng(0)
        self._drawn_shape = () if task.draw is None else np.shape(task.draw(any_generator))
        drawn_shape = (0,) if task.draw is None else self._drawn_shape
        self.batch = Episodes(scenario, members, threads, vary=vary, drawn_shape=drawn_shape)
        for failure in self.batch.failures:
            raise failure.error()
        self.limits = _limits(task, self.batch)
        seen = self._rows("observe", task.observe(self.batch), dtype=None)
        self.space = task.observation_space or Box(-np.inf, np.inf, seen.shape[1:], np.float64)
        self._check_observed(seen)

    def begin(self, members: Iterable[int], generators: Sequence[np.random.Generator]) -> None:
        """Let members begin episodes; `generators` has one for every member of the batch."""
        members = list(members)
        if not members:
            return
        self.batch.reset(members)
        self.batch.played[members] = 0
        for member in members:
            if self._task.draw is not None:
                self.batch.drawn[member] = self._drawn(self._task.draw(generators[member]))
            if self._task.noise is not None:
                self._task.noise(self.batch, member, generators[member])

    def observations(self) -> NDArray[Any]:
        """Return what the members observe now, a copy."""
        seen = self._rows("observe", self._task.observe(self.batch), self.space.dtype)
        self._check_observed(seen)
        return seen

    def step(self, actions: NDArray[Any]) -> Outcome:
        """Let every member take its action."""
        task, batch = self._task, self.batch
        check_actions(task.action_space, actions)
        task.act(batch, actions)
        batch.step(task.steps_per_action)
        batch.played += 1
        ended = batch.failed.copy()
        if task.terminate is not None:
            ended |= self._ends(task.terminate(batch))
        return Outcome(
            self.observations(),
            self._rows("reward", task.reward(batch, actions), np.float64, ndim=1),
            ended,
            batch.played >= self.limits,
            {
                failure.member: {"failure": failure.status, "failure_message": failure.message}
                for failure in batch.failures
            },
        )

    def _ends(self, returned: ArrayLike) -> NDArray[np.bool_]:
        """Return whose episode the task ends; other numbers than 0 and 1 are a slip."""
        ends = self._rows("terminate", returned, dtype=None, ndim=1)
        if ends.dtype.kind not in "biu" or not np.isin(ends, (0, 1)).all():
            raise ValueError(
                f"terminate returned {returned!r}: it returns truth values, one for each member"
            )
        return ends.astype(np.bool_)

    def _check_observed(self, seen: NDArray[Any]) -> None:
        if seen.shape[1:] == self.space.shape:
            return
        whence = "first call" if self._task.observation_space is None else "observation space"
        raise ValueError(
            f"observe: a member's observation has the shape {seen.shape[1:]}, but that of the "
            f"{whence} is {self.space.shape}"
        )

    def _drawn(self, drawn: ArrayLike) -> NDArray[np.float64]:
        """Return what was drawn for a member, which always has one shape."""
        values = _as_array("draw", drawn, np.float64)
        if drawn is None or values.shape != self._drawn_shape:
            raise ValueError(
                f"draw returned {drawn!r}: it returns numbers of one shape, as the "
                f"{self._drawn_shape} of its first call"
            )
        return values

    def _rows(
        self, function: str, returned: ArrayLike, dtype: Any, ndim: int | None = None
    ) -> NDArray[Any]:
        rows = _as_array(function, returned, dtype)
        members = len(self.batch)
        if rows.ndim < 1 or len(rows) != members or (ndim is not None and rows.ndim != ndim):
            raise ValueError(
                f"{function} returned the shape {rows.shape} for {members} members: the first "
                f"axis is that of members{', and there is no other' if ndim == 1 else ''}"
            )
        return rows


def _as_array(function: str, returned: ArrayLike, dtype: Any) -> NDArray[Any]:
    """Return what a function of a task has returned as an array of its own."""
    try:
        return np.array(returned, dtype=dtype)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{function} returned {returned!r}, which is no array of numbers: {error}"
        ) from None


def _limits(task: Task, batch: Episodes) -> NDArray[np.int64]:
    """Return how many actions an episode of each member may have."""
    steps = batch.total_steps
    _check_equal_steps(steps)
    if task.max_steps is not None:
        return np.full_like(steps, task.max_steps)
    limits: NDArray[np.int64] = steps // task.steps_per_action
    if (limits == 0).any():
        member = int(np.argmin(limits))
        raise ValueError(
            f"the scene of environment {member} ends after {steps[member]} of the "
            f"{task.steps_per_action} time steps of an action: give it a longer duration or "
            "shorter steps, or the task fewer steps_per_action or max_steps"
        )
    return limits


def _check_equal_steps(steps: NDArray[np.int64]) -> None:
    """Refuse scenes with a tolerance: an action of a number of their steps has no fixed length."""
    adaptive = np.flatnonzero(steps == 0)
    if adaptive.size:
        raise ValueError(
            "an action lasts a number of equal time steps, and the scene of environment "
            f"{adaptive[0]} has steps of other lengths: give it 'step' in place of 'tolerance' in "
            "its 'time'"
        )
