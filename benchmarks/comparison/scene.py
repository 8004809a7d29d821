"""The common parts of all scenes: the simulated second, and the result of a run of a code."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path as File
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: The tip is compared 100 times after the start, every hundredth of a second.
FRAMES = 100
FRAME_TIME = 0.01  # [s]
DURATION = FRAMES * FRAME_TIME  # [s]

#: A tip further than this from the clamp in any direction is that of an unstable run; rods are 1 m
#: long.
REACH = 1.5  # [m]

REFERENCES = File(__file__).resolve().parents[2] / "tests/validation/references"

#: The varied parameters: names and values as an adapter understands them. All have ``elements``,
#: and ``steps``, the number of time steps from one frame to the next.
Config: TypeAlias = Mapping[str, str | int | float | bool]

#: Tip positions [m] at the start and all frames, shape (FRAMES + 1, 2), or 3 in space.
Path: TypeAlias = NDArray[np.float64]


class RunFailedError(Exception):
    """A code did not get through the second: unstable, or its solver gave up."""


def reference_path(file: str, problem: str, keys: Sequence[str]) -> Path:
    """Return stored coordinates of a tip, one key of the problem for each axis."""
    stored = json.loads((REFERENCES / file).read_text(encoding="utf-8"))[problem]["values"]
    return np.column_stack([stored[key]["value"] for key in keys])


def distance(path: Path, other: Path) -> float:
    """Return the largest distance of two tips over all frames [m]."""
    return float(np.linalg.norm(path - other, axis=1).max())


def steps_per_frame(config: Config) -> int:
    """Return the number of time steps from one frame to the next."""
    return int(config["steps"])


def time_step(config: Config) -> float:
    """Return the time step [s]."""
    return FRAME_TIME / steps_per_frame(config)


def march(advance: Callable[[], object], tip: Callable[[], ArrayLike]) -> tuple[float, Path]:
    """Let a code step through the second and time it.

    Parameters
    ----------
    advance
        Brings the code from one frame to the next.
    tip
        Gives the position of the tip, in the plane or in space.

    Returns
    -------
    seconds
        CPU seconds of the loop.
    path
        The tip at the start and all frames.

    Raises
    ------
    RunFailedError
        If the tip leaves the reach of the rod, or is not a number any more.
    """
    start_place = np.array(tip(), dtype=float)
    path = np.empty((FRAMES + 1, len(start_place)))
    path[0] = start_place
    start = time.process_time()
    for frame in range(1, FRAMES + 1):
        advance()
        path[frame] = tip()
        # Written so that NaN fails too.
        if not np.abs(path[frame]).max() < REACH:
            raise RunFailedError(f"unstable after {frame * FRAME_TIME:g} s")
    return time.process_time() - start, path
