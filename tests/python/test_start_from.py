"""Runs that start from an equilibrium, or from the end of another run."""

import der
import numpy as np
import pytest


def test_a_dynamic_run_from_its_equilibrium_stays_there(swing):
    swing["start_from"] = "equilibrium"
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    start = simulation.positions.copy()
    assert np.abs(simulation.gradient()).max() < 1e-6
    assert not np.array_equal(start, simulation.model.initial_positions)
    simulation.step(20)
    assert simulation.positions == pytest.approx(start, abs=1e-7)


def test_a_run_goes_on_from_the_last_frame_of_another(swing, tmp_path):
    first = der.run(swing, out=tmp_path / "first")
    swing["start_from"] = str(tmp_path / "first")
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    assert np.array_equal(simulation.positions, first.positions[-1])
    assert np.array_equal(simulation.velocities, first.velocities[-1])
    assert simulation.time == 0.0


def test_a_static_run_from_a_saved_state(swing, tmp_path):
    der.run(swing, out=tmp_path / "first")
    settled = {key: value for key, value in swing.items() if key not in ("time", "output")}
    settled |= {"analysis": "static", "start_from": str(tmp_path / "first")}
    assert der.run(settled).status == "static_converged"


def test_a_run_of_other_rods_is_refused(swing, tmp_path):
    der.run(swing, out=tmp_path / "first")
    swing["rods"][0]["nodes"] += 1
    swing["start_from"] = str(tmp_path / "first")
    with pytest.raises(der.DerError, match="'arm' has 11 nodes there and 12 here"):
        der.Simulation(der.Scenario.from_dict(swing))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"to": [2, 0]}, "'arm' is 1 m long there and 2 m here"),
        ({"name": "leg"}, "it has no rod 'leg' but 'arm'"),
    ],
)
def test_rods_that_differ_are_refused_and_named(swing, tmp_path, changes, words):
    der.run(swing, out=tmp_path / "first")
    swing["rods"][0] |= changes
    for item in (swing["supports"][0], swing["output"]["probes"]["tip"]):
        item["rod"] = swing["rods"][0]["name"]
    swing["start_from"] = str(tmp_path / "first")
    with pytest.raises(der.DerError, match=words) as caught:
        der.Simulation(swing)
    assert str(caught.value).startswith("start_from: ")
    assert "scene.yaml" in str(caught.value)  # which has the right rods


def test_nodes_at_other_places_along_the_rod_are_refused(swing, tmp_path):
    rod = swing["rods"][0]
    for key in ("nodes", "from", "to"):
        del rod[key]
    rod["points"] = [[0, 0], [0.5, 0], [1, 0]]
    der.run(swing, out=tmp_path / "first")
    rod["points"] = [[0, 0], [0.6, 0], [1, 0]]
    swing["start_from"] = str(tmp_path / "first")
    with pytest.raises(der.DerError, match=r"node 1 of rod 'arm' is at 0.5 m .* 0.6 m here"):
        der.Simulation(swing)


def test_the_order_of_the_rods_counts(swing, tmp_path):
    other = {**swing["rods"][0], "name": "other", "from": [0, 1], "to": [1, 1]}
    swing["supports"].append({"rod": "other", "at": "start", "clamp": True})
    swing["rods"].append(other)
    der.run(swing, out=tmp_path / "both")
    swing["start_from"] = str(tmp_path / "both")
    der.Simulation(swing)
    swing["rods"].reverse()
    with pytest.raises(der.DerError, match="list the rods in the same order"):
        der.Simulation(swing)
    del swing["rods"][0], swing["supports"][1]
    with pytest.raises(der.DerError, match="has 2 rods, 'arm', 'other', and this scene 1"):
        der.Simulation(swing)


def test_other_stiffness_is_the_same_rod(swing, tmp_path):
    first = der.run(swing, out=tmp_path / "first")
    swing["rods"][0]["material"]["youngs_modulus"] = 2e7
    swing["start_from"] = str(tmp_path / "first")
    assert np.array_equal(der.Simulation(swing).positions, first.positions[-1])


def test_a_folder_without_a_run_is_refused(swing, tmp_path):
    for folder in (tmp_path, tmp_path / "nowhere"):
        swing["start_from"] = str(folder)
        with pytest.raises(der.DerError, match=r"^start_from: there is no run in .*written to"):
            der.Simulation(swing)
    (tmp_path / "results.h5").write_text("nothing of the kind")
    swing["start_from"] = str(tmp_path)
    with pytest.raises(der.DerError, match=r"^start_from: cannot open"):
        der.Simulation(swing)


def test_a_run_from_another_starts_a_ledger_of_its_own(swing, tmp_path):
    """A rod is let go: what it holds is what it begins with, not what the steps have made."""
    held = {key: value for key, value in swing.items() if key not in ("time", "output")}
    pull = {"point_force": {"rod": "arm", "at": "end", "force": [0, 5]}}
    held |= {"analysis": "static", "loads": [*swing["loads"], pull]}
    first = der.run(held, out=tmp_path / "first")
    swing["time"] |= {"integrator": "tr_bdf2"}
    swing["start_from"] = str(tmp_path / "first")
    second = der.run(swing)
    total = sum(second.energies.values())
    assert total[0] > 1.0
    assert total[0] == pytest.approx(sum(first.energies.values())[-1], rel=1e-12)
    assert {name: values[0] for name, values in second.work.items()} == dict.fromkeys(
        second.work, 0.0
    )
    assert second.work["numerical"][-1] == pytest.approx(total[0] - total[-1], rel=1e-9)
    assert second.summary["warnings"] == []


def test_supports_are_where_the_scene_has_them(swing, tmp_path):
    """In a static scene; a run over time would begin with a jump, which stores an energy that
    depends on the mesh."""
    der.run(swing, out=tmp_path / "first")
    swing["start_from"] = str(tmp_path / "first")
    swing["supports"] = [{"rod": "arm", "at": "end", "fix": ["x", "y"]}]
    with pytest.raises(der.DerError, match=r"hold node 10 of rod 'arm' .* would begin with a jump"):
        der.Simulation(der.Scenario.from_dict(swing))
    static = {key: value for key, value in swing.items() if key not in ("time", "output")}
    simulation = der.Simulation(der.Scenario.from_dict({**static, "analysis": "static"}))
    simulation.equilibrium()
    assert np.array_equal(simulation.positions[-1], [1.0, 0.0])


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ({"angle": 0.4}, {}, "a clamp of rod 'arm' begins 0.4 rad from how it was"),
        ({"angle": 0.4}, {"angle": {"times": [0, 1], "values": [0.3, 0.4]}}, "begins 0.1 rad"),
        ({}, {"angle": 0.2}, "begins 0.2 rad"),
        ({"angle": 0.4}, {"angle": {"times": [0, 1], "values": [0.4, 0]}}, None),
        ({"angle": 0}, {"angle": 0.2}, None),  # a program may have turned it
    ],
)
def test_clamps_begin_where_the_earlier_run_left_them(swing, tmp_path, before, after, words):
    static = {key: value for key, value in swing.items() if key not in ("time", "output")}
    static["supports"] = [{"rod": "arm", "at": "start", "clamp": True, "prescribe": before}]
    der.run({**static, "analysis": "static"}, out=tmp_path / "first")
    swing["supports"] = [{"rod": "arm", "at": "start", "clamp": True, "prescribe": after}]
    swing["start_from"] = str(tmp_path / "first")
    if words is None:
        der.Simulation(der.Scenario.from_dict(swing)).step()
        return
    with pytest.raises(der.DerError, match=words):
        der.Simulation(der.Scenario.from_dict(swing))


def rotation(axis, angle):
    return {"rotation": {"axis": axis, "angle": angle}}


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ((True, {"twist": 20.0}), (True, {}), "begins .* rad"),
        ((True, {"twist": 4 * np.pi}), (True, {}), "begins 12.6 rad"),
        ((True, {"twist": 2.0}), (True, rotation([3, 0, 0], 2.0)), None),  # the same
        ((True, {"twist": 2.0}), ("tangent", {}), None),  # lets the section go
        ((True, rotation([0, 0, 1], 1.0)), ("tangent", rotation([0, 0, -1], -1.0)), None),
        ((True, rotation([0, 0, 1], 1.0)), (True, rotation([0, 0, -2], -1.0)), None),
        ((True, rotation([0, 0, 1], 1.0)), (True, rotation([0, 1, 0], 1.0)), "begins 1.38 rad"),
        (("tangent", rotation([0, 0, 1], 1.0)), ("tangent", {}), "begins 1 rad"),
    ],
)
def test_clamps_in_space_begin_where_the_earlier_run_left_them(tmp_path, before, after, words):
    stiffness = {"EA": 1e4, "EI1": 1.0, "EI2": 2.0, "GJ": 0.7, "mass_per_length": 1.0}
    rod = {"name": "arm", "nodes": 11, "from": [0, 0, 0], "to": [1, 0, 0]}
    rod["cross_section"] = {"stiffness": {**stiffness, "rotary_inertia": 1e-3}}
    clamps = [
        {"rod": "arm", "at": "start", "clamp": clamp, "prescribe": prescribe}
        for clamp, prescribe in (before, after)
    ]
    scene = {"model": "spatial", "rods": [rod]}
    # The far end holds the twist.
    far = {"rod": "arm", "at": "end", "clamp": True} if "twist" in before[1] else {}
    held = [far] if far else []
    first = {**scene, "supports": [clamps[0], *held], "analysis": "static"}
    der.run(first, out=tmp_path / "first")
    second = {
        **scene,
        "supports": [clamps[1], *held],
        "time": {"duration": 0.1, "step": 0.001},
        "start_from": str(tmp_path / "first"),
    }
    if words is None:
        der.Simulation(der.Scenario.from_dict(second)).step()
        return
    with pytest.raises(der.DerError, match=words):
        der.Simulation(der.Scenario.from_dict(second))


@pytest.mark.parametrize("stepper", ["implicit_midpoint", "tr_bdf2", "generalized_alpha"])
def test_a_run_at_rest_has_made_no_energy(swing, stepper):
    """But rounding, which is more than the rounding that it moves by."""
    swing["loads"] = [{"gravity": [0, -50]}]
    swing["start_from"] = "equilibrium"
    swing["time"] |= {"integrator": stepper, "duration": 1.0, "step": 0.01}
    assert der.run(swing).summary["warnings"] == []
