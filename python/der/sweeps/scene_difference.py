"""Where two scenes differ."""

from __future__ import annotations

from typing import Any

from der._core import Scenario


def first_difference(one: str, other: str) -> str:
    """Return the key path of the first difference of two scenes given as text."""
    return _first(Scenario.parse(one).to_dict(), Scenario.parse(other).to_dict(), "") or "the text"


def _first(one: Any, other: Any, path: str) -> str | None:
    pairs: list[tuple[str, Any, Any]]
    if isinstance(one, dict) and isinstance(other, dict):
        pairs = [(key, one.get(key), other.get(key)) for key in (*one, *other)]
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = [(str(i), *both) for i, both in enumerate(zip(one, other, strict=True))]
    else:
        return path if one != other else None
    found = (_first(a, b, f"{path}.{key}".lstrip(".")) for key, a, b in pairs)
    return next((path for path in found if path is not None), None)
