"""Vibrations about loaded equilibria, by the linearised boundary value problem."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from . import statics
from .case import Case, Label, Truth
from .rod import Array, Mesh
from .shapes import Random, draw


def modes(rng: Random) -> Case:
    drawing = draw(rng, curved=0.25, natural=0.2, slender=(3, 6), nodes=(9, 80))
    count = int(rng.integers(1, 5))
    scene: dict[str, Any] = {
        "title": "Audit: modes",
        "rods": [drawing.entry],
        "supports": [],
        "analysis": {"modes": {"count": count}},
        "loads": [],
    }
    free = drawing.straight and drawing.rod.natural is None and rng.random() < 0.15
    if free:
        count += 3
        scene["analysis"]["modes"]["count"] = count
        del scene["supports"]
    else:
        statics.hold(rng, drawing, scene)
        if rng.random() < 0.7:
            statics.load(rng, drawing, scene)
    if not scene["loads"]:
        del scene["loads"]
    scene["output"] = {"probes": {"end": {"rod": "rod", "at": "end", "quantity": "x"}}}

    def truths(final: dict[str, Any]) -> Mapping[Label, Truth]:
        if free:
            coarse, fine = Mesh(drawing.rod, 16), Mesh(drawing.rod, 21)
            state, fine_state = coarse.drawn(), fine.drawn()
        else:
            coarse, state, fine, fine_state = statics.solution(drawing, final)
        pair = frequencies(coarse, state, count), frequencies(fine, fine_state, count)
        found = {}
        for i, (rough, value) in enumerate(zip(*pair, strict=True)):
            # Rigid motions have frequency 0, here but for the rounding of its square.
            value = 0.0 if value < 1e-5 * pair[1][-1] else value
            error = 3 * abs(value - rough) + 1e-9 * pair[1][-1]
            found[f"frequency {i + 1}", "final"] = Truth(
                float(value), float(error), float(max(value, 1e-3 * pair[1][-1])), "frequency"
            )
        return found

    return Case("modes", scene, truths)


def frequencies(mesh: Mesh, state: Array, count: int) -> Array:
    """The lowest frequencies [Hz]."""
    squares = mesh.vibrations(state)[:count]
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi))
