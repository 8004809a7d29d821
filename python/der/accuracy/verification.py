"""How far a scene's numbers can be trusted: each probe with an error bar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from der._core import Scenario
from der.accuracy.verification_table import summary_line, value_table, values_to_show
from der.accuracy.verified_value import VerifiedValue


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
        duration = 0.0 if self.scenario.is_static else self.scenario.duration
        shown = values_to_show(self.values, duration)
        hidden = len(self.values) - len(shown)
        lines = [self.scenario.title, "", *value_table(shown), ""]
        if len(self.meshes) > 1:
            lines.append(f"Space: {', '.join(self.meshes)}.")
        if len(self.steps) > 1:
            lines.append(f"Time: {', '.join(self.steps)}.")
        # The scene's own are Python's warnings as soon as it is read.
        of_run = [text for text in self.warnings if text not in self.scenario.warnings]
        lines += [f"Warning: {warning.rstrip('.')}." for warning in of_run]
        lines += [f"Note: {note.rstrip('.')}." for note in self.notes]
        lines.append(summary_line(shown, self.order_not_measured, hidden, self.cpu_seconds))
        return "\n".join(lines)
