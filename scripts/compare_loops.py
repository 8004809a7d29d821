"""Run scenes with the plain innermost loops and with those for AVX2, and compare the results.

    scripts/compare_loops.py [SCENE ...]

Without scenes: those of configs/. Prints a table in Markdown: whether all that a run saves has the
same bits, and the largest difference of the positions against the size of the structure, at the end
and in any frame. Each run is made twice; exit code 1 where two with the same loops differ.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from compare_runs import Columns, columns, compare
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parent.parent
DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))


def run(scene: Path, folder: Path, loops: str) -> Columns:
    """Return the arrays of a run with these loops."""
    command = [DER_RUN, str(scene), "--out", str(folder), "--quiet"]
    # A scene may be one that must not complete: what it has saved until then is compared.
    subprocess.run(command, env={**os.environ, "DER_LOOPS": loops}, stderr=subprocess.DEVNULL)
    return columns(folder)


def differences(plain: Columns, avx2: Columns) -> NDArray[np.float64]:
    """Return for each frame the largest difference of positions against the structure's size."""
    one, other = (found["positions"] for found in (plain, avx2))
    size = np.max(np.ptp(one, axis=1), axis=1)
    return np.max(np.abs(one - other), axis=(1, 2)) / size


def row(scene: Path, folder: Path) -> tuple[str, bool]:
    """Return a row of the table, and whether two runs with the same loops have the same bits."""
    pairs = {
        loops: [run(scene, folder / f"{loops}{i}", loops) for i in range(2)]
        for loops in ("plain", "avx2")
    }
    repeats = all(compare(*pair)[0] == 0.0 for pair in pairs.values())
    plain, avx2 = (pair[0] for pair in pairs.values())
    bits = "the same" if compare(plain, avx2)[0] == 0.0 else "others"
    frames = differences(plain, avx2)
    return f"| `{scene.stem}` | {bits} | {frames[-1]:.0e} | {np.max(frames):.0e} |", repeats


def main() -> int:
    """Print the table; return the exit code."""
    parser = argparse.ArgumentParser(description="Compare the two sorts of innermost loops.")
    parser.add_argument("scenes", nargs="*", type=Path, metavar="SCENE")
    scenes = parser.parse_args().scenes or sorted((ROOT / "configs").glob("*.yaml"))
    print("| scene | bits | at the end | in any frame |\n|---|---|---:|---:|")
    wrong = []
    for scene in scenes:
        with tempfile.TemporaryDirectory() as folder:
            line, repeats = row(scene, Path(folder))
        print(line, flush=True)
        if not repeats:
            wrong.append(scene.stem)
    for name in wrong:
        print(f"{name}: two runs with the same loops differ", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
