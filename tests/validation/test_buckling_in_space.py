"""Linear buckling and continuation of rods in space against closed forms, boundary value solutions
and the planar model.
"""

import der
import numpy as np
import pytest
from references.side_buckling import beam_on_a_spring
from scenes import END, START, arch, tip_force
from scipy.optimize import brentq
from scipy.special import jv
from spatial_scenes import critical, measured, section, straight_rod

SIZES = [10, 20, 40]
STEPS = [1 / n for n in SIZES]
SLENDER = 1e7  # EA


def buckling(scene, count=3):
    return der.run({**scene, "analysis": {"buckling": {"count": count}}}).buckling


def continued(scene, **options):
    return der.run({**scene, "analysis": {"continuation": options}})


# ---- linear buckling


def test_columns_buckle_about_both_axes(fitted_order):
    """pi^2 EI/4, 9 pi^2 EI/4 of a clamped column with EI = 1 and 0.4."""
    exact = np.sort(np.outer([1.0, 0.4], [1, 9]).ravel())[:3] * np.pi**2 / 4
    errors = []
    for n in SIZES:
        bar = section([0, 0, 1], EA=SLENDER, EI1=0.4, EI2=1.0, GJ=0.3)
        found = buckling(straight_rod(n, bar, loads=tip_force(-1, 0, 0), model="spatial"))
        errors.append(found.load_factors / exact - 1)
    for column in np.transpose(errors):
        assert fitted_order(STEPS, column) > 1.9
    # the weak direction is z
    along = np.abs(found.shapes[0]).max(axis=0)
    assert along[2] == 1.0
    assert along[:2].max() < 1e-6


#: Supports with which nothing resists the spin of a rod, and its factor over pi^2 EI.
PINS = [{**START, "fix": ["x", "y", "z"]}, {**END, "fix": ["y", "z"]}]
SPIN = {"pins": (PINS, 1.0), "held tangent": ([{**START, "clamp": "tangent"}], 0.25)}


@pytest.mark.parametrize("name", SPIN)
def test_a_column_that_may_spin_buckles_as_one_that_may_not(fitted_order, name):
    """pi^2 EI or pi^2 EI/4 about both axes, EI = 1 and 0.4."""
    supports, times = SPIN[name]
    exact = times * np.pi**2 * np.array([0.4, 1.0])
    errors = []
    for n in SIZES:
        bar = section([0, 0, 1], EA=SLENDER, EI1=0.4, EI2=1.0, GJ=0.3)
        scene = straight_rod(n, bar, supports=supports, loads=tip_force(-1, 0, 0), model="spatial")
        errors.append(buckling(scene, 2).load_factors / exact - 1)
    for column in np.transpose(errors):
        assert fitted_order(STEPS, column) > 1.9


def factors_of_an_oblique_force(first, second, EI1, EI2, GJ):
    """Three factors of a force at the end of a strip of length 1, with components along both
    directors.

    The bending moment that either component makes acts on the deflection across it as the section
    turns by phi: with the deflections eliminated, GJ phi'' + (1 - s)^2 (first^2/EI2 + second^2/EI1)
    phi = 0, whose solutions are Bessel functions of order -1/4 (Timoshenko and Gere, Theory of
    Elastic Stability, 6.3, for one component)."""
    guesses = (2.0, 5.12, 8.26)
    zeros = [brentq(lambda z: jv(-0.25, z), guess - 0.3, guess + 0.3) for guess in guesses]
    return 2 * np.array(zeros) / np.sqrt((first**2 / EI2 + second**2 / EI1) / GJ)


@pytest.mark.parametrize("solver", ["banded", "simplicial_ldlt"])
def test_no_factor_of_an_oblique_force_is_missing(fitted_order, solver):
    """On some meshes only the first one was found, and none at all with other solvers."""
    director = np.array([0, 0.3, 1]) / np.hypot(0.3, 1)
    force = np.array([0, -1, 0.4])
    stiffness = {"EI1": 0.3, "EI2": 1.0, "GJ": 0.2}
    components = force @ director, force @ np.cross([1, 0, 0], director)
    exact = factors_of_an_oblique_force(*components, **stiffness)
    sizes = (20, 24, 40, 48, 100)
    errors = []
    for n in sizes:
        strip = section(director, EA=SLENDER, **stiffness)
        scene = straight_rod(n, strip, loads=tip_force(*force.tolist()))
        found = buckling({**scene, "solver": {"linear": solver}})
        errors.append(found.load_factors / exact - 1)
    for column in np.transpose(errors):
        assert fitted_order([1 / n for n in sizes], column) > 1.9
    assert np.abs(errors[-1]).max() < 2e-3


LEAVING_THE_PLANE = {
    "force": {"point_force": {**END, "force": [0, -1, 0.4]}},
    "weight": {"gravity": [0, -1, 0.3]},
    "distributed": {"distributed_force": {"rod": "rod", "force": [0, -1, 1e-6]}},
}


@pytest.mark.parametrize("load", LEAVING_THE_PLANE)
@pytest.mark.parametrize("analysis", ["buckling", "continuation"])
def test_a_model_chosen_by_its_loads_keeps_its_space_at_the_factor_0(load, analysis):
    """Without the loads a plane would do: the two models were mixed, and memory overwritten."""
    strip = section(EI1=0.3, EI2=1.0, GJ=0.2)
    scene = straight_rod(10, strip, loads=[LEAVING_THE_PLANE[load]])
    answers = []
    for model in ("auto", "spatial"):
        result = der.run({**scene, "model": model, "analysis": {analysis: {}}})
        assert result.summary["model"] == "spatial"
        answers.append(
            result.buckling.load_factors if analysis == "buckling" else result.positions[-1]
        )
    np.testing.assert_array_equal(*answers)
    assert len(answers[0]) > 0


def test_spins_that_loads_act_on_are_named():
    bar = section([0, 0, 1], EA=SLENDER, EI1=0.4, EI2=1.0, GJ=0.3)
    across = [{"point_force": {"rod": "rod", "at": "middle", "force": [0, -1, 0]}}]
    with pytest.raises(der.NotConvergedError, match=r"rod 'rod'.*linear theory does not decide"):
        buckling(straight_rod(10, bar, supports=PINS, loads=across, model="spatial"), 1)
    ends = [
        {"point_force": {**START, "force": [1, 0, 0]}},
        {"point_force": {**END, "force": [-1, 0, 0]}},
    ]
    with pytest.raises(der.NotConvergedError, match=r"rod 'rod'.*smallest loads make it unstable"):
        buckling(straight_rod(10, bar, supports=[], loads=ends, model="spatial"), 1)


def test_column_without_sections(fitted_order):
    """pi^2 EI, twice, of the model without twist, pinned along any direction."""
    along = np.array([1.0, 2.0, 2.0]) / 3
    supports = [
        {**START, "fix": ["x", "y", "z"]},
        {**END, "fix": ["y", "z"]},
    ]
    errors = []
    for n in SIZES:
        bar = section(EA=SLENDER, EI=1.0)
        scene = straight_rod(
            n, bar, supports=supports, loads=tip_force(-1, 0, 0), model="spatial_bend"
        )
        errors.append(buckling(scene, 2).load_factors / np.pi**2 - 1)
    for column in np.transpose(errors):
        assert fitted_order(STEPS, column) > 1.9
    slanted = straight_rod(SIZES[-1], bar, to=along, loads=tip_force(*-along), model="spatial_bend")
    assert buckling(slanted, 2).load_factors == pytest.approx(np.pi**2 / 4, rel=1e-3)


def test_lateral_torsional_buckling(spatial_reference, fitted_order):
    """P L^2/sqrt(EI_weak GJ) = 4.0126, whatever the stiffness in the plane of the load."""
    exact = spatial_reference("spatial_buckling", "lateral.limit")
    errors = []
    for n in SIZES:
        bar = section([0, 0, 1], EA=SLENDER, EI1=0.4, EI2=1.0, GJ=0.1)
        scene = straight_rod(n, bar, loads=tip_force(0, 0.2, 0), model="spatial")
        errors.append(buckling(scene, 1).load_factors[0] / exact - 1)
    assert fitted_order(STEPS, errors) > 1.9
    assert abs(errors[-1]) < 2e-3


# ---- continuation


@pytest.mark.parametrize(
    ("towards_weak", "judged"), [(1e7, False), (1e7, True), (0.8, False), (0.8, True)], ids=str
)
def test_a_beam_that_buckles_on_a_soft_spring(fitted_order, towards_weak, judged):
    """The spring bears the moment in the plane, and is soft about the tangent, or about both other
    axes. Verdicts on equilibria are of a beam that hardly bends in its plane."""
    weak, twisting, about_tangent = 0.3, 0.2, 0.5
    exact = beam_on_a_spring(towards_weak / weak, about_tangent / twisting)
    exact *= np.sqrt(weak * twisting)
    stiffness = [towards_weak, 1e9, about_tangent]
    supports = [
        {**START, "fix": ["x", "y", "z"], "spring": {"rotational_stiffness": stiffness}},
        {**END, "clamp": True},
    ]
    bar = section([0, 0, 1], EA=1e9, EI1=weak, EI2=1e5 if judged else 1.0, GJ=twisting)
    sizes = [20, 40, 80] if not judged else SIZES
    errors = []
    for n in sizes:

        def beam(load, n=n):
            push = {"point_force": {"rod": "rod", "at": "middle", "force": [0, -load, 0]}}
            return straight_rod(n, bar, supports=supports, loads=[push])

        def is_unstable(load, beam=beam):
            analysis = {"static": {"stability": "any"}}
            _, result = measured({**beam(load), "analysis": analysis}, ["end"], ["x"])
            return result.summary["stability"] == "unstable"

        if judged:
            found = critical(is_unstable, 0.9 * exact, 1.1 * exact, 1e-7)
        else:
            found = buckling(beam(1.0), 1).load_factors[0]
        errors.append(found / exact - 1)
    assert fitted_order([1 / n for n in sizes], errors) > 1.9
    assert abs(errors[-1]) < 3e-3


def clamped_arch(model, out_of_plane=False):
    """An arch that snaps through; in space its nodes stay at z = 0 unless they may leave."""
    scene = {**arch(20, 0.15), "model": model}
    (rod,) = scene["rods"]
    rod["cross_section"]["stiffness"]["GJ"] = 0.7
    scene["supports"] = [{**START, "clamp": True}, {**END, "clamp": True}]
    if model == "spatial" and not out_of_plane:
        scene["supports"] += [
            {"rod": "rod", "at": {"node": i}, "fix": ["z"]}
            for i in range(1, len(rod["points"]) - 1)
        ]
    return scene


def test_planar_path_in_space():
    """The same limit points, and the same shape at the end."""
    with pytest.warns(der.DerWarning, match="leaves its plane"):
        planar = continued(clamped_arch("planar"), to=60)
    spatial = continued(clamped_arch("spatial"), to=60)
    folds = [result.path.factor[result.path.rows("fold")] for result in (planar, spatial)]
    assert len(folds[0]) == 2
    assert folds[1] == pytest.approx(folds[0], rel=1e-9)
    ends = [result.positions[-1][:, :2] for result in (planar, spatial)]
    assert np.abs(ends[0] - ends[1]).max() < 1e-9

    free = continued(clamped_arch("spatial", out_of_plane=True), to=60, branches=1)
    left = planar.path.factor[planar.path.rows("out_of_plane")]
    assert len(left) == 4
    assert free.path.factor[free.path.rows("bifurcation")] == pytest.approx(left, rel=1e-7)
    # Two pairs of branches out of the plane, each from one bifurcation to another.
    endings = [branch["ending"] for branch in free.summary["path"]["branches"]]
    assert endings == ["last factor", *["meets branch 0"] * 4]


def lateral(n, **options):
    bar = section([0, 0, 1], EA=SLENDER, EI1=0.1, EI2=1.0, GJ=0.1)
    probes = {c: {**END, "quantity": c} for c in "xyz"}
    scene = straight_rod(n, bar, loads=tip_force(0, 0.1, 0), model="spatial")
    return continued({**scene, "output": {"probes": probes}}, **options)


def test_lateral_torsional_path(spatial_reference, fitted_order):
    """The bifurcation, with the bending before it."""
    exact = spatial_reference("spatial_buckling", "lateral.weak0.1.GJ0.1")
    errors = []
    for n in SIZES:
        path = lateral(n, to=6).path
        errors.append(path.factor[path.rows("bifurcation")[0]] / exact - 1)
        assert path.unstable_directions[-1] == 1
    assert fitted_order(STEPS, errors) > 1.9


def test_buckled_sideways(spatial_reference, fitted_order):
    """Both branches beyond it, at the load 6, against the boundary value problem of the rod."""
    exact = [spatial_reference("spatial_buckling", f"sideways.{c}") for c in "xyz"]
    errors = []
    for n in SIZES:
        result = lateral(n, to=6, branches=1)
        path = result.path
        assert path.branch.max() == 2
        tips = []
        for branch in (1, 2):
            last = np.flatnonzero(path.branch == branch)[-1]
            assert path.factor[last] == pytest.approx(6, rel=1e-12)
            assert path.stable[last]
            tips.append([result.probes[c][last] for c in "xyz"])
        assert tips[0] == pytest.approx(tips[1] * np.array([1, 1, -1]), abs=1e-6)
        errors.append(np.abs(np.abs(tips[0]) - exact).max())
    assert fitted_order(STEPS, errors) > 1.9
    assert errors[-1] < 5e-3


def test_greenhill_along_a_path(spatial_reference, fitted_order):
    """Both ends clamped, one turned about the rod: the path of the twist bifurcates."""
    exact = spatial_reference("spatial_buckling", "twist.clamped.thrust0")
    turns = {"twist": 1 / 2.0}  # the torque GJ/L times the twist is the factor
    supports = [{**START, "clamp": True}, {**END, "clamp": True, "prescribe": turns}]
    errors = []
    for n in SIZES:
        scene = straight_rod(n, section(EA=SLENDER, EI=1.0, GJ=2.0), supports=supports)
        path = continued(scene, to=10, vary="supports").path
        first = np.flatnonzero(path.unstable_directions > 0)[0]
        errors.append(path.factor[first] / exact - 1)
    assert fitted_order(STEPS, errors) > 1.9


def test_a_rod_that_may_spin_has_no_path():
    supports = [{**START, "fix": ["x", "y", "z"]}, {**END, "fix": ["y", "z"]}]
    bar = section([0, 0, 1], EA=SLENDER, EI1=0.4, EI2=1.0, GJ=0.3)
    scene = straight_rod(10, bar, supports=supports, loads=tip_force(-1, 0, 0))
    with pytest.raises(der.NotConvergedError, match="own axis"):
        continued(scene, to=1)
