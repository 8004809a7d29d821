"""A verification as text."""

from __future__ import annotations

import math
from collections.abc import Sequence

from der.accuracy.error_bars import ErrorEstimate
from der.accuracy.verification import Verification, VerifiedValue


def verification_table(verification: Verification) -> str:
    """Return the table: one line for each value, then what was run, notes and a summary.

    Extremes that tell nothing new, at the start of the run or equal to the final value, are left
    out unless they are flagged.
    """
    duration = 0.0 if verification.scenario.is_static else verification.scenario.duration
    shown = [value for value in verification.values if _tells(verification, value, duration)]
    header = ("probe", "value", "error", "space", "time", "extrapolated", "orders", "verdict")
    rows = [header, *(_row(value) for value in shown)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(header))]
    lines = [verification.scenario.title, ""]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        lines.append("  ".join(cells).rstrip())
    lines += ["", *_what_was_run(verification)]
    lines += [f"Note: {note.rstrip('.')}." for note in verification.notes]
    lines.append(_summary(verification, shown))
    return "\n".join(lines)


def _tells(verification: Verification, value: VerifiedValue, duration: float) -> bool:
    if value.what not in ("min", "max") or value.flagged:
        return True
    same_as_final = abs(value.value - verification[value.probe].value) <= value.solver
    return 0.0 < value.time_of_value < duration and not same_as_final


def _row(value: VerifiedValue) -> tuple[str, ...]:
    return (
        value.label,
        _number(value.value, value),
        f"± {_bar(value.bar)}",
        _bar(None if value.space is None else value.space.bar),
        _bar(None if value.time is None else value.time.bar),
        _number(value.extrapolated, value),
        f"{_order(value.space)}, {_order(value.time)}",
        value.verdict,
    )


def _number(number: float, value: VerifiedValue) -> str:
    if math.isnan(number):
        return "-"
    return f"{with_digits_of(number, value.bar)} {value.unit}".rstrip()


def with_digits_of(value: float, bar: float) -> str:
    """Return a value with the digits that its error bar leaves, at two digits of the bar."""
    if not math.isfinite(bar) or bar <= 0.0:
        return f"{value:.6g}"
    least = math.floor(math.log10(bar)) - 1
    leading = math.floor(math.log10(abs(value))) if value else least
    digits = min(max(leading - least + 1, 1), 12)
    return f"{value:#.{digits}g}".replace(".e", "e").rstrip(".")


def _bar(bar: float | None) -> str:
    if bar is None:
        return "-"
    return f"{bar:.2g}" if math.isfinite(bar) else "unknown"


def _order(part: ErrorEstimate | None) -> str:
    if part is None or part.order is None:
        return "-"
    return f"{part.order:.1f}"


def _what_was_run(verification: Verification) -> list[str]:
    lines = []
    if len(verification.meshes) > 1:
        lines.append(f"Space: {', '.join(verification.meshes)}.")
    if len(verification.steps) > 1:
        lines.append(f"Time: {', '.join(verification.steps)}.")
    return lines


def _summary(verification: Verification, shown: Sequence[VerifiedValue]) -> str:
    """Return what holds for the rows of the table; every flagged value has one."""
    total = len(shown)
    flagged = [value for value in shown if value.flagged]
    settled = [value for value in shown if value.settled and not value.flagged]
    unmeasured = {value.label for value in verification.order_not_measured}
    unmeasured &= {value.label for value in shown}
    found = []
    if flagged:
        found.append(f"{len(flagged)} of {total} values do not converge at the expected order")
    elif not settled and not unmeasured:
        found.append(f"All {total} values converge at the expected order")
    if settled:
        found.append(f"{_share(len(settled), total)} values settle at no clear order")
    if unmeasured:
        share = _share(len(unmeasured), total).lower()
        found.append(f"The order of {share} values was not measured")
    hidden = len(verification.values) - total
    left_out = f"extremes at the start or the end, not shown: {hidden}; " if hidden else ""
    return f"{'. '.join(found)} ({left_out}{verification.cpu_seconds:.2g} s of CPU time)."


def _share(part: int, total: int) -> str:
    return f"{part} of {total}" if part < total else f"All {total}"
