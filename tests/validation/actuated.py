"""Scenes with actuations that several validation tests vary."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import der
import numpy as np
from numpy.typing import NDArray
from scenes import Scene

Array = NDArray[np.float64]

#: Profiles along a stretch, of the share u of it.
PROFILES: dict[str, Callable[[Any], Any]] = {
    "constant": lambda u: 1.0 + 0.0 * u,
    "linear": lambda u: u,
    "smooth": lambda u: np.sin(np.pi * u) ** 2,
}


def bend(value: Any, start: float, end: float, name: str = "bend", **more: Any) -> Scene:
    """A natural curvature over a stretch."""
    return {"name": name, "rod": "rod", "from": start, "to": end, "natural_curvature": value} | more


def stretch(value: Any, start: float, end: float, name: str = "stretch", **more: Any) -> Scene:
    """An elongation over a stretch."""
    return {"name": name, "rod": "rod", "from": start, "to": end, "elongation": value} | more


def probed(
    scene: Scene, places: Sequence[tuple[float | str, str]], quantities: Sequence[str]
) -> Array:
    """Final values at (place, side), shape (places, quantities)."""
    probes = {
        f"{quantity}-{i}": {"rod": "rod", "at": place, "quantity": quantity}
        | ({} if quantity in "xyz" else {"side": side})
        for i, (place, side) in enumerate(places)
        for quantity in quantities
    }
    result = der.run(der.Scenario.from_dict({**scene, "output": {"probes": probes}}))
    return np.array(
        [[result.probes[f"{q}-{i}"][-1] for q in quantities] for i in range(len(places))]
    )
