"""Rods drawn by segments: refinement, places, and what a program sees of them."""

import der
import numpy as np
import pytest
from der.accuracy.refinement import count_nodes, curves_between_points, with_elements

SECTION = {"stiffness": {"EA": 1e4, "EI": 1.0, "mass_per_length": 1.0}}
HOOK = [{"line": [0.5, 0]}, {"arc": {"to": [0.7, 0.2], "radius": "200 mm"}}, {"line": [0.6, 0.6]}]
ROD = {"name": "rod", "nodes": 12, "from": [0, 0], "shape": HOOK, "cross_section": SECTION}
SCENE = {
    "rods": [ROD],
    "supports": [{"rod": "rod", "at": "start", "clamp": True}],
    "loads": [{"point_force": {"rod": "rod", "at": {"node": -3}, "force": [0.1, -0.3]}}],
    "analysis": "static",
    "output": {
        "probes": {
            "k": {"rod": "rod", "at": 0.5 + 0.1 * np.pi, "side": "before", "quantity": "curvature"},
            "x": {"rod": "rod", "at": {"node": 4}, "quantity": "x"},
        }
    },
}


def positions(scene):
    return der.Model(der.Scenario.from_dict(scene)).initial_positions


def test_finer_meshes_keep_the_nodes_and_lie_on_the_curve():
    scenario = der.Scenario.from_dict(SCENE)
    fine = with_elements(scenario, 3)
    assert count_nodes(fine) == {"rod": 34}
    rod = fine.to_dict()["rods"][0]
    assert (rod["nodes"], rod["subdivide"]) == (12, 3)
    points = positions(fine.to_dict())
    assert np.array_equal(points[::3], positions(SCENE))
    arc = np.hypot(points[:, 0] - 0.5, points[:, 1] - 0.2)[
        (points[:, 0] > 0.5) & (points[:, 1] < 0.2)
    ]
    assert len(arc) > 5
    assert np.abs(arc - 0.2).max() < 1e-15
    assert fine.to_dict()["output"]["probes"]["x"]["at"] == {"node": 12}
    assert with_elements(fine, 2).to_dict()["rods"][0]["subdivide"] == 6
    with pytest.raises(ValueError, match="cannot be cut into 1/2"):
        with_elements(scenario, der.accuracy.refinement.Fraction(1, 2))


def test_a_shape_leaves_nothing_open():
    assert curves_between_points(der.Scenario.from_dict(SCENE)) == []
    found = der.verify(SCENE)
    assert not found.flagged
    assert all(value.drawing is None for value in found.values)


def test_lists_follow_a_finer_mesh():
    listed = {**ROD, "natural_curvature": np.linspace(0.0, 1.1, 12).tolist()}
    fine = with_elements(der.Scenario.from_dict({**SCENE, "rods": [listed]}), 2)
    assert np.allclose(fine.to_dict()["rods"][0]["natural_curvature"], np.linspace(0.0, 1.1, 23))


def test_a_place_is_the_same_on_every_mesh():
    """The end of the arc, at the length of the curve and not of the edges."""
    scene = {**SCENE, "loads": []}
    scene["output"] = {"probes": {"y": {"rod": "rod", "at": 0.5 + 0.1 * np.pi, "quantity": "y"}}}
    for nodes in (5, 12, 40):
        result = der.run({**scene, "rods": [{**ROD, "nodes": nodes}]})
        assert result.probes["y"][-1] == pytest.approx(0.2, abs=1e-14)


def test_a_line_is_a_straight_rod_to_the_bit():
    straight = {key: value for key, value in ROD.items() if key != "shape"} | {"to": [0.7, 0.4]}
    drawn = {**ROD, "shape": [{"line": [0.7, 0.4]}]}
    probes = {"k": {"rod": "rod", "at": 0.3, "quantity": "curvature"}}
    scene = {**SCENE, "output": {"probes": probes}}
    first, second = (der.run({**scene, "rods": [rod]}) for rod in (straight, drawn))
    assert np.array_equal(first.positions, second.positions)
    assert first.probes["k"][-1] == second.probes["k"][-1]


def test_curvature_in_an_arc_of_one_element():
    """It is known beside, where it jumps."""
    result = der.run({**SCENE, "loads": [], "rods": [{**ROD, "nodes": 5}]}, check=False)
    assert result.probes["k"][-1] == pytest.approx(5.0, rel=0.15)


@pytest.mark.parametrize("at", [1.3, "1.3 m"])
def test_places_beyond_the_curve_are_refused(at):
    scene = {**SCENE, "supports": [{"rod": "rod", "at": at, "clamp": True}]}
    with pytest.raises(der.SceneError, match=r"beyond the rod's length, 1\.2264"):
        der.Scenario.from_dict(scene)
