"""Networks of rods in space that joints join, against `references/spatial_networks.py`.

Meshes are nested: the lengths of legs are in ratios of whole numbers, so that twice the edges of
each rod are twice the cells of each leg.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import der
import numpy as np
import pytest
from network_scenes import at, clamp, final, force, joint, scene_of
from references.spatial_networks import Scene, SpatialNetwork

FINENESS = [2, 4, 8]
#: Where held rods stretch, errors of several orders and opposite signs show before.
FINER = [8, 16, 32]
FIELDS = ["x", "y", "z", "tx", "ty", "tz", "moment_1", "moment_2", "torque", "tension"]
REACTIONS = [f"reaction_{c}" for c in ("x", "y", "z", "moment_x", "moment_y", "moment_z")]
EXERTED = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"]
ROTATION = ["rotation_x", "rotation_y", "rotation_z"]
SECTION = {"EA": 2e3, "EI1": 1.0, "EI2": 0.4, "GJ": 0.5, "mass_per_length": 1.0}


def rod(name: str, start: list[float], end: list[float], edges: int, **more: Any) -> Scene:
    section: Scene = {"stiffness": SECTION | more.pop("stiffness", {})}
    if "director" in more:
        section["director"] = more.pop("director")
    line: Scene = {"name": name, "from": start, "to": end, "nodes": edges + 1}
    return line | {"cross_section": section} | more


def arc(name: str, radius: float, angle: float, start: list[float], edges: int) -> Scene:
    """A part of a circle about an axis along y, that leaves `start` along x."""
    along = np.linspace(0, angle, edges + 1)
    points = np.array(start) + radius * np.column_stack(
        [np.sin(along), np.zeros(edges + 1), 1 - np.cos(along)]
    )
    section = {"stiffness": SECTION, "director": [0, 1, 0]}
    return {"name": name, "points": points.tolist(), "cross_section": section}


def moment(name: str, place: Any, *components: float, **more: Any) -> Scene:
    return {"moment": at(name, place, moment=list(components), **more)}


def pin(name: str, place: Any, **more: Any) -> Scene:
    return at(name, place, fix=["x", "y", "z"], **more)


# Scenes: functions of a fineness.


def frame(n: int) -> Scene:
    """An L that is bent out of its plane."""
    return scene_of(
        [rod("a", [0, 0, 0], [1, 0, 0], 10 * n), rod("b", [1, 0, 0], [1, 0.8, 0], 8 * n)],
        [joint("corner", at("a", "end"), at("b", "start"))],
        [clamp("a", "start")],
        [force("b", "end", 0.3, -0.2, 1.2), moment("a", "end", 0.2, -0.3, 0.1)],
    )


def portal(n: int) -> Scene:
    """Two posts and a beam out of their plane's normal, with loads in all directions."""
    upright = {"director": [0, 1, 0]}
    return scene_of(
        [
            rod("left", [0, 0, 0], [0, 0, 1], 10 * n, **upright),
            rod("beam", [0, 0, 1], [1.2, 0.9, 1], 15 * n),
            rod("right", [1.2, 0.9, 0], [1.2, 0.9, 1], 10 * n, **upright),
        ],
        [
            joint("nw", at("left", "end"), at("beam", "start")),
            joint("ne", at("right", "end"), at("beam", "end")),
        ],
        [clamp("left", "start"), pin("right", "start")],
        [
            force("left", "end", 0.6, -0.4, 0),
            {"distributed_force": {"rod": "beam", "force": [0.2, 0.2, -0.8]}},
            moment("beam", 0.6, 0.3, -0.2, 0.4),
        ],
    )


def star(n: int) -> Scene:
    """Three arms that are in no plane, with a moment where they meet."""
    return scene_of(
        [
            rod("a", [-0.8, 0, -0.1], [0, 0, 0], 8 * n),
            rod("b", [0, 0, 0], [0.5, 0.7, 0.2], 9 * n),
            rod("c", [0.4, -0.6, -0.3], [0, 0, 0], 8 * n, stiffness={"EI1": 0.7}),
        ],
        [joint("middle", at("a", "end"), at("b", "start"), at("c", "end"))],
        [clamp("a", "start"), pin("b", "end"), clamp("c", "start")],
        [moment("a", "end", 2.4, 1.8, -1.6), force("b", "start", 0, 1, -2)],
    )


def tee(n: int) -> Scene:
    """A beam that runs through on a post, and a spring to an anchor."""
    return scene_of(
        [
            rod("beam", [0, 0, 0], [1, 0, 0], 10 * n),
            rod("post", [0.4, 0.3, -0.4], [0.4, 0, 0], 5 * n),
        ],
        [joint("tee", at("beam", 0.4), at("post", "end"))],
        [clamp("post", "start"), at("beam", "start", spring={"stiffness": [2, 3, 4]})],
        [force("beam", "end", 0.3, 1.5, -1), force("beam", 0.7, 0, 0, 1)],
    )


def loop(n: int) -> Scene:
    """A closed frame that is in no plane."""
    corners = {
        "p": [0.0, 0.0, 0.0],
        "q": [1.0, 0.0, 0.1],
        "r": [1.0, 0.8, -0.1],
        "s": [0.0, 0.8, 0.2],
    }

    def bar(name: str, a: str, b: str, edges: int) -> Scene:
        return rod(name, corners[a], corners[b], edges)

    return scene_of(
        [
            bar("pq", "p", "q", 10 * n),
            bar("qr", "q", "r", 8 * n),
            bar("rs", "r", "s", 10 * n),
            bar("sp", "s", "p", 8 * n),
        ],
        [
            joint("p", at("pq", "start"), at("sp", "end")),
            joint("q", at("pq", "end"), at("qr", "start")),
            joint("r", at("qr", "end"), at("rs", "start")),
            joint("s", at("rs", "end"), at("sp", "start")),
        ],
        [clamp("pq", "start")],
        [force("rs", "start", 0.4, -0.2, 1.0), moment("sp", "start", 0.3, 0.5, -0.2)],
    )


def curved(n: int) -> Scene:
    """An arc that is free of stress as drawn, and a straight rod out of its plane."""
    return scene_of(
        [
            arc("bow", 0.8, 1.2, [0, 0, 0], 12 * n),
            rod(
                "arm",
                (0.8 * np.array([np.sin(1.2), 0, 1 - np.cos(1.2)])).tolist(),
                (0.8 * np.array([np.sin(1.2), 0.75, 1 - np.cos(1.2)])).tolist(),
                8 * n,
            ),
        ],
        [joint("tip", at("bow", "end"), at("arm", "start"))],
        [clamp("bow", "start")],
        [force("arm", "end", -0.4, 0.1, 0.8)],
    )


def natural(n: int) -> Scene:
    """Natural curvatures that differ from rod to rod, and weight."""
    return scene_of(
        [
            rod(
                "a", [0, 0, 0], [0.6, 0, 0], 6 * n, natural_curvature=[0.8, -0.5], natural_twist=0.9
            ),
            rod("b", [0.6, 0, 0], [0.6, 0.5, 0.3], 6 * n, natural_curvature=[-1.0, 1.2]),
        ],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [clamp("a", "start")],
        [{"gravity": [0, 0, -1.5]}, force("b", "end", 0.2, 0.1, 0)],
    )


def moved(n: int) -> Scene:
    """Supports that move and turn, and a rod with a short leg."""
    return scene_of(
        [
            rod("a", [0, 0, 0], [0.7, 0, 0], 7 * n),
            rod("b", [0.7, 0, 0], [0.7, 0.6, 0.2], 6 * n),
        ],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [
            clamp("a", "start", prescribe={"rotation": {"axis": [1, 1, 0.5], "angle": 1.1}}),
            clamp("b", "end", prescribe={"x": -0.1, "z": 0.15, "twist": 0.8}),
        ],
        [force("a", 0.4, 0, 0, -3), moment("a", 0.6, 0.5, 0, 0.5)],
    )


def followed(n: int) -> Scene:
    """Forces and moments that turn with the joints."""
    return scene_of(
        [
            rod("a", [0, 0, 0], [0.8, 0, 0], 8 * n),
            rod("b", [0.8, 0, 0], [0.8, 0, 0.6], 6 * n, director=[0, 1, 0]),
        ],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [clamp("a", "start")],
        [
            force("b", "end", 0.5, 1.0, 0.2, follower=True),
            moment("a", "end", 0.6, 0.2, -0.3, follower=True),
        ],
    )


def sprung(n: int) -> Scene:
    """Springs against rotation inside a rod and at its end."""
    return scene_of(
        [rod("a", [0, 0, 0], [0.9, 0, 0], 9 * n), rod("b", [0.9, 0, 0], [0.9, 0.6, 0], 6 * n)],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [
            clamp("a", "start"),
            at("a", 0.6, spring={"rotational_stiffness": [0.5, 3, 0.2]}),
            at("b", "end", spring={"rotational_stiffness": [1, 2, 0.5], "stiffness": [1, 1, 2]}),
        ],
        [moment("a", "end", 0.8, 0.5, -0.6), force("b", "end", 0.2, 0.3, 1.0)],
    )


def balls(n: int) -> Scene:
    """A bent beam on a strut that balls hold, and a rod that runs through one."""
    return scene_of(
        [
            rod("beam", [0, 0, 0], [1, 0, 0], 10 * n),
            rod("strut", [0.6, 0.4, -0.5], [0.6, 0, 0], 6 * n, stiffness={"EA": 300.0}),
        ],
        [joint("top", at("beam", 0.6), at("strut", "end")) | {"kind": "ball"}],
        [clamp("beam", "start"), clamp("strut", "start")],
        [force("beam", "end", 0.2, 1.0, -1.5), force("strut", 0.3, 0.5, 0, 0)],
    )


SCENES: list[Callable[[int], Scene]] = [
    frame,
    portal,
    star,
    tee,
    loop,
    curved,
    natural,
    moved,
    followed,
    sprung,
    balls,
]


def probed(scene: Scene, network: SpatialNetwork) -> dict[str, tuple[dict[str, Any], float]]:
    """Probes at both ends and a third of every leg, with the reference's values."""
    probes = {}
    for number, leg in enumerate(network.pieces):
        span = leg.end - leg.start
        places = [(leg.start, "after"), (leg.start + span / 3, "after"), (leg.end, "before")]
        ends: list[Any] = [leg.start, None, leg.end]
        if "points" in network.rods[leg.rod]:
            places, ends = [places[0], places[2]], ["start", "end"]
        for place, (s, side) in enumerate(places):
            for quantity in FIELDS:
                probe = {"rod": leg.rod, "at": s, "quantity": quantity}
                if isinstance(ends[place], str):
                    probe["at"] = ends[place]
                if quantity not in ("x", "y", "z"):
                    probe["side"] = side
                exact = float(network.along(quantity, leg.rod, np.array([s]), side)[0])
                probes[f"{quantity}-{number}-{place}"] = (probe, exact)
    for number, key in enumerate(network.supports):
        if network.supports.count(key) == 1:
            for quantity, exact in zip(REACTIONS, network.reaction(number), strict=True):
                probe = {"support": number, "quantity": quantity}
                probes[f"{quantity}-{number}"] = (probe, exact)
    for item in scene["joints"]:
        name = item["name"]
        if item.get("kind") == "ball":
            continue
        for quantity, exact in zip(ROTATION, network.rotation({"joint": name}), strict=True):
            probes[f"{quantity}-{name}"] = ({"joint": name, "quantity": quantity}, exact)
        for member in item["of"]:
            leg = member["rod"]
            for quantity, exact in zip(EXERTED, network.exerted(name, leg), strict=True):
                probe = {"joint": name, "leg": leg, "quantity": quantity}
                probes[f"{quantity}-{name}-{leg}"] = (probe, exact)
    return probes


def errors(scene: Scene, network: SpatialNetwork) -> dict[str, float]:
    """Largest error of each kind of quantity against the reference."""
    expected = probed(scene, network)
    probes = {key: probe for key, (probe, _) in expected.items()}
    result = der.run(
        der.Scenario.from_dict(scene | {"analysis": "static", "output": {"probes": probes}})
    )
    assert result.status == "static_converged"
    worst: dict[str, float] = {}
    for key, (_, exact) in expected.items():
        kind = re.sub("_?[xyz12]$", "", key.split("-")[0]) or "place"
        error = abs(result.probes[key][-1] - exact)
        worst[kind] = max(worst.get(kind, 0.0), error)
    return worst


@pytest.mark.parametrize("make", SCENES, ids=lambda make: make.__name__)
def test_equilibria(make: Callable[[int], Scene], fitted_order: Any) -> None:
    fineness = FINER if make in (star, moved, balls) else FINENESS
    network = SpatialNetwork(make(1)).solve()
    rows = [errors(make(n), network) for n in fineness]
    for quantity in rows[0]:
        found = [row[quantity] for row in rows]
        if max(found) > 1e-8:  # else it is exact but for rounding
            assert fitted_order([1 / n for n in fineness], found) > 1.85, (quantity, found)


def test_rods_balance_what_acts_on_a_joint() -> None:
    probes = {
        f"{leg}-{name}": {"joint": "middle", "leg": leg, "quantity": name}
        for leg in ("a", "b", "c")
        for name in EXERTED
    }
    result = der.run(
        der.Scenario.from_dict(star(1) | {"analysis": "static", "output": {"probes": probes}})
    )
    exerted = np.reshape([float(series[-1]) for series in result.probes.values()], (3, 6))
    assert exerted.sum(axis=0) == pytest.approx([0, -1, 2, -2.4, -1.8, 1.6], abs=1e-8)


def test_a_clamp_turns_a_joint_more_than_once() -> None:
    """Two rods in line are wound up by 2.5 turns: the twist is the same all along."""
    straight = {"EA": 1e4, "GJ": 3.0, "EI1": 200.0, "EI2": 100.0}
    turn = 5 * np.pi
    scene = scene_of(
        [
            rod("a", [0, 0, 0], [1, 0, 0], 5, stiffness=straight),
            rod("b", [1, 0, 0], [2, 0, 0], 5, stiffness=straight),
        ],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [clamp("a", "start"), clamp("b", "end", prescribe={"twist": turn})],
        [],
    )
    probes = {
        "torque": at("b", 0.5, quantity="torque"),
        "wall": {"support": 0, "quantity": "reaction_moment_x"},
    }
    scene |= {"analysis": "static", "output": {"probes": probes}}
    result = der.run(der.Scenario.from_dict(scene))
    assert result.probes["torque"][-1] == pytest.approx(3.0 * turn / 2, rel=1e-9)
    assert result.probes["wall"][-1] == pytest.approx(-3.0 * turn / 2, rel=1e-9)


def test_a_path_ends_at_the_equilibrium() -> None:
    scene = frame(1) | {"analysis": "static"}
    scene["loads"] = scene["loads"][:1]
    probes = {"z": at("b", "end", quantity="z")}
    exact = der.run(der.Scenario.from_dict(scene | {"output": {"probes": probes}})).probes["z"][-1]
    path = der.continuation(scene | {"output": {"probes": probes}}, to=1.0)
    assert path.path.factor[-1] == pytest.approx(1.0)
    assert path.probes["z"][-1] == pytest.approx(exact, rel=1e-9)


# Vibrations.


def test_frequencies_of_a_cantilever_with_an_idle_joint(fitted_order: Any) -> None:
    """Bending in two planes, and torsion, of a rod of length 1 that two are joined to."""
    found = []
    for n in FINENESS:
        stiff = {"EA": 1e6, "rotary_inertia": 0.01}
        scene = scene_of(
            [
                rod("a", [0, 0, 0], [0.4, 0, 0], 4 * n, stiffness=stiff),
                rod("b", [0.4, 0, 0], [1, 0, 0], 6 * n, stiffness=stiff),
            ],
            [joint("ab", at("a", "end"), at("b", "start"))],
            [clamp("a", "start")],
            [],
        )
        simulation = der.Simulation(der.Scenario.from_dict(scene | {"analysis": "modes"}))
        simulation.equilibrium()
        found.append(2 * np.pi * simulation.modes(4).frequencies)
    bending = np.outer([1.8751040687, 4.6940911330], np.ones(2)) ** 2 * np.sqrt([1.0, 0.4])
    torsion = np.pi / 2 * np.sqrt(0.5 / 0.01)
    exact = np.sort([*bending.ravel(), torsion])[:4]
    for of_mode in (np.array(found) / exact - 1).T:
        assert fitted_order([1 / n for n in FINENESS], of_mode) > 1.85


# Motion.


def swinging(step: float, integrator: str, **time: Any) -> Scene:
    """A soft L that growing couples at its corner and a force at its end swing out of its plane."""
    soft = {"EA": 100.0, "rotary_inertia": 0.05}
    couple = {"times": [0, 1], "values": [[0, 0, 0], [1.0, 1.5, 2.0]], "smooth": True}
    push = {"times": [0, 1], "values": [[0, 0, 0], [0.5, 0.2, 1.0]], "smooth": True}
    scene = scene_of(
        [
            rod("post", [0, 0, 0], [0.6, 0, 0], 3, stiffness=soft),
            rod("arm", [0.6, 0, 0], [0.6, 0.8, 0.1], 4, stiffness=soft),
        ],
        [joint("corner", at("post", "end"), at("arm", "start"))],
        [clamp("post", "start")],
        [
            {"moment": at("arm", "start", moment=couple)},
            {"point_force": at("arm", "end", force=push)},
            {"gravity": [0, 0, -3]},
        ],
    )
    probes = {
        "x": at("arm", "end", quantity="x"),
        "z": at("arm", "end", quantity="z"),
        "turn": {"joint": "corner", "quantity": "rotation_z"},
        "before": {"joint": "corner", "leg": "post", "quantity": "moment_x"},
        "after": {"joint": "corner", "leg": "arm", "quantity": "moment_y"},
        "wall": {"support": 0, "quantity": "reaction_moment_y"},
    }
    settings = {"duration": 0.8, "step": step, "integrator": integrator, **time}
    return scene | {"time": settings, "output": {"probes": probes, "every": 0.8}}


@pytest.fixture(scope="module")
def swung() -> dict[str, float]:
    return final(swinging(0.8 / 3200, "sdirk5"))


@pytest.mark.parametrize(
    ("integrator", "order", "coarse"),
    [
        ("implicit_euler", 1, 3200),
        ("implicit_midpoint", 2, 1600),
        ("generalized_alpha", 2, 1600),
        ("newmark", 2, 1600),
        ("bdf2", 2, 3200),
        ("tr_bdf2", 2, 800),
        ("sdirk4", 2, 400),  # as sections twist (docs/steppers.md)
        ("sdirk5", 2, 200),
        ("verlet", 2, 800),
    ],
)
def test_order_in_the_step(
    integrator: str, order: int, coarse: int, swung: dict[str, float], fitted_order: Any
) -> None:
    counts = [coarse * 2**k for k in range(3)]
    rows = [final(swinging(0.8 / count, integrator)) for count in counts]
    errors = [np.linalg.norm([row[name] - swung[name] for name in swung]) for row in rows]
    assert fitted_order([1 / count for count in counts], errors) > order - 0.15, errors


def free_frame(integrator: str, step: float) -> Scene:
    """Three arms that nothing holds, thrown so that they turn at first as a rigid body."""
    rods, members = [], []
    spin = np.array([1.0, -0.6, 2.0])
    for k, out in enumerate(np.array([[0.5, 0.1, 0], [-0.2, 0.4, 0.1], [-0.2, -0.4, 0.2]])):
        ends = np.linspace([0, 0, 0], out, 5) if k else np.linspace(out, [0, 0, 0], 5)
        speed = np.cross(spin, ends) + np.array([0.4, -0.2, 0.1])
        members.append(at(f"arm{k}", "start" if k else "end"))
        soft = {"EA": 50.0, "EI1": 0.02, "EI2": 0.03, "GJ": 0.02, "rotary_inertia": 0.01}
        thrown = {"initial_velocity": speed.tolist(), "stiffness": soft}
        rods.append(rod(f"arm{k}", ends[0].tolist(), ends[-1].tolist(), 4, **thrown))
    scene = scene_of(rods, [joint("hub", *members)], [], [])
    return scene | {"time": {"duration": 2, "step": step, "integrator": integrator}}


@pytest.mark.parametrize("integrator", ["implicit_midpoint", "newmark", "verlet"])
def test_a_free_frame_keeps_its_momenta(integrator: str) -> None:
    simulation = der.Simulation(der.Scenario.from_dict(free_frame(integrator, 0.002)))
    momentum, spin = simulation.momentum.copy(), simulation.angular_momentum.copy()
    energy = simulation.energies.total
    swings = []
    for _ in range(10):
        simulation.step(100)
        swings.append(simulation.energies.elastic)
        assert simulation.momentum == pytest.approx(momentum, abs=1e-9)
        if integrator != "newmark":
            assert simulation.angular_momentum == pytest.approx(spin, abs=1e-5)
        assert simulation.energies.total == pytest.approx(energy, rel=1e-3)
    assert max(swings) > 0.01 * energy


@pytest.mark.parametrize("integrator", ["implicit_midpoint", "tr_bdf2", "bdf2", "verlet", "sdirk4"])
def test_a_sudden_couple_is_balanced_at_every_step(integrator: str) -> None:
    """The rotation of a joint has no inertia: its moments balance at the end of each step."""
    scene = swinging(0.0005, integrator)
    couple = {"times": [0, 0.02, 0.0201], "values": [[0, 0, 0], [0, 0, 0], [1.0, -0.5, 0.7]]}
    scene["loads"] = [{"moment": at("arm", "start", moment=couple)}]
    scene["time"]["duration"] = 0.1
    probes = {
        f"{leg}-{c}": {"joint": "corner", "leg": leg, "quantity": f"moment_{c}"}
        for leg in ("post", "arm")
        for c in "xyz"
    }
    scene["output"] = {"every": 0.0005, "probes": probes}
    result = der.run(der.Scenario.from_dict(scene))
    exerted = np.array([np.asarray(series) for series in result.probes.values()]).reshape(2, 3, -1)
    times = np.asarray(result.times)
    sums = exerted.sum(axis=0)
    assert np.abs(sums[:, times < 0.0199]).max() < 1e-9
    after = sums[:, times > 0.0203]
    assert after == pytest.approx(np.outer([-1.0, 0.5, -0.7], np.ones(after.shape[1])), abs=1e-8)
