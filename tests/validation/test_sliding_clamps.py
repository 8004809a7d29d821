"""Clamps whose node may move (`free`): guides that slide along the rod, or across it.

References: the elastica by shooting, Euler's columns, and the frequency equation of a beam that a
guide ends.
"""

import der
import numpy as np
import pytest
from scipy import integrate, optimize

EI, LENGTH = 1.0, 1.0
EDGES = [10, 20, 40, 80]
MODELS = ["planar", "spatial_bend", "spatial"]


def scene(edges, model, supports, loads=(), EA=1e6, **more):
    """A straight rod along x; vectors are lengthened to three components in space."""
    stiffness = {"EA": EA, "EI": EI, "mass_per_length": 1.0}
    cross_section = {"stiffness": stiffness}
    if model == "spatial":
        cross_section["director"] = [0, 1, 0]
        stiffness |= {"GJ": 0.7, "rotary_inertia": 1e-4}
    rod = {"name": "rod", "nodes": edges + 1, "from": [0, 0], "to": [LENGTH, 0]}
    if model != "planar":
        rod |= {"from": [0, 0, 0], "to": [LENGTH, 0, 0]}
    if not {"analysis", "time"} & set(more):
        more["analysis"] = "static"
    # Without twist in the model one section at most is held.
    clamps = ["tangent" if model == "spatial_bend" else True] * len(supports)
    return {
        "model": model,
        "rods": [rod | {"cross_section": cross_section}],
        "supports": [
            {"rod": "rod", "clamp": clamp} | support
            for clamp, support in zip(clamps, supports, strict=True)
        ],
        "loads": list(loads),
        **more,
    }


def force(model, *components):
    load = [*components, 0.0] if model != "planar" else [*components]
    return {"point_force": {"rod": "rod", "at": "end", "force": load}}


def cantilever(P, length):
    """The elastica under a force across it: moment at the clamp, and the place of the tip."""

    def end(curvature):
        def slopes(_, y):
            return [y[1], -P * np.cos(y[0]) / EI, np.cos(y[0]), np.sin(y[0])]

        start = [0.0, curvature, 0.0, 0.0]
        return integrate.solve_ivp(slopes, (0, length), start, rtol=1e-11, atol=1e-12).y[:, -1]

    curvature = optimize.brentq(lambda k: end(k)[1], 0.0, 1.2 * P * length / EI, xtol=1e-13)
    return EI * curvature, *end(curvature)[2:]


@pytest.mark.parametrize("model", MODELS)
def test_a_guide_that_moves_across_bends_the_rod_as_two_cantilevers(model, fitted_order):
    """By symmetry the middle has no moment: each half is a cantilever under the same force."""
    P = 20.0
    moment, x, y = cantilever(P, 0.5 * LENGTH)
    supports = [{"at": "start"}, {"at": "end", "free": ["x", "y"]}]
    errors, moments = [], []
    for edges in EDGES:
        simulation = der.Simulation(scene(edges, model, supports, [force(model, 0.0, P)]))
        end = simulation.run().positions[-1][-1]
        errors.append(np.hypot(*(end[:2] - [2 * x, 2 * y])))
        wall, guide = simulation.reactions()
        moments.append(abs(np.atleast_1d(guide.moment)[-1] + moment))
        assert np.atleast_1d(wall.moment)[-1] == pytest.approx(-moment, rel=0.05)
        assert wall.force[:2] == pytest.approx([0.0, -P], abs=1e-6)
        assert guide.force == pytest.approx(np.zeros(len(end)), abs=1e-12)
    assert fitted_order([1 / n for n in EDGES], errors) > 1.85
    assert fitted_order([1 / n for n in EDGES], moments) > 1.85


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("free", "share"), [(["x"], 4.0), (["x", "y"], 1.0)])
def test_columns_that_slide_in_their_clamps(model, free, share, fitted_order):
    critical = share * np.pi**2 * EI / LENGTH**2
    supports = [{"at": "start"}, {"at": "end", "free": free}]
    errors = []
    for edges in EDGES[1:]:
        column = scene(edges, model, supports, [force(model, -1.0, 0.0)], 1e8, analysis="buckling")
        errors.append(der.run(column).buckling.load_factors[0] / critical - 1)
    assert fitted_order([1 / n for n in EDGES[1:]], errors) > 1.85


@pytest.mark.parametrize("model", MODELS)
def test_frequencies_of_a_beam_whose_end_a_guide_moves_across(model, fitted_order):
    def equation(b):
        return np.tan(b) + np.tanh(b)

    exact = [optimize.brentq(equation, lo, lo + 1.4) ** 2 for lo in (1.6, 4.8)]
    supports = [{"at": "start"}, {"at": "end", "free": ["y"]}]
    errors = []
    for edges in EDGES[1:]:
        modes = der.Simulation(scene(edges, model, supports)).modes(8 if model == "planar" else 12)
        omega = 2 * np.pi * modes.frequencies
        # In space the rod also vibrates along z, between two clamps that hold it there.
        in_plane = np.abs(modes.shapes[..., 1]).max(axis=1) > 1e-6
        errors.append(omega[in_plane][:2] / exact - 1)
    for of_mode in np.array(errors).T:
        assert fitted_order([1 / n for n in EDGES[1:]], of_mode) > 1.85


def test_the_twist_that_a_rod_between_sliding_clamps_bears(fitted_order):
    """Greenhill's problem between clamps: M L/(2 EI) is the first root of tan x = x."""
    root = optimize.brentq(lambda x: np.tan(x) - x, 4.4, 4.6)
    critical = 2 * root * EI / LENGTH / 0.7
    turned = {"at": "end", "free": ["x"], "prescribe": {"twist": 1.0}}
    errors = []
    for edges in EDGES[1:]:
        twisted = scene(edges, "spatial", [{"at": "start"}, turned], EA=1e7)
        path = der.continuation(twisted, to=1.1 * critical, vary="supports").path
        (first, *_) = path.rows("bifurcation")
        errors.append(path.factor[first] * LENGTH / critical - 1)
    assert fitted_order([1 / n for n in EDGES[1:]], errors) > 1.85


INTEGRATORS = [info.name for info in der.steppers() if info.order > 1]


@pytest.mark.parametrize("model", ["planar", "spatial"])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_the_momentum_along_the_guides_is_the_impulse(model, integrator):
    if integrator == "energy_momentum" and model == "spatial":
        pytest.skip("for the planar model only")
    zero = [0.0] if model == "planar" else [0.0, 0.0]
    push = {"times": [0, 0.05, 0.1], "values": [[0, *zero], [0, 5, *zero[1:]], [0, *zero]]}
    load = {"point_force": {"rod": "rod", "at": 0.3, "force": push}}
    guides = [{"at": "start", "free": ["y"]}, {"at": "end", "free": ["y"]}]
    step = "auto" if integrator == "verlet" else 1e-3
    time = {"duration": 0.2, "integrator": integrator, "step": step}
    simulation = der.Simulation(scene(20, model, guides, [load], EA=1e3, time=time))
    simulation.run()
    masses = np.full(21, 1 / 20)
    masses[[0, -1]] *= 0.5
    # The steps of bdf2 keep the momentum, and its first one is of order 1 in the force.
    error = 1e-4 if integrator == "bdf2" else 1e-12
    assert masses @ simulation.velocities[:, 1] == pytest.approx(0.25, abs=error)


@pytest.mark.parametrize("model", MODELS)
def test_a_rod_falls_freely_along_its_guides(model):
    supports = [{"at": "start", "free": ["x"]}, {"at": "end", "free": ["x"]}]
    down = [-9.81, 0.0] if model == "planar" else [-9.81, 0.0, 0.0]
    time = {"duration": 0.5, "step": 0.01, "integrator": "newmark"}
    fall = scene(10, model, supports, [{"gravity": down}], time=time)
    result = der.run(fall)
    assert result.positions[-1][:, 0] - result.positions[0][:, 0] == pytest.approx(
        np.full(11, -0.5 * 9.81 * 0.25), rel=1e-6
    )
    with pytest.raises(der.NotConvergedError, match="no support holds rod 'rod' in x"):
        der.run(scene(10, model, supports, [{"gravity": down}]))


def test_a_spring_holds_what_a_guide_leaves_free():
    supports = [
        {"at": "start", "free": ["x"], "spring": {"stiffness": [40.0, 0.0]}},
        {"at": "end", "free": ["x"]},
    ]
    result = der.run(scene(10, "planar", supports, [force("planar", 3.0, 0.0)]))
    assert result.positions[-1][0, 0] == pytest.approx(3.0 / 40.0, rel=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_a_guide_inside_a_rod(model):
    """It slides along x and keeps the direction: each side is a cantilever from it."""
    P = 0.01
    supports = [{"at": "middle", "free": ["x"]}, {"at": "start", "clamp": False, "fix": ["x"]}]
    result = der.run(scene(20, model, supports, [force(model, 0.0, P)]))
    tip = result.positions[-1][-1]
    assert tip[1] == pytest.approx(P * 0.5**3 / (3 * EI), rel=1e-5)
    assert np.abs(result.positions[-1][:11, 1]).max() < 1e-12


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_turned_guide_at_a_joint_and_without_one(model):
    """So does one that is moved to where it would go."""
    turn = {"angle": 0.6} if model == "planar" else {"rotation": {"axis": [0, 0, 1], "angle": 0.6}}
    supports = [{"at": "start"}, {"at": "end", "free": ["x", "y"], "prescribe": turn}]
    plain = scene(40, model, supports)
    jointed = {**plain, "joints": [{"name": "here", "of": [{"rod": "rod", "at": "middle"}]}]}
    # A circular arc: a guide that moves in both directions exerts no force.
    arc = LENGTH * np.array([np.sin(0.6), 1 - np.cos(0.6)]) / 0.6
    supports[1] = {"at": "end", "free": ["x"], "prescribe": {**turn, "y": arc[1]}}
    moved = scene(40, model, supports)
    for one in (plain, jointed, moved):
        assert der.run(one).positions[-1][-1][:2] == pytest.approx(arc, abs=2e-5)


@pytest.mark.parametrize(
    ("support", "message"),
    [
        ({"clamp": False, "fix": ["y"], "free": ["x"]}, "'free' is of a clamp"),
        ({"free": ["x", "x"]}, "'x' is free twice"),
        ({"free": ["z"]}, "has no z"),
        ({"free": ["x"], "fix": ["y"]}, "holds every component that is not in 'free'"),
        ({"free": ["x"], "prescribe": {"x": 0.1}}, "'x' is both free and prescribed"),
        ({"free": ["x"], "spring": {"stiffness": [1, 1]}}, "y of node 10 .* is held by support 1"),
    ],
)
def test_what_contradicts_a_free_component_is_refused(support, message):
    with pytest.raises(der.SceneError, match=message):
        der.load(scene(10, "planar", [{"at": "start"}, {"at": "end", **support}]))
