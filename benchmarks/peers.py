"""Cost against error in der, Exudyn, MuJoCo, PyElastica and DiSMech-Newton, in one run.

    pip install .[peers]
    python benchmarks/peers.py [--scene SCENE] [--peers der exudyn ...] [--quick] [--csv FILE]
                               [--plot FILE]

A soft rod, 1 m long, is clamped horizontally at one end and falls for 1 s. The scene ``swing`` is a
round rod, which stays in its plane; ``strip`` is a strip that is clamped askew and therefore bends
about both axes and twists. Each code tries many
numbers of elements, time steps and settings; the error is the largest distance of the tip from the
continuum's at 101 times. Times are CPU seconds of the time loop on one core, the least of several
runs taken in turns; imports, compilation and the building of models do not count. A peer that is
not installed is left out. The whole takes about ten minutes a scene; --quick some ten seconds, with
so few configurations that its numbers say little.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

THREAD_LIMITS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print the tables, and write what was asked for."""
    use_one_core()
    # Not before: libraries read the thread limits when they are first imported.
    from comparison import plot, report
    from comparison.codes import CODES, missing_text
    from comparison.measure import measure
    from comparison.scenes import SCENES
    from der.progress import progress_on_terminal

    options = parse(arguments, list(SCENES), [code.key for code in CODES])
    scene = SCENES[options.scene]
    codes = [code for code in CODES if code.key in options.peers]
    for code in codes:
        if not code.is_installed():
            print(missing_text(code))
    codes = [code for code in codes if code.is_installed()]
    if not codes:
        print("nothing to measure", file=sys.stderr)
        return 1
    with progress_on_terminal() as progress:
        repeats = 2 if options.quick else options.repeats
        points, limits = measure(scene, codes, options.quick, repeats, progress)
    series = report.to_series(points)
    print(", ".join(f"{code.title} {code.version()}" for code in codes))
    texts = (report.cost_table(series), report.notes(limits), report.configuration_table(series))
    print("".join(f"\n{text}\n" for text in texts if text))
    if options.csv is not None:
        report.write_csv(options.csv, points)
    if options.plot is not None:
        plot.write(options.plot, series)
    return 0


def parse(
    arguments: Sequence[str] | None, scenes: Sequence[str], codes: Sequence[str]
) -> argparse.Namespace:
    """Read the command line; `scenes` and `codes` are the keys of all that there are."""
    from der.output_paths import output_file, output_picture  # not before: see main

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scene", choices=scenes, default="swing")
    parser.add_argument("--peers", nargs="+", choices=codes, default=codes, metavar="CODE")
    parser.add_argument("--quick", action="store_true", help="few configurations, two runs each")
    parser.add_argument("--repeats", type=int, default=3, help="runs of those that are worth it")
    parser.add_argument("--csv", type=output_file, metavar="FILE", help="write every run")
    parser.add_argument(
        "--plot", type=output_picture, metavar="FILE", help="draw cost against error"
    )
    return parser.parse_args(arguments)


def use_one_core() -> None:
    """Keep this process on one core, and its libraries to one thread."""
    os.environ.update(dict.fromkeys(THREAD_LIMITS, "1"))
    if hasattr(os, "sched_setaffinity"):  # Linux only
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


if __name__ == "__main__":
    sys.exit(main())
