"""Checks of what a study is asked for, before any work is done."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Integral, Real
from typing import Any


def check_arguments(
    nodes: Sequence[int] | None,
    steps: Sequence[float] | None,
    steppers: Sequence[str] | None,
    max_seconds: float,
) -> None:
    """Check the arguments of `der.study` as far as that is possible without the scene.

    Raises
    ------
    ValueError
        For an empty list, or a value that is none for any scene.
    """
    if nodes is not None:
        for count in _checked_list("nodes", nodes, "[21, 41]"):
            if isinstance(count, bool) or not isinstance(count, Integral):
                raise ValueError(f"nodes must be whole numbers, such as 21, got {count!r}")
    if steps is not None:
        _check_positive("steps", steps, "seconds, such as [0.01, 0.005]")
    if steppers is not None:
        _checked_list("steppers", steppers, "['tr_bdf2']")
    if not _is_number(max_seconds) or not max_seconds > 0.0:
        raise ValueError(
            f"max_seconds must be a number greater than 0, such as 2, got {max_seconds!r}"
        )


def check_errors(errors: Sequence[float]) -> None:
    """Check the errors that advice is wanted for.

    Raises
    ------
    ValueError
        If there are none, or one that is not greater than 0 and finite.
    """
    _check_positive("errors", errors, "units of the probes, such as [0.001, 0.0001]")


def _check_positive(name: str, values: Sequence[float], what: str) -> None:
    for value in _checked_list(name, values, what.partition("such as ")[2]):
        if not _is_number(value) or not 0.0 < value < math.inf:
            raise ValueError(
                f"{name} must be finite numbers greater than 0 in {what}, got {value!r}"
            )


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _checked_list(name: str, values: Any, example: str) -> list[Any]:
    try:
        found = [] if isinstance(values, str) else list(values)
    except TypeError:
        found = []
    if not found:
        raise ValueError(
            f"{name} must be a list with at least one entry, such as {example}, got {values!r}; "
            "leave it out for the default"
        )
    return found
