"""der beside PyElastica and MuJoCo on the public score board cosseratbench, in one run.

    pip install '.[board]' 'pyelastica>=1.0' 'mujoco>=3.2,<4'
    python benchmarks/board.py [EXPERIMENT ...] [--solvers der pyelastica mujoco] [--csv FILE]

The board's own code builds the scenarios and scores the solvers; this program chooses what runs,
and prints one table. Times are CPU seconds of the run on one core, the least of several where a run
is short, without the board's warm-up, in which kernels are compiled. A solver that is not installed
is left out. All four experiments without contact take some minutes, most of them PyElastica's.

MuJoCo has to be 3.x: the board runs its cable plugin, which is gone from version 4.
"""

from __future__ import annotations

import argparse
import csv
import importlib.metadata
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from peers import use_one_core

if TYPE_CHECKING:
    from cosseratbench import Capability, Experiment, Scenario, Solver, Trajectory

EXPERIMENTS = ("cantilever", "catenary", "pendulum", "twist")
#: Names on the board, and the packages that they drive.
SOLVERS = {"der": "der", "pyelastica": "pyelastica", "mujoco": "mujoco"}
TITLES = {"der": "der", "pyelastica": "PyElastica", "mujoco": "MuJoCo"}
#: Runs are repeated until they have taken so long together [s], or so often.
ENOUGH, REPEATS = 2.0, 5


@dataclass
class Timed:
    """A solver of the board that tells the CPU time of its last run."""

    solver: Solver
    seconds: float = float("nan")

    @property
    def name(self) -> str:
        """Name on the board."""
        return str(self.solver.name)

    @property
    def capabilities(self) -> frozenset[Capability]:
        """The capabilities of the solver."""
        return self.solver.capabilities

    def run(self, scenario: Scenario, *, n_elements: int, n_frames: int) -> Trajectory:
        """Run a scenario."""
        before = time.process_time()
        trajectory = self.solver.run(scenario, n_elements=n_elements, n_frames=n_frames)
        self.seconds = time.process_time() - before
        return trajectory


@dataclass(frozen=True)
class Score:
    """The score of a solver in an experiment."""

    experiment: str
    solver: str
    n_elements: int
    metrics: dict[str, float]
    seconds: float
    outcome: str = ""  # why there are no metrics


def score(experiment: Experiment, solver: Solver, n_elements: int | None) -> Score:
    """Run an experiment with the board's code, as often as its time asks for."""
    from cosseratbench import run

    timed, spent, least = Timed(solver), 0.0, float("inf")
    for _ in range(REPEATS):
        result = run(experiment, timed, n_elements=n_elements)
        least = min(least, timed.seconds)
        spent += timed.seconds
        if result.outcome != "completed" or spent > ENOUGH:
            break
    why = ""
    if result.outcome != "completed":
        why = (
            f"diverged: {result.failure}"
            if result.failure
            else "needs " + ", ".join(result.missing)
        )
    return Score(experiment.name, solver.name, result.n_elements, dict(result.metrics), least, why)


def solvers(names: Sequence[str]) -> Iterator[tuple[Solver, str]]:
    """Load solvers, with their versions; say which are missing, and how to get them."""
    from cosseratbench import registry

    for name in names:
        try:
            version = importlib.metadata.version(SOLVERS[name])
            if name == "mujoco" and int(version.partition(".")[0]) > 3:
                print(
                    f"MuJoCo {version} lacks the cable that the board runs: pip install 'mujoco<4'"
                )
                continue
            yield registry.load_solver(name), version
        except ModuleNotFoundError:
            print(f"{TITLES[name]}: not installed: pip install {SOLVERS[name]}")


def table(scores: Sequence[Score], titles: dict[str, str]) -> str:
    """Return a row for each metric of each experiment, and one for the CPU time."""
    lines = [
        "| experiment | elements | | " + " | ".join(titles.values()) + " |",
        "|---" * (3 + len(titles)) + "|",
    ]
    for name in dict.fromkeys(one.experiment for one in scores):
        own = {one.solver: one for one in scores if one.experiment == name}
        metrics = list(dict.fromkeys(key for one in own.values() for key in one.metrics))
        head = f"| {name} | {next(iter(own.values())).n_elements} |"
        for metric in metrics:
            cells = [_number(own[solver], metric) for solver in titles]
            lines.append(f"{head} {metric.replace('_', ' ')} | " + " | ".join(cells) + " |")
            head = "| | |"
        lines.append(f"{head} CPU time | " + " | ".join(map(_time, map(own.get, titles))) + " |")
    return "\n".join(lines)


def _number(one: Score, metric: str) -> str:
    return one.outcome or f"{one.metrics[metric]:.1e}"


def _time(one: Score) -> str:
    from comparison.report import time_text

    return one.outcome or time_text(one.seconds)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for and print the table."""
    use_one_core()
    options = parse(arguments)
    try:
        from cosseratbench import registry
    except ModuleNotFoundError:
        print("the board is not installed: pip install 'der[board]'", file=sys.stderr)
        return 1
    found = list(solvers(options.solvers))
    if not found:
        print("nothing to measure", file=sys.stderr)
        return 1
    titles = {solver.name: f"{TITLES[solver.name]} {version}" for solver, version in found}
    print(
        f"cosseratbench {importlib.metadata.version('cosseratbench')}: "
        + ", ".join(titles.values())
    )
    scores = []
    for name in options.experiments:
        for solver, _ in found:
            scores.append(score(registry.load_experiment(name), solver, options.elements))
            last = scores[-1]
            print(f"{name}, {last.solver}: {last.outcome or _time(last)}", file=sys.stderr)
    print(f"\n{table(scores, titles)}")
    if options.csv is not None:
        write_csv(options.csv, scores)
    return 0


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line."""
    from der.output_paths import output_file  # not before: see peers.py

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("experiments", nargs="*", default=EXPERIMENTS, metavar="EXPERIMENT")
    parser.add_argument("--solvers", nargs="+", choices=SOLVERS, default=list(SOLVERS))
    parser.add_argument("--elements", type=int, help="of each rod, in place of the board's own")
    parser.add_argument("--csv", type=output_file, metavar="FILE", help="write every number")
    return parser.parse_args(arguments)


def write_csv(path: Path, scores: Sequence[Score]) -> None:
    """Write a row for each metric."""
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(
            ["experiment", "solver", "elements", "metric", "value", "cpu_seconds", "outcome"]
        )
        for one in scores:
            for metric, value in (one.metrics or {"": float("nan")}).items():
                rows.writerow(
                    [
                        one.experiment,
                        one.solver,
                        one.n_elements,
                        metric,
                        value,
                        one.seconds,
                        one.outcome,
                    ]
                )


if __name__ == "__main__":
    sys.exit(main())
