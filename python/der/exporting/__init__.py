"""Results for other programs: one file of this folder for each format."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Literal, get_args

from der.progress import ProgressFunction
from der.run_data import RunData

ExportFormat = Literal["csv", "npz", "vtk"]


def export(
    result: RunData,
    format: ExportFormat,
    out: str | os.PathLike[str],
    *,
    progress: ProgressFunction | None = None,
) -> list[Path]:
    """Write a result for other programs.

    ``docs/looking.md`` describes the files.

    Parameters
    ----------
    result
        A result of ``der.run`` or ``der.open_run``.
    format
        ``csv``: two tables, of all nodes and of the probes. ``npz``: every array, for NumPy.
        ``vtk``: one file for each frame and a ``.pvd`` that ParaView opens as a series over time;
        requires the package pyevtk.
    out
        Folder to write to, made if it is not there; with ``npz`` a file.
    progress
        Told how much is done, from 0 to 1.

    Returns
    -------
    list of pathlib.Path
        The files to open; the frames of a VTK series are not listed.

    Raises
    ------
    ValueError
        For a format that there is not, and a run without a frame.
    ModuleNotFoundError
        For VTK without pyevtk.
    """
    # Here, since each format may need a package of its own.
    from der.exporting.csv_tables import write_csv
    from der.exporting.npz_file import write_npz
    from der.exporting.vtk_series import write_vtk

    writers: dict[str, Callable[[RunData, Path, ProgressFunction], list[Path]]] = {
        "csv": write_csv,
        "npz": write_npz,
        "vtk": write_vtk,
    }
    if format not in writers:
        raise ValueError(f"no format {format!r}; there are {', '.join(get_args(ExportFormat))}")
    if len(result.times) == 0:
        raise ValueError(f"the run has no frame to export (status {result.status})")
    return writers[format](result, Path(out), progress or (lambda done: None))
