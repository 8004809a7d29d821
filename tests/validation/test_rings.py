"""Closed rods: Michell's ring, vibrations, a pressed ring, link and writhe, agreement of models."""

import der
import numpy as np
import pytest
from references.writhe import figure_eight, torus_knot
from scipy.integrate import solve_bvp
from spatial_scenes import rod_through, section

STRAIGHT = {"natural_curvature": [0, 0], "natural_twist": 0}


def circle(count, turn=0.0, radius=1.0):
    """The nodes of a ring around z, the first one turned by `turn` [rad] from the x axis."""
    angle = turn + 2 * np.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])


def length_of(points):
    return np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1).sum()


def ring_through(points, cross_section, rod=None, **more):
    rod = {"closed": True, **(rod or {})}
    return rod_through(points, cross_section, **{"supports": [], "rod": rod, **more})


def michell(count, ratio, twist, wave=0.0):
    """A naturally straight rod of length 2 pi and EI = 1, bent to a circle, its ends turned against
    each other by `twist` [rad] and glued; `ratio` is EI/GJ."""
    stiff = section(EA=1e5, EI=1.0, GJ=1 / ratio, rotary_inertia=1e-3)
    points = circle(count) * (2 * np.pi / length_of(circle(count)))
    points[:, 2] = wave * np.cos(2 * np.arctan2(points[:, 1], points[:, 0]))
    rod = {**STRAIGHT, "initial_twist": twist / length_of(points)}
    return ring_through(points, stiff, rod)


def unstable_directions(scene):
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    return simulation.equilibrium(leave_saddles=False).unstable_directions


@pytest.mark.parametrize("ratio", [0.75, 1.0, 1.5])
def test_ring_of_michell(spatial_reference, ratio):
    """It buckles out of its plane in a pair of modes of two waves."""
    critical = spatial_reference("spatial_buckling", f"ring.{ratio:g}.twist")
    assert unstable_directions(michell(200, ratio, 0.999 * critical)) == 0
    assert unstable_directions(michell(200, ratio, 1.001 * critical)) == 2


def test_order_of_the_critical_twist(spatial_reference, fitted_order):
    """The twist at which the pair appears, by bisection."""
    critical = spatial_reference("spatial_buckling", "ring.1.twist")

    def found(count):
        low, high = 0.99 * critical, 1.02 * critical
        while high - low > 2e-5 * critical:
            middle = 0.5 * (low + high)
            if unstable_directions(michell(count, 1.0, middle)) >= 2:
                high = middle
            else:
                low = middle
        return low

    sizes = [30, 42, 60]
    errors = [found(n) / critical - 1 for n in sizes]
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


@pytest.mark.parametrize("plane", ["in_plane", "out_of_plane"])
def test_frequencies(spatial_reference, fitted_order, plane):
    """Pairs of modes of n = 2, 3 waves of a ring without stress; 6 rigid motions."""
    radius = 0.01  # of the section
    stiff = section(EA=4 / radius**2, EI=1.0, GJ=1 / 1.3, rotary_inertia=radius**2 / 2)
    names = [f"ring.{plane}.{waves}.radius0.01.omega" for waves in (2, 3)]
    exact = np.repeat([spatial_reference("spatial_frequencies", name) for name in names], 2)
    sizes = [36, 54, 81]
    errors = []
    for count in sizes:
        scene = ring_through(circle(count), stiff, analysis={"modes": {"count": 14}})
        found = 2 * np.pi * np.array(der.run(scene).summary["frequencies_hz"])
        assert np.all(found[:6] == 0.0)
        assert np.all(found[6:] > 1.0)
        # Out of the plane the ring is a little softer than in it (not on coarser meshes).
        own = found[6:].reshape(2, 2, 2)[:, 1 if plane == "in_plane" else 0].ravel()
        errors.append(own / exact - 1)
    for of_mode in np.array(errors).T:
        assert fitted_order([1 / n for n in sizes], of_mode) > 1.9
    assert np.abs(errors[-1]).max() < 1e-2


def pressed_diameter(force):
    """Diameter along two opposite forces that press an inextensible ring of EI = 1 and R = 1.

    A quarter, from a force to the side: theta'' = -n cos(theta) with the force n = -F/2 across the
    force-free horizontal, theta = 0 and pi/2 at its ends.
    """

    def slopes(s, y):
        theta, curvature, _ = y
        return np.stack([curvature, 0.5 * force * np.cos(theta), np.sin(theta)])

    def ends(a, b):
        return np.array([a[0], b[0] - np.pi / 2, a[2]])

    s = np.linspace(0, np.pi / 2, 101)
    found = solve_bvp(
        slopes, ends, s, np.stack([s, 1 + 0 * s, 1 - np.cos(s)]), tol=1e-8, max_nodes=10000
    )
    assert found.success
    return 2 * found.y[2, -1]


def press(count, force, model="planar"):
    """A ring held at its foot; its head is pressed down."""
    points = circle(count, turn=-np.pi / 2)
    stiff = section(EA=1e8, EI=1.0, GJ=1.0)
    head = {"node": count // 2}
    scene = ring_through(
        points,
        stiff,
        supports=[
            {"rod": "rod", "at": "start", "fix": ["x", "y", "z"]},
            {"rod": "rod", "at": head, "fix": ["x", "z"]},
            {"rod": "rod", "at": {"node": count // 4}, "fix": ["z"]},
        ],
        loads=[{"point_force": {"rod": "rod", "at": head, "force": [0, -force, 0]}}],
        output={"probes": {"y": {"rod": "rod", "at": head, "quantity": "y"}}},
    )
    scene["model"] = model
    result = der.run(scene)
    return result.probes["y"][-1] + 1, result


@pytest.mark.parametrize("force", [0.01, 2.0, 5.0])
def test_pressed_ring(fitted_order, force):
    exact = pressed_diameter(force)
    if force < 0.1:  # (pi/4 - 2/pi) F R^3/EI
        assert 2 - exact == pytest.approx((np.pi / 4 - 2 / np.pi) * force, rel=5e-3)
    sizes = [20, 40, 80]
    errors = [press(n, force)[0] - exact for n in sizes]
    assert fitted_order([1 / n for n in sizes], errors) > 1.9
    assert abs(errors[-1]) < 5e-3


@pytest.mark.parametrize("model", ["spatial_bend", "spatial"])
def test_planar_ring_is_the_same_in_all_models(model):
    """Statics of a bent ring that is straight without stress, and a motion of it."""
    points = circle(24)
    points[:, 1] *= 0.8
    stiff = section(EA=1e4, EI=1.0, GJ=0.7)
    base = ring_through(
        points,
        stiff,
        {"natural_curvature": [0, 0]},
        supports=[{"rod": "rod", "at": {"node": 5}, "fix": ["x", "y", "z"]}],
        loads=[
            {"point_force": {"rod": "rod", "at": 0.03, "force": [0.2, -0.3, 0]}},
            {"distributed_force": {"rod": "rod", "force": [0, 0.1, 0], "from": 3.5}},
        ],
        time={"duration": 0.5, "step": 0.01, "integrator": "sdirk4"},
    )
    runs = [der.run({**base, "model": each}) for each in ("planar", model)]
    here, there = (run.positions[-1] for run in runs)
    assert np.abs(here - points[:, :2]).max() > 0.01  # it has moved
    assert np.abs(there[:, :2] - here).max() < 1e-9
    assert np.abs(there[:, 2]).max() < 1e-12


def test_pressed_ring_is_the_same_in_space():
    planar = press(24, 3.0)[1]
    spatial = press(24, 3.0, model="spatial")[1]
    assert np.abs(spatial.positions[-1][:, :2] - planar.positions[-1]).max() < 1e-9


CURVES = {
    "figure_eight.0.5": figure_eight(0.5),
    "torus2.3": torus_knot(2, 3),
    "torus1.8": torus_knot(1, 8),
}


@pytest.mark.parametrize("count", [20, 40, 80])
@pytest.mark.parametrize("name", list(CURVES))
def test_writhe_of_polygons(spatial_reference, name, count):
    points = CURVES[name](2 * np.pi * np.arange(count) / count).T
    scene = ring_through(
        points,
        section(EI=1.0, GJ=1.0),
        output={"probes": {"writhe": {"rod": "rod", "quantity": "writhe"}}},
    )
    exact = spatial_reference("writhe", f"{name}.polygon{count}.writhe")
    assert der.run(scene).probes["writhe"][-1] == pytest.approx(exact, abs=1e-11)


def test_link_is_kept():
    """A twisted ring that buckles in a motion: its twist becomes writhe."""
    turns = 3
    scene = michell(40, 1.0, 2 * np.pi * turns, wave=0.02)
    del scene["analysis"]
    names = ("link", "writhe")
    scene |= {
        "time": {"duration": 1.9, "step": 0.01, "integrator": "implicit_midpoint"},
        "output": {"probes": {name: {"rod": "rod", "quantity": name} for name in names}},
    }
    result = der.run(scene)
    link, writhe = (np.asarray(result.probes[name]) for name in names)
    assert np.abs(link - link[0]).max() < 1e-11
    assert writhe[0] < 0.01
    assert np.abs(writhe).max() > 0.5


def test_link_of_directors_that_close():
    """A ring drawn flat, its sections turned 2 times on the way around: a whole number."""
    points = circle(30)
    for turns in (0, 2, -5):
        scene = ring_through(
            points,
            section(EI=1.0, GJ=1.0),
            {"initial_twist": 2 * np.pi * turns / length_of(points)},
            output={"probes": {"link": {"rod": "rod", "quantity": "link"}}},
        )
        assert der.run(scene).probes["link"][-1] == pytest.approx(turns, abs=1e-12)


def strip(**stiffnesses):
    return section(EA=1e4, EI1=3.0, EI2=1.0, GJ=0.6, rotary_inertia=0.01, **stiffnesses)


def test_twisted_ring_stays_at_rest():
    """A knot without stress as it is drawn, whatever the mismatch of its directors: 1e4 steps."""
    points = torus_knot(2, 3)(2 * np.pi * np.arange(16) / 16).T
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    scene = ring_through(
        points @ turn,
        strip(director=[0.3, 0.2, 1.0]),
        {"initial_twist": 1.3},
        time={"duration": 10.0, "step": 0.001, "integrator": "implicit_midpoint"},
        output={"every": 10.0},
    )
    result = der.run(scene)
    assert np.abs(result.positions[-1] - points @ turn).max() < 1e-11


def test_glue_of_a_moebius_strip_is_a_joint_as_the_others():
    """A straight strip, half a turn twisted and glued: where the glue is does not matter.

    There the section meets itself the other way up, which is the same section.
    """
    count = 20
    points = circle(count)
    twist = np.pi / length_of(points)
    energies = []
    for first in (0, 1, 5, 13):
        start = np.roll(points, -first, axis=0)
        tangent = (start[1] - start[0]) / np.linalg.norm(start[1] - start[0])
        angle = np.pi * first / count
        director = np.cos(angle) * np.eye(3)[2] + np.sin(angle) * np.cross(tangent, np.eye(3)[2])
        scene = ring_through(start, strip(director=director), {**STRAIGHT, "initial_twist": twist})
        energies.append(der.Simulation(der.Scenario.from_dict(scene)).energies.bend)
    assert energies == pytest.approx(energies[:1] * 4, rel=1e-12)


@pytest.mark.parametrize("shift", [1, 7, 23])
def test_start_of_a_ring_is_a_place_like_any_other(shift):
    """The same ring drawn from another node on: statics of a twisted ring under its weight."""
    count = 24
    twist = 0.7

    def run(first):
        points = np.roll(michell(count, 0.8, 0.0)["rods"][0]["points"], -first, axis=0)
        nodes = [(node - first) % count for node in (2, 9, 16)]
        scene = ring_through(
            points,
            section(EA=1e4, EI=1.0, GJ=0.8),
            {**STRAIGHT, "initial_twist": twist},
            supports=[
                {"rod": "rod", "at": {"node": node}, "fix": ["x", "y", "z"]} for node in nodes
            ],
            loads=[
                {"gravity": [0, 0, -1]},
                {"point_force": {"rod": "rod", "at": {"node": nodes[1] - 3}, "force": [0, 2, 1]}},
            ],
        )
        result = der.run(scene)
        _, moments = result.along("rod", "moment")
        return result.positions[-1], moments[-1][:-1]

    here, there = run(0), run(shift)
    assert np.abs(here[0] - michell(count, 0.8, 0.0)["rods"][0]["points"]).max() > 0.01
    for one, other in zip(here, there, strict=True):
        assert np.abs(np.roll(other, shift, axis=0) - one).max() < 1e-9
