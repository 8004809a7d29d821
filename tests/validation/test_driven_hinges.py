"""Hinges whose angle is prescribed (`prescribe: {angle}`): servos.

A hinge that is held at an angle is a rigid joint of rods that are drawn at that angle: that is the
reference in statics. In motion, free rods keep their momenta, and the energy is the motor's work.
"""

import der
import numpy as np
import pytest

SECTION = {"stiffness": {"EA": 1e4, "EI": 0.5, "mass_per_length": 1.0}}
PIN = {"name": "pin", "of": [{"rod": "a", "at": "end"}, {"rod": "b", "at": "start"}]}


def rods(drawn: float = 0.0, nodes: int = 11, **more) -> list:
    """Two rods of length 1 that meet at (1, 0); the second is drawn at an angle."""
    end = [1 + np.cos(drawn), np.sin(drawn)]
    one = {"nodes": nodes, "cross_section": SECTION, **more}
    return [
        {"name": "a", "from": [0, 0], "to": [1, 0], **one},
        {"name": "b", "from": [1, 0], "to": end, **one},
    ]


def driven(angle) -> dict:
    return {**PIN, "kind": "hinge", "prescribe": {"angle": angle}}


def probes() -> dict:
    legs = {
        f"{quantity}-{leg}": {"joint": "pin", "leg": leg, "quantity": quantity}
        for quantity in ("force_x", "force_y", "moment_z")
        for leg in "ab"
    }
    return legs | {
        "slope": {"rod": "b", "at": 0.35, "quantity": "slope"},
        "start": {"rod": "b", "at": "start", "quantity": "slope"},
        "moment": {"rod": "b", "at": 0.35, "quantity": "moment"},
        "tension": {"rod": "b", "at": 0.35, "quantity": "tension"},
        "x": {"rod": "b", "at": 0.42, "quantity": "x"},
        "wall": {"support": 0, "quantity": "reaction_moment"},
    }


@pytest.mark.parametrize(
    ("angle", "tip"),
    [
        (0.7, {}),
        (-2.0, {}),
        (3.5, {}),
        (9.0, {}),
        (0.7, {"fix": ["x", "y"]}),
        (0.4, {"fix": ["y"]}),
    ],
)
def test_a_hinge_held_at_an_angle_is_a_corner(angle, tip):
    """Loads act after the turn, so that a tip is held where the angle has brought it."""
    loads = [
        {"gravity": [0.3, -1.0]},
        {"point_force": {"rod": "b", "at": "middle", "force": [0.2, -0.1]}},
        {"moment": {"rod": "b", "at": 0.7, "moment": 0.05}},
    ]
    clamp = {"rod": "a", "at": "start", "clamp": True}
    moved = {}
    if tip:
        turned = {"x": float(np.cos(angle)) - 1, "y": float(np.sin(angle))}
        moved = {"prescribe": {axis: turned[axis] for axis in tip["fix"]}}
    ends = [{"rod": "b", "at": "end", **one} for one in (tip, moved) if one]
    common = {"loads": loads, "analysis": "static", "output": {"probes": probes()}}
    corner = der.run(
        {"rods": rods(angle), "joints": [PIN], "supports": [clamp, *ends[:1]], **common}
    )
    hinge = der.run(
        {"rods": rods(), "joints": [driven(angle)], "supports": [clamp, *ends[1:]], **common}
    )
    assert hinge.positions[-1] == pytest.approx(corner.positions[-1], abs=1e-9)
    for name, value in corner.probes.items():
        whole = 2 * np.pi if name in ("slope", "start") else np.inf
        difference = hinge.probes[name][-1] - value[-1]
        if np.isfinite(whole):
            difference -= whole * np.round(difference / whole)
        assert difference == pytest.approx(0.0, abs=1e-7), name


def test_whole_turns_of_a_hinge_count():
    clamp = {"rod": "a", "at": "start", "clamp": True}
    start = {"rod": "b", "at": "start", "quantity": "slope"}
    angle = {"joint": "pin", "quantity": "angle"}
    result = der.run(
        {
            "rods": rods(),
            "joints": [driven(20.0)],
            "supports": [clamp],
            "analysis": "static",
            "output": {"probes": {"slope": start, "angle": angle}},
        }
    )
    assert result.probes["slope"][-1] == pytest.approx(20.0, abs=1e-9)
    assert result.probes["angle"][-1] == pytest.approx(20.0, abs=1e-9)
    assert result.positions[-1][-1] == pytest.approx([1 + np.cos(20), np.sin(20)], abs=1e-9)


def test_a_path_turns_a_hinge_by_the_load_factor():
    scene = {
        "rods": rods(),
        "joints": [driven(3.0)],
        "supports": [{"rod": "a", "at": "start", "clamp": True}],
        "analysis": "static",
        "output": {"probes": {"angle": {"joint": "pin", "quantity": "angle"}}},
    }
    result = der.continuation(scene, to=1.0, vary="supports")
    assert result.probes["angle"] == pytest.approx(3.0 * result.path.factor, abs=1e-9)
    assert result.positions[-1][-1] == pytest.approx([1 + np.cos(3), np.sin(3)], abs=1e-9)


TURN = {"times": [0, 0.5], "values": [0, 2.0], "smooth": True}


def in_flight(angle, **time):
    work = {"motor": {"joint": "pin", "leg": "b", "quantity": "moment_z"}}
    return {
        "rods": rods(),
        "joints": [driven(angle)],
        "time": {"duration": 0.8, **time},
        "output": {"probes": work, "every": time.get("step", 0.01)},
    }


MASSES = np.r_[0.5, np.ones(9), 1.0, np.ones(9), 0.5] / 10


@pytest.mark.parametrize(
    "integrator", ["implicit_midpoint", "tr_bdf2", "sdirk4", "sdirk5", "bdf2", "generalized_alpha"]
)
def test_free_rods_that_a_motor_turns_keep_their_momenta(integrator):
    simulation = der.Simulation(in_flight(TURN, integrator=integrator, step=1e-3))
    result = simulation.run()
    momentum = MASSES @ simulation.velocities
    x, v = simulation.positions, simulation.velocities
    spin = MASSES @ (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])
    assert momentum == pytest.approx([0, 0], abs=1e-11)
    assert spin == pytest.approx(0.0, abs=2e-4 if integrator != "implicit_midpoint" else 1e-10)
    assert np.abs(v).max() > 0.01
    # The rods have the energy that the motor gives. The second rod exerts the opposite moment.
    t = np.clip(np.asarray(result.times) / 0.5, 0, 1)
    angle = 2.0 * (10 * t**3 - 15 * t**4 + 6 * t**5)
    motor = -np.asarray(result.probes["motor"])
    work = np.sum(0.5 * (motor[1:] + motor[:-1]) * np.diff(angle))
    energy = sum(values[-1] for values in result.energies.values())
    assert energy == pytest.approx(work, abs=2e-4)


def test_stiff_rods_turn_by_half_the_angle_each():
    """By symmetry: the first one backwards."""
    scene = in_flight(TURN, integrator="sdirk4", step=1e-3)
    for rod in scene["rods"]:
        rod["cross_section"] = {"stiffness": {"EA": 1e7, "EI": 1e3, "mass_per_length": 1.0}}
    scene["output"]["probes"] = {
        name: {"rod": name, "at": "middle", "quantity": "slope"} for name in "ab"
    }
    result = der.run(scene)
    assert result.probes["a"][-1] == pytest.approx(-1.0, abs=2e-3)
    assert result.probes["b"][-1] == pytest.approx(1.0, abs=2e-3)


def test_a_program_drives_a_hinge():
    clamp = {"rod": "a", "at": "start", "clamp": True}
    scene = {
        "rods": rods(),
        "joints": [driven(0.0)],
        "supports": [clamp],
        "loads": [{"damping": {"coefficient": 1.2}}],
        "time": {"duration": 30.0, "step": 0.02},
    }
    simulation = der.Simulation(scene)
    simulation.set("pin", 0.8, over=1.0)
    simulation.run()
    assert simulation.positions[-1] == pytest.approx([1 + np.cos(0.8), np.sin(0.8)], abs=1e-3)


def test_a_run_goes_on_from_where_the_hinge_is(tmp_path):
    clamp = {"rod": "a", "at": "start", "clamp": True}
    turn = {"times": [0, 0.5], "values": [0, 0.7], "smooth": True}
    scene = {
        "rods": rods(),
        "joints": [driven(turn)],
        "supports": [clamp],
        "time": {"duration": 0.6, "step": 0.01},
    }
    der.run(scene, out=tmp_path / "first")
    later = {**scene, "start_from": str(tmp_path / "first")}
    with pytest.raises(der.DerError, match=r"hinge 'pin' begins at an angle of 0 rad.* at 0.7 rad"):
        der.run(later)
    held = {**later, "joints": [driven({"times": [0, 1], "values": [0.7, 0.7]})]}
    assert der.run(held).status == "completed"
    free = {**scene, "joints": [{**PIN, "kind": "hinge"}]}
    der.run(free, out=tmp_path / "free")
    with pytest.raises(der.DerError, match="turned freely"):
        der.run({**scene, "start_from": str(tmp_path / "free")})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"joints": [{**driven(0.5), "kind": "rigid"}]}, "do not turn against one another"),
        ({"joints": [{**driven(0.5), "damping": 1.0}]}, "does nothing: remove one"),
        (
            {"joints": [driven({"times": [0, 1], "values": [0, 1]})]},
            "a static analysis has no time",
        ),
        ({"supports": [{"rod": "b", "at": "start", "clamp": True}]}, "turns with rod 'b'"),
        (
            {"loads": [{"moment": {"joint": "pin", "moment": 1.0}}]},
            "between its sides does nothing",
        ),
        (
            {"rods": rods(cross_section={"stiffness": {**SECTION["stiffness"], "damping": 0.1}})},
            "internal damping",
        ),
    ],
)
def test_what_a_driven_hinge_cannot_have_is_refused(change, message):
    scene = {
        "rods": rods(),
        "joints": [driven(0.5)],
        "supports": [{"rod": "a", "at": "start", "clamp": True}],
        "analysis": "static",
    }
    with pytest.raises(der.SceneError, match=message):
        der.load({**scene, **change})
