"""Write an interactive 3D view of a run: one HTML file that opens offline in a browser."""

from __future__ import annotations

import argparse
from pathlib import Path

from der import open_run
from der.viewing import view


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("run", metavar="RUN", type=Path, help="run folder")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="file to write (default: RUN/view.html)"
    )
    parser.add_argument("--open", action="store_true", help="show it in a browser")


def execute(arguments: argparse.Namespace) -> int:
    """Write the file and print its path."""
    out = arguments.out or arguments.run / "view.html"
    print(view(open_run(arguments.run), out, open=arguments.open))
    return 0
