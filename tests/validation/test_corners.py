"""Rods drawn with corners, and with jumps of the curvature, against `references/bent_wire.py` and
statics."""

import der
import numpy as np
import pytest
from references.bent_wire import Leg, Wire
from references.kirchhoff_rod import rotation
from scipy.integrate import solve_ivp
from spatial_scenes import CLAMPED, QUANTITIES, rod_through, section

SIZES = [16, 32, 64]  # edges a leg
STRONG, WEAK, TWISTING, STRETCHING = 2.0, 1.0, 0.7, 1e3
#: Direction of the third leg in the plane of the first three.
THIRD = np.radians(80 + 50) - 0.6
#: A leg along x, corners of 80 and 50 degrees with an arc between them, one of 70 out of the plane.
LEGS = (
    Leg(0.5, ((0.0, 0.0, 1.0), 0.0)),
    Leg(0.5, ((0.0, 0.0, 1.0), np.radians(80)), bent=(0.0, 0.0, -1.2)),
    Leg(0.3, ((0.0, 0.0, 1.0), np.radians(50))),
    Leg(0.4, ((np.sin(THIRD), -np.cos(THIRD), 0.0), np.radians(70))),
)
#: A straight leg, an arc, an arc of another radius in another plane, a straight leg: no corners.
SMOOTH = ((0.0, 0.0, 1.0), 0.0)
JOINED = (
    Leg(0.5, SMOOTH),
    Leg(0.5, SMOOTH, bent=(0.0, 0.0, -1.2)),
    Leg(0.3, SMOOTH, bent=(2.0 * np.sin(0.6), 2.0 * np.cos(0.6), 1.5)),
    Leg(0.4, SMOOTH),
)
#: Those of `references/bent_wire.py`.
COLUMNS = [*QUANTITIES, "tx", "ty", "tz"]
#: Where everything has two values: leg and share of it.
SIDES = {
    f"{side} corner {corner}": place
    for corner in (1, 2, 3)
    for side, place in (("before", (corner - 1, 1.0)), ("after", (corner, 0.0)))
}
#: On the edges beside.
NEAR = {
    f"near {side} corner {corner}": place
    for corner in (1, 2, 3)
    for side, place in (("before", (corner - 1, 0.985)), ("after", (corner, 0.015)))
}


def at(points, edges, leg, share):
    """The place of a probe: a node and a side, or an arc length."""
    number = round((leg + share) * edges)
    if share in (0.0, 1.0):
        return {"at": {"node": number}, "side": "after" if share == 0.0 else "before"}
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    return {"at": float(np.interp((leg + share) * edges, np.arange(len(arc)), arc))}


def found(wire, edges, places, quantities, planar=False, **more):
    """Values at the places, shape (places, quantities)."""
    points = wire.points(edges)
    EI1, EI2, GJ, EA = wire.stiffness
    sides = ("x", "y", "z")
    probes = {}
    for i, place in enumerate(places):
        for quantity in quantities:
            probe = {"rod": "rod", "quantity": quantity, **at(points, edges, *place)}
            if quantity in sides:
                probe.pop("side", None)
            probes[f"{quantity}-{i}"] = probe
    dimension = 2 if planar else 3
    loads = [
        {"point_force": {"rod": "rod", **at(points, edges, leg, share), "force": list(force)}}
        for leg, (share, force) in [*wire.inside.items(), (len(wire.legs) - 1, (1.0, wire.tip))]
    ]
    for load in loads:
        load["point_force"].pop("side", None)
        load["point_force"]["force"] = load["point_force"]["force"][:dimension]
    if planar:
        cross_section = section(EA=EA, EI=EI1)
    else:
        cross_section = section(wire.frame[:, 0], EA=EA, EI1=EI1, EI2=EI2, GJ=GJ)
    springs = [
        {"rod": "rod", "at": {"node": leg * edges}, "spring": {"rotational_stiffness": list(k)}}
        for leg, k in wire.springs.items()
    ]
    more["supports"] = [*CLAMPED, *springs]
    scene = rod_through(points[:, :dimension], cross_section, loads=loads, **more)
    scene["model"] = "planar" if planar else "spatial"
    result = der.run(der.Scenario.from_dict({**scene, "output": {"probes": probes}}))
    values = [[result.probes[f"{q}-{i}"][-1] for q in quantities] for i in range(len(places))]
    return np.array(values)


def check_orders(fitted_order, sizes, errors, scale, names, quantities):
    """`errors`: (sizes, places, quantities)."""
    assert (np.abs(errors[-1]) < 5e-4 * scale).all()
    for i, name in enumerate(names):
        for k, quantity in enumerate(quantities):
            if np.abs(errors[:, i, k]).max() < 2e-5 * scale[k]:
                continue  # terms of order 3 are as large
            order = fitted_order([1 / n for n in sizes], errors[:, i, k])
            assert order > 1.9, (name, quantity, order)


def compare(fitted_order, wire, quantities, planar=False, sizes=SIZES, **more):
    """Orders on both sides of the corners, and errors on the edges beside these: there they depend
    on where in its edge a place lies."""
    columns = [COLUMNS.index(quantity) for quantity in quantities]
    names = [quantity.removesuffix("_1") for quantity in quantities] if planar else quantities
    exact = wire.solve([*SIDES.values(), *NEAR.values()])[:, columns]
    scale = np.abs(exact).max(axis=0)
    sides = exact[: len(SIDES)]
    errors = np.array(
        [found(wire, n, SIDES.values(), names, planar, **more) - sides for n in sizes]
    )
    check_orders(fitted_order, sizes, errors, scale, SIDES, quantities)
    for n in sizes:
        near = found(wire, n, NEAR.values(), names, planar, **more) - exact[len(SIDES) :]
        assert (np.abs(near) < 2.0 / n**2 * scale).all()


def along_x(director):
    tangent = np.array([1.0, 0.0, 0.0])
    return np.column_stack([director, np.cross(tangent, director), tangent])


def test_what_jumps_at_a_corner(fitted_order):
    """Forces and moments go through a corner, but the section has another direction behind it."""
    frame = along_x([0.0, 0.6, 0.8])
    wire = Wire(LEGS, frame, (STRONG, WEAK, TWISTING, STRETCHING), tip=(1.0, 0.7, -1.4))
    compare(fitted_order, wire, QUANTITIES)


NATURAL = {
    "twist given": ((0.0, 0.0, 0.9), {"rod": {"natural_twist": 0.9}}),
    "twist actuated": (
        (0.0, 0.0, 0.9),
        {"actuation": [{"name": "turn", "rod": "rod", "natural_twist": 0.9}]},
    ),
    "bent and twisted": (
        (0.5, -0.8, 0.6),
        {
            "actuation": [
                {"name": "turn", "rod": "rod", "natural_twist": 0.6},
                {"name": "bend", "rod": "rod", "natural_curvature": [0.5, -0.8]},
            ]
        },
    ),
}


@pytest.mark.parametrize("spring", [{}, {2: (0.8, 3.0, 0.5)}], ids=["free", "on a spring"])
@pytest.mark.parametrize("case", list(NATURAL))
def test_a_natural_shape_beyond_the_drawn_one_goes_through_corners(fitted_order, case, spring):
    """Half of the cell at a corner has it about the axes of each leg, and so has the rod on the way
    from the edges to a spring."""
    natural, more = NATURAL[case]
    wire = Wire(
        LEGS,
        along_x([0.0, 0.6, 0.8]),
        (STRONG, WEAK, TWISTING, STRETCHING),
        tip=(0.5, 0.3, -0.7),
        natural=natural,
        springs=spring,
    )
    compare(fitted_order, wire, QUANTITIES, sizes=[3 * n for n in SIZES], **more)


def test_what_jumps_at_a_corner_in_the_plane(fitted_order):
    """The moment does not."""
    legs = (*LEGS[:3], Leg(0.4, ((0.0, 0.0, 1.0), np.radians(-100))))
    frame = along_x([0.0, 1.0, 0.0])
    wire = Wire(legs, frame, (1.0, 1.0, 1.0, STRETCHING), tip=(0.6, -0.9, 0.0))
    compare(fitted_order, wire, ("x", "y", "curvature_1", "moment_1", "tension"), planar=True)


def test_what_a_jump_of_the_drawn_curvature_leaves(fitted_order):
    """The section goes on, and the edges beside lean against it, each by half of what it turns."""
    frame = along_x([0.0, 0.6, 0.8])
    wire = Wire(JOINED, frame, (STRONG, WEAK, TWISTING, STRETCHING), tip=(1.0, 0.7, -1.4))
    compare(fitted_order, wire, COLUMNS)


def test_what_a_jump_of_the_drawn_curvature_leaves_in_the_plane(fitted_order):
    """The arcs bend to opposite sides."""
    legs = (*JOINED[:2], Leg(0.3, SMOOTH, bent=(0.0, 0.0, 2.5)), Leg(0.4, SMOOTH))
    wire = Wire(legs, along_x([0.0, 1.0, 0.0]), (1.0, 1.0, 1.0, STRETCHING), tip=(0.6, -0.9, 0.0))
    quantities = ("x", "y", "curvature_1", "moment_1", "tension", "tx", "ty")
    compare(fitted_order, wire, quantities, planar=True)


class PolynomialLeg:
    """A leg drawn through p(t) = sum of t^k p_k, t in [0, 1], with p_0 = 0."""

    def __init__(self, *coefficients):
        self.coefficients = np.array([np.zeros(3), *coefficients], dtype=float)

    def __call__(self, t, derivative=0):
        coefficients = np.polynomial.polynomial.polyder(self.coefficients, derivative)
        return np.polynomial.polynomial.polyval(t, coefficients)

    def tangent(self, t):
        slope = self(t, 1)
        return slope / np.linalg.norm(slope, axis=0)

    def transported(self, director, times):
        """Along the leg without twist: the director turns towards the tangent alone."""

        def rate(t, director):
            tangent, slope = self.tangent(t), self(t, 1)
            bent = self(t, 2) - (self(t, 2) @ tangent) * tangent
            return -(director @ bent) / np.linalg.norm(slope) * tangent

        return solve_ivp(
            rate, (0.0, 1.0), director, t_eval=times, method="DOP853", rtol=1e-11, atol=1e-13
        ).y.T


#: Curved in a plane, straight, curved in space, curved in another plane, straight.
CURVED = (
    PolynomialLeg((0.5, 0.1, 0.0), (0.1, 0.4, 0.0)),
    PolynomialLeg((0.2, -0.1, 0.7)),
    PolynomialLeg((-0.4, 0.3, 0.1), (0.0, 0.4, 0.2), (0.2, 0.0, -0.2)),
    PolynomialLeg((0.1, -0.2, -0.5), (0.0, -0.3, 0.1)),
    PolynomialLeg((0.6, 0.3, 0.0)),
)


def smallest_rotation(a, b):
    axis = np.cross(a, b)
    return rotation(axis / np.linalg.norm(axis), np.arctan2(np.linalg.norm(axis), a @ b))


def test_directors_behind_corners_out_of_the_plane_of_a_curved_leg(fitted_order):
    """From the tangent of one leg to that of the next by the smallest rotation. Edges of different
    lengths, sections that turn as they are drawn."""
    sizes, spin = (20, 40, 80, 160), 0.8
    errors = []
    for n in sizes:
        share = np.linspace(0.0, 1.0, n + 1)
        times = share + 0.4 * share * (1.0 - share)
        points, exact = [np.zeros((1, 3))], []
        director = np.array([0.3, -0.4, 0.8])
        before = CURVED[0].tangent(0.0)
        director -= (director @ before) * before
        director /= np.linalg.norm(director)
        for leg in CURVED:
            director = smallest_rotation(before, leg.tangent(0.0)) @ director if exact else director
            points.append(points[-1][-1] + leg(times[1:]).T)
            exact.append(leg.transported(director, [*(0.5 * (times[1:] + times[:-1])), 1.0]))
            director, before = exact[-1][-1], leg.tangent(1.0)
        points = np.vstack(points)
        strip = section([0.3, -0.4, 0.8], EA=1e3, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
        scene = rod_through(points, strip, rod={"initial_twist": spin})
        edges = np.linalg.norm(np.diff(points, axis=0), axis=1)
        middles = np.cumsum(edges) - 0.5 * edges
        found = der.Simulation(der.Scenario.from_dict(scene)).directors
        off = []
        for i, (leg, directors) in enumerate(zip(CURVED, exact, strict=True)):
            at = n // 2
            tangent = leg.tangent(0.5 * (times[at] + times[at + 1]))
            turned = rotation(tangent, spin * middles[i * n + at]) @ directors[at]
            off.append(found[i * n + at] - turned)
        errors.append(np.linalg.norm(off, axis=1))
    errors = np.array(errors)
    assert (errors[-1] < 1e-3).all()
    for leg in range(len(CURVED)):
        assert fitted_order([1 / n for n in sizes], errors[:, leg]) > 1.9, errors[:, leg]


def out_of_plane_wire():
    """An arc, a straight leg, an arc, an arc: at each of its corners it leaves the plane of the leg
    before, and an arc begins out of the plane of the corner."""
    frame = along_x([0.0, 0.6, 0.8])
    legs, here = [], frame
    for length, (turn, about), (curvature, towards) in (
        (0.4, (0.0, 0.0), (2.5, 0.3)),
        (0.5, (1.3, 2.0), (0.0, 0.0)),
        (0.6, (1.2, 4.0), (2.2, 1.0)),
        (0.35, (1.1, 0.5), (3.0, 3.5)),
    ):
        axis = np.cos(about) * here[:, 0] + np.sin(about) * here[:, 1]
        here = rotation(axis, turn) @ here
        bent = curvature * (np.cos(towards) * here[:, 0] + np.sin(towards) * here[:, 1])
        legs.append(Leg(length, (tuple(axis), turn), tuple(bent)))
        here = legs[-1].turned(length) @ here
    return Wire(legs, frame, (STRONG, WEAK, TWISTING, STRETCHING), tip=(1.0, 0.7, -1.4))


def test_a_strip_bent_out_of_the_plane_of_its_arcs(fitted_order):
    """Its sides behind a corner, the axes of its stiffnesses, are turned with it. Arcs of circles
    have the exact directors on any mesh."""
    wire, sizes = out_of_plane_wire(), (20, 40, 80, 160)
    places = {**SIDES, "end": (3, 1.0)}
    exact = wire.solve(list(places.values()))[:, : len(QUANTITIES)]
    errors = np.array([found(wire, n, places.values(), QUANTITIES) - exact for n in sizes])
    check_orders(fitted_order, sizes, errors, np.abs(exact).max(axis=0), places, QUANTITIES)
    for n in sizes[:2]:
        strip = section(wire.frame[:, 0], EA=1e3, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
        scene = rod_through(wire.points(n), strip, supports=[])
        drawn = [
            (leg.turned(leg.length * (k + 0.5) / n) @ frame)[:, 0]
            for leg, frame in zip(wire.legs, wire.frames(), strict=True)
            for k in range(n)
        ]
        directors = der.Simulation(der.Scenario.from_dict(scene)).directors
        assert directors == pytest.approx(np.array(drawn), abs=1e-12)


@pytest.mark.parametrize("natural", [{}, {"natural_twist": 0.7}], ids=["as drawn", "given"])
@pytest.mark.parametrize("inside", [[], [20, 47, 60]], ids=["free", "clamped at corners"])
def test_a_strip_bent_out_of_the_plane_of_its_arcs_has_the_twist_drawn(natural, inside):
    """Free of stress, as its natural twist is that of the drawn sections."""
    wire, n = out_of_plane_wire(), 20
    points = wire.points(n)
    strip = section(wire.frame[:, 0], EA=1e3, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
    places = ["start", *({"node": node} for node in inside)]
    supports = [{"rod": "rod", "at": place, "clamp": True} for place in places]
    probes = {
        f"{quantity}-{node}-{side}": {
            "rod": "rod",
            "at": {"node": node},
            "side": side,
            "quantity": quantity,
        }
        for quantity in ("twist", "natural_twist", "torque")
        for node in (10, 20, 40, 60)
        for side in ("before", "after")
    }
    rod = {"initial_twist": 0.7, **natural}
    scene = rod_through(points, strip, supports, rod=rod, output={"probes": probes})
    result = der.run(der.Scenario.from_dict(scene))
    assert result.positions[-1] == pytest.approx(points, abs=1e-9)
    for name, values in result.probes.items():
        exact = 0.0 if name.startswith("torque") else 0.7
        assert values[-1] == pytest.approx(exact, abs=1e-6), name


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_clamp_where_the_curvature_jumps(fitted_order, dimension):
    """It holds the tangent that both sides have; hardly loaded, they bear what statics says."""
    force = 1e-5
    sizes = (8, 16, 32)
    exact = {"tx": (1.0, 1.0), "ty": (0.0, 0.0), "tension": (0.0, 0.0)}
    if dimension == 2:
        exact |= {"moment": (0.5, 0.3)}
    else:
        exact |= {"moment_1": (0.5, 0.3), "moment_2": (-0.5, -0.3), "torque": (0.0, 0.3)}
    errors = []
    for n in sizes:
        angle = np.linspace(0.0, np.pi / 2, n + 1)[1:, None]
        arc = np.hstack([0.5 + 0.3 * np.sin(angle), 0.3 - 0.3 * np.cos(angle)])
        points = np.vstack([np.linspace([0.0, 0.0], [0.5, 0.0], n + 1), arc])
        points = np.hstack([points, np.zeros((len(points), dimension - 2))])
        loads = [
            {"point_force": {"rod": "rod", "at": end, "force": [0.0, force, force][:dimension]}}
            for end in ("start", "end")
        ]
        stiffness = {"EI": 1.0} if dimension == 2 else {"EI": 1.0, "GJ": 0.7}
        here = {"rod": "rod", "at": {"node": n}}
        supports = [{**here, "clamp": True}]
        scene = rod_through(points, section(EA=1e4, **stiffness), supports, loads=loads)
        scene["model"] = "planar" if dimension == 2 else "spatial"
        probes = {
            f"{name}_{side}": {**here, "quantity": name, "side": side}
            for name in exact
            for side in ("before", "after")
        }
        result = der.run(der.Scenario.from_dict({**scene, "output": {"probes": probes}}))
        values = np.reshape([values[-1] for values in result.probes.values()], (-1, 2))
        values[2:] /= force
        errors.append(values - list(exact.values()))
    assert np.abs(errors[-1]).max() < 2e-3
    for error in np.reshape(errors, (len(sizes), -1)).T:
        if np.abs(error).max() > 2e-4:
            assert fitted_order([1 / n for n in sizes], error) > 1.9


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_rod_that_turns_has_its_tangent_where_the_curvature_jumps(dimension):
    """A straight leg and an arc, with edges of other lengths, turn freely about their middle. So
    slowly that they keep their shape: after 0.2 s the leg points where it did, and 0.3 rad on."""
    rate, angle = 1.5, np.linspace(0.0, 1.0, 8)[1:, None]
    arc = np.hstack([0.5 + 0.6 * np.sin(angle), 0.6 - 0.6 * np.cos(angle)])
    points = np.vstack([np.linspace([0.0, 0.0], [0.5, 0.0], 12), arc])
    points -= points.mean(axis=0)
    velocities = rate * np.column_stack([-points[:, 1], points[:, 0]])
    flat = np.zeros((len(points), dimension - 2))
    scene = rod_through(np.hstack([points, flat]), section(EA=1e8, EI=1e5, GJ=1e5))
    scene["model"] = "planar" if dimension == 2 else "spatial"
    scene["supports"] = []
    scene["rods"][0]["initial_velocity"] = np.hstack([velocities, flat]).tolist()
    del scene["analysis"]
    scene["time"] = {"duration": 0.2, "step": 1e-3, "integrator": "generalized_alpha"}
    probes = {name: {"rod": "rod", "quantity": name, "at": {"node": 11}} for name in ("tx", "ty")}
    result = der.run(der.Scenario.from_dict({**scene, "output": {"probes": probes}}))
    tangent = [result.probes[name][-1] for name in ("tx", "ty")]
    assert tangent == pytest.approx([np.cos(0.3), np.sin(0.3)], abs=1e-4)


@pytest.fixture(params=["planar", "spatial"])
def dimension(request):
    return 2 if request.param == "planar" else 3


def ell(dimension, stiffness, loads, probes, angle=90):
    """Final values of the probes on a clamped frame of two legs of 0.5 m in the x-y plane."""
    share = np.linspace(0.0, 0.5, 6)[:, None]
    second = [np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0]
    points = np.vstack([share * [1, 0, 0], [0.5, 0, 0] + share[1:] * second])[:, :dimension]
    cross_section = {"stiffness": {"mass_per_length": 1.0, "GJ": stiffness["EI"], **stiffness}}
    scene = rod_through(points, cross_section, loads=loads)
    scene["model"] = "planar" if dimension == 2 else "spatial"
    scene["output"] = {"probes": {name: {"rod": "rod", **probe} for name, probe in probes.items()}}
    result = der.run(der.Scenario.from_dict(scene))
    return {name: values[-1] for name, values in result.probes.items()}


@pytest.mark.parametrize("angle", [90, 25, 7])
def test_torque_becomes_a_moment_behind_a_corner(angle):
    """A tip force across the plane bends one leg, and twists and bends the other: by statics. Small
    angles are corners too where they stand alone."""
    force, leg = 1e-5, 0.5  # so small that the frame keeps its shape
    sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    corner = {"at": {"node": 5}}
    values = ell(
        3,
        {"EA": 1e6, "EI": 1.0, "GJ": 0.2},
        [{"point_force": {"rod": "rod", "at": "end", "force": [0, 0, force]}}],
        {
            "before": {"quantity": "torque", **corner, "side": "before"},
            "after": {"quantity": "torque", **corner, "side": "after"},
            "moment_before": {"quantity": "moment", **corner, "side": "before"},
            "moment_after": {"quantity": "moment", **corner, "side": "after"},
            "moment_near": {"quantity": "moment", "at": 0.48},
            "greatest": {"quantity": "torque", "over": "rod", "reduce": "max"},
            "most_curved": {"quantity": "curvature", "over": "rod", "reduce": "max"},
        },
        angle,
    )
    exact = {
        "before": force * leg * sine,
        "after": 0.0,
        "moment_before": force * leg * cosine,
        "moment_after": force * leg,
        "moment_near": force * (0.02 + leg * cosine),
        "greatest": force * leg * sine,
        "most_curved": force * leg * (1.0 + cosine),
    }
    assert values == pytest.approx(exact, abs=1e-6 * force)


def test_tension_at_a_right_angle(dimension):
    """A stiff frame: the force is (1, 3) in both legs."""
    tension = {"quantity": "tension"}
    force = [1.0, 3.0, 0.0][:dimension]
    values = ell(
        dimension,
        {"EA": 1e8, "EI": 1e6},
        [{"point_force": {"rod": "rod", "at": "end", "force": force}}],
        {
            "before": {**tension, "at": {"node": 5}, "side": "before"},
            "after": {**tension, "at": {"node": 5}, "side": "after"},
            "near_before": {**tension, "at": 0.48},
            "near_after": {**tension, "at": 0.52},
            "greatest": {**tension, "over": "rod", "reduce": "max"},
            "least": {**tension, "over": "rod", "reduce": "min"},
        },
    )
    exact = [1.0, 3.0, 1.0, 3.0, 3.0, 1.0]
    assert list(values.values()) == pytest.approx(exact, abs=1e-5)


def test_places_beside_a_corner_lie_on_their_leg(dimension):
    """An unloaded frame: no place is beyond the corner, and nothing lies outside the legs."""
    probes = {
        f"{quantity}_{i}": {"quantity": quantity, "at": s}
        for i, s in enumerate((0.47, 0.52))
        for quantity in "xy"
    }
    probes |= {
        "greatest": {"quantity": "x", "over": "rod", "reduce": "max"},
        "least": {"quantity": "y", "over": "rod", "reduce": "min"},
    }
    values = ell(dimension, {"EA": 1e8, "EI": 1.0}, [], probes)
    exact = [0.47, 0.0, 0.5, 0.02, 0.5, 0.0]
    assert list(values.values()) == pytest.approx(exact, abs=1e-12)


def test_forces_beside_a_corner(fitted_order):
    """Within the first two edges on either side of a corner, at 1/5 and 4/5 of an edge. The rod
    does not stretch: forces between nodes along it stretch it to order 1."""
    inside = {0: (0.96, (0.8, 1.5, -0.9)), 1: (0.04, (-1.0, 0.9, 0.6))}
    frame = along_x([0.0, 0.6, 0.8])
    wire = Wire(LEGS, frame, (STRONG, WEAK, TWISTING, 1e8), (0.4, 0.3, -0.5), inside)
    places = {"start": (0, 0.0), "before": (0, 1.0), "after": (1, 0.0), "end": (3, 1.0)}
    exact = wire.solve(list(places.values()))[:, : len(QUANTITIES)]
    sizes = [20, 45, 70, 95]  # in the edge at the corner, and three times in the next one
    errors = np.array([found(wire, n, places.values(), QUANTITIES) - exact for n in sizes])
    scale = np.abs(exact).max(axis=0)
    check_orders(fitted_order, sizes[1:], errors[1:], scale, places, QUANTITIES)
    assert (np.abs(errors[0]) < 5e-4 * (95 / 20) ** 2 * scale).all()


def test_a_clamp_beside_a_corner_holds_the_leg():
    """A leg of one edge is straight: its clamp has its direction and not one that bends into the
    corner."""
    points = [[0, 0], [0.5, 0], [0.5, 0.5]]
    scene = rod_through(points, section(EA=1e8, EI=1.0))
    scene["model"] = "planar"
    turn = {"rod": "rod", "quantity": "turning_angle", "at": "start"}
    scene["output"] = {"probes": {"turn": turn}}
    result = der.run(der.Scenario.from_dict(scene))
    assert result.probes["turn"][-1] == pytest.approx(0.0, abs=1e-12)


#: Two legs that meet at a corner of about a radian, from their outer ends to it.
CORNER_LEGS = ((0.5, 0.0), (0.6, 1.0))
#: What the leg at a clamp has there.
HELD = {2: ("moment", "tension", "slope"), 3: ("moment_1", "moment_2", "torque", "tension", "tx")}
FORCES = ([-0.4, 0.5, 0.7], [0.3, -0.6, 0.5])


def leg_points(edges, bent, dimension):
    """Nodes of the two legs, each from the corner at the origin on."""
    legs = []
    for number, (length, direction) in enumerate(CORNER_LEGS):
        s = np.linspace(0.0, length, edges + 1)
        away = np.pi if number == 0 else direction
        curvature = bent * (-1.0 if number == 0 else 1.5)
        chord = s * np.sinc(curvature * s / (2 * np.pi))
        angle = away + curvature * s / 2
        flat = np.zeros((edges + 1, dimension - 2))
        legs.append(np.column_stack([chord * np.cos(angle), chord * np.sin(angle), flat]))
    return legs


def at_corner_clamp(points, node, loads, probes, dimension, turned=0.0, **rod):
    """Final values of the probes of a rod with a clamp at a node."""
    stiffness = {"EI": 1.0} if dimension == 2 else {"EI1": 1.0, "EI2": 0.6, "GJ": 0.2}
    support = {"rod": "rod", "at": {"node": node}, "clamp": True}
    if turned and dimension == 2:
        support["prescribe"] = {"angle": turned}
    elif turned:
        support["prescribe"] = {"rotation": {"axis": [0, 1, 1], "angle": turned}}
    director = None if dimension == 2 else [0, 0, 1]
    scene = rod_through(points, section(director, EA=1e4, **stiffness), [support], rod=rod)
    scene["model"] = "planar" if dimension == 2 else "spatial"
    scene["loads"] = [{"point_force": {"rod": "rod", **load}} for load in loads]
    scene["output"] = {"probes": {name: {"rod": "rod", **probe} for name, probe in probes.items()}}
    result = der.run(der.Scenario.from_dict(scene))
    return np.array([values[-1] for values in result.probes.values()]), result


@pytest.mark.parametrize("turned", [0.0, 0.4], ids=["as drawn", "turned"])
@pytest.mark.parametrize("bent", [0.0, 1.0], ids=["straight", "bent"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_clamp_at_a_corner_holds_each_leg(fitted_order, dimension, bent, turned):
    """Either leg is the same as alone, with a clamp at its end: its nodes to rounding. Fields of a
    strip are read from other places beside a corner than at an end."""
    sizes = (20, 40, 80)
    errors = []
    for n in sizes:
        before, after = leg_points(n, bent, dimension)
        points = np.vstack([before[::-1], after[1:]])
        ends = ("start", "end")
        forces = [force[:dimension] for force in FORCES]
        loads = [{"at": end, "force": force} for end, force in zip(ends, forces, strict=True)]
        probes = {
            f"{quantity}_{side}": {"quantity": quantity, "at": {"node": n}, "side": side}
            for side in ("before", "after")
            for quantity in HELD[dimension]
        }
        both, result = at_corner_clamp(points, n, loads, probes, dimension, turned)
        alone = []
        for leg, node in ((points[: n + 1], n), (points[n:], 0)):
            own = {q: {"quantity": q, "at": {"node": node}} for q in HELD[dimension]}
            load = loads[0 if node else 1]
            values, of_leg = at_corner_clamp(leg, node, [load], own, dimension, turned)
            part = slice(0, n + 1) if node else slice(n, None)
            assert result.positions[-1][part] == pytest.approx(of_leg.positions[-1], abs=1e-9)
            alone.append(values)
        errors.append(both - np.concatenate(alone))
    assert np.abs(errors[-1]).max() < 2e-5
    for error in np.transpose(errors):
        if np.abs(error).max() > 2e-5:
            assert fitted_order([1 / n for n in sizes], error) > 1.9


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_ring_clamped_at_the_corner_where_it_starts(dimension):
    """It is the rod through its nodes that both ends clamp, there and back."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.7, 0.8], [0.0, 0.0]])
    n = 8
    s = np.arange(3 * n) / n
    points = np.column_stack([np.interp(s, np.arange(4), corners[:, c]) for c in (0, 1)])
    points = np.hstack([points, np.zeros((3 * n, dimension - 2))])
    load = {"at": {"node": n}, "force": [0.3, -0.6, 0.5][:dimension]}
    probes = {
        f"{quantity}_{side}": {"quantity": quantity, "at": {"node": 0}, "side": side}
        for side in ("before", "after")
        for quantity in HELD[dimension]
        if quantity != "slope"
    }
    ring, closed = at_corner_clamp(points, 0, [load], probes, dimension, closed=True)
    names = [quantity for quantity in HELD[dimension] if quantity != "slope"]
    own = {f"{q}_{at}": {"quantity": q, "at": at} for at in ("end", "start") for q in names}
    stiffness = {"EI": 1.0} if dimension == 2 else {"EI1": 1.0, "EI2": 0.6, "GJ": 0.2}
    scene = rod_through(
        np.vstack([points, points[:1]]),
        section(None if dimension == 2 else [0, 0, 1], EA=1e4, **stiffness),
        [{"rod": "rod", "at": at, "clamp": True} for at in ("start", "end")],
        loads=[{"point_force": {"rod": "rod", **load}}],
        output={"probes": {name: {"rod": "rod", **probe} for name, probe in own.items()}},
    )
    scene["model"] = "planar" if dimension == 2 else "spatial"
    opened = der.run(der.Scenario.from_dict(scene))
    assert closed.positions[-1] == pytest.approx(opened.positions[-1][:-1], abs=1e-9)
    exact = np.array([values[-1] for values in opened.probes.values()])
    assert ring == pytest.approx(exact, abs=1e-2 * np.abs(exact).max())


def test_a_clamp_at_a_corner_has_no_one_tangent_to_twist_about():
    points = np.vstack([p[::-1] if i == 0 else p[1:] for i, p in enumerate(leg_points(4, 0.0, 3))])
    support = {"rod": "rod", "at": {"node": 4}, "clamp": True, "prescribe": {"twist": 0.1}}
    scene = rod_through(points, section(EI=1.0, GJ=0.2), [support])
    with pytest.raises(der.DerError, match="at a corner and holds two"):
        der.Simulation(der.Scenario.from_dict(scene))


@pytest.mark.parametrize("longer", [1.0, 1.6], ids=["equal edges", "longer edges on the arc"])
@pytest.mark.parametrize("holds", ["clamp", "spring"])
def test_natural_curvatures_that_jump_where_the_drawn_ones_do(dimension, holds, longer):
    """Free of stress: a clamp or a spring at the node of the jump bears nothing. The chain's cells
    turn by `l kappa (1 - (l kappa)^2/24)` between chords, which is all that is left."""
    bears, sizes = [], (10, 20, 40)
    radius, angle = 0.4, 0.9
    for n in sizes:
        turn = angle / n
        edge = 2.0 * radius * np.sin(0.5 * turn)
        arc = np.arange(1, n + 1)[:, None] * turn
        leg = np.arange(-n, 1)[:, None] * edge / longer * [1.0, 0.0]
        arc = radius * np.hstack([np.sin(arc), 1.0 - np.cos(arc)])
        points = np.vstack([leg, arc])
        points = np.hstack([points, np.zeros((len(points), dimension - 2))])
        share = longer / (1.0 + longer)
        curvatures = [*[0.0] * n, share / radius, *[1.0 / radius] * n]
        if dimension == 3:
            curvatures = [[curvature, 0.0] for curvature in curvatures]
        here = {"rod": "rod", "at": {"node": n}}
        held = {"clamp": True} if holds == "clamp" else {"spring": {"rotational_stiffness": 30.0}}
        stiffness = {"EI": 1.0} if dimension == 2 else {"EI1": 1.0, "EI2": 2.0, "GJ": 0.7}
        scene = rod_through(
            points,
            section([0.0, 1.0, 0.0] if dimension == 3 else None, EA=1e5, **stiffness),
            [{"rod": "rod", "at": "start", "clamp": True}, {**here, **held}],
            rod={"natural_curvature": curvatures},
        )
        scene["model"] = "planar" if dimension == 2 else "spatial"
        quantity = "reaction_moment" if dimension == 2 else "reaction_moment_z"
        probes = {"moment": {"quantity": quantity, "support": 1}}
        result = der.run(der.Scenario.from_dict({**scene, "output": {"probes": probes}}))
        bears.append(abs(result.probes["moment"][-1]))
    # An error of order 1 would leave a quarter of an edge times the curvature 1/radius.
    assert np.all(np.array(bears) < 0.1 * angle**2 / np.array(sizes) ** 2 / radius)


@pytest.mark.parametrize("at", [0.333333, 0.333334])
@pytest.mark.parametrize(
    "joints", [[], [{"name": "elbow", "of": [{"rod": "rod", "at": "middle"}]}]]
)
def test_a_probe_with_a_side_finds_the_corner_by_a_rounded_number(at, joints):
    """A corner at a third of the rod, with an own tension and slope on either side."""
    n = 12
    points = [[k / (3 * n), 0.0] for k in range(n + 1)]
    points += [[1 / 3, k / (3 * n)] for k in range(1, 2 * n + 1)]
    places = {"rounded": at, "exact": {"node": n}}
    probes = {
        f"{quantity}-{side}-{name}": {"rod": "rod", "at": place, "side": side, "quantity": quantity}
        for quantity in ("slope", "tension", "moment")
        for side in ("before", "after")
        for name, place in places.items()
    }
    load = {"point_force": {"rod": "rod", "at": "end", "force": [0.02, -0.05]}}
    frame = {
        "rods": [{"name": "rod", "points": points, "cross_section": section(EA=1e3, EI=0.1)}],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "loads": [load],
        "joints": joints,
        "analysis": "static",
        "output": {"probes": probes},
    }
    found = der.run(frame).probes
    for quantity in ("slope", "tension", "moment"):
        sides = [found[f"{quantity}-{side}-exact"][-1] for side in ("before", "after")]
        rounded = [found[f"{quantity}-{side}-rounded"][-1] for side in ("before", "after")]
        assert rounded == sides
    assert found["slope-after-exact"][-1] - found["slope-before-exact"][-1] > 1.5
