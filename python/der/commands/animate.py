"""Write an animation of a run: GIF or MP4, true to time and to scale.

The frames of a path of equilibria are its points; modes vibrate one after the other. MP4 output
requires the package imageio-ffmpeg. Runs in space are seen in perspective. Animations are limited
to 20,000 frames.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from der import open_run
from der.progress import progress_on_terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("run", metavar="RUN", type=Path, help="run folder")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="file to write, .gif or .mp4 (default: RUN/animation.gif)",
    )
    parser.add_argument(
        "--fps", type=float, default=25.0, metavar="N", help="frames per second (default: 25)"
    )
    parser.add_argument(
        "--speed",
        type=float,
        metavar="X",
        help="simulated seconds per second of the animation (default: 1 for runs of 1 to 20 s, "
        "else a round number for about 8 s)",
    )
    parser.add_argument(
        "--view",
        metavar="AXES",
        help="in space: 3d, in perspective (default), or the axes to the right and up, such as xz",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Write the file and print its path."""
    from der.animation import animate

    result = open_run(arguments.run)
    out = arguments.out or arguments.run / "animation.gif"
    with progress_on_terminal() as progress:
        animate(
            result,
            out,
            fps=arguments.fps,
            speed=arguments.speed,
            view=arguments.view,
            progress=progress,
        )
    print(out)
    return 0
