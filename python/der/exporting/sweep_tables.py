"""Sweeps for other programs: CSV, NPZ for NumPy, Parquet."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from der.output_paths import written_whole
from der.sweeps.sweep_data import SweepData

SweepFormat = Literal["csv", "npz", "parquet"]


def export_sweep(sweep: SweepData, format: SweepFormat, out: str | os.PathLike[str]) -> list[Path]:
    """Write the table of a sweep; see `der.export`.

    Parameters
    ----------
    sweep
        The sweep to write.
    format
        ``csv``: a table, empty where a member has no value. ``npz``: an array for each column, for
        NumPy, and the ``scene``. ``parquet``: a table with the unit of each column; requires the
        package pyarrow.
    out
        File to write, its ending added if it lacks.

    Returns
    -------
    list of pathlib.Path
        The file.

    Raises
    ------
    ValueError
        For a format that there is not.
    ModuleNotFoundError
        For Parquet without pyarrow.
    """
    writers: dict[str, Callable[[SweepData, Path], None]] = {
        "csv": _write_csv,
        "npz": _write_npz,
        "parquet": _write_parquet,
    }
    if format not in writers:
        raise ValueError(
            f"a sweep is not written as {format!r}, but as {', '.join(get_args(SweepFormat))}"
        )
    path = Path(out)
    if path.suffix != f".{format}":
        path = path.with_name(f"{path.name}.{format}")
    path.parent.mkdir(parents=True, exist_ok=True)
    with written_whole(path) as partial:
        writers[format](sweep, partial)
    return [path]


def _write_csv(sweep: SweepData, path: Path) -> None:
    titles = [f"{c.name} [{c.unit}]" if c.unit else c.name for c in sweep.columns]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(titles)
        writer.writerows(zip(*sweep.values.values(), strict=True))


def _write_npz(sweep: SweepData, path: Path) -> None:
    arrays = {name: sweep[name] for name in sweep.values}
    arrays |= {f"units/{c.name}": np.array(c.unit) for c in sweep.columns}
    arrays["scene"] = np.array(sweep.scenario.to_yaml())
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]


def _of_one_type(values: list[Any]) -> list[Any]:
    """Return the values of a column, as texts if some are texts: ``auto`` beside 1e-5."""
    if not any(isinstance(value, str) for value in values):
        return values
    return [value if value is None else str(value) for value in values]


def _write_parquet(sweep: SweepData, path: Path) -> None:
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            "Parquet needs the package pyarrow: pip install 'der[tables]'"
        ) from error
    columns = [pa.array(_of_one_type(values)) for values in sweep.values.values()]
    fields = [
        pa.field(column.name, values.type, metadata={"unit": column.unit})
        for column, values in zip(sweep.columns, columns, strict=True)
    ]
    schema = pa.schema(fields, metadata={"scene": sweep.scenario.to_yaml()})
    parquet.write_table(pa.Table.from_arrays(columns, schema=schema), path)
