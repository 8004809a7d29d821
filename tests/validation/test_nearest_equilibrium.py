"""Shapes of the continuum that a program writes into `positions`: `stability: any` keeps them.

The nodes lie on the curve, so that the edges are its chords and pressed by EA kappa^2 l^2/24, up
to 1e4 times the buckling load. Reference: columns of length 1 with EI = 1 in their buckling modes,
the elastica with axial strain (Magnusson, Ristinmaa and Ljung, Int. J. Solids Struct. 38, 2001), by
its first integral.
"""

from __future__ import annotations

import copy
from typing import Any

import der
import numpy as np
import pytest
from numpy.typing import NDArray
from scenes import START, straight, tip_force
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from test_elastica import GUIDED_END

SIZES = [20, 40, 80, 160]
STEPS = [1 / n for n in SIZES]
#: Quarter waves along the column in its first, second and third mode.
QUARTERS = {"pinned-pinned": (2, 4, 6), "clamped-free": (1, 3, 5), "clamped-clamped": (4, 8)}


def load_of(quarters: int, angle: float, EA: float) -> float:
    """The dead load under which the axis turns by at most `angle` from that of the load."""
    k = np.sin(angle / 2)

    def quarter(load: float) -> float:
        def per_phase(u: float) -> float:
            cosines = 2 - 2 * k**2 * (1 + np.sin(u) ** 2)
            return 1 / np.sqrt((1 - (k * np.sin(u)) ** 2) * (1 - load / (2 * EA) * cosines))

        return quad(per_phase, 0, np.pi / 2)[0] / np.sqrt(load)

    return brentq(lambda load: quarters * quarter(load) - 1, 1, 0.45 * EA, xtol=1e-12)


def curve(ends: str, mode: int, angle: float, EA: float, nodes: int) -> tuple[float, Any]:
    """The load, and `nodes` points of the axis that are equally far apart without stress."""
    load = load_of(QUARTERS[ends][mode - 1], angle, EA)

    def along(_: float, state: NDArray[np.float64]) -> list[float]:
        turn = state[2]
        stretch = 1 - load * np.cos(turn) / EA
        return [
            stretch * np.cos(turn),
            stretch * np.sin(turn),
            state[3],
            -load * stretch * np.sin(turn),
        ]

    cosine = np.cos(angle)
    bent = np.sqrt(2 * load * (1 - cosine) * (1 - load / (2 * EA) * (1 + cosine)))
    start = [0, 0, angle, 0] if ends == "pinned-pinned" else [0, 0, 0, bent]
    at = np.linspace(0, 1, nodes)
    points = solve_ivp(along, (0, 1), start, t_eval=at, rtol=1e-11, atol=1e-12).y[:2].T
    if ends != "clamped-free":
        points[-1, 1] = 0
    return load, points


def column(ends: str, edges: int, EA: float, force: list[dict[str, Any]]) -> dict[str, Any]:
    scene = straight(edges, ends, EA, loads=force)
    if ends == "clamped-clamped":
        scene["supports"] = [{**START, "clamp": True}, GUIDED_END]
    return scene


def in_space(scene: dict[str, Any]) -> dict[str, Any]:
    scene = copy.deepcopy(scene)
    (rod,) = scene["rods"]
    rod |= {"from": [0, 0, 0], "to": [1, 0, 0]}
    rod["cross_section"]["stiffness"] |= {"GJ": 1.0}
    for support in scene["supports"]:
        if "fix" in support:
            support["fix"] = [*support["fix"], "z"]
    for load in scene["loads"]:
        load["point_force"]["force"] += [0]
    return scene | {"model": "spatial"}


def kept(scene: dict[str, Any], points: Any) -> tuple[der.Simulation, Any]:
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    simulation.positions[:, :2] = points
    return simulation, simulation.equilibrium(leave_saddles=False)


CASES = [(ends, mode + 1) for ends in QUARTERS for mode in range(len(QUARTERS[ends]))]


@pytest.mark.parametrize("EA", [1e3, 1e5, 1e7, 1e9])
@pytest.mark.parametrize("angle", [0.6, 1.2, 2.2])
@pytest.mark.parametrize(("ends", "mode"), CASES)
def test_buckling_modes_are_kept_in_the_plane(fitted_order, ends, mode, angle, EA):
    errors = []
    # Each quarter wave has at least 6 edges.
    sizes = [max(1, QUARTERS[ends][mode - 1] // 2) * n for n in SIZES]
    for n in sizes:
        load, points = curve(ends, mode, angle, EA, n + 1)
        simulation, report = kept(column(ends, n, EA, tip_force(-load, 0)), points)
        assert report.stability == ("stable" if mode == 1 else "unstable")
        errors.append(np.abs(simulation.positions - points).max())
    assert errors[0] < 0.05
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


@pytest.mark.parametrize("EA", [1e3, 1e9])
@pytest.mark.parametrize("mode", [2, 3])
@pytest.mark.parametrize("ends", ["pinned-pinned", "clamped-free"])
def test_buckling_modes_are_kept_in_space(fitted_order, ends, mode, EA):
    errors = []
    for n in SIZES:
        load, points = curve(ends, mode, 1.2, EA, n + 1)
        scene = in_space(column(ends, n, EA, tip_force(-load, 0)))
        simulation, report = kept(scene, points)
        assert report.stability == "unstable"
        errors.append(np.abs(simulation.positions[:, :2] - points).max())
        assert np.abs(simulation.positions[:, 2]).max() < 1e-9
    assert fitted_order(STEPS, errors) > 1.9


@pytest.mark.parametrize("EA", [1e3, 1e5, 1e9])
@pytest.mark.parametrize("mode", [1, 2, 3])
def test_buckling_modes_under_a_follower_load_are_kept(fitted_order, mode, EA):
    """The line of thrust joins the pins, so that the force is P/cos(angle) for the dead load P. On
    the path from the unloaded column is the straight one."""
    errors = []
    for n in SIZES:
        load, points = curve("pinned-pinned", mode, 0.9, EA, n + 1)
        force = tip_force(-load / np.cos(0.9), 0)
        force[0]["point_force"]["follower"] = True
        simulation, report = kept(column("pinned-pinned", n, EA, force), points)
        assert report.stability == "not_judged"
        errors.append(np.abs(simulation.positions - points).max())
    assert fitted_order(STEPS, errors) > 1.9


def test_the_scene_says_whether_a_written_shape_is_kept():
    load, points = curve("pinned-pinned", 2, 1.2, 1e5, 81)
    scene = column("pinned-pinned", 80, 1e5, tip_force(-load, 0))
    for choice, word in (("any", "unstable"), ("stable", "stable")):
        scene["analysis"] = {"static": {"stability": choice}}
        simulation = der.Simulation(der.Scenario.from_dict(scene))
        simulation.positions[...] = points
        assert simulation.equilibrium().stability == word
        batch = der.Batch(scene, 2)
        batch.positions[...] = points
        assert [report.stability for report in batch.equilibrium()] == [word, word]
