"""Run a scene with many values of its parameters: each member a row of a table.

Writes FOLDER/sweep.sqlite, to which members are added while they finish; a member that fails is a
row as well. VALUES are spelled 1,2,5 or as a range with its number of values, 0:1:11, in equal
ratios 1e6:1e9:7:log; with --sample, as 0:1 or 1e6:1e9:log. Exit codes: 0, 1 for a mistake in the
scene or the values of arguments, 2 for a command line that cannot be read, 3 if every member
failed, 130 after Ctrl-C, 143 after SIGTERM: what is finished is kept, and --resume goes on.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from der.arguments import whole_number_argument
from der.interrupts import exit_code, told
from der.output_paths import output_folder
from der.progress import progress_on_terminal

if TYPE_CHECKING:
    from der.sweeps.executors import AnyExecutor

_ALL_FAILED = 3


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "scene", metavar="SCENE", type=Path, help="scene file (YAML), or example:NAME"
    )
    parser.add_argument(
        "--vary",
        action="append",
        required=True,
        metavar="PATH=VALUES",
        help="a parameter, as `der_run --set` names it, and its values; can be given more than "
        "once: each value with each",
    )
    parser.add_argument(
        "--zip", action="store_true", help="take the values side by side instead of each with each"
    )
    parser.add_argument(
        "--sample",
        metavar="KIND:N",
        help="sobol:N or lhs:N: N points in the space of all parameters",
    )
    parser.add_argument(
        "--seed",
        type=whole_number_argument,
        default=0,
        metavar="N",
        help="where the sample starts (default: 0)",
    )
    parser.add_argument(
        "--out",
        type=output_folder,
        required=True,
        metavar="FOLDER",
        help="folder for sweep.sqlite",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on with an interrupted sweep, or with more values; begin it if there is none",
    )
    parser.add_argument(
        "--frames", action="store_true", help="keep the run folder of each member as well"
    )
    parser.add_argument(
        "--verify", action="store_true", help="put error bars on each member, as `der verify`"
    )
    parser.add_argument(
        "--jobs",
        type=whole_number_argument,
        metavar="N",
        help="runs at once (default: as many as there are cores)",
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--processes",
        action="store_true",
        help="processes in place of threads: faster on many cores where a member takes less than "
        "a few milliseconds",
    )
    where.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="run on a Dask cluster: tcp://HOST:PORT of its scheduler, or its scheduler file "
        "(requires the package distributed)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Run the members that are not in the folder yet, and print how many failed."""
    from der.sweeps import sweep
    from der.sweeps.design import make_design
    from der.sweeps.store import FILE

    vary = dict(map(_varied, arguments.vary))
    if len(vary) < len(arguments.vary):
        raise ValueError("--vary: a parameter is given twice; give all its values at once")
    design = make_design(vary, zipped=arguments.zip, sample=arguments.sample, seed=arguments.seed)
    for repeat in design.repeats():
        print(repeat)
    try:
        with _executor(arguments) as executor, progress_on_terminal() as progress:
            found = sweep(
                arguments.scene,
                vary,
                out=arguments.out,
                resume=arguments.resume,
                zipped=arguments.zip,
                sample=arguments.sample,
                seed=arguments.seed,
                frames=arguments.frames,
                verify=arguments.verify,
                jobs=arguments.jobs,
                executor=executor,
                progress=progress,
            )
    except KeyboardInterrupt as interrupt:
        print(f"{told(interrupt)}: {_kept(arguments.out)}", file=sys.stderr)
        return exit_code(interrupt)
    print(f"{found.scenario.title}: {found.summary()}")
    print(arguments.out / FILE)
    return _ALL_FAILED if found.all_failed else 0


def _varied(text: str) -> tuple[str, str]:
    path, equals, values = text.partition("=")
    if not (path and equals and values):
        raise ValueError(f"--vary: '{text}' is no parameter with values: write PATH=1,2,5")
    return path, values


def _kept(out: Path) -> str:
    """Return what a sweep that was interrupted leaves."""
    from der.sweeps import load_sweep

    try:
        kept = len(load_sweep(out))
    except (OSError, ValueError):
        kept = 0  # it never began
    what = "no member is" if kept == 0 else "1 member is" if kept == 1 else f"{kept} members are"
    return f"{what} kept in {out}; the same command with --resume goes on from there"


@contextmanager
def _executor(arguments: argparse.Namespace) -> Iterator[AnyExecutor | None]:
    """Give what runs the members for the time of a ``with`` block; None for threads."""
    if arguments.processes:
        from der.sweeps.executors import Processes

        with Processes(arguments.jobs) as pool:
            yield pool
    elif arguments.dask is not None:
        from der.sweeps.executors import connect

        with connect(arguments.dask) as client:
            yield client
    else:
        yield None
