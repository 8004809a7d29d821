"""The numbers of the strip, and the exact motion of its tip.

The strip starts along x. The director of its width lies in the y-z plane, at 45 degrees from y, so
that its weight bends it about both axes of its section; where it is bent about both, it twists.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from comparison.scene import Path, reference_path

LENGTH = 1.0  # [m]
WIDTH = 0.02  # [m]
THICKNESS = 0.01  # [m]
TILT = math.pi / 4.0  # [rad] of the width, from y towards z
YOUNGS_MODULUS = 2e7  # [Pa]
POISSONS_RATIO = 0.45
DENSITY = 1000.0  # [kg/m^3]
GRAVITY = (0.0, 0.0, -9.81)  # [m/s^2]

AREA = WIDTH * THICKNESS  # [m^2]
#: Second moments about the axis along the width, about that along the thickness, and polar [m^4].
WEAK = WIDTH * THICKNESS**3 / 12.0
STRONG = THICKNESS * WIDTH**3 / 12.0
POLAR = WEAK + STRONG
#: Saint-Venant's torsion constant of a rectangle twice as wide as thick [m^4].
TORSION = 0.2286817 * WIDTH * THICKNESS**3

SHEAR_MODULUS = YOUNGS_MODULUS / (2.0 + 2.0 * POISSONS_RATIO)  # [Pa]
AXIAL_STIFFNESS = YOUNGS_MODULUS * AREA  # [N]
SHEAR_STIFFNESS = 5.0 / 6.0 * SHEAR_MODULUS * AREA  # [N]
WEAK_STIFFNESS = YOUNGS_MODULUS * WEAK  # [N m^2]
STRONG_STIFFNESS = YOUNGS_MODULUS * STRONG  # [N m^2]
TWISTING_STIFFNESS = SHEAR_MODULUS * TORSION  # [N m^2]

#: Directions of the width and of the thickness at the clamp.
ALONG_WIDTH: NDArray[np.float64] = np.array([0.0, math.cos(TILT), math.sin(TILT)])
ALONG_THICKNESS: NDArray[np.float64] = np.array([0.0, -math.sin(TILT), math.cos(TILT)])


def reference() -> Path:
    """Return the tip of the extensible, unshearable continuum, accurate to 6e-7 m.

    Its sections have inertia against spin about the tangent, and none against other rotations.
    """
    return reference_path("spatial_values.json", "falling_strip", [f"tip.{c}" for c in "xyz"])
