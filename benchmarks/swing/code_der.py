"""The swing in der."""

from __future__ import annotations

import time
from itertools import chain, product
from typing import Any

import der

from swing import problem
from swing.problem import Config, Path2D, RunFailedError


def run(config: Config) -> tuple[float, Path2D]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip.

    Keys besides ``elements`` and ``steps``: ``integrator``, and ``tolerance``, the residual at
    which Newton's method stops.
    """
    simulation = der.Simulation(der.Scenario.from_dict(_scene(config)))
    start = time.process_time()
    recording = simulation.record()  # the run in C++, without what `run` makes of it in Python
    seconds = time.process_time() - start
    if recording.failed:
        raise RunFailedError(recording.message)
    return seconds, recording.positions[:, -1]


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried.

    Adaptive steps (`time.tolerance`) are not among them: a constant step that is tuned by hand, as
    here, is cheaper for the same error.
    """
    if quick:
        return [_implicit(n, m, "implicit_midpoint") for n, m in ((10, 2), (24, 3), (100, 14))]
    coarse = product((8, 10, 12, 14, 17, 20, 24, 28, 32, 40, 50, 60), (1, 2, 3, 4, 5))
    middle = product((60, 70, 80, 90, 100, 120, 140, 160), (5, 7, 10, 14, 20))
    fine = product((160, 200, 240, 320, 400), (14, 20, 30, 40, 50))
    finest = product((500, 600, 700, 800), (40, 50, 60, 80))
    implicit = [
        _implicit(n, m, integrator)
        for n, m in chain(coarse, middle, fine, finest)
        for integrator in ("implicit_midpoint", "tr_bdf2")
        if n < 500 or integrator != "tr_bdf2"
    ]
    # Five stages a step, of order 5: fewer steps.
    implicit += [
        _implicit(n, m, "sdirk5")
        for n, m in product(
            (28, 40, 50, 60, 70, 80, 85, 90, 110, 140, 180, 240, 250, 260, 280, 320),
            (1, 2, 3, 4, 5, 6),
        )
    ]
    explicit: list[Config] = [
        {"elements": n, "integrator": "verlet", "steps": "fewest"}
        for n in (10, 14, 20, 30, 40, 50, 60, 80, 100, 140)
    ]
    return implicit + explicit


def _implicit(elements: int, steps: int, integrator: str) -> Config:
    # The default tolerance, 1e-9, takes up to twice as many iterations; it moves the errors in
    # their third digit.
    return {"elements": elements, "integrator": integrator, "steps": steps, "tolerance": 1e-3}


def _scene(config: Config) -> dict[str, Any]:
    scene: dict[str, Any] = {
        "rods": [
            {
                "name": "rod",
                "nodes": int(config["elements"]) + 1,
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
        "loads": [{"gravity": [0, -problem.GRAVITY]}],
        "time": {
            "duration": problem.FRAMES * problem.FRAME_TIME,
            "step": problem.time_step(config),
            "integrator": config["integrator"],
        },
        "output": {"every": problem.FRAME_TIME},
    }
    if config["integrator"] == "verlet":
        # The guard's estimate of the stable step is on the safe side; all codes here may try more.
        scene["time"]["allow_unstable"] = True
    if "tolerance" in config:
        scene["solver"] = {
            "residual_tolerance": config["tolerance"],
            "step_tolerance": config["tolerance"],
        }
    return scene
