"""Actuated stretches in pictures, views and exports: where they are, and what they have there."""

import der
import matplotlib.pyplot as plt
import numpy as np
import pytest
from der.actuated_stretches import actuated_stretches
from der.plotting.style import ACTUATED, actuated_colour
from der.viewing.payload import make_payload
from matplotlib.colors import to_rgb
from PIL import Image

TABLE = {"times": [0.05, 0.15], "values": [1.0, -2.0]}


@pytest.fixture(autouse=True)
def close_figures():
    yield
    plt.close("all")


@pytest.fixture
def bent(swing):
    """The arm of 11 nodes on 1 m, bent on a part of it."""
    part = {"name": "bend", "rod": "arm", "from": 0.23, "to": 0.77}
    swing["actuation"] = [{**part, "natural_curvature": TABLE}]
    return swing


def band(axes, name="bend"):
    (found,) = (one for one in axes.collections if one.get_gid() == f"actuation-{name}")
    return found


def test_values_are_those_of_the_scene_at_each_frame(bent):
    bent["actuation"].append(
        {
            **{"name": "longer", "rod": "arm", "from": 0.5},
            "elongation": {"sine": {"amplitude": 0.1, "frequency": 5}},
        }
    )
    bent["actuation"].append({"name": "all", "rod": "arm", "natural_curvature": 0})
    result = der.run(bent)
    bend, longer, whole = actuated_stretches(result)
    assert bend.values == pytest.approx(np.interp(result.times, TABLE["times"], TABLE["values"]))
    assert bend.shares == pytest.approx(0.5 * bend.values)
    assert longer.values == pytest.approx(0.1 * np.sin(10 * np.pi * result.times))
    assert (longer.start, longer.end) == (0.5, pytest.approx(1.0))
    assert [one.level for one in (bend, longer, whole)] == [0, 1, 2]
    assert not np.any(whole.shares)
    last = len(result.times) - 1
    texts = [one.value_text(last) for one in (bend, longer, whole)]
    assert texts == ["curvature -2 1/m", "elongation 0", "curvature 0 1/m"]


def test_pairs_in_space(helix):
    pair = [{"times": [0, 0.04], "values": [0, 3]}, 4]
    helix["actuation"] = [{"name": "bend", "rod": "strip", "natural_curvature": pair}]
    result = der.run(helix)
    (bend,) = actuated_stretches(result)
    assert bend.values[[0, -1]] == pytest.approx(np.array([[0, 4], [3, 4]]))
    assert bend.shares[[0, -1]] == pytest.approx([0.8, 1.0])
    assert bend.value_text(0) == "curvature (0, 4) 1/m"


@pytest.mark.parametrize("vary", ["actuation", "actuation.1", "actuation.tip"])
def test_the_factor_of_a_path_scales_them(bent, vary):
    bent["actuation"][0]["natural_curvature"] = 1.0
    bent["actuation"].append({"name": "tip", "rod": "arm", "natural_curvature": 0.5})
    path = der.continuation(bent, vary=vary, to=2.0)
    other, tip = actuated_stretches(path)
    assert tip.values == pytest.approx(0.5 * path.path.factor)
    assert other.values[-1] == pytest.approx(2.0 if vary == "actuation" else 1.0)
    axes = path.plot("shapes").axes[0]
    assert "tip: curvature 1 1/m" in [text.get_text() for text in axes.get_legend().get_texts()]


@pytest.mark.parametrize("profile", ["constant", "linear", "smooth"])
def test_profiles_are_those_of_the_engine(bent, profile):
    """A free rod without loads has the natural curvature: read off by the engine, at the nodes."""
    bent["actuation"][0] |= {"natural_curvature": 0.5, "profile": profile, "from": 0.2}
    bent["loads"] = []
    result = der.equilibrium(bent)
    (bend,) = actuated_stretches(result)
    places, found = result.along("arm", "curvature")
    nodes = result.rods[0].arc_lengths
    after = np.searchsorted(places, nodes, side="right") - 1  # where it jumps, the value after it
    assert 0.5 * bend.profile_at(nodes) == pytest.approx(found[-1][after], abs=1e-9)
    assert bend.profile_at(np.array([0.77])) == {"smooth": pytest.approx(0)}.get(profile, 1.0)


def test_bands_lie_on_their_part_of_the_rod(bent):
    result = der.run(bent)
    axes = result.plot("shapes").axes[0]
    pieces = band(axes).get_segments()
    (rod,) = result.rods
    for at, point in ((0.23, pieces[0][0]), (0.77, pieces[-1][-1])):
        place = [np.interp(at, rod.arc_lengths, column) for column in result.positions[-1].T]
        assert point == pytest.approx(place)
    colours = band(axes).get_colors()[:, :3]
    assert colours == pytest.approx(np.tile(actuated_colour(0, negative=True), (len(pieces), 1)))
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[-1] == "bend: curvature -2 1/m"


def test_colours_tell_the_sign():
    full = np.array(to_rgb(ACTUATED[1]))
    assert actuated_colour(1, negative=False) == pytest.approx(full)
    assert np.all(np.array(actuated_colour(1, negative=True)) < full + 1e-9)
    assert actuated_colour(1 + len(ACTUATED), negative=False) == pytest.approx(full)


def test_what_is_never_positive_has_the_full_colour(bent):
    """The sign tells something only where both occur."""
    bent["actuation"][0]["natural_curvature"] = {"times": [0, 0.2], "values": [0, -2]}
    (bend,) = actuated_stretches(der.run(bent))
    assert bend.shares[[0, -1]] == pytest.approx([0.0, 1.0])


def test_widths_tell_the_value_in_the_picture_and_in_the_legend(bent):
    """From 0 to half the largest value the band grows as much as from there to the largest."""
    del bent["actuation"][0]["from"], bent["actuation"][0]["to"]
    bent["actuation"][0]["natural_curvature"] = {"times": [0, 0.2], "values": [0, 2]}
    widths = []
    for time in (0.0, 0.1, 0.2):
        axes = der.run(bent).plot("shapes", times=[time]).axes[0]
        (line,) = (
            one
            for one in axes.lines
            if one.get_gid() == "actuation-bend" and not len(one.get_xdata())
        )
        assert set(band(axes).get_linewidths()) == {line.get_linewidth()}
        assert band(axes).get_colors()[0, :3] == pytest.approx(to_rgb(line.get_color()))
        widths.append(line.get_linewidth())
    assert widths[0] > 0.0
    assert widths[1] - widths[0] == pytest.approx(widths[2] - widths[1])
    assert widths[2] > 2.0 * widths[0]


def test_bands_that_overlap_are_as_many_widths(bent):
    bent["actuation"].append({"name": "longer", "rod": "arm", "elongation": 0.1})
    axes = der.run(bent).plot("shapes").axes[0]
    inner, outer = band(axes), band(axes, "longer")
    assert outer.get_linewidths()[0] > inner.get_linewidths()[0]
    assert outer.get_zorder() < inner.get_zorder()


@pytest.mark.parametrize("analysis", ["static", {"modes": {"count": 2}}], ids=["static", "modes"])
def test_equilibria_and_modes_have_bands(bent, analysis):
    del bent["time"], bent["output"]["every"]
    bent["actuation"][0]["natural_curvature"] = 0.5
    result = der.run({**bent, "analysis": analysis})
    assert all(band(axes) for axes in result.plot("shapes").axes)


def test_animations_show_when_it_acts(bent, tmp_path):
    """There is the more pink the larger the value is."""
    bent["actuation"][0]["natural_curvature"] = {"times": [0.1, 0.2], "values": [0, 2]}
    path = der.run(bent).animate(tmp_path / "bend.gif", fps=10, speed=0.1)
    pink = []
    with Image.open(path) as image:
        for number in (0, image.n_frames - 1):
            image.seek(number)
            # The legend, above the axes, is left out.
            pixels = np.asarray(image.convert("RGB")).astype(int)[90:]
            off = np.abs(pixels - 255 * np.array(actuated_colour(0, negative=False))).max(axis=2)
            pink.append(int(np.sum(off < 12)))
    assert pink[1] > 500
    assert pink[1] > 2 * pink[0]


def test_the_page_has_the_bands(bent):
    bent["actuation"][0]["profile"] = "linear"
    data = make_payload(der.run(bent))
    (one,) = data["actuation"]
    assert (one["name"], one["rod"], one["level"]) == ("bend", 0, 0)
    places, shares, profile = zip(*one["points"], strict=True)
    assert (places[0], shares[0], profile[0]) == (2, pytest.approx(0.3), 0.0)
    assert (places[-1], shares[-1], profile[-1]) == (7, pytest.approx(0.7), pytest.approx(1.0))
    assert {7, 4} <= set(places)
    assert (one["sizes"][0], one["sizes"][-1]) == (0.5, -1.0)
    assert (one["texts"][0], one["texts"][-1]) == ("curvature 1 1/m", "curvature -2 1/m")
    assert make_payload(der.run({**bent, "actuation": []}))["actuation"] == []


def test_vtk_has_what_each_adds_at_the_nodes(bent, tmp_path):
    pytest.importorskip("pyevtk")
    vtk_io = pytest.importorskip("vtkmodules.vtkIOXML")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    bent["rods"].append({**bent["rods"][0], "name": "other", "from": [0, 1], "to": [1, 1]})
    path, _ = der.run(bent).export("vtk", tmp_path)
    reader = vtk_io.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(sorted((path.parent / "frames").glob("rods_*.vtu"))[-1]))
    reader.Update()
    found = vtk_to_numpy(reader.GetOutput().GetPointData().GetArray("actuation_bend"))
    assert found.tolist() == [0] * 3 + [-2] * 5 + [0] * 3 + [0] * 11


def test_vtk_has_both_of_a_pair(helix, tmp_path):
    pytest.importorskip("pyevtk")
    helix["actuation"] = [{"name": "bend", "rod": "strip", "natural_curvature": [3, 4]}]
    path, _ = der.run(helix).export("vtk", tmp_path)
    header = next((path.parent / "frames").glob("rods_*.vtu")).read_bytes()[:4000]
    assert b'"actuation_bend_k1"' in header
    assert b'"actuation_bend_k2"' in header
