"""A case of the audit: a scene, and true values to check the results of ``der verify``."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

Label = tuple[str, str]  # probe and what (final, min, max, fold 1, ...)


class UnsolvedError(RuntimeError):
    """The reference found no solution, so that the case says nothing."""


@dataclasses.dataclass(frozen=True)
class Truth:
    """A true value, the error of the reference, and the size that is natural for the quantity."""

    value: float
    error: float
    scale: float
    quantity: str


@dataclasses.dataclass(frozen=True)
class Case:
    """A scene and the function that solves it; the function may look which branch was taken."""

    kind: str
    scene: dict[str, Any]
    truths: Callable[[dict[str, Any]], Mapping[Label, Truth]]
