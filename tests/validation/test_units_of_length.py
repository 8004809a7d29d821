"""The same answers in every unit of length, with positions and angles side by side.

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


def column(unit, turned):
    """A column in space, pressed along its axis, that can buckle about both axes of its section."""
    axes = np.linalg.qr(np.random.default_rng(turned).standard_normal((3, 3)))[0]
    stiffness = {"EA": 1e6, "EI1": unit**2, "EI2": 3 * unit**2, "GJ": 0.7 * unit**2}
    return {
        "model": "spatial",
        "rods": [
            {
                "name": "rod",
                "nodes": 41,
                "from": [0, 0, 0],
                "to": (unit * axes[0]).tolist(),
                "cross_section": {
                    "stiffness": {**stiffness, "mass_per_length": 1},
                    "director": axes[1].tolist(),
                },
            }
        ],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "loads": [{"point_force": {"rod": "rod", "at": "end", "force": (-axes[0]).tolist()}}],
        "analysis": {"buckling": {"count": 4}},
    }


@pytest.mark.parametrize("unit", [1e-9, 5e-5, 1.0, 1e5])
def test_buckling_loads_do_not_depend_on_the_unit_of_length(unit):
    """Euler's column about the weak and the strong axis; the error of 40 edges is below 1 %.

    Between units only rounding differs: axes that are not powers of 2 and the bisection, 1e-13.
    """
    exact = np.pi**2 / 4 * np.array([1, 3, 9, 25])  # (2 n + 1)^2, times 3 about the strong axis
    in_metres = np.array(der.run(column(1.0, 0)).summary["load_factors"])
    np.testing.assert_allclose(in_metres, exact, rtol=1e-2)
    for turned in range(3):
        factors = der.run(column(unit, turned)).summary["load_factors"]
        np.testing.assert_allclose(factors, in_metres, rtol=1e-8)


@pytest.mark.parametrize(("length", "EI"), [(1e-6, 1e-22), (1e-5, 2e-23), (1e-9, 1e-30)])
def test_springs_against_turning_have_the_roundings_of_their_own_size(length, EI):
    """Frequencies of a bent rod on such a spring, against those in metres and newtons."""

    def frequencies(a, stiffness):
        section = {"EA": 1e4 * stiffness / a**2, "EI": stiffness, "GJ": stiffness / 2}
        force = stiffness / a**2
        scene = {
            "model": "spatial",
            "rods": [
                {
                    "name": "rod",
                    "nodes": 21,
                    "from": [0, 0, 0],
                    "to": [a, 0, 0],
                    "cross_section": {
                        "stiffness": {**section, "mass_per_length": stiffness / a**4}
                    },
                }
            ],
            "supports": [
                {"rod": "rod", "at": "start", "clamp": True},
                {"rod": "rod", "at": "end", "spring": {"rotational_stiffness": stiffness / a}},
            ],
            "loads": [
                {"point_force": {"rod": "rod", "at": "end", "force": [0, force, 0.5 * force]}}
            ],
            "analysis": "modes",
        }
        simulation = der.Simulation(scene)
        simulation.equilibrium()
        return simulation.modes(4).frequencies

    np.testing.assert_allclose(frequencies(length, EI), frequencies(1.0, 1.0), rtol=1e-9)
