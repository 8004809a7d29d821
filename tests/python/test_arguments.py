"""Wrong arguments from Python get a message that says what to write, not signatures of C++."""

import der
import numpy as np
import pytest

SCENE = {
    "title": "Arm",
    "rods": [
        {
            "name": "arm",
            "nodes": 7,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"stiffness": {"EA": 1e3, "EI": 1.0, "mass_per_length": 1.0}},
        }
    ],
    "supports": [
        {"name": "wall", "rod": "arm", "at": "start", "clamp": True, "prescribe": {"angle": 0}}
    ],
    "loads": [{"name": "push", "point_force": {"rod": "arm", "at": "end", "force": [0, -1]}}],
    "time": {"duration": 0.1, "step": 0.01},
    "output": {"every": 0.01},
}
HUGE = 10**30


@pytest.fixture
def simulation():
    return der.Simulation(SCENE)


@pytest.fixture
def batch():
    return der.Batch(SCENE, 3, 1)


@pytest.fixture(scope="module")
def result():
    return der.run(SCENE)


@pytest.mark.parametrize("given", [2.5, np.float64(2.0), "3", None, True, [1], HUGE, -1])
def test_what_is_no_number_of_steps(simulation, batch, given):
    error = ValueError if given in (HUGE, -1) else TypeError
    for call in (simulation.step, batch.step):
        with pytest.raises(error, match="number of steps must be a whole number of at least 0"):
            call(given)
    assert simulation.step_count == 0
    assert not batch.step_count.any()


def test_whole_numbers_of_numpy_are_taken(simulation, batch):
    simulation.step(np.int64(2))
    batch.step(np.uint8(2))
    assert simulation.step_count == 2
    assert len(der.Batch(SCENE, np.int64(2), np.int32(1))) == 2
    batch.reset(np.int64(1))
    assert batch.step_count.tolist() == [2, 0, 2]


@pytest.mark.parametrize("given", [2.5, "0", None, -1, HUGE])
def test_what_is_no_support(simulation, batch, given):
    error = ValueError if given in (HUGE, -1) else TypeError
    message = "number of the support must be a whole number of at least 0"
    for one in (simulation, batch):
        with pytest.raises(error, match=message):
            one.prescribe(given, angle=0.1)
    with pytest.raises(error, match=message):
        simulation.prescribed(given)


def test_a_support_that_the_scene_has_not(simulation, batch):
    message = "there is no support 7: the scene has 1, counted from 0"
    for call in (simulation.prescribe, batch.prescribe):
        with pytest.raises(der.DerError, match=message):
            call(7, angle=0.1)
    with pytest.raises(der.DerError, match=message):
        simulation.prescribed(7)
    free = der.Simulation({**SCENE, "supports": []})
    with pytest.raises(der.DerError, match="there is no support 0: the scene has none"):
        free.prescribed(0)


def test_a_component_that_no_support_has(simulation, batch):
    message = "no component 'turn' to move: there are 'x', 'y', 'z', 'angle' and 'twist'"
    for one in (simulation, batch):
        with pytest.raises(der.DerError, match=message):
            one.prescribe(0, angle=0.1, turn=0.1)
        one.step()
    assert simulation.prescribed(0) == {"angle": 0.0}
    assert not batch.value("wall.angle").any()


@pytest.mark.parametrize("name", ["positions", "velocities", "extra_force", "theta", "spin"])
def test_nothing_takes_the_place_of_an_array(simulation, batch, name):
    for one in (simulation, batch):
        before = getattr(one, name).copy()
        with pytest.raises(
            AttributeError, match=rf"write into it, as in {name}\[\.\.\.\] = values"
        ):
            setattr(one, name, before + 1.0)
        assert np.array_equal(getattr(one, name), before)


def test_a_probe_that_the_scene_has_not():
    probes = {"tip": {"rod": "arm", "at": "end", "quantity": "y"}}
    scene = {**SCENE, "output": {"every": 0.01, "probes": probes}}
    for one in (der.Simulation(scene), der.Batch(scene, 2), der.run(scene)):
        assert list(one.probes) == ["tip"]
        with pytest.raises(KeyError, match="the scene has no probe 'top'; it has 'tip'"):
            one.probes["top"]
    with pytest.raises(KeyError, match=r"no probe 'top'; it has none, and takes them in output"):
        der.Simulation(SCENE).probes["top"]


@pytest.mark.parametrize("given", ["a", [1, 2], object()])
def test_what_is_no_value(simulation, batch, given):
    with pytest.raises(TypeError, match="angle must be a number, got"):
        simulation.prescribe(0, angle=given)
    with pytest.raises(TypeError, match="over must be a number, got"):
        simulation.set("push", [0, 1], over=given)
    if given != [1, 2]:
        with pytest.raises(TypeError, match="'angle' takes numbers, or arrays of them, got"):
            batch.prescribe(0, angle=given)
        with pytest.raises(TypeError, match=r"'push\.y' takes numbers, or arrays of them, got"):
            batch.set("push.y", given)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.equilibrium("no"), "leave_saddles must be True or False, got 'no'"),
        (lambda s: s.modes(2.5), "number of modes must be a whole number of at least 1, got 2.5"),
        (lambda s: s.restore_state("x"), "a state that save_state has returned is needed, got 'x'"),
        (lambda s: s.prescribe(0, 0.1), r"names of components: write prescribe\(0, angle=0\.1\)"),
        (lambda s: s.add_force(5), r"a force is a function\(time, positions, velocities\), got 5"),
        (lambda s: s.value(3), "the name must be a text, got 3"),
        (lambda s: s.run(5), "callback must be a function, got 5"),
        (lambda s: s.run(progress="x"), "progress must be True, False or a function, got 'x'"),
        (lambda s: s.run(until="x"), "until must be a time in s, got 'x'"),
        (lambda s: s.run(out=5), "not int"),
        (lambda s: s.scenario.with_(5), r"by their key paths, such as \{.*not by 5"),
        (lambda s: der.run(s.scenario, "folder"), r"by their key paths, .* not by 'folder'"),
        (lambda s: s.scenario.varies_load("a"), "number of the load must be a whole number"),
        (lambda _: der.Scenario.load(5), "expected a Scenario, the path of a scene file, .* got 5"),
        (lambda _: der.Scenario.parse(5), "the text of a scene must be a text, got 5"),
        (lambda _: der.Scenario.parse("", 5), "the name of the source must be a text, got 5"),
        (lambda _: der.Scenario.from_dict([1]), "a scene is a dict with the keys .* got \\[1\\]"),
    ],
)
def test_what_simulations_and_scenes_do_not_take(simulation, call, message):
    with pytest.raises(TypeError, match=message):
        call(simulation)


def test_a_name_is_one_name_and_no_list_of_letters(result):
    with pytest.raises(ValueError, match="the scene has no probe 'tip'"):
        result.plot("probes", probes="tip")
    with pytest.raises(ValueError, match="the sweep has no column 'tip'"):
        der.sweep(SCENE, {"rods.arm.nodes": [5, 7]}).plot("tip")


def test_what_results_do_not_take(result):
    for given in (1.5, "a", None):
        with pytest.raises(TypeError, match="number of the frame must be a whole number"):
            result.held_nodes(given)
        with pytest.raises(TypeError, match="number of the load must be a whole number"):
            result.load_arc_lengths(given)
    with pytest.raises(IndexError, match="there is no load 1: the scene has 1, counted from 0"):
        result.load_arc_lengths(1)
    with pytest.raises(TypeError, match="name of the rod must be a text, got 5"):
        result.along(5, "x")
    with pytest.raises(TypeError, match="name of the quantity must be a text, got None"):
        result.along("arm", None)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"members": 2.5}, TypeError, "members must be a whole number of at least 1, got 2.5"),
        ({"members": True}, TypeError, "members must be a whole number of at least 1, got True"),
        ({"members": HUGE}, ValueError, "members must be a whole number .* and at most"),
        ({"members": 2, "threads": 1.5}, TypeError, "threads must be a whole number"),
        ({"members": 2, "threads": HUGE}, ValueError, "threads must be a whole number .* at most"),
        ({"members": 2, "vary": 5}, TypeError, "vary must be a dict of key paths"),
        ({"members": 2, "vary": {5: [1, 2]}}, TypeError, "vary must be a dict of key paths"),
    ],
)
def test_what_makes_no_batch(arguments, error, message):
    with pytest.raises(error, match=message):
        der.Batch(SCENE, **arguments)


@pytest.mark.parametrize(
    ("members", "error", "message"),
    [
        ([1.5], TypeError, r"members are whole numbers, such as \[0, 2\], or a mask of 3"),
        (np.array([1.0]), TypeError, "members are whole numbers"),
        ("ab", TypeError, "members are whole numbers"),
        ([[0, 1]], TypeError, "members are whole numbers"),
        (-1, IndexError, "there is no member -1: they are counted from 0 to 2"),
        ([0, 3], IndexError, "there is no member 3"),
        ([True, False], ValueError, r"a mask of members .* not one of the shape \(2,\)"),
        (True, ValueError, "a mask of members"),
    ],
)
def test_what_is_no_member(batch, members, error, message):
    batch.step()
    with pytest.raises(error, match=message):
        batch.reset(members)
    assert batch.step_count.tolist() == [1, 1, 1]


def test_members_by_lists_and_masks(batch):
    for members, left in (([0, 2], [0, 1, 0]), ({1}, [1, 0, 1]), ([], [1, 1, 1])):
        batch.reset()
        batch.step()
        batch.reset(members)
        assert batch.step_count.tolist() == left
    for mask in ([True, False, True], np.array([True, False, True])):
        batch.reset()
        batch.step()
        batch.reset(mask)
        assert batch.step_count.tolist() == [0, 1, 0]


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        (5, ValueError, r"takes values of shape \(3, 2\), .* array of shape \(\)"),
        (np.zeros((3, 1)), ValueError, r"array of shape \(3, 1\)"),
        (None, TypeError, "takes numbers, or arrays of them, got None"),
        (["1", "2"], TypeError, "takes numbers, or arrays of them"),
        (np.array([1j, 2]), TypeError, "takes numbers, or arrays of them"),
        ([[1, 2], [3]], TypeError, "takes numbers, or arrays of them"),
    ],
)
def test_what_is_no_force_of_all_members(batch, value, error, message):
    with pytest.raises(error, match=f"'push' .*{message}"):
        batch.set("push", value)
    batch.step()
    assert batch.value("push").tolist() == [[0, -1]] * 3


def test_what_a_force_function_does_not_return(simulation):
    simulation.add_force(lambda *_: "x")
    with pytest.raises(ValueError, match=r"the force function .* returned no array .* but 'x'"):
        simulation.step()


def test_what_is_no_state_of_a_member(batch):
    for state in ("x", 5, [1, 2]):
        with pytest.raises(TypeError, match="a state that save_state has returned is needed"):
            batch.reset([0, 1], state)
    for call in (batch.save_state, batch.scenario):
        with pytest.raises(TypeError, match="number of the member must be a whole number"):
            call(1.5)
        with pytest.raises(ValueError, match=r"number of the member must be .* got -1"):
            call(-1)
    with pytest.raises(TypeError, match="leave_saddles must be True or False"):
        batch.equilibrium("no")


def test_long_values_are_not_shown_whole(simulation):
    with pytest.raises(TypeError, match="got <class 'list'>"):
        simulation.step(list(range(1000)))


def test_mappings_are_scenes():
    from types import MappingProxyType

    assert der.Simulation(MappingProxyType(SCENE)).total_steps == 10
