"""Loads, supports and gravity that follow sines and smooth tables.

References: closed forms of an oscillator and of free fall; scipy's integration of the same
oscillator to 1e-12; modal superposition for a cantilever whose clamp is shaken.
"""

from itertools import pairwise

import der
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

STEPPERS = [info for info in der.steppers() if info.implicit]
EVERY_STEPPER = pytest.mark.parametrize("info", der.steppers(), ids=lambda info: info.name)
IMPLICIT = pytest.mark.parametrize("info", STEPPERS, ids=lambda info: info.name)

# A mass on a bar that stretches: one degree of freedom.
LENGTH, EA, LINE_MASS = 1.0, 40.0, 0.8
SPRING = EA / LENGTH  # [N/m]
MASS = 0.5 * LINE_MASS * LENGTH  # [kg] the free node's half
OWN = np.sqrt(SPRING / MASS)  # [rad/s]


def bar(*, force=(0.0, 0.0), motion=0.0, **rest):
    """Return the scene of the mass, pulled by a force and its bar moved at the foot."""
    section = {"stiffness": {"EA": EA, "EI": 0, "mass_per_length": LINE_MASS}}
    return {
        "rods": [{"name": "bar", "points": [[0, 0], [LENGTH, 0]], "cross_section": section}],
        "supports": [
            {"rod": "bar", "at": "start", "fix": ["y"], "prescribe": {"x": motion}},
            {"rod": "bar", "at": "end", "fix": ["y"]},
        ],
        "loads": [{"point_force": {"rod": "bar", "at": "end", "force": force}}],
        **rest,
    }


def oscillator(info, steps, **driven):
    """Return the displacement of the mass after 1 s."""
    time = {"duration": 1.0, "step": 1.0 / steps, "integrator": info.name}
    result = der.run(bar(**driven, time=time, output={"every": 1.0}))
    return result.positions[-1, 1, 0] - LENGTH


def orders_of(fitted_order, info, exact, **driven):
    """Return the observed order over steps that the integrator resolves."""
    steps = np.array([640, 900, 1280] if info.order <= 2 else [28, 40, 56])
    errors = [abs(oscillator(info, int(n), **driven) - exact) for n in steps]
    assert min(errors) > 1e-13
    return fitted_order(1.0 / steps, errors)


@EVERY_STEPPER
def test_a_sine_force_on_an_oscillator(fitted_order, info):
    """Every order is kept, that of methods with stages beyond the end of a step, too."""
    amplitude, frequency, phase, offset = 1.5, 0.7, 0.4, 0.3
    rate = 2 * np.pi * frequency
    sine = {"amplitude": [amplitude, 0], "frequency": frequency, "phase": phase}
    force = {"sine": {**sine, "offset": [offset, 0]}}
    gain = amplitude / (MASS * (OWN**2 - rate**2))
    rest = offset / SPRING + gain * np.sin(phase)
    exact = offset / SPRING + gain * np.sin(rate + phase) - rest * np.cos(OWN)
    exact -= gain * rate * np.cos(phase) / OWN * np.sin(OWN)
    assert orders_of(fitted_order, info, exact, force=force) > info.order - 0.1


def by_scipy(force, foot, breaks=()):
    """Return the displacement at 1 s; `force` [N] acts on the mass, `foot` [m] moves the bar."""

    def rates(t, y):
        return [y[1], (force(t) - SPRING * (y[0] - foot(t))) / MASS]

    state, times = [0.0, 0.0], [0.0, *breaks, 1.0]
    for piece in pairwise(times):
        state = solve_ivp(rates, piece, state, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return state[0]


def quintic(t, times, values):
    """Return the smooth table at a time, by a polynomial that is fitted to its six conditions."""
    if t <= times[0] or t >= times[-1]:
        return values[0] if t <= times[0] else values[-1]
    i = int(np.searchsorted(times, t, side="right")) - 1
    powers = np.arange(6)
    rows = [
        0.0**powers,
        1.0**powers,
        (powers == 1),
        powers,
        2.0 * (powers == 2),
        powers * (powers - 1),
    ]
    shape = np.linalg.solve(np.array(rows, dtype=float), [0, 1, 0, 0, 0, 0])
    share = float(shape @ ((t - times[i]) / (times[i + 1] - times[i])) ** powers)
    return values[i] + share * (values[i + 1] - values[i])


@IMPLICIT
def test_smooth_tables_on_an_oscillator(fitted_order, info):
    """A force and a support; entries lie within steps, and methods up to order 4 keep it."""
    times, pulls, moves = [0.1, 0.43, 0.77], [0.0, 2.0, -1.0], [0.0, 0.05, 0.02]
    exact = by_scipy(
        lambda t: quintic(t, times, pulls), lambda t: quintic(t, times, moves), breaks=times
    )
    table = {"times": times, "smooth": True}
    driven = {
        "force": {**table, "values": [[pull, 0] for pull in pulls]},
        "motion": {**table, "values": moves},
    }
    assert orders_of(fitted_order, info, exact, **driven) > min(info.order, 4) - 0.2


def test_adaptive_steps_see_every_swing():
    """From rest, with nothing else to tell the error control that a sine is there."""
    rate, pull = 100 * np.pi, 20.0
    force = {"sine": {"amplitude": [pull, 0], "frequency": 50}}
    time = {"duration": 1.0, "tolerance": 0.1, "integrator": "sdirk5"}
    result = der.run(bar(force=force, time=time, output={"every": 0.01}))
    assert result.summary["steps"] >= 200  # four in a period
    gain = pull / (MASS * (OWN**2 - rate**2))
    exact = gain * (np.sin(rate * result.times) - rate / OWN * np.sin(OWN * result.times))
    assert np.abs(result.positions[:, 1, 0] - LENGTH - exact).max() < 0.1 * np.abs(exact).max()


def test_equal_steps_that_hardly_see_a_sine_are_warned_of():
    force = {"sine": {"amplitude": [1, 0], "frequency": 10}}
    for step, warned in ((0.05, True), (0.02, False)):
        result = der.run(bar(force=force, time={"duration": 1.0, "step": step}))
        found = any("a period of 0.1 s" in text for text in result.summary["warnings"])
        assert found == warned


def test_a_shaken_clamp_against_modal_superposition(fitted_order):
    """The clamp moves by A (1 - cos wt), near the first frequency; A is 1e-5 of the length."""
    amplitude, steps = 1e-5, np.array([800, 1131, 1600])
    rod = {
        "name": "rod",
        "nodes": 9,
        "from": [0, 0],
        "to": [1, 0],
        "cross_section": {"stiffness": {"EA": 1e4, "EI": 1.0, "mass_per_length": 1.0}},
    }

    def scene(motion, **rest):
        support = {"rod": "rod", "at": "start", "clamp": True, "prescribe": {"y": motion}}
        return {"rods": [rod], "supports": [support], **rest}

    # The matrices of the engine, the time dependence by hand.
    still = der.Simulation(scene(0, analysis="static"))
    still.equilibrium()
    mass, stiffness = still.mass().toarray(), still.hessian().toarray()
    squares, shapes = eigh(stiffness, mass)
    across = (still.free_dofs % 2 == 1).astype(float)
    rates, shares = np.sqrt(squares), shapes.T @ mass @ across
    rate = 0.9 * rates[np.argmax(np.abs(shares) > 1e-3)]
    duration = 3.0 * 2 * np.pi / rate
    swings = np.cos(rate * duration) - np.cos(rates * duration)
    relative = shapes @ (-shares * amplitude * rate**2 / (rates**2 - rate**2) * swings)
    exact = (relative + across * amplitude * (1 - np.cos(rate * duration)))[-1]
    sine = {"amplitude": amplitude, "frequency": rate / (2 * np.pi), "phase": -0.5 * np.pi}

    def error(integrator, count):
        time = {"duration": duration, "step": duration / count, "integrator": integrator}
        motion = {"sine": {**sine, "offset": amplitude}}
        result = der.run(scene(motion, time=time, output={"every": duration}))
        return abs(result.positions[-1, -1, 1] - exact)

    assert error("sdirk5", 800) < 3e-5 * abs(exact)
    errors = [error("implicit_midpoint", int(n)) for n in steps]
    assert fitted_order(1.0 / steps, errors) > 1.9


def falling(info, step, **rest):
    """A rod that falls in a gravity along y of -9 + 4 sin(2 pi 1.3 t + 0.5)."""
    section = {"stiffness": {"EA": 20, "EI": 0.05, "mass_per_length": 0.4}}
    rod = {"name": "rod", "points": [[1, 2], [1.5, 2], [2, 2]], "cross_section": section}
    rod["initial_velocity"] = [0.5, 1.0]
    sine = {"amplitude": [0, 4], "frequency": 1.3, "phase": 0.5, "offset": [0, -9]}
    return {
        "rods": [rod],
        "loads": [{"gravity": {"sine": sine}}],
        "time": {"duration": 0.6, "step": step, "integrator": info.name},
        "output": {"every": step},
        **rest,
    }


@IMPLICIT
def test_free_fall_in_a_gravity_that_swings(fitted_order, info):
    """Place, energies and ledger against the closed form."""
    steps = np.array([0.004, 0.0025, 0.002]) * (1 if info.order <= 2 else 15)
    rate, mass = 2.6 * np.pi, 0.4
    places, works, losses = [], [], []
    for step in steps:
        result = der.run(falling(info, step))
        t = result.times
        gravity = -9 + 4 * np.sin(rate * t + 0.5)
        speed = 1 - 9 * t - 4 / rate * (np.cos(rate * t + 0.5) - np.cos(0.5))
        fallen = 2 + t - 4.5 * t**2 - 4 / rate**2 * (np.sin(rate * t + 0.5) - np.sin(0.5))
        fallen += 4 / rate * np.cos(0.5) * t
        places.append(np.abs(result.positions[:, 1, 1] - fallen).max())
        # The work of what changes gravity, as it is without any integral.
        came_in = 0.5 * mass * (speed**2 - 1) - mass * (gravity * fallen - gravity[0] * 2)
        works.append(np.abs(result.work["loads"] - came_in).max())
        losses.append(np.abs(result.work["numerical"]).max())
        weight = -mass * gravity * result.positions[:, [0, 1, 1, 2], 1].mean(axis=1)
        assert np.abs(result.energies["gravity"] - weight).max() < 1e-12 * np.abs(weight).max()
    assert fitted_order(steps, places) > info.order - 0.15
    assert fitted_order(steps, works) > min(info.order, 2) - 0.15
    if info.name == "energy_momentum":
        assert max(losses) < 1e-12
    else:
        assert max(losses) < 1e-12 or fitted_order(steps, losses) > min(info.order, 2) - 0.15


def test_buoyancy_follows_gravity():
    """A rod of spheres as heavy as the fluid that they displace does not fall in any gravity."""
    section = {"stiffness": {"EA": 20, "EI": 0.05, "mass_per_length": 0}}
    rod = {"name": "rod", "points": [[0, 0], [0.5, 0], [1, 0]], "cross_section": section}
    rod["spheres"] = [{"at": "all", "radius": 0.05, "density": 900}]
    scene = {**falling(STEPPERS[0], 0.01), "rods": [rod]}
    water = {"fluid": {"density": 900, "viscosity": 0.1}}
    scene["loads"] = [water, *scene["loads"]]
    result = der.run(scene)
    assert np.abs(result.positions - result.positions[0]).max() < 1e-12
