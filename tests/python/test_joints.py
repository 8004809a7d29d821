"""Scenes with joints from Python: meshes, states, readings, pictures."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import der
import matplotlib
import numpy as np
import pytest
from der.viewing.payload import make_payload

matplotlib.use("Agg")

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))

STIFFNESS = {"stiffness": {"EA": 1e4, "EI": 1.0, "mass_per_length": 1.0}}


def frame(nodes: int = 11, **changes: Any) -> dict[str, Any]:
    """A column and a beam with a rigid corner, loaded at the corner and inside the beam."""
    scene: dict[str, Any] = {
        "rods": [
            {"name": "column", "nodes": nodes, "from": [0, 0], "to": [0, 1]},
            {"name": "beam", "nodes": nodes, "from": [0, 1], "to": [1, 1]},
        ],
        "joints": [
            {"name": "corner", "of": [{"rod": "column", "at": "end"}, {"rod": "beam", "at": 0}]}
        ],
        "supports": [{"rod": "column", "at": "start", "clamp": True}],
        "loads": [
            {"moment": {"joint": "corner", "moment": 0.2}},
            {"point_force": {"rod": "beam", "at": 0.33, "force": [0, -1]}},
        ],
        "output": {"probes": {"turn": {"joint": "corner", "quantity": "rotation"}}},
        "analysis": "static",
    }
    for rod in scene["rods"]:
        rod["cross_section"] = STIFFNESS
    return scene | changes


def in_motion(**time: Any) -> dict[str, Any]:
    scene = frame(time={"duration": 0.5, "step": 0.01, **time})
    del scene["analysis"]
    return scene


def test_rods_share_the_node_of_a_joint_and_legs_end_where_something_acts() -> None:
    model = der.Model(der.Scenario.from_dict(frame()))
    column, beam = model.rods
    assert column.nodes[-1] == beam.nodes[0]
    assert len(beam.nodes) == 11
    assert np.min(np.abs(beam.arc_lengths - 0.33)) < 1e-12
    # 10 cells for legs of 0.33 and 0.67, none much longer than another.
    assert np.ptp(np.diff(beam.arc_lengths)) < 0.02


def test_subdivided_legs_keep_their_nodes() -> None:
    scene = frame()
    coarse = der.Model(der.Scenario.from_dict(scene)).rods[1].arc_lengths
    scene["rods"][1]["subdivide"] = 3
    fine = der.Model(der.Scenario.from_dict(scene)).rods[1].arc_lengths
    np.testing.assert_allclose(fine[::3], coarse, rtol=0, atol=1e-15)


def test_places_that_are_nearly_one_are_one() -> None:
    scene = frame()
    scene["loads"] += [{"point_force": {"rod": "beam", "at": 0.33 + 1e-5, "force": [1, 0]}}]
    scene["loads"] += [{"point_force": {"rod": "beam", "at": 1 - 1e-5, "force": [1, 0]}}]
    beam = der.Model(der.Scenario.from_dict(scene)).rods[1]
    assert np.sum(np.abs(beam.arc_lengths - 0.33) < 1e-3) == 1
    assert np.diff(beam.arc_lengths)[-1] > 0.05


def test_fields_have_two_values_where_legs_meet() -> None:
    result = der.run(der.Scenario.from_dict(frame()))
    places, values = result.along("beam", "moment")
    twice = np.flatnonzero(np.diff(places) == 0)
    assert np.all(np.abs(places[twice] - 0.33) < 1e-12)
    assert len(twice) == 1
    # Beyond the force the rod is free; at the corner it has the force times its arm.
    node = int(result.rods[1].nodes[np.argmin(np.abs(result.rods[1].arc_lengths - 0.33))])
    corner = int(result.rods[1].nodes[0])
    arm = result.positions[-1][node, 0] - result.positions[-1][corner, 0]
    assert values[-1][0] == pytest.approx(-arm, rel=1e-9)
    assert np.abs(values[-1][twice[0] + 1 :]).max() < 1e-9


def test_rods_of_other_lengths_pull_at_their_joint() -> None:
    """Two bars in a row between fixed ends, drawn 1 and 2 long, 0.98 and 2.01 without stress."""
    stiffness = {"stiffness": {"EA": 100.0, "EI": 0.01, "mass_per_length": 1.0}}
    scene = {
        "rods": [
            {"name": "a", "nodes": 4, "from": [0, 0], "to": [1, 0], "rest_length": 0.98},
            {"name": "b", "nodes": 7, "from": [1, 0], "to": [3, 0], "rest_length": 2.01},
        ],
        "joints": [{"name": "j", "of": [{"rod": "a", "at": "end"}, {"rod": "b", "at": "start"}]}],
        "supports": [
            {"rod": "a", "at": "start", "clamp": True},
            {"rod": "b", "at": "end", "clamp": True},
        ],
        "analysis": "static",
        "output": {
            "probes": {
                "x": {"joint": "j", "quantity": "x"},
                "tension": {"rod": "a", "at": 0.5, "quantity": "tension"},
            }
        },
    }
    for rod in scene["rods"]:
        rod["cross_section"] = stiffness
    probes = der.run(der.Scenario.from_dict(scene)).summary["probes"]
    # The same force in both: 100 (x/0.98 - 1) = 100 ((3 - x)/2.01 - 1).
    x = 3.0 * 0.98 / (0.98 + 2.01)
    assert probes["x"]["final"] == pytest.approx(x, abs=1e-10)
    assert probes["tension"]["final"] == pytest.approx(100.0 * (x / 0.98 - 1.0), abs=1e-7)


def test_a_state_goes_on_bit_for_bit() -> None:
    simulation = der.Simulation(in_motion())
    simulation.step(5)
    saved = simulation.save_state()
    simulation.step(5)
    other = der.Simulation(in_motion())
    other.restore_state(pickle.loads(pickle.dumps(saved)))
    other.step(5)
    np.testing.assert_array_equal(other.positions, simulation.positions)


def test_a_stopped_run_is_resumed_bit_for_bit(tmp_path: Path) -> None:
    whole = der.run(in_motion(), out=tmp_path / "whole")
    simulation = der.Simulation(in_motion())
    simulation.run(lambda s: s.step_count < 20, out=tmp_path / "part")
    command = [DER_RUN, tmp_path / "part" / "scene.yaml", "--out", tmp_path / "part", "--resume"]
    subprocess.run(command, check=True, capture_output=True)
    resumed = der.open_run(tmp_path / "part")
    assert np.array_equal(resumed.positions, whole.positions)
    assert np.array_equal(resumed.probes["turn"], whole.probes["turn"])


def test_rods_spin_about_their_joint_as_they_are_drawn() -> None:
    """Velocities of a rigid spin differ at the joint by rounding."""
    scene = in_motion()
    del scene["loads"], scene["supports"], scene["output"]
    beam, column = scene["rods"][1], scene["rods"][0]
    beam |= {"from": [0, 0], "to": [1, 0], "nodes": 11}
    column |= {"from": [0.37, 0], "to": [0.37, 1], "nodes": 11}
    along = np.linspace(0, 1, 11)
    beam["initial_velocity"] = [[0.0, 2 * (x - 0.37)] for x in along]
    column["initial_velocity"] = [[-2 * y, 0.0] for y in along]
    scene["joints"][0]["of"] = [{"rod": "beam", "at": 0.37}, {"rod": "column", "at": "start"}]
    simulation = der.Simulation(scene)
    x, y = simulation.positions.T
    assert np.allclose(
        simulation.velocities, np.stack([-2 * y, 2 * (x - 0.37)], axis=1), atol=1e-12
    )
    column["initial_velocity"] = [[-2 * y, 0.1] for y in along]
    with pytest.raises(ValueError, match="different velocities"):
        der.Simulation(scene)


@pytest.mark.parametrize("angle", [0.4, 2.0, 5.0, 8.0])
def test_joints_follow_written_shapes(angle: float) -> None:
    """A frame that is turned as a whole has no bending, and its joint has turned with it."""
    scene = in_motion()
    del scene["loads"], scene["supports"]
    simulation = der.Simulation(scene)
    cosine, sine = np.cos(angle), np.sin(angle)
    simulation.positions[...] = simulation.positions @ np.array([[cosine, sine], [-sine, cosine]])
    turned = np.arctan2(sine, cosine)
    assert simulation.energies.bend == pytest.approx(0, abs=1e-20)
    assert simulation.probes["turn"] == pytest.approx(turned, abs=1e-13)
    assert np.abs(simulation.gradient()).max() < 1e-8
    batch = der.Batch(scene, 1)
    batch.positions[0] = simulation.positions
    assert batch.probes["turn"][0] == pytest.approx(turned, abs=1e-13)


def wound(**changes: Any) -> dict[str, Any]:
    """Two rods in line, coiled up by a clamp and a rotational spring: an arc of any angle."""
    scene = frame(21) | {
        "supports": [
            {"rod": "column", "at": "start", "clamp": True, "prescribe": {"angle": 9.0}},
            {"rod": "beam", "at": "end", "spring": {"rotational_stiffness": 0.25}},
        ],
        "loads": [],
    }
    scene["rods"][0] |= {"from": [0, 0], "to": [0.5, 0]}
    scene["rods"][1] |= {"from": [0.5, 0], "to": [1, 0]}
    return scene | changes


def test_whole_turns_of_joints_count_in_statics_and_in_written_shapes() -> None:
    """A moment 9 / (1 / EI + 1 / k) bends the rod to an arc: EI = L = 1, k = 0.25."""
    moment = 9.0 / (1.0 + 4.0)
    found = der.Simulation(wound())
    assert found.equilibrium().stability == "stable"
    assert found.probes["turn"] == pytest.approx(9.0 - 0.5 * moment, rel=1e-9)
    written = der.Simulation(wound())
    written.positions[...] = found.positions
    assert written.probes["turn"] == pytest.approx(found.probes["turn"], rel=1e-12)
    assert written.energies.total == pytest.approx(9.0 * moment / 2, rel=1e-9)
    assert written.equilibrium().stability == "stable"
    assert written.probes["turn"] == pytest.approx(found.probes["turn"], rel=1e-12)


@pytest.mark.parametrize("quantity", ["slope", "moment", "tension", "tx"])
def test_what_each_rod_has_for_itself_is_not_read_at_a_joint(quantity: str) -> None:
    scene = frame(output={"probes": {"p": {"joint": "corner", "quantity": quantity}}})
    with pytest.raises(der.SceneError, match="give 'rod' and 'at' in place of 'joint'"):
        der.Simulation(scene)


def test_a_study_leaves_out_what_scenes_with_joints_do_not_have() -> None:
    scene = in_motion(duration=0.02)
    study = der.study(scene, nodes=[11], steps=[0.01])
    tried = {row.stepper for row in study.rows}
    assert "newmark" in tried
    assert "energy_momentum" not in tried


def test_members_of_a_batch_are_simulations() -> None:
    batch = der.Batch(in_motion(), 5, 2)
    batch.step(7)
    alone = der.Simulation(in_motion())
    alone.step(7)
    for member in batch.positions:
        np.testing.assert_array_equal(member, alone.positions)


def test_a_motion_starts_from_a_saved_equilibrium(tmp_path: Path) -> None:
    first = der.run(der.Scenario.from_dict(frame()), out=tmp_path / "rest")
    assert first.summary["status"] == "static_converged"
    scene = in_motion() | {"start_from": str(tmp_path / "rest")}
    moved = der.run(der.Scenario.from_dict(scene))
    turn = first.summary["probes"]["turn"]["final"]
    assert turn != 0.0
    for bound in ("min", "max"):
        assert moved.summary["probes"]["turn"][bound] == pytest.approx(turn, abs=1e-7)


def test_verify_refines_legs() -> None:
    found = der.verify(der.Scenario.from_dict(frame(nodes=6)))
    assert found.flagged == []
    assert found["turn"].space.order == pytest.approx(4.0, abs=0.5)


def test_pictures_show_loads_and_clamps_at_joints(tmp_path: Path) -> None:
    scene = in_motion()
    scene["supports"][0]["prescribe"] = {"angle": {"times": [0, 0.5], "values": [0, 0.4]}}
    result = der.run(der.Scenario.from_dict(scene))
    [held] = result.held_nodes(len(result.times) - 1)
    assert held.tangent_angle == pytest.approx(np.pi / 2 + 0.4)
    scene["joints"][0]["kind"] = "hinge"
    scene["loads"] = scene["loads"][1:]
    del scene["output"]
    hinged = der.run(scene)
    (hinge,) = make_payload(hinged)["hinges"]
    joint = hinged.rods[hinge["rod"]].nodes[hinge["place"]]
    figure = hinged.plot()
    (circles,) = [line for line in figure.axes[0].lines if line.get_gid() == "hinges"]
    assert circles.get_xydata() == pytest.approx(hinged.positions[-1, [joint]])
    figure.savefig(tmp_path / "frame.png")
    assert (tmp_path / "frame.png").stat().st_size > 5000
