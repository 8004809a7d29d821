"""Running many scenarios at once: the one way of `verify`, `study` and `sweep`.

Threads do the work, in which the engine steps without the interpreter's lock, or any executor of
`concurrent.futures`.
"""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from der import _core
from der._core import RunRecording, Scenario
from der.arguments import MOST, whole_number
from der.errors import DerError
from der.interrupts import take_all_interrupts, take_one_interrupt
from der.progress import ProgressFunction
from der.result import Result
from der.simulation import Simulation, recorded_result

#: Status of a run that was cancelled.
TOO_LONG = "too_long"

Key = TypeVar("Key", bound=Hashable)
Work = TypeVar("Work")
Done = TypeVar("Done")
Found = TypeVar("Found")
_Block = TypeVar("_Block", bound="CancellableExecutor")


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
class Outcome(Generic[Found]):
    """How a run went.

    Attributes
    ----------
    result
        What was read of the recorded data, of a failed run up to its last good step; None if it did
        not start.
    error
        Why it failed; None if it did not.
    cpu_seconds
        CPU time of building the simulation and running it [s], the least of the repeats.
    """

    result: Found | None
    error: DerError | None
    cpu_seconds: float

    def value(self) -> Found:
        """Return the result of a run that did not fail; raise the error of one that did."""
        if self.error is not None:
            raise self.error
        assert self.result is not None
        return self.result


class _Stop(Protocol):
    """An event of threads or of processes."""

    def set(self) -> None: ...
    def is_set(self) -> bool: ...


class CancellableExecutor(Executor):
    """An executor whose work ends early when the ``with`` block around it fails.

    Its workers are to raise `KeyboardInterrupt` at their next tick once `_stop` is set.
    """

    _stop: _Stop
    _takes_one_interrupt = False

    def __enter__(self: _Block) -> _Block:
        """Take Ctrl-C once, which ends the block, until the workers have ended.

        A second one would leave threads of the engine behind, which end the process by a signal.
        """
        self._takes_one_interrupt = take_one_interrupt()
        return super().__enter__()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Wait for the workers, which end at their next tick if the block fails."""
        if kind is not None:
            self._stop.set()
        try:
            self.shutdown(cancel_futures=kind is not None)
        finally:
            if self._takes_one_interrupt:
                take_all_interrupts()


class Threads(CancellableExecutor, ThreadPoolExecutor):
    """Threads that stop when the ``with`` block around them fails, by Ctrl-C above all.

    Parameters
    ----------
    jobs
        How many; as many as the machine has cores, unless given.

    Raises
    ------
    ValueError, TypeError
        If `jobs` is not a whole number of at least 1.
    """

    def __init__(self, jobs: int | None = None) -> None:
        super().__init__(checked_jobs(jobs))
        self._stop = threading.Event()

    def tick(self) -> None:
        """Raise `KeyboardInterrupt` in a thread whose work nobody wants any more."""
        if self._stop.is_set():
            raise KeyboardInterrupt


def checked_jobs(jobs: int | None) -> int:
    """Return how many runs go on at once; as many as the machine has cores, unless given.

    Raises
    ------
    ValueError
        If `jobs` is less than 1.
    TypeError
        If it is no whole number.
    """
    return (os.cpu_count() or 1) if jobs is None else whole_number("jobs", jobs, 1, MOST)


def as_they_finish(
    executor: Executor,
    function: Callable[[Work], Done],
    take: Callable[[], Work | None],
    at_once: Callable[[], int],
) -> Iterator[tuple[Work, Future[Done]]]:
    """Do work whose amount need not be known, and yield each piece when it is finished.

    Parameters
    ----------
    executor
        Who does it.
    function
        What to do with a piece.
    take
        Returns the next piece, or None if there is none now.
    at_once
        Returns how many pieces the executor may have; only so many are held in memory.

    Yields
    ------
    tuple
        A piece, and its future, which is done. When the caller stops, what has not begun is
        cancelled.
    """
    pending: dict[Future[Done], Work] = {}
    try:
        while True:
            while len(pending) < max(1, at_once()):
                piece = take()
                if piece is None:
                    break
                pending[executor.submit(function, piece)] = piece
            if not pending:
                return
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                yield pending.pop(future), future
    finally:
        for future in pending:
            future.cancel()


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
    ValueError, TypeError
        If `jobs` is not a whole number of at least 1.
    """

    def __init__(self, jobs: int | None = None, progress: ProgressFunction | None = None) -> None:
        self._jobs = checked_jobs(jobs)
        self._progress = progress
        self._lock = threading.Lock()
        self._expected = 0.0
        self._later = 0.0
        self._done = 0.0

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

    def run(
        self, tasks: Mapping[Key, Task], *, jobs: int | None = None
    ) -> dict[Key, Outcome[Result]]:
        """Run all tasks and return their outcomes by key; a failed run is an outcome as well.

        Parameters
        ----------
        tasks
            The tasks to run. All must be announced with `expect` first, or the progress is ahead
            of the work; a task of weight 0 needs no announcement.
        jobs
            In place of that of the constructor: 1 to measure costs undisturbed.
        """
        costly_first = iter(sorted(tasks, key=lambda key: -tasks[key].weight))
        at_once = jobs or self._jobs
        with Threads(at_once) as threads:
            finished = as_they_finish(
                threads,
                lambda key: self._run_task(tasks[key], threads.tick),
                lambda: next(costly_first, None),
                lambda: at_once,
            )
            found = {key: future.result() for key, future in finished}
        return {key: found[key] for key in tasks}

    def _run_task(self, task: Task, tick: Callable[[], None]) -> Outcome[Result]:
        shown = _Share(self, task.weight)
        for scenario in task.scenarios:
            outcome = min(
                (
                    attempt(
                        scenario,
                        recorded_result,
                        start=task.start,
                        max_seconds=task.max_seconds,
                        progress=shown.part(repeat, task.repeats),
                        tick=tick,
                    )
                    for repeat in range(task.repeats)
                ),
                key=lambda outcome: outcome.cpu_seconds,
            )
            if not task.keep_motion:
                outcome = _without_motion(outcome)
            if outcome.error is not None:
                outcome.error.result = outcome.result
            if outcome.error is None:
                break
        shown(1.0)
        return outcome

    def add_done(self, weight: float) -> None:
        """Count work as done and show it."""
        with self._lock:
            self._done += weight
            if self._progress is not None and self._expected > 0.0:
                self._progress(min(1.0, self._done / (self._expected + self._later)))


def attempt(
    scenario: Scenario,
    read: Callable[[Scenario, RunRecording], Found],
    *,
    start: NDArray[np.float64] | None = None,
    max_seconds: float = math.inf,
    out: Path | None = None,
    progress: ProgressFunction | None = None,
    tick: Callable[[], None] | None = None,
) -> Outcome[Found]:
    """Run a scenario in this thread; a failed run is an outcome as well.

    Parameters
    ----------
    scenario
        What to run.
    read
        Returns what is wanted of the recorded data, which takes time as well: `recorded_result`
        for all.
    start, max_seconds
        As in `Task`.
    out
        Folder to write the run to.
    progress
        Told now and then how much is done, from 0 to 1.
    tick
        Called as often; what it raises ends the run.
    """
    begun = time.thread_time()

    def beat() -> None:
        if tick is not None:
            tick()
        if time.thread_time() - begun > max_seconds:
            raise DerError(f"it took more than {max_seconds:g} s of CPU time", TOO_LONG)
        if progress is not None:
            progress(simulation.share_done())

    try:
        simulation = _SilentSimulation(scenario)
        if start is not None:
            simulation.positions[:] = start
        recording = simulation.record(tick=beat, out=out)
    except DerError as error:
        return Outcome(None, error, time.thread_time() - begun)
    found = read(scenario, recording)
    return Outcome(found, recording.error, time.thread_time() - begun)


class _SilentSimulation(Simulation):
    """One that does not issue its scene's warnings: the result has them, maybe thousands alike."""

    def __init__(self, scenario: Scenario) -> None:
        _core.Simulation.__init__(self, scenario)


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


def _without_motion(outcome: Outcome[Result]) -> Outcome[Result]:
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
        turns=None,
    )
    return replace(outcome, result=slim)


def total_weight(tasks: Iterable[Task]) -> float:
    """Return the cost of all tasks together."""
    return sum(task.weight for task in tasks)
