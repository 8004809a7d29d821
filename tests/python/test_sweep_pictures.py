"""Pictures of sweeps: what is drawn where, and which members are marked."""

import der
import numpy as np
import pytest
from der.cli import main
from matplotlib.image import imread
from sweep_scenes import FORCE, STIFFNESS, STRIP, cantilever

NODES = "rods.arm.nodes"
SIDEWAYS = "rods.strip.cross_section.stiffness.EI1"
CANTILEVER = cantilever()


def marked(axes):
    """Return by the words of the legend where markers are drawn in these axes."""
    return {
        line.get_label(): list(zip(line.get_xdata(), line.get_ydata(), strict=True))
        for line in axes.get_lines()
        if not line.get_label().startswith("_")
    }


def points(lines):
    """Return the points of lines of one length, NaN included."""
    return np.array([path.vertices for path in lines.get_paths()])


@pytest.mark.parametrize(
    ("vary", "axes"),
    [
        ({FORCE: "-2:0:5"}, 1),
        ({NODES: [11, 21], FORCE: [-1]}, 1),  # one value is no axis
        ({FORCE: "-2:0:5", STIFFNESS: [1.0, -1.0, 30.0]}, 2),  # with its colour bar
        ({FORCE: "-2:0:3", STIFFNESS: [1.0, 2.0], NODES: [11, 1]}, 2),
    ],
)
def test_pictures(vary, axes, tmp_path, capsys):
    out = tmp_path / "s"
    sweep = der.sweep(CANTILEVER, vary, out=out)
    figure = sweep.plot()
    assert len(figure.axes) == axes
    texts = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert bool(texts) == bool(sweep.failed.any())
    assert main(["plot", str(out), "--probes", "tip_y.max"]) == 0
    assert capsys.readouterr().out == f"{out / 'plot.png'}\n"
    assert imread(out / "plot.png").std() > 0.01


def test_a_line_marks_failed_members_and_error_bars():
    sweep = der.sweep(CANTILEVER, {STIFFNESS: [1.0, -1.0, 2.0]}, verify=True)
    (axes,) = sweep.plot().axes
    line, *_ = axes.get_lines()
    assert line.get_xdata().tolist() == [-1.0, 1.0, 2.0]
    assert marked(axes) == {"failed: 1 of 3": [(-1.0, 0.0)]}
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["failed: 1 of 3"]
    (bars,) = axes.collections
    value, error = sweep["tip_y"][[0, 2]], sweep["tip_y.final.error"][[0, 2]]
    assert (error > 0.0).all()
    np.testing.assert_allclose(points(bars)[:, :, 1].T, [value - error, value + error])


def test_a_line_marks_doubtful_members(swing):
    """One of 5 nodes is right; 11 nodes whip, so that the steps create energy."""
    swing["time"] = {"duration": 2, "step": 0.005, "integrator": "implicit_midpoint"}
    sweep = der.sweep(swing, {NODES: [5, 11]}, verify=True)
    assert sweep.rows[1]["unreliable_from"] > 0.0
    assert sweep.values["flagged"] == [0, 3]
    (axes,) = sweep.plot().axes
    label = "doubtful: 1 of 2 (unreliable 1, with warnings 1, flagged 1)"
    assert marked(axes) == {
        label: [(11.0, sweep["tip"][1])],
        "error without bound": [(11.0, 0.0), (11.0, 1.0)],
    }


def test_a_line_marks_members_that_are_not_verified():
    sweep = der.sweep(CANTILEVER, {FORCE: [-1.0, -2.0]})
    sweep.values["message"][1] = "not verified: no convergence"
    (axes,) = sweep.plot().axes
    assert list(marked(axes)) == ["doubtful: 1 of 2 (not verified 1)"]


def test_a_member_without_a_value_is_a_dot():
    sweep = der.sweep(CANTILEVER, {FORCE: [-1.0, -2.0]})
    sweep.values["tip_y.final"][0] = None
    (axes,) = sweep.plot().axes
    assert marked(axes) == {"no finite value": [(-1.0, 0.0)]}
    sweep.values["message"][0] = "not verified: no convergence"
    (axes,) = sweep.plot().axes
    assert marked(axes) == {
        "doubtful: 1 of 2 (not verified 1)": [(-1.0, 0.0)],
        "no finite value": [(-1.0, 0.0)],
    }


def test_an_error_without_bound_goes_across_the_panel():
    """It looked exact: without an error bar at all."""
    sweep = der.sweep(CANTILEVER, {STIFFNESS: [1.0, 2.0]}, verify=True)
    sweep.values["tip_y.final.error"][1] = np.inf
    (axes,) = sweep.plot().axes
    assert marked(axes) == {"error without bound": [(2.0, 0.0), (2.0, 1.0)]}
    (bars,) = axes.collections
    assert len(points(bars)) == 1


@pytest.mark.parametrize(
    ("vary", "sample"),
    [
        ({FORCE: "-40:0:3", SIDEWAYS: [1.0, -1.0, 8.0]}, None),
        ({FORCE: "-40:0", SIDEWAYS: "-1:8"}, "sobol:16"),
    ],
    ids=["grid", "scattered"],
)
def test_maps_mark_members_at_their_places(vary, sample):
    sweep = der.sweep({**STRIP, "analysis": "static"}, vary, sample=sample)
    missing = int(np.flatnonzero(~sweep.failed)[0])
    sweep.values["tip_y.final"][missing] = None
    failed, warned = sweep.failed.sum(), sweep.warned
    assert 0 < failed < failed + warned < len(sweep)
    axes, _ = sweep.plot().axes
    places = list(zip(sweep[FORCE].tolist(), sweep[SIDEWAYS].tolist(), strict=True))
    assert marked(axes) == {
        f"doubtful: {warned} of {len(sweep)} (with warnings {warned})": [
            place for place, row in zip(places, sweep.rows, strict=True) if row["warnings"]
        ],
        "no finite value": [places[missing]],
        f"failed: {failed} of {len(sweep)}": [
            place for place, bad in zip(places, sweep.failed, strict=True) if bad
        ],
    }


@pytest.fixture
def over_three():
    """Members over three parameters: numbers 0, 1, 4, 5 have warnings, 2, 3, 8, 9 fail."""
    vary = {FORCE: [-40.0, 0.0], SIDEWAYS: [1.0, -1.0, 8.0], "rods.strip.nodes": [11, 15]}
    return der.sweep({**STRIP, "analysis": "static"}, vary)


ON_AXES = [FORCE, SIDEWAYS, "rods.strip.nodes", "tip_y", "tip_y.max"]
SOUND, DOUBTFUL, FAILED = [6, 7, 10, 11], [0, 1, 4, 5], [2, 3, 8, 9]


def drawn_on_parallel_axes(sweep):
    """Return the axes, the lines of good and of failed members on them, and where these belong."""
    axes, _ = sweep.plot(ON_AXES[3:]).axes
    good, failed = map(points, axes.collections)
    columns = (sweep[name] for name in ON_AXES)
    shares = [(own - np.nanmin(own)) / (np.nanmax(own) - np.nanmin(own)) for own in columns]
    return axes, good, failed, np.column_stack(shares)


def test_parallel_axes_draw_each_member_through_its_values(over_three):
    axes, good, failed, places = drawn_on_parallel_axes(over_three)
    np.testing.assert_array_equal(good[:, :, 0], [range(5)] * 8)
    np.testing.assert_allclose(good[:, :, 1], places[SOUND + DOUBTFUL])
    np.testing.assert_array_equal(failed[:, :, 0], [range(3)] * 4)
    np.testing.assert_allclose(failed[:, :, 1], places[FAILED, :3])
    assert marked(axes) == {
        "doubtful: 4 of 12 (with warnings 4)": [(4.0, up) for up in places[DOUBTFUL, 4]],
        "failed: 4 of 12": [(2.0, up) for up in places[FAILED, 2]],
    }
    assert axes.get_title(loc="left") == ""


def test_parallel_axes_draw_members_without_some_values_with_gaps(over_three):
    over_three.values["tip_y.max"][0] = None
    over_three.values["tip_y.final"][6] = None
    axes, good, _, places = drawn_on_parallel_axes(over_three)
    assert np.argwhere(np.isnan(good[:, :, 1])).tolist() == [[0, 3], [4, 4]]
    np.testing.assert_allclose(good[:, :, 1], places[SOUND + DOUBTFUL])
    rings, _ = marked(axes).values()
    assert rings[0] == (3.0, places[0, 3])  # at the last value that the member has
    assert axes.get_title(loc="left") == "lines with gaps where a member has no value: 2"


def test_names_of_parallel_axes_are_broken_between_keys_and_words():
    vary = {FORCE: [-40.0, -39.0], SIDEWAYS: [1.0, 2.0], "rods.strip.nodes": [11, 15]}
    growth = der.sweep({**STRIP, "analysis": "modes"}, vary)
    axes, _ = growth.plot(["growth rate out of plane"]).axes
    names = [text.get_text() for text in axes.get_xticklabels()]
    assert names[2:] == ["rods.strip.\nnodes", "growth rate\nout of plane\n[1/s]"]


def test_parallel_axes_say_how_many_members_they_leave_out(over_three, monkeypatch):
    monkeypatch.setattr("der.plotting.sweep._MOST_LINES", 3)
    axes, good, failed, places = drawn_on_parallel_axes(over_three)
    np.testing.assert_allclose(good[:, :, 1], places[[6, 7, 11, 0, 1, 5]])
    np.testing.assert_allclose(failed[:, :, 1], places[[2, 3, 9], :3])
    note = "9 of 12 members are drawn: more lines would hide one another"
    assert axes.get_title(loc="left") == note
    # The legend tells of all members, drawn or not.
    assert list(marked(axes)) == ["doubtful: 4 of 12 (with warnings 4)", "failed: 4 of 12"]


def test_scattered_members_are_dots(tmp_path):
    vary = {FORCE: "-2:0", STIFFNESS: "1:100:log"}
    figure = der.sweep(CANTILEVER, vary, sample="sobol:16").plot(["tip_y"])
    assert figure.axes[0].get_yscale() == "log"
    assert len(figure.axes[0].collections[0].get_offsets()) == 16


def test_pictures_that_are_refused(tmp_path, capsys):
    folder = tmp_path / "s"
    der.sweep(CANTILEVER, {FORCE: [-2, -1.5]}, out=folder)
    assert main(["plot", str(folder), "--probes", "tip_z"]) == 1
    assert "no column 'tip_z'" in capsys.readouterr().err
    for column in ("status", "message"):  # no member has a message
        assert main(["plot", str(folder), "--probes", column]) == 1
        assert f"the column '{column}' has no numbers to draw" in capsys.readouterr().err
    assert main(["plot", str(folder), "--view", "xz"]) == 1
    assert "neither times nor shapes" in capsys.readouterr().err
