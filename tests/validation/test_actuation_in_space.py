"""Rods in space whose natural curvatures, twist and length change on parts of them.

References: the exponential of a constant rate of turning, which is a helix; `kirchhoff_rod.py`, the
boundary value problem of the spatial rod; the planar model.
"""

import math
from itertools import accumulate, pairwise

import der
import numpy as np
import pytest
from actuated import PROFILES, bend, probed, stretch
from references.kirchhoff_rod import UPRIGHT
from scenes import END, START, tip_force
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import root
from spatial_scenes import CLAMPED, rod_through, section, straight_rod

SIZES = [20, 40, 80]
STEPS = [1 / n for n in SIZES]
#: Meshes on which the thirds and the ninths lie at the same part of their edges.
ALIKE = [38, 74, 146]
ALIKE_STEPS = [1 / n for n in ALIKE]
FINE = [74, 146, 290]
WEAK, STRONG, TWISTING, STRETCHING = 1.0, 3.0, 0.8, 1e5
BEAM = section([0, 1, 0], EA=STRETCHING, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
CURVATURES, TWIST = (1.3, -0.8), 2.1
STRAINS = ("curvature_1", "curvature_2", "twist", "moment_1", "moment_2", "torque", "tension")


def twist(value, start, end, name="twist", **more):
    actuation = {"name": name, "rod": "rod", "from": start, "to": end, "natural_twist": value}
    return actuation | more


def screw(length, k1, k2, turn):
    """Motion of the section along a curve of constant curvatures and twist, as a 4x4 matrix.

    Its frame has the columns d1, d2, d3, and turns at u = (-k2, k1, twist) along them; it moves
    along d3.
    """
    rate = np.zeros((4, 4))
    u1, u2, u3 = -k2, k1, turn
    rate[:3, :3] = [[0, -u3, u2], [u3, 0, -u1], [-u2, u1, 0]]
    rate[2, 3] = 1.0
    return expm(length * rate)


def curve(parts):
    """Position at the end of pieces (length, k1, k2, twist) of a rod along x from the origin."""
    place = np.eye(4)
    place[:3, :3] = UPRIGHT
    for part in parts:
        place = place @ screw(*part)
    return place[:3, 3]


def actuated(edges, *actuations, **more):
    return straight_rod(edges, BEAM, actuation=list(actuations), **more)


def elastic_energy(result):
    return sum(result.summary["energies"][name] for name in ("stretch", "bend"))


def test_straight_rod_becomes_a_helix(fitted_order):
    """A helix of radius k/(k^2 + t^2) and pitch 2 pi t/(k^2 + t^2)."""
    k, t = np.hypot(*CURVATURES), TWIST
    exact = curve([(1.0, *CURVATURES, TWIST)])
    # The axis has the direction of u = (-k2, k1, twist) at the clamp, and lies k/(k^2 + t^2)
    # towards the curvature.
    axis = UPRIGHT @ [-CURVATURES[1], CURVATURES[0], TWIST] / np.hypot(k, t)
    centre = UPRIGHT @ [*CURVATURES, 0.0] / (k**2 + t**2)
    errors, radii, pitches = [], [], []
    for n in SIZES:
        scene = actuated(n, bend(list(CURVATURES), 0.0, 1.0), twist(TWIST, 0.0, 1.0))
        result = der.run(scene)
        assert elastic_energy(result) < 1e-20
        x = result.positions[-1]
        errors.append(np.linalg.norm(x[-1] - exact))
        off = x - centre
        radius = np.linalg.norm(off - np.outer(off @ axis, axis), axis=1)
        radii.append(np.abs(radius - k / (k**2 + t**2)).max())
        advance = (x[-1] - x[0]) @ axis * 2 * np.pi / np.hypot(k, t)
        pitches.append(advance - 2 * np.pi * t / (k**2 + t**2))
    for each in (errors, radii, pitches):
        assert fitted_order(STEPS, each) > 1.9
        assert abs(each[-1]) < STEPS[-1] ** 2


#: Thirds and ninths lie at the same part of the edges of all meshes.
STRETCHES = [(1 / 3, 7 / 9), (0.0, 7 / 9), (1 / 3, 1.0), (0.004, 0.777), (0.503, 0.511)]


@pytest.mark.parametrize("ends", STRETCHES)
def test_helix_joined_to_straight_pieces(fitted_order, ends):
    """Both kinds on one stretch."""
    start, end = ends
    exact = curve([(start, 0, 0, 0), (end - start, *CURVATURES, TWIST), (1 - end, 0, 0, 0)])
    places = [(start, "after"), (0.5 * (start + end), "after"), (end, "before")]
    places += [(start, "before")] * (start > 0) + [(end, "after")] * (end < 1)
    truth = np.zeros((len(places), len(STRAINS)))
    truth[:3, :3] = [*CURVATURES, TWIST]
    errors = []
    for n in ALIKE:
        scene = actuated(n, bend(list(CURVATURES), *ends), twist(TWIST, *ends))
        result = der.run(scene)
        assert elastic_energy(result) < 1e-20
        errors.append(np.linalg.norm(result.positions[-1, -1] - exact))
        assert probed(scene, places, STRAINS) == pytest.approx(truth, abs=1e-6)
    turn = np.linalg.norm([*CURVATURES, TWIST]) * (end - start)
    assert (errors < turn * np.square(ALIKE_STEPS)).all()
    if ends in STRETCHES[:3]:
        assert fitted_order(ALIKE_STEPS, errors) > 1.9


def test_curvatures_and_twist_on_different_parts(fitted_order):
    ends = (1 / 9, 1 / 3, 2 / 3, 8 / 9)
    exact = curve(
        [
            (1 / 9, 0, 0, 0),
            (2 / 9, 0, 0, TWIST),
            (1 / 3, *CURVATURES, TWIST),
            (2 / 9, *CURVATURES, 0),
            (1 / 9, 0, 0, 0),
        ]
    )
    errors = []
    for n in ALIKE:
        bent, twisted = bend(list(CURVATURES), *ends[1::2]), twist(TWIST, *ends[::2])
        scene = actuated(n, bent, twisted)
        result = der.run(scene)
        assert elastic_energy(result) < 1e-20
        errors.append(np.linalg.norm(result.positions[-1, -1] - exact))
    assert fitted_order(ALIKE_STEPS, errors) > 1.9


def test_helix_on_an_uneven_mesh(fitted_order):
    """Edges are 3 to 5 times a length."""

    def placed(u):
        return u + math.sin(2 * math.pi * u) / (8 * math.pi)

    start, end = placed(1 / 3), placed(7 / 9)
    exact = curve([(start, 0, 0, 0), (end - start, *CURVATURES, TWIST), (1 - end, 0, 0, 0)])
    errors = []
    for n in FINE:
        points = [[placed(k / n), 0.0, 0.0] for k in range(n + 1)]
        acts = [bend(list(CURVATURES), start, end), twist(TWIST, start, end)]
        result = der.run(rod_through(points, BEAM, actuation=acts))
        assert elastic_energy(result) < 1e-20
        errors.append(np.linalg.norm(result.positions[-1, -1] - exact))
    assert fitted_order([1 / n for n in FINE], errors) > 1.9


def test_helix_beyond_a_clamp_inside(fitted_order):
    """The part beyond the clamp in the middle starts from there, straight along x."""
    beyond = curve([(7 / 9 - 1 / 2, *CURVATURES, TWIST), (2 / 9, 0, 0, 0)])
    exact = beyond + np.array([0.5, 0.0, 0.0])
    errors = []
    for n in FINE:
        inner = {"rod": "rod", "at": {"node": n // 2}, "clamp": True}
        acts = [bend(list(CURVATURES), 1 / 3, 7 / 9), twist(TWIST, 1 / 3, 7 / 9)]
        scene = actuated(n, *acts, supports=[*CLAMPED, inner])
        errors.append(np.linalg.norm(der.equilibrium(scene).positions[-1, -1] - exact))
    assert fitted_order([1 / n for n in FINE], errors) > 1.9


def test_frequencies_of_an_actuated_helix(fitted_order):
    """Those of a rod that is drawn as the helix, with its sections turned."""
    beam = section([0, 1, 0], EA=1e5, EI1=3.0, EI2=1.0, GJ=0.8, rotary_inertia=1e-3)
    analysis = {"modes": {"count": 4}}
    errors = []
    for n in SIZES:
        acts = [bend(list(CURVATURES), 0.0, 1.0), twist(TWIST, 0.0, 1.0)]
        edge = screw(1 / n, *CURVATURES, TWIST)
        places = list(accumulate([edge] * n, np.matmul, initial=np.eye(4)))
        points = [UPRIGHT @ place[:3, 3] for place in places]
        scenes = (
            straight_rod(n, beam, actuation=acts, analysis=analysis),
            rod_through(points, beam, rod={"initial_twist": TWIST}, analysis=analysis),
        )
        found, drawn = (np.array(der.run(scene).summary["frequencies_hz"]) for scene in scenes)
        errors.append(found / drawn - 1)
    for column in np.transpose(errors):
        assert fitted_order(STEPS, column) > 1.9
    assert np.abs(errors[-1]).max() < 2e-4


# ---- under loads

FORCE = np.array([-0.4, 0.7, 0.5])
PLACES = [(0.0, "after"), (1 / 9, "after"), (1 / 3, "before"), (1 / 3, "after")]
PLACES += [(7 / 9, "before"), (7 / 9, "after"), (8 / 9, "after"), (1.0, "before")]


def by_shooting(natural, places):
    """Strains and stress resultants of the cantilever, and its end, with `natural(s, before)` from
    cut to cut: the equations of `references/kirchhoff_rod.py`, integrated from the clamp with the
    moment there that leaves none at the end.
    """
    cuts = [0.0, 1 / 3, 7 / 9, 1.0]
    stiffness = np.array([WEAK, STRONG, TWISTING])

    def slopes(_s, y, own):
        frame, moment = y[3:12].reshape(3, 3), y[12:]
        u = own + (moment @ frame) / stiffness
        tangent = frame[:, 2] * (1 + frame[:, 2] @ FORCE / STRETCHING)
        turned = frame @ np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
        return np.concatenate([tangent, turned.ravel(), np.cross(FORCE, tangent)])

    def pieces(moment):
        y = np.concatenate([np.zeros(3), UPRIGHT.ravel(), moment])
        found = []
        for i, (a, b) in enumerate(pairwise(cuts)):
            own = natural[i]
            run = solve_ivp(
                slopes, (a, b), y, "DOP853", args=(own,), rtol=1e-11, atol=1e-13, dense_output=True
            )
            found.append((a, b, own, run.sol))
            y = run.y[:, -1]
        return found, y

    moment = root(lambda m: pieces(m)[1][12:], np.cross([1.0, 0, 0], FORCE), tol=1e-11).x
    found, last = pieces(moment)
    table = []
    for s, side in places:
        inside = [piece for piece in found if piece[0] - 1e-12 <= s <= piece[1] + 1e-12]
        _, _, own, at = inside[0] if side == "before" else inside[-1]
        y = at(s)
        frame = y[3:12].reshape(3, 3)
        m = y[12:] @ frame
        u = own + m / stiffness
        table.append([u[1], -u[0], u[2], m[1], -m[0], m[2], frame[:, 2] @ FORCE])
    return np.array(table), last[:3]


@pytest.mark.parametrize("start", [1 / 3, 0.0], ids=["inside", "from the clamp on"])
def test_actuated_cantilever_in_space_under_a_tip_force(fitted_order, start):
    """At the clamp, inside, and on both sides of where the actuations begin and end."""
    strains = np.array([-CURVATURES[1], CURVATURES[0], TWIST])
    own = [np.zeros(3) if start > 0.0 else strains, strains, np.zeros(3)]
    exact, tip = by_shooting(own, PLACES)
    errors = []
    for n in ALIKE:
        ends = (start, 7 / 9)
        scene = actuated(n, bend(list(CURVATURES), *ends), twist(TWIST, *ends))
        scene["loads"] = tip_force(*FORCE)
        off = np.abs(probed(scene, PLACES, STRAINS) - exact)
        tip_error = np.linalg.norm(der.equilibrium(scene).positions[-1, -1] - tip)
        errors.append([*off.max(axis=0), tip_error])
    for quantity, column in zip([*STRAINS, "tip"], np.transpose(errors), strict=True):
        assert fitted_order(ALIKE_STEPS, column) > 1.9, (quantity, column)


# ---- the plane in space


def planar_scene(model, **time):
    """Curvature, elongation, a load, a clamp and an interior one."""
    stiff = {"EA": 1e4, "EI1": 2.0, "EI2": 1.0, "GJ": 0.7, "mass_per_length": 1.0}
    scene = {
        "model": model,
        "rods": [
            {
                "name": "rod",
                "nodes": 19,
                "from": [0, 0, 0],
                "to": [1, 0, 0],
                "cross_section": {"stiffness": stiff, "director": [0, 1, 0]},
            }
        ],
        "supports": [{**START, "clamp": True}, {"rod": "rod", "at": "middle", "fix": ["y", "z"]}],
        "loads": [*tip_force(0.2, -0.9, 0), {"damping": {"coefficient": 0.3}}],
    }
    if time:
        table = {"times": [0, 0.05, 0.2], "values": [0, 2.0, -1.0]}
        growing = {"times": [0, 0.2], "values": [0, 0.1]}
        scene["actuation"] = [bend(table, 0.21, 0.83), stretch(growing, 0.0, 0.4)]
        return scene | {"time": {"duration": 0.2, "step": 0.002} | time}
    scene["actuation"] = [
        bend(2.5, 0.21, 0.83, profile="smooth"),
        bend(1.5, 0.0, 0.3, "clamp"),
        stretch(0.1, 0.0, 0.4),
    ]
    return scene | {"analysis": "static"}


@pytest.mark.parametrize("time", [{}, {"integrator": "implicit_midpoint"}, {"integrator": "bdf2"}])
def test_planar_scene_is_the_same_in_space(time):
    """Statics, motions, and the work that it takes."""
    flat, space = (der.run(planar_scene(model, **time)) for model in ("planar", "spatial"))
    assert np.abs(flat.positions[-1][:, 1]).max() > 0.01
    assert np.abs(space.positions[-1][:, :2] - flat.positions[-1]).max() < 1e-9
    assert np.abs(space.positions[-1][:, 2]).max() < 1e-12
    for name in flat.work if time else []:
        assert space.work[name] == pytest.approx(flat.work[name], abs=1e-9), name


@pytest.mark.parametrize(
    ("director", "pair"),
    [([0, 1, 0], [2, 0]), ([0, -1, 0], [-2, 0]), ([0, 0, 1], [0, -2]), ([0, 0, -1], [0, 2])],
)
@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_number_is_the_pair_that_curves_about_z(model, director, pair):
    """Whichever way the director shows."""
    shapes = []
    for value in (2.0, pair):
        beam = section(director, EA=1e4, EI1=STRONG, EI2=WEAK, GJ=TWISTING)
        scene = straight_rod(12, beam, loads=tip_force(0.1, 0.4, 0.0))
        scene["actuation"] = [bend(value, 0.21, 0.8)]
        scene["model"] = model
        shapes.append(der.equilibrium(scene).positions[-1])
    assert shapes[0] == pytest.approx(shapes[1], abs=1e-12)
    assert shapes[0][-1, 1] > 0.4


@pytest.mark.parametrize("profile", PROFILES)
def test_twist_between_clamps(profile):
    """It stays straight and bears the torque -GJ times the mean twist; by hand."""
    share = {"constant": 1.0, "linear": 0.5, "smooth": 0.5}[profile]
    mean = 1.5 * share * (0.777 - 0.313)
    supports = [{**START, "clamp": True}, {**END, "clamp": True}]
    scene = actuated(20, twist(1.5, 0.313, 0.777, profile=profile), supports=supports)
    result = der.run(scene)
    assert result.along("rod", "torque")[1] == pytest.approx(-TWISTING * mean, rel=1e-9)
    assert np.abs(result.positions[-1][:, 1:]).max() < 1e-12
    assert elastic_energy(result) == pytest.approx(0.5 * TWISTING * mean**2, rel=1e-9)


# ---- rings


def ring(count, first, closed_over, model, **actuation):
    """A ring of length 1 whose drawing begins at node `first`; actuated over (from, to) as counted
    on the ring whose drawing begins at node 0, in one or two pieces.
    """
    angle = 2 * np.pi * (first + np.arange(count)) / count
    radius = 0.5 / (count * np.sin(np.pi / count))
    points = radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    stiff = section(EA=1e4, EI=1.0, GJ=0.7)
    # At three nodes of the ring, so that it neither moves nor turns; no force arises there.
    supports = [
        {"rod": "rod", "at": {"node": (node - first) % count}, "fix": list(axes)}
        for node, axes in ((0, "xyz"), (count // 2, "yz"), (count // 4, "z"))
    ]
    scene = rod_through(points, stiff, supports=supports, rod={"closed": True}, model=model)
    begin, end = ((s - first / count) % 1.0 for s in closed_over)
    pieces = [(begin, end)] if begin < end else [(begin, 1.0), (0.0, end)]
    if closed_over == (0.0, 1.0):
        pieces = [(0.0, 1.0)]
    scene["actuation"] = [
        {"name": f"part{i}", "rod": "rod", "from": a, "to": b} | actuation
        for i, (a, b) in enumerate(pieces)
    ]
    return scene, points


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_ring_that_is_curved_evenly_stays_as_it_is(model):
    """It bears the moment -EI k everywhere, without a force: 1/2 EI k^2 L."""
    scene, points = ring(24, 0, (0.0, 1.0), model, natural_curvature=2.0)
    result = der.run(scene)
    assert result.positions[-1] == pytest.approx(points[:, : result.positions.shape[2]], abs=1e-9)
    assert result.summary["energies"]["bend"] == pytest.approx(2.0, rel=1e-9)
    assert result.summary["energies"]["stretch"] < 1e-15
    if model == "planar":
        assert result.along("rod", "moment")[1] == pytest.approx(-2.0, rel=1e-9)
    else:
        moments = [result.along("rod", f"moment_{i}")[1] for i in (1, 2)]
        assert np.hypot(*moments) == pytest.approx(2.0, rel=1e-9)


def test_ring_that_is_twisted_evenly_stays_as_it_is():
    """Below the twist at which it buckles: 1/2 GJ t^2 L, and the torque -GJ t."""
    scene, points = ring(24, 0, (0.0, 1.0), "spatial", natural_twist=3.0)
    result = der.run(scene)
    assert result.positions[-1] == pytest.approx(points, abs=1e-9)
    assert elastic_energy(result) == pytest.approx(0.5 * 0.7 * 9.0, rel=1e-9)
    assert result.along("rod", "torque")[1] == pytest.approx(-2.1, rel=1e-9)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_an_actuation_that_ends_at_the_start_of_a_ring_has_its_curvature_up_to_there(model):
    """Curvature is M/EI, that of the circle and what is actuated, at any place."""
    count, radius, own = 40, 0.5, 2.0
    angle = 2 * np.pi * np.arange(count) / count
    points = radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    length = 2 * radius * count * np.sin(np.pi / count)
    flat = model == "planar"
    scene = rod_through(
        points[:, : 2 if flat else 3],
        section(EA=1e4, EI=1.0) if flat else section([0, 0, 1], EA=1e4, EI=1.0, GJ=1.0),
        supports=[{"rod": "rod", "at": {"node": 10}, "clamp": True}],
        rod={"closed": True},
        actuation=[bend(own if flat else [0.0, own], 0.6 * length, length)],
    )
    # Towards the second director, which points inwards.
    part = "" if flat else "_2"
    places = [(length - u * length / count, "after") for u in (0.9, 0.55, 0.3, 0.05)]
    names = (f"curvature{part}", f"moment{part}", f"natural_curvature{part}")
    found = probed({**scene, "model": model}, [*places, (0.0, "before"), (0.0, "after")], names)
    curved, moment, natural = found.T
    assert curved == pytest.approx(natural + moment, abs=1e-9)
    circle = natural[-1]
    assert abs(circle) == pytest.approx(1 / radius, rel=3e-3)
    assert natural[:-1] == pytest.approx(circle + own, abs=1e-9)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_ring_that_grows_evenly_is_free_of_stress(model):
    scene, points = ring(24, 0, (0.0, 1.0), model, elongation=0.1)
    result = der.run(scene)
    x = result.positions[-1]
    radius = np.linalg.norm(x - x.mean(axis=0), axis=1)
    assert radius == pytest.approx(1.1 * np.linalg.norm(points, axis=1), rel=1e-9)
    assert elastic_energy(result) < 1e-18


@pytest.mark.parametrize(
    ("model", "actuation"),
    [
        ("planar", {"natural_curvature": 3.0}),
        ("planar", {"elongation": 0.3}),
        ("spatial", {"natural_twist": 2.0}),
        ("spatial", {"natural_curvature": 3.0}),
    ],
)
def test_where_the_drawing_of_an_actuated_ring_begins_does_not_matter(model, actuation):
    """Within the stretch or out of it: the same energy and the same shape."""
    energies, shapes = [], []
    for first in (0, 3, 7, 20):
        scene, points = ring(24, first, (0.137, 0.613), model, **actuation)
        result = der.run(scene)
        shapes.append(np.roll(result.positions[-1], first, axis=0))
        energies.append(elastic_energy(result))
        assert np.abs(result.positions[-1] - points[:, : shapes[0].shape[1]]).max() > 1e-4
    assert energies == pytest.approx([energies[0]] * 4, rel=1e-9)
    for shape in shapes[1:]:
        assert shape == pytest.approx(shapes[0], abs=1e-9)


# ---- which model


def chosen(actuation, director=(0, 1, 0), load=(0.0, 0.1, 0.0)):
    stiff = section(director, EA=1e4, EI=1.0, GJ=0.7)
    scene = straight_rod(8, stiff, loads=tip_force(*load), actuation=[actuation])
    return der.run(scene | {"model": "auto"}).summary["model"]


@pytest.mark.parametrize(
    ("actuation", "model"),
    [
        ({"natural_curvature": 1.0}, "planar"),
        ({"elongation": 0.1}, "planar"),
        ({"natural_twist": 1.0}, "spatial"),
        ({"natural_twist": 0.0}, "spatial"),
        ({"natural_curvature": [0.5, 1.0]}, "spatial"),
    ],
)
def test_model_of_an_actuated_rod(actuation, model):
    base = {"name": "act", "rod": "rod"}
    assert chosen(base | actuation) == model


def test_growth_of_a_rod_bent_in_space_needs_no_twist():
    grows = {"name": "act", "rod": "rod", "elongation": 0.1}
    assert chosen(grows, load=(0, 0.1, 0.2)) == "spatial_bend"


# ---- the ledger

SPATIAL_STEPPERS = [info for info in der.steppers() if info.name != "energy_momentum"]


def with_all_actuations(turns, step, integrator):
    """All kinds of actuation at once; the clamp may turn about an oblique axis, and so turn the
    tangent and twist the rod. All kinks of tables are at ends of steps.
    """
    soft = section([0, 1, 0], EA=20.0, EI1=0.05, EI2=0.03, GJ=0.02, rotary_inertia=2e-3)
    table = {"times": [0, 0.07, 0.2], "values": [0, 2.0, -1.0]}
    growing = {"times": [0, 0.2], "values": [0, 0.2]}
    turn = {"axis": [0, 1, 0.3], "angle": {"times": [0, 0.1, 0.2], "values": [0, 0.3, 0.2]}}
    clamp = {**START, "clamp": True} | ({"prescribe": {"rotation": turn}} if turns else {})
    actuation = [
        bend([table, growing], 0.0, 0.71),
        twist(table, 0.13, 1.0, profile="linear"),
        stretch(growing, 0.2, 0.55),
    ]
    scene = straight_rod(
        6,
        soft,
        supports=[clamp],
        loads=[{"damping": {"coefficient": 0.2}}],
        actuation=actuation,
        time={"duration": 0.2, "step": step, "integrator": integrator},
        output={"every": 0.01},
    )
    return der.run(scene)


@pytest.fixture(scope="module")
def work_of_turning_clamp():
    """Limit in the step that all steppers share, over time: 1e-3 of the errors that are fitted."""
    return with_all_actuations(True, 2e-5, "sdirk5").work["supports"]


@pytest.mark.parametrize("turns", [False, True], ids=["clamp", "turning clamp"])
@pytest.mark.parametrize("info", SPATIAL_STEPPERS, ids=lambda info: info.name)
def test_ledger_in_space(fitted_order, info, turns, work_of_turning_clamp):
    """The energy that a stepper makes or loses has the stepper's order in the step, and so has the
    work of the clamp. With frames of the start at the end of a step, that work had order 1."""
    steps = [5e-4, 2.5e-4, 1.25e-4]
    losses, of_clamp = [], []
    for step in steps:
        result = with_all_actuations(turns, step, info.name)
        total, work = sum(result.energies.values()), result.work
        scale = np.ptp(total)
        came_in = work["supports"] + work["actuation"] + work["solver"] - work["drag"]
        assert np.abs(total - total[0] - came_in + work["numerical"]).max() < 1e-12 * scale
        assert np.abs(work["solver"]).max() < 1e-8 * scale
        assert np.abs(work["actuation"]).max() > 1e-3
        assert (np.abs(work["supports"]).max() > 1e-3) == turns
        losses.append(np.abs(work["numerical"]).max())
        of_clamp.append(np.abs(work["supports"] - work_of_turning_clamp).max())
    order = min(info.order, 2) - 0.1
    assert fitted_order(steps, losses) > order
    if turns:
        assert fitted_order(steps, of_clamp) > order


# ---- the natural shape as quantities


def test_natural_curvatures_and_twist_are_those_of_the_rod_and_of_its_actuations():
    """Whatever holds the rod, on both sides of the jumps, at nodes and between them."""
    actuation = [
        bend([1.3, -0.8], 0.313, 0.777, profile="linear"),
        twist(2.1, 0.2, 0.9),
    ]
    held = [{**START, "clamp": True}, {**END, "clamp": True}]
    scene = straight_rod(12, BEAM, supports=held, actuation=actuation)
    scene["rods"][0] |= {"natural_curvature": [0.3, 0.5], "natural_twist": -0.4}
    cases = [(0.313, "before"), (0.313, "after"), (0.777, "before"), (0.777, "after")]
    places = [*cases, (0.5, "after"), (0.2, "before"), (0.2, "after"), (1.0, "before")]
    names = ["natural_curvature_1", "natural_curvature_2", "natural_twist"]
    shares = np.array([0, 0, 1, 0, (0.5 - 0.313) / 0.464, 0, 0, 0])
    twisted = np.array([1, 1, 1, 1, 1, 0, 1, 0])
    truth = np.column_stack([0.3 + 1.3 * shares, 0.5 - 0.8 * shares, -0.4 + 2.1 * twisted])
    assert probed(scene, places, names) == pytest.approx(truth, abs=1e-9)
