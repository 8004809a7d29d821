"""Regenerate every figure and number of the course report, beside ours and the exact one.

Runs the report's three problems and writes report.html, which holds everything and needs no other
file, report.md, every figure as PNG and the numbers as CSV. Takes about half a minute on two cores.
Exit codes: 0, 1 if the folder cannot be written, 3 if a run fails; then nothing is written.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from der.output_paths import output_folder
from der.progress import progress_on_terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--out",
        type=output_folder,
        default=Path("reproduction"),
        metavar="FOLDER",
        help="folder to write to; an earlier reproduction there is replaced, anything else is left "
        "alone (default: %(default)s)",
    )
    parser.add_argument(
        "--jobs", type=int, metavar="N", help="runs at once (default: as many as there are cores)"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Write the folder and print the path of the report."""
    import matplotlib as mpl

    from der.reproduce import reproduce

    mpl.use("agg")  # files are written and no window opened, on a screen or without
    with progress_on_terminal() as progress:
        begun = progress.label if progress is not None else _print_stage
        report = reproduce(arguments.out, jobs=arguments.jobs, progress=progress, begun=begun)
    print(report)
    return 0


def _print_stage(name: str) -> None:
    """Tell on the error stream, where the path of the report does not go."""
    print(name, file=sys.stderr, flush=True)
