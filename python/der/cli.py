"""The command ``der``: one subcommand for each file of ``der/commands``."""

from __future__ import annotations

import argparse
import importlib
import os
import pkgutil
import signal
import sys
import warnings
from collections.abc import Sequence

from der import __version__, commands
from der.errors import DerError, DivergedError, NotConvergedError
from der.interrupts import (
    end_with_signals,
    exit_code,
    take_one_interrupt,
    take_one_termination,
    told,
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a subcommand and return its exit code, as der_run has them; without one, print the help.

    0, or with a message on stderr 3 if a run failed and 1 for anything else; a command may have
    others of its own. 2 for a command line that cannot be read, 130 after Ctrl-C, 143 after
    SIGTERM. Without a message 141 if nobody reads what it prints any more, as the shell calls the
    end of a program by SIGPIPE.

    Parameters
    ----------
    arguments
        In place of those of the process.
    """
    warnings.showwarning = _print_warning
    taken = [take_one_interrupt(), take_one_termination()]
    try:
        return _execute(arguments)
    finally:
        if any(taken):
            end_with_signals()


def _execute(arguments: Sequence[str] | None) -> int:
    try:
        try:
            parser = _make_parser()
            chosen = parser.parse_args(arguments)
            if chosen.execute is None:
                parser.print_help()
                return 0
            return int(chosen.execute(chosen))
        finally:
            # Here and not when Python ends, where nobody catches errors. There may be no stdout.
            print(end="", flush=True)
    except BrokenPipeError:
        _discard_output()
        return 128 + signal.SIGPIPE
    except (NotConvergedError, DivergedError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 3
    except (DerError, OSError, ValueError, ModuleNotFoundError) as error:
        print(f"error: {_told(error)}", file=sys.stderr)
        return 1
    except MemoryError as error:
        print(f"error: the memory does not suffice: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt as interrupt:
        print(told(interrupt), file=sys.stderr)
        return exit_code(interrupt)


def _told(error: Exception) -> str:
    """Return the message of an error; the system's own begin with a number."""
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return str(error)


def _print_warning(message: Warning | str, *_: object, **__: object) -> None:
    """Print a warning as der_run does: without the line of a program that no user has written."""
    print(f"warning: {message}", file=sys.stderr)


def _discard_output() -> None:
    """Send to nowhere what is still to be printed; Python does that once more when it ends."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())


def _make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="der", description="Simulate slender elastic rods, and look at what came out."
    )
    parser.add_argument("--version", action="version", version=f"der {__version__}")
    parser.set_defaults(execute=None)
    subparsers = parser.add_subparsers(title="commands", metavar="COMMAND")
    for name in sorted(module.name for module in pkgutil.iter_modules(commands.__path__)):
        command = importlib.import_module(f"{commands.__name__}.{name}")
        text = command.__doc__ or ""
        subparser = subparsers.add_parser(name, help=text.partition("\n")[0], description=text)
        command.add_arguments(subparser)
        subparser.set_defaults(execute=command.execute)
    return parser
