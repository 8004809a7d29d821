"""Loads without a potential: forces and moments that follow the rod, moments fixed in space.

References: `references/helix.py`, `curved_twisted_rod.py` (a dead force, a dead moment and one that
follows at once) and `follower_loads.py`. Beck's column flutters at P L^2/EI = 20.05 (Beck, Z.
angew. Math. Phys. 3, 1952).
"""

import re

import der
import numpy as np
import pytest
from references.curved_twisted_rod import NATURAL
from references.follower_loads import held_at_start
from references.kirchhoff_rod import Rod
from references.section_loads import Wrench
from references.section_loads import held_at_start as held_at_places
from scenes import END, START, arch
from spatial_scenes import CLAMPED, measured, rod_through, section, straight_rod

XYZ = ("x", "y", "z")
SIZES = [16, 32, 64]
SHARES = (0.25, 0.5, 0.75, 1.0)


def force(*components, at="end", follower=True):
    return {
        "point_force": {"rod": "rod", "at": at, "force": list(components), "follower": follower}
    }


def moment(*components, at="end", follower=False):
    return {"moment": {"rod": "rod", "at": at, "moment": list(components), "follower": follower}}


def fitted_errors(scene_of, exact, places, fitted_order, sizes=SIZES, axes=XYZ):
    """Errors of the positions on the finest mesh, after a check of the order of all of them."""
    errors = []
    for n in sizes:
        values, result = measured(scene_of(n), places, axes)
        assert result.summary["stability"] == "not_judged"
        errors.append(np.linalg.norm(values - exact, axis=1))
    errors = np.array(errors)
    for column in errors.T:
        assert fitted_order([1 / n for n in sizes], column) > 1.9
    return errors[-1]


@pytest.mark.parametrize("ratio", ["1", "0.667"])
def test_a_moment_that_follows_winds_a_rod_to_the_exact_helix(
    spatial_reference, fitted_order, ratio
):
    """Radius 10, height 50, two turns; with GJ = 2/3 EI another helix."""

    def value(name):
        return spatial_reference("helix", f"GJ{ratio}.{name}")

    length = value("length")
    rod = section([0, 1, 0], EA=1e4, EI=1.0, GJ=1.0 if ratio == "1" else 2 / 3)
    load = moment(
        value("follower_moment.d3"), 0, value("follower_moment.d2"), follower=True
    )  # d3, d1, d2 as drawn
    exact = np.array([[value(f"{s:g}.{c}") for c in XYZ] for s in SHARES])
    places = [s * length for s in SHARES]
    last = fitted_errors(
        lambda n: straight_rod(n, rod, to=[length, 0, 0], loads=[load]),
        exact,
        places,
        fitted_order,
        [32, 64, 128],
    )
    assert last.max() < 5e-3 * length


def test_all_loads_on_a_curved_and_twisted_rod(spatial_reference, fitted_order):
    """A dead force, a dead moment and one that follows the section at the end, and a weight."""
    exact = [
        [spatial_reference("curved_twisted_rod", f"all_loads.s{s:g}.{c}") for c in XYZ]
        for s in SHARES
    ]
    strip = section([1, 0, 0], EA=1e4, EI1=3.0, EI2=1.0, GJ=0.8)
    curved = {"natural_curvature": [NATURAL[1], -NATURAL[0]], "natural_twist": NATURAL[2]}
    loads = [
        force(1, -2, 0.5, follower=False),
        moment(0.5, 0.4, -0.3),
        # Drawn straight along z with d1 = x and d2 = y: components along d1, d2, d3.
        moment(-0.2, 0.6, 0.8, follower=True),
        {"distributed_force": {"rod": "rod", "force": [0.6, 0.8, -1.5]}},
    ]
    last = fitted_errors(
        lambda n: straight_rod(n, strip, to=[0, 0, 1], rod=curved, loads=loads),
        np.array(exact),
        list(SHARES),
        fitted_order,
        [32, 64, 128],
    )
    assert last.max() < 3e-4


def test_a_force_and_a_moment_that_follow_in_space(fitted_order):
    """A strip that bends by about a right angle and twists."""
    weak, strong, twisting, stretching = 1.0, 3.0, 0.8, 1e4
    strip = section([0, 1, 0], EA=stretching, EI1=strong, EI2=weak, GJ=twisting)
    rod = Rod(1.0, (weak, strong), twisting, stretching)
    # As drawn: d1 = y, d2 = z, d3 = x.
    exact = held_at_start(rod, (1.5, 2.0, -1.0), (0.2, 0.5, 0.7), SHARES)
    loads = [force(-1.0, 1.5, 2.0), moment(0.7, 0.2, 0.5, follower=True)]
    last = fitted_errors(
        lambda n: straight_rod(n, strip, loads=loads), exact, list(SHARES), fitted_order
    )
    assert last.max() < 1e-3


def planar_scene(model, loads, n=32, **more):
    """A straight cantilever along x that could bend in the plane alone."""
    return {**straight_rod(n, section(EA=1e4, EI=1.0, GJ=1.0), loads=loads, **more), "model": model}


#: Along the tangent and across it: the rod bends beyond half a turn.
IN_PLANE = force(-2.0, 8.0, 0)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_force_that_follows_in_the_plane(fitted_order, model):
    exact = held_at_start(Rod(1.0, (1.0, 1.0), 1.0, 1e4), (8.0, 0.0, -2.0), shares=SHARES)
    axes = XYZ[:2] if model == "planar" else XYZ
    last = fitted_errors(
        lambda n: planar_scene(model, [IN_PLANE], n),
        exact[:, : len(axes)],
        list(SHARES),
        fitted_order,
        axes=axes,
    )
    assert last.max() < 3e-3


@pytest.mark.parametrize("stepper", ["static", "implicit_midpoint", "sdirk4", "verlet"])
@pytest.mark.parametrize(
    "load",
    [IN_PLANE, force(0.5, 3.0, 0, at=0.437), moment(0, 0, 2.0), moment(0, 0, 2.0, at=0.437)],
    ids=["tip force", "force", "tip moment", "moment"],
)
def test_a_planar_scene_is_the_same_in_space(stepper, load):
    more = {}
    if stepper != "static":
        time = {"duration": 0.2, "step": 0.01, "integrator": stepper}
        if stepper == "verlet":
            time |= {"duration": 0.01, "step": "auto"}
        more["time"] = time
    answers, balances = [], []
    for model in ("planar", "spatial"):
        rod = section(EA=1e3, EI=1.0, GJ=1.0, rotary_inertia=1e-3)
        scene = {**straight_rod(12, rod, loads=[load], **more), "model": model}
        values, result = measured(scene, [0.3, "middle", "end"], ("x", "y", "vx", "vy"))
        answers.append(values)
        balances.append([result.energies[k][-1] for k in ("kinetic", "stretch")])
        balances[-1] += [result.work[k][-1] for k in ("loads", "supports")]
    assert answers[1] == pytest.approx(answers[0], abs=1e-9)
    if stepper != "static":  # the ledger of the plane has the energy of the cells besides
        assert balances[1][0] == pytest.approx(balances[0][0], abs=1e-9)


def error_of_small_moment(place, edges):
    """How far the end is off beam theory, over M L^2/EI of the weak axis: a moment M at a moves it
    by M a (1 - a/2)/EI."""
    strip = section([0, 1, 0], EA=1e6, EI1=3.0, EI2=1.0, GJ=0.8)
    small = 1e-6
    scene = straight_rod(edges, strip, loads=[moment(2 * small, -small, small, at=place)])
    values, _ = measured(scene, ["end"], ("y", "z"))
    exact = np.array([1 / 3, 1]) * place * (1 - place / 2)
    return np.abs(values[0] / small - exact).max()


@pytest.mark.parametrize("place", [0.013, 0.29, 0.5, 0.7183, 1.0])
def test_moments_anywhere_along_a_rod(place):
    """Small ones, between nodes, beside the clamp and at a node, in every direction. The error is
    at most l^2/12 of M/EI, at a node, and jumps from mesh to mesh."""
    for n in SIZES:
        assert error_of_small_moment(place, n) < 1.01 / 12 / n**2 + 1e-6


@pytest.mark.parametrize("edges", [0.2, 0.5, 0.7, 1.2])
def test_moments_beside_a_clamp(fitted_order, edges):
    """At the same part of the edges beside it, on both sides of where it begins to take a part."""
    errors = [error_of_small_moment(edges / n, n) for n in SIZES]
    assert fitted_order([1 / n for n in SIZES], errors) > 1.99
    assert max(errors) < 0.08 / SIZES[0] ** 2


ALONG_X = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])  # d1 = y, d2 = z, d3 = x


@pytest.mark.parametrize("part", [0.1, 0.3, 0.45])
def test_a_moment_that_follows_just_before_a_free_end(fitted_order, part):
    """Within half an edge of the end, always at the same part of the edge: the moment bends the
    rod up to its place, and turns with that. Reference: shooting, `references/section_loads.py`.
    """
    rod = Rod(1.0, (1.0, 2.0), 0.8, 3e4)
    load, couple = np.array([0.0, 1.0, 0.3]), np.array([1.5, 1.0, 0.2])
    strip = section([0, 1, 0], EA=3e4, EI1=2.0, EI2=1.0, GJ=0.8)
    sizes = (20, 40, 80)
    errors = []
    for n in sizes:
        place = 1 - part / n
        wrenches = [Wrench(0.8, force=load), Wrench(place, moment=couple), Wrench(1.0)]
        _, exact, _ = held_at_places(rod, wrenches, ALONG_X)
        loads = [
            force(*(ALONG_X @ load), at=0.8),
            moment(*(ALONG_X @ couple), at=place, follower=True),
        ]
        values, _ = measured(straight_rod(n, strip, loads=loads), [0.8], XYZ)
        errors.append(np.linalg.norm(values[0] - exact[0]))
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


def far_from_the_clamp(loads, supports, edges):
    """The same rod with sixteen times as many edges: a place in the first edge of the coarse mesh
    is then inside the rod, where moments are compared with shooting in this file."""
    strip = section([0, 1, 0], EA=3e4, EI1=1.0, EI2=2.0, GJ=0.8)
    probed = [0.3, 0.8, "end"], (*XYZ, "torque")
    coarse, fine = (
        measured(straight_rod(n, strip, loads=loads, supports=supports), *probed)[0]
        for n in (edges, 16 * edges)
    )
    return np.abs(coarse - fine).max(axis=0)


@pytest.mark.parametrize("part", [0.1, 0.3, 0.51])
def test_a_moment_beside_a_clamp_that_lets_the_section_spin(fitted_order, part):
    """It has a part about the tangent at its place, which twists the rod; with the tangent at the
    end of the clamp's cell in its place the torque was 90 % off with 20 edges."""
    supports = [
        {**START, "clamp": "tangent"},
        {"rod": "rod", "at": 0.6, "spring": {"rotational_stiffness": 4}},
    ]
    loads = [force(0, 1, 1.2, follower=False)]
    errors = [
        far_from_the_clamp([*loads, moment(0, 2, 1, at=part / n)], supports, n) for n in (20, 40)
    ]
    assert fitted_order([1 / 20, 1 / 40], [np.linalg.norm(e) for e in errors]) > 1.9
    assert errors[0][3] < 2e-3


@pytest.mark.parametrize("part", [0.1, 0.25, 0.45])
@pytest.mark.parametrize(
    ("couple", "follower"), [((0.1, 0.6, -0.3), False), ((1, 2, -3), False), ((0, 0.6, 0), True)]
)
def test_a_moment_beside_a_held_tangent_of_an_arc(fitted_order, couple, follower, part):
    """The tangent turns from the clamp to the place and on to the edge's. The clamp lets the
    section spin, and bears no torque: it did, and the torque was 50 % off in the whole rod, at any
    mesh. Reference: sixteen times the edges, where the place is inside the rod."""
    strip = section([0, 0, 1], EA=1e5, EI1=2.0, EI2=1.0, GJ=0.8)

    def values(edges, place):
        s = np.linspace(0, 1, edges + 1)
        scene = rod_through(
            np.column_stack([np.sin(s), 1 - np.cos(s), 0 * s]),
            strip,
            supports=[{**START, "clamp": "tangent"}, {**END, "clamp": True}],
            loads=[moment(*couple, at=place, follower=follower)],
        )
        found, result = measured(scene, [0.3, 0.6], ("z", "torque", "moment_1", "moment_2"))
        return found, result.reactions()[0].moment[-1]

    errors, torques = [], []
    for n in (10, 20, 40):
        coarse, reaction = values(n, part / n)
        errors.append(np.linalg.norm(coarse - values(16 * n, part / n)[0]))
        torques.append(abs(reaction[0]))
    assert fitted_order([1 / 10, 1 / 20, 1 / 40], errors) > 1.9
    assert errors[0] < 0.01 * np.linalg.norm(couple)
    assert fitted_order([1 / 10, 1 / 20, 1 / 40], torques) > 1.9
    assert max(torques) < 1e-4 * np.linalg.norm(couple)


@pytest.mark.parametrize("part", [0.502, 0.51, 0.52])
def test_a_torque_between_the_middle_of_an_edge_and_the_end_of_the_clamps_cell(fitted_order, part):
    """In bending the clamp's cell ends at 25/48 of the edge, in twist at its middle."""
    supports = [{**START, "clamp": True}]
    loads = [force(0.3, 1.5, 1.8, follower=False)]
    errors = [
        far_from_the_clamp([*loads, moment(2, 0, 0, at=part / n)], supports, n)[:3]
        for n in (20, 40)
    ]
    assert fitted_order([1 / 20, 1 / 40], [np.linalg.norm(e) for e in errors]) > 1.9


def ledger_of(loads, supports, step):
    """Work of the loads, and the energy that the ledger misses."""
    strip = section([0, 1, 0], EA=100.0, EI1=3.0, EI2=1.0, GJ=0.8, rotary_inertia=0.05)
    time = {"duration": 0.4, "step": step, "integrator": "implicit_midpoint"}
    scene = straight_rod(6, strip, loads=loads, supports=supports, time=time)
    _, result = measured(scene, ["end"], ["x"])
    return result.work["loads"][-1], result.work["numerical"][-1]


def test_the_ledger_closes(fitted_order):
    """Loads that do work along a closed way: the ledger misses the square of the step."""
    loads = [
        force(-0.5, 1.0, 0.5),
        moment(0.3, 0.2, 0.1, at=0.61),
        moment(0.2, 0.1, 0.3, follower=True),
    ]
    steps = [0.01, 0.005, 0.0025, 0.00125]
    works = [ledger_of(loads, [{**START, "clamp": True}], step) for step in steps]
    assert min(abs(work) for work, _ in works) > 0.1
    assert fitted_order(steps, [missed for _, missed in works]) > 1.9


def test_the_ledger_of_loads_at_one_place():
    """On a spring, where each of them turns the section that the others act on."""
    at = {"at": 0.61}
    loads = [
        force(-0.5, 1.0, 0.5, **at),
        moment(0.3, 0.2, 0.1, **at),
        moment(0.2, 0.1, 0.3, follower=True, **at),
    ]
    spring = {"rod": "rod", **at, "spring": {"rotational_stiffness": [8.0, 0.5, 1.0]}}
    work, missed = ledger_of(loads, [{**START, "clamp": True}, spring], 0.00125)
    assert abs(missed) < 1e-6 * abs(work)  # waves that the sudden loads excite hide the order


@pytest.mark.parametrize(("load", "grows"), [(19.0, False), (21.2, True)])
def test_becks_column_flutters(load, grows):
    """At 20.05 EI/L^2 vibrations under a force along the end's tangent begin to grow, though no
    equilibrium besides the straight one exists."""
    rod = section(EA=1e5, EI=1.0, GJ=1.0)
    scene = straight_rod(
        20,
        rod,
        loads=[force(-load, 0, 0)],
        time={"duration": 5.0, "step": 0.01, "integrator": "implicit_midpoint"},
        rod={"initial_velocity": [[0, 1e-6 * (k / 20) ** 2, 0] for k in range(21)]},
    )
    scene["model"] = "planar"
    scene["output"] = {"every": 0.05, "probes": {"y": {"rod": "rod", "at": "end", "quantity": "y"}}}
    y = np.abs(der.run(der.Scenario.from_dict(scene)).probes["y"])
    later, before = y[len(y) // 2 :].max(), y[: len(y) // 2].max()
    assert later > 3 * before if grows else later < 1.5 * before


def test_what_needs_a_potential_is_refused():
    scene = planar_scene("planar", [force(-1, 0, 0)], analysis={"modes": {"count": 2}})
    with pytest.raises(der.SceneError, match="modes are those of a potential"):
        der.Scenario.from_dict(scene)
    static = der.Simulation(der.Scenario.from_dict(planar_scene("planar", [IN_PLANE])))
    assert static.equilibrium().stability == "not_judged"
    with pytest.raises(der.DerError, match="have no potential"):
        static.modes(2)


def test_a_rod_that_nothing_holds_against_a_force_that_follows():
    supports = [{**START, "fix": ["y", "z"]}, {**END, "fix": ["y", "z"]}]
    scene = straight_rod(8, section(EI=1.0, GJ=1.0), supports=supports, loads=[force(1, 0, 0)])
    with pytest.raises(der.NotConvergedError, match="no support holds rod 'rod' in x"):
        der.Simulation(der.Scenario.from_dict(scene)).equilibrium()


@pytest.mark.parametrize("load", ["force", "moment"])
def test_a_rod_that_spins_about_its_clamped_tangent(load):
    """The message says what turns, and what holds it."""
    strip = section(EA=1e4, EI1=2.0, EI2=1.0, GJ=0.6)
    across = {"rod": "rod", "at": "end", load: [0, 0.2, 0.3], "follower": True}
    loads = [{"point_force" if load == "force" else load: across}]
    supports = [{**START, "clamp": "tangent"}]
    scene = straight_rod(20, strip, supports=supports, loads=loads)
    with pytest.raises(der.NotConvergedError, match="spins freely about the tangent") as failure:
        der.Simulation(der.Scenario.from_dict(scene)).equilibrium()
    assert failure.value.status == "not_held"
    assert "'clamp: true'" in str(failure.value)
    spring = {"rotational_stiffness": [0, 0, 1.0]}
    supports.append({"rod": "rod", "at": 0.3, "spring": spring})
    der.Simulation(der.Scenario.from_dict(scene)).equilibrium()


@pytest.mark.parametrize("seed", [79, 1005, 1035, 1048])
def test_the_smallest_moment_leaves_the_equilibrium_that_is_there_without_it(seed):
    """Rods with several equilibria, drawn straight: Newton's method goes far from there."""
    random = np.random.default_rng(seed)
    edges = int(random.choice([20, 40, 60]))
    stiffnesses = {key: float(random.uniform(0.5, 2)) for key in ("EI1", "EI2", "GJ")}
    largest = 6 if seed == 79 else 10
    natural = {
        "natural_curvature": random.uniform(-largest, largest, 2).tolist(),
        "natural_twist": float(random.uniform(-6, 6)),
    }
    spring = {"stiffness": [50, 80, 30], "rotational_stiffness": [3, 1, 2]}
    scene = straight_rod(
        edges,
        section(EA=1e4, **stiffnesses),
        rod=natural,
        supports=[*CLAMPED, {"rod": "rod", "at": 0.6, "spring": spring}],
    )
    without = der.run(scene).positions[-1]
    for more in ({"follower": True}, {}):
        tiny = {"rod": "rod", "at": 0.3, "moment": [2e-9, -1e-9, 3e-9], **more}
        found = der.run({**scene, "loads": [{"moment": tiny}]}).positions[-1]
        assert found == pytest.approx(without, abs=1e-5)


@pytest.mark.parametrize(
    ("factor", "tip"), [(0.25, (0.453, 0.621, 0.428)), (0.35, (0.727, 0.296, 0.507))]
)
def test_the_answer_is_on_the_path_from_the_unloaded_rod(factor, tip):
    """Two equilibria exist; the tips are those of shooting along the path in 280 steps."""
    along = np.array([1.0, 0.3, -0.2])
    bar = section([0.2, 0.1, 1.0], EA=1e5, EI1=1.0, EI2=0.6, GJ=0.5)
    loads = [
        force(*(factor * np.array([-4.0, 7.0, -4.0]))),
        moment(*(factor * np.array([1.0, 2.0, 3.0]))),
    ]
    scene = straight_rod(80, bar, to=along / np.linalg.norm(along), loads=loads)
    values, _ = measured({**scene, "analysis": "static"}, ["end"], ("x", "y", "z"))
    assert values[0] == pytest.approx(tip, abs=2e-3)


@pytest.mark.parametrize("end", ["start", "end"])
@pytest.mark.parametrize("follower", [False, True])
def test_a_moment_at_a_tangent_clamp_is_a_torque(end, follower):
    """The clamp takes its part across the tangent, and a spin needs the whole of the other."""
    torque = 0.3
    other = "end" if end == "start" else "start"
    strip = section([0, 1, 0], EA=1e5, EI1=1.0, EI2=0.5, GJ=0.8)
    scene = straight_rod(8, strip, loads=[moment(torque, 0.2, -0.4, at=end, follower=follower)])
    scene["supports"] = [
        {"rod": "rod", "at": end, "clamp": "tangent"},
        {"rod": "rod", "at": other, "clamp": True},
    ]
    values, result = measured(scene, ["start", 0.35, "end"], ("torque", "moment_1", "y"))
    sign = -1.0 if end == "start" else 1.0
    assert values == pytest.approx(np.tile([sign * torque, 0, 0], (3, 1)), abs=1e-9)
    assert result.summary["warnings"] == []
    # The rod stores T^2 L/(2 GJ), half of which the cell at the clamp has, beyond its edge.
    assert result.energies["bend"][-1] == pytest.approx(torque**2 / 1.6, rel=1e-9)
    moments = sum(reaction.moment[-1] for reaction in result.reactions())
    assert moments[0] == pytest.approx(-torque, abs=1e-9)
    assert np.hypot(*moments[1:]) == pytest.approx(np.hypot(0.2, 0.4), abs=1e-9)


def test_moment_and_torque_up_to_a_turned_end(fitted_order):
    """A moment at the end of a rod with EI = GJ bends it to a helix: both are uniform."""
    strip = section([0, 1, 0], EA=1e5, EI1=1.0, EI2=1.0, GJ=1.0)
    errors = []
    for n in SIZES:
        scene = straight_rod(n, strip, loads=[moment(0.3, 0.0, 0.5)])
        scene["analysis"] = "static"
        scene["output"] = {
            "probes": {
                f"{quantity}_{reduce}": {"quantity": quantity, "rod": "rod", **where}
                for quantity in ("moment", "torque")
                for reduce, where in (
                    ("end", {"at": "end"}),
                    ("least", {"over": "rod", "reduce": "min"}),
                    ("most", {"over": "rod", "reduce": "max"}),
                )
            }
        }
        values = np.array([probe[-1] for probe in der.run(scene).probes.values()])
        errors.append(np.abs(values - np.repeat([0.5, 0.3], 3)).max())
    assert fitted_order(SIZES, errors) < -1.9


def test_a_failure_says_how_far_the_loads_could_be_raised():
    """A shallow arch under a force that follows its middle, which stays horizontal: it snaps at the
    fold of the path under the dead force."""
    scene = arch(24, 0.1)
    path = der.run({**scene, "analysis": {"continuation": {"to": 200.0}}}).path
    fold = path.factor[path.rows("fold")[0]]
    load = {"rod": "rod", "at": "middle", "force": [0, -2.0 * fold], "follower": True}
    with pytest.raises(der.NotConvergedError, match="no equilibrium found: the path of") as failure:
        der.run({**scene, "loads": [{"point_force": load}]})
    share = float(re.search(r"up to ([0-9.]+) times the loads", str(failure.value)).group(1))
    assert share == pytest.approx(0.5, abs=2e-3)


@pytest.mark.parametrize("follower", [True, False])
def test_a_force_at_a_clamped_node_is_warned_of(follower):
    scene = planar_scene("planar", [force(0, 1.0, 0, at="start", follower=follower)], n=8)
    warnings = der.run(scene).summary["warnings"]
    assert len(warnings) == 1
    assert "point_force" in warnings[0]
    assert "the support takes it up" in warnings[0]


def test_a_force_that_follows_a_hinged_end_across_its_free_axis_is_no_mistake():
    supports = [{**START, "fix": ["x", "y"]}, {**END, "fix": ["y"]}]
    loads = [force(-1.0, 0.2, 0)]
    scene = planar_scene("planar", loads, n=8, supports=supports)
    assert der.run(scene).summary["warnings"] == []


@pytest.mark.parametrize(
    ("model", "load"),
    [
        ("planar", {"force": (0.0, -0.9, 0.5)}),
        ("spatial", {"force": (0.4, -0.9, 0.5)}),
        ("spatial", {"moment": (0.9, 0.7, 0.4)}),
    ],
    ids=["force in the plane", "force", "moment"],
)
@pytest.mark.parametrize("free", ["end", "start"])
def test_what_follows_a_free_end_of_a_rod_drawn_as_an_arc(fitted_order, model, load, free):
    """With a natural curvature that is given, edges at a free end lean against the curve, but those
    that are drawn are its chords. The rod is straight by nature."""
    arc = 1.2  # [rad], of length 1
    bar = section(EA=1e5, EI=1.0)
    rod = Rod(1.0, (1.0, 1.0), 0.7, 1e5)
    natural = 0
    if model == "spatial":
        bar = section([0, 0, 1], EA=1e5, EI1=0.6, EI2=1.0, GJ=0.7)
        rod = Rod(1.0, (1.0, 0.6), 0.7, 1e5)  # about d1 = z and about d2
        natural = [0, 0]
    drawn = [
        np.array([[0, np.sin(a), np.cos(a)], [0, -np.cos(a), np.sin(a)], [1, 0, 0]])
        for a in (0.0, arc)
    ]
    tip, _, _ = held_at_places(rod, [Wrench(1.0, **load)], drawn[0])
    ((kind, components),) = load.items()
    dimension = 2 if model == "planar" else 3
    vector = (drawn[1] @ components)[:dimension].tolist()
    sizes = (20, 40, 80)
    errors = []
    for n in sizes:
        angle = np.linspace(0, arc, n + 1)
        points = np.column_stack([np.sin(angle), 1 - np.cos(angle), 0 * angle])[:, :dimension] / arc
        at = {"rod": "rod", "at": free, kind: vector, "follower": True}
        scene = rod_through(
            points if free == "end" else points[::-1],
            bar,
            supports=[{"rod": "rod", "at": "start" if free == "end" else "end", "clamp": True}],
            loads=[{"point_force" if kind == "force" else "moment": at}],
            model=model,
            rod={"natural_curvature": natural},
        )
        found = der.run(scene).positions[-1][-1 if free == "end" else 0]
        errors.append(np.linalg.norm(found - tip[:dimension]))
    assert errors[0] < 1.0 / sizes[0] ** 2
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


def corner_wire(size):
    """A wire of `size` components, drawn with a corner at node 10 and straight without stress."""
    legs = [[0.05 * i, 0.0, 0.0] for i in range(11)] + [[0.5, 0.05 * i, 0.0] for i in range(1, 11)]
    return {
        "name": "rod",
        "points": [point[:size] for point in legs],
        "cross_section": {"stiffness": {"EA": 1e4, "EI": 1.0, "GJ": 1.0, "mass_per_length": 1.0}},
        "natural_curvature": 0.0,
    }


@pytest.mark.parametrize("bends", [True, False])
@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_force_that_follows_keeps_its_size_at_a_kink(model, bends):
    """At the corner of a wire that is straight without stress, and where it bends a cable: it turns
    with the mean of both sides, and the supports bear all of it."""
    size = 2 if model == "planar" else 3
    force = np.array([0.6, -0.8, 1.2])[:size]
    rod = corner_wire(size)
    supports = [{"rod": "rod", "at": "start", "clamp": True}]
    load = {"rod": "rod", "at": {"node": 10}, "force": force.tolist(), "follower": True}
    scene = {"model": model, "rods": [rod], "supports": supports, "analysis": "static"}
    scene["loads"] = [{"point_force": load}]
    if not bends:
        force = np.array([0.0, -1.0, 0.0])[:size]
        sag = [[0.05 * i, 0.02 * i * (0.05 * i - 1.0), 0.0] for i in range(21)]
        rod["points"] = [point[:size] for point in sag]
        del rod["natural_curvature"]
        rod["cross_section"]["stiffness"] |= {"EI": 0.0}
        held = {"fix": ["x", "y", "z"][:size]}
        scene["supports"] = [{"rod": "rod", "at": end, **held} for end in ("start", "end")]
        load["force"] = force.tolist()
    reactions = der.run(der.Scenario.from_dict(scene)).reactions()
    whole = sum(reaction.force[-1] for reaction in reactions)
    assert np.linalg.norm(whole) == pytest.approx(np.linalg.norm(force), rel=1e-7)


def test_a_moment_that_follows_keeps_its_size_at_a_kink():
    rod = corner_wire(3)
    moment = [0.3, -0.4, 0.5]
    load = {"rod": "rod", "at": {"node": 10}, "moment": moment, "follower": True}
    scene = {
        "rods": [rod],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "loads": [{"moment": load}],
        "analysis": "static",
    }
    reaction = der.run(der.Scenario.from_dict(scene)).reactions()[0]
    assert np.linalg.norm(reaction.moment[-1]) == pytest.approx(np.linalg.norm(moment), rel=1e-9)
