"""Results of runs in space: live views, saved frames of sections, replay, exports and pictures."""

import copy
import csv
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import der
import numpy as np
import pytest
from der.sections import section_of, swept

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))

#: Quantities that have probes here; those of the section first.
QUANTITIES = (
    *("curvature_1", "curvature_2", "moment_1", "moment_2", "twist", "torque"),
    *("curvature", "moment", "tension", "z", "vy", "speed"),
)


@pytest.fixture
def arm(swing: dict[str, Any]) -> dict[str, Any]:
    """The planar scene of other tests, with all that the spatial model asks for."""
    swing["rods"][0]["material"]["poissons_ratio"] = 0.3
    return swing


@pytest.fixture
def cantilever(helix) -> dict[str, Any]:
    """A straight rod that stands out of a wall, with a force out of the plane of its drawing."""
    del helix["rods"][0]["natural_curvature"], helix["rods"][0]["natural_twist"]
    del helix["time"]
    helix["analysis"] = "static"
    helix["loads"] = [{"point_force": {"rod": "strip", "at": "end", "force": [0, 0.005, 0.01]}}]
    return helix


def probed(scene, nodes=(2, 4, 6)):
    """The scene with a probe of each quantity at some nodes."""
    scene["output"]["probes"] = {
        f"{quantity}-{node}": {"rod": "strip", "at": {"node": node}, "quantity": quantity}
        for quantity in QUANTITIES
        for node in nodes
    }
    return scene


def section_scene(scene):
    return der.Simulation(der.Scenario.from_dict(scene))


def same_result(one, other):
    """Whether two results have the same bits."""
    arrays = ("times", "steps", "positions", "velocities", "theta", "directors")
    return (
        all(np.array_equal(getattr(one, name), getattr(other, name)) for name in arrays)
        and np.array_equal(one.sections.spin, other.sections.spin)
        and np.array_equal(one.sections.frames, other.sections.frames)
        and all(np.array_equal(one.energies[name], other.energies[name]) for name in one.energies)
    )


# Live views


def test_views_are_those_of_the_nodes_and_of_the_edges(helix):
    simulation = section_scene(helix)
    for view in (simulation.positions, simulation.velocities, simulation.extra_force):
        assert view.shape == (9, 3)
        assert view.strides == (24, 8)
        assert view.flags.writeable
    assert simulation.theta.shape == (8,)
    assert simulation.theta.strides == (8,)
    assert simulation.positions[:, 0] == pytest.approx(np.linspace(0.0, 0.4, 9))
    simulation.step(5)
    before = simulation.positions.ctypes.data
    assert simulation.theta.ctypes.data == before + 8 * 27, "theta stands behind the positions"
    assert np.abs(simulation.theta).max() > 0.0
    assert np.all(simulation.positions[0] == 0.0)


def test_theta_is_a_live_view_that_can_be_written(helix):
    simulation = section_scene(helix)
    theta, free = simulation.theta, list(simulation.free_dofs)
    simulation.step(3)
    assert np.array_equal(theta, simulation.theta)
    rest = simulation.gradient()
    theta[4] += 0.1
    assert simulation.theta[4] == theta[4]
    turned = simulation.gradient()
    place = free.index(simulation.positions.size + 4)
    assert turned[place] > rest[place], "it is held back"
    assert simulation.hessian().shape == (len(free), len(free))


def test_free_dofs_name_every_node_and_edge(helix):
    simulation = section_scene(helix)
    free = simulation.free_dofs
    assert len(free) == simulation.model.num_free == 8 * 3 + 8
    assert set(free) == set(range(3, 27 + 8))


def test_directors_are_unit_vectors_across_the_edges(helix):
    simulation = section_scene(helix)
    assert simulation.directors == pytest.approx(np.tile([0.0, 0.0, 1.0], (8, 1)))
    simulation.step(20)
    directors = simulation.directors
    edges = np.diff(simulation.positions, axis=0)
    assert np.linalg.norm(directors, axis=1) == pytest.approx(np.ones(8))
    across = np.sum(directors[1:] * edges[1:], axis=1) / np.linalg.norm(edges[1:], axis=1)
    assert across == pytest.approx(np.zeros(7), abs=1e-12)
    assert not directors.flags.writeable
    # A turn of an edge's section turns its director about the edge.
    before, angle = directors[3], 0.25
    simulation.theta[3] += angle
    edge = edges[3] / np.linalg.norm(edges[3])
    expected = np.cos(angle) * before + np.sin(angle) * np.cross(edge, before)
    assert simulation.directors[3] == pytest.approx(expected)


@pytest.mark.parametrize("model", ["planar", "spatial_bend"])
def test_models_without_sections_have_no_angles(arm, model):
    simulation = section_scene(arm | {"model": model})
    assert simulation.theta.shape == (0,)
    assert simulation.directors.shape == (0, 3)
    result = simulation.run()
    assert result.sections is None
    assert result.theta.shape == (len(result.times), 0)
    assert result.directors.shape == (len(result.times), 0, 3)
    assert result.positions.shape[2] == (2 if model == "planar" else 3)
    with pytest.raises(der.DerError):
        result.along("arm", "twist")


def test_forces_from_python_act_on_nodes(helix):
    def scene():
        simulation = section_scene(helix)
        simulation.step(3)
        return simulation

    written, added = scene(), scene()
    force = np.zeros((9, 3))
    force[8] = [0.0, 0.0, 0.01]
    written.extra_force[:] = force
    added.add_force(lambda time, positions, velocities: force + 0.0 * positions + 0.0 * velocities)
    written.step(3)
    added.step(3)
    assert np.array_equal(written.positions, added.positions)
    assert np.array_equal(written.theta, added.theta)
    plain = scene()
    plain.step(3)
    assert written.positions[8, 2] > plain.positions[8, 2]


@pytest.mark.parametrize("pickled", [False, True])
def test_a_state_is_saved_and_restored_bit_for_bit(helix, pickled):
    simulation = section_scene(helix)
    simulation.step(7)
    state = simulation.save_state()
    assert np.array_equal(state.positions, simulation.positions)
    assert state.velocities.shape == (9, 3)
    simulation.step(9)
    there = simulation.positions.copy(), simulation.theta.copy(), simulation.directors
    if pickled:
        state = pickle.loads(pickle.dumps(state))
        simulation = section_scene(helix)
    simulation.restore_state(state)
    simulation.step(9)
    assert np.array_equal(simulation.positions, there[0])
    assert np.array_equal(simulation.theta, there[1])
    assert np.array_equal(simulation.directors, there[2])


@pytest.mark.parametrize("view", ["positions", "velocities", "theta"])
def test_a_state_saved_after_a_write_reads_the_same(helix, view):
    simulation, other = section_scene(helix), section_scene(helix)
    simulation.step(7)
    getattr(simulation, view)[2:] += 1e-3
    other.restore_state(simulation.save_state())
    for _ in range(2):
        assert np.array_equal(other.directors, simulation.directors)
        assert other.energies.bend == simulation.energies.bend
        for each in (simulation, other):
            each.step()


def test_a_state_of_another_model_is_refused(arm):
    planar = section_scene(arm).save_state()
    simulation = section_scene(arm | {"model": "spatial"})
    with pytest.raises(ValueError, match="degrees of freedom"):
        simulation.restore_state(planar)


def test_equilibrium_and_modes(cantilever):
    """Small deflections of a cantilever: P L^3 / (3 EI), each about its own axis."""
    simulation = section_scene(cantilever)
    report = simulation.equilibrium()
    assert report.stability == "stable"
    E, w, h, L = 1e8, 0.02, 0.004, 0.4
    tip = simulation.positions[-1]
    across_height, across_width = E * w * h**3 / 12.0, E * h * w**3 / 12.0
    assert abs(tip[1]) == pytest.approx(0.005 * L**3 / (3.0 * across_height), rel=0.01)
    assert tip[2] == pytest.approx(0.01 * L**3 / (3.0 * across_width), rel=0.01)
    modes = simulation.modes(3)
    assert modes.shapes.shape == (3, 9, 3)
    first = 1.8751**2 / (2.0 * np.pi * L**2) * np.sqrt(across_height / (1000.0 * w * h))
    assert modes.frequencies[0] == pytest.approx(first, rel=0.05)
    assert np.all(modes.shapes[:, 0] == 0.0)


# Saved frames and replay


def test_a_result_has_the_sections_of_every_frame(helix):
    simulation = section_scene(helix)
    seen: dict[int, tuple[np.ndarray, ...]] = {
        0: (simulation.positions.copy(), simulation.theta.copy(), simulation.directors)
    }

    def keep(now):
        seen[now.step_count] = now.positions.copy(), now.theta.copy(), now.directors

    result = simulation.run(keep)
    assert result.positions.shape == (11, 9, 3)
    assert result.theta.shape == (11, 8)
    assert result.directors.shape == (11, 8, 3)
    assert result.sections.frames.shape == (11, 8, 8)
    for frame, step in enumerate(result.steps):
        positions, theta, directors = seen[int(step)]
        assert np.array_equal(result.positions[frame], positions)
        assert np.array_equal(result.theta[frame], theta)
        assert np.array_equal(result.directors[frame], directors)


@pytest.mark.parametrize("adaptive", [False, True])
def test_replay_reads_what_probes_recorded(helix, adaptive):
    """The probes of the run saw the state itself, the replay sees what was saved of it."""
    if adaptive:
        helix["time"] = {"duration": 0.04, "tolerance": 1e-4, "integrator": "sdirk4"}
    result = der.run(probed(helix))
    for quantity in QUANTITIES:
        places, values = result.along("strip", quantity)
        for node in (2, 4, 6):
            probe = np.asarray(result.probes[f"{quantity}-{node}"])
            read = np.array([np.interp(0.05 * node, places, row) for row in values])
            scale = np.abs(probe).max()
            assert scale > 0.0, quantity
            assert np.abs(read - probe).max() <= 1e-12 * scale, (quantity, node)


@pytest.mark.parametrize("adaptive", [False, True])
def test_saved_frames_are_those_of_the_saved_shape(helix, adaptive):
    """Also within adaptive steps, which do not end at the frames."""
    if adaptive:
        helix["time"] = {"duration": 0.04, "tolerance": 1e-3, "integrator": "sdirk4"}
    result = der.run(helix)
    edges = np.diff(result.positions, axis=1)[:, 1:]  # beside a clamp an edge is not the chord
    tangents = edges / np.linalg.norm(edges, axis=2, keepdims=True)
    frames = result.sections.frames[:, 1:]
    assert frames[..., :3] == pytest.approx(tangents, abs=1e-12)
    assert np.sum(frames[..., :3] * frames[..., 3:6], axis=2) == pytest.approx(0.0, abs=1e-12)


def test_curvatures_and_twist_are_those_of_the_directors(helix):
    """The section's rotation from edge to edge, by the result's directors alone."""
    helix["rods"][0]["nodes"] = 41
    helix["time"] |= {"duration": 0.02}
    result = der.run(helix)
    t = np.diff(result.positions[-1], axis=0)
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    m1 = result.directors[-1]
    m2 = np.cross(t, m1)
    length = 0.4 / 40
    middle = slice(5, 35)
    between = np.arange(39)
    change = (t[1:] - t[:-1]) / length
    mean1, mean2 = 0.5 * (m1[1:] + m1[:-1]), 0.5 * (m2[1:] + m2[:-1])
    twist = np.sum((m1[1:] - m1[:-1]) / length * mean2, axis=1)
    for quantity, found in (
        ("curvature_1", np.sum(change * mean1, axis=1)),
        ("curvature_2", np.sum(change * mean2, axis=1)),
        ("twist", twist),
    ):
        places, values = result.along("strip", quantity)
        read = np.interp(length * (between + 1), places, values[-1])
        scale = np.abs(read[middle]).max()
        assert np.abs(read - found)[middle].max() < 0.01 * scale, quantity


def test_turning_angles_are_those_of_planar_runs(helix):
    result = der.run(helix)
    with pytest.raises(der.DerError, match="take 'curvature'"):
        result.along("strip", "turning_angle")


def test_a_run_folder_holds_what_was_run(helix, tmp_path):
    result = der.run(probed(helix), out=tmp_path / "written")
    for folder in (tmp_path / "written", result.save(tmp_path / "saved")):
        again = der.open_run(folder)
        assert same_result(again, result)
        for quantity in ("twist", "curvature_1"):
            assert np.array_equal(
                again.along("strip", quantity)[1], result.along("strip", quantity)[1]
            )


def test_planar_files_have_no_sections(arm, tmp_path):
    h5py = pytest.importorskip("h5py")
    der.run(arm, out=tmp_path / "planar")
    der.run(arm | {"model": "spatial"}, out=tmp_path / "spatial")
    with h5py.File(tmp_path / "planar" / "results.h5") as file:
        assert "sections" not in file
    with h5py.File(tmp_path / "spatial" / "results.h5") as file:
        assert file["sections/theta"].shape[1:] == (10,)
        assert file["sections/frames"].shape[1:] == (10, 8)
        assert file["sections/theta"].attrs["unit"] in ("rad", b"rad")
        assert file["sections/spin"].attrs["unit"] in ("rad/s", b"rad/s")


def test_a_stopped_run_is_resumed_to_the_same_bits(helix, tmp_path):
    helix["output"]["every"] = 0.002
    whole = der.run(helix)
    simulation = section_scene(helix)
    simulation.run(until=0.02, out=tmp_path)
    subprocess.run(
        [DER_RUN, tmp_path / "scene.yaml", "--out", tmp_path, "--resume", "--quiet"], check=True
    )
    assert same_result(der.open_run(tmp_path), whole)


def test_a_run_starts_from_the_end_of_another(helix, tmp_path):
    """Two halves, the second from the folder of the first, move as one: the spin is taken over."""
    helix["time"] |= {"integrator": "implicit_midpoint"}
    whole = der.run(helix)
    first = copy.deepcopy(helix)
    first["time"]["duration"] = 0.02
    half = der.run(first, out=tmp_path / "first")
    for folder in (tmp_path / "first", half.save(tmp_path / "copy")):
        second = der.run(first | {"start_from": str(folder)})
        assert second.positions[-1] == pytest.approx(whole.positions[-1], abs=1e-9)
        assert second.directors[-1] == pytest.approx(whole.directors[-1], abs=1e-7)


def test_a_run_of_another_model_is_no_start(arm, tmp_path):
    der.run(arm, out=tmp_path)
    with pytest.raises(der.DerError, match=r"'planar'.*'spatial'"):
        der.run(arm | {"model": "spatial", "start_from": str(tmp_path)})


# Exports


def test_exports_have_three_components_and_the_directors(helix, tmp_path):
    result = der.run(helix)
    nodes, _ = result.export("csv", tmp_path / "tables")
    with nodes.open(encoding="utf-8", newline="") as file:
        titles, *rows = csv.reader(file)
    assert {"z [m]", "vz [m/s]", "twist [rad/m]", "curvature_1 [1/m]", "torque [N m]"} < set(titles)
    assert len(rows) == 11 * 9
    z = [float(row[titles.index("z [m]")]) for row in rows[-9:]]
    assert z == result.positions[-1, :, 2].tolist()
    (path,) = result.export("npz", tmp_path / "run.npz")
    with np.load(path) as arrays:
        assert np.array_equal(arrays["sections/theta"], result.theta)
        assert np.array_equal(arrays["directors"], result.directors)
        assert str(arrays["units/sections/spin"]) == "rad/s"


# Sections and programs


def test_a_section_sweeps_a_mitred_surface():
    """At a right angle the corners of a square tube lie on the bisecting plane."""
    line = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    outline = section_of({"rectangle": {"width": 0.2, "height": 0.1}}).outline
    corners = swept(line, np.array([[0.0, 0.0, 1.0]]), outline)
    assert corners.shape == (3, 8, 3)
    assert np.abs(corners[..., 2]) == pytest.approx(np.full((3, 8), 0.1))
    assert corners[1] @ [1, 1, 0] == pytest.approx(np.full(8, 1.0))
    assert sorted({round(x, 9) for x in corners[1, :, 0].tolist()}) == [0.95, 1.05]


def test_a_program_turns_and_twists_a_clamp():
    scene = {
        "rods": [
            {
                "name": "rod",
                "nodes": 9,
                "from": [0, 0, 0],
                "to": [1, 0, 0],
                "cross_section": {
                    "stiffness": {"EA": 1e4, "EI": 1, "GJ": 2, "mass_per_length": 1},
                },
            }
        ],
        "supports": [
            {"rod": "rod", "at": "start", "clamp": True},
            {
                "rod": "rod",
                "at": "end",
                "clamp": True,
                "prescribe": {"z": 0, "twist": 0, "rotation": {"axis": [0, 1, 0], "angle": 0}},
            },
        ],
        "analysis": "static",
        "output": {"probes": {"torque": {"quantity": "torque", "rod": "rod", "at": "middle"}}},
    }
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    simulation.prescribe(1, twist=1.5)
    simulation.equilibrium()
    # A straight rod: GJ times the twist.
    assert simulation.probes["torque"] == pytest.approx(3.0, rel=1e-9)
    simulation.prescribe(1, twist=0, z=0.1, angle=0.2)
    simulation.equilibrium()
    assert simulation.prescribed(1) == {"z": 0.1, "angle": 0.2, "twist": 0.0}
    assert simulation.positions[-1, 2] == pytest.approx(0.1)
    # The end's tangent falls by 0.2 rad about y, of which the last half cell takes some.
    tangent = simulation.positions[-1] - simulation.positions[-2]
    assert -0.2 < tangent[2] / tangent[0] < 0.0
