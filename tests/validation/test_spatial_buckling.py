"""Loads at which straight and planar equilibria become unstable in space, found by the count of
unstable directions, or by the answer to a seed. References: `references/spatial_buckling.py`.
"""

import numpy as np
import pytest
from scenes import END, START, tip_force
from spatial_scenes import critical, measured, section, straight_rod

SIZES = [10, 20, 40]
SLENDER = 1e7  # EA


def unstable(scene):
    analysis = {"static": {"stability": "any"}}
    _, result = measured({**scene, "analysis": analysis}, ["end"], ["x"])
    return result.summary["stability"] == "unstable"


@pytest.mark.parametrize("case", ["weak0.01.GJ0.01", "weak0.1.GJ0.2"])
def test_lateral_torsional_buckling(spatial_reference, fitted_order, case):
    """A cantilever bent across its weak direction, the bending before buckling included."""
    weak = spatial_reference("spatial_buckling", f"lateral.{case}.EI_weak")
    twisting = spatial_reference("spatial_buckling", f"lateral.{case}.GJ")
    exact = spatial_reference("spatial_buckling", f"lateral.{case}")
    strip = section([0, 1, 0], EA=SLENDER, EI1=1.0, EI2=weak, GJ=twisting)
    errors = []
    for n in SIZES:

        def is_unstable(load, n=n):
            force = load * np.sqrt(weak * twisting)
            return unstable(straight_rod(n, strip, loads=tip_force(0, force, 0)))

        errors.append(critical(is_unstable, 0.9 * exact, 1.1 * exact, 1e-7) / exact - 1)
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9
    assert np.abs(errors[-1]) < 2e-3


def test_a_seed_grows_beyond_lateral_torsional_buckling(spatial_reference):
    """A force of 1e-4 of the load across the plane. Below the critical load the deflection follows
    that seed, above it is large, and both sides are equal."""
    exact = spatial_reference("spatial_buckling", "lateral.weak0.1.GJ0.1") * 0.1
    strip = section([0, 1, 0], EA=SLENDER, EI1=1.0, EI2=0.1, GJ=0.1)

    def deflection(share, seed):
        scene = straight_rod(20, strip, loads=tip_force(0, share * exact, seed * share * exact))
        values, result = measured(scene, ["end"], "z")
        assert result.summary["stability"] == "stable"
        return values[0, 0]

    assert abs(deflection(0.8, 1e-4)) < 1e-3
    assert abs(deflection(1.2, 1e-4)) > 0.3
    assert deflection(1.2, -1e-4) == pytest.approx(-deflection(1.2, 1e-4), rel=1e-6)


@pytest.mark.parametrize("thrust", [-20, 0, 20])
def test_greenhill(spatial_reference, fitted_order, thrust):
    """Both ends clamped, one turned about the straight rod under thrust: the torque M L/EI."""
    exact = spatial_reference("spatial_buckling", f"twist.clamped.thrust{thrust}")
    rod = section(EA=SLENDER, EI=1.0, GJ=2.0)
    errors = []
    for n in SIZES:

        def is_unstable(torque, n=n):
            motion = {"x": -thrust / SLENDER, "twist": torque / 2.0}
            supports = [{**START, "clamp": True}, {**END, "clamp": True, "prescribe": motion}]
            return unstable(straight_rod(n, rod, supports=supports))

        errors.append(critical(is_unstable, 0.8 * exact, 1.1 * exact, 1e-7) / exact - 1)
    assert fitted_order([1 / n for n in SIZES], errors) > 1.9
    assert np.abs(errors[-1]) < 0.02


@pytest.mark.parametrize("thrust", [-5, 0, 5])
@pytest.mark.parametrize("ends", ["axial", "tangential"])
def test_greenhill_with_hinged_ends(spatial_reference, fitted_order, ends, thrust):
    """Greenhill 1883: 2 pi EI/L without thrust, whether the moments are vectors along the axis or
    follow the tangents. Such moments have no potential and the verdict is `not_judged`, so that
    the critical moment is the one at which the answer to a seed grows beyond all bounds: the zero
    of one over that answer, a smooth function of the moment, by a cubic through four moments."""
    exact = spatial_reference("spatial_buckling", f"twist.{ends}.thrust{thrust}")
    if thrust == 0:
        assert exact == pytest.approx(2 * np.pi, rel=1e-12)
    rod = section(EA=SLENDER, EI=1.0, GJ=2.0)
    supports = [
        {**START, "fix": ["x", "y", "z"]},
        {**END, "fix": ["y", "z"]},
        # Hinges leave the rod free to spin, which this holds without any torque.
        {"rod": "rod", "at": "middle", "spring": {"rotational_stiffness": [0, 0, 10]}},
    ]
    follows = {"follower": True} if ends == "tangential" else {}
    seed = {"point_force": {"rod": "rod", "at": 0.3, "force": [0, 1e-6, 0]}}
    push = {"point_force": {**END, "force": [-thrust, 0, 0]}}
    shares = np.array([0.9, 0.93, 0.96, 0.98])
    sizes, errors = [20, 40, 80], []
    for n in sizes:
        inverse = []
        for moment in shares * exact:
            moments = [
                {"moment": {**place, "moment": [sign * moment, 0, 0], **follows}}
                for place, sign in ((START, -1), (END, 1))
            ]
            scene = straight_rod(n, rod, supports=supports, loads=[*moments, push, seed])
            values, result = measured(scene, ["middle"], "yz")
            assert result.summary["stability"] == "not_judged"
            inverse.append(1 / np.linalg.norm(values))
        zeros = np.roots(np.polyfit(shares, inverse, 3))
        errors.append(zeros[np.argmin(np.abs(zeros - 1))].real - 1)
    assert fitted_order([1 / n for n in sizes], errors) >= 1.9
    assert np.abs(errors[-1]) < 1e-3
