"""Values that a program sets by name: the calls of Python, and that a run keeps them."""

import json
import os
import pickle
import subprocess
import sys
from pathlib import Path

import der
import numpy as np
import pytest
from der.scene_loads import acting_loads, value_at

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))
SCENE = {
    "title": "Controlled rod",
    "rods": [
        {
            "name": "rod",
            "nodes": 6,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"circle": {"radius": 0.01}},
            "material": {"youngs_modulus": 1e7, "density": 1000},
        }
    ],
    "supports": [
        {
            "name": "wall",
            "rod": "rod",
            "at": "start",
            "clamp": True,
            "prescribe": {"x": 0, "angle": 0},
        }
    ],
    "loads": [
        {"name": "gravity", "gravity": [0, -5]},
        {"name": "push", "point_force": {"rod": "rod", "at": "end", "force": [0, 0]}},
        {"name": "bend", "moment": {"rod": "rod", "at": 0.4, "moment": 0}},
        {"name": "water", "damping": {"coefficient": 0.1}},
    ],
    "time": {"duration": 0.2, "step": 0.002},
}


@pytest.fixture
def simulation():
    return der.Simulation(SCENE)


def test_names_have_their_units(simulation):
    assert simulation.names == {
        "wall": {"x": "m", "angle": "rad"},
        "gravity": {"x": "m/s^2", "y": "m/s^2"},
        "push": {"x": "N", "y": "N"},
        "bend": {"z": "N m"},
    }


def test_every_form_of_a_value(simulation):
    simulation.set("push", [1, -3])
    simulation.set("wall", {"x": 0.1})
    simulation.set("wall.angle", np.float64(0.2))
    for two in (np.float32(2), np.array(2.0), np.array([2.0]), [np.int64(2)], 2):
        simulation.set("bend", 0)
        simulation.set("bend", two)
    simulation.set("gravity", np.array([0.0, -1.6]))
    simulation.step()
    assert simulation.value("push").tolist() == [1, -3]
    assert simulation.value("push.y") == -3.0
    assert simulation.value("wall") == {"x": 0.1, "angle": 0.2}
    assert simulation.value("bend") == 2.0
    assert simulation.value("gravity").tolist() == [0, -1.6]
    assert simulation.prescribed(0) == {"x": 0.1, "angle": 0.2}
    for name in simulation.names:
        simulation.set(name, simulation.value(name))


def test_a_value_is_reached_evenly(simulation):
    simulation.set("push", (0, -3), over=0.008)
    seen = []
    for _ in range(5):
        simulation.step()
        seen.append(simulation.value("push.y"))
    assert seen == pytest.approx([-0.75, -1.5, -2.25, -3, -3], rel=1e-12)


@pytest.mark.parametrize(
    ("name", "value", "error", "message"),
    [
        ("psh", 1, der.DerError, "did you mean 'push'"),
        ("", 1, der.DerError, "the name ''; there is 'wall'"),
        (".push", 1, der.DerError, "the name '.push'; did you mean 'push'"),
        ("water", 1, der.DerError, "a load of the kind 'damping' has no value"),
        ("wall.y", 1, der.DerError, "has no component 'y'; it has 'x' and 'angle'"),
        ("push", 1, der.DerError, "takes 2 values, for 'x' and 'y', but here is 1"),
        ("push", [1, np.nan], der.DerError, "y must be finite, got nan"),
        ("wall", {"x": 0.5, "z": 1}, der.DerError, "has no component 'z'"),
        ("push", "up", TypeError, "takes a number, a list of numbers or a dict"),
        ("push", [1, "up"], TypeError, "not 'up'"),
        ("push", None, TypeError, "not None"),
        (3, 1, TypeError, "the name must be a text, got 3"),
    ],
)
def test_a_wrong_call_says_what_is_right_and_changes_nothing(
    simulation, name, value, error, message
):
    before = pickle.dumps(simulation.save_state())
    with pytest.raises(error, match=message.replace("(", r"\(")):
        simulation.set(name, value)
    assert pickle.dumps(simulation.save_state()) == before


def test_a_state_in_a_pickle_knows_what_was_set(simulation):
    simulation.step(3)
    simulation.set("push", [0.1, -0.2], over=0.03)
    simulation.set("gravity.y", 3)
    saved = pickle.loads(pickle.dumps(simulation.save_state()))
    other = der.Simulation(SCENE)
    other.restore_state(saved)
    for each in (simulation, other):
        each.step(20)
    assert np.array_equal(simulation.positions, other.positions)
    assert simulation.value("push").tolist() == other.value("push").tolist()


def test_a_run_goes_on_from_a_checkpoint_with_what_was_set(tmp_path):
    """The same bits as a run that nobody stopped."""

    def run(out, stop_at):
        simulation = der.Simulation(SCENE)

        def control(simulation):
            if simulation.step_count == 10:
                simulation.set("push", [0.02, -0.03], over=0.1)
                simulation.set("wall", {"x": 0.01, "angle": 0.3})
            return simulation.step_count < stop_at

        return simulation.run(control, out=out)

    whole = run(tmp_path / "whole", 10**6)
    assert run(tmp_path / "part", 25).status == "stopped"
    scene = tmp_path / "part" / "scene.yaml"
    command = [DER_RUN, scene, "--out", tmp_path / "part", "--resume"]
    subprocess.run(command, check=True, capture_output=True)
    resumed = der.open_run(tmp_path / "part")
    assert np.array_equal(resumed.positions[-1], whole.positions[-1])
    assert resumed.work["loads"][-1] == whole.work["loads"][-1]


def test_overrides_find_items_by_their_names():
    scenario = der.Scenario.parse(
        json.dumps(SCENE), **{"loads.push.point_force.force": [0, -2], "supports.wall.at": "end"}
    )
    assert scenario.to_dict()["loads"][1]["point_force"]["force"] == [0, -2]
    assert scenario.to_dict()["supports"][0]["at"] == "end"


def test_drawings_and_statics_read_sines_and_smooth_tables():
    sine = {"sine": {"amplitude": [0, 2], "frequency": 1.5, "phase": 0.3, "offset": [1, 0]}}
    smooth = {"times": [0, 0.2], "values": [0, 0.4], "smooth": True}
    loads = [
        {"gravity": {"sine": {"amplitude": [3, 0], "frequency": 2}}},
        {"name": "push", "point_force": {"rod": "rod", "at": "end", "force": sine}},
        {"moment": {"rod": "rod", "at": "end", "moment": smooth}},
    ]
    result = der.run({**SCENE, "loads": loads})
    frame = 40
    t = result.times[frame]
    acting = acting_loads(result, frame)
    assert acting.gravity == pytest.approx([3 * np.sin(4 * np.pi * t), 0])
    assert acting.forces[0].value == pytest.approx([1, 2 * np.sin(3 * np.pi * t + 0.3)])
    u = t / 0.2
    assert acting.moments[0].value == pytest.approx(0.4 * (10 * u**3 - 15 * u**4 + 6 * u**5))
    assert value_at(sine, 0.0) == pytest.approx([1, 2 * np.sin(0.3)])
    result.plot("shapes")
    still = der.equilibrium({**SCENE, "loads": loads})
    assert acting_loads(still, 0).forces[0].value == pytest.approx([1, 2 * np.sin(0.3)])
