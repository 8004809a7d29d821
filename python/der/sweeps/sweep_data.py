"""The table of a sweep, which everything that draws or writes sweeps takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der._core import Scenario, ended_as_asked
from der.sweeps.table import Column

#: Rows of a table, with a value for each column.
Rows = list[tuple[Any, ...]]


@dataclass(frozen=True, eq=False)
class SweepData:
    """The members of a sweep that are finished, in the order of their numbers.

    `Sweep` adds ways to draw and write them.

    Attributes
    ----------
    scenario
        The scene that was varied.
    columns
        Name, kind and unit of each column.
    requests
        What was asked for, one after the other: paths, values, and of samples their seed.
    statuses
        By status, how many members have it.
    cpu_seconds
        CPU time of all members [s].
    warned
        How many members have warnings, which the column ``warnings`` tells.
    """

    scenario: Scenario
    columns: tuple[Column, ...]
    requests: tuple[dict[str, Any], ...]
    statuses: dict[str, int]
    cpu_seconds: float
    warned: int
    _read: Callable[[], Rows] = field(repr=False)

    @cached_property
    def values(self) -> dict[str, list[Any]]:
        """The columns by name, each with a value for each member; None where a member has none.

        Read when they are first asked for: a million members take some memory.
        """
        read = list(zip(*self._read(), strict=True)) or [()] * len(self.columns)
        return {column.name: list(own) for column, own in zip(self.columns, read, strict=True)}

    @property
    def parameters(self) -> list[str]:
        """The key paths of the parameters."""
        return [column.name for column in self.columns if column.kind == "parameter"]

    @property
    def answers(self) -> list[str]:
        """The columns of what was asked for: numbers that the analysis finds, and final values."""
        found = [c.name for c in self.columns if c.kind == "found" and self.is_number(c.name)]
        probes = [c.name for c in self.columns if c.kind == "probe" and c.name.endswith(".final")]
        return found + probes

    def is_number(self, name: str) -> bool:
        """Return whether a column has numbers, and not texts."""
        return self[name].dtype.kind in "if"

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The members, each with its values by column."""
        return [
            dict(zip(self.values, row, strict=True))
            for row in zip(*self.values.values(), strict=True)
        ]

    @cached_property
    def failed(self) -> NDArray[np.bool_]:
        """Whether each member failed, shape (members,)."""
        return np.array([not ended_as_asked(status) for status in self.values["status"]], bool)

    @property
    def all_failed(self) -> bool:
        """Whether there are members, and each one failed."""
        return bool(self.statuses) and not any(map(ended_as_asked, self.statuses))

    def __len__(self) -> int:
        """Return the number of members."""
        return sum(self.statuses.values())

    def column(self, name: str) -> Column:
        """Return a column by its name; that of a probe alone is that of its final value.

        Raises
        ------
        KeyError
            If there is none; its message lists those that there are.
        """
        by_name = {column.name: column for column in self.columns}
        for tried in (name, f"{name}.final"):
            if tried in by_name:
                return by_name[tried]
        raise KeyError(f"the sweep has no column '{name}'; it has: {', '.join(by_name)}")

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a column, or the final values of a probe, as an array, shape (members,).

        Numbers are NaN where a member has none.
        """
        return _array(self.values[self.column(name).name])


def _array(values: list[Any]) -> NDArray[Any]:
    if any(isinstance(value, str) for value in values):
        return np.array(["" if value is None else str(value) for value in values])
    if all(isinstance(value, int) for value in values):
        return np.array(values, np.int64)
    return np.array(values, np.float64)
