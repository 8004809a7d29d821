"""Validate scene files without running them."""

from __future__ import annotations

import argparse
import sys

from der import Scenario
from der.errors import DerError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "scenes", nargs="+", metavar="SCENE", help="scene file (YAML), or example:NAME"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print every diagnostic of every file; return 0 only if there is none."""
    invalid = 0
    for path in arguments.scenes:
        try:
            scenario = Scenario.load(path)
        except DerError as error:
            invalid += 1
            print(error, file=sys.stderr)
        else:
            print(f"{path}: valid ({scenario.title})")
    return 1 if invalid else 0
