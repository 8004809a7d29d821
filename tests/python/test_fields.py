"""Quantities along rods: the same numbers as the engine's probes."""

from dataclasses import replace

import der
import numpy as np
import pytest
from der.fields import rod_fields

TURN = {"times": [0, 0.2], "values": [0.1, -0.8]}


def with_probes(scene, bent):
    """The scene with a probe of each quantity at every node, and of tension in every edge."""
    scenario = der.Scenario.from_dict(scene)
    probes = {}
    for rod in der.Model(scenario).rods:
        arc = rod.arc_lengths
        middles = 0.5 * (arc[1:] + arc[:-1])
        for i in range(len(arc)):
            for quantity in ("curvature", "tension", "speed"):
                if quantity != "curvature" or bent(rod, i):
                    place = {"node": i}
                    probes[f"{rod.name}-{quantity}-{i}"] = {
                        "rod": rod.name,
                        "at": place,
                        "quantity": quantity,
                    }
        for i, s in enumerate(middles):
            probes[f"{rod.name}-edge-{i}"] = {
                "rod": rod.name,
                "at": float(s),
                "quantity": "tension",
            }
    scene.setdefault("output", {})["probes"] = probes
    return scene


def inner(rod, i):
    return 0 < i < len(rod.nodes) - 1


def check(result):
    values = {fields.rod.name: fields for fields in rod_fields(result)}
    scale = {}
    for name, probe in result.probes.items():
        _, quantity, _ = name.split("-")
        scale[quantity] = max(scale.get(quantity, 0.0), float(np.abs(probe).max()))
    for name, probe in result.probes.items():
        rod, quantity, place = name.split("-")
        fields = values[rod]
        known = fields.edge_tension if quantity == "edge" else fields.named()[quantity]
        difference = np.abs(known[:, int(place)] - np.asarray(probe)).max()
        assert difference <= 1e-8 * scale[quantity] + 1e-300, name
    assert scale["curvature"] > 0.0
    assert scale["tension"] > 0.0


def test_plain_beam(tube):
    tube["rods"][0]["nodes"] = 9
    check(der.run(with_probes(tube, inner)))


@pytest.mark.parametrize("curvature", ["angle", "tangent"])
def test_clamps_that_turn(swing, curvature):
    swing["rods"][0] |= {"curvature": curvature, "natural_curvature": 0.7}
    swing["supports"][0]["prescribe"] = {"angle": TURN}
    swing["supports"].append({"rod": "arm", "at": {"node": 6}, "clamp": True})
    swing["supports"].append({"rod": "arm", "at": "end", "clamp": True})
    result = der.run(with_probes(swing, lambda rod, i: True))
    assert result.times[-1] == pytest.approx(0.2)
    check(result)


def test_clamp_beside_a_free_end(swing):
    check(der.run(with_probes(swing, lambda rod, i: i < len(rod.nodes) - 1)))


def test_uneven_arch_of_two_rods(swing):
    swing["rods"][0] |= {"points": [[0, 0], [0.1, 0.05], [0.3, 0.12], [0.4, 0.1], [0.7, 0]]}
    for key in ("nodes", "from", "to"):
        del swing["rods"][0][key]
    swing["rods"].append({**swing["rods"][0], "name": "other", "points": [[0, 1], [1, 1], [1, 2]]})
    swing["supports"].append({"rod": "other", "at": "end", "clamp": True})
    check(
        der.run(with_probes(swing, lambda rod, i: inner(rod, i) or (i == 0) == (rod.name == "arm")))
    )


def test_supports_that_a_continuation_turns(swing):
    del swing["time"], swing["loads"]
    del swing["output"]["every"]
    swing["supports"][0]["prescribe"] = {"angle": 0.9}
    swing["supports"].append({"rod": "arm", "at": "end", "fix": ["x", "y"]})
    swing["analysis"] = {"continuation": {"vary": "supports"}}
    result = der.run(with_probes(swing, lambda rod, i: i < len(rod.nodes) - 1))
    assert result.path.factor[-1] == pytest.approx(1.0)
    check(result)


def test_free_ends_carry_on_and_short_rods_are_straight(spheres):
    (fields,) = rod_fields(der.run(spheres))
    assert np.array_equal(fields.curvature[:, 0], fields.curvature[:, 1])
    spheres["rods"][0] |= {"nodes": 2}
    spheres["rods"][0]["spheres"].pop()
    spheres["output"]["probes"].pop("angle")
    spheres["output"]["probes"]["v_mid"]["at"] = "start"
    (fields,) = rod_fields(der.run(spheres))
    assert np.all(fields.curvature == 0.0)


def test_rods_in_space_have_a_curvature_without_sign(swing):
    """A circle that leaves the plane; the engine has no such model yet, but positions may."""
    from der.fields import make_rod_fields

    result = der.run(swing)
    rod = result.rods[0]
    angle = np.linspace(0.0, 1.0, len(rod.nodes))
    circle = np.column_stack([np.sin(angle), 0.6 * np.cos(angle), 0.8 * np.cos(angle)])
    positions = circle[np.newaxis]
    fields = make_rod_fields(rod, circle, positions, np.zeros_like(positions), {})
    assert fields.curvature == pytest.approx(np.ones((1, len(angle))), rel=1e-3)
    assert fields.tension == pytest.approx(0.0)
    assert replace(fields, velocities=positions).speed.shape == (1, len(angle))
