"""Strain and tension beside the forces that make them jump, against statics by hand."""

import der
import numpy as np
import pytest

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
