"""The cost of a sweep beside the engine: rows a second, bytes a row, overhead of Dask.

    python benchmarks/sweep.py [--members N] [--dask]

Sweeps equilibria of a cantilever with 51 nodes, the cheapest members there are. The share that is
not the engine's is measured in CPU time on one thread, in turns with a loop that does nothing but
vary the scene, build the simulation and run it, so that other work on the machine counts little.
The memory of this process is that of the driver, with Dask also that of the scheduler.
The sweep that is meant has 100,000 members, and takes some minutes. Ends with exit code 1 if not
all ways have the same rows, bit for bit but for their cost.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
import tempfile
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import der
from der import _core
from der.sweeps.chunk import Chunk, run_chunk
from der.sweeps.executors import pack
from memory import resident

FORCE = "loads.0.point_force.force.1"
CHUNKS = 60  # without members, for the overhead of a chunk


class Here(Executor):
    """Does at once what it is asked for, in this thread."""

    _max_workers = 1

    def submit(self, function, /, *arguments):
        """Return what is done already."""
        future: Future = Future()
        future.set_result(function(*arguments))
        return future


class InTurns(Here):
    """Runs each chunk in this thread, and all its members by the engine alone as well.

    The two are done in turns of some tenths of a second, so that other work on the machine disturbs
    both alike.

    Attributes
    ----------
    engine, chunks
        CPU time of the engine alone, and of the chunks [s].
    """

    def __init__(self, scene: der.Scenario) -> None:
        self.engine = self.chunks = 0.0
        self._scene = scene
        self._engine_first = False

    def submit(self, function, /, chunk):
        """Return the rows of a chunk, after both turns."""
        self._engine_first = not self._engine_first
        if self._engine_first:
            self._run_engine(chunk)
        begun = time.process_time()
        future = super().submit(function, chunk)
        self.chunks += time.process_time() - begun
        if not self._engine_first:
            self._run_engine(chunk)
        return future

    def _run_engine(self, chunk: Chunk) -> None:
        begun = time.process_time()
        for _, (force,) in chunk.members:
            _core.Simulation(self._scene.with_(**{FORCE: force})).record()
        self.engine += time.process_time() - begun


def show_share(scene: der.Scenario, members: int) -> None:
    """Print what of a sweep with a file is not the engine's."""
    turns = InTurns(scene)
    with tempfile.TemporaryDirectory() as folder:
        begun = time.process_time()
        vary = {FORCE: f"-5:0:{members}"}
        der.sweep(scene, vary, out=Path(folder) / "s", executor=turns)
        whole = time.process_time() - begun - turns.engine
        size = (Path(folder) / "s/sweep.sqlite").stat().st_size
    engine, chunks, whole = (1e6 * t / members for t in (turns.engine, turns.chunks, whole))
    print(
        f"CPU time of a member, of {members}: engine {engine:.0f} us, its chunk {chunks:.0f} us, "
        f"whole sweep {whole:.0f} us ({1e6 / whole:.0f} a second), {size / 1e6:.1f} MB"
    )
    print(f"not the engine's: {1.0 - engine / whole:.1%}")


def digest(sweep: der.Sweep) -> str:
    """Return what two sweeps have in common only if all bits of their rows but the cost are."""
    columns = {name: values for name, values in sweep.values.items() if name != "seconds"}
    return hashlib.sha256(repr(columns).encode()).hexdigest()


def show_rows(
    label: str, scene: der.Scenario, members: int, executor: object = None, jobs: int | None = None
) -> str:
    """Print how fast a sweep with a file is, what it takes; return its digest."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "s"
        vary = {FORCE: f"-5:0:{members}"}
        begun, cpu = time.perf_counter(), time.process_time()
        held: list[tuple[float, int]] = []

        def note_memory(done: float) -> None:
            held.append((done, resident()))

        sweep = der.sweep(scene, vary, out=out, executor=executor, jobs=jobs, progress=note_memory)
        wall, cpu = time.perf_counter() - begun, time.process_time() - cpu
        size = (out / "sweep.sqlite").stat().st_size
        print(
            f"{label}: {members} rows in {wall:.1f} s ({members / wall:.0f} a second; {cpu:.1f} s "
            f"of CPU time in this process), {size / 1e6:.1f} MB ({size / members:.0f} bytes a row)"
        )
        early = next(bytes_held for done, bytes_held in held if done >= 0.1)
        print(
            f"  memory of this process: {early / 1e6:.0f} MB when a tenth of the rows is there, "
            f"{held[-1][1] / 1e6:.0f} MB when all are"
        )
        return digest(sweep)


def show_dask(scene: der.Scenario, members: int) -> str:
    """Print rows a second on a cluster of this machine, and what a chunk costs there.

    Returns
    -------
    str
        The digest of the sweep.
    """
    from distributed import Client, LocalCluster
    from distributed.protocol import serialize

    cores = os.cpu_count() or 1
    with (
        LocalCluster(cores, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        rows = show_rows("Dask", scene, members, client)
        text = scene.to_yaml()
        empty = Chunk(text, "scene", (FORCE,), ())
        full = Chunk(text, "scene", (FORCE,), tuple((i, (-1e-3 * i,)) for i in range(1000)))
        table = run_chunk(full)
        dask = client.get_executor(pure=False)
        for label, executor in (("threads", Here()), ("Dask", dask)):
            executor.submit(run_chunk, empty).result()
            begun = time.perf_counter()
            for _ in range(CHUNKS):
                executor.submit(run_chunk, empty).result()
            each = (time.perf_counter() - begun) / CHUNKS
            print(f"a chunk without members, {label}: {1e3 * each:.2f} ms")
        there, back = len(pack(run_chunk, full)), sum(map(len, map(bytes, serialize(table)[1])))
        print(f"a chunk of 1000 members: {there / 1e3:.0f} kB there, {back / 1e3:.0f} kB back")
    return rows


def main() -> int:
    """Print everything, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--members", type=int, default=5000, metavar="N")
    parser.add_argument("--dask", action="store_true", help="measure a Dask cluster as well")
    arguments = parser.parse_args()
    scene = der.load(Path(__file__).parent.parent / "configs/cantilever.yaml")
    show_share(scene, arguments.members)
    count = arguments.members
    rows = [show_rows("one thread", scene, count, jobs=1), show_rows("threads", scene, count)]
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as pool:
        rows.append(show_rows("processes", scene, count, pool))
    if arguments.dask:
        rows.append(show_dask(scene, count))
    same = len(set(rows)) == 1
    print(f"the same rows: {'yes' if same else 'NO'}")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
