"""Results of modes, buckling and continuation: their pictures, and saved runs read back."""

import os
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import der
import h5py
import matplotlib.pyplot as plt
import numpy as np
import pytest

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))

COLUMN = {
    "title": "Column",
    "rods": [
        {
            "name": "rod",
            "nodes": 21,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"stiffness": {"EA": 1e6, "EI": 1, "mass_per_length": 1}},
        }
    ],
    "supports": [
        {"rod": "rod", "at": "start", "fix": ["x", "y"]},
        {"rod": "rod", "at": "end", "fix": ["y"]},
    ],
    "loads": [{"point_force": {"rod": "rod", "at": "end", "force": [-1, 0]}}],
    "output": {
        "probes": {
            "middle": {"rod": "rod", "at": "middle", "quantity": "y"},
            "end": {"rod": "rod", "at": "end", "quantity": "x"},
        }
    },
}
ANALYSES = {
    "modes": {"modes": {"count": 3}},
    "buckling": {"buckling": {"count": 2}},
    "continuation": {"continuation": {"to": 12, "branches": 1}},
}


@pytest.fixture(autouse=True)
def close_figures():
    yield
    plt.close("all")


@pytest.fixture(scope="module", params=ANALYSES)
def result(request):
    return der.run({**COLUMN, "analysis": ANALYSES[request.param]})


@pytest.fixture(scope="module")
def path():
    return der.run({**COLUMN, "analysis": ANALYSES["continuation"]})


def found(result):
    """The result's own part of the three: modes, buckling modes or path."""
    parts = [part for part in (result.modes, result.buckling, result.path) if part is not None]
    assert len(parts) == 1
    return parts[0]


def check_same(a, b):
    assert type(a) is type(b)
    for field in fields(a):
        assert np.array_equal(getattr(a, field.name), getattr(b, field.name)), field.name


def test_a_saved_run_is_read_back_with_its_data(result, tmp_path):
    again = der.open_run(result.save(tmp_path / "saved"))
    assert set(again.data) == set(result.data)
    check_same(found(again), found(result))
    assert np.array_equal(again.positions, result.positions)
    assert again.summary == result.summary


def test_a_folder_of_der_run_holds_the_same(result, tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(result.scenario.to_yaml())
    out = tmp_path / "run"
    subprocess.run([DER_RUN, scene, "--out", out, "--quiet"], check=True)
    check_same(found(der.open_run(out)), found(result))
    # Saved from Python, the arrays have the same units.
    saved = result.save(tmp_path / "saved")
    with h5py.File(out / "results.h5") as of_run, h5py.File(saved / "results.h5") as of_python:
        for name in result.data:
            assert of_python[name].attrs["unit"] == of_run[name].attrs["unit"], name


@pytest.mark.parametrize(("kind", "labels"), [("modes", "Hz"), ("buckling", "load factor")])
def test_modes_are_drawn_to_scale_of_the_structure_each_in_its_panel(kind, labels):
    result = der.run({**COLUMN, "analysis": ANALYSES[kind]})
    figure = result.plot()
    figure.canvas.draw()
    shapes = found(result).shapes
    assert len(figure.axes) == len(shapes)
    for axes, shape in zip(figure.axes, shapes, strict=True):
        assert labels in axes.texts[-1].get_text()
        solid = [line for line in axes.lines if line.get_linestyle() == "-"]
        drawn = solid[-1].get_xydata() - result.positions[-1]
        assert np.abs(drawn).max() == pytest.approx(0.12, rel=1e-5)
        assert np.abs(shape / np.abs(shape).max() - drawn / np.abs(drawn).max()).max() < 1e-9


def test_a_path_is_drawn_against_each_probe_with_its_events_and_its_stability(path):
    left, right = path.plot().axes
    assert (left.get_xlabel(), right.get_xlabel()) == ("middle [m]", "end [m]")
    assert left.get_ylabel() == "load factor"
    (bifurcation,) = (line for line in left.lines if line.get_label() == "bifurcation")
    rows = np.flatnonzero(path.path.events == "bifurcation")
    assert np.array_equal(bifurcation.get_ydata(), path.path.factor[rows])
    lines = [line for line in left.lines if len(line.get_xdata()) > 1]
    dashed = [line for line in lines if line.get_linestyle() == "--"]
    assert dashed, "the straight column above its buckling load is unstable"
    for line in dashed:
        assert np.abs(line.get_xdata()).max() < 1e-6
        assert line.get_ydata().min() > 9.8
    ends = {np.sign(line.get_xdata()[-1]) for line in lines if line.get_linestyle() == "-"}
    assert {-1.0, 1.0} <= ends, "it buckles to both sides"


def test_unstable_paths_look_unstable_where_shapes_are_mirror_images():
    """Dashes upon dashes would make a solid line."""
    arch = Path(__file__).resolve().parents[2] / "configs/snap_through_arch.yaml"
    for axes in der.run(arch).plot().axes:
        dashed = [
            line for line in axes.lines if line.get_linestyle() == "--" and line.get_xydata().size
        ]
        solid = [
            line for line in axes.lines if line.get_linestyle() == "-" and line.get_xydata().size
        ]
        assert max(line.get_linewidth() for line in dashed) < 0.6 * solid[0].get_linewidth()
        size = np.array([np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())])
        for line in dashed:
            points = line.get_xydata() / size
            point = points[len(points) // 3]
            for other in dashed:
                if other is line:
                    continue
                ends = other.get_xydata() / size
                share = np.linspace(0, 1, 20)[:, np.newaxis, np.newaxis]
                between = ends[:-1] + share * np.diff(ends, axis=0)
                assert np.linalg.norm(between - point, axis=2).min() > 3e-3
    assert len(dashed) > 2, "against the quarter point the skew branches are apart"


def test_a_path_without_probes_says_what_to_add(path):
    scene = {**COLUMN, "analysis": ANALYSES["continuation"]}
    del scene["output"]
    with pytest.raises(ValueError, match=r"add some under output\.probes"):
        der.run(scene).plot()


@pytest.mark.parametrize("vary", ["loads", "loads.0", "loads.1"])
def test_energy_probes_along_a_continuation_weigh_with_its_factor(vary):
    """-sum of m g . x with the gravity of each point, by the shapes and the masses of nodes."""
    gravity = np.array([3.0, -4.0])
    loads = [{"gravity": gravity.tolist()}, *COLUMN["loads"]]
    probes = {
        f"{quantity}_{where}": {"quantity": f"{quantity}_energy"} | at
        for quantity in ("gravity", "elastic", "total")
        for where, at in (("all", {}), ("rod", {"rod": "rod"}))
    }
    scene = der.Scenario.from_dict(
        {**COLUMN, "loads": loads, "output": {"probes": probes}, "analysis": "static"}
    )
    result = der.continuation(scene, vary=vary, to=2.0)
    acting = np.ones_like(result.path.factor) if vary == "loads.1" else result.path.factor
    lifted = result.positions @ -gravity  # of each node, for each mass
    exact = acting * (lifted @ der.Simulation(scene).node_masses)
    assert np.ptp(exact) > 1e-3
    for where in ("all", "rod"):
        weight = np.asarray(result.probes[f"gravity_{where}"])
        total = np.asarray(result.probes[f"total_{where}"])
        assert weight == pytest.approx(exact, abs=1e-12)
        assert total == pytest.approx(exact + result.probes[f"elastic_{where}"], abs=1e-12)
    assert result.energies["gravity"] == pytest.approx(exact, abs=1e-12)
