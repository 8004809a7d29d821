"""Planar rods whose rest shape is changed on parts of them: equilibria, folds and frequencies.

References: the curve of given curvature, by Gauss quadrature; `references/actuated_rod.py`, the
boundary value problem of the extensible elastica with a rest shape; thermal buckling by hand.
"""

import math
import warnings
from itertools import pairwise

import der
import numpy as np
import pytest
from actuated import PROFILES, bend, probed, stretch
from references.actuated_rod import (
    ANGLE,
    MOMENT,
    Segment,
    X,
    Y,
    clamped,
    pinned,
    pulled,
    rod_slopes,
    solve,
)
from scenes import END, START, straight, tip_force
from scipy.integrate import solve_bvp
from spatial_scenes import critical

CURVATURE = 2.5
FROM, TO = 0.313, 0.777
SIZES = [20, 40, 80]
STEPS = [1 / n for n in SIZES]
#: Meshes on which the thirds, the ninths and the middle lie at the same part of their edges.
ALIKE = [74, 146, 290]
ALIKE_STEPS = [1 / n for n in ALIKE]


def profile_curvature(profile, start, end):
    """The curvature at arc lengths of the stretch."""
    return lambda s: CURVATURE * PROFILES[profile]((s - start) / (end - start))


def drawn_by(curvature, start, end, length=1.0):
    """Position at the end of the curve that is straight but for a stretch, from the origin on.

    Gauss quadrature of cos and sin of the tangent's angle, itself by quadrature.
    """
    nodes, weights = np.polynomial.legendre.leggauss(30)
    nodes, weights = (nodes + 1) / 2, weights / 2

    def angle(s):
        return (s - start) * weights @ curvature(start + (s - start) * nodes)

    angles = np.array([angle(start + (end - start) * u) for u in nodes])
    tangents = np.column_stack([np.cos(angles), np.sin(angles)])
    last = angle(end)
    straight_part = np.array([np.cos(last), np.sin(last)]) * (length - end)
    return np.array([start, 0.0]) + (end - start) * weights @ tangents + straight_part


def elastic_energy(scene):
    return sum(der.run(scene).summary["energies"][name] for name in ("stretch", "bend", "spring"))


@pytest.mark.parametrize("edges", [1, 2, 10, 160])
def test_curvature_of_the_whole_rod_needs_no_energy(edges):
    whole = {"name": "bend", "rod": "rod", "natural_curvature": CURVATURE}
    scene = straight(edges, "clamped-free", 1e4, actuation=[whole])
    assert elastic_energy(scene) < 1e-20
    values = probed(scene, [(0.0, "after"), (0.437, "after"), (1.0, "before")], ["curvature"])
    assert values == pytest.approx(CURVATURE, rel=1e-9)


def test_curvature_of_the_whole_rod_makes_an_arc(fitted_order):
    exact = np.array([np.sin(CURVATURE), 1 - np.cos(CURVATURE)]) / CURVATURE
    errors = []
    for n in SIZES:
        scene = straight(n, "clamped-free", 1e4, actuation=[bend(CURVATURE, 0.0, 1.0)])
        errors.append(np.linalg.norm(der.equilibrium(scene).positions[-1, -1] - exact))
    assert fitted_order(STEPS, errors) > 1.9
    # A polygon with the curve's turning angles is smaller by (k h)^2/24.
    assert errors[-1] < (CURVATURE * STEPS[-1]) ** 2 / 12


#: A long stretch, two short ones, the second within an edge of all meshes, and ones at the ends.
LONG = [(FROM, TO), (0.0, TO), (0.004, TO), (FROM, 1.0)]
STRETCHES = [*LONG, (0.49, 0.52), (0.503, 0.511)]


def sides(start, end):
    """Both sides of the borders of a stretch within a rod of length 1."""
    inside = [(start, "after"), (end, "before")]
    beyond = [(start, "before")] * (start > 0.0) + [(end, "after")] * (end < 1.0)
    return inside, beyond


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("ends", STRETCHES)
def test_actuated_part(fitted_order, ends, profile):
    """The exact shape, without stress, wherever the stretch ends."""
    curvature = profile_curvature(profile, *ends)
    exact = drawn_by(curvature, *ends)
    inside, beyond = sides(*ends)
    truth = [*(curvature(s) for s, _ in inside), *(0.0 for _ in beyond)]
    errors = []
    for n in SIZES:
        actuation = bend(CURVATURE, *ends, profile=profile)
        scene = straight(n, "clamped-free", 1e4, actuation=[actuation])
        errors.append(np.linalg.norm(der.equilibrium(scene).positions[-1, -1] - exact))
        values = probed(scene, inside + beyond, ["curvature", "moment", "tension"])
        assert values[:, 0] == pytest.approx(np.array(truth), abs=1e-9)
        assert np.abs(values[:, 1:]).max() < 1e-8
        assert elastic_energy(scene) < 1e-20
    # The tangent is off by h^2/8 of the change of its direction, here over all that is actuated.
    turn = CURVATURE * (ends[1] - ends[0])
    assert (errors < turn * np.square(STEPS) / 4).all()
    if ends in LONG:
        assert fitted_order(STEPS, errors) > 1.9


@pytest.mark.parametrize("profile", ["constant", "linear"])
@pytest.mark.parametrize("ends", STRETCHES)
def test_curvature_along_an_actuated_part(ends, profile):
    """At every sample, with both sides of the jumps."""
    curvature = profile_curvature(profile, *ends)
    scene = straight(20, "clamped-free", 1e4, actuation=[bend(CURVATURE, *ends, profile=profile)])
    result = der.run(scene)
    places, values = result.along("rod", "curvature")
    expected = np.where((places > ends[0]) & (places < ends[1]), curvature(places), 0.0)
    at_border = np.min(np.abs(places[:, None] - ends), axis=1) < 1e-9
    assert values[-1, ~at_border] == pytest.approx(expected[~at_border], abs=1e-9)
    inside, beyond = sides(*ends)
    for border in ends:
        found = values[-1, np.abs(places - border) < 1e-9]
        truth = [curvature(s) for s, _ in inside if s == border]
        truth += [0.0 for s, _ in beyond if s == border]
        assert np.unique(found.round(8)) == pytest.approx(np.unique(truth), abs=1e-8)
    _, moments = result.along("rod", "moment")
    assert np.abs(moments).max() < 1e-8


def test_actuations_add_up():
    """Parts that overlap are the parts of their sum."""
    parts = [bend(1.5, 0.1, 0.6, "a"), bend(-0.7, 0.35, 0.9, "b"), bend(0.4, 0.35, 0.9, "c")]
    whole = [bend(1.5, 0.1, 0.35, "a"), bend(1.2, 0.35, 0.6, "b"), bend(-0.3, 0.6, 0.9, "c")]
    shapes = [
        der.equilibrium(
            straight(23, "clamped-free", 1e4, actuation=actuation, loads=tip_force(0.3, 0.8))
        ).positions[-1]
        for actuation in (parts, whole)
    ]
    assert shapes[0] == pytest.approx(shapes[1], abs=1e-11)


@pytest.mark.parametrize("own", ["given", "drawn"])
def test_actuation_adds_to_the_curvature_that_the_rod_has(fitted_order, own):
    """The arc of the sum."""
    curved = 0.8
    exact = np.array([np.sin(CURVATURE), 1 - np.cos(CURVATURE)]) / CURVATURE
    errors = []
    for n in SIZES:
        scene = straight(n, "clamped-free", 1e4)
        section = scene["rods"][0]["cross_section"]
        if own == "given":
            scene["rods"][0]["natural_curvature"] = curved
        else:
            angle = curved * np.linspace(0, 1, n + 1)
            arc = np.column_stack([np.sin(angle), 1 - np.cos(angle)]) / curved
            scene["rods"][0] = {"name": "rod", "points": arc.tolist(), "cross_section": section}
        scene["actuation"] = [
            {"name": "bend", "rod": "rod", "natural_curvature": CURVATURE - curved}
        ]
        errors.append(np.linalg.norm(der.equilibrium(scene).positions[-1, -1] - exact))
    assert fitted_order(STEPS, errors) > 1.9


@pytest.mark.parametrize("change", ["clamp", "curvature"])
def test_other_laws_of_clamps_and_joints(fitted_order, change):
    """`clamp: tangent` and `curvature: tangent`: the same shape, without energy too."""
    ends = (0.0, 7 / 9)
    exact = drawn_by(profile_curvature("constant", *ends), *ends)
    errors = []
    for n in ALIKE:
        scene = straight(n, "clamped-free", 1e4, actuation=[bend(CURVATURE, *ends)])
        if change == "clamp":
            scene["supports"] = [{**START, "clamp": "tangent"}]
        else:
            scene["rods"][0]["curvature"] = "tangent"
        errors.append(np.linalg.norm(der.equilibrium(scene).positions[-1, -1] - exact))
        assert elastic_energy(scene) < 1e-20
    assert fitted_order(ALIKE_STEPS, errors) > 1.9


@pytest.mark.parametrize("ends", [(1 / 3, 7 / 9), (0.5, 7 / 9), (0.0, 1.0)])
def test_actuated_part_about_a_drawn_corner(fitted_order, ends):
    """A right angle in the middle of the rod; the turns of corner and actuation add up."""
    nodes, weights = np.polynomial.legendre.leggauss(30)
    exact = np.zeros(2)
    for a, b in pairwise(np.unique([0.0, *ends, 0.5, 1.0])):
        s = a + (b - a) * (nodes + 1) / 2
        angle = np.pi / 2 * (s > 0.5) + CURVATURE * (np.clip(s, *ends) - ends[0])
        exact += (b - a) / 2 * np.array([weights @ np.cos(angle), weights @ np.sin(angle)])
    errors = []
    for n in ALIKE:
        scene = straight(n, "clamped-free", 1e4, actuation=[bend(CURVATURE, *ends)])
        legs = np.linspace(0.0, 0.5, n // 2 + 1)
        points = [[s, 0.0] for s in legs] + [[0.5, s] for s in legs[1:]]
        section = scene["rods"][0]["cross_section"]
        scene["rods"][0] = {"name": "rod", "points": points, "cross_section": section}
        errors.append(np.linalg.norm(der.equilibrium(scene).positions[-1, -1] - exact))
        assert elastic_energy(scene) < 1e-20
    assert fitted_order(ALIKE_STEPS, errors) > 1.9


# ---- under loads

SLENDER, SOFT = 1e5, 1e3  # EA
FORCE = (-0.7, 0.5)
#: From, to; a third and seven ninths lie at the same parts of the edges of ALIKE.
PARTS = {"inner": (1 / 3, 7 / 9), "at the clamp": (0.0, 7 / 9), "at the free end": (1 / 3, 1.0)}
QUANTITIES = ("x", "y", "curvature", "moment", "tension")


def segments_of(curvature, ends, cuts):
    """The rod from cut to cut, with `curvature(s)` within the ends of the stretch."""
    start, end = ends
    return [
        Segment(a, b, curvature if start <= a < end else lambda s: 0.0 * s)
        for a, b in pairwise(cuts)
    ]


def by_hand(equilibrium, places):
    return np.array([[equilibrium.at(s, side)[q] for q in QUANTITIES] for s, side in places])


def graded(u):
    """Places of evenly numbered nodes on a mesh whose edges are 3 to 5 times a length."""
    return u + math.sin(2 * math.pi * u) / (8 * math.pi)


def evenly(u):
    return u


#: Supports of the scene, conditions of the reference, clamps inside; the force of both is at the
#: end where it is free, else in the middle of the rod.
SPRING = 2.5  # against turning
HELD = {
    "cantilever": (clamped(), pulled(FORCE), False),
    "clamped-clamped": (clamped(), clamped(1.0), False),
    "clamped-pinned": (clamped(), pinned(1.0), False),
    "interior clamp": (clamped(), pulled(FORCE), True),
    "spring at the start": (
        lambda u: [u[MOMENT] - SPRING * u[ANGLE], u[X], u[Y]],
        pulled(FORCE),
        False,
    ),
    "spring at the end": (
        clamped(),
        lambda u: [u[MOMENT] + SPRING * u[ANGLE], u[4] - FORCE[0], u[5] - FORCE[1]],
        False,
    ),
}
ON_SPRINGS = ("spring at the start", "spring at the end")


def held_scene(n, held, placed, EA):
    scene = straight(n, "clamped-free", EA)
    section = scene["rods"][0]["cross_section"]
    points = [[placed(k / n), 0.0] for k in range(n + 1)]
    scene["rods"][0] = {"name": "rod", "points": points, "cross_section": section}
    more = {
        "clamped-clamped": [{**END, "clamp": True}],
        "clamped-pinned": [{**END, "fix": ["x", "y"]}],
        "interior clamp": [{"rod": "rod", "at": {"node": n // 2}, "clamp": True}],
    }
    scene["supports"] = [{**START, "clamp": True}, *more.get(held, [])]
    turning = {"spring": {"rotational_stiffness": SPRING}}
    if held == "spring at the start":
        scene["supports"] = [{**START, "fix": ["x", "y"], **turning}]
    if held == "spring at the end":
        scene["supports"] += [{**END, **turning}]
    if HELD[held][1] not in (HELD["clamped-clamped"][1], HELD["clamped-pinned"][1]):
        scene["loads"] = tip_force(*FORCE)
    return scene


def check_held(fitted_order, held, part, profile, EA, placed=evenly):
    """All quantities at the ends, at both sides of the borders and near the clamp.

    Left out are those that have an error of order 1, whatever curves the rod: moments at a clamp if
    the rod is soft along (an error of the strain times the edge's shear force).
    """
    ends = tuple(placed(u) for u in PARTS[part])
    middle = placed(0.5)
    curvature = profile_curvature(profile, *ends)
    first, last, clamp_inside = HELD[held]
    cuts = np.unique([0.0, *ends, 1.0, *([middle] * clamp_inside)])
    exact = solve(
        segments_of(curvature, ends, cuts),
        first,
        last,
        EA=EA,
        held={list(cuts).index(middle): clamped(middle)} if clamp_inside else {},
    )
    inside, beyond = sides(*ends)
    clamps = [(0.0, "after"), (1.0, "before"), (middle, "before"), (middle, "after")]
    fixed = [*clamps, *((placed(u), "after") for u in (1 / 9, 2 / 3, 8 / 9)), *inside, *beyond]
    errors = []
    for n in ALIKE:
        scene = held_scene(n, held, placed, EA)
        scene["actuation"] = [bend(CURVATURE, *ends, profile=profile)]
        places = fixed + [(placed(share / n), "after") for share in (0.3, 0.5, 0.8, 1.3)]
        off = np.abs(probed(scene, places, QUANTITIES) - by_hand(exact, places))
        if EA < SLENDER:
            near = [s < 0.9 / n or s in (1.0, middle) for s, _ in places]
            off[near, 2:4] = 0.0
        errors.append(off.max(axis=0))
    for quantity, column in zip(QUANTITIES, np.transpose(errors), strict=True):
        assert fitted_order(ALIKE_STEPS, column) > 1.9, (quantity, column)


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("part", PARTS)
def test_actuated_cantilever_under_a_tip_force(fitted_order, part, profile):
    check_held(fitted_order, "cantilever", part, profile, SLENDER)


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("held", ["clamped-clamped", "clamped-pinned", "interior clamp"])
def test_actuated_rod_that_is_held(fitted_order, held, profile):
    check_held(fitted_order, held, "inner", profile, SOFT)


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("held", ON_SPRINGS)
def test_actuated_rod_on_a_spring_against_turning(fitted_order, held, part):
    """Where the rod is actuated at the spring, it turns on from the edges to it."""
    check_held(fitted_order, held, part, "constant", SLENDER)


@pytest.mark.parametrize("held", HELD)
def test_actuated_rod_on_an_uneven_mesh(fitted_order, held):
    EA = SLENDER if held in ("cantilever", *ON_SPRINGS) else SOFT
    check_held(fitted_order, held, "inner", "constant", EA, graded)


# ---- elongation


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("ends", STRETCHES)
def test_a_rod_that_is_free_to_grow_has_no_tension(ends, profile):
    """Every node moves by the integral of the profile, wherever the stretch ends."""
    share = {"constant": 1.0, "linear": 0.5, "smooth": 0.5}[profile]
    scene = straight(20, "clamped-free", 1e4)
    scene["actuation"] = [stretch(0.1, *ends, profile=profile)]
    x = der.equilibrium(scene).positions[-1, :, 0]
    assert x[-1] == pytest.approx(1.0 + 0.1 * share * (ends[1] - ends[0]), abs=1e-13)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    for place, found in zip(np.linspace(0, 1, 21), x, strict=True):
        until = np.clip(place, *ends)
        s = ends[0] + (until - ends[0]) * (nodes + 1) / 2
        values = 0.1 * PROFILES[profile]((s - ends[0]) / (ends[1] - ends[0]))
        moved = (until - ends[0]) * weights @ values / 2
        assert found == pytest.approx(place + moved, abs=1e-13)
    result = der.run(scene)
    assert np.abs(result.along("rod", "tension")[1]).max() < 1e-8
    assert elastic_energy(scene) < 1e-20


def test_a_rod_that_nothing_holds_grows_by_a_tenth():
    scene = straight(10, "free-free", 1e4, actuation=[stretch(0.1, 0.0, 1.0)])
    x = der.equilibrium(scene).positions[-1]
    assert np.linalg.norm(x[-1] - x[0]) == pytest.approx(1.1, abs=1e-12)
    assert elastic_energy(scene) < 1e-20


def test_a_rod_between_clamps_is_pressed():
    """By EA times the mean elongation; it stays straight, and moves along (by hand)."""
    EA, share, ends = 1e2, 0.05, (FROM, TO)
    scene = straight(20, "clamped-clamped", EA, actuation=[stretch(share, *ends)])
    mean = share * (TO - FROM)
    result = der.run(scene)
    assert result.along("rod", "tension")[1][-1] == pytest.approx(-EA * mean, rel=1e-9)
    assert result.along("rod", "strain")[1][-1] == pytest.approx(-mean, rel=1e-9)
    x = result.positions[-1, :, 0]
    s = np.linspace(0, 1, 21)
    assert x == pytest.approx(s * (1 - mean) + share * (np.clip(s, *ends) - FROM), abs=1e-12)
    energy = result.summary["energies"]["stretch"]
    assert energy == pytest.approx(0.5 * EA * mean**2, rel=1e-9)


def pinned_at_both_ends(edges, EA):
    scene = straight(edges, "free-free", EA)
    scene["supports"] = [{**START, "fix": ["x", "y"]}, {**END, "fix": ["x", "y"]}]
    return scene


@pytest.mark.parametrize("vary", ["actuation", "actuation.stretch", "actuation.0"])
def test_a_pinned_rod_that_grows_buckles(fitted_order, vary):
    """At EA a = pi^2 EI/L^2, as under heat (Timoshenko and Gere, Theory of Elastic Stability,
    2.1): before, the rod has its length, so that the rest lengths of EA and EI are its own.
    """
    EA = 100.0
    errors = []
    for n in SIZES:
        scene = pinned_at_both_ends(n, EA) | {"actuation": [stretch(0.1, 0.0, 1.0)]}
        result = der.continuation(scene, vary=vary, to=1.5, branches=1)
        path = result.path
        row = path.rows("bifurcation")[0]
        errors.append(0.1 * path.factor[row] * EA / np.pi**2 - 1)
        before = (path.branch == 0) & (path.arc < path.arc[row])
        assert path.stable[before].all()
        assert np.abs(result.positions[before, :, 1]).max() < 1e-9
        assert path.branch.max() == 2
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 1e-3


def test_a_grown_rod_bows_by_what_the_reference_says(fitted_order):
    """Far beyond the buckling, on one part of it: `references/actuated_rod.py`."""
    EA, share, ends = 100.0, 0.4, PARTS["inner"]

    def bowed(s):
        slope = np.cos(np.pi * s)
        return np.array(
            [slope, -3 * np.sin(np.pi * s), s, 0.3 * np.sin(np.pi * s), -9 + 0 * s, 0 * s]
        )

    cuts = [0.0, *ends, 1.0]
    segments = [
        Segment(a, b, elongation=(lambda s, grows=a == ends[0]: share * grows))
        for a, b in pairwise(cuts)
    ]
    exact = solve(segments, pinned(0.0), pinned(1.0), EA=EA, guess=bowed)
    errors = []
    for n in ALIKE:
        scene = pinned_at_both_ends(n, EA) | {"actuation": [stretch(share, *ends)]}
        places = [(s, side) for s in (1 / 9, 0.5, 8 / 9) for side in ("before", "after")]
        places += [(0.0, "after"), (1.0, "before")]
        found, truth = probed(scene, places, QUANTITIES), by_hand(exact, places)
        side = np.sign(found[2, 1] * truth[2, 1])
        errors.append(found * [1, side, side, side, 1] - truth)
    errors = np.abs(errors).max(axis=1)
    assert abs(exact.at(0.5)["y"]) > 0.15
    for quantity, column in zip(QUANTITIES, errors.T, strict=True):
        assert fitted_order(ALIKE_STEPS, column) > 1.9, (quantity, column)


def test_elongation_and_curvature_under_load(fitted_order):
    """Curvature and bending stiffness count per undeformed length; `references/actuated_rod.py`."""
    ends = PARTS["inner"]
    cuts = [0.0, *ends, 1.0]
    segments = [
        Segment(
            a,
            b,
            curvature=(lambda s, acts=a == ends[0]: CURVATURE * acts + 0 * s),
            elongation=(
                lambda s, acts=a == ends[0]: 0.3 * acts * (s - ends[0]) / (ends[1] - ends[0])
            ),
        )
        for a, b in pairwise(cuts)
    ]
    exact = solve(segments, clamped(), pulled(FORCE), EA=SLENDER)
    errors = []
    for n in ALIKE:
        scene = straight(n, "clamped-free", SLENDER, loads=tip_force(*FORCE))
        scene["actuation"] = [bend(CURVATURE, *ends), stretch(0.3, *ends, profile="linear")]
        places = [(s, "after") for s in (0.0, 1 / 9, 0.5, 8 / 9)] + [(1.0, "before")]
        errors.append(
            np.abs(probed(scene, places, QUANTITIES) - by_hand(exact, places)).max(axis=0)
        )
    for quantity, column in zip(QUANTITIES, np.transpose(errors), strict=True):
        assert fitted_order(ALIKE_STEPS, column) > 1.9, (quantity, column)


@pytest.mark.parametrize(
    ("value", "part", "profile", "in_space"),
    [
        (0.3, (0.0, 1.0), "constant", False),
        (-0.3, (0.0, 5 / 9), "constant", True),
        (0.3, (0.0, 4 / 9), "linear", False),
        (-0.3, (0.0, 1.0), "smooth", False),
        (0.3, "within the edge", "constant", False),
        (-0.3, "within the edge", "linear", True),
    ],
)
def test_tension_at_clamps_of_a_rod_that_grows(fitted_order, value, part, profile, in_space):
    """The edge at a clamp leans against the rod, which turns the force across it into tension: that
    force is `-M'` over the stretch, elongation included (`references/actuated_rod.py`).
    """
    at_start = [clamped(), pulled(FORCE)]
    at_end = [lambda u: [u[MOMENT], u[4] + FORCE[0], u[5] + FORCE[1]], clamped(1.0)]
    errors = []
    for n in ALIKE:
        off = []
        for clamp, free, ends in ((START, END, at_start), (END, START, at_end)):
            parts = (0.0, 0.4 / n) if part == "within the edge" else part
            if clamp is END:
                parts = (1 - parts[1], 1 - parts[0])
            scene = straight(
                n, "free-free", SOFT, loads=[{"point_force": {**free, "force": FORCE}}]
            )
            scene["supports"] = [{**clamp, "clamp": True}]
            scene["actuation"] = [stretch(value, *parts, profile=profile)]
            if in_space:
                scene["model"] = "spatial"
                scene["rods"][0]["cross_section"]["stiffness"]["GJ"] = 1.0
            exact = solve(grown_segments(value, parts, profile), *ends, EA=SOFT)
            place = (0.0, "after") if clamp is START else (1.0, "before")
            found = probed(scene, [place], ["tension"])[0, 0]
            off.append(abs(found - exact.at(*place)["tension"]))
        errors.append(off)
    for column in np.transpose(errors):
        assert fitted_order(ALIKE_STEPS, column) > 1.85, column


def grown_segments(value, part, profile):
    """The rod with an elongation on a part."""
    start, end = part

    def elongation(s):
        return value * PROFILES[profile]((s - start) / (end - start))

    cuts = sorted({0.0, start, end, 1.0})
    return [
        Segment(a, b, elongation=elongation) if start <= a and b <= end else Segment(a, b)
        for a, b in pairwise(cuts)
    ]


def test_linear_buckling_of_a_rod_that_is_pressed_by_its_growth():
    """The load factor counts from the grown state: near the bifurcation of the path there, from
    which it differs by the strain before buckling, here 0.03.
    """
    EA = 1e3
    for share in (0.0, 0.5):
        scene = pinned_at_both_ends(40, EA)
        scene["actuation"] = [stretch(share * np.pi**2 / EA, 0.0, 1.0)]
        scene["loads"] = [{"point_force": {"rod": "rod", "at": "middle", "force": [1.0, 0.0]}}]
        linear = der.run(scene | {"analysis": {"buckling": {"count": 1}}}).buckling.load_factors[0]
        path = der.continuation(scene, to=100.0).path
        assert linear == pytest.approx(path.factor[path.rows("bifurcation")[0]], rel=0.03)


# ---- a bistable strip

SHORTENING, STIFF = 0.03, 1e3
ACTUATED = (0.15, 0.45)


def strip(edges, side):
    """Pinned, pushed together by a prescribed motion, and bent to the other side on a part."""
    scene = straight(edges, "free-free", STIFF)
    scene["supports"] = [
        {**START, "fix": ["x", "y"]},
        {**END, "fix": ["y"], "prescribe": {"x": -SHORTENING}},
    ]
    scene["actuation"] = [bend(side, *ACTUATED)]
    return scene


def strip_by_hand(angle, guess):
    """The equilibrium with this angle at its start, and the actuation that it needs: (t, u, k).

    As in `references/actuated_rod.py`, with the actuation k as a parameter.
    """
    cuts = [0.0, *ACTUATED, 1.0]

    def slopes(t, u, p):
        rate = np.empty_like(u)
        for i, (a, b) in enumerate(pairwise(cuts)):
            part = u[6 * i : 6 * i + 6]
            rate[6 * i : 6 * i + 6] = (b - a) * rod_slopes(part, p[0] * (i == 1), 0.0, STIFF, 1.0)
        return rate

    def conditions(first, last, _p):
        joined = [*(last[:6] - first[6:12]), *(last[6:12] - first[12:])]
        ends = [*pinned(0.0)(first[:6]), *pinned(1.0 - SHORTENING)(last[12:])]
        return np.array([*ends, *joined, first[0] - angle])

    t, u, k = guess
    found = solve_bvp(slopes, conditions, t, u, [k], tol=1e-8, bc_tol=1e-11, max_nodes=5000)
    assert found.success
    return t, found.sol(t), found.p[0]


def snap_by_hand():
    """Largest actuation on the path from the arch above, by a polynomial through its points."""
    t = np.linspace(0.0, 1.0, 31)
    rise = 2 * np.sqrt(SHORTENING - np.pi**2 / STIFF) / np.pi
    first = []
    for a, b in zip([0.0, *ACTUATED], [*ACTUATED, 1.0], strict=True):
        s = a + (b - a) * t
        bow = rise * np.pi * np.cos(np.pi * s)
        height = rise * np.sin(np.pi * s)
        first.append(
            [bow, -(np.pi**2) * height, (1 - SHORTENING) * s, height, -(np.pi**2) + 0 * s, 0 * s]
        )
    guess = (t, np.vstack(first), 0.0)
    for angle in (0.25, 0.2, 0.15, 0.1):
        guess = strip_by_hand(angle, guess)
    angles = 0.04 - 0.02 * np.cos(np.pi * np.arange(7) / 6)[::-1]
    needed = []
    for angle in angles:
        guess = strip_by_hand(angle, guess)
        needed.append(guess[2])
    through = np.polynomial.Polynomial.fit(angles, needed, 6)
    turns = [root.real for root in through.deriv().roots() if abs(root - 0.04) < 0.02]
    assert len(turns) == 1
    return float(through(turns[0]))


def test_actuated_strip_snaps(fitted_order):
    """Bent on a part against its bow: without a symmetry its path turns at a fold."""
    exact = snap_by_hand()
    errors = []
    for n in SIZES:
        path = der.continuation(strip(n, 1.0), vary="actuation.bend", to=2.0).path
        assert list(path.events[path.events != ""]) == ["fold", "fold"]
        there, back = path.factor[path.rows("fold")]
        assert back == pytest.approx(-there, abs=1e-9)  # the strip bowed down
        errors.append(there / exact - 1)
        assert not path.unstable_directions[: path.rows("fold")[0]].any()
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 3e-4


def test_actuated_strip_does_not_snap_to_the_side_to_which_it_bows():
    path = der.continuation(strip(20, -1.0), vary="actuation.bend", to=10.0).path
    assert not (path.events != "").any()


# ---- vibrations about actuated shapes, and out of the plane


@pytest.mark.parametrize("ends", ["clamped-free", "clamped-clamped"])
def test_frequencies_of_an_actuated_arc(fitted_order, ends):
    """Those of a rod that is drawn as the arc."""
    angle = CURVATURE
    errors = []
    for n in SIZES:
        s = np.linspace(0, angle, n + 1)
        arc = np.column_stack([np.sin(s), 1 - np.cos(s)]) / angle
        scene = straight(n, "clamped-free", 1e5, analysis={"modes": {"count": 4}})
        drawn = {"name": "rod", "points": arc.tolist()}
        drawn["cross_section"] = scene["rods"][0]["cross_section"]
        others = scene | {"rods": [drawn]}
        scene["actuation"] = [bend(angle, 0.0, 1.0)]
        if ends == "clamped-clamped":
            # The end is brought to where it is without stress, the tangent too.
            moved = dict(zip("xy", arc[-1] - [1.0, 0.0], strict=True)) | {"angle": angle}
            scene["supports"] = [*scene["supports"], {**END, "clamp": True, "prescribe": moved}]
            others["supports"] = [*others["supports"], {**END, "clamp": True}]
        found, expected = (
            np.array(der.run(each).summary["frequencies_hz"]) for each in (scene, others)
        )
        errors.append(found / expected - 1)
    for column in np.transpose(errors):
        assert fitted_order(STEPS, column) > 1.9
    # Chords are shorter than arcs by (k h)^2/24, and frequencies go with the length squared.
    assert np.abs(errors[-1]).max() < 2 * (CURVATURE * STEPS[-1]) ** 2 / 24 + 1e-4


def test_frequencies_of_a_rod_that_is_pressed_by_its_growth(fitted_order):
    """(k pi)^2 sqrt(EI/m) sqrt(1 - a EA/(k pi)^2): a column under the force EA a, by hand."""
    EA, share = 1e3, 0.5
    force = share * np.pi**2
    waves = np.arange(1, 4) * np.pi
    exact = waves**2 * np.sqrt(1 - force / waves**2) / (2 * np.pi)
    errors = []
    for n in SIZES:
        scene = pinned_at_both_ends(n, EA) | {"analysis": {"modes": {"count": 3}}}
        scene["actuation"] = [stretch(force / EA, 0.0, 1.0)]
        errors.append(np.array(der.run(scene).summary["frequencies_hz"]) / exact - 1)
    for column in np.transpose(errors):
        assert fitted_order(STEPS, column) > 1.9


def coil(edges, length, **curved):
    """A curved rod hangs from a clamp; EI = k = 1 (`references/hanging_coil.py`)."""
    scene = straight(edges, "clamped-free", 1e6, loads=[{"gravity": [0, -1]}])
    stiffness = {"EA": 1e6, "EI": 1.0, "GJ": 1 / 1.3, "mass_per_length": 0.1}
    scene["rods"][0] |= {"to": [0, -length], "cross_section": {"stiffness": stiffness}}
    scene["rods"][0] |= curved.pop("rod", {})
    return scene | curved


def unstable_out_of_plane(scene):
    return der.Simulation(scene).equilibrium(leave_saddles=False).out_of_plane.unstable_directions


def test_an_actuated_coil_leaves_its_plane(spatial_reference, fitted_order):
    """At the length at which one that is curved by itself does."""
    exact = spatial_reference("hanging_coil", "critical_length")
    sizes = [10, 20, 40]
    errors = []
    for n in sizes:

        def actuated(length, n=n):
            return coil(n, length, actuation=[bend(1.0, 0.0, length)])

        def is_unstable(length):
            return unstable_out_of_plane(actuated(length)) > 0

        errors.append(critical(is_unstable, 0.8 * exact, 1.2 * exact, 1e-7) / exact - 1)
    assert fitted_order([1 / n for n in sizes], errors) > 1.9
    assert abs(errors[-1]) < 5e-3


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_verdict_on_an_actuated_coil_is_that_of_the_spatial_model(spatial_reference, share):
    """And that on the coil that is curved by itself."""
    length = share * spatial_reference("hanging_coil", "critical_length")
    actuation = [bend(1.0, 0.0, length)]
    planar = unstable_out_of_plane(coil(20, length, actuation=actuation))
    drawn = unstable_out_of_plane(coil(20, length, rod={"natural_curvature": 1.0}))
    space = coil(20, length, model="spatial", actuation=actuation)
    space["rods"][0] |= {"from": [0, 0, 0], "to": [0, -length, 0]}
    space["loads"] = [{"gravity": [0, -1, 0]}]
    report = der.Simulation(space).equilibrium(leave_saddles=False)
    assert planar == drawn == report.unstable_directions
    assert (planar > 0) == (share > 1)


@pytest.mark.parametrize(("value", "unstable"), [(10.0, False), (14.0, True), (20.0, True)])
def test_verdict_on_a_rod_between_clamps_is_that_of_the_spatial_model(value, unstable):
    """Bent by its actuation, against its clamps, until it leaves the plane."""
    stiffness = {"EA": 1e4, "EI": 1.0, "GJ": 0.3, "mass_per_length": 1.0}
    flat = straight(24, "clamped-clamped", actuation=[bend(value, 0.2, 0.7)])
    flat["rods"][0]["cross_section"] = {"stiffness": stiffness}
    space = flat | {"model": "spatial"}
    space["rods"] = [flat["rods"][0] | {"from": [0, 0, 0], "to": [1, 0, 0]}]
    report, spatial = (
        der.Simulation(scene).equilibrium(leave_saddles=False) for scene in (flat, space)
    )
    directions = report.unstable_directions + report.out_of_plane.unstable_directions
    assert directions == spatial.unstable_directions
    assert (directions > 0) == unstable


@pytest.mark.parametrize("ends", [(0.313, 0.777), (0.503, 0.511)])
def test_curvature_within_a_smooth_stretch(ends):
    """Without stress it is the profile at every place, also of a stretch within an edge."""
    middle = 0.5 * (ends[0] + ends[1])
    scene = straight(40, "clamped-free", 1e4)
    scene["actuation"] = [bend(CURVATURE, *ends, profile="smooth")]
    found = probed(scene, [(middle, "after")], ["curvature", "moment"])
    assert found[0, 1] == pytest.approx(0.0, abs=1e-8)
    truth = CURVATURE * PROFILES["smooth"](0.5)
    assert found[0, 0] == pytest.approx(truth, abs=1e-8)


def test_elongations_that_do_not_all_overlap_at_one_place():
    """Two at a time: nowhere is the rod shorter than a fifth of its length."""
    parts = [stretch(-0.35, 0.0, 0.3, "a"), stretch(-0.4, 0.6, 1.0, "b"), stretch(-0.38, 0, 1, "c")]
    scene = straight(10, "clamped-free", 1e3, actuation=parts)
    length = 1 - (0.35 * 0.3 + 0.4 * 0.4 + 0.38)
    assert der.equilibrium(scene).positions[-1, -1, 0] == pytest.approx(length, abs=1e-9)


def test_elongations_that_overlap_at_different_times():
    """The sum of two tables is never below -0.6."""
    early = {"times": [0, 0.1, 0.2], "values": [0, -0.6, 0]}
    late = {"times": [0, 0.2, 0.3], "values": [0, 0, -0.6]}
    scene = straight(4, "clamped-free", 1e3)
    del scene["analysis"]
    scene["actuation"] = [stretch(early, 0.0, 1.0, "early"), stretch(late, 0.0, 1.0, "late")]
    der.Scenario.from_dict(scene | {"time": {"duration": 0.3, "step": 0.01}})


def test_edges_beside_a_clamp_keep_a_length():
    """They start from a pivot at a fifth of it: what leaves nothing is refused."""
    scene = straight(10, "clamped-free", 1e3, actuation=[stretch(-0.7, 0.0, 1.0)])
    assert der.equilibrium(scene).positions[-1, -1, 0] == pytest.approx(0.3, abs=1e-9)
    scene["actuation"] = [stretch(-0.8, 0.0, 1.0)]
    with pytest.raises(der.SceneError, match=r"must be greater than -0\.75 beside a clamp"):
        der.Scenario.from_dict(scene)
    scene["actuation"] = [stretch(-0.95, 0.2, 1.0)]
    assert der.equilibrium(scene).positions[-1, -1, 0] == pytest.approx(0.24, abs=1e-9)


def driven(*parts, ends="free-free"):
    """A rod that has time to follow."""
    scene = straight(10, ends, 1e3, actuation=list(parts), loads=[{"damping": {"coefficient": 5}}])
    del scene["analysis"]
    time = {"duration": 20.0, "step": 0.02, "integrator": "energy_momentum"}
    return der.Simulation(scene | {"time": time})


def test_elongations_that_a_program_sets_leave_every_edge_a_length():
    """Each is greater than -1; the sum where they overlap would not be, from 0.3 m to 0.6 m."""
    rod = driven(stretch(0.0, 0.0, 0.6, "a"), stretch(0.0, 0.3, 1.0, "b"))
    rod.set("a", -0.6, over=2.0)
    rod.set("b", -0.3, over=1.0)
    wrong = (
        r"greater than -0\.4 while 'a' is -0\.6: the edge from 0\.3 m to 0\.4 m would be .* 1\.1 of"
    )
    with pytest.raises(der.DerError, match=wrong):
        rod.set("b", -0.5, over=2.0)
    # A value on its way counts: a is -0.3 when b would come to -0.5, and then goes on.
    with pytest.raises(der.DerError, match=wrong):
        rod.set("b", -0.5, over=1.0)
    rod.step(100)
    assert rod.value("b") == -0.3  # as before
    rod.set("b", -0.39, over=1.0)
    rod.step(100)
    assert rod.positions[-1, 0] - rod.positions[0, 0] == pytest.approx(1 - 0.36 - 0.273, abs=1e-3)


def test_smooth_elongations_that_a_program_sets():
    """The edge in the middle has the largest share of sin^2, on average."""
    parts = [stretch(0.0, 0.0, 1.0, name, profile="smooth") for name in "ab"]
    rod = der.Simulation(straight(9, "free-free", 1e3, actuation=parts))
    share = 0.5 + 9 * np.sin(np.pi / 9) / (2 * np.pi)
    rod.set("a", -0.7)
    rod.set("b", 0.7 - 1 / share + 1e-9)
    with pytest.raises(der.DerError, match=r"while 'a' is -0\.7"):
        rod.set("b", 0.7 - 1 / share - 1e-9)


def test_elongation_that_a_program_sets_beside_a_clamp():
    rod = driven(stretch(0.0, 0.0, 1.0, "a"), ends="clamped-free")
    rod.set("a", -0.7)
    with pytest.raises(der.DerError, match=r"than -0\.75: the edge from 0 m to 0\.1 m .* quarter"):
        rod.set("a", -0.8)


def test_a_table_that_meets_what_a_program_has_set():
    """Neither the table nor the value is wrong by itself."""
    table = {"times": [0, 4, 10], "values": [0, 0, -0.6]}
    rod = driven(stretch(table, 0.0, 1.0, "a"), stretch(0.0, 0.5, 1.0, "b"))
    rod.set("b", -0.65, over=4.0)
    with pytest.raises(der.DerError, match=r"'a' is -0\.35 and 'b' is -0\.65 would shorten"):
        rod.step(1000)
    assert rod.time == pytest.approx(7.5, abs=0.06)
    rod.set("b", 0.0, over=2.0)
    rod.step(50)


# ---- the natural curvature as a quantity


@pytest.mark.parametrize("profile", PROFILES)
def test_natural_curvature_is_that_of_the_rod_and_of_its_actuations(profile):
    """Whatever holds the rod; a quantity of the rest shape does not see how it is bent."""
    curvature = profile_curvature(profile, FROM, TO)
    part = bend(CURVATURE, FROM, TO, profile=profile)
    scene = straight(20, "clamped-clamped", 1e4, actuation=[part, bend(0.4, 0.0, 1.0, "whole")])
    scene["rods"][0]["natural_curvature"] = 0.7
    inside, beyond = sides(FROM, TO)
    places = [*inside, *beyond, (0.0, "after"), (0.5432, "after"), (1.0, "before")]
    truth = [*(curvature(s) for s, _ in inside), 0.0, 0.0, 0.0, curvature(0.5432), 0.0]
    found = probed(scene, places, ["natural_curvature", "curvature"])
    assert found[:, 0] == pytest.approx(np.array(truth) + 1.1, abs=1e-9)
    assert np.abs(found[:, 0] - found[:, 1]).max() > 0.1
    result = der.run(scene)
    s, values = result.along("rod", "natural_curvature")
    assert s == pytest.approx(result.along("rod", "curvature")[0])
    moment = (result.along("rod", "curvature")[1] - values)[-1]  # EI = 1
    assert result.along("rod", "moment")[1][-1] == pytest.approx(moment, abs=1e-9)


# ---- paths


@pytest.mark.parametrize("vary", ["loads.push", "supports.wall", "actuation.bend"])
def test_paths_of_what_has_a_name(vary):
    """By the name as by the number."""
    scene = straight(6, "clamped-free", 1e3, actuation=[bend(0.0, 0, 1, "no"), bend(2.0, 0, 1)])
    scene |= {
        "supports": [
            {"rod": "rod", "at": "end", "spring": {"stiffness": [0.1, 0.1]}},
            {"name": "wall", "rod": "rod", "at": "start", "clamp": True, "prescribe": {"y": 0.1}},
        ],
        "loads": [{"gravity": [0, -0.1]}, {"name": "push"} | tip_force(0, 0.3)[0]],
    }
    paths = [
        der.continuation(scene, vary=which).positions for which in (vary, vary.split(".")[0] + ".1")
    ]
    assert np.ptp(paths[0][:, -1, 1]) > 0.005
    np.testing.assert_array_equal(*paths)


def test_buckling_loads_of_an_actuated_rod_name_the_path_of_its_actuations():
    """They scale the loads, and the rod is bent before it buckles."""
    scene = straight(8, "clamped-free", 1e3, actuation=[bend(2.0, 0.0, 0.5)])
    scene |= {"loads": tip_force(-0.1, -0.1), "analysis": "buckling"}
    (warning,) = der.run(scene).summary["warnings"]
    assert "'analysis: {continuation: {vary: actuation}}'" in warning
    (warning,) = der.run(scene | {"actuation": []}).summary["warnings"]
    assert "actuation" not in warning


def test_a_hinge_may_be_shorter_than_an_edge():
    """A short strong stretch turns the rod by what it has in all, whatever its curvature.

    Without stress: straight, an arc of 5 mm that turns by 0.5 rad, straight. An edge within which
    the rod is turned has the mean direction, off by a share turn^2/24 of its length.
    """
    turn, start, end = 0.5, 0.5, 0.505
    scene = straight(10, "clamped-free", 1e4, actuation=[bend(turn / 0.005, start, end)])
    scenario = der.Scenario.from_dict(scene)
    assert not scenario.warnings
    arc = 0.005 / turn * np.array([np.sin(turn), 1 - np.cos(turn)])
    exact = [start, 0] + arc + (1 - end) * np.array([np.cos(turn), np.sin(turn)])
    tip = der.run(scenario).positions[-1, -1]
    assert tip == pytest.approx(exact, abs=0.1 * turn**2 / 24)
    scene["actuation"] = [bend(3.3 / 0.005, start, end)]
    with pytest.raises(der.SceneError, match=r"asks for a turn of 3\.22 rad at node 5"):
        der.Scenario.from_dict(scene)


def test_a_hinge_at_a_clamp_turns_the_edge_there_more():
    """From its pivot on the edge is 4/5 as long, and turns by 5/4 of its mean direction."""
    scene = straight(10, "clamped-free", 1e4, actuation=[bend(2.6 / 1e-6, 0.0, 1e-6)])
    with pytest.raises(der.SceneError, match=r"asks for a turn of 3\.25 rad at node 0"):
        der.Scenario.from_dict(scene)


def test_curvatures_that_overlap_are_judged_together():
    """Three of 9.5/m turn edges of 0.1 m by 2.85 rad, and opposite ones by nothing."""
    parts = [bend(9.5, 0.0, 1.0, name) for name in "abc"]
    scene = straight(10, "clamped-free", 1e4, actuation=parts)
    (warning,) = der.Scenario.from_dict(scene).warnings
    assert "for actuation.a and actuation.b and actuation.c: " in warning
    assert "by 2.9 rad at node 2. Give it about 58 nodes" in warning
    table = {"times": [0, 1, 2], "values": [0, -9.5, 0]}
    scene["actuation"][2]["natural_curvature"] = table
    del scene["analysis"]
    scene["time"] = {"duration": 2, "step": 0.1}
    (warning,) = der.Scenario.from_dict(scene).warnings
    assert "by 1.9 rad at node" in warning  # at the start and at the end
    scene["actuation"] = [bend(50.0, 0.0, 1.0, "a"), bend(-49.0, 0.0, 1.0, "b")]
    assert not der.Scenario.from_dict(scene).warnings
    scene["actuation"] = [bend(20.0, 0.0, 0.6, "a"), bend(20.0, 0.3, 1.0, "b")]
    with pytest.raises(der.SceneError, match=r"b.natural_curvature: together with .* of 4 rad"):
        der.Scenario.from_dict(scene)
    scene["actuation"] = [bend(20.0, 0.0, 0.5, "a"), bend(20.0, 0.5, 1.0, "b")]
    (warning,) = der.Scenario.from_dict(scene).warnings
    assert "by 2 rad" in warning


def test_curvatures_that_a_program_sets_are_judged_together():
    """A warning once for each rod, and an error from half a turn that changes nothing."""
    rod = driven(bend(0.0, 0.0, 0.6, "a"), bend(0.0, 0.3, 1.0, "b"), ends="clamped-free")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rod.set("a", 9.5)
        rod.set("b", -9.5, over=1.0)
    with pytest.warns(der.DerWarning, match="too coarse for 'b': .* by 1.2 rad at node"):
        rod.set("b", -12.0, over=1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rod.set("b", -15.0, over=1.0)  # said already
        rod.set("a", 30.0, over=1.0)  # -15 meanwhile
    before = rod.value("b"), rod.save_state().time
    with pytest.raises(der.DerError, match=r"'a' and 'b' would turn .* by 3\.5 rad"):
        rod.set("b", 5.0, over=2.0)
    assert (rod.value("b"), rod.save_state().time) == before


def test_curvatures_that_a_program_sets_meet_a_table():
    """The step before edges would turn by half a turn says so."""
    table = {"times": [0, 4, 14], "values": [0, 0, 20]}
    with pytest.warns(der.DerWarning, match="too coarse for actuation.table: .* by 2 rad"):
        rod = driven(bend(0, 0.0, 1.0, "set"), bend(table, 0.4, 0.6, "table"), ends="clamped-free")
    with pytest.warns(der.DerWarning, match="too coarse for 'set'"):
        rod.set("set", 20.0, over=4.0)
    with pytest.raises(der.DerError, match=r"at t = .* 'set' and 'table' would turn the edges"):
        rod.step(600)
    assert 2.0 + 0.2 * (rod.time - 4.0) == pytest.approx(np.pi, abs=0.2 * 0.021)


def test_pairs_that_a_program_sets_are_judged_together():
    """Both components of one call: each is less than half a turn."""
    scene = straight(10, "clamped-free", 1e4, actuation=[bend([0.0, 0.0], 0.0, 1.0)])
    scene["rods"][0] |= {"from": [0, 0, 0], "to": [1, 0, 0]}
    scene["rods"][0]["cross_section"] = {
        "stiffness": {"EA": 1e4, "EI": 1.0, "GJ": 1.0, "mass_per_length": 1.0}
    }
    rod = der.Simulation({**scene, "model": "spatial"})
    with pytest.raises(der.DerError, match=r"'bend' would turn .* by 3\.54 rad"):
        rod.set("bend", [25.0, 25.0])
    with pytest.warns(der.DerWarning, match="by 2.5 rad"):
        rod.set("bend", [25.0, 0.0])


def test_elongations_count_on_the_edge_beside_a_clamp_by_their_mean():
    """The clamp's edge keeps its length where little of a profile or of a stretch is on it."""
    smooth = [stretch(-0.9, 0.0, 1.0, profile="smooth")]
    scene = straight(20, "clamped-free", 1e3, actuation=smooth)
    assert der.equilibrium(scene).positions[-1, -1, 0] == pytest.approx(1 - 0.45, abs=1e-9)
    scene["actuation"] = [stretch(-0.9, 0.0499, 1.0)]
    assert der.equilibrium(scene).positions[-1, -1, 0] == pytest.approx(1 - 0.9 * 0.9501, abs=1e-9)
    scene["actuation"] = [stretch(-0.9, 0.005, 1.0)]
    with pytest.raises(der.SceneError, match=r"must be greater than -0\.8333 beside a clamp"):
        der.Scenario.from_dict(scene)
    scene["actuation"] = [stretch(-0.5, 0.0, 1.0, "a"), stretch(-0.4, 0.0, 0.05, "b")]
    with pytest.raises(der.SceneError, match=r"shorten the edge beside a clamp by 0\.9 of"):
        der.Scenario.from_dict(scene)
