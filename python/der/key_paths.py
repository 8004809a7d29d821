"""Key paths into a scene, as `Scenario.with_` takes them: what they name."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from typing import Any


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
