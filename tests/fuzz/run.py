"""Fuzz the readers of scenes and of run files: the figures of docs/robustness.md.

    python tests/fuzz/run.py --seconds 60
    python tests/fuzz/run.py --only run_file_reader --seconds 3600

Builds the fuzzers of the preset `asan-ubsan` (clang, libFuzzer), fuzzes each target for so long,
and prints a table.
Inputs that covered something new are kept in build/fuzz/corpus/ and are where the next run starts.
Exits with 1 if an input crashes, hangs or takes too much memory; such inputs are in
build/fuzz/findings/.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from dictionary import dictionary

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "asan-ubsan"
KEPT = ROOT / "build" / "fuzz"
REGRESSIONS = Path(__file__).parent / "regressions"
LEAKS = Path(__file__).parent / "leaks_of_hdf5.txt"

MEMORY_MIB = 2048  # of the process, with what the sanitizers add
ALLOCATION_MIB = 1024  # at once
SECONDS_OF_AN_INPUT = 60
SANITIZERS = {
    # What was freed is kept aside to see uses of it, and would count as memory of the target. Short
    # stacks: HDF5 allocates so much that the stacks take a third of the time. HDF5 asks for
    # impossible sizes and takes no for an answer; `new` still must not.
    "ASAN_OPTIONS": "quarantine_size_mb=32:malloc_context_size=4:allocator_may_return_null=1",
    # HDF5 forgets memory of files that it refuses.
    "LSAN_OPTIONS": f"suppressions={LEAKS}:print_suppressions=0",
}


@dataclasses.dataclass
class Target:
    """A fuzz target, what is special about its inputs, and where its first ones are."""

    name: str
    options: Callable[[Path], list[str]]
    seeds: Callable[[Path], list[Path]]


def words(scratch: Path) -> list[str]:
    """The option that names the words of scenes."""
    file = scratch / "words.dict"
    file.write_text(dictionary())
    return [f"-dict={file}"]


def single_edits(scratch: Path) -> list[Path]:
    """A folder of run files with one edit each: of every base run and of every kind."""
    folder = scratch / "single_edits"
    folder.mkdir()
    for base in range(4):
        for kind in range(16):
            edit = [kind, 23 * base + 7 * kind, kind, base, *[3] * 8]
            (folder / f"{base}-{kind}").write_bytes(bytes([base, base, *edit]))
    return [folder]


TARGETS = [
    Target("scene_reader", words, lambda _: [ROOT / "configs", ROOT / "tests" / "malformed"]),
    # As long as sixteen edits.
    Target("run_file_reader", lambda _: ["-max_len=194", "-len_control=0"], single_edits),
]


@dataclasses.dataclass
class Outcome:
    """The figures of one run; `finding` is the first line about what stopped it, else empty."""

    executions: int
    seconds: int
    edges: int
    features: int
    memory_mib: int
    slowest: int  # in whole seconds
    finding: str

    def row(self, name: str) -> str:
        """A row of the table."""
        rate = self.executions / max(1, self.seconds)
        slowest = f"{self.slowest} s" if self.slowest else "under 1 s"
        return (
            f"| `{name}` | {self.seconds} s | {self.executions} | {rate:.0f} | {self.edges} | "
            f"{self.features} | {self.memory_mib} MiB | {slowest} | "
            f"{self.finding or 'none'} |"
        )


HEADER = (
    "| target | time | executions | a second | edges | features | peak memory | slowest input "
    "| finding |\n|---|---:|---:|---:|---:|---:|---:|---:|---|"
)


def build() -> None:
    """Build the fuzzers; what the compilers say is shown if they fail."""
    for command in (
        ["cmake", "--preset", "asan-ubsan"],
        ["cmake", "--build", "--preset", "asan-ubsan", "--target", "der_fuzzers"],
    ):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stdout + done.stderr)


def place_of(log: str) -> str:
    """Whose code the innermost known frame is in: that of HDF5 and yaml-cpp is not ours to mend."""
    frame = re.search(
        r"^ *#\d+ .*?(libhdf5|libyaml-cpp|cpp/src|cpp/include|tests/fuzz)", log, re.MULTILINE
    )
    return f" in {frame[1]}" if frame else ""


def outcome_of(log: str) -> Outcome:
    """The figures that libFuzzer has printed."""

    def last(pattern: str) -> int:
        found = re.findall(pattern, log)
        return int(found[-1]) if found else 0

    error = re.search(r"^(?:==\d+== ?ERROR: |SUMMARY: )(.*)$", log, re.MULTILINE)
    uncaught = re.search(r"^terminate called .*\n(?:  what\(\): .*)?", log, re.MULTILINE)
    finding = " ".join(match[0] for match in (uncaught, error) if match)
    return Outcome(
        executions=last(r"stat::number_of_executed_units: *(\d+)") or last(r"^#(\d+)"),
        seconds=last(r"in (\d+) second"),
        edges=last(r"cov: (\d+)"),
        features=last(r"ft: (\d+)"),
        memory_mib=last(r"stat::peak_rss_mb: *(\d+)") or last(r"rss: (\d+)Mb"),
        slowest=last(r"stat::slowest_unit_time_sec: *(\d+)"),
        finding=finding + place_of(log) if finding else "",
    )


def fuzz(target: Target, seconds: int, scratch: Path) -> Outcome:
    """Fuzz one target, from its seeds, its regressions and what earlier runs have kept."""
    corpus = KEPT / "corpus" / target.name
    findings = KEPT / "findings" / target.name
    for folder in (corpus, findings):
        folder.mkdir(parents=True, exist_ok=True)
    command = [
        str(BUILD / "tests" / "fuzz" / f"{target.name}_fuzzer"),
        f"-max_total_time={seconds}",
        f"-rss_limit_mb={MEMORY_MIB}",
        f"-malloc_limit_mb={ALLOCATION_MIB}",
        f"-timeout={SECONDS_OF_AN_INPUT}",
        "-report_slow_units=2",
        "-print_final_stats=1",
        f"-artifact_prefix={findings}/",
        *target.options(scratch),
    ]
    folders = [corpus, REGRESSIONS / target.name, *target.seeds(scratch)]
    done = subprocess.run(
        [*command, *map(str, folders)],
        env={**os.environ, **SANITIZERS, "TMPDIR": str(scratch)},
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        errors="replace",
    )
    (findings / "log.txt").write_text(done.stderr)
    outcome = outcome_of(done.stderr)
    if done.returncode and not outcome.finding:
        outcome.finding = f"exit code {done.returncode}"
    return outcome


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", type=int, default=60, help="for each target")
    parser.add_argument("--only", default="", choices=["", *(t.name for t in TARGETS)])
    parser.add_argument("--jobs", type=int, default=1, help="targets at once")
    parser.add_argument("--no-build", action="store_true", help="the fuzzers are built already")
    arguments = parser.parse_args()
    if not arguments.no_build:
        build()
    memory = Path("/dev/shm")  # run files need no disk
    print(HEADER)
    chosen = [target for target in TARGETS if arguments.only in ("", target.name)]
    findings = 0
    with (
        tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as scratch,
        ThreadPoolExecutor(arguments.jobs) as pool,
    ):
        outcomes = pool.map(lambda each: fuzz(each, arguments.seconds, Path(scratch)), chosen)
        for target, outcome in zip(chosen, outcomes, strict=True):
            print(outcome.row(target.name), flush=True)
            findings += bool(outcome.finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
