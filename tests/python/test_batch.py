"""Many simulations of one scene on threads: `der.Batch`.

The reference is `der.Simulation` of each member's scene on its own, bit for bit.
"""

import copy
import os
import signal
import subprocess
import sys
import textwrap
import threading
import warnings

import der
import numpy as np
import pytest

EI = "rods.rod.cross_section.stiffness.EI"

PLANAR = {
    "title": "Planar",
    "rods": [
        {
            "name": "rod",
            "nodes": 9,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"stiffness": {"EA": 1e3, "EI": 1e-2, "mass_per_length": 0.1}},
        }
    ],
    "supports": [
        {
            "name": "wall",
            "rod": "rod",
            "at": "start",
            "clamp": True,
            "prescribe": {"x": 0, "angle": 0},
        }
    ],
    "loads": [
        {"name": "weight", "gravity": [0, -9.81]},
        {"name": "push", "point_force": {"rod": "rod", "at": "end", "force": [0, 0]}},
    ],
    "time": {"duration": 1, "step": 0.002},
    "output": {"probes": {"tip": {"rod": "rod", "at": "end", "quantity": "y"}}},
}
SPATIAL = {
    "title": "Spatial",
    "rods": [
        {
            "name": "rod",
            "nodes": 7,
            "from": [0, 0, 0],
            "to": [1, 0, 0],
            "cross_section": {"circle": {"radius": 0.01}},
            "material": {"youngs_modulus": 1e7, "density": 1000, "poissons_ratio": 0.3},
        }
    ],
    "supports": [{"rod": "rod", "at": "start", "clamp": True}],
    "loads": [
        {"gravity": [0, -9.81, 0]},
        {"point_force": {"rod": "rod", "at": "end", "force": [0, 0, 0.05]}},
    ],
    "time": {"duration": 1, "step": 0.002},
}


def with_time(scene, **time):
    changed = copy.deepcopy(scene)
    changed["time"] = {"duration": 1, **time}
    return changed


SCENES = {
    "newmark": (with_time(PLANAR, step=0.002, integrator="newmark"), EI, 1e-2),
    "energy_momentum": (with_time(PLANAR, step=0.002, integrator="energy_momentum"), EI, 1e-2),
    "adaptive": (with_time(PLANAR, tolerance=1e-3, integrator="tr_bdf2"), EI, 1e-2),
    "verlet": (with_time(PLANAR, step=0.0002, integrator="verlet"), EI, 1e-2),
    "spatial_bend": (
        {**SPATIAL, "model": "spatial_bend", "supports": [{"rod": "rod", "at": "start"}]},
        "rods.rod.material.density",
        1000.0,
    ),
    "spatial": (
        {**with_time(SPATIAL, step=0.002, integrator="bdf2"), "model": "spatial"},
        "rods.rod.material.youngs_modulus",
        1e7,
    ),
}
SCENES["spatial_bend"][0]["supports"][0]["clamp"] = "tangent"


def same_bits(a, b):
    return np.asarray(a).tobytes() == np.asarray(b).tobytes()


def assert_same(batch, member, alone):
    for view in ("positions", "velocities", "theta", "spin", "extra_force"):
        assert same_bits(getattr(batch, view)[member], getattr(alone, view)), (member, view)
    assert batch.time[member] == alone.time
    assert batch.step_count[member] == alone.step_count


@pytest.mark.parametrize("threads", [1, 2, 3, 16])
@pytest.mark.parametrize("name", SCENES)
def test_members_have_the_bits_of_simulations(name, threads):
    scene, path, value = SCENES[name]
    values = value * np.linspace(1.0, 1.1, 5)
    batch = der.Batch(scene, 5, threads, vary={path: values})
    batch.extra_force[:, -1, 1] = 0.01
    batch.step(7)
    for _ in range(3):
        batch.step()
    base = der.Scenario.from_dict(scene)
    for i, varied in enumerate(values):
        alone = der.Simulation(base.with_(**{path: varied}))
        alone.extra_force[-1, 1] = 0.01
        alone.step(10)
        assert_same(batch, i, alone)
        assert batch.scenario(i).to_dict() == alone.scenario.to_dict()
    assert batch.model.name == der.Simulation(scene).model.name


def test_views_are_live_and_outlive_the_batch():
    batch = der.Batch(PLANAR, 3)
    positions, time, tips = batch.positions, batch.time, batch.probes["tip"]
    batch.velocities[1, 4:, 1] = 0.5
    batch.step(5)
    assert positions[1, -1, 1] > positions[0, -1, 1]
    assert same_bits(tips, positions[:, -1, 1])
    assert np.array_equal(time, [0.01] * 3)
    assert positions.flags.writeable
    assert not time.flags.writeable
    assert not tips.flags.writeable
    kept = positions.copy()
    del batch
    assert same_bits(kept, positions)


def test_probes_are_those_of_what_was_written():
    batch = der.Batch(PLANAR, 2)
    batch.positions[1, -1, 1] = 0.25
    assert np.array_equal(batch.probes["tip"], [0.0, 0.25])


def test_vectors_vary_too():
    gravities = np.array([[0.0, -9.81], [1.0, 0.0], [0.0, 3.0]])
    batch = der.Batch(PLANAR, 3, vary={"loads.weight.gravity": gravities, EI: [1e-2, 2e-2, 3e-2]})
    batch.step(3)
    alone = der.Simulation(
        der.Scenario.from_dict(PLANAR).with_(**{"loads.weight.gravity": [0.0, 3.0], EI: 3e-2})
    )
    alone.step(3)
    assert_same(batch, 2, alone)


def test_members_tell_how_many_steps_their_scenes_have():
    vary = {"time.duration": [1.0, 0.5, 0.5], "time.step": [0.002, 0.002, 0.001]}
    batch = der.Batch(PLANAR, 3, vary=vary)
    assert batch.total_steps.tolist() == [500, 250, 500]
    assert der.Batch(with_time(PLANAR, tolerance=1e-3), 2).total_steps.tolist() == [0, 0]


def test_member_that_fails_is_masked_and_named():
    batch = der.Batch(PLANAR, 4, 2)
    failed = batch.step(3)
    saved = batch.save_state(2)
    last_good = batch.positions[2].copy()
    batch.velocities[2, 5, 0] = np.nan
    assert batch.step(4) is not failed
    assert np.array_equal(failed, [False, False, True, False])
    (failure,) = batch.failures
    assert (failure.member, failure.status, failure.time) == (2, "diverged", 0.006)
    assert failure.message == (
        "the velocity of node 5 of rod 'rod' (x) is nan, not a finite number: bring the member "
        "back to a good state with 'reset'"
    )
    assert isinstance(failure.error(), der.DivergedError)
    assert same_bits(batch.positions[2], last_good)
    assert np.array_equal(batch.step_count, [7, 7, 3, 7])
    alone = der.Simulation(PLANAR)
    alone.velocities[5, 0] = np.nan
    with pytest.raises(der.DivergedError) as raised:
        alone.step()
    assert failure.message.split(":")[0] == str(raised.value).split(":")[0]
    assert "begin again with a new simulation" in str(raised.value)

    batch.reset(2, saved)
    assert batch.failures == []
    batch.step(4)
    assert_same(batch, 2, alone_after(7))
    assert_same(batch, 3, alone_after(11))


def alone_after(steps, **changes):
    alone = der.Simulation(der.Scenario.from_dict(PLANAR).with_(**changes))
    alone.step(steps)
    return alone


def test_member_that_creates_energy_fails_as_a_simulation_does(swing):
    # Steps that do not resolve the whip of the free end.
    swing["time"] = {"duration": 6, "step": 0.005, "integrator": "implicit_midpoint"}
    alone = der.Simulation(swing)
    with pytest.raises(der.DivergedError) as raised:
        alone.step(1200)
    integrators = ["implicit_euler", "implicit_midpoint"]
    batch = der.Batch(swing, 2, vary={"time.integrator": integrators})
    with pytest.warns(der.UnreliableResultWarning, match="member 1: result unreliable") as told:
        batch.step(400)
    assert [warning.filename for warning in told] == [__file__]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        batch.step(800)
    assert np.array_equal(batch.unreliable, [False, True])
    assert np.array_equal(batch.failed, [False, True])
    (failure,) = batch.failures
    assert (failure.status, failure.message) == (raised.value.status, str(raised.value))
    assert_same(batch, 1, alone)


def test_reset_to_starts_and_states():
    values = np.linspace(1e-2, 2e-2, 6)
    batch = der.Batch(PLANAR, 6, vary={EI: values})
    start = batch.positions.copy()
    batch.step(4)
    states = [batch.save_state(i) for i in range(6)]
    batch.step(4)
    batch.reset(np.arange(6) % 2 == 0)
    assert np.array_equal(batch.step_count, [0, 8, 0, 8, 0, 8])
    assert same_bits(batch.positions[::2], start[::2])
    batch.reset([1, 3], [states[1], states[3]])
    batch.reset(5, states[4])
    assert np.array_equal(batch.step_count, [0, 4, 0, 4, 0, 4])
    assert same_bits(batch.positions[5], states[4].positions)
    batch.step(4)
    assert_same(batch, 0, alone_after(4, **{EI: values[0]}))
    assert_same(batch, 3, alone_after(8, **{EI: values[3]}))
    batch.reset()
    assert same_bits(batch.positions, start)
    alone = der.Simulation(PLANAR)
    alone.restore_state(states[2])
    assert same_bits(alone.positions, states[2].positions)
    with pytest.raises(IndexError):
        batch.reset([6])
    with pytest.raises(ValueError, match="1 states for 2 members"):
        batch.reset([0, 1], [states[0]])
    with pytest.raises(ValueError, match="same rods"):
        batch.reset(0, der.Simulation(SPATIAL).save_state())


def test_values_are_set_for_each_member():
    batch = der.Batch(PLANAR, 3)
    assert batch.names == der.Simulation(PLANAR).names
    batch.set("push", [[0.0, 0.1], [0.0, 0.2], [0.0, 0.3]])
    batch.set("wall", {"angle": [0.0, 0.01, 0.02], "x": 0.001}, over=0.01)
    batch.set("weight.x", [1.0, 2.0, 3.0])
    batch.step(6)
    for i in range(3):
        alone = der.Simulation(PLANAR)
        alone.set("push", [0.0, [0.1, 0.2, 0.3][i]])
        alone.set("wall", {"angle": 0.01 * i, "x": 0.001}, over=0.01)
        alone.set("weight.x", 1.0 + i)
        alone.step(6)
        assert_same(batch, i, alone)
    assert np.array_equal(batch.value("push"), [[0.0, 0.1], [0.0, 0.2], [0.0, 0.3]])
    assert np.array_equal(batch.value("weight.x"), [1.0, 2.0, 3.0])
    batch.prescribe(0, angle=[0.1, 0.2, 0.3], x=0.0)
    batch.step()
    assert np.array_equal(batch.value("wall.angle"), [0.1, 0.2, 0.3])


def change_after_a_write(runs, row):
    """Write into a batch's row, or a simulation's arrays, then change what the scene sets."""
    runs.velocities[(*row, 4, 1)] += 0.003
    runs.set("weight", [0.0, -2.0])
    runs.velocities[(*row, 5, 1)] += 0.001
    runs.prescribe(0, angle=1e-3)
    runs.step(3)


@pytest.mark.parametrize("time", [{"tolerance": 5e-3}, {"step": 0.002}], ids=["adaptive", "equal"])
def test_what_was_written_counts_before_what_is_set_after_it(time):
    scene = with_time(PLANAR, **time)
    batch, alone = der.Batch(scene, 1), der.Simulation(scene)
    change_after_a_write(batch, (0,))
    change_after_a_write(alone, ())
    assert_same(batch, 0, alone)


def test_values_that_do_not_fit_set_nothing():
    batch = der.Batch(PLANAR, 3)
    batch.step()
    with pytest.raises(der.DerError, match=r"member 1: 'push': y must be finite, got nan"):
        batch.set("push", [[0.0, 1.0], [0.0, np.nan], [0.0, 1.0]])
    with pytest.raises(der.DerError, match="has no component 'z'"):
        batch.set("push", {"x": 1.0, "z": 2.0})
    with pytest.raises(der.DerError, match="member 0: the scene does not prescribe y"):
        batch.prescribe(0, x=1.0, y=2.0)
    with pytest.raises(ValueError, match=r"'push' takes values of shape \(3, 2\)"):
        batch.set("push", [1.0, 2.0, 3.0])
    with pytest.raises(der.DerError, match="nothing that could be set has the name 'pull'"):
        batch.set("pull", 1.0)
    masked = np.ma.array([0.1, 0.2, 0.3], mask=[1, 0, 0])
    with pytest.raises(ValueError, match=r"'push\.y': some values are masked"):
        batch.set("push.y", masked)
    with pytest.raises(ValueError, match="'x': some values are masked"):
        batch.prescribe(0, x=masked)
    batch.step()
    assert_same(batch, 2, alone_after(2))


def test_equilibria():
    scene = {k: v for k, v in PLANAR.items() if k != "time"} | {"analysis": "static"}
    values = np.linspace(0.5, 1.0, 5)
    batch = der.Batch(scene, 5, vary={EI: values})
    reports = batch.equilibrium()
    for i, value in enumerate(values):
        alone = der.Simulation(der.Scenario.from_dict(scene).with_(**{EI: value}))
        report = alone.equilibrium()
        assert reports[i].residual == report.residual
        assert reports[i].stability == report.stability
        assert reports[i].out_of_plane.stability == report.out_of_plane.stability
        assert_same(batch, i, alone)
    with pytest.raises(der.DerError, match="a static scene has no time steps"):
        batch.step()


def test_member_without_an_equilibrium_has_failed():
    scene = {k: v for k, v in PLANAR.items() if k != "time"} | {"analysis": "static"}
    batch = der.Batch(scene, 3)
    # A value that is not a number is refused as `Simulation` refuses it.
    batch.extra_force[1, 4, 0] = np.nan
    reports = batch.equilibrium()
    assert [report is None for report in reports] == [False, True, False]
    assert [f.member for f in batch.failures] == [1]


def test_start_from_equilibrium():
    scene = {**PLANAR, "start_from": "equilibrium"}
    values = [0.5, 1.0, 2.0]
    batch = der.Batch(scene, 3, vary={EI: values})
    alike = der.Batch(scene, 2)
    for b, member, alone in (
        (batch, 1, der.Simulation(der.Scenario.from_dict(scene).with_(**{EI: 1.0}))),
        (alike, 1, der.Simulation(scene)),
    ):
        assert_same(b, member, alone)
        b.step(3)
        alone.step(3)
        assert_same(b, member, alone)
        b.reset()
        b.step(3)
        assert_same(b, member, alone)


PUSH = PLANAR["loads"][1]
WIND = {"name": "push", "distributed_force": {"rod": "rod", "force": [0, 0]}}


@pytest.mark.parametrize(
    ("vary", "error", "message"),
    [
        ({"rods.rod.nodes": [9, 9, 8]}, der.DerError, "member 2: only numbers .* 8 nodes"),
        ({"supports.wall.at": ["start", "start", "end"]}, der.DerError, "member 2.* supports hold"),
        ({EI: [1e-2, 0.0, 1e-2]}, der.DerError, "member 1: only numbers"),
        ({EI: [1e-2, np.nan, 1e-2]}, der.SceneError, r"NaN are out of range \(member 1\)"),
        ({EI: [-1.0, 1.0, -2.0]}, der.SceneError, "member 0"),
        ({EI: [1.0, -1.0, -2.0]}, der.SceneError, "member 1 and 1 more"),
        ({"rods.rod.width": [1, 2, 3]}, der.SceneError, "no key 'width'"),
        ({"rods.bar.nodes": [1, 2, 3]}, der.SceneError, "'rods' has no item 'bar'"),
        ({EI: [1.0, 2.0]}, ValueError, "has 2 values for 3 members"),
        ({EI: 1.0}, ValueError, "one value for each of the 3 members, not 1.0"),
        ({EI: {1.0, 2.0, 3.0}}, ValueError, f"vary: '{EI}': a set has no order: write a list"),
        ({EI: {1.0: 1, 2.0: 2, 3.0: 3}}, ValueError, "a dict is one value and no list"),
        ({EI: b"abc"}, ValueError, "bytes are no list of values"),
        ({EI: np.array(1.0)}, ValueError, r"one value for each of the 3 members, not array\(1"),
        ({EI: np.ma.array([1.0, 2, 3], mask=[0, 1, 0])}, ValueError, "some values are masked"),
        ({EI: [1.0, np.ma.masked, 2.0]}, ValueError, "some values are masked"),
        ({EI: [1.0, "x", 2.0]}, der.SceneError, r"member 1"),
        ({EI: [1.0, object(), 2.0]}, der.SceneError, "cannot stand in a scene"),
        (
            {"loads.push.name": ["push", "pull", "push"]},
            der.DerError,
            r"member 1: it has other named loads and supports than member 0: .*pull\.x \(N\)",
        ),
        (
            {"loads.push": [PUSH, PUSH, WIND]},
            der.DerError,
            r"member 2: .*push\.x \(N/m\), .* in place of .*push\.x \(N\)",
        ),
        (
            {"output.probes.tip.quantity": ["y", "y", "vy"]},
            der.DerError,
            r"member 2: it has other probes than member 0: tip \(vy\) in place of tip \(y\)",
        ),
    ],
)
def test_what_cannot_vary_is_refused(vary, error, message):
    with pytest.raises(error, match=message):
        der.Batch(PLANAR, 3, vary=vary)


SPRING = {"rod": "rod", "at": 0.5, "spring": {"stiffness": [0, 9]}}


@pytest.mark.parametrize(
    ("change", "vary", "message"),
    [
        (
            {"loads": [{"foundation": {"rod": "rod", "stiffness": 2.0, "from": 0.2}}]},
            {"rods.rod.to": [[1, 0], [1.8, 0]]},
            "its foundations hold other edges, first at node 0 of rod 'rod': .* vary its 'from'",
        ),
        (
            {"supports": [*PLANAR["supports"], SPRING]},
            {"supports.1.at": [0.5, 0.75]},
            "its springs hold other nodes or edges, first at node 6 of rod 'rod'",
        ),
        (
            {"loads": [{"moment": {"rod": "rod", "at": 0.5, "moment": 0.1}}]},
            {"loads.0.moment.at": [0.5, 0.75]},
            "its moments act on other edges, first at node 5 of rod 'rod'",
        ),
        (
            {},
            {EI: [1e-2, 0]},
            "its rods stretch or bend by other elements, first at node 0 of rod 'rod'",
        ),
    ],
)
def test_elements_that_differ_are_named(change, vary, message):
    with pytest.raises(der.DerError, match=f"member 1: .*{message}"):
        der.Batch({**PLANAR, **change}, 2, vary=vary)


def test_numbers_that_are_no_batch():
    with pytest.raises(ValueError, match="members must be a whole number of at least 1"):
        der.Batch(PLANAR, 0)
    with pytest.raises(ValueError, match="threads must be a whole number of at least 1"):
        der.Batch(PLANAR, 2, threads=0)
    with pytest.raises(ValueError, match=r"threads must be a whole number .* at most 4096"):
        der.Batch(PLANAR, 2, threads=100000)
    batch = der.Batch(PLANAR, 2, threads=7)
    assert (len(batch), batch.threads) == (2, 2)
    assert der.Batch(PLANAR, 1).threads >= 1
    with pytest.raises(ValueError, match="number of steps must be a whole number of at least 0"):
        batch.step(-1)
    with pytest.raises(der.DerError, match="members 0 to 1, but no member 2"):
        batch.scenario(2)


def test_two_threads_must_not_share_a_batch():
    from concurrent.futures import ThreadPoolExecutor

    batch = der.Batch(PLANAR, 64)
    with ThreadPoolExecutor() as pool:
        first = pool.submit(batch.step, 300)
        busy = 0
        while not first.done():
            try:
                batch.value("push")
                batch.set("push", [0.0, 0.0])
            except RuntimeError as refusal:
                busy += "two threads must not share it" in str(refusal)
        first.result()
    assert busy


def test_ctrl_c_ends_a_step():
    batch = der.Batch(PLANAR, 4, 2)
    batch.step(2)
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        batch.step(100_000_000)
    assert not batch.failed.any()
    assert (batch.step_count > 2).any()
    batch.step()
    assert_same(batch, 0, alone_after(int(batch.step_count[0])))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_batch_goes_on_in_a_forked_process():
    program = f"""
        import os, sys
        import der
        batch = der.Batch({PLANAR!r}, 4, 3)
        batch.step(2)
        child = os.fork()
        batch.step(3)
        good = (batch.step_count == 5).all()
        if child == 0:
            os._exit(0 if good else 1)
        assert good and os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    """
    line = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(program)]
    assert subprocess.run(line, timeout=60, check=False).returncode == 0


def test_curvatures_that_the_mesh_hardly_resolves_are_warned_of():
    scene = {
        "rods": [
            {
                "name": "r",
                "nodes": 11,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"stiffness": {"EA": 1e4, "EI": 1.0, "mass_per_length": 1.0}},
            }
        ],
        "supports": [{"rod": "r", "at": "start", "clamp": True}],
        "actuation": [{"name": "bend", "rod": "r", "natural_curvature": 0.0}],
        "time": {"duration": 1, "step": 0.01, "integrator": "implicit_euler"},
    }
    batch = der.Batch(der.Scenario.from_dict(scene), 3)
    with pytest.warns(der.DerWarning, match=r"member 1: .*\(and likewise in 1 more members\)"):
        batch.set("bend", [0.0, 20.0, 20.0])
