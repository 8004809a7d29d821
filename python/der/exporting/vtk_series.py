"""VTK: files for each frame and ``.pvd`` that ParaView opens as a series over time.

``rods.pvd`` has the rods as lines, ``sections.pvd`` as the surfaces that their sections sweep.

Written with pyevtk, which needs nothing but NumPy; VTK's own package would be a hundred times its
size, and meshio does not write series over time.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from der._core import Rod
from der.actuated_stretches import ActuatedStretch, actuated_stretches
from der.fields import RodFields, along_line, rod_fields
from der.film import mode_shapes
from der.progress import ProgressFunction
from der.run_data import RunData
from der.sections import Section, directors_along, sections_of, swept

Array = NDArray[np.float64]
#: Values or vectors (their x, y and z) at all points, by name.
PointData = dict[str, Array | tuple[Array, ...]]


def write_vtk(result: RunData, out: Path, progress: ProgressFunction) -> list[Path]:
    """Write ``rods.pvd``, ``sections.pvd`` and the frames in ``frames/``; see `der.export`.

    Each rod is a polyline with points of its own, also where rods share a node. Surfaces have the
    data of the nodes at which their corners stand; a run whose rods are all given by stiffnesses
    has none. Files of an earlier export into the same folder are replaced.
    """
    try:
        from pyevtk.hl import unstructuredGridToVTK
        from pyevtk.vtk import VtkGroup, VtkPolygon, VtkPolyLine
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            "VTK output requires the package pyevtk: pip install pyevtk"
        ) from None
    frames = out / "frames"
    frames.mkdir(parents=True, exist_ok=True)
    for old in [*frames.glob("rods_*.vtu"), *frames.glob("sections_*.vtu")]:
        old.unlink()
    (out / "sections.pvd").unlink(missing_ok=True)
    rods = rod_fields(result)
    sizes = np.array([len(fields.rod.line_nodes) for fields in rods])
    sections, directors = sections_of(result), directors_along(result)
    surfaces = _Surfaces(sections, [fields.rod for fields in rods])
    actuated = actuated_stretches(result)
    lines = np.full(len(rods), VtkPolyLine.tid, dtype=np.uint8)
    # A path has no time: its frames are numbered.
    times = result.times if result.path is None else np.arange(len(result.times), dtype=np.float64)
    names = ["rods", "sections"] if surfaces.rods else ["rods"]
    groups = {name: VtkGroup(str(out / name)) for name in names}
    digits = len(str(len(times) - 1))
    for frame, time in enumerate(times.tolist()):
        at_nodes = (
            _point_data(rods, frame)
            | _section_data(sections, directors, rods, frame)
            | _mode_data(result, rods)
            | _actuation_data(actuated, rods, frame)
        )
        at_frame = _field_data(result, frame, time)
        path = unstructuredGridToVTK(
            str(frames / f"rods_{frame:0{digits}d}"),
            *_in_space(np.vstack([fields.positions[frame] for fields in rods])),
            connectivity=np.arange(sizes.sum(), dtype=np.int32),
            offsets=np.cumsum(sizes, dtype=np.int32),
            cell_types=lines,
            cellData={"rod": np.arange(len(rods), dtype=np.int32)},
            pointData=at_nodes,
            fieldData=at_frame,
        )
        groups["rods"].addFile(path, time)
        if surfaces.rods:
            path = unstructuredGridToVTK(
                str(frames / f"sections_{frame:0{digits}d}"),
                *_columns(
                    surfaces.corners([rod.positions[frame] for rod in rods], directors, frame)
                ),
                connectivity=surfaces.connectivity,
                offsets=surfaces.offsets,
                cell_types=np.full(len(surfaces.offsets), VtkPolygon.tid, dtype=np.uint8),
                cellData={"rod": surfaces.cell_rods},
                pointData=surfaces.carried(at_nodes),
                fieldData=at_frame,
            )
            groups["sections"].addFile(path, time)
        progress((frame + 1) / len(times))
    for group in groups.values():
        group.save()
    return [out / f"{name}.pvd" for name in names]


class _Surfaces:
    """The polygons that the sections of rods sweep; their corners move, their cells do not.

    Attributes
    ----------
    rods
        Numbers of the rods whose section has a shape.
    nodes
        The node, counted along all rods, at which each corner stands, shape (corners,).
    connectivity, offsets
        The polygons as VTK has them: the sides of each edge, and the two ends of each open rod.
    cell_rods
        The rod of each polygon.
    """

    def __init__(self, sections: list[Section | None], rods: list[Rod]) -> None:
        sizes = [len(rod.line_nodes) for rod in rods]
        self._outlines = [None if section is None else section.outline for section in sections]
        self.rods = [number for number, one in enumerate(self._outlines) if one is not None]
        nodes, cells, owners = [np.zeros(0, dtype=np.int64)], [], []
        corner = 0  # the first of the rod
        for number, (outline, size) in enumerate(zip(self._outlines, sizes, strict=True)):
            if outline is None:
                continue
            around = len(outline)
            nodes.append(np.repeat(sum(sizes[:number]) + np.arange(size), around))
            numbers = corner + np.arange(size * around).reshape(size, around)
            beside = np.roll(numbers, -1, axis=1)
            wide = np.any(np.roll(outline, -1, axis=0) != outline, axis=1)  # sides with a length
            sides = np.stack([numbers[:-1], beside[:-1], beside[1:], numbers[1:]], axis=2)
            ends = [] if rods[number].closed else [numbers[0, ::-1], numbers[-1]]
            own = [*sides[:, wide].reshape(-1, 4), *ends]
            cells += own
            owners += [number] * len(own)
            corner += size * around
        self.nodes = np.concatenate(nodes)
        self.connectivity = np.concatenate(cells or [np.zeros(0)]).astype(np.int32)
        self.offsets = np.cumsum([len(cell) for cell in cells], dtype=np.int32)
        self.cell_rods = np.array(owners, dtype=np.int32)

    def corners(self, lines: list[Array], directors: list[Array | None], frame: int) -> Array:
        """Return the corners at a frame [m], shape (corners, 3), the rods being at `lines`."""
        found = []
        for number in self.rods:
            outline, across = self._outlines[number], directors[number]
            assert outline is not None
            line = np.column_stack(_in_space(lines[number]))
            here = None if across is None else across[min(frame, len(across) - 1)]
            found.append(swept(line, here, outline).reshape(-1, 3))
        return np.vstack(found)

    def carried(self, at_nodes: PointData) -> PointData:
        """Return the data of the nodes at the corners."""
        return {
            name: tuple(part[self.nodes] for part in values)
            if isinstance(values, tuple)
            else values[self.nodes]
            for name, values in at_nodes.items()
        }


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


def _section_data(
    sections: list[Section | None],
    directors: list[Array | None],
    rods: list[RodFields],
    frame: int,
) -> PointData:
    """Return the sizes of the sections [m], and the director of the width.

    Sizes that are not known are 0; only the model ``spatial`` has a director.
    """
    counts = [len(fields.rod.line_nodes) for fields in rods]
    sizes = [(0.0, 0.0) if one is None else (one.width, one.height) for one in sections]
    width, height = np.repeat(np.array(sizes), counts, axis=0).T
    data: PointData = {"width": width.copy(), "height": height.copy()}
    known = [across[frame] for across in directors if across is not None and len(across[0]) > 1]
    if len(known) == len(rods):
        data["director"] = _columns(np.vstack(known))
    return data


def _mode_data(result: RunData, rods: list[RodFields]) -> PointData:
    """Return the displacements of each mode as vectors, which ParaView warps the rods by."""
    return {
        f"mode_{number}": _in_space(np.vstack([shape[fields.rod.line_nodes] for fields in rods]))
        for number, shape in enumerate(mode_shapes(result), 1)
    }


def _actuation_data(
    stretches: list[ActuatedStretch], rods: list[RodFields], frame: int
) -> PointData:
    """Return what each actuation adds to the rest shape at the nodes, also those at its ends."""
    data: PointData = {}
    for stretch in stretches:
        profile = np.concatenate(
            [
                stretch.profile_at(fields.rod.line_arc_lengths) * (fields.rod.name == stretch.rod)
                for fields in rods
            ]
        )
        values = np.atleast_1d(stretch.values[frame])
        names = [""] if len(values) == 1 else ["_k1", "_k2"]
        for name, value in zip(names, values.tolist(), strict=True):
            data[f"actuation_{stretch.name}{name}"] = value * profile
    return data


def _field_data(result: RunData, frame: int, time: float) -> dict[str, Array]:
    data = {"TimeValue": np.array([time])}
    if result.path is not None:
        data["load_factor"] = result.path.factor[frame : frame + 1].copy()
        data["branch"] = result.path.branch[frame : frame + 1].astype(np.float64)
    return data


def _columns(vectors: Array) -> tuple[Array, ...]:
    """Return x, y and z of vectors in space, shape (points, 3), each contiguous."""
    return tuple(np.ascontiguousarray(column) for column in vectors.T)


def _in_space(rows: Array) -> tuple[Array, ...]:
    """Return x, y and z of vectors, shape (points, dim), each contiguous; z is 0 in the plane."""
    columns = np.zeros((3, len(rows)))
    columns[: rows.shape[1]] = rows.T
    return tuple(columns)
