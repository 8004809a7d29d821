"""The Princeton beam: a flat aluminium cantilever with a weight at its tip, the section turned by
an angle against the weight (Dowell and Traybar, Princeton University AMS reports 1194 and 1257,
1975).

Nominal data: 7075 aluminium, E = 10.4e6 psi, Poisson's ratio 0.31, length 20 in, section 0.5 in by
0.125 in, weights of 1, 2 and 3 lb; the beam's own weight is left out. At the angle 0 the weight
acts along the wide side of the section, at 90 degrees along the thin one. The torsion constant
of a rectangle a >= b is Saint-Venant's (Timoshenko and Goodier, Theory of Elasticity, 109)

    J = a b^3/3 (1 - 192 b/(pi^5 a) sum over odd n of tanh(n pi a/(2 b))/n^5)
"""

from __future__ import annotations

import numpy as np

from .kirchhoff_rod import Checked, Held, Loaded, Rod, checked, follow
from .record import Array, Problem, Reference, exact

INCH = 0.0254
POUND = 4.4482216152605  # of force (N)
LENGTH, WIDTH, THICKNESS = 20.0 * INCH, 0.5 * INCH, 0.125 * INCH
MODULUS = 10.4e6 * POUND / INCH**2
SHEAR_MODULUS = MODULUS / (2.0 * 1.31)
CLAMP = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""d1 (along the width) = y, d2 (along the thickness) = z, d3 = x."""


def torsion_constant(long: float, short: float) -> float:
    """Saint-Venant's torsion constant of a rectangle (the length of its sides to the fourth)."""
    n = np.arange(1, 400, 2)
    series = float(np.sum(np.tanh(0.5 * n * np.pi * long / short) / n**5.0))
    return long * short**3 / 3.0 * (1.0 - 192.0 * short / (np.pi**5 * long) * series)


def rod() -> Rod:
    """The beam; EI1, about the width, is the weak stiffness."""
    weak = MODULUS * WIDTH * THICKNESS**3 / 12.0
    strong = MODULUS * THICKNESS * WIDTH**3 / 12.0
    twisting = SHEAR_MODULUS * torsion_constant(WIDTH, THICKNESS)
    return Rod(LENGTH, (weak, strong), twisting, MODULUS * WIDTH * THICKNESS)


def loaded(weight: float, angle: float) -> Checked:
    """Equilibrium under the tip weight (N); `angle` (degrees) between it and the width."""
    turned = np.deg2rad(angle)
    force = weight * np.array([0.0, np.cos(turned), np.sin(turned)])
    steps = int(np.ceil(weight))
    return checked(
        follow(
            rod(),
            Held((0.0, 0.0, 0.0), CLAMP),
            lambda share: Loaded(share * force),
            steps,
            segments=2,
        )
    )


def twist(frame: Array) -> float:
    """Angle (degrees) by which the width, seen along the undeformed beam, has turned."""
    return float(np.rad2deg(np.arctan2(frame[2, 0], frame[1, 0])))


def references() -> Problem:
    """Tip displacements along the undeformed section, and the twist of the tip."""
    beam = rod()
    values: dict[str, Reference] = {
        "EI_weak": exact(beam.bending[0], "N m^2"),
        "EI_strong": exact(beam.bending[1], "N m^2"),
        "GJ": exact(beam.twisting, "N m^2"),
        "EA": exact(beam.stretching, "N"),
        "torsion_constant.4to1": exact(torsion_constant(4.0, 1.0), "side^4"),
    }
    for pounds in (1, 2, 3):
        for angle in range(0, 91, 15):
            found = loaded(pounds * POUND, float(angle))
            x, y, z = found.point(unit="m")
            label = f"{pounds}lb.{angle}"
            values[f"{label}.axial"] = Reference(
                float(found.equilibrium.tip[0]) - LENGTH, x.error, "m"
            )
            values[f"{label}.chordwise"] = y
            values[f"{label}.flapwise"] = z
            turned = twist(found.equilibrium.tip_frame)
            values[f"{label}.twist"] = Reference(
                turned, float(np.rad2deg(found.angle_error)), "deg"
            )
    return Problem(
        "princeton_beam",
        "flat cantilever of 7075 aluminium, E 10.4e6 psi, nu 0.31, 20 in by 0.5 in by 0.125 in, "
        "tip weight 1, 2, 3 lb at 0 to 90 degrees from the section's width: displacement of the "
        "tip along the beam (axial), the width (chordwise) and the thickness (flapwise), and the "
        "angle by which the width has turned, seen along the undeformed beam",
        "Chebyshev collocation of the 13 equations with quaternions; error: the larger of twice "
        "the change with the degree and the distance to shooting with rotation matrices",
        values,
    )
