"""The swing: its numbers, the exact motion of the tip, and the result of a run of a code."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

LENGTH = 1.0  # [m]
RADIUS = 0.01  # [m]
YOUNGS_MODULUS = 1e7  # [Pa]
DENSITY = 1000.0  # [kg/m^3]
GRAVITY = 9.81  # [m/s^2], downwards (-y)
AREA = math.pi * RADIUS**2  # [m^2]
SECOND_MOMENT = math.pi / 4.0 * RADIUS**4  # [m^4]

#: The tip is compared 100 times after the start, every hundredth of a second.
FRAMES = 100
FRAME_TIME = 0.01  # [s]

REFERENCES = Path(__file__).resolve().parents[2] / "tests/validation/references/values.json"

#: The varied parameters: names and values as an adapter understands them. All have ``elements``,
#: and ``steps``, the number of time steps from one frame to the next.
Config: TypeAlias = Mapping[str, str | int | float | bool]

#: Tip positions x, y [m] at all frames and the start, shape (FRAMES + 1, 2).
Path2D: TypeAlias = NDArray[np.float64]


class RunFailedError(Exception):
    """A code did not get through the second: unstable, or its solver gave up."""


def reference() -> Path2D:
    """Return the tip of the extensible, unshearable continuum, accurate to 2e-8 m."""
    values = json.loads(REFERENCES.read_text(encoding="utf-8"))["swing"]["values"]
    return np.column_stack([values[f"soft.tip.{c}"]["value"] for c in "xy"])


def distance(path: Path2D, other: Path2D) -> float:
    """Return the largest distance of two tips over all frames [m]."""
    return float(np.linalg.norm(path - other, axis=1).max())


def steps_per_frame(config: Config) -> int:
    """Return the number of time steps from one frame to the next."""
    return int(config["steps"])


def time_step(config: Config) -> float:
    """Return the time step [s]."""
    return FRAME_TIME / steps_per_frame(config)


def march(advance: Callable[[], object], tip: Callable[[], ArrayLike]) -> tuple[float, Path2D]:
    """Let a code step through the second and time it.

    Parameters
    ----------
    advance
        Brings the code from one frame to the next.
    tip
        Gives the position of the tip; only x and y, its first two entries, are used.

    Returns
    -------
    seconds
        CPU seconds of the loop.
    path
        The tip at all frames.

    Raises
    ------
    RunFailedError
        If the tip leaves the reach of the rod, or is not a number any more.
    """
    path = np.empty((FRAMES + 1, 2))
    path[0] = LENGTH, 0.0
    start = time.process_time()
    for frame in range(1, FRAMES + 1):
        advance()
        path[frame] = np.asarray(tip())[:2]
        # Written so that NaN fails too.
        if not np.abs(path[frame]).max() < 1.5 * LENGTH:
            raise RunFailedError(f"unstable after {frame * FRAME_TIME:g} s")
    return time.process_time() - start, path
