"""The result of a study of cost against error."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING

from der._core import Scenario
from der.accuracy.study_plan import check_errors
from der.accuracy.study_row import StudyRow, seconds_text
from der.html import card
from der.output_paths import written_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: No advice is given for errors of more than this share of a probe's size.
_USEFUL = 0.2


@dataclass(frozen=True)
class Study:
    """The result of `der.study`: cost against error.

    Attributes
    ----------
    scenario
        The scene that was varied.
    rows
        One for each probe and configuration.
    sizes
        By probe, what errors are set against: what it goes through in the reference, largest less
        smallest value, or its largest magnitude if that is more.
    notes
        Notes for the reader, such as what could not be varied and what was skipped.
    noise
        By probe, what rounding leaves: an error of this or less is none.
    """

    scenario: Scenario
    rows: tuple[StudyRow, ...]
    sizes: dict[str, float]
    notes: tuple[str, ...]
    noise: dict[str, float] = field(default_factory=dict)

    @property
    def probes(self) -> list[str]:
        """The names of the probes."""
        return list(self.sizes)

    def of(self, probe: str) -> list[StudyRow]:
        """Return the rows of a probe.

        Raises
        ------
        KeyError
            If the study has no such probe.
        """
        if probe not in self.sizes:
            raise KeyError(probe)
        return [row for row in self.rows if row.probe == probe]

    def cheapest(self, probe: str, error: float) -> StudyRow | None:
        """Return the cheapest configuration whose error is at most `error`; None if none is."""
        good = [row for row in self.of(probe) if row.completed and row.claimed_error <= error]
        return min(good, key=lambda row: row.cpu_seconds, default=None)

    def advice(self, errors: Sequence[float] | None = None) -> list[str]:
        """Return one line for each probe and error: what to take for it, and what it costs.

        Parameters
        ----------
        errors
            In the units of the probes; without it, powers of ten that the configurations reach.

        Raises
        ------
        ValueError
            For an empty list, and for errors that are not greater than 0 and finite.
        """
        if errors is not None:
            check_errors(errors)
        lines = []
        for probe in self.probes:
            wanted = self._decades(probe) if errors is None else errors
            lines += [self._advice_line(probe, error) for error in wanted]
            if not wanted:
                close = "no configuration of this study is close enough: refine more"
                exact = "exact in every configuration"
                lines.append(f"{probe}: {exact if self.is_exact(probe) else close}")
        return lines

    def is_exact(self, probe: str) -> bool:
        """Whether no completed configuration has an error larger than rounding."""
        errors = [row.claimed_error for row in self.of(probe) if row.completed]
        return bool(errors) and max(errors) <= self._noise(probe)

    def _noise(self, probe: str) -> float:
        return self.noise.get(probe, 0.0)

    def _advice_line(self, probe: str, error: float) -> str:
        rows = self.of(probe)
        size = self.sizes[probe]
        share = f" ({100.0 * error / size:.2g} %)" if size > self._noise(probe) else ""
        best = self.cheapest(probe, error)
        what = "no configuration of this study"
        if best is not None:
            what = f"{best.configuration}: {seconds_text(best.cpu_seconds)}"
        unit = f" {rows[0].unit}" if rows[0].unit else ""
        return f"{probe}: for {error:.3g}{unit}{share}: {what}"

    def _decades(self, probe: str) -> list[float]:
        found = [row.claimed_error for row in self.of(probe) if row.completed]
        found = [error for error in found if error > self._noise(probe)]
        if not found:
            return []
        lowest, highest = (math.ceil(math.log10(e) - 1e-9) for e in (min(found), max(found)))
        if self.sizes[probe] > self._noise(probe):
            highest = min(highest, math.floor(math.log10(_USEFUL * self.sizes[probe])))
        return [10.0**power for power in range(highest, lowest - 1, -1)]

    def write_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the rows as a table: one column for each attribute of `StudyRow`.

        Numbers that are not known are empty.
        """
        names = [field.name for field in fields(StudyRow)]
        with (
            written_whole(Path(path)) as partial,
            partial.open("w", newline="", encoding="utf-8") as file,
        ):
            writer = csv.writer(file)
            writer.writerow(names)
            for row in self.rows:
                values = (getattr(row, name) for name in names)
                writer.writerow(["" if value != value else value for value in values])

    def plot(self) -> Figure:
        """Draw cost against error, and the errors in space and in time, for each probe.

        Probes without any error are left out.
        """
        from der.plotting.study import plot_study  # here, because matplotlib takes long to load

        inexact = [probe for probe in self.probes if not self.is_exact(probe)]
        shown = inexact or self.probes[:1]
        return plot_study(self.scenario.title, [self.of(probe) for probe in shown])

    def __repr__(self) -> str:
        """Return title and size in one line."""
        return f"<der.Study of {self.scenario.title!r}: {self._facts()}>"

    def _repr_html_(self) -> str:
        advice = [("probe", "what to take"), *(line.partition(": ")[::2] for line in self.advice())]
        return card(self.scenario.title, self._facts(), self.plot, [advice])

    def _facts(self) -> str:
        configurations = len(self.rows) // max(len(self.probes), 1)
        return f"{configurations} configurations, probes: {', '.join(self.probes) or 'none'}"
