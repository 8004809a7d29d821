"""Moment, curvature and energies of rods, at every kind of end and next to every kind of load.

Where the load is small the references are closed forms of beam theory, worked out here; pure
bending has closed forms at any load. Each case is read at its ends, at the nodes beside them, on
both sides of jumps, all along the arc and as the extremes along the rod.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import der
import numpy as np
import pytest
from der.fields import rod_fields
from scenes import END, START, straight
from scipy.integrate import quad

SIZES = [10, 30, 90]  # factors of 3 keep x.25 and x.5 edges where they are
SMALL = 1e-5  # a load that bends the beam so little that linear theory holds to rounding
PLACES = [0.013, 0.05, 0.21, 0.377, 0.5, 0.64, 0.83, 0.97, 0.995]
TIGHT = {"residual_tolerance": 1e-13, "step_tolerance": 1e-13}
PINNED = [{**START, "fix": ["x", "y"]}, {**END, "fix": ["y"]}]
CLAMPED = [{**START, "clamp": True}]


@dataclass
class Case:
    """A scene for every mesh, and what is exact of it."""

    scene: Callable[[int], dict]
    moment: Callable[[float], float]  # [N m] at arc length s of a rod of length 1 and EI = 1
    jumps: list[float] = field(default_factory=list)  # places of jumps
    kinks: list[float] = field(default_factory=list)
    natural: float = 0.0  # natural curvature [1/m]
    spring: float = 0.0  # energy of springs [J]

    @property
    def bend(self) -> float:
        """Energy of bending [J]."""
        ends = sorted({0.0, 1.0, *self.jumps, *self.kinks})
        pieces = pairwise(ends)
        return sum(quad(lambda s: self.moment(s) ** 2 / 2, a, b)[0] for a, b in pieces)


def scene_of(n, supports, loads, **rod):
    scene = straight(n, "free-free", 1e7, loads=loads, solver=TIGHT)
    scene["rods"][0] |= rod
    scene["supports"] = supports
    return scene


def moment_at(place, value):
    return {"moment": {"rod": "rod", "at": place, "moment": value}}


def force_at(place, *force):
    return {"point_force": {"rod": "rod", "at": place, "force": list(force)}}


def turning_spring(place, k):
    return {"rod": "rod", "at": place, "spring": {"rotational_stiffness": k}}


def pinned(s, a=None, turning=None, P=1.0, M=1.0):
    """Moment of a pinned beam under P down at a, and a moment M that turns it at `turning`."""
    bow = 0.0 if a is None else P * ((1 - a) * s if s < a else a * (1 - s))
    return bow + (0.0 if turning is None else M * (s - (s >= turning)))


def slope(s, a):
    """Slope of a pinned beam at s under a unit force down at a > s."""
    b = 1 - a
    return -b * (1 - b**2 - 3 * s**2) / 6


def with_spring(place, a, k, M):
    """Moment of spring and load M together on a pinned beam, and the rotation, at `place`."""
    X = (M - k * slope(place, a)) / (1 + k * (place**3 + (1 - place) ** 3) / 3)
    return X, (M - X) / k


def pinned_with_spring(place, at, k, M):
    a = 0.775
    X, turn = with_spring(place, a, k, M)
    loads = [force_at(a, 0, -SMALL)]
    if M:
        loads.append(moment_at(at, SMALL * M))
    return Case(
        lambda n: scene_of(n, [*PINNED, turning_spring(at, k)], loads),
        lambda s: SMALL * pinned(s, a, place, M=X),
        jumps=[place] if 0 < place < 1 else [],
        kinks=[a],
        spring=SMALL**2 * k * turn**2 / 2,
    )


def anchored(s, k):
    """A cantilever under a tip load on a spring between nodes."""
    F = k * s**2 * (3 - s) / 6 / (1 + k * s**3 / 3)
    spring = {"rod": "rod", "at": s, "spring": {"stiffness": [0, k]}}
    return Case(
        lambda n: scene_of(n, [*CLAMPED, spring], [force_at("end", 0, -SMALL)]),
        lambda x: SMALL * (F * max(s - x, 0.0) - (1 - x)),
        kinks=[s],
        spring=SMALL**2 * F**2 / (2 * k),
    )


def drawn(points, supports, loads):
    scene = scene_of(len(points) - 1, supports, loads)
    rod = scene["rods"][0]
    for key in ("nodes", "from", "to"):
        del rod[key]
    rod["points"] = np.asarray(points).tolist()
    return scene


def drawn_arc(n, radius=0.7):
    angle = np.linspace(0, 1 / radius, n + 1)
    points = radius * np.column_stack([np.sin(angle), 1 - np.cos(angle)])
    return drawn(points, CLAMPED, [moment_at("end", 0.8)])


def uneven(n):
    s = np.linspace(0, 1, n + 1)
    s = s + 0.08 * np.sin(2 * np.pi * s)
    loads = [moment_at("start", -SMALL), moment_at(0.4444, SMALL)]
    return drawn(np.column_stack([s, 0 * s]), PINNED, loads)


CLAMP_MIDDLE = [{"rod": "rod", "at": "middle", "clamp": True}]
CASES = {
    "end moment": Case(lambda n: scene_of(n, CLAMPED, [moment_at("end", 1.0)]), lambda s: 1.0),
    "start moment": Case(
        lambda n: scene_of(n, [{**END, "clamp": True}], [moment_at("start", 1.0)]), lambda s: -1.0
    ),
    "roll-up": Case(
        lambda n: scene_of(n, CLAMPED, [moment_at("end", 2 * np.pi)]), lambda s: 2 * np.pi
    ),
    "end moment, tangent": Case(
        lambda n: scene_of(n, CLAMPED, [moment_at("end", 2.0)], curvature="tangent"), lambda s: 2.0
    ),
    "natural curvature": Case(
        lambda n: scene_of(n, CLAMPED, [], natural_curvature=2.0), lambda s: 0.0, natural=2.0
    ),
    "natural curvature and end moment": Case(
        lambda n: scene_of(n, CLAMPED, [moment_at("end", 0.5)], natural_curvature=2.0),
        lambda s: 0.5,
        natural=2.0,
    ),
    "drawn arc": Case(drawn_arc, lambda s: 0.8, natural=1 / 0.7),
    "tip force": Case(
        lambda n: scene_of(n, CLAMPED, [force_at("end", 0, -SMALL)]), lambda s: -SMALL * (1 - s)
    ),
    "force between nodes": Case(
        lambda n: scene_of(n, CLAMPED, [force_at(0.625, 0, -SMALL)]),
        lambda s: -SMALL * max(0.625 - s, 0.0),
        kinks=[0.625],
    ),
    "force beside a clamp": Case(
        lambda n: scene_of(n, CLAMPED, [force_at(0.025, 0, -SMALL), force_at("end", 0, SMALL)]),
        lambda s: -SMALL * max(0.025 - s, 0.0) + SMALL * (1 - s),
        kinks=[0.025],
    ),
    "force at a node": Case(
        lambda n: scene_of(n, PINNED, [force_at(0.25, 0, -SMALL)]),
        lambda s: SMALL * pinned(s, 0.25),
        kinks=[0.25],
    ),
    "pinned, start moment": Case(
        lambda n: scene_of(n, PINNED, [moment_at("start", -SMALL)]), lambda s: SMALL * (1 - s)
    ),
    "pinned, end moment": Case(
        lambda n: scene_of(n, PINNED, [moment_at("end", SMALL)]), lambda s: SMALL * s
    ),
    "interior moment": Case(
        lambda n: scene_of(n, PINNED, [moment_at(0.325, SMALL)]),
        lambda s: SMALL * pinned(s, turning=0.325),
        jumps=[0.325],
    ),
    "moment at a node": Case(
        lambda n: scene_of(n, PINNED, [moment_at("middle", SMALL)]),
        lambda s: SMALL * pinned(s, turning=0.5),
        jumps=[0.5],
    ),
    "uneven mesh": Case(
        uneven,
        lambda s: SMALL * (1 - s + pinned(s, turning=0.4444)),
        jumps=[0.4444],
    ),
    "spring at the start": pinned_with_spring(0.0, "start", 7.0, 0.0),
    "spring and moment at the start": pinned_with_spring(0.0, "start", 7.0, 0.6),
    "interior spring": pinned_with_spring(0.325, 0.325, 5.0, 0.0),
    "interior spring and moment": pinned_with_spring(0.325, 0.325, 5.0, -0.4),
    "spring to an anchor between nodes": anchored(0.625, 50.0),
    "interior clamp": Case(
        lambda n: scene_of(
            n,
            CLAMP_MIDDLE,
            [force_at("end", 0, -SMALL), force_at("start", 0, -3 * SMALL)],
        ),
        lambda s: -SMALL * (1 - s) if s >= 0.5 else -3 * SMALL * s,
        jumps=[0.5],
    ),
    "force across an interior clamp": Case(
        lambda n: scene_of(
            n,
            CLAMP_MIDDLE,
            [force_at("end", 0, -SMALL), force_at(0.475, 0, -3 * SMALL)],
        ),
        lambda s: -SMALL * (1 - s) if s >= 0.5 else -3 * SMALL * max(s - 0.475, 0.0),
        jumps=[0.5],
        kinks=[0.475],
    ),
}


def probes_of(case):
    """By name: the probe, and what is exact."""
    around = 1e-9  # to either side of a jump
    found = {}
    places = [("start", 0.0), ("end", 1.0), *((s, s) for s in PLACES)]
    for at, s in places:
        if min((abs(s - jump) for jump in case.jumps), default=1.0) > around:
            found[f"at_{at}"] = ({"at": at}, case.moment(s))
    for i, s in enumerate(case.jumps):
        found[f"before_{i}"] = ({"at": s, "side": "before"}, case.moment(s - around))
        found[f"after_{i}"] = ({"at": s, "side": "after"}, case.moment(s + around))
        found[f"default_{i}"] = ({"at": s}, case.moment(s + around))
    grid = np.linspace(0, 1, 2001)
    sides = [s + d for s in (*case.jumps, *case.kinks) for d in (-around, around)]
    every = [case.moment(s) for s in (*grid, *sides)]
    for reduce, extreme in (("min", min(every)), ("max", max(every))):
        found[reduce] = ({"over": "rod", "reduce": reduce}, extreme)
    return found


def solved(case, n):
    """The results of a mesh, with errors of moment, curvature and energies."""
    scene = case.scene(n)
    probes = {}
    for name, (where, _) in probes_of(case).items():
        name = name.replace(".", "_")
        for quantity in ("moment", "curvature"):
            probes[f"{quantity}_{name}"] = {"rod": "rod", "quantity": quantity, **where}
    for node in (1, -2):
        probes[f"node_{node}".replace("-", "_")] = {
            "rod": "rod",
            "quantity": "moment",
            "at": {"node": node},
        }
    for term in ("bend", "spring"):
        probes[f"{term}_energy"] = {"quantity": f"{term}_energy", "rod": "rod"}
    scene["output"] = {"probes": probes}
    return der.run(scene)


@pytest.mark.parametrize("name", CASES)
def test_moment_and_curvature_are_of_second_order_everywhere(name, fitted_order):
    case = CASES[name]
    scale = max(abs(case.moment(s)) for s in np.linspace(0, 1, 101)) or 1.0
    errors = []
    for n in SIZES:
        result = solved(case, n)
        largest = 0.0
        for probe, (_, exact) in probes_of(case).items():
            probe = probe.replace(".", "_")
            moment = result.probes[f"moment_{probe}"][-1]
            curvature = result.probes[f"curvature_{probe}"][-1]
            largest = max(largest, abs(moment - exact), abs(curvature - exact - case.natural))
        arc_length = der.Model(result.scenario).rods[0].arc_lengths
        for node, probe in ((1, "node_1"), (-2, "node__2")):
            exact = case.moment(arc_length[node])
            largest = max(largest, abs(result.probes[probe][-1] - exact))
        errors.append(largest / scale)
    if max(errors) > 1e-6:
        assert errors[-1] < 2e-2
        assert fitted_order([1 / n for n in SIZES], errors) > 1.9, errors


# Not the force in the clamp's first edge: from mesh to mesh it stands in another cell.
@pytest.mark.parametrize("name", [name for name in CASES if name != "force beside a clamp"])
def test_energies_are_of_second_order(name, fitted_order):
    case = CASES[name]
    exact = {"bend": case.bend, "spring": case.spring}
    errors = []
    for n in SIZES:
        result = solved(case, n)
        found = {term: result.energies[term][-1] for term in exact}
        for term, value in found.items():
            probe = result.probes[f"{term}_energy"][-1]
            assert probe == pytest.approx(value, rel=1e-12, abs=1e-300)
        errors.append(
            max(abs(found[term] - value) / (value or 1.0) for term, value in exact.items())
        )
    if max(errors) > 1e-6:
        assert errors[-1] < 2e-2
        assert fitted_order([1 / n for n in SIZES], errors) > 1.9, errors


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("case", ["end moment", "start moment", "natural curvature"])
def test_the_coarsest_meshes_bend_purely(n, case):
    """A moment that is the same everywhere is so on any mesh, however few nodes it has."""
    found = solved(CASES[case], n)
    for probe, (_, exact) in probes_of(CASES[case]).items():
        moment = found.probes[f"moment_{probe.replace('.', '_')}"][-1]
        assert moment == pytest.approx(exact, abs=1e-8)


def test_a_rod_of_one_edge_has_the_moments_of_its_ends():
    scene = scene_of(1, PINNED, [moment_at("start", -2e-5), moment_at("end", 1e-5)])
    places, moment = der.run(scene).along("rod", "moment")
    assert places == pytest.approx([0, 1])
    assert moment[-1] == pytest.approx([2e-5, 1e-5])


def test_along_has_a_jump_twice_and_a_kink_once():
    loads = [moment_at("middle", SMALL), moment_at(0.33, SMALL), force_at(0.78, 0, -SMALL)]
    result = der.run(scene_of(10, PINNED, loads))
    places, moment = result.along("rod", "moment")
    nodes = [k / 10 for k in range(11)]
    assert places == pytest.approx(sorted([*nodes, 0.5, 0.33, 0.33, 0.78]))
    for place in (0.33, 0.5):
        (before, after) = moment[-1, np.isclose(places, place)]
        assert before - after == pytest.approx(SMALL, rel=1e-8)
    fields = rod_fields(result)[0]
    assert fields.at_nodes["curvature"][-1, 5] == pytest.approx(
        moment[-1][np.isclose(places, 0.5)][1]
    )


def test_clamped_ends_and_the_nodes_beside_them_have_the_curvature_of_a_drawn_arc(fitted_order):
    """Its cells turn by other angles than those of a rod that is naturally so curved."""
    errors = []
    for n in SIZES:
        angle = np.linspace(0, 1.2, n + 1)
        points = np.column_stack([np.sin(angle), 1 - np.cos(angle)])
        supports = [{**START, "clamp": True}, {**END, "clamp": True}]
        result = der.run(drawn(points, supports, []))
        errors.append(np.abs(result.along("rod", "curvature")[1][-1] - 1).max())
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9


def test_a_moment_that_grows_does_the_work_of_its_tangent():
    """Slowly, so that its work is the energy of the rod, M^2 L / 2 EI."""
    scene = scene_of(10, CLAMPED, [moment_at("end", {"times": [0, 20], "values": [0, 1.0]})])
    del scene["analysis"]
    scene["loads"].append({"damping": {"coefficient": 1.0}})
    scene["time"] = {"duration": 20.0, "step": 0.1, "integrator": "tr_bdf2"}
    result = der.run(scene)
    assert result.energies["bend"][-1] == pytest.approx(0.5, rel=2e-2)
    # All of the energy comes from the work; the rest is what the time stepping takes.
    stored = sum(energy[-1] for energy in result.energies.values())
    assert result.work["loads"][-1] - result.work["drag"][-1] == pytest.approx(stored, rel=2e-5)
    quick = {**scene, "time": {"duration": 20.0, "tolerance": 1e-3}}
    adaptive = der.run(quick)
    assert adaptive.work["loads"][-1] == pytest.approx(result.work["loads"][-1], rel=1e-3)
    assert np.abs(adaptive.work["numerical"]).max() < 1e-3


def test_a_moment_and_a_spring_that_change_leave_no_loss(fitted_order):
    """The energies of the cells, and the work that the moments do on them, keep the ledger."""
    losses = []
    steps = [4e-3, 2e-3, 1e-3]
    for step in steps:
        swinging = {"times": [0, 0.2, 0.4], "values": [0, 0.3, -0.2]}
        supports = [*PINNED, turning_spring("start", 5.0)]
        scene = scene_of(8, supports, [moment_at("start", swinging)])
        scene["rods"][0]["cross_section"]["stiffness"]["EA"] = 1e3
        del scene["analysis"]
        scene["time"] = {"duration": 0.4, "step": step, "integrator": "tr_bdf2"}
        result = der.run(scene)
        losses.append(np.abs(result.work["numerical"]).max())
    assert fitted_order(steps, losses) > 1.9


@pytest.mark.parametrize(
    "name", ["end moment", "roll-up", "pinned, end moment", "spring and moment at the start"]
)
def test_the_bars_of_verify_hold_the_truth(name):
    case = CASES[name]
    scene = case.scene(20)
    largest = {"rod": "rod", "quantity": "moment", "over": "rod", "reduce": "max"}
    scene["output"] = {
        "probes": {
            "largest": largest,
            "start": {"rod": "rod", "quantity": "moment", "at": "start"},
            "end": {"rod": "rod", "quantity": "moment", "at": "end"},
            "bend": {"quantity": "bend_energy"},
        }
    }
    found = der.verify(scene)
    grid = np.linspace(0, 1, 20001)
    exact = {
        "largest": max(case.moment(s) for s in grid),
        "start": case.moment(0.0),
        "end": case.moment(1.0),
        "bend": case.bend,
    }
    for probe, truth in exact.items():
        value = found[probe]
        assert abs(value.value - truth) <= value.error_bar + 1e-7 * abs(truth), probe
