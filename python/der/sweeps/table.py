"""Tables of finished members, as they travel from where they were run to where they are kept."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from der._core import __version__

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


#: Status of a member whose run met an error that is none of der's, such as a lack of memory.
BROKEN = "error"
#: Status of a member that brought down every process that tried it.
LOST = "worker_lost"
#: Status of a member that finds more columns than a table can have.
TOO_WIDE = "too_many_columns"
#: Failures that are the surroundings' and not the member's: a full disk, a lack of memory.
OF_SURROUNDINGS = ("io_error", BROKEN, LOST)
#: The column of the warnings of a run, a line each; there is none where no member has any.
WARNINGS = "warnings"


def failed_row(number: int, status: str, message: str, seconds: float = 0.0) -> dict[str, object]:
    """Return the row of a member that has no result."""
    return {
        "member": number,
        "status": status,
        "message": message,
        "seconds": seconds,
        "version": __version__,
    }


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
