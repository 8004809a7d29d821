"""NPZ: every array of a result in one file for NumPy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der._core import array_units
from der.fields import along_line, fields_of, rod_fields
from der.output_paths import written_whole
from der.progress import ProgressFunction
from der.run_data import RunData

#: Names of the arrays that have another name in a run file.
_NAMES = {
    "times": "time",
    "steps": "step",
    "nodes": "rods/nodes",
    "arc_lengths": "rods/arc_length",
    "radius": "rods/radius",
    "sphere_radii": "rods/sphere_radius",
}


def write_npz(result: RunData, out: Path, progress: ProgressFunction) -> list[Path]:
    """Write one file, its ending added if it lacks; see `der.export`."""
    out = out if out.suffix == ".npz" else out.with_name(out.name + ".npz")
    out.parent.mkdir(parents=True, exist_ok=True)
    arrays: dict[str, NDArray[Any]] = {
        "scene": np.array(result.scenario.to_yaml()),
        "status": np.array(result.status),
        "times": result.times,
        "steps": result.steps,
        "positions": result.positions,
        "velocities": result.velocities,
    }
    if result.sections is not None:
        arrays |= {f"sections/{name}": values for name, values in vars(result.sections).items()}
        arrays["directors"] = result.directors
    for group, columns in (("energies", result.energies), ("work", result.work)):
        arrays |= {f"{group}/{name}": values for name, values in columns.items()}
    arrays |= {f"probes/{name}": np.asarray(probe) for name, probe in result.probes.items()}
    arrays |= result.data
    for fields in rod_fields(result):
        rod: dict[str, NDArray[Any]] = {
            "nodes": fields.rod.line_nodes,
            "arc_lengths": fields.rod.line_arc_lengths,
            "radius": np.array(fields.rod.radius),
            "sphere_radii": along_line(fields.rod.sphere_radii, fields.rod),
            **{f"edge_{name}": values for name, values in fields.at_edges.items()},
            **fields.at_nodes,
        }
        arrays |= {f"rods/{fields.rod.name}/{name}": values for name, values in rod.items()}
    arrays |= {f"units/{name}": np.array(unit) for name, unit in _units(result).items()}
    with written_whole(out) as partial, partial.open("wb") as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
    progress(1.0)
    return [out]


def _units(result: RunData) -> dict[str, str]:
    """Return the unit of each array, of those of a rod by their last name."""
    known = array_units()
    shared = ("positions", "velocities")
    grouped = (
        f"{group}/{name}" for group in ("energies", "work") for name in getattr(result, group)
    )
    units = {name: known[name] for name in (*shared, *grouped)}
    if result.sections is not None:
        units |= {f"sections/{name}": known[f"sections/{name}"] for name in vars(result.sections)}
        units["directors"] = ""
    units |= {name: known.get(name, "") for name in result.data}
    units |= {name: known[in_file] for name, in_file in _NAMES.items()}
    units |= {f"probes/{name}": probe.unit for name, probe in result.probes.items()}
    for name, quantity in fields_of(result.model).items():
        units[name] = quantity.unit
        if quantity.kind == "edge":
            units[f"edge_{name}"] = quantity.unit
    return units
