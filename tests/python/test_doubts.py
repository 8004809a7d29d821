"""Runs that leave what the model can tell: rods that cross, strains beyond a linear law, units."""

import json
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
