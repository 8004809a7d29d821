"""Tables of finished members, as they travel from where they were run to where they are kept."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Kind = Literal["run", "parameter", "probe", "found", "error"]


@dataclass(frozen=True)
class Column:
    """A column of a sweep.

    Attributes
    ----------
    name
        ``tip_y.final``, ``frequency 1``, ``rods.arm.nodes``, ``status``.
    kind
        ``run``: number, status and cost; ``parameter``; ``probe``; ``found`` by the analysis;
        ``error``: the error bar of the column whose name it has before ``.error``.
    unit
        In SI; empty for none, and for parameters.
    """

    name: str
    kind: Kind
    unit: str = ""


#: The columns that every sweep has, beside its parameters.
RUN_COLUMNS = (
    Column("member", "run"),
    Column("status", "run"),
    Column("message", "run"),
    Column("seconds", "run", "s"),
    Column("steps", "run"),
    Column("newton_iterations", "run"),
    Column("unreliable_from", "run", "s"),
    Column("version", "run"),
)


@dataclass
class Table:
    """Some finished members: a row each, and the columns that they have beside `RUN_COLUMNS`.

    Attributes
    ----------
    columns
        By their name.
    rows
        A value for each column that the member has.
    """

    columns: dict[str, Column] = field(default_factory=dict)
    rows: list[dict[str, Any]] = field(default_factory=list)

    def begin(self, **values: Any) -> dict[str, Any]:
        """Begin a row with the values of `RUN_COLUMNS` that are known, and return it."""
        self.rows.append(values)
        return values

    def add(self, column: Column) -> None:
        """Add a column, unless it is there."""
        self.columns.setdefault(column.name, column)

    def put(self, name: str, kind: Kind, unit: str, value: Any) -> None:
        """Put a value into the last row."""
        if name not in self.columns:
            self.columns[name] = Column(name, kind, unit)
        self.rows[-1][name] = value
