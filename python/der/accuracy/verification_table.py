"""Values with error bars as text."""

from __future__ import annotations

import math
from collections.abc import Sequence

from der.accuracy.error_bars import ErrorEstimate
from der.accuracy.verified_value import VerifiedValue
from der.tables import text_table


def values_to_show(values: Sequence[VerifiedValue], duration: float) -> list[VerifiedValue]:
    """Return the values that tell something new about a run of this duration [s].

    Extremes at its start or its end, and those equal to the final value, are left out unless they
    are flagged.
    """
    final = {value.probe: value.value for value in values if value.what == "final"}

    def tells(value: VerifiedValue) -> bool:
        if value.what not in ("min", "max") or value.flagged:
            return True
        same_as_final = abs(value.value - final[value.probe]) <= value.solver
        return 0.0 < value.time_of_value < duration and not same_as_final

    return [value for value in values if tells(value)]


def value_table(values: Sequence[VerifiedValue]) -> list[str]:
    """Return the lines of the table: a header, and one line for each value."""
    header = ("probe", "value", "error", "space", "time", "drawing", "extrapolated", "orders")
    rows = [(*header, "verdict"), *(_row(value) for value in values)]
    if all(value.drawing is None for value in values):
        left_out = header.index("drawing")
        rows = [row[:left_out] + row[left_out + 1 :] for row in rows]
    return text_table(rows)


def summary_line(
    shown: Sequence[VerifiedValue],
    order_not_measured: Sequence[VerifiedValue],
    hidden: int,
    cpu_seconds: float,
) -> str:
    """Return in words what holds for the values shown.

    Parameters
    ----------
    shown
        The rows of the table; every flagged value has one.
    order_not_measured
        `Verification.order_not_measured`, shown or not.
    hidden
        How many values are not shown.
    cpu_seconds
        CPU time of all runs [s].
    """
    total = len(shown)
    flagged = [value for value in shown if value.flagged]
    settled = [value for value in shown if value.settled and not value.flagged]
    unmeasured = {value.label for value in order_not_measured}
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
    left_out = f"extremes at the start or the end, not shown: {hidden}; " if hidden else ""
    return f"{'. '.join(found)} ({left_out}{cpu_seconds:.2g} s of CPU time)."


def _row(value: VerifiedValue) -> tuple[str, ...]:
    return (
        value.label,
        _number(value.value, value),
        f"± {_error_bar_text(value.error_bar)}",
        *(_part_text(part) for part in (value.space, value.time, value.drawing)),
        _number(value.extrapolated, value),
        f"{_order(value.space)}, {_order(value.time)}",
        value.verdict,
    )


def _number(number: float, value: VerifiedValue) -> str:
    if math.isnan(number):
        return "-"
    return f"{with_digits_of(number, value.error_bar)} {value.unit}".rstrip()


def with_digits_of(value: float, error_bar: float) -> str:
    """Return a value with the digits that its error bar leaves, at two digits of the bar."""
    if not math.isfinite(error_bar) or error_bar <= 0.0:
        return f"{value:.6g}"
    least = math.floor(math.log10(error_bar)) - 1
    leading = math.floor(math.log10(abs(value))) if value else least
    digits = min(max(leading - least + 1, 1), 12)
    return f"{value:#.{digits}g}".replace(".e", "e").rstrip(".")


def _part_text(part: ErrorEstimate | None) -> str:
    return "-" if part is None else _error_bar_text(part.error_bar)


def _error_bar_text(error_bar: float) -> str:
    return f"{error_bar:.2g}" if math.isfinite(error_bar) else "unknown"


def _order(part: ErrorEstimate | None) -> str:
    if part is None or part.order is None:
        return "-"
    return f"{part.order:.1f}"


def _share(part: int, total: int) -> str:
    return f"{part} of {total}" if part < total else f"All {total}"
