"""Draw a run or a sweep.

A run shows its shapes, coloured by time, and its probes against time. A sweep shows its probes over
its parameters: lines over one, maps over two, parallel axes over more. Failed and doubtful members
are marked.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from der import load_sweep, open_run
from der.output_paths import PICTURE_ENDINGS, written_whole
from der.sweeps.store import is_sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("run", metavar="RUN", type=Path, help="folder of a run or a sweep")
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
        help="in space: 3d, in perspective (default), or the axes to the right and up, such as "
        "xz; 3d,xy draws two views",
    )
    parser.add_argument(
        "--scale",
        type=float,
        default=1.0,
        metavar="X",
        help="draw displacements X times as large, where a stiff structure shows none",
    )
    parser.add_argument(
        "--probes",
        nargs="+",
        metavar="NAME",
        help="probes to draw (default: all); of a sweep any columns, such as tip_y.max (default: "
        "what the analysis finds and the probes, six of them)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Write the picture and print its path."""
    import matplotlib as mpl

    out = arguments.out or arguments.run / "plot.png"
    if out.suffix.lower() not in PICTURE_ENDINGS:
        raise ValueError(f"cannot write {out.name}: a picture ends with .png, .svg or .pdf")
    mpl.use("agg")  # a file is written and no window opened, on a screen or without
    figure = _plot_sweep(arguments) if is_sweep(arguments.run) else _plot_run(arguments)
    with written_whole(out) as partial:
        figure.savefig(partial)
    print(out)
    return 0


def _plot_run(arguments: argparse.Namespace) -> Figure:
    return open_run(arguments.run).plot(
        arguments.what,
        times=arguments.times,
        probes=arguments.probes,
        views=None if arguments.view is None else arguments.view.split(","),
        scale=arguments.scale,
    )


def _plot_sweep(arguments: argparse.Namespace) -> Figure:
    options = (arguments.times, arguments.view, arguments.what != "overview")
    if any(options) or arguments.scale != 1.0:
        raise ValueError(
            "a sweep has neither times nor shapes: leave out --times, --view, --scale, --what"
        )
    return load_sweep(arguments.run).plot(arguments.probes)
