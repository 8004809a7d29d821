"""Properties of the Python entry points: whatever they are given, they answer or raise by name.

Short and the same on every run here; `DER_HYPOTHESIS=long python -m pytest
tests/python/test_properties.py` draws new examples for minutes.
"""

from __future__ import annotations

import copy
import math
import os
import pickle
import warnings

import der
import numpy as np
import pytest

hypothesis = pytest.importorskip("hypothesis")

from hypothesis import HealthCheck, given, settings  # noqa: E402
from hypothesis import strategies as st  # noqa: E402

LONG = os.environ.get("DER_HYPOTHESIS") == "long"
settings.register_profile(
    "der",
    max_examples=2000 if LONG else 25,
    derandomize=not LONG,
    database=None,
    deadline=20_000,  # [ms] a hang is a failure
    suppress_health_check=list(HealthCheck),
)
settings.load_profile("der")

#: What der raises on purpose; anything else is a crash.
REFUSALS = (der.DerError, ValueError, TypeError, KeyError, IndexError, OverflowError)

SCENE = {
    "model": "auto",
    "rods": [
        {
            "name": "rod",
            "nodes": 5,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"stiffness": {"EA": 1e3, "EI": 1, "GJ": 1, "mass_per_length": 1}},
        }
    ],
    "supports": [{"name": "wall", "rod": "rod", "at": "start", "clamp": True}],
    "loads": [{"name": "push", "point_force": {"rod": "rod", "at": "end", "force": [0, -1]}}],
    "time": {"duration": 0.05, "step": 0.01},
    "output": {"every": 0.01, "probes": {"tip": {"rod": "rod", "at": "end", "quantity": "y"}}},
}

NUMBERS = st.one_of(
    st.floats(),
    st.sampled_from([0.0, -0.0, 1e308, -1e308, 5e-324, 1e-300, math.inf, -math.inf, math.nan]),
    st.integers(-(2**70), 2**70),
)
TAME = st.one_of(st.floats(-1e3, 1e3), st.integers(-50, 50))
LEAVES = st.one_of(NUMBERS, TAME, st.booleans(), st.none(), st.text(max_size=8))
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=8), inner, max_size=3)
    ),
    max_leaves=8,
)


def places(value, path=()):
    """The paths of all values of a scene."""
    yield path
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, inner in items if isinstance(value, (dict, list)) else ():
        yield from (
            places(inner, (*path, key)) if isinstance(inner, (dict, list)) else ((*path, key),)
        )


PLACES = [path for path in places(SCENE) if path]


def replaced(path, value):
    """The scene with another value at a place."""
    scene = copy.deepcopy(SCENE)
    inside = scene
    for key in path[:-1]:
        inside = inside[key]
    inside[path[-1]] = value
    return scene


def is_short(scenario):
    """Whether a scene that was accepted is over in a moment."""
    scene = scenario.to_dict()
    time = scene.get("time", {})
    step = time.get("step", 1)
    return (
        isinstance(step, (int, float))
        and time.get("duration", 1) / step <= 1000
        and all(rod.get("nodes", 2) <= 200 for rod in scene["rods"])
    )


@given(scene=VALUES)
def test_any_value_as_a_scene_is_refused_or_read(scene):
    try:
        der.Scenario.from_dict(scene)
    except REFUSALS:
        return


@given(text=st.text(max_size=200))
def test_any_text_is_refused_with_diagnostics(text):
    with pytest.raises(der.SceneError) as caught:  # no such text is a scene
        der.Scenario.parse(text)
    assert caught.value.diagnostics
    assert all(diagnostic.message for diagnostic in caught.value.diagnostics)


@given(path=st.sampled_from(PLACES), value=st.one_of(LEAVES, VALUES))
def test_any_value_at_any_place_of_a_scene_is_refused_or_runs_to_finite_numbers(path, value):
    try:
        scenario = der.Scenario.from_dict(replaced(path, value))
    except REFUSALS:
        return
    assert der.Scenario.from_dict(scenario.to_dict()).to_yaml() == scenario.to_yaml()
    if not is_short(scenario):
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = der.run(scenario, check=False)  # the status tells
    assert np.all(np.isfinite(result.positions))
    assert np.all(np.isfinite(result.probes["tip"])) if "tip" in result.probes else True


@given(path=st.text(max_size=30), value=VALUES)
def test_overrides_are_refused_or_taken(path, value):
    try:
        der.Scenario.from_dict(SCENE).with_(**{path: value})
    except REFUSALS:
        return


@given(name=st.one_of(st.sampled_from(["push", "wall"]), st.text(max_size=6)), value=VALUES)
def test_set_is_refused_or_leaves_finite_numbers(name, value):
    simulation = der.Simulation(SCENE)
    before = pickle.dumps(simulation.save_state())
    try:
        simulation.set(name, value)
    except REFUSALS:
        assert pickle.dumps(simulation.save_state()) == before
        return
    try:
        simulation.step()
    except der.DerError:
        return
    assert np.all(np.isfinite(simulation.positions))


@given(numbers=st.dictionaries(st.sampled_from(["x", "y", "z", "angle", "twist"]), NUMBERS))
def test_prescribe_is_refused_or_leaves_finite_numbers(numbers):
    simulation = der.Simulation(SCENE)
    try:
        simulation.prescribe(0, **numbers)
        simulation.step()
    except REFUSALS:
        pass
    assert np.all(np.isfinite(simulation.positions))


@given(
    which=st.sampled_from(["positions", "velocities", "extra_force"]),
    node=st.integers(0, 4),
    value=st.floats(),
)
def test_whatever_a_program_writes_a_step_answers_or_raises(which, node, value):
    simulation = der.Simulation(SCENE)
    getattr(simulation, which)[node, 1] = value
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            simulation.step()
        except REFUSALS:
            return
    assert np.all(np.isfinite(simulation.positions))
