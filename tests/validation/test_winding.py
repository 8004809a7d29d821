"""Springs and clamps that turn by more than half a turn, against the rigid bar.

The bar is so stiff (EI = 1e4 k L) that theta = M / k, and a spring wound up by theta holds
k theta^2 / 2: bending changes theta by a share of 1e-4 at most.
"""

import pickle

import der
import numpy as np
import pytest
from scenes import END, START, Scene, straight

K = 1e-4  # N m/rad, against EI = 1
BENT = 3e-4  # twice the share of theta
TURNS = [4.0, 10.0, 25.0]


def bar(nodes=5, **more) -> Scene:
    """Pinned at its start on a spring against turning."""
    scene = straight(nodes - 1, "free-free", 1e4, **more)
    scene["supports"] = [{**START, "fix": ["x", "y"], "spring": {"rotational_stiffness": K}}]
    return scene


def stored(turn):
    return pytest.approx(0.5 * K * turn**2, rel=BENT)


@pytest.mark.parametrize("turn", [*TURNS, -10.0])
def test_a_moment_winds_a_spring_up(turn):
    scene = bar(loads=[{"moment": {**END, "moment": K * turn}}])
    simulation = der.Simulation(scene)
    assert simulation.equilibrium().stability == "stable"
    assert simulation.energies.spring == stored(turn)
    x, y = simulation.positions[-1]
    assert np.angle(complex(x, y) * np.exp(-1j * turn)) == pytest.approx(0.0, abs=2e-3)
    # From there on, and back: one wound up stays so.
    assert np.abs(simulation.gradient()).max() < 1e-4 * K
    simulation.equilibrium()
    assert simulation.energies.spring == stored(turn)


def test_a_path_winds_a_spring_up():
    scene = bar(loads=[{"moment": {**END, "moment": K * 10.0}}])
    result = der.continuation(scene, step=0.2)
    factors = result.path.factor
    assert factors[-1] == pytest.approx(1.0)
    expected = 0.5 * K * (10.0 * factors) ** 2
    assert result.energies["spring"] == pytest.approx(expected, rel=BENT, abs=1e-9 * K)


@pytest.mark.parametrize("angle", [2 * np.pi, 8.0, -8 * np.pi])
def test_a_clamp_winds_a_spring_up_in_statics(angle):
    """Whole turns too, where the clamp ends as it began: from the drawn shape and from another."""
    scene = wound(angle)
    assert der.run(scene).energies["spring"][-1] == stored(angle)
    scene["supports"][0]["prescribe"] = {"angle": 0.0}
    simulation = der.Simulation(scene)
    simulation.equilibrium()
    for target in (angle, 0.0, angle):
        simulation.prescribe(0, angle=target)
        simulation.equilibrium()
        assert simulation.energies.spring == pytest.approx(
            0.5 * K * target**2, rel=BENT, abs=1e-9 * K
        )


def wound(angle) -> Scene:
    """Turned by a clamp at its start, against a spring at its free end."""
    scene = straight(4, "free-free", 1e4)
    scene["supports"] = [
        {**START, "clamp": True, "prescribe": {"angle": angle}},
        {**END, "spring": {"rotational_stiffness": K}},
    ]
    return scene


def test_a_clamp_winds_a_spring_up_along_a_path():
    """Two turns in each of the largest steps."""
    result = der.continuation(wound(8 * np.pi), vary="supports", step=0.5)
    assert result.path.factor[-1] == pytest.approx(1.0)
    assert result.energies["spring"][-1] == stored(8 * np.pi)


@pytest.mark.parametrize(
    "time",
    [
        {"step": 2.5, "integrator": "implicit_euler"},
        {"step": 12.5, "integrator": "implicit_euler"},
        {"tolerance": 1e-2, "integrator": "tr_bdf2"},
    ],
)
def test_a_clamp_that_turns_once_round_in_a_step_is_followed(time):
    """Whether in all of the step or in a part of it."""
    scene = wound({"times": [2.5, 5.0], "values": [0, 2 * np.pi]})
    del scene["analysis"]
    scene["loads"] = [{"damping": {"rod": "rod", "coefficient": 0.5}}]
    scene["time"] = {"duration": 50.0, **time}
    result = der.run(scene)
    assert result.energies["spring"][-1] == stored(2 * np.pi)
    if "step" in time:
        assert result.summary["retried_steps"] > 0


def test_an_end_that_moves_far_in_a_step_is_followed():
    """Both ends clamped, one moves aside by two edges: steps of its time end in the same shape."""
    shapes = []
    for step in (0.1, 0.0025):
        scene = straight(20, "clamped-clamped", 1e4)
        push = {"times": [0, 0.1], "values": [0, 0.1]}
        scene["supports"] = [
            {**START, "clamp": True},
            {**END, "clamp": True, "prescribe": {"y": push}},
        ]
        scene["loads"] = [{"damping": {"rod": "rod", "coefficient": 50.0}}]
        del scene["analysis"]
        scene["time"] = {"duration": 1.0, "step": step, "integrator": "implicit_euler"}
        result = der.run(scene)
        shapes.append(result.positions[-1])
        assert (result.summary["retried_steps"] > 0) == (step == 0.1)
    assert shapes[0] == pytest.approx(shapes[1], abs=1e-4)


def test_supports_that_move_beyond_all_reason_are_named():
    scene = wound({"times": [0, 1], "values": [0, 1e9]})
    del scene["analysis"]
    scene["time"] = {"duration": 1.0, "step": 0.25}
    with pytest.raises(der.NotConvergedError, match="numbers and units of 'prescribe'"):
        der.run(scene)


STEPPERS = ["implicit_midpoint", "generalized_alpha", "bdf2", "tr_bdf2", "sdirk4", "verlet"]


THROWN = 13.5 * K


def thrown(energy=THROWN, **time) -> Scene:
    """A bar of two nodes, thrown round until the spring has all of its energy."""
    scene = bar(nodes=2)
    scene["rods"][0]["cross_section"]["stiffness"] = {"EA": 10.0, "EI": 1.0, "mass_per_length": 1.0}
    inertia = 0.5  # of the free end; the edge at a held node is lumped
    scene["rods"][0]["initial_velocity"] = [[0, 0], [0, float(np.sqrt(2 * energy / inertia))]]
    del scene["analysis"]
    quarter = 0.5 * np.pi * np.sqrt(inertia / K)
    scene["time"] = {"duration": float(quarter), **time}
    return scene


@pytest.mark.parametrize("integrator", STEPPERS)
def test_a_bar_thrown_round_winds_its_spring_up(integrator):
    """By sqrt(27) rad: 13.5 k, where half a turn holds 4.93 k."""
    quarter = thrown(step=1.0)["time"]["duration"]
    scene = thrown(step=quarter / 4000, integrator=integrator)
    scene["output"] = {
        "every": quarter / 40,
        "probes": {"spring": {"quantity": "spring_energy"}},
    }
    result = der.run(scene)
    assert result.energies["spring"][-1] == pytest.approx(THROWN, rel=1e-2)
    assert result.probes["spring"][-1] == result.energies["spring"][-1]
    swing = np.sin(0.5 * np.pi * result.times / quarter)
    assert result.energies["spring"] == pytest.approx(THROWN * swing**2, abs=0.01 * THROWN)
    assert abs(result.work["numerical"][-1]) < 1e-2 * THROWN


def test_adaptive_steps_follow_a_spring_too():
    result = der.run(thrown(tolerance=1e-3, integrator="tr_bdf2"))
    assert result.energies["spring"][-1] == pytest.approx(THROWN, rel=2e-2)


def test_a_wound_spring_is_saved_and_goes_on(tmp_path):
    """Through a pickle, and through a run that starts where another ended."""
    quarter = thrown(step=1.0)["time"]["duration"]
    scene = thrown(step=quarter / 400, integrator="implicit_midpoint")
    first = der.Simulation(scene)
    wound_up = first.run(out=tmp_path / "first").energies["spring"][-1]
    assert wound_up == pytest.approx(THROWN, rel=1e-2)

    second = der.Simulation(scene)
    second.restore_state(pickle.loads(pickle.dumps(first.save_state())))
    assert second.energies.spring == wound_up

    third = der.Simulation({**scene, "start_from": str(tmp_path / "first")})
    assert third.energies.spring == pytest.approx(wound_up, rel=1e-12)
    third.step(400)  # and back it swings
    assert third.energies.spring < 1e-2 * wound_up


def test_a_turn_that_a_program_writes_is_the_shorter_way():
    simulation = der.Simulation(thrown(energy=1e-12, step=1e-2))
    simulation.positions[1] = [0, -1]
    assert simulation.energies.spring == stored(np.pi / 2)
    simulation.step()
    assert simulation.energies.spring == pytest.approx(0.5 * K * (np.pi / 2) ** 2, rel=1e-2)


def between(start, end) -> Scene:
    """A rod that bends, between two supports."""
    scene = straight(40, "clamped-clamped", 1e4)
    scene["supports"] = [{**START, **start}, {**END, **end}]
    return scene


#: Rods whose equilibrium has turned a clamp, or has one prescribed nearer by more than an edge.
TURNED = {
    "nearer": between(
        {"clamp": True, "prescribe": {"angle": 0.4}},
        {"clamp": True, "prescribe": {"x": -0.25, "angle": -0.4}},
    ),
    "held": between({"clamp": True}, {"clamp": True, "prescribe": {"x": -0.3, "angle": 5.0}}),
    "both": between(
        {"clamp": True, "prescribe": {"angle": -2.0}},
        {"clamp": True, "prescribe": {"x": -0.3, "angle": 5.0}},
    ),
    "pinned": between({"fix": ["x", "y"]}, {"clamp": True, "prescribe": {"x": -0.3, "angle": 5.0}}),
    "spring": between(
        {"fix": ["x", "y"], "spring": {"rotational_stiffness": 10.0}},
        {"clamp": True, "prescribe": {"x": -0.3, "angle": 5.0}},
    ),
}


@pytest.fixture(params=TURNED)
def turned(request):
    """One of these scenes, and a simulation in its equilibrium."""
    simulation = der.Simulation(TURNED[request.param])
    assert simulation.equilibrium().stability == "stable"
    return TURNED[request.param], simulation


def test_an_equilibrium_that_a_program_writes_is_kept(turned):
    """Its turns are those of the shape. They were counted from where the supports begin, which had
    turned an edge over: the rod was wound by a whole turn."""
    scene, first = turned
    simulation = der.Simulation(scene)
    simulation.positions[...] = first.positions
    batch = der.Batch(scene, 2, 1)
    batch.positions[1] = first.positions
    restored = der.Simulation(scene)
    restored.positions[...] = first.positions
    state = restored.save_state()
    restored = der.Simulation(scene)
    restored.restore_state(state)
    for written in (simulation, batch, restored):
        written.equilibrium()
    for found in (simulation.positions, batch.positions[1], restored.positions):
        assert found == pytest.approx(first.positions, abs=1e-9)


def test_a_search_from_a_saved_equilibrium_keeps_its_turns(turned, tmp_path):
    """Whether the clamps are where they were, or nearer by more than an edge."""
    scene, first = turned
    der.run(scene, out=tmp_path / "first")
    kept = der.run({**scene, "start_from": str(tmp_path / "first")})
    assert kept.positions[-1] == pytest.approx(first.positions, abs=1e-9)

    prescribed = {**scene["supports"][1]["prescribe"], "x": -0.4}
    nearer = {
        **scene,
        "supports": [scene["supports"][0], {**scene["supports"][1], "prescribe": prescribed}],
    }
    moved = der.run({**nearer, "start_from": str(tmp_path / "first")})
    first.prescribe(1, x=-0.4)
    first.equilibrium()
    assert moved.positions[-1] == pytest.approx(first.positions, abs=1e-8)


def test_a_shape_without_turns_that_a_program_writes_unwinds_a_rod():
    """Two turns were in it before; the shape that is written has none."""
    scene = between({"clamp": True}, {"clamp": True, "prescribe": {"x": -0.05, "angle": 0.0}})
    simulation = der.Simulation(scene)
    simulation.equilibrium()
    shape = simulation.positions.copy()
    simulation.prescribe(1, x=-0.5, angle=4 * np.pi)
    simulation.equilibrium()
    simulation.positions[...] = shape
    simulation.prescribe(1, x=-0.05, angle=0.0)
    simulation.equilibrium()
    assert simulation.positions == pytest.approx(shape, abs=1e-9)


@pytest.mark.parametrize("shortening", [0.1, 0.4])
def test_a_search_from_a_run_whose_clamps_did_not_turn(tmp_path, shortening):
    """It saved no turns. They were counted from where this scene has the supports: the rod was
    wound by a whole turn."""

    def ends(x, start, end):
        return between({"clamp": True, **start}, {"clamp": True, "prescribe": {"x": x, **end}})

    der.run(ends(-0.25, {}, {}), out=tmp_path / "first")
    clamps = {"prescribe": {"angle": 0.4}}, {"angle": -0.4}
    later = der.run({**ends(-shortening, *clamps), "start_from": str(tmp_path / "first")})
    simulation = der.Simulation(ends(-0.25, {"prescribe": {"angle": 0.0}}, {"angle": 0.0}))
    simulation.equilibrium()
    simulation.prescribe(0, angle=0.4)
    simulation.prescribe(1, x=-shortening, angle=-0.4)
    simulation.equilibrium()
    assert later.energies["bend"][-1] == pytest.approx(simulation.energies.bend, rel=1e-8)
