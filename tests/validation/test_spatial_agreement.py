"""One scene as planar, `spatial_bend` and `spatial`; shapes at rest. See also tests/laws."""

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


def planar_arc(model, **more):
    """A rod under forces in its plane, drawn in the plane z = 0."""
    angle = np.linspace(0, 1.2, 13)
    points = np.cumsum(0.1 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]), axis=0)
    # Stiff in the plane and towards z alike: no side to bend to is special.
    square = {"rectangle": {"width": 0.02, "height": 0.02}}
    loads = [
        {"gravity": [0, -9.81, 0]},
        {"point_force": {"rod": "rod", "at": 0.437, "force": [0.3, 0.2, 0]}},
        {"distributed_force": {"rod": "rod", "force": [0.1, -0.3, 0], "from": 0.2, "to": 0.9}},
    ]
    material = {"youngs_modulus": 1e7, "density": 1000, "poissons_ratio": 0.3}
    scene = rod_through(points, square, rod={"material": material}, loads=loads, **more)
    return {**scene, "model": model}


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
        scene = planar_arc(model, analysis={"modes": {"count": count}})
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
