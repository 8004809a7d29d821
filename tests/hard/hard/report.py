"""The rows of the suite as tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby

from .case import SOLVED, Row


def plain(rows: Sequence[Row]) -> str:
    """One line for each case, and the count of outcomes."""
    lines = [
        f"{case.topic}: {case.measure.__name__}: {_outcome(list(some))}"
        for case, some in groupby(rows, lambda row: row.case)
    ]
    return "\n".join([*lines, "", counts(rows)])


def counts(rows: Sequence[Row]) -> str:
    """How many rows ended how, in a sentence."""
    right = sum(row.outcome == SOLVED for row in rows)
    refused = sum(row.outcome == row.expected != SOLVED for row in rows)
    limits = sum(row.outcome != row.expected and not row.complaint for row in rows)
    surprises = sum(bool(row.complaint) for row in rows)
    return (
        f"{len(rows)} rows: {right} solved within the error expected, {refused} refused by name "
        f"where that is right, {limits} under known limits, {surprises} not as expected."
    )


def markdown(rows: Sequence[Row]) -> str:
    """The table of all cases, then the known limits."""
    lines = ["| tried | in | oracle | outcome |", "|---|---|---|---|"]
    for topic, of_topic in groupby(rows, lambda row: row.case.topic):
        lines.append(f"| **{topic}** | | | |")
        for case, some in groupby(of_topic, lambda row: row.case):
            tried = list(some)
            lines.append(
                f"| {case.tried} | {_settings(tried)} | {case.oracle} | {_outcome(tried)} |"
            )
    lines += ["", counts(rows)]
    limits = [row for row in rows if row.limit is not None and row.outcome != row.expected]
    if limits:
        lines += ["", "Known limits:", ""]
    for limit, some in groupby(limits, lambda row: row.limit):
        under = list(some)
        assert limit is not None
        ends = ", ".join(f"`{name}`" for name in dict.fromkeys(row.outcome for row in under))
        lines.append(f"- {under[0].case.topic} ({_settings(under)}; {ends}): {limit.why}")
    return "\n".join(lines)


def _settings(rows: Iterable[Row]) -> str:
    """Values, models and steppers of some rows, each once."""
    tried = [row.setting for row in rows]
    parts = [
        _once(setting.label for setting in tried),
        _once(f"`{setting.model}`" for setting in tried),
        _once(f"`{setting.stepper.name}`" for setting in tried if setting.stepper),
    ]
    return "; ".join(_listed(part) for part in parts if part)


def _once(names: Iterable[str]) -> list[str]:
    return [name for name in dict.fromkeys(names) if name]


def _listed(names: list[str]) -> str:
    if len(names) > 8 and all(name.startswith("`") for name in names):
        return f"{len(names)} steppers"
    return ", ".join(names)


def _outcome(rows: list[Row]) -> str:
    """Outcomes with their counts, and how near the worst error came to what is expected."""
    parts = []
    for outcome in dict.fromkeys(row.outcome for row in rows):
        some = [row for row in rows if row.outcome == outcome]
        text = f"{len(some)} {outcome}" if outcome == SOLVED else f"{len(some)} `{outcome}`"
        readings = [row.reading for row in some if row.reading is not None]
        if outcome == SOLVED:
            near = max(readings, key=lambda reading: reading.share)
            text += f" (largest error {near.error:.1e}, expected below {near.allowed:.1e})"
        if outcome != some[0].expected:
            text += ", a known limit" if not some[0].complaint else ", **not as expected**"
        parts.append(text)
    return "; ".join(parts)
