"""The 45-degree bend: an arc of radius R = 100 in a plane, clamped, with a dead tip force across
the plane (Bathe and Bolourchi, Int. J. Num. Meth. Eng. 14, 1979). Square section of side w,
E = 1e7, no Poisson effect; GJ = EI as those who compare with it take it.

The rod starts along x and bends towards y; the force is along z. The bend of the rod without
shear (`unsheared`) is the reference; `inextensible` is its limit EA = infinity, and `sheared` has
GA = EA/2. R/w = 1e2, 1e3 and 1e4 change w and take P in proportion to EI, so that the limit of the
thin rod is the inextensible one.
"""

from __future__ import annotations

import numpy as np

from .kirchhoff_rod import UPRIGHT, Checked, Held, Loaded, Rod, checked, constant, follow
from .record import Problem, Reference

RADIUS = 100.0
MODULUS = 1e7
QUOTED = {300.0: (58.7802, 22.2453, 40.1894), 600.0: (47.1522, 15.6854, 53.4718)}


def rod(side: float = 1.0, stretches: bool = True, shears: bool = False) -> Rod:
    """The eighth of a circle with a square section of this side."""
    bending, stretching = MODULUS * side**4 / 12.0, MODULUS * side**2
    return Rod(
        RADIUS * np.pi / 4.0,
        (bending, bending),
        bending,
        stretching if stretches else np.inf,
        constant(0.0, 1.0 / RADIUS, 0.0),
        0.5 * stretching if shears else np.inf,
    )


def bent(bend: Rod, load: float) -> Checked:
    """Equilibrium under the dead tip force `load` along z."""
    clamp = Held((0.0, 0.0, 0.0), UPRIGHT)
    scaled = load * bend.length**2 / bend.bending[0]
    steps = int(np.ceil(scaled))
    return checked(
        follow(bend, clamp, lambda share: Loaded((0.0, 0.0, share * load)), steps, segments=2)
    )


def references() -> Problem:
    """Tip positions."""
    values: dict[str, Reference] = {}

    def add(label: str, bend: Rod, load: float) -> None:
        for axis, entry in zip("xyz", bent(bend, load).point(), strict=True):
            values[f"{label}.{axis}"] = entry

    for load, quoted in QUOTED.items():
        add(f"unsheared.{load:g}", rod(), load)
        add(f"inextensible.{load:g}", rod(stretches=False), load)
        add(f"sheared.{load:g}", rod(shears=True), load)
        for axis, number in zip("xyz", quoted, strict=True):
            old = values[f"unsheared.{load:g}.{axis}"]
            values[f"unsheared.{load:g}.{axis}"] = Reference(
                old.value, old.error, old.unit, number, 5e-5
            )
        for slenderness in (1e2, 1e3, 1e4):
            side = RADIUS / slenderness
            add(f"slender.{slenderness:g}.{load:g}", rod(side), load * side**4)
    return Problem(
        "bent_cantilever",
        "45-degree bend, R = 100, square side w = 1 (slender.R/w: w = R/(R/w), load times w^4), "
        "E = 1e7, GJ = EI: tip position, x along the initial tangent, y in the plane, z along "
        "the load 300 or 600; unsheared: EA = E w^2, no shear; inextensible: no stretch either; "
        "sheared: GA = EA/2",
        "Chebyshev collocation of the 13 equations with quaternions; error: the larger of twice "
        "the change with the degree and the distance to shooting with rotation matrices",
        values,
    )
