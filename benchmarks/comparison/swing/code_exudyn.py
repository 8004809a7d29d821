"""The swing in Exudyn: cubic elements ANCFCable2D, generalized-alpha; full Newton is slower."""

from __future__ import annotations

from itertools import pairwise, product
from typing import Any

from comparison import run_exudyn
from comparison.run_exudyn import exudyn, items
from comparison.scene import Config, Path
from comparison.swing import problem

# Coordinates of a node, in its order, that a clamp holds: x, y and the slope's y. The slope's x
# stays free, since the rod stretches at the wall too.
CLAMPED = (0, 1, 3)


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip.

    Keys besides those of `run_exudyn.run`: ``integration``, of the elements' energies (0: full, 2:
    mixed Lobatto and Gauss).
    """
    return run_exudyn.run(*_model(config), config, dimension=2)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried."""
    if quick:
        return [
            configuration(n, m, 1e-3, 0.5, 1.0, 0) for n, m in ((12, 2), (20, 3), (24, 5), (32, 10))
        ]
    coarse = product((10, 11, 12, 14, 16, 18, 20, 22, 24), (2, 3, 4, 5))
    middle = product((24, 28, 32, 36), (4, 5, 7, 10, 14))
    fine = product((32, 34, 36, 40, 48), (10, 12, 14, 17, 20, 30, 40))
    finest = product((48, 52, 56, 64), (40, 50, 60, 80))
    schemes = list(product((1e-2, 1e-3), (0.3, 0.5), (1.0, 0.9)))
    return [
        *(configuration(n, m, *s, i) for (n, m), s, i in product(coarse, schemes, (0, 2))),
        *(configuration(n, m, *s, 0) for (n, m), s in product(middle, schemes)),
        *(
            configuration(n, m, t, 0.3, r, 0)
            for (n, m), t, r in product(fine, (1e-3, 1e-4), (1.0, 0.9))
        ),
        *(configuration(n, m, t, 0.3, 1.0, 0) for (n, m), t in product(finest, (1e-3, 1e-4))),
    ]


def configuration(
    elements: int,
    steps: int,
    tolerance: float,
    contractivity: float,
    spectral_radius: float,
    integration: int,
) -> Config:
    """Return a configuration."""
    return {
        "elements": elements,
        "steps": steps,
        "tolerance": tolerance,
        "contractivity": contractivity,
        "spectral_radius": spectral_radius,
        "integration": integration,
    }


def _model(config: Config) -> tuple[Any, Any]:
    """Return the system and its sensor of the tip."""
    system = exudyn.SystemContainer().AddSystem()
    elements = int(config["elements"])
    edge = problem.LENGTH / elements
    nodes = [
        system.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[i * edge, 0, 1, 0]))
        for i in range(elements + 1)
    ]
    for ends in pairwise(nodes):
        cable = system.AddObject(
            items.ObjectANCFCable2D(
                nodeNumbers=list(ends),
                length=edge,
                massPerLength=problem.DENSITY * problem.AREA,
                axialStiffness=problem.YOUNGS_MODULUS * problem.AREA,
                bendingStiffness=problem.YOUNGS_MODULUS * problem.SECOND_MOMENT,
                useReducedOrderIntegration=int(config["integration"]),
            )
        )
        run_exudyn.add_weight(system, cable, (*problem.GRAVITY, 0.0))
    run_exudyn.hold(system, nodes[0], CLAMPED)
    tip = run_exudyn.add_sensor(system, nodes[-1])
    system.Assemble()
    return system, tip
