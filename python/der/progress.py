"""A progress line for runs that take a while."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

#: Told now and then how much of a run is done, from 0 to 1.
ProgressFunction = Callable[[float], None]


class ProgressLine:
    """Writes one line with percentage and time left, over and over in place.

    It comes only after `delay` seconds, so that short runs stay silent; `close` wipes it out.
    """

    delay = 0.5

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._start = time.monotonic()
        self._width = 0

    def __call__(self, done: float) -> None:
        """Show that the share `done` (0 to 1) of the run is done."""
        elapsed = time.monotonic() - self._start
        if elapsed < self.delay:
            return
        left = f", {_duration(elapsed * (1.0 - done) / done)} left" if done > 0.0 else ""
        self._write(f"{done:4.0%}{left}")

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


def _duration(seconds: float) -> str:
    if seconds < 60.0:
        return f"{seconds:.0f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest} s"
    return f"{minutes // 60} h {minutes % 60} min"
