"""Running many scenarios at once, over threads: the engine steps without the interpreter's lock."""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Hashable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from der._core import Scenario
from der.errors import DerError
from der.progress import ProgressFunction
from der.result import Result
from der.simulation import Simulation

#: Status of a run that was cancelled.
TOO_LONG = "too_long"

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Task:
    """A run that is wanted.

    Attributes
    ----------
    scenarios
        The scenarios to try: the second is run if the first fails, and so on.
    weight
        Predicted cost, in any unit: the costly tasks are started first.
    repeats
        How many times to run it, to measure its cost.
    keep_motion
        Whether positions and velocities are wanted, which take most of the memory; without them
        those of the result are empty.
    max_seconds
        CPU time after which a run is cancelled and counts as failed, with the status ``too_long``.
    start
        Positions of the nodes to start from [m], shape (nodes, dim); None: as the scene says.
    """

    scenarios: Sequence[Scenario]
    weight: float = 1.0
    repeats: int = 1
    keep_motion: bool = True
    max_seconds: float = math.inf
    start: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Outcome:
    """How a run went.

    Attributes
    ----------
    result
        The recorded data, of a failed run up to its last good step; None if it did not start.
    error
        Why it failed; None if it did not.
    cpu_seconds
        CPU time of building the simulation and running it [s], the least of the repeats.
    """

    result: Result | None
    error: DerError | None
    cpu_seconds: float

    def value(self) -> Result:
        """Return the result of a run that did not fail; raise the error of one that did."""
        if self.error is not None:
            raise self.error
        assert self.result is not None
        return self.result


class Workers:
    """Runs tasks over some threads.

    Parameters
    ----------
    jobs
        Runs at once; as many as the machine has cores, unless given.
    progress
        Told what share of the work announced with `expect` is done.

    Raises
    ------
    ValueError
        If `jobs` is not a whole number of at least 1.
    """

    def __init__(self, jobs: int | None = None, progress: ProgressFunction | None = None) -> None:
        if jobs is not None and (not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1):
            raise ValueError(f"jobs must be a whole number of at least 1, got {jobs!r}")
        self._jobs = jobs or os.cpu_count() or 1
        self._progress = progress
        self._lock = threading.Lock()
        self._expected = 0.0
        self._later = 0.0
        self._done = 0.0
        self._stop = threading.Event()

    def expect(self, weight: float, later: float = 0.0) -> None:
        """Announce work, in the unit of `Task.weight`, so that progress counts it from now on.

        Parameters
        ----------
        weight
            Weight of the tasks that are run next.
        later
            A guess of what will be announced after them; it holds until the next call.
        """
        self._expected += weight
        self._later = later

    def run(self, tasks: Mapping[Key, Task], *, jobs: int | None = None) -> dict[Key, Outcome]:
        """Run all tasks and return their outcomes by key; a failed run is an outcome as well.

        Parameters
        ----------
        tasks
            The tasks to run. All must be announced with `expect` first, or the progress is ahead
            of the work; a task of weight 0 needs no announcement.
        jobs
            In place of that of the constructor: 1 to measure costs undisturbed.
        """
        order = sorted(tasks, key=lambda key: -tasks[key].weight)
        with ThreadPoolExecutor(jobs or self._jobs) as pool:
            futures = {key: pool.submit(self._run_task, tasks[key]) for key in order}
            try:
                return {key: futures[key].result() for key in tasks}
            except BaseException:  # Ctrl-C above all: the others stop at their next tick
                self._stop.set()
                pool.shutdown(cancel_futures=True)
                raise

    def _run_task(self, task: Task) -> Outcome:
        shown = _Share(self, task.weight)
        for scenario in task.scenarios:
            outcome = min(
                (
                    self._run_once(task, scenario, shown.part(repeat, task.repeats))
                    for repeat in range(task.repeats)
                ),
                key=lambda outcome: outcome.cpu_seconds,
            )
            if not task.keep_motion:
                outcome = _without_motion(outcome)
            if outcome.error is None:
                break
        shown(1.0)
        return outcome

    def _run_once(self, task: Task, scenario: Scenario, shown: ProgressFunction) -> Outcome:
        start = time.thread_time()

        def tick(share: float) -> None:
            if self._stop.is_set():
                raise KeyboardInterrupt
            if time.thread_time() - start > task.max_seconds:
                raise DerError(f"it took more than {task.max_seconds:g} s of CPU time", TOO_LONG)
            shown(share)

        try:
            simulation = Simulation(scenario)
            if task.start is not None:
                simulation.positions[:] = task.start
            result = simulation.run(progress=tick, warns=False)
        except DerError as error:
            return Outcome(error.result, error, time.thread_time() - start)
        return Outcome(result, None, time.thread_time() - start)

    def add_done(self, weight: float) -> None:
        """Count work as done and show it."""
        with self._lock:
            self._done += weight
            if self._progress is not None and self._expected > 0.0:
                self._progress(min(1.0, self._done / (self._expected + self._later)))


class _Share:
    """Adds up what of one task is done; a second try starts again."""

    def __init__(self, workers: Workers, weight: float) -> None:
        self._workers = workers
        self._weight = weight
        self._counted = 0.0

    def __call__(self, share: float) -> None:
        if share > self._counted:
            self._workers.add_done(self._weight * (share - self._counted))
            self._counted = share

    def part(self, index: int, count: int) -> ProgressFunction:
        """Return what is told the progress of one of several equal parts of the task."""
        return lambda share: self((index + share) / count)


def _without_motion(outcome: Outcome) -> Outcome:
    result = outcome.result
    if result is None:
        return outcome
    # Copies, for the arrays are views of a memory that they keep alive as a whole.
    slim = replace(
        result,
        times=result.times.copy(),
        steps=result.steps.copy(),
        positions=np.empty((0, *result.positions.shape[1:])),
        velocities=np.empty((0, *result.velocities.shape[1:])),
        energies={name: values.copy() for name, values in result.energies.items()},
        sections=None,
    )
    if outcome.error is not None:
        outcome.error.result = slim
    return replace(outcome, result=slim)


def total_weight(tasks: Iterable[Task]) -> float:
    """Return the cost of all tasks together."""
    return sum(task.weight for task in tasks)
