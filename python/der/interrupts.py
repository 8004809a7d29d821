"""Ctrl-C and SIGTERM that count once, while something ends that must not be interrupted again."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any


class Terminated(KeyboardInterrupt):
    """SIGTERM: what Ctrl-C ends, it ends in the same way."""


#: What each signal does by itself in Python.
_OWN: dict[signal.Signals, Callable[[int, FrameType | None], Any] | signal.Handlers] = {
    signal.SIGINT: signal.default_int_handler,
    signal.SIGTERM: signal.SIG_DFL,
}


def take_one_interrupt() -> bool:
    """Let Ctrl-C raise `KeyboardInterrupt` once, and do nothing from then on.

    Returns
    -------
    bool
        Whether it was done: other threads than the main one are not interrupted, and a handler of
        the program's own is its affair.
    """
    return _take_one(signal.SIGINT)


def take_one_termination() -> bool:
    """Let SIGTERM raise `Terminated` once, and do nothing from then on.

    It is for the command `der`: other programs end by it, unless they handle it.

    Returns
    -------
    bool
        Whether it was done, as in `take_one_interrupt`.
    """
    return _take_one(signal.SIGTERM)


def take_all_interrupts() -> None:
    """Let Ctrl-C raise `KeyboardInterrupt` whenever it comes, as Python does."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def end_with_signals() -> None:
    """End a program: signals that were taken do again what they do in Python, or nothing.

    Nothing if one has come: when Python ends it gives up its own handlers, and a second Ctrl-C
    would be the exit code.
    """
    for number, own in _OWN.items():
        if signal.getsignal(number) is _ignore:
            signal.signal(number, signal.SIG_IGN)
        elif signal.getsignal(number) is _end_once:
            signal.signal(number, own)


def exit_code(interrupt: KeyboardInterrupt) -> int:
    """Return the exit code of a program that a signal has ended, as der_run has it."""
    return 128 + (signal.SIGTERM if isinstance(interrupt, Terminated) else signal.SIGINT)


def told(interrupt: KeyboardInterrupt) -> str:
    """Return the word for it in messages."""
    return "terminated" if isinstance(interrupt, Terminated) else "interrupted"


def _take_one(number: signal.Signals) -> bool:
    in_main = threading.current_thread() is threading.main_thread()
    if not in_main or signal.getsignal(number) is not _OWN[number]:
        return False
    signal.signal(number, _end_once)
    return True


def _end_once(number: int, _frame: FrameType | None) -> None:
    for taken in _OWN:
        if signal.getsignal(taken) is _end_once:
            signal.signal(taken, _ignore)
    raise Terminated if number == signal.SIGTERM else KeyboardInterrupt


def _ignore(_signal: int, _frame: FrameType | None) -> None:
    pass
