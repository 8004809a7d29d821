"""VTK: one file for each frame and a ``.pvd`` that ParaView opens as a series over time.

Written with pyevtk, which needs nothing but NumPy; VTK's own package would be a hundred times its
size, and meshio does not write series over time.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from der.fields import RodFields, along_line, rod_fields
from der.film import mode_shapes
from der.progress import ProgressFunction
from der.run_data import RunData

Array = NDArray[np.float64]
#: Values or vectors (their x, y and z) at all points, by name.
PointData = dict[str, Array | tuple[Array, ...]]


def write_vtk(result: RunData, out: Path, progress: ProgressFunction) -> list[Path]:
    """Write ``rods.pvd`` and the frames beside it in ``frames/``; see `der.export`.

    Each rod is a polyline with points of its own, also where rods share a node. Files of an earlier
    export into the same folder are replaced.
    """
    try:
        from pyevtk.hl import unstructuredGridToVTK
        from pyevtk.vtk import VtkGroup, VtkPolyLine
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            "VTK output requires the package pyevtk: pip install pyevtk"
        ) from None
    frames = out / "frames"
    frames.mkdir(parents=True, exist_ok=True)
    for old in frames.glob("rods_*.vtu"):
        old.unlink()
    rods = rod_fields(result)
    sizes = np.array([len(fields.rod.line_nodes) for fields in rods])
    lines = np.full(len(rods), VtkPolyLine.tid, dtype=np.uint8)
    # A path has no time: its frames are numbered.
    times = result.times if result.path is None else np.arange(len(result.times), dtype=np.float64)
    group = VtkGroup(str(out / "rods"))
    digits = len(str(len(times) - 1))
    for frame, time in enumerate(times.tolist()):
        path = unstructuredGridToVTK(
            str(frames / f"rods_{frame:0{digits}d}"),
            *_in_space(np.vstack([fields.positions[frame] for fields in rods])),
            connectivity=np.arange(sizes.sum(), dtype=np.int32),
            offsets=np.cumsum(sizes, dtype=np.int32),
            cell_types=lines,
            cellData={"rod": np.arange(len(rods), dtype=np.int32)},
            pointData=_point_data(rods, frame)
            | _section_data(result, rods, frame)
            | _mode_data(result, rods),
            fieldData=_field_data(result, frame, time),
        )
        group.addFile(path, time)
        progress((frame + 1) / len(times))
    group.save()
    return [out / "rods.pvd"]


def _point_data(rods: list[RodFields], frame: int) -> PointData:
    data: PointData = {
        name: np.concatenate([fields.at_nodes[name][frame] for fields in rods])
        for name in rods[0].at_nodes
    }
    # Without sections rods do not twist: 0 [rad/m], for programs that read it of all rods.
    data.setdefault("twist", np.zeros(sum(len(fields.rod.line_nodes) for fields in rods)))
    data["velocity"] = _in_space(np.vstack([fields.velocities[frame] for fields in rods]))
    data["radius"] = np.concatenate(
        [np.full(len(fields.rod.line_nodes), fields.rod.radius) for fields in rods]
    )
    data["sphere_radius"] = np.concatenate(
        [along_line(fields.rod.sphere_radii, fields.rod) for fields in rods]
    )
    data["arc_length"] = np.concatenate([fields.rod.line_arc_lengths for fields in rods])
    return data


def _section_data(result: RunData, rods: list[RodFields], frame: int) -> PointData:
    """Return director 1 at the nodes: the mean of the two edges there, a unit vector."""
    if result.sections is None:
        return {}
    found = []
    first = 0  # edge of the rod
    for fields in rods:
        edges = result.directors[frame, first : first + len(fields.rod.line_nodes) - 1]
        first += len(edges)
        ends = edges[:1] + edges[-1:] if fields.rod.closed else None
        sums = np.vstack(
            [
                edges[:1] if ends is None else ends,
                edges[:-1] + edges[1:],
                edges[-1:] if ends is None else ends,
            ]
        )
        sizes = np.linalg.norm(sums, axis=1, keepdims=True)
        # Two opposite directors have no mean: the node has that of the edge after it.
        after = np.vstack([edges, edges[:1] if fields.rod.closed else edges[-1:]])
        found.append(np.where(sizes > 1e-9, sums / np.maximum(sizes, 1e-9), after))
    return {"director": _in_space(np.vstack(found))}


def _mode_data(result: RunData, rods: list[RodFields]) -> PointData:
    """Return the displacements of each mode as vectors, which ParaView warps the rods by."""
    return {
        f"mode_{number}": _in_space(np.vstack([shape[fields.rod.line_nodes] for fields in rods]))
        for number, shape in enumerate(mode_shapes(result), 1)
    }


def _field_data(result: RunData, frame: int, time: float) -> dict[str, Array]:
    data = {"TimeValue": np.array([time])}
    if result.path is not None:
        data["load_factor"] = result.path.factor[frame : frame + 1].copy()
        data["branch"] = result.path.branch[frame : frame + 1].astype(np.float64)
    return data


def _in_space(rows: Array) -> tuple[Array, ...]:
    """Return x, y and z of vectors, shape (points, dim), each contiguous; z is 0 in the plane."""
    columns = np.zeros((3, len(rows)))
    columns[: rows.shape[1]] = rows.T
    return tuple(columns)
