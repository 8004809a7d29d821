"""The numbers of the swing, and the exact motion of its tip."""

from __future__ import annotations

import math

from comparison.scene import Path, reference_path

LENGTH = 1.0  # [m]
RADIUS = 0.01  # [m]
YOUNGS_MODULUS = 1e7  # [Pa]
DENSITY = 1000.0  # [kg/m^3]
GRAVITY = (0.0, -9.81)  # [m/s^2]
AREA = math.pi * RADIUS**2  # [m^2]
SECOND_MOMENT = math.pi / 4.0 * RADIUS**4  # [m^4]


def reference() -> Path:
    """Return the tip of the extensible, unshearable continuum, accurate to 2e-8 m."""
    return reference_path("values.json", "swing", [f"soft.tip.{c}" for c in "xy"])
