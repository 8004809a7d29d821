"""The result of a sweep: a table with a row for each member."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from der._core import Scenario, ended_as_asked
from der.exporting.sweep_tables import SweepFormat, export_sweep
from der.html import card
from der.output_paths import folder_path
from der.sweeps.store import FILE, Store, is_sweep
from der.sweeps.sweep_data import Rows, SweepData
from der.sweeps.table import WARNINGS, Column
from der.tables import data_frame

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


#: A notebook has a picture of no more members than these, and the rows of the first few.
_DRAWN, _SHOWN = 5000, 8


class Sweep(SweepData):
    """The members of a sweep, with methods to convert, draw and write them."""

    def to_numpy(self) -> NDArray[np.void]:
        """Return a structured array, shape (members,), with a field for each column.

        Numbers are NaN and texts empty where a member has none.
        """
        arrays = {name: self[name] for name in self.values}
        table = np.empty(len(self), [(name, array.dtype) for name, array in arrays.items()])
        for name, array in arrays.items():
            table[name] = array
        return table

    def to_pandas(self, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Return a table of pandas, with the parameters as its index.

        Parameters
        ----------
        columns
            Names of columns, or of probes for their final values; without it, the final values of
            all probes and what the analysis finds. ``attrs["units"]`` has their units.

        Raises
        ------
        KeyError
            If there is no such column.
        ModuleNotFoundError
            Without pandas.
        """
        names = self.answers if columns is None else columns
        found = {name.removesuffix(".final"): self[name] for name in names}
        units = {name: self.column(name).unit for name in found}
        return data_frame(found, {path: self[path] for path in self.parameters}, units)

    def export(self, format: SweepFormat, out: str | os.PathLike[str]) -> list[Path]:
        """Write the table as ``csv``, ``npz`` or ``parquet``, and return the path of the file.

        The ending is added if it lacks. Parquet requires the package pyarrow.
        """
        return export_sweep(self, format, out)

    def plot(self, columns: Sequence[str] | None = None) -> Figure:
        """Draw columns over the parameters; failed and doubtful members are marked.

        Over one parameter a line, over two a map, over more parallel axes.

        Parameters
        ----------
        columns
            Names of columns, or of probes for their final values; without it, the final values of
            all probes and what the analysis finds.
        """
        from der.plotting.sweep import plot_sweep  # here, because matplotlib takes long to load

        return plot_sweep(self, columns)

    def summary(self) -> str:
        """Return in words how many members there are, failed, by status, and have warnings."""
        failed = {
            status: count for status, count in self.statuses.items() if not ended_as_asked(status)
        }
        counts = ", ".join(f"{status} {count}" for status, count in failed.items())
        parts = [
            f"{len(self)} member{'' if len(self) == 1 else 's'}",
            f"{sum(failed.values())} failed ({counts})" if failed else "none failed",
        ]
        if self.warned:
            parts.append(f"{self.warned} with warnings (column {WARNINGS})")
        return f"{', '.join(parts)}; {self.cpu_seconds:.3g} s of CPU time"

    def _repr_html_(self) -> str:
        if not 0 < len(self) <= _DRAWN:
            return card(self.scenario.title, self.summary())
        names = [*self.parameters, "status", *self.answers]
        cells = zip(*(self.values[name][:_SHOWN] for name in names), strict=True)
        rows = [[_text(value) for value in row] for row in cells]

        def draw() -> Figure:
            figure = self.plot()
            figure.suptitle("")  # it stands above
            return figure

        titles = [name.removesuffix(".final") for name in names]
        return card(self.scenario.title, self.summary(), draw, [[titles, *rows]])

    def __repr__(self) -> str:
        """Return title, parameters and size in one line."""
        return (
            f"<der.Sweep of {self.scenario.title!r} over {', '.join(self.parameters)}: "
            f"{self.summary()}>"
        )


def _text(value: Any) -> str:
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


def load_sweep(folder: str | os.PathLike[str]) -> Sweep:
    """Read the folder of a sweep, also of one that still goes on or was killed.

    Parameters
    ----------
    folder
        A folder with ``sweep.sqlite``.

    Raises
    ------
    FileNotFoundError
        If there is none.
    ValueError
        If it was written by another version of der, or never began.
    OSError
        If it is damaged.
    TypeError
        If the folder is no path.
    """
    path = folder_path("folder", folder) / FILE
    if not is_sweep(folder):
        raise FileNotFoundError(f"no sweep in {folder}: {path} does not exist")
    with closing(Store(path)) as store:
        return read_sweep(store, partial(_read_rows, path))


def read_sweep(
    store: Store, rows: Callable[[tuple[Column, ...], int], Rows] | None = None
) -> Sweep:
    """Return what a store holds; without a function that reads rows later, they are read now."""
    description = store.description()
    if not description:
        raise ValueError("the sweep never began: it holds nothing to read")
    columns, last = tuple(store.columns), store.last()
    read = store.read(columns, last) if rows is None else []
    counts = store.counts(last)
    return Sweep(
        scenario=Scenario.parse(description["scene"], description["source"]),
        columns=columns,
        requests=tuple(store.requests()),
        statuses={status: count for status, count, _, _ in counts},
        cpu_seconds=sum((seconds for _, _, seconds, _ in counts), 0.0),
        warned=sum(warned for _, _, _, warned in counts),
        _read=(lambda: read) if rows is None else partial(rows, columns, last),
    )


def _read_rows(path: Path, columns: tuple[Column, ...], last: int) -> Rows:
    with closing(Store(path)) as store:
        return store.read(columns, last)
