"""CSV: a table of the nodes, one row for each frame and node, and a table of the probes."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from der._core import array_units
from der.fields import fields_of, rod_fields
from der.film import mode_shapes
from der.output_paths import written_whole
from der.progress import ProgressFunction
from der.run_data import RunData

_AXES = "xyz"
_UNITS = array_units()


def write_csv(result: RunData, out: Path, progress: ProgressFunction) -> list[Path]:
    """Write ``nodes.csv`` and ``probes.csv`` into a folder; see `der.export`."""
    out.mkdir(parents=True, exist_ok=True)
    nodes, probes = out / "nodes.csv", out / "probes.csv"
    with _table(nodes) as file:
        _write_nodes(result, file, progress)
    with _table(probes) as file:
        _write_probes(result, file)
    if not len(mode_shapes(result)):
        return [nodes, probes]
    modes = out / "modes.csv"
    with _table(modes) as file:
        _write_modes(result, file)
    return [nodes, probes, modes]


@contextmanager
def _table(path: Path) -> Iterator[TextIO]:
    with (
        written_whole(path) as partial,
        partial.open("w", newline="", encoding="utf-8") as file,
    ):
        yield file


def _write_nodes(result: RunData, file: TextIO, progress: ProgressFunction) -> None:
    dimension = result.positions.shape[2]
    writer = csv.writer(file)
    writer.writerow(
        [
            *_frame_titles(result),
            "rod",
            "node",
            _title("s", _UNITS["rods/arc_length"]),
            *(_title(axis, _UNITS["positions"]) for axis in _AXES[:dimension]),
            *(_title(f"v{axis}", _UNITS["velocities"]) for axis in _AXES[:dimension]),
            *(_title(name, quantity.unit) for name, quantity in fields_of(result.model).items()),
        ]
    )
    rods = rod_fields(result)
    count = len(result.times)
    for frame, start in enumerate(_frame_columns(result)):
        for fields in rods:
            table = np.column_stack(
                [
                    fields.rod.line_arc_lengths,
                    fields.positions[frame],
                    fields.velocities[frame],
                    *(values[frame] for values in fields.at_nodes.values()),
                ]
            )
            rows = zip(fields.rod.line_nodes.tolist(), table.tolist(), strict=True)
            writer.writerows([*start, fields.rod.name, node, *row] for node, row in rows)
        progress((frame + 1) / count)


def _write_probes(result: RunData, file: TextIO) -> None:
    writer = csv.writer(file)
    titles = [_title(name, probe.unit) for name, probe in result.probes.items()]
    writer.writerow([*_frame_titles(result), *titles])
    columns: list[NDArray[np.float64]] = [np.asarray(probe) for probe in result.probes.values()]
    for frame, start in enumerate(_frame_columns(result)):
        writer.writerow([*start, *(float(column[frame]) for column in columns)])


def _write_modes(result: RunData, file: TextIO) -> None:
    if result.modes is not None:
        kind, values = _title("frequency", _UNITS["modes/frequencies"]), result.modes.frequencies
        unit = _UNITS["modes/shapes"]
    else:
        assert result.buckling is not None
        # Buckling modes have no size: the largest displacement counts as 1.
        kind, values, unit = "load factor", result.buckling.load_factors, "1"
    shapes = [_title(f"d{axis}", unit) for axis in _AXES[: result.positions.shape[2]]]
    writer = csv.writer(file)
    place = _title("s", _UNITS["rods/arc_length"])
    writer.writerow(["mode", kind, "rod", "node", place, *shapes])
    for number, (shape, value) in enumerate(zip(mode_shapes(result), values, strict=True), 1):
        for rod in result.rods:
            rows = np.column_stack([rod.line_arc_lengths, shape[rod.line_nodes]]).tolist()
            writer.writerows(
                [number, float(value), rod.name, node, *row]
                for node, row in zip(rod.line_nodes.tolist(), rows, strict=True)
            )


def _title(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _frame_titles(result: RunData) -> list[str]:
    if result.path is None:
        return ["frame", _title("time", _UNITS["time"])]
    return ["frame", "branch", "load factor"]


def _frame_columns(result: RunData) -> list[list[Any]]:
    """Return what begins each row of a frame: where on a path it is, or when."""
    if result.path is None:
        return [[frame, time] for frame, time in enumerate(result.times.tolist())]
    places = zip(result.path.branch.tolist(), result.path.factor.tolist(), strict=True)
    return [[frame, *place] for frame, place in enumerate(places)]
