"""Reading the run folders that der_run and `Result.save` write.

The layout of ``results.h5`` is described in ``docs/results.md``.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from der._core import FileRecording, Scenario, read_run
from der.errors import DerError
from der.examples import PREFIX
from der.result import Result, to_result
from der.sweeps.store import FRAMES, is_sweep


def open_run(folder: str | os.PathLike[str]) -> Result:
    """Read a run folder, also that of a run that still goes on or was killed.

    Parameters
    ----------
    folder
        A folder with ``results.h5``, written by der_run, ``der.run(..., out=...)`` or
        `Result.save`.

    Returns
    -------
    Result
        With every frame that was saved. Without ``summary.json``, its `summary` holds only the
        ``status``: ``running`` for a run that was killed or is not over.

    Raises
    ------
    FileNotFoundError
        If there is no ``results.h5``; of a scene the message says how to run it.
    ValueError
        If it is damaged, is no run file, or was written by another version of der; the message says
        what to do; if the folder is that of a sweep.
    """
    folder = Path(folder)
    path = folder / "results.h5"
    if not path.exists() and is_sweep(folder):
        kept = folder / FRAMES
        advice = f"; its members are runs, in {kept}" if kept.is_dir() else ""
        raise ValueError(
            f"{folder} is a sweep of many runs, and no run: `der plot {folder}` draws it, `der "
            f"export {folder} --format csv` writes its table, der.load_sweep reads it{advice}"
        )
    if not path.exists():
        if folder.suffix in (".yaml", ".yml") or str(folder).startswith(PREFIX):
            words = f"{folder} is a scene, and no folder of a run: `der run {folder}` writes one"
            raise FileNotFoundError(words)
        raise FileNotFoundError(f"no run in {folder}: {path} does not exist")
    try:
        recording = read_run(path)
        scenario = Scenario.parse(recording.scene, str(folder / "scene.yaml"))
    except DerError as error:
        raise ValueError(str(error)) from error
    return _to_result(recording, scenario, folder)


def _to_result(recording: FileRecording, scenario: Scenario, folder: Path) -> Result:
    names = (scenario.to_dict().get("output") or {}).get("probes") or {}
    if set(names) != set(recording.probe_units):
        raise ValueError(f"{folder / 'results.h5'} has other probes than its scene")
    summary = _read_summary(folder, status=recording.status)
    return to_result(scenario, recording, list(names), summary)


def _read_summary(folder: Path, status: str) -> dict[str, Any]:
    path = folder / "summary.json"
    if status == "running" or not path.exists():
        return {"status": status}
    summary: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return summary
