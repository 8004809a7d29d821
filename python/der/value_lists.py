"""Lists of values that a program gives: what is none, though Python goes through it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np


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
