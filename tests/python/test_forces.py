"""Forces that Python writes or computes."""

import gc
import weakref
from functools import partial

import der
import numpy as np
import pytest


@pytest.fixture
def scenario(swing):
    return der.Scenario.from_dict(swing)


def test_written_force_equals_a_load_of_the_scene(swing):
    force = [0.3, -0.2]
    swing["loads"].append({"point_force": {"rod": "arm", "at": "end", "force": force}})
    loaded = der.Simulation(der.Scenario.from_dict(swing))
    swing["loads"].pop()
    written = der.Simulation(der.Scenario.from_dict(swing))
    written.extra_force[-1] = force
    loaded.step(100)
    written.step(100)
    assert written.positions == pytest.approx(loaded.positions, abs=1e-9)
    assert np.array_equal(written.extra_force[-1], force), "it stays until it is overwritten"
    assert written.equilibrium().stability == "stable"
    loaded.equilibrium()
    assert written.positions == pytest.approx(loaded.positions, abs=1e-9)


def test_force_function_equals_the_same_force_written_before_each_step(scenario):
    def spring(time, positions, velocities):
        force = np.zeros_like(positions)
        force[-1] = -3.0 * (positions[-1] - [1.0, 0.0]) - 0.1 * velocities[-1] + [0.0, time]
        return force

    written = der.Simulation(scenario)
    while not written.finished:
        written.extra_force[...] = spring(written.time, written.positions, written.velocities)
        written.step()
    one_by_one, at_once, run = (der.Simulation(scenario) for _ in range(3))
    for simulation in (one_by_one, at_once, run):
        assert simulation.add_force(spring) is spring
    while not one_by_one.finished:
        one_by_one.step()
    at_once.step(at_once.total_steps)
    run.run()
    free = der.Simulation(scenario)
    free.step(free.total_steps)
    assert not np.allclose(free.positions, written.positions)
    for simulation in (one_by_one, at_once, run):
        assert np.array_equal(simulation.positions, written.positions)
        assert np.all(simulation.extra_force == 0.0), "the state does not remember them"


def test_functions_add_up_with_what_is_written(scenario):
    written, added = der.Simulation(scenario), der.Simulation(scenario)
    written.extra_force[-1] = [0.0, 0.75]
    added.extra_force[-1] = [0.0, 0.25]
    half = np.zeros((11, 2))
    half[-1, 1] = 0.25
    added.add_force(lambda *_: half)
    added.add_force(lambda *_: half.tolist())
    written.step(10)
    added.step(10)
    assert np.array_equal(added.positions, written.positions)
    assert np.array_equal(added.extra_force[-1], [0.0, 0.25])


def test_equilibrium_includes_functions(scenario):
    written, added = der.Simulation(scenario), der.Simulation(scenario)
    force = np.zeros((11, 2))
    force[-1, 1] = 0.25
    written.extra_force[...] = force
    added.add_force(lambda *_: force)
    written.equilibrium()
    added.equilibrium()
    assert np.array_equal(added.positions, written.positions)


def test_remove(scenario):
    simulation = der.Simulation(scenario)

    @simulation.add_force
    def push(time, positions, velocities):
        return np.ones_like(positions)

    simulation.remove_force(push)
    simulation.step(3)
    free = der.Simulation(scenario)
    free.step(3)
    assert np.array_equal(simulation.positions, free.positions)
    with pytest.raises(ValueError, match="push"):
        simulation.remove_force(push)


@pytest.mark.parametrize(
    ("returned", "words"),
    [
        (np.zeros((2, 11)), r"shape \(2, 11\).*\(11, 2\)"),
        (np.zeros(22), r"shape \(22,\)"),
        (None, r"shape \(\)"),
        (np.full((11, 2), np.nan), "finite"),
    ],
)
def test_a_wrong_force_is_an_error_and_changes_nothing(scenario, returned, words):
    simulation = der.Simulation(scenario)
    simulation.step(2)
    before = simulation.save_state()
    simulation.add_force(lambda *_: returned)
    for act in (simulation.step, simulation.equilibrium, simulation.run):
        with pytest.raises(ValueError, match=words):
            act()
    assert np.array_equal(simulation.positions, before.positions)
    assert np.all(simulation.extra_force == 0.0)
    assert simulation.step_count == 2


def test_an_exception_passes_through_and_leaves_no_force_behind(scenario):
    simulation = der.Simulation(scenario)

    def fails_late(time, positions, velocities):
        if time > 0.019:
            raise LookupError("no such force")
        return np.ones_like(positions)

    simulation.add_force(fails_late)
    with pytest.raises(LookupError, match="no such force"):
        simulation.step(50)
    assert simulation.step_count == 10
    assert np.all(simulation.extra_force == 0.0)
    simulation.remove_force(fails_late)
    simulation.step(50)


def test_a_force_function_must_not_step(scenario):
    simulation = der.Simulation(scenario)
    state = simulation.save_state()
    for act in (
        simulation.step,
        simulation.run,
        simulation.equilibrium,
        lambda: simulation.restore_state(state),
    ):

        def meddle(time, positions, velocities, act=act):
            act()
            return np.zeros_like(positions)

        simulation.add_force(meddle)
        with pytest.raises(RuntimeError, match="busy"):
            simulation.step()
        simulation.remove_force(meddle)
    simulation.step()


def zero_force(simulation, time, positions, velocities):
    return np.zeros_like(simulation.positions)


def test_a_function_that_refers_to_its_simulation_is_collected(scenario):
    simulation = der.Simulation(scenario)
    simulation.add_force(partial(zero_force, simulation))
    simulation.step()
    alive = weakref.ref(simulation)
    del simulation
    gc.collect()
    assert alive() is None
