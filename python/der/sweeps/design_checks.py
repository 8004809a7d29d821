"""Mistakes in what a sweep is asked for, found before anything is run."""

from __future__ import annotations

from typing import Any

from der._core import Scenario
from der.arguments import check_apart
from der.errors import SceneError
from der.sweeps.design import Design
from der.sweeps.store import MOST_COLUMNS
from der.sweeps.table import RUN_COLUMNS, TOLD, WHEN, probes_of, units_of_probes
from der.sweeps.values import Range, stored


def check_design(scene: Scenario, design: Design, verify: bool) -> None:
    """Find a mistake in a path, a value, or what the table can hold.

    The first member that is not valid is a `SceneError`, all else a `ValueError`.
    """
    _check_members(scene, design)
    _check_columns(scene, design, verify)
    _check_units(scene, design)


def _check_members(scene: Scenario, design: Design) -> None:
    """Find a mistake in a path or a value before anything is run."""
    check_apart(scene.to_dict(), design.paths)
    first = dict(zip(design.paths, next(iter(design)), strict=True))
    try:
        scene.with_(**first)
    except SceneError:
        _check_whole_numbers(scene, design, first)
        raise
    probes = probes_of(scene)
    fixed = {column.name for column in RUN_COLUMNS} | {"stability"}
    for name in sorted(fixed & set(probes)):
        raise ValueError(
            f"the probe '{name}' has the name of a column that each sweep has: rename the probe"
        )
    spelled: dict[str, str] = {}
    for name in (*design.paths, *probes):
        # SQLite does not tell the names of columns apart by the case of letters.
        other = spelled.setdefault(name.lower(), name)
        if other != name:
            raise ValueError(
                f"'{other}' and '{name}' differ in the case of letters alone, and are columns of "
                "one table: rename one of them"
            )


def _check_columns(scene: Scenario, design: Design, verify: bool) -> None:
    """See that the table has room for all probes."""
    probes = probes_of(scene)
    each = len(TOLD) + len(WHEN) + (len(TOLD) if verify else 0)  # and error bars
    # One more tells the stability, and one how many values are flagged.
    room = MOST_COLUMNS - len(RUN_COLUMNS) - len(design.paths) - 2
    if len(probes) * each > room:
        raise ValueError(
            f"the scene has {len(probes)} probes of {each} columns each, and the table of a sweep "
            f"(SQLite) has room for {max(0, room // each)} of them: name fewer under output.probes"
        )


def _check_units(scene: Scenario, design: Design) -> None:
    """See that each probe has one unit in all members.

    Numbers do not change it: of members that differ in numbers alone one is looked at.
    """
    telling = [
        i
        for i, own in enumerate(design.values)
        if not isinstance(own, Range) and any(isinstance(value, (str, dict)) for value in own)
    ]
    if not telling:
        return
    seen: set[tuple[Any, ...]] = set()
    first: dict[str, str] = {}
    for member in design.members_that_differ_in(telling):
        key = tuple(stored(member[i]) for i in telling)
        if key in seen:
            continue
        seen.add(key)
        try:
            varied = scene.with_(**dict(zip(design.paths, member, strict=True)))
        except SceneError:
            continue  # it will be a row that says so
        units = {probe: unit or "1" for probe, unit in units_of_probes(varied).items()}
        when = "s" if varied.factor_range is None else "points of a path"
        for probe, unit in (units | {f"{probe}.t_min": when for probe in units}).items():
            if (other := first.setdefault(probe, unit)) != unit:
                raise ValueError(
                    f"the probe '{probe}' has values in {other} in some members and in {unit} in "
                    "others, and a column has one unit: give each quantity a probe of its own"
                )


def _check_whole_numbers(scene: Scenario, design: Design, first: dict[str, Any]) -> None:
    """Say where a parameter takes whole numbers and its values are others.

    A range may have more values than whole numbers in it. Its first value is whole then, and the
    scene's message about that one does not help.
    """
    for (path, value), own in zip(first.items(), design.values, strict=True):
        if not isinstance(value, float) or not (value.is_integer() or isinstance(own, Range)):
            continue
        try:
            scene.with_(**first | {path: round(value)})
        except SceneError:
            continue
        if isinstance(own, Range):
            what, remedy = f"a sample of {own.low:g}:{own.high:g} has others", "list whole ones"
        else:
            shown = ", ".join(map(_spelled, own[:4]))
            what = f"its values are {shown}" + (", ..." if len(own) > 4 else "")
            remedy = "take a range with a whole distance between two values, or list whole ones"
        raise ValueError(
            f"{path}: a whole number belongs there, and {what}: {remedy}, as 11:41:4 or 11,21,31,41"
        )


def _spelled(value: Any) -> str:
    """Return a value as short as it is told from a whole number."""
    if not isinstance(value, float):
        return str(value)
    return f"{value:.1f}" if value.is_integer() and abs(value) < 1e6 else f"{value:.6g}"
