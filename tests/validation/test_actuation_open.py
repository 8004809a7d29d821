"""Numbers of actuated rods that are not yet what they should be: each test here fails.

References as in `test_actuation.py` and `test_actuation_in_space.py`.
"""

import der
import numpy as np
import pytest
from actuated import PROFILES, bend, probed, stretch
from references.actuated_rod import Segment, clamped, pulled, solve
from scenes import straight, tip_force
from test_actuation import (
    ALIKE,
    ALIKE_STEPS,
    CURVATURE,
    FORCE,
    PARTS,
    SLENDER,
    by_hand,
    profile_curvature,
    segments_of,
    sides,
)
from test_actuation import QUANTITIES as PLANAR
from test_actuation_in_space import (
    CURVATURES,
    PLACES,
    STRAINS,
    TWIST,
    actuated,
    by_shooting,
    ring,
    twist,
)
from test_actuation_in_space import FORCE as SPATIAL_FORCE


@pytest.mark.parametrize("profile", ["constant", "linear"])
def test_tension_where_the_curvature_jumps(fitted_order, profile):
    """Its slope jumps there, by the shear force times the jump: now an error of order 1."""
    ends = PARTS["inner"]
    curvature = profile_curvature(profile, *ends)
    exact = solve(
        segments_of(curvature, ends, [0.0, *ends, 1.0]), clamped(), pulled(FORCE), EA=SLENDER
    )
    inside, beyond = sides(*ends)
    errors = []
    for n in ALIKE:
        scene = straight(n, "clamped-free", SLENDER, loads=tip_force(*FORCE))
        scene["actuation"] = [bend(CURVATURE, *ends, profile=profile)]
        found = probed(scene, inside + beyond, PLANAR) - by_hand(exact, inside + beyond)
        errors.append(np.abs(found[:, PLANAR.index("tension")]).max())
    assert fitted_order(ALIKE_STEPS, errors) > 1.9


def test_probes_where_the_elongation_jumps(fitted_order):
    """Nodes are right; positions, moments and curvatures within the edge are of order 1."""
    ends, share = PARTS["inner"], 0.3
    segments = [
        Segment(0.0, ends[0]),
        Segment(*ends, elongation=lambda s: share),
        Segment(ends[1], 1.0),
    ]
    exact = solve(segments, clamped(), pulled(FORCE), EA=SLENDER)
    inside, beyond = sides(*ends)
    errors = []
    for n in ALIKE:
        scene = straight(n, "clamped-free", SLENDER, loads=tip_force(*FORCE))
        scene["actuation"] = [stretch(share, *ends)]
        found = probed(scene, inside + beyond, PLANAR) - by_hand(exact, inside + beyond)
        errors.append(np.abs(found).max(axis=0))
    for quantity, column in zip(PLANAR, np.transpose(errors), strict=True):
        assert fitted_order(ALIKE_STEPS, column) > 1.9, quantity


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_moment_at_the_clamp_of_a_rod_that_is_longer(fitted_order, share):
    """By a load (0.0 and EA = 100: an error older than actuation) or by elongation there."""
    EA = SLENDER if share else 100.0
    segment = Segment(0.0, 1.0, elongation=lambda s: share)
    exact = solve([segment], clamped(), pulled((5.0, 3.0)), EA=EA)
    errors = []
    for n in ALIKE:
        scene = straight(n, "clamped-free", EA, loads=tip_force(5.0, 3.0))
        if share:
            scene["actuation"] = [stretch(share, 0.0, 1.0)]
        places = [(0.0, "after"), (0.3 / n, "after")]
        found = probed(scene, places, PLANAR) - by_hand(exact, places)
        errors.append(np.abs(found[:, PLANAR.index("moment")]).max())
    assert fitted_order(ALIKE_STEPS, errors) > 1.9


@pytest.mark.parametrize("kind", ["curvature", "twist"])
def test_moments_in_space_where_the_rest_shape_jumps(fitted_order, kind):
    """Moments and torque are components in the section, which turns with a kink there."""
    ends = (1 / 3, 7 / 9)
    own = {"curvature": [-CURVATURES[1], CURVATURES[0], 0.0], "twist": [0.0, 0.0, TWIST]}[kind]
    exact, _ = by_shooting([np.zeros(3), np.array(own), np.zeros(3)], PLACES)
    acts = {"curvature": bend(list(CURVATURES), *ends), "twist": twist(TWIST, *ends)}[kind]
    errors = []
    for n in ALIKE:
        scene = actuated(n, acts, loads=tip_force(*SPATIAL_FORCE))
        errors.append(np.abs(probed(scene, PLACES, STRAINS) - exact)[2:6].max(axis=0))
    for quantity, column in zip(STRAINS, np.transpose(errors), strict=True):
        assert fitted_order(ALIKE_STEPS, column) > 1.9, quantity


@pytest.mark.parametrize("ends", [(0.313, 0.777), (0.503, 0.511)])
def test_curvature_within_a_smooth_stretch(ends):
    """Without stress it is the profile, which `constant` and `linear` give exactly; of `smooth` it
    is read off lines between samples, so that a stretch within an edge seems not to be there.
    """
    middle = 0.5 * (ends[0] + ends[1])
    scene = straight(40, "clamped-free", 1e4)
    scene["actuation"] = [bend(CURVATURE, *ends, profile="smooth")]
    found = probed(scene, [(middle, "after")], ["curvature", "moment"])
    assert found[0, 1] == pytest.approx(0.0, abs=1e-8)
    truth = CURVATURE * PROFILES["smooth"](0.5)
    assert found[0, 0] == pytest.approx(truth, abs=1e-8)


@pytest.mark.parametrize("share", [-0.79, -0.81, -0.95])
def test_a_rod_that_is_free_may_become_much_shorter(share):
    """Without stress; below -0.8 its edges count as crushed, as if they had their drawn length."""
    scene = straight(10, "clamped-free", 1e3, actuation=[stretch(share, 0.0, 1.0)])
    assert der.equilibrium(scene).positions[-1, -1, 0] == pytest.approx(1 + share, abs=1e-9)


def test_a_rod_that_is_free_may_become_much_shorter_in_time():
    """Damped, and so slow that it follows."""
    scene = straight(10, "clamped-free", 1e3)
    del scene["analysis"]
    table = {"times": [0.0, 1.0], "values": [0.0, -0.95]}
    scene |= {
        "actuation": [stretch(table, 0.0, 1.0)],
        "loads": [{"damping": {"coefficient": 20.0}}],
        "time": {"duration": 1.0, "step": 0.005},
    }
    assert der.run(scene).positions[-1, -1, 0] == pytest.approx(0.05, abs=0.02)


def test_elongations_that_do_not_all_overlap_at_one_place():
    """Two at a time: nowhere is the rod shorter than a fifth of its length."""
    parts = [stretch(-0.4, 0.0, 0.3, "a"), stretch(-0.4, 0.6, 1.0, "b"), stretch(-0.4, 0, 1, "c")]
    scene = straight(10, "clamped-free", 1e3, actuation=parts)
    length = 1 - 0.4 * (0.3 + 0.4 + 1.0)
    assert der.equilibrium(scene).positions[-1, -1, 0] == pytest.approx(length, abs=1e-9)


def test_elongations_that_overlap_at_different_times():
    """The sum of two tables is never below -0.6."""
    early = {"times": [0, 0.1, 0.2], "values": [0, -0.6, 0]}
    late = {"times": [0, 0.2, 0.3], "values": [0, 0, -0.6]}
    scene = straight(4, "clamped-free", 1e3)
    del scene["analysis"]
    scene["actuation"] = [stretch(early, 0.0, 1.0, "early"), stretch(late, 0.0, 1.0, "late")]
    der.Scenario.from_dict(scene | {"time": {"duration": 0.3, "step": 0.01}})


@pytest.mark.parametrize("first", range(0, 24, 3))
def test_ring_that_nothing_holds_finds_its_equilibrium(first):
    """Wherever its drawing begins; now some runs end with 'forces balance to their rounding error,
    and that hides the shape' (also without actuation, where natural curvatures differ by node).
    """
    scene, _ = ring(24, first, (0.137, 0.613), "planar", elongation=0.3)
    scene["supports"] = []
    assert der.run(scene, check=False).status == "static_converged"
