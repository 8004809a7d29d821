"""Exports: what other programs read is what the engine computed."""

import csv
import subprocess
import sys
import xml.etree.ElementTree as ET

import der
import numpy as np
import pytest
from der.fields import fields_of


def probes_at(scene, nodes):
    """Add a probe of each quantity at some nodes of the first rod."""
    rod = scene["rods"][0]["name"]
    for quantity in ("vx", "vy", *fields_of(der.Model(der.Scenario.from_dict(scene)))):
        for node in nodes:
            scene["output"]["probes"][f"{quantity}-{node}"] = {
                "rod": rod,
                "at": {"node": node},
                "quantity": quantity,
            }
    return scene


def read_table(path):
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], rows[1:]


def test_csv(swing, tmp_path):
    result = der.run(probes_at(swing, [0, 4]))
    nodes, probes = result.export("csv", tmp_path / "tables")
    titles, rows = read_table(nodes)
    assert titles == [
        *("frame", "time [s]", "rod", "node", "s [m]", "x [m]", "y [m]", "vx [m/s]", "vy [m/s]"),
        *(
            f"{name} [{one.unit}]" if one.unit else name
            for name, one in fields_of(result.model).items()
        ),
    ]
    assert {"curvature [1/m]", "strain", "tension [N]", "speed [m/s]"} < set(titles)
    assert len(rows) == len(result.times) * 11
    for frame in (0, 7, len(result.times) - 1):
        for node in (0, 4):
            row = rows[frame * 11 + node]
            assert row[:4] == [str(frame), repr(float(result.times[frame])), "arm", str(node)]
            values = [float(value) for value in row[4:]]
            assert values[1:3] == pytest.approx(result.positions[frame, node])
            for column, name in enumerate(("vx", "vy", *fields_of(result.model)), 3):
                known = result.probes[f"{name}-{node}"][frame]
                scale = np.abs(result.probes[f"{name}-{node}"]).max()
                assert values[column] == pytest.approx(known, rel=1e-9, abs=1e-9 * scale + 1e-12)
    titles, rows = read_table(probes)
    assert titles[:3] == ["frame", "time [s]", "tip [m]"]
    assert [float(row[2]) for row in rows] == np.asarray(result.probes["tip"]).tolist()


def test_csv_of_paths_and_modes(tube, tmp_path):
    path = der.continuation(tube)
    nodes, probes = path.export("csv", tmp_path)
    assert read_table(nodes)[0][:3] == ["frame", "branch", "load factor"]
    assert [float(row[2]) for row in read_table(probes)[1]] == path.path.factor.tolist()
    del tube["time"], tube["output"]["every"]
    tube["analysis"] = {"modes": {"count": 2}}
    result = der.run(tube)
    *_, modes = result.export("csv", tmp_path)
    titles, rows = read_table(modes)
    shapes = ["dx [kg^-1/2]", "dy [kg^-1/2]"]
    assert titles == ["mode", "frequency [Hz]", "rod", "node", "s [m]", *shapes]
    assert len(rows) == 2 * 21
    assert float(rows[21 + 5][1]) == result.modes.frequencies[1]
    assert [float(value) for value in rows[21 + 5][5:]] == result.modes.shapes[1, 5].tolist()
    tube["analysis"] = {"buckling": {"count": 2}}
    tube["loads"] = [{"point_force": {"rod": "beam", "at": "end", "force": [-1, 0]}}]
    *_, modes = der.run(tube).export("csv", tmp_path)
    assert read_table(modes)[0][-2:] == ["dx [1]", "dy [1]"]


def test_npz(swing, tmp_path):
    result = der.run(probes_at(swing, [0, 4]))
    (path,) = der.export(result, "npz", tmp_path / "deep" / "run")
    assert path == tmp_path / "deep" / "run.npz"
    with np.load(path) as arrays:
        assert np.array_equal(arrays["positions"], result.positions)
        assert np.array_equal(arrays["velocities"], result.velocities)
        assert np.array_equal(arrays["times"], result.times)
        assert np.array_equal(arrays["probes/tip"], np.asarray(result.probes["tip"]))
        assert str(arrays["units/probes/tip"]) == "m"
        assert np.array_equal(arrays["energies/bend"], result.energies["bend"])
        for name in fields_of(result.model):
            known = result.probes[f"{name}-4"]
            scale = np.abs(known).max()
            assert arrays[f"rods/arm/{name}"][:, 4] == pytest.approx(known, abs=1e-8 * scale)
        again = der.Scenario.parse(str(arrays["scene"]))
        units = {key: str(arrays[f"units/{key}"]) for key in ("times", "positions", "velocities")}
        assert units == {"times": "s", "positions": "m", "velocities": "m/s"}
        assert str(arrays["units/energies/bend"]) == str(arrays["units/work/loads"]) == "J"
        for name, unit in {"arc_lengths": "m", "radius": "m", "edge_tension": "N"}.items():
            assert f"rods/arm/{name}" in arrays.files
            assert str(arrays[f"units/{name}"]) == unit
        without = {"scene", "status"}
        for key in set(arrays.files) - without:
            if not key.startswith("units/"):
                name = key.rpartition("/")[2] if key.startswith("rods/") else key
                assert f"units/{name}" in arrays.files
    assert again.to_dict() == result.scenario.to_dict()


def read_vtk(path):
    """Read a frame with VTK's own reader."""
    vtk_io = pytest.importorskip("vtkmodules.vtkIOXML")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader = vtk_io.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    data = grid.GetPointData()
    points = vtk_to_numpy(grid.GetPoints().GetData())
    arrays = {
        data.GetArrayName(i): vtk_to_numpy(data.GetArray(i))
        for i in range(data.GetNumberOfArrays())
    }
    cells = [
        [grid.GetCell(c).GetPointId(k) for k in range(grid.GetCell(c).GetNumberOfPoints())]
        for c in range(grid.GetNumberOfCells())
    ]
    return points, arrays, cells


def series(path):
    """Return times and files of a .pvd."""
    return [
        (float(entry.get("timestep")), path.parent / entry.get("file"))
        for entry in ET.parse(path).getroot().iter("DataSet")
    ]


def test_vtk_is_read_by_vtk(swing, tmp_path):
    pytest.importorskip("pyevtk")
    swing["rods"].append(
        {**swing["rods"][0], "name": "other", "nodes": 7, "from": [0, 1], "to": [2, 1]}
    )
    result = der.run(probes_at(swing, [0, 4]))
    path, _ = result.export("vtk", tmp_path / "vtk")
    frames = series(path)
    assert [time for time, _ in frames] == pytest.approx(result.times)
    for frame in (0, 7, len(frames) - 1):
        points, arrays, cells = read_vtk(frames[frame][1])
        assert cells == [list(range(11)), list(range(11, 18))]
        assert points[:, :2] == pytest.approx(result.positions[frame])
        assert np.all(points[:, 2] == 0.0)
        assert arrays["velocity"][:, :2] == pytest.approx(result.velocities[frame])
        assert arrays["radius"] == pytest.approx(np.full(18, 0.01))
        assert np.array_equal(arrays["twist"], np.zeros(18))
        for name in fields_of(result.model):
            for node in (0, 4):
                known = result.probes[f"{name}-{node}"]
                scale = np.abs(known).max()
                assert arrays[name][node] == pytest.approx(known[frame], abs=1e-8 * scale)


def test_vtk_has_the_directors_as_vectors(helix, tmp_path):
    pytest.importorskip("pyevtk")
    result = der.run(helix)
    path, _ = result.export("vtk", tmp_path)
    points, arrays, _ = read_vtk(series(path)[-1][1])
    assert points == pytest.approx(result.positions[-1])
    directors = result.directors[-1]
    assert arrays["director"].shape == (9, 3)
    assert arrays["director"][[0, -1]] == pytest.approx(directors[[0, -1]])
    means = directors[1:] + directors[:-1]
    means /= np.linalg.norm(means, axis=1, keepdims=True)
    assert arrays["director"][1:-1] == pytest.approx(means)
    assert np.abs(arrays["twist"]).max() > 0.1


def test_vtk_replaces_an_earlier_export_and_has_modes(swing, tmp_path):
    pytest.importorskip("pyevtk")
    der.run(swing).export("vtk", tmp_path)
    before = len(list((tmp_path / "frames").iterdir()))
    del swing["time"], swing["output"]["every"]
    swing["analysis"] = {"modes": {"count": 2}}
    result = der.run(swing)
    path, _ = result.export("vtk", tmp_path)
    assert before > len(list((tmp_path / "frames").glob("rods_*"))) == len(series(path)) == 1
    _, arrays, _ = read_vtk(series(path)[0][1])
    assert arrays["mode_2"][:, :2] == pytest.approx(result.modes.shapes[1])


def test_vtk_of_a_path_counts_its_points(tube, tmp_path):
    pytest.importorskip("pyevtk")
    result = der.continuation(tube)
    for path in result.export("vtk", tmp_path):
        assert [time for time, _ in series(path)] == list(range(len(result.times)))


def test_vtk_has_the_surfaces_of_the_sections(helix, tmp_path):
    """A strip has four long sides and two ends, as wide and as high as the section is."""
    pytest.importorskip("pyevtk")
    result = der.run(helix)
    shape = result.scenario.to_dict()["rods"][0]["cross_section"]["rectangle"]
    lines, surfaces = result.export("vtk", tmp_path)
    assert surfaces.name == "sections.pvd"
    assert [time for time, _ in series(surfaces)] == pytest.approx(result.times)
    points, arrays, cells = read_vtk(series(surfaces)[-1][1])
    assert [len(cell) for cell in cells] == [4] * 4 * 8 + [8, 8]
    # The edge at a clamp starts from a pivot: it is nearly across the director that is saved.
    directors, middle = result.directors[-1], result.positions[-1]
    ring = points[:8]  # of the first node: each corner twice
    assert ring.mean(axis=0) == pytest.approx(middle[0])
    assert np.ptp(ring @ directors[0]) == pytest.approx(shape["width"], rel=1e-3)
    tangent = (middle[1] - middle[0]) / np.linalg.norm(middle[1] - middle[0])
    assert np.ptp(ring @ np.cross(tangent, directors[0])) == pytest.approx(
        shape["height"], rel=1e-3
    )
    _, at_nodes, _ = read_vtk(series(lines)[-1][1])
    for name in ("curvature", "width", "height", "director"):
        assert np.array_equal(arrays[name], np.repeat(at_nodes[name], 8, axis=0)), name
    assert at_nodes["width"] == pytest.approx(np.full(9, shape["width"]))


def test_vtk_of_stiffnesses_has_lines_alone(swing, tmp_path):
    pytest.importorskip("pyevtk")
    der.run(swing).export("vtk", tmp_path)
    swing["rods"][0]["cross_section"] = {
        "stiffness": {"EA": 3e3, "EI": 0.08, "mass_per_length": 0.3}
    }
    del swing["rods"][0]["material"]
    result = der.run(swing)
    (path,) = result.export("vtk", tmp_path)
    assert path.name == "rods.pvd"
    assert not (tmp_path / "sections.pvd").exists(), "that of an earlier export"
    _, arrays, _ = read_vtk(series(path)[-1][1])
    assert not arrays["width"].any()


def test_mistakes(spheres, tmp_path, monkeypatch):
    result = der.run(spheres)
    with pytest.raises(ValueError, match="'xls'; there are csv, npz, vtk"):
        result.export("xls", tmp_path)
    monkeypatch.setitem(sys.modules, "pyevtk.hl", None)
    with pytest.raises(ModuleNotFoundError, match="pip install pyevtk"):
        result.export("vtk", tmp_path)


@pytest.mark.parametrize(
    ("format", "files"),
    [
        ("csv", ["csv/nodes.csv", "csv/probes.csv"]),
        ("npz", ["run.npz"]),
        ("vtk", ["vtk/rods.pvd", "vtk/sections.pvd"]),
    ],
)
def test_command(swing, tmp_path, format, files):
    if format == "vtk":
        pytest.importorskip("pyevtk")
    folder = tmp_path / "run"
    der.run(swing, out=folder)
    command = [sys.executable, "-m", "der", "export", str(folder), "--format", format]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [str(folder / name) for name in files]
    assert all((folder / name).exists() for name in files)
