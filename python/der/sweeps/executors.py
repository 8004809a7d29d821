"""The executors that a sweep runs on: its own threads, those of `concurrent.futures`, Dask."""

from __future__ import annotations

import json
import multiprocessing
import os
import pickle
import signal
import threading
import time
import zlib
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeAlias, TypeVar

from der.errors import warn
from der.parallel import CancellableExecutor, Threads, checked_jobs
from der.sweeps.chunk import Chunk, run_chunk
from der.sweeps.table import Table

if TYPE_CHECKING:
    from distributed import Client

_Given = ParamSpec("_Given")
_Done = TypeVar("_Done")
#: Who can run a sweep.
AnyExecutor: TypeAlias = "Executor | Client"

#: How often a scheduler file is read that a scheduler may be writing just now, and the pause [s].
_TRIES, _PAUSE = 10, 0.1
#: Chunks that wait for each one that runs, so that nobody is idle while a table is written.
_WAITING = 1


@dataclass(frozen=True)
class Place:
    """Where chunks are run: by whom, the function that runs one there, and how many at once."""

    executor: Executor
    run: Callable[[Chunk], Table]
    workers: Callable[[], int]  # clusters grow and shrink

    def at_once(self) -> int:
        """Return how many chunks the executor may have."""
        return (1 + _WAITING) * self.workers()


@contextmanager
def place_for(executor: AnyExecutor | None, jobs: int | None) -> Iterator[Place]:
    """Give the place that a program names; without one, threads for the time of the block.

    `jobs` are threads; of an executor, how many chunks it runs at once, which it does not tell.
    """
    count = checked_jobs(jobs)
    if executor is None:
        with Threads(count) as threads:
            yield Place(threads, partial(run_chunk, tick=threads.tick), lambda: count)
    elif isinstance(executor, Processes):
        yield Place(executor, _run_chunk_in_process, lambda: executor.count)
    elif isinstance(executor, Executor):
        if jobs is None:
            count = getattr(executor, "_max_workers", count)
        yield Place(executor, run_chunk, lambda: count)
    elif hasattr(executor, "get_executor"):
        # Not pure: nobody asks for the same chunk again, so that no result is to be kept.
        client: Any = executor
        if client.status != "running":
            raise ValueError(f"the Dask client is {client.status}: connect a new one")
        if not client.nthreads():
            warn(["the Dask cluster has no workers yet: the sweep waits for them"])
        yield Place(
            _OnDask(client.get_executor(pure=False)),
            run_chunk,
            lambda: sum(client.nthreads().values()) if jobs is None else count,
        )
    else:
        raise TypeError(
            f"executor must be an executor of concurrent.futures or a Dask client, got {executor!r}"
        )


class _OnDask(Executor):
    """Hands work to Dask, packed.

    A scheduler keeps the last thousand messages for each worker and client, chunks with them
    (``distributed.admin.low-level-log-length``): 190 kB for one of 1000 members as objects of
    Python, 10 kB packed.
    """

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def submit(
        self, fn: Callable[_Given, _Done], /, *args: _Given.args, **kwargs: _Given.kwargs
    ) -> Future[_Done]:
        """Hand work over."""
        return self._executor.submit(run_packed, pack(fn, *args, **kwargs))


def pack(fn: Callable[_Given, Any], /, *args: _Given.args, **kwargs: _Given.kwargs) -> bytes:
    """Return work as the bytes that travel."""
    return zlib.compress(pickle.dumps((fn, args, kwargs)), level=1)


def run_packed(packed: bytes) -> Any:
    """Do packed work; the name is what Dask shows of it."""
    function, args, kwargs = pickle.loads(zlib.decompress(packed))
    return function(*args, **kwargs)


class Processes(CancellableExecutor, ProcessPoolExecutor):
    """Processes that stop when the ``with`` block around them fails, by Ctrl-C above all.

    There are as many as the machine has cores, unless `jobs` says how many.
    """

    def __init__(self, jobs: int | None = None) -> None:
        self.count = checked_jobs(jobs)
        # Fresh processes: a fork of one with threads may stop at a lock that nobody opens.
        context = multiprocessing.get_context("spawn")
        self._stop = context.Event()
        super().__init__(self.count, context, initializer=_begin_process, initargs=(self._stop,))

    def submit(
        self, fn: Callable[_Given, _Done], /, *args: _Given.args, **kwargs: _Given.kwargs
    ) -> Future[_Done]:
        """Hand work over, which starts a process if none is idle."""
        # A process that loads its modules would end with a traceback: it takes over what is blocked
        # in the thread that starts it.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


#: In a process of `Processes`: whether nobody wants its work any more.
_stop_here: Event | None = None


def _begin_process(stop: Event) -> None:
    global _stop_here
    _stop_here = stop
    # Ctrl-C of a terminal goes to all processes, and is the parent's to answer.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()


def _run_chunk_in_process(chunk: Chunk) -> Table:
    return run_chunk(chunk, tick=_tick_of_process)


def _tick_of_process() -> None:
    if _stop_here is not None and _stop_here.is_set():
        raise KeyboardInterrupt


def end_with_parent() -> None:
    """Let this process end with the one that started it, even if that was killed.

    A worker of a pool waits for work for ever, and holds the output that it has inherited.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def lost_its_worker(error: BaseException) -> bool:
    """Return whether Dask gave a chunk up, because each worker that tried it died."""
    # By name: where nobody runs on Dask, it may not be installed.
    return type(error).__name__ == "KilledWorker"


def connect(address: str) -> Client:
    """Return a client of a Dask scheduler: of ``tcp://HOST:PORT``, or of a scheduler's file.

    Nobody who answers there is an `OSError`, anything else a `ValueError`.
    """
    try:
        from distributed import Client
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            "Dask needs the package distributed: pip install 'der[dask]'"
        ) from error
    try:
        if Path(address).exists():
            _check_scheduler_file(Path(address))
            return Client(scheduler_file=address)
        return Client(address)
    except ValueError as error:
        raise ValueError(
            f"'{address}' is no scheduler ({error}): write tcp://HOST:PORT, or the path of a "
            "scheduler file"
        ) from error


def _check_scheduler_file(path: Path) -> None:
    """Refuse a file that does not tell the address of a scheduler: Dask asserts that it does."""
    if path.is_dir():
        raise ValueError("it is a folder")
    for _ in range(_TRIES):
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except ValueError:
            time.sleep(_PAUSE)
            continue
        if isinstance(content, dict) and isinstance(content.get("address"), str):
            return
        break
    raise ValueError("it is no JSON file with an address")
