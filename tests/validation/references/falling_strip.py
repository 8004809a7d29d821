"""A straight soft strip, clamped askew, falls: it bends about both axes of its section and twists.

By the elements and the collocation of `spatial_motion.py`, whose rods start along z with d1 = x and
d2 = y; here the rod starts along x, with its width d1 in the y-z plane at `TILT` from y, and
gravity points along -z.
"""

from __future__ import annotations

import numpy as np

from .kirchhoff_rod import Rod
from .princeton_beam import torsion_constant
from .record import Array, Problem, Reference
from .spatial_motion import Case, Motion, Refinement, still
from .swing import Collocation

LENGTH, WIDTH, THICKNESS = 1.0, 0.02, 0.01
MODULUS, POISSON, DENSITY, GRAVITY = 2e7, 0.45, 1000.0, 9.81
TILT = np.pi / 4.0
FRAMES = 100  # in the second

#: Rows: d1, d2 and the tangent of the clamp in the scene's x, y, z.
CLAMP = np.array(
    [[0.0, np.cos(TILT), np.sin(TILT)], [0.0, -np.sin(TILT), np.cos(TILT)], [1.0, 0.0, 0.0]]
)

FINE = Refinement(6, 11, Collocation("gauss", 3), 1600)
OTHERS = (
    Refinement(6, 11, Collocation("gauss", 3), 800),  # time
    Refinement(8, 9, Collocation("radau", 3), 1600),  # space and method
)


def strip() -> Case:
    """The strip in the axes of its clamp."""
    area = WIDTH * THICKNESS
    weak, strong = area * THICKNESS**2 / 12.0, area * WIDTH**2 / 12.0
    shear = MODULUS / (2.0 + 2.0 * POISSON)
    twisting = shear * torsion_constant(WIDTH, THICKNESS)
    weight = CLAMP @ [0.0, 0.0, -GRAVITY * DENSITY * area]
    return Case(
        Rod(LENGTH, (MODULUS * weak, MODULUS * strong), twisting, MODULUS * area),
        DENSITY * area,
        DENSITY * (weak + strong),
        (float(weight[0]), float(weight[1]), float(weight[2])),
        (0.0, 0.0, 0.0),
        still,
        1.0,
    )


def path(resolution: Refinement) -> Array:
    """Places of the tip at even times from 0 to 1 s, shape (FRAMES + 1, 3), in the scene's axes."""
    case = strip()
    dynamics, start = case.start(resolution.elements, resolution.degree)
    motion = Motion(case, dynamics, start, resolution.method, case.duration / resolution.steps)
    states = [motion.position]
    for k in range(resolution.steps):
        motion.step()
        if (k + 1) % (resolution.steps // FRAMES) == 0:
            states.append(motion.position)
    return np.asarray(dynamics.mesh.position(np.array(states), LENGTH) @ CLAMP)


def references() -> Problem:
    """Path of the tip every 0.01 s."""
    fine = path(FINE)
    error = max(float(np.abs(fine - path(other)).max()) for other in OTHERS)
    values = {
        f"tip.{axis}": Reference([float(x) for x in fine[:, i]], error, "m")
        for i, axis in enumerate("xyz")
    }
    return Problem(
        "falling_strip",
        "strip of 1 m from the origin along x, 20 mm wide (d1, at 45 degrees from y towards z) and "
        "10 mm thick, E 20 MPa, nu 0.45, 1000 kg/m3, clamped at the origin, falls from rest along "
        "-z with g = 9.81; tip at t = 0, 0.01, .., 1 s. Spin has the inertia rho times the polar "
        "moment of area, with the couple j w t_t on the centre line; other rotations have none",
        "C1 elements for r and C0 elements for the angle of the section: 6 of degree 11, Gauss "
        "with 3 stages, 1600 steps; error: largest change from 800 steps, and from 8 elements of "
        "degree 9 with Radau IIA of 3 stages",
        values,
    )
