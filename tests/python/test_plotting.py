"""Pictures: that what is drawn is what was computed, to scale and with its units."""

import dataclasses
from itertools import pairwise
from types import SimpleNamespace

import der
import matplotlib.pyplot as plt
import numpy as np
import pytest
from der.film import failure_text
from der.plotting import PALETTE, pick_frames, style, time_colours
from der.plotting.lengths import LengthScale
from der.plotting.shapes import outline
from der.plotting.study import _looks
from der.plotting.style import quantity_text, wrapped
from der.scene_loads import acting_loads
from der.viewing.payload import make_payload
from matplotlib.collections import PatchCollection, PolyCollection
from matplotlib.colors import to_hex
from matplotlib.textpath import text_to_path


@pytest.fixture(autouse=True)
def close_figures():
    yield
    plt.close("all")


@pytest.fixture
def result(spheres):
    return der.run(spheres)


def lines_of(axes):
    """The artists that are drawn as lines; the symbols of supports and loads are not."""
    return [line for line in axes.lines if line.get_linestyle() != "None"]


def symbols_of(axes, kind):
    """Where the symbols of supports or loads are drawn, by their ids."""
    return {
        line.get_gid(): line.get_xydata()[0]
        for line in axes.lines
        if (line.get_gid() or "").startswith(kind) and len(line.get_xydata())
    }


def test_overview_has_shapes_and_every_probe(result):
    figure = result.plot()
    figure.canvas.draw()
    shape, *panels = figure.axes
    assert shape.get_title(loc="left") == "Three spheres in a fluid"
    assert (shape.get_xlabel(), shape.get_ylabel()) == ("x [m]", "y [m]")
    assert [axes.get_ylabel() for axes in panels] == ["v_mid [m/s]", "angle [rad]"]
    assert panels[-1].get_xlabel() == "time [s]"
    for axes, probe in zip(panels, result.probes.values(), strict=True):
        curve = lines_of(axes)[0]
        assert np.array_equal(curve.get_xdata(), result.times)
        assert np.array_equal(curve.get_ydata(), probe)


def test_axes_of_the_shapes_are_equal(result):
    shape = result.plot("shapes").axes[0]
    shape.figure.canvas.draw()
    box, x, y = shape.get_window_extent(), shape.get_xlim(), shape.get_ylim()
    assert box.width / (x[1] - x[0]) == pytest.approx(box.height / (y[1] - y[0]), rel=1e-3)


def test_shapes_at_given_times(result):
    shape = result.plot("shapes", times=[0.0, 0.101, 1.0]).axes[0]
    drawn = lines_of(shape)
    assert len(drawn) == 3
    for line, frame in zip(drawn, (0, 10, 100), strict=True):
        assert np.array_equal(line.get_xydata(), result.positions[frame])
    labels = [text.get_text() for text in shape.get_legend().get_texts()]
    assert labels == ["0 s", "0.1 s", "1 s", "gravity 9.8 m/s²"]
    colours = [to_hex(line.get_color()) for line in drawn]
    assert colours == [to_hex(colour) for colour in time_colours(3)]


@pytest.mark.parametrize(
    ("low", "high", "titles"),
    [
        ((0, 0), (1, 0.0008), ("x [m]", "y [m]")),
        ((0, -2e-6), (2e-5, 0), ("x [µm]", "y [µm]")),
        ((0, 0), (3e-3, 1e-3), ("x [mm]", "y [mm]")),
        ((0, 0), (3e4, 0), ("x [km]", "y [km]")),
        ((1e6 - 0.3, 0), (1e6 + 0.5, 1), ("x - 1000000 [m]", "y [m]")),
        ((-1000.0, 0), (-999.998, 0), ("x + 1000000 [mm]", "y [mm]")),
        ((0, 0), (0, 0), ("x [nm]", "y [nm]")),
    ],
)
def test_lengths_have_one_unit(low, high, titles):
    scale = LengthScale.of(np.array(low, float), np.array(high, float))
    assert (scale.label(0), scale.label(1)) == titles


@pytest.mark.parametrize(("start", "length"), [(0.0, 2e-5), (0.0, 1.0), (1e6, 1.0)])
def test_ticks_say_all_that_there_is_to_say(swing, start, length):
    """No power of ten and no offset stands beside an axis; ticks are short and in its unit."""
    swing["rods"][0] |= {"from": [start, 0], "to": [start + length, 0]}
    swing["rods"][0]["cross_section"] = {"circle": {"radius": 0.01 * length}}
    swing["time"] |= {"duration": 0.02}
    axes = der.run(swing).plot("shapes").axes[0]
    axes.figure.canvas.draw()
    for axis in (axes.xaxis, axes.yaxis):
        assert axis.get_offset_text().get_text() == ""
        labels = [label.get_text() for label in axis.get_ticklabels()]
        assert all(len(label) <= 5 for label in labels)
    metres = {2e-5: 1e-6, 1.0: 1.0}[length]
    for tick, label in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True):
        shown = float(label.get_text().replace("\N{MINUS SIGN}", "-"))
        assert start + metres * shown == pytest.approx(tick, abs=1e-6 * length)


def test_a_title_without_end_costs_no_more_than_its_lines(monkeypatch):
    measured = []
    measure = text_to_path.get_text_width_height_descent

    def count(text, *arguments, **options):
        measured.append(len(text))
        return measure(text, *arguments, **options)

    monkeypatch.setattr(text_to_path, "get_text_width_height_descent", count)
    lines = wrapped("two words " * 200, 12.0, 5.0)
    assert len(lines) == 4
    assert lines[-1].endswith("…")
    assert sum(measured) < 20_000  # at most 120 letters on a line, and each such length tried once


def test_titles_are_wrapped_to_their_width():
    long = "WWWWWWWWWW " * 12
    lines = wrapped(long, 12.0, 5.0)
    figure = plt.figure(figsize=(5.0, 3.0))
    for line in lines:
        text = figure.text(0, 0, line, fontsize=12)
        assert 0.4 < text.get_window_extent().width / figure.bbox.width <= 1.0
    assert len(lines) == 4
    assert lines[-1].endswith("…")
    assert wrapped("Costs $5 or $6", 12.0, 5.0) == ["Costs $5 or $6"]


def test_a_title_is_no_formula(result):
    figure = der.plot(result, title=r"Costs $5 \frac or $6")
    figure.canvas.draw()
    assert figure.axes[0].get_title(loc="left") == r"Costs $5 \frac or $6"


def test_modes_are_not_to_scale(swing):
    del swing["time"], swing["output"]["every"]
    swing["analysis"] = {"modes": {"count": 2}}
    figure = der.run(swing).plot()
    assert ["not to scale" in axes.texts[0].get_text() for axes in figure.axes] == [True, True]
    assert figure.axes[-1].get_xlabel() == "x [m]"


def test_thickness_and_spheres_are_to_scale(result):
    shape = result.plot("shapes", times=[0.0]).axes[0]
    (body,) = (c for c in shape.collections if isinstance(c, PolyCollection))
    corners = body.get_paths()[0].vertices
    assert np.ptp(corners[:, 1]) == pytest.approx(2 * 0.001)
    (circles,) = (c for c in shape.collections if isinstance(c, PatchCollection))
    widths = [np.ptp(path.vertices[:, 0]) for path in circles.get_paths()]
    assert widths == pytest.approx([0.01, 0.05, 0.01], rel=1e-3)
    y = shape.get_ylim()
    assert y[0] < -0.025 < 0.025 < y[1], "the spheres lie inside of the axes"


def test_supports_have_their_symbols(tube, swing):
    beam = der.run(tube).plot("shapes").axes[0]
    marked = symbols_of(beam, "support")
    assert set(marked) == {"support-beam-0", "support-beam-20"}
    assert marked["support-beam-20"][0] < 1.0, "a roller stands where its node has moved"
    arm = der.run(swing).plot("shapes").axes[0]
    (wall,) = (line for line in arm.lines if (line.get_gid() or "").startswith("support"))
    vertices = wall.get_marker().vertices
    assert vertices[:, 0].max() == pytest.approx(0.0, abs=1e-12), "the wall is behind the clamp"
    assert np.ptp(vertices[:, 1]) > np.ptp(vertices[:, 0])


@pytest.mark.parametrize(("free", "slides"), [(["x"], True), (["y"], False)])
def test_clamps_that_slide_have_symbols_of_their_own(swing, free, slides):
    clamp = {**swing["supports"][0], "free": free}
    swing["supports"] = [clamp, {"rod": "arm", "at": "end", "fix": free}]
    result = der.run(swing)
    assert result.held_nodes(0)[0].slides is slides
    lines = {line.get_gid(): line for line in result.plot("shapes").axes[0].lines}
    symbol = lines["support-arm-0"].get_marker().vertices
    assert symbol[:, 0].max() == pytest.approx(0.5 if slides else 0.0, abs=1e-12)
    assert symbol[:, 0].min() == pytest.approx(-0.5 if slides else -0.6, abs=1e-12)


def test_springs_have_their_symbols(swing):
    swing["supports"] = [
        {"rod": "arm", "at": "start", "fix": ["x", "y"], "spring": {"rotational_stiffness": 1.0}},
        {"rod": "arm", "at": 0.43, "spring": {"stiffness": [0, 3.0]}},
        {"rod": "arm", "at": "end", "spring": {"stiffness": 2.0}},
    ]
    result = der.run(swing)
    springs = der.springs(result.scenario)
    assert [spring.stiffness for spring in springs] == [[0.0, 0.0], [0.0, 3.0], [2.0, 2.0]]
    assert [spring.rotational_stiffness for spring in springs] == [1.0, 0.0, 0.0]
    assert [len(spring.nodes) for spring in springs] == [1, 6, 1]
    assert springs[1].weights.sum() == pytest.approx(1.0)
    drawn = [line for line in result.plot("shapes").axes[0].lines if line.get_gid()]
    at_end = [line for line in drawn if line.get_gid() == "spring-arm-2"]
    assert [line.get_gid() for line in drawn].count("spring-arm-1") == 1
    for line in at_end:
        assert line.get_xydata()[0] == pytest.approx(result.positions[-1, -1])
    sideways, down = (np.abs(line.get_marker().vertices).max(axis=0) for line in at_end)
    assert sideways[0] > sideways[1]
    assert down[1] > down[0]


LOADS = [
    {"gravity": [0, -9.81]},
    {"point_force": {"rod": "beam", "at": 0.75, "force": [0, -2000]}},
    {"point_force": {"rod": "beam", "at": "end", "force": [0, 0]}},
    {"moment": {"rod": "beam", "at": "middle", "moment": -0.5}},
    {"distributed_force": {"rod": "beam", "from": 0.2, "to": 0.4, "force": [0, 3]}},
]


def test_loads_have_their_symbols(tube):
    tube["loads"] = LOADS
    result = der.equilibrium(tube)
    axes = result.plot("shapes").axes[0]
    marked = symbols_of(axes, "load")
    assert [name for name in marked if "line" not in name] == ["load-beam-0.75", "load-beam-0.5"]
    x, y = result.positions[-1].T
    assert marked["load-beam-0.5"] == pytest.approx([x[10], y[10]])
    along = [place[0] for name, place in marked.items() if "line" in name]
    assert [min(along), max(along)] == pytest.approx([x[4], x[8]])
    texts = [text.get_text() for text in axes.texts]
    assert texts == ["2 kN", "3 N/m", "500 mN m"]
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[-1] == "gravity 9.81 m/s²"


def test_arrows_point_where_forces_do(tube):
    tube["loads"] = [{"point_force": {"rod": "beam", "at": 0.5, "force": [0, -1]}}]
    axes = der.equilibrium(tube).plot("shapes").axes[0]
    shaft, head = (line for line in axes.lines if (line.get_gid() or "").startswith("load"))
    assert shaft.get_marker().vertices[:, 1].min() > 0.0, "it comes from above"
    assert head.get_marker().vertices[:, 1].min() == pytest.approx(0.0), "and ends at the rod"
    tube["loads"] = [{"point_force": {"rod": "beam", "at": "end", "force": [1, 0]}}]
    axes = der.equilibrium(tube).plot("shapes").axes[0]
    shaft, head = (line for line in axes.lines if (line.get_gid() or "").startswith("load"))
    assert shaft.get_marker().vertices[:, 0].min() == pytest.approx(0.0, abs=1e-9), "it pulls"
    # The arrow and its text lie inside of the axes.
    axes.figure.canvas.draw()
    box = axes.get_window_extent()
    (text,) = axes.texts
    assert text.get_window_extent().x1 < box.x1 + 5


@pytest.mark.parametrize(
    ("analysis", "panels"), [("static", 1), ({"modes": {"count": 2}}, 2)], ids=["static", "modes"]
)
def test_foundations_are_drawn_below_their_part(tube, analysis, panels):
    """Modes, which are drawn without loads, have them too: they are supports."""
    tube.pop("time", None)
    part = {"rod": "beam", "stiffness": [0, 1e3], "from": 0.2, "to": 0.6}
    result = der.run({**tube, "loads": [{"foundation": part}], "analysis": analysis})
    figure = result.plot("shapes")
    found = [
        line
        for axes in figure.axes
        for line in axes.lines
        if "foundation" in (line.get_gid() or "")
    ]
    assert len(found) == 6 * panels  # 15 springs on a whole rod
    places = [float(line.get_xdata()[0]) for line in found]
    assert (min(places), max(places)) == pytest.approx((0.2, 0.6), abs=1e-3)
    assert all(line.get_marker().vertices[:, 1].max() < 1e-9 for line in found)
    symbols = make_payload(result)["loads"][0]
    assert [symbol["along"] for symbol in symbols] == [[0.0, -1.0, 0.0]] * 6


def test_loads_follow_time_and_load_factor(tube):
    table = {"times": [0, 0.5], "values": [[0, -100], [0, -300]]}
    tube["loads"][0]["point_force"]["force"] = table
    result = der.run(tube)
    assert acting_loads(result, 0).forces[0].value == pytest.approx([0, -100])
    frame = int(np.argmin(np.abs(result.times - 0.25)))
    value = -100 - 400 * result.times[frame]
    assert acting_loads(result, frame).forces[0].value == pytest.approx([0, value])
    tube["loads"][0]["point_force"]["force"] = [0, -100]
    path = der.continuation(tube, vary="loads.0", to=2.0)
    assert path.path.factor[-1] == pytest.approx(2.0)
    last = len(path.times) - 1
    assert acting_loads(path, last).forces[0].value == pytest.approx([0, -200])


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2000.0, "2 kN"),
        (-0.00123456, "-1.23 mN"),
        (999.9, "1 kN"),
        (1e-30, "1e-18 pN"),
        (0, "0 N"),
    ],
)
def test_amounts_have_prefixes(value, text):
    assert quantity_text(value, "N") == text


def test_held_nodes(swing):
    swing["supports"][0]["prescribe"] = {"angle": {"times": [0, 1], "values": [0, 0.5]}}
    swing["supports"].append({"rod": "arm", "at": "end", "fix": ["y"]})
    clamp, roller = der.held_nodes(der.Scenario.from_dict(swing), time=0.5)
    assert (clamp.rod, clamp.node, clamp.components) == ("arm", 0, ["x", "y"])
    assert clamp.tangent_angle == pytest.approx(0.25)
    assert (roller.node, roller.components, roller.tangent_angle) == (10, ["y"], None)


def test_static_shape_beside_the_drawn_one(tube):
    result = der.equilibrium(tube)
    figure = result.plot()
    shape, values = figure.axes
    drawn, found = lines_of(shape)
    assert np.all(drawn.get_ydata() == 0.0)
    assert np.array_equal(found.get_xydata(), result.positions[-1])
    labels = [text.get_text() for text in shape.get_legend().get_texts()]
    assert labels == ["as drawn", "equilibrium"]
    text = values.texts[0].get_text()
    assert f"deflection = {result.probes['deflection'][-1]:.6g} m" in text


def test_only_some_probes(result):
    figure = der.plot(result, "probes", probes=["angle"], title="Folding")
    (axes,) = figure.axes
    assert axes.get_ylabel() == "angle [rad]"
    assert axes.get_title(loc="left") == "Folding"


def test_rounding_errors_are_not_blown_up(spheres):
    spheres["rods"][0]["spheres"].pop()
    result = der.run(spheres)
    spread = np.ptp(result.probes["v_mid"][50:])
    figure = der.plot(result, "probes", probes=["v_mid"])
    low, high = figure.axes[0].get_ylim()
    assert high - low > 100 * spread


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"probes": ["speed"]}, "'speed'.*v_mid"),
        ({"times": [2.0]}, "from 0 s to 1 s"),
        ({"times": [-0.1]}, "-0.1"),
    ],
)
def test_what_is_not_there_is_an_error(result, arguments, words):
    with pytest.raises(ValueError, match=words):
        result.plot(**arguments)


def test_what_has_no_time_has_no_shapes_at_times(tube):
    for result, kind in (
        (der.equilibrium(tube), "static"),
        (der.continuation(tube), "continuation"),
    ):
        with pytest.raises(ValueError, match=f"a {kind} run has no time"):
            result.plot(times=[3.0])


def test_pictures_say_that_a_run_failed(unstable):
    with pytest.raises(der.DivergedError) as caught:
        der.run(unstable)
    result = caught.value.result
    title = result.plot("shapes").axes[0].get_title(loc="left")
    assert title == f"Three spheres in a fluid (diverged at t = {result.times[-1]:g} s)"
    assert result.plot(title="Mine").axes[0].get_title(loc="left") == "Mine"


@pytest.mark.parametrize(
    ("status", "text"),
    [
        ("completed", ""),
        ("static_converged", ""),
        ("stopped", ""),
        ("running", "running at t = 1 s"),
        ("not_converged", "not converged at t = 1 s"),
    ],
)
def test_titles_tell_how_a_run_failed(result, status, text):
    """A run that was stopped as its caller asked did not fail; one that was killed is not over."""
    assert result.times[-1] == 1.0
    assert failure_text(dataclasses.replace(result, summary={"status": status})) == text


def test_no_probes_to_plot(spheres):
    del spheres["output"]
    result = der.run(spheres)
    assert len(result.plot().axes) == 1
    with pytest.raises(ValueError, match="no probes"):
        result.plot("probes")


def test_style_stays_inside(result):
    before = dict(plt.rcParams)
    result.plot()
    assert dict(plt.rcParams) == before
    with style():
        assert plt.rcParams["axes.prop_cycle"].by_key()["color"] == list(PALETTE)


def test_frames_are_picked_along_the_way():
    way = np.array([0.0, 0.0, 1.0, 5.0, 9.0, 10.0, 10.0, 10.0])
    positions = np.zeros((8, 3, 2))
    positions[:, :, 1] = way[:, np.newaxis]
    assert pick_frames(positions, 3) == [0, 3, 7]
    assert pick_frames(positions[:1], 6) == [0]
    assert pick_frames(np.zeros((4, 3, 2)), 6) == [0, 3]


def test_outline_of_a_bend_keeps_its_width():
    line = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    corners = outline(line, 0.1)
    assert len(corners) == 6
    assert corners[0] == pytest.approx([0.0, 0.1])
    assert corners[-1] == pytest.approx([0.0, -0.1])
    for edge in (0, 1):
        direction = line[edge + 1] - line[edge]
        normal = np.array([-direction[1], direction[0]])
        for node in (edge, edge + 1):
            assert (corners[node] - line[node]) @ normal == pytest.approx(0.1)
            assert (corners[5 - node] - line[node]) @ normal == pytest.approx(-0.1)


def test_outline_of_a_fold_is_finite():
    line = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]])
    assert np.all(np.isfinite(outline(line, 0.1)))


def test_lightness_of_time_colours_rises():
    lightness = [np.dot(colour[:3], [0.2126, 0.7152, 0.0722]) for colour in time_colours(6)]
    assert np.all(np.diff(lightness) > 0.05)
    assert lightness[-1] < 0.85


def test_shapes_of_a_path_have_their_load_factors(tube):
    path = der.continuation(tube, step=0.1)
    axes = path.plot("shapes").axes[0]
    drawn = lines_of(axes)
    assert np.array_equal(drawn[0].get_xydata(), path.positions[0])
    assert np.array_equal(drawn[-1].get_xydata(), path.positions[-1])
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[0] == "load factor 0"
    assert labels[-1] == "load factor 1"


def test_every_stepper_has_a_look_of_its_own_in_every_figure():
    def row(stepper):
        return SimpleNamespace(stepper=stepper)

    names = [info.name for info in der.steppers()]
    looks = {
        name: (to_hex(colour), marker) for name, colour, marker in _looks([row(n) for n in names])
    }
    assert len(set(looks.values())) == len(names)
    assert len({colour for colour, _ in looks.values()}) == len(names)
    for name in names:  # alone in a figure, too
        ((_, colour, marker),) = _looks([row(name)])
        assert (to_hex(colour), marker) == looks[name]


def test_displacements_are_drawn_larger_where_asked_for(tube):
    tube["title"] = "Stiff tube"
    result = der.run(tube)
    axes = result.plot("shapes", times=[0.5], scale=50.0).axes[0]
    start, end = result.model.initial_positions, result.positions[-1]
    (line,) = lines_of(axes)[:1]
    assert line.get_xydata() == pytest.approx(start + 50.0 * (end - start), abs=1e-12)
    assert axes.get_title(loc="left") == "Stiff tube (displacements drawn 50 times as large)"
    support = max(symbols_of(axes, "support").values(), key=lambda place: place[0])
    assert support == pytest.approx(start[-1] + 50.0 * (end[-1] - start[-1]))
    assert "larger" not in result.plot("probes", scale=50.0).axes[0].get_title(loc="left")
    for wrong in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="scale of displacements is a positive number"):
            result.plot(scale=wrong)


def test_modes_have_no_scale(tube):
    del tube["time"], tube["output"]
    modes = der.run({**tube, "analysis": {"modes": {"count": 1}}})
    with pytest.raises(ValueError, match="a modes run have no scale"):
        modes.plot(scale=2.0)


def test_labels_of_long_names_stay_apart(swing):
    """They are parted after underscores, and a unit stays in one piece."""
    tip = swing["output"]["probes"]["tip"]
    moment = {"rod": "arm", "at": "start", "quantity": "moment"}
    names = {f"height_of_the_tip_of_the_long_arm_{number}": tip for number in range(4)}
    swing["output"]["probes"] = {**names, "moment_at_the_root": moment}
    figure = der.run(swing).plot("probes")
    figure.canvas.draw()
    labels = [axes.yaxis.label for axes in figure.axes]
    boxes = [label.get_window_extent() for label in labels]
    for upper, lower in pairwise(boxes):
        assert upper.y0 >= lower.y1
    assert labels[0].get_text().replace("\n", "") == "height_of_the_tip_of_the_long_arm_0 [m]"
    assert labels[-1].get_text().endswith("[N m]")
    plt.close(figure)
