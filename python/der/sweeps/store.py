"""The file of a sweep: an SQLite database, one transaction for each chunk of members.

docs/sweeps.md describes its tables. The journal is the rollback journal of SQLite, which works on
the file systems of clusters as well, and leaves one file.
"""

from __future__ import annotations

import fcntl
import json
import os
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from der.errors import DerError
from der.sweeps.design import Design, Member
from der.sweeps.table import (
    OF_SURROUNDINGS,
    RUN_COLUMNS,
    RUN_TYPES,
    TOO_WIDE,
    WARNINGS,
    Column,
    Kind,
    Table,
    row_of,
)
from der.sweeps.values import stored

#: The file in the folder of a sweep, and the one that is locked while a sweep goes on there.
FILE, LOCK = "sweep.sqlite", "sweep.lock"
#: Run folders of the members, with ``--frames``.
FRAMES = "runs"
#: Number of the layout of the tables.
_FORMAT = "1"
#: How long to wait for another program that reads or writes the file [s].
_PATIENCE = 60.0
#: What SQLite says of a file that is damaged, or has other tables.
_SIGNS_OF_ANOTHER_FILE = ("not a database", "malformed", "no such column", "no such table")
#: How many columns a table of SQLite has at most, as it is built by default.
MOST_COLUMNS = 2000
#: Types of columns: parameters are kept as they are given.
_TYPES: dict[Kind, str] = {"parameter": "", "probe": "REAL", "found": "", "error": "REAL"}


def is_sweep(folder: str | os.PathLike[str]) -> bool:
    """Return whether a folder holds a sweep."""
    return (Path(folder) / FILE).is_file()


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other sweeps out of a folder for the time of a ``with`` block."""
    with (folder / LOCK).open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise DerError(
                f"another sweep is writing its results to '{folder}'; wait for it or name another "
                "folder"
            ) from None
        except OSError:
            pass  # a file system without locks
        yield


class Store:
    """The tables of a sweep, in a database file or in memory."""

    def __init__(self, path: Path | None = None) -> None:
        self._path = path
        with self._named_errors():
            self._base = sqlite3.connect(
                ":memory:" if path is None else path, timeout=_PATIENCE, isolation_level=None
            )
        self._columns: dict[str, Column] = {}

    def close(self) -> None:
        """Close the file."""
        self._base.close()

    @property
    def columns(self) -> list[Column]:
        """The columns of the table of members: parameters behind the member's number."""
        return list(self._columns.values())

    def description(self) -> dict[str, str]:
        """Return what is known of the sweep, by name; empty if it never began."""
        with self._named_errors():
            if not self._base.execute(
                "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'sweep'"
            ).fetchall():
                if self._base.execute("SELECT 1 FROM sqlite_master").fetchall():
                    raise OSError(
                        f"{self._path} has tables, and none of a sweep: name another folder"
                    )
                return {}
            found = dict(self._base.execute("SELECT key, value FROM sweep").fetchall())
            if found.get("format") != _FORMAT:
                raise ValueError(
                    f"{self._path} was written by another version of der, {found.get('version')}: "
                    "read it with that version"
                )
            rows = self._base.execute("SELECT name, kind, unit FROM columns ORDER BY rowid")
            self._columns = {name: Column(name, kind, unit) for name, kind, unit in rows}
        return found

    def create(
        self, description: dict[str, str], paths: Iterable[str], probes: Iterable[Column] = ()
    ) -> None:
        """Make the tables of a sweep that varies these parameters, all of them or none.

        The columns of probes are there from the start, even if every member fails.
        """
        number, *others = RUN_COLUMNS
        columns = [number, *(Column(path, "parameter") for path in paths), *others]
        of_probes = list(probes)
        # Varied probes may need more columns: members that have them fail (TOO_WIDE).
        if len(columns) + len(of_probes) <= MOST_COLUMNS:
            columns += of_probes
        with self._transaction():
            for table in (
                "sweep (key TEXT PRIMARY KEY, value TEXT NOT NULL)",
                "requests (first INTEGER NOT NULL, count INTEGER NOT NULL, design TEXT NOT NULL)",
                "columns (name TEXT, kind TEXT, unit TEXT)",
                f"runs ({', '.join(map(_definition, columns))})",
            ):
                self._base.execute(f"CREATE TABLE {table}")
            self._base.executemany(
                "INSERT INTO sweep VALUES (?, ?)", {"format": _FORMAT, **description}.items()
            )
            for column in columns:
                self._note_column(column)

    def request(self, design: Design) -> int:
        """Note what is asked for, and return the number of its first member.

        What was asked for before has the numbers that it had.
        """
        text = design.to_json()
        with self._transaction():
            known = self._base.execute("SELECT first, count, design FROM requests").fetchall()
            for first, _, asked in known:
                if asked == text:
                    return int(first)
            first = max((first + count for first, count, _ in known), default=0)
            self._base.execute("INSERT INTO requests VALUES (?, ?, ?)", (first, len(design), text))
        return int(first)

    def requests(self) -> list[dict[str, Any]]:
        """Return what was asked for, one after the other, as `Design.to_json` tells it."""
        rows = self._ask("SELECT design FROM requests ORDER BY rowid")
        return [json.loads(design) for (design,) in rows]

    def known(
        self, paths: Iterable[str]
    ) -> tuple[set[tuple[Any, ...]], dict[tuple[Any, ...], int]]:
        """Return the values of the parameters of all members that are not to be run again.

        Behind them the numbers of those that are, by their values.
        """
        names = ", ".join(map(_quoted, ["member", "status", *paths]))
        done, again = set(), {}
        for number, status, *values in self._ask(f"SELECT {names} FROM runs"):
            if status in OF_SURROUNDINGS:
                again[tuple(values)] = number
            else:
                done.add(tuple(values))
        return done, again

    def write(self, table: Table, paths: Iterable[str], values: Mapping[int, Member]) -> None:
        """Add finished members, all of them or none; one that was run again has its new row.

        `values` are those of the parameters of each member, by its number.
        """
        table = self._that_fits(table)
        run, found = [column.name for column in RUN_COLUMNS], list(table.columns)
        names = [*run, *paths, *found]
        places = ", ".join("?" * len(names))
        rows = (
            (*map(row.get, run), *map(stored, values[row["member"]]), *map(row.get, found))
            for row in table.rows
        )
        with self._transaction():
            for column in table.columns.values():
                self._add_column(column)
            # The old row goes only now: nobody knows whether the member will be run to its end.
            new = ", ".join(f"{own} = excluded.{own}" for own in map(_quoted, self._columns))
            self._base.executemany(
                f"INSERT INTO runs ({', '.join(map(_quoted, names))}) VALUES ({places}) "
                f"ON CONFLICT (member) DO UPDATE SET {new}",
                rows,
            )

    def _that_fits(self, table: Table) -> Table:
        """Return the rows with the columns that there is room for; the others are failures."""
        known = set(self._columns)
        if len(known.union(table.columns)) <= MOST_COLUMNS:
            return table
        rows = []
        for row in table.rows:
            wider = known.union(name for name in row if name in table.columns)
            if len(wider) <= MOST_COLUMNS:
                known = wider
            else:
                message = (
                    f"it finds {len(wider) - len(known)} columns more, and a table has "
                    f"{MOST_COLUMNS} at most: ask for fewer probes, modes or bifurcations"
                )
                row = row_of(row["member"], TOO_WIDE, message, row["seconds"])
            rows.append(row)
        columns = {name: column for name, column in table.columns.items() if name in known}
        return Table(columns, rows)

    def last(self) -> int:
        """Return how many members there are: none is ever taken away, and new ones are added."""
        return int(self._ask("SELECT COALESCE(MAX(rowid), 0) FROM runs")[0][0])

    def read(self, columns: Iterable[Column], last: int) -> list[tuple[Any, ...]]:
        """Return these columns of the first `last` members, in the order of their numbers."""
        names = ", ".join(_quoted(column.name) for column in columns)
        return self._ask(f"SELECT {names} FROM runs WHERE rowid <= ? ORDER BY member", last)

    def counts(self, last: int) -> list[tuple[str, int, float, int]]:
        """Return by status, most frequent first, how many of the first `last` members have it.

        Behind that their CPU time [s], and how many of them have warnings.
        """
        warned = f"COUNT({WARNINGS})" if WARNINGS in self._columns else "0"
        return self._ask(
            f"SELECT status, COUNT(*) AS n, TOTAL(seconds), {warned} FROM runs WHERE rowid <= ? "
            "GROUP BY status ORDER BY n DESC, status",
            last,
        )

    def _ask(self, question: str, *values: Any) -> list[Any]:
        with self._named_errors():
            return self._base.execute(question, values).fetchall()

    def _add_column(self, column: Column) -> None:
        if column.name not in self._columns:
            self._base.execute(f"ALTER TABLE runs ADD COLUMN {_definition(column)}")
            self._note_column(column)

    def _note_column(self, column: Column) -> None:
        self._base.execute(
            "INSERT INTO columns VALUES (?, ?, ?)", (column.name, column.kind, column.unit)
        )
        self._columns[column.name] = column

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        with self._named_errors():
            self._base.execute("BEGIN IMMEDIATE")
            try:
                yield
            except BaseException:
                if self._base.in_transaction:
                    self._base.execute("ROLLBACK")
                raise
            self._base.execute("COMMIT")

    @contextmanager
    def _named_errors(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            if any(sign in str(error) for sign in _SIGNS_OF_ANOTHER_FILE):
                raise OSError(
                    f"{self._path} is damaged, or no file of a sweep ({error}): name another folder"
                ) from error
            if "disk is full" in str(error):
                raise OSError(
                    f"{self._path}: {error}; the members written before are kept: make room, then "
                    "go on with --resume (resume=True)"
                ) from error
            raise OSError(f"{self._path or 'the table of the sweep'}: {error}") from error


def _definition(column: Column) -> str:
    type_ = RUN_TYPES[column] if column.kind == "run" else _TYPES[column.kind]
    return f"{_quoted(column.name)} {type_}"


def _quoted(name: str) -> str:
    doubled = name.replace('"', '""')
    return f'"{doubled}"'
