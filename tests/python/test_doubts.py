"""Runs that leave what the model can tell: rods that cross, strains beyond a linear law, units."""

import json
import math
import os
import subprocess
import sys
import warnings
from pathlib import Path

import der
import pytest

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))


def rod(name, start, end):
    return {
        "name": name,
        "nodes": 6,
        "from": start,
        "to": end,
        "cross_section": {"circle": {"radius": 0.01}},
        "material": {"youngs_modulus": 1e7, "density": 1000},
    }


@pytest.fixture
def fall():
    """A rod that falls for 0.2 m onto another, which is held."""
    return {
        "rods": [rod("low", [0, 0, 0], [1, 0, 0]), rod("high", [0.6, -0.5, 0.2], [0.6, 0.5, 0.2])],
        "supports": [{"rod": "low", "at": "all", "fix": ["x", "y", "z"]}],
        "loads": [{"gravity": [0, 0, -10]}],
        "time": {"duration": 0.3, "step": 0.002},
    }


def test_a_run_warns_once_of_rods_that_pass_through_one_another(fall, tmp_path):
    with pytest.warns(der.UnreliableResultWarning, match="'low' and 'high' pass through") as told:
        result = der.run(fall)
    assert len(told) == 1
    (text,) = result.summary["warnings"]
    assert str(told[0].message) == text
    # sqrt(2 (0.2 - 0.02) / 10) = 0.190 s
    assert text.startswith("rods 'low' and 'high' pass through one another at t = 0.19")
    assert "at the arc lengths 0.6 m and 0.5 m" in text
    scene = tmp_path / "fall.yaml"
    scene.write_text(der.Scenario.from_dict(fall).to_yaml())
    done = subprocess.run(
        [DER_RUN, scene, "--out", tmp_path / "run"], capture_output=True, text=True, check=True
    )
    assert "pass through one another at t = 0.19" in done.stdout
    assert json.loads((tmp_path / "run/summary.json").read_text())["warnings"] == [text]


def test_a_run_that_ends_before_or_goes_on_after_says_nothing(fall):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        der.Simulation(fall).run(until=0.18)
    simulation = der.Simulation(fall)
    simulation.step(100)  # beyond the crossing, and nothing records
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulation.run()


def test_a_strain_beyond_a_linear_law_is_told_once(fall):
    fall["rods"] = [rod("band", [0, 0], [1, 0])]
    fall["supports"] = [
        {"rod": "band", "at": "start", "clamp": True},
        {
            "rod": "band",
            "at": "end",
            "fix": ["y"],
            "prescribe": {"x": {"times": [0, 0.2], "values": [0, 1.5]}},
        },
    ]
    fall["loads"] = []
    with pytest.warns(der.UnreliableResultWarning, match="stretched to 2.* its rest length at t"):
        der.run(fall)


def test_a_probable_unit_is_told_when_the_scene_is_used_and_not_again_in_the_run(fall):
    fall["rods"] = [rod("arm", [0, 0], [0.3, 0]) | {"cross_section": {"circle": {"radius": 6}}}]
    fall["supports"] = [{"rod": "arm", "at": "start", "clamp": True}]
    fall["loads"] = [{"gravity": [0, -10]}]
    with pytest.warns(der.DerWarning, match="'radius' then is 0.006") as told:
        result = der.run(fall)
    assert len(told) == 1
    assert len(result.summary["warnings"]) == 1


def loop(analysis, dx=-0.3):
    """A rod that lies across itself: one end is turned by a whole turn."""
    return {
        "rods": [
            rod("r", [0, 0], [1, 0]) | {"nodes": 61, "cross_section": {"circle": {"radius": 0.004}}}
        ],
        "supports": [
            {"rod": "r", "at": "start", "clamp": True},
            {"rod": "r", "at": "end", "clamp": True, "prescribe": {"x": dx, "angle": 6.2831853}},
        ],
        "analysis": analysis,
    }


@pytest.mark.filterwarnings("ignore::der.DerWarning")
@pytest.mark.parametrize(
    ("analysis", "where"),
    [
        ("static", "in the equilibrium"),
        ("modes", "in the equilibrium"),
        ({"continuation": {"vary": "supports", "step": 0.05}}, "at load factor"),
    ],
)
def test_equilibria_and_paths_of_rods_that_cross_themselves_say_so(analysis, where):
    """The end is moved along the rod: with its one edge over the rod nothing begins overlapping."""
    assert f"rod 'r' passes through itself {where}" in str(
        der.run(loop(analysis)).summary["warnings"]
    )


def test_a_run_that_starts_from_an_equilibrium_across_itself_says_so_at_its_start():
    scene = loop("static")
    del scene["analysis"]
    scene |= {"start_from": "equilibrium", "time": {"duration": 0.01, "step": 0.005}}
    told = der.run(scene, check=False).summary["warnings"]
    assert any("rod 'r' passes through itself at t = 0 s" in text for text in told)


@pytest.mark.parametrize("gap", [0.0, 0.0125])
def test_a_ring_is_looked_at_though_its_ends_meet(gap):
    """Two opposite places are pushed past each other; the ends are 2 mm apart or less."""
    angles = [i * (2 * math.pi - gap) / 60 for i in range(61)]
    points = [[0.16 * math.cos(a), 0.16 * math.sin(a)] for a in angles]
    pushed = [
        {
            "rod": "r",
            "at": {"node": node},
            "fix": ["x"],
            "prescribe": {"y": {"times": [0, 1], "values": [0, by]}},
        }
        for node, by in ((15, -0.2), (45, 0.2))
    ]
    ring = rod("r", [0, 0], [1, 0]) | {"points": points}
    ring["cross_section"] = {"circle": {"radius": 0.004}}
    ring["material"] = {"youngs_modulus": 1e6, "density": 1000}
    for key in ("from", "to", "nodes"):
        del ring[key]
    scene = {
        "rods": [ring],
        "supports": [{"rod": "r", "at": at, "clamp": True} for at in ("start", "end")] + pushed,
        "loads": [{"damping": {"coefficient": 0.3}}],
        "time": {"duration": 1.0, "step": 0.004},
    }
    (text,) = der.run(scene, check=False).summary["warnings"]
    # The axes are nearer than two radii from t = 0.78 s on.
    assert "rod 'r' passes through itself at t = 0.8" in text or "at t = 0.79" in text
    scene["time"]["duration"] = 0.7
    assert der.run(scene).summary["warnings"] == []


def test_joined_rods_are_looked_at_but_for_their_joint():
    """One leg of an L curls through the other; near the joint they may touch."""
    legs = [rod("base", [0, 0], [0.5, 0]), rod("arm", [0, 0], [0, 0.5])]
    for leg in legs:
        leg |= {"nodes": 41, "cross_section": {"circle": {"radius": 0.003}}}
        leg["material"] = {"youngs_modulus": 1e8, "density": 1000}
    scene = {
        "rods": legs,
        "joints": [{"name": "corner", "of": [{"rod": leg["name"], "at": "start"} for leg in legs]}],
        "supports": [{"rod": "base", "at": at, "clamp": True} for at in ("start", "end")],
        "loads": [{"damping": {"coefficient": 0.3}}],
        "actuation": [
            {
                "name": "curl",
                "rod": "arm",
                "natural_curvature": {"times": [0, 1], "values": [0, -7.0]},
            }
        ],
        "time": {"duration": 1.2, "step": 0.004},
    }
    (text,) = der.run(scene, check=False).summary["warnings"]
    assert "rods 'base' and 'arm' pass through one another at t = 1." in text
    scene["time"]["duration"] = 1.0
    assert der.run(scene).summary["warnings"] == []
