"""Put an error bar on every probe of a scene, by runs on finer meshes and with smaller steps.

Runs the scene as written, with 2 and 4 times as many elements, and with a half and a quarter of the
step. Prints each probe with its error in space and in time, the value extrapolated to the limit,
and whether it converges at the order that mesh and stepper have. Exit codes: 5 if a value does not,
0 otherwise (two levels measure no order), 1 for a mistake in the scene, 3 if the scene fails.
"""

from __future__ import annotations

import argparse
import json

from der.accuracy import verify
from der.arguments import whole_number_argument
from der.output_paths import output_file, written_whole
from der.progress import progress_on_terminal

_FLAGGED = 5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", help="scene file (YAML), or example:NAME")
    parser.add_argument(
        "--json",
        type=output_file,
        metavar="FILE",
        help="also write everything that was found to FILE",
    )
    parser.add_argument(
        "--levels",
        type=whole_number_argument,
        choices=(2, 3),
        help="2: one refinement, cheap; 3: two, which measure the order (default: 3 if that takes "
        "less than a minute)",
    )
    parser.add_argument(
        "--jobs",
        type=whole_number_argument,
        metavar="N",
        help="runs at once (default: as many as there are cores)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the table and return the exit code."""
    with progress_on_terminal() as progress:
        verification = verify(
            arguments.scene, levels=arguments.levels, jobs=arguments.jobs, progress=progress
        )
    print(verification)
    if arguments.json is not None:
        text = json.dumps(verification.to_dict(), indent=2, ensure_ascii=False)
        with written_whole(arguments.json) as partial:
            partial.write_text(text + "\n", encoding="utf-8")
    return _FLAGGED if verification.flagged else 0
