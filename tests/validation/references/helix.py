"""A straight rod with equal bending stiffnesses under an end moment: a helix, in closed form.

Without force the moment m is constant, and the tangent turns about it at the rate |m|/EI, for
t' = (m x t)/EI + (..) t x t. The section turns with the tangent and, besides, about it at the rate
m.t (1/GJ - 1/EI). With R(v) the rotation by the vector v and D the frame,

    D(s) = R(s m/EI) D(0) R(s (m.t) (1/GJ - 1/EI) e3)
    r(s) = integral of R(s m/EI) t(0)

A moment that follows the section with the components M along d_i at the end therefore has m =
D(0) R(-(that spin)) M. For GJ = EI, M = m along D(0): the helix of radius R0 and height h in n
turns has

    M = EI/(R0 (1 + c^2)) (e_b + c e_t),   c = h/(2 pi n R0),   L = 2 pi n R0 sqrt(1 + c^2),

with e_t along the tangent and e_b a direction of the section (Meier, Popp and Wall, Comput.
Methods Appl. Mech. Eng. 278, 2014).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .kirchhoff_rod import UPRIGHT, Held, Loaded, Rod, checked, follow, rotation
from .record import Array, Problem, Reference


@dataclass(frozen=True)
class Helix:
    """A straight rod, clamped along x with d1 = y and d2 = z, under the moment `follower` of its
    end (along d1, d2, d3).
    """

    length: float
    bending: float
    twisting: float
    follower: tuple[float, float, float]

    @property
    def _spin(self) -> float:
        """Turning of the section about the tangent, besides that of the helix, a length."""
        return self.follower[2] * (1.0 / self.twisting - 1.0 / self.bending)

    @property
    def moment(self) -> Array:
        """The constant moment in fixed axes."""
        back = rotation((0.0, 0.0, 1.0), self._spin * self.length)
        # The end's section is D(L) = R(L m/EI) D(0) back, and the first rotation keeps m.
        return np.asarray(UPRIGHT @ back @ np.asarray(self.follower), dtype=float)

    def position(self, s: float) -> Array:
        """Place at arc length `s`."""
        size = float(np.linalg.norm(self.moment))
        axis, tangent = self.moment / size, UPRIGHT[:, 2]
        angle = s * size / self.bending
        along = axis * (axis @ tangent)
        across = tangent - along
        swept = across * np.sin(angle) + np.cross(axis, tangent) * (1.0 - np.cos(angle))
        return np.asarray(s * along + swept * self.bending / size, dtype=float)

    def frame(self, s: float) -> Array:
        """Columns d1, d2, d3 at arc length `s`."""
        size = float(np.linalg.norm(self.moment))
        turned = rotation(self.moment / size, s * size / self.bending)
        return np.asarray(turned @ UPRIGHT @ rotation((0.0, 0.0, 1.0), s * self._spin), dtype=float)


def wound(radius: float, height: float, turns: float, bending: float, ratio: float) -> Helix:
    """The end moment that makes the helix of this radius and height for GJ = EI, on a rod with
    GJ = `ratio` EI.
    """
    slope = height / (2.0 * np.pi * turns * radius)
    size = bending / (radius * (1.0 + slope**2))
    length = 2.0 * np.pi * turns * radius * np.sqrt(1.0 + slope**2)
    return Helix(float(length), bending, ratio * bending, (0.0, size, slope * size))


def distance_to_equilibrium(helix: Helix) -> float:
    """Largest distance between the closed form and a solution of the boundary value problem."""
    rod = Rod(helix.length, (helix.bending, helix.bending), helix.twisting)
    found = checked(
        follow(
            rod,
            Held((0.0, 0.0, 0.0), UPRIGHT),
            lambda share: Loaded(follower=share * np.array(helix.follower)),
            steps=16,
        )
    ).equilibrium
    places = np.linspace(0.0, helix.length, 21)
    exact = np.array([helix.position(s) for s in places]).T
    gap = float(np.abs(found.at(places)[:3] - exact).max())
    turned = float(np.abs(found.tip_frame - helix.frame(helix.length)).max())
    return max(gap, turned * helix.length)


def references() -> Problem:
    """Length, moment, and positions at quarters of the length."""
    values: dict[str, Reference] = {}
    for ratio in (1.0, 2.0 / 3.0):
        helix = wound(10.0, 50.0, 2.0, 1.0, ratio)
        error = distance_to_equilibrium(helix)
        label = f"GJ{ratio:.3g}"
        values[f"{label}.length"] = Reference(helix.length, 1e-13, "length")
        for k in (1, 2):
            entry = Reference(helix.follower[k], 1e-16, "EI/length")
            values[f"{label}.follower_moment.d{k + 1}"] = entry
        for share in (0.25, 0.5, 0.75, 1.0):
            for axis, x in zip("xyz", helix.position(share * helix.length), strict=True):
                key = f"{label}.{share:g}.{axis}"
                values[key] = Reference(float(x), max(error, 1e-13 * helix.length), "length")
        for k in range(3):
            for axis, x in zip("xyz", helix.frame(helix.length)[:, k], strict=True):
                error_bar = max(error / helix.length, 1e-14)
                values[f"{label}.tip.d{k + 1}.{axis}"] = Reference(float(x), error_bar, "1")
    return Problem(
        "helix",
        "straight rod, EI = 1, clamped along x with d1 = y, d2 = z, under an end moment that "
        "follows the section, which for GJ = EI makes a helix of radius 10 and height 50 in 2 "
        "turns: positions at shares of the length, and the frame of the end; also with the same "
        "moment and GJ = 2/3 EI",
        "closed form; error: largest distance to Chebyshev collocation of the boundary value "
        "problem",
        values,
    )
