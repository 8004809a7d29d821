"""A soft clamped rod that swings down under its weight.

Reference: `references/swing.py`, cubic finite elements with high-order collocation in time.
"""

import der
import numpy as np
import pytest
from scenes import swing

SWING = swing(51, step=2e-4, integrator="implicit_midpoint")


def tip_error(reference, **changes):
    """Largest distance of the tip from the reference over the second [m]."""
    result = der.run(der.Scenario.from_dict(SWING).with_(**changes))
    exact = np.stack([reference("swing", f"soft.tip.{c}") for c in "xy"], axis=1)
    return np.linalg.norm(result.positions[:, -1] - exact, axis=1).max()


def test_converges_to_the_continuum_at_second_order_in_space(reference, fitted_order):
    nodes = [21, 41, 81]
    errors = [tip_error(reference, **{"rods.arm.nodes": n}) for n in nodes]
    assert fitted_order([1 / (n - 1) for n in nodes], errors) > 1.9


@pytest.mark.parametrize(
    "integrator", ["implicit_midpoint", "generalized_alpha", "tr_bdf2", "bdf2"]
)
def test_second_order_steppers_reach_the_continuum(reference, integrator):
    """At 51 nodes the error in space is 2e-4 m; that in time is 2e-5 m for the midpoint rule and up
    to 2e-4 m for the damping ones."""
    assert tip_error(reference, **{"time.integrator": integrator}) < 4e-4
