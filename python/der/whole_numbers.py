"""Whole numbers that programs give, such as numbers of members and of steps."""

from __future__ import annotations

from operator import index
from typing import Any

#: The largest number of whatever is counted: the engine counts it with 32 bits.
MOST = 2**31 - 1


def whole_number(name: str, value: Any, least: int | None = None, most: int | None = None) -> int:
    """Return a whole number of Python or NumPy as one of Python.

    Parameters
    ----------
    name
        The name of the argument, for messages.
    value
        The value given.
    least
        The least that it may be; None: there is none.
    most
        The most that it may be; None: there is none.

    Raises
    ------
    TypeError
        If it is not a whole number; True and False do not count as such.
    ValueError
        If it is less than `least` or more than `most`.
    """
    wanted = "a whole number" if least is None else f"a whole number of at least {least}"
    try:
        if isinstance(value, bool):
            raise TypeError
        number = index(value)
    except TypeError:
        raise TypeError(f"{name} must be {wanted}, got {value!r}") from None
    if least is not None and number < least:
        raise ValueError(f"{name} must be {wanted}, got {number}")
    if most is not None and number > most:
        raise ValueError(f"{name} must be {wanted} and at most {most}")
    return number
