"""Measure what accuracy costs: vary nodes, step and stepper of a scene.

Writes study.csv and study.png, and prints the cheapest configuration for each requested error. The
error of a probe is its largest difference from a reference over the frames that the scene saves,
in the unit of the probe; the reference is extrapolated from finer meshes and smaller steps. The
cost is CPU time, the smallest of up to five runs. Exit codes: 0, 1 for a mistake in the
scene or the values of arguments, 2 for a command line that cannot be read, 3 if the scene itself
fails.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from der.arguments import whole_number_argument
from der.examples import PREFIX
from der.output_paths import check_output_folder, make_folder, output_folder, written_whole
from der.progress import progress_on_terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "scene", metavar="SCENE", type=Path, help="scene file (YAML), or example:NAME"
    )
    parser.add_argument(
        "--nodes",
        nargs="+",
        type=whole_number_argument,
        metavar="N",
        help="nodes of the first rod that can be refined (default: 1/2 to 4 times the elements)",
    )
    parser.add_argument(
        "--steps",
        nargs="+",
        type=float,
        metavar="DT",
        help="time steps [s] (default: four times to an eighth of the scene's, or if that is "
        "explicit or adaptive, 1/50 to 1/1600 of the duration; for explicit steppers the longest "
        "stable ones)",
    )
    parser.add_argument(
        "--steppers", nargs="+", metavar="NAME", help="time integrators (default: all)"
    )
    parser.add_argument(
        "--errors",
        nargs="+",
        type=float,
        metavar="E",
        help="errors to give advice for, in the units of the probes (default: powers of ten)",
    )
    parser.add_argument(
        "--max-seconds",
        type=float,
        default=2.0,
        metavar="S",
        help="skip configurations that would take longer (default: %(default)g s)",
    )
    parser.add_argument(
        "--jobs",
        type=whole_number_argument,
        metavar="N",
        help="runs at once for the reference (default: as many as there are cores)",
    )
    parser.add_argument(
        "--out", type=output_folder, metavar="DIR", help="folder to write to (default: SCENE_study)"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Write table and picture, and print the advice."""
    import matplotlib as mpl

    from der.accuracy.studier import study
    from der.accuracy.study_plan import check_errors

    if arguments.errors is not None:
        check_errors(arguments.errors)
    out = arguments.out or Path(f"{arguments.scene.stem.removeprefix(PREFIX)}_study")
    check_output_folder(out)
    mpl.use("agg")  # a file is written and no window opened, on a screen or without
    with progress_on_terminal() as progress:
        found = study(
            arguments.scene,
            nodes=arguments.nodes,
            steps=arguments.steps,
            steppers=arguments.steppers,
            max_seconds=arguments.max_seconds,
            jobs=arguments.jobs,
            progress=progress,
        )
    make_folder(out)
    found.write_csv(out / "study.csv")
    with written_whole(out / "study.png") as partial:
        found.plot().savefig(partial)
    for note in found.notes:
        print(f"Note: {note}.")
    for line in found.advice(arguments.errors):
        print(line)
    print(out / "study.csv")
    print(out / "study.png")
    return 0
