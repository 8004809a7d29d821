"""Slope and tangent of rods: kinks, free ends, clamps, corners, whole turns, space."""

import der
import numpy as np
import pytest
from scenes import END, straight
from scipy.integrate import solve_bvp
from spatial_scenes import section

CLAMPED = {"rod": "rod", "at": "start", "clamp": True}
PLACES = (0.0, 0.013, 0.21, 0.37, 0.372, 0.5, 0.93, 0.987, 1.0)


def probes(places, quantities):
    return {
        f"{quantity}{i}": {"quantity": quantity, "rod": "rod", "at": s}
        for i, s in enumerate(places)
        for quantity in quantities
    }


def read(scene, places, *quantities):
    """Return the values at the places, shape (places, quantities)."""
    result = der.run({**scene, "output": {"probes": probes(places, quantities)}})
    return np.array(
        [[result.probes[f"{q}{i}"][-1] for q in quantities] for i in range(len(places))]
    )


def moment(at, value):
    return {"moment": {"rod": "rod", "at": at, "moment": value}}


@pytest.mark.parametrize("supports", [[CLAMPED], [{**END, "clamp": True}]])
@pytest.mark.parametrize("natural", [None, 1.5])
def test_slope_under_moments(supports, natural, fitted_order):
    # Each part between two moments is an arc. The whole rod turns by more than one turn.
    at_end, inside, place = 5.0, 3.0, 0.372
    held_end = supports[0]["at"] == "end"
    if held_end:
        at_end, inside = -at_end, -inside
    edges = [10, 20, 40, 80]
    errors = []
    for count in edges:
        scene = straight(count, "free-free", EA=1e8)
        if natural:
            scene["rods"][0]["natural_curvature"] = natural
        loads = [moment("start" if held_end else "end", at_end), moment(place, inside)]
        found = read({**scene, "supports": supports, "loads": loads}, PLACES, "slope", "tx", "ty")
        s = np.array(PLACES)
        if held_end:
            bent = -at_end * (s - 1) - inside * (np.maximum(s, place) - 1)
        else:
            bent = at_end * s + inside * np.minimum(s, place)
        exact = bent + (natural or 0.0) * (s - held_end)
        np.testing.assert_allclose(found[:, 1], np.cos(found[:, 0]), atol=1e-12)
        np.testing.assert_allclose(found[:, 2], np.sin(found[:, 0]), atol=1e-12)
        errors.append(max(np.abs(found[:, 0] - exact).max(), 1e-12))
    assert errors[-1] < 1e-3
    assert errors[-1] < 1e-9 or fitted_order(edges, errors) < -1.9


def elastica(force, at_end, places):
    """Return the slope of an inextensible cantilever with EI = 1 under a force up and a moment."""
    s = np.linspace(0, 1, 101)
    solution = solve_bvp(
        lambda _, y: np.array([y[1], -force * np.cos(y[0])]),
        lambda a, b: np.array([a[0], b[1] - at_end]),
        s,
        np.zeros((2, len(s))),
        tol=1e-9,
    )
    return solution.sol(np.array(places))[0]


def test_slope_of_a_bent_cantilever(fitted_order):
    exact = elastica(3.0, -1.0, PLACES)
    edges = [10, 20, 40]
    errors = []
    for count in edges:
        load = [{"point_force": {**END, "force": [0, 3.0]}}, moment("end", -1.0)]
        scene = straight(count, "clamped-free", EA=1e9, loads=load)
        errors.append(read(scene, PLACES, "slope")[:, 0] - exact)
    assert errors[-1][0] == pytest.approx(0.0, abs=1e-15)  # the clamp holds it
    assert fitted_order(edges, np.abs(errors).max(axis=1)) < -1.9


def test_slope_where_a_spring_and_a_clamp_hold_a_beam_inside(fitted_order):
    # A pinned beam of length 1 with a moment at its end, and a spring against turning in the
    # middle: y'' = M is linear in each half, and jumps by k y' (EI = 1).
    k, load = 6.0, 1e-4
    pinned = [{"rod": "rod", "at": "start", "fix": ["x", "y"]}, {**END, "fix": ["y"]}]
    places = (0.0, 0.2, 0.47, 0.5, 0.53, 0.8, 1.0)
    s = np.array(places)

    # y'' = r s + (k y'(1/2)) [s > 1/2], r + k y'(1/2) = load; unknowns r, p = y'(1/2), c = y'(0).
    a = np.array(
        [
            [1.0, k, 0.0],  # moment at the end
            [1 / 8, -1.0, 1.0],  # slope in the middle
            [1 / 6, k / 8, 1.0],  # deflection of the end
        ]
    )
    r, p, c = np.linalg.solve(a, [load, 0, 0])
    exact = r * s**2 / 2 + k * p * np.maximum(0, s - 0.5) + c
    spring = {"rod": "rod", "at": 0.5, "spring": {"rotational_stiffness": k}}
    edges = [10, 20, 40]
    errors = []
    for count in edges:
        scene = straight(count, "free-free", EA=1e4, loads=[moment("end", load)])
        found = read({**scene, "supports": [*pinned, spring]}, places, "slope")[:, 0]
        errors.append(np.abs(found - exact).max() / load)
    assert fitted_order(edges, errors) < -1.9


def test_whole_turns_of_a_free_bar_count():
    spin, duration = 30.0, 0.6  # almost three turns
    rod = straight(4, "free-free", EA=1e6)["rods"][0]
    s = np.linspace(-0.5, 0.5, 5)
    rod["initial_velocity"] = [[0.0, spin * x] for x in s]
    result = der.run(
        {
            "rods": [rod],
            "time": {"duration": duration, "step": 1e-3},
            "output": {
                "every": 0.02,
                "probes": {"slope": {"quantity": "slope", "rod": "rod", "at": 0.5}},
            },
        }
    )
    exact = spin * result.times
    np.testing.assert_allclose(result.probes["slope"], exact, atol=0.05)
    arc, along = result.along("rod", "slope")
    np.testing.assert_allclose(along[:, len(arc) // 2], result.probes["slope"], atol=1e-12)
    assert np.ptp(along[-1]) < 0.1


def test_whole_turns_of_a_clamp_count():
    angle = {"times": [0, 1], "values": [0, 15.0]}
    scene = straight(6, "free-free", EA=1e4)
    del scene["analysis"]
    result = der.run(
        {
            **scene,
            "supports": [{**CLAMPED, "prescribe": {"angle": angle}}],
            "loads": [{"damping": {"rod": "rod", "coefficient": 2.0}}],
            "time": {"duration": 1.0, "step": 5e-3},
            "output": {
                "every": 0.5,
                "probes": {
                    "held": {"quantity": "slope", "rod": "rod", "at": "start"},
                    "tip": {"quantity": "slope", "rod": "rod", "at": "end"},
                },
            },
        }
    )
    assert result.probes["held"][-1] == pytest.approx(15.0)
    assert 10 < result.probes["tip"][-1] < 17


def test_slope_around_a_ring():
    turn = 2 * np.pi * np.arange(40) / 40
    ring = {
        "name": "rod",
        "closed": True,
        "points": np.column_stack([np.cos(turn), np.sin(turn)]).tolist(),
        "cross_section": {"stiffness": {"EA": 1e3, "EI": 1.0, "mass_per_length": 1.0}},
    }
    result = der.run({"rods": [ring], "analysis": "modes"})
    arc, along = result.along("rod", "slope")
    exact = np.pi / 2 + 2 * np.pi * arc / arc[-1]
    np.testing.assert_allclose(along[0], exact, atol=1e-12)
    _, tx = result.along("rod", "tx")
    np.testing.assert_allclose(tx[0], np.cos(exact), atol=1e-12)


DRAWN, LOADED = 2.0, 1.3  # curvature of the drawn arc, and what an end moment adds [1/m]
HELD = [("start",), ("end",), ("start", "middle", "end")]


def drawn_arc(edges, dimension, held, kind):
    """A circular arc of length 1 in a plane, from the x axis on, and the length of its edges."""
    turn = DRAWN * np.arange(edges + 1) / edges
    points = np.column_stack([np.sin(turn), 1 - np.cos(turn), 0 * turn])[:, :dimension] / DRAWN
    stiff = section(EA=1e8, EI=1.0)
    if dimension == 3:
        stiff = section([0.3, 0.5, 1], EA=1e8, EI1=1.0, EI2=1.0, GJ=0.7)
    rod = {"name": "rod", "points": points.tolist(), "cross_section": stiff}
    if dimension == 3:
        rod["initial_twist"] = 1.5
    scene = {
        "model": "planar" if dimension == 2 else "spatial",
        "rods": [rod],
        "supports": [{"rod": "rod", "at": at, "clamp": kind} for at in held],
        "analysis": "static",
    }
    return scene, 2 * np.sin(DRAWN / 2 / edges) / DRAWN


def beside_clamps(edges, edge):
    """Arc lengths in edges from the two ends and the middle."""
    off = np.array([0, 0.25, 0.5, 1, 1.25, 1.5, 2])
    half = edges // 2
    return edge * np.concatenate([off, edges - off, half + off, half - off])


@pytest.mark.parametrize("held", HELD, ids=str)
def test_slope_of_a_drawn_arc_is_exact_beside_clamps(held):
    edges = 20
    scene, edge = drawn_arc(edges, 2, held, True)
    places = beside_clamps(edges, edge)
    found = read(scene, places, "slope")[:, 0]
    np.testing.assert_allclose(found, DRAWN * places / (edges * edge), atol=1e-12)


@pytest.mark.parametrize("held", HELD[:2], ids=str)
@pytest.mark.parametrize(("dimension", "kind"), [(2, True), (3, True), (3, "tangent")])
def test_tangent_of_a_drawn_arc_beside_clamps(dimension, kind, held, fitted_order):
    """A moment at the other end bends the arc to one of another radius."""
    sizes = [20, 40, 80]
    errors = []
    for edges in sizes:
        scene, edge = drawn_arc(edges, dimension, held, kind)
        places = beside_clamps(edges, edge)
        from_start = held == ("start",)
        value = LOADED if from_start else -LOADED
        scene["loads"] = [
            moment("end" if from_start else "start", [0, 0, value] if dimension == 3 else value)
        ]
        found = read(scene, places, *("tx", "ty", "tz")[:dimension])
        s = places / (edges * edge)
        angle = DRAWN * s + LOADED * (s - (0 if from_start else 1))
        exact = np.column_stack([np.cos(angle), np.sin(angle), 0 * s])[:, :dimension]
        errors.append(np.abs(found - exact).max())
    assert errors[-1] < 1e-3
    assert fitted_order(sizes, errors) < -1.9


def frame(legs, **more):
    """Two legs of length 1, along x and then up."""
    s = np.linspace(0, 1, legs + 1)
    points = [[x, 0.0] for x in s] + [[1.0, y] for y in s[1:]]
    rod = {
        "name": "rod",
        "points": points,
        "cross_section": {"stiffness": {"EA": 1e8, "EI": 1.0, "mass_per_length": 1.0}},
    }
    return {"rods": [rod], "supports": [CLAMPED], "analysis": "static", **more}


@pytest.mark.parametrize("side", ["before", "after"])
def test_slope_has_two_values_at_a_corner(side, fitted_order):
    # A moment at the tip bends both legs to arcs of curvature 0.7.
    exact = 0.7 + (np.pi / 2 if side == "after" else 0.0)
    edges = [4, 8, 16]
    errors = []
    for count in edges:
        probe = {"quantity": "slope", "rod": "rod", "at": 1.0, "side": side}
        scene = frame(count, loads=[moment("end", 0.7)], output={"probes": {"p": probe}})
        errors.append(abs(der.run(scene).probes["p"][-1] - exact) + 1e-15)
    assert errors[-1] < 1e-6 or fitted_order(edges, errors) < -1.9


def test_tangent_in_space_is_that_of_the_plane(fitted_order):
    # Bent toward director 1 and fixed in the plane of x and z, by a force and moments: the closed
    # parts are arcs. Directors lie askew.
    at_end, inside, place = 1.3, 0.9, 0.372
    stiffness = 0.8
    s = np.array(PLACES)
    angle = (at_end * s + inside * np.minimum(s, place)) / stiffness
    exact = np.column_stack([np.cos(angle), 0 * s, np.sin(angle)])
    edges = [10, 20, 40]
    errors = []
    for count in edges:
        rod = {
            "name": "rod",
            "nodes": count + 1,
            "from": [0, 0, 0],
            "to": [1, 0, 0],
            "cross_section": section(EI1=stiffness, EI2=2.0, GJ=0.6, EA=1e8),
        }
        loads = [moment("end", [0, -at_end, 0]), moment(place, [0, -inside, 0])]
        scene = {
            "model": "spatial",
            "rods": [rod],
            "supports": [CLAMPED],
            "loads": loads,
            "analysis": "static",
        }
        found = read(scene, PLACES, "tx", "ty", "tz")
        np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, atol=1e-3)
        errors.append(np.abs(found - exact).max())
    assert fitted_order(edges, errors) < -1.9


def test_tangent_of_a_helix(fitted_order):
    # Without loads the rod has its natural shape: about the vector (-k2, k1, twist) of constant
    # components in the section the tangent turns as on a cone.
    k1, k2, twist = 1.2, -0.7, 2.0
    edges = [20, 40, 80]
    errors = []
    for count in edges:
        rod = {
            "name": "rod",
            "nodes": count + 1,
            "from": [0, 0, 0],
            "to": [1, 0, 0],
            "natural_curvature": [k1, k2],
            "natural_twist": twist,
            "cross_section": section(EI1=0.8, EI2=2.0, GJ=0.6, EA=1e8),
        }
        scene = {"rods": [rod], "supports": [CLAMPED], "analysis": "static"}
        found = read(scene, PLACES, "tx", "ty", "tz")
        # Directors at the start: width along z, height along t x d1 = -y.
        d1, d2, t = np.array([0, 0, 1.0]), np.array([0, -1.0, 0]), np.array([1.0, 0, 0])
        axis = -k2 * d1 + k1 * d2 + twist * t
        rate = np.linalg.norm(axis)
        axis = axis / rate
        turned = [
            t * np.cos(rate * s)
            + np.cross(axis, t) * np.sin(rate * s)
            + axis * (axis @ t) * (1 - np.cos(rate * s))
            for s in PLACES
        ]
        errors.append(np.abs(found - turned).max())
    assert fitted_order(edges, errors) < -1.9


def test_slope_in_space_is_refused():
    scene = straight(4, "clamped-free")
    asked = {"p": {"quantity": "slope", "rod": "rod", "at": "end"}}
    with pytest.raises(der.DerError, match="take 'tx', 'ty' and 'tz'"):
        _ = der.Simulation({**scene, "model": "spatial_bend", "output": {"probes": asked}}).probes
    asked["p"]["quantity"] = "tz"
    with pytest.raises(der.DerError, match="the model 'planar' has no 'tz'"):
        _ = der.Simulation({**scene, "output": {"probes": asked}}).probes
