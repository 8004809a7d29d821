"""The direction of an actuated rod between its edges: slopes and tangents, loads that follow the
rod, and the work of moments.

References: integrals of the profiles; the elastica and the Kirchhoff rod under loads that are known
in the axes of their end, which are initial value problems from there; a moment times the turn of
its place.
"""

from itertools import pairwise

import der
import numpy as np
import pytest
from actuated import PROFILES, bend, probed
from references.kirchhoff_rod import UPRIGHT
from scenes import END, straight
from scipy.integrate import quad, solve_ivp
from spatial_scenes import section, straight_rod

CURVATURE = 2.5
#: Meshes on which the thirds and the ninths lie at the same part of their edges.
ALIKE = [38, 74, 146]
ALIKE_STEPS = [1 / n for n in ALIKE]
STRETCHES = [(0.0, 1.0), (0.33, 0.68), (0.0, 0.777), (0.313, 1.0), (0.503, 0.511)]


def turn_until(s, start, end, profile):
    """The angle [rad] of the curve of curvature `CURVATURE` times the profile, from its start."""
    value = quad(
        lambda r: PROFILES[profile]((r - start) / (end - start)), start, np.clip(s, start, end)
    )
    return CURVATURE * value[0]


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("ends", STRETCHES)
@pytest.mark.parametrize("edges", [5, 20])
def test_slope_without_stress(edges, ends, profile):
    """Is that of the curve at any place, beside clamps and borders too."""
    scene = straight(edges, "clamped-free", actuation=[bend(CURVATURE, *ends, profile=profile)])
    scene["supports"] = [{"rod": "rod", "at": {"node": 2}, "clamp": True}]
    origin = turn_until(2 / edges, *ends, profile)
    places = [0.0, 0.01, 0.09, 0.1, 0.11, 0.2, 0.327, 0.33, 0.34, 0.41, 0.507, 0.68, 0.9, 0.97, 1.0]
    found = probed(scene, [(s, "after") for s in places], ["slope"])[:, 0]
    exact = [turn_until(s, *ends, profile) - origin for s in places]
    assert found == pytest.approx(np.array(exact), abs=1e-9)


def test_slope_beside_a_clamp_lies_within_its_bar():
    """Where the meshes that make the bar end the stretch in different parts of their edges."""
    scene = straight(10, "clamped-free", 1e6, actuation=[bend(2.0, 0.0, 0.68)])
    scene["output"] = {
        "probes": {
            f"s{100 * s:.0f}": {"rod": "rod", "at": s, "quantity": "slope"} for s in (0.01, 0.66)
        }
    }
    verification = der.verify(scene)
    for s in (0.01, 0.66):
        slope = verification[f"s{100 * s:.0f}"]
        assert abs(slope.value - 2.0 * s) <= slope.error_bar + 1e-12
        assert slope.error_bar < 1e-9


# ---- under loads at the end

FORCE = np.array([0.3, 1.0])


def elastica(ends, profile, places):
    """Slopes at the places of a clamped elastica with EI = 1 under a force that follows its end,
    the end's position, and that force in fixed axes: from the end on, where the force is known.
    """
    start, end = ends

    def slopes(s, u):
        angle, moment, _, _ = u
        inside = start <= s < end
        k = CURVATURE * PROFILES[profile]((s - start) / (end - start)) if inside else 0.0
        cos, sin = np.cos(angle), np.sin(angle)
        return [k + moment, -(cos * FORCE[1] - sin * FORCE[0]), cos, sin]

    u = np.zeros(4)
    cuts = np.unique([0.0, *ends, *places, 1.0])
    angles = {1.0: 0.0}
    for a, b in reversed(list(pairwise(cuts))):
        middle = 0.5 * (a + b)
        inside = start <= middle < end

        def part(s, u, inside=inside):
            return slopes(np.clip(s, start, end - 1e-14) if inside else start - 1.0, u)

        u = solve_ivp(part, (b, a), u, rtol=1e-11, atol=1e-12).y[:, -1]
        angles[a] = u[0]
    turn = -u[0]
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return np.array([angles[s] + turn for s in places]), rotation @ -u[2:], rotation @ FORCE


@pytest.mark.parametrize("follower", [False, True])
@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("ends", [(0.0, 1.0), (1 / 3, 7 / 9), (1 / 3, 1.0)])
def test_slopes_of_an_actuated_rod_under_a_force(fitted_order, ends, profile, follower):
    fixed = [1 / 9, 1 / 3, 2 / 3, 7 / 9, 1.0]
    errors = []
    for n in ALIKE:
        places = [*fixed, 0.3 / n, 0.6 / n, 0.8 / n, 1 - 0.3 / n]
        slopes, tip, force = elastica(ends, profile, places)
        force = FORCE if follower else force
        load = {"point_force": {**END, "force": force.tolist(), "follower": follower}}
        scene = straight(n, "clamped-free", loads=[load])
        scene["actuation"] = [bend(CURVATURE, *ends, profile=profile)]
        found = probed(scene, [(s, "after") for s in places], ["slope"])[:, 0]
        end = der.equilibrium(scene).positions[-1, -1]
        errors.append([np.abs(found - slopes).max(), np.linalg.norm(end - tip)])
    for column in np.transpose(errors):
        assert fitted_order(ALIKE_STEPS, column) > 1.9, column


STIFFNESS = {"EI1": 3.0, "EI2": 1.0, "GJ": 0.8}
FORCE_3D, MOMENT_3D = np.array([0.6, -0.8, 1.1]), np.array([0.7, 0.5, -0.4])
STRAINS = np.array([1.3, -0.8, 2.1])


def kirchhoff_rod(ends, places):
    """Tangents at the places of a clamped rod under a force and a moment that follow its end, the
    end's position, and the loads in fixed axes: from the end on, where both are known.
    """

    def slopes(_s, u, natural):
        frame, place = u[:9].reshape(3, 3), u[9:]
        moment = frame.T @ (MOMENT_3D - np.cross(place, FORCE_3D))
        about = natural + moment / [STIFFNESS["EI2"], STIFFNESS["EI1"], STIFFNESS["GJ"]]
        cross = np.cross(np.eye(3), about)
        return np.append((frame @ cross).ravel(), frame[:, 2])

    u = np.append(UPRIGHT.ravel(), np.zeros(3))
    frames = {1.0: UPRIGHT}
    cuts = np.unique([0.0, *ends, *places, 1.0])
    k1, k2, twist = STRAINS
    for a, b in reversed(list(pairwise(cuts))):
        inside = ends[0] <= 0.5 * (a + b) < ends[1]
        natural = inside * np.array([-k2, k1, twist])
        u = solve_ivp(slopes, (b, a), u, rtol=1e-11, atol=1e-12, args=(natural,)).y[:, -1]
        frames[a] = u[:9].reshape(3, 3)
    rotation = UPRIGHT @ frames[0.0].T
    tangents = np.array([rotation @ frames[s][:, 2] for s in places])
    return tangents, rotation @ -u[9:], (rotation @ FORCE_3D, rotation @ MOMENT_3D)


@pytest.mark.parametrize("follower", [False, True])
@pytest.mark.parametrize("ends", [(0.0, 1.0), (1 / 3, 7 / 9), (1 / 3, 1.0)])
def test_tangents_of_an_actuated_rod_in_space_under_loads(fitted_order, ends, follower):
    fixed = [1 / 9, 1 / 3, 2 / 3, 7 / 9, 1.0]
    errors = []
    for n in ALIKE:
        places = [*fixed, 0.3 / n, 0.6 / n, 0.8 / n, 1 - 0.3 / n]
        tangents, tip, fixed_loads = kirchhoff_rod(ends, places)
        force, moment = (FORCE_3D, MOMENT_3D) if follower else fixed_loads
        beam = section([0, 1, 0], EA=1e8, **STIFFNESS)
        scene = straight_rod(
            n,
            beam,
            loads=[
                {"point_force": {**END, "force": force.tolist(), "follower": follower}},
                {"moment": {**END, "moment": moment.tolist(), "follower": follower}},
            ],
            actuation=[
                bend(STRAINS[:2].tolist(), *ends),
                {
                    "name": "twist",
                    "rod": "rod",
                    "from": ends[0],
                    "to": ends[1],
                    "natural_twist": STRAINS[2],
                },
            ],
        )
        found = probed(scene, [(s, "after") for s in places], ["tx", "ty", "tz"])
        end = der.equilibrium(scene).positions[-1, -1]
        off = np.linalg.norm(found - tangents, axis=1)
        errors.append([off.max(), np.linalg.norm(end - tip)])
    for column in np.transpose(errors):
        assert fitted_order(ALIKE_STEPS, column) > 1.9, column


def test_force_that_follows_an_end_within_a_stretch_shorter_than_an_edge():
    """The last fiftieth of the rod twists by 0.8 rad, and turns the force with it."""
    beam = section([0, 1, 0], EA=1e5, EI1=1.0, EI2=1.0, GJ=1.0)
    force = 1e-3
    twist = {"name": "twist", "rod": "rod", "from": 0.98, "to": 1.0, "natural_twist": 40.0}
    scene = straight_rod(
        5,
        beam,
        loads=[{"point_force": {**END, "force": [0, force, 0], "follower": True}}],
        actuation=[twist],
        output={
            "probes": {axis: {"quantity": f"reaction_{axis}", "support": 0} for axis in ("y", "z")}
        },
    )
    result = der.run(scene)
    found = np.array([result.probes[axis][-1] for axis in ("y", "z")])
    assert found == pytest.approx(-force * np.array([np.cos(0.8), np.sin(0.8)]), abs=1e-8)


# ---- the work of moments


def works(scene, moment, actuation):
    """Works on a rod that a smooth table moves from one equilibrium to another."""
    result = der.run(
        scene
        | {
            "loads": [
                {"moment": {**END, "moment": moment}},
                {"damping": {"coefficient": 5.0}},
            ],
            "actuation": [actuation],
            "start_from": "equilibrium",
            "time": {"duration": 8.0, "step": 0.02},
        }
    )
    return {name: values[-1] for name, values in result.work.items()}


SMOOTH = {"times": [0, 1], "values": [0, 2], "smooth": True}


@pytest.mark.parametrize("ends", [(0.0, 1.0), (0.9, 1.0), (0.33, 0.68), (0.97, 1.0)])
def test_work_of_a_moment_at_an_end_that_is_bent(ends):
    """Is the moment times the turn of the end, which is that of the actuation."""
    scene = straight(10, "clamped-free", 1e4)
    del scene["analysis"]
    work = works(scene, 1.0, bend(SMOOTH, *ends))
    turn = 2 * (ends[1] - ends[0])
    # The steps leave 1e-4, by the order 2 of the midpoint rule.
    assert work["loads"] == pytest.approx(turn, abs=2e-4)


@pytest.mark.parametrize("ends", [(0.0, 1.0), (0.9, 1.0), (0.33, 0.68)])
@pytest.mark.parametrize("axis", ["twist", "bend"])
def test_work_of_a_moment_at_an_end_that_is_turned_in_space(ends, axis):
    beam = section([0, 1, 0], EA=1e4, EI1=1.0, EI2=1.0, GJ=1.0, rotary_inertia=1e-4)
    scene = straight_rod(10, beam)
    del scene["analysis"]
    key = {"twist": "natural_twist", "bend": "natural_curvature"}[axis]
    value = SMOOTH
    moment = {"twist": [1.0, 0, 0], "bend": [0, 0, 1.0]}[axis]
    actuation = {"name": "a", "rod": "rod", "from": ends[0], "to": ends[1], key: value}
    work = works(scene, moment, actuation)
    assert work["loads"] == pytest.approx(2 * (ends[1] - ends[0]), abs=2e-4)
