"""Rods that stretch by a fifth under a force between nodes, which a spring may exert, or which may
follow the rod.

The reference is `references/section_loads.py`, for which each force is given in the axes of the
section there. A spring has its anchor where it exerts that force in equilibrium.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import der
import numpy as np
import pytest
from references.kirchhoff_rod import UPRIGHT, Rod
from references.record import Array
from references.section_loads import Wrench, held_at_start
from spatial_scenes import measured, section, straight_rod

STRETCHING = 20.0
ROUNDING = 1e-10
STIFFNESS = np.array([30.0, 10.0, 20.0])  # of springs [N/m]
#: Places with numbers of edges: the middle of an edge, and a quarter from its start.
PLACES = {0.425: (60, 180, 540), 0.4125: (100, 260, 500)}
#: Along d1, d2 and d3 of the sections; in a plane along d1 and d3.
INNER, TIP = np.array([1.5, 0.0, 3.0]), np.array([-1.0, 0.0, 1.0])
ACROSS = np.array([0.0, 0.8, 0.0])
MODELS = {
    "planar": section(EA=STRETCHING, EI=1.0),
    "spatial": section([0, 1, 0], EA=STRETCHING, EI1=1.0, EI2=2.0, GJ=0.7),
}


def loaded(how: str, place: float, force: Array, position: Array) -> dict[str, Any]:
    """A force [N] at a place of the rod as a load, or a spring that exerts it."""
    if how == "spring":
        anchor = position + force / STIFFNESS
        spring = {"stiffness": STIFFNESS.tolist(), "anchor": anchor.tolist()}
        return {"supports": [{"rod": "rod", "at": place, "spring": spring}]}
    load = {"rod": "rod", "at": place, "force": force.tolist(), "follower": how == "follower"}
    return {"loads": [{"point_force": load}]}


def scene_of(
    model: str, hows: tuple[str, ...], places: tuple[float, ...], forces: Any, positions: Any
) -> Any:
    """A scene maker by edges: a force at each place, and a fixed one at the end."""
    supports: list[Any] = [{"rod": "rod", "at": "start", "clamp": True}]
    loads: list[Any] = []
    for how, place, force, position in zip(hows, places, forces, positions, strict=True):
        more = loaded(how, place, force, position)
        supports += more.get("supports", [])
        loads += more.get("loads", [])

    def scene(edges: int) -> Any:
        made = straight_rod(
            edges, MODELS[model], model=model, supports=supports, loads=loads, analysis="static"
        )
        if model == "planar":
            flatten(made)
        return made

    return scene


def flatten(scene: Any) -> None:
    """Takes the third component of all vectors away."""
    for rod in scene["rods"]:
        rod["points"] = [point[:2] for point in rod["points"]]
    for support in scene["supports"]:
        for key, vector in support.get("spring", {}).items():
            support["spring"][key] = vector[:2]
    for load in scene["loads"]:
        load["point_force"]["force"] = load["point_force"]["force"][:2]


QUANTITIES = {
    "planar": ("x", "y", "moment", "tension"),
    "spatial": ("x", "y", "z", "moment_1", "moment_2", "torque", "tension"),
}


@dataclass
class Exact:
    """The solution for a rod under a force at a place and another at its end."""

    forces: list[Array]  # [N], of a fixed direction
    positions: Array  # of the place and the end [m]
    force: Array  # in the rod at its start [N]
    moment: Array  # likewise [N m]
    section: Array  # at the place, columns d1, d2, d3

    @property
    def moment_there(self) -> Array:
        """In the rod at the place [N m]."""
        return np.cross(self.positions[1] - self.positions[0], self.forces[1])


def exact(model: str, place: float, force: Array, tip: Array) -> Exact:
    """`force` and `tip` [N] along d1, d2, d3 of the sections there."""
    bending = (2.0, 1.0) if model == "spatial" else (1.0, 1.0)  # about d1 and d2
    rod = Rod(1.0, bending, 0.7, STRETCHING)
    wrenches = [Wrench(place, tuple(force)), Wrench(1.0, tuple(tip))]
    end, positions, frames = held_at_start(rod, wrenches)
    forces = [frames[0] @ force, frames[1] @ tip]
    moment = np.cross(positions[0], forces[0]) + np.cross(end, forces[1])
    return Exact(forces, positions, forces[0] + forces[1], moment, frames[0])


def bends(model: str, moment: Array, section: Array) -> list[float]:
    """The moment of a section as probes have it."""
    if model == "planar":
        return [moment[2]]
    about_first, about_second, torque = section.T @ moment
    return [about_second, -about_first, torque]  # towards a director it turns about the other


@pytest.mark.parametrize(("place", "meshes"), PLACES.items())
@pytest.mark.parametrize("how", ["fixed", "follower", "spring"])
@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_forces_between_nodes(model, how, place, meshes, fitted_order):
    """The whole solution is of order 2 wherever the force stands; so is what the clamp bears, and
    what probes tell of the rod at the clamp and where the force stands."""
    across = ACROSS if model == "spatial" else 0.0 * ACROSS
    true = exact(model, place, INNER + across, TIP + across)
    drawn = UPRIGHT @ (INNER + across)
    makers = scene_of(
        model,
        (how, "fixed"),
        (place, 1.0),
        [drawn if how == "follower" else true.forces[0], true.forces[1]],
        true.positions,
    )
    size = 2 if model == "planar" else 3
    tensions = [true.force[0], true.forces[1] @ true.section[:, 2]]
    expected = [
        *(*true.positions[0][:size], *true.positions[1][:size], *-true.force[:size]),
        *(-true.moment[3 - len(bends(model, true.moment, UPRIGHT)) :]),
        *(*bends(model, true.moment, UPRIGHT), tensions[0]),
        *(*bends(model, true.moment_there, true.section), tensions[1]),
    ]
    errors = []
    for edges in meshes:
        values, result = measured(makers(edges), ["start", place, "end"], QUANTITIES[model])
        clamp = result.reactions()[0]
        found = [*values[1, :size], *values[2, :size], *clamp.force[-1]]
        found += [*np.atleast_1d(clamp.moment[-1]), *values[0, size:], *values[1, size:]]
        errors.append(np.array(found) - expected)
    sizes = [1.0 / edges for edges in meshes]
    for column in np.transpose(errors):
        if abs(column[0]) > ROUNDING:  # clamps bear exactly what loads of a fixed direction are
            assert fitted_order(sizes, column) > 1.9


def errors_of(scene: Any, end: Array, positions: Array, forces: list[Array]) -> Array:
    """Errors of the end, in a plane, and of the moment that the clamp at the start exerts."""
    values, result = measured(scene, ["end"], ("x", "y"))
    bears = sum(np.cross(r, f)[2] for r, f in zip(positions, forces, strict=True))
    found = [*values[0], result.reactions()[0].moment[-1]]
    return np.array(found) - [*end[:2], -bears]


@pytest.mark.parametrize("apart", [1.0, 1.3, 2.2])
@pytest.mark.parametrize("how", ["fixed", "spring"])
def test_forces_in_neighbouring_edges(how, apart, fitted_order):
    """Each sees the jump of the strain that the other makes, so many edges from it."""
    rod = Rod(1.0, (1.0, 1.0), 0.7, STRETCHING)
    meshes = (40, 80, 160, 320)
    errors = []
    for edges in meshes:
        places = (0.5 + 0.4 / edges, 0.5 + (0.4 + apart) / edges, 1.0)
        shares = [INNER, -0.6 * INNER + np.array([0.5, 0.0, 0.0]), TIP]
        wrenches = [Wrench(s, tuple(force)) for s, force in zip(places, shares, strict=True)]
        end, positions, frames = held_at_start(rod, wrenches)
        forces = [frame @ force for frame, force in zip(frames, shares, strict=True)]
        makers = scene_of("planar", (how, how, "fixed"), places, forces, positions)
        errors.append(errors_of(makers(edges), end, positions, forces))
    sizes = [1.0 / edges for edges in meshes]
    for column in np.transpose(errors):
        assert fitted_order(sizes, column) > 1.9


CURVATURE = 2.0  # [1/m], in the plane


@pytest.mark.parametrize("model", ["planar", "spatial"])
@pytest.mark.parametrize("shape", ["drawn", "given"])
def test_ends_of_curved_rods(model, shape, fitted_order):
    """Moment and tension at a clamp and at an end on which a moment acts."""
    bending = (2.0, 1.0) if model == "spatial" else (1.0, 1.0)
    rod = Rod(
        1.0,
        bending,
        0.7,
        STRETCHING,
        natural=lambda s: np.stack([0.0 * s, CURVATURE + 0.0 * s, 0.0 * s]),
    )
    # Along d1, d2 and d3; the moment is about d2, out of the plane of the natural curvature.
    force = np.array([1.0, 0.4 if model == "spatial" else 0.0, 3.0])
    turning = np.array([0.0, 0.5, 0.0])
    end, _, frames = held_at_start(rod, [Wrench(1.0, tuple(force), tuple(turning))])
    pull, moment = frames[0] @ force, frames[0] @ turning
    at_start = np.cross(end, pull) + moment
    expected = [*bends(model, at_start, UPRIGHT), pull[0]]
    expected += [*bends(model, moment, frames[0]), force[2]]
    size = 2 if model == "planar" else 3

    def scene(edges: int) -> Any:
        angles = CURVATURE * np.linspace(0.0, 1.0, edges + 1)
        arc = np.stack([np.sin(angles), 1.0 - np.cos(angles), 0.0 * angles], axis=1) / CURVATURE
        made = straight_rod(edges, MODELS[model], model=model, analysis="static")
        if shape == "drawn":
            made["rods"][0]["points"] = arc.tolist()
        else:
            given = CURVATURE if model == "planar" else [CURVATURE, 0.0]
            made["rods"][0]["natural_curvature"] = given
        loads = [
            {"point_force": {"rod": "rod", "at": "end", "force": pull[:size].tolist()}},
            {"moment": {"rod": "rod", "at": "end", "moment": moment.tolist()}},
        ]
        if model == "planar":
            made["rods"][0]["points"] = [point[:2] for point in made["rods"][0]["points"]]
            loads[1]["moment"]["moment"] = moment[2]
        return {**made, "loads": loads}

    meshes = (40, 80, 160, 320)
    errors = []
    for edges in meshes:
        values, _ = measured(scene(edges), ["start", "end"], QUANTITIES[model])
        errors.append(values[:, size:].ravel() - expected)
    sizes = [1.0 / edges for edges in meshes]
    for column in np.transpose(errors):
        if abs(column[0]) > 1e-6:  # moments at a free end are known
            assert fitted_order(sizes, column) > 1.9


@pytest.mark.parametrize("share", [0.2, 0.45, 0.7, 1.2])
def test_moments_beside_a_clamp(share, fitted_order):
    """At a share of an edge from the clamp, or beyond the first edge, of a planar rod."""
    rod, pull, turning = Rod(1.0, (1.0, 1.0), 0.7, STRETCHING), [0.0, 0.0, 4.0], [0.0, 0.5, 0.0]
    meshes = (80, 160, 320, 640)
    errors = []
    for edges in meshes:
        place = share / edges
        wrenches = [Wrench(place, moment=tuple(turning)), Wrench(1.0, tuple(pull))]
        end, _, frames = held_at_start(rod, wrenches)
        force = frames[1] @ pull
        loads = [
            {"point_force": {"rod": "rod", "at": "end", "force": force[:2].tolist()}},
            {"moment": {"rod": "rod", "at": place, "moment": turning[1]}},
        ]
        scene = straight_rod(edges, MODELS["planar"], model="planar", loads=loads)
        scene["rods"][0]["points"] = [point[:2] for point in scene["rods"][0]["points"]]
        values, result = measured(scene, ["start", "end"], QUANTITIES["planar"])
        bears = np.cross(end, force)[2] + turning[1]
        found = [*values[1, :2], result.reactions()[0].moment[-1], *values[0, 2:]]
        errors.append(np.array(found) - [*end[:2], -bears, bears, force[0]])
    sizes = [1.0 / edges for edges in meshes]
    for column in np.transpose(errors):
        assert fitted_order(sizes, column) > 1.9


def tensions(result: der.Result, places: list[tuple[float, bool]]) -> list[float]:
    """At places, or before them, where a field has two values, before the jump and after it."""
    samples, values = result.along("rod", "tension")
    found = []
    for place, before in places:
        here = np.flatnonzero(np.abs(samples - place) < 1e-9)
        if here.size:
            found.append(values[-1, here[0] if before else here[-1]])
        else:
            found.append(np.interp(place, samples, values[-1]))
    return found


def exact_tensions(
    rod: Rod, wrenches: list[Wrench], places: list[tuple[float, bool]]
) -> tuple[list[float], list[Array]]:
    """The tensions of a rod held at its start, and the forces of the wrenches in space [N]."""
    markers = [Wrench(place) for place, _ in places]
    _, _, frames = held_at_start(rod, [*wrenches, *markers])
    order = np.argsort([-wrench.s for wrench in [*wrenches, *markers]], kind="stable")[::-1]
    at = dict(zip(order.tolist(), frames, strict=True))
    forces = [at[i] @ wrench.force for i, wrench in enumerate(wrenches)]
    found = []
    for i, (place, before) in enumerate(places):
        beyond = [
            force
            for force, wrench in zip(forces, wrenches, strict=True)
            if wrench.s > place + 1e-12 or (before and abs(wrench.s - place) < 1e-12)
        ]
        found.append(float(np.sum(beyond, axis=0) @ at[len(wrenches) + i][:, 2]))
    return found, forces


#: Places of forces, from the first in numbers of edges: few middles of edges lie between two of
#: them, or between one and the clamp.
NEAR = {
    "in the first edge": (0.0, [0.2]),
    "before its middle": (0.0, [0.45]),
    "beyond its middle": (0.0, [0.55]),
    "far in the first edge": (0.0, [0.9]),
    "in the second edge": (0.0, [1.2]),
    "before its middle too": (0.0, [1.45]),
    "one edge apart": (0.5, [0.4, 1.4]),
    "about a middle": (0.5, [0.3, 0.7]),
    "on one side of a middle": (0.5, [0.1, 0.4]),
    "on the other side": (0.5, [0.6, 0.9]),
}


@pytest.mark.parametrize(("start", "shares"), NEAR.values(), ids=NEAR.keys())
@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_tension_between_places_close_to_one_another(model, start, shares, fitted_order):
    """Few middles of edges tell of the tension there: its slope is that of the forces across the
    rod, as it curves."""
    across = ACROSS if model == "spatial" else 0.0 * ACROSS
    given = [INNER + across, np.array([-4.0, 0.0, 0.0]) - across][: len(shares)]
    if len(shares) == 2 and shares[1] < 1.0:
        given[0] = given[0] * [1.0, 1.0, 0.0]  # forces along the rod in one edge are a known limit
    rod = Rod(1.0, (2.0, 1.0) if model == "spatial" else (1.0, 1.0), 0.7, STRETCHING)
    meshes = (40, 80, 160, 320)
    errors = []
    for edges in meshes:
        places = [start + share / edges for share in shares]
        wrenches = [Wrench(s, tuple(f)) for s, f in zip(places, given, strict=True)]
        wrenches.append(Wrench(1.0, tuple(TIP + across)))
        bounds = [start, *places, start + 2.0 / edges]
        told = [(place, before) for place in places for before in (True, False)]
        told += [(0.5 * (a + b), False) for a, b in pairwise(bounds)]
        if start == 0.0:
            told.append((0.0, False))
        expected, forces = exact_tensions(rod, wrenches, told)
        makers = scene_of(
            model,
            ("fixed",) * len(wrenches),
            (*places, 1.0),
            forces,
            [None] * len(wrenches),
        )
        result = der.run(der.Scenario.from_dict(makers(edges)))
        errors.append(np.array(tensions(result, told)) - expected)
    sizes = [1.0 / edges for edges in meshes]
    for column in np.transpose(errors):
        if np.max(np.abs(column) / np.square(sizes)) > 0.1:  # of tensions of 1 to 4
            assert fitted_order(sizes, column) > 1.9


def test_weight_between_a_clamp_and_a_force_close_to_it():
    """Tension of a rod that hangs is exactly what hangs below, wherever the force is."""
    for share in (0.3, 0.8, 1.0, 1.4, 1.7):
        loads = [
            {"gravity": [0.0, -10.0]},
            {"point_force": {"rod": "rod", "at": share / 10, "force": [0.0, -5.0]}},
        ]
        scene = straight_rod(10, MODELS["planar"], model="planar", loads=loads, analysis="static")
        scene["rods"][0]["points"] = [[0.0, -point[0]] for point in scene["rods"][0]["points"]]
        mass = scene["rods"][0]["cross_section"]["stiffness"]["mass_per_length"]
        places, found = der.run(der.Scenario.from_dict(scene)).along("rod", "tension")
        expected = mass * 10.0 * (1.0 - places) + 5.0 * (places < share / 10 - 1e-9)
        at = np.flatnonzero(np.abs(places - share / 10) < 1e-9)
        expected[at[0]] += 5.0
        assert found[-1] == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("share", [0.3, 0.51, 0.9, 1.0, 1.2])
def test_a_force_that_follows_near_the_end_of_a_naturally_curved_rod(share, fitted_order):
    """The outermost edge leans against the curve; the force does not, on either side of its
    middle. The rod is drawn straight."""
    rod = Rod(
        1.0,
        (1.0, 1.0),
        0.7,
        STRETCHING,
        natural=lambda s: np.stack([0.0 * s, CURVATURE + 0.0 * s, 0.0 * s]),
    )
    meshes = (40, 80, 160, 320)
    errors = []
    for edges in meshes:
        place = 1.0 - share / edges
        wrenches = [Wrench(place, tuple(INNER)), Wrench(1.0, tuple(TIP))]
        end, positions, frames = held_at_start(rod, wrenches)
        forces = [frames[0] @ INNER, frames[1] @ TIP]
        drawn = UPRIGHT @ INNER
        scene = scene_of(
            "planar", ("follower", "fixed"), (place, 1.0), [drawn, forces[1]], positions
        )(edges)
        scene["rods"][0]["natural_curvature"] = CURVATURE
        errors.append(errors_of(scene, end, positions, forces))
    sizes = [1.0 / edges for edges in meshes]
    for column in np.transpose(errors):
        assert fitted_order(sizes, column) > 1.9


@pytest.mark.parametrize("share", [0.2, 0.45, 0.51])
@pytest.mark.parametrize("torque", [-0.2, -2.0])
def test_a_force_that_follows_on_a_spring_beside_a_clamp_that_turns(share, torque, fitted_order):
    """The spring takes its part of the clamp's turn, too. It is given the stiffness that the
    moment which it exerts asks for."""
    turn = 1.0
    turned = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    rod = Rod(1.0, (1.0, 1.0), 0.7, STRETCHING)
    meshes = (40, 80, 160, 320)
    errors = []
    for edges in meshes:
        place = share / edges
        wrenches = [Wrench(place, tuple(INNER), (0.0, torque, 0.0)), Wrench(1.0, tuple(TIP))]
        end, positions, frames = held_at_start(rod, wrenches, start=turned @ UPRIGHT)
        forces = [frames[0] @ INNER, frames[1] @ TIP]
        tangent = frames[0][:, 2]
        stiffness = -torque / np.arctan2(tangent[1], tangent[0])
        drawn = UPRIGHT @ INNER
        scene = scene_of(
            "planar", ("follower", "fixed"), (place, 1.0), [drawn, forces[1]], positions
        )(edges)
        scene["supports"][0]["prescribe"] = {"angle": turn}
        spring = {"rotational_stiffness": stiffness}
        scene["supports"].append({"rod": "rod", "at": place, "spring": spring})
        values, result = measured(scene, ["end"], ("x", "y"))
        clamp = result.reactions()[0]
        found = [*values[0], *clamp.force[-1]]
        errors.append(np.array(found) - [*end[:2], *-sum(forces)[:2]])
    sizes = [1.0 / edges for edges in meshes]
    for column in np.transpose(errors):
        assert fitted_order(sizes, column) > 1.9
