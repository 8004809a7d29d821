"""Frequencies of rods in space against `references/spatial_frequencies.py` and closed forms."""

import der
import numpy as np
import pytest
from references.spatial_frequencies import blade
from scenes import END, START
from spatial_scenes import rod_through, section, straight_rod

SIZES = [16, 32, 64]
FINE = [32, 64, 128]
CLAMP = [{**START, "clamp": True}]
SUPPORTS = {"clamped-free": CLAMP, "clamped-clamped": [*CLAMP, {**END, "clamp": True}]}
SUPPORTS["free-free"] = []


def frequencies(scene, count):
    """Angular frequencies [rad/s]."""
    scene = {**scene, "analysis": {"modes": {"count": count}}}
    return 2 * np.pi * np.array(der.run(scene).summary["frequencies_hz"])


@pytest.mark.parametrize("ends", list(SUPPORTS))
def test_torsion_of_a_bar(fitted_order, ends):
    """omega = k pi sqrt(GJ/j)/L, with k - 1/2 in place of k if one end is free."""
    stiff = section(EA=1e8, EI1=1e4, EI2=3e4, GJ=2.0, rotary_inertia=0.01)
    waves = np.arange(1, 4) - (0.5 if ends == "clamped-free" else 0.0)
    exact = waves * np.pi * np.sqrt(2.0 / 0.01)
    errors = []
    for n in SIZES:
        found = frequencies(straight_rod(n, stiff, supports=SUPPORTS[ends]), 9)
        moving = found[found > 1e-2]
        # The bar bends and stretches at higher frequencies: all of these are of torsion.
        errors.append(moving[:3] / exact - 1)
    for of_mode in np.array(errors).T:
        assert fitted_order([1 / n for n in SIZES], of_mode) > 1.9
    assert np.abs(errors[-1]).max() < 1e-3  # (k pi/n)^2/24


def test_bending_to_both_sides(spatial_reference, fitted_order):
    """Cantilever: omega = beta^2 sqrt(EI/mu), cos(beta) cosh(beta) = -1, for either EI."""
    beta = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613])
    exact = np.sort(np.concatenate([beta**2, beta**2 * np.sqrt(2.7)]))
    strip = section(EA=1e8, EI1=1.0, EI2=2.7, GJ=1e3, rotary_inertia=1e-4)
    errors = [frequencies(straight_rod(n, strip), 6) / exact - 1 for n in SIZES]
    for of_mode in np.array(errors).T:
        assert fitted_order([1 / n for n in SIZES], of_mode) > 2.8  # as in the plane


@pytest.mark.parametrize("ends", ["clamped-free", "clamped-clamped"])
def test_arcs(spatial_reference, fitted_order, ends):
    """Half a circle in its plane and out of it; the latter with torsion."""
    radius = 0.005  # of the section
    square = section(EA=4 / radius**2, EI=1.0, GJ=1 / 1.3, rotary_inertia=radius**2 / 2)
    label = f"arc180.{ends}.{{}}.radius0.005.{{}}.omega"
    planes = ("in_plane", "out_of_plane")
    exact = [
        spatial_reference("spatial_frequencies", label.format(plane, mode))
        for plane in planes
        for mode in (1, 2, 3, 4)
    ]
    exact = np.sort(exact)[:5]
    errors = []
    for n in FINE:
        angle = np.linspace(0, np.pi, n + 1)
        points = np.column_stack([np.sin(angle), 1 - np.cos(angle), 0 * angle])
        points /= np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        arc = rod_through(points, square, supports=SUPPORTS[ends])
        errors.append(frequencies(arc, 5) / exact - 1)
    # The largest error of the five: that of one of them may pass through zero.
    assert fitted_order([1 / n for n in FINE], np.abs(errors).max(axis=1)) > 1.9
    assert np.abs(errors[-1]).max() < 2e-4


@pytest.mark.parametrize("angle", [45, 90])
def test_pretwisted_blade(spatial_reference, fitted_order, angle):
    shape = blade(np.deg2rad(angle))
    strong, weak = shape.bending[1], shape.bending[0]
    flat = section(
        EA=1 / shape.compliance,
        EI1=strong,
        EI2=weak,
        GJ=shape.twisting,
        rotary_inertia=shape.spin,
    )
    label = f"blade{angle}.{{}}.omega"
    exact = [spatial_reference("spatial_frequencies", label.format(k)) for k in (1, 2, 3, 4)]
    errors = []
    for n in SIZES:
        scene = straight_rod(n, flat, rod={"initial_twist": np.deg2rad(angle)})
        errors.append(frequencies(scene, 4) / exact - 1)
    assert fitted_order([1 / n for n in SIZES], np.abs(errors).max(axis=1)) > 1.9
    assert np.abs(errors[-1]).max() < 2e-4
