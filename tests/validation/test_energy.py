"""The energy ledger: what goes in, what goes out, and what the time stepping makes of it.

References: trapezoidal integrals of power, force times velocity, over the recorded steps, which
know nothing of the stepper; exact balances.
"""

import der
import numpy as np
import pytest

DRIVEN = {
    "title": "Driven rod",
    "rods": [
        {
            "name": "rod",
            "points": [[0, 0], [0.3, 0.05], [0.6, 0], [0.9, 0.1]],
            "cross_section": {"stiffness": {"EA": 20, "EI": 0.05, "mass_per_length": 0.2}},
            "spheres": [{"at": "all", "radius": 0.01, "density": 1000}],
        }
    ],
    "supports": [
        {
            "rod": "rod",
            "at": "start",
            "fix": ["x"],
            "prescribe": {"y": {"times": [0, 0.1, 0.4], "values": [0, 0.02, 0.08]}},
        }
    ],
    "loads": [
        {"gravity": [0, -9.81]},
        {"damping": {"coefficient": 0.2}},
        {
            "point_force": {
                "rod": "rod",
                "at": "end",
                "force": {"times": [0, 1], "values": [[0, 0], [2, 4]]},
            }
        },
    ],
}
ORDER_2 = ["implicit_midpoint", "tr_bdf2", "verlet"]
STEPS = [1e-3, 5e-4, 2.5e-4]


def driven(integrator, step):
    time = {"duration": 0.4, "step": step, "integrator": integrator}
    return der.run(der.Scenario.from_dict({**DRIVEN, "time": time, "output": {"every": step}}))


def balance(result):
    """What is left when everything but the numerical loss is taken from the change of energy."""
    total = sum(result.energies.values())
    work = result.work
    came_in = work["loads"] + work["supports"] + work["solver"] - work["drag"]
    return came_in - work["numerical"] - (total - total[0])


@pytest.mark.parametrize("info", der.steppers(), ids=lambda info: info.name)
def test_the_ledger_closes_and_the_solver_leaves_little(info):
    result = driven(info.name, 1e-3)
    scale = max(np.ptp(values) for values in result.energies.values())
    assert np.abs(balance(result)).max() < 1e-12 * scale
    assert np.abs(result.work["solver"]).max() < 1e-8 * scale


@pytest.mark.parametrize("integrator", ORDER_2)
def test_the_numerical_loss_vanishes_at_second_order(fitted_order, integrator):
    """A work that were booked wrongly would not go away with the step."""
    losses = [np.abs(driven(integrator, step).work["numerical"]).max() for step in STEPS]
    assert fitted_order(STEPS, losses) > 1.9


@pytest.mark.parametrize("integrator", ORDER_2)
def test_works_are_the_integrals_of_power(fitted_order, integrator):
    differences = {"loads": [], "drag": []}
    for step in STEPS:
        result = driven(integrator, step)
        times, velocities = result.times, result.velocities
        pull = np.column_stack([2 * times, 4 * times])
        lengths = np.linalg.norm(np.diff(result.positions[0], axis=0), axis=1)
        voronoi = 0.5 * (np.append(lengths, 0) + np.append(0, lengths))
        # The held node's velocity is that over the step, so its drag stands out of the trapezoids.
        drag = 0.2 * np.sum(voronoi[1:, None] * velocities[:, 1:] ** 2, axis=(1, 2))
        held = 0.2 * voronoi[0] * 0.2**2 * times[-1]
        powers = {"loads": np.sum(pull * velocities[:, -1], axis=1), "drag": drag}
        for name, power in powers.items():
            integral = np.trapezoid(power, times) + (held if name == "drag" else 0.0)
            differences[name].append(abs(result.work[name][-1] - integral))
    assert fitted_order(STEPS, differences["loads"]) > 1.9
    assert fitted_order(STEPS, differences["drag"]) > 1.9


def test_the_midpoint_rule_keeps_a_quadratic_energy_exactly():
    """Axial waves in a straight cable: the energy is quadratic, so nothing is lost."""
    scene = {
        "title": "Axial waves",
        "rods": [
            {
                "name": "cable",
                "nodes": 21,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"stiffness": {"EA": 100, "EI": 0, "mass_per_length": 1}},
                "initial_velocity": [0.1, 0],
            }
        ],
        "supports": [{"rod": "cable", "at": "start", "fix": ["x", "y"]}],
        "time": {"duration": 2.0, "step": 0.01, "integrator": "implicit_midpoint"},
    }
    result = der.run(der.Scenario.from_dict(scene))
    total = sum(result.energies.values())
    assert np.abs(result.work["numerical"]).max() < 1e-9 * total[0]
    damped = der.run(der.Scenario.from_dict(scene).with_(**{"time.integrator": "implicit_euler"}))
    assert damped.work["numerical"][-1] > 0.5 * total[0]


@pytest.mark.parametrize("integrator", ORDER_2)
def test_a_clamp_that_turns_and_a_moment_do_work(fitted_order, integrator):
    scene = {
        "title": "Turned",
        "rods": [
            {
                "name": "arm",
                "nodes": 11,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"stiffness": {"EA": 100, "EI": 0.1, "mass_per_length": 0.3}},
            }
        ],
        "supports": [
            {
                "rod": "arm",
                "at": "start",
                "clamp": True,
                "prescribe": {"angle": {"times": [0, 1], "values": [0, 1.0]}},
            }
        ],
        "loads": [{"moment": {"rod": "arm", "at": "end", "moment": 0.05}}],
    }
    losses = []
    for step in STEPS:
        time = {"duration": 1.0, "step": step, "integrator": integrator}
        result = der.run(der.Scenario.from_dict({**scene, "time": time}))
        losses.append(np.abs(result.work["numerical"]).max())
        assert result.work["supports"][-1] > 0.01
        assert abs(result.work["loads"][-1]) > 0.01
    assert fitted_order(STEPS, losses) > 1.9


def test_adaptive_steps_keep_the_ledger():
    time = {"duration": 0.4, "tolerance": 1e-5}
    result = der.run(der.Scenario.from_dict({**DRIVEN, "time": time, "output": {"every": 0.02}}))
    scale = max(np.ptp(values) for values in result.energies.values())
    assert np.abs(balance(result)).max() < 1e-12 * scale
    assert np.abs(result.work["numerical"]).max() < 1e-3 * scale


def test_a_new_start_from_an_equilibrium_starts_a_new_ledger():
    time = {"duration": 0.1, "step": 1e-3}
    simulation = der.Simulation(der.Scenario.from_dict({**DRIVEN, "time": time}))
    simulation.equilibrium()
    result = simulation.run()
    assert result.work["numerical"][0] == pytest.approx(0.0, abs=1e-12)
