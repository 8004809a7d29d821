"""Elastic supports against closed forms of beam theory, wherever the springs stand.

Loads are so small that nothing is left of the large deflection; the elastic clamp under a large one
is in `references/springs.py`.
"""

import der
import numpy as np
import pytest
from scenes import END, START, straight, tip_force
from scipy.optimize import brentq

SIZES = [20, 40, 80, 160]
STEPS = [1 / n for n in SIZES]
P = 1e-5  # times EI/L^2
PLACES = [0.0, 0.02, 0.3, 0.3717, 0.6180]


def settled(scene):
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    report = simulation.equilibrium()
    assert report.stability == "stable"
    return simulation


def force_at(place, *force):
    return {"point_force": {"rod": "rod", "at": place, "force": list(force)}}


def deflection(n, supports, loads, at):
    """Downward displacement of a place, in units of the load."""
    scene = straight(n, "free-free", 1e6, loads=loads)
    scene["supports"] = supports
    scene["output"] = {"probes": {"y": {"rod": "rod", "at": at, "quantity": "y"}}}
    return -der.run(der.Scenario.from_dict(scene)).probes["y"][-1] / P


def check_second_order(found, exact, fitted_order):
    """Order 2, and an error of order 2 that is negligible against the answer."""
    errors = np.abs(np.array(found) / exact - 1)
    assert errors[-1] < 2e-3
    if errors.max() > 1e-6:  # else it is exact but for the large deflection and the stretching
        assert fitted_order(STEPS, errors) > 1.9


def test_a_beam_on_end_springs(fitted_order):
    a, k = 0.3717, 20.0
    supports = [
        {**START, "fix": ["x"], "spring": {"stiffness": [0, k]}},
        {**END, "spring": {"stiffness": [0, k]}},
    ]
    found = [deflection(n, supports, [force_at(a, 0, -P)], a) for n in SIZES]
    exact = (a * (1 - a)) ** 2 / 3 + (a**2 + (1 - a) ** 2) / k
    check_second_order(found, exact, fitted_order)


@pytest.mark.parametrize("k", [1.0, 1e3, 1e7])
@pytest.mark.parametrize("s", PLACES[2:])
def test_a_spring_at_any_place_of_a_cantilever(fitted_order, s, k):
    supports = [{**START, "clamp": True}, {"rod": "rod", "at": s, "spring": {"stiffness": [0, k]}}]
    found = [deflection(n, supports, tip_force(0, -P), "end") for n in SIZES]
    across = s**2 * (3 - s) / 6
    exact = 1 / 3 - across**2 / (1 / k + s**3 / 3)
    check_second_order(found, exact, fitted_order)


@pytest.mark.parametrize("k", [0.1, 1.0, 10.0, 1e4, 1e9])
@pytest.mark.parametrize("end", ["start", "end"])
def test_an_elastic_clamp(fitted_order, end, k):
    supports = [{"rod": "rod", "at": end, "fix": ["x", "y"], "spring": {"rotational_stiffness": k}}]
    free = "end" if end == "start" else "start"
    load = 1e-2 * min(1.0, k)
    found = [deflection(n, supports, [force_at(free, 0, -P * load)], free) / load for n in SIZES]
    check_second_order(found, 1 / 3 + 1 / k, fitted_order)


def test_a_stiff_elastic_clamp_is_a_clamp():
    """Both are without an error of order 2 in linear theory, so they differ by order 3."""
    elastic = [{**START, "fix": ["x", "y"], "spring": {"rotational_stiffness": 1e12}}]
    clamp = [{**START, "clamp": True}]
    for n in SIZES:
        differ = [deflection(n, held, tip_force(0, -P), "end") for held in (elastic, clamp)]
        assert abs(differ[0] - differ[1]) < 0.3 / n**3


@pytest.mark.parametrize("load", ["1", "10"])
@pytest.mark.parametrize("k", ["1", "20"])
def test_an_elastic_clamp_under_a_large_load(reference, fitted_order, load, k):
    exact = [reference("springs", f"elastic_clamp.{k}.load.{load}.{c}") for c in "xy"]
    errors = []
    sizes = [2 * n for n in SIZES]
    for n in sizes:
        scene = straight(n, "free-free", 1e9, loads=tip_force(0, -float(load)))
        spring = {"rotational_stiffness": float(k)}
        scene["supports"] = [{**START, "fix": ["x", "y"], "spring": spring}]
        x, y = settled(scene).positions[-1]
        errors.append(np.hypot(x - exact[0], -y - exact[1]))
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


@pytest.mark.parametrize("k", [1.0, 1e6])
@pytest.mark.parametrize("s", PLACES)
def test_a_spring_against_turning_at_any_place(fitted_order, s, k):
    a = 0.75
    b = 1 - a
    supports = [
        {**START, "fix": ["x", "y"]},
        {**END, "fix": ["y"]},
        {"rod": "rod", "at": s, "spring": {"rotational_stiffness": k}},
    ]
    found = [deflection(n, supports, [force_at(a, 0, -P)], a) for n in SIZES]
    turn = b * (1 - b**2 - 3 * s**2) / 6  # at s by a unit force at a, and the other way round
    exact = (a * b) ** 2 / 3 - turn**2 / (1 / k + (s**3 + (1 - s) ** 3) / 3)
    check_second_order(found, exact, fitted_order)


@pytest.mark.parametrize("place", ["start", "end", 0.3717])
def test_a_moment_where_a_spring_is(fitted_order, place):
    """Both bend the cell between them and the chain."""
    k, s = 7.0, {"start": 0.0, "end": 1.0}.get(place, place)
    supports = [
        {**START, "fix": ["x", "y"]},
        {**END, "fix": ["y"]},
        {"rod": "rod", "at": place, "spring": {"rotational_stiffness": k}},
    ]
    b, at = 1 - s, 0.75
    moment = [{"moment": {"rod": "rod", "at": place, "moment": -P}}]
    found = [deflection(n, supports, moment, at) for n in SIZES]
    turn = 1 / (k + 3 / (s**3 + b**3))
    left = -(1 - k * turn) * at * (1 - 3 * b**2 - at**2) / 6
    right = (1 - k * turn) * (1 - at) * (1 - 3 * s**2 - (1 - at) ** 2) / 6
    check_second_order(found, left if at < s else right, fitted_order)


def test_two_springs_at_one_place_add_up():
    def tip(*stiffness):
        springs = [{**START, "spring": {"rotational_stiffness": k}} for k in stiffness]
        return deflection(20, [{**START, "fix": ["x", "y"]}, *springs], tip_force(0, -P), "end")

    assert tip(1.0, 2.0, 3.0) == pytest.approx(tip(6.0), rel=1e-9)


@pytest.mark.parametrize("end", ["start", "end"])
def test_a_naturally_curved_rod_keeps_the_direction_of_its_spring(fitted_order, end):
    """Nothing is stressed: an arc that starts in the initial direction, however soft the spring."""
    errors = []
    for n in SIZES:
        scene = straight(n, "free-free", 1e9)
        scene["rods"][0]["natural_curvature"] = 1.0
        spring = {"rotational_stiffness": 0.1}
        scene["supports"] = [{"rod": "rod", "at": end, "fix": ["x", "y"], "spring": spring}]
        simulation = settled(scene)
        tip = simulation.positions[-1] if end == "start" else simulation.positions[0]
        exact = [np.sin(1), 1 - np.cos(1)] if end == "start" else [1 - np.sin(1), 1 - np.cos(1)]
        assert simulation.energies.elastic < 1e-12
        errors.append(np.hypot(*(tip - exact)))
    assert fitted_order(STEPS, errors) > 1.9


def test_a_rigid_body_on_springs():
    """A uniform bar on springs at its ends: it bounces, pitches and moves lengthwise."""
    kx, ky = 3.0, 5.0
    scene = straight(10, "free-free", EA=1e9)
    scene["rods"][0]["cross_section"]["stiffness"]["EI"] = 1e6
    scene["supports"] = [{**end, "spring": {"stiffness": [kx, ky]}} for end in (START, END)]
    simulation = settled(scene)
    omega = 2 * np.pi * simulation.modes(3).frequencies
    assert omega**2 == pytest.approx(sorted([2 * kx, 2 * ky, 6 * ky]), rel=1e-5)


@pytest.mark.parametrize("k", [0.5, 5.0, 500.0])
def test_buckling_of_a_column_with_springs_against_turning(fitted_order, k):
    """tan(u) = -2 u EI / (k L) with u = L/2 sqrt(P / EI), between pinned and clamped ends."""
    u = brentq(lambda u: np.sin(u) + 2 * u * np.cos(u) / k, np.pi / 2, np.pi)
    errors = []
    for n in SIZES:
        scene = straight(n, "pinned-pinned", loads=tip_force(-1, 0), analysis="buckling")
        springs = [{**end, "spring": {"rotational_stiffness": k}} for end in (START, END)]
        scene["supports"] = [*scene["supports"], *springs]
        result = der.run(der.Scenario.from_dict(scene))
        errors.append(result.buckling.load_factors[0] / (4 * u**2) - 1)
    assert fitted_order(STEPS, errors) > 1.9


def test_a_spring_pulls_to_its_anchor_and_its_energy_is_recorded():
    scene = straight(10, "free-free")
    scene["supports"] = [
        {"rod": "rod", "at": 0.23, "spring": {"stiffness": 4.0, "anchor": [0.5, 0.3]}},
        {"rod": "rod", "at": 0.77, "spring": {"stiffness": 2.0}},
    ]
    scene["loads"] = [{"gravity": [0, -1.0]}]
    scene["output"] = {"probes": {"spring": {"quantity": "spring_energy"}}}
    result = der.run(der.Scenario.from_dict(scene))
    places = [
        spring.weights @ result.positions[-1][spring.nodes]
        for spring in der.springs(result.scenario)
    ]
    forces = [4.0 * (places[0] - [0.5, 0.3]), 2.0 * (places[1] - [0.77, 0.0])]
    assert np.sum(forces, axis=0) == pytest.approx([0.0, -1.0], abs=1e-7)
    energy = sum(f @ f / (2 * k) for f, k in zip(forces, (4.0, 2.0), strict=True))
    assert result.energies["spring"][-1] == pytest.approx(energy, rel=1e-9)
    assert result.probes["spring"][-1] == pytest.approx(energy, rel=1e-9)


def test_every_solver_takes_the_wider_band():
    scene = straight(30, "free-free", loads=tip_force(0, -5))
    scene["supports"] = [
        {"rod": "rod", "at": 0.01, "spring": {"stiffness": 1e3, "rotational_stiffness": 4.0}},
        {"rod": "rod", "at": 0.47, "spring": {"stiffness": 30.0}},
    ]
    shapes = []
    for solver in ("banded", "simplicial_ldlt"):
        scene["solver"] = {"linear": solver}
        shapes.append(np.array(settled(scene).positions))
    assert shapes[0] == pytest.approx(shapes[1], abs=1e-9)


@pytest.mark.parametrize("integrator", ["energy_momentum", "implicit_midpoint"])
def test_a_swing_on_springs_keeps_its_energy(fitted_order, integrator):
    """But for what the time stepping takes: nothing, or an amount of order 2."""
    kx, ky, anchor = 20.0, 30.0, np.array([1.02, 0.05])
    tight = {"residual_tolerance": 1e-12, "step_tolerance": 1e-13}
    changes = []
    steps = [1e-3, 5e-4, 2.5e-4]
    for step in steps:
        time = {"duration": 0.5, "step": step, "integrator": integrator}
        scene = straight(10, "free-free", EA=1e3, time=time, solver=tight)
        scene["output"] = {"every": 0.01}
        del scene["analysis"]
        spring = {"stiffness": [kx, ky], "anchor": anchor.tolist()}
        scene["supports"] = [{**START, "fix": ["x", "y"]}, {**END, "spring": spring}]
        scene["loads"] = [{"gravity": [0, -9.81]}]
        result = der.run(der.Scenario.from_dict(scene))
        pulled = result.positions[:, -1] - anchor
        stored = 0.5 * (pulled**2 @ [kx, ky])
        assert result.energies["spring"] == pytest.approx(stored, rel=1e-12)
        assert np.ptp(stored) > 1.0
        total = sum(result.energies.values())
        changes.append(np.abs(total - total[0]).max())
    if integrator == "energy_momentum":
        assert max(changes) < 1e-11
    else:
        assert fitted_order(steps, changes) > 1.9
