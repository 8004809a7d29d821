"""Count the instructions of a step, and fail if one costs more than it did.

    python tests/performance/instructions.py            # compare with instructions.json
    python tests/performance/instructions.py --write    # keep the present figures

Times differ by half on a busy machine; instructions that valgrind counts do not differ.
Each scene of this folder runs for two durations, so that start and end of the program cancel.
A count depends on the compiler: figures of another one are not compared.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
BUILD = ROOT / "build" / "release"
KEPT = HERE / "instructions.json"
BAND = 0.03
STEPS = 20, 60  # of the two runs
MEMBERS = 16


def run(scene: Path, steps: int, out: str) -> list[str]:
    """The command that takes so many steps of a scene."""
    duration = steps * step_of(scene)
    settings = [f"time.duration={duration:.9g}", f"output.every={duration:.9g}"]
    words = [word for setting in settings for word in ("--set", setting)]
    return [str(BUILD / "cpp" / "der_run"), str(scene), "--out", out, "--quiet", *words]


def batch(scene: Path, steps: int, _: str) -> list[str]:
    """The command that takes so many steps of a batch in lanes."""
    program = BUILD / "tests" / "performance" / "der_batch_steps"
    return [str(program), str(scene), str(MEMBERS), str(steps)]


def step_of(scene: Path) -> float:
    """The step of a scene of this folder [s]."""
    return float(re.search(r"step: ([^,}]+)", scene.read_text())[1])


def instructions(command: list[str]) -> int:
    """The instructions that a command takes; valgrind does not know all loops of AVX2."""
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    environment = {**os.environ, "DER_LOOPS": "plain"}
    done = subprocess.run([*tool, *command], capture_output=True, text=True, env=environment)
    collected = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode or collected is None:
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
    return int(collected[1])


def of_a_step(job: tuple[Callable[[Path, int, str], list[str]], Path]) -> int:
    """The instructions of one step."""
    command, scene = job
    with tempfile.TemporaryDirectory() as folder:
        few, many = (instructions(command(scene, steps, f"{folder}/{steps}")) for steps in STEPS)
    return round((many - few) / (STEPS[1] - STEPS[0]))


def compiler() -> str:
    """The compiler of the build, by its own words."""
    cache = (BUILD / "CMakeCache.txt").read_text()
    path = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", cache, re.MULTILINE)[1]
    version = subprocess.run([path, "--version"], capture_output=True, text=True, check=True)
    return version.stdout.splitlines()[0]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--write", action="store_true", help="keep the present figures")
    writes = parser.parse_args().write
    kept = json.loads(KEPT.read_text()) if KEPT.is_file() else {"compiler": "", "of a step": {}}
    if not writes and kept["compiler"] != compiler():
        print(f"not compared: the figures are those of {kept['compiler']}, this is {compiler()}")
        return 0
    scenes = {scene.stem: scene for scene in sorted(HERE.glob("*.yaml"))}
    jobs = {name: (batch if name == "members" else run, scene) for name, scene in scenes.items()}
    with ThreadPoolExecutor(2) as pool:
        counts = dict(zip(jobs, pool.map(of_a_step, jobs.values()), strict=True))
    dearer = 0
    print("| scene | instructions of a step | kept | ratio |\n|---|---:|---:|---:|")
    for name, now in counts.items():
        before = kept["of a step"].get(name)
        ratio = now / before if before else float("nan")
        dearer += not writes and not ratio <= 1.0 + BAND
        print(f"| {name} | {now} | {before or '-'} | {ratio:.3f} |")
    if writes:
        KEPT.write_text(json.dumps({"compiler": compiler(), "of a step": counts}, indent=2) + "\n")
    if dearer:
        print(
            f"error: {dearer} of {len(counts)} cost more than {1 + BAND:.2f} of what they did. "
            "Find out why; if it is worth it, write the new figures with --write",
            file=sys.stderr,
        )
    return 1 if dearer else 0


if __name__ == "__main__":
    sys.exit(main())
