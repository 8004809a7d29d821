"""Run a scene and write its results to a folder; `der run --help` has the options."""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import sys
import sysconfig
from pathlib import Path

from der.examples import scene_path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Take everything that follows as it is."""
    parser.add_argument("arguments", nargs="*", metavar="ARGUMENT")
    # No argument starts with this character, so that options, even --help, pass as arguments.
    parser.prefix_chars = "\0"


def execute(arguments: argparse.Namespace) -> int:
    """Turn this process into der_run, which calls itself as its first argument says."""
    program = _find_program()
    sys.stdout.flush()
    # Python ignores it, and so would der_run, which is ended by it otherwise: `der run ... | head`.
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    os.execv(program, ["der run", *map(scene_path, arguments.arguments)])


def _find_program() -> Path:
    beside_python = Path(sysconfig.get_path("scripts"), "der_run")
    if beside_python.exists():
        return beside_python
    on_path = shutil.which("der_run")
    if on_path is None:
        raise FileNotFoundError(
            f"der_run is neither in {beside_python.parent} nor on the PATH; `pip install` of der "
            "puts it there"
        )
    return Path(on_path)
