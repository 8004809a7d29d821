"""Draw a run: shapes coloured by time, and probes against time."""

from __future__ import annotations

import argparse
from pathlib import Path

from der import open_run
from der.output_paths import PICTURE_ENDINGS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("run", metavar="RUN", type=Path, help="run folder")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="picture to write, .png, .svg or .pdf (default: RUN/plot.png)",
    )
    parser.add_argument(
        "--what", choices=("overview", "shapes", "probes"), default="overview", help="what to draw"
    )
    parser.add_argument(
        "--times", nargs="+", type=float, metavar="T", help="times of the shapes [s]"
    )
    parser.add_argument(
        "--view",
        metavar="AXES",
        help="axes to the right and upwards, in space, such as xz; xy,xz draws two views",
    )
    parser.add_argument("--probes", nargs="+", metavar="NAME", help="probes to draw (default: all)")


def execute(arguments: argparse.Namespace) -> int:
    """Write the picture and print its path."""
    import matplotlib as mpl

    out = arguments.out or arguments.run / "plot.png"
    if out.suffix.lower() not in PICTURE_ENDINGS:
        raise ValueError(f"cannot write {out.name}: a picture ends with .png, .svg or .pdf")
    mpl.use("agg")  # a file is written and no window opened, on a screen or without
    result = open_run(arguments.run)
    figure = result.plot(
        arguments.what,
        times=arguments.times,
        probes=arguments.probes,
        views=None if arguments.view is None else arguments.view.split(","),
    )
    figure.savefig(out)
    print(out)
    return 0
