"""One scene as planar, `spatial_bend` and `spatial`, and turned in space; shapes at rest."""

import der
import numpy as np
import pytest
from references.kirchhoff_rod import rotation
from scenes import END, START, tip_force
from spatial_scenes import measured, rod_through, section, straight_rod

PLANAR = ("x", "y", "vx", "vy")
PLACES = [0.3, "middle", "end"]
STEPPERS = [
    *("implicit_euler", "implicit_midpoint", "generalized_alpha", "newmark", "bdf2", "tr_bdf2"),
    *("sdirk4", "sdirk5", "verlet"),
]


def planar_scene(model, curved, **more):
    """A rod with all loads that the models share, drawn in the plane z = 0."""
    angle = np.linspace(0, 1.2, 13) if curved else np.linspace(0.3, 0.3, 13)
    points = np.cumsum(0.1 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]), axis=0)
    # Stiff in the plane and towards z alike: no side to bend to is special.
    square = {"rectangle": {"width": 0.02, "height": 0.02}}
    supports = [{**START, "clamp": True}]
    if not curved and "time" not in more:
        supports[0]["prescribe"] = {"rotation": {"axis": [0, 0, 1], "angle": 0.4}}
    loads = [
        {"gravity": [0, -9.81, 0]},
        {"point_force": {"rod": "rod", "at": 0.437, "force": [0.3, 0.2, 0]}},
        {"distributed_force": {"rod": "rod", "force": [0.1, -0.3, 0], "from": 0.2, "to": 0.9}},
    ]
    if "time" in more:
        loads.append({"damping": {"coefficient": 0.1}})
    material = {"youngs_modulus": 1e7, "density": 1000, "poissons_ratio": 0.3}
    scene = rod_through(
        points, square, supports=supports, rod={"material": material}, loads=loads, **more
    )
    return {**scene, "model": model}


def motion(stepper):
    time = {"duration": 0.2, "step": 0.01, "integrator": stepper}
    return time if stepper != "verlet" else {**time, "duration": 0.02, "step": "auto"}


@pytest.mark.parametrize("stepper", ["static", *STEPPERS, "tolerance"])
@pytest.mark.parametrize("curved", [False, True])
def test_planar_scene_is_the_same_in_all_models(stepper, curved):
    """Positions and speeds are of size 1: the bound is far above rounding, far below any error."""
    more = {}
    if stepper == "tolerance":
        more["time"] = {"duration": 0.2, "tolerance": 1e-3}
    elif stepper != "static":
        more["time"] = motion(stepper)
    models = ["planar", "spatial"] if curved else ["planar", "spatial_bend", "spatial"]
    answers, balances = [], []
    for model in models:
        values, result = measured(planar_scene(model, curved, **more), PLACES, PLANAR)
        answers.append(values)
        balances.append([result.energies[k][-1] for k in ("kinetic", "bend", "stretch")])
        balances[-1] += [result.work[k][-1] for k in ("loads", "drag", "supports", "numerical")]
    for other, balance in zip(answers[1:], balances[1:], strict=True):
        assert other == pytest.approx(answers[0], abs=1e-9)
        assert balance == pytest.approx(balances[0], abs=1e-9)


@pytest.mark.parametrize("curvature", ["angle", "tangent"])
def test_corners_in_their_plane(curvature):
    """A wire with corners of 90 and 45 degrees: to the tolerance of the equilibria."""
    points = [(0.1 * i, 0) for i in range(5)] + [(0.4, 0.1 * i) for i in range(1, 5)]
    points += [(0.4 + 0.07 * i, 0.4 + 0.07 * i) for i in range(1, 4)]
    answers = []
    for model in ("planar", "spatial"):
        wire = rod_through(
            [(*point, 0.0) for point in points],
            section(EI=1.0, GJ=0.7),
            rod={"curvature": curvature},
            loads=tip_force(0.3, 0.5, 0),
        )
        answers.append(measured({**wire, "model": model}, PLACES, PLANAR)[0])
    assert answers[1] == pytest.approx(answers[0], abs=1e-9)


@pytest.mark.parametrize("drawn", ["straight", "bent"])
@pytest.mark.parametrize("loaded", ["follower", "moment", "spring", "clamp"])
def test_natural_curvatures_that_jump_in_their_plane(drawn, loaded):
    """Loads and supports at the node of the jump have the same effect in both models.

    The follower force in space turns with the section. That of the plane is the mean of two forces
    that turn with the edges, which turn by 0.05 rad from one to the next: it is smaller by a share
    of 0.05^2/8, which moves the rod by some tenths of that.
    """
    angle = np.cumsum([0.0] * 7 + [0.07] * 7) if drawn == "bent" else np.zeros(14)
    steps = 0.07 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    here = {"rod": "rod", "at": {"node": 7}}
    loads = tip_force(0.3, 0.5, 0)
    supports = [{**START, "clamp": True}]
    if loaded == "follower":
        loads.append({"point_force": {**here, "force": [0.2, 1.0, 0], "follower": True}})
    elif loaded == "moment":
        loads.append({"moment": {**here, "moment": [0, 0, -0.8]}})
    else:
        held = {"spring": {"rotational_stiffness": 3.0}} if loaded == "spring" else {"clamp": True}
        supports.append({**here, **held})
    answers = []
    for model in ("planar", "spatial"):
        rod = rod_through(
            np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]),
            section([0, 1, 0], EI=1.0, GJ=0.7),
            supports,
            loads=loads,
            rod={"natural_curvature": [[1.3 * (i > 7) + 0.65 * (i == 7), 0] for i in range(15)]},
        )
        answers.append(measured({**rod, "model": model}, PLACES, PLANAR)[0])
    bound = 1e-4 if loaded == "follower" else 1e-9
    assert answers[1] == pytest.approx(answers[0], abs=bound)


def test_modes_of_the_plane_are_among_those_in_space():
    def squares(model, count):
        scene = planar_scene(model, curved=True, analysis={"modes": {"count": count}})
        return np.array(der.run(scene).summary["frequencies_hz"])

    in_space = squares("spatial", 8)
    for frequency in squares("planar", 4):
        assert np.abs(in_space / frequency - 1).min() < 1e-9


UNTWISTED = {
    "cantilever": [{**START, "clamp": True}],
    "springs": [
        {**START, "clamp": True},
        {"rod": "rod", "at": 0.6, "spring": {"stiffness": [0.0, 5.0, 20.0]}},
    ],
    "clamps": [
        {**START, "clamp": True},
        {**END, "clamp": "tangent", "prescribe": {"x": -0.1, "z": 0.2}},
    ],
    "pins": [
        {**START, "fix": ["x", "y", "z"]},
        {"rod": "rod", "at": {"node": 6}, "clamp": True},
        {**END, "fix": ["y", "z"]},
    ],
}
FORCES = (0.437, 0.83)


@pytest.mark.parametrize("drawn", ["straight", "bent"])
@pytest.mark.parametrize("supports", UNTWISTED.values(), ids=UNTWISTED.keys())
def test_rod_without_torque_needs_no_sections(supports, drawn):
    """Loaded to two sides out of its plane, it is the same rod in both models, to rounding; what is
    drawn as a helix is straight without stress.

    Moments beside a point force are recovered from neighbours, whose sections are not parallel. The
    difference of that is of order 4 in the length of an edge: it was 5e-7 at most.
    """
    s = np.linspace(0, 1, 21)
    points = np.column_stack([s, 0 * s, 0 * s])
    if drawn == "bent":
        points = np.column_stack([0.9 * s, 0.15 * np.sin(3 * s), 0.15 * np.cos(3 * s) - 0.15])
    loads = [
        {"distributed_force": {"rod": "rod", "force": [0.0, 2.0, -3.0]}},
        {"point_force": {"rod": "rod", "at": FORCES[0], "force": [0.0, 6.0, 2.0]}},
        {"point_force": {"rod": "rod", "at": FORCES[1], "force": [-1.0, -2.0, 3.0]}},
    ]
    places = [*PLACES, *FORCES]
    round_rod = section(EI=1.0, GJ=0.7)
    answers, moments, energies = [], [], []
    for model in ("auto", "spatial"):
        rod = rod_through(
            points,
            round_rod,
            supports,
            rod={"natural_curvature": 0},
            loads=loads,
            solver={"residual_tolerance": 1e-12, "step_tolerance": 1e-14},
        )
        quantities = ("x", "y", "z", "tx", "ty", "tz", "curvature", "moment")
        values, result = measured({**rod, "model": model}, places, quantities)
        assert result.summary["model"] == ("spatial" if model == "spatial" else "spatial_bend")
        bent = np.ptp(result.positions[-1] - points, axis=0)
        assert bent[1:].min() > 1e-3  # to both sides
        answers.append(values[:, :6])
        moments.append(values[:, 6:])
        energies.append([result.energies[kind][-1] for kind in ("bend", "stretch")])
    assert answers[1] == pytest.approx(answers[0], abs=1e-9)
    assert moments[1] == pytest.approx(moments[0], abs=2e-6)
    assert energies[1] == pytest.approx(energies[0], abs=1e-9)


def test_spin_of_sections_moves_a_thin_rod_little(fitted_order):
    """In motion `spatial` has the inertia of the sections' spin, which `spatial_bend` lacks.

    No torque acts, but a rod whose tangents go around turns its sections. What that moves is of the
    order of the other rotary inertia of its sections, which neither model has: the square of the
    radius over the length. In units in which EI, the mass and the length are 1 the rod of each
    radius is the same one otherwise.
    """
    youngs_modulus, radii = 1e7, (0.04, 0.02, 0.01)
    forces = np.array([[0, 0, 0], [0, 2, 0], [0, 2, 3], [0, -2, 3]], dtype=float)

    def final(radius, model):
        bending = youngs_modulus * np.pi * radius**4 / 4
        density = bending / (np.pi * radius**2)
        table = {"times": [0, 0.25, 0.5, 1], "values": (bending * forces).tolist()}
        material = {"youngs_modulus": youngs_modulus, "poissons_ratio": 0.3, "density": density}
        rod = straight_rod(
            20,
            {"circle": {"radius": radius}},
            rod={"material": material},
            loads=[{"point_force": {**END, "force": table}}],
            time={"duration": 1.0, "step": 0.01, "integrator": "implicit_midpoint"},
        )
        values, result = measured({**rod, "model": model}, ["middle", "end"], ("x", "y", "z"))
        assert result.summary["model"] == ("spatial" if model == "spatial" else "spatial_bend")
        return values

    apart = [np.abs(final(r, "spatial") - final(r, "auto")).max() for r in radii]
    assert fitted_order(radii, apart) > 1.9
    assert 0.5 * radii[-1] ** 2 < apart[-1] < radii[-1] ** 2


def twisted_scene(turn, drawn, **more):
    """A rod of curved and twisted shape with all that acts on it turned by the matrix `turn`."""
    s = np.linspace(0, 1, 15)
    points = np.column_stack([np.sin(2 * s), 0.3 * s**2, 0.4 * np.cos(3 * s) - 0.4]) @ turn.T
    strip = {
        "rectangle": {"width": 0.05, "height": 0.02},
        "director": (turn @ [0.2, 1, 0.3]).tolist(),
    }
    material = {"youngs_modulus": 1e7, "density": 1000, "poissons_ratio": 0.3}
    rod = {"initial_twist": 4.0, "material": material, **drawn}
    return rod_through(points, strip, rod=rod, **more)


ANYHOW = rotation(np.array([2, -3, 6]) / 7, 2.2)
RIGID = np.eye(3)
SECTION = ("curvature_1", "curvature_2", "twist", "torque", "moment_1", "moment_2", "tension")


@pytest.mark.parametrize("stepper", ["static", *STEPPERS])
def test_turning_a_scene_turns_the_answer(stepper):
    more = {} if stepper == "static" else {"time": motion(stepper)}

    def answer(turn):
        def turned(*vector):
            return (turn @ vector).tolist()

        spin, tilt = (
            {"times": [0, 0.2], "values": [0, 1.5]},
            {"times": [0, 0.2], "values": [0, 0.8]},
        )
        if stepper == "static":
            spin, tilt = 1.5, 0.8
        move = {"twist": spin, "rotation": {"axis": turned(0, 1, 1), "angle": tilt}}
        loads = [
            {"gravity": turned(0, -9.81, 3)},
            {"point_force": {"rod": "rod", "at": 0.437, "force": turned(0.3, 0.2, 0.1)}},
        ]
        supports = [{**START, "clamp": True, "prescribe": move}]
        # Newton's method then leaves a share of the gyroscopic forces far below the bounds.
        solver = {"residual_tolerance": 1e-12, "step_tolerance": 1e-14}
        scene = twisted_scene(turn, {}, supports=supports, loads=loads, solver=solver, **more)
        values, _ = measured(scene, PLACES, ("x", "y", "z", "vx", "vy", "vz", *SECTION))
        return values

    straight, turned = answer(RIGID), answer(ANYHOW)
    for first in (0, 3):  # positions, velocities
        vectors = straight[:, first : first + 3] @ ANYHOW.T
        assert turned[:, first : first + 3] == pytest.approx(vectors, abs=1e-10)
    # Curvatures, twist, torque and moments, of up to 5/m and N m; tensions of 10 N are strains of
    # 1e-3 times EA = 1e4 N, and what is 1e-12 of a strain is 1e-8 N.
    assert turned[:, 6:-1] == pytest.approx(straight[:, 6:-1], abs=1e-10)
    assert turned[:, -1] == pytest.approx(straight[:, -1], abs=1e-8)


@pytest.mark.parametrize(
    "time",
    [
        {"duration": 100.0, "step": 1e-3, "integrator": "implicit_midpoint"},
        {"duration": 1000.0, "step": 1e-2, "integrator": "tr_bdf2"},
        {"duration": 33.0, "step": "auto", "integrator": "verlet"},
    ],
    ids=["implicit_midpoint", "tr_bdf2", "verlet"],
)
@pytest.mark.parametrize("supports", [[], [{**START, "clamp": True}]], ids=["free", "clamped"])
def test_any_shape_stays_at_rest(time, supports):
    """1e5 steps from a curved, twisted shape that is free of stress.

    The roundings of 1e5 steps, each 1e-16 of a length of 1 m, add up to 3e-14 m where they are
    random. Waves along the rod have up to 3e3 rad/s, so that such an amplitude is 1e-10 m/s.
    """
    scene = twisted_scene(ANYHOW, {}, supports=supports, time=time)
    points = np.array(scene["rods"][0]["points"])
    values, result = measured(scene, ["start", "end"], ("x", "y", "z", "vx", "vy", "vz"))
    assert result.summary["steps"] >= 100_000
    assert np.abs(result.positions[-1] - points).max() < 1e-12
    assert np.abs(values[:, 3:]).max() < 1e-9
    assert result.energies["kinetic"][-1] + result.energies["bend"][-1] < 1e-20


def resting(seed, kind, **more):
    """A rod of a random shape and orientation, somewhere, held at its start or free: smooth, with
    a corner of 69 degrees, or drawn straight with random lists of natural curvatures and twists,
    in its natural shape.
    """
    random = np.random.default_rng(seed)
    s = np.linspace(0, 1, 14)
    waves = np.sin(np.outer(s, [2, 4, 6]) + random.uniform(0, 6, 3))
    tangents = waves @ (random.normal(size=(3, 3)) / [[1], [2], [3]]) + 2 * random.normal(size=3)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    rod = {"material": {"youngs_modulus": 1e7, "density": 1000, "poissons_ratio": 0.3}}
    if kind == "natural lists":
        tangents[:] = tangents[0]
        rod["natural_curvature"] = random.uniform(-3, 3, (15, 2)).tolist()
        rod["natural_twist"] = random.uniform(-4, 4, 15).tolist()
        more["start_from"] = "equilibrium"
    else:
        rod["initial_twist"] = random.uniform(-6, 6)
    if kind == "corner":
        across = np.cross(tangents[7], random.normal(size=3))
        tangents[7:] = tangents[7:] @ rotation(across / np.linalg.norm(across), 1.2).T
    points = random.normal(size=3) + np.vstack([np.zeros(3), np.cumsum(tangents / 14, axis=0)])
    director = random.normal(size=3).tolist()
    strip = {"rectangle": {"width": 0.05, "height": 0.02}, "director": director}
    supports = [{**START, "clamp": True}] if seed % 2 else []
    return rod_through(points, strip, supports=supports, rod=rod, **more)


RESTING = [
    pytest.param(stepper, kind, 3 * i + k, 2000, id=f"{stepper}-{kind}")
    for i, stepper in enumerate(STEPPERS)
    for k, kind in enumerate(["smooth", "corner", "natural lists"])
]
RESTING.append(pytest.param("sdirk5", "corner", 31, 20_000, id="longer"))
RESTING.append(pytest.param("newmark", "corner", 33, 100_000, id="longest"))


@pytest.mark.parametrize(("stepper", "kind", "seed", "steps"), RESTING)
def test_random_shapes_stay_at_rest(stepper, kind, seed, steps):
    """As above, every shape, orientation and director another one."""
    time = {"duration": 1e-3 * steps, "step": 1e-3, "integrator": stepper}
    if stepper == "verlet":
        time = {"duration": 0.8, "step": "auto", "integrator": stepper}
    solver = {"residual_tolerance": 1e-13, "step_tolerance": 1e-14}
    scene = resting(seed, kind, time=time, solver=solver)
    values, result = measured(scene, ["start", "end"], ("x", "y", "z", "vx", "vy", "vz"))
    assert result.summary["steps"] >= steps
    assert np.abs(result.positions[-1] - result.positions[0]).max() < 1e-12
    assert np.abs(values[:, 3:]).max() < 1e-9
    assert result.energies["kinetic"][-1] + result.energies["bend"][-1] < 1e-20


def test_end_of_the_same_rod_drawn_backwards():
    """Nothing depends on where a rod begins but the signs of its directors' handedness."""
    strip = {"rectangle": {"width": 0.05, "height": 0.02}, "director": [0.2, 1, 0.3]}
    material = {"youngs_modulus": 1e7, "density": 1000, "poissons_ratio": 0.3}
    s = np.linspace(0, 1, 21)
    points = np.column_stack([s, 0 * s, 0 * s])
    load = [{"point_force": {"rod": "rod", "at": 0.7, "force": [0, -0.5, 1.2]}}]
    back = [{"point_force": {"rod": "rod", "at": 0.3, "force": [0, -0.5, 1.2]}}]
    rod = {"material": material}
    there, _ = measured(rod_through(points, strip, loads=load, rod=rod), [0.35, "end"], "xyz")
    clamp = [{**END, "clamp": True}]
    scene = rod_through(points[::-1], strip, supports=clamp, loads=back, rod=rod)
    reverse, _ = measured(scene, [0.65, "start"], "xyz")
    assert reverse == pytest.approx(there, abs=1e-9)
