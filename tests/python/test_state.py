"""A call that raises leaves the state as it was; a state that does not fit is not restored."""

import copy
import math
import pickle

import der
import numpy as np
import pytest


def dumped(simulation) -> bytes:
    return pickle.dumps(simulation.save_state())


@pytest.fixture
def moving(swing):
    """A swing whose clamp a program turns, in the middle of its run."""
    swing["supports"][0] |= {"name": "pin", "prescribe": {"y": 0, "angle": 0}}
    swing["time"]["integrator"] = "bdf2"
    simulation = der.Simulation(swing)
    simulation.extra_force[-1] = [0.1, 0.2]
    simulation.step(3)
    simulation.prescribe(0, angle=0.1)
    return simulation


def no_balance(simulation):
    """Nothing stands against a force at the end of a rod that turns on a pin."""
    simulation.extra_force[:] = 0.0
    simulation.extra_force[5] = [1e30, 1e30]


def write_nan(view, node=5):
    def write(simulation):
        getattr(simulation, view)[node, 1] = math.nan

    return write


def bad_force(simulation):
    simulation.add_force(lambda time, x, v: np.full(x.shape, math.nan))


def raising_force(simulation):
    def force(time, x, v):
        raise RuntimeError("no")

    simulation.add_force(force)


def far(simulation):
    simulation.prescribe(0, angle=1e9)


def other_state():
    scene = {
        "rods": [
            {
                "name": "arm",
                "nodes": 3,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"circle": {"radius": 0.01}},
                "material": {"youngs_modulus": 1e7, "density": 1000},
            }
        ],
        "supports": [{"rod": "arm", "at": "start", "clamp": True}],
        "time": {"duration": 1, "step": 0.1},
    }
    return der.Simulation(scene).save_state()


def nothing(simulation):
    pass


# The ways in which each public call can fail: the preparation that makes it fail, and the call.
FAILURES = {
    "step": [
        (far, lambda s: s.step()),
        (no_balance, lambda s: s.step()),
        (write_nan("extra_force"), lambda s: s.step()),
        (write_nan("extra_force", 0), lambda s: s.step()),
        (write_nan("positions"), lambda s: s.step()),
        (write_nan("velocities"), lambda s: s.step()),
        (bad_force, lambda s: s.step()),
        (raising_force, lambda s: s.step()),
        (nothing, lambda s: s.step(-1)),
    ],
    "equilibrium": [
        (no_balance, lambda s: s.equilibrium()),
        (write_nan("positions"), lambda s: s.equilibrium()),
        (bad_force, lambda s: s.equilibrium()),
        (raising_force, lambda s: s.equilibrium()),
    ],
    "run": [
        (nothing, lambda s: s.run(until=-1.0)),
        (nothing, lambda s: s.run(until=math.nan)),
        (raising_force, lambda s: s.run()),
        (nothing, lambda s: s.run(out="/dev/null/nowhere")),
    ],
    "record": [
        (raising_force, lambda s: s.record()),
        (nothing, lambda s: s.record(out="/dev/null/nowhere")),
    ],
    "recording": [(nothing, lambda s: s.recording(1))],
    "prescribe": [
        (nothing, lambda s: s.prescribe(0, x=1.0)),
        (nothing, lambda s: s.prescribe(7, y=1.0)),
        (nothing, lambda s: s.prescribe(0, y=1.0, angle=math.nan)),
        (nothing, lambda s: s.prescribe(0, y=0.5, x=1.0)),
    ],
    "set": [
        (nothing, lambda s: s.set("pni", 1.0)),
        (nothing, lambda s: s.set("pin", {"y": 0.5, "angle": math.nan})),
        (nothing, lambda s: s.set("pin", [1.0])),
        (nothing, lambda s: s.set("pin.angle", "left")),
        (nothing, lambda s: s.set("pin.angle", 1.0, over=-1.0)),
    ],
    "value": [(nothing, lambda s: s.value("pin.x"))],
    "modes": [
        (nothing, lambda s: s.modes()),
        (nothing, lambda s: s.modes(0)),
        (write_nan("positions"), lambda s: s.modes()),
    ],
    "vibration_modes": [(nothing, lambda s: s.vibration_modes(0))],
    "restore_state": [
        (nothing, lambda s: s.restore_state(other_state())),
        (nothing, lambda s: s.restore_state(None)),
    ],
    "add_force": [(nothing, lambda s: s.add_force(None))],
    "remove_force": [(nothing, lambda s: s.remove_force(far))],
    "prescribed": [(nothing, lambda s: s.prescribed("x"))],
    "hessian": [(nothing, lambda s: s.hessian(1))],
    "mass": [(nothing, lambda s: s.mass(1))],
    "actuation_forces": [(nothing, lambda s: s.actuation_forces(1))],
    "actuation_values": [(nothing, lambda s: s.actuation_values(1))],
    "reactions": [(nothing, lambda s: s.reactions(1))],
    "share_done": [(nothing, lambda s: s.share_done("x"))],
    "reaction_vectors": [(nothing, lambda s: s.reaction_vectors(1))],
    "gradient": [(nothing, lambda s: s.gradient(1))],
    "lower_hessian": [(nothing, lambda s: s.lower_hessian(1))],
    "lower_mass": [(nothing, lambda s: s.lower_mass(1))],
    "save_state": [(nothing, lambda s: s.save_state(1))],
}


def test_all_public_calls_are_in_the_list():
    calls = {
        name
        for name in dir(der.Simulation)
        if not name.startswith("_") and callable(getattr(der.Simulation, name))
    }
    assert calls == set(FAILURES)


@pytest.mark.parametrize(
    ("name", "number"), [(name, i) for name, ways in FAILURES.items() for i in range(len(ways))]
)
def test_a_call_that_throws_leaves_the_state_as_it_was(moving, name, number):
    prepare, call = FAILURES[name][number]
    prepare(moving)
    before = dumped(moving)
    moved = moving.prescribed(0)
    with pytest.raises(Exception):  # noqa: B017, PT011 - whatever it is
        call(moving)
    assert dumped(moving) == before
    assert moving.prescribed(0) == moved


@pytest.mark.parametrize("integrator", ["verlet", "explicit_euler", "tr_bdf2", "generalized_alpha"])
@pytest.mark.parametrize("stepping", ["step", "tolerance"])
@pytest.mark.parametrize("node", [0, 5])
def test_a_force_that_is_no_number_is_named_by_all_steppers(swing, integrator, stepping, node):
    explicit = integrator in ("verlet", "explicit_euler")
    value = 1e-3 if stepping == "tolerance" else "auto" if explicit else 0.002
    swing["time"] = {"duration": 0.2, "integrator": integrator, stepping: value}
    simulation = der.Simulation(swing)
    simulation.step(2)
    simulation.extra_force[node, 1] = math.nan
    before = dumped(simulation)
    with pytest.raises(der.DivergedError, match=rf"extra force of node {node} .* \(y\) is nan"):
        simulation.step()
    assert dumped(simulation) == before
    simulation.extra_force[:] = 0.0
    simulation.step()
    assert np.isfinite(simulation.positions).all()


@pytest.mark.parametrize("analysis", [{"buckling": {"count": 2}}, {"continuation": {"from": 0.5}}])
def test_an_analysis_that_fails_leaves_the_state_as_it_was(tube, analysis):
    tube["loads"] = [{"point_force": {"rod": "beam", "at": "middle", "force": [-1, 0]}}]
    tube["supports"] = [{"rod": "beam", "at": "end", "fix": ["y"]}]  # it can slide and turn
    del tube["time"], tube["output"]["every"]
    simulation = der.Simulation({**tube, "analysis": analysis})
    before = dumped(simulation)
    with pytest.raises(der.DerError):
        simulation.run()
    assert dumped(simulation) == before


# Restoring.


def test_a_state_of_a_moved_support_does_not_fit_a_scene_without(swing, moving):
    state = moving.save_state()
    plain = copy.deepcopy(swing)
    del plain["supports"][0]["prescribe"]
    with pytest.raises(ValueError, match="the same rods and supports"):
        der.Simulation(plain).restore_state(state)


def bent(swing, *parts):
    """The swing with actuations."""
    swing["actuation"] = [{"rod": "arm", **part} for part in parts]
    return der.Simulation(swing)


CURL = {"name": "curl", "natural_curvature": 0}
BEND = {"name": "bend", "natural_curvature": 0}
OTHER_NAMES = {
    "order": ((BEND, CURL), "'curl' of the state stands in the place of 'bend' of this scene"),
    "one less": ((CURL,), r"the state has 'bend' \(natural_curvature \[1/m\]\), which this scene"),
    "one more": ((CURL, BEND, {**BEND, "name": "b"}), "this scene has 'b' .* of the state lacks"),
    "kind": (
        (CURL, {"name": "bend", "elongation": 0}),
        r"'bend' of the state is natural_curvature \[1/m\], and here elongation",
    ),
}


@pytest.mark.parametrize("what", OTHER_NAMES)
@pytest.mark.parametrize("is_set", [True, False])
def test_a_state_knows_the_names_of_what_can_be_set(swing, what, is_set):
    """It sets controls by their number: in a scene that lists others it would set another one."""
    first = bent(swing, CURL, BEND)
    if is_set:
        first.set("bend", 1.0)
        first.step()
    state = pickle.loads(pickle.dumps(first.save_state()))
    same = bent(swing, CURL, BEND)
    same.restore_state(state)
    assert same.value("bend") == first.value("bend")
    parts, message = OTHER_NAMES[what]
    other = bent(swing, *parts)
    before = dumped(other)
    with pytest.raises(ValueError, match=message + ".*same names in the same order"):
        other.restore_state(state)
    assert dumped(other) == before


def test_tables_without_a_name_count_too(swing):
    """They shift the numbers of those that have one."""
    push = {"rod": "arm", "at": "end", "force": {"times": [0, 1], "values": [[0, 0], [0, 0]]}}
    swing["loads"] = [{"name": "push", "point_force": {**push, "force": [0, 0]}}]
    state = der.Simulation(swing).save_state()
    swing["loads"].insert(0, {"point_force": push})
    with pytest.raises(ValueError, match="other tables without a name stand before it"):
        der.Simulation(swing).restore_state(state)


def test_time_goes_on_under_another_step(swing):
    first = der.Simulation(swing)
    first.step(33)
    state = first.save_state()
    for step in (0.005, 0.0007, 0.02):
        swing["time"]["step"] = step
        swing["output"]["every"] = step
        simulation = der.Simulation(swing)
        simulation.restore_state(state)
        assert simulation.time == first.time
        simulation.step()
        assert 0.0 < simulation.time - first.time <= step * (1 + 1e-9)
        assert simulation.time / step == pytest.approx(round(simulation.time / step), abs=1e-9)
        result = simulation.run()
        assert result.status == "completed"
        assert result.times[-1] == 0.2
        assert np.diff(result.times).max() <= step * (1 + 1e-9)


def test_equal_steps_count_their_time_as_before(swing):
    """Times are whole multiples of the step to the last bit, the last one is the duration."""
    swing["time"] |= {"duration": 0.0305, "step": 0.003}
    swing["output"]["every"] = 0.003
    simulation = der.Simulation(swing)
    times = []
    while not simulation.finished:
        simulation.step()
        times.append(simulation.time)
    assert times == [i * 0.003 for i in range(1, 11)] + [0.0305]
    simulation.step()
    assert simulation.time == 12 * 0.003


HEAD = ("kind", "version", "nodes", "dimension", "fields", "controls")


def content_of(state):
    """The content of the pickle of a state."""
    return dict(zip(HEAD, state.__reduce_ex__(4)[2], strict=True))


def revived(state, content):
    """A state of other content, as a damaged file might have it."""
    function, (cls,) = state.__reduce_ex__(4)[:2]
    fresh = function(cls)
    fresh.__setstate__(content)
    return fresh


def changed(state, **parts):
    """The state with parts of its pickled content replaced."""
    content = content_of(state)
    for name, value in parts.items():
        (content if name in HEAD else content["fields"])[name] = value
    return revived(state, tuple(content.values()))


def ramp(**parts):
    way = {"step": 0.0, "before": 0.0, "earlier": 0.0}
    return {"control": 0, "start": 0.0, "end": 1.0, "from": 0.0, "to": 1.0} | way | parts


def bdf2(size, **parts):
    return ("bdf2", {"displacement": np.zeros(size), "velocities": np.zeros(size)} | parts)


MALFORMED = {
    "short positions": {"positions": np.zeros(3)},
    "short velocities": {"velocities": np.zeros(4)},
    "short forces": {"extra_force": np.zeros(4)},
    "short accelerations": {"accelerations": np.zeros(4)},
    "short memory": {"memory": bdf2(2)},
    "half a memory": {"memory": ("bdf2", {"displacement": np.zeros(22)})},
    "memory of more": {"memory": bdf2(22, accelerations=np.zeros(22))},
    "memory of nan": {"memory": bdf2(22, velocities=np.full(22, math.nan))},
    "unknown memory": {"memory": ("bdf3", {})},
    "memory without a name": {"memory": {}},
    "unknown field": {"momenta": np.zeros(22)},
    "a number for a struct": {"work": 0.0},
    "short turns": {"followed": np.zeros(0)},
    "two dimensions": {"positions": np.zeros((11, 2))},
    "integers": {"velocities": np.zeros(22, dtype=int)},
    "text": {"velocities": "none"},
    "no time": {"time": math.nan},
    "loads that vary": {"load_factor": 0.5},
    "no load factor": {"load_factor": math.nan},
    "endless": {"time": math.inf},
    "before the start": {"time": -1.0},
    "negative count": {"step": -5},
    "dimension": {"dimension": 0},
    "no node": {"nodes": 0},
    "too many nodes": {"nodes": 12},
    "other kind": {"kind": "der.Model"},
    "other version": {"version": 99},
    "no names": {"controls": []},
    "a name that is a number": {"controls": [{"name": 1}]},
    "names of another type": {"controls": "pin"},
    "control": {"ramps": [ramp(control=17)]},
    "negative control": {"ramps": [ramp(control=-1)]},
    "half a control": {"ramps": [ramp(control=0.5)]},
    "ramp without end": {"ramps": [ramp(end=math.nan)]},
    "ramp of four": {"ramps": [{"control": 0, "start": 0.0, "end": 1.0, "from": 0.0}]},
    "backward ramp": {"ramps": [ramp(start=1.0, end=0.5)]},
    "turn": {"followed": np.array([math.nan])},
}


@pytest.mark.parametrize("what", MALFORMED)
def test_malformed_states_are_refused(moving, what):
    state = moving.save_state()
    before = dumped(moving)
    with pytest.raises(ValueError, match=r"state|turn"):
        moving.restore_state(changed(state, **MALFORMED[what]))
    assert dumped(moving) == before


def test_strided_arrays_are_read_as_they_are(moving):
    state = moving.save_state()
    values = np.array(state.velocities).ravel()
    strided = np.repeat(values, 3)[::3]
    assert not strided.flags.c_contiguous
    assert np.array_equal(changed(state, velocities=strided).velocities, state.velocities)


def test_each_field_that_is_missing_is_named(moving):
    state = moving.save_state()
    content = content_of(state)
    for name in content["fields"]:
        rest = {key: value for key, value in content["fields"].items() if key != name}
        with pytest.raises(ValueError, match=f"'{name}' is missing"):
            revived(state, tuple({**content, "fields": rest}.values()))


def test_pickles_of_other_versions_are_refused_by_name(moving):
    state = moving.save_state()
    content = tuple(content_of(state).values())
    for version in (content[1] - 1, content[1] + 1):
        with pytest.raises(ValueError, match=f"it is of version {version}, not {content[1]}"):
            revived(state, (content[0], version, *content[2:]))
    # Version 1 had its parts one behind the other; before it there was no version.
    with pytest.raises(ValueError, match="it is of version 1"):
        revived(state, (content[0], 1, 2, 0.5, 3, *content))
    with pytest.raises(ValueError, match="not a saved state of this version of der"):
        revived(state, (2, 0.5, 3))


@pytest.mark.parametrize(
    ("integrator", "memory"), [("bdf2", "bdf2"), ("verlet", "stability"), ("tr_bdf2", "none")]
)
def test_the_memory_of_a_stepper_is_saved_by_name(swing, integrator, memory):
    step = "auto" if integrator == "verlet" else 0.002
    swing["time"] = {"duration": 0.2, "integrator": integrator, "step": step}
    simulation = der.Simulation(swing)
    assert content_of(simulation.save_state())["fields"]["memory"][0] == "none"
    simulation.step(3)
    state = simulation.save_state()
    assert content_of(state)["fields"]["memory"][0] == memory
    again = der.Simulation(swing)
    again.restore_state(pickle.loads(pickle.dumps(state)))
    for each in (simulation, again):
        each.step(20)
    assert dumped(again) == dumped(simulation)


def test_a_time_too_late_for_its_step_is_named(moving):
    moving.restore_state(changed(moving.save_state(), time=1e300, ramps=[]))
    assert moving.finished
    with pytest.raises(der.DerError, match="rounding of the time"):
        moving.step()


# The number of steps.


def test_more_steps_than_anyone_can_wait_for_are_refused(swing):
    """Their number overflowed, and the run ended at once as completed."""
    swing["rods"][0]["material"]["youngs_modulus"] = 1e30
    for time in ({"step": "auto"}, {"tolerance": 1e-3}):
        swing["time"] = {"duration": 1e9, "integrator": "verlet", **time}
        swing.pop("output", None)
        with pytest.raises(der.DerError, match=r"more than 1e\+12 steps"):
            der.Simulation(swing)
