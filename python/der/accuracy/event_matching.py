"""Which events of two paths of equilibria are the same: those of a kind that lie at the same place.

Counting along the path does not tell. One more bifurcation on a finer mesh would shift all that
come after it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from der._core import Model
from der.accuracy.noise import noise_floor
from der.accuracy.readings import Readings

#: Two events farther apart than this, in the largest values of factor and probes, are not the same.
_SAME_PLACE = 0.25

#: Probes that are never larger than this many times their rounding tell no place.
_MUCH_NOISE = 1e6

#: Factor and probes where an event lies, each over its largest value on the path.
Place = dict[str, float]


def numbered_as(reference: Readings, found: Readings, model: Model) -> Readings:
    """Return what was found on a path, with its events numbered as those of a reference.

    An event that the reference lacks comes after all of those that it has. The sizes of the model
    tell what is rounding.
    """
    names: dict[str, str] = {}
    scales: dict[str, float] = {}
    for r in (*reference.values(), *found.values()):
        least = max(r.largest, _MUCH_NOISE * noise_floor(model, r.unit, math.inf, 0.0))
        scales[r.probe] = max(scales.get(r.probe, 0.0), least)
    for kind in dict.fromkeys(r.kind for r in found.values() if re.search(r" \d+$", r.what)):
        here, there = _places(reference, kind, scales), _places(found, kind, scales)
        same = match_places(list(here.values()), list(there.values()))
        new = len(here)
        for index, what in enumerate(there):
            if index in same:
                names[what] = list(here)[same[index]]
            else:
                new += 1
                names[what] = f"{kind} {new}"
    renamed = (replace(r, what=names.get(r.what, r.what)) for r in found.values())
    return {reading.label: reading for reading in renamed}


def match_places(here: Sequence[Place], there: Sequence[Place]) -> dict[int, int]:
    """Return, by the index of a place in `there`, the index of the same place in `here`.

    Both are in the order of the path, which the pairs keep. Among the ways to pair them, the one of
    the smallest sum of distances, where a place without a partner counts half of the largest
    distance that a pair may have: an alignment of sequences (Needleman and Wunsch, J. Mol. Biol.
    48, 1970, 443).
    """
    cost = np.zeros((len(here) + 1, len(there) + 1))
    cost[:, 0] = 0.5 * _SAME_PLACE * np.arange(len(here) + 1)
    cost[0, :] = 0.5 * _SAME_PLACE * np.arange(len(there) + 1)
    for i, place in enumerate(here):
        for j, other in enumerate(there):
            alone = 0.5 * _SAME_PLACE + min(cost[i, j + 1], cost[i + 1, j])
            cost[i + 1, j + 1] = min(cost[i, j] + _distance(place, other), alone)
    pairs = {}
    i, j = len(here), len(there)
    while i > 0 and j > 0:
        if cost[i, j] == cost[i - 1, j - 1] + _distance(here[i - 1], there[j - 1]):
            i, j = i - 1, j - 1
            pairs[j] = i
        elif cost[i, j] == 0.5 * _SAME_PLACE + cost[i - 1, j]:
            i -= 1
        else:
            j -= 1
    return pairs


def _distance(here: Place, there: Place) -> float:
    return max(abs(here[name] - there[name]) for name in here)


def _places(readings: Readings, kind: str, scales: Mapping[str, float]) -> dict[str, Place]:
    """Return the places of a kind by what they are called, in the order of the path."""
    places: dict[str, Place] = {}
    for reading in readings.values():
        if reading.kind == kind:
            place = places.setdefault(reading.what, {})
            place[reading.probe] = reading.value / scales[reading.probe]
    return places
