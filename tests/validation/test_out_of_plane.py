"""Planar answers that would leave their plane: the verdict, the place on a path, the factor of
linear buckling. References: `references/spatial_buckling.py` and `references/hanging_coil.py`, with
the bending before buckling, and Prandtl's equation of the narrow beam, without it.
"""

import warnings
from dataclasses import dataclass, replace
from itertools import pairwise

import der
import numpy as np
import pytest
from references.kirchhoff_rod import (
    UPRIGHT,
    Held,
    Loaded,
    Rod,
    constant,
    follow,
    march,
    rotation,
    solve,
)
from references.side_buckling import beam_on_a_spring
from scenes import END, START, tip_force
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve
from spatial_scenes import critical, measured, section, straight_rod

SIZES = [10, 20, 40]
STEPS = [1 / n for n in SIZES]
SLENDER = 1e7  # EA
CANTILEVER = [{**START, "clamp": True}]
BEAM = [{**START, "fix": ["x", "y"]}, {**END, "fix": ["y"]}]


def strip(n, supports, loads, weak, twisting, **more):
    """A straight rod of length 1 along x, with EI = 1 in its plane."""
    stiffness = {"EA": SLENDER, "EI1": weak, "EI2": 1.0, "GJ": twisting, "mass_per_length": 1.0}
    rod = {
        "name": "rod",
        "nodes": n + 1,
        "from": [0, 0],
        "to": [1, 0],
        "cross_section": {"stiffness": stiffness},
    }
    return {"rods": [rod], "supports": supports, "loads": loads, "analysis": "static", **more}


def planar_verdict(scene):
    """The verdict of the equilibrium, stable in its plane or not."""
    return der.Simulation(scene).equilibrium(leave_saddles=False).out_of_plane


def leaves_plane(scene):
    return planar_verdict(scene).stability == "unstable"


def quiet_run(scene):
    """Without the warning that is tested elsewhere."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", der.DerWarning)
        return der.run(scene)


def prandtl(moment, end, symmetric=False):
    """Least factor P of EI_weak = GJ = 1, L = 1: phi'' + (P moment(s))^2 phi = 0 over 0 .. `end`,
    phi = 0 at the start, and there or, in the middle of a symmetric beam, phi' = 0."""

    def at_end(load):
        def rate(s, y):
            return [y[1], -((load * moment(s)) ** 2) * y[0]]

        y = solve_ivp(rate, (0, end), [0, 1], method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
        return y[1] if symmetric else y[0]

    low = 1.0
    while at_end(low) * at_end(low + 2) > 0:
        low += 2
    return brentq(at_end, low, low + 2, xtol=1e-10)


@pytest.mark.parametrize("case", ["weak0.01.GJ0.01", "weak0.1.GJ0.2"])
def test_cantilever_under_a_tip_load(spatial_reference, fitted_order, case):
    weak = spatial_reference("spatial_buckling", f"lateral.{case}.EI_weak")
    twisting = spatial_reference("spatial_buckling", f"lateral.{case}.GJ")
    exact = spatial_reference("spatial_buckling", f"lateral.{case}")
    unit = np.sqrt(weak * twisting)
    errors = []
    for n in SIZES:

        def is_unstable(load, n=n):
            scene = strip(n, CANTILEVER, tip_force(0, load * unit), weak, twisting)
            return leaves_plane(scene)

        errors.append(critical(is_unstable, 0.9 * exact, 1.1 * exact, 1e-7) / exact - 1)
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 2e-3


@pytest.mark.parametrize("load", [4.5, 4.7, 9.0, 15.0])
def test_verdict_is_that_of_the_spatial_model(spatial_reference, load):
    """The numbers of unstable directions add up to that of the same shape in space, and beyond the
    critical load a seed leaves the plane."""
    weak, twisting = 0.1, 0.1
    exact = spatial_reference("spatial_buckling", "lateral.weak0.1.GJ0.1")
    force = load * np.sqrt(weak * twisting)
    report = der.Simulation(strip(20, CANTILEVER, tip_force(0, force), weak, twisting)).equilibrium(
        leave_saddles=False
    )
    bar = section([0, 0, 1], EA=SLENDER, EI1=weak, EI2=1.0, GJ=twisting)
    in_space = straight_rod(20, bar, loads=tip_force(0, force, 0), model="spatial")
    spatial = der.Simulation(in_space).equilibrium(leave_saddles=False)
    directions = report.unstable_directions + report.out_of_plane.unstable_directions
    assert directions == spatial.unstable_directions
    assert (directions > 0) == (load > exact)
    seeded = straight_rod(20, bar, loads=tip_force(0, force, 1e-5 * force))
    values, _ = measured(seeded, ["end"], "z")
    assert (abs(values[0, 0]) > 0.05) == (load > exact)


ADVICE = (
    "write 'model: spatial', draw a node in its middle a millionth of its length off the plane, "
    "and let the supports hold z ('clamp: true' holds the section, too)"
)


def as_advised(scene, warning):
    """A planar scene of a straight rod with a clamp after what `warning` says to write."""
    assert warning.endswith(ADVICE)
    rod = dict(scene["rods"][0])
    start, end, nodes = rod.pop("from"), rod.pop("to"), rod.pop("nodes")
    points = np.linspace([*start, 0.0], [*end, 0.0], nodes)
    points[nodes // 2, 2] = 1e-6 * np.linalg.norm(points[-1] - points[0])
    loads = tip_force(*scene["loads"][0]["point_force"]["force"], 0.0)
    rod["points"] = points.tolist()
    return {**scene, "model": "spatial", "rods": [rod], "loads": loads}


def bent_to_the_side(weak, twisting, force):
    """The tip of a rod clamped along x under a force there that makes it leave the x-y plane: the
    boundary value problem, pushed to the side and let go."""
    rod, start = Rod(1.0, (weak, 1.0), twisting, SLENDER), Held((0, 0, 0), UPRIGHT)
    force, push = np.array([*force, 0.0]), np.array([0.0, 0.0, 0.1 * weak])
    found = follow(rod, start, lambda share: Loaded(share * (force + push)), 8, degree=14)
    for share in (0.3, 0.1, 0.03, 0.0):
        found = solve(rod, start, Loaded(force + share * push), found.solution)
    return found.tip


@pytest.mark.parametrize(
    "force",
    [
        (0.0, -0.5),  # a strip bent in its stiff direction turns sideways, from 0.462 on
        (-0.35, 0.0),  # a column buckles about its weak axis, from pi^2/4 of its stiffness on
    ],
    ids=["strip", "column"],
)
def test_the_advice_leads_to_the_stable_shape_in_space(fitted_order, force):
    weak = twisting = 0.1
    exact = bent_to_the_side(weak, twisting, force)
    assert exact[2] > 0.2
    sizes, errors = (20, 40, 80), []
    for n in sizes:
        scene = strip(n, CANTILEVER, tip_force(*force), weak, twisting)
        with pytest.warns(der.DerWarning, match="unstable out of it: 1 direction"):
            verdict = der.run(scene).summary["out_of_plane"]
        followed = der.run(as_advised(scene, verdict["warning"]))
        assert followed.summary["stability"] == "stable"
        tip = followed.positions[-1][-1]
        errors.append(np.abs([*tip[:2], abs(tip[2])] - exact).max())
    assert fitted_order([1 / n for n in sizes], errors) > 1.9
    assert errors[-1] < 2e-4


@pytest.mark.parametrize(
    ("name", "loads", "moment", "end", "quoted"),
    [
        # P/4 at the middle, 16.94 sqrt(EI GJ)/L^2 (Timoshenko and Gere, Theory of Elastic
        # Stability, 6.4), and q s (1 - s)/2, 28.3 sqrt(EI GJ)/L^3
        (
            "middle",
            [{"point_force": {"rod": "rod", "at": "middle", "force": [0, -1]}}],
            lambda s: s / 2,
            0.5,
            16.94,
        ),
        (
            "uniform",
            [{"distributed_force": {"rod": "rod", "force": [0, -1]}}],
            lambda s: s * (1 - s) / 2,
            1.0,
            28.3,
        ),
    ],
)
def test_beam_between_forks(fitted_order, name, loads, moment, end, quoted):
    """Linear buckling of a planar beam, whose supports hold the section as forks do."""
    exact = prandtl(moment, end, symmetric=name == "middle")
    assert exact == pytest.approx(quoted, rel=1e-3)
    weak, twisting = 0.3, 0.2
    errors = []
    for n in SIZES:
        scene = strip(n, BEAM, loads, weak, twisting, analysis="buckling")
        factor = quiet_run(scene).summary["out_of_plane"]["load_factor"]
        errors.append(factor / (exact * np.sqrt(weak * twisting)) - 1)
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 3e-3


def test_two_spans(fitted_order):
    """A fork between two spans of length 1/2 under a uniform load q, with the moment q s (3/16 -
    s/2) from either end. The lowest mode is odd, so that the middle support has no force across."""
    exact = prandtl(lambda s: s * (3 / 16 - s / 2), 0.5)
    weak, twisting = 0.3, 0.2
    supports = [*BEAM, {"rod": "rod", "at": "middle", "fix": ["y"]}]
    loads = [{"distributed_force": {"rod": "rod", "force": [0, -1]}}]
    errors = []
    sizes = [40, 80, 160]  # two terms of the error cancel on coarse meshes
    for n in sizes:
        scene = strip(n, supports, loads, weak, twisting, analysis="buckling")
        factor = quiet_run(scene).summary["out_of_plane"]["load_factor"]
        errors.append(factor / (exact * np.sqrt(weak * twisting)) - 1)
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


@pytest.mark.parametrize("in_space", [False, True])
@pytest.mark.parametrize("spins", [START, END])
def test_beam_that_spins_in_a_clamp(fitted_order, spins, in_space):
    """Linear buckling where a clamp of the tangent bears a moment."""
    exact = beam_on_a_spring(towards_weak=np.inf, about_tangent=0)
    weak, twisting = 0.3, 0.2
    holds = END if spins is START else START
    supports = [{**spins, "clamp": "tangent"}, {**holds, "clamp": True}]
    force = [0, -1, 0] if in_space else [0, -1]
    loads = [{"point_force": {"rod": "rod", "at": "middle", "force": force}}]
    errors = []
    for n in SIZES:
        if in_space:
            bar = section([0, 0, 1], EA=SLENDER, EI1=weak, EI2=1.0, GJ=twisting)
            scene = straight_rod(n, bar, supports=supports, loads=loads, analysis="buckling")
            factor = quiet_run(scene).buckling.load_factors[0]
        else:
            scene = strip(n, supports, loads, weak, twisting, analysis="buckling")
            factor = quiet_run(scene).summary["out_of_plane"]["load_factor"]
        errors.append(factor / (exact * np.sqrt(weak * twisting)) - 1)
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 3e-3


SPINS = [{**START, "clamp": "tangent"}]


def buckling_out_of_plane(scene):
    return quiet_run({**scene, "analysis": "buckling"}).summary["out_of_plane"]


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_column_that_spins_in_its_clamp(fitted_order, angle):
    """The spin has no stiffness, and the load does not act on it: Euler's load about the weak axis
    all the same, which the clamp that holds the section has, too."""
    weak = 0.1
    exact = weak * (np.pi / 2) ** 2
    along = np.array([np.cos(angle), np.sin(angle)])
    errors = []
    for n in [*SIZES, 160]:
        factors = []
        for supports in (SPINS, CANTILEVER):
            scene = strip(n, supports, tip_force(*-along), weak, 0.1)
            scene["rods"][0]["to"] = along.tolist()
            factors.append(buckling_out_of_plane(scene)["load_factor"])
        assert factors[0] == pytest.approx(factors[1], rel=1e-8)
        errors.append(factors[0] / exact - 1)
    assert fitted_order(STEPS, errors[: len(SIZES)]) > 1.9
    assert abs(errors[-1]) < 1e-4


@pytest.mark.parametrize("others", [1, 3])
def test_a_rod_that_spins_beside_another_takes_no_verdict_away(others):
    """And has no part in it: no load acts on it."""
    alone = strip(40, CANTILEVER, tip_force(0, -0.5), 0.1, 0.1)
    factor = buckling_out_of_plane(alone)["load_factor"]
    assert factor == pytest.approx(4.0126 * 0.1 / 0.5, rel=1e-3)  # Prandtl and Michell
    both = {key: list(alone[key]) for key in ("rods", "supports", "loads")}
    for y in range(1, others + 1):
        name = f"other{y}"
        both["rods"].append({**alone["rods"][0], "name": name, "from": [0, y], "to": [1, y]})
        both["supports"].append({**SPINS[0], "rod": name})
    assert buckling_out_of_plane(both)["load_factor"] == pytest.approx(factor, rel=1e-8)


def test_more_spins_than_are_looked_at():
    scene = strip(4, CANTILEVER, tip_force(0, -0.5), 0.1, 0.1)
    for y in range(1, 50):
        name = f"other{y}"
        scene["rods"].append({**scene["rods"][0], "name": name, "from": [0, y], "to": [1, y]})
        scene["supports"] = [*scene["supports"], {**SPINS[0], "rod": name}]
    assert "too many of its rods are free to spin" in buckling_out_of_plane(scene)["not_tested"]


def test_a_spin_that_the_loads_drive_is_not_decided():
    """They bend the rod, which then may spin to its weak axis: a term of second order in them."""
    scene = strip(20, SPINS, tip_force(0, -1), 0.1, 0.1)
    verdict = buckling_out_of_plane(scene)
    assert verdict["stability"] == "not_tested"
    assert "load_factor" not in verdict
    assert "of rod 'rod'" in verdict["not_tested"]
    assert "hold its section ('clamp: true')" in verdict["not_tested"]


def ring_on_two_pins(node, force, **stiffness):
    turn = 2 * np.pi * np.arange(40) / 40
    rod = {
        "name": "rod",
        "points": np.column_stack([np.cos(turn), np.sin(turn)]).tolist(),
        "closed": True,
        "cross_section": {"stiffness": {**ARC, **stiffness}},
    }
    far = {"rod": "rod", "at": {"node": 20}}
    supports = [{"rod": "rod", "at": {"node": 0}, "fix": ["x", "y"]}, {**far, "fix": ["y"]}]
    loads = [{"point_force": {"rod": "rod", "at": {"node": node}, "force": force}}]
    return {"rods": [rod], "supports": supports, "loads": loads, "analysis": "static"}


def test_a_motion_that_nothing_resists_and_the_loads_drive_has_the_factor_zero():
    """A ring that may turn about the line between its pins, under a force at its top: it falls
    over, and hangs under one that pulls it up."""
    scene = {**ring_on_two_pins(10, [0, -1]), "analysis": "buckling"}
    with pytest.warns(der.DerWarning, match="leaves its plane under any load"):
        verdict = der.run(scene).summary["out_of_plane"]
    assert verdict["load_factor"] == 0.0
    hanging = buckling_out_of_plane(ring_on_two_pins(10, [0, 1]))
    assert "is not decided by linear theory" in hanging["not_tested"]


def test_a_motion_that_nothing_resists_and_the_loads_leave_alone_has_no_part():
    """The same ring pressed along that line. A section that is too stiff to buckle out of the plane
    by itself leaves nothing else there."""
    weak, stiff = (
        buckling_out_of_plane(ring_on_two_pins(20, [1, 0], EI1=EI, GJ=EI)) for EI in (0.01, 1.0)
    )
    assert stiff["load_factor"] == pytest.approx(100 * weak["load_factor"], rel=1e-3)


def test_a_shape_that_is_unstable_without_loads_has_no_factor():
    """A rod of a natural curvature, held straight by its supports, turns sideways."""
    loads = [{"point_force": {"rod": "rod", "at": "middle", "force": [1, 0]}}]
    scene = strip(20, [*CANTILEVER, {**END, "clamp": True}], loads, 0.02, 0.02)
    scene["rods"][0] |= {"natural_curvature": 6.0}
    verdict = buckling_out_of_plane(scene)
    assert "without its loads" in verdict["not_tested"]


def test_forks_turn_with_the_rod():
    """A beam drawn straight and bent by a load, and one that is drawn as it is bent: the same."""
    loads = [{"point_force": {"rod": "rod", "at": {"node": 8}, "force": [0, -6]}}]
    drawn_straight = strip(20, BEAM, loads, 0.1, 0.1, analysis="modes")
    bent = quiet_run(drawn_straight)
    rod = {**drawn_straight["rods"][0], "points": bent.positions[-1].tolist()}
    rod = {key: value for key, value in rod.items() if key not in ("nodes", "from", "to")}
    drawn_bent = {**drawn_straight, "rods": [{**rod, "natural_curvature": 0}]}
    rates = [
        result.summary["out_of_plane"]["growth_rate"] for result in (bent, quiet_run(drawn_bent))
    ]
    assert rates[0] > 0
    assert rates[1] == pytest.approx(rates[0], rel=1e-4)


ARC = {"EA": 2e4, "EI1": 0.12, "EI2": 1.0, "GJ": 0.1, "mass_per_length": 0.1}
BEND = 2.0  # turn of the drawn arc, whose length is 1


def arc_under_a_force(n, start):
    """An arc with a pin at its end, and a force of 1 in its middle."""
    turn = BEND * np.linspace(0, 1, n + 1)
    points = np.column_stack([np.sin(turn), 1 - np.cos(turn)]) / BEND
    rod = {"name": "rod", "points": points.tolist(), "cross_section": {"stiffness": ARC}}
    supports = [{**START, **start}, {**END, "fix": ["x", "y"]}]
    force = {"point_force": {"rod": "rod", "at": 0.5, "force": [0, 1]}}
    return {"rods": [rod], "supports": supports, "loads": [force]}


def critical_force_of_the_arc(is_pinned, low, high):
    """The force at which that arc's equilibrium is neutral out of its plane, by shooting from the
    start. Of the plane the slope or moment and the forces there are unknown; out of it the tilt or
    moment, the torque, and the force, of which complex steps give the matrix of the conditions at
    the end. A pin holds z and the turn of the section about the tangent, and lets it tilt.
    """
    half = Rod(0.5, (ARC["EI1"], ARC["EI2"]), ARC["GJ"], ARC["EA"], constant(0.0, BEND, 0.0))
    tip = np.array([np.sin(BEND), 1 - np.cos(BEND)]) / BEND

    def conditions(force, in_plane, out_of_plane):
        slope = in_plane[0] if is_pinned else 0.0
        tilt = out_of_plane[0] if is_pinned else 0.0
        frame = rotation((0, 0, 1), slope) @ UPRIGHT @ [[1, 0, 0], [0, 1, -tilt], [0, tilt, 1]]
        moment = [0 if is_pinned else out_of_plane[0], 0 if is_pinned else in_plane[0]]
        wrench = [*(np.array([*in_plane[1:], out_of_plane[2]]) @ frame), *moment, out_of_plane[1]]
        y = march(half, np.zeros(3), np.array([0, 0, 0, *frame.ravel(), *wrench]))
        y[12:15] -= np.array([0, force, 0]) @ y[3:12].reshape(3, 3)
        y = march(half, np.zeros(3), y)
        _, d2, d3 = y[3:12].reshape(3, 3).T
        m = y[3:12].reshape(3, 3) @ y[15:18]
        across = np.real(np.cross(d3, [0, 0, 1]))
        return np.array([*(y[:2] - tip), m[2]]), np.array([y[2], d2 @ across, m @ across])

    in_plane = np.zeros(3)

    def determinant(force):
        nonlocal in_plane
        zero = np.zeros(3)
        in_plane = fsolve(lambda x: conditions(force, x, zero)[0].real, in_plane, xtol=1e-12)
        columns = [conditions(force, in_plane, 1e-30j * unit)[1].imag for unit in np.eye(3)]
        return np.linalg.det(np.array(columns) * 1e30)

    for share in np.linspace(0, 1, 5):
        determinant(share * low)
    return brentq(determinant, low, high, xtol=1e-10)


@pytest.mark.parametrize(
    ("start", "low", "high"),
    [({"fix": ["x", "y"]}, 0.4, 0.8), ({"clamp": True}, 3.0, 3.3)],
    ids=["pinned", "clamped"],
)
def test_pins_hold_the_section_about_the_tangent_of_a_curved_rod(fitted_order, start, low, high):
    """And not about the edge beside them, which leans against it."""
    exact = critical_force_of_the_arc("clamp" not in start, low, high)
    errors = []
    for n in SIZES:
        scene = arc_under_a_force(n, start)
        result = quiet_run({**scene, "analysis": {"continuation": {"to": 1.2 * exact}}})
        errors.append(result.summary["out_of_plane"]["load_factor"] / exact - 1)
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 2e-3


@dataclass(frozen=True)
class Frame:
    """Two legs, clamped at the start and free at the end, where a force acts. A pin holds the
    corner at which they meet."""

    legs: tuple[float, float]
    turn: float
    force: tuple[float, float]
    twisting: float
    low: float  # the critical force lies between these
    high: float
    curvatures: tuple[float, float] = (0.0, 0.0)  # of the legs, stress-free

    @property
    def section(self):
        return {"EA": 2e4, "EI1": 0.12, "EI2": 1.0, "GJ": self.twisting, "mass_per_length": 0.1}

    def nodes(self, n):
        """With n edges a leg; the rod begins along x."""
        points = np.zeros((1, 2))
        angle = -self.turn
        for length, curvature in zip(self.legs, self.curvatures, strict=True):
            angle += self.turn
            s = np.linspace(0, length, n + 1)[1:]
            chord, lean = s * np.sinc(curvature * s / (2 * np.pi)), angle + curvature * s / 2
            leg = np.column_stack([chord * np.cos(lean), chord * np.sin(lean)])
            points = np.concatenate([points, points[-1] + leg])
            angle += curvature * length
        return points

    def scene(self, n, **hold):
        rod = {
            "name": "rod",
            "points": self.nodes(n).tolist(),
            "cross_section": {"stiffness": self.section},
        }
        corner = {"rod": "rod", "at": {"node": n}, **(hold or {"fix": ["x", "y"]})}
        loads = tip_force(*self.force)
        supports = [*CANTILEVER, corner]
        path = {"continuation": {"to": 1.2 * self.high}}
        return {"rods": [rod], "supports": supports, "loads": loads, "analysis": path}

    def critical_factor(self, n, **hold):
        return quiet_run(self.scene(n, **hold)).summary["out_of_plane"]["load_factor"]


def critical_factor_of_a_frame(frame, fillet=0.0):
    """By shooting, as for the arc. The corner is rigid, and held about the direction between its
    two tangents; with a `fillet` it is an arc of that length, held about the tangent of its middle.
    """
    stiffness = ((frame.section["EI1"], frame.section["EI2"]), frame.twisting, frame.section["EA"])
    legs = [
        Rod(length - fillet / 2, *stiffness, constant(0.0, curvature, 0.0))
        for length, curvature in zip(frame.legs, frame.curvatures, strict=True)
    ]
    half_turn = rotation((0, 1, 0), frame.turn / 2)

    def half_the_corner(y):
        if fillet > 0:
            arc = Rod(fillet / 2, *stiffness, constant(0.0, frame.turn / fillet, 0.0))
            return march(arc, np.zeros(3), y)
        d = y[3:12].reshape(3, 3) @ half_turn
        return np.array([*y[:3], *d.ravel(), *(y[12:15] @ half_turn), *(y[15:18] @ half_turn)])

    def to_the_pin(wrench):
        y = np.array([0, 0, 0, *UPRIGHT.ravel(), *wrench])
        return half_the_corner(march(legs[0], np.zeros(3), y))

    drawn = to_the_pin(np.zeros(6))

    def conditions(factor, in_plane, out_of_plane):
        """Of the plane the force and the moment at the start and the force of the pin are unknown,
        out of it the same and the torque of the pin."""
        n = np.array([*in_plane[:2], out_of_plane[0]])
        y = to_the_pin([*(n @ UPRIGHT), out_of_plane[1], in_plane[2], out_of_plane[2]])
        d = y[3:12].reshape(3, 3)
        tangent = np.real(d[:, 2])
        held = [y[2], d[:, 1] @ np.cross(tangent, [0, 0, 1])]
        gap = y[:2] - drawn[:2]
        y[12:15] += np.array([*in_plane[3:], out_of_plane[3]]) @ d
        y[15:18] += out_of_plane[4] * tangent @ d
        y = march(legs[1], np.zeros(3), half_the_corner(y))
        d = y[3:12].reshape(3, 3)
        n, m = d @ y[12:15] - factor * np.array([*frame.force, 0]), d @ y[15:18]
        return np.array([*gap, *n[:2], m[2]]), np.array([*held, n[2], *m[:2]])

    in_plane = np.zeros(5)

    def determinant(factor):
        nonlocal in_plane
        zero = np.zeros(5)
        in_plane = fsolve(lambda x: conditions(factor, x, zero)[0].real, in_plane, xtol=1e-12)
        columns = [conditions(factor, in_plane, 1e-30j * unit)[1].imag for unit in np.eye(5)]
        return np.linalg.det(np.array(columns) * 1e30)

    for share in np.linspace(0, 1, 5):
        determinant(share * frame.low)
    return brentq(determinant, frame.low, frame.high, xtol=1e-9)


FRAMES = {
    "GJ0.012": Frame((0.6, 0.4), np.pi / 2, (-0.6, -0.8), 0.012, 0.78, 0.8),
    "GJ0.036": Frame((0.6, 0.4), np.pi / 2, (-0.6, -0.8), 0.036, 0.89, 0.92),
    "GJ0.12": Frame((0.6, 0.4), np.pi / 2, (-0.6, -0.8), 0.12, 1.0, 1.04),
    "GJ0.6": Frame((0.6, 0.4), np.pi / 2, (-0.6, -0.8), 0.6, 1.34, 1.38),
    "bent.much": Frame((0.6, 0.4), np.pi / 2, (-1.0, 0.0), 0.1, 2.52, 2.65),
    "sharp": Frame((0.25, 0.75), 2.2, (-0.5, -0.9), 0.036, 0.345, 0.36),
    "curved": Frame((0.6, 0.4), 1.4, (0.0, -1.0), 0.1, 0.69, 0.71, (1.5, -2.0)),
    "blunt": Frame((0.4, 0.6), -0.8, (-1.0, 0.3), 0.012, 0.47, 0.49),
    "curvature.jumps": Frame((0.6, 0.4), 0.0, (0.3, -1.0), 0.1, 2.8, 2.95, (-0.5, 2.5)),
}


@pytest.mark.parametrize("name", FRAMES)
def test_a_pin_at_a_corner(fitted_order, name):
    """It holds the section about the direction between both tangents, and the legs stay glued."""
    frame = FRAMES[name]
    exact = critical_factor_of_a_frame(frame)
    errors = [frame.critical_factor(n) / exact - 1 for n in SIZES]
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 5e-3


def test_a_corner_is_the_limit_of_a_round():
    """The rule above against what a smooth curve leaves no choice about."""
    frame = replace(FRAMES["GJ0.12"], high=1.1)
    exact = critical_factor_of_a_frame(frame)
    fillets = [0.01, 0.005, 0.0025]
    values = [critical_factor_of_a_frame(frame, fillet) for fillet in fillets]
    assert values[-1] / exact > 1.01
    assert np.polyfit(fillets, values, 2)[-1] == pytest.approx(exact, rel=3e-4)


def rounded(frame, n, fillet, arcs):
    """The scene of a frame whose corner is a round of `arcs` edges between legs of `n` edges."""
    angles = frame.turn * np.linspace(0, 1, arcs + 1)[:, None]
    start, end = (np.array([np.cos(a), np.sin(a)]) for a in (0, frame.turn))
    before, after = (length - fillet / 2 for length in frame.legs)
    first = np.linspace(0, before, n + 1)[:, None] * start
    arc = first[-1] + fillet / frame.turn * np.hstack([np.sin(angles), 1 - np.cos(angles)])
    last = arc[-1] + np.linspace(0, after, n + 1)[:, None] * end
    scene = frame.scene(n)
    scene["rods"][0]["points"] = np.concatenate([first, arc[1:], last[1:]]).tolist()
    scene["supports"][-1]["at"] = {"node": n + arcs // 2}
    return scene


@pytest.mark.parametrize("edge", [1e-3, 1e-4, 1e-5])
def test_a_round_of_very_short_edges(fitted_order, edge):
    """Rounding of the stiffness of its edges, EI/edge^3, does not move the place where a path
    leaves the plane."""
    frame = replace(FRAMES["GJ0.12"], high=1.1)
    fillet = 8 * edge
    exact = critical_factor_of_a_frame(frame, fillet)
    errors = []
    for n in SIZES:
        summary = quiet_run(rounded(frame, n, fillet, 8)).summary
        errors.append(summary["out_of_plane"]["load_factor"] / exact - 1)
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 2e-3


def graded_column(edge, weak):
    """A pinned column with 20 edges of that length in its middle, and the factor at which its chain
    is neutral in its plane: the deflection y and the angles of the edges, from the start on, as
    M = -P y bends each node."""
    half = np.linspace(0, 0.5 - 10 * edge, 21)
    x = np.concatenate([half, 0.5 + edge * np.arange(-9, 10), 1 - half[::-1]])
    scene = strip(20, BEAM, tip_force(-1, 0), weak, 0.7)
    rod = {key: scene["rods"][0][key] for key in ("name", "cross_section")}
    scene["rods"] = [{**rod, "points": np.column_stack([x, 0 * x]).tolist()}]
    lengths = np.diff(x)

    def at_end(load):
        y, angle = lengths[0], 1.0
        for before, after in pairwise(lengths):
            angle -= load * y * (before + after) / 2
            y += after * angle
        return y

    load = brentq(at_end, 8, 11, xtol=1e-13)
    return scene, load * (1 + load / SLENDER)  # bent about edges that are compressed


@pytest.mark.parametrize("edge", [1e-3, 1e-4, 1e-5])
def test_a_column_with_very_short_edges(edge):
    """The critical factor of a path in the plane and out of it, and no other."""
    scene, exact = graded_column(edge, 0.9)
    path = quiet_run({**scene, "analysis": {"continuation": {"to": 12}}}).path
    assert path.factor[path.rows("bifurcation")] == pytest.approx([exact], rel=1e-6)
    assert path.factor[path.rows("out_of_plane")] == pytest.approx([0.9 * exact], rel=1e-6)


@pytest.mark.parametrize("analysis", ["buckling", "modes"])
def test_what_very_short_edges_hide_is_refused(analysis):
    scene, _ = graded_column(1e-6, 0.9)
    with pytest.raises(der.DerError, match="rounding errors of the stiffness of the shortest"):
        der.run({**scene, "analysis": analysis})


def test_a_path_says_where_rounding_hides_its_stability():
    scene, _ = graded_column(1e-6, 0.9)
    verdict = quiet_run({**scene, "analysis": {"continuation": {"to": 12}}}).summary["out_of_plane"]
    assert verdict["stability"] == "not_tested"
    assert "rounding hides whether the path is stable out of its plane" in verdict["not_tested"]
    scene, _ = graded_column(1e-7, 0.9)
    with pytest.raises(der.DerError, match="no start whose stability is known"):
        der.run({**scene, "analysis": {"continuation": {"to": 12}}})


def test_verdict_at_a_corner_is_that_of_the_path():
    frame = FRAMES["curved"]
    factor = frame.critical_factor(10)
    for share, directions in ((0.999, 0), (1.001, 1)):
        loads = tip_force(*(share * factor * np.array(frame.force)))
        scene = {**frame.scene(10), "loads": loads, "analysis": "static"}
        assert planar_verdict(scene).unstable_directions == directions


def test_a_spring_at_a_corner_holds_the_section_as_a_pin_does():
    frame = FRAMES["GJ0.12"]
    pinned = frame.critical_factor(10)
    assert frame.critical_factor(10, spring={"stiffness": 1e8}) == pytest.approx(pinned, rel=1e-4)


def test_a_ring_may_begin_at_the_corner_that_is_held():
    corners = np.array([[0, 0], [0.5, 0], [0.4, 0.3], [0.1, 0.3]])
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    points = np.concatenate([np.linspace(a, b, 6)[:-1] for a, b in sides])
    rates = []
    for first in (0, 3, 10):
        rod = {
            "name": "rod",
            "points": np.roll(points, -first, axis=0).tolist(),
            "closed": True,
            "cross_section": {"stiffness": ARC},
        }

        def at(node, first=first):
            return {"rod": "rod", "at": {"node": (node - first) % len(points)}}

        supports = [{**at(0), "fix": ["x", "y"]}, {**at(10), "fix": ["y"]}]
        loads = [{"point_force": {**at(12), "force": [0, -20]}}]
        scene = {"rods": [rod], "supports": supports, "loads": loads, "analysis": "modes"}
        rates.append(quiet_run(scene).summary["out_of_plane"]["growth_rate"])
    assert rates[0] > 0
    assert rates[1:] == pytest.approx([rates[0]] * 2, rel=1e-6)


@pytest.mark.parametrize("force", [0.0, 0.1])
def test_a_ring_on_two_pins_turns_about_the_line_between_them(force):
    """Both tangents lie across that line: nothing holds the ring against turning."""
    verdict = planar_verdict(ring_on_two_pins(20, [force, 0]))
    assert verdict.stability == "neutral"
    assert verdict.neutral_directions == 1


def test_beam_between_forks_leaves_its_plane_at_that_load():
    """A beam so stiff in its plane that it hardly bends before."""
    weak, twisting = 1e-4, 1e-4
    exact = prandtl(lambda s: s / 2, 0.5, symmetric=True) * 1e-4
    for share, word in ((0.98, "stable"), (1.02, "unstable")):
        loads = [{"point_force": {"rod": "rod", "at": "middle", "force": [0, -share * exact]}}]
        assert planar_verdict(strip(40, BEAM, loads, weak, twisting)).stability == word


@pytest.mark.parametrize(
    ("supports", "length"), [(BEAM, 1.0), (CANTILEVER, 2.0)], ids=["pinned", "clamped"]
)
def test_column_whose_weak_axis_lies_in_the_plane(fitted_order, supports, length):
    weak = 0.4
    exact = weak * (np.pi / length) ** 2
    errors = []
    for n in SIZES:

        def is_unstable(load, n=n):
            return leaves_plane(strip(n, supports, tip_force(-load, 0), weak, 0.3))

        errors.append(critical(is_unstable, 0.9 * exact, 1.1 * exact, 1e-7) / exact - 1)
    assert fitted_order(STEPS, errors) > 1.9
    below = planar_verdict(strip(10, supports, tip_force(-0.5 * exact, 0), weak, 0.3))
    assert below.stability == "stable"


def coil(n, length):
    """A naturally curved rod hangs from a clamp whose tangent points down; EI = k = 1."""
    section_ = {"stiffness": {"EA": 1e6, "EI": 1.0, "GJ": 1 / 1.3, "mass_per_length": 0.1}}
    rod = {
        "name": "rod",
        "nodes": n + 1,
        "from": [0, 0],
        "to": [0, -length],
        "natural_curvature": 1.0,
        "cross_section": section_,
    }
    return {
        "rods": [rod],
        "supports": CANTILEVER,
        "loads": [{"gravity": [0, -1]}],
        "analysis": "static",
    }


def test_hanging_coil(spatial_reference, fitted_order):
    """The length at which it leaves the plane."""
    exact = spatial_reference("hanging_coil", "critical_length")
    errors = []
    for n in SIZES:

        def is_unstable(length, n=n):
            return leaves_plane(coil(n, length))

        errors.append(critical(is_unstable, 0.8 * exact, 1.2 * exact, 1e-7) / exact - 1)
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 5e-3


def test_shapes_of_the_coil_in_space_and_in_its_plane(spatial_reference, fitted_order):
    """A little longer than the critical length. The model in space leaves the saddle in the plane
    downhill, to one of two mirror images."""

    def exact(shape):
        names = [[f"{shape}.6.s{s}.{c}" for c in "xyz"] for s in ("0.5", "1")]
        return np.array([[spatial_reference("hanging_coil", n) for n in row] for row in names])

    gap = spatial_reference("hanging_coil", "space.6.energy_above_plane")
    wire = section([1, 0, 0], EI=1.0, GJ=1 / 1.3, mass_per_length=0.1)
    sizes = [40, 80, 160]
    errors = []
    for n in sizes:
        rod = {"natural_curvature": [1.0, 0.0], "natural_twist": 0.0}
        scene = straight_rod(n, wire, to=[0, 0, 6], rod=rod, loads=[{"gravity": [0, 0, 1]}])
        found, energies = {}, {}
        for shape in ("plane", "space"):
            simulation = der.Simulation(der.Scenario.from_dict(scene))
            equilibrium = simulation.equilibrium(leave_saddles=shape == "space")
            assert equilibrium.unstable_directions == (1 if shape == "plane" else 0)
            found[shape] = simulation.positions[[n // 2, -1]]
            energy = simulation.energies
            energies[shape] = energy.stretch + energy.bend + energy.gravity
        found["space"][:, 1] *= np.sign(found["space"][-1, 1])
        off = [np.linalg.norm(found[k] - exact(k), axis=1).max() for k in ("plane", "space")]
        errors.append([*off, energies["space"] - energies["plane"] - gap])
    for column in np.transpose(errors):
        assert fitted_order([1 / n for n in sizes], column) > 1.9
    # So near the bifurcation, the shape in space depends on the mesh a hundred times more.
    assert (np.abs(errors[-1]) < [2e-4, 6e-3, 0.012 * abs(gap)]).all()


def test_a_free_rod_is_neutral():
    """Its rigid motions out of the plane: along z, and about x and y."""
    verdict = planar_verdict(strip(10, [], [], 0.3, 0.2))
    assert (verdict.stability, verdict.neutral_directions) == ("neutral", 3)


def test_turned_clamp():
    """A clamp turned by five radians holds the same rod: nothing changes out of the plane."""
    weak, twisting, turn = 0.1, 0.1, 5.0
    unit = np.sqrt(weak * twisting)
    words = []
    for load in (4.4, 4.9):
        force = load * unit * np.array([-np.sin(turn), np.cos(turn)])
        supports = [{**START, "clamp": True, "prescribe": {"angle": turn}}]
        words.append(planar_verdict(strip(20, supports, tip_force(*force), weak, twisting)))
    assert [word.stability for word in words] == ["stable", "unstable"]


def test_path_leaves_its_plane(spatial_reference, fitted_order):
    """The event of a path, at the same load as the bifurcation of the path in space."""
    exact = spatial_reference("spatial_buckling", "lateral.weak0.1.GJ0.1")
    errors = []
    for n in SIZES:
        scene = strip(n, CANTILEVER, tip_force(0, 0.1), 0.1, 0.1)
        scene["analysis"] = {"continuation": {"to": 6}}
        with pytest.warns(der.DerWarning, match="leaves its plane at the load factor"):
            result = der.run(scene)
        (row,) = result.path.rows("out_of_plane")
        factor = result.path.factor[row]
        assert result.summary["out_of_plane"]["load_factor"] == pytest.approx(factor, rel=1e-12)
        assert list(result.path.unstable_out_of_plane[[row - 1, row, -1]]) == [0, 1, 1]
        assert not result.path.unstable_directions.any()
        errors.append(factor / exact - 1)
    assert fitted_order(STEPS, errors) > 1.9
    bar = section([0, 0, 1], EA=SLENDER, EI1=0.1, EI2=1.0, GJ=0.1)
    space = straight_rod(SIZES[-1], bar, loads=tip_force(0, 0.1, 0), model="spatial")
    space["analysis"] = {"continuation": {"to": 6}}
    path = der.run(space).path
    # The test of a plane counts eigenvalues beyond rounding, the path in space all below zero.
    assert path.factor[path.rows("bifurcation")[0]] == pytest.approx(factor, rel=1e-7)


def test_warning_and_summary():
    scene = strip(20, CANTILEVER, tip_force(0, 0.5), 0.1, 0.1)
    with pytest.warns(der.DerWarning, match="stable in its plane, unstable out of it: 1 direction"):
        result = der.run(scene)
    verdict = result.summary["out_of_plane"]
    assert verdict["stability"] == "unstable"
    assert verdict["unstable_directions"] == 1
    assert "model: spatial" in verdict["warning"]
    assert verdict["warning"] in result.summary["warnings"]
    with pytest.warns(der.DerWarning, match="grows by"):
        modes = der.run({**scene, "analysis": "modes"})
    assert modes.summary["out_of_plane"]["growth_rate"] > 0.0
    steady = der.run(strip(20, CANTILEVER, tip_force(0, 0.3), 0.1, 0.1))
    assert steady.summary["out_of_plane"]["stability"] == "stable"
    assert steady.summary["warnings"] == []


def test_growth_rate_is_that_of_the_spatial_model():
    force = 0.6
    scene = strip(20, CANTILEVER, tip_force(0, force), 0.1, 0.1, analysis="modes")
    bar = section([0, 0, 1], EA=SLENDER, EI1=0.1, EI2=1.0, GJ=0.1)
    space = der.Simulation(straight_rod(20, bar, loads=tip_force(0, force, 0), model="spatial"))
    space.equilibrium(leave_saddles=False)
    rate = quiet_run(scene).summary["out_of_plane"]["growth_rate"]
    assert rate == pytest.approx(space.modes(1).growth_rates[0], rel=1e-6)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"EI1": None, "EI2": None, "EI": 1.0, "GJ": None}, "give 'GJ' beside 'EI'"),
        ({"GJ": None}, "give 'GJ' beside 'EI1' and 'EI2'"),
    ],
)
def test_unknown_stiffness(change, reason):
    scene = strip(10, CANTILEVER, tip_force(0, 0.1), 0.1, 0.1)
    stiffness = scene["rods"][0]["cross_section"]["stiffness"] | change
    scene["rods"][0]["cross_section"] = {
        "stiffness": {key: value for key, value in stiffness.items() if value is not None}
    }
    verdict = der.run(scene).summary["out_of_plane"]
    assert verdict["stability"] == "not_tested"
    assert reason in verdict["not_tested"]


def test_no_potential_in_space():
    scene = strip(10, CANTILEVER, [{"moment": {**END, "moment": 0.1}}], 0.1, 0.1)
    assert planar_verdict(scene).not_tested == "loads.0.moment has no potential in space"
    sprung = [*CANTILEVER, {**END, "spring": {"rotational_stiffness": 1.0}}]
    scene = strip(10, sprung, tip_force(0, 0.1), 0.1, 0.1)
    assert "supports.1 against rotation" in planar_verdict(scene).not_tested


@pytest.mark.parametrize("n", [10, 30, 50])
def test_columns_that_buckle_alike_both_ways_do_not_leave_their_plane_first(n):
    """The same matrices in the plane and out of it: the factors differ by rounding alone."""
    scene = strip(n, BEAM, tip_force(-1, 0), 1.0, 0.7, analysis="buckling")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = der.run(scene)
    factor = result.summary["out_of_plane"]["load_factor"]
    assert factor == pytest.approx(result.buckling.load_factors[0], rel=1e-9)
    # A difference that is one of mechanics counts.
    with pytest.warns(der.DerWarning, match="buckles out of its plane first"):
        der.run(strip(n, BEAM, tip_force(-1, 0), 0.99999, 0.7, analysis="buckling"))
