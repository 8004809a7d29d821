"""Checks of what programs and command lines give: numbers, lists, key paths, names."""

from __future__ import annotations

import itertools
import math
import re
from argparse import ArgumentTypeError
from collections.abc import Iterable, Mapping
from operator import index
from typing import Any, Generic, NoReturn, TypeVar

import numpy as np

#: The largest number of whatever is counted: the engine counts it with 32 bits.
MOST = 2**31 - 1
#: A number as scenes spell it, before it is looked at more closely.
NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_WHOLE = re.compile(r"[+-]?[0-9]+")
_LEADING_ZERO = re.compile(r"[+-]?0[0-9]")
_INFINITE_OR_NAN = re.compile(r"[+-]?\.?(?:inf|infinity|nan)", re.IGNORECASE)

Value = TypeVar("Value")


def whole_number(name: str, value: Any, least: int | None = None, most: int | None = None) -> int:
    """Return a whole number of Python or NumPy as one of Python.

    Parameters
    ----------
    name
        The name of the argument, for messages.
    value
        The value given.
    least, most
        The least and the most that it may be; None: there is none.

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


def read_number(text: str) -> int | float | None:
    """Return the number that a text is in a scene; None for a text that looks like none.

    Python reads more, such as 010 and 1_0, which scenes refuse.

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


def check_value_list(given: object) -> None:
    """See that values have an order, and each of them is there.

    Raises
    ------
    ValueError
        For a set, a dict, bytes, and masked entries of NumPy; the message says what to write.
    """
    if isinstance(given, (set, frozenset)):
        raise ValueError("a set has no order: write a list of values")
    if isinstance(given, Mapping):
        raise ValueError("a dict is one value and no list of them: write [{...}]")
    if isinstance(given, (bytes, bytearray)):
        raise ValueError("bytes are no list of values: write [1, 2]")
    values = [given] if isinstance(given, np.ndarray) else given
    if isinstance(values, (list, tuple)) and any(map(_is_masked, values)):
        raise ValueError("some values are masked, and have none: leave them out, or fill them")


def _is_masked(value: object) -> bool:
    return isinstance(value, np.ma.MaskedArray) and bool(np.ma.is_masked(value))


def check_varied(vary: object) -> None:
    """See that what is to be varied is a dict of key paths and their values.

    Raises
    ------
    TypeError
        If it is anything else.
    """
    if isinstance(vary, Mapping) and all(isinstance(path, str) for path in vary):
        return
    raise TypeError(
        "vary must be a dict of key paths and their values, such as "
        f'{{"rods.arm.nodes": [11, 21]}}, got {vary!r}'
    )


def check_apart(scene: dict[str, Any], paths: Iterable[str]) -> None:
    """See that no two paths set the same value of a scene.

    An item of a list has a number and may have a name; a key may be set by itself, or with what
    holds it. The later of two such paths would win without a word.

    Raises
    ------
    ValueError
        If two do; the message names them.
    """
    places = [(path, _place(scene, path)) for path in paths]
    for (first, a), (second, b) in itertools.combinations(places, 2):
        common = min(len(a), len(b))
        if a[:common] != b[:common]:
            continue
        how = "are the same value" if len(a) == len(b) else "overlap: one holds the other"
        raise ValueError(f"'{first}' and '{second}' {how}: vary one of them")


def _place(scene: dict[str, Any], path: str) -> tuple[str, ...]:
    """Return the keys of a path, items of lists by their numbers."""
    here: Any = scene
    keys: list[str] = []
    for key in path.split("."):
        if isinstance(here, list):
            number = _number(here, key)
            keys.append(str(number) if number is not None else key)
            here = here[number] if number is not None else None
        else:
            keys.append(key)
            here = here.get(key) if isinstance(here, dict) else None
    return tuple(keys)


def _number(items: list[Any], key: str) -> int | None:
    if key.isdecimal():
        return int(key) if int(key) < len(items) else None
    named = (
        i for i, item in enumerate(items) if isinstance(item, dict) and item.get("name") == key
    )
    return next(named, None)


class NamedProbes(dict[str, Value], Generic[Value]):
    """A dict whose KeyError says which probes the scene has."""

    def __missing__(self, name: object) -> NoReturn:
        """Refuse a name that no probe has."""
        known = ", ".join(repr(known) for known in self) or "none, and takes them in output.probes"
        raise KeyError(f"the scene has no probe {name!r}; it has {known}")
