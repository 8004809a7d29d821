"""Numbers for people: digits that mean something, powers of ten in print."""

from __future__ import annotations

import math

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Spaces that no line is broken at.
_TIMES_TEN = "\u00a0\u00d7\u00a010"
_PERCENT = "\u00a0%"


def number(value: float, digits: int = 3) -> str:
    """Return a number to some significant digits; very small and large ones with a power of ten."""
    if value == 0.0:
        return "0"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    power = int(exponent)
    if -5 < power < 6:
        return f"{float(f'{mantissa}e{exponent}'):.{max(digits - 1 - power, 0)}f}"
    return f"{mantissa}{_TIMES_TEN}{str(power).translate(_SUPERSCRIPTS)}"


def error_bar_text(error_bar: float) -> str:
    """Return an error bar to its two digits."""
    return f"±\u00a0{number(error_bar, 2)}"


def digits_within(value: float, error_bar: float) -> int:
    """Return how many digits an error bar leaves: down to the second of its own, at most twelve."""
    last = math.floor(math.log10(error_bar)) - 1
    first = math.floor(math.log10(abs(value))) if value else last
    return min(max(first - last + 1, 1), 12)


def percent(share: float, digits: int = 2) -> str:
    """Return a share, such as 0.0066, as a percentage."""
    return f"{number(100.0 * share, digits)}{_PERCENT}"


def duration(seconds: float) -> str:
    """Return a time to two digits, in ms below a second."""
    if seconds < 0.9995:
        return f"{number(1e3 * seconds, 2)} ms"
    return f"{number(seconds, 2)} s"
