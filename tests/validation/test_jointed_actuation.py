"""Actuated rods with a joint that does nothing: places and slopes by quadrature of the curvature.

Nothing loads the rod, so that its curvature is that of the actuations: theta(s) is its integral,
x' = cos(theta), y' = sin(theta) (scipy's adaptive quadrature to 1e-12).
"""

from __future__ import annotations

from typing import Any

import der
import numpy as np
import pytest
from scipy.integrate import quad

#: Name of a profile, its curvature by the share of the stretch, and its integral.
PROFILES = {
    "constant": lambda u: u,
    "linear": lambda u: 0.5 * u**2,
}
FROM, TO, CURVATURE = 0.2, 0.7, 3.0


def theta(profile: str, s: float) -> float:
    length = TO - FROM
    share = np.clip((s - FROM) / length, 0.0, 1.0)
    return float(CURVATURE * length * PROFILES[profile](share))


def place(profile: str, s: float) -> tuple[float, float]:
    borders = [each for each in (FROM, TO) if each < s]
    kwargs: dict[str, Any] = {"points": borders, "epsabs": 1e-12, "epsrel": 1e-12}
    return (
        quad(lambda t: np.cos(theta(profile, t)), 0.0, s, **kwargs)[0],
        quad(lambda t: np.sin(theta(profile, t)), 0.0, s, **kwargs)[0],
    )


def readings(profile: str, parts: int) -> dict[str, float]:
    """A rod of two, joined at 0.45; the actuation of each is its part of the whole."""
    stiffness = {"stiffness": {"EA": 1e6, "EI": 1.0, "mass_per_length": 1.0}}
    rods = [
        {"name": "a", "from": [0, 0], "to": [0.45, 0], "nodes": 6, "subdivide": parts},
        {"name": "b", "from": [0.45, 0], "to": [1, 0], "nodes": 6, "subdivide": parts},
    ]
    middle = 0.45
    actuations = [{"name": "p", "rod": "a", "from": FROM, "natural_curvature": CURVATURE}]
    actuations += [{"name": "q", "rod": "b", "to": TO - middle, "natural_curvature": CURVATURE}]
    if profile == "linear":
        slope = CURVATURE / (TO - FROM)
        reached = slope * (middle - FROM)
        actuations[0] |= {"natural_curvature": reached, "profile": "linear"}
        actuations[1] |= {"natural_curvature": reached}
        rise = {"natural_curvature": CURVATURE - reached, "profile": "linear"}
        actuations += [{"name": "r", "rod": "b", "to": TO - middle, **rise}]
    scene = {
        "rods": [{**rod, "cross_section": stiffness} for rod in rods],
        "joints": [{"name": "j", "of": [{"rod": "a", "at": "end"}, {"rod": "b", "at": "start"}]}],
        "supports": [{"rod": "a", "at": "start", "clamp": True}],
        "actuation": actuations,
        "analysis": "static",
        "output": {
            "probes": {
                "x": {"rod": "b", "at": "end", "quantity": "x"},
                "y": {"rod": "b", "at": "end", "quantity": "y"},
                "slope": {"rod": "b", "at": "end", "quantity": "slope"},
                "turn": {"joint": "j", "quantity": "rotation"},
                "moment": {"rod": "a", "at": "start", "quantity": "moment"},
                "curvature": {"rod": "b", "at": 0.05, "quantity": "curvature"},
            }
        },
    }
    result = der.run(der.Scenario.from_dict(scene))
    return {name: probe["final"] for name, probe in result.summary["probes"].items()}


@pytest.mark.parametrize("profile", PROFILES)
def test_places_and_slopes(profile: str) -> None:
    x, y = place(profile, 1.0)
    exact = {
        "x": x,
        "y": y,
        "slope": theta(profile, 1.0),
        "turn": theta(profile, 0.45),
        "curvature": CURVATURE * (1.0 if profile == "constant" else (0.5 - FROM) / (TO - FROM)),
    }
    levels = [readings(profile, parts) for parts in (4, 8, 16)]
    for found in levels:
        assert abs(found["moment"]) < 1e-8
    for name, value in exact.items():
        errors = np.array([abs(found[name] - value) for found in levels])
        if errors[0] < 1e-9:
            continue  # exact: a curvature that is linear along a leg turns it by its integral
        orders = np.log2(errors[:-1] / errors[1:])
        assert orders[-1] >= 1.85, (name, errors)
    assert abs(levels[-1]["x"] - x) < 2e-4
