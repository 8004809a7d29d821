"""Rods with another length without stress than drawn: cables that hang, tight strings."""

import der
import numpy as np
import pytest
from scipy.optimize import brentq

GRAVITY = 9.81
MESHES = (20, 40, 80)


def catenary(length, span=1.0):
    """Return the sag and the horizontal force per weight of a metre, of an inextensible cable."""
    a = brentq(lambda a: 2.0 * a * np.sinh(0.5 * span / a) - length, 0.02, 1e3)
    return a * (np.cosh(0.5 * span / a) - 1.0), a


def cable(elements, length, **changes):
    return {
        "rods": [
            {
                "name": "cable",
                "nodes": elements + 1,
                "from": [0, 0],
                "to": [1, 0],
                "rest_length": length,
                "cross_section": {"stiffness": {"EA": 1e9, "EI": 0, "mass_per_length": 2.0}},
            }
            | changes
        ],
        "supports": [
            {"rod": "cable", "at": "start", "fix": ["x", "y"]},
            {"rod": "cable", "at": "end", "fix": ["x", "y"]},
        ],
        "loads": [{"gravity": [0, -GRAVITY]}],
        "analysis": "static",
        "output": {
            "probes": {
                "lowest": {"rod": "cable", "quantity": "y", "over": "rod", "reduce": "min"},
                "pull": {"support": 1, "quantity": "reaction_x"},
                "weight": {"support": 1, "quantity": "reaction_y"},
            }
        },
    }


@pytest.mark.parametrize("length", [1.02, 1.2, 1.9])
def test_a_cable_longer_than_its_span_hangs_in_a_catenary(length, fitted_order):
    sag, a = catenary(length)
    results = [der.run(cable(elements, length)) for elements in MESHES]
    assert all(result.summary["stability"] == "stable" for result in results)
    lowest = [result.probes["lowest"][-1] + sag for result in results]
    pull = [result.probes["pull"][-1] - 2.0 * GRAVITY * a for result in results]
    sizes = [1.0 / elements for elements in MESHES]
    assert fitted_order(sizes, lowest) > 1.9
    assert fitted_order(sizes, pull) > 1.9
    assert abs(lowest[-1]) < 3e-4 * sag
    # The mass is that of the rest length, and each end bears half of it.
    weight = results[-1].probes["weight"][-1]
    assert weight == pytest.approx(0.5 * 2.0 * length * GRAVITY, rel=1e-6)


def test_it_is_the_cable_that_is_drawn_at_its_length_and_whose_end_is_moved():
    drawn = cable(40, 1.2, to=[1.2, 0])
    del drawn["rods"][0]["rest_length"]
    drawn["supports"][1] = {
        "rod": "cable",
        "at": "end",
        "fix": ["y"],
        "prescribe": {"x": -0.2},
    }
    moved = der.run(drawn)
    hung = der.run(cable(40, 1.2))
    assert hung.positions[-1] == pytest.approx(moved.positions[-1], abs=1e-8)


def test_a_string_that_is_shorter_than_its_span_is_tight():
    # EA (1 - L/l0)... of rest length 0.98 on a span of 1: strain 1/49.
    scene = cable(20, 0.98)
    scene["loads"] = []
    scene["output"]["probes"]["tension"] = {"rod": "cable", "at": "middle", "quantity": "tension"}
    scene["output"]["probes"]["strain"] = {"rod": "cable", "at": "middle", "quantity": "strain"}
    result = der.run(scene)
    assert result.probes["strain"][-1] == pytest.approx(1.0 / 0.98 - 1.0, rel=1e-12)
    assert result.probes["tension"][-1] == pytest.approx(1e9 * (1.0 / 0.98 - 1.0), rel=1e-12)
    assert result.probes["pull"][-1] == pytest.approx(1e9 * (1.0 / 0.98 - 1.0), rel=1e-12)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_arc_lengths_count_along_the_rest_length(model):
    """A clamped arc that nothing loads grows to its rest length with the angles as drawn."""
    radius, angle, stretch = 1.0, 1.2, 1.1
    turn = np.linspace(0.0, angle, 41)
    points = radius * np.stack([np.sin(turn), 1.0 - np.cos(turn)], axis=1)
    chain = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    if model != "planar":
        points = np.pad(points, ((0, 0), (0, 1)))
    scene = {
        "model": model,
        "rods": [
            {
                "name": "arc",
                "points": points.tolist(),
                "rest_length": stretch * chain,
                "cross_section": {"stiffness": {"EA": 1e4, "EI": 1.0, "GJ": 1.0}},
            }
        ],
        "supports": [{"rod": "arc", "at": "start", "clamp": True}],
        "analysis": "static",
        "output": {
            "probes": {
                "x": {"rod": "arc", "at": 0.5 * stretch * chain, "quantity": "x"},
                "moment": {"rod": "arc", "at": "middle", "quantity": "moment"},
            }
        },
    }
    if model != "planar":
        del scene["output"]["probes"]["moment"]
    scene["rods"][0]["cross_section"]["stiffness"]["mass_per_length"] = 1.0
    result = der.run(scene)
    expected = stretch * points
    assert result.positions[-1] == pytest.approx(expected, abs=1e-9)
    assert result.probes["x"][-1] == pytest.approx(expected[20, 0], abs=1e-9)
    assert der.Simulation(scene).model.rods[0].length == pytest.approx(stretch * chain, rel=1e-12)


def test_a_run_over_time_starts_as_drawn():
    scene = cable(20, 1.2)
    del scene["analysis"]
    scene["time"] = {"duration": 0.01, "step": 0.001}
    result = der.run(scene)
    assert np.all(result.positions[0][:, 1] == 0.0)
    assert result.positions[0][:, 0] == pytest.approx(np.linspace(0.0, 1.0, 21), abs=1e-15)
    # EA eps^2 / 2 over the rest length
    start = 0.5 * 1e9 * (1.0 / 1.2 - 1.0) ** 2 * 1.2
    assert result.energies["stretch"][0] == pytest.approx(start, rel=1e-12)


def test_refined_meshes_keep_the_rest_length_and_the_places_on_it():
    x = np.linspace(0.0, 1.0, 21)
    scene = cable(20, 1.2)
    rod = scene["rods"][0]
    for key in ("nodes", "from", "to"):
        del rod[key]
    rod["points"] = np.stack([x, 0.2 * x * (x - 1.0)], axis=1).tolist()
    scene["output"]["probes"]["aside"] = {"rod": "cable", "at": 1.14, "quantity": "y"}
    verification = der.verify(scene)
    sag, a = catenary(1.2)
    exact = {"lowest": -sag, "aside": np.hypot(a, 1.14 - 0.6) - (a + sag)}
    for name, value in exact.items():
        measured = verification[name]
        assert abs(measured.value - value) <= measured.error_bar
        assert abs(measured.extrapolated - value) < 0.1 * abs(measured.value - value)
