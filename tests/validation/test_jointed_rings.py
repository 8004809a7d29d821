"""Closed rods with joints, curvatures that jump beside joints, and meshes of unlike edges.

References: half a ring between its two loads as the boundary-value problem of an extensible
elastica (`half_ring`); arcs of circles in closed form.
"""

from functools import cache

import der
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

EI, EA, BAR_EA = 1.0, 300.0, 40.0
LOAD = 3.0
MESHES = (48, 96, 192)


def stiffness(stretch: float, bending: float) -> dict:
    section = {"EA": stretch, "EI": bending, "mass_per_length": 1.0}
    return {"cross_section": {"stiffness": section}}


@cache
def quarter(force: float) -> tuple[float, float, float]:
    """Return the rise, the width and the moment at the top of a quarter of a ring of radius 1.

    Two opposite forces press the ring. From its top, where the tangent points to -x, to its side,
    the part ahead exerts the force (0, force / 2) on the part behind.
    """

    def along(_, at):
        theta, moment = at[:2]
        stretch = 1.0 + np.sin(theta) * force / 2 / EA
        return [
            1.0 + moment / EI,
            -stretch * np.cos(theta) * force / 2,
            stretch * np.cos(theta),
            stretch * np.sin(theta),
        ]

    def side(moment):
        start = [np.pi, moment, 0.0, 0.0]
        return solve_ivp(along, (0, np.pi / 2), start, rtol=1e-11, atol=1e-12).y[:, -1]

    moment = brentq(lambda m: side(m)[0] - 1.5 * np.pi, -2 * force - 1, 2 * force + 1, xtol=1e-12)
    _, _, x, y = side(moment)
    return -y, -x, moment


def circle(count: int, drawn: str) -> dict:
    if drawn == "shape":
        halves = [{"arc": {"to": [0, side], "through": [side, 0]}} for side in (1, -1)]
        return {"nodes": count, "from": [0, -1], "shape": halves}
    angle = -np.pi / 2 + 2 * np.pi * np.arange(count) / count
    return {"points": np.column_stack([np.cos(angle), np.sin(angle)]).tolist()}


def ring(count: int, bar: bool, drawn: str = "points") -> dict:
    top = {"rod": "ring", "at": "middle"}
    scene = {
        "rods": [
            {"name": "ring", "closed": True, **circle(count, drawn), **stiffness(EA, EI)},
        ],
        "joints": [{"name": "top", "of": [top]}],
        "supports": [
            {"rod": "ring", "at": "start", "fix": ["x", "y"]},
            {"joint": "top", "fix": ["x"]},
        ],
        "loads": [{"point_force": {"joint": "top", "force": [0, -LOAD]}}],
        "analysis": "static",
        "output": {
            "probes": {
                "top": {"joint": "top", "quantity": "y"},
                "moment": {**top, "quantity": "moment", "side": "after"},
                "before": {**top, "quantity": "moment", "side": "before"},
                "rotation": {"joint": "top", "quantity": "rotation"},
                "side": {"rod": "ring", "at": {"node": count // 4}, "quantity": "x"},
                "slope": {"rod": "ring", "at": {"node": count // 4}, "quantity": "slope"},
                "pull": {"support": 0, "quantity": "reaction_y"},
            }
        },
    }
    if bar:
        ends = {"name": "bar", "nodes": 5, "from": [0, -1], "to": [0, 1], **stiffness(BAR_EA, 0.1)}
        scene["rods"].append(ends)
        scene["joints"] = [
            {"name": "top", "kind": "hinge", "of": [top, {"rod": "bar", "at": "end"}]},
            {
                "name": "foot",
                "kind": "hinge",
                "of": [{"rod": "ring", "at": "start"}, {"rod": "bar", "at": "start"}],
            },
        ]
        del scene["output"]["probes"]["rotation"]
    return scene


@pytest.mark.parametrize("drawn", ["points", "shape"])
@pytest.mark.parametrize("bar", [False, True], ids=["alone", "with a bar across"])
def test_a_ring_that_is_pressed(bar, drawn, fitted_order):
    """The bar bears what it is shortened by; it buckles at 0.25 and here bears less than that."""
    load = LOAD if not bar else 0.1
    pressed = load
    if bar:
        pressed = brentq(lambda f: load - f - BAR_EA * (1 - quarter(f)[0]), 0.0, load, xtol=1e-13)
    rise, width, moment = quarter(pressed)
    expected = {
        "top": -1 + 2 * rise,
        "moment": moment,
        "before": moment,
        "rotation": 0.0,
        "side": width,
        "slope": np.pi / 2,
        "pull": load,
    }
    errors = []
    for count in MESHES:
        scene = ring(count, bar, drawn)
        scene["loads"][0]["point_force"]["force"] = [0, -load]
        result = der.run(scene)
        assert result.summary["stability"] == "stable"
        errors.append([result.probes[p][-1] - expected[p] for p in result.probes])
    for name, column in zip(result.probes, np.abs(errors).T, strict=True):
        assert column[-1] < 4e-3, name
        assert column[-1] < 1e-9 or fitted_order(1 / np.array(MESHES), column) > 1.85, name


def test_a_ring_with_an_idle_joint_vibrates_as_one_without(fitted_order):
    """Free rings: the frequencies of a thin one, k (k^2 - 1) / sqrt(k^2 + 1), twice each."""
    expected = np.repeat([k * (k * k - 1) / np.sqrt(k * k + 1) for k in (2, 3)], 2)
    errors = []
    for count in MESHES:
        scene = ring(count, False) | {
            "supports": [],
            "loads": [],
            "analysis": {"modes": {"count": 4}},
        }
        scene["rods"][0] |= stiffness(1e6, EI)
        scene["output"] = {}
        found = der.Simulation(der.Scenario.from_dict(scene)).modes(7)
        frequencies = 2 * np.pi * np.sort(found.frequencies)[-4:]
        errors.append(np.abs(frequencies / expected - 1).max())
    assert errors[-1] < 5e-3
    assert fitted_order(1 / np.array(MESHES), errors) > 1.85


def arcs(pieces: list[tuple[float, float]]) -> np.ndarray:
    """The end of arcs of (length, curvature) that follow one another smoothly from +x."""
    place, slope = np.zeros(2), 0.0
    for length, kappa in pieces:
        turn = kappa * length
        chord = length * np.sinc(turn / 2 / np.pi)
        place = place + chord * np.array([np.cos(slope + turn / 2), np.sin(slope + turn / 2)])
        slope += turn
    return np.append(place, slope)


def test_a_natural_curvature_that_jumps_at_a_node(fitted_order):
    """A joint elsewhere moves the nodes; the jump keeps one of its own."""
    before, after, moment, jump = 1.4, -0.6, 0.7, 0.6
    expected = arcs([(jump, before + moment / EI), (1 - jump, after + moment / EI)])
    errors = []
    for count in (20, 40, 80):
        natural = np.where(np.arange(count + 1) < round(jump * count), before, after)
        natural = natural.astype(float)
        natural[round(jump * count)] = (before + after) / 2
        scene = {
            "rods": [
                {
                    "name": "rod",
                    "nodes": count + 1,
                    "from": [0, 0],
                    "to": [1, 0],
                    "natural_curvature": natural.tolist(),
                    **stiffness(1e7, EI),
                }
            ],
            "joints": [{"name": "idle", "of": [{"rod": "rod", "at": 0.237}]}],
            "supports": [{"rod": "rod", "at": "start", "clamp": True}],
            "loads": [{"moment": {"rod": "rod", "at": "end", "moment": moment}}],
            "analysis": "static",
            "output": {
                "probes": {
                    q: {"rod": "rod", "at": "end", "quantity": q} for q in ("x", "y", "slope")
                }
            },
        }
        probes = der.run(scene).probes
        errors.append([probes[q][-1] - e for q, e in zip(probes, expected, strict=True)])
    for column in np.abs(errors).T:
        assert column[-1] < 1e-7 or fitted_order(1 / np.array([20, 40, 80]), column) > 1.85


def test_a_joint_tells_a_spring_from_a_moment_beside_it():
    """A third of an edge apart; the example of docs/joints.md, "A joint of one rod"."""
    spring, moment, place, beside = 5.0, 2.0, 0.5, 0.50375
    bent = moment / (1 + spring * place / EI)
    tip = arcs([(place, bent / EI), (beside - place, moment / EI), (1 - beside, 0.0)])[1]
    off = {}
    for count, jointed in ((21, True), (81, True), (81, False)):
        at = {"rod": "beam", "at": place}
        scene = {
            "rods": [{"name": "beam", "nodes": count, "from": [0, 0], "to": [1, 0]}],
            "joints": [{"name": "pivot", "of": [at]}] if jointed else [],
            "supports": [
                {"rod": "beam", "at": "start", "clamp": True},
                {**at, "spring": {"rotational_stiffness": spring}},
            ],
            "loads": [{"moment": {"rod": "beam", "at": beside, "moment": moment}}],
            "analysis": "static",
            "output": {"probes": {"tip": {"rod": "beam", "at": "end", "quantity": "y"}}},
        }
        scene["rods"][0] |= stiffness(1e6, EI)
        if not jointed:
            del scene["joints"]
        result = der.run(scene)
        off[count, jointed] = abs(result.probes["tip"][-1] - tip)
        told = any("joints: [{name: here, of: [{rod: beam" in w for w in result.summary["warnings"])
        assert told is not jointed
    assert off[21, True] < 1e-9
    assert off[81, True] < 1e-11
    assert off[81, False] > 1e-3  # of order 1, as the warning says


def test_edges_of_unlike_lengths_beside_a_joint():
    """An edge of a tenth of the others next to a spring: the end of a leg has none such."""
    load, spring = 1e-5, 5.0
    # Clamped at 0, sprung at 0.5 about its rotation, loaded at the end: small deflection.
    turn = (load * 0.5**2 / 2 + load * 0.5 * 0.5) / EI / (1 + spring * 0.5 / EI)
    sag = load / 3 / EI - spring * turn / EI * (0.5**2 / 2 + 0.5 * 0.5)
    errors = []
    for count in (10, 20, 40):
        s = np.linspace(0, 1, count + 1)
        s = np.insert(s, count // 2 + 1, 0.5 + 0.1 / count)
        scene = {
            "rods": [{"name": "rod", "points": np.column_stack([s, 0 * s]).tolist()}],
            "joints": [{"name": "middle", "of": [{"rod": "rod", "at": {"node": count // 2}}]}],
            "supports": [
                {"rod": "rod", "at": "start", "clamp": True},
                {"joint": "middle", "spring": {"rotational_stiffness": spring}},
            ],
            "loads": [{"point_force": {"rod": "rod", "at": "end", "force": [0, load]}}],
            "analysis": "static",
            "output": {"probes": {"tip": {"rod": "rod", "at": "end", "quantity": "y"}}},
        }
        scene["rods"][0] |= stiffness(1e7, EI)
        errors.append(abs(der.run(scene).probes["tip"][-1] / sag - 1))
    assert max(errors) < 1e-6


@pytest.mark.parametrize("off", [-1e-5, 0.0, 1e-5])
def test_a_probe_beside_a_joint_reads_one_of_its_sides(off):
    """Places nearer than 2e-5 of the length are one, for probes, too."""
    at = {"rod": "rod", "at": 0.5 + off}
    scene = {
        "rods": [{"name": "rod", "nodes": 21, "from": [0, 0], "to": [1, 0]}],
        "joints": [{"name": "here", "of": [{"rod": "rod", "at": 0.5}]}],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "loads": [{"moment": {**at, "moment": 0.4}}],
        "analysis": "static",
        "output": {
            "probes": {
                side: {**at, "side": side, "quantity": "moment"} for side in ("before", "after")
            }
        },
    }
    scene["rods"][0] |= stiffness(1e6, EI)
    probes = der.run(scene).probes
    assert probes["before"][-1] == pytest.approx(0.4, abs=1e-9)
    assert probes["after"][-1] == pytest.approx(0.0, abs=1e-9)


def test_an_extreme_beside_a_joint():
    """The lowest point of an arc without loads, between a joint and the node before it."""
    angle = np.linspace(-0.5, 0.5, 9) / 1.0
    points = np.column_stack([np.sin(angle), 1 - np.cos(angle)]).tolist()
    scene = {
        "rods": [{"name": "rod", "points": points}],
        "joints": [{"name": "here", "of": [{"rod": "rod", "at": {"node": 5}}]}],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "analysis": "static",
        "output": {
            "probes": {
                "top": {"rod": "rod", "quantity": "x", "over": "rod", "reduce": "max"},
                "low": {"rod": "rod", "quantity": "y", "over": "rod", "reduce": "min"},
            }
        },
    }
    turn = np.array([[np.cos(0.12), -np.sin(0.12)], [np.sin(0.12), np.cos(0.12)]])
    scene["rods"][0]["points"] = (np.array(points) @ turn).tolist()
    scene["rods"][0] |= stiffness(1e4, EI)
    lowest = np.min(
        (np.array([[np.sin(a), 1 - np.cos(a)] for a in np.linspace(-0.5, 0.5, 100001)]) @ turn)[
            :, 1
        ]
    )
    low = der.run(scene).probes["low"][-1]
    assert low == pytest.approx(lowest, abs=2e-5)
    assert low < np.array(scene["rods"][0]["points"])[:, 1].min() - 1e-6
