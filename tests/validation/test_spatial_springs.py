"""Springs and foundations in space.

References: beam theory for small loads; `references/springs.py` for large ones, of an elastically
clamped elastica; `references/springs_in_space.py` for springs that are soft about some axes;
`references/curved_twisted_rod.py` for curved rods; the planar models, whose own references are in
test_springs.py and test_foundation.py.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from references.curved_twisted_rod import NATURAL, rest_position
from references.kirchhoff_rod import rotation
from references.springs_in_space import (
    CASES,
    STRETCHING,
    TOWARDS_FIRST,
    TOWARDS_SECOND,
)
from references.springs_in_space import TWISTING as TORSIONAL
from scenes import START
from scipy.optimize import root
from spatial_scenes import CLAMPED, measured, rod_through, section, straight_rod

XYZ = ("x", "y", "z")
SIZES = [16, 32, 64]
FINE = [64, 128, 256]  # of helices: 3.7 rad a length
STRONG, WEAK, TWISTING = 3.0, 1.0, 0.8
STRIP = section([0, 1, 0], EA=1e6, EI1=STRONG, EI2=WEAK, GJ=TWISTING)  # director 1 = y
SMALL = 1e-6


def force(*components, at="end"):
    return {"point_force": {"rod": "rod", "at": at, "force": list(components)}}


def moment(*components, at="end", follower=False):
    return {"moment": {"rod": "rod", "at": at, "moment": list(components), "follower": follower}}


def turning_spring(*stiffness, at="start", **more):
    return {"rod": "rod", "at": at, "spring": {"rotational_stiffness": list(stiffness)}, **more}


def check_order(errors, fitted_order, largest, sizes=SIZES):
    assert np.max(errors[-1]) < largest
    for column in np.array(errors).T:
        if column.max() > 1e-6:  # else exact but for the large deflection and the stretching
            assert fitted_order([1 / n for n in sizes], column) > 1.9


@pytest.mark.parametrize("end", ["start", "end"])
@pytest.mark.parametrize("k", [(0.5, 2.0, 0.3), (1e6, 1e-1, 1e5)])
def test_an_elastic_clamp(fitted_order, end, k):
    """Tip forces across and a torque: EI/L^3 and 1/k in series, about each axis its own."""
    k1, k2, kt = k
    load, torque = SMALL * min(k1, k2, 1), SMALL * min(kt, 1)
    free = "end" if end == "start" else "start"
    support = turning_spring(k1, k2, kt, at=end, fix=list(XYZ))
    errors = []
    for n in SIZES:
        bent = straight_rod(n, STRIP, supports=[support], loads=[force(0, load, 2 * load, at=free)])
        values, _ = measured(bent, [free], ("y", "z"))
        exact = load * np.array([1 / (3 * STRONG) + 1 / k1, 2 / (3 * WEAK) + 2 / k2])
        errors.append(np.abs(values[0] - exact) / exact)
        twisted = straight_rod(n, STRIP, supports=[support], loads=[moment(torque, 0, 0, at=free)])
        _, result = measured(twisted, [free], ["x"])
        turned = torque * (1 / kt + (1 - 0.5 / n) / TWISTING)
        assert result.theta[-1][-1 if end == "start" else 0] == pytest.approx(turned, rel=1e-9)
    check_order(errors, fitted_order, 2e-3)


@pytest.mark.parametrize("place", [0.013, 0.29, 0.5, 0.7183])
def test_a_turning_spring_at_any_place(place):
    """A cantilever with a spring inside: the redundant moment by beam theory."""
    k = 5.0
    supports = [*CLAMPED, turning_spring(k, k, k, at=place)]
    errors = []
    for n in SIZES:
        scene = straight_rod(n, STRIP, supports=supports, loads=[force(0, SMALL, SMALL)])
        values, _ = measured(scene, ["end"], ("y", "z"))
        stiffness = np.array([STRONG, WEAK])
        slope = (place - place**2 / 2) / stiffness  # at the spring, under the force alone
        reaction = slope / (1 / k + place / stiffness)
        exact = SMALL * (1 / (3 * stiffness) - reaction * slope)
        errors.append(np.abs(values[0] - exact) / exact)
    # The error is of order 2. Its factor jumps from mesh to mesh with the place within the edge.
    if place > 2 / SIZES[0]:
        assert (np.array(errors).max(axis=1) * np.array(SIZES) ** 2 < 1.0).all()
    assert np.max(errors[-1]) < 5e-3


@pytest.mark.parametrize(("stiffness", "load"), [(1, 10), (20, 10)])
def test_an_elastic_clamp_under_a_large_load(reference, fitted_order, stiffness, load):
    """The elastica of references/springs.py, in a plane that is none of the coordinate planes."""
    turn = rotation(np.array([2, 1, -2]) / 3, 0.7)
    rod = section(turn @ [0, 0.6, 0.8], EA=1e8, EI=1.0, GJ=0.7)
    label = f"elastic_clamp.{stiffness}.load.{load}"
    exact = [reference("springs", f"{label}.{axis}") for axis in "xy"]
    support = turning_spring(stiffness, stiffness, stiffness, fix=list(XYZ))
    errors = []
    sizes = [64, 128, 256]
    for n in sizes:
        scene = straight_rod(
            n,
            rod,
            to=turn @ [1, 0, 0],
            supports=[support],
            loads=[force(*(turn @ [0, load, 0]))],
        )
        tip = measured(scene, ["end"], XYZ)[0][0] @ turn
        errors.append([np.linalg.norm(tip - [*exact, 0])])
    check_order(errors, fitted_order, 1e-5, sizes)


def sprung(case, n, turn, **more):
    """A rod of references/springs_in_space.py, all of it turned."""
    supports = CLAMPED if case.clamped else [{**START, "fix": list(XYZ)}]
    springs = [turning_spring(*spring.stiffness, at=spring.place) for spring in case.springs]
    rod = section(
        turn @ [0, 1, 0],
        EA=STRETCHING,
        EI1=TOWARDS_FIRST,
        EI2=TOWARDS_SECOND,
        GJ=TORSIONAL,
    )
    natural = {"natural_curvature": list(case.natural[:2]), "natural_twist": case.natural[2]}
    moments = [
        moment(*(turn @ spring.moment), at=spring.place, follower=spring.follows)
        for spring in case.springs
        if any(spring.moment)
    ]
    return straight_rod(
        n,
        rod,
        to=turn @ [1, 0, 0],
        rod=natural if any(case.natural) else {},
        supports=[*supports, *springs],
        loads=[force(*(turn @ case.force)), *moments],
        **more,
    )


@pytest.mark.parametrize("name", CASES)
def test_springs_soft_about_some_axes(spatial_reference, fitted_order, name):
    """They turn far about these and bear moments about the others. The rod between a spring and
    the next edges bends about axes that have turned with it. Moments of loads at the very places of
    springs turn the same sections."""
    case = CASES[name]
    turn = rotation(np.array([2, 1, -2]) / 3, 0.7)

    def exact(place, quantities):
        return [spatial_reference("springs_in_space", f"{name}.{place}.{q}") for q in quantities]

    moments = ("moment_1", "moment_2", "torque")
    ends = [
        place for place, s in (("start", 0.0), ("end", 1.0)) if s in {k.place for k in case.springs}
    ]
    has_potential = not any(any(spring.moment) for spring in case.springs)
    # Under moments of 2 EI the next term of the error still counts on 20 edges.
    sizes = (20, 40, 80) if has_potential else (40, 80, 160)
    errors = []
    for n in sizes:
        values, result = measured(sprung(case, n, turn), ["end", *ends], [*XYZ, *moments])
        errors.append(
            [
                np.linalg.norm(values[0, :3] @ turn - exact("end", XYZ)),
                *(
                    np.linalg.norm(row[3:] - exact(place, moments))
                    for place, row in zip(ends, values[1:], strict=True)
                ),
            ]
        )
        assert result.summary["stability"] == ("stable" if has_potential else "not_judged")
    check_order(errors, fitted_order, 1e-4, sizes)


@pytest.mark.parametrize("case", ["soft", "moment", "moment that follows"])
def test_a_motion_on_soft_springs_keeps_its_energy(fitted_order, case):
    """The implicit midpoint rule loses energy of order 2 in the step, beside the work of the
    moments."""
    losses = []
    for step in (2e-3, 1e-3, 5e-4):
        time = {"duration": 0.5, "step": step, "integrator": "implicit_midpoint"}
        scene = sprung(CASES[case], 8, np.eye(3), time=time)
        scene["rods"][0]["cross_section"]["stiffness"]["rotary_inertia"] = 1e-2
        work = measured(scene, ["end"], XYZ)[1].work
        losses.append(abs(work["numerical"][-1] / work["loads"][-1]))
    assert fitted_order([2e-3, 1e-3, 5e-4], losses) > 1.9
    assert losses[-1] < 3e-5


@pytest.mark.parametrize("share", [0.05, 0.3, 0.49])
def test_a_turning_spring_beside_a_clamp_that_turns(share):
    """Within half an edge of it, the rod on to the end being straight: beam theory, exactly."""
    k, edges, turned = 3.0, 10, 0.02
    place = share / edges
    rod = section([0, 1, 0], EA=1e6, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
    spring = turning_spring(k, k, k, at=place)
    for axis, stiffness in (("x", TWISTING), ("z", STRONG), ("y", WEAK)):
        motion = {"rotation": {"axis": [float(axis == a) for a in XYZ], "angle": turned}}
        if axis == "x":
            motion = {"twist": turned}
        supports = [{**START, "clamp": True, "prescribe": motion}, spring]
        _, result = measured(straight_rod(edges, rod, supports=supports), ["end"], XYZ)
        edge = np.diff(result.positions[-1], axis=0)[-1]
        found = {"x": result.theta[-1][-1], "y": -edge[2] / edge[0], "z": edge[1] / edge[0]}[axis]
        exact = turned / (1 + k * place / stiffness)
        assert found == pytest.approx(exact, rel=3e-4)


@pytest.mark.parametrize("s", [0.3, 0.3717, 1.0])
def test_a_spring_along_an_axis_at_any_place(fitted_order, s):
    k = np.array([20.0, 300.0])
    spring = {"rod": "rod", "at": s, "spring": {"stiffness": [0, *k.tolist()]}}
    errors = []
    for n in SIZES:
        scene = straight_rod(n, STRIP, supports=[*CLAMPED, spring], loads=[force(0, SMALL, SMALL)])
        values, _ = measured(scene, ["end"], ("y", "z"))
        stiffness = np.array([STRONG, WEAK])
        across = s**2 * (3 - s) / 6 / stiffness
        exact = SMALL * (1 / (3 * stiffness) - across**2 / (1 / k + s**3 / (3 * stiffness)))
        errors.append(np.abs(values[0] - exact) / exact)
    check_order(errors, fitted_order, 2e-3)


def held_elastically(model, axis, time=None):
    """A clamped rod on a foundation and springs, all acting along y or along z."""
    unit = np.eye(3)[1 if axis == "y" else 2]
    supports = [
        *CLAMPED,
        {"rod": "rod", "at": 0.437, "spring": {"stiffness": (20 * unit).tolist()}},
        {"rod": "rod", "at": "end", "spring": {"rotational_stiffness": 0.5}},
    ]
    foundation = {"rod": "rod", "stiffness": (50 * unit).tolist(), "from": 0.15, "to": 0.77}
    rod = section(EA=1e4, EI=1.0, GJ=0.7, rotary_inertia=1e-3)
    more = {} if time is None else {"time": time}
    scene = straight_rod(
        12,
        rod,
        supports=supports,
        loads=[{"foundation": foundation}, force(*(8 * unit).tolist())],
        **more,
    )
    quantities = ("x", axis)
    values, result = measured({**scene, "model": model}, [0.3, "middle", "end"], quantities)
    return values, [result.energies[k][-1] for k in ("spring", "stretch")], result


@pytest.mark.parametrize("time", [None, {"duration": 0.2, "step": 0.01}], ids=["static", "motion"])
def test_along_z_as_in_the_plane(time):
    """The spring against turning has the energy of its cell besides in the plane alone."""
    planar, _, _ = held_elastically("planar", "y", time)
    for axis in "yz":
        values, _, result = held_elastically("spatial", axis, time)
        assert values == pytest.approx(planar, abs=1e-9)
        if time is None:
            assert result.summary["stability"] == "stable"


@pytest.mark.parametrize("time", [None, {"duration": 0.2, "step": 0.01}], ids=["static", "motion"])
@pytest.mark.parametrize("place", ["start", 0.437, "end"])
def test_a_moment_at_the_place_of_a_spring_as_in_the_plane(place, time):
    """The two are in series with the rod between them and the edges: forces, energies and works."""

    springs = [
        {"rod": "rod", "at": at, "spring": {"rotational_stiffness": k}}
        for at, k in (("start", 7.0), (place, 30.0))
    ]

    def answer(model):
        scene = straight_rod(
            12,
            section(EA=1e4, EI=1.0, GJ=0.7, rotary_inertia=1e-3),
            supports=[
                {**START, "fix": list(XYZ)},
                *springs,
            ],
            loads=[moment(0, 0, 2.0, at=place), force(0, 1.5, 0)],
            **({} if time is None else {"time": time}),
        )
        quantities = ("x", "y", "tension")
        values, result = measured({**scene, "model": model}, ["start", 0.3, "end"], quantities)
        energies = [result.energies[k][-1] for k in ("stretch", "bend", "spring")]
        return values, energies, 0.0 if time is None else result.work["loads"][-1]

    for spatial, planar in zip(answer("spatial"), answer("planar"), strict=True):
        assert spatial == pytest.approx(planar, abs=1e-9)


def test_a_twisting_spring_counts_whole_turns():
    """One end turned three times, the other held by a spring: GJ/L and k in series."""
    k, turns = 0.4, 3 * 2 * np.pi
    supports = [
        {**START, "clamp": True, "prescribe": {"twist": turns}},
        turning_spring(0, 0, k, at="end", fix=["y", "z"]),
    ]
    rod = section(EI=50.0, GJ=TWISTING)
    values, _ = measured(straight_rod(10, rod, supports=supports), ["middle"], ["torque"])
    assert abs(values[0, 0]) == pytest.approx(turns / (1 / k + 1 / TWISTING), rel=1e-9)


LEGS = 0.6, 0.4


@dataclass(frozen=True)
class TwoLegs:
    """A rod of two arcs of the lengths LEGS, from the origin along x with director 1 along z.

    `curvatures` of the legs are towards the directors of sections that do not twist, which the
    rod's own are not: they turn by `twist` a length. At the corner between the legs these turn by
    a rotation vector with the components `corner` along their directors.
    """

    curvatures: tuple[tuple[float, float], tuple[float, float]] = ((0, 0), (0, 0))
    corner: tuple[float, float] = (0, 0)
    twist: float = 0.0

    def at(self, s, leg=None):
        """Position, and the rod's directors and tangent, in the columns of a frame; of a leg, also
        beyond its end."""
        leg = int(s >= LEGS[0]) if leg is None else leg
        if leg == 0:
            point, start = np.zeros(3), np.array([[0, 0, 1.0], [0, -1.0, 0], [1.0, 0, 0]])
        else:
            point, start = self.untwisted_end()
            angle = np.hypot(*self.corner)
            if angle > 0:
                start = rotation(start[:, :2] @ self.corner / angle, angle) @ start
        moved, frame = self.along_arc(start, self.curvatures[leg], s - leg * LEGS[0])
        return point + moved, frame @ rotation([0, 0, 1], self.twist * s)

    def untwisted_end(self):
        point, frame = self.at(LEGS[0], leg=0)
        return point, frame @ rotation([0, 0, 1], -self.twist * LEGS[0])

    @staticmethod
    def along_arc(start, curvature, length):
        size = np.hypot(*curvature)
        if size == 0:
            return length * start[:, 2], start
        axis = start @ [-curvature[1] / size, curvature[0] / size, 0]
        turned = size * length
        inward = np.cross(axis, start[:, 2])
        moved = np.sin(turned) * start[:, 2] + (1 - np.cos(turned)) * inward
        return moved / size, rotation(axis, turned) @ start

    def nodes(self, edges):
        """The same number of edges on each leg."""
        first = [self.at(s, leg=0)[0] for s in np.linspace(0, LEGS[0], edges + 1)]
        second = [self.at(s, leg=1)[0] for s in np.linspace(LEGS[0], sum(LEGS), edges + 1)]
        return np.array([*first, *second[1:]])


SHAPES = {
    "straight legs": TwoLegs(corner=(np.arccos(0.28), 0)),
    "curved legs": TwoLegs(((0.8, -1.1), (-0.7, 1.9)), (np.arccos(0.28), 0)),
    "twisted legs": TwoLegs(corner=(0.6, -0.5), twist=1.7),
    "jump": TwoLegs(((0, 0), (0.8, -1.1))),
    "jump of a twisted rod": TwoLegs(((0.5, 0), (0.8, -1.1)), twist=0.7),
}


def tip_by_beam_theory(shape, k, place, load, torque=(0, 0, 0)):
    """How far the end moves under a small force there, and a moment at the arc length `place`,
    where the springs `k` are.

    The rotation r' = C m, with the compliance C of each leg. At the place the springs exert -k r
    towards the two directors and about the tangent.
    """
    nodes, weights = np.polynomial.legendre.leggauss(12)
    total = sum(LEGS)
    end = shape.at(total)[0]

    def axes(s):
        """Rotations towards the two directors, and about the tangent."""
        first, second, tangent = shape.at(s)[1].T
        return np.column_stack([second, -first, tangent])

    def turns(moment, at):
        """Rotation at `at` and movement of the end."""
        turn, moved = np.zeros(3), np.zeros(3)
        borders = sorted({0.0, LEGS[0], at, place, total})
        for low, high in pairwise(borders):
            for node, weight in zip(nodes, weights, strict=True):
                s = low + (high - low) * (1 + node) / 2
                own = axes(s)
                bend = own @ ((own.T @ moment(s)) / [STRONG, WEAK, TWISTING])
                bend *= weight * (high - low) / 2
                turn += bend * (s < at)
                moved += np.cross(bend, end - shape.at(s)[0])
        return turn, moved

    turn, moved = turns(lambda s: np.cross(end - shape.at(s)[0], load), place)
    units = [turns(lambda s, unit=unit: unit * (s < place), place) for unit in np.eye(3)]
    flexible = np.column_stack([unit[0] for unit in units])
    held = axes(place)
    stiffness = held @ np.diag(k) @ held.T
    moment = np.linalg.solve(np.eye(3) + stiffness @ flexible, torque - stiffness @ turn)
    return moved + np.column_stack([unit[1] for unit in units]) @ moment


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
@pytest.mark.parametrize("share", [0.0, -0.3, 0.4], ids=["at", "before", "beyond"])
@pytest.mark.parametrize("torque", [(0, 0, 0), (0.7, 1.1, -0.4)], ids=["", "moment"])
@pytest.mark.parametrize(
    "k", [(10.0, 10.0, 10.0), (20.0, 1.0, 5.0), (0.0, 0.0, 0.0)], ids=["one", "three", "none"]
)
def test_a_spring_and_a_moment_between_two_legs(fitted_order, k, torque, share, shape):
    """They hold and turn the section of the leg beyond a corner, or of the leg on which they are.
    Beside the corner the rod bends about other axes than beyond it. On a curved leg, or a twisted
    one, the section at the corner is not that of the edge there, and where the curvature jumps it
    is not the mean of those of the two edges."""
    load = SMALL * np.array([1.0, -0.5, 2.0])
    torque = SMALL * np.array(torque)
    strip = section([0, 0, 1], EA=1e8, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
    errors = []
    sizes = (5, 10, 20) if shape is SHAPES["straight legs"] else (20, 40, 80)
    for edges in sizes:
        nodes = shape.nodes(edges)
        beside = np.linalg.norm(nodes[edges + int(share > 0)] - nodes[edges - int(share <= 0)])
        drawn = np.linalg.norm(np.diff(nodes[: edges + 1], axis=0), axis=1).sum() + share * beside
        place = {"node": edges} if share == 0 else drawn
        scene = rod_through(
            nodes,
            strip,
            supports=[*CLAMPED, *([turning_spring(*k, at=place)] if any(k) else [])],
            loads=[force(*load), *([moment(*torque, at=place)] if any(torque) else [])],
            rod={"initial_twist": shape.twist},
        )
        values, result = measured(scene, ["end"], XYZ)
        moved = values[0] - result.model.initial_positions[-1]
        s = LEGS[0] + share * LEGS[int(share > 0)] / edges
        exact = tip_by_beam_theory(shape, k, s, load, torque)
        errors.append(np.linalg.norm(moved - exact) / np.linalg.norm(exact))
    # At another place in its edge on each mesh, a bound tells the order.
    assert errors[-1] < 2e-3
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


# NATURAL counts rates of turning about d1 and d2; the scene counts curvatures towards them.
CURVED = {"natural_curvature": [NATURAL[1], -NATURAL[0]], "natural_twist": NATURAL[2]}
HELIX = section([1, 0, 0], EA=1e4, EI1=3.0, EI2=1.0, GJ=0.8)
DRAWN = ["straight", "helix with strains", "helix"]


def turned_helix(n, drawn, frame, **more):
    """The rod of references/curved_twisted_rod.py with the directors and the tangent of its drawn
    start in the columns of `frame`."""
    rod = {**HELIX, "director": frame[:, 0].tolist()}
    if drawn == "straight":
        return straight_rod(n, rod, to=frame[:, 2], rod=CURVED, **more)
    points = np.array([rest_position(NATURAL, s) for s in np.linspace(0, 1, n + 1)])
    points *= 1 / np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    natural = CURVED if drawn == "helix with strains" else {}
    return rod_through(points @ frame.T, rod, rod={"initial_twist": NATURAL[2], **natural}, **more)


def spring_energy(stiffness, drawn, turned):
    """Energy of a spring between two frames, columns d1, d2, d3.

    Its turns are the angle between the tangents, towards the mean directors, and the twist once the
    drawn frame is transported (docs/space.md).
    """
    binormal = np.cross(drawn[:, 2], turned[:, 2])
    sine, cosine = np.linalg.norm(binormal), drawn[:, 2] @ turned[:, 2]
    angle = np.arctan2(sine, cosine) / sine * binormal
    mean = (drawn + turned) / 2
    moved = rotation(binormal / sine, np.arctan2(sine, cosine)) @ drawn[:, 0]
    twist = np.arctan2(-moved @ turned[:, 1], moved @ turned[:, 0])
    return 0.5 * stiffness @ np.array([angle @ mean[:, 1], angle @ mean[:, 0], twist]) ** 2


def drawn_frame(stiffness, moment):
    """The frame from which a spring has to be turned to the unit matrix to exert a moment."""

    def turned_by(vector):
        angle = np.linalg.norm(vector)
        return rotation(vector / angle, angle)

    def missing(turn, step=1e-6):
        drawn = turned_by(turn).T
        slopes = [
            spring_energy(stiffness, drawn, turned_by(step * axis))
            - spring_energy(stiffness, drawn, turned_by(-step * axis))
            for axis in np.eye(3)
        ]
        return np.array(slopes) / (2 * step) - moment

    return turned_by(root(missing, moment / stiffness[[1, 0, 2]], tol=1e-10).x).T


@pytest.mark.parametrize("drawn", DRAWN)
def test_a_turning_spring_at_the_start_of_a_curved_and_twisted_rod(
    spatial_reference, fitted_order, drawn
):
    """A clamped rod of references/curved_twisted_rod.py, the spring in place of its clamp: drawn
    turned back by the angles that the clamp's moment makes of the spring's stiffnesses, the rod
    comes to lie where the clamped one does."""
    stiffness = np.array([150.0, 500.0, 250.0])  # towards d1, towards d2, about d3
    moment = [spatial_reference("curved_twisted_rod", f"tip_force.start.moment.{c}") for c in XYZ]
    frame = drawn_frame(stiffness, np.array(moment))
    exact = [spatial_reference("curved_twisted_rod", f"tip_force.s1.{c}") for c in XYZ]
    errors = []
    for n in FINE:
        scene = turned_helix(
            n,
            drawn,
            frame,
            supports=[turning_spring(*stiffness.tolist(), fix=list(XYZ))],
            loads=[force(2, -3, 1)],
        )
        errors.append([np.linalg.norm(measured(scene, ["end"], XYZ)[0][0] - exact)])
    check_order(errors, fitted_order, 5e-5, FINE)


@pytest.mark.parametrize("place", [0.993, "end"])
def test_a_turning_spring_at_the_end_holds_the_natural_shape(fitted_order, place):
    """Free of stress where the natural shape is drawn: nothing may move."""
    errors = []
    for n in FINE:
        spring = turning_spring(20, 50, 30, at=place)
        scene = turned_helix(n, "helix with strains", np.eye(3), supports=[*CLAMPED, spring])
        tip = measured(scene, ["end"], XYZ)[0][0]
        errors.append([np.linalg.norm(tip - rest_position(NATURAL, 1.0))])
    check_order(errors, fitted_order, 5e-5, FINE)


@pytest.mark.parametrize("place", [0.013, 0.4137, 0.5, 0.99, 1.0])
@pytest.mark.parametrize("follower", [False, True])
def test_bending_energy_beside_a_moment(place, follower):
    """Bent and twisted evenly up to the moment, 1/2 m.K^-1 m a length, and free beyond."""
    m = np.array([0.5, 2.0, -1.0]) * SMALL  # about x, y and z
    exact = 0.5 * place * (m[0] ** 2 / TWISTING + m[1] ** 2 / WEAK + m[2] ** 2 / STRONG)
    for n in (7, 16):
        load = moment(*m.tolist(), at=place)
        load["moment"]["follower"] = follower
        scene = straight_rod(n, STRIP, supports=CLAMPED, loads=[load])
        energies = measured(scene, ["end"], XYZ)[1].energies
        assert energies["bend"][-1] == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("place", [0.0, 0.013, 0.4137, 1.0])
def test_energies_beside_a_turning_spring(place):
    """The moment of the load goes through the spring alone, and the rod from there on is bent."""
    k = np.array([0.3, 7.0, 1.1])  # about z, y and x
    m = np.array([-1.0, 2.0, 0.5]) * SMALL  # likewise
    stiffness = np.array([STRONG, WEAK, TWISTING])
    supports = [{**START, "fix": list(XYZ)}, turning_spring(*k.tolist(), at=place)]
    for n in (7, 16):
        scene = straight_rod(n, STRIP, supports=supports, loads=[moment(m[2], m[1], m[0])])
        energies = measured(scene, ["end"], XYZ)[1].energies
        assert energies["spring"][-1] == pytest.approx(np.sum(m**2 / k) / 2, rel=1e-5)
        bent = (1 - place) * np.sum(m**2 / stiffness) / 2
        assert energies["bend"][-1] == pytest.approx(bent, rel=1e-5)
