"""A progress line for what takes a while, the same as that of ``der run``."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

from der import _core

#: Told now and then how much of a run is done, from 0 to 1.
ProgressFunction = Callable[[float], None]


class ProgressLine:
    """Writes one line with percentage, bar and time left, over and over in place.

    It comes only after `delay` seconds, so that short runs stay silent, and then every `interval`
    seconds at most; `close` wipes it out.
    """

    delay = 0.3
    interval = 0.1

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._start = time.monotonic()
        self._shown = -self.interval  # when the line was last written, in seconds after the start
        self._width = 0

    def __call__(self, done: float) -> None:
        """Show that the share `done` (0 to 1) of the run is done."""
        elapsed = time.monotonic() - self._start
        if elapsed < self.delay or (elapsed < self._shown + self.interval and done < 1.0):
            return
        self._shown = elapsed
        left = elapsed * (1.0 - done) / done if done > 0.0 else None
        # One column is left free: a full line would wrap on some terminals.
        self._write(_core.progress_line(done, left, _columns(self._stream) - 1))

    def close(self) -> None:
        """Wipe the line."""
        if self._width:
            self._write("")
            self._stream.write("\r")
            self._stream.flush()

    def _write(self, text: str) -> None:
        self._stream.write("\r" + text.ljust(self._width))
        self._stream.flush()
        self._width = len(text)


@contextmanager
def progress_on_terminal() -> Iterator[ProgressLine | None]:
    """Give a progress line for the time of a ``with`` block; None where no one is looking."""
    if not sys.stderr.isatty():
        yield None
        return
    line = ProgressLine()
    try:
        yield line
    finally:
        line.close()


def _columns(stream: TextIO) -> int:
    """Return the width of a terminal; 80 for everything else."""
    try:
        columns = os.get_terminal_size(stream.fileno()).columns
    except (OSError, ValueError):  # no terminal, or no file
        columns = 0
    return columns or 80
