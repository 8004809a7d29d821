"""Rods of unequal bending stiffnesses that are curved and twisted when free of stress.

All lengths are in the rest length, EI1 = 1, EA = 1e4. The clamped start lies in the origin with
d1 = x, d2 = y, d3 = z. With constant k the rest shape is a helix about the axis k/|k|,

    D(s) = R(s k),     r(s) = integral of R(s k) e3.

tip_force    dead force at the end
all_loads    dead force, dead moment and following moment at the end, dead force along the rod
turned       the end held too: turned about its own tangent by a whole turn, and then brought nearer
             to the start along the chord; stable (no conjugate point)
"""

from __future__ import annotations

import numpy as np

from .kirchhoff_rod import (
    Checked,
    Held,
    Loaded,
    Rod,
    checked,
    constant,
    directors,
    follow,
    rotation,
)
from .record import Array, Problem, Reference

START = Held((0.0, 0.0, 0.0), np.eye(3))
NATURAL = np.array([1.0, 2.0, 3.0])
SHARES = (0.25, 0.5, 0.75, 1.0)
NEARER = 0.2


def twisted() -> Rod:
    """The helix of unequal stiffnesses."""
    return Rod(1.0, (1.0, 3.0), 0.8, 1e4, constant(*NATURAL))


def rest_position(natural: Array, s: float) -> Array:
    """The closed form of the rest shape."""
    rate = float(np.linalg.norm(natural))
    axis, tangent = natural / rate, np.array([0.0, 0.0, 1.0])
    along = axis * (axis @ tangent)
    angle = rate * s
    swept = (tangent - along) * np.sin(angle) + np.cross(axis, tangent) * (1.0 - np.cos(angle))
    return np.asarray(s * along + swept / rate, dtype=float)


def tip_force() -> Checked:
    """Dead force (2, -3, 1) at the end."""
    force = np.array([2.0, -3.0, 1.0])
    return checked(follow(twisted(), START, lambda share: Loaded(share * force), steps=4))


def all_loads() -> Checked:
    """All kinds of loads at once."""
    force, moment = np.array([1.0, -2.0, 0.5]), np.array([0.5, 0.4, -0.3])
    follower = np.array([-0.2, 0.6, 0.8])

    def end(share: float) -> Loaded:
        return Loaded(share * force, share * moment, share * follower)

    return checked(follow(twisted(), START, end, steps=4, weight=(0.6, 0.8, -1.5)))


def turned() -> Checked:
    """The helix with both ends held."""
    rate = float(np.linalg.norm(NATURAL))
    tip, frame = rest_position(NATURAL, 1.0), rotation(NATURAL / rate, rate)
    chord = tip / np.linalg.norm(tip)

    def end(share: float) -> Held:
        spin = rotation((0.0, 0.0, 1.0), 2.0 * np.pi * min(1.0, 2.0 * share))
        return Held(tip - NEARER * max(0.0, 2.0 * share - 1.0) * chord, frame @ spin)

    return checked(follow(twisted(), START, end, steps=24))


def references() -> Problem:
    """Positions, frames, strains and the wrench at the start."""
    values: dict[str, Reference] = {}
    for share in SHARES:
        for axis, x in zip("xyz", rest_position(NATURAL, share), strict=True):
            values[f"rest.s{share:g}.{axis}"] = Reference(float(x), 1e-15, "L")
    cases = {"tip_force": tip_force(), "all_loads": all_loads(), "turned": turned()}
    for label, case in cases.items():
        found = case.equilibrium
        error_bar = 10.0 * max(case.error, 1e-12)  # of curvatures and forces of order 10
        for share in SHARES:
            key = f"{label}.s{share:g}"
            for axis, entry in zip("xyz", case.point(share, "L"), strict=True):
                values[f"{key}.{axis}"] = entry
            d = directors(found.at(np.array([share]))[3:7, 0])
            for k in (0, 2):
                for i, axis in enumerate("xyz"):
                    value = Reference(float(d[i, k]), case.error, "1")
                    values[f"{key}.d{k + 1}.{axis}"] = value
            u = found.strains(np.array([share]))[:, 0]
            for name, x in zip(("curvature_1", "curvature_2", "twist"), u[:3], strict=True):
                values[f"{key}.{name}"] = Reference(float(x), error_bar, "1/L")
            values[f"{key}.strain"] = Reference(float(u[3]), error_bar / found.rod.stretching, "1")
        wrench = found.at(np.zeros(1))[7:, 0]
        names = [f"{kind}.{axis}" for kind in ("force", "moment") for axis in "xyz"]
        for name, x in zip(names, wrench, strict=True):
            unit = "EI1/L^2" if name.startswith("force") else "EI1/L"
            values[f"{label}.start.{name}"] = Reference(float(x), 10.0 * error_bar, unit)
    return Problem(
        "curved_twisted_rod",
        "rod of length 1 with EI1 = 1, EI2 = 3, GJ = 0.8, EA = 1e4, natural curvatures 1 and 2 "
        "(about d1, d2) and natural twist 3, held at the origin with d1, d2, d3 along x, y, z. "
        "rest: free of loads; tip_force: dead force (2, -3, 1) at the end; all_loads: dead force "
        "(1, -2, 0.5), dead moment (0.5, 0.4, -0.3), moment (-0.2, 0.6, 0.8) along d1, d2, d3 of "
        "the end, dead force (0.6, 0.8, -1.5) a length; turned: the other end held too, turned "
        "about its tangent by 2 pi, then moved by 0.2 along the chord to the start. curvature_1 "
        "and _2 are the rates of turning about d1 and d2; start: what the rod beyond it exerts "
        "on the clamp",
        "Chebyshev collocation of the 13 equations with quaternions; error: the larger of twice "
        "the change with the degree and the distance to shooting with rotation matrices",
        values,
    )
