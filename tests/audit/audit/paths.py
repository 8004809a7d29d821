"""Continuation: arches that snap, and paths that only bend."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from . import statics
from .case import Case, Label, Truth, UnsolvedError
from .path import Path
from .rod import Array, Mesh, Rod
from .shapes import Drawing, Random, draw, power

QUANTITIES = ("x", "y", "moment", "tension", "bend_energy", "gravity_energy", "total_energy")


def paths(rng: Random) -> Case:
    """An arch under a force two times out of three, else any bent rod."""
    vary = "loads"
    scene: dict[str, Any] = {"title": "Audit: paths", "rods": [], "supports": [], "loads": []}
    if rng.random() < 0.65:
        drawing, to = _arch(rng, scene)
    else:
        drawing = draw(rng, curved=0.3, natural=0.0, slender=(3, 5), nodes=(11, 25))
        vary = str(rng.choice(["loads", "supports"]))
        u = float(drawing.node_u[-1])
        _clamp(rng, drawing, scene, 0.0, "start", moved=vary == "supports" or rng.random() < 0.3)
        if rng.random() < 0.3:
            scene["supports"].append({"rod": "rod", "at": "end", "fix": ["x", "y"]})
            drawing.rod.place(u).fix = (True, True)
        statics.load(rng, drawing, scene)
        to = float(rng.uniform(0.5, 1.3))
    scene["rods"] = [drawing.entry]
    scene["analysis"] = {"continuation": {"to": to, "vary": vary}}
    if not scene["loads"]:
        del scene["loads"]
    probes: dict[str, dict[str, Any]] = {}
    for i in range(4):
        quantity = str(rng.choice(QUANTITIES))
        probe: dict[str, Any] = {"quantity": quantity}
        if "energy" not in quantity:
            node = int(rng.integers(2, drawing.nodes - 2))
            probe |= {"rod": "rod", "at": {"node": node}}
        probes[f"p{i}"] = probe
    scene["output"] = {"probes": probes}

    def truths(_: dict[str, Any]) -> Mapping[Label, Truth]:
        rough = _values(drawing, to, vary, probes, 6)
        fine = _values(drawing, to, vary, probes, 8)
        if rough.keys() != fine.keys():
            raise UnsolvedError("the reference is not converged")
        found = {}
        for label, (value, scale, quantity) in fine.items():
            error = 3 * abs(value - rough[label][0]) + 1e-9 * scale
            found[label] = Truth(float(value), float(error), float(scale), quantity)
        return found

    return Case("paths", scene, truths)


def _arch(rng: Random, scene: dict[str, Any]) -> tuple[Drawing, float]:
    """A shallow arch on two pins or clamps; a force on it, mostly beside the top."""
    L = power(rng, -6, 2) if rng.random() < 0.5 else 1.0
    EI = power(rng, -2, 2) * L**4
    EA = EI / L**2 * power(rng, 3.3, 4.5)
    count = int(rng.choice([13, 17, 21, 25]))
    t = np.linspace(0, 1, count)
    rise = float(rng.uniform(0.04, 0.12))
    x = t * L
    y = rise * L * (np.sin(np.pi * t) if rng.random() < 0.5 else 4 * t * (1 - t))
    points = np.column_stack([x, y])
    node_s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    spline = CubicSpline(node_s, points)

    def curve(u: Array) -> tuple[Array, Array, Array, Array]:
        position, d, dd = spline(u), spline(u, 1), spline(u, 2)
        speed = np.hypot(d[..., 0], d[..., 1])
        bend = (d[..., 0] * dd[..., 1] - d[..., 1] * dd[..., 0]) / speed**3
        return position, np.arctan2(d[..., 1], d[..., 0]), bend, speed

    mass = EI / L**3 * 0.01
    rod = Rod(node_s, curve, EA, EI, mass)
    stiffness = {"EA": EA, "EI": EI, "mass_per_length": mass}
    entry = {"name": "rod", "points": points.tolist(), "cross_section": {"stiffness": stiffness}}
    drawing = Drawing(entry, rod, node_s, node_s, False)
    clamped = rng.random() < 0.3
    for at, u in (("start", 0.0), ("end", float(node_s[-1]))):
        if clamped:
            _clamp(rng, drawing, scene, u, at, moved=False)
        else:
            scene["supports"].append({"rod": "rod", "at": at, "fix": ["x", "y"]})
            rod.place(u).fix = (True, True)
    node = count // 2 if rng.random() < 0.3 else int(rng.integers(count // 4, count // 2))
    force = -EI / L**2 * float(rng.uniform(0.5, 2))
    rod.place(float(node_s[node])).force = (0.0, force)
    load = {"rod": "rod", "at": {"node": node}, "force": [0.0, force]}
    scene["loads"].append({"point_force": load})
    if rng.random() < 0.5:
        g = float(rng.uniform(-2, 0)) * EI / L**3 / mass
        rod.gravity = (0.0, g)
        scene["loads"].append({"gravity": [0.0, g]})
    return drawing, float(rng.uniform(5, 40))


def _clamp(
    rng: Random, drawing: Drawing, scene: dict[str, Any], u: float, at: str, *, moved: bool
) -> None:
    place = drawing.rod.place(u)
    place.fix, place.clamp = (True, True), True
    entry: dict[str, Any] = {"rod": "rod", "at": at, "clamp": True}
    if moved:
        place.turn = float(rng.uniform(-1.5, 1.5))
        place.shift = (0.0, float(rng.uniform(-0.05, 0.05) * drawing.length))
        entry["prescribe"] = {"y": place.shift[1], "angle": place.turn}
    scene["supports"].append(entry)


def _values(
    drawing: Drawing, to: float, vary: str, probes: dict[str, dict[str, Any]], degree: int
) -> dict[Label, tuple[float, float, str]]:
    """Factors and probes at all events."""
    mesh = Mesh(drawing.rod, degree if len(drawing.rod.knots) > 2 else 3 * degree)
    found: dict[Label, tuple[float, float, str]] = {}
    counts: dict[str, int] = {}
    for event in Path(mesh, to, vary).events():
        what = event.kind
        if what in ("fold", "bifurcation"):
            counts[what] = counts.get(what, 0) + 1
            what = f"{what} {counts[what]}"
            found["factor", what] = event.factor, abs(event.factor), "factor"
        weight = event.factor if vary == "loads" else 1.0
        for name, probe in probes.items():
            value = statics.value(drawing, mesh, event.state, probe, weight)
            if value is not None:
                scale = statics.scale(mesh, event.state, probe["quantity"], weight)
                found[name, what] = value, scale, probe["quantity"]
    return found
