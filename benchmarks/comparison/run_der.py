"""Runs of der: the parts of a scene that a configuration sets, and the timed loop."""

from __future__ import annotations

import time
from typing import Any

import der
import numpy as np

from comparison.scene import DURATION, FRAME_TIME, FRAMES, Config, Path, RunFailedError, time_step


def run(scene: dict[str, Any], config: Config) -> tuple[float, Path]:
    """Run a scene; return CPU seconds of the time loop and the path of the last node.

    Keys of a configuration besides ``elements`` and ``steps``: ``integrator``, and ``tolerance``,
    the residual at which Newton's method stops.
    """
    simulation = der.Simulation(der.Scenario.from_dict({**scene, **controls(config)}))
    start = time.process_time()
    recording = simulation.record()  # the run in C++, without what `run` makes of it in Python
    seconds = time.process_time() - start
    if recording.error is not None:
        raise RunFailedError(str(recording.error))
    return seconds, recording.positions[:, -1]


def run_batch(batch: der.Batch, steps: int) -> tuple[float, list[Path]]:
    """Run a batch through the second, with so many steps from one frame to the next.

    Returns
    -------
    seconds, paths
        CPU seconds of all steps in one call, and the path of the last node of each member, taken in
        a second run.
    """
    start = time.process_time()
    batch.step(FRAMES * steps)
    seconds = time.process_time() - start
    batch.reset()
    tips = [batch.positions[:, -1].copy()]
    for _ in range(FRAMES):
        batch.step(steps)
        tips.append(batch.positions[:, -1].copy())
    return seconds, list(np.array(tips).transpose(1, 0, 2))


def implicit(elements: int, steps: int, integrator: str) -> Config:
    """Return a configuration of an implicit integrator."""
    # The default tolerance, 1e-9, takes up to twice as many iterations; it moves the errors in
    # their third digit.
    return {"elements": elements, "integrator": integrator, "steps": steps, "tolerance": 1e-3}


def explicit(elements: int) -> Config:
    """Return a configuration of `verlet` with its largest stable step."""
    return {"elements": elements, "integrator": "verlet", "steps": "fewest"}


def controls(config: Config) -> dict[str, Any]:
    """Return the parts of a scene that a configuration sets."""
    integration: dict[str, Any] = {
        "duration": DURATION,
        "step": time_step(config),
        "integrator": config["integrator"],
    }
    if config["integrator"] == "verlet":
        # The guard's estimate of the stable step is on the safe side; all codes here may try more.
        integration["allow_unstable"] = True
    controls: dict[str, Any] = {"time": integration, "output": {"every": FRAME_TIME}}
    if "tolerance" in config:
        controls["solver"] = {
            "residual_tolerance": config["tolerance"],
            "step_tolerance": config["tolerance"],
        }
    return controls
