"""Equilibria of rods in space against solutions of the boundary value problem.

References: `references/bent_cantilever.py`, `princeton_beam.py`, `curved_twisted_rod.py` and, for
ends that are held, `kirchhoff_rod.py` itself. There d1 is the director of the width, and the
curvatures u1 and u2 turn the section about d1 and d2: towards d1 the rod is curved by u2, towards
d2 by -u1.
"""

from itertools import pairwise

import der
import numpy as np
import pytest
from references.curved_twisted_rod import NATURAL, rest_position
from references.kirchhoff_rod import (
    UPRIGHT,
    Held,
    HeldTangent,
    Rod,
    constant,
    directors,
    follow,
    natural_shape,
    rotation,
)
from scenes import END, START, tip_force
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from spatial_scenes import QUANTITIES, measured, rod_through, section, straight_rod

XYZ = ("x", "y", "z")
SIZES = [16, 32, 64]
#: Where what is extrapolated to an end is not yet asymptotic at 16.
FINE = [64, 128, 256]


def orders(fitted_order, sizes, errors):
    """Fitted order of each of the arrays' entries."""
    table = np.array(errors).reshape(len(sizes), -1)
    return np.array([fitted_order([1 / n for n in sizes], column) for column in table.T])


@pytest.mark.parametrize("measure", ["angle", "tangent"])
@pytest.mark.parametrize("load", [300, 600])
@pytest.mark.parametrize("slenderness", [100, 1000, 10000])
def test_45_degree_bend(spatial_reference, fitted_order, load, slenderness, measure):
    """Bathe and Bolourchi 1979. R/w up to 1e4: the error must not depend on it (no locking).

    The curvature `tangent` of a joint that turns by phi is larger, by phi^3/12."""
    side, radius = 100 / slenderness, 100
    label = f"slender.{slenderness}.{load}"
    exact = [spatial_reference("bent_cantilever", f"{label}.{c}") for c in XYZ]
    bending = 1e7 * side**4 / 12
    square = section(EA=1e7 * side**2, EI=bending, GJ=bending)
    errors = []
    for n in SIZES:
        angle = np.linspace(0, np.pi / 4, n + 1)
        points = radius * np.column_stack([np.sin(angle), 1 - np.cos(angle), 0 * angle])
        loads = tip_force(0, 0, load * side**4)
        scene = rod_through(points, square, loads=loads, rod={"curvature": measure})
        tip, _ = measured(scene, ["end"], XYZ)
        errors.append(np.linalg.norm(tip - exact))
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9
    assert errors[-1] < (3e-5 if measure == "angle" else 1.1e-4) * radius


@pytest.mark.parametrize("pounds", [1, 2, 3])
@pytest.mark.parametrize("angle", [0, 15, 30, 45, 60, 75, 90])
def test_princeton_beam(spatial_reference, fitted_order, angle, pounds):
    """Dowell and Traybar 1975; the angle is between weight and width."""

    def value(name):
        return spatial_reference("princeton_beam", name)

    strong, weak = value("EI_strong"), value("EI_weak")
    beam = section([0, 1, 0], EA=value("EA"), EI1=strong, EI2=weak, GJ=value("GJ"))
    weight = pounds * 4.4482216152605
    force = weight * np.array([0, np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))])
    label = f"{pounds}lb.{angle}"
    exact = np.array([value(f"{label}.{c}") for c in ("axial", "chordwise", "flapwise")])
    errors = []
    for n in SIZES:
        scene = straight_rod(n, beam, to=[0.508, 0, 0], loads=tip_force(*force))
        tip, _ = measured(scene, ["end"], XYZ)
        errors.append(np.linalg.norm(tip[0] - [0.508, 0, 0] - exact))
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9
    assert errors[-1] < 2e-5 * 0.508


PLACES = [0.25, 0.5, 0.75, 1.0]
CURVED = {"natural_curvature": [NATURAL[1], -NATURAL[0]], "natural_twist": NATURAL[2]}


def curved_twisted(n, drawn, **more):
    """The rod of references/curved_twisted_rod.py, drawn straight, in its rest shape whose strains
    are also given, or in its rest shape alone."""
    strip = section([1, 0, 0], EA=1e4, EI1=3.0, EI2=1.0, GJ=0.8)
    if drawn == "straight":
        return straight_rod(n, strip, to=[0, 0, 1], rod=CURVED, **more)
    points = np.array([rest_position(NATURAL, s) for s in np.linspace(0, 1, n + 1)])
    points /= np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    natural = CURVED if drawn == "helix with strains" else {}
    return rod_through(points, strip, rod={"initial_twist": NATURAL[2], **natural}, **more)


DRAWN = ["straight", "helix with strains", "helix"]


@pytest.mark.parametrize("drawn", DRAWN)
def test_natural_shape_of_a_curved_and_twisted_rod_is_the_exact_helix(fitted_order, drawn):
    exact = np.array([rest_position(NATURAL, s) for s in PLACES])
    errors = []
    for n in FINE:
        values, _ = measured(curved_twisted(n, drawn), PLACES)
        errors.append(np.linalg.norm(values[:, :3] - exact, axis=1))
        # Curvatures of a polygon on the curve differ from the curve's, by order 2; those of a
        # natural shape that is given are met, and nothing is stressed.
        strains = values[:, 3:6] - [NATURAL[1], -NATURAL[0], NATURAL[2]]
        assert np.abs(strains).max() < (20 / n**2 if drawn == "helix" else 1e-8)
        assert np.abs(values[:, 6:]).max() < 1e-7
    assert (orders(fitted_order, FINE, errors) >= 1.9).all()
    assert np.max(errors[-1]) < 3e-5


@pytest.mark.parametrize("drawn", DRAWN)
def test_curved_and_twisted_rod_under_a_tip_force(spatial_reference, fitted_order, drawn):
    exact = []
    for s in PLACES:

        def value(name, s=s):
            return spatial_reference("curved_twisted_rod", f"tip_force.s{s:g}.{name}")

        k1, k2, twist = value("curvature_2"), -value("curvature_1"), value("twist")
        moments = [3.0 * (k1 - NATURAL[1]), k2 + NATURAL[0], 0.8 * (twist - NATURAL[2])]
        position = [value(c) for c in XYZ]
        exact.append([*position, k1, k2, twist, *moments, 1e4 * value("strain")])
    exact = np.array(exact)
    errors = []
    for n in FINE:
        values, _ = measured(curved_twisted(n, drawn, loads=tip_force(2, -3, 1)), PLACES)
        error = np.abs(values - exact)
        errors.append([*np.linalg.norm(error[:, :3], axis=1), *error[:, 3:].max(axis=0)])
    assert (orders(fitted_order, FINE, errors) >= 1.9).all()
    assert np.max(np.array(errors[-1])[:4]) < 2e-5  # positions; the length is 1
    assert np.max(np.array(errors[-1])[4:7]) < 1e-4  # curvatures and twist of up to 5/m


@pytest.mark.parametrize("edges", [5, 20])
@pytest.mark.parametrize(
    "motion",
    [
        {"twist": 27 * 2 * np.pi},
        {"rotation": {"axis": [1, 0, 0], "angle": 27 * 2 * np.pi}},
    ],
    ids=["twist", "rotation"],
)
def test_27_turns_of_an_end(edges, motion):
    """While the rod is straight, its twist is the same all along, and the torque GJ times it."""
    turned = {**END, "clamp": True, "prescribe": motion}
    supports = [{**START, "clamp": True}, turned]
    rod = section(EI=5e3, GJ=0.8)
    scene = straight_rod(edges, rod, to=[2, 0, 0], supports=supports)
    values, result = measured(scene, ["start", 0.7, "end"], ["twist", "torque"])
    twist = 27 * 2 * np.pi / 2
    assert values == pytest.approx(np.array([[twist, 0.8 * twist]] * 3), rel=1e-10)
    assert result.summary["stability"] == "stable"


@pytest.mark.parametrize(
    ("axis", "angle", "twist", "shift"),
    [
        ((0, 1, 0.3), 0.8, 1.5, (-0.03, 0.1, 0)),
        ((1, 1, 0.3), 1.2, -0.4, (-0.05, 0.1, 0.1)),
    ],
)
def test_clamp_turned_about_an_axis(fitted_order, axis, angle, twist, shift):
    """Both ends held, the last one moved, turned about an axis and twisted."""
    strong, weak, twisting, stretching = 2.0, 1.0, 0.7, 1e4
    unit = np.array(axis) / np.linalg.norm(axis)

    def end(share):
        frame = rotation(unit, share * angle) @ UPRIGHT @ rotation((0, 0, 1), share * twist)
        return Held(np.array([1.0, 0, 0]) + share * np.array(shift), frame)

    rod = Rod(1.0, (weak, strong), twisting, stretching)
    found = follow(rod, Held((0, 0, 0), UPRIGHT), end, steps=4, segments=2, degree=16)
    places = np.array([0.25, 0.5, 0.75])
    u1, u2, u3, strain = found.strains(places)
    exact = np.vstack([found.at(places)[:3], u2, -u1, u3, strong * u2, -weak * u1, twisting * u3])
    exact = np.vstack([exact, stretching * strain]).T

    motion = dict(zip(XYZ, shift, strict=True))
    motion |= {"rotation": {"axis": list(axis), "angle": angle}, "twist": twist}
    supports = [{**START, "clamp": True}, {**END, "clamp": True, "prescribe": motion}]
    beam = section([0, 1, 0], EA=stretching, EI1=strong, EI2=weak, GJ=twisting)
    errors = []
    for n in FINE:
        values, _ = measured(straight_rod(n, beam, supports=supports), places.tolist())
        error = np.abs(values - exact)
        errors.append([np.linalg.norm(error[:, :3]), *error[:, 3:].max(axis=0)])
    assert (orders(fitted_order, FINE, errors) >= 1.9).all()
    assert errors[-1][0] < 5e-6
    assert max(errors[-1][1:7]) < 1e-4
    assert errors[-1][7] < 0.008  # of a tension of up to 40, which is EA times a strain of 4e-3


STRIP = {"EA": 1e6, "EI1": 8.0, "EI2": 1.0, "GJ": 1.5}
TURN = np.pi
ASIDE = np.array([-0.01, 0.1, 0.05])


@pytest.mark.parametrize("torque", [0.0, 0.8])
def test_section_that_spins_in_a_clamp_that_holds_the_tangent(fitted_order, torque):
    """The rod is curved, and bends, about the directors that have spun with it, by half a turn and
    what it twists; at the clamp, too. Of a moment at the clamp's node the rod has the part along
    the tangent, and the clamp takes the rest."""
    natural = np.array([-0.9, 0.6, 1.0])
    rod = Rod(1.0, (1.0, 8.0), 1.5, 1e6, constant(*natural))
    first = Held((0, 0, 0), UPRIGHT @ rotation((0, 0, 1), TURN))
    loose = natural_shape(rod, first, np.linspace(0, 1, 3), 16).values[-1, :, -1]
    chord, loose_tangent, along = loose[:3], directors(loose[3:7])[:, 2], np.array([1.0, 0, 0])

    def end(share):
        # A rod that goes aside gets shorter by the square of the way.
        aside = np.array([share**2, share, share]) * ASIDE
        tangent = (1 - share) * loose_tangent + share * along
        place = (1 - share) * chord + share * along + aside
        return HeldTangent(place, tangent / np.linalg.norm(tangent), share * torque)

    found = follow(rod, first, end, steps=24, segments=2, degree=20)
    places = np.array([0.0, 0.5, 1.0])
    u1, u2, u3, _ = found.strains(places)
    m1, m2, m3 = rod.stiffness[:, None] * (found.strains(places)[:3] - natural[:, None])
    exact = np.vstack([found.at(places)[:3], u2, -u1, u3, m2, -m1, m3]).T

    loads = [{"moment": {**END, "moment": [torque, 0.5, -0.3]}}] if torque else []
    supports = [
        {**START, "clamp": True, "prescribe": {"twist": TURN}},
        {**END, "clamp": "tangent", "prescribe": dict(zip(XYZ, ASIDE.tolist(), strict=True))},
    ]
    curved = {"natural_curvature": [0.6, 0.9], "natural_twist": 1.0}
    sizes, errors = [128, 256, 512], []  # asymptotic for a rod that is bent this much
    for n in sizes:
        scene = straight_rod(
            n, section([0, 1, 0], **STRIP), supports=supports, rod=curved, loads=loads
        )
        values, result = measured(scene, places.tolist())
        errors.append(np.abs(values[:, :9] - exact))
    assert result.summary["warnings"] == []
    scale = np.abs(exact).max(axis=0)
    assert (errors[-1] < 3e-4 * scale).all()
    for i, place in enumerate(places):
        for k, size in enumerate(scale):
            column = np.array([error[i, k] for error in errors])
            if column.max() > 1e-9 * size:  # else held, or known
                assert fitted_order([1 / n for n in sizes], column) > 1.9, (place, k, column)


@pytest.mark.parametrize("measure", ["angle", "tangent"])
@pytest.mark.parametrize(("loose", "held"), [(START, END), (END, START)])
def test_how_far_a_section_has_spun_in_its_clamp_does_not_count(loose, held, measure):
    """A rod that spins in the clamp of its tangent, as the section at its other end is turned, is
    the rod that is drawn turned."""

    def shape(turned, director, actuated):
        motion = {"y": 0.2, "z": 0.1, "x": 0.0, "twist": turned}
        supports = [{**loose, "clamp": "tangent"}, {**held, "clamp": True, "prescribe": motion}]
        curved = {"natural_curvature": [0.6, 0.9], "curvature": measure}
        scene = straight_rod(
            8, section(director, **(STRIP | {"EA": 1e3})), supports=supports, rod=curved
        )
        if actuated:
            scene["actuation"] = [{"name": "winding", "rod": "rod", "natural_twist": 1.0}]
        else:
            scene["rods"][0]["natural_twist"] = 1.0
        values, result = measured(scene, ["start", 0.3, "end"], QUANTITIES)
        return result.positions[-1], values

    drawn, values = shape(0.0, [0, np.cos(TURN / 3), np.sin(TURN / 3)], False)
    for actuated in (False, True):
        spun, same = shape(TURN / 3, [0, 1, 0], actuated)
        assert spun == pytest.approx(drawn, abs=1e-9)
        assert same == pytest.approx(values, abs=1e-6)


def test_tension_at_clamps(fitted_order):
    """The edge beside a clamp stretches over its whole length, of which a part is held along the
    tangent: straight rods have the same tension everywhere, bent ones that of the boundary value
    problem."""
    pulled = {**END, "clamp": True, "prescribe": {"x": 1e-3}}
    supports = [{**START, "clamp": True}, pulled]
    scene = straight_rod(8, section(EA=1e4, EI=1.0, GJ=1.0), supports=supports)
    tension, _ = measured(scene, ["start", 0.1, "middle", "end"], ["tension"])
    assert tension == pytest.approx(np.full((4, 1), 10.0), rel=1e-9)

    rod = Rod(1.0, (1.0, 1.0), 1.0, 1e4)
    swung = rotation((0, 0, 1), 0.5) @ UPRIGHT

    def end(share):
        return Held((1 - 0.01 * share, 0, 0), rotation((0, 0, 1), 0.5 * share) @ UPRIGHT)

    found = follow(rod, Held((0, 0, 0), UPRIGHT), end, steps=4, segments=2, degree=16)
    assert found.tip_frame == pytest.approx(swung, abs=1e-9)
    exact = 1e4 * found.strains(np.array([0.0, 1.0]))[3]
    motion = {"x": -0.01, "rotation": {"axis": [0, 0, 1], "angle": 0.5}}
    supports[1] = {**END, "clamp": True, "prescribe": motion}
    errors = []
    for n in FINE:
        scene = straight_rod(n, section(EA=1e4, EI=1.0, GJ=1.0), supports=supports)
        tension, _ = measured(scene, ["start", "end"], ["tension"])
        errors.append(np.abs(tension[:, 0] - exact))
    # Tension of a bent rod between clamps: the force's component along the edge, extrapolated.
    assert (orders(fitted_order, FINE, errors) >= 1.9).all()
    assert np.max(errors[-1]) < 5e-3 * np.abs(exact).max()


def arc_and_straight(n):
    """A rod drawn straight whose natural shape is a straight half and an arc, each of its own twist
    that grows along it."""
    s = np.linspace(0, 1, n + 1)
    curved = {
        "natural_curvature": [[2.0, -1.0] if x > 0.5 else [0.0, 0.0] for x in s],
        "natural_twist": (3.0 * s**2).tolist(),
    }
    strip = section([1, 0, 0], EA=1e4, EI1=3.0, EI2=1.0, GJ=0.8)
    return straight_rod(n, strip, to=[0, 0, 1], rod=curved)


def test_list_of_natural_twists(fitted_order):
    """Free of loads the rod takes its natural shape, here integrated, without any energy."""

    def rate(s, y):
        u1, u2 = (1.0, 2.0) if s > 0.5 else (0.0, 0.0)
        d = y[3:].reshape(3, 3)
        spin = np.array([[0, -3 * s * s, u2], [3 * s * s, 0, -u1], [-u2, u1, 0]])
        return np.concatenate([d[:, 2], (d @ spin).ravel()])

    start = np.concatenate([np.zeros(3), np.eye(3).ravel()])
    half = solve_ivp(rate, (0, 0.5), start, rtol=1e-11, atol=1e-13).y[:, -1]
    exact = solve_ivp(rate, (0.5 + 1e-15, 1), half, rtol=1e-11, atol=1e-13).y[:3, -1]
    sizes, errors = [15, 31, 63], []  # the halves meet in the middle of an edge
    for n in sizes:
        values, result = measured(arc_and_straight(n), ["end", 0.2, 0.8], (*XYZ, "twist", "torque"))
        errors.append(np.linalg.norm(values[0, :3] - exact))
        assert values[:, 4] == pytest.approx(np.zeros(3), abs=1e-7)
        twist = np.interp(
            [1, 0.2, 0.8], np.linspace(0, 1, n + 1), 3 * np.linspace(0, 1, n + 1) ** 2
        )
        assert values[:, 3] == pytest.approx(twist, abs=1e-7)
        assert result.energies["bend"][-1] < 1e-14
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


@pytest.mark.parametrize("at", ["start", "end"])
def test_natural_twist_that_varies_up_to_a_clamp_of_the_tangent(at):
    """The section turns freely in the clamp: it has its natural twist, which is linear."""
    edges = 10
    natural = 1 + 2 * np.linspace(0, 1, edges + 1)
    other = {"start": "end", "end": "start"}[at]
    clamps = [
        {"rod": "rod", "at": at, "clamp": "tangent"},
        {"rod": "rod", "at": other, "clamp": True},
    ]
    rod = straight_rod(
        edges,
        section(EA=1e4, EI=1.0, GJ=1.0),
        rod={"natural_twist": natural.tolist()},
        supports=clamps,
    )
    places = np.array([0, 0.01, 0.04, 0.06, 0.5, 0.94, 0.96, 0.99, 1])
    values, _ = measured(rod, places.tolist(), ["twist", "natural_twist", "torque"])
    assert values[:, 0] == pytest.approx(1 + 2 * places, abs=1e-9)
    assert values[:, 1] == pytest.approx(1 + 2 * places, abs=1e-12)
    assert values[:, 2] == pytest.approx(0 * places, abs=1e-9)


#: Corners of 90, 54 and 70 degrees; legs of 1, 0.8 and 0.6 m.
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 0.8, 0], [1, 1.153, 0.485]])
FORCE = 1e-6 * np.array([0.5, -0.3, 1.0])


def tip_of_a_bent_wire(corners, force, EI1, EI2, GJ):
    """Displacement of the end by the unit-load theorem, with sections that go round corners without
    twist: the directors turn by the smallest rotation."""
    moments_per_force = [np.cross(unit, np.eye(3)).T for unit in np.eye(3)]
    first, before = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0, 0])
    flexibility = np.zeros((3, 3))
    for start, end in pairwise(corners):
        length = np.linalg.norm(end - start)
        tangent = (end - start) / length
        first = Rotation.align_vectors([tangent], [before])[0].apply(first)
        axes = np.array([first, np.cross(tangent, first), tangent])
        before = tangent
        # Simpson's rule is exact for squares of moments.
        for share, weight in ((0.0, 1 / 6), (0.5, 4 / 6), (1.0, 1 / 6)):
            arm = corners[-1] - (start + share * (end - start))
            moments = axes @ sum(a * m for a, m in zip(arm, moments_per_force, strict=True))
            flexibility += (
                weight * length * moments.T @ np.diag([1 / EI2, 1 / EI1, 1 / GJ]) @ moments
            )
    return flexibility @ force


@pytest.mark.parametrize("stiffness", [(1.0, 1.0, 1.0), (2.0, 0.5, 0.3)])
def test_a_wire_with_corners(fitted_order, stiffness):
    """Cells at corners bend and twist by halves, so that corners keep the order 2."""
    EI1, EI2, GJ = stiffness
    exact = tip_of_a_bent_wire(CORNERS, FORCE, EI1, EI2, GJ)
    wire = section([0, 0, 1], EA=1e6, EI1=EI1, EI2=EI2, GJ=GJ)
    errors = []
    for n in SIZES:
        shares = np.linspace(0, 3, 3 * (n // 2) + 1)
        points = np.column_stack([np.interp(shares, range(4), CORNERS[:, i]) for i in range(3)])
        tip, _ = measured(rod_through(points, wire, loads=tip_force(*FORCE)), ["end"], XYZ)
        errors.append(np.linalg.norm(tip[0] - CORNERS[-1] - exact))
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9
    assert errors[-1] < 2e-4 * np.linalg.norm(exact)


def test_director_stands_across_the_start_of_a_curve(fitted_order):
    """The default director, on a curve that leaves its first edge: differences of order 2.

    Across the first edge instead of the tangent at the start, the sections are turned by an angle
    of order 1, and all answers with them.
    """

    def tip(n):
        t = np.linspace(0, 5, n + 1)
        points = np.column_stack([np.cos(t), 0.8 * np.sin(t), 0.2 * np.sin(2 * t + 1)]) / 5
        section = {"EA": 1e4, "EI1": 0.5, "EI2": 3, "GJ": 0.7, "mass_per_length": 1}
        simulation = der.Simulation(
            {
                "model": "spatial",
                "rods": [
                    {
                        "name": "rod",
                        "points": points.tolist(),
                        "cross_section": {"stiffness": section},
                    }
                ],
                "supports": [{"rod": "rod", "at": "start", "clamp": True}],
                "loads": [{"point_force": {"rod": "rod", "at": "end", "force": [0, 1, 3]}}],
                "analysis": "static",
            }
        )
        simulation.equilibrium()
        return np.array(simulation.positions[-1])

    sizes = [40, 80, 160, 320]
    tips = [tip(n) for n in sizes]
    changes = [np.linalg.norm(b - a) for a, b in pairwise(tips)]
    assert fitted_order([1 / n for n in sizes[1:]], changes) > 1.9
