"""Runs whose integrator creates energy: a warning and marks first, then a failure by name."""

import json
import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import der
import numpy as np
import pytest
from matplotlib import pyplot as plt

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))
DOUBTFUL = 2.0  # [s] that `whip` comes to before it fails
SINCE = 1.6  # [s] from which on it is unreliable


@pytest.fixture
def whip(swing):
    """A swing in steps that do not resolve the whip of its free end."""
    swing["time"] = {"duration": 6, "step": 0.005, "integrator": "implicit_midpoint"}
    swing["output"]["every"] = 0.05
    return swing


def step_until(simulation, time):
    while simulation.time < time:
        simulation.step()


def test_a_run_that_blows_up_fails_by_name_and_keeps_its_frames(whip):
    with pytest.raises(der.DivergedError, match="the integrator created") as caught:
        der.run(whip)
    result = caught.value.result
    assert caught.value.status == result.status == "unstable_motion"
    assert 2.0 < result.times[-1] < 3.0
    assert len(result.times) > 40
    assert result.unreliable_from == pytest.approx(SINCE, abs=0.1)
    assert np.all(np.isfinite(result.positions))
    created = -result.work["numerical"]
    assert created[-1] > 0.4
    assert created[result.times < 1].max() < 1e-3
    unchecked = der.run(whip, check=False)
    assert unchecked.status == "unstable_motion"


@pytest.mark.parametrize("model", ["planar", "spatial_bend"])
def test_verlet_of_a_kicked_free_rod_names_a_step_that_works(model):
    """Steps near the limit do not resolve the fastest vibrations, which a kicked end excites."""
    dimension = 2 if model == "planar" else 3
    velocity = np.zeros((19, dimension))
    velocity[-1, 1] = 162.0
    rod = {
        "name": "rod",
        "nodes": 19,
        "from": [0] * dimension,
        "to": [1] + [0] * (dimension - 1),
        "cross_section": {"circle": {"radius": 0.019}},
        "material": {"youngs_modulus": 6.5e8, "density": 1000},
        "initial_velocity": velocity.tolist(),
    }
    time = {"duration": 0.1, "step": "auto", "integrator": "verlet"}
    with pytest.raises(der.DivergedError, match="the integrator created") as caught:
        der.run({"model": model, "rods": [rod], "time": time})
    found = re.search(r"To get a right result write 'step: (\S+)'", str(caught.value))
    assert found is not None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        der.run({"model": model, "rods": [rod], "time": {**time, "step": float(found[1])}})


def test_with_a_callback_and_until_it_fails_too(whip):
    with pytest.raises(der.DivergedError):
        der.Simulation(whip).run(callback=lambda simulation: True, until=5.0)


def test_steps_from_python_warn_once_and_then_fail(whip):
    simulation = der.Simulation(whip)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        step_until(simulation, 1.5)
    with pytest.warns(der.UnreliableResultWarning, match="unreliable from t = 1.6 s") as told:
        step_until(simulation, DOUBTFUL)
    assert len(told) == 1
    assert told[0].filename == __file__
    with pytest.raises(der.DivergedError, match="unstable") as caught:
        simulation.step(1000)
    assert caught.value.status == "unstable_motion"
    assert simulation.time < 3.0
    assert np.all(np.isfinite(simulation.positions))


def test_a_doubtful_run_warns_at_the_line_that_ran_it(whip):
    whip["time"]["duration"] = DOUBTFUL
    with pytest.warns(der.UnreliableResultWarning, match="energy exchanged in the run") as told:
        result = der.run(whip)
    assert [warning.filename for warning in told] == [__file__]
    assert result.status == "completed"
    assert result.summary["warnings"] == [str(told[0].message)]
    assert result.summary["unreliable_from"] == result.unreliable_from
    with pytest.warns(der.UnreliableResultWarning) as told:
        der.Simulation(whip).run()
    assert [warning.filename for warning in told] == [__file__]


def test_the_scene_may_allow_it(whip):
    whip["time"] |= {"allow_unstable": True, "duration": 4}
    with pytest.warns(der.UnreliableResultWarning):
        result = der.run(whip)
    assert result.status == "completed"
    assert -result.work["numerical"][-1] > 0.5


def test_a_right_run_has_neither_mark_nor_warning(whip):
    whip["time"] |= {"integrator": "energy_momentum", "duration": 4}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = der.run(whip)
    assert result.unreliable_from is None
    assert "unreliable_from" not in result.summary
    assert np.abs(result.work["numerical"]).max() < 1e-9
    figure = result.plot()
    assert all("unreliable" not in text.get_text() for text in figure.findobj(plt.Text))
    plt.close(figure)


def test_plots_mark_what_is_unreliable(whip):
    whip["time"]["duration"] = DOUBTFUL
    with pytest.warns(der.UnreliableResultWarning):
        result = der.run(whip)
    figure = result.plot(times=[0.5, 1.9])
    shapes, probe = figure.axes
    assert shapes.get_title("left").endswith("(unreliable from t = 1.6 s on)")
    labels = [text.get_text() for text in shapes.get_legend().get_texts()]
    assert labels[:2] == ["0.5 s", "1.9 s, unreliable"]
    (band,) = probe.patches
    box = band.get_extents().transformed(probe.transData.inverted())
    assert (box.x0, box.x1) == pytest.approx((result.unreliable_from, DOUBTFUL))
    plt.close(figure)


def test_der_run_says_so_on_the_command_line(whip, tmp_path):
    scene = tmp_path / "whip.json"
    scene.write_text(json.dumps(whip))
    done = subprocess.run(
        [DER_RUN, scene, "--out", tmp_path / "out"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 3
    assert "unstable_motion at t = 2." in done.stdout
    assert "error: the motion is unstable" in done.stderr
    result = der.open_run(tmp_path / "out")
    assert result.status == "unstable_motion"
    assert result.unreliable_from == pytest.approx(SINCE, abs=0.1)
    assert len(result.times) > 40


def test_adaptive_steps_are_watched_too():
    """A stiff rod that curls up, with a loose tolerance: sdirk4 turns stretching into energy."""
    section = {"stiffness": {"EA": 1e8, "EI": 1, "mass_per_length": 1}}
    rod = {"name": "rod", "nodes": 15, "from": [0, 0], "to": [1, 0], "cross_section": section}
    scene = {
        "rods": [{**rod, "natural_curvature": 3}],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "time": {"duration": 0.1, "tolerance": 0.02, "integrator": "sdirk4"},
    }
    with pytest.warns(der.UnreliableResultWarning, match="smaller tolerance"):
        result = der.Simulation(scene).run(until=0.03)
    assert 0.005 < result.unreliable_from < 0.025  # it fails at 0.041
    assert result.work["numerical"].min() < 0.0


@pytest.mark.parametrize("integrator", ["tr_bdf2", "sdirk5", "energy_momentum"])
def test_a_node_that_folds_over_is_named(integrator):
    """A free rod that is flung together: beyond half a turn its bending energy jumps.

    No step is short enough for that.
    """
    scene = {
        "rods": [
            {
                "name": "rod",
                "nodes": 3,
                "from": [0, 0],
                "to": [1, 0],
                "natural_curvature": -1,
                "initial_velocity": [[0, 9], [0, -9], [0, 9]],
                "cross_section": {"stiffness": {"EA": 1e4, "EI": 0.5, "mass_per_length": 1}},
            }
        ],
        "time": {"duration": 0.12, "step": 2e-4, "integrator": integrator},
    }
    with pytest.warns(der.UnreliableResultWarning, match=r"node 1 of rod 'rod' folded over"):
        result = der.run(scene)
    (warning,) = result.summary["warnings"]
    assert "more nodes" in warning
    # Both halves are turned up by then: the middle node is below the ends.
    folded = result.positions[np.searchsorted(result.times, result.unreliable_from)]
    first, last = folded[1] - folded[0], folded[2] - folded[1]
    assert first @ last < -0.9 * np.linalg.norm(first) * np.linalg.norm(last)
