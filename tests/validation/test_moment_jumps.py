"""Moments, torque, curvatures and twist of rods in space on both sides of moments and of springs
against turning inside them, against the boundary value problem of `references/kirchhoff_rod.py`.
"""

import functools

import der
import numpy as np
import pytest
from references.kirchhoff_rod import UPRIGHT, Held, Loaded, Rod, constant, cross, follow
from scenes import END, tip_force
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from spatial_scenes import CLAMPED, section, straight_rod

# At a clamp the moment of a rod that stretches noticeably is of order 1 (docs/results.md).
STRONG, WEAK, TWISTING, STRETCHING = 2.0, 1.0, 0.7, 1e5
CURVED = (0.8, -0.6, 1.5)  # natural curvatures and twist, about d1, d2, d3
STRAIGHT = (0.0, 0.0, 0.0)
TIP = (1.2, -0.5, 0.7)
TIP_MOMENT = (0.8, 0.3, -0.2)
MOMENT = np.array([0.6, -0.9, 0.5])  # fixed axes, or as drawn
SPRINGS = np.array([2.0, 0.7, 1.1])  # towards director 1, director 2, about the tangent
QUANTITIES = (
    *("curvature_1", "curvature_2", "twist"),
    *("moment_1", "moment_2", "torque", "tension"),
)


def spring(d, _share):
    """Minus the slope of 1/2 k strain^2 of a section with the frame d, which may be complex.

    The strains are those of a joint between the drawn frame and d (docs/space.md, "Mechanics"):
    kappa_k = f(t0 . t) m_k . t, with m_k the drawn directors turned by half of the twist. A
    rotation omega changes t by omega x t, t0 . t by omega . (t x t0), and the twist by
    omega . (t0 + t)/(1 + t0 . t).
    """
    d1, d2, t0 = UPRIGHT.T
    d = d / np.sqrt(d[:, 2] @ d[:, 2])  # quaternions have no unit norm yet while they are sought
    t = d[:, 2]
    cosine = t0 @ t
    axis = cross(t0 + 0 * t, t)
    moved = cosine * d1 + cross(axis, d1 + 0 * t) + (axis @ d1) / (1 + cosine) * axis
    twist = np.arctan(-(moved @ d[:, 1]) / (moved @ d[:, 0]))
    by_twist = (t0 + t) / (1 + cosine)
    x = 1 - cosine
    if abs(x) < 1e-3:
        f = 1 + x / 3 + 2 * x**2 / 15 + 2 * x**3 / 35
        slope = -1 / 3 - 4 * x / 15 - 6 * x**2 / 35
    else:
        f = np.arccos(cosine) / np.sqrt(1 - cosine**2)
        slope = (cosine * f - 1) / (1 - cosine**2)
    c, s = np.cos(twist / 2), np.sin(twist / 2)
    first, second = c * d1 + s * d2, c * d2 - s * d1
    k1, k2, kt = SPRINGS
    moment = kt * twist * by_twist
    for k, director, turned in ((k1, first, second), (k2, second, -first)):
        strain = f * (director @ t)
        by_omega = slope * (director @ t) * cross(t, t0 + 0 * t)
        by_omega = by_omega + f * cross(t, director) + f * (turned @ t) / 2 * by_twist
        moment = moment + k * strain * by_omega
    return np.concatenate([np.zeros(3), -moment])


def fixed(_d, share):
    return np.concatenate([np.zeros(3), share * MOMENT])


def following(d, share):
    return np.concatenate([np.zeros(3), share * d @ (UPRIGHT.T @ MOMENT)])


def moment(at, follower):
    return {"moment": {"rod": "rod", "at": at, "moment": MOMENT.tolist(), "follower": follower}}


def held(at):
    return {"rod": "rod", "at": at, "spring": {"rotational_stiffness": SPRINGS.tolist()}}


#: The action inside the rod: for the reference, as a load of the scene or as a support, and the
#: natural shape. (A spring assumes that the drawn shape is the natural one.)
CASES = {
    "fixed": (fixed, lambda at: moment(at, False), None, CURVED),
    "follower": (following, lambda at: moment(at, True), None, CURVED),
    "spring": (spring, None, held, STRAIGHT),
}


@functools.cache
def exact(name, at, places):
    """Values at places (arc length, side), shape (places, quantities)."""
    load, _, _, natural = CASES[name]
    rod = Rod(1.0, (WEAK, STRONG), TWISTING, STRETCHING, constant(*natural))
    borders = np.unique([0.0, at, *np.linspace(at, 1.0, 3)])
    found = follow(
        rod,
        Held((0, 0, 0), UPRIGHT),
        lambda share: Loaded(share * np.array(TIP), share * np.array(TIP_MOMENT)),
        steps=2,
        segments=borders,
        degree=10,
        inside=[(0, load)],
    )
    stations = np.array([s - 1e-12 if side == "before" else s for s, side in places])
    u1, u2, u3, strain = found.strains(stations)
    n1, n2, n3 = natural
    moments = [STRONG * (u2 - n2), -WEAK * (u1 - n1), TWISTING * (u3 - n3)]
    return np.vstack([u2, -u1, u3, *moments, STRETCHING * strain]).T


def found(name, at, places, edges):
    _, load, support, natural = CASES[name]
    beam = section([0, 1, 0], EA=STRETCHING, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
    shape = {"natural_curvature": [natural[1], -natural[0]], "natural_twist": natural[2]}
    turn = {"moment": {**END, "moment": list(TIP_MOMENT)}}
    scene = straight_rod(
        edges,
        beam,
        rod=shape,
        loads=[*([load(at)] if load else []), *tip_force(*TIP), turn],
        supports=[*CLAMPED, *([support(at)] if support else [])],
    )
    probes = {
        f"{quantity}-{i}": {"rod": "rod", "at": s, "quantity": quantity, "side": side}
        for quantity in QUANTITIES
        for i, (s, side) in enumerate(places)
    }
    result = der.run(der.Scenario.from_dict({**scene, "output": {"probes": probes}}))
    return np.array(
        [[result.probes[f"{q}-{i}"][-1] for q in QUANTITIES] for i in range(len(places))]
    )


def worst_errors(name, at, places, sizes):
    """Relative to the largest value of each quantity, the largest of moments, torque and strains
    and that of the tension: two arrays, shape (sizes, places). `at(n)` and `places(n)` are those of
    a mesh with n edges.
    """
    truths = [exact(name, at(n), places(n)) for n in sizes]
    errors = np.array(
        [found(name, at(n), places(n), n) - truth for n, truth in zip(sizes, truths, strict=True)]
    )
    errors = np.abs(errors) / np.abs(truths[-1]).max(axis=0)
    return errors[:, :, :-1].max(axis=2), errors[:, :, -1]


@pytest.mark.parametrize(
    "sizes",
    [(78, 158), (82, 162), (80, 160)],
    ids=["first half of an edge", "second half", "at a node"],
)
@pytest.mark.parametrize("name", CASES)
def test_both_sides_of_a_jump(name, sizes, fitted_order):
    """All places are at the same part of their edges on every mesh."""
    at = 0.4
    places = ((0.0, "after"), (0.25, "after"), (0.35, "after"), (at, "before"), (at, "after"))
    places += ((0.45, "after"), (1.0, "before"))
    worst, tension = worst_errors(name, lambda _: at, lambda _: places, sizes)
    steps = [1 / n for n in sizes]
    assert worst[-1].max() < 2e-4
    for place, column in zip(places, worst.T, strict=True):
        assert fitted_order(steps, column) > 1.9, (place, column)
    # Over all places at once: at one that follows a moment the error changes its sign.
    assert fitted_order(steps, tension.max(axis=1)) > 1.9
    assert tension[-1].max() < 1e-4


@pytest.mark.parametrize("edges", [0.2, 1.3])
@pytest.mark.parametrize("name", ["fixed", "spring"])
def test_beside_a_clamp(name, edges, fitted_order):
    """At the same part of the first edges on every mesh."""

    def places(n):
        return ((0.0, "after"), (edges / n, "before"), (edges / n, "after"), (0.3, "after"))

    sizes = (80, 160)
    worst, tension = worst_errors(name, lambda n: edges / n, places, sizes)
    assert worst[-1].max() < 1e-4
    for place, column in zip(places(sizes[-1]), worst.T, strict=True):
        assert fitted_order([1 / n for n in sizes], column) > 1.9, (place, column)
    # Up to the moment there is one middle of an edge at most: no slope (docs/limits.md).
    assert tension[-1].max() < 1e-2


def tension_of_elastica(force, moment, stiffness, drawn):
    """Tension of the inextensible rod of EI = L = 1 in its plane, drawn with a curvature, clamped
    at the start, at the end of which a force, a moment and a spring against turning act:
    theta'' = -(Fy cos theta - Fx sin theta), and the tension is the force along the tangent."""

    def march(start):
        def rate(_, y):
            return [y[1], force[0] * np.sin(y[0]) - force[1] * np.cos(y[0])]

        return solve_ivp(rate, (0, 1), [0, start], rtol=1e-12, atol=1e-13, dense_output=True)

    def missing(start):
        angle, curvature = march(start).y[:, -1]
        return curvature - drawn - moment + stiffness * (angle - drawn)

    angles = march(brentq(missing, -8, 8)).sol

    def tension(s):
        theta = angles(s)[0]
        return force[0] * np.cos(theta) + force[1] * np.sin(theta)

    return tension


def arc(curvature, n):
    """Nodes on an arc of length 1 from the origin, which it leaves along x."""
    s = np.linspace(0, 1, n + 1)
    if curvature == 0:
        return np.column_stack([s, 0 * s])
    turned = curvature * s
    return np.column_stack([np.sin(turned), 1 - np.cos(turned)]) / curvature


@pytest.mark.parametrize("in_space", [False, True], ids=["plane", "space"])
@pytest.mark.parametrize("drawn", [0.0, -1.3], ids=["straight", "arc"])
@pytest.mark.parametrize("stiffness", [0.0, 0.6])
def test_tension_at_an_end_that_is_bent(stiffness, drawn, in_space, fitted_order):
    """The edge there leans against the curve; by a moment, and by a spring, too. It does not by the
    curvature of an arc on which its nodes are drawn."""
    force, places = (1.5, -0.8), (0.8, 0.99, "end")
    moment = 1.2 if stiffness == 0 else 0.0
    tension = tension_of_elastica(force, moment, stiffness, drawn)
    truth = np.array([tension(1.0 if s == "end" else s) for s in places])
    bar = {"EA": 1e7, "EI1": 1.7, "EI2": 1.0, "GJ": 0.8, "mass_per_length": 1.0}
    if not in_space:
        bar = {"EA": 1e7, "EI": 1.0, "mass_per_length": 1.0}

    def vector(x, y):
        return [x, y, 0.0] if in_space else [x, y]

    supports = [*CLAMPED]
    loads = [{"point_force": {**END, "force": vector(*force)}}]
    if stiffness > 0:
        against = [1e-9, stiffness, 1e-9] if in_space else stiffness
        supports.append({**END, "spring": {"rotational_stiffness": against}})
    else:
        loads.append({"moment": {**END, "moment": [0, 0, moment] if in_space else moment}})
    errors = []
    sizes = (20, 40, 80)
    for n in sizes:
        rod = {"name": "rod", "points": [vector(x, y) for x, y in arc(drawn, n).tolist()]}
        scene = {
            "rods": [{**rod, "cross_section": {"stiffness": bar}}],
            "supports": supports,
            "loads": loads,
            "analysis": "static",
            "output": {
                "probes": {
                    f"at_{i}": {"rod": "rod", "at": s, "quantity": "tension"}
                    for i, s in enumerate(places)
                }
            },
        }
        if in_space:
            scene["rods"][0]["cross_section"]["director"] = [0, 0, 1]
            scene["model"] = "spatial"
        probes = der.run(scene).probes
        errors.append([probes[f"at_{i}"][-1] for i in range(len(places))] - truth)
    for column in np.transpose(errors):
        assert fitted_order([1 / n for n in sizes], column) > 1.9
    assert np.abs(errors[-1]).max() < 1e-3
