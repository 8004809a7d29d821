"""Rods at rest stay at rest."""

from __future__ import annotations

import der
import numpy as np

from .case import Reading, hard
from .setting import Setting, line


def _steps(s: Setting) -> int:
    return 100_000 if s.long else 1000


@hard(
    "Rest states over 1e5 steps",
    "rod free of stress, clamped: an arc, in `spatial_bend` a straight one",
    "it does not move, to 1e-12 of its length (1e5 steps in the long run, 1e3 in CI)",
    motion=True,
)
def stays(s: Setting) -> Reading:
    angle = np.linspace(0, 2, 6)
    drawn = np.column_stack([np.sin(angle), 1 - np.cos(angle)]) / 2
    if s.model == "spatial_bend":  # has only rods that are straight without stress
        drawn = line(6)
    steps = _steps(s)
    scene = s.scene(
        s.rod(drawn),
        [{"at": "start", **s.clamp}],
        time=s.time_in(1e-4, steps),
        output={"every": 1e-4 * steps},
    )
    result = der.run(scene)
    return Reading(float(np.abs(result.positions[-1] - result.positions[0]).max()), 1e-12)


@hard(
    "Rest states over 1e5 steps",
    "cantilever that hangs in its equilibrium under its weight",
    "it does not move, to 1e-8 of its length (1e5 steps in the long run, 1e3 in CI)",
    motion=True,
)
def hangs(s: Setting) -> Reading:
    steps = _steps(s)
    x = np.linspace(0, 1, 6)
    scene = s.scene(
        s.rod(np.column_stack([x, 0 * x])),
        [{"at": "start", **s.clamp}],
        loads=[{"gravity": s.vector(0, -10)}],
        start_from="equilibrium",
        time=s.time_in(1e-4, steps),
        output={"every": 1e-4 * steps},
    )
    result = der.run(scene)
    return Reading(float(np.abs(result.positions[-1] - result.positions[0]).max()), 1e-8)
