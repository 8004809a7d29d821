"""Where the command ``der`` begins: it answers signals also while its modules are loaded.

A package of its own, because every module of `der` is loaded after the whole of it.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import Any

_STDERR = 2

#: How long Ctrl-C and SIGTERM may take to end it [s].
_PATIENCE = 1.0


def main() -> int:
    """Load the command and run it; see `der.cli.main`."""
    own: dict[signal.Signals, Callable[[int, FrameType | None], Any] | signal.Handlers] = {
        signal.SIGINT: signal.default_int_handler,
        signal.SIGTERM: signal.SIG_DFL,
    }
    answered = [number for number, handler in own.items() if signal.getsignal(number) is handler]
    for number in answered:
        signal.signal(number, _end)
    from der._core import end_if_unanswered
    from der.cli import main as command

    end, told = os.pipe()
    os.set_blocking(told, False)
    signal.set_wakeup_fd(told, warn_on_full_buffer=False)
    end_if_unanswered(end, _PATIENCE)
    for number in answered:
        signal.signal(number, own[number])
    return command()


def _end(number: int, _frame: FrameType | None) -> None:
    """End at once: there is nothing to keep, and modules may catch what is raised in them."""
    with suppress(OSError):  # it may be closed
        os.write(_STDERR, b"terminated\n" if number == signal.SIGTERM else b"interrupted\n")
    os._exit(128 + number)
