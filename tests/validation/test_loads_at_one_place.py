"""Loads that follow, at places where the edges beside them do not tell how the section lies: other
moments act there, springs against turning hold it, the rod has a corner, or a clamp is near.

The reference is `references/section_loads.py`. It is given what acts in the axes of each section,
in which `Case` has all its vectors. What springs exert there is a part of the moment of a fixed
direction, whose rest is the load of the scene.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from references.kirchhoff_rod import Rod
from references.section_loads import Wrench, held_at_start
from scipy.spatial.transform import Rotation
from spatial_scenes import CLAMPED, measured, rod_through, section

STRONG, WEAK, TWISTING, STRETCHING = 1.0, 0.3, 0.25, 2e3
STRIP = section([0, 1, 0], EA=STRETCHING, EI1=WEAK, EI2=STRONG, GJ=TWISTING)
ROD = Rod(1.0, (STRONG, WEAK), TWISTING, STRETCHING)  # the rates of turning about d1 and d2
DRAWN = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], dtype=float)  # d1 = y, d2 = z, d3 = x
CORNER = Rotation.from_rotvec([0.4, 1.2, 0.0]).as_matrix()
NONE = (0.0, 0.0, 0.0)
FORCE, MOMENT, OTHER = (1.0, 2.0, 0.3), (0.6, 1.0, 0.3), (0.5, -1.0, 0.8)
SIZES = (40, 80, 160)


@dataclass
class Case:
    """The loads at a share of the length that may depend on the number of edges, and at the end."""

    force: tuple[float, float, float] = NONE  # follows
    moment: tuple[float, float, float] = NONE  # follows
    fixed: tuple[float, float, float] = NONE
    spring: float = 0.0
    corner: bool = False
    share: float = 0.5
    edges_on: float = 0.0
    tip: tuple[float, float, float] = NONE  # a force of a fixed direction
    natural: tuple[float, float, float] = NONE  # curvatures towards d1, d2 and twist beyond it
    longer: float = 1.0  # edges beyond the place, against those before it
    actuated: bool = False  # whether an actuation gives the natural shape

    def place(self, edges):
        return self.share + self.edges_on / edges


#: Of a rod that is drawn straight: its natural shape jumps at the node of the place.
JUMP = {"natural": (2.0, -1.5, 1.2)}
CASES = {
    "force and fixed moment": Case(FORCE, fixed=OTHER),
    "moment and fixed moment": Case(moment=MOMENT, fixed=OTHER),
    "between two nodes": Case(FORCE, MOMENT, OTHER, edges_on=0.3),
    "force on a spring": Case(FORCE, spring=3.0, fixed=OTHER),
    "moments on a spring": Case(moment=MOMENT, fixed=OTHER, spring=3.0),
    "at the end": Case((0.3, 0.6, 0.1), (0.2, 0.3, 0.1), (0.2, -0.4, 0.3), share=1.0),
    "force at a corner": Case(FORCE, corner=True),
    "all at a corner": Case(FORCE, MOMENT, OTHER, corner=True),
    "beside the clamp": Case(
        FORCE, (1.5, 2.0, 1.0), OTHER, share=0.0, edges_on=0.3, tip=(0.3, -0.5, 0.2)
    ),
    "moment alone beside the clamp": Case(
        moment=(1.5, 2.0, 1.0), share=0.0, edges_on=0.3, tip=(0.3, -0.5, 0.2)
    ),
    "force at a natural jump": Case(FORCE, **JUMP),
    "moment at a natural jump": Case(moment=MOMENT, **JUMP, tip=(0.3, -0.5, 0.2)),
    "spring at a natural jump": Case(fixed=OTHER, spring=3.0, **JUMP),
    "all at a natural jump of longer edges": Case(
        FORCE, MOMENT, OTHER, spring=3.0, share=0.4, longer=1.5, **JUMP
    ),
    "all on a spring where an actuation begins": Case(
        FORCE, MOMENT, OTHER, spring=3.0, actuated=True, **JUMP
    ),
    "force at an actuated corner": Case(FORCE, corner=True, actuated=True, **JUMP),
    "all at an actuated corner": Case(FORCE, MOMENT, OTHER, corner=True, actuated=True, **JUMP),
    "all within an edge where an actuation begins": Case(
        FORCE, MOMENT, OTHER, edges_on=0.3, actuated=True, **JUMP
    ),
}


def spring_moment(k, frame):
    """Of 1/2 k (swing^2 + twist^2), exerted on a section with this frame (docs/space.md)."""
    before, now = DRAWN[:, 2], frame[:, 2]
    axis = np.cross(before, now)
    cosine = before @ now
    swing = np.arctan2(np.linalg.norm(axis), cosine) * axis / np.linalg.norm(axis)
    moved = Rotation.from_rotvec(swing).apply(DRAWN[:, 0])
    twist = np.arctan2(np.cross(moved, frame[:, 0]) @ now, moved @ frame[:, 0])
    return -k * (swing + twist * (before + now) / (1.0 + cosine))


def naturally_bent(case, edges):
    """Nodes of a straight rod whose edges beyond the place are longer, and the natural shape there:
    at the node of the jump the mean of its cell, towards which longer edges count more."""
    before = round(edges * case.share * case.longer / (1 + case.share * (case.longer - 1)))
    x = np.concatenate(
        [np.linspace(0, case.share, before + 1), np.linspace(case.share, 1, edges - before + 1)[1:]]
    )
    shares = np.repeat([0.0, 1.0], [before, edges - before + 1])
    after, mean = x[before + 1] - x[before], 0.5 * (x[before + 1] - x[before - 1])
    shares[before] = 0.5 * after / mean
    return x[:, None] * DRAWN[:, 2], shares[:, None] * case.natural


def scene_and_tip(case, edges):
    place = case.place(edges)
    total = np.add(case.moment, case.fixed)
    corner = CORNER if case.corner else np.eye(3)
    wrenches = [Wrench(place, case.force, tuple(total), corner)]
    if place < ROD.length:
        wrenches.append(Wrench(ROD.length, case.tip))
    towards_1, towards_2, twist = case.natural

    def natural(s):
        return np.array([[-towards_2], [towards_1], [twist]]) * (np.asarray(s) >= place)

    tip, _, frames = held_at_start(replace(ROD, natural=natural), wrenches, DRAWN)
    fixed = frames[0] @ case.fixed - spring_moment(case.spring, frames[0]) * bool(case.spring)

    nodes = np.linspace(0, 1, edges + 1)[:, None] * DRAWN[:, 2]
    rod = {}
    if case.actuated:
        beyond = {"rod": "rod", "from": place}
        rod["actuation"] = [
            {**beyond, "name": "bend", "natural_curvature": [towards_1, towards_2]},
            {**beyond, "name": "turn", "natural_twist": twist},
        ]
    elif case.natural != NONE:
        nodes, shape = naturally_bent(case, edges)
        curvatures, twist = shape[:, :2].tolist(), shape[:, 2].tolist()
        rod = {"rod": {"natural_curvature": curvatures, "natural_twist": twist}}
    if case.corner:
        beyond = np.maximum(nodes[:, 0] - place, 0)[:, None]
        nodes = np.minimum(nodes, place) + beyond * (DRAWN @ CORNER)[:, 2]
    at = {"rod": "rod", "at": place}
    loads = [
        {"point_force": {**at, "force": (DRAWN @ case.force).tolist(), "follower": True}},
        {"moment": {**at, "moment": (DRAWN @ case.moment).tolist(), "follower": True}},
        {"moment": {**at, "moment": fixed.tolist()}},
        {"point_force": {"rod": "rod", "at": "end", "force": (frames[-1] @ case.tip).tolist()}},
    ]
    acting = [load for load in loads if any(v for kind in load.values() for v in amount(kind))]
    springs = [{**at, "spring": {"rotational_stiffness": case.spring}}] if case.spring else []
    return rod_through(nodes, STRIP, supports=[*CLAMPED, *springs], loads=acting, **rod), tip


def amount(load):
    return load.get("force") or load.get("moment")


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_end_of_the_rod(case, fitted_order):
    errors = []
    for edges in SIZES:
        scene, tip = scene_and_tip(case, edges)
        values, _ = measured(scene, ["end"], ("x", "y", "z"))
        errors.append(np.linalg.norm(values[0] - tip))
    # The rod turns by some 2 rad, of which order 1 would leave a share of 1/edges.
    assert errors[0] < 2.0 / SIZES[0] ** 2
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9


@pytest.mark.parametrize("place", ["end", 0.5, 0.4813])
def test_two_parts_of_a_moment_store_what_the_whole_does(place):
    """The rod beside the place bends under both, by more than each of them stores."""
    whole = np.array([0.8, 0.5, -1.0])
    gaps = []
    for edges in SIZES:
        bend = []
        for parts in [(1.0,), (0.3, 0.7)]:
            loads = [
                {"moment": {"rod": "rod", "at": place, "moment": (part * whole).tolist()}}
                for part in parts
            ]
            nodes = np.linspace([0, 0, 0], [1, 0, 0], edges + 1)
            _, result = measured(rod_through(nodes, STRIP, loads=loads), ["end"], ("x",))
            bend.append(result.energies["bend"][-1])
        gaps.append(abs(bend[1] / bend[0] - 1))
    # Where its share of an edge changes, a bound tells the order: what both store besides their
    # own is a share of 0.2/edges.
    assert np.all(np.array(gaps) < 0.15 / np.array(SIZES) ** 2)


@pytest.mark.parametrize("turns", [0.4565, 1.4565])
def test_a_rod_that_spins_past_half_a_turn_at_a_corner(turns):
    """A section at a corner has no drawn one from which turns would count: a rod that its clamp
    turns has the shape of one that is not, turned. Half a turn away from the drawn sections lies
    between those of the two edges there, one of which seemed to be a whole turn from the other."""
    scene, _ = scene_and_tip(CASES["all at a corner"], 20)
    follower = [load for load in scene["loads"] if next(iter(load.values())).get("follower")]
    shapes = []
    for twist in (0.0, 2 * np.pi * turns):
        support = {**CLAMPED[0], "prescribe": {"twist": twist}}
        moved, _ = measured(
            {**scene, "supports": [support], "loads": follower}, ["end"], ("x", "y", "z")
        )
        shapes.append(moved[0])
    turned = Rotation.from_rotvec([2 * np.pi * turns, 0.0, 0.0]).apply(shapes[0])
    assert np.allclose(turned, shapes[1], atol=1e-9)


#: Places in edges from an end, and what acts there beside the force that follows.
PLACES = {"inside": (0.5, 0.0), "beside the clamp": (0.0, 0.3), "beside the end": (1.0, -0.3)}
BESIDE = {"nothing": (0.0, 0.0), "moment": (1.0, 0.0), "spring": (0.0, 3.0), "both": (1.0, 3.0)}


@pytest.mark.parametrize("beside", BESIDE.values(), ids=BESIDE)
@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_a_force_that_follows_a_planar_rod_turns_with_its_tangent(fitted_order, place, beside):
    """The tangent turns further than the edges beside it under a moment, less on a spring, and by a
    part of an edge's turn beside a clamp."""
    force, (moment, spring) = 2.0, beside  # across the rod, and all that turns it at the place
    rod = Rod(1.0, (1.0, 1.0), 1.0, 1e6)
    errors = []
    for edges in SIZES:
        s = place[0] + place[1] / edges
        end = Wrench(1.0, (0.4, 0.0, 0.3))
        wrenches = [Wrench(s, (force, 0.0, 0.0), (0.0, moment, 0.0)), end]
        tip, _, frames = held_at_start(rod, wrenches, DRAWN)
        turned = np.arctan2(frames[0][1, 2], frames[0][0, 2])
        fixed = frames[1] @ end.force
        here = {"rod": "rod", "at": s}
        loads = [
            {"point_force": {**here, "force": [0.0, force], "follower": True}},
            {"moment": {**here, "moment": moment + spring * turned}},
            {"point_force": {"rod": "rod", "at": "end", "force": fixed[:2].tolist()}},
        ]
        springs = [{**here, "spring": {"rotational_stiffness": spring}}] if spring else []
        nodes = np.column_stack([np.linspace(0, 1, edges + 1), np.zeros(edges + 1)])
        scene = rod_through(nodes, section(EI=1.0), [*CLAMPED, *springs], loads=loads)
        values, result = measured({**scene, "model": "planar"}, ["end"], ("x", "y"))
        held = result.reactions()[0].force[-1][:2] + fixed[:2] + force * frames[0][:2, 0]
        errors.append([np.linalg.norm(values[0] - tip[:2]), np.linalg.norm(held)])
    worst = np.array(errors).T
    assert (worst[:, 0] < 4.0 / SIZES[0] ** 2).all()
    for error in worst:
        assert fitted_order([1 / n for n in SIZES], error) > 1.9
