"""Writing a run folder as der_run writes it.

The layout of ``results.h5`` is described in ``docs/results.md``.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

from der import _core
from der.run_data import RunData


def save_run(result: RunData, folder: str | os.PathLike[str]) -> Path:
    """Write a result as a run folder; see `Result.save`."""
    folder = Path(folder)
    # That of a killed run is bare, and the version is what marks the file as one of der's.
    summary = json.dumps(
        {**result.summary, "der_version": result.summary.get("der_version", _core.__version__)},
        indent=2,
        ensure_ascii=False,
    )
    _core.save_run(folder, result.scenario, result.model, result, summary + "\n")
    return folder
