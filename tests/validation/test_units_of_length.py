"""The same equilibria in every unit of length, with positions and angles side by side.

No reference is needed: a scene whose lengths are multiplied by a power of 2, and whose stiffnesses
follow, has the same numbers but for their exponents, so every iterate must be the same to the bit.
"""

import der
import numpy as np
import pytest
from spatial_scenes import rod_through, section

NANOMETRES, KILOMETRES = 2.0**-30, 2.0**10


def crumpled(seed, unit):
    """A naturally straight rod, drawn crumpled between a clamp and a pin.

    Newton's method alone finds no equilibrium: shifts, pseudo-transient continuation and rounding
    of forces beside moments all have a say.
    """
    rng = np.random.default_rng(seed)
    turn = np.cumsum(rng.uniform(-0.8, 0.8, 21))
    rise = rng.uniform(-1, 1)
    along = [np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.full(21, np.sin(rise))]
    edges = np.column_stack(along) / 21
    return rod_through(
        unit * np.concatenate([np.zeros((1, 3)), np.cumsum(edges, axis=0)]),
        section(
            [-0.3, -0.5, -0.16],
            EA=7.5e4,
            EI1=1.3 * unit**2,
            EI2=unit**2,
            GJ=0.12 * unit**2,
            rotary_inertia=1e-4 * unit**2,
        ),
        rod={"natural_curvature": [0, 0]},
        supports=[
            {"rod": "rod", "at": "start", "clamp": True},
            {"rod": "rod", "at": "end", "fix": ["x", "y", "z"]},
        ],
    )


@pytest.mark.parametrize("seed", [11, 16, 18, 22])
def test_equilibria_are_the_same_in_every_unit(seed):
    def found(unit):
        simulation = der.Simulation(der.Scenario.from_dict(crumpled(seed, unit)))
        report = simulation.equilibrium()
        assert report.stability == "stable"
        return report.newton_iterations, np.array(simulation.positions) / unit

    iterations, positions = found(1.0)
    for unit in (NANOMETRES, KILOMETRES):
        there = found(unit)
        assert there[0] == iterations
        np.testing.assert_array_equal(there[1], positions)
