"""Where the command ``der`` begins: Ctrl-C is answered also while its modules are loaded.

A package of its own, because every module of `der` is loaded after the whole of it.
"""

from __future__ import annotations

import os
import signal
from contextlib import suppress
from types import FrameType

_STDERR = 2


def main() -> int:
    """Load the command and run it; see `der.cli.main`."""
    answers = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if answers:
        signal.signal(signal.SIGINT, _end)
    from der.cli import main as command

    if answers:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    return command()


def _end(_signal: int, _frame: FrameType | None) -> None:
    """End at once: there is nothing to keep, and modules may catch what is raised in them."""
    with suppress(OSError):  # it may be closed
        os.write(_STDERR, b"interrupted\n")
    os._exit(130)
