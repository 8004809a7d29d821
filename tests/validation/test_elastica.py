"""Elastica: tip loads and self weight up to the large, and buckled columns, each as one solve.

References: `references/elastica.py` (elliptic integrals; collocation for the self weight).
"""

import der
import numpy as np
import pytest
from scenes import END, START, straight, tip_force
from scipy.integrate import solve_ivp
from scipy.special import ellipe, ellipk

SIZES = [20, 40, 80, 160]
STEPS = [1 / n for n in SIZES]
#: A clamp that slides along x: its spring gives way by 1e-9 rad.
GUIDED_END = {**END, "fix": ["y"], "spring": {"rotational_stiffness": 1e11}}


def settled(scene):
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    report = simulation.equilibrium()
    assert report.stability == "stable"
    return simulation, report


def tip_errors(exact, EA, loads, sizes=SIZES):
    errors = []
    for n in sizes:
        simulation, _ = settled(straight(n, "clamped-free", EA, loads=loads))
        x, y = simulation.positions[-1]
        errors.append(np.hypot(x - exact[0], -y - exact[1]))
    return errors


@pytest.mark.parametrize("load", ["0.5", "1", "2", "5", "10", "100"])
def test_tip_load_from_a_straight_start(reference, fitted_order, load):
    exact = [reference("elastica", f"tip_load.{load}.{c}") for c in "xy"]
    errors = tip_errors(exact, 1e9, tip_force(0, -float(load)))
    assert fitted_order(STEPS, errors) > 1.9


@pytest.mark.parametrize("weight", ["1", "10", "100", "1000"])
def test_self_weight_from_a_straight_start(reference, fitted_order, weight):
    exact = [reference("elastica", f"self_weight.{weight}.{c}") for c in "xy"]
    sizes = [80, 160, 320] if weight == "1000" else SIZES[1:]
    steps = [1 / n for n in sizes]
    errors = tip_errors(exact, 1e10, [{"gravity": [0, -float(weight)]}], sizes)
    # The bend at the clamp is (EI/w L^3)^(1/3) L long, 0.1 L at weight 1000.
    assert fitted_order(steps, errors) > 1.9


@pytest.mark.parametrize("factor", ["1.02", "1.1", "1.5", "2"])
@pytest.mark.parametrize("ends", ["pinned-pinned", "clamped-free", "clamped-clamped"])
def test_buckled_columns_are_found_from_the_straight_one(reference, fitted_order, ends, factor):
    load = reference("elastica", f"critical.{ends}") * float(factor)
    exact = [
        reference("elastica", f"buckled.{ends}.{factor}.{of}")
        for of in ("deflection", "shortening")
    ]
    errors = []
    # Four quarter waves between two clamps: each gets as many elements as that of one clamp.
    sizes = [4 * n for n in SIZES] if ends == "clamped-clamped" else SIZES
    for n in sizes:
        scene = straight(n, ends, loads=tip_force(-load, 0))
        if ends == "clamped-clamped":
            scene["supports"] = [{**START, "clamp": True}, GUIDED_END]
        simulation, report = settled(scene)
        assert report.saddles_left == 1
        found = [np.abs(simulation.positions[:, 1]).max(), 1 - simulation.positions[-1, 0]]
        errors.append(np.linalg.norm(np.subtract(found, exact)))
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


def two_half_waves(k, nodes):
    """Points of a pinned column of length 1 that has buckled in its second mode, unstable under a
    dead load (Timoshenko and Gere, Theory of Elastic Stability, 2.7); k is the sine of half the
    largest angle."""
    load = (4 * ellipk(k**2)) ** 2

    def along(s, state):
        return [np.cos(state[2]), np.sin(state[2]), state[3], -load * np.sin(state[2])]

    start = [0, 0, 2 * np.arcsin(k), 0]
    at = np.linspace(0, 1, nodes)
    points = solve_ivp(along, (0, 1), start, t_eval=at, rtol=1e-11, atol=1e-12).y[:2].T
    points[[0, -1], 1] = 0.0
    return points


@pytest.mark.parametrize("drawn", [0.6, 0.57], ids=["on it", "beside it"])
def test_any_equilibrium_is_the_one_nearest_to_the_drawn_shape(fitted_order, drawn):
    """Stable or not: what leads downhill left it."""
    exact = 2 * ellipe(0.6**2) / ellipk(0.6**2) - 1
    errors = []
    for n in SIZES[1:]:
        scene = straight(n, "pinned-pinned", 1e7)
        rod = scene["rods"][0]
        del rod["nodes"], rod["from"], rod["to"]
        rod |= {"points": two_half_waves(drawn, n + 1).tolist(), "natural_curvature": 0}
        scene["loads"] = tip_force(-((4 * ellipk(0.6**2)) ** 2), 0)
        scene["analysis"] = {"static": {"stability": "any"}}
        result = der.run(scene)
        assert result.summary["stability"] == "unstable"
        assert result.summary["saddles_left"] == 0
        errors.append(result.positions[-1, -1, 0] - exact)
    assert fitted_order(STEPS[1:], errors) > 1.9
