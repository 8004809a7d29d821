"""Compare two folders of run folders, such as those of the version before a change and after it.

    scripts/compare_runs.py BEFORE AFTER [--tolerance 1e-12]

Both hold a run folder of the same name for each scene. For each one it prints the column with the
largest difference, against the largest value of that column; columns that only one of the two has
are named. Exit code 1 where a difference is above the tolerance or a scene is missing.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

Columns = dict[str, NDArray[Any]]


def columns(run: Path) -> Columns:
    """Return every array of numbers in a run folder, by its name in ``results.h5``.

    Checkpoints are left out: they are written by the clock.
    """
    found: Columns = {}

    def keep(name: str, item: Any) -> None:
        numbers = isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu"
        if numbers and not name.startswith("checkpoint/"):
            found[name] = item[()]

    with h5py.File(run / "results.h5", "r") as file:
        file.visititems(keep)
    return found


def difference(before: NDArray[Any], after: NDArray[Any]) -> float:
    """Return the largest difference against the largest value; infinity if the shapes differ."""
    if before.shape != after.shape:
        return np.inf
    if not before.size or np.array_equal(before, after, equal_nan=True):
        return 0.0
    scale = np.max(np.abs(before))
    largest = np.max(np.abs(np.asarray(after, float) - np.asarray(before, float)))
    return float(largest / scale) if scale > 0.0 else np.inf


def compare(before: Columns, after: Columns) -> tuple[float, str]:
    """Return the largest difference of two runs, with words that say where it is."""
    common = before.keys() & after.keys()
    worst = max(common, key=lambda name: difference(before[name], after[name]))
    largest = difference(before[worst], after[worst])
    words = "the same bits" if largest == 0.0 else f"{largest:.1e} in {worst}"
    alone = sorted(name for name in before.keys() ^ after.keys())
    return largest, words + (f"; only in one of them: {', '.join(alone)}" if alone else "")


def main() -> int:
    """Print a line a scene; return the exit code."""
    parser = argparse.ArgumentParser(description="Compare two folders of run folders.")
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--tolerance", type=float, default=1e-12, help="default: %(default)g")
    options = parser.parse_args()
    failed = False
    for run in sorted(path.parent for path in options.before.glob("*/results.h5")):
        other = options.after / run.name
        if not (other / "results.h5").exists():
            print(f"{run.name}: no run in {options.after}")
            failed = True
            continue
        largest, words = compare(columns(run), columns(other))
        failed |= largest > options.tolerance
        print(f"{run.name}: {words}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
