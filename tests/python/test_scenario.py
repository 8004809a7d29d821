"""Scenarios from files, texts and dicts: one validator, one set of messages."""

import inspect
import json
import math
import pickle
import re
from collections import OrderedDict
from pathlib import Path
from types import MappingProxyType

import der
import numpy as np
import pytest
from der import _core

ROOT = Path(__file__).resolve().parents[2]


def test_dict_and_text_give_the_same_scene(tube, tmp_path):
    from_dict = der.Scenario.from_dict(tube)
    path = tmp_path / "tube.yaml"
    path.write_text(from_dict.to_yaml())
    from_file = der.load(path)
    assert from_file.to_dict() == from_dict.to_dict() == tube
    assert from_file.source == str(path)
    assert from_dict.source == ""
    first = der.run(from_dict)
    second = der.run(str(path))
    assert np.array_equal(first.positions, second.positions)


def test_facts(tube):
    scenario = der.Scenario.from_dict(tube)
    assert scenario.title == "Tube on two supports"
    assert scenario.duration == 0.5
    assert not scenario.is_static
    assert repr(scenario) == "<der.Scenario 'Tube on two supports'>"


@pytest.mark.parametrize(
    "points",
    [
        np.column_stack([np.linspace(0.0, 1.0, 21), np.zeros(21)]),
        [(np.float32(x), np.int8(0)) for x in (0.0, 0.5, 1.0)],
        tuple((x, 0) for x in (0.0, 0.25, 1.0)),
    ],
)
def test_numpy_and_tuples_are_plain_values(tube, points):
    rod = tube["rods"][0]
    for key in ("nodes", "from", "to"):
        del rod[key]
    rod["points"] = points
    scenario = der.Scenario.from_dict(OrderedDict(tube))
    assert der.Simulation(scenario).positions == pytest.approx(np.asarray(points, dtype=float))


def test_numpy_scalars(tube):
    tube["rods"][0]["nodes"] = np.int64(31)
    tube["time"]["step"] = np.float64(0.02)
    tube["rods"][0]["name"] = np.str_("beam")
    scenario = der.Scenario.from_dict(tube)
    assert der.Simulation(scenario).positions.shape == (31, 2)
    assert scenario.to_dict()["time"]["step"] == 0.02


def test_texts_with_units_are_the_numbers_in_si_units(tube):
    scenario = der.Scenario.from_dict(tube)
    varied = scenario.with_(
        {
            "rods.beam.cross_section.tube.outer_radius": "13 mm",
            "rods.beam.material.youngs_modulus": "70 GPa",
            "time": {"duration": "500 ms", "step": "1 cs"},
            "loads.0.point_force.force": [0, "-2 kN"],
        }
    )
    plain = scenario.with_(
        {
            "rods.beam.cross_section.tube.outer_radius": 13e-3,
            "rods.beam.material.youngs_modulus": 70e9,
            "time": {"duration": 500e-3, "step": 1e-2},
            "loads.0.point_force.force": [0, -2e3],
        }
    )
    assert varied.to_dict() == plain.to_dict()
    assert der.Scenario.from_dict(varied.to_dict()).to_yaml() == varied.to_yaml()
    with pytest.raises(der.SceneError, match="'kg' is not a unit of this kind"):
        scenario.with_({"time.step": "5 kg"})
    with pytest.raises(der.SceneError, match="remove the quotes"):
        scenario.with_({"time.step": "5"})
    with pytest.raises(der.SceneError, match="alone, without a unit"):
        scenario.with_({"rods.beam.nodes": "11 m"})


def test_an_empty_text_is_answered_with_what_removes_a_key(tube):
    scenario = der.Scenario.from_dict(tube)
    assert "every" in scenario.to_dict()["output"]
    with pytest.raises(der.SceneError, match="got the text '': to remove the key write nothing"):
        scenario.with_({"output.every": ""})
    assert "every" not in scenario.with_({"output.every": None}).to_dict()["output"]


def test_every_unit_of_a_key_is_one_that_numbers_can_have():
    """It may stand behind a number, and changes nothing."""
    units = set(re.findall(r"\[([^\[\]]+)\](?: Default:[^\[\]]*)?\"", der.json_schema()))
    units.discard("of the key")
    assert {"m", "Pa", "kg/m^3", "N m^2", "N s/m^2", "rad/m", "1/m", "Hz"} < units
    for unit in units:
        assert _core.number_with_unit(f"2.5 {unit}") == 2.5, unit


def test_the_pattern_of_the_schema_has_numbers_with_units_and_no_others():
    pattern = json.loads(der.json_schema())["$defs"]["circle"]["properties"]["radius"]["pattern"]
    for text in ("5 mm", "-.5e-3mm", "3 N m^2", "30°", "2 1/m", "2/m", "1.2 g/cm³", "1 µm"):
        assert re.search(pattern, text), text
        assert _core.number_with_unit(text) is not None
    for text in ("5", "mm", "1 2", "1/2", "5 -3", "1.2.3", ""):
        assert not re.search(pattern, text), text
        assert _core.number_with_unit(text) is None


def test_every_diagnostic_names_its_key_path(tube):
    tube["rods"][0]["nodes"] = "many"
    tube["titel"] = "typo"
    tube["output"]["probes"]["roller"]["quantity"] = "w"
    with pytest.raises(der.SceneError) as caught:
        der.Scenario.from_dict(tube)
    paths = {diagnostic.path for diagnostic in caught.value.diagnostics}
    assert paths == {"rods.beam.nodes", "titel", "output.probes.roller.quantity"}
    assert all(d.line == 0 and d.column == 0 for d in caught.value.diagnostics)
    assert "title" in str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert caught.value.status == "invalid_scene"


@pytest.mark.parametrize(
    ("value", "path", "words"),
    [
        (object(), "rods.beam.nodes", "object"),
        (1 + 2j, "rods.beam.nodes", "complex"),
        (2**70, "rods.beam.nodes", "64 bits"),
        (math.nan, "rods.beam.nodes", "whole number, got nan"),
        (math.inf, "rods.beam.nodes", "whole number, got inf"),
        (True, "rods.beam.nodes", "whole number, got true"),
        ({1: 2}, "rods.beam.nodes", "int"),
        (None, "rods.beam.nodes", "has no value"),
    ],
)
def test_values_that_do_not_belong_there(tube, value, path, words):
    tube["rods"][0]["nodes"] = value
    with pytest.raises(der.SceneError) as caught:
        der.Scenario.from_dict(tube)
    assert caught.value.diagnostics[0].path == path
    assert words in caught.value.diagnostics[0].message


class _Itself:
    def tolist(self):
        return self


class _Deeper:
    def tolist(self):
        return [_Deeper()]


def _nested(depth):
    value = 1.0
    for _ in range(depth):
        value = [value]
    return value


def _doubled(times):
    value = [1.0]
    for _ in range(times):
        value = [value, value]
    return value


@pytest.mark.parametrize("value", [_Itself(), _Deeper(), _nested(100_000), _doubled(200)])
def test_values_without_an_end_are_refused(tube, value):
    tube["rods"][0]["nodes"] = value
    with pytest.raises(der.SceneError, match="nested in more than 100 levels"):
        der.Scenario.from_dict(tube)


def test_a_dict_that_holds_itself_is_refused(tube):
    tube["rods"][0]["material"] = tube
    tube["rods"][0]["cross_section"] = tube
    with pytest.raises(der.SceneError, match="does a dict or a list hold itself"):
        der.Scenario.from_dict(tube)


def test_half_of_a_surrogate_pair_is_no_text(tube):
    with pytest.raises(
        der.SceneError, match=r"title: the text 'a\\ud800' holds half of a surrogate"
    ):
        der.Scenario.from_dict({**tube, "title": "a\ud800"})
    with pytest.raises(der.SceneError, match="surrogate"):
        der.Scenario.from_dict({**tube, "a\udfff": 1})
    tube["rods"][0]["name"] = "\ud800"
    with pytest.raises(der.SceneError, match=r"rods\.0\.name: .*surrogate"):
        der.Scenario.from_dict(tube)
    with pytest.raises(der.SceneError, match="surrogate"):
        der.Scenario.parse("title: \ud800")
    scenario = der.Scenario.from_dict({**tube, "rods": [{**tube["rods"][0], "name": "beam"}]})
    with pytest.raises(der.SceneError, match="surrogate"):
        scenario.with_(**{"\ud800": 1})


def test_a_dict_may_change_while_it_is_read(tube):
    class Meddler:
        def tolist(self):
            tube["rods"][0].clear()
            tube["rods"].clear()
            tube.clear()
            return 21

    tube["rods"][0] = {
        "nodes": Meddler(),
        **{k: v for k, v in tube["rods"][0].items() if k != "nodes"},
    }
    assert der.Simulation(der.Scenario.from_dict(tube)).positions.shape == (21, 2)


def test_quotes_of_a_dict_are_printable(tube):
    with pytest.raises(der.SceneError, match=r"no key 'a\\x1b\[31m'"):
        der.Scenario.from_dict({**tube, "a\x1b[31m": 1})
    with pytest.raises(der.SceneError, match="control character 0x07"):
        der.Scenario.from_dict({**tube, "title": "bell\a"})


def test_errors_of_a_text_have_lines_and_columns():
    text = "title: x\nrods:\n  - {name: a, nodes: 5}\ntime: {duration: 1, step: 0.1}\ntimes: 3\n"
    with pytest.raises(der.SceneError) as caught:
        der.Scenario.parse(text, "mine.yaml")
    by_path = {d.path: d for d in caught.value.diagnostics}
    assert (by_path["times"].line, by_path["times"].column) == (5, 1)
    assert "mine.yaml:5:1" in str(caught.value)


def test_missing_file(tmp_path):
    with pytest.raises(der.SceneError, match=r"no_such\.yaml"):
        der.load(tmp_path / "no_such.yaml")


def test_with_replaces_and_adds(tube):
    scenario = der.Scenario.from_dict(tube)
    varied = scenario.with_(
        **{
            "rods.beam.nodes": 31,
            "time.step": np.float64(0.005),
            "loads.0.point_force.force": (0, -10),
            "solver.linear": "simplicial_ldlt",
            "output.probes": {"tip": {"rod": "beam", "at": "end", "quantity": "x"}},
        }
    )
    simulation = der.Simulation(varied)
    assert simulation.positions.shape == (31, 2)
    assert simulation.linear_solver == "simplicial_ldlt"
    assert list(simulation.probes) == ["tip"]
    scene = varied.to_dict()
    assert scene["time"]["step"] == 0.005
    assert scene["loads"][0]["point_force"]["force"] == [0, -10]
    assert scenario.to_dict() == tube, "the scenario itself never changes"


@pytest.mark.parametrize("number", [0.1, 1 / 3, 1e-300, 5e22, -0.0, 1.0, 123456789012345680.0])
def test_with_keeps_every_bit_of_a_number(tube, number):
    varied = der.Scenario.from_dict(tube).with_(**{"loads.0.point_force.force": [number, 0.0]})
    kept = varied.to_dict()["loads"][0]["point_force"]["force"][0]
    assert kept == number
    assert math.copysign(1.0, kept) == math.copysign(1.0, number)


def test_with_keeps_texts_texts(tube):
    varied = der.Scenario.from_dict(tube).with_(title='2020: "yes" # or\nno')
    assert varied.title == '2020: "yes" # or\nno'
    assert der.Scenario.parse(varied.to_yaml()).title == varied.title


def test_with_complains_like_the_reader(tube):
    scenario = der.Scenario.from_dict(tube)
    with pytest.raises(der.SceneError, match=r"rods\.beam\.nodes"):
        scenario.with_(**{"rods.beam.nodes": 1.5})
    with pytest.raises(der.SceneError, match="beem"):
        scenario.with_(**{"rods.beem.nodes": 5})
    with pytest.raises(der.SceneError, match=r"time\.step: .*object"):
        scenario.with_(**{"time.step": object()})


def test_load_and_parse_take_overrides(tube, tmp_path):
    text = der.Scenario.from_dict(tube).to_yaml()
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    assert der.load(path, **{"rods.beam.nodes": 5}).to_dict()["rods"][0]["nodes"] == 5
    assert der.Scenario.parse(text, title="other").title == "other"


def test_overrides_are_mappings_or_keywords(tube):
    nodes = MappingProxyType({"rods.beam.nodes": 5})
    scenario = der.load(tube, nodes, title="Coarse")
    assert scenario.title == "Coarse"
    assert scenario.with_({"title": "Again"}).title == "Again"
    assert scenario.to_dict()["rods"][0]["nodes"] == 5
    assert der.load(scenario) is scenario
    assert der.run(tube, nodes).positions.shape[1] == 5
    with pytest.raises(TypeError, match=r"multiple values .*'title'"):
        scenario.with_({"title": "a"}, title="b")


def test_signatures_are_shown_by_help():
    """Of the methods that Python has replaced; those of the engine have them in their texts."""
    assert list(inspect.signature(der.Scenario.with_).parameters) == ["self", "overrides", "more"]
    assert list(inspect.signature(der.Scenario.load).parameters) == ["scene", "overrides", "more"]


def test_examples_are_loaded_by_name():
    names = der.examples()
    files = {path.stem: path for path in (ROOT / "configs").glob("*.yaml")}
    assert set(names) == set(files)
    for name, title in names.items():
        assert title == der.load(f"example:{name}").title == der.load(files[name]).title
    with pytest.raises(FileNotFoundError, match=r"no example 'fingr'; there are .* finger,"):
        der.load("example:fingr")


def test_pickle(tube):
    scenario = der.Scenario.from_dict(tube)
    copy = pickle.loads(pickle.dumps(scenario))
    assert copy.to_dict() == scenario.to_dict()


def test_errors_can_be_pickled(tube):
    tube["titel"] = 1
    with pytest.raises(der.SceneError) as caught:
        der.Scenario.from_dict(tube)
    copy = pickle.loads(pickle.dumps(caught.value))
    assert str(copy) == str(caught.value)
    assert copy.diagnostics == caught.value.diagnostics


def test_schema_and_reference_know_the_keys():
    assert "youngs_modulus" in der.json_schema()
    assert "youngs_modulus" in der.scene_reference()


def test_static_scene(tube):
    del tube["time"], tube["output"]["every"]
    scenario = der.Scenario.from_dict({**tube, "analysis": "static"})
    assert scenario.is_static
    assert scenario.duration == 0.0


def _rods(*points, **more):
    section = {"stiffness": {"EA": 1e4, "EI": 1.0, "mass_per_length": 1.0}}
    rods = [
        {"name": name, "cross_section": section, "points": list(map(list, line))}
        for name, line in zip("abcdefgh", points, strict=False)
    ]
    return {"rods": rods, "time": {"duration": 0.02, "step": 0.01}, **more}


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        # A frame of two legs; 0.1 + 0.2 is not 0.3.
        (
            [[(0, 0), (0, 0.3)], [(0, 0.1 + 0.2), (1, 0.3)]],
            "the end of rod 'a' and the start of rod 'b'",
        ),
        ([[(1, 1), (0, 0)], [(1, 1), (2, 0)]], "the start of rod 'a' and the start of rod 'b'"),
        ([[(0, 0), (1, 0), (2, 0)], [(1, 1), (1, 0)]], "a node of rod 'a' and the end of rod 'b'"),
        ([[(0, 0), (1, 0), (0, 1), (0, 0)]], "the last point of rod 'a' is its first, (0, 0) m"),
        ([[(0, 0), (1, 0), (2, 0), (2, 1), (1, 0)]], "a node of rod 'a' and the end of rod 'a'"),
    ],
)
def test_rods_that_touch_are_warned_of(lines, words):
    scenario = der.Scenario.from_dict(_rods(*lines))
    [warning] = scenario.warnings
    assert warning.startswith(words)
    advice = "For a ring leave the last point out and write 'closed: true'"
    assert (advice if "its first" in words else "To join them write 'joints: [{name: ") in warning
    with pytest.warns(der.DerWarning) as caught:
        result = der.run(scenario)
    assert [str(w.message) for w in caught] == [warning]
    assert caught[0].filename == __file__
    assert result.summary["warnings"] == [warning]


@pytest.mark.parametrize(
    "lines",
    [
        [[(0, 0), (1, 0)], [(1.0001, 0), (2, 0)]],
        [[(0, 0), (1, 0), (2, 0)], [(1, 1), (1, 0), (1, -1)]],  # they cross
        [[(0, 0), (1, 0), (0, 1), (0, 1e-3)]],
    ],
)
def test_rods_that_do_not_end_on_another_are_not_warned_of(lines):
    assert der.Scenario.from_dict(_rods(*lines)).warnings == ()


def test_rods_that_supports_hold_at_the_same_place_are_not_warned_of():
    scene = _rods([(0, 0), (1, 0)], [(0, 0), (0, 1)])
    scene["supports"] = [{"rod": "a", "at": "start", "clamp": True}]
    assert len(der.Scenario.from_dict(scene).warnings) == 1
    scene["supports"] += [{"rod": "b", "at": "start", "fix": ["x", "y"]}]
    assert der.Scenario.from_dict(scene).warnings == ()


def test_a_star_of_rods_is_warned_of_a_few_times():
    star = _rods(*([(0, 0), (math.cos(k), math.sin(k))] for k in range(8)))
    warnings = der.Scenario.from_dict(star).warnings
    assert len(warnings) == 6
    assert warnings[-1] == "there are more places where rods touch and nothing joins them"


@pytest.mark.parametrize(
    ("natural", "warnings"),
    [
        ({"natural_curvature": [5.0, 8.0]}, []),
        ({"natural_curvature": [0.0, 12.0]}, ["natural_curvature: without stress the edges"]),
        ({"natural_twist": 12.0}, ["natural_twist: without stress the sections"]),
        ({"natural_twist": [12.0] + 10 * [9.0]}, []),
    ],
)
def test_meshes_that_hardly_resolve_the_natural_shape_are_warned_of(natural, warnings):
    """Edges of 0.1 m: warnings begin at a radian."""
    rod = {
        "name": "strip",
        "nodes": 11,
        "from": [0, 0, 0],
        "to": [1, 0, 0],
        "cross_section": {"rectangle": {"width": 0.02, "height": 0.01}},
        "material": {"youngs_modulus": 1e7, "shear_modulus": 4e6, "density": 1000},
    }
    found = der.Scenario.from_dict({"rods": [rod | natural], "analysis": "static"}).warnings
    expected = [
        f"too coarse for its {w} turn by 1.2 rad at node 1. Give it about 25" for w in warnings
    ]
    assert len(found) == len(expected)
    assert all(e in f for e, f in zip(expected, found, strict=True))


def strip_between_clamps(twists, **rod):
    """A flat strip of 10 edges between two clamps, which twist it so."""
    stiffness = {"EA": 1e4, "EI1": 1.0, "EI2": 9.0, "GJ": 0.1, "mass_per_length": 1.0}
    strip = {"name": "strip", "nodes": 11, "from": [0, 0, 0], "to": [1, 0, 0]}
    clamps = [
        {"rod": "strip", "at": end, "clamp": True, "prescribe": {"twist": twist}}
        for end, twist in zip(("start", "end"), twists, strict=True)
    ]
    strip["cross_section"] = {"stiffness": stiffness, "director": [0, 0, 1]}
    return {"rods": [{**strip, **rod}], "supports": clamps, "time": {"duration": 1, "step": 0.01}}


@pytest.mark.parametrize(
    ("twists", "rod", "words"),
    [
        (
            [0, {"times": [0, 1], "values": [0, 12]}],
            {},
            r"clamps prescribe: .* 1.2 rad .* about 25",
        ),
        ([0, {"times": [0, 1], "values": [0, 8]}], {}, None),
        ([{"times": [0, 1], "values": [0, 12]}] * 2, {}, None),  # they turn together
        ([0, {"times": [0, 9, 10], "values": [0, 0, 12]}], {}, None),  # after the end of the run
        ([0, 0], {"initial_twist": 12.0}, r"its initial_twist: .* turn by 1.2 rad .* about 25"),
        ([0, 0], {"initial_twist": 12.0, "natural_twist": 2.0}, None),
    ],
)
def test_strips_that_are_too_coarse_for_their_twist(twists, rod, words):
    found = der.Scenario.from_dict(strip_between_clamps(twists, **rod)).warnings
    assert len(found) == (0 if words is None else 1)
    assert all(re.search(words, warning) for warning in found)


_TAKEN = "a support holds: the support takes it up without any effect on the rod"


def test_loads_that_a_support_takes_up_are_warned_of(tube):
    def warnings_of(kind, **load):
        tube["loads"] = [{kind: {"rod": "beam", **load}}]
        return der.Scenario.from_dict(tube).warnings

    taken = "component of loads.0.point_force acts on a node of rod 'beam' whose"
    at_start = warnings_of("point_force", at=0.0, force=[1, 2])
    assert at_start == (f"the x {taken} x {_TAKEN}", f"the y {taken} y {_TAKEN}")
    assert warnings_of("point_force", at="end", force=[1, 2]) == (f"the y {taken} y {_TAKEN}",)
    assert warnings_of("point_force", at="end", force=[1, 0]) == ()
    assert warnings_of("point_force", at="all", force=[1, 2]) == ()
    assert warnings_of("moment", at="start", moment=1.0) == ()
    tube["supports"][0] = {"rod": "beam", "at": "start", "clamp": True}
    assert warnings_of("moment", at="start", moment=1.0) == (
        f"loads.0.moment acts on a node of rod 'beam' whose angle {_TAKEN}",
    )


def test_a_moment_on_a_clamp_bends_nothing(tube):
    tube["supports"] = [{"rod": "beam", "at": place, "clamp": True} for place in (0.0, 0.5)]
    tube["loads"] = [
        {"moment": {"rod": "beam", "at": place, "moment": 100.0}} for place in ("start", "middle")
    ]
    del tube["time"], tube["output"]
    with pytest.warns(der.DerWarning):
        result = der.run({**tube, "analysis": "static"})
    assert np.array_equal(result.positions[0, :, 1], np.zeros(21))


@pytest.mark.parametrize(
    ("clamps", "words"),
    [
        ({"start": {}, "end": {"rotation": {"axis": [-2, 0, 0], "angle": 12.0}}}, "1.2 rad"),
        ({"start": {}, "end": {"rotation": {"axis": [0, 1, 0], "angle": 12.0}}}, None),
        (
            {
                "start": {},
                "end": {"rotation": {"axis": [1, 0, 0], "angle": 12.0}, "twist": -12.0},
            },
            None,
        ),
        ({"start": {}, "middle": {"twist": 8.0}, "end": {}}, "1.6 rad"),
        ({"start": {}, "middle": {"twist": 8.0}, "end": {"twist": 10.0}}, "1.6 rad"),
        ({"start": {}, "middle": {"twist": 8.0}}, "1.6 rad"),
    ],
)
def test_the_twist_between_neighbouring_clamps(clamps, words):
    scene = strip_between_clamps([0, 0])
    del scene["time"]
    scene |= {"analysis": "static"}
    scene["supports"] = [
        {"rod": "strip", "at": place, "clamp": True, "prescribe": prescribe}
        for place, prescribe in clamps.items()
    ]
    found = der.Scenario.from_dict(scene).warnings
    assert len(found) == (0 if words is None else 1)
    assert all(f"turn by {words} from edge to edge" in warning for warning in found)


@pytest.mark.parametrize("quantity", ["moment", "curvature_1", "twist", "natural_twist"])
def test_a_probe_of_how_a_cable_in_space_bends_is_refused(quantity):
    stiffness = {"EA": 1e3, "EI": 0, "GJ": 1.0, "mass_per_length": 1.0}
    rod = {"name": "rope", "nodes": 5, "from": [0, 0, 0], "to": [1, 0, 0]}
    scene = {
        "model": "spatial",
        "rods": [{**rod, "cross_section": {"stiffness": stiffness}}],
        "analysis": "static",
        "output": {"probes": {"p": {"rod": "rope", "at": 0.3, "quantity": quantity}}},
    }
    with pytest.raises(
        der.SceneError, match=rf"probes\.p\.quantity: rod 'rope' .* no '{quantity}'"
    ):
        der.Scenario.from_dict(scene)


@pytest.mark.parametrize("length", [1.0, 1e-200, 1e200])
def test_the_length_of_an_axis_and_of_a_director_does_not_count(length):
    turned = {"axis": [0, 0, length], "angle": 1.0}
    scene = strip_between_clamps([0, 0])
    scene["rods"][0]["cross_section"]["director"] = [0, 0, length]
    scene["supports"] = [
        {"rod": "strip", "at": "start", "clamp": True, "prescribe": {"rotation": turned}}
    ]
    del scene["time"]
    scene |= {"model": "spatial", "analysis": "static"}
    result = der.run(der.Scenario.from_dict(scene))
    assert result.positions[-1, -1] == pytest.approx([math.cos(1), math.sin(1), 0], abs=1e-9)


def test_a_force_in_the_edge_of_an_end_clamp_is_read_as_at_a_start_clamp():
    """The mirror image has the same moments at the clamp and at the force, to rounding."""
    found = []
    for clamped, free, place in (("start", "end", 0.03), ("end", "start", 0.97)):
        rod = {"name": "rod", "nodes": 11, "from": [0, 0], "to": [1, 0]}
        rod["cross_section"] = {"stiffness": {"EA": 10.0, "EI": 0.1, "mass_per_length": 1.0}}
        sign = 1.0 if clamped == "start" else -1.0
        loads = [
            {"point_force": {"rod": "rod", "at": at, "force": [sign * force[0], force[1]]}}
            for at, force in ((place, [0.5, 0.4]), (free, [0.8, -0.1]))
        ]
        support = {"rod": "rod", "at": clamped, "clamp": True}
        scene = {"rods": [rod], "supports": [support], "loads": loads, "analysis": "static"}
        places, moments = der.run(der.Scenario.from_dict(scene)).along("rod", "moment")
        order = slice(None) if clamped == "start" else slice(None, None, -1)
        assert len(places) == 12
        found.append(moments[-1][order][:2])
    assert found[1] == pytest.approx(found[0], abs=1e-9)


def test_a_force_on_a_ring_changes_no_place_on_the_other_side():
    angles = np.linspace(0, 2 * np.pi, 17, endpoint=False)
    points = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rod = {"name": "ring", "closed": True, "points": points.tolist()}
    rod["cross_section"] = {"stiffness": {"EA": 1e3, "EI": 1.0, "mass_per_length": 1.0}}
    edge = float(np.linalg.norm(points[1] - points[0]))
    probes = {
        f"{c}{i}": {"rod": "ring", "quantity": c, "at": (i + 0.4) * edge}
        for i in range(17)
        for c in "xy"
    }
    scene = {"rods": [rod], "time": {"duration": 1e-6, "step": 1e-6}, "output": {"probes": probes}}
    free = der.run(der.Scenario.from_dict(scene))
    load = {"point_force": {"rod": "ring", "at": 0.7 * edge, "force": [0, 1e-9]}}
    loaded = der.run(der.Scenario.from_dict({**scene, "loads": [load]}))
    for i in range(5, 13):
        for c in "xy":
            assert loaded.probes[f"{c}{i}"][0] == free.probes[f"{c}{i}"][0]
