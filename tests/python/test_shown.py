"""Objects that show themselves: probes as a table, cards for notebooks, tables of pandas, views."""

import base64
import io
import pickle
import re
import sys
from pathlib import Path

import der
import matplotlib.pyplot as plt
import numpy as np
import pytest
from der.html import card
from der.tables import text_table
from matplotlib.image import imread

UNSAFE = '<script>alert(1)</script> & "quotes"'
LOAD = "loads.0.point_force.force.1"


def pictures(html):
    """The pictures of a card as bytes."""
    found = re.findall(r'src="data:image/png;base64,([^"]+)"', html)
    return [base64.b64decode(data) for data in found]


def cells(html):
    """The cells of all tables of a card, row by row."""
    rows = re.findall(r"<tr>(.*?)</tr>", html)
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]


@pytest.fixture(scope="module")
def result():
    return der.run("example:simply_supported")


def test_probes_print_as_a_table(result):
    header, *rows = str(result.probes).splitlines()
    assert header.split() == ["probe", "unit", "final", "min", "max"]
    assert [row.split()[0] for row in rows] == list(result.probes)
    for row, probe in zip(rows, result.probes.values(), strict=True):
        values = [float(cell) for cell in row.split()[2:]]
        expected = [probe.summary[key] for key in ("final", "min", "max")]
        assert values == pytest.approx(expected, rel=1e-5)
        assert row.split()[1] == probe.unit == "m"
    assert cells(result.probes._repr_html_())[1] == rows[0].split()
    assert str(pickle.loads(pickle.dumps(result.probes))) == str(result.probes)
    with pytest.raises(KeyError, match="the scene has no probe 'tip'"):
        result.probes["tip"]


def test_probes_of_runs_without_any_and_of_runs_that_are_not_over(tube, tmp_path):
    del tube["output"]["probes"]
    assert str(der.run(tube).probes) == "no probes"
    folder = der.run("example:cantilever").save(tmp_path / "run")
    (folder / "summary.json").unlink()
    assert str(der.open_run(folder).probes).splitlines()[1].split() == ["tip_x", "m"]


@pytest.mark.parametrize(
    "name",
    ["beam_modes", "euler_buckling", "snap_through_arch", "simply_supported", "twisted_ring"],
)
def test_runs_scenarios_and_simulations_show_themselves(name):
    open_before = plt.get_fignums()
    scenario = der.load(f"example:{name}")
    simulation = der.Simulation(scenario)
    for thing in (scenario, simulation, simulation.run(warns=False)):
        html = thing._repr_html_()
        (picture,) = pictures(html)
        assert len(picture) < 60_000
        pixels = imread(io.BytesIO(picture), format="png")
        assert len(np.unique(pixels.reshape(-1, pixels.shape[-1]), axis=0)) > 20
        assert html.startswith(f"<div><div><strong>{scenario.title}</strong>")
        assert html.count("<div>") == html.count("</div>")
    assert plt.get_fignums() == open_before


def test_texts_are_escaped(tube):
    tube["title"] = UNSAFE
    scenario = der.Scenario.from_dict(tube)
    run = der.run(scenario)
    sweep = der.sweep(tube, {"rods.beam.nodes": [5, 7]})
    batch = der.Batch(tube, 2)
    for thing in (scenario, der.Simulation(scenario), run, sweep, batch):
        html = thing._repr_html_()
        assert "<script" not in html
        assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;quotes&quot;" in html


def test_a_card_has_what_it_is_given():
    html = card("A < B", "two rods", tables=[[["name"], ["x"]], [["empty"]]], text="a: <b>")
    assert cells(html) == [["name"], ["x"]]
    assert pictures(html) == []
    assert "<strong>A &lt; B</strong><br>two rods" in html
    assert "<pre>a: &lt;b&gt;</pre>" in html


def test_a_run_without_a_frame_has_no_picture(swing):
    swing["supports"] = []
    with pytest.raises(der.DerError) as caught:
        der.equilibrium(swing)
    html = caught.value.result._repr_html_()
    assert pictures(html) == []
    assert f"{caught.value.status}, 0 frames" in html


@pytest.mark.parametrize(
    ("analysis", "count"), [("buckling", 0), ("continuation", 1), ("modes", 1)]
)
def test_analyses_without_probes_or_modes(swing, analysis, count):
    """A rod that its weight pulls does not buckle."""
    swing["loads"] = [{"gravity": [9.81, 0]}]
    del swing["time"], swing["output"]
    run = der.run({**swing, "analysis": {analysis: {}}})
    assert len(pictures(run._repr_html_())) == count
    plt.close("all")


def test_text_tables_are_aligned():
    assert text_table([["a", "bcd"], ["ef", "g"]]) == ["a   bcd", "ef  g"]


def test_sweeps_show_their_first_members(tube):
    open_before = plt.get_fignums()
    tube["analysis"] = "static"
    del tube["time"], tube["output"]["every"]
    moduli = np.linspace(1e9, 2e9, 12)
    sweep = der.sweep(tube, {"rods.beam.material.youngs_modulus": [*moduli, -1.0]})
    html = sweep._repr_html_()
    header, *rows = cells(html)
    assert header == ["rods.beam.material.youngs_modulus", "status", "deflection", "roller"]
    assert len(rows) == 8
    assert float(rows[0][2]) == pytest.approx(sweep["deflection"][0], rel=1e-5)
    assert len(pictures(html)) == 1
    assert "13 members, 1 failed (invalid_scene 1)" in html
    assert plt.get_fignums() == open_before


def test_verifications_and_studies_show_themselves():
    open_before = plt.get_fignums()
    found = der.verify("example:cantilever", levels=2)
    assert repr(found).startswith(
        "<der.Verification of 'Cantilever with a tip load, P L^2 / EI = 1': "
    )
    header, *rows = cells(found._repr_html_())
    assert (header[:3], header[-1]) == (["probe", "value", "error"], "verdict")
    assert [row[0] for row in rows] == ["tip_x", "tip_y", "root_moment"]
    assert float(rows[1][1].split()[0]) == pytest.approx(found["tip_y"].value, rel=1e-5)
    study = der.study("example:cantilever", nodes=[11, 21])
    assert "2 configurations, probes: tip_x, tip_y, root_moment" in repr(study)
    html = study._repr_html_()
    assert len(pictures(html)) == 1
    assert [": ".join(row) for row in cells(html)[1:]] == study.advice()
    assert plt.get_fignums() == open_before


def test_analyses_and_recordings_say_what_they_are():
    assert repr(der.run("example:beam_modes").modes) == (
        "<der.Modes: 4 modes, 24.2609, 152.04, 425.718, 834.237 Hz>"
    )
    many = der.Simulation("example:cantilever")
    many.equilibrium()
    assert repr(many.modes(9)).startswith("<der.Modes: 9 modes, ")
    assert repr(many.modes(9)).endswith(", ... Hz>")
    path = der.run("example:snap_through_arch").path
    assert repr(path) == (
        f"<der.Path: {len(path.factor)} points on 3 branches, load factors "
        f"{path.factor.min():.6g} to {path.factor.max():.6g}, events: bifurcation 2, fold 2>"
    )
    simulation = der.Simulation("example:finger")
    recording = simulation.recording()
    simulation.step(10)
    recording.add()
    assert repr(recording) == (
        "<der.Recording of 'A soft finger closes and opens': 2 frames, t = 0 to 0.025 s>"
    )


def test_view_without_a_path_is_a_temporary_file(result, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("sys.platform", "linux")
    for screen in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(screen, raising=False)
    hidden = result.view()
    assert opened == []
    monkeypatch.setenv("DISPLAY", ":0")
    shown = result.view()
    assert opened == [shown.as_uri()]
    assert shown != hidden
    assert result.view(open=False) not in (shown, hidden)
    assert len(opened) == 1
    assert "Plotly" in Path(hidden).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["simply_supported", "snap_through_arch"])
def test_results_as_tables_of_pandas(name):
    pytest.importorskip("pandas")
    run = der.run(f"example:{name}")
    table = run.to_pandas()
    assert list(table.columns) == list(run.probes)
    assert table.attrs["units"] == {name: probe.unit for name, probe in run.probes.items()}
    index, title = (run.times, "time") if run.path is None else (run.path.factor, "load factor")
    assert table.index.name == title
    np.testing.assert_array_equal(table.index, index)
    for name, probe in run.probes.items():
        np.testing.assert_array_equal(table[name], probe)


def test_without_pandas(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ModuleNotFoundError, match=r"needs the package pandas: pip install"):
        result.to_pandas()
