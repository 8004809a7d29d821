"""The engine driven from Python: live views, saved states, the same result in every way."""

import gc
import pickle
import subprocess
import sys
import warnings
import weakref
from contextlib import nullcontext
from itertools import pairwise

import der
import numpy as np
import pytest


@pytest.fixture
def simulation(swing):
    return der.Simulation(der.Scenario.from_dict(swing))


def test_views_have_the_shape_and_the_memory_of_the_engine(simulation):
    for view in (simulation.positions, simulation.velocities, simulation.extra_force):
        assert view.shape == (11, 2)
        assert view.dtype == np.float64
        assert view.flags.writeable
        assert view.flags.c_contiguous
        assert not view.flags.owndata
    assert np.shares_memory(simulation.positions, simulation.positions)


def test_views_follow_the_engine(simulation):
    positions, velocities = simulation.positions, simulation.velocities
    before = positions.copy()
    simulation.step(5)
    assert not np.array_equal(positions, before)
    assert np.array_equal(positions, simulation.positions)
    assert velocities[-1, 1] < 0.0
    simulation.equilibrium()
    assert np.array_equal(positions, simulation.positions)
    assert np.all(velocities == 0.0)


@pytest.mark.parametrize("integrator", [info.name for info in der.steppers()])
def test_after_an_equilibrium_no_stepper_remembers_the_steps_before(swing, integrator):
    swing["time"] |= {"integrator": integrator}
    if integrator in ("verlet", "explicit_euler"):
        swing["time"]["step"] = "auto"
    used, fresh = der.Simulation(swing), der.Simulation(swing)
    used.step(10)
    for simulation in (used, fresh):
        simulation.equilibrium()
    fresh.positions[...] = used.positions
    for simulation in (used, fresh):
        simulation.velocities[1:] = [0.0, 1.0]
        simulation.step(10)
    # The equilibria agree to the solver's tolerance; the times, which no load depends on, do not.
    assert np.abs(used.positions - fresh.positions).max() < 1e-13
    assert np.abs(used.velocities - fresh.velocities).max() < 1e-9


def test_the_engine_sees_what_is_written(simulation):
    untouched = der.Simulation(simulation.scenario)
    untouched.step()
    simulation.velocities[-1] = [0.0, 3.0]
    # A uniform edge of twice the end node's mass with one end at rest: 1/2 (m/3) v^2.
    edge_mass = 2.0 * simulation.node_masses[-1]
    assert simulation.energies.kinetic == pytest.approx(0.5 * edge_mass / 3.0 * 9.0)
    simulation.step()
    assert simulation.positions[-1, 1] > untouched.positions[-1, 1] + 0.003
    simulation.positions[...] = untouched.positions
    simulation.velocities[...] = untouched.velocities
    untouched.step()
    simulation.step()
    assert simulation.positions == pytest.approx(untouched.positions, abs=1e-12)


def test_held_nodes_return_to_their_place(simulation):
    """A warning says so, once."""
    for answer in (
        pytest.warns(
            der.DerWarning, match=r"node 0 of rod '\w+' .* at 0\.5 m, .* at 0 m at t = 0 s"
        ),
        nullcontext(),
    ):
        simulation.positions[0] = [0.5, 0.5]
        with answer, warnings.catch_warnings():
            if isinstance(answer, nullcontext):
                warnings.simplefilter("error")
            simulation.step()
        assert np.array_equal(simulation.positions[0], [0.0, 0.0])


@pytest.mark.parametrize("arrives_by", ["equilibrium", "step", ""])
def test_supports_arrive_before_a_shape_is_written(swing, arrives_by):
    """Whatever is written, prescribe moves a support during the next step."""
    swing["supports"][0] = {"rod": "arm", "at": "start", "clamp": True, "prescribe": {"x": 0}}
    simulation = der.Simulation(swing)
    shape = simulation.positions + np.array([0.3, 0.0])
    simulation.prescribe(0, x=0.3)
    if arrives_by:
        getattr(simulation, arrives_by)()
    simulation.positions[...] = shape
    simulation.velocities[...] = 0.0
    with nullcontext() if arrives_by else pytest.warns(der.DerWarning, match="arrive before"):
        simulation.step()
    moved = np.abs(simulation.positions - shape).max()
    assert moved < 0.01 if arrives_by else moved > 0.1


def test_supports_move_on_from_a_shape_once_it_is_entered():
    """Without the equilibrium between, the clamp counts as turned already in the written shape."""
    stiffness = {"EA": 1e5, "EI": 1, "GJ": 0.8, "mass_per_length": 1}
    wire = {"name": "wire", "nodes": 11, "from": [0, 0, 0], "to": [1, 0, 0]}
    clamp = {"rod": "wire", "clamp": True}
    scene = {
        "rods": [wire | {"cross_section": {"stiffness": stiffness}}],
        "supports": [
            clamp | {"at": "start"},
            clamp | {"at": "end", "prescribe": {"x": 0, "twist": 0}},
        ],
        "loads": [{"distributed_force": {"rod": "wire", "force": [0, 0, -0.5]}}],
        "analysis": "static",
    }
    known = der.Simulation(scene)
    known.prescribe(1, x=-0.1, twist=1.0)
    known.equilibrium()
    kept = known.energies.elastic
    found = {}
    for entered in (False, True):
        simulation = der.Simulation(scene)
        simulation.prescribe(1, x=-0.1, twist=1.0)
        simulation.positions[...], simulation.theta[...] = known.positions, known.theta
        if entered:
            simulation.equilibrium()
        simulation.prescribe(1, twist=1.0 + 2.0 * np.pi)
        simulation.equilibrium()
        found[entered] = simulation.energies.elastic
    known.prescribe(1, twist=1.0 + 2.0 * np.pi)
    known.equilibrium()
    assert found[True] == pytest.approx(known.energies.elastic, rel=1e-6)
    assert found[False] == pytest.approx(kept, rel=1e-6)
    assert found[True] > 2.0 * found[False]


def test_views_do_not_move_and_outlive_the_name_of_the_simulation(simulation, swing):
    address = simulation.positions.ctypes.data
    saved = simulation.save_state()
    simulation.step(20)
    simulation.equilibrium()
    simulation.restore_state(saved)
    simulation.run()
    assert simulation.positions.ctypes.data == address

    other = der.Simulation(der.Scenario.from_dict(swing))
    other.step(3)
    positions, expected = other.positions, other.positions.copy()
    rods, model = other.model.rods, other.model
    del other
    gc.collect()
    der.Simulation(der.Scenario.from_dict(swing)).step(3)  # would reuse freed memory
    assert np.array_equal(positions, expected)
    assert model.num_nodes == 11
    assert rods[0].name == "arm"


def test_the_collector_may_come_while_the_first_simulation_is_made(swing):
    """It met an object that pybind11 had not laid out yet, and the process died."""
    code = f"""
import gc, der
class Own(der.Simulation): pass
scenario = der.Scenario.from_dict({swing})
gc.set_threshold(1)
Own(scenario)
der.Simulation(scenario)
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_simulation_goes_away_with_its_last_view(swing):
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    alive = weakref.ref(simulation)
    view = simulation.positions
    del simulation
    gc.collect()
    assert alive() is not None
    del view
    gc.collect()
    assert alive() is None


def test_step_n_and_run_agree_bit_for_bit(swing):
    scenario = der.Scenario.from_dict(swing)
    one_by_one = der.Simulation(scenario)
    while not one_by_one.finished:
        one_by_one.step()
    at_once = der.Simulation(scenario)
    at_once.step(at_once.total_steps)
    run = der.Simulation(scenario)
    result = run.run()
    recorded = der.run(scenario)
    for simulation in (at_once, run):
        assert simulation.time == one_by_one.time == pytest.approx(0.2)
        assert np.array_equal(simulation.positions, one_by_one.positions)
        assert np.array_equal(simulation.velocities, one_by_one.velocities)
    for frames in (result, recorded):
        assert np.array_equal(frames.positions[-1], one_by_one.positions)
        assert np.array_equal(frames.velocities[-1], one_by_one.velocities)


def test_counts(simulation):
    assert (simulation.step_count, simulation.total_steps, simulation.finished) == (0, 100, False)
    simulation.step()
    simulation.step(9)
    simulation.step(0)
    assert simulation.step_count == simulation.counters.steps == 10
    assert simulation.counters.newton_iterations >= 10
    assert simulation.time == pytest.approx(0.02)
    simulation.step(95)
    assert simulation.finished, "stepping goes on beyond the scene's end"
    with pytest.raises(ValueError, match="number of steps must be a whole number of at least 0"):
        simulation.step(-1)


@pytest.mark.parametrize("way", ["direct", "pickled"])
def test_save_and_restore_bit_for_bit(swing, way):
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    simulation.step(30)
    simulation.extra_force[-1] = [0.1, 0.2]
    state = simulation.save_state()
    if way == "pickled":
        dumped = pickle.dumps(state)
        state = pickle.loads(dumped)
        assert pickle.dumps(state) == dumped
    assert (state.time, state.step_count) == (simulation.time, 30)
    assert np.array_equal(state.positions, simulation.positions)
    simulation.step(40)
    first = simulation.positions.copy()
    assert not np.array_equal(state.positions, first), "a saved state is a copy"

    simulation.restore_state(state)
    assert simulation.step_count == 30
    assert np.array_equal(simulation.extra_force[-1], [0.1, 0.2])
    simulation.step(40)
    assert np.array_equal(simulation.positions, first)

    other = der.Simulation(der.Scenario.from_dict(swing))
    other.restore_state(state)
    other.step(40)
    assert np.array_equal(other.positions, first)


def test_a_state_saved_after_a_write_knows_its_energy(swing):
    """What a program has written is not energy that the integrator creates, here or after a
    restore: both go on bit for bit."""
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    simulation.step(30)
    simulation.velocities[1:] += 30.0
    other = der.Simulation(der.Scenario.from_dict(swing))
    other.restore_state(simulation.save_state())
    with warnings.catch_warnings():
        warnings.simplefilter("error", der.UnreliableResultWarning)
        for each in (simulation, other):
            each.step(20)
    assert pickle.dumps(other.save_state()) == pickle.dumps(simulation.save_state())


def test_a_saved_state_is_read_only_and_must_fit(simulation, tube):
    state = simulation.save_state()
    with pytest.raises(ValueError, match="read-only"):
        state.positions[0, 0] = 1.0
    other = der.Simulation(der.Scenario.from_dict(tube))
    with pytest.raises(ValueError, match="22 degrees of freedom"):
        other.restore_state(state)


def test_mass_and_model(simulation):
    density_length_area = 1000 * 1.0 * np.pi * 0.01**2
    assert simulation.node_masses.shape == (11,)
    assert simulation.node_masses.sum() == pytest.approx(density_length_area)
    assert not simulation.node_masses.flags.writeable
    model = simulation.model
    assert (model.name, model.dimension, model.num_nodes) == ("planar", 2, 11)
    assert (model.num_dofs, model.num_free) == (22, 20)
    assert model.reason
    assert simulation.linear_solver
    assert simulation.linear_solver_reason
    assert simulation.integrator == "implicit_euler"
    (rod,) = model.rods
    assert rod.name == "arm"
    assert rod.nodes.tolist() == list(range(11))
    assert rod.arc_lengths == pytest.approx(np.linspace(0.0, 1.0, 11))
    assert (rod.length, rod.radius) == pytest.approx((1.0, 0.01))
    assert np.array_equal(rod.sphere_radii, np.zeros(11))
    bending_stiffness = 1e7 * np.pi / 4 * 0.01**4
    assert bending_stiffness == pytest.approx(rod.EI)
    assert model.initial_positions[-1] == pytest.approx([1.0, 0.0])


def test_energies_are_those_of_positions_and_velocities(simulation):
    energies = simulation.energies
    assert energies.total == pytest.approx(0.0, abs=1e-12)
    simulation.step(10)
    energies = simulation.energies
    parts = (energies.kinetic, energies.elastic, energies.gravity)
    assert energies.kinetic > 0.0 > energies.gravity
    assert energies.elastic == pytest.approx(energies.stretch + energies.bend + energies.spring)
    assert energies.total == pytest.approx(sum(parts))
    # Edges are uniform bars, but for the first one, which is held at one end and so stays lumped.
    v = simulation.velocities
    edge_mass = 2.0 * simulation.node_masses[-1]
    kinetic = 0.25 * edge_mass * np.sum(v[1] ** 2)
    for a, b in pairwise(v[1:]):
        kinetic += edge_mass / 6.0 * (a @ a + a @ b + b @ b)
    assert energies.kinetic == pytest.approx(kinetic)
    assert energies.gravity == pytest.approx(
        9.81 * np.sum(simulation.node_masses * simulation.positions[:, 1])
    )


def test_probes_of_the_present_state(simulation):
    simulation.step(7)
    assert simulation.probes == {"tip": pytest.approx(simulation.positions[-1, 1])}


def test_equilibrium_of_a_simulation(simulation):
    report = simulation.equilibrium()
    assert report.residual <= 1e-9 * report.force_scale
    assert report.stability == "stable"
    settled = simulation.positions.copy()
    simulation.step(10)
    assert simulation.positions == pytest.approx(settled, abs=1e-7)


@pytest.mark.parametrize("call", ["equilibrium", "modes"])
@pytest.mark.parametrize(
    ("view", "what"), [("positions", "the position"), ("extra_force", "the extra force")]
)
def test_what_is_not_a_number_is_named(swing, call, view, what):
    simulation = der.Simulation(swing)
    getattr(simulation, view)[3, 1] = np.nan
    with pytest.raises(der.DerError, match=rf"{what} of node 3 of rod 'arm' \(y\) is nan"):
        getattr(simulation, call)()


def test_equilibrium_without_supports_is_an_error(swing):
    swing["supports"] = []
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    before = simulation.positions.copy()
    with pytest.raises(der.NotConvergedError) as caught:
        simulation.equilibrium()
    assert caught.value.status == "not_held"
    assert isinstance(caught.value, der.DerError)
    assert np.array_equal(simulation.positions, before)


def test_a_step_of_a_static_scene_is_an_error(tube):
    del tube["time"], tube["output"]["every"]
    simulation = der.Simulation(der.Scenario.from_dict({**tube, "analysis": "static"}))
    with pytest.raises(der.DerError, match="static"):
        simulation.step()


def test_divergence_is_an_error_of_its_own(unstable):
    simulation = der.Simulation(der.Scenario.from_dict(unstable))
    with pytest.raises(der.DivergedError, match=r"time\.step") as caught:
        simulation.step(10_000)
    assert caught.value.status == "diverged"
    assert np.all(np.isfinite(simulation.positions))


def test_repr_tells_what_it_is(simulation):
    assert "Swinging rod" in repr(simulation)
    assert "11 nodes" in repr(simulation)


def test_hessian_is_the_derivative_of_the_gradient(swing):
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    simulation.step(3)
    hessian = simulation.hessian()
    free = simulation.free_dofs
    assert hessian.shape == (free.size, free.size)
    assert abs(hessian - hessian.T).max() == 0.0
    flat = simulation.positions.reshape(-1)
    start = flat.copy()
    step = 1e-7
    for column in (0, free.size // 2, free.size - 1):
        flat[free[column]] = start[free[column]] + step
        forward = simulation.gradient()
        flat[free[column]] = start[free[column]] - step
        difference = (forward - simulation.gradient()) / (2 * step)
        flat[:] = start
        expected = hessian[:, [column]].toarray().ravel()
        assert difference == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


def test_gradient_vanishes_in_equilibrium_and_mass_is_that_of_the_nodes(swing):
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    report = simulation.equilibrium()
    assert np.abs(simulation.gradient()).max() <= 1e-8 * report.force_scale
    mass = simulation.mass()
    assert mass.shape == simulation.hessian().shape
    # Half an edge on the last node, of which a third couples it to the next.
    assert mass.diagonal()[-1] == pytest.approx(2 / 3 * simulation.node_masses[-1])
    velocities = np.zeros(simulation.positions.size)
    velocities[simulation.free_dofs] = np.linspace(-1, 2, len(simulation.free_dofs))
    simulation.velocities[...] = velocities.reshape(simulation.velocities.shape)
    moving = velocities[simulation.free_dofs]
    assert 0.5 * moving @ mass @ moving == pytest.approx(simulation.energies.kinetic)


@pytest.fixture
def turning(swing):
    swing["supports"][0]["prescribe"] = {"y": 0, "angle": 0}
    return der.Simulation(der.Scenario.from_dict(swing))


def test_supports_can_be_moved_from_step_to_step(turning, swing):
    swing["supports"][0]["prescribe"]["angle"] = {"times": [0, 1], "values": [0, 5]}
    by_table = der.Simulation(der.Scenario.from_dict(swing))
    while not turning.finished:
        turning.prescribe(0, angle=5 * (turning.time + turning.time_step))
        turning.step()
        by_table.step()
    assert turning.positions == pytest.approx(by_table.positions, abs=1e-10)
    assert turning.prescribed(0) == {"y": 0.0, "angle": pytest.approx(1.0)}


def test_a_callback_can_move_supports(turning):
    def rise(simulation):
        simulation.prescribe(0, y=simulation.time)

    result = turning.run(rise)
    # A value that is set after a step is reached at the end of the next one.
    assert result.positions[-1, 0, 1] == pytest.approx(result.times[-1] - turning.time_step)


def test_moved_supports_are_part_of_a_saved_state(turning):
    turning.prescribe(0, angle=0.2)
    state = pickle.loads(pickle.dumps(turning.save_state()))
    turning.step(3)
    once = turning.positions.copy()
    turning.prescribe(0, angle=-0.3)
    turning.step()
    turning.restore_state(state)
    turning.step(3)
    assert np.array_equal(turning.positions, once)


def test_only_what_the_scene_prescribes_can_be_moved(turning, tube):
    with pytest.raises(der.DerError, match=r"prescribe: \{x: 0\}"):
        turning.prescribe(0, x=1.0)
    with pytest.raises(der.DerError, match="it prescribes nothing"):
        der.Simulation(der.Scenario.from_dict(tube)).prescribe(0, angle=1.0)
