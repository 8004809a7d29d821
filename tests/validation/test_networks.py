"""Networks of rods that joints join, against `references/networks.py`, closed forms and trusses.

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
from references.networks import Network, Scene
from scipy.optimize import brentq, minimize_scalar

COARSE = [1, 2, 4]
FINENESS = [2, 4, 8]
#: Where at coarser meshes errors of several orders and of opposite signs show.
FINER = [8, 16, 32]
FINEST = [16, 32, 64]
FIELDS = ["x", "y", "slope", "moment", "tension"]
REACTIONS = ["reaction_x", "reaction_y", "reaction_moment"]


def rod(name: str, start: list[float], end: list[float], edges: int, **more: Any) -> Scene:
    """A straight rod of EI = 1, EA = 1e4 and mass 1 a unit length, unless told otherwise."""
    stiffness = {"EA": 1e4, "EI": 1.0, "mass_per_length": 1.0} | more.pop("stiffness", {})
    line: Scene = {"name": name, "from": start, "to": end, "nodes": edges + 1}
    return line | {"cross_section": {"stiffness": stiffness}} | more


def hinge(name: str, *members: Scene) -> Scene:
    return joint(name, *members, kind="hinge")


def moment(name: str, place: Any, value: float) -> Scene:
    return {"moment": at(name, place, moment=value)}


def pin(name: str, place: Any, **more: Any) -> Scene:
    return at(name, place, fix=["x", "y"], **more)


# Scenes: functions of a fineness.


def corner(n: int) -> Scene:
    return scene_of(
        [
            rod("post", [0, 0], [0, 1], 10 * n),
            rod("arm", [0, 1], [0.6, 1], 6 * n, stiffness={"EI": 0.6}),
        ],
        [joint("corner", at("post", "end"), at("arm", "start"))],
        [clamp("post", "start")],
        [force("arm", "end", 0.5, -2)],
    )


def tee(n: int) -> Scene:
    """A beam that runs through on a post."""
    return scene_of(
        [rod("beam", [0, 0], [1, 0], 10 * n), rod("post", [0.4, -0.5], [0.4, 0], 5 * n)],
        [joint("tee", at("beam", 0.4), at("post", "end"))],
        [clamp("post", "start"), at("beam", "start", fix=["y"])],
        [force("beam", "end", 2, -4), moment("post", "end", 0.7)],
    )


def fork(n: int) -> Scene:
    return scene_of(
        [
            rod("a", [-0.8, -0.3], [0, 0], 8 * n),
            rod("b", [0, 0], [0.9, -0.2], 9 * n, stiffness={"EI": 0.7}),
            rod("c", [0.1, 0.7], [0, 0], 7 * n, stiffness={"EI": 1.3}),
        ],
        [joint("middle", at("a", "end"), at("b", "start"), at("c", "end"))],
        [clamp("a", "start"), pin("b", "end")],
        [force("c", "start", 3, -1), moment("c", "start", 0.4)],
    )


def portal(n: int) -> Scene:
    return scene_of(
        [
            rod("left", [0, 0], [0, 1], 10 * n),
            rod("beam", [0, 1], [1.2, 1], 12 * n),
            rod("right", [1.2, 0], [1.2, 1], 10 * n),
        ],
        [
            joint("nw", at("left", "end"), at("beam", "start")),
            joint("ne", at("right", "end"), at("beam", "end")),
        ],
        [clamp("left", "start"), pin("right", "start")],
        [
            force("beam", "start", 4, 0),
            {"distributed_force": {"rod": "beam", "force": [0, -5]}},
            moment("beam", 0.3, 1.0),
        ],
    )


def braced(n: int) -> Scene:
    """A closed frame with rigid corners and two diagonals, one hinged at one end only."""
    soft = {"EA": 1e3}
    corners = {"sw": [0.0, 0.0], "se": [1.0, 0.0], "ne": [1.0, 0.8], "nw": [0.0, 0.8]}

    def bar(name: str, a: str, b: str, edges: int, EI: float = 1.0) -> Scene:
        return rod(name, corners[a], corners[b], edges, stiffness={**soft, "EI": EI})

    return scene_of(
        [
            bar("s", "sw", "se", 10 * n),
            bar("e", "se", "ne", 8 * n),
            bar("n", "ne", "nw", 10 * n),
            bar("w", "nw", "sw", 8 * n),
            rod("up", corners["sw"], corners["ne"], 12 * n, stiffness={**soft, "EI": 0.2}),
        ],
        [
            joint("sw", at("s", "start"), at("w", "end")),
            joint("se", at("s", "end"), at("e", "start")),
            joint("ne", at("e", "end"), at("n", "start"), at("up", "end")),
            joint("nw", at("n", "end"), at("w", "start")),
        ],
        [pin("s", "start"), at("s", "end", fix=["y"]), pin("up", "start")],
        [force("e", "end", 5, -2), moment("w", "start", 1.5)],
    )


def gerber(n: int) -> Scene:
    """A beam with a hinge inside, that a strut props where both run through."""
    return scene_of(
        [
            rod("left", [0, 0], [0.6, 0], 6 * n),
            rod("right", [0.6, 0], [1.4, 0], 8 * n),
            rod("strut", [0.9, -0.5], [0.9, 0.5], 10 * n, stiffness={"EA": 200, "EI": 0.5}),
        ],
        [
            hinge("inside", at("left", "end"), at("right", "start")),
            hinge("crossing", at("right", 0.3), at("strut", 0.5)),
        ],
        [clamp("left", "start"), clamp("strut", "start"), at("right", "end", fix=["y"])],
        [
            {"gravity": [0, -4]},
            force("strut", "end", 1.5, 0),
            moment("right", "start", -0.6),
            moment("left", "end", 0.3),
        ],
    )


def sprung(n: int) -> Scene:
    """Hinges with springs, and a motor between a beam and the arm that stands on it."""
    scene = scene_of(
        [
            rod("beam", [0, 0], [1, 0], 10 * n),
            rod("tail", [1, 0], [1.5, 0.2], 5 * n, stiffness={"EI": 0.4}),
            rod("arm", [0.4, 0], [0.4, 0.6], 6 * n, stiffness={"EI": 0.7}),
        ],
        [
            hinge("hip", at("beam", 0.4), at("arm", "start")),
            hinge("knee", at("beam", "end"), at("tail", "start")),
        ],
        [clamp("beam", "start"), pin("arm", "end")],
        [force("tail", "end", 0.5, -1), {"moment": {"joint": "hip", "moment": 0.8}}],
    )
    scene["joints"][0]["spring"] = {"rotational_stiffness": 1.5}
    scene["joints"][1]["spring"] = {"rotational_stiffness": 3}
    return scene


def tied(n: int) -> Scene:
    """Springs between tips, one of them tight as drawn, and one between the ends of a rod."""
    scene = scene_of(
        [
            rod("beam", [0, 0], [1, 0], 10 * n),
            rod("arm", [0.4, 0], [0.4, 0.6], 6 * n, stiffness={"EI": 0.7}),
            rod("post", [-0.5, 0], [-0.5, 0.6], 6 * n, stiffness={"EI": 0.4}),
        ],
        [
            hinge("hip", at("beam", 0.4), at("arm", "start")),
            joint("tip", at("beam", "end")),
            joint("top", at("arm", "end")),
            joint("head", at("post", "end")),
            joint("foot", at("post", "start")),
        ],
        [clamp("beam", "start"), clamp("post", "start")],
        [force("beam", "end", 0.5, -1)],
    )
    scene["springs"] = [
        {"name": "guy", "between": ["head", "top"], "stiffness": 8, "rest_length": 0.6},
        {"name": "tie", "between": ["tip", "top"], "stiffness": 20},
        {"name": "string", "between": ["head", "foot"], "stiffness": 5, "rest_length": 0.2},
    ]
    return scene


def curved(n: int) -> Scene:
    """Natural curvatures that differ from rod to rod."""
    return scene_of(
        [
            rod("a", [0, 0], [0.4, 0], 4 * n, natural_curvature=0),
            rod("b", [0.4, 0], [0.7, 0], 3 * n, natural_curvature=2.0),
            rod("c", [0.7, 0], [1, 0], 3 * n, natural_curvature=-1.5),
        ],
        [
            joint("ab", at("a", "end"), at("b", "start")),
            joint("bc", at("b", "end"), at("c", "start")),
        ],
        [clamp("a", "start"), at("a", "end", spring={"rotational_stiffness": 5})],
        [force("c", "end", 0, -2)],
    )


def stretched(n: int) -> Scene:
    """Forces and springs along rods that stretch by a fifth, and motions of supports."""
    soft = {"EA": 20.0}
    return scene_of(
        [
            rod("a", [0, 0], [0.6, 0], 6 * n, stiffness=soft),
            rod("b", [0.6, 0], [1, 0], 4 * n, stiffness=soft),
        ],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [
            clamp("a", "start", prescribe={"x": -0.05, "angle": 0.2}),
            at("a", 0.4, spring={"stiffness": [5, 8]}),
            at("b", "start", spring={"rotational_stiffness": 1.5}),
            at("b", "end", prescribe={"x": 0.15, "y": -0.1}),
        ],
        [force("a", 0.2, 3, -1), force("b", "start", 1, 0.5)],
    )


def near(n: int) -> Scene:
    """A spring and a couple 0.3 cells apart, and a spring so near to a clamp."""
    gap = 0.3 / (10 * n)
    return scene_of(
        [rod("a", [0, 0], [0.5, 0], 5 * n + 1), rod("b", [0.5, 0], [1, 0], 5 * n + 1)],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [
            clamp("a", "start"),
            at("a", gap, spring={"rotational_stiffness": 5}),
            at("b", "start", spring={"rotational_stiffness": 5}),
        ],
        [moment("b", gap, 2.0), force("b", "end", 0, -3)],
    )


def near_end(n: int) -> Scene:
    """Things within a cell of a free end, and a short overhang."""
    h = 1 / (10 * n)
    return scene_of(
        [
            rod("a", [0, 0], [0.5, 0], 5 * n),
            rod("b", [0.5, 0], [1, 0], 5 * n + 2),
            rod("c", [1 - 0.7 * h, 0], [1 - 0.7 * h, 0.3], 3 * n),
        ],
        [
            joint("ab", at("a", "end"), at("b", "start")),
            joint("bc", at("b", 0.5 - 0.7 * h), at("c", "start")),
        ],
        [clamp("a", "start"), at("b", 0.5 - 0.2 * h, spring={"rotational_stiffness": 2})],
        [moment("b", 0.5 - 0.7 * h, 1.0), force("b", "end", 0, -2), force("c", "end", 1, 0)],
    )


def near_stretch(n: int) -> Scene:
    """Forces and springs within a cell along a rod that stretches."""
    h = 1 / (10 * n)
    soft = {"EA": 20.0}
    return scene_of(
        [
            rod("a", [0, 0], [0.3, 0], 3 * n, stiffness=soft),
            rod("b", [0.3, 0], [1, 0], 7 * n + 3, stiffness=soft),
        ],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [
            clamp("a", "start"),
            at("b", 0.25 * h, spring={"stiffness": 8}),
            at("b", 1.3 * h, spring={"stiffness": [3, 0]}),
        ],
        [force("a", "end", 2, -1), force("b", 0.7 * h, 1, 0.5), force("b", "end", 1, -0.6)],
    )


def followed(n: int) -> Scene:
    """Forces that turn with a beam, inside and at its end, and one with a hinged strut."""
    scene = scene_of(
        [
            rod("beam", [0, 0], [1, 0], 10 * n),
            rod("strut", [0.4, -0.3], [0.4, 0], 3 * n, stiffness={"EA": 300.0}),
        ],
        [hinge("top", at("beam", 0.4), at("strut", "end"))],
        [clamp("beam", "start"), pin("strut", "start")],
        [force("beam", 0.7, 1, -4), force("beam", "end", 2, -3), force("strut", 0.1, 3, 0)],
    )
    for load in scene["loads"]:
        load["point_force"]["follower"] = True
    return scene


SCENES: list[Callable[[int], Scene]] = [
    corner,
    tee,
    fork,
    portal,
    braced,
    gerber,
    sprung,
    tied,
    curved,
    stretched,
    near,
    near_end,
    near_stretch,
    followed,
]


MOVES = [near, near_end, near_stretch]  # the places in them depend on the mesh


def probed(network: Network) -> dict[str, tuple[dict[str, Any], float]]:
    """Probes at both ends and a third of every leg, with the reference's values."""
    probes = {}
    for number, leg in enumerate(network.pieces):
        span = leg.end - leg.start
        places = [(leg.start, "after"), (leg.start + span / 3, "after"), (leg.end, "before")]
        for place, (s, side) in enumerate(places):
            for quantity in FIELDS:
                probe = {"rod": leg.rod, "at": s, "quantity": quantity}
                if quantity not in ("x", "y"):
                    probe["side"] = side
                exact = network.read(quantity, leg.rod, s, side)
                probes[f"{quantity}-{number}-{place}"] = (probe, exact)
    for name in network.springs:
        for quantity, exact in zip(("length", "force"), network.spring(name), strict=True):
            probe = {"spring": name, "quantity": f"spring_{quantity}"}
            probes[f"spring-{name}-{quantity}"] = (probe, exact)
    for number, key in enumerate(network.supports):
        if network.supports.count(key) == 1:
            for quantity, exact in zip(REACTIONS, network.reaction(number), strict=True):
                probe = {"support": number, "quantity": quantity}
                probes[f"{quantity}-{number}"] = (probe, exact)
    return probes


def errors(scene: Scene, network: Network) -> dict[str, float]:
    """Largest error of each quantity, of probes and along the rods, against the reference."""
    expected = probed(network)
    probes = {key: probe for key, (probe, _) in expected.items()}
    result = der.run(
        der.Scenario.from_dict(scene | {"analysis": "static", "output": {"probes": probes}})
    )
    assert result.status == "static_converged"
    worst: dict[str, float] = {}

    def enter(quantity: str, error: float) -> None:
        worst[quantity] = max(worst.get(quantity, 0.0), error)

    for key, (_, exact) in expected.items():
        enter(re.split("[-_]", key)[0], abs(result.probes[key][-1] - exact))
    for name in network.rods:
        for quantity in FIELDS:
            places, values = result.along(name, quantity)
            second = np.append(False, np.diff(places) <= 1e-12)  # after a jump
            exact = np.where(
                second,
                network.along(quantity, name, places, "after"),
                network.along(quantity, name, places, "before"),
            )
            enter(quantity, np.abs(values[-1] - exact).max())
    return worst


#: Of legs that stretch noticeably, or of one cell, and where such a rod moves with the mesh.
ORDER_2 = [stretched, near, near_end, near_stretch]


@pytest.mark.parametrize("make", SCENES, ids=lambda make: make.__name__)
def test_equilibria(make: Callable[[int], Scene], fitted_order: Any) -> None:
    fineness = FINER if make in ORDER_2 else FINENESS
    same = Network(make(1)).solve()
    networks = [Network(make(n)).solve() if make in MOVES else same for n in fineness]
    rows = [errors(make(n), network) for n, network in zip(fineness, networks, strict=True)]
    for quantity in rows[0]:
        found = [row[quantity] for row in rows]
        if max(found) > 1e-8:  # else it is exact but for rounding
            assert fitted_order([1 / n for n in fineness], found) > 1.85, (quantity, found)


@pytest.mark.parametrize("make", [corner, fork], ids=lambda make: make.__name__)
def test_slender_legs_under_loads_at_points_have_order_4(
    make: Callable[[int], Scene], fitted_order: Any
) -> None:
    """At joints and inside legs, from 10 cells a leg on."""
    network = Network(make(1)).solve()
    rows = [errors(make(n), network) for n in COARSE]
    for quantity in rows[0]:
        found = [row[quantity] for row in rows]
        assert found[-1] < 1e-5
        assert fitted_order([1 / n for n in COARSE], found) > 3.7, (quantity, found)


@pytest.mark.parametrize("make", [gerber, curved], ids=lambda make: make.__name__)
def test_distributed_loads_have_order_3(make: Callable[[int], Scene], fitted_order: Any) -> None:
    network = Network(make(1)).solve()
    rows = [errors(make(n), network) for n in COARSE]
    for quantity in rows[0]:
        found = [row[quantity] for row in rows]
        assert fitted_order([1 / n for n in COARSE], found) > 2.7, (quantity, found)


@pytest.mark.parametrize("load", [1.0, 5.0, 10.0])
def test_an_idle_joint_changes_nothing(load: float, fitted_order: Any) -> None:
    """Two rods that are joined end to end are the one rod of the reference."""
    stiff = {"EA": 1e8}
    whole = scene_of(
        [rod("a", [0, 0], [1, 0], 1, stiffness=stiff)],
        [],
        [clamp("a", "start")],
        [force("a", "end", 0, -load)],
    )
    network = Network(whole).solve(6)
    names = ["x", "y", "slope"]
    exact = [network.read(name, "a", "end") for name in names] + [network.read("moment", "a", 0.4)]
    errors = []
    for n in FINENESS:
        scene = jointed_beam(n)
        scene |= {"supports": [clamp("a", "start")], "loads": [force("b", "end", 0, -load)]}
        probes = {name: at("b", "end", quantity=name) for name in names}
        probes["moment"] = {"joint": "ab", "leg": "a", "quantity": "moment_z"}
        result = der.run(
            der.Scenario.from_dict(scene | {"analysis": "static", "output": {"probes": probes}})
        )
        found = [float(result.probes[name][-1]) for name in probes]
        found[-1] *= -1  # the rod exerts the opposite of the moment that the part beyond exerts
        errors.append(np.linalg.norm(np.subtract(found, exact)))
    assert fitted_order([1 / n for n in FINENESS], errors) > 1.85


def test_rods_exert_forces_and_moments_on_a_joint(fitted_order: Any) -> None:
    """They balance what acts on it, and are those of the reference."""
    network = Network(portal(1)).solve()
    exact = -network.states("left", np.array([1.0]), "before")[3:, 0]
    errors = []
    for n in FINENESS:
        probes = {
            f"{leg}-{name}": {"joint": "nw", "leg": leg, "quantity": name}
            for leg in ("left", "beam")
            for name in ("force_x", "force_y", "moment_z")
        }
        probes["turn"] = {"joint": "nw", "quantity": "rotation"}
        result = der.run(
            der.Scenario.from_dict(portal(n) | {"analysis": "static", "output": {"probes": probes}})
        )
        *values, turn = (float(series[-1]) for series in result.probes.values())
        assert np.add(values[:3], values[3:]) == pytest.approx([-4, 0, 0], abs=1e-8)
        turn -= network.read("slope", "beam", "start")
        errors.append(np.linalg.norm([*np.subtract(values[:3], exact), turn]))
    assert fitted_order([1 / n for n in FINENESS], errors) > 1.85


# Limit loads.


def lee(n: int) -> Scene:
    """Lee's frame in units of its leg and its EI: EA L^2/EI = 4320 120^2/1440, a square section."""
    section = {"EA": 43200.0}
    return scene_of(
        [
            rod("column", [0, 0], [0, 1], 10 * n, stiffness=section),
            rod("beam", [0, 1], [1, 1], 10 * n, stiffness=section),
        ],
        [joint("corner", at("column", "end"), at("beam", "start"))],
        [pin("column", "start"), pin("beam", "end")],
        [force("beam", 0.2, 0, -1)],
    )


def limit_of_lee() -> float:
    """The first fold of the continuum: the greatest force of a support in place of the load."""

    def reaction(sinking: float) -> float:
        scene = lee(1)
        scene["loads"] = []
        scene["supports"].append(at("beam", 0.2, prescribe={"y": -sinking}))
        return float(Network(scene, steps=8).solve(6).reaction(2)[1])

    found = minimize_scalar(
        reaction, bounds=(0.37, 0.44), method="bounded", options={"xatol": 1e-6}
    )
    return -float(found.fun)


def test_lees_frame(fitted_order: Any) -> None:
    exact = limit_of_lee()
    assert exact == pytest.approx(18.5567, abs=1e-4)  # Lee, Manuel, Rossow (1968): 18.552
    found = []
    for n in COARSE:
        path = der.continuation(lee(n) | {"analysis": "static"}, to=20.0).path
        found.append(path.factor[path.rows("fold")[0]])
    assert fitted_order([1 / n for n in COARSE], np.array(found) - exact) > 1.9
    assert found[2] + (found[2] - found[1]) / 3 == pytest.approx(exact, rel=1e-4)


def test_a_portal_sways(fitted_order: Any) -> None:
    """Clamped columns of length 1 under P each; the beam of length 1 turns with both corners alike.

    It resists by 6 EI/L, so that tan k = -k/6 with P = k^2 EI/L^2 (Timoshenko, Gere, Theory of
    Elastic Stability, sec. 2.4).
    """
    exact = brentq(lambda k: 6 * np.sin(k) + k * np.cos(k), 1.6, 3.1) ** 2
    found = []
    for n in FINENESS:
        stiff = {"EA": 1e9}
        scene = scene_of(
            [
                rod("left", [0, 0], [0, 1], 2 * n, stiffness=stiff),
                rod("beam", [0, 1], [1, 1], 2 * n, stiffness=stiff),
                rod("right", [1, 0], [1, 1], 2 * n, stiffness=stiff),
            ],
            [
                joint("nw", at("left", "end"), at("beam", "start")),
                joint("ne", at("right", "end"), at("beam", "end")),
            ],
            [clamp("left", "start"), clamp("right", "start")],
            [force("left", "end", 0, -1), force("right", "end", 0, -1)],
        )
        result = der.run(der.Scenario.from_dict(scene | {"analysis": "buckling"}))
        found.append(result.summary["load_factors"][0])
    assert fitted_order([1 / n for n in FINENESS], np.array(found) - exact) > 3.3
    assert found[-1] == pytest.approx(exact, rel=1e-5)


# Small displacements.


@pytest.mark.parametrize("arms", [2, 3, 4, 5, 6])
def test_a_star_turns_by_the_stiffness_of_its_arms(arms: int) -> None:
    """A clamped arm resists a turn of the middle by 4 EI/L, a pinned one by 3 EI/L."""
    small = 1e-6

    def turn(order: list[int], backward: bool) -> float:
        rods, members, supports = [], [], []
        for k in order:
            angle = 0.3 + k
            out = [np.cos(angle), np.sin(angle)]
            ends = (out, [0, 0]) if backward else ([0, 0], out)
            rods.append(rod(f"arm{k}", *ends, 4, stiffness={"EA": 1e9}))
            members.append(at(f"arm{k}", "end" if backward else "start"))
            far = "start" if backward else "end"
            supports.append(clamp(f"arm{k}", far) if k else pin(f"arm{k}", far))
        scene = scene_of(
            rods, [joint("hub", *members)], supports, [moment("arm0", members[0]["at"], small)]
        )
        probe = {"rod": "arm1", "at": members[0]["at"], "quantity": "slope"}
        scene |= {"analysis": "static", "output": {"probes": {"turn": probe}}}
        drawn = 1.3 + (np.pi if backward else 0.0)
        found = float(der.run(der.Scenario.from_dict(scene)).probes["turn"][-1]) - drawn
        return (found + np.pi) % (2 * np.pi) - np.pi

    exact = small / (4 * (arms - 1) + 3)
    for order in (list(range(arms)), list(range(arms))[::-1]):
        for backward in (False, True):
            assert turn(order, backward) == pytest.approx(exact, rel=1e-6)


def truss_places(
    places: np.ndarray, bars: list[tuple[int, int]], EA: float, held: list[int], load: np.ndarray
) -> np.ndarray:
    """Equilibrium of hinged bars with the energy EA/(2 L) (l - L)^2, by Newton's method."""
    free = np.setdiff1d(np.arange(places.size), held)
    x = places.ravel().copy()
    for _ in range(30):
        residual, stiffness = -load.ravel(), np.zeros((x.size, x.size))
        for a, b in bars:
            of = [2 * a, 2 * a + 1, 2 * b, 2 * b + 1]
            rest = np.linalg.norm(places[b] - places[a])
            along = x[of[2:]] - x[of[:2]]
            length = np.linalg.norm(along)
            unit = along / length
            pull = EA * (length / rest - 1)
            block = EA / rest * np.outer(unit, unit)
            block += pull / length * (np.eye(2) - np.outer(unit, unit))
            residual[of] += pull * np.concatenate([-unit, unit])
            stiffness[np.ix_(of, of)] += np.block([[block, -block], [-block, block]])
        x[free] -= np.linalg.solve(stiffness[np.ix_(free, free)], residual[free])
    return x.reshape(places.shape)


@pytest.mark.parametrize(("EI", "edges"), [(0.0, 1), (1.0, 1), (1.0, 3)])
def test_a_truss(EI: float, edges: int) -> None:
    places = np.array([[0, 0], [1, 0], [2, 0], [0.5, 0.8], [1.5, 0.9]])
    bars = [(0, 1), (1, 2), (0, 3), (3, 1), (1, 4), (4, 2), (3, 4)]
    EA = 50.0
    rods = [
        rod(f"b{a}{b}", list(places[a]), list(places[b]), edges, stiffness={"EA": EA, "EI": EI})
        for a, b in bars
    ]
    joints, of_joint = [], []
    for k in range(len(places)):
        members = [at(f"b{a}{b}", "start" if a == k else "end") for a, b in bars if k in (a, b)]
        of_joint.append(members[-1])
        joints.append(hinge(f"j{k}", *members))
    load = np.zeros(places.shape)
    load[1], load[3], load[4] = [0.3, -1], [0.5, -0.7], [0.2, 0.1]
    scene = scene_of(
        rods,
        joints,
        [of_joint[0] | {"fix": ["x", "y"]}, of_joint[2] | {"fix": ["y"]}],
        [{"point_force": of_joint[k] | {"force": list(load[k])}} for k in (1, 3, 4)],
    )
    probes = {f"{c}{k}": {**of_joint[k], "quantity": c} for k in range(len(places)) for c in "xy"}
    probes["tension"] = {"rod": "b34", "at": "middle", "quantity": "tension"}
    scene |= {"analysis": {"static": {"stability": "any"}}, "output": {"probes": probes}}
    result = der.run(der.Scenario.from_dict(scene))
    exact = truss_places(places, bars, EA, [0, 1, 5], load)
    for k, place in enumerate(exact):
        for c, value in zip("xy", place, strict=True):
            assert result.probes[f"{c}{k}"][-1] == pytest.approx(value, abs=1e-9)
    stretched = np.linalg.norm(exact[4] - exact[3]) / np.linalg.norm(places[4] - places[3])
    assert result.probes["tension"][-1] == pytest.approx(EA * (stretched - 1), abs=1e-8)


# Vibrations.


def omegas(scene: Scene, count: int) -> np.ndarray:
    simulation = der.Simulation(der.Scenario.from_dict(scene | {"analysis": "modes"}))
    simulation.equilibrium()
    return 2 * np.pi * simulation.modes(count).frequencies


def jointed_beam(n: int) -> Scene:
    """A pinned beam of two rods."""
    stiff = {"EA": 1e8}
    return scene_of(
        [
            rod("a", [0, 0], [0.4, 0], 4 * n, stiffness=stiff),
            rod("b", [0.4, 0], [1, 0], 6 * n, stiffness=stiff),
        ],
        [joint("ab", at("a", "end"), at("b", "start"))],
        [pin("a", "start"), at("b", "end", fix=["y"])],
        [],
    )


def test_frequencies_of_a_beam_with_an_idle_joint(fitted_order: Any) -> None:
    exact = (np.pi * np.arange(1, 5)) ** 2
    found = np.array([omegas(jointed_beam(n), 4) / exact - 1 for n in COARSE])
    for of_mode in found.T:
        assert fitted_order([1 / n for n in COARSE], of_mode) > 1.85


@pytest.mark.parametrize("make", [corner, tee, portal, gerber], ids=lambda make: make.__name__)
@pytest.mark.parametrize("loaded", [False, True], ids=["free", "loaded"])
def test_frequencies(make: Callable[[int], Scene], loaded: bool, fitted_order: Any) -> None:
    def scene(n: int) -> Scene:
        return make(n) if loaded else make(n) | {"loads": []}

    found = np.array([omegas(scene(n), 3) for n in FINEST])
    network = Network(scene(1)).solve()
    exact = np.array([network.frequency_near(omega) for omega in found[-1]])
    for of_mode in (found / exact - 1).T:
        if np.abs(of_mode).max() > 1e-6:
            assert fitted_order([1 / n for n in FINEST], of_mode) > 1.85


# Motion.


def swinging(step: float, integrator: str, **time: Any) -> Scene:
    """A soft L on a post that a growing couple at its corner and its weight swing."""
    soft = {"EA": 100.0}
    ramp = {"times": [0, 1], "values": [0, 3], "smooth": True}
    scene = scene_of(
        [
            rod("post", [0, 0], [0, 0.6], 3, stiffness=soft),
            rod("arm", [0, 0.6], [0.8, 0.6], 4, stiffness=soft),
        ],
        [joint("corner", at("post", "end"), at("arm", "start"))],
        [clamp("post", "start"), at("arm", 0.4, spring={"rotational_stiffness": 0.5})],
        [
            moment("arm", "start", 0) | {"moment": at("arm", "start", moment=ramp)},
            {"gravity": [0, -3]},
        ],
    )
    probes = {
        "x": {"rod": "arm", "at": "end", "quantity": "x"},
        "turn": {"rod": "arm", "at": "start", "quantity": "slope"},
        "before": {"rod": "post", "at": "end", "quantity": "moment"},
        "after": {"rod": "arm", "at": "start", "quantity": "moment"},
        "wall": {"support": 0, "quantity": "reaction_moment"},
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
        ("sdirk4", 4, 400),
        ("sdirk5", 5, 200),
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


def free_frame(integrator: str, step: float, **time: Any) -> Scene:
    """A Y that nothing holds, thrown so that its arms turn at first as a rigid body."""
    rods, members = [], []
    for k, angle in enumerate((0.1, 2.0, 4.1)):
        out = 0.5 * np.array([np.cos(angle), np.sin(angle)])
        ends = np.linspace([0, 0], out, 5) if k else np.linspace(out, [0, 0], 5)
        speed = np.column_stack([-ends[:, 1], ends[:, 0]]) * 3 + [0.4, -0.2]
        members.append(at(f"arm{k}", "start" if k else "end"))
        velocity = {"initial_velocity": speed.tolist(), "stiffness": {"EA": 50.0, "EI": 0.02}}
        rods.append(rod(f"arm{k}", ends[0].tolist(), ends[-1].tolist(), 4, **velocity))
    scene = scene_of(rods, [joint("hub", *members)], [], [])
    return scene | {"time": {"duration": 2, "step": step, "integrator": integrator, **time}}


@pytest.mark.parametrize("integrator", ["implicit_midpoint", "newmark", "verlet"])
@pytest.mark.parametrize("kind", ["rigid", "hinge", "tied"])
def test_a_free_frame_keeps_its_momenta(integrator: str, kind: str) -> None:
    scene = free_frame(integrator, 0.002)
    scene["joints"][0]["kind"] = "hinge" if kind == "tied" else kind
    if kind == "tied":
        scene["joints"] += [joint("a", at("arm0", "start")), joint("b", at("arm1", "end"))]
        scene["springs"] = [
            {"name": "tie", "between": ["a", "b"], "stiffness": 4, "rest_length": 0.3}
        ]
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    momentum, spin = simulation.momentum.copy(), simulation.angular_momentum.copy()
    energy = simulation.energies.total
    assert energy > 0.5
    swings = []
    for _ in range(10):
        simulation.step(100)
        swings.append(simulation.energies.elastic)
        assert simulation.momentum == pytest.approx(momentum, abs=1e-9)
        if integrator != "newmark":
            assert simulation.angular_momentum == pytest.approx(spin, abs=1e-8)
        assert simulation.energies.total == pytest.approx(energy, rel=1e-3)
    assert max(swings) > 0.01 * energy


@pytest.mark.parametrize("integrator", ["implicit_midpoint", "tr_bdf2", "bdf2", "verlet", "sdirk4"])
def test_a_sudden_couple_is_balanced_at_every_step(integrator: str) -> None:
    """The rotation of a joint has no inertia: its moments balance at the end of each step."""
    scene = swinging(0.0005, integrator)
    couple = {"times": [0, 0.02, 0.0201], "values": [0, 0, 1.0]}
    scene["loads"] = [{"moment": at("arm", "start", moment=couple)}]
    scene["time"]["duration"] = 0.1
    scene["output"]["every"] = 0.0005
    result = der.run(der.Scenario.from_dict(scene))
    jump = np.asarray(result.probes["before"]) - np.asarray(result.probes["after"])
    times = np.asarray(result.times)
    assert np.abs(jump[times < 0.0199]).max() < 1e-9
    assert jump[times > 0.0203] == pytest.approx(1.0, abs=1e-8)


def test_the_slope_goes_on_where_a_drawn_rod_turns_through_pi() -> None:
    """An arc of radius 1 from the direction 2.5 on, almost without a load: the slope is 2.5 + s."""
    angles = np.linspace(2.5, 4.5, 17)
    points = np.column_stack([np.sin(angles), -np.cos(angles)]).tolist()
    stub = rod("stub", points[8], [points[8][0], points[8][1] + 0.5], 4)
    section = {"stiffness": {"EA": 1e5, "EI": 1.0, "mass_per_length": 1.0}}
    scene = scene_of(
        [{"name": "arc", "points": points, "cross_section": section}, stub],
        [joint("middle", at("arc", {"node": 8}), at("stub", "start"))],
        [clamp("arc", "start")],
        [force("stub", "end", 1e-6, 0)],
    )
    result = der.run(der.Scenario.from_dict(scene | {"analysis": "static"}))
    places, slopes = result.along("arc", "slope")
    assert slopes[-1] == pytest.approx(2.5 + places * 2.0 / places[-1], abs=2e-3)


def test_a_moment_at_a_clamp_is_in_no_reaction() -> None:
    """It acts on what holds the clamp (docs/mechanics.md, Loads)."""

    def reaction(*loads: Scene) -> float:
        probes = {"moment": {"support": 0, "quantity": "reaction_moment"}}
        scene = corner(1) | {"analysis": "static", "output": {"probes": probes}}
        scene["loads"] = [*scene["loads"], *loads]
        return float(der.run(der.Scenario.from_dict(scene)).probes["moment"][-1])

    assert reaction(moment("post", "start", 2.0)) == reaction()
