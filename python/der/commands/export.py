"""Write a run for other programs: CSV tables, NPZ for NumPy, or VTK files for ParaView."""

from __future__ import annotations

import argparse
from pathlib import Path

from der import open_run
from der.exporting import export
from der.progress import progress_on_terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("run", metavar="RUN", type=Path, help="run folder")
    parser.add_argument(
        "--format",
        choices=("csv", "npz", "vtk"),
        required=True,
        help="csv: a table of the nodes and one of the probes; npz: every array; vtk: a series of "
        "files that ParaView opens (requires the package pyevtk)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="PATH",
        help="folder to write to, for npz the file (default: RUN/csv, RUN/run.npz, RUN/vtk)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Write the files and print their paths."""
    result = open_run(arguments.run)
    name = "run.npz" if arguments.format == "npz" else arguments.format
    out = arguments.out or arguments.run / name
    with progress_on_terminal() as progress:
        for path in export(result, arguments.format, out, progress=progress):
            print(path)
    return 0
