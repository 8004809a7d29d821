"""Adaptive steps: the error asked for is the error that comes out.

References for the error in time: the same mesh under another method. For swings the midpoint rule
in equal steps of 4e-5 s and 2e-5 s, extrapolated at its order 2 from errors of some 5e-8 m; for
the other scenes `verlet` or the midpoint rule in steps of 2e-5 s, that fit the entries of tables.
"""

import der
import numpy as np
import pytest
import scenes
from spatial_scenes import rod_through, section, straight_rod

TOLERANCES = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]
IMPLICIT = [info.name for info in der.steppers() if info.implicit]


def swing(**time):
    return der.Scenario.from_dict(scenes.swing(21, **time))


@pytest.fixture(scope="module")
def exact():
    tight = {"solver.residual_tolerance": 1e-12, "solver.step_tolerance": 1e-13}
    coarse, fine = (
        der.run(swing(step=step, integrator="implicit_midpoint").with_(**tight)).positions[:, -1]
        for step in (4e-5, 2e-5)
    )
    return fine + (fine - coarse) / 3


def error(result, exact):
    return np.linalg.norm(result.positions[:, -1] - exact, axis=1).max()


def test_the_error_follows_the_tolerance_in_a_straight_line(exact, fitted_order):
    errors = [error(der.run(swing(tolerance=t)), exact) for t in TOLERANCES]
    assert fitted_order(TOLERANCES, errors) == pytest.approx(1.0, abs=0.1)
    assert all(e <= t for e, t in zip(errors, TOLERANCES, strict=True))
    # Not wastefully accurate either.
    assert all(e >= 0.05 * t for e, t in zip(errors, TOLERANCES, strict=True))


@pytest.mark.parametrize("integrator", IMPLICIT)
def test_errors_of_every_implicit_stepper_follow_the_tolerance(exact, integrator):
    """The estimate of sdirk4 assumes order 2 in stiff parts: in other parts errors fall faster."""
    asked = TOLERANCES[:3] if integrator == "implicit_euler" else TOLERANCES  # it takes too long
    errors = [error(der.run(swing(tolerance=t, integrator=integrator)), exact) for t in asked]
    assert all(e <= t for e, t in zip(errors, asked, strict=True))
    slope, offset = np.polyfit(np.log10(asked), np.log10(errors), 1)
    assert 0.8 < slope < (1.5 if integrator == "sdirk4" else 1.2)
    assert np.abs(slope * np.log10(asked) + offset - np.log10(errors)).max() < 0.3  # decades


def free_spin():
    """A rod that spins in free flight, ten radians a second, at first not stretched by it."""
    scene = scenes.swing(21)
    scene["rods"][0]["initial_velocity"] = [[0, 10 * (i / 20 - 0.5)] for i in range(21)]
    return {**scene, "supports": [], "loads": []}, 2.0, "verlet"


def shaken():
    """A clamp that moves up and down and turns, with kinks."""
    scene = scenes.swing(21)
    y = {"times": [0, 0.1, 0.2, 0.3, 0.4], "values": [0, 0.1, -0.1, 0.1, 0]}
    angle = {"times": [0, 0.25, 0.5], "values": [0, 0.5, 0]}
    scene["supports"][0]["prescribe"] = {"y": y, "angle": angle}
    return scene, 0.5, "implicit_midpoint"


def let_go():
    """A moment that grows and then vanishes within a hundredth of a second."""
    moment = {"times": [0, 0.3, 0.31, 1], "values": [0, 0.5, 0, 0]}
    load = {"moment": {"rod": "arm", "at": "end", "moment": moment}}
    return {**scenes.swing(21), "loads": [load]}, 1.0, "implicit_midpoint"


@pytest.mark.parametrize("make", [free_spin, shaken, let_go])
def test_errors_stay_below_the_tolerance_in_other_motions(make):
    scene, duration, integrator = make()
    scene["output"] = {"every": duration / 50}

    def positions(**time):
        return der.run({**scene, "time": {"duration": duration, **time}}).positions

    exact = positions(step=2e-5, integrator=integrator)
    for name in IMPLICIT:
        for tolerance in (1e-2, 1e-3, 1e-4):
            if name == "implicit_euler" and tolerance < 1e-2:
                continue  # hundreds of thousands of steps
            found = positions(tolerance=tolerance, integrator=name)
            # Backward Euler takes rotation away, and what it takes adds up over time once more.
            factor = 6 if (name, make) == ("implicit_euler", free_spin) else 1
            worst = np.linalg.norm(found - exact, axis=2).max()
            assert worst <= factor * tolerance, (name, tolerance)


@pytest.mark.parametrize("integrator", [info.name for info in der.steppers() if info.order > 1])
def test_an_edge_shorter_than_the_tolerance_does_not_turn_over(integrator):
    """An edge of 1.3 mm in a bent rod of 1 m that is let go; a tolerance of 1 cm.

    Without a limit of its own it turns over with half of the steppers, and the run fails.
    """
    points = [[0, 0], [0.3, 0.02], [0.3006, 0.0212], [0.62, 0.21], [0.9, 0.12]]
    section = {"stiffness": {"EA": 100, "EI": 1, "mass_per_length": 1}}
    scene = {
        "rods": [{"name": "rod", "points": points, "cross_section": section}],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "output": {"every": 0.1},
    }
    scene["rods"][0]["natural_curvature"] = 0

    def end(**time):
        return der.run({**scene, "time": {"duration": 0.1, **time}}).positions[-1]

    exact = end(step=1e-6, integrator="verlet")
    found = end(tolerance=1e-2, integrator=integrator)
    assert np.linalg.norm(found - exact, axis=1).max() < 2e-3  # as for a tolerance of that edge


def test_verlet_adapts_below_its_stable_step(exact):
    result = der.run(swing(tolerance=1e-3, integrator="verlet"))
    assert error(result, exact) < 1e-3
    stable = der.Simulation(swing(step="auto", integrator="verlet")).time_step / 0.9
    simulation = der.Simulation(swing(tolerance=1e-1, integrator="verlet"))
    times = [0.0]
    while not simulation.finished:
        simulation.step()
        times.append(simulation.time)
    assert 0.5 * stable < np.diff(times).max() <= stable


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
    unmet = "error in time stays above the tolerance: a step of 0.005 s from t = 0 s"
    with pytest.raises(der.NotConvergedError, match=unmet) as failure:
        der.run(swing(tolerance=1e-6, minimum_step=5e-3))
    assert "Shorter steps are below time.minimum_step of 0.005 s: lower that" in str(failure.value)


def test_rounding_that_no_step_makes_smaller_is_named():
    """And nothing else is blamed: no load, no residual."""
    with pytest.raises(der.NotConvergedError, match="rounding of positions") as failure:
        der.run(swing(tolerance=1e-13))
    assert str(failure.value).endswith("raise time.tolerance.")
    assert "load" not in str(failure.value)
    assert "residual" not in str(failure.value)


def test_entries_of_tables_that_are_close_together_in_a_long_run_are_hit():
    jump = [500.0, 500.0 + 1e-7]
    force = {"times": [0, *jump, 1000], "values": [[0, 0], [0, 0], [0, 0.01], [0, 0.01]]}
    scene = scenes.swing(11)
    scene["loads"] = [
        {"point_force": {"rod": "arm", "at": "end", "force": force}},
        {"damping": {"coefficient": 1}},
    ]
    scene["time"] = {"duration": 1000, "tolerance": 1e-2}
    simulation = der.Simulation(scene)
    reached = []
    while simulation.time < 501:
        simulation.step()
        reached.append(simulation.time)
    assert set(jump) <= set(reached)


def test_a_run_of_a_day_needs_no_smaller_minimum_step():
    scene = scenes.swing(11)
    scene["loads"].append({"damping": {"coefficient": 1}})
    scene["time"] = {"duration": 1e5, "tolerance": 1e-2}
    scene["output"] = {"every": 1e4}
    assert der.run(scene).summary["status"] == "completed"


WIRE = {
    "cross_section": {"circle": {"radius": 0.003}},
    "material": {"youngs_modulus": 1e7, "poissons_ratio": 0.45, "density": 1100},
}


def turned_wire(nodes, turn, duration, **changes):
    """A straight wire, 1 m long, whose end is turned about its axis by straight pieces."""
    rod = {"name": "wire", "nodes": nodes, "from": [0, 0, 0], "to": [1, 0, 0], **WIRE}
    twist = {"twist": {"times": [0, 1], "values": [0, turn]}}
    return {
        "rods": [rod],
        "supports": [
            {"rod": "wire", "at": "start", "clamp": True},
            {"rod": "wire", "at": "end", "clamp": True, "prescribe": twist},
        ],
        "loads": [{"damping": {"coefficient": 0.1}}],
        "time": {"duration": duration, "tolerance": 1e-3},
        "output": {"every": duration / 20},
        **changes,
    }


def test_torsional_waves_that_move_no_node_are_damped():
    """The kink starts waves of 0.01 rad. They turned 500 times the tolerance into steps, 22,126 of
    them. What is left is the torque of Saint-Venant, GJ times the twist."""
    scene = turned_wire(41, 3.0, 1.0)
    scene["output"]["probes"] = {"torque": {"quantity": "torque", "rod": "wire", "at": "middle"}}
    result = der.run(scene)
    assert result.summary["steps"] < 200
    GJ = 1e7 / (2 * 1.45) * np.pi * 0.003**4 / 2
    assert result.probes["torque"][-1] == pytest.approx(3.0 * GJ, rel=1e-6)


@pytest.mark.parametrize(
    ("smooth", "tolerance", "most_steps"),
    [(True, 1e-3, 4000), (False, 1e-2, 4000), (False, 0.1, 2000)],
)
def test_a_twisted_wire_that_is_pushed_to_a_loop(smooth, tolerance, most_steps):
    """It writhes, snaps and vibrates. The error is that of all its nodes at all frames, and has
    grown in the snap. Kinks of the tables start waves, which a loose tolerance need not resolve."""
    scene = turned_wire(21, 25.13, 4.0)
    motion = scene["supports"][1]["prescribe"]
    motion["twist"]["smooth"] = smooth
    motion["x"] = {"times": [1, 3], "values": [0, -0.4], "smooth": smooth}
    scene["loads"].append({"gravity": [0, 0, -0.05]})
    fine = {"duration": 4.0, "step": 2e-4, "integrator": "sdirk5"}
    exact = der.run({**scene, "time": fine}).positions
    result = der.run({**scene, "time": {"duration": 4.0, "tolerance": tolerance}})
    assert np.abs(exact[..., 2]).max() > 0.15
    assert np.linalg.norm(result.positions - exact, axis=2).max() < tolerance
    assert result.summary["steps"] < most_steps


def bar_that_swings_about_its_axis(tolerance=None):
    """A clamped, straight bar whose sections spin in its slowest torsional vibration: steps, and
    the angles of its sections after 1.3 periods. Its radius of gyration is a tenth of its length.
    """
    edges, bar = 20, section(EA=1e3, EI=10.0, GJ=2.0, mass_per_length=1.0, rotary_inertia=0.01)
    slowest = np.pi / 2 * np.sqrt(2.0 / 0.01)
    exact = {"step": 1e-4, "integrator": "sdirk5"}
    stepping = exact if tolerance is None else {"tolerance": tolerance}
    time = {"duration": 1.3 * 2 * np.pi / slowest, **stepping}
    simulation = der.Simulation(straight_rod(edges, bar, time=time))
    simulation.spin[:] = slowest * np.sin(np.pi / 2 * (np.arange(edges) + 0.5) / edges)
    result = simulation.run()
    assert np.array_equal(result.positions[-1], result.positions[0])
    return result.summary["steps"], result.theta[-1]


def test_errors_of_angles_follow_the_tolerance_over_the_radius_of_gyration(fitted_order):
    """Where no node moves, it is the sections' own material that does."""
    _, exact = bar_that_swings_about_its_axis()
    assert np.abs(exact).max() > 0.8
    tolerances = [1e-3, 1e-4, 1e-5]
    errors = [
        np.abs(bar_that_swings_about_its_axis(tolerance)[1] - exact).max()
        for tolerance in tolerances
    ]
    assert fitted_order(tolerances, errors) == pytest.approx(1.0, abs=0.15)
    assert all(e <= 10 * t for e, t in zip(errors, tolerances, strict=True))
    assert all(e >= 0.5 * t for e, t in zip(errors, tolerances, strict=True))


def crank():
    """A bar that a weight twists by the arm at its end: torsion is all that lets the arm fall."""
    points = [[0, 0, 0.05 * i] for i in range(11)] + [[0.05 * i, 0, 0.5] for i in range(1, 7)]
    bar = section([0, 1, 0], EA=500, EI=2.0, GJ=0.05, mass_per_length=0.2, rotary_inertia=2e-5)
    scene = rod_through(points, bar, loads=[{"gravity": [0, -1.0, 0]}])
    return scene, 1.0


def strip_that_spins():
    """A bent strip whose clamp turns it about its tangent: it bends and twists as it goes round."""
    s = np.linspace(0, 0.5, 13)
    points = np.column_stack([0 * s, (np.cos(3 * s) - 1) / 3, np.sin(3 * s) / 3])
    strip = section([1, 0, 0], EA=500, EI1=0.04, EI2=0.01, GJ=0.01, mass_per_length=0.3)
    strip["stiffness"]["rotary_inertia"] = 3e-5
    twist = {"twist": {"times": [0, 0.8], "values": [0, 6.0], "smooth": True}}
    support = {**scenes.START, "clamp": True, "prescribe": twist}
    return rod_through(points, strip, supports=[support]), 0.8


def rod_that_unwinds():
    """A bent rod that is drawn without its natural twist and let go, free at both ends."""
    s = np.linspace(0, 0.5, 11)
    points = np.column_stack([(1 - np.cos(4 * s)) / 4, 0 * s, np.sin(4 * s) / 4])
    soft = section([0, 1, 0], EA=500, EI1=0.05, EI2=0.02, GJ=0.02, mass_per_length=0.3)
    soft["stiffness"]["rotary_inertia"] = 1e-4
    return rod_through(points, soft, supports=[], rod={"natural_twist": 3.0}), 0.3


@pytest.mark.parametrize("make", [crank, strip_that_spins, rod_that_unwinds])
def test_errors_follow_the_tolerance_where_torsion_moves_nodes(make, fitted_order):
    scene, duration = make()
    del scene["analysis"]
    scene["output"] = {"every": duration / 20}

    def positions(**time):
        return der.run({**scene, "time": {"duration": duration, **time}}).positions

    exact = positions(step=duration / 20000, integrator="implicit_midpoint")
    size = np.linalg.norm(np.diff(exact[0], axis=0), axis=1).sum()
    tolerances = [1e-2, 1e-3, 1e-4]
    for integrator in ("tr_bdf2", "newmark"):
        errors = []
        for tolerance in tolerances:
            found = positions(tolerance=tolerance, integrator=integrator)
            errors.append(np.linalg.norm(found - exact, axis=2).max() / size)
        assert fitted_order(tolerances, errors) == pytest.approx(1.0, abs=0.3), errors
        assert all(e <= t for e, t in zip(errors, tolerances, strict=True)), errors


def arm_that_curls(radius, moment):
    """An arm in a bearing: a motor turns it to and fro while it is straight, and then it curls."""
    silicone = {"youngs_modulus": 1e6, "poissons_ratio": 0.45, "density": 1100}
    pushes = [0.0, moment, 0.0, 0.0, -moment, 0.0]
    times = [0, 0.15, 0.3, 1, 1.15, 1.3]
    motor = {"times": times, "values": [[m, 0, 0] for m in pushes], "smooth": True}
    curl = {"times": [0, 1.5, 2.5], "values": [0, 0, 6.0], "smooth": True}
    return {
        "rods": [
            {
                "name": "rod",
                "nodes": 11,
                "from": [0, 0, 0],
                "to": [0.3, 0, 0],
                "cross_section": {"circle": {"radius": radius}},
                "material": {**silicone, "damping": 0.002},
                "natural_curvature": [0, 0],
                "natural_twist": 0,
            }
        ],
        "supports": [{"rod": "rod", "at": "start", "clamp": "tangent"}],
        "loads": [
            {"moment": {"rod": "rod", "at": "start", "moment": motor}},
            {"damping": {"coefficient": 0.3}},
        ],
        "actuation": [{"name": "curl", "rod": "rod", "natural_curvature": [curl, 0]}],
        "output": {"every": 0.1},
    }


@pytest.mark.parametrize("integrator", ["tr_bdf2", "implicit_midpoint", "bdf2", "sdirk5"])
@pytest.mark.parametrize("tolerance", [0.1, 1e-2, 1e-3])
def test_the_angle_of_a_rod_that_nothing_holds_counts_as_a_motion(integrator, tolerance):
    """It moves no node while the rod is straight, and is where the rod bends to later."""
    scene = arm_that_curls(0.004, 2e-5)

    def positions(**time):
        return der.run({**scene, "time": {"duration": 3.0, **time}}).positions

    exact = positions(step=1e-3, integrator="sdirk5")
    found = positions(tolerance=tolerance, integrator=integrator)
    assert np.abs(exact[-1][-1][1:]).max() > 0.1
    assert np.linalg.norm(found - exact, axis=2).max() < 0.3 * tolerance
