"""A ring of rectangular section that folds into three coils (Goto, Watanabe, Kasugai and Obata,
Int. J. Solids Struct. 29, 1992).

The circle of radius 1, free of stress, is held at one point. The opposite point is turned about
the diameter between them by 2 pi and brought nearer: it ends upon three coils of radius 1/3. There
the rod bends in its plane alone, by 2 more than in its natural shape, under a moment of 2 EI and no
force: a closed form.

On the way the two halves are each other's image under half a turn about the diameter. One of them
is found between two held ends, from the point that is held still, in the origin, to the other one.
The section has the sides 1/3 and 1 and Poisson's ratio 0.3: EI2 = 9 EI1 and GJ = 1.2154 EI1, EI1
for bending in the ring's plane.
"""

from __future__ import annotations

import numpy as np

from .kirchhoff_rod import Checked, Held, Rod, checked, constant, follow, rotation
from .record import Array, Problem, Reference

BENDING = (1.0, 9.0)
TWISTING = 1.2154
STRETCHING = 1e4
NEARER = 4.0 / 3.0
SHARES = (0.25, 0.6)
PLACES = {"quarter": 0.25 * np.pi, "half": 0.5 * np.pi}
FRAME = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
"""At the point that is held still: columns d1 = -z, d2 = -x, d3 = y."""


def opposite(share: float) -> Held:
    """The point on the other side, at a share of the way."""
    drawn = rotation((0.0, 0.0, -1.0), np.pi) @ FRAME
    return Held(
        (2.0 - share * NEARER, 0.0, 0.0), rotation((1.0, 0.0, 0.0), 2.0 * np.pi * share) @ drawn
    )


def folded(share: float) -> Checked:
    """A half of the ring."""
    rod = Rod(np.pi, BENDING, TWISTING, STRETCHING, constant(1.0, 0.0, 0.0))
    start = Held((0.0, 0.0, 0.0), FRAME)
    steps = int(np.ceil(32 * share))
    return checked(follow(rod, start, lambda part: opposite(part * share), steps))


def moments(case: Checked, s: float) -> Array:
    """Moments about d1 and d2, which bend towards -d2 and d1, and the torque."""
    found = case.equilibrium
    place = np.array([s])
    u = found.strains(place)[:3, 0] - found.rod.natural(place)[:, 0]
    return np.asarray(found.rod.stiffness * u)


def references() -> Problem:
    """Positions and moments at a quarter and in the middle of a half."""
    values: dict[str, Reference] = {}
    for share in SHARES:
        case = folded(share)
        for label, s in PLACES.items():
            key = f"share{share:g}.{label}"
            for axis, entry in zip("xyz", case.point(s, "R"), strict=True):
                values[f"{key}.{axis}"] = entry
            names = ("moment_1", "moment_2", "torque")
            for name, x in zip(names, moments(case, s), strict=True):
                values[f"{key}.{name}"] = Reference(float(x), 20.0 * case.error, "EI1/R")
    return Problem(
        "deployable_ring",
        "circle of radius R = 1, free of stress, in the x-y plane, held in the origin with the "
        "tangent along y; the opposite point is turned about x by 2 pi share and moved by "
        "-4/3 share along x. EI = 1 in the plane and 9 across it, GJ = 1.2154, EA = 1e4. quarter "
        "and half: at arc lengths pi/4 and pi/2 from the origin. moment_1 bends towards the "
        "director that points inwards in the drawn shape, moment_2 towards t x this one",
        "Chebyshev collocation of one half with quaternions; error: the larger of twice the change "
        "with the degree and the distance to shooting with rotation matrices",
        values,
    )
