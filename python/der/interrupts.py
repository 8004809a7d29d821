"""Ctrl-C that counts once, while something ends that must not be interrupted again."""

from __future__ import annotations

import signal
import threading
from types import FrameType


def take_one_interrupt() -> bool:
    """Let Ctrl-C raise `KeyboardInterrupt` once, and do nothing from then on.

    Returns
    -------
    bool
        Whether it was done: other threads than the main one are not interrupted, and a handler of
        the program's own is its affair.
    """
    in_main = threading.current_thread() is threading.main_thread()
    if not in_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return False
    signal.signal(signal.SIGINT, _interrupt_once)
    return True


def take_all_interrupts() -> None:
    """Let Ctrl-C raise `KeyboardInterrupt` whenever it comes, as Python does."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def end_with_interrupts() -> None:
    """End a program: take all interrupts again, or none any more if the one has come.

    When Python ends it gives up its own handlers, and a second Ctrl-C would be the exit code.
    """
    if signal.getsignal(signal.SIGINT) is _ignore:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    else:
        take_all_interrupts()


def _interrupt_once(_signal: int, _frame: FrameType | None) -> None:
    signal.signal(signal.SIGINT, _ignore)
    raise KeyboardInterrupt


def _ignore(_signal: int, _frame: FrameType | None) -> None:
    pass
