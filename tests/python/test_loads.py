"""Every kind of load of the schema, on its sample in tests/load_samples.yaml.

A new kind must have all that the package does for the others: the warning of fine tables, the
drawings, the refinement of meshes, the scene reference. A kind without a sample fails.
"""

import json
from dataclasses import replace
from pathlib import Path

import der
import numpy as np
import pytest
from der.accuracy.refinement import with_elements
from der.plotting.space import make_picture
from der.scene_loads import WITHOUT_SYMBOL, acting_loads, ground_direction
from der.viewing.payload import make_payload

ROOT = Path(__file__).parents[2]
SCHEMA = json.loads(der.json_schema())["$defs"]
KINDS = sorted(set(SCHEMA["load"]["properties"]) - {"name"})
SAMPLES = der.Scenario.load(ROOT / "tests/load_samples.yaml").to_dict()
EVERY_KIND = pytest.mark.parametrize("kind", KINDS)


def with_only(kind):
    """Return the scene with none but the load of that kind."""
    (load,) = (load for load in SAMPLES["loads"] if kind in load)
    return {**SAMPLES, "loads": [load]}


def properties(kind):
    return SCHEMA.get(kind, {}).get("properties", {})


def tip(scene):
    """Return where the end of the rod comes to."""
    result = der.run(scene)
    return result.positions[-1, result.rods[0].nodes[-1]]


@EVERY_KIND
def test_sample_is_a_hard_one(kind):
    """It follows a table and stands at a node wherever its kind lets it."""
    ((_, load),) = with_only(kind)["loads"][0].items()
    for key, value in properties(kind).items():
        if "#/$defs/table" in json.dumps(value):
            assert min(np.diff(load[key]["times"])) < SAMPLES["time"]["step"], key
    assert load["at"] == {"node": 4} if "at" in properties(kind) else True
    assert all(key in load for key in {"rod", "from", "to"} & set(properties(kind)))


@EVERY_KIND
def test_fine_tables_are_warned_of(kind):
    warnings = der.run(with_only(kind)).summary["warnings"]
    for key, value in properties(kind).items():
        if "#/$defs/table" in json.dumps(value):
            path = f"the table loads.0.{kind}.{key} has entries at 0 and 0.001 s"
            assert any(warning.startswith(path) for warning in warnings)


@EVERY_KIND
def test_is_drawn_unless_it_has_no_symbol(kind):
    result = der.run(with_only(kind))
    last = len(result.times) - 1
    acting = acting_loads(result, last)
    found = [*acting.forces, *acting.moments, *acting.lines, *acting.foundations]
    drawn = bool(found) or acting.gravity is not None
    assert drawn == (kind not in WITHOUT_SYMBOL)
    axes = result.plot("shapes").axes[0]
    assert drawn == any((line.get_gid() or "").startswith("load") for line in axes.lines)
    view = make_payload(result)
    assert drawn == (bool(view["loads"][view["load_set"][-1]]) or "gravity" in view["note"])


@pytest.mark.parametrize(
    ("at", "arc_lengths"),
    [
        ("start", [0.0]),
        ("middle", [0.6]),
        ("end", [1.2]),
        ({"node": -2}, [0.9]),
        (0.7, [0.7]),
        ("all", [0.0, 0.3, 0.6, 0.9, 1.2]),
    ],
)
def test_loads_are_drawn_where_they_act(at, arc_lengths):
    """On a rod of 1.2 m with four elements."""
    rod = {**SAMPLES["rods"][0], "from": [0, 0], "to": [1.2, 0], "nodes": 5}
    del rod["points"]
    force = {"point_force": {"rod": "rod", "at": at, "force": [1, 0]}}
    part = {"distributed_force": {"rod": "rod", "from": 0.2, "force": [1, 0]}}
    scene = {**SAMPLES, "rods": [rod], "supports": [], "loads": [force, part]}
    acting = acting_loads(der.run(scene), 0)
    assert [load.at for load in acting.forces] == pytest.approx(arc_lengths)
    assert [(load.start, load.end) for load in acting.lines] == [(0.2, pytest.approx(1.2))]


def test_a_force_that_follows_is_drawn_as_it_is_turned():
    """A clamp turns a straight rod by a right angle, and past half a turn."""
    scene = {
        **SAMPLES,
        "rods": [{**SAMPLES["rods"][0], "points": [[0, 0], [1, 0], [2, 0]]}],
        "loads": [{"point_force": {"rod": "rod", "at": "end", "force": [0, 3], "follower": True}}],
        "analysis": "static",
    }
    del scene["time"], scene["rods"][0]["initial_velocity"], scene["rods"][0]["spheres"]
    scene["rods"][0]["cross_section"] = {"stiffness": {"EA": 1e9, "EI": 1e9, "mass_per_length": 1}}
    for angle in (np.pi / 2, np.pi, 4.0):
        turn = {"clamp": True, "prescribe": {"angle": angle}}
        result = der.run({**scene, "supports": [{"rod": "rod", "at": "start", **turn}]})
        (force,) = acting_loads(result, len(result.times) - 1).forces
        assert force.value == pytest.approx([-3 * np.sin(angle), 3 * np.cos(angle)], abs=1e-6)


def test_springs_and_foundations_in_space_are_drawn():
    """A rod along y: what acts along z is drawn downwards."""
    rod = {**SAMPLES["rods"][0], "points": [[0, 0, 0], [0, 1, 0], [0, 2, 0.3]]}
    del rod["initial_velocity"], rod["spheres"]
    stiffness = {"EA": 100, "EI": 1, "GJ": 1, "mass_per_length": 1}
    scene = {
        "rods": [{**rod, "cross_section": {"stiffness": stiffness}}],
        "supports": [
            {"rod": "rod", "at": "start", "clamp": True},
            {"rod": "rod", "at": "end", "spring": {"stiffness": [0, 0, 5]}},
        ],
        "loads": [
            {"gravity": [0, 0, -1]},
            {"foundation": {"rod": "rod", "stiffness": [0, 0, 20]}},
        ],
        "analysis": "static",
    }
    result = der.run(scene)
    (part,) = acting_loads(result, 0).foundations
    assert part.stiffness.tolist() == [0, 0, 20]
    down = ground_direction(part, result.rods[0], result.positions[0])
    assert down.tolist() == [0, 0, -1]
    picture = make_picture(result)
    shape, loads = picture.shape(0, "black"), picture.loads(0)

    def drawn_below_the_rod(loads):
        points = picture._symbols(shape, loads).corners.reshape(-1, 3)
        line = result.positions[0]
        below = points[:, 2] < np.interp(points[:, 1], line[:, 1], line[:, 2]) - 0.05
        return points[below, 1]

    at_spring = drawn_below_the_rod(replace(loads, foundations=[]))
    assert np.sum(np.abs(at_spring - result.positions[0, -1, 1]) < 0.1) > 10
    assert not np.any((at_spring > 0.3) & (at_spring < 1.5))
    assert np.ptp(drawn_below_the_rod(loads)) > 1.5
    assert make_payload(result)["springs"][0]["along"] == [[0, 0, -1]]


def test_view_draws_every_symbol():
    """The page tells moments and lines apart; every other symbol is an arrow."""
    kinds = {
        load["kind"]
        for kind in KINDS
        for load in make_payload(der.run(with_only(kind)))["loads"][-1]
    }
    script = (ROOT / "python/der/viewing/view.js").read_text(encoding="utf-8")
    assert all(f'load.kind === "{kind}"' in script for kind in kinds - {"force"})


@EVERY_KIND
def test_refinement_carries_its_effect(kind):
    """The load moves the tip on a mesh of 32 elements as far as on one of 16.

    The error is of second order in their length, (1/16)^2 times a factor of a few. A load that
    keeps the number of its node, or that counts nodes, is off by half of its effect and more.
    """
    scenes = [{**SAMPLES, "loads": []}, with_only(kind)]
    coarse, fine = (
        np.subtract(*(tip(with_elements(der.Scenario.from_dict(s), n)) for s in scenes))
        for n in (2, 4)
    )
    assert np.linalg.norm(coarse) > 1e-4
    assert np.linalg.norm(fine - coarse) < 0.03 * np.linalg.norm(coarse)


@EVERY_KIND
def test_at_all_nodes_it_is_not_refined(kind):
    if '"all"' not in json.dumps(properties(kind).get("at")):
        return
    scene = with_only(kind)
    load = {**scene["loads"][0][kind], "at": "all"}
    scenario = der.Scenario.from_dict({**scene, "loads": [{kind: load}]})
    assert with_elements(scenario, 2).to_dict()["rods"] == scene["rods"]


@EVERY_KIND
def test_the_scene_reference_has_it(kind):
    reference = (ROOT / "docs/scene_reference.md").read_text(encoding="utf-8")
    section = reference.split('<a id="load"></a>')[1].split("<a id=")[0]
    assert f"| `{kind}` |" in section
    for key in properties(kind):
        assert f"| `{key}` |" in reference.split(f'<a id="{kind.replace("_", "-")}"></a>')[1]
