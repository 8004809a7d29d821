"""A reference number: value, error bar, unit, and how it was made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Reference:
    """One reference number, or one list of them.

    `error` bounds the error of every entry of `value`, in `unit`, and is never zero: exact
    formulas carry their rounding. `quoted` is a number stated elsewhere (a specification or
    a paper) with `quoted_error`, half a unit of its last printed digit or its stated error.
    """

    value: float | list[float]
    error: float
    unit: str
    quoted: float | None = None
    quoted_error: float = 0.0


@dataclass(frozen=True)
class Problem:
    """All reference numbers of one problem and how they were made."""

    name: str
    about: str
    method: str
    values: dict[str, Reference] = field(default_factory=dict)


def rounded(value: float) -> float:
    """Error bar of a value that is exact but for rounding: 4 units in the last place."""
    return 4.0 * float(np.spacing(abs(value)))


def exact(value: float, unit: str) -> Reference:
    """A closed-form value in double precision."""
    return Reference(value, rounded(value), unit)


def refined(
    fine: float, coarse: float, unit: str, floor: float = 1e-14, safety: float = 2.0
) -> Reference:
    """A value computed twice: the difference of the two runs bounds the error of `fine`.

    `floor` is the least relative error claimed, for accumulated rounding.
    """
    return Reference(fine, max(safety * abs(fine - coarse), floor * abs(fine), 1e-300), unit)


def refined_series(
    fine: Sequence[float] | Array,
    coarse: Sequence[float] | Array,
    unit: str,
    floor: float = 1e-14,
    safety: float = 2.0,
) -> Reference:
    """As `refined`, for a list with one error bar."""
    a = np.asarray(fine, dtype=float)
    b = np.asarray(coarse, dtype=float)
    error = max(safety * float(np.abs(a - b).max()), floor * float(np.abs(a).max()), 1e-300)
    return Reference([float(v) for v in a], error, unit)
