"""The strip in der."""

from __future__ import annotations

from itertools import chain, product
from typing import Any

from comparison import run_der
from comparison.run_der import explicit, implicit
from comparison.scene import Config, Path
from comparison.strip import problem


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip."""
    return run_der.run(scene(int(config["elements"])), config)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried."""
    if quick:
        return [implicit(n, m, "implicit_midpoint") for n, m in ((14, 2), (50, 3), (160, 8))]
    coarse = product((10, 12, 14, 17, 20, 24, 28), (1, 2, 3, 4))
    middle = product((40, 44, 46, 48, 50, 52, 56, 60, 70, 80), (2, 3, 4, 5, 6))
    fine = product((140, 150, 160, 170, 180, 200, 240), (6, 8, 10, 14, 20))
    finest = product((400, 500, 560, 640), (20, 30, 40, 60))
    second_order = [
        implicit(n, m, integrator)
        for n, m in chain(coarse, middle, fine)
        for integrator in ("implicit_midpoint", "tr_bdf2")
    ]
    high_order = [
        implicit(n, m, integrator)
        for n, m in product((48, 52, 60, 150, 160, 180), (1, 2, 3, 4))
        for integrator in ("sdirk4", "sdirk5")
    ]
    return [
        *second_order,
        *(implicit(n, m, "implicit_midpoint") for n, m in finest),
        *high_order,
        *(implicit(n, m, "sdirk5") for n, m in product((400, 500, 560, 640), (4, 6, 8, 10))),
        *(explicit(n) for n in (14, 20, 28, 40, 50, 60, 80)),
    ]


def scene(elements: int) -> dict[str, Any]:
    """Return the parts of the scene that no configuration but the number of elements sets."""
    return {
        "rods": [
            {
                "name": "strip",
                "nodes": elements + 1,
                "from": [0, 0, 0],
                "to": [problem.LENGTH, 0, 0],
                "cross_section": {
                    "rectangle": {"width": problem.WIDTH, "height": problem.THICKNESS},
                    "director": problem.ALONG_WIDTH.tolist(),
                },
                "material": {
                    "youngs_modulus": problem.YOUNGS_MODULUS,
                    "poissons_ratio": problem.POISSONS_RATIO,
                    "density": problem.DENSITY,
                },
            }
        ],
        "supports": [{"rod": "strip", "at": "start", "clamp": True}],
        "loads": [{"gravity": list(problem.GRAVITY)}],
    }
