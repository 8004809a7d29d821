"""Numbers as scenes spell them: Python reads more, such as 010 and 1_0, which scenes refuse."""

from __future__ import annotations

import math
import re
from argparse import ArgumentTypeError

#: A number as scenes spell it, before it is looked at more closely.
NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_WHOLE = re.compile(r"[+-]?[0-9]+")
_LEADING_ZERO = re.compile(r"[+-]?0[0-9]")
_INFINITE_OR_NAN = re.compile(r"[+-]?\.?(?:inf|infinity|nan)", re.IGNORECASE)


def read_number(text: str) -> int | float | None:
    """Return the number that a text is in a scene; None for a text that looks like none.

    Parameters
    ----------
    text
        Without blanks around it.

    Raises
    ------
    ValueError
        For one that a scene refuses; the message says what to write.
    """
    if _INFINITE_OR_NAN.fullmatch(text):
        raise ValueError(
            f"'{text}': infinities and nan are out of range; a word stands in double quotes"
        )
    if not NUMBER.fullmatch(text):
        _refuse_what_python_reads(text)
        return None
    if _LEADING_ZERO.match(text):
        raise ValueError(f"'{text}': {_leading_zero_problem(text)}")
    if _WHOLE.fullmatch(text):
        return int(text)
    number = float(text)
    vanished = number == 0.0 and re.search("[1-9]", re.split("[eE]", text)[0])
    if math.isinf(number) or vanished:
        raise ValueError(
            f"'{text}': it is out of the range of double-precision numbers (1e-308 to 1.8e308)"
        )
    return number


def whole_number_argument(text: str) -> int:
    """Return a whole number of a command line: the `type` of an argument of `argparse`.

    Raises
    ------
    argparse.ArgumentTypeError
        If it is none; it says what to write.
    """
    try:
        number = read_number(text.strip())
    except ValueError as error:
        raise ArgumentTypeError(str(error)) from None
    if not isinstance(number, int):
        raise ArgumentTypeError(f"'{text}' is no whole number")
    return number


def _refuse_what_python_reads(text: str) -> None:
    """Refuse separators, and digits of other scripts than the Latin one."""
    for read in (int, float):
        try:
            number = read(text)
        except ValueError:
            continue
        raise ValueError(f"'{text}': numbers have the digits 0 to 9 and no separators: {number}")


def _leading_zero_problem(text: str) -> str:
    sign, digits = ("-" if text[0] == "-" else ""), text.lstrip("+-")
    without = re.sub("^0+(?=[0-9])", "", digits)
    if re.fullmatch("[0-7]+", digits):
        return (
            f"a leading zero is ambiguous (octal): write {sign}{without} or {sign}{int(digits, 8)}"
        )
    return f"numbers have no leading zero: write {sign}{without}"
