"""NPZ: every array of a result in one file for NumPy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der.analyses import DATA_UNITS
from der.fields import FIELD_UNITS, rod_fields
from der.progress import ProgressFunction
from der.run_data import RunData

#: Unit of each array, of those of a rod by their last name; pure numbers have an empty one.
_UNITS = {
    "times": "s",
    "steps": "",
    "positions": "m",
    "velocities": "m/s",
    "nodes": "",
    "arc_lengths": "m",
    "radius": "m",
    "sphere_radii": "m",
    "edge_tension": "N",
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
    units = _UNITS | FIELD_UNITS
    for group, columns in (("energies", result.energies), ("work", result.work)):
        arrays |= {f"{group}/{name}": values for name, values in columns.items()}
        units |= {f"{group}/{name}": "J" for name in columns}
    for name, probe in result.probes.items():
        arrays[f"probes/{name}"] = np.asarray(probe)
        units[f"probes/{name}"] = probe.unit
    arrays |= result.data
    units |= {name: DATA_UNITS.get(name, "") for name in result.data}
    for fields in rod_fields(result):
        prefix = f"rods/{fields.rod.name}"
        arrays |= {
            f"{prefix}/nodes": fields.rod.nodes,
            f"{prefix}/arc_lengths": fields.rod.arc_lengths,
            f"{prefix}/radius": np.array(fields.rod.radius),
            f"{prefix}/sphere_radii": fields.rod.sphere_radii,
            f"{prefix}/edge_tension": fields.edge_tension,
        }
        arrays |= {f"{prefix}/{name}": values for name, values in fields.named().items()}
    arrays |= {f"units/{name}": np.array(unit) for name, unit in units.items()}
    with out.open("wb") as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
    progress(1.0)
    return [out]
