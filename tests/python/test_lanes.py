"""Members of a batch whose steps are done together, in the lanes of one register.

The reference is `der.Simulation` of each member on its own: every bit of its state, works and
audit included.
"""

from __future__ import annotations

import copy
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import der
import numpy as np
import pytest

Scene = dict[str, Any]

MODULUS = "rods.rod.material.youngs_modulus"


def swing(nodes: int = 12, **changes: Any) -> Scene:
    """Return a soft rod that falls from a clamp."""
    return {
        "rods": [
            {
                "name": "rod",
                "nodes": nodes,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"circle": {"radius": 0.01}},
                "material": {"youngs_modulus": 1e7, "density": 1000},
            }
        ],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "loads": [{"gravity": [0, -9.81]}],
        "time": {"duration": 1, "step": 0.0025, "integrator": "implicit_midpoint"},
        **changes,
    }


def with_rod(scene: Scene, **changes: Any) -> Scene:
    scene["rods"][0].update(changes)
    return scene


def two_rods() -> Scene:
    scene = swing()
    other = copy.deepcopy(scene["rods"][0])
    other.update(name="other", nodes=6, to=[0, -1])
    scene["rods"].append(other)
    scene["supports"].append({"rod": "other", "at": "start", "fix": ["x", "y"]})
    return scene


def bent_rod() -> Scene:
    """Return a rod with a corner, drawn node by node."""
    scene = swing()
    for key in ("nodes", "from", "to"):
        del scene["rods"][0][key]
    legs = [[0.1 * i, 0.0] for i in range(6)] + [[0.5, 0.1 * i] for i in range(1, 6)]
    return with_rod(scene, points=legs)


SCENES: dict[str, Scene] = {
    "clamped": swing(),
    "pinned": swing(supports=[{"rod": "rod", "at": "start", "fix": ["x", "y"]}]),
    "free": swing(supports=[]),
    "both ends": swing(
        supports=[{"rod": "rod", "at": at, "clamp": True} for at in ("start", "end")]
    ),
    "tangent measure": with_rod(swing(), curvature="tangent"),
    "natural curvature": with_rod(swing(), natural_curvature=2.0),
    "spring and foundation": swing(
        supports=[
            {"rod": "rod", "at": "end", "spring": {"stiffness": [3.0, 5.0]}},
            {"rod": "rod", "at": "start", "clamp": True},
        ],
        loads=[
            {"gravity": [0, -9.81]},
            {"foundation": {"rod": "rod", "stiffness": [0, 20.0]}},
            {"point_force": {"rod": "rod", "at": 0.4, "force": [0.1, 0.2]}},
        ],
    ),
    "springs of four nodes": swing(
        4,
        supports=[
            {"rod": "rod", "at": "start", "clamp": True},
            {"rod": "rod", "at": 0.47, "spring": {"stiffness": [3.0, 5.0]}},
        ],
    ),
    "springs of three nodes": swing(
        3,
        supports=[
            {"rod": "rod", "at": 0.3, "spring": {"stiffness": [3.0, 5.0]}},
            {"rod": "rod", "at": "end", "fix": ["x", "y"]},
        ],
    ),
    "tangent measure, both ends": with_rod(
        swing(supports=[{"rod": "rod", "at": at, "clamp": True} for at in ("start", "end")]),
        curvature="tangent",
        natural_curvature=1.0,
    ),
    "what programs set": swing(
        supports=[
            {
                "name": "wall",
                "rod": "rod",
                "at": "start",
                "clamp": True,
                "prescribe": {"x": {"times": [0, 0.02, 1], "values": [0, 0.01, 0]}, "y": 0},
            }
        ],
        loads=[
            {"name": "weight", "gravity": [0, -9.81]},
            {"name": "push", "point_force": {"rod": "rod", "at": 0.43, "force": [0, 0.2]}},
            {
                "distributed_force": {
                    "rod": "rod",
                    "force": {"sine": {"amplitude": [0, 1], "frequency": 9}},
                }
            },
        ],
    ),
    "spheres in a fluid": with_rod(
        swing(
            supports=[],
            loads=[{"gravity": [0, -9.81]}, {"fluid": {"density": 100, "viscosity": 1.0}}],
        ),
        spheres=[{"at": "all", "radius": 0.02, "density": 3000}],
    ),
    "corner": bent_rod(),
    "two rods": two_rods(),
    "3 nodes": swing(3),
    "5 nodes": swing(5),
    "9 nodes": swing(9),
    "30 nodes": swing(30),
}


def in_space(nodes: int = 12, **changes: Any) -> Scene:
    """Return a strip, bent and twisted without stress, that falls from a clamp out of its plane."""
    scene = swing(nodes, loads=[{"gravity": [0, -9.81, 2.0]}], model="spatial")
    return with_rod(
        {**scene, **changes},
        **{"from": [0, 0, 0], "to": [1, 0, 0.2]},
        cross_section={"rectangle": {"width": 0.03, "height": 0.01}, "director": [0, 0.8, 0.6]},
        material={"youngs_modulus": 1e7, "poissons_ratio": 0.4, "density": 1000},
        natural_curvature=[1.5, -0.7],
        natural_twist=3.0,
    )


def wire(nodes: int = 12, **changes: Any) -> Scene:
    """Return a rod whose sections do not count, that falls from a pin out of its plane."""
    scene = swing(nodes, model="spatial_bend", loads=[{"gravity": [0, -9.81, 2.0]}], **changes)
    if "supports" not in changes:
        scene["supports"] = [{"rod": "rod", "at": "start", "fix": ["x", "y", "z"]}]
    return with_rod(scene, **{"from": [0, 0, 0], "to": [1, 0, 0.2]})


def tumbling(**changes: Any) -> Scene:
    """Return a free strip that spins about all its axes."""
    scene = in_space(supports=[], loads=[], **changes)
    along = np.linspace(-0.5, 0.5, 12)
    velocities = np.array([0.1, 0, 0.3]) + np.cross([9.0, 4.0, -3.0], np.outer(along, [1, 0, 0.2]))
    return with_rod(scene, initial_velocity=velocities.tolist())


TANGENT_CLAMPS = [{"rod": "rod", "at": at, "clamp": "tangent"} for at in ("start", "end")]

SPATIAL: dict[str, Scene] = {
    "strip": in_space(),
    "strip, tangent measure": with_rod(in_space(), curvature="tangent"),
    "strip, both ends": in_space(
        supports=[{"rod": "rod", "at": at, "clamp": True} for at in ("start", "end")]
    ),
    "strip, tangents held": in_space(supports=TANGENT_CLAMPS),
    "strip, hanging": in_space(supports=[{"rod": "rod", "at": "start", "fix": ["x", "y", "z"]}]),
    "tumbling": tumbling(),
    "strip, driven": in_space(
        supports=[
            {
                "rod": "rod",
                "at": "start",
                "clamp": True,
                "prescribe": {"x": {"times": [0, 0.02, 1], "values": [0, 0.01, 0]}},
            },
            {"rod": "rod", "at": "end", "spring": {"stiffness": [3.0, 5.0, 1.0]}},
        ],
        loads=[
            {"name": "weight", "gravity": [0, -9.81, 1]},
            {"point_force": {"rod": "rod", "at": 0.43, "force": [0, 0.2, 0.1]}},
        ],
    ),
    "wire": wire(),
    "wire, tangent measure": with_rod(wire(), curvature="tangent"),
    "wire, tangents held": wire(supports=TANGENT_CLAMPS),
    "strip of 5 nodes": in_space(5),
    "strip of 9 nodes": in_space(9),
    "strip of 30 nodes": in_space(30),
    "wire of 3 nodes": wire(3),
    "wire of 5 nodes": wire(5),
    "wire of 30 nodes": wire(30),
}
SCENES.update(SPATIAL)


def state_of(thing: Any, *member: int) -> bytes:
    return pickle.dumps(thing.save_state(*member))


def alone(scene: Scene, **changes: Any) -> der.Simulation:
    return der.Simulation(der.Scenario.from_dict(scene).with_(**changes))


def assert_all_as_alone(scene: Scene, members: int, threads: int, lanes: int) -> None:
    moduli = 1e7 * np.linspace(0.8, 3.0, members)
    batch = der.Batch(scene, members, threads, vary={MODULUS: moduli})
    assert batch.lanes == lanes
    batch.step(21)
    batch.step()
    for member, modulus in enumerate(moduli):
        one = alone(scene, **{MODULUS: modulus})
        one.step(22)
        assert state_of(batch, member) == state_of(one), member
        assert batch.positions[member].tobytes() == one.positions.tobytes()


WIDEST = 8 if der.loops() == "avx512" else 4


@pytest.mark.parametrize("name", SCENES)
def test_lanes_have_the_bits_of_simulations(name: str) -> None:
    assert_all_as_alone(SCENES[name], 5, 1, 4)
    assert_all_as_alone(SCENES[name], 11, 1, WIDEST)


@pytest.mark.parametrize(
    "integrator", ["implicit_euler", "implicit_midpoint", "tr_bdf2", "sdirk4", "sdirk5"]
)
@pytest.mark.parametrize(
    "name", ["clamped", "spheres in a fluid", "3 nodes", "strip", "tumbling", "wire"]
)
def test_all_runge_kutta_methods_go_in_lanes(name: str, integrator: str) -> None:
    scene = copy.deepcopy(SCENES[name])
    scene["time"]["integrator"] = integrator
    assert_all_as_alone(scene, 9, 1, WIDEST)


@pytest.mark.parametrize("name", ["clamped", "wire", "strip"])
@pytest.mark.parametrize("threads", [1, 2, 3, 16])
def test_threads_do_not_change_the_bits(threads: int, name: str) -> None:
    assert_all_as_alone(SCENES[name], 17, threads, {1: WIDEST, 2: WIDEST, 3: 4, 16: 1}[threads])


def test_lanes_on_many_threads() -> None:
    """A full group and a part of one for each of sixteen threads."""
    assert_all_as_alone(SCENES["strip"], 16 * WIDEST + 3, 16, WIDEST)


@pytest.mark.parametrize("name", ["clamped", "wire", "strip"])
@pytest.mark.parametrize("loops", ["plain", "avx2"])
def test_other_loops_have_the_same_bits(loops: str, name: str) -> None:
    if loops == "avx2" and der.loops() == "plain":
        pytest.skip("this processor has no AVX2")
    code = """if True:
        import sys, der
        from test_lanes import SCENES, state_of
        batch = der.Batch(SCENES[sys.argv[1]], 9, 1)
        batch.step(30)
        sys.stdout.buffer.write(state_of(batch, 8))
    """
    done = subprocess.run(
        [sys.executable, "-c", code, name],
        cwd=Path(__file__).parent,
        env={**os.environ, "DER_LOOPS": loops},
        capture_output=True,
        check=True,
    )
    one = der.Simulation(SCENES[name])
    one.step(30)
    assert done.stdout == state_of(one)


def test_members_of_many_kinds_at_once() -> None:
    """Lengths, loads, tolerances and steps of their own, and forces that a program writes."""
    count = 8
    rng = np.random.default_rng(1)
    vary = {
        "rods.rod.to": rng.uniform(0.5, 1.5, (count, 2)),
        "loads.0.gravity": rng.uniform(-20, 20, (count, 2)),
        "solver.residual_tolerance": 10.0 ** rng.uniform(-10, -3, count),
        "time.step": rng.uniform(0.001, 0.004, count),
        MODULUS: 10.0 ** rng.uniform(6, 9, count),
    }
    scene = swing()
    batch = der.Batch(scene, count, 1, vary=vary)
    assert batch.lanes == WIDEST
    forces = rng.uniform(-0.1, 0.1, batch.extra_force.shape)
    for force in (forces, -0.5 * forces):
        batch.extra_force[:] = force
        batch.step(15)
    for member in range(count):
        one = alone(scene, **{path: values[member].tolist() for path, values in vary.items()})
        for force in (forces, -0.5 * forces):
            one.extra_force[:] = force[member]
            one.step(15)
        assert state_of(batch, member) == state_of(one), member


def test_elements_outside_of_chains_have_values_of_each_member() -> None:
    """Clamps, springs and foundations differ from member to member."""
    rng = np.random.default_rng(2)
    count = 8
    vary = {
        "rods.rod.to": rng.uniform(-1.5, 1.5, (count, 2)),
        "rods.rod.natural_curvature": rng.uniform(-2, 2, count),
        "supports.0.spring.stiffness": rng.uniform(1, 9, (count, 2)),
        "loads.1.foundation.stiffness": rng.uniform(1, 9, (count, 2)),
        MODULUS: 10.0 ** rng.uniform(6, 8, count),
    }
    for curvature in ("angle", "tangent"):
        scene = with_rod(copy.deepcopy(SCENES["spring and foundation"]), curvature=curvature)
        scene["rods"][0]["natural_curvature"] = 0.1
        batch = der.Batch(scene, count, 1, vary=vary)
        assert batch.lanes == WIDEST
        batch.step(30)
        for member in range(count):
            one = alone(scene, **{path: values[member].tolist() for path, values in vary.items()})
            one.step(30)
            assert state_of(batch, member) == state_of(one), member


@pytest.mark.parametrize(
    ("load", "path", "values"),
    [
        (
            {"at": "end", "force": [0, 0.1]},
            "loads.0.point_force.at",
            ["start", "end", 0.4, "middle"],
        ),
        ({"at": 0.43, "force": [0, 0.1]}, "rods.rod.to", [[1, 0], [0.6, 0], [2, 0], [0, 3]]),
        ({"force": [0, 1.0], "from": 0.2}, "loads.0.distributed_force.from", [0.1, 0.2, 0.5, 0.8]),
    ],
    ids=["another node", "another length", "another part"],
)
def test_loads_act_on_other_nodes_in_each_member(load: Scene, path: str, values: list[Any]) -> None:
    kind = "point_force" if "at" in load else "distributed_force"
    scene = swing(loads=[{"name": "push", kind: {"rod": "rod", **load}}])
    batch = der.Batch(scene, 8, 1, vary={path: values * 2})
    assert batch.lanes == WIDEST
    batch.set("push.x", np.linspace(0.0, 0.2, 8))
    batch.step(9)
    for member, value in enumerate(values * 2):
        one = alone(scene, **{path: value})
        one.set("push.x", np.linspace(0.0, 0.2, 8)[member])
        one.step(9)
        assert state_of(batch, member) == state_of(one), member


def test_supports_that_change_places_go_one_by_one() -> None:
    """The same components are held, but not in the same order."""
    scene = swing(
        supports=[
            {"name": "a", "rod": "rod", "at": "start", "fix": ["y"], "prescribe": {"x": 0}},
            {"name": "b", "rod": "rod", "at": "end", "fix": ["y"], "prescribe": {"x": 0}},
        ]
    )
    places = ["start", "end"] * 4
    batch = der.Batch(
        scene, 8, 1, vary={"supports.a.at": places, "supports.b.at": places[1:] + places[:1]}
    )
    assert batch.lanes == 1
    batch.prescribe(0, x=0.01)
    batch.step(5)
    for member in range(8):
        one = alone(
            scene,
            **{"supports.a.at": places[member], "supports.b.at": (places[1:] + places[:1])[member]},
        )
        one.prescribe(0, x=0.01)
        one.step(5)
        assert state_of(batch, member) == state_of(one), member


@pytest.mark.parametrize("integrator", ["implicit_midpoint", "tr_bdf2", "sdirk5"])
def test_programs_set_values_of_each_member(integrator: str) -> None:
    scene = copy.deepcopy(SCENES["what programs set"])
    scene["time"]["integrator"] = integrator
    batch = der.Batch(scene, 8, 1)
    assert batch.lanes == WIDEST
    values = np.linspace(0.0, 0.3, 8)
    for _ in range(2):
        batch.set("push.y", values)
        batch.set("weight.x", -values, over=0.01)
        batch.prescribe(0, y=0.01 * values)
        batch.step(11)
        values = 0.5 - values
    for member in range(8):
        one = der.Simulation(scene)
        for value in (np.linspace(0.0, 0.3, 8)[member], 0.5 - np.linspace(0.0, 0.3, 8)[member]):
            one.set("push.y", value)
            one.set("weight.x", -value, over=0.01)
            one.prescribe(0, y=0.01 * value)
            one.step(11)
        assert state_of(batch, member) == state_of(one), member


def test_a_member_whose_step_is_retried_does_it_alone() -> None:
    """Steps far too long for some members, whose motion needs pieces."""
    scene = swing(time={"duration": 10, "step": 0.25, "integrator": "implicit_midpoint"})
    scene["time"]["allow_unstable"] = True
    moduli = [1e4, 1e9, 3e4, 1e10, 1e5, 1e11, 3e9, 1e5]
    batch = der.Batch(scene, 8, 1, vary={MODULUS: moduli})
    assert batch.lanes == WIDEST
    batch.step(12)
    retried = 0
    for member, modulus in enumerate(moduli):
        one = alone(scene, **{MODULUS: modulus})
        one.step(12)
        retried += one.counters.retried_steps > 0
        assert state_of(batch, member) == state_of(one), member
    assert 0 < retried < 8


def test_a_member_that_fails_stops_nobody() -> None:
    batch = der.Batch(SCENES["clamped"], 8, 1)
    batch.step(3)
    saved = batch.save_state(2)
    batch.velocities[2, 5, 0] = np.nan
    batch.velocities[4, 5, 0] += 0.5  # energy that a program adds
    batch.step(4)
    assert list(batch.step_count) == [7, 7, 3, 7, 7, 7, 7, 7]
    (failure,) = batch.failures
    assert (failure.member, failure.status) == (2, "diverged")
    one = der.Simulation(SCENES["clamped"])
    one.step(3)
    pushed = der.Simulation(SCENES["clamped"])
    pushed.step(3)
    pushed.velocities[5, 0] += 0.5
    pushed.step(4)
    one.step(4)
    assert state_of(batch, 1) == state_of(one)
    assert state_of(batch, 4) == state_of(pushed)
    # Members whose times differ go on together.
    batch.reset(2, saved)
    batch.reset(0)
    batch.step(4)
    assert state_of(batch, 2) == state_of(one)
    one.step(4)
    assert state_of(batch, 3) == state_of(one)


def test_a_motion_that_creates_energy_fails_in_its_lane(swing: Scene) -> None:
    # Steps that do not resolve the whip of the free end.
    swing["time"] = {"duration": 6, "step": 0.005, "integrator": "implicit_midpoint"}
    densities = [swing["rods"][0]["material"]["density"] * factor for factor in (1, 1e-3, 1, 1e-3)]
    batch = der.Batch(swing, 4, 1, vary={"rods.0.material.density": densities})
    assert batch.lanes == 4
    with pytest.warns(der.UnreliableResultWarning):
        batch.step(1200)
    for member, density in enumerate(densities):
        one = alone(swing, **{"rods.0.material.density": density})
        if batch.failed[member]:
            with pytest.raises(der.DivergedError) as raised:
                one.step(1200)
            (failure,) = [failure for failure in batch.failures if failure.member == member]
            assert (failure.status, failure.message) == ("unstable_motion", str(raised.value))
        else:
            one.step(1200)
        assert state_of(batch, member) == state_of(one), member
    assert batch.failed.any()
    assert not batch.failed.all()


def test_a_rod_that_folds_over_is_named_in_its_lane() -> None:
    scene = with_rod(swing(8), natural_curvature=0.0)
    scene["time"] = {"duration": 1, "step": 0.001, "integrator": "implicit_euler"}
    speeds = [0.0, 30.0, 0.0, 60.0]

    def throw(thing: Any, speed: float) -> None:
        thing[4:, 0] = -speed

    batch = der.Batch(scene, 4, 1, vary={MODULUS: [1e4] * 4})
    for member, speed in enumerate(speeds):
        throw(batch.velocities[member], speed)
    with pytest.warns(der.UnreliableResultWarning):
        batch.step(60)
    for member, speed in enumerate(speeds):
        one = alone(scene, **{MODULUS: 1e4})
        throw(one.velocities, speed)
        one.step(60)
        assert state_of(batch, member) == state_of(one), member
    assert list(batch.unreliable) == [False, True, False, True]


@pytest.mark.parametrize(
    "change",
    [
        in_space(
            supports=[{"rod": "rod", "at": "start", "clamp": True, "prescribe": {"twist": 0}}]
        ),
        in_space(
            loads=[{"moment": {"rod": "rod", "at": "end", "moment": [0.1, 0, 0.1]}}],
        ),
        in_space(
            supports=[
                {"rod": "rod", "at": "start", "fix": ["x", "y", "z"]},
                {"rod": "rod", "at": "start", "spring": {"rotational_stiffness": 1.0}},
            ]
        ),
        {"time": {"duration": 1, "tolerance": 1e-3}},
        {"time": {"duration": 1, "step": 0.0025, "integrator": "bdf2"}},
        {"solver": {"linear": "simplicial_ldlt"}},
        {
            "supports": [
                {"rod": "rod", "at": "start", "clamp": True, "prescribe": {"angle": 0}},
            ]
        },
        {"loads": [{"moment": {"rod": "rod", "at": "end", "moment": 0.1}}]},
    ],
    ids=[
        "turned section",
        "moment in space",
        "spring in space",
        "adaptive",
        "several steps",
        "sparse",
        "turned clamp",
        "moment",
    ],
)
def test_other_steps_are_done_one_by_one(change: Scene) -> None:
    assert_all_as_alone(change if "rods" in change else swing(**change), 9, 1, 1)


def test_ctrl_c_and_forks_leave_whole_steps() -> None:
    """What ends a call early leaves every member between two of its steps."""
    batch = der.Batch(SCENES["clamped"], 8, 1)
    batch.step(5)
    pid = os.fork()
    if pid == 0:
        batch.step(5)
        os._exit(int(batch.step_count[7] != 10))
    assert os.waitpid(pid, 0)[1] == 0
    batch.step(5)
    one = der.Simulation(SCENES["clamped"])
    one.step(10)
    assert state_of(batch, 7) == state_of(one)
