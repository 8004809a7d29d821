"""How far a scene's numbers can be trusted: each probe with an error bar."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from der._core import Scenario
from der.accuracy.error_bars import ErrorEstimate
from der.accuracy.verified_value import VerifiedValue
from der.html import card
from der.tables import Rows, text_table


@dataclass(frozen=True)
class Verification:
    """The result of `der.verify` for a scene.

    Attributes
    ----------
    scenario
        The scene that was verified; with default probes if it had none.
    values
        Every probe's final value, and in a run over time its extremes; of a path of equilibria, the
        factor and every probe at each event.
    meshes
        The meshes that were run, coarsest first, such as ``51 nodes``; one entry if not refined.
    steps
        The steps that were run, such as ``0.01 s``; empty for a static scene.
    warnings
        Those of the run of the scene as it is written, in ``summary.json``.
    notes
        Notes for the reader, such as what could not be refined and which run failed.
    cpu_seconds
        CPU time of all runs [s].
    """

    scenario: Scenario
    values: tuple[VerifiedValue, ...]
    meshes: tuple[str, ...]
    steps: tuple[str, ...]
    warnings: tuple[str, ...]
    notes: tuple[str, ...]
    cpu_seconds: float

    @property
    def flagged(self) -> list[VerifiedValue]:
        """The values that do not converge at the expected order."""
        return [value for value in self.values if value.flagged]

    @property
    def order_not_measured(self) -> list[VerifiedValue]:
        """The values of which nothing tells whether they converge at the expected order.

        Those with two levels only; all, where neither mesh nor step could be refined.
        """
        if len(self.meshes) < 2 and len(self.steps) < 2:
            return list(self.values)
        return [value for value in self.values if value.has_two_levels]

    def __getitem__(self, name: str | tuple[str, str]) -> VerifiedValue:
        """Return a value by probe, or by probe and `VerifiedValue.what` (if not ``final``)."""
        wanted = (name, "final") if isinstance(name, str) else name
        for value in self.values:
            if (value.probe, value.what) == wanted:
                return value
        known = ", ".join(repr((value.probe, value.what)) for value in self.values)
        raise KeyError(f"there is no value {wanted!r}; there are: {known}")

    def to_dict(self) -> dict[str, Any]:
        """Return everything as JSON knows it."""
        return {
            "title": self.scenario.title,
            "scene": self.scenario.source,
            "converged": not self.flagged and not self.order_not_measured,
            "flagged": len(self.flagged),
            "order_not_measured": len(self.order_not_measured),
            "meshes": list(self.meshes),
            "steps": list(self.steps),
            "values": [value.to_dict() for value in self.values],
            "warnings": list(self.warnings),
            "notes": list(self.notes),
            "cpu_seconds": self.cpu_seconds,
        }

    def __str__(self) -> str:
        """Return the table that ``der verify`` prints, what was run, notes and a summary."""
        shown = self._shown()
        lines = [self.scenario.title, "", *text_table(_table(shown)), ""]
        if len(self.meshes) > 1:
            lines.append(f"Space: {', '.join(self.meshes)}.")
        if len(self.steps) > 1:
            lines.append(f"Time: {', '.join(self.steps)}.")
        # The scene's own are Python's warnings as soon as it is read.
        of_run = [text for text in self.warnings if text not in self.scenario.warnings]
        lines += [f"Warning: {warning.rstrip('.')}." for warning in of_run]
        lines += [f"Note: {note.rstrip('.')}." for note in self.notes]
        lines.append(self._summary_line(shown))
        return "\n".join(lines)

    def __repr__(self) -> str:
        """Return the title and what was found in one line."""
        return f"<der.Verification of {self.scenario.title!r}: {self._facts()}>"

    def _repr_html_(self) -> str:
        return card(self.scenario.title, self._facts(), tables=[_table(self._shown())])

    def _facts(self) -> str:
        return self._summary_line(self._shown()).rstrip(".")

    def _shown(self) -> list[VerifiedValue]:
        """Return the values that tell something new.

        Extremes at the start or the end of a run, and those equal to the final value, are left out
        unless they are flagged.
        """
        final = {value.probe: value.value for value in self.values if value.what == "final"}
        duration = 0.0 if self.scenario.is_static else self.scenario.duration

        def tells(value: VerifiedValue) -> bool:
            if value.what not in ("min", "max") or value.flagged:
                return True
            same_as_final = abs(value.value - final[value.probe]) <= value.solver
            return 0.0 < value.time_of_value < duration and not same_as_final

        return [value for value in self.values if tells(value)]

    def _summary_line(self, shown: Sequence[VerifiedValue]) -> str:
        """Return in words what holds for the values shown; every flagged value is."""
        total, flagged = len(shown), len(self.flagged)
        settled = sum(value.settled and not value.flagged for value in shown)
        unmeasured = {value.label for value in self.order_not_measured}
        unmeasured &= {value.label for value in shown}
        found = []
        if flagged:
            found.append(f"{flagged} of {total} values do not converge at the expected order")
        elif not settled and not unmeasured:
            found.append(f"All {total} values converge at the expected order")
        if settled:
            found.append(f"{_share(settled, total)} values settle at no clear order")
        if unmeasured:
            share = _share(len(unmeasured), total).lower()
            found.append(f"The order of {share} values was not measured")
        hidden = len(self.values) - total
        left_out = f"extremes at the start or the end, not shown: {hidden}; " if hidden else ""
        return f"{'. '.join(found)} ({left_out}{self.cpu_seconds:.2g} s of CPU time)."


def _table(shown: Sequence[VerifiedValue]) -> Rows:
    header = ("probe", "value", "error", "space", "time", "drawing", "extrapolated", "orders")
    rows = [(*header, "verdict"), *map(_row, shown)]
    if all(value.drawing is None for value in shown):
        left_out = header.index("drawing")
        rows = [row[:left_out] + row[left_out + 1 :] for row in rows]
    return rows


def _row(value: VerifiedValue) -> tuple[str, ...]:
    parts = (value.space, value.time, value.drawing)
    return (
        value.label,
        _number(value.value, value),
        f"± {_error_bar_text(value.error_bar)}",
        *("-" if part is None else _error_bar_text(part.error_bar) for part in parts),
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


def _error_bar_text(error_bar: float) -> str:
    return f"{error_bar:.2g}" if math.isfinite(error_bar) else "unknown"


def _order(part: ErrorEstimate | None) -> str:
    return "-" if part is None or part.order is None else f"{part.order:.1f}"


def _share(part: int, total: int) -> str:
    return f"{part} of {total}" if part < total else f"All {total}"
