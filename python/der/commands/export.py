"""Write a run or a sweep for other programs: CSV, NPZ for NumPy, VTK for ParaView, or Parquet."""

from __future__ import annotations

import argparse
from pathlib import Path

from der import load_sweep, open_run
from der.exporting import export
from der.progress import progress_on_terminal
from der.sweeps.store import is_sweep


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("run", metavar="RUN", type=Path, help="folder of a run or a sweep")
    parser.add_argument(
        "--format",
        choices=("csv", "npz", "vtk", "parquet"),
        required=True,
        help="csv: a table of the nodes and one of the probes; npz: every array; vtk: a series of "
        "files that ParaView opens (requires the package pyevtk). Of a sweep, csv: its table; npz: "
        "an array for each column; parquet: its table (requires the package pyarrow)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="PATH",
        help="folder to write to, for npz and of a sweep the file (default: RUN/csv, RUN/run.npz, "
        "RUN/vtk; RUN/sweep.csv and so on)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Write the files and print their paths."""
    if is_sweep(arguments.run):
        out = arguments.out or arguments.run / f"sweep.{arguments.format}"
        for path in load_sweep(arguments.run).export(arguments.format, out):
            print(path)
        return 0
    result = open_run(arguments.run)
    name = "run.npz" if arguments.format == "npz" else arguments.format
    out = arguments.out or arguments.run / name
    with progress_on_terminal() as progress:
        for path in export(result, arguments.format, out, progress=progress):
            print(path)
    return 0
