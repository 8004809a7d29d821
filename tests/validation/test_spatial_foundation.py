"""Rods in space on foundations that act along z or across the axes, against Hetenyi, Beams on
Elastic Foundation (1946), and a bar on springs."""

import numpy as np
import pytest
from references.kirchhoff_rod import rotation
from references.pulled_bar import pulled_bar
from scenes import END
from spatial_scenes import measured, section, straight_rod

BETA = 20.0  # the ends are 10 wave lengths from the middle: they count by exp(-20)
STIFFNESS = 4 * BETA**4
P = 1e-3
OBLIQUE = rotation(np.array([2, 1, -2]) / 3, 0.7)
#: Directions of the rod and of the load across it.
ACROSS = {"z": (np.array([1, 0, 0]), np.array([0, 0, 1])), "oblique": OBLIQUE[:, :2].T}
#: Directions of a rod that is pulled.
ALONG = {"z": np.array([0, 0, 1]), "oblique": OBLIQUE[:, 0]}


def foundation(*stiffness, **part):
    return {"foundation": {"rod": "rod", "stiffness": list(stiffness), **part}}


def force(vector, **at):
    return {"point_force": {"rod": "rod", "force": vector.tolist(), **at}}


@pytest.mark.parametrize("at", [0.5, 0.4871])
@pytest.mark.parametrize("direction", ACROSS)
def test_a_point_load_across_a_long_beam(fitted_order, direction, at):
    """M = P/(4 beta) e^(-beta x) (cos - sin); the load pushes against director 1."""
    along, across = ACROSS[direction]
    places = at + np.array([0.0, 0.004, 0.013, 0.1])
    x = BETA * (places - at)
    exact = P / (4 * BETA) * np.exp(-x) * (np.cos(x) - np.sin(x))
    only_z = foundation(0, 0, STIFFNESS)
    loads = [
        only_z if direction == "z" else foundation(*3 * [STIFFNESS]),
        force(-P * across, at=at),
    ]
    beam = section(across, EI=1.0, GJ=1.0)
    sizes = [80, 160, 320]
    errors = []
    for n in sizes:
        scene = straight_rod(n, beam, to=along, loads=loads)
        values, _ = measured(scene, places.tolist(), ["moment_1"])
        errors.append(np.abs(values[:, 0] - exact).max() / exact[0])
    assert errors[-1] < (BETA / sizes[-1]) ** 2
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


@pytest.mark.parametrize("border", [0.1, 0.45])
@pytest.mark.parametrize("direction", ALONG)
def test_tension_where_foundations_begin_and_end_within_edges(fitted_order, direction, border):
    """u'' = k u/EA by hand; borders at the same part of the edge on every mesh."""
    along = ALONG[direction]
    sizes = [1 / n for n in (20, 40, 80)]
    errors = []
    for h in sizes:
        parts = [(500.0, border * h, 1.0), (300.0, 0.0, 0.5 + border * h)]
        loads = [foundation(k, k, k, **{"from": a, "to": b}) for k, a, b in parts]
        rod = section(EA=100.0, EI=1.0, GJ=1.0)
        # Nothing but the foundation holds the rod along itself.
        scene = straight_rod(
            round(1 / h),
            rod,
            to=along,
            supports=[{**END, "spring": {"rotational_stiffness": 1.0}}],
            loads=[*loads, force(1e-3 * along, at="end")],
        )
        places = np.array([0.0, border * h, 0.3, 0.5, 0.5 + border * h, 0.9])
        tension, _ = measured(scene, places.tolist(), ["tension"])
        errors.append(np.abs(1e3 * tension[:, 0] - pulled_bar(places, parts)).max())
    assert fitted_order(sizes, errors) > 1.9
