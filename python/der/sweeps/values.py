"""How the values of a parameter are spelled: lists, ranges, and ranges to sample from."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from der._core import number_with_unit
from der.arguments import NUMBER, check_value_list, read_number

#: Values of a range and points of a sample, at most: all of them are held in memory.
MOST_VALUES = 10_000_000
_LOG = "log"
_SPELLING = (
    "write values as 1,2,5, a range with its number of values as 0:1:11 (or 1e6:1e9:7:log), or a "
    "range to sample from as 0:1 (or 1e6:1e9:log)"
)


class WithUnit(str):
    """A number with its unit, as ``5 mm``: a text for the scene, which knows what unit a key has.

    Tables hold the number in SI units.

    Attributes
    ----------
    number
        In SI units.
    """

    number: float

    def __new__(cls, text: str) -> WithUnit:
        """Make it from a text that `number_with_unit` reads."""
        number = number_with_unit(text)
        assert number is not None
        made = super().__new__(cls, text)
        made.number = number
        return made


@dataclass(frozen=True)
class Range:
    """A range to sample from, both ends included.

    Attributes
    ----------
    low, high
        Its ends.
    log
        Whether equal shares of it are equal ratios.
    unit
        The unit of both ends; empty for the unit of the key.

    Raises
    ------
    ValueError
        If no number tells how far apart its ends are.
    """

    low: float
    high: float
    log: bool = False
    unit: str = ""

    def __post_init__(self) -> None:
        """See that `at` has numbers to compute with."""
        if not math.isfinite(self.high / self.low if self.log else self.high - self.low):
            what = "ratio" if self.log else "difference"
            raise ValueError(
                f"the {what} of the ends of a range, {self.low:g} and {self.high:g}, is beyond the "
                "largest number: take ends that are nearer"
            )

    def at(self, share: float) -> float | WithUnit:
        """Return the value at a share of the range, from 0 to 1."""
        if self.log:
            value = float(self.low * (self.high / self.low) ** share)
        else:
            value = float(self.low + (self.high - self.low) * share)
        return WithUnit(f"{value!r} {self.unit}") if self.unit else value

    def __str__(self) -> str:
        """Return it as the command line spells it."""
        behind = f" {self.unit}" if self.unit else ""
        return f"{self.low:g}{behind}:{self.high:g}{behind}"


#: What a parameter goes through: values, or a range to sample from.
Values = tuple[Any, ...] | Range


def parse_values(text: str) -> Values:
    """Read the values of a parameter as the command line spells them.

    ``1,2,5``: these values. ``0:1:11``: 11 values from 0 to 1, both ends included; with ``:log`` at
    the end, in equal ratios. ``0:1``, or ``1e6:1e9:log``: a range to sample from. A value may be a
    number, one with a unit (``5 mm``, ``1 mm:5 mm:5``), a word, a text in double quotes, true,
    false, null, or a list in brackets.
    """
    if ":" in text and not any(mark in text for mark in '["{,'):
        return _parse_range(text)
    values = tuple(_parse_value(part) for part in _split(text))
    _check_numbers(values)
    return values


def as_values(given: str | Iterable[Any]) -> Values:
    """Return the values of a parameter that a program gives: any sequence, or a text.

    NumPy numbers and arrays become numbers and lists of Python.
    """
    if isinstance(given, Range):
        return given
    if isinstance(given, str):
        return parse_values(given)
    if isinstance(given, np.ndarray) and given.ndim == 0:
        given = given.item()  # Python takes it for iterable, and cannot go through it
    if not isinstance(given, Iterable):
        raise ValueError(f"expected a sequence of values, got {given!r}: write [{given!r}]")
    check_value_list(given)
    values = tuple(_with_unit(_plain(value)) for value in given)
    if not values:
        raise ValueError("there is no value")
    for value in values:
        try:
            stored(value)
        except TypeError:
            raise ValueError(
                f"{value!r} is no value of a scene: use numbers, texts, lists and dicts"
            ) from None
    _check_numbers(values)
    return values


def stored(value: Any) -> Any:
    """Return a value as a table holds it: numbers in SI units and texts, the rest as JSON.

    So are whole numbers of more than 64 bits, which SQLite lacks.
    """
    if isinstance(value, WithUnit):
        return value.number
    if isinstance(value, int) and not isinstance(value, bool):
        return value if -(2**63) <= value < 2**63 else json.dumps(value)
    return value if isinstance(value, (float, str)) else json.dumps(value)


def _check_numbers(values: Iterable[Any]) -> None:
    """Refuse numbers that no scene has, and JSON neither."""
    for value in values:
        for number in _floats_in(value):
            if not math.isfinite(number):
                what = "a value is" if value is number else f"the value {value} has"
                raise ValueError(f"{what} {number}, which is no number of a scene")


def _floats_in(value: Any) -> Iterable[float]:
    if isinstance(value, float):
        return (value,)
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, (list, tuple)):
        return itertools.chain.from_iterable(map(_floats_in, value))
    return ()


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def _with_unit(value: Any) -> Any:
    """Return a text that is a number with a unit as such; everything else as it is."""
    if isinstance(value, str) and number_with_unit(value) is not None:
        return WithUnit(value)
    return value


def _split_unit(text: str) -> tuple[str, str]:
    """Return the number and the unit of a text; it as it is, and no unit, where it has none."""
    if number_with_unit(text) is None:
        return text, ""
    number = NUMBER.match(text)
    assert number is not None
    return number[0], text[number.end() :].strip()


def _parse_range(text: str) -> Values:
    fields = [field.strip() for field in text.split(":")]
    parted = [_split_unit(field) for field in fields[:2]]
    fields[:2] = [number for number, _ in parted]
    unit = parted[0][1]
    if any(other != unit for _, other in parted):
        raise ValueError(f"'{text}': both ends of a range have the same unit")
    log = fields[-1] == _LOG
    numbers = [number for field in fields if (number := read_number(field)) is not None]
    has_ends = len(numbers) == 2 or (len(numbers) == 3 and isinstance(numbers[2], int))
    if not has_ends or len(numbers) + log < len(fields):
        raise ValueError(f"'{text}' is no range: {_SPELLING}")
    low, high = map(float, numbers[:2])
    if log and not (low > 0.0 and high > 0.0):
        raise ValueError(f"'{text}': both ends of a range in equal ratios are greater than 0")
    if len(numbers) == 2:
        return Range(low, high, log, unit)
    count = int(numbers[2])
    if not 2 <= count <= MOST_VALUES:
        raise ValueError(f"'{text}': a range has at least 2 values and at most {MOST_VALUES}")
    if log:
        spaced = np.geomspace(low, high, count).tolist()
    else:
        ends = Range(low, high)
        spaced = np.linspace(ends.low, ends.high, count).tolist()
    between_whole = isinstance(numbers[0], int) and isinstance(numbers[1], int)
    # A number of nodes is to be a whole number.
    values = _whole_where_all_are(spaced) if between_whole else spaced
    return tuple(WithUnit(f"{value!r} {unit}") for value in values) if unit else tuple(values)


def _whole_where_all_are(values: list[float]) -> list[float] | list[int]:
    """Return whole numbers if all are up to rounding: 4:16:3:log is 4, 8.000000000000002, 16."""
    if all(abs(value - round(value)) <= min(1e-3, 1e-13 * abs(value)) for value in values):
        return list(map(round, values))
    return values


def _split(text: str) -> list[str]:
    """Split at the commas that are outside of brackets and quotes."""
    parts, depth, quoted = [""], 0, False
    for letter in text:
        quoted ^= letter == '"'
        depth += 0 if quoted else (letter in "[{") - (letter in "]}")
        if letter == "," and depth == 0 and not quoted:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def _parse_value(text: str) -> Any:
    text = text.strip()
    if not text:
        raise ValueError(f"a value is empty: {_SPELLING}")
    if (number := read_number(text)) is not None:
        return number
    if number_with_unit(text) is not None:
        return WithUnit(text)
    if text[0] not in '["{' and text not in ("true", "false", "null"):
        return text
    try:
        return json.loads(text)
    except ValueError as error:
        raise ValueError(f"'{text}' is no value ({error}): {_SPELLING}") from None
