"""Run folders: reading what der_run wrote, and writing the same from a `Result`.

The layout of ``results.h5`` is described in ``docs/results.md``.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from der._core import Rod, Scenario, __version__
from der.probe_series import make_probes
from der.result import Result

if TYPE_CHECKING:
    import h5py

_FORMAT_VERSION = 4
#: What analyses find besides frames.
_DATA_GROUPS = ("modes", "buckling", "path")
#: Unit of each of these arrays that is no pure number.
DATA_UNITS = {
    "modes/frequencies": "Hz",
    "modes/growth_rates": "1/s",
    "modes/shapes": "kg^-1/2 m",
    "buckling/rotations": "rad",
}


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
        If there is no ``results.h5``.
    ValueError
        If its format is newer than this version of der.
    """
    import h5py  # here, because it takes long to load

    folder = Path(folder)
    path = folder / "results.h5"
    if not path.exists():
        raise FileNotFoundError(f"no run in {folder}: {path} does not exist")
    # Without locking, since the run may still be writing.
    with h5py.File(path, "r", locking=False) as file:
        return _read_results(file, folder)


def _read_results(file: h5py.File, folder: Path) -> Result:
    version = int(file.attrs["format_version"])
    if version != _FORMAT_VERSION:
        raise ValueError(
            f"{file.filename} has format {version}, this der reads format {_FORMAT_VERSION}: "
            "install a newer version of der"
        )
    scenario = Scenario.parse(file["scene"].asstr()[()], str(folder / "scene.yaml"))
    summary = _read_summary(folder, status=str(file.attrs["status"]))
    # A killed run may leave other columns longer than `time`, which counts the whole frames.
    frames = len(file["time"])
    names = (scenario.to_dict().get("output") or {}).get("probes") or {}
    return Result(
        scenario=scenario,
        times=file["time"][:],
        steps=file["step"][:frames],
        positions=file["positions"][:frames],
        velocities=file["velocities"][:frames],
        energies={name: column[:frames] for name, column in file["energies"].items()},
        work={name: column[:frames] for name, column in file["work"].items()},
        probes=make_probes(
            {name: file["probes"][name][:frames] for name in names},
            {name: str(file["probes"][name].attrs["unit"]) for name in names},
            summary,
        ),
        summary=summary,
        data=_read_data(file),
    )


def _read_data(file: h5py.File) -> dict[str, NDArray[np.float64]]:
    return {
        f"{group}/{name}": dataset[:]
        for group in _DATA_GROUPS
        for name, dataset in file.get(group, {}).items()
    }


def _read_summary(folder: Path, status: str) -> dict[str, Any]:
    path = folder / "summary.json"
    if status == "running" or not path.exists():
        return {"status": status}
    summary: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return summary


def save_run(result: Result, folder: str | os.PathLike[str]) -> Path:
    """Write a result as a run folder; see `Result.save`."""
    import h5py

    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with h5py.File(folder / "results.h5", "w") as file:
        _write_results(file, result)
    (folder / "scene.yaml").write_text(result.scenario.to_yaml(), encoding="utf-8")
    summary = json.dumps(result.summary, indent=2, ensure_ascii=False)
    (folder / "summary.json").write_text(summary + "\n", encoding="utf-8")
    return folder


def _write_results(file: h5py.File, result: Result) -> None:
    model = result.model
    file.attrs["format_version"] = np.int64(_FORMAT_VERSION)
    file.attrs["der_version"] = __version__
    file.attrs["status"] = result.status
    file.attrs["title"] = result.scenario.title
    file.attrs["analysis"] = result.scenario.analysis
    file.attrs["model"] = model.name
    file.attrs["dimension"] = np.int64(model.dimension)
    _write(file, "scene", _fixed_text(result.scenario.to_yaml()), "")
    _write(file, "time", result.times, "s")
    _write(file, "step", result.steps, "")
    _write(file, "positions", result.positions, "m")
    _write(file, "velocities", result.velocities, "m/s")
    for group_name, columns in (("energies", result.energies), ("work", result.work)):
        group = file.create_group(group_name)
        for name, values in columns.items():
            _write(group, name, values, "J")
    probes = file.create_group("probes")
    for name, probe in result.probes.items():
        _write(probes, name, np.asarray(probe), probe.unit)
    for name, values in result.data.items():
        _write(file, name, values, DATA_UNITS.get(name, ""))
    rods = file.create_group("rods")
    for rod in result.rods:
        _write_rod(rods.create_group(rod.name), rod)


def _write_rod(group: h5py.Group, rod: Rod) -> None:
    _write(group, "nodes", rod.nodes, "")
    _write(group, "arc_length", rod.arc_lengths, "m")
    _write(group, "rest_turning_angle", rod.rest_turning_angles, "rad")
    _write(group, "sphere_radius", rod.sphere_radii, "m")
    group.attrs["curvature"] = rod.curvature
    group.attrs["radius"] = rod.radius
    group.attrs["EA"] = rod.EA
    group.attrs["EI"] = rod.EI


def _fixed_text(text: str) -> NDArray[np.bytes_]:
    """Return a text as der_run writes it, of fixed length, which every reader knows."""
    import h5py

    data = text.encode()
    return np.array(data, dtype=h5py.string_dtype("utf-8", len(data)))


def _write(group: h5py.Group, name: str, data: NDArray[Any], unit: str) -> None:
    group.create_dataset(name, data=data).attrs["unit"] = unit
