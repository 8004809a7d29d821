"""Energies of single rods: those of all rods add up to the whole, in the plane and in space."""

import der
import numpy as np
import pytest

TERMS = ("kinetic", "stretch", "bend", "spring", "gravity")


def strip(name, start, end, **more):
    stiffness = {"EA": 1e3, "EI1": 2.0, "EI2": 1.0, "GJ": 0.7}
    stiffness |= {"mass_per_length": 1.0, "rotary_inertia": 0.05}
    return {
        "name": name,
        "nodes": 9,
        "from": start,
        "to": end,
        "cross_section": {"stiffness": stiffness, "director": [0, 0.6, 0.8]},
        **more,
    }


def two_rods():
    """One is clamped, turned and curved by nature; the other one hangs on springs and spins."""
    turn = {"times": [0, 0.2], "values": [0, 1.5]}
    return {
        "model": "spatial",
        "rods": [
            strip("held", [0, 0, 0], [1, 0, 0], natural_curvature=[0.8, -0.4], natural_twist=1.2),
            strip("hung", [0, 1, 0], [0.8, 1, 0.6]),
        ],
        "supports": [
            {"rod": "held", "at": "start", "clamp": True, "prescribe": {"twist": turn}},
            {"rod": "held", "at": 0.41, "spring": {"rotational_stiffness": [1.0, 2.0, 0.5]}},
            {"rod": "hung", "at": 0.37, "spring": {"stiffness": [50, 60, 70]}},
            {"rod": "hung", "at": "end", "spring": {"rotational_stiffness": 0.8}},
        ],
        "loads": [
            {"gravity": [0, 0, -9.81]},
            {"foundation": {"rod": "held", "stiffness": [0, 0, 30], "from": 0.55}},
            {"moment": {"rod": "hung", "at": "start", "moment": [0.7, 0.2, 0.1]}},
        ],
        "time": {"duration": 0.2, "step": 0.01},
    }


def test_they_add_up_to_the_whole_in_space():
    scene = two_rods()
    scene["output"] = {
        "every": 0.05,
        "probes": {
            f"{term}_{rod}": {"quantity": f"{term}_energy", "rod": rod}
            for term in TERMS
            for rod in ("held", "hung")
        },
    }
    result = der.run(scene)
    for term in TERMS:
        whole = result.energies[term]
        assert np.abs(whole).max() > 1e-3
        parts = [result.probes[f"{term}_{rod}"] for rod in ("held", "hung")]
        assert all(np.abs(part).max() > 1e-4 for part in parts)
        assert np.sum(parts, axis=0) == pytest.approx(whole, rel=1e-12)
