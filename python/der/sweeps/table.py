"""Tables of finished members, as they travel from where they were run to where they are kept."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Literal

from der._core import Scenario, __version__, quantities

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


#: The columns that every sweep has, beside its parameters, with their types in SQLite.
RUN_TYPES = {
    # Not the primary key, so that the numbers of SQLite's own rows grow as members are added.
    Column("member", "run"): "INTEGER NOT NULL UNIQUE",
    Column("status", "run"): "TEXT NOT NULL",
    Column("message", "run"): "TEXT",
    Column("seconds", "run", "s"): "REAL",
    Column("steps", "run"): "INTEGER",
    Column("newton_iterations", "run"): "INTEGER",
    Column("unreliable_from", "run", "s"): "REAL",
    Column("version", "run"): "TEXT NOT NULL",
}
RUN_COLUMNS = tuple(RUN_TYPES)
#: What is told of each probe.
TOLD, WHEN = ("final", "min", "max"), ("t_min", "t_max")

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


def probes_of(scene: Scenario) -> dict[str, dict[str, Any]]:
    """Return the probes that a scene asks for, by name."""
    return (scene.to_dict().get("output") or {}).get("probes") or {}


def units_of_probes(scene: Scenario) -> dict[str, str]:
    """Return the unit of each probe of a scene."""
    unit_of = {quantity.name: quantity.unit for quantity in quantities()}
    return {name: unit_of[probe["quantity"]] for name, probe in probes_of(scene).items()}


def columns_of_probe(name: str, unit: str, on_path: bool) -> list[Column]:
    """Return the columns of a probe.

    On a path of equilibria an extreme has the number of a point, and no time.
    """
    units = (unit,) * len(TOLD) + ("" if on_path else "s",) * len(WHEN)
    names = names_of_columns(name)
    return [Column(own, "probe", its) for own, its in zip(names, units, strict=True)]


@lru_cache(maxsize=1024)
def names_of_columns(probe: str) -> tuple[str, ...]:
    """Return the names of the columns of a probe, made once and not for each member."""
    return tuple(f"{probe}.{what}" for what in (*TOLD, *WHEN))


def row_of(
    number: int, status: str, message: str | None = None, seconds: float = 0.0
) -> dict[str, Any]:
    """Return the row of a member; of one that has no result it is all that is known."""
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

    def put(self, name: str, kind: Kind, unit: str, value: Any) -> None:
        """Put a value into the last row."""
        if name not in self.columns:
            self.columns[name] = Column(name, kind, unit)
        self.rows[-1][name] = value
