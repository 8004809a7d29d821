"""Moments within the first edges of a clamp: shape, moment and tension of a planar rod, against the
elastica with a jump of the moment, and against pure bending.

The moment stands at the same part of the first edges on every mesh, so that the references are
those of each mesh.
"""

import der
import numpy as np
import pytest
from references.kirchhoff_rod import UPRIGHT, Rod, rotation
from references.section_loads import Wrench, held_at_start
from scenes import straight
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

SIZES = [80, 160, 320]
EDGES = [0.2, 0.7, 1.3]
EA = 30.0
FORCE = (-1.0, 2.0)
MOMENT = 1.5


def elastica(place):
    """Values of a clamped rod (length 1, EI = 1) that stretches, under a tip force and a moment.

    x' = (1 + N/EA) cos a, y' = (1 + N/EA) sin a, a' = m, m' = (1 + N/EA) (P_x sin a - P_y cos a)
    with N = P . t, and m falls by the moment at the place.
    """
    P = np.array(FORCE)

    def rate(_s, state):
        _, _, a, m = state
        t = np.array([np.cos(a), np.sin(a)])
        stretched = (1 + P @ t / EA) * t
        return [*stretched, m, P[0] * stretched[1] - P[1] * stretched[0]]

    def march(root):
        options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}
        inner = solve_ivp(rate, (0, place), [0, 0, 0, root], **options).y[:, -1]
        beyond = inner - [0, 0, 0, MOMENT]
        return inner, beyond, solve_ivp(rate, (place, 1), beyond, **options).y[:, -1]

    root = brentq(lambda m: march(m)[2][3], 0.0, 8.0, xtol=1e-12)
    inner, beyond, tip = march(root)
    tension = P @ [np.cos(inner[2]), np.sin(inner[2])]
    return {
        "x_tip": tip[0],
        "y_tip": tip[1],
        "moment_root": root,
        "moment_before": inner[3],
        "moment_after": beyond[3],
        "tension_root": P[0],
        "tension_before": tension,
        "tension_after": tension,
    }


@pytest.mark.parametrize("end", ["start", "end"])
@pytest.mark.parametrize("edges", EDGES)
def test_a_bent_rod(fitted_order, edges, end):
    """Also with the clamp at the end of the rod, whose arc length then runs the other way."""
    errors = []
    for n in SIZES:
        place = edges / n
        at, near, far, other = place, "before", "after", "end"
        if end == "end":
            at, near, far, other = 1 - place, "after", "before", "start"
        places = {"tip": (other, far), "root": (end, far), "before": (at, near), "after": (at, far)}
        scene = straight(n, "free-free", EA)
        scene["supports"] = [{"rod": "rod", "at": end, "clamp": True}]
        sign = 1.0 if end == "start" else -1.0  # half a revolution about the rod's middle
        scene["loads"] = [
            {"point_force": {"rod": "rod", "at": other, "force": [sign * c for c in FORCE]}},
            {"moment": {"rod": "rod", "at": at, "moment": MOMENT}},
        ]
        truth = elastica(place)
        probes = {}
        for name in truth:
            quantity, where = name.split("_")
            s, side = places[where]
            probes[name] = {"rod": "rod", "at": s, "quantity": quantity}
            if quantity in ("moment", "tension") and not isinstance(s, str):
                probes[name]["side"] = side
        result = der.run({**scene, "output": {"probes": probes}})
        found = {name: values[-1] for name, values in result.probes.items()}
        if end == "end":
            found["x_tip"], found["y_tip"] = 1 - found["x_tip"], -found["y_tip"]
            found |= {name: -value for name, value in found.items() if name.startswith("moment")}
        errors.append([abs(found[name] - truth[name]) for name in truth])
    for name, column in zip(truth, np.array(errors).T, strict=True):
        if name.startswith("tension"):
            # Between the clamp and the moment there is one middle of an edge at most: the tension
            # has no slope there (docs/limits.md).
            assert column[-1] < 0.03, name
        else:
            assert column[-1] < 1e-4, name
            assert fitted_order([1 / n for n in SIZES], column) > 1.9, (name, column)


@pytest.mark.parametrize("model", ["planar", "spatial"])
@pytest.mark.parametrize("edges", EDGES)
def test_pure_bending(fitted_order, model, edges):
    """An arc up to the moment and a straight line beyond it; no force, so no tension."""
    errors = []
    for n in SIZES:
        place = edges / n
        scene = straight(n, "clamped-free", 1e6)
        if model == "spatial":
            scene["rods"][0] |= {"from": [0, 0, 0], "to": [1, 0, 0]}
            scene["rods"][0]["cross_section"]["stiffness"]["GJ"] = 1.0
        vector = MOMENT if model == "planar" else [0, 0, MOMENT]
        scene["loads"] = [{"moment": {"rod": "rod", "at": place, "moment": vector}}]
        quantities = {
            "root": (0.0, "after"),
            "before": (place, "before"),
            "after": (place, "after"),
        }
        probes = {
            f"{quantity}_{name}": {"rod": "rod", "at": s, "side": side, "quantity": quantity}
            for quantity in ("moment", "tension")
            for name, (s, side) in quantities.items()
        }
        probes |= {axis: {"rod": "rod", "at": "end", "quantity": axis} for axis in "xy"}
        result = der.run({**scene, "model": model, "output": {"probes": probes}})
        found = {name: values[-1] for name, values in result.probes.items()}
        for name, moment in {"root": MOMENT, "before": MOMENT, "after": 0.0}.items():
            assert found[f"moment_{name}"] == pytest.approx(moment, abs=1e-6)
            assert found[f"tension_{name}"] == pytest.approx(0.0, abs=1e-4)
        angle = MOMENT * place
        tip = np.array([np.sin(angle), 1 - np.cos(angle)]) / MOMENT
        tip += (1 - place) * np.array([np.cos(angle), np.sin(angle)])
        errors.append(np.abs([found["x"], found["y"]] - tip))
    for column in np.array(errors).T:
        assert column[-1] < 1e-4
        if column.max() > 1e-6:
            assert fitted_order([1 / n for n in SIZES], column) > 1.9, column


@pytest.mark.parametrize("edges", [0.2, 0.45, 0.7])
def test_a_spring_beside_a_clamp_that_turns(fitted_order, edges):
    """It winds up by what the tangent at its place turns, of which the clamp turns the most.

    The reference is `references/section_loads.py`, to which the spring's moment is given; its
    stiffness follows from the angle there.
    """
    rod, turn, exerts = Rod(1.0, (1.0, 1.0), 0.7, EA), 0.5, -1.2
    errors = []
    for n in SIZES:
        place = edges / n
        wrenches = [Wrench(place, moment=(0.0, exerts, 0.0)), Wrench(1.0, (0.5, 0.0, 1.0))]
        end, _, frames = held_at_start(rod, wrenches, rotation((0, 0, 1), turn) @ UPRIGHT)
        force = frames[1] @ np.array([0.5, 0.0, 1.0])
        angle = np.arctan2(frames[0][1, 2], frames[0][0, 2])
        scene = straight(n, "free-free", EA)
        scene["supports"] = [
            {"rod": "rod", "at": "start", "clamp": True, "prescribe": {"angle": turn}},
            {"rod": "rod", "at": place, "spring": {"rotational_stiffness": -exerts / angle}},
        ]
        load = {"rod": "rod", "at": "end", "force": force[:2].tolist()}
        scene["loads"] = [{"point_force": load}]
        probes = {axis: {"rod": "rod", "at": "end", "quantity": axis} for axis in "xy"}
        probes["moment"] = {"rod": "rod", "at": "start", "quantity": "moment"}
        result = der.run({**scene, "output": {"probes": probes}})
        bears = np.cross(end, force)[2] + exerts
        clamp, spring = (reaction.moment[-1] for reaction in result.reactions())
        found = [*(values[-1] for values in result.probes.values()), clamp, spring]
        errors.append(np.array(found) - [*end[:2], bears, -bears, exerts])
    for column in np.transpose(errors):
        assert abs(column[-1]) < 1e-3
        assert fitted_order([1 / n for n in SIZES], column) > 1.9
