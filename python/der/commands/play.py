"""Play a scene in the browser: set loads, motions and actuations, and pull rods with the mouse.

Prints the address of the page, and ends when it is closed or with Ctrl-C. Scenes with an analysis
in place of a time do not move. Requires the package viser.
"""

from __future__ import annotations

import argparse

from der.arguments import whole_number_argument
from der.playing import play


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", help="scene file (YAML), or example:NAME")
    parser.add_argument(
        "--port",
        type=whole_number_argument,
        default=8080,
        metavar="N",
        help="port of the address, or else the next one that is free (default: 8080)",
    )
    parser.add_argument("--open", action="store_true", help="show the page in a browser")


def execute(arguments: argparse.Namespace) -> int:
    """Serve the page until it is closed."""
    play(arguments.scene, port=arguments.port, open=arguments.open)
    return 0
