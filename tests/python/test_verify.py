"""der.verify and der verify: error bars, what is refined and what cannot be, what is flagged."""

import json
import math
import re
from fractions import Fraction
from types import SimpleNamespace

import der
import numpy as np
import pytest
from der.accuracy.branches import are_far_apart, are_mirrored
from der.accuracy.error_bars import ErrorEstimate, estimate_error
from der.accuracy.event_matching import match_places
from der.accuracy.noise import ExactBelow, exact_below
from der.accuracy.readings import parabola_top, probe_values
from der.accuracy.refinement import (
    curves_between_points,
    rods_that_cannot_be_refined,
    with_elements,
    with_time,
)
from der.accuracy.resampling import (
    find_corners,
    find_curvature_jumps,
    resample,
    resample_list,
    unresolved_nodes,
)
from der.accuracy.verification import Verification, with_digits_of
from der.accuracy.verification_runs import VerificationRuns
from der.accuracy.verified_value import VerifiedValue
from der.accuracy.verifier import Evaluation
from der.cli import main
from der.probe_series import ProbeSeries
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipk

# The cantilever of configs/, whose tip the elastica knows.
ARM = {
    "title": "Arm",
    "rods": [
        {
            "name": "arm",
            "nodes": 21,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"stiffness": {"EA": 1e7, "EI": 1, "mass_per_length": 0.1}},
        }
    ],
    "supports": [{"rod": "arm", "at": "start", "clamp": True}],
    "loads": [{"point_force": {"rod": "arm", "at": "end", "force": [0, -1]}}],
    "analysis": "static",
    "output": {"probes": {"tip": {"rod": "arm", "at": "end", "quantity": "y"}}},
}
TIP = -0.3017207738


@pytest.fixture
def arm():
    return json.loads(json.dumps(ARM))


@pytest.fixture
def sagging(swing):
    """A soft beam on two supports falls into a sag: its middle converges cleanly."""
    swing["rods"][0]["nodes"] = 21
    swing["supports"] = [
        {"rod": "arm", "at": "start", "fix": ["x", "y"]},
        {"rod": "arm", "at": "end", "fix": ["y"]},
    ]
    swing["time"] = {"duration": 0.3, "step": 0.002, "integrator": "implicit_euler"}
    swing["output"]["probes"] = {"sag": {"rod": "arm", "at": "middle", "quantity": "y"}}
    return swing


@pytest.fixture
def half_circle(arm):
    angle = np.linspace(0.0, np.pi, 17)
    points = np.column_stack([np.cos(angle), np.sin(angle)])
    arm["rods"][0] |= {"points": points.tolist()}
    for key in ("nodes", "from", "to"):
        del arm["rods"][0][key]
    return arm


def crook(edges):
    """A straight leg of 0.5 m that runs into a quarter arc of radius 0.3 m."""
    angle = np.linspace(0.0, np.pi / 2, edges + 1)[1:]
    leg = np.column_stack([np.linspace(0.0, 0.5, edges + 1), np.zeros(edges + 1)])
    arc = np.column_stack([0.5 + 0.3 * np.sin(angle), 0.3 - 0.3 * np.cos(angle)])
    return np.vstack([leg, arc])


@pytest.fixture
def column():
    """A pinned column; buckles at pi^2 N, with 20 elements at 9.8493, with 40 at 9.8646 N."""
    column = json.loads(json.dumps(ARM))
    column["rods"][0]["cross_section"]["stiffness"]["EA"] = 1e8
    column["supports"] = [
        {"rod": "arm", "at": "start", "fix": ["x", "y"]},
        {"rod": "arm", "at": "end", "fix": ["y"]},
    ]
    column["loads"] = [{"point_force": {"rod": "arm", "at": "end", "force": [-1, 0]}}]
    column["output"]["probes"] = {"end_x": {"rod": "arm", "at": "end", "quantity": "x"}}
    return column


# Error bars from values.


@pytest.mark.parametrize("order", [1.0, 2.0])
def test_clean_convergence_gives_the_limit_and_a_quarter_more(order):
    values = [3.0 + 0.1 / 2.0 ** (order * level) for level in range(3)]
    estimate = estimate_error(values, order)
    assert estimate.verdict == "converged"
    assert not estimate.flagged
    assert estimate.order == pytest.approx(order)
    assert values[0] + estimate.correction == pytest.approx(3.0, abs=1e-12)
    assert estimate.error_bar == pytest.approx(1.25 * 0.1)


def test_two_levels_trust_the_expected_order_with_factor_three():
    estimate = estimate_error([1.4, 1.1], 2.0)
    assert estimate.verdict == "two levels"
    assert 1.4 + estimate.correction == pytest.approx(1.0)
    assert estimate.error_bar == pytest.approx(3 * 0.4)


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        ([1.0, 0.5, 0.2], "slow"),
        ([1.0, 0.9, 0.7], "diverging"),
        ([1.0, 0.5, 0.8], "oscillating"),
    ],
)
def test_what_does_not_converge_at_order_two_is_flagged(values, verdict):
    estimate = estimate_error(values, 2.0)
    assert (estimate.verdict, estimate.flagged) == (verdict, True)
    # At least three times what the refinements changed.
    assert estimate.error_bar >= 3 * max(abs(np.diff(values)))


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        # Errors of h^2 - h^4: two of opposite sign, whose changes show no order.
        ([1.1, 1.3, 1.2, 1.21], "settled"),
        # Order 1 where 2 is expected: half of the change each time.
        ([1.0, 0.5, 0.25, 0.125], "settled"),
        ([1.0, 0.5, 0.25], "settled"),
        ([1.0, 0.9, 1.1, 0.9], "oscillating"),
        ([1.0, 0.9, 0.81, 0.73], "slow"),
    ],
)
def test_what_settles_is_not_flagged_but_has_a_wide_bar(values, verdict):
    estimate = estimate_error(values, 2.0)
    assert estimate.verdict == verdict
    assert estimate.flagged is estimate.unsettled is (verdict != "settled")
    assert estimate.error_bar >= 3 * (max(values) - min(values))


def test_a_fourth_level_finds_the_order_that_three_hide():
    """The error 0.2 h^2 - 0.16 h^4 is the same at h = 1 and at h = 1/2."""
    errors = [0.2 * h**2 - 0.16 * h**4 for h in (1.0, 0.5, 0.25, 0.125)]
    assert estimate_error(errors[:3], 2.0).unsettled
    estimate = estimate_error(errors, 2.0)
    assert estimate.verdict == "converged"
    assert abs(errors[0]) <= estimate.error_bar <= 10 * abs(errors[0])
    assert errors[0] + estimate.correction == pytest.approx(0.0, abs=1e-3)


def test_noise_is_not_mistaken_for_an_order():
    estimate = estimate_error([1.0, 1.0 + 1e-13, 1.0 - 2e-13], 2.0, noise=1e-12)
    assert (estimate.verdict, estimate.error_bar, estimate.order) == ("exact", 1e-12, None)


def test_faster_than_expected_is_no_flaw():
    estimate = estimate_error([1.0, 0.9, 0.8999], 1.0)
    assert not estimate.flagged
    assert estimate.error_bar > 0.1


def test_number_of_levels():
    with pytest.raises(ValueError, match="two or more"):
        estimate_error([1.0], 2.0)


def test_parabola_top():
    times = np.array([1.0, 1.5, 2.5])
    assert parabola_top(times, 4.0 - 3.0 * (times - 1.7) ** 2) == pytest.approx(4.0)


def test_extremes_between_few_frames_are_found_from_all_steps():
    """A sine of period 1 in steps of 1/32, of which every third is a frame: the highest step is up
    to (pi/32)^2 / 2 = 4.8e-3 below the top. The error of the parabola is of third order."""
    raw, found = [], []
    for start in np.linspace(0.0, 1 / 32, 9):
        steps = start + np.arange(33) / 32
        values = np.sin(2 * np.pi * steps)
        summary = {"final": values[-1], "min": values.min(), "max": values.max()}
        summary |= {"t_min": steps[values.argmin()], "t_max": steps[values.argmax()]}
        frames = slice(None, None, 3)
        series = ProbeSeries(values[frames], "m", summary)
        run = SimpleNamespace(times=steps[frames], probes={"probe": series})
        raw.append(max(1.0 - summary["max"], 1.0 + summary["min"]))
        extremes = probe_values(run, "probe")
        found.append(max(abs(1.0 - extremes["max"]), abs(1.0 + extremes["min"])))
    assert max(raw) > 4.7e-3
    assert max(found) < 6e-4


# Refining a scene.


def test_straight_rod_keeps_its_places(tube):
    tube["rods"][0]["natural_curvature"] = np.linspace(0.0, 1.0, 21).tolist()
    tube["rods"][0]["initial_velocity"] = [[0.1 * i, 0.0] for i in range(21)]
    tube["output"]["probes"]["v"] = {"rod": "beam", "at": {"node": 5}, "quantity": "vy"}
    tube["output"]["probes"]["w"] = {"rod": "beam", "at": {"node": -2}, "quantity": "vy"}
    refined = with_elements(der.Scenario.from_dict(tube), 2).to_dict()
    rod = refined["rods"][0]
    assert rod["nodes"] == 41
    assert rod["natural_curvature"] == pytest.approx(np.linspace(0.0, 1.0, 41))
    assert np.array(rod["initial_velocity"])[:, 0] == pytest.approx(np.linspace(0.0, 2.0, 41))
    assert refined["output"]["probes"]["v"]["at"] == {"node": 10}
    assert refined["output"]["probes"]["w"]["at"] == {"node": -3}
    assert refined["loads"] == tube["loads"]


def test_points_of_a_curve_stay_on_the_curve(half_circle):
    half_circle["loads"][0]["point_force"]["at"] = "middle"
    finer = with_elements(der.Scenario.from_dict(half_circle), 4)
    points = np.array(finer.to_dict()["rods"][0]["points"])
    assert np.linalg.norm(points, axis=1) == pytest.approx(np.ones(65), abs=2e-6)
    assert finer.to_dict()["loads"][0]["point_force"]["at"] == {"node": 32}


def test_arc_lengths_on_a_curve_move_with_their_element(half_circle):
    model = der.Model(der.Scenario.from_dict(half_circle))
    arc = model.rods[0].arc_lengths
    half_circle["output"]["probes"] = {
        "node": {"rod": "arm", "at": arc[4], "quantity": "x"},
        "between": {"rod": "arm", "at": 0.5 * (arc[4] + arc[5]), "quantity": "x"},
    }
    finer = with_elements(der.Scenario.from_dict(half_circle), 2)
    new_arc = der.Model(finer).rods[0].arc_lengths
    places = {name: probe["at"] for name, probe in finer.to_dict()["output"]["probes"].items()}
    assert places["node"] == pytest.approx(new_arc[8])
    assert places["between"] == pytest.approx(new_arc[9], rel=1e-3)
    assert new_arc[-1] > arc[-1]


def test_corners_stay_corners():
    ell = np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 0.5], [1.0, 1.0]])
    assert find_corners(ell) == [2]
    finer = resample(ell, Fraction(2))
    assert np.all((finer[:, 1] == 0.0) | (finer[:, 0] == 1.0))
    x = np.linspace(0.0, 8.0, 17)
    assert find_corners(np.column_stack([x, 0.1 * np.sin(x)])) == []
    # One kink of 40 degrees in a straight line is a corner too.
    kink = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.77, 0.64], [3.54, 1.28]])
    assert find_corners(kink) == [2]


def test_the_last_turn_behind_an_inflection_is_no_corner():
    """It stands alone: the curve turns the other way before it, and ends behind it."""
    x = np.linspace(0.0, 1.05, 30)
    wave = np.column_stack([x, 0.1 * np.sin(np.pi * x)])
    edges = np.diff(wave, axis=0)
    turns = edges[:-1, 0] * edges[1:, 1] - edges[:-1, 1] * edges[1:, 0]
    assert turns[-1] > 0.0 > turns[-2]
    assert find_corners(wave) == []


def test_corners_in_space():
    bent = np.array([[0.0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 2, 1], [0, 2, 2]])
    assert find_corners(bent) == [2]
    turn = np.linspace(0.0, 4 * np.pi, 49)
    assert find_corners(np.column_stack([np.cos(turn), np.sin(turn), 0.1 * turn])) == []


def test_a_pair_of_curvatures_in_space_is_no_list_of_nodes():
    rod = ARM["rods"][0] | {"nodes": 3, "from": [0, 0, 0], "to": [1, 0, 0]}
    scene = {"rods": [rod], "analysis": "static"}
    for curvature, finer in [
        ([0, 2], [0, 2]),
        ([[0, 2], [0, 4], [0, 6]], [[0, 2], [0, 3], [0, 4], [0, 5], [0, 6]]),
    ]:
        scene["rods"] = [rod | {"natural_curvature": curvature}]
        refined = with_elements(der.Scenario.from_dict(scene), 2).to_dict()["rods"][0]
        assert np.allclose(refined["natural_curvature"], finer)


def test_a_list_of_natural_twists_is_refined():
    rod = ARM["rods"][0] | {"nodes": 3, "from": [0, 0, 0], "to": [1, 0, 0]}
    rod["cross_section"] = {"stiffness": {"EA": 1, "EI": 1, "GJ": 1, "mass_per_length": 1}}
    for twist, finer in [(2.0, 2.0), ([0, 2, 4], [0, 1, 2, 3, 4])]:
        scene = {"rods": [rod | {"natural_twist": twist}], "analysis": "static"}
        refined = with_elements(der.Scenario.from_dict(scene), 2).to_dict()["rods"][0]
        assert np.allclose(refined["natural_twist"], finer)


@pytest.mark.parametrize("edges", [5, 10, 20])
def test_jumps_of_the_curvature_stay_jumps(edges):
    """The straight leg stays straight, and the arc is left by what a spline of degree 5 leaves a
    circle: an error of sixth order."""
    points = crook(edges)
    assert find_curvature_jumps(points) == [edges]
    finer = resample(points, Fraction(4))
    assert finer[: 4 * edges + 1, 1] == pytest.approx(0.0, abs=1e-12)
    radii = np.linalg.norm(finer[4 * edges :] - [0.5, 0.3], axis=1)
    turn = np.pi / 2 / edges
    assert radii == pytest.approx(0.3, abs=0.3 * turn**6 / 30)


def test_smooth_curves_have_no_jumps_of_the_curvature():
    x = np.linspace(0.0, 4 * np.pi, 41)
    ellipse = np.column_stack([2 * np.cos(x / 2), np.sin(x / 2)])
    helix = np.column_stack([np.cos(x), np.sin(x), 0.3 * x])
    for curve in (np.column_stack([x, np.sin(x)]), ellipse, helix, crook(20)[:21]):
        assert find_curvature_jumps(curve) == []
    # An arc has none either where the points are rounded.
    rounded = np.round(crook(20)[20:], 7)
    assert find_curvature_jumps(rounded) == []


def test_a_piece_of_one_edge_between_two_jumps_has_both_curves():
    """A line of uneven edges that runs into an arc: guessed jumps at two neighbouring nodes."""
    points = np.array(
        [
            [0.0, 0.0],
            [0.075, 0.0],
            [0.15, 0.0],
            [0.58, 0.0],
            [0.6, 0.0],
            [0.69933, 0.00997],
            [0.72941, 0.01704],
            [0.85, 0.06699],
        ]
    )
    assert find_curvature_jumps(points) == [3, 4]
    for other in (False, True):
        finer = resample(points, Fraction(2), other_curve=other)
        np.testing.assert_array_equal(finer[::2], points)
        np.testing.assert_allclose(finer[7], [0.59, 0.0], atol=1e-4)


def test_narrow_peaks_have_no_certain_jumps():
    """Their flanks look like jumps of the curvature. Other curves through the points are smooth."""
    share = np.linspace(0.0, 1.0, 20)
    phase = 2.0 * np.pi * share
    peak = np.column_stack([np.sin(0.7 * phase + 3.0), 0.7 * np.sin(1.2 * phase)])
    assert find_curvature_jumps(peak)
    assert find_curvature_jumps(peak, certain=True) == []
    differ = np.abs(resample(peak, Fraction(2)) - resample(peak, Fraction(2), other_curve=True))
    assert differ.max() > 1e-3
    for edges in (5, 10):
        assert find_curvature_jumps(crook(edges), certain=True) == [edges]


def bump(elements):
    """A curve that inflects behind its first turn, which may be a corner by its points."""
    x = np.linspace(0.0, 1.0, elements + 1)
    return np.column_stack([x, 0.35 * np.exp(-((x - 0.45) ** 2) / (2 * 0.25**2))])


def test_the_first_turn_before_an_inflection_is_no_certain_corner():
    points = bump(12)
    assert find_corners(points) == [1]
    assert find_corners(points, certain=True) == []
    ell = np.array([[0.0, 0.0], [0.5, 0.0], [0.8, 0.3], [1.1, 0.6], [1.4, 0.9]])
    assert find_corners(ell, certain=True) == [1]
    zigzag = np.column_stack([np.arange(6.0), 0.2 * (np.arange(6) % 2)])
    assert find_corners(zigzag, certain=True) == [1, 2, 3, 4]


def test_points_that_do_not_resolve_their_curve_are_flagged(arm):
    """The first turn of the bump is taken for a corner, and the slope before it is off by 0.079.
    That of finer meshes is the same, behind the same corner: the value would be called exact."""
    rod = {key: arm["rods"][0][key] for key in ("name", "cross_section")}
    arm["rods"] = [rod | {"points": bump(12).tolist()}]
    arm["output"]["probes"] = {"slope": {"rod": "arm", "at": "start", "quantity": "slope"}}
    found = der.verify(arm)
    slope = found["slope"]
    exact = 0.35 * (0.45 / 0.25**2) * np.exp(-(0.45**2) / (2 * 0.25**2))
    error = abs(slope.value - math.atan(exact))
    assert error == pytest.approx(0.079, abs=0.01)
    assert 0.5 * error < slope.error_bar < 5.0 * error
    assert slope.verdict == "unresolved in drawing"
    assert found.flagged
    assert any("do not resolve its curve beside node 1:" in note for note in found.notes)


def test_drawings_that_resolve_their_curves_are_not_flagged():
    x = np.linspace(0.0, 1.0, 21)
    sine = np.column_stack([x, 0.1 * np.sin(2.0 * np.pi * x)])
    turn = 2.0 * np.pi * x[:-1]
    ring = np.column_stack([np.cos(turn), 0.6 * np.sin(turn)])
    ell = np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 0.5], [1.0, 1.0]])
    for line in (sine, ell, crook(5), crook(10), np.column_stack([x, 0.0 * x])):
        assert unresolved_nodes(line) == []
    assert unresolved_nodes(ring, closed=True) == []
    # Three edges do not show where an arc begins, as long as something else follows them.
    arc = np.array([0.15, 0.3, 0.45])
    end = [np.sin(0.45), 1.0 - np.cos(0.45)]
    after = end + np.outer(0.15 * np.arange(1, 4), [np.cos(0.45), np.sin(0.45)])
    before = np.column_stack([[-0.45, -0.3, -0.15, 0.0], np.zeros(4)])
    line = np.vstack([before, np.column_stack([np.sin(arc), 1.0 - np.cos(arc)]), after])
    assert unresolved_nodes(line) != []


def test_bars_hold_where_the_curvature_jumps(arm):
    """Hardly loaded: the tangent at the junction is that of the straight leg."""
    rod = arm["rods"][0]
    for key in ("nodes", "from", "to"):
        del rod[key]
    arm["loads"][0]["point_force"]["force"] = [0, 1e-9]
    probe = {"rod": "arm", "at": {"node": 10}, "quantity": "slope"}
    arm["output"]["probes"] = {"slope": probe}
    rod["points"] = crook(10).tolist()
    verification = der.verify(arm)
    slope = verification["slope"]
    assert not verification.flagged
    assert abs(slope.value) < 1e-8
    assert slope.error_bar < 3e-4  # 0.021 with one spline through all points, which rounds it


@pytest.mark.parametrize("other_curve", [False, True])
@pytest.mark.parametrize("closed", [False, True])
def test_new_nodes_of_a_curve_are_of_high_order(closed, other_curve):
    """A spline of degree k errs by h^(k + 1), beside its ends by h^k; the one to compare with is
    two orders better."""
    errors = []
    for elements in (16, 32):
        whole = 2.0 * np.pi if closed else 2.0
        turn = np.linspace(0.0, whole, elements + 1)[: -1 if closed else None]
        points = np.column_stack([np.cos(turn), np.sin(turn)])
        finer = resample(points, Fraction(4), closed=closed, other_curve=other_curve)
        errors.append(np.max(np.abs(np.linalg.norm(finer, axis=1) - 1.0)))
    least = (7.0 if other_curve else 5.0) + closed
    assert least - 0.3 < np.log2(errors[0] / errors[1]) < least + 2.0


@pytest.mark.parametrize("edges", range(3, 6))
def test_few_points_are_compared_with_a_lower_degree(edges):
    """No spline is of higher degree than the polynomial through all of the points."""
    angle = np.linspace(0.0, 1.5, edges + 1)
    arc = np.column_stack([np.cos(angle), np.sin(angle)])
    usual, other = (
        np.abs(np.linalg.norm(resample(arc, Fraction(2), other_curve=o), axis=1) - 1.0).max()
        for o in (False, True)
    )
    assert 0.0 < usual < 5.0 * other


def test_what_is_straight_between_corners_leaves_nothing_open(half_circle):
    ell = [[0.0, 0.0], [0.2, 0.0], [0.5, 0.0], [0.5, 0.1], [0.5, 0.7]]
    polyline = {**half_circle, "rods": [{**half_circle["rods"][0], "points": ell}]}
    for scene, curves in ((ARM, []), (polyline, []), (half_circle, ["arm"])):
        assert curves_between_points(der.Scenario.from_dict(scene)) == curves
    found = der.verify(polyline)
    assert found["tip"].drawing is None
    assert "drawing" not in str(found)
    assert found.to_dict()["values"][0]["drawing_error"] is None


def test_coarser_points_drop_nodes_but_no_corner():
    line = np.column_stack([np.arange(9.0), np.zeros(9)])
    assert np.array_equal(resample(line, Fraction(1, 2)), line[::2])
    with pytest.raises(ValueError, match="1/3"):
        resample(line, Fraction(1, 3))
    with pytest.raises(ValueError, match="whole multiples"):
        resample(line, Fraction(3, 2))


def test_lists_with_a_jump_do_not_overshoot():
    refined = resample_list(np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), 20)
    assert refined.min() >= 0.0
    assert refined.max() <= 1.0


def test_node_numbers_that_a_coarser_mesh_has_not(tube):
    tube["output"]["probes"]["v"] = {"rod": "beam", "at": {"node": 5}, "quantity": "vy"}
    with pytest.raises(ValueError, match="node 5"):
        with_elements(der.Scenario.from_dict(tube), Fraction(1, 2))


def test_spheres_and_forces_on_every_node_are_part_of_the_model(spheres, arm):
    assert rods_that_cannot_be_refined(der.Scenario.from_dict(spheres)).keys() == {"rod"}
    arm["loads"][0]["point_force"]["at"] = "all"
    scenario = der.Scenario.from_dict(arm)
    assert "force" in rods_that_cannot_be_refined(scenario)["arm"]
    assert with_elements(scenario, 2).to_dict()["rods"][0]["nodes"] == 21


def test_spheres_at_places_do_not_prevent_refinement(arm):
    arm["rods"][0]["spheres"] = [{"at": "end", "radius": 0.01, "density": 1000}]
    assert rods_that_cannot_be_refined(der.Scenario.from_dict(arm)) == {}


# Verifying.


def test_static_bar_holds_the_elastica(arm):
    verification = der.verify(arm)
    tip = verification["tip"]
    assert tip.value == pytest.approx(der.run(arm).probes["tip"][0], rel=1e-12)
    assert abs(tip.value - TIP) <= tip.error_bar < 3 * abs(tip.value - TIP)
    assert abs(tip.extrapolated - TIP) < 0.01 * abs(tip.value - TIP)
    assert tip.time is None
    assert tip.space.order == pytest.approx(2.0, abs=0.1)
    assert verification.meshes == ("21 nodes", "41 nodes", "81 nodes")
    assert verification.flagged == []


def wave(share):
    """A sine of two half waves over unit length, and its curvature."""
    height, number = 0.15, 2.0 * np.pi
    slope = height * number * np.cos(number * share)
    curvature = -height * number**2 * np.sin(number * share) / (1.0 + slope**2) ** 1.5
    return np.column_stack([share, height * np.sin(number * share)]), curvature


@pytest.fixture
def drawn_wave(arm):
    """The sine, drawn by uneven points and free of loads, so that its curvature is known."""
    even = np.linspace(0.0, 1.0, 26)
    points, curvature = wave(even + 0.1 * np.sin(2.0 * np.pi * even) * (1.0 - even))
    rod = {key: arm["rods"][0][key] for key in ("name", "cross_section")}
    arm["rods"] = [{**rod, "points": points.tolist()}]
    del arm["loads"]
    nodes = range(1, 25)
    arm["output"]["probes"] = {
        f"node_{node}": {"rod": "arm", "at": {"node": node}, "quantity": "curvature"}
        for node in nodes
    }
    return arm, {f"node_{node}": curvature[node] for node in nodes}


def test_the_bar_includes_what_points_leave_open(drawn_wave):
    """The curvature of a cubic spline through them is off by more than the error of the mesh."""
    scene, exact = drawn_wave
    found = der.verify(scene)
    for name, curvature in exact.items():
        value = found[name]
        assert abs(value.value - curvature) <= value.error_bar, name
        assert abs(value.extrapolated - curvature) <= value.error_bar, name
        parts = (value.space, value.drawing)
        assert value.error_bar == pytest.approx(value.solver + sum(p.error_bar for p in parts))
    assert {value.drawing.verdict for value in found.values} == {"compared"}
    assert found.to_dict()["values"][0]["drawing_error"]["error_bar"] > 0.0
    header, first = str(found).splitlines()[2:4]
    assert header.split()[:6] == ["probe", "value", "error", "space", "time", "drawing"]
    assert len(first.split()) == 13


def test_a_note_tells_where_the_drawing_limits(drawn_wave):
    found = der.verify(drawn_wave[0])
    limited = [value.label for value in found.values if value.is_limited_by_drawing]
    assert 1 < len(limited) < len(found.values)
    (note,) = found.notes
    named = ", ".join(f"'{label}'" for label in limited)
    assert note.startswith(
        f"the error of {named} is mostly that of the drawing: the points of 'arm' leave open"
    )


def test_what_points_leave_open_over_time(half_circle):
    """Its tip sinks under a load put on at once; truth from 16 times the points of the circle."""
    del half_circle["analysis"]
    half_circle["time"] = {"duration": 0.5, "step": 0.025, "integrator": "tr_bdf2"}
    half_circle["output"]["every"] = 0.025
    fine = json.loads(json.dumps(half_circle))
    angle = np.linspace(0.0, np.pi, 16 * 16 + 1)
    fine["rods"][0]["points"] = np.column_stack([np.cos(angle), np.sin(angle)]).tolist()
    found = der.verify(half_circle)
    truth = der.run(fine).probes["tip"][-1]
    tip = found["tip"]
    assert tip.drawing.verdict in ("compared", "exact")
    assert abs(tip.value - truth) <= tip.space.error_bar + tip.drawing.error_bar + tip.solver


def test_failed_run_on_other_curves_is_flagged_with_a_note(half_circle, monkeypatch):
    original = der.accuracy.verification_runs.Workers.run

    def fail_on_other_curves(self, tasks, **options):
        outcomes = original(self, tasks, **options)
        error = der.NotConvergedError("no convergence")
        return {
            key: type(outcome)(None, error, 0.0) if key == ("drawing", 2) else outcome
            for key, outcome in outcomes.items()
        }

    monkeypatch.setattr(der.accuracy.verification_runs.Workers, "run", fail_on_other_curves)
    found = der.verify(half_circle)
    assert found["tip"].verdict == "failed in drawing"
    assert math.isinf(found["tip"].error_bar)
    assert found.notes == ("the run with other curves through the points failed: no convergence",)


def hanging_rod(weight):
    """Tip of a heavy elastica, clamped horizontally: EI theta'' = w (L - s) cos(theta)."""
    s = np.linspace(0.0, 1.0, 201) ** 2
    found = solve_bvp(
        lambda s, y: np.vstack(
            [y[1], weight * (1.0 - s) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]
        ),
        lambda a, b: np.array([a[0], b[1], a[2], a[3]]),
        s,
        np.vstack([-np.minimum(1.5, 20 * s), 0 * s, 0 * s, -s]),
        tol=1e-7,
        max_nodes=10_000,
    )
    assert found.success
    return found.y[2, -1], found.y[3, -1]


def test_levels_are_added_until_the_values_settle(arm):
    """A rod that hangs from its clamp bends nearly all within a sixteenth of its length, which the
    coarser meshes do not resolve: three of them show no order."""
    arm["rods"][0]["nodes"] = 15
    arm["loads"] = [{"gravity": [0.0, -9.81]}]
    arm["rods"][0]["cross_section"]["stiffness"] |= {"EI": 0.005, "mass_per_length": 1.0}
    at_end = {"rod": "arm", "at": "end"}
    arm["output"]["probes"] = {c: {**at_end, "quantity": c} for c in ("x", "y")}
    three = der.verify(arm, levels=2)
    verification = der.verify(arm)
    assert len(three.meshes) == 2
    assert len(verification.meshes) > 3
    assert not verification.flagged
    for name, exact in zip(("x", "y"), hanging_rod(9.81 / 0.005), strict=True):
        value = verification[name]
        assert abs(value.value - exact) <= value.error_bar <= 10 * abs(value.value - exact)


def test_meshes_that_buckle_to_the_other_side_follow_the_scene(column, monkeypatch):
    """With 12 N the column bows out; finer meshes have a slight bend to the other side, and go
    there unless they start from the shape of the scene."""
    column["loads"][0]["point_force"]["force"] = [-12, 0]
    column["output"]["probes"] = {"middle": {"rod": "arm", "at": "middle", "quantity": "y"}}
    bend_the_other_way(column, monkeypatch)
    verification = der.verify(column)
    middle = verification["middle"]
    exact = elastica_middle(12.0)
    assert not middle.flagged
    assert abs(abs(middle.value) - exact) <= middle.error_bar <= 0.02 * exact
    assert sum("another equilibrium" in note for note in verification.notes) == 2


def test_motion_to_the_other_side_is_called_so(column, monkeypatch):
    column["loads"][0]["point_force"]["force"] = [-30, 0]
    column["rods"][0]["cross_section"]["stiffness"]["EA"] = 1e5
    del column["analysis"]
    column["time"] = {"duration": 0.5, "step": 0.005, "integrator": "implicit_euler"}
    column["output"]["probes"]["middle"] = {"rod": "arm", "at": "middle", "quantity": "y"}
    bend_the_other_way(column, monkeypatch)
    verification = der.verify(column)
    assert verification["middle"].verdict.startswith("other branch in space")
    assert math.isinf(verification["middle"].error_bar)
    assert math.isfinite(verification["end_x"].error_bar)
    assert sum("mirror image" in note for note in verification.notes) == 1


def test_a_rod_that_swings_is_not_its_own_mirror_image():
    """Straight shapes at two angles have a mirror between them, which no symmetry has."""
    rod = {"name": "arm", "nodes": 6, "from": [0, 0], "to": [1, 0]}
    rod["cross_section"] = {"circle": {"radius": 0.02}}
    rod["material"] = {"youngs_modulus": 1e9, "density": 1000}
    scene = {
        "rods": [rod],
        "supports": [{"rod": "arm", "at": "start", "fix": ["x", "y"]}],
        "loads": [{"gravity": [0, -9.81]}],
        "time": {"duration": 0.4, "step": 0.01},
    }
    coarse, fine = (der.run(scene, {"time.duration": end}) for end in (0.2, 0.4))
    assert are_far_apart(coarse, fine)
    assert not are_mirrored(coarse, fine)


def bend_the_other_way(scene, monkeypatch):
    """Give the scene a slight natural curvature, and finer meshes the opposite one."""
    scene["rods"][0]["natural_curvature"] = 1e-3

    def other(scenario, factor, **options):
        finer = with_elements(scenario, factor, **options)
        return finer if factor == 1 else finer.with_(**{"rods.0.natural_curvature": -1e-3})

    monkeypatch.setattr(der.accuracy.verification_runs, "with_elements", other)


def elastica_middle(force):
    """Deflection of the middle of a pinned column, EI = L = 1: 2 k / sqrt(P) = k / K(k), where the
    modulus k obeys 2 K(k) = sqrt(P) (Timoshenko and Gere, Theory of Elastic Stability, 2.7)."""
    modulus = brentq(lambda k: 2 * ellipk(k**2) - math.sqrt(force), 1e-9, 1 - 1e-9)
    return 2 * modulus / math.sqrt(force)


def test_dynamic_errors_in_space_and_time_apart(sagging):
    verification = der.verify(sagging)
    sag = verification["sag"]
    assert sag.time.order == pytest.approx(1.0, abs=0.15)
    assert sag.space.order == pytest.approx(2.0, abs=0.2)
    assert sag.error_bar == pytest.approx(sag.space.error_bar + sag.time.error_bar + sag.solver)
    assert verification["sag", "max"].time_of_value == 0.0
    assert verification.steps == ("0.002 s", "0.001 s", "0.0005 s")
    with pytest.raises(KeyError):
        verification["top"]


def test_turning_angles_have_no_error_in_space(swing):
    swing["output"]["probes"]["angle"] = {
        "rod": "arm",
        "at": "middle",
        "quantity": "turning_angle",
    }
    verification = der.verify(swing)
    assert verification["angle"].space is None
    assert verification["angle"].time is not None
    assert any("turning angle" in note for note in verification.notes)


def test_space_is_not_refined_where_spheres_are_on_every_node(spheres):
    verification = der.verify(spheres)
    assert verification.meshes == ()
    assert verification["v_mid"].space is None
    assert any("spheres at every node" in note for note in verification.notes)


def test_space_is_not_refined_where_a_run_gives_the_start(sagging, tmp_path):
    """Its last frame has as many nodes as it has; time is refined all the same."""
    der.run(sagging, out=tmp_path / "first")
    verification = der.verify(sagging | {"start_from": str(tmp_path / "first")})
    sag = verification["sag"]
    assert (sag.space, verification.meshes) == (None, ())
    assert sag.time.verdict != "failed"
    assert math.isfinite(sag.error_bar)
    (note,) = verification.notes
    assert note.startswith("space not refined: it starts from ")


def test_space_is_refined_where_the_equilibrium_is_the_start(sagging):
    sagging["start_from"] = "equilibrium"
    assert rods_that_cannot_be_refined(der.Scenario.from_dict(sagging)) == {}


def test_numerical_damping_is_found_out(tube):
    """At the end a load put on at once still swings; implicit Euler has damped it away, the same on
    every level."""
    deflection = der.verify(tube)["deflection"]
    at_rest = der.equilibrium(tube).probes["deflection"][0]
    assert deflection.value == pytest.approx(at_rest, rel=1e-6)
    assert deflection.verdict == "damped in time"
    assert 0.9 * abs(at_rest) < deflection.error_bar < 2 * abs(at_rest)


def test_explicit_meshes_are_compared_at_a_stable_step(sagging):
    """The scene's step is stable on its own mesh, but not on the finest."""
    sagging["time"] = {"duration": 0.3, "step": 2.5e-4, "integrator": "verlet"}
    with pytest.raises(der.DerError):
        der.run(sagging | {"rods": [sagging["rods"][0] | {"nodes": 81}]})
    verification = der.verify(sagging)
    assert verification["sag"].space.order == pytest.approx(2.0, abs=0.2)
    assert verification["sag"].time.error_bar < 1e-2 * verification["sag"].space.error_bar
    assert verification.notes == ()


def test_tolerance_is_refined_in_place_of_the_step(sagging):
    sagging["time"] = {"duration": 0.3, "tolerance": 1e-3}
    sagging["output"]["every"] = 0.1
    verification = der.verify(sagging)
    assert verification.steps == ("tolerance 0.001", "tolerance 0.00025", "tolerance 6.25e-05")
    sag = verification["sag"]
    finest = der.run(
        sagging | {"time": {"duration": 0.3, "step": 1e-4, "integrator": "implicit_midpoint"}}
    )
    assert abs(sag.value - finest.probes["sag"][-1]) <= sag.time.error_bar + sag.solver
    assert sag.time.error_bar < 1e-2


def test_automatic_step_is_refined_from_what_it_was(sagging):
    sagging["time"] = {"duration": 0.3, "step": "auto", "integrator": "verlet"}
    verification = der.verify(sagging)
    steps = [float(step.removesuffix(" s")) for step in verification.steps]
    assert steps[0] == pytest.approx(der.run(sagging).summary["step"], rel=1e-3)
    assert steps == pytest.approx([steps[0], steps[0] / 2, steps[0] / 4], rel=1e-3)
    assert not verification["sag"].flagged


def test_two_levels(arm):
    verification = der.verify(arm, levels=2, jobs=1)
    assert verification.meshes == ("21 nodes", "41 nodes")
    assert verification["tip"].verdict == "two levels in space"
    assert not verification.flagged
    assert verification.order_not_measured == list(verification.values)
    assert "The order of all 1 values was not measured (" in str(verification)
    assert "converge at" not in str(verification)
    assert verification.to_dict()["converged"] is False
    for name in ("top", ("tip", "mean"), 5):
        with pytest.raises(KeyError, match=r"there is no value .*; there are: \('tip', 'final'\)"):
            verification[name]
    with pytest.raises(ValueError, match="levels"):
        der.verify(arm, levels=4)
    with pytest.raises(ValueError, match="jobs"):
        der.verify(arm, jobs=0)


def test_two_levels_do_not_hide_what_is_flagged(tube):
    verification = der.verify(tube, levels=2)
    assert verification["deflection"].verdict == "damped in time"
    rows = [
        line for line in str(verification).splitlines() if "converged" in line or " in " in line
    ]
    rows = [line for line in rows if line.startswith(("deflection", "roller"))]
    flagged = len(verification.flagged)
    assert f"{flagged} of {len(rows)} values do not converge" in str(verification)


def test_nothing_refined_is_nothing_measured(arm):
    arm["loads"][0]["point_force"]["at"] = "all"
    verification = der.verify(arm)
    assert not verification.flagged
    assert "The order of all 1 values was not measured (" in str(verification)


def test_summary_counts_the_rows_of_the_table(sagging):
    text = str(der.verify(sagging))
    rows = [line for line in text.splitlines() if line.startswith("sag")]
    assert len(rows) < 3
    assert f"All {len(rows)} values converge at the expected order" in text
    assert f"(extremes at the start or the end, not shown: {3 - len(rows)}; " in text


def estimate(verdict, error_bar):
    return ErrorEstimate(0.0, error_bar, None, 2.0, verdict)


@pytest.mark.parametrize(
    ("error_bar", "verdict"),
    [(0.9e-7, "converged"), (1.1e-7, "diverging in time"), (math.inf, "diverging in time")],
)
def test_negligible_parts_are_not_flagged_but_stay_in_the_bar(error_bar, verdict):
    space = estimate("exact", 1e-10)
    time = estimate("diverging", error_bar)
    value = VerifiedValue("tip", "max", "m", 1.0, 0.0, space, time, 0.0, negligible=1e-7)
    assert (value.verdict, value.flagged) == (verdict, verdict != "converged")
    assert value.error_bar == 1e-10 + error_bar


def exact_value(value, error_bar, verdict="oscillating", **limits):
    part = estimate(verdict, error_bar)
    return VerifiedValue(
        "p", "final", "m", value, 0.0, part, None, 0.0, exact_below=ExactBelow(**limits)
    )


@pytest.mark.parametrize(
    ("value", "error_bar", "verdict"),
    [
        (3.0, 0.9e-9, "exact"),
        (3.0, 1.1e-9, "oscillating in space"),
        (1e-8, 5e-8, "exact"),  # 0 to rounding
        (6e-8, 5e-8, "oscillating in space"),  # small, but not 0
        (1e-8, 2e-6, "oscillating in space"),
        (3.0, math.inf, "oscillating in space"),
    ],
)
def test_values_whose_bar_is_rounding_are_exact(value, error_bar, verdict):
    found = exact_value(value, error_bar, rounding=1e-9, nothing=1e-6)
    assert (found.verdict, found.flagged) == (verdict, verdict != "exact")
    assert found.unsettled == (set() if verdict == "exact" else {"space"})
    assert found.to_dict()["verdict"] == verdict
    assert found.error_bar == error_bar


def test_what_coordinates_leave_of_a_value_is_called_rounding():
    """A tension of 2.3 N with a bar of 2e-3 N, where EA is 1e11 N, is not exact."""
    limits = {"rounding": 1e-9, "nothing": 1e-9, "coordinates": 5e-3}
    for bar, verdict in [(1e-9, "exact"), (2e-3, "rounding"), (6e-3, "oscillating in space")]:
        found = exact_value(2.3, bar, **limits)
        assert (found.verdict, found.is_exact) == (verdict, bar < 6e-3)
        assert found.flagged == (bar == 6e-3)


def test_forces_of_a_rod_that_hardly_stretches_are_known_to_rounding(arm):
    """EA = 1e11 N and a force of 0.3 N along the rod: its strain is 3e-12."""
    stiffness = {"EA": 1e11, "EI": 1.0, "mass_per_length": 1.0}
    arm["rods"][0]["cross_section"] = {"stiffness": stiffness}
    arm["rods"][0].pop("material", None)
    arm["loads"] = [{"point_force": {"rod": "arm", "at": "end", "force": [-0.3, -1.0]}}]
    at = {"rod": "arm", "at": 0.5}
    arm["output"]["probes"] = {name: {**at, "quantity": name} for name in ("tension", "moment")}
    found = der.verify(arm)
    assert not found.flagged
    tension = found["tension"]
    assert tension.verdict == "rounding"
    assert 1e-3 < tension.error_bar < 0.1
    assert found["moment"].verdict == "converged"


def test_exact_values_count_as_measured():
    assert not exact_value(0.0, 1e-12, "two levels", nothing=1e-9).has_two_levels
    alone = VerifiedValue("p", "final", "m", 0.0, 0.0, None, None, 0.0)
    assert alone.verdict == "converged"  # nothing was refined


def test_values_that_are_zero_to_rounding_are_exact_in_every_quantity(arm):
    """A straight rod without load, on a slope so that coordinates have all digits: its curvature is
    rounding over the square of the edges, and shows any order."""
    arm["rods"][0] |= {"nodes": 61, "to": [math.cos(0.7), math.sin(0.7)]}
    del arm["loads"]
    at = {"rod": "arm", "at": "middle"}
    names = ("x", "slope", "curvature", "moment", "tension", "strain")
    probes = {name: {**at, "quantity": name} for name in names}
    probes["reaction"] = {"support": 0, "quantity": "reaction_x"}
    probes["energy"] = {"quantity": "elastic_energy"}
    arm["output"]["probes"] = probes
    found = der.verify(arm)
    verdicts = {value.probe: value.verdict for value in found.values}
    assert {name for name, verdict in verdicts.items() if verdict != "exact"} <= {
        "tension",  # EA times the rounding of coordinates
        "reaction",
    }
    assert set(verdicts.values()) <= {"exact", "rounding"}
    assert not found.flagged
    assert f"All {len(probes)} values converge at the expected order" in str(found)


def test_forces_far_below_the_axial_stiffness_are_not_taken_for_zero(arm):
    """EA is 1e7 N, and 1e-9 of it is much of the force: that of bending is what counts."""
    limits = exact_below(der.run(arm), "N", 1.0)
    assert limits.nothing == pytest.approx(1e-9)  # EI / L^2 is 1 N
    assert max(limits.rounding, limits.coordinates) < 1e-5


def test_positions_far_from_the_origin_are_not_exact_for_it(arm):
    rod = arm["rods"][0]
    rod |= {"from": [1000.0, 0.0], "to": [1001.0, 0.0]}
    limits = exact_below(der.run(arm), "m", 1001.0)
    assert limits.rounding == pytest.approx(1e-9)


def test_what_is_negligible_goes_by_the_way_of_the_probe(swing):
    """Not by its value: far from the origin, a small motion is all that there is."""
    far = json.loads(json.dumps(swing))
    for end in ("from", "to"):
        far["rods"][0][end] = [far["rods"][0][end][0] + 1000.0, far["rods"][0][end][1]]
    limits = []
    for scene in (swing, far):
        scene["output"]["probes"] = {"tip": {"rod": "arm", "at": "end", "quantity": "x"}}
        found = der.verify(scene, levels=2)
        way = found["tip", "max"].value - found["tip", "min"].value
        limits.append(found["tip"].negligible)
        assert limits[-1] == pytest.approx(1e-7 * way)
    assert limits[0] == pytest.approx(limits[1], rel=1e-3)
    assert limits[0] > 0.0


def test_scene_without_probes_gets_some(arm, swing):
    del arm["output"]
    verification = der.verify(arm)
    names = {value.probe for value in verification.values}
    assert names == {"arm_end_x", "arm_end_y", "arm_lowest", "arm_highest"}
    assert any("no probes" in note for note in verification.notes)


def test_a_scene_in_space_without_probes_gets_some_along_z(arm):
    del arm["output"]
    names = {value.probe for value in der.verify({**arm, "model": "spatial_bend"}, levels=2).values}
    ends = {"arm_end_x", "arm_end_y", "arm_end_z"}
    assert names == ends | {"arm_lowest", "arm_highest", "arm_least_z", "arm_greatest_z"}


def test_solver_tolerance_is_part_of_the_bar(sagging):
    sagging["time"]["step"] = 0.05
    sagging["output"]["every"] = 0.05
    exact = der.verify(sagging)["sag"]
    sagging["solver"] = {"residual_tolerance": 1e-1, "step_tolerance": 1e-1}
    loose = der.verify(sagging)["sag"]
    assert loose.solver > 10 * exact.solver
    assert abs(loose.value - exact.extrapolated) <= loose.error_bar + exact.error_bar


def test_failed_finer_run_is_flagged_with_a_note(arm, monkeypatch):
    """A finer mesh that cannot be run leaves two levels; the finest alone none."""
    original = der.accuracy.verification_runs.Workers.run

    def fail_on_finer_meshes(self, tasks, **options):
        outcomes = original(self, tasks, **options)
        error = der.NotConvergedError("no convergence")
        return {
            key: type(outcome)(None, error, 0.0) if key == ("space", 1) else outcome
            for key, outcome in outcomes.items()
        }

    monkeypatch.setattr(der.accuracy.verification_runs.Workers, "run", fail_on_finer_meshes)
    verification = der.verify(arm)
    assert verification["tip"].verdict == "failed in space"
    assert math.isinf(verification["tip"].error_bar)
    assert math.isnan(verification["tip"].extrapolated)
    (row,) = [line for line in str(verification).splitlines() if line.startswith("tip ")]
    assert re.fullmatch(r"tip +\S+ m +± unknown +unknown +- +- +-, - +failed in space", row)
    assert any("41 nodes failed: no convergence" in note for note in verification.notes)
    json.dumps(verification.to_dict(), allow_nan=False)


@pytest.mark.parametrize("scene", [None, 3, ["arm.yaml"]])
def test_what_is_no_scene_is_a_clear_error(scene):
    with pytest.raises(TypeError, match="path of a scene file, or a dict with its keys, got"):
        der.verify(scene)


@pytest.mark.parametrize("given", [{"jobs": 1.5}, {"jobs": "2"}, {"levels": 2.0}])
def test_numbers_of_levels_and_jobs_are_whole(arm, given):
    ((name, value),) = given.items()
    with pytest.raises(TypeError, match=f"{name} must be a whole number.*, got {value!r}"):
        der.verify(arm, **given)


def test_scene_that_fails_is_a_clear_error(unstable):
    with pytest.raises(der.DerError, match="drag"):
        der.verify(unstable)


def test_progress_runs_to_the_end(swing):
    seen = []
    der.verify(swing, progress=seen.append)
    assert min(seen) > 0.0
    assert seen[-1] == max(seen) == pytest.approx(1.0)
    # The first run tells how much there is to do: before its end the share is a guess.
    assert seen[2:] == sorted(seen[2:])


def test_minimum_step_does_not_stand_in_the_way(swing):
    swing["time"]["minimum_step"] = 0.002
    scenario = der.Scenario.from_dict(swing)
    assert der.verify(scenario)["tip"].time.order == pytest.approx(1.0, abs=0.1)
    assert "tolerance" not in with_time(scenario, tolerance=None).to_dict()["time"]


@pytest.mark.parametrize(
    ("value", "error_bar", "text"),
    [
        (-0.30177, 7.1e-5, "-0.301770"),
        (0.0, 1e-3, "0"),
        (-7.6e-9, 1.5e-8, "-8e-09"),
        (1234.5, 20.0, "1234"),
        (2.0, math.inf, "2"),
    ],
)
def test_digits_follow_the_bar(value, error_bar, text):
    assert with_digits_of(value, error_bar) == text


# The command.


@pytest.fixture
def scene_file(arm, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(der.Scenario.from_dict(arm).to_yaml())
    return path


def test_command_prints_a_table_and_writes_json(scene_file, tmp_path, capsys):
    out = tmp_path / "arm.json"
    assert main(["verify", str(scene_file), "--json", str(out), "--jobs", "1"]) == 0
    printed = capsys.readouterr()
    assert "tip" in printed.out
    assert "±" in printed.out
    assert "converge at the expected order" in printed.out
    assert printed.err == ""  # no progress where no one is looking
    found = json.loads(out.read_text())
    assert found["converged"] is True
    assert found["values"][0]["space_error"]["order"] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("nodir/x.json", "there is no folder nodir; make it first"),
        (".", "it is a folder; name a file in it"),
    ],
)
def test_json_that_cannot_be_written_is_refused_before_the_work(
    scene_file, monkeypatch, tmp_path, capsys, name, words
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as caught:
        main(["verify", str(scene_file), "--json", name])
    assert caught.value.code == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert f"argument --json: cannot write {name}: {words}" in printed.err


def test_json_where_one_may_not_write_is_refused(scene_file, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    with pytest.raises(SystemExit):
        main(["verify", str(scene_file), "--json", str(tmp_path / "x.json")])
    assert "not permitted" in capsys.readouterr().err


def test_exit_codes(tube, unstable, tmp_path, capsys):
    flagged, failing, wrong = (tmp_path / f"{i}.yaml" for i in range(3))
    flagged.write_text(der.Scenario.from_dict(tube).to_yaml())
    failing.write_text(der.Scenario.from_dict(unstable).to_yaml())
    wrong.write_text("title: nothing")
    assert main(["verify", str(flagged)]) == 5
    assert "analysis: static" in capsys.readouterr().out
    assert main(["verify", str(failing)]) == 3
    assert "error: " in capsys.readouterr().err
    assert main(["verify", str(wrong)]) == 1


# Analyses that find more than probes.


def test_a_path_is_verified_by_its_events_and_its_end(column):
    column["analysis"] = {"continuation": {"to": 50, "branches": 1, "points": 40}}
    found = der.verify(column)
    assert [value.label for value in found.values] == [
        "factor, bifurcation 1",
        "end_x, bifurcation 1",
        "factor, bifurcation 2",
        "end_x, bifurcation 2",
        "end_x, end",
    ]
    assert not found.flagged
    for number in (1, 2):
        value = found["factor", f"bifurcation {number}"]
        exact = (number * np.pi) ** 2
        assert abs(value.value - exact) <= value.error_bar <= 2 * abs(value.value - exact)
        assert value.extrapolated == pytest.approx(exact, rel=1e-4)
        assert value.space.order == pytest.approx(2.0, abs=0.1)
    assert "factor, bifurcation 1" in str(found)


def test_an_event_that_finer_meshes_do_not_find_is_flagged(column):
    column["analysis"] = {"continuation": {"to": 9.86}}
    found = der.verify(column)
    event = found["factor", "bifurcation 1"]
    assert (event.verdict, event.error_bar) == ("unmatched in space", math.inf)
    assert event.value == pytest.approx(9.8493, abs=1e-4)
    assert not found["end_x", "end"].flagged
    (note,) = found.notes
    assert note.startswith(
        "bifurcation: 1 with the scene as written, 1 with a tight tolerance, 0 with 41 nodes"
    )


def test_events_beside_an_unmatched_one_keep_their_bars(column):
    """With 20 elements the third load is 87.7 N, with 40 it is 88.5 N: only two match."""
    column["analysis"] = {"continuation": {"to": 88.0, "points": 80}}
    found = der.verify(column)
    for number in (1, 2):
        value = found["factor", f"bifurcation {number}"]
        assert not value.flagged
        assert abs(value.value - (number * np.pi) ** 2) <= value.error_bar
    assert found["factor", "bifurcation 3"].verdict == "unmatched in space"
    assert [value.what for value in found.flagged] == ["bifurcation 3"] * 2


def test_events_are_matched_by_their_place():
    places = [{"factor": f, "top": t} for f, t in ((0.2, 0.0), (0.5, 0.4), (0.9, 0.9))]
    moved = [{"factor": p["factor"] + 0.02, "top": p["top"] - 0.01} for p in places]
    assert match_places(places, moved) == {0: 0, 1: 1, 2: 2}
    assert match_places(places, [moved[0], {"factor": 0.22, "top": 0.9}, *moved[1:]]) == {
        0: 0,
        2: 1,
        3: 2,
    }
    assert match_places(places, moved[1:]) == {0: 1, 1: 2}
    assert match_places(places, []) == match_places([], places) == {}


def test_an_event_that_only_finer_meshes_find_is_flagged(column):
    column["analysis"] = {"continuation": {"to": 9.86}}
    coarse = der.Scenario.from_dict(column)
    fine = with_elements(coarse, 2)
    runs = VerificationRuns(der.run(fine), meshes=["41 nodes", "21 nodes"])
    runs.results = {("time", 0): runs.base, ("space", 0): runs.base, ("space", 1): der.run(coarse)}
    values = Evaluation(runs).values()
    event = next(v for v in values if v.label == "factor, bifurcation 1")
    assert math.isnan(event.value)
    assert event.flagged
    assert event.to_dict()["value"] is None
    found = Verification(fine, (event,), (), (), (), (), 0.0)
    assert str(found).splitlines()[3].split()[:4] == ["factor,", "bifurcation", "1", "-"]
    assert len(Evaluation(runs).notes(values)) == 1


def test_a_path_that_stops_before_its_last_factor_has_no_end(column):
    column["analysis"] = {"continuation": {"to": 50, "points": 8}}
    assert [v.label for v in der.verify(column).values if v.what == "end"] == []


def test_frequencies_have_bars(column):
    """f = 1/(2 pi) sqrt(((k pi)^4 EI - P (k pi)^2) / m) of a pinned beam under P = 1 N."""
    column["analysis"] = {"modes": {"count": 3}}
    del column["output"]
    found = der.verify(column)
    assert [(v.probe, v.what, v.unit) for v in found.values] == [
        (f"frequency {k}", "final", "Hz") for k in (1, 2, 3)
    ]
    assert found.notes == ()
    for k in (1, 2, 3):
        exact = np.sqrt(((k * np.pi) ** 4 - (k * np.pi) ** 2) / 0.1) / (2 * np.pi)
        value = found[f"frequency {k}"]
        assert 0 < abs(value.value - exact) <= value.error_bar
        assert not value.flagged


def test_buckling_loads_have_bars(column):
    column["analysis"] = {"buckling": {"count": 3}}
    found = der.verify(column)
    for k in (1, 2, 3):
        value = found[f"load factor {k}"]
        error = abs(value.value - (k * np.pi) ** 2)
        assert error <= value.error_bar <= 3 * error
        assert value.extrapolated == pytest.approx((k * np.pi) ** 2, rel=1e-3)
    assert not found.flagged


def test_warnings_of_the_run_are_told(column):
    """A column that buckles out of its plane first; and the bars of where it does."""
    stiffness = column["rods"][0]["cross_section"]["stiffness"]
    EI = stiffness.pop("EI")
    stiffness.update({"EI1": EI / 4, "EI2": EI, "GJ": EI})
    column["analysis"] = {"continuation": {"to": 5.0}}
    found = der.verify(column)
    (warning,) = found.warnings
    assert "the path leaves its plane" in warning
    assert f"Warning: {warning.rstrip('.')}." in str(found)
    assert found.to_dict()["warnings"] == [warning]
    factor = found["factor", "out_of_plane 1"]
    # Pinned in the plane, held upright by a fork out of it: pi^2 EI1 / L^2 of a pinned column.
    assert abs(factor.value - np.pi**2 * EI / 4) < factor.error_bar + 1e-3


@pytest.mark.parametrize("dim", [1, 2])
def test_lists_that_jump_keep_both_sides_on_finer_meshes(dim):
    """Linear on either side; the node has their mean, weighted by its two edges."""
    nodes, jump = np.arange(13.0), 6
    lines = [1.0 + 0.1 * nodes, 5.0 - 0.2 * nodes]
    values = np.where(nodes < jump, *lines)
    values[jump] = 0.4 * lines[0][jump] + 0.6 * lines[1][jump]
    given = values if dim == 1 else np.column_stack([values, 0.5 * values])
    finer = resample_list(given, 24)
    places = np.linspace(0.0, 12.0, 25)
    exact = np.where(places < jump, 1.0 + 0.1 * places, 5.0 - 0.2 * places)
    exact[2 * jump] = values[jump]
    found = finer if dim == 1 else finer[:, 0]
    assert found == pytest.approx(exact, abs=1e-12)
    # The value of one side at the node is a jump beside it, which nobody can place better.
    values[jump] = lines[1][jump]
    one_sided = resample_list(values, 24)
    assert lines[0][jump - 1] < one_sided[2 * jump - 1] < values[jump]


def test_bars_of_a_rod_whose_natural_curvature_jumps():
    """The end of a straight leg and of an arc of radius 1/2, each half of the rod."""
    nodes, jump = 21, 10
    curvature = [*[0.0] * jump, 1.0, *[2.0] * (nodes - 1 - jump)]
    rod = {**ARM["rods"][0], "nodes": nodes, "natural_curvature": curvature}
    end = {"rod": "arm", "at": "end"}
    output = {"probes": {name: {**end, "quantity": name} for name in ("x", "y", "slope")}}
    found = der.verify(
        {
            "rods": [rod],
            "supports": [{"rod": "arm", "at": "start", "clamp": True}],
            "analysis": "static",
            "output": output,
        }
    )
    length = ARM["rods"][0]["to"][0]
    arc = 0.5 * length
    exact = {"x": arc + np.sin(2 * arc) / 2, "y": (1 - np.cos(2 * arc)) / 2, "slope": 2 * arc}
    for name, value in exact.items():
        assert abs(found[name].value - value) <= found[name].error_bar + 1e-12, name
        assert abs(found[name].extrapolated - value) <= 0.2 * found[name].error_bar + 1e-9, name


@pytest.mark.parametrize("direction", [[0.6, 0.8], [0.8, -0.6], [0.28, 0.96]])
def test_forces_of_a_rod_that_bends_easily_are_exact_to_rounding_away_from_the_origin(direction):
    """A straight rod in tension: the reaction is the force; EI/l^3 times rounding of x is left."""
    start = np.array([1.3, -0.7])
    end = start + direction
    stiffness = {"EA": 1e3, "EI": 1, "mass_per_length": 1}
    line = {"name": "rod", "nodes": 39, "from": start.tolist(), "to": end.tolist()}
    force = (0.4 * np.array(direction)).tolist()
    reaction = {"support": 0, "quantity": "reaction_x"}
    scene = {
        "rods": [{**line, "cross_section": {"stiffness": stiffness}}],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "loads": [{"point_force": {"rod": "rod", "at": "end", "force": force}}],
        "analysis": "static",
        "output": {"probes": {"reaction": reaction}},
    }
    found = der.verify(scene)["reaction"]
    assert found.verdict in ("exact", "rounding")
    assert found.value == pytest.approx(-force[0], abs=1e-8)
