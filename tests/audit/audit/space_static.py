"""Equilibria of rods in space: the boundary value problem by collocation.

The reference is ``tests/validation/references/kirchhoff_rod.py``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from references.kirchhoff_rod import Equilibrium, Held, Loaded, directors, follow, refine, rotation

from .case import Case, Label, Truth, UnsolvedError
from .rod import Array
from .shapes import Random
from .space import Placed, place, probes, share

QUANTITIES = (
    *("x", "y", "z", "x", "y", "z", "curvature_1", "curvature_2", "twist"),
    *("moment_1", "moment_2", "torque", "tension"),
)
_COARSE, _FINE = 14, 20  # degrees of the collocation
_STEPS = 8  # from the shape without load
_SAME = 0.03  # of the length: farther apart, two shapes are two equilibria


def space_static(rng: Random) -> Case:
    held = rng.random() < 0.3
    natural = np.zeros(3) if held or rng.random() < 0.4 else rng.uniform(-2, 2, 3)
    placed = place(rng, natural, (2.5, 6))
    nodes = int(rng.choice([9, 13, 21, 31, 41]))
    unit, start, frame = placed.length, placed.origin, placed.frame
    entry = {
        **placed.entry(),
        "nodes": nodes,
        "from": start.tolist(),
        "to": (start + unit * frame[:, 2]).tolist(),
    }
    if natural.any():
        entry |= placed.natural(natural)
    supports: list[dict[str, Any]] = [{"rod": "rod", "at": "start", "clamp": True}]
    loads: list[dict[str, Any]] = []
    line = rng.uniform(-4, 4, 3) if rng.random() < 0.5 else np.zeros(3)
    if line.any():
        force = (line * placed.force / unit).tolist()
        loads.append({"distributed_force": {"rod": "rod", "force": force}})
    shift, turn, push = np.zeros(3), 0.0, np.zeros(3)
    if held:
        # Drawn apart along the rod, by a pull of up to 3, so that it does not buckle.
        pull = rng.uniform(0, 3) / placed.rod.stretching
        shift = frame @ np.array([*rng.uniform(-0.01, 0.01, 2), pull])
        turn = float(rng.uniform(-2, 2))
        moved: dict[str, Any] = {
            axis: float(x) for axis, x in zip("xyz", unit * shift, strict=True)
        }
        moved["twist"] = turn
        supports.append({"rod": "rod", "at": "end", "clamp": True, "prescribe": moved})
    else:
        push = rng.uniform(-3, 3, 3)
        force = (push * placed.force).tolist()
        loads.append({"point_force": {"rod": "rod", "at": "end", "force": force}})
    scene: dict[str, Any] = {
        "title": "Audit: equilibrium in space",
        "model": "spatial",
        "rods": [entry],
        "supports": supports,
        "loads": loads,
        "analysis": "static",
        "output": {"probes": probes(rng, nodes, unit, QUANTITIES)},
    }
    if not loads:
        del scene["loads"]
    scene["output"]["probes"]["energy"] = {"quantity": "elastic_energy"}

    def truths(final: dict[str, Any]) -> Mapping[Label, Truth]:
        clamp = Held(np.zeros(3), frame)

        def end(part: float) -> Held | Loaded:
            if not held:
                return Loaded(part * push)
            spun = frame @ rotation((0, 0, 1), part * turn)
            return Held(frame[:, 2] + part * shift, spun)

        try:
            rough = follow(placed.rod, clamp, end, _STEPS, line, segments=2, degree=_COARSE)
            fine = refine(rough, _FINE)
        except RuntimeError as error:
            raise UnsolvedError(str(error)) from error
        at_nodes = start[:, None] + unit * fine.at(np.linspace(0, 1, nodes))[:3]
        apart = float(np.abs(at_nodes.T - final["positions"]).max()) / unit
        if apart > _SAME + 0.5 / nodes:
            raise UnsolvedError(f"the nearest solution is {apart:.2g} L away")
        found: dict[Label, Truth] = {}
        for name, probe in scene["output"]["probes"].items():
            s = share(probe.get("at", "end"), nodes, unit)
            a, b = (_read(placed, solved, probe["quantity"], s) for solved in (rough, fine))
            size = _size(placed, fine, probe["quantity"])
            apart = 3 * abs(a - b) + 1e-9 * size
            found[name, "final"] = Truth(b, apart, size, probe["quantity"])
        return found

    return Case("space_static", scene, truths)


def _read(placed: Placed, solved: Equilibrium, quantity: str, s: float) -> float:
    """A probe of the scene."""
    if quantity == "elastic_energy":
        points, weights = np.polynomial.legendre.leggauss(48)
        u = solved.strains(0.5 + 0.5 * points)
        gap = u[:3] - placed.rod.natural(points)
        density = (placed.rod.stiffness[:, None] * gap**2).sum(axis=0)
        density += placed.rod.stretching * u[3] ** 2
        return float(0.25 * weights @ density * placed.moment)
    if quantity in ("x", "y", "z"):
        axis = "xyz".index(quantity)
        place_there = solved.at(np.array([s]))[axis, 0]
        return float(placed.origin[axis] + placed.length * place_there)
    values = solved.at(np.array([s]))[:, 0]
    d = directors(values[3:7])
    moments, tension = values[10:13] @ d, float(values[7:10] @ d[:, 2])
    u = solved.strains(np.array([s]))[:3, 0]
    # The scene's curvature_1 is the one towards d1, a turning about d2.
    return float(
        {
            "curvature_1": u[1] / placed.length,
            "curvature_2": -u[0] / placed.length,
            "twist": u[2] / placed.length,
            "moment_1": moments[1] * placed.moment,
            "moment_2": -moments[0] * placed.moment,
            "torque": moments[2] * placed.moment,
            "tension": tension * placed.force,
        }[quantity]
    )


def _size(placed: Placed, solved: Equilibrium, quantity: str) -> float:
    """The size that is natural for a quantity in this solution."""
    if quantity == "elastic_energy":
        return abs(_read(placed, solved, quantity, 0.0))
    if quantity in ("x", "y", "z"):
        return placed.length + float(np.abs(placed.origin).max())
    values = solved.at(np.linspace(0, 1, 41))
    if quantity == "tension":
        # An edge's length is rounded to 1e-16 of the coordinates.
        rounding = 1e-5 * placed.rod.stretching * (1 + np.abs(placed.origin).max() / placed.length)
        return float((np.abs(values[7:10]).max() + rounding) * placed.force)
    moment = float(np.abs(values[10:13]).max())
    if quantity in ("moment_1", "moment_2", "torque"):
        return moment * placed.moment
    weakest = float(placed.rod.stiffness.min())
    natural: Array = placed.rod.natural(np.zeros(1))
    return (moment / weakest + float(np.abs(natural).max())) / placed.length
