"""A straight bar on springs along its length that is pulled at its end."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from .record import Array


def pulled_bar(places: Array, parts: Sequence[tuple[float, float, float]]) -> Array:
    """Tension of a free bar on springs (stiffness, from, to) that 1 N pulls at its end, EA = 100.

    (u, N)' = (N/EA, k u), with k constant between the borders of the parts.
    """
    EA = 100.0
    stops = np.unique([0.0, 1.0, *places, *(s for part in parts for s in part[1:])])
    transfers = {0.0: np.eye(2)}
    for before, s in pairwise(stops):
        k = sum(stiffness for stiffness, a, b in parts if a <= before < b)
        r, h = np.sqrt(k / EA), s - before
        step = (
            [[np.cosh(r * h), np.sinh(r * h) / (EA * r)], [EA * r * np.sinh(r * h), np.cosh(r * h)]]
            if k
            else [[1.0, h / EA], [0.0, 1.0]]
        )
        transfers[s] = step @ transfers[before]
    start = 1.0 / transfers[1.0][1, 0]
    return np.array([start * transfers[s][1, 0] for s in places])
