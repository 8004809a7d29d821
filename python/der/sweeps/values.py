"""How the values of a parameter are spelled: lists, ranges, and ranges to sample from."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

#: Values of a range and points of a sample, at most: all of them are held in memory.
MOST_VALUES = 10_000_000
_LOG = "log"
_SPELLING = (
    "write values as 1,2,5, a range with its number of values as 0:1:11 (or 1e6:1e9:7:log), or a "
    "range to sample from as 0:1 (or 1e6:1e9:log)"
)


@dataclass(frozen=True)
class Range:
    """A range to sample from, both ends included.

    Attributes
    ----------
    low, high
        Its ends.
    log
        Whether equal shares of it are equal ratios.
    """

    low: float
    high: float
    log: bool = False

    def at(self, share: float) -> float:
        """Return the value at a share of the range, from 0 to 1."""
        if self.log:
            return float(self.low * (self.high / self.low) ** share)
        return float(self.low + (self.high - self.low) * share)


#: What a parameter goes through: values, or a range to sample from.
Values = tuple[Any, ...] | Range


def parse_values(text: str) -> Values:
    """Read the values of a parameter as the command line spells them.

    Parameters
    ----------
    text
        ``1,2,5``: these values. ``0:1:11``: 11 values from 0 to 1, both ends included; with
        ``:log`` at the end, in equal ratios. ``0:1``, or ``1e6:1e9:log``: a range to sample from.
        A value may be a number, a word, a text in double quotes, true, false, null, or a list
        in brackets.

    Raises
    ------
    ValueError
        If it is none of these; the message says what to write.
    """
    if ":" in text and not any(mark in text for mark in '["{,'):
        return _parse_range(text)
    values = tuple(_parse_value(part) for part in _split(text))
    _check_numbers(values)
    return values


def as_values(given: str | Iterable[Any]) -> Values:
    """Return the values of a parameter that a program gives: any sequence, or a text.

    NumPy numbers and arrays become numbers and lists of Python.

    Raises
    ------
    ValueError
        If there is no value, or a text is not spelled as `parse_values` reads it.
    """
    if isinstance(given, Range):
        return given
    if isinstance(given, str):
        return parse_values(given)
    if not isinstance(given, Iterable):
        raise ValueError(f"expected a sequence of values, got {given!r}: write [{given!r}]")
    values = tuple(_plain(value) for value in given)
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
    """Return a value as a table holds it: numbers and texts as they are, the rest as JSON.

    So are whole numbers of more than 64 bits, which SQLite lacks.
    """
    if isinstance(value, int) and not isinstance(value, bool):
        return value if -(2**63) <= value < 2**63 else json.dumps(value)
    return value if isinstance(value, (float, str)) else json.dumps(value)


def _check_numbers(values: Iterable[Any]) -> None:
    if any(isinstance(value, float) and math.isnan(value) for value in values):
        raise ValueError("a value is nan, which is no number")


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def _parse_range(text: str) -> Values:
    fields = text.split(":")
    log = fields[-1].strip() == _LOG
    numbers = fields[:-1] if log else fields
    try:
        low, high = (float(field) for field in numbers[:2])
        count = int(numbers[2]) if len(numbers) == 3 else 0
    except (ValueError, IndexError):
        raise ValueError(f"'{text}' is no range: {_SPELLING}") from None
    if len(numbers) > 3 or not np.isfinite([low, high]).all():
        raise ValueError(f"'{text}' is no range: {_SPELLING}")
    if log and not (low > 0.0 and high > 0.0):
        raise ValueError(f"'{text}': both ends of a range in equal ratios are greater than 0")
    if len(numbers) == 2:
        return Range(low, high, log)
    if not 2 <= count <= MOST_VALUES:
        raise ValueError(f"'{text}': a range has at least 2 values and at most {MOST_VALUES}")
    spaced = (np.geomspace if log else np.linspace)(low, high, count).tolist()
    whole = all(_is_whole(field) for field in numbers) and all(v.is_integer() for v in spaced)
    # A number of nodes is to be a whole number.
    return tuple(int(value) for value in spaced) if whole else tuple(spaced)


def _is_whole(text: str) -> bool:
    return isinstance(_parse_value(text), int)


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
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            pass
    if text[0] not in '["{' and text not in ("true", "false", "null"):
        return text
    try:
        return json.loads(text)
    except ValueError as error:
        raise ValueError(f"'{text}' is no value ({error}): {_SPELLING}") from None
