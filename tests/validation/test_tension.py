"""Strain and tension beside the loads that give them jumps and kinks, against statics by hand."""

import der
import numpy as np
import pytest
from references.pulled_bar import pulled_bar
from scenes import Scene, straight, tip_force

SCENE = """
title: Axial forces
rods:
  - {{name: rod, nodes: {nodes}, from: [0, 0], to: [1, 0],
     cross_section: {{stiffness: {{EA: 1e4, EI: 1, mass_per_length: 1}}}}}}
supports:
  - {{rod: rod, at: start, clamp: true}}
loads:
  - {{point_force: {{rod: rod, at: 0.437, force: [1, 0]}}}}
  - {{distributed_force: {{rod: rod, force: [3, 0], from: 0.13, to: 0.29}}}}
analysis: static
output:
  probes:
    before: {{rod: rod, quantity: tension, at: 0.437, side: before}}
    after: {{rod: rod, quantity: tension, at: 0.437}}
    strain: {{rod: rod, quantity: strain, at: 0.437, side: before}}
    least: {{rod: rod, quantity: tension, over: rod, reduce: min}}
    greatest: {{rod: rod, quantity: tension, over: rod, reduce: max}}
"""

BENT = """
title: Bent, with a force and a spring that pull across and along it
rods:
  - {{name: rod, nodes: {nodes}, from: [0, 0], to: [1, 0],
     cross_section: {{stiffness: {{EA: 1e3, EI: 1, mass_per_length: 1}}}}}}
supports:
  - {{rod: rod, at: start, clamp: true}}
  - {{rod: rod, at: 0.4, spring: {{stiffness: [5, 3]}}}}
loads:
  - {{point_force: {{rod: rod, at: 0.4, force: [2, -3]}}}}
  - {{point_force: {{rod: rod, at: end, force: [-1, -2]}}}}
analysis: static
output:
  probes:
    before: {{rod: rod, quantity: tension, at: 0.4, side: before}}
    after: {{rod: rod, quantity: tension, at: 0.4}}
    near: {{rod: rod, quantity: tension, at: 0.41}}
    least: {{rod: rod, quantity: tension, over: rod, reduce: min}}
    greatest: {{rod: rod, quantity: tension, over: rod, reduce: max}}
"""


def probed(scene):
    result = der.run(der.Scenario.parse(scene))
    return {name: values[-1] for name, values in result.probes.items()}


@pytest.mark.parametrize("nodes", [11, 14, 30])
def test_forces_along_a_rod(nodes):
    """A straight rod's tension is the sum of what pulls beyond, wherever the nodes are."""
    result = der.run(der.Scenario.parse(SCENE.format(nodes=nodes)))
    last = {name: values[-1] for name, values in result.probes.items()}
    assert last["before"] == pytest.approx(1.0, abs=1e-7)
    assert last["after"] == pytest.approx(0.0, abs=1e-7)
    assert last["strain"] == pytest.approx(1e-4, abs=1e-11)
    assert last["least"] == pytest.approx(0.0, abs=1e-7)
    assert last["greatest"] == pytest.approx(1.0 + 3.0 * 0.16, abs=1e-7)
    places, tension = result.along("rod", "tension")
    expected = 3.0 * np.clip(0.29 - np.maximum(places, 0.13), 0.0, None) + (places < 0.437 - 1e-9)
    expected[np.flatnonzero(abs(places - 0.437) < 1e-9)] = [1.0, 0.0]
    assert tension[-1] == pytest.approx(expected, abs=1e-7)


def test_tension_of_a_bent_rod_is_of_order_2_beside_a_jump(fitted_order):
    """Force and spring stand at 4/5 of an edge; the reference has them at a node, extrapolated."""
    coarse, fine = (probed(BENT.format(nodes=edges + 1)) for edges in (320, 640))
    sizes = [1 / edges for edges in (22, 42, 82)]
    found = [probed(BENT.format(nodes=edges + 1)) for edges in (22, 42, 82)]
    for name in ("before", "after", "near", "least", "greatest"):
        exact = (4.0 * fine[name] - coarse[name]) / 3.0
        assert fitted_order(sizes, [values[name] - exact for values in found]) > 1.9, name


def line_load(kind: str, amount: list[float], start: float, end: float) -> Scene:
    """A load along a part of the rod; `kind` names its key of `amount`."""
    load = {"distributed_force": "force", "foundation": "stiffness"}[kind]
    return {kind: {"rod": "rod", load: amount, "from": start, "to": end}}


# Parts that begin and end in the outer half of an edge: outermost edges, inner ones, beside a node.
PARTS = [
    [(0.004, 1.0)],
    [(0.0, 0.996)],
    [(0.01, 0.02)],
    [(0.981, 0.992)],
    [(0.003, 0.021), (0.011, 0.995), (0.015, 1.0)],
    [(0.13, 0.14), (0.19, 0.206), (0.0, 0.163)],
]


@pytest.mark.parametrize("edges", [1, 2, 3, 10, 23])
@pytest.mark.parametrize("parts", PARTS)
@pytest.mark.parametrize("held", ["start", "end"])
def test_distributed_forces_that_begin_and_end_anywhere(held, parts, edges):
    """Tension is the force between a place and the free end: exact on every mesh."""
    forces = [100.0 * (-0.6) ** i for i in range(len(parts))]
    scene = straight(edges, "free-free", 1e4)
    scene["rods"][0]["cross_section"]["stiffness"]["EI"] = 100.0  # does not buckle
    scene["supports"] = [{"rod": "rod", "at": held, "clamp": True}]
    scene["loads"] = [
        line_load("distributed_force", [q, 0.0], *part)
        for q, part in zip(forces, parts, strict=True)
    ]
    result = der.run(scene)
    for quantity, stiffness in {"tension": 1.0, "strain": 1e4}.items():
        places, found = result.along("rod", quantity)
        expected = np.zeros(len(places))
        for q, (a, b) in zip(forces, parts, strict=True):
            beyond = b - np.clip(places, a, b)
            expected += q * (beyond if held == "start" else beyond - (b - a))
        assert stiffness * found[-1] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("border", [0.1, 0.25, 0.45])
def test_foundations_that_begin_and_end_within_the_outermost_edges(fitted_order, border):
    """Borders at the same part of the edge on every mesh: u'' = k u/EA by hand on each of them."""
    sizes = [1 / n for n in (20, 40, 80)]
    errors = []
    for h in sizes:
        parts = [
            (500.0, border * h, 1.0),
            (300.0, 0.0, 1.0 - border * h),
            (900.0, 1.0 - 0.3 * h, 1.0 - 0.05 * h),
        ]
        scene = straight(round(1 / h), "free-free", 100.0)
        scene["loads"] = [line_load("foundation", [k, k], a, b) for k, a, b in parts]
        scene["loads"] += tip_force(1e-3, 0.0)
        places, tension = der.run(scene).along("rod", "tension")
        errors.append(np.abs(1e3 * tension[-1] - pulled_bar(places, parts)).max())
    # Lines through two middles are continued by half an edge at most: N'' 1/2 h/2 3h/2.
    assert errors[-1] < 3 / 8 * sizes[-1] ** 2 * sum(k for k, _, _ in parts) / 100.0
    assert fitted_order(sizes, errors) > 1.9


@pytest.mark.parametrize("border", [0.1, 0.25, 0.45])
def test_a_free_end_of_a_bent_rod_beyond_its_distributed_force(fitted_order, border):
    """Nothing acts beyond the force, which ends before the middle of the last edge: no tension."""
    sizes = [1 / n for n in (20, 40, 80)]
    errors = []
    for h in sizes:
        scene = straight(round(1 / h), "clamped-free", 1e3)
        scene["loads"] = [line_load("distributed_force", [30.0, -20.0], 0.0, 1.0 - border * h)]
        places, tension = der.run(scene).along("rod", "tension")
        errors.append(np.abs(tension[-1][places >= 1.0 - border * h - 1e-9]).max())
    assert fitted_order(sizes, errors) > 1.9


def test_extreme_of_a_position_within_the_outermost_edge():
    """A drawn parabola that no load bends: its lowest point, 1/400 below the ends of the edge."""
    points = [[s, (s - 0.05) ** 2] for s in np.linspace(0.0, 1.0, 11)]
    scene = {
        "title": "Dip beside the start",
        "rods": [
            {
                "name": "rod",
                "points": [[float(x), float(y)] for x, y in points],
                "cross_section": {"stiffness": {"EA": 1e4, "EI": 1, "mass_per_length": 1}},
            }
        ],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "analysis": "static",
        "output": {
            "probes": {"low": {"quantity": "y", "rod": "rod", "over": "rod", "reduce": "min"}}
        },
    }
    low = der.run(der.Scenario.from_dict(scene)).probes["low"][-1]
    assert low == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("model", ["planar", "spatial_bend"])
def test_tension_of_a_cable_that_is_given_a_natural_curvature(model):
    """A rod without bending stiffness hangs from its start: half its weight is at its middle."""
    scene = {
        "title": "Cable",
        "model": model,
        "rods": [
            {
                "name": "rod",
                "nodes": 9,
                "from": [0, 0, 0],
                "to": [0, -1, 0],
                "natural_curvature": -3.0,
                "cross_section": {"stiffness": {"EA": 1e4, "EI": 0, "mass_per_length": 0.2}},
            }
        ],
        "supports": [{"rod": "rod", "at": "start", "fix": ["x", "y", "z"]}],
        "loads": [{"gravity": [0, -10, 0]}],
        "analysis": "static",
        "output": {"probes": {"middle": {"rod": "rod", "at": 0.5, "quantity": "tension"}}},
    }
    if model == "planar":
        scene["rods"][0].update({"from": [0, 0], "to": [0, -1]})
        scene["supports"][0]["fix"] = ["x", "y"]
        scene["loads"] = [{"gravity": [0, -10]}]
    tension = der.run(der.Scenario.from_dict(scene)).probes["middle"][-1]
    assert tension == pytest.approx(1.0, rel=1e-6)
