"""Kill the driver and the workers of a sweep at random moments; show that no row suffers.

    python benchmarks/sweep_kills.py [--kills N] [--seed N]

The driver of a sweep is killed by SIGKILL and the sweep resumed, N times; then workers of a Dask
cluster of this machine are killed by SIGKILL while they run a sweep, N times. After each kill every
row that was there is there as it was, to its cost, and none twice; at the end all rows are those of
a sweep that nobody disturbed, bit for bit but for their cost. Fails with exit code 1 otherwise.
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
from pathlib import Path

import der

SCENE = Path(__file__).parent.parent / "configs/cantilever.yaml"
NODES = 401
WORKERS = 2
VARIED = {"loads.0.point_force.force.1": "-5:0:{members}", "rods.arm.nodes": str(NODES)}


def vary(members: int) -> dict[str, str]:
    """Return what is varied, in so many members."""
    return {path: values.format(members=members) for path, values in VARIED.items()}


def bits(sweep: der.Sweep) -> list[dict[str, str]]:
    """Return the rows without their costs, floats as exact texts."""
    return [
        {name: repr(value) for name, value in row.items() if name != "seconds"}
        for row in sweep.rows
    ]


def rows_of(out: Path) -> dict[int, dict[str, object]]:
    """Return the rows by the number of their member; fail if one is twice."""
    try:
        rows = der.load_sweep(out).rows
    except (FileNotFoundError, ValueError):  # it was killed before it began
        return {}
    found = {row["member"]: row for row in rows}
    if len(found) != len(rows):
        raise SystemExit(f"{len(rows) - len(found)} rows are twice")
    return found


def check_kept(before: dict[int, dict[str, object]], after: dict[int, dict[str, object]]) -> None:
    """Fail if a row is lost or changed."""
    lost = [number for number, row in before.items() if after.get(number) != row]
    if lost:
        raise SystemExit(f"rows that are lost or changed: {lost}")


def command(members: int, out: Path) -> list[str]:
    """Return the command line of a sweep."""
    line = [sys.executable, "-m", "der", "sweep", str(SCENE), "--out", str(out), "--resume"]
    for path, values in vary(members).items():
        line += ["--vary", f"{path}={values}"]
    return line


def kill_drivers(kills: int, members: int, chance: random.Random, out: Path) -> der.Sweep:
    """Sweep by the command, killed so many times, and return what it has in the end."""
    begun = time.monotonic()
    silent = {"check": True, "stdout": subprocess.DEVNULL}
    subprocess.run(command(members, out.with_name("undisturbed")), **silent)
    whole = time.monotonic() - begun
    kept: dict[int, dict[str, object]] = {}
    for number in range(kills):
        process = subprocess.Popen(command(members, out), stdout=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.0, 0.4 * whole))
        process.send_signal(signal.SIGKILL)
        if process.wait() == 0:
            print("it was finished before it could be killed: give more --members")
        found = rows_of(out)
        check_kept(kept, found)
        print(f"driver {number + 1}: {len(kept)} -> {len(found)} rows of {members}")
        kept = found
    subprocess.run(command(members, out), **silent)
    check_kept(kept, rows_of(out))
    return der.load_sweep(out)


def kill_workers(kills: int, members: int, chance: random.Random, out: Path) -> der.Sweep:
    """Sweep on a Dask cluster, some worker of which is killed so many times."""
    import distributed

    done = threading.Event()
    with (
        distributed.LocalCluster(
            WORKERS, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):

        def kill() -> None:
            for number in range(kills):
                victims: list[int] = []
                if not done.wait(chance.uniform(0.2, 3.0)):
                    # One that is killed while it starts may not be started again.
                    while len(victims) < WORKERS and not done.wait(0.1):
                        victims = list(client.run(os.getpid, on_error="ignore").values())
                if done.is_set():
                    print("it was finished before all kills: give more --members")
                    return
                os.kill(chance.choice(victims), signal.SIGKILL)
                print(f"worker {number + 1}: killed")

        killer = threading.Thread(target=kill)
        killer.start()
        swept = der.sweep(SCENE, vary(members), out=out, executor=client)
        done.set()
        killer.join()
    return swept


def main() -> None:
    """Kill, and compare."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--kills", type=int, default=10, metavar="N")
    parser.add_argument("--members", type=int, default=10000, metavar="N")
    parser.add_argument("--seed", type=int, default=0, metavar="N")
    arguments = parser.parse_args()
    chance = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        reference = bits(der.sweep(SCENE, vary(arguments.members)))
        for way in (kill_drivers, kill_workers):
            swept = way(arguments.kills, arguments.members, chance, Path(folder) / way.__name__)
            if bits(swept) != reference:
                raise SystemExit(f"{way.__name__}: rows differ from those of a sweep undisturbed")
            print(f"{way.__name__}: {len(swept)} rows, none lost, none twice, none different")


if __name__ == "__main__":
    main()
