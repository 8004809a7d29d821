"""Adaptive steps: the error asked for is the error that comes out.

Reference for the error in time: the same mesh under another method, the midpoint rule in equal
steps of 2e-5 s, whose own error in time (order 2, measured at 1e-3 s) is below 5e-8 m.
"""

import der
import numpy as np
import pytest
import scenes

TOLERANCES = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]


def swing(**time):
    return der.Scenario.from_dict(scenes.swing(21, **time))


@pytest.fixture(scope="module")
def exact():
    return der.run(swing(step=2e-5, integrator="implicit_midpoint")).positions[:, -1]


def error(result, exact):
    return np.linalg.norm(result.positions[:, -1] - exact, axis=1).max()


def test_the_error_follows_the_tolerance_in_a_straight_line(exact, fitted_order):
    errors = [error(der.run(swing(tolerance=t)), exact) for t in TOLERANCES]
    assert fitted_order(TOLERANCES, errors) == pytest.approx(1.0, abs=0.1)
    assert all(e <= t for e, t in zip(errors, TOLERANCES, strict=True))
    # Not wastefully accurate either.
    assert all(e >= 0.05 * t for e, t in zip(errors, TOLERANCES, strict=True))


@pytest.mark.parametrize(
    "integrator", ["implicit_midpoint", "generalized_alpha", "bdf2", "implicit_euler"]
)
def test_every_implicit_stepper_can_adapt(exact, integrator):
    """BDF2 remembers a step of another length, which its estimate does not see: up to 3 times the
    tolerance."""
    for tolerance in (1e-2, 1e-3):
        result = der.run(swing(tolerance=tolerance, integrator=integrator))
        assert error(result, exact) < (3 if integrator == "bdf2" else 2) * tolerance


def test_verlet_adapts_below_its_stable_step(exact):
    result = der.run(swing(tolerance=1e-3, integrator="verlet"))
    assert error(result, exact) < 1e-3


def test_frames_come_at_the_times_asked_for_and_are_as_accurate(exact):
    result = der.run(swing(tolerance=1e-5))
    assert result.times == pytest.approx(np.arange(101) * 0.01, abs=1e-12)
    fine = der.run(swing(step=2e-5, integrator="implicit_midpoint"))
    # The axial modes that the swing excites have up to some 500 rad/s: 5e-3 m/s for 1e-5 m.
    assert result.velocities[:, -1] == pytest.approx(fine.velocities[:, -1], abs=5e-3)


def pulled(**changes):
    """A rod at rest that is pulled from 0.3 s on, and let go at 0.6 s."""
    scene = {
        **scenes.swing(21),
        "loads": [
            {
                "point_force": {
                    "rod": "arm",
                    "at": "end",
                    "force": {
                        "times": [0, 0.3, 0.301, 0.6, 0.601],
                        "values": [[0, 0], [0, 0], [0, 0.5], [0, 0.5], [0, 0]],
                    },
                }
            }
        ],
        "time": {"duration": 1.0, "tolerance": 1e-4, **changes},
    }
    return der.Scenario.from_dict(scene)


def test_breakpoints_of_tables_are_hit_exactly_and_bad_steps_are_counted():
    simulation = der.Simulation(pulled())
    times = []
    while not simulation.finished:
        simulation.step()
        times.append(simulation.time)
    assert {0.3, 0.301, 0.6, 0.601, 1.0} <= set(times)
    # At rest the steps grow long; the pull comes as a surprise.
    assert simulation.counters.rejected_steps > 0
    assert simulation.counters.steps == len(times)
    steps = np.diff([0.0, *times])
    assert steps.max() > 20 * steps.min()


def test_a_load_that_jumps_does_not_spoil_the_error():
    fine = der.run(
        der.Scenario.from_dict(
            {**pulled().to_dict(), "time": {"duration": 1.0, "step": 1e-4, "integrator": "tr_bdf2"}}
        )
    )
    result = der.run(pulled())
    assert error(result, fine.positions[:, -1]) < 1e-4


def test_a_restored_state_goes_on_bit_for_bit():
    simulation = der.Simulation(pulled())
    simulation.step(40)
    saved = simulation.save_state()
    simulation.step(40)
    there = (simulation.time, simulation.positions.copy())
    simulation.restore_state(saved)
    simulation.step(40)
    assert simulation.time == there[0]
    assert np.array_equal(simulation.positions, there[1])


def test_until_is_hit_exactly():
    simulation = der.Simulation(pulled())
    simulation.run(until=0.4321)
    assert simulation.time == 0.4321


def test_a_tolerance_that_cannot_be_met_is_named():
    with pytest.raises(der.NotConvergedError, match="error in time stays above the tolerance"):
        der.run(swing(tolerance=1e-6, minimum_step=5e-3))
