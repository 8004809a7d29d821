"""Kill runs, fill disks, damage files, and see what is left: the figures of docs/robustness.md.

    python tests/survival/run.py --kills 100
    python tests/survival/run.py --only tr_bdf2 --kills 500

Exits with 1 if anything saved is lost, changed or unreadable.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from survival import damage, fill_disk, kill, prepare, scenes, two_at_once


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--kills", type=int, default=100, help="of each stepper and analysis")
    parser.add_argument("--damages", type=int, default=1000, help="damaged files of each analysis")
    parser.add_argument("--steps", type=int, default=4000, help="length of the runs")
    parser.add_argument("--only", default="", help="one stepper or analysis")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    faults: list[str] = []
    print("| run | killed | full disks | two at once | damaged files refused | faults |")
    print("|---|---:|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for subject_name, scene in scenes(arguments.steps).items():
            if arguments.only not in ("", subject_name):
                continue
            subject = prepare(subject_name, scene, folder)
            out = folder / "out"
            found = [f for _ in range(arguments.kills) for f in kill(subject, rng, out)]
            limits = [int(10 ** rng.uniform(3, 5.5)) for _ in range(10)]
            found += [f for limit in limits for f in fill_disk(subject, limit, out)]
            found += two_at_once(subject, out)
            refused, wrong = damage(subject, rng, arguments.damages, folder / "damaged")
            found += wrong
            faults += found
            print(
                f"| `{subject_name}` | {arguments.kills} | {len(limits)} | 1 | "
                f"{refused} of {arguments.damages} | {len(found)} |",
                flush=True,
            )
    print(*faults, sep="\n", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
