"""Print the JSON Schema of a scene file, for editors that complete and check YAML."""

from __future__ import annotations

import argparse

from der import json_schema, scene_reference


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--markdown", action="store_true", help="print the reference of all keys to read instead"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the schema or the reference."""
    print((scene_reference() if arguments.markdown else json_schema()).rstrip())
    return 0
