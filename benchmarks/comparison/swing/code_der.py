"""The swing in der."""

from __future__ import annotations

from itertools import chain, product
from typing import Any

from comparison import run_der
from comparison.run_der import explicit, implicit
from comparison.scene import Config, Path
from comparison.swing import problem


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip."""
    return run_der.run(scene(int(config["elements"])), config)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried.

    Adaptive steps (`time.tolerance`) are not among them: a constant step that is tuned by hand, as
    here, is cheaper for the same error.
    """
    if quick:
        return [implicit(n, m, "implicit_midpoint") for n, m in ((10, 2), (24, 3), (100, 14))]
    coarse = product((8, 10, 12, 14, 17, 20, 24, 28, 32, 40, 50, 60), (1, 2, 3, 4, 5))
    middle = product((60, 70, 80, 90, 100, 120, 140, 160), (5, 7, 10, 14, 20))
    fine = product((160, 200, 240, 320, 400), (14, 20, 30, 40, 50))
    finest = product((500, 600, 700, 800), (40, 50, 60, 80))
    second_order = [
        implicit(n, m, integrator)
        for n, m in chain(coarse, middle, fine, finest)
        for integrator in ("implicit_midpoint", "tr_bdf2")
        if n < 500 or integrator != "tr_bdf2"
    ]
    # Five stages a step, of order 5: fewer steps.
    fifth_order = [
        implicit(n, m, "sdirk5")
        for n, m in product(
            (28, 40, 50, 60, 70, 80, 85, 90, 110, 140, 180, 240, 250, 260, 280, 320),
            (1, 2, 3, 4, 5, 6),
        )
    ]
    return [
        *second_order,
        *fifth_order,
        *(explicit(n) for n in (10, 14, 20, 30, 40, 50, 60, 80, 100, 140)),
    ]


def scene(elements: int) -> dict[str, Any]:
    """Return the parts of the scene that no configuration but the number of elements sets."""
    return {
        "rods": [
            {
                "name": "rod",
                "nodes": elements + 1,
                "from": [0, 0],
                "to": [problem.LENGTH, 0],
                "cross_section": {"circle": {"radius": problem.RADIUS}},
                "material": {
                    "youngs_modulus": problem.YOUNGS_MODULUS,
                    "density": problem.DENSITY,
                },
            }
        ],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "loads": [{"gravity": list(problem.GRAVITY)}],
    }
