"""Linear buckling of straight columns: ``EI v'''' - a (N v')' = 0`` with the tension of the loads.

The rod's own equations, linearised about the straight shape with ``EA`` without bound, are affine
in the tension: a generalised eigenvalue problem for its factor.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.linalg

from .case import Case, Label, Truth, UnsolvedError
from .rod import NX, NY, THETA, Array, M, Mesh, Rod, X, straight
from .shapes import Random, power


def buckling(rng: Random) -> Case:
    L = power(rng, -8, 3) if rng.random() < 0.6 else 1.0
    EI = power(rng, -3, 3) * L**4
    EA = EI / L**2 * power(rng, 4, 8)
    nodes = round(power(rng, 1, 1.9)) // 2 * 2 + 1
    angle = float(rng.choice([0.0, np.pi / 2, rng.uniform(-np.pi, np.pi)]))
    along = np.array([np.cos(angle), np.sin(angle)])
    knots, curve = straight((0, 0), (L, 0))  # the reference's column lies along x
    rod = Rod(knots, curve, EA, EI, 1.0)
    count = int(rng.integers(1, 4))
    entry = {
        "name": "rod",
        "nodes": nodes,
        "from": [0, 0],
        "to": (L * along).tolist(),
        "cross_section": {"stiffness": {"EA": EA, "EI": EI, "mass_per_length": 1.0}},
    }
    scene: dict[str, Any] = {
        "title": "Audit: buckling",
        "rods": [entry],
        "supports": [],
        "loads": [],
        "analysis": {"buckling": {"count": count}},
    }
    _hold(rng, rod, L, scene, angle)
    unit = EI / L**2
    scene["loads"] = []
    for _ in range(int(rng.integers(1, 3))):
        kind = rng.choice(["end", "somewhere", "weight"])
        press = -float(rng.uniform(0.5, 4)) * unit
        if kind == "end":
            at: Any = "end"
            u = L
        else:
            u = at = float(rng.uniform(0.3, 0.95) * L)
        if kind == "weight":
            rod.line_loads.append((0.0, L, (press / L, 0.0)))
            force = (press / L * along).tolist()
            scene["loads"].append({"distributed_force": {"rod": "rod", "force": force}})
            continue
        place = rod.place(u)
        place.force = (place.force[0] + press, 0.0)
        force = (press * along).tolist()
        scene["loads"].append({"point_force": {"rod": "rod", "at": at, "force": force}})

    if rng.random() < 0.3:
        # Equal along both axes, as for springs; of the whole rod or of a part.
        k = unit / L**2 * power(rng, 0, 3)
        lo, hi = (0.0, L) if rng.random() < 0.5 else np.sort(rng.uniform(0, L, 2)).tolist()
        rod.foundations.append((lo, hi, (k, k)))
        part = {"rod": "rod", "from": lo, "to": hi, "stiffness": k}
        scene["loads"].append({"foundation": part})

    def truths(_: dict[str, Any]) -> Mapping[Label, Truth]:
        rough, fine = (factors(rod, degree)[:count] for degree in (16, 22))
        if len(rough) != len(fine):
            raise UnsolvedError("the reference is not converged")
        return {
            (f"load factor {i + 1}", "final"): Truth(
                float(b), float(3 * abs(a - b) + 1e-9 * b), float(b), "load factor"
            )
            for i, (a, b) in enumerate(zip(rough, fine, strict=True))
        }

    return Case("buckling", scene, truths)


def _hold(rng: Random, rod: Rod, L: float, scene: dict[str, Any], angle: float) -> None:
    """Columns of every kind; rollers need an axis along or across the column."""
    supports = scene["supports"]
    aligned = angle in (0.0, np.pi / 2)
    across = "y" if angle == 0.0 else "x"
    kind = rng.choice(["free", "pinned", "clamp_roller", "spring", "torsion", "middle"])
    if not aligned and kind in ("pinned", "clamp_roller", "middle"):
        kind = "free"
    start = rod.place(0.0)
    start.fix = (True, True)
    if kind in ("pinned", "torsion", "middle"):
        supports.append({"rod": "rod", "at": "start", "fix": ["x", "y"]})
    else:
        start.clamp = True
        supports.append({"rod": "rod", "at": "start", "clamp": True})
    if kind in ("pinned", "clamp_roller", "middle"):
        supports.append({"rod": "rod", "at": "end", "fix": [across]})
        rod.place(L).fix = (False, True)
    if kind == "middle":
        supports.append({"rod": "rod", "at": "middle", "fix": [across]})
        rod.place(L / 2).fix = (False, True)
    if kind == "torsion":
        k = rod.EI / L * power(rng, -0.5, 2)
        start.torsion = k
        supports.append({"rod": "rod", "at": "start", "spring": {"rotational_stiffness": k}})
    if kind == "spring":
        # Equal along both axes, so that the axial part works along the column as well.
        k = rod.EI / L**3 * power(rng, 0, 3)
        u = float(rng.uniform(0.2, 1.0) * L)
        rod.place(u).spring = (k, k)
        supports.append({"rod": "rod", "at": u, "spring": {"stiffness": k}})


def factors(rod: Rod, degree: int) -> Array:
    """The positive factors of the loads, rising."""
    mesh = Mesh(rod, degree)
    state = mesh.drawn()
    residual, matrix = mesh.equations(state, 1.0, 1.0)
    step = scipy.sparse.linalg.spsolve(matrix, residual).reshape(state.shape)
    rigid = copy.copy(mesh)
    rigid.stretch = 0.0
    _, free = rigid.equations(state, 0.0, 1.0)
    pressed = state.copy()
    pressed[..., NX] = -step[..., NX]
    _, loaded = rigid.equations(pressed, 0.0, 1.0)
    # Only the transverse unknowns: with EA without bound the axial ones would be singular.
    keep = np.ones((mesh.pieces, mesh.order, 6), bool)
    keep[..., [X, NX]] = False
    rows = _transverse_rows(mesh)
    a = free.toarray()[np.ix_(rows, keep.ravel())]
    b = (loaded - free).toarray()[np.ix_(rows, keep.ravel())]
    columns = np.nonzero(np.abs(b).max(axis=0))[0]
    small = np.linalg.solve(a, b[:, columns])[columns]
    eigenvalues = scipy.linalg.eigvals(small)
    largest = np.abs(eigenvalues).max()
    real = (np.abs(eigenvalues) > 1e-9 * largest) & (
        np.abs(eigenvalues.imag) < 1e-7 * np.abs(eigenvalues)
    )
    found = -1.0 / eigenvalues[real].real
    return np.sort(found[found > 0])


def _transverse_rows(mesh: Mesh) -> Array:
    rows = np.arange(mesh.pieces * (mesh.order - 1) * 6).reshape(-1, 6)
    inner = rows[:, [1, THETA, NY, M]].ravel()
    at = mesh.pieces * (mesh.order - 1) * 6
    conditions: list[int] = []
    for i in range(mesh.pieces + 1):
        if 0 < i < mesh.pieces:
            conditions += [at + 1, at + 2]  # y and theta are continuous
            at += 3
        conditions += [at + 1, at + 2]  # balance across and of moments
        at += 3
    return np.concatenate([inner, conditions])
