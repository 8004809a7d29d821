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


def arm(radius=0.006, modulus=1e6, density=1100, loads=None):
    loads = [{"gravity": [0, -9.81]}] if loads is None else loads
    return {
        "rods": [
            rod("arm", [0, 0], [0.3, 0])
            | {
                "nodes": 21,
                "cross_section": {"circle": {"radius": radius}},
                "material": {"youngs_modulus": modulus, "density": density},
            }
        ],
        "supports": [{"rod": "arm", "at": "start", "clamp": True}],
        "loads": loads,
        "time": {"duration": 0.1, "step": 0.01},
    }


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        ({"modulus": 1}, "Is it in MPa? 'youngs_modulus' then is 1e+06"),
        # In MPa it would be one of the softest gels.
        ({"modulus": 0.001}, "Is it in GPa? 'youngs_modulus' then is 1e+06"),
        ({"modulus": 1e-7}, "No unit makes 'youngs_modulus' a likely number: it is read in Pa"),
        ({"modulus": 2.1, "density": 7850}, "No unit makes 'youngs_modulus' a likely number"),
        ({"density": 1.1}, "Is it in g/cm^3? 'density' then is 1100"),
        # In g/cm^3 it would be as light as air.
        ({"density": 0.0011}, "Is it in kg/cm^3? 'density' then is 1100"),
        ({"density": 1.1e-9}, "Is it in t/mm^3? 'density' then is 1100"),
        ({"density": 1.1e9}, "No unit makes 'density' a likely number: it is read in kg/m^3"),
        ({"radius": 6}, "Is its cross-section in mm? 'radius' then is 0.006"),
        ({"radius": 6000}, "Is its cross-section in um? 'radius' then is 0.006"),
        # M r / EI = 4 M / (pi E r^3) = 15
        (
            {"loads": [{"moment": {"rod": "arm", "at": "end", "moment": 2.5}}]},
            "would be strained by 15 if its moments bent it",
        ),
    ],
)
def test_a_unit_that_is_named_makes_a_likely_number(numbers, text):
    (told,) = der.Scenario.from_dict(arm(**numbers)).warnings
    assert text in told


def test_a_moment_that_a_rod_bears_is_not_doubted():
    loads = [{"moment": {"rod": "arm", "at": "end", "moment": 0.1}}]
    assert not der.Scenario.from_dict(arm(loads=loads)).warnings


def test_strains_by_bending_and_by_compression_are_told():
    """An end that a moment bends to kappa r = 1.5, and a rod that is pressed to a tenth."""
    bent = arm(loads=[{"moment": {"rod": "arm", "at": "end", "moment": 1.5 * 0.1696}}])
    bent["rods"][0] |= {"nodes": 401}
    del bent["time"]
    with pytest.warns(der.UnreliableResultWarning, match=r"its surface is strained by 1\.[56]"):
        der.run(bent | {"analysis": "static"}, check=False)
    # Held in its line, or it would buckle.
    pressed = arm(loads=[{"damping": {"coefficient": 1.0}}])
    table = {"times": [0, 1], "values": [0, -0.27], "smooth": True}
    pressed["supports"] = [
        {"rod": "arm", "at": "all", "fix": ["y"]},
        {"rod": "arm", "at": "start", "fix": ["x"]},
        {"rod": "arm", "at": "end", "prescribe": {"x": table}},
    ]
    pressed["time"] = {"duration": 1, "step": 0.01, "integrator": "bdf2"}
    with pytest.warns(der.UnreliableResultWarning, match="compressed to 0.1.* its rest length"):
        der.run(pressed, check=False)


@pytest.mark.parametrize(
    ("rods", "nodes", "analysis", "text"),
    [
        (50, 19999, {"analysis": "static"}, "its 50 rods of 999950 nodes take 3 GB"),
        (
            10,
            99999,
            {"time": {"duration": 1, "step": 0.01}},
            "its 10 rods of 999990 nodes take 1.2",
        ),
        (10, 1000, {"analysis": "static"}, None),
    ],
)
def test_the_size_of_a_scene_is_that_of_all_its_rods(rods, nodes, analysis, text):
    scene = arm()
    del scene["time"]
    names = [f"r{i}" for i in range(rods)]
    scene["rods"] = [
        scene["rods"][0]
        | {"name": name, "nodes": nodes, "from": [0, 0.1 * i], "to": [0.3, 0.1 * i]}
        for i, name in enumerate(names)
    ]
    scene["supports"] = [{"rod": name, "at": "start", "clamp": True} for name in names]
    told = der.Scenario.from_dict(scene | analysis).warnings
    assert [text in one for one in told] == ([True] if text else [])


def test_a_turn_that_a_coarse_mesh_has_lost_beside_a_clamp_is_told():
    """With 20 nodes the end does not follow its clamp around; with 80 it does."""
    scene = {
        "rods": [
            {
                "name": "r",
                "nodes": 20,
                "from": [0, 0],
                "to": [2.873240873484383, 0],
                "cross_section": {
                    "stiffness": {
                        "EA": 2372.539779482633,
                        "EI": 0.12252154815627136,
                        "mass_per_length": 1,
                    }
                },
            }
        ],
        "supports": [
            {
                "rod": "r",
                "at": "start",
                "fix": ["x", "y"],
                "spring": {"rotational_stiffness": 1.3324963773599359},
            },
            {
                "rod": "r",
                "at": "end",
                "clamp": True,
                "prescribe": {
                    "angle": -7.3904707307687705,
                    "x": -0.3332460140027345,
                    "y": -0.05627860173480093,
                },
            },
        ],
        "loads": [
            {
                "distributed_force": {
                    "rod": "r",
                    "force": [-0.022268900342547016, -0.04033331898772794],
                }
            }
        ],
        "analysis": "static",
    }
    with pytest.warns(der.UnreliableResultWarning, match="less or more than the clamps"):
        result = der.run(scene, check=False)
    assert result.summary["largest_turning_angle"] == pytest.approx(6.3, abs=0.3)
    scene["rods"][0]["nodes"] = 80
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        assert der.run(scene, check=False).summary["largest_turning_angle"] < 1.0
    assert not any("clamp" in str(one.message) for one in told)
