"""Audit ``der verify``: random scenes with true values against its error bars.

    python tests/audit/run.py --scenes 300 --seed 1
    python tests/audit/run.py --kind static --only 17
    python tests/audit/run.py --extremes --scenes 10000 --jobs 2

Prints the share of true values within their bars, the share of right values that carry a flag, and
every value outside its bar. With ``--extremes`` single runs of scenes of extreme numbers are judged
in their place: right, refused by name, or wrong. Exits with 1 if an aim is missed
(docs/validation.md, docs/robustness.md).
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
import traceback
import warnings
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

sys.path.append(str(Path(__file__).resolve().parents[1] / "validation"))  # its references

import numpy as np
from audit import KINDS, aims_missed
from audit.answers import Answer, aims_of_answers_missed, answer, table
from audit.score import Outcome, judge, report

# Statics has the richest grammar, and takes every other turn.
TURNS = [turn for kind in sorted(KINDS) if kind != "static" for turn in ("static", kind)]


def outcome_of(kind: str, seed: int, number: int) -> Outcome:
    """Draw and judge one scene; the same numbers give the same scene."""
    rng = np.random.default_rng([seed, number, sum(map(ord, kind))])
    name = f"{kind}:{number}"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return judge(KINDS[kind](rng), name)
        except Exception as error:  # a crash is a finding, and the other scenes count as well
            where = traceback.extract_tb(error.__traceback__)[-1]
            remark = f"{type(error).__name__} in {where.name}: {str(error)[:200]}"
            return Outcome(name, kind, "", [], remark)


def audit(
    kinds: list[str], scenes: int, seed: int, *, first: int = 0, jobs: int = 1
) -> list[Outcome]:
    """``scenes`` scenes, the kinds taking turns."""
    numbers = range(first, first + scenes)
    turns = [kinds[number % len(kinds)] for number in numbers]
    if jobs == 1:
        return [outcome_of(kind, seed, number) for kind, number in zip(turns, numbers, strict=True)]
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn")) as pool:
        return list(pool.map(outcome_of, turns, [seed] * scenes, numbers))


def answers(scenes: int, seed: int, *, first: int = 0, jobs: int = 1) -> list[Answer]:
    """The outcomes of ``scenes`` scenes of extreme numbers."""
    numbers = range(first, first + scenes)
    if jobs == 1:
        return [answer(seed, number) for number in numbers]
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn")) as pool:
        return list(pool.map(answer, [seed] * scenes, numbers, chunksize=16))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", nargs="+", choices=sorted(KINDS), help="default: all, in turn")
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--only", type=int, help="the scene of this number alone, as YAML")
    parser.add_argument("--dump", type=Path, help="folder for the scenes with a value outside")
    parser.add_argument("--extremes", action="store_true", help="single runs of extreme scenes")
    arguments = parser.parse_args()
    if arguments.extremes:
        found = answers(
            arguments.scenes, arguments.seed, first=arguments.first, jobs=arguments.jobs
        )
        print(table(found))
        missed = aims_of_answers_missed(found)
        print(*missed, sep="\n")
        return 1 if missed else 0
    kinds = arguments.kind or TURNS
    if arguments.only is not None:
        outcome = outcome_of(kinds[arguments.only % len(kinds)], arguments.seed, arguments.only)
        print(outcome.scene, *outcome.refused, *outcome.rows, sep="\n")
        outcomes = [outcome]
    else:
        outcomes = audit(
            kinds, arguments.scenes, arguments.seed, first=arguments.first, jobs=arguments.jobs
        )
    print(report(outcomes))
    if arguments.dump:
        arguments.dump.mkdir(parents=True, exist_ok=True)
        for outcome in outcomes:
            if any(row.measured and not row.inside for row in outcome.rows):
                name = outcome.name.replace(":", "_") + ".yaml"
                (arguments.dump / name).write_text(outcome.scene, encoding="utf-8")
    missed = aims_missed(row for outcome in outcomes for row in outcome.rows)
    print(*missed, sep="\n")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
