"""Try every hard case in every model and with every stepper: the tables of docs/robustness.md.

    python tests/hard/run.py --markdown
    python tests/hard/run.py --long --only Whip

Exits with 1 if a row does not end as expected, or if a known limit begins to pass.
"""

from __future__ import annotations

import argparse
import os
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from hard import CASES, complaints, play
from hard.report import markdown, plain


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--long", action="store_true", help="with what takes minutes")
    parser.add_argument("--only", default="", help="cases whose name or topic contains this")
    parser.add_argument("--markdown", action="store_true", help="the tables of docs/robustness.md")
    parser.add_argument("--times", action="store_true", help="what each case takes")
    arguments = parser.parse_args()
    rows = []
    for case in CASES:
        if arguments.only not in case.topic + " " + case.measure.__name__:
            continue
        begun = time.perf_counter()
        rows += [play(case, setting) for setting in case.settings(long=arguments.long)]
        if arguments.times:
            taken = time.perf_counter() - begun
            print(f"{taken:8.2f} s  {case.topic}: {case.measure.__name__}", file=sys.stderr)
    print(markdown(rows) if arguments.markdown else plain(rows))
    failures = complaints(rows)
    print(*failures, sep="\n", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
