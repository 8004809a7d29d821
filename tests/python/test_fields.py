"""Quantities along rods and held nodes at every frame: the same numbers as the engine's probes."""

from dataclasses import replace

import der
import numpy as np
import pytest
from der.characteristic_scales import characteristic_scale
from der.fields import fields_of, rod_fields

TURN = {"times": [0, 0.2], "values": [0, -0.9]}


def with_probes(scene, bent):
    """The scene with a probe of each exported quantity at every node, those of edges there too."""
    scenario = der.Scenario.from_dict(scene)
    model = der.Model(scenario)
    probes = {}
    for rod in model.rods:
        arc = rod.arc_lengths
        middles = 0.5 * (arc[1:] + arc[:-1])
        for i in range(len(arc)):
            for quantity, row in fields_of(model).items():
                if row.kind != "bend" or bent(rod, i):
                    place = {"node": i}
                    probes[f"{rod.name}-{quantity}-{i}"] = {
                        "rod": rod.name,
                        "at": place,
                        "quantity": quantity,
                    }
        for i, s in enumerate(middles):
            for quantity in ("strain", "tension"):
                probes[f"{rod.name}-edge_{quantity}-{i}"] = {
                    "rod": rod.name,
                    "at": float(s),
                    "quantity": quantity,
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
        known = {**fields.at_nodes, **{f"edge_{n}": v for n, v in fields.at_edges.items()}}[
            quantity
        ]
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


def test_every_quantity_where_the_rod_has_it(swing):
    """With a clamp that turns at one end, so that there are 11 nodes, 10 edges and 10 turns."""
    swing["rods"][0] |= {"curvature": "tangent", "natural_curvature": 0.7}
    swing["supports"][0]["prescribe"] = {"angle": TURN}
    model = der.Model(der.Scenario.from_dict(swing))
    rod = model.rods[0]
    middles = 0.5 * (rod.arc_lengths[1:] + rod.arc_lengths[:-1])
    kinds = ("position", "velocity", "bend", "natural", "tangent")
    of_kind = dict.fromkeys(kinds, rod.arc_lengths)
    of_kind["turn"] = rod.arc_lengths[:-1]
    of_kind["edge"] = np.r_[0.0, middles, rod.arc_lengths[-1]]
    places = {
        one.name: of_kind[one.kind]
        for one in der.quantities()
        if one.kind not in ("energy", "support", "actuation", "joint", "spring")
        and one.is_available(model)
    }
    assert len(places) >= 10
    swing["output"]["probes"] = {
        f"{quantity}-{i}": {"rod": "arm", "at": float(s), "quantity": quantity}
        for quantity, known in places.items()
        for i, s in enumerate(known)
    }
    result = der.run(swing)
    for quantity, known in places.items():
        found, values = result.along("arm", quantity)
        probes = np.column_stack([result.probes[f"{quantity}-{i}"] for i in range(len(known))])
        assert found == pytest.approx(known, abs=1e-15)
        assert np.abs(probes).max() > 0.0, quantity
        assert np.abs(values - probes).max() <= 1e-8 * np.abs(probes).max(), quantity


def test_exports_have_every_quantity_with_a_value_at_all_nodes(swing):
    """Components are exported as vectors; a turning angle has no value between nodes that bend."""
    of_whole = ("ring", "energy", "support", "actuation", "joint", "spring")
    along_rods = [q.name for q in der.quantities() if q.kind not in (*of_whole, "natural")]
    left_out = {"x", "y", "z", "vx", "vy", "vz", "turning_angle", "tz"}
    of_sections = {quantity.name for quantity in der.quantities() if quantity.kind == "section"}
    fields = fields_of(der.Model(der.Scenario.from_dict(swing)))
    assert set(fields) == set(along_rods) - left_out - of_sections
    assert [name for name in fields if fields[name].kind == "velocity"] == list(fields)[-1:]
    swing["rods"][0]["material"]["poissons_ratio"] = 0.3
    spatial = fields_of(der.Model(der.Scenario.from_dict(swing | {"model": "spatial"})))
    assert set(spatial) == (set(fields) | of_sections | {"tz"}) - {"slope"}


def test_exports_of_a_flat_scene_have_the_quantities_of_space(swing):
    """A scene of three components has no others, whichever model its values make `auto` take."""
    swing["rods"][0] |= {"from": [0, 0, 0], "to": [1, 0, 0]}
    swing["rods"][0]["material"]["poissons_ratio"] = 0.3
    swing["loads"] = [{"gravity": [0, -9.81, 0]}]
    swing["output"]["probes"] = {}
    flat = der.Model(der.Scenario.from_dict(swing))
    spatial = der.Model(der.Scenario.from_dict(swing | {"model": "spatial"}))
    assert flat.name == "planar"
    assert list(fields_of(flat)) == list(fields_of(spatial))
    check(der.run(with_probes(swing, lambda rod, i: True)))


def test_exports_have_the_shape_without_stress_where_actuations_change_it(swing):
    swing["actuation"] = [{"name": "bend", "rod": "arm", "natural_curvature": 1.5}]
    plane = fields_of(der.Model(der.Scenario.from_dict(swing)))
    assert "natural_curvature" in plane
    swing["rods"][0]["material"]["poissons_ratio"] = 0.3
    space = fields_of(der.Model(der.Scenario.from_dict(swing | {"model": "spatial"})))
    assert set(space) >= {"natural_curvature_1", "natural_curvature_2", "natural_twist"}
    values = rod_fields(der.run(swing))[0].at_nodes["natural_curvature"]
    assert values == pytest.approx(1.5)


def test_every_quantity_has_a_natural_size(swing):
    """Views and error bars need one to tell rounding from numbers."""
    rods = der.Model(der.Scenario.from_dict(swing)).rods
    (rod,) = rods
    sizes = {one.name: characteristic_scale(rods, one.unit, 0.5) for one in der.quantities()}
    assert all(size > 0.0 for size in sizes.values()), sizes
    assert sizes["curvature"] == pytest.approx(1.0 / rod.length)
    assert sizes["moment"] == pytest.approx(rod.EI / rod.length)
    assert sizes["tension"] == pytest.approx(rod.EA)
    assert sizes["speed"] == pytest.approx(2.0 * rod.length)


def test_held_nodes_turn_with_their_clamps(swing):
    swing["supports"][0]["prescribe"] = {"angle": TURN}
    swing["supports"].append({"rod": "arm", "at": {"node": 6}, "clamp": True})
    swing["supports"].append({"rod": "arm", "at": "end", "fix": ["y"]})
    result = der.run(swing)
    held = [result.held_nodes(frame) for frame in range(len(result.times))]
    assert {tuple(node.node for node in nodes) for nodes in held} == {(0, 6, 10)}
    assert [nodes[0].tangent_angle for nodes in held] == pytest.approx(-4.5 * result.times)
    assert all(nodes[1].tangent_angle == 0.0 for nodes in held)
    assert all(nodes[2].tangent_angle is None for nodes in held)


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
    frames = range(len(result.times))
    turned = [result.held_nodes(frame)[0].tangent_angle for frame in frames]
    assert turned == pytest.approx(0.9 * result.path.factor)


def test_one_of_two_supports_that_a_continuation_turns(swing):
    del swing["time"], swing["loads"]
    del swing["output"]["every"]
    swing["supports"][0]["prescribe"] = {"angle": 0.9}
    swing["supports"].append(
        {"rod": "arm", "at": "end", "clamp": True, "prescribe": {"x": -0.05, "angle": 0.4}}
    )
    swing["analysis"] = {"continuation": {"vary": "supports.1", "from": 0.2, "to": 1.5}}
    result = der.run(with_probes(swing, lambda rod, i: True))
    assert result.path.factor[-1] == pytest.approx(1.5)
    check(result)
    for frame, factor in enumerate(result.path.factor):
        start, end = (held.tangent_angle for held in result.held_nodes(frame))
        assert (start, end) == pytest.approx((0.9, 0.4 * factor))


def test_rod_without_bending_stiffness(swing):
    """A clamp does not hold its tangent; the chain still has a shape, and so a curvature."""
    del swing["rods"][0]["material"]
    swing["rods"][0]["cross_section"] = {"stiffness": {"EA": 1e3, "EI": 0, "mass_per_length": 1}}
    swing["supports"][0]["prescribe"] = {"angle": TURN}
    result = der.run(with_probes(swing, inner))
    check(result)
    assert np.all(result.along("arm", "moment")[1] == 0.0)
    assert result.held_nodes(20)[0].tangent_angle == 0.0


def test_free_ends_and_short_rods_are_not_bent(spheres):
    (fields,) = rod_fields(der.run(spheres))
    assert np.abs(fields.at_nodes["curvature"][-1, 1]) > 0.0
    assert np.all(fields.at_nodes["curvature"][:, [0, -1]] == 0.0)
    spheres["rods"][0] |= {"nodes": 2}
    spheres["rods"][0]["spheres"].pop()
    spheres["output"]["probes"].pop("angle")
    spheres["output"]["probes"]["v_mid"]["at"] = "start"
    (fields,) = rod_fields(der.run(spheres))
    assert np.all(fields.at_nodes["curvature"] == 0.0)


def test_drawn_circle(swing):
    angle = np.linspace(0.0, 1.0, 11)
    circle = np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])
    for key in ("nodes", "from", "to"):
        del swing["rods"][0][key]
    swing["rods"][0]["points"] = circle.tolist()
    swing["supports"][0] = {"rod": "arm", "at": "start", "fix": ["x", "y"]}
    (fields,) = rod_fields(der.run(swing))
    assert fields.at_nodes["curvature"][0] == pytest.approx(np.ones(len(angle)), rel=1e-3)
    assert fields.at_nodes["tension"][0] == pytest.approx(0.0)


def test_no_frames(swing):
    whole = der.run(swing)
    result = replace(
        whole,
        times=whole.times[:0],
        positions=whole.positions[:0],
        velocities=whole.velocities[:0],
        turns=whole.turns[:0],
    )
    (fields,) = rod_fields(result)
    assert {values.shape for values in fields.at_nodes.values()} == {(0, 11)}
    assert {values.shape for values in fields.at_edges.values()} == {(0, 10)}
    with pytest.raises(der.DerError, match="there is no frame 0: the run has 0"):
        result.held_nodes(0)


def test_mistakes_are_named(swing):
    result = der.run(swing)
    with pytest.raises(der.DerError, match="no rod named 'leg'"):
        result.along("leg", "tension")
    for quantity in ("torsion", "bend_energy"):
        with pytest.raises(der.DerError, match=f"'{quantity}' is not.*these are: x, y, .*moment"):
            result.along("arm", quantity)
    in_space = replace(result, positions=np.zeros((21, 11, 3)))
    shapes = r"positions has the shape \(21, 11, 3\), not \(frames, nodes, dim\) = \(21, 11, 2\)"
    with pytest.raises(ValueError, match=shapes):
        in_space.along("arm", "tension")
    with pytest.raises(ValueError, match="velocities has the shape"):
        replace(result, velocities=result.velocities[1:]).along("arm", "tension")
    with pytest.raises(der.DerError, match="which this scene does not ask for"):
        der._core.Replay(result.scenario, [0.5], on_path=True)


def test_node_that_two_supports_hold_is_held_in_both_directions(tube):
    tube["supports"][0]["fix"] = ["x"]
    tube["supports"].append({"rod": "beam", "at": "start", "fix": ["y"]})
    held = der.held_nodes(der.Scenario.from_dict(tube))
    assert [(node.node, node.components) for node in held] == [
        (0, ["x", "y"]),
        (20, ["y"]),
        (0, ["x", "y"]),
    ]
