"""The cost of `der.Batch` beside the simulations in it, in one run; best on a machine that is idle.

    python benchmarks/batch.py [--quick] [--threads N ...] [--cpp PROGRAM] [--peers]

1. Swings: 1,000 soft rods of 24 elements, clamped at one end, fall for 1 s in 300 steps of
   `implicit_midpoint`: those with which benchmarks/peers.py finds the tip within 1e-3 m of the
   continuum's at 101 times. The error is measured here, too. Swings a second of a loop over
   `Simulation.step(300)`, which is one C++ loop for each, and of a batch on one thread and on two,
   or on other numbers of threads (`--threads 1 4 16`). With DER_LOOPS=avx2 members go in four
   lanes, with DER_LOOPS=avx512 in eight. The same with the model `spatial_bend`, and for the strip
   of benchmarks/peers.py, which twists, with as many elements and steps (`spatial`).
2. One step of all of many short rods: a loop in C++ against `Batch`, by the Google benchmarks
   `batch` and `loop_over_simulations` of der_benchmarks (`--cpp`; left out if it is not built).
   Members one by one, which a prescribed angle keeps out of lanes, show what a step of a batch
   costs beyond its members' own.
3. Building, memory and resets of members of 51 nodes, of one scene and with a modulus of its own
   for each.
4. With `--peers` (`pip install .[peers]`): swings for a second of one core in a batch of `der`, in
   `mujoco.rollout`, in a block of PyElastica or DiSMech-Newton, and of Exudyn one by one, with the
   error of each.

Ways are taken in turns, and the best of several times counts, so that other work on the machine
disturbs all alike. Seconds are those of the clock but for building, resets and
peers: those of the CPU. Ends with exit code 1 if a member of a batch has other bits than its
simulation.
"""

from __future__ import annotations

import argparse
import functools
import json
import multiprocessing
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import der
import numpy as np
from comparison.codes import CODES, missing_text
from comparison.run_der import controls, implicit, run_batch
from comparison.scene import FRAMES, distance, steps_per_frame
from comparison.strip import code_der as strip
from comparison.swing import batches, code_der, problem
from memory import resident

SWING = implicit(24, 3, "implicit_midpoint")
ROOT = Path(__file__).resolve().parents[1]
MODULUS = "rods.rod.material.youngs_modulus"


def swing(elements: int) -> der.Scenario:
    """Return the scene of the swing."""
    return der.Scenario.from_dict({**code_der.scene(elements), **controls(SWING)})


def tip_error(scene: der.Scenario) -> float:
    """Return the largest distance [m] of a batch's tips from the continuum's over all frames."""
    _, tips = run_batch(der.Batch(scene, 2), steps_per_frame(SWING))
    return max(distance(tip, problem.reference()) for tip in tips)


def best_of(ways: dict[str, Callable[[], object]], repeats: int) -> dict[str, float]:
    """Return the least seconds that each way takes, taken in turns."""
    best = dict.fromkeys(ways, float("inf"))
    for _ in range(repeats):
        for name, way in ways.items():
            start = time.perf_counter()
            way()
            best[name] = min(best[name], time.perf_counter() - start)
    return best


def kinds() -> dict[str, der.Scenario]:
    """Return a swing with each model, by what it is called."""
    elements = int(SWING["elements"])
    plane = swing(elements)
    tangent = {"supports": [{"rod": "rod", "at": "start", "clamp": "tangent"}]}
    wire = {**code_der.scene(elements), **controls(SWING), **tangent, "model": "spatial_bend"}
    return {
        f"swings of 1 s, error {tip_error(plane):.1e} m": plane,
        "swings of 1 s as rods in space": der.Scenario.from_dict(wire),
        "swings of 1 s of strips": der.Scenario.from_dict(
            {**strip.scene(elements), **controls(SWING)}
        ),
    }


def throughput(
    title: str, scene: der.Scenario, members: int, repeats: int, threads: Sequence[int]
) -> bool:
    """Print swings a second of a loop and of batches on so many threads.

    Returns
    -------
    bool
        Whether all have the same bits.
    """
    steps = FRAMES * steps_per_frame(SWING)
    print(f"{members} {title}, loops {der.loops()}:")
    simulations = [der.Simulation(scene) for _ in range(members)]
    start = simulations[0].save_state()
    batches = [der.Batch(scene, members, count) for count in threads]

    def loop() -> None:
        for simulation in simulations:
            simulation.restore_state(start)
            simulation.step(steps)

    def run(batch: der.Batch) -> None:
        batch.reset()
        batch.step(steps)

    ways: dict[str, Callable[[], object]] = {"loop over Simulation": loop}
    ways |= {threads_in_words(batch): functools.partial(run, batch) for batch in batches}
    seconds = best_of(ways, repeats)
    loop_time, first, *_ = seconds.values()
    for name, each in seconds.items():
        print(
            f"  {name:22} {members / each:8.0f} swings a second, {loop_time / each:6.3f} of the "
            f"loop's, {first / each:6.2f} of the first batch's"
        )
    same = all(
        batch.positions[i].tobytes() == simulations[0].positions.tobytes()
        for batch in batches
        for i in range(members)
    )
    lanes = ", ".join(str(batch.lanes) for batch in batches)
    print(f"  members in lanes: {lanes}; the same bits: {'yes' if same else 'NO'}")
    return same


def threads_in_words(batch: der.Batch) -> str:
    """Return "batch, 1 thread"."""
    return f"batch, {batch.threads} thread{'s' if batch.threads > 1 else ''}"


def overheads(program: Path, repeats: int) -> None:
    """Print what a step of a batch costs beyond its members' own."""
    line = [
        str(program),
        "--benchmark_filter=^(batch|loop_over_simulations)/",
        f"--benchmark_repetitions={repeats}",
        "--benchmark_enable_random_interleaving=true",
        "--benchmark_format=json",
    ]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    best: dict[str, float] = {}
    for row in json.loads(done.stdout)["benchmarks"]:
        if row["run_type"] == "iteration":
            best[row["run_name"]] = min(best.get(row["run_name"], float("inf")), row["cpu_time"])
    for name, batch in best.items():
        if not name.startswith("batch/"):
            continue
        case = name.removeprefix("batch/")
        loop = best[f"loop_over_simulations/{case}"]
        size = dict(part.split(":") for part in case.split("/"))
        members = int(size["members"])
        how = "in lanes" if int(size["lanes"]) else "one by one"
        print(
            f"{size['nodes']} nodes, {members} members {how}, {size['steps']} steps: own "
            f"{loop / members:.2f} us a member, beyond that {(batch - loop) / members:+.3f} us; "
            f"loop over batch {loop / batch:.3f}"
        )


def building(members: int, varies: bool) -> dict[str, float]:
    """Return costs of a member: of building and of a reset [us], its memory [kB]."""
    scene = swing(50)
    vary: dict[str, Any] = {MODULUS: np.linspace(1e7, 2e7, members)} if varies else {}
    der.Batch(scene, 2).step()
    memory = resident()
    start = time.process_time()
    batch = der.Batch(scene, members, 1, vary=vary)
    built = time.process_time()
    batch.step()
    batch.probes  # noqa: B018, which makes them
    kilobytes = (resident() - memory) / 1e3
    numbers = list(range(members))
    reset = float("inf")
    for _ in range(3):
        begin = time.process_time()
        batch.reset(numbers)
        reset = min(reset, time.process_time() - begin)
    scale = 1e6 / members
    return {"build": (built - start) * scale, "kB": kilobytes / members, "reset": reset * scale}


def print_building(members: int) -> None:
    """Print the costs of members, each batch in a process of its own, so that memory counts."""
    for varies in (False, True):
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(1, mp_context=context) as pool:
            cost = pool.submit(building, members, varies).result()
        print(
            f"{members} members of 51 nodes, {'a modulus each' if varies else 'one scene'}: "
            f"{cost['build']:.1f} us to build, {cost['reset']:.2f} us to reset, "
            f"{cost['kB']:.1f} kB a member"
        )


def peers(repeats: int, quick: bool) -> None:
    """Print members a second of each code that is installed."""
    for code in CODES:
        print(f"{code.title} {code.version()}" if code.is_installed() else missing_text(code))
    print(batches.table(batches.measure(repeats, quick)))


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; return the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="few members, few repeats")
    parser.add_argument(
        "--cpp",
        type=Path,
        default=ROOT / "build/release/benchmarks/der_benchmarks",
        metavar="PROGRAM",
        help="der_benchmarks, as built by the preset `release`",
    )
    parser.add_argument(
        "--threads",
        type=int,
        nargs="+",
        default=[1, 2],
        metavar="N",
        help="numbers of threads of the batches of swings (1 and 2)",
    )
    parser.add_argument("--peers", action="store_true", help="compare with other codes as well")
    options = parser.parse_args(arguments)
    members, repeats = (100, 2) if options.quick else (1000, 5)
    same = [
        throughput(title, scene, members, repeats, options.threads)
        for title, scene in kinds().items()
    ]
    if options.cpp.exists():
        overheads(options.cpp, 3 if options.quick else 9)
    else:
        print(f"no program {options.cpp}: build it with `cmake --preset release`, or name it")
    print_building(1000 if options.quick else 10_000)
    if options.peers:
        peers(2 if options.quick else 5, options.quick)
    return 0 if all(same) else 1


if __name__ == "__main__":
    sys.exit(main())
