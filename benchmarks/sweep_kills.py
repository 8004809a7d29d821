"""Kill the driver and the workers of a sweep at random moments; show that no row suffers.

    pip install .[dask]
    python benchmarks/sweep_kills.py [--kills N] [--members N] [--seed N]

A sweep runs on a Dask cluster of processes on this machine. First its driver, the command
``der sweep --dask``, is killed by SIGKILL and the sweep resumed, N times; then a worker is killed
by SIGKILL, N times while it sweeps. The rows that are there at each kill are compared with those at
the end, to their cost, and the rows at the end with those of a sweep on threads that nobody
disturbed, bit for bit but for their cost. Ends with a table, and with exit code 1 if a row is lost,
twice or different.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import der

if TYPE_CHECKING:
    from distributed import Client, LocalCluster

SCENE = Path(__file__).parent.parent / "configs/cantilever.yaml"
NODES = 401
WORKERS = 2
VARIED = {"loads.0.point_force.force.1": "-5:0:{members}", "rods.arm.nodes": str(NODES)}
#: The mean time between two kills, as a share of that of a sweep divided by the kills. Below 1, so
#: that a sweep seldom ends before the last kill; then another is begun.
PACE = 0.8
#: How long a worker may take to start again before the kills go on [s].
PATIENCE = 60.0

Row: TypeAlias = dict[str, Any]


@dataclass
class Outcome:
    """What became of sweeps that were killed again and again.

    Attributes
    ----------
    killed
        Who was killed.
    folder
        Where the folders of the sweeps are. There is more than one only if a sweep ended before the
        last kill.
    seen
        For each kill the number of the sweep, and the rows that were there.
    sweeps
        How many there were.
    """

    killed: str
    folder: Path
    seen: list[tuple[int, list[Row]]] = field(default_factory=list)
    sweeps: int = 1

    @property
    def out(self) -> Path:
        """The folder of the last sweep."""
        return self.folder / f"{self.killed} {self.sweeps}"

    def note(self, moment: float) -> None:
        """Note the rows that are there after a kill."""
        rows = rows_of(self.out)
        self.seen.append((self.sweeps, rows))
        print(
            f"{self.killed} {len(self.seen)}: killed after {moment:.2f} s, {len(rows)} rows are "
            f"there in sweep {self.sweeps}",
            flush=True,
        )

    def check(self, reference: dict[int, Row]) -> dict[str, int]:
        """Count the rows that are lost, twice and different."""
        counts = {"lost": 0, "twice": 0, "different": 0}
        for number in range(1, self.sweeps + 1):
            rows = rows_of(self.folder / f"{self.killed} {number}")
            last = by_member(rows)
            lost = set(reference) - set(last)
            different = {n for n, row in last.items() if without_cost(row) != reference.get(n)}
            counts["twice"] += len(rows) - len(last)
            for earlier in (rows for sweep, rows in self.seen if sweep == number):
                known = by_member(earlier)
                counts["twice"] += len(earlier) - len(known)
                lost |= set(known) - set(last)
                # To the cost, which tells whether a row was run again.
                different |= {n for n, row in known.items() if n in last and last[n] != row}
            counts["lost"] += len(lost)
            counts["different"] += len(different)
        return counts


def vary(members: int) -> dict[str, str]:
    """Return what is varied, in so many members."""
    return {path: values.format(members=members) for path, values in VARIED.items()}


def exact(sweep: der.Sweep) -> list[Row]:
    """Return the rows, floats as exact texts: NaN is not equal to itself."""
    return [{name: repr(value) for name, value in row.items()} for row in sweep.rows]


def by_member(rows: list[Row]) -> dict[int, Row]:
    """Return the rows by the number of their member."""
    return {int(row["member"]): row for row in rows}


def without_cost(row: Row) -> Row:
    """Return a row without what no two runs have in common."""
    return {name: value for name, value in row.items() if name != "seconds"}


def rows_of(out: Path) -> list[Row]:
    """Return the rows that are in a folder."""
    try:
        return exact(der.load_sweep(out))
    except (FileNotFoundError, ValueError):  # it was killed before it began
        return []


def command(members: int, out: Path, address: str) -> list[str]:
    """Return the command line of a sweep on a cluster."""
    line = [sys.executable, "-m", "der", "sweep", str(SCENE), "--out", str(out), "--resume"]
    for path, values in vary(members).items():
        line += ["--vary", f"{path}={values}"]
    return [*line, "--dask", address]


def seconds_of(line: list[str]) -> float:
    """Run a command to its end, and return how long it takes [s]."""
    begun = time.monotonic()
    subprocess.run(line, check=True, stdout=subprocess.DEVNULL)
    return time.monotonic() - begun


def kill_drivers(
    cluster: LocalCluster, kills: int, members: int, chance: random.Random, folder: Path
) -> Outcome:
    """Kill the command so many times, each at a random moment, and let it end at last."""
    address = cluster.scheduler_address
    start = seconds_of(command(2, folder / "start", address))
    whole = seconds_of(command(members, folder / "undisturbed", address))
    longest = start + 2.0 * PACE * max(whole - start, 0.0) / kills
    outcome = Outcome("driver", folder)
    while len(outcome.seen) < kills:
        begun = time.monotonic()
        process = subprocess.Popen(
            command(members, outcome.out, address), stdout=subprocess.DEVNULL
        )
        time.sleep(chance.uniform(0.0, longest))
        process.kill()
        moment = time.monotonic() - begun
        if process.wait() == -signal.SIGKILL:
            outcome.note(moment)
        else:
            outcome.sweeps += 1
    subprocess.run(command(members, outcome.out, address), check=True, stdout=subprocess.DEVNULL)
    return outcome


def all_workers(cluster: LocalCluster, client: Client, done: threading.Event) -> list[int]:
    """Return the processes of all workers, once they are all there."""
    found: list[int] = []
    give_up = time.monotonic() + PATIENCE
    while len(found) < WORKERS and not done.wait(0.1):
        if time.monotonic() > give_up:
            raise RuntimeError("a worker was not started again")
        # Dask starts a worker again, but not one that was killed while it started; it forgets that
        # one after a while, and then this asks for another.
        cluster.scale(WORKERS)
        found = list(client.run(os.getpid, on_error="ignore").values())
    return found


def kill_till_done(
    cluster: LocalCluster,
    client: Client,
    kills: int,
    chance: random.Random,
    longest: float,
    outcome: Outcome,
    done: threading.Event,
) -> None:
    """Kill workers at random moments until there were enough, or the sweep is done."""
    begun = time.monotonic()
    while len(outcome.seen) < kills:
        done.wait(chance.uniform(0.0, longest))
        victims = all_workers(cluster, client, done)
        if done.is_set():
            return
        os.kill(chance.choice(victims), signal.SIGKILL)
        outcome.note(time.monotonic() - begun)


def kill_workers(
    cluster: LocalCluster, kills: int, members: int, chance: random.Random, folder: Path
) -> Outcome:
    """Sweep while some worker is killed so many times, each at a random moment."""
    from distributed import Client

    outcome = Outcome("worker", folder)
    with Client(cluster) as client:
        begun = time.monotonic()
        der.sweep(SCENE, vary(members), out=folder / "calm", executor=client)
        longest = 2.0 * PACE * (time.monotonic() - begun) / kills
        while True:
            done = threading.Event()
            with ThreadPoolExecutor(1) as killers:
                killer = killers.submit(
                    kill_till_done, cluster, client, kills, chance, longest, outcome, done
                )
                der.sweep(SCENE, vary(members), out=outcome.out, executor=client)
                done.set()
                killer.result()
            if len(outcome.seen) == kills:
                return outcome
            outcome.sweeps += 1


def main() -> None:
    """Kill, compare, and print a table."""
    from distributed import LocalCluster

    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--kills", type=int, default=10, metavar="N")
    parser.add_argument("--members", type=int, default=6000, metavar="N")
    parser.add_argument("--seed", type=int, default=0, metavar="N")
    options = parser.parse_args()
    chance = random.Random(options.seed)
    threads = exact(der.sweep(SCENE, vary(options.members)))
    reference = {number: without_cost(row) for number, row in by_member(threads).items()}
    checked = []
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalCluster(
            WORKERS, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
    ):
        for way in (kill_drivers, kill_workers):
            outcome = way(cluster, options.kills, options.members, chance, Path(folder))
            checked.append((outcome, outcome.check(reference)))
    print("\n| killed by SIGKILL | rows there at the kills | lost | twice | different |")
    print("|---|---|---|---|---|")
    for outcome, counts in checked:
        there = ", ".join(str(len(rows)) for _, rows in outcome.seen)
        numbers = " | ".join(map(str, counts.values()))
        print(f"| {outcome.killed}, {len(outcome.seen)} times | {there} | {numbers} |")
    if any(any(counts.values()) for _, counts in checked):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
