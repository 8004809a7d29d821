"""Whether two answers are the same, but for rounding."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import der
import numpy as np

from .readings import Array, Name, Reading
from .schema import Scene

#: Of numbers of natural size, after some hundred operations and solutions of stiff equations.
ROUNDING = 2e-12


def differences(
    found: Mapping[Name, Reading],
    expected: Mapping[Name, Reading],
    bound: Callable[[Name], float],
    floors: Mapping[str, float],
) -> list[str]:
    """What differs by more than its `bound` of the largest number of its unit, worst first.

    `floors` are by unit: differences below them are rounding whatever the size of the numbers.
    """
    scales = _scales(expected)
    complaints: list[tuple[float, str]] = []
    for name in expected.keys() - found.keys():
        complaints.append((np.inf, f"{name}: not found"))
    for name in expected.keys() & found.keys():
        one, other = expected[name], found[name]
        if one.values.shape != other.values.shape:
            complaints.append((np.inf, f"{name}: {one.values.shape}, {other.values.shape}"))
            continue
        if one.values.size == 0:
            continue
        difference = _difference(name, one.values, other.values)
        allowed = bound(name) * scales[_group(name, one)] + floors.get(one.unit, 0.0)
        if not difference <= allowed:
            share = difference / allowed if allowed > 0 else np.inf
            complaints.append((share, f"{name}: off by {difference:.3g}, allowed {allowed:.3g}"))
    return [text for _, text in sorted(complaints, key=lambda pair: -pair[0])]


def largest_share(found: Mapping[Name, Reading], expected: Mapping[Name, Reading]) -> float:
    """The largest difference, over the largest number of its unit."""
    scales = _scales(expected)
    return max(
        _difference(name, each.values, found[name].values) / scales[_group(name, each)]
        for name, each in expected.items()
        if scales[_group(name, each)] > 0.0 and each.values.shape == found[name].values.shape
    )


def roundings(scene: Scene) -> dict[str, float]:
    """By units, what rounding may make of nothing: numbers of the sizes that the scene's stiffness,
    extent and duration give."""
    model = der.Model(der.Scenario.from_dict({**scene, "output": {}}))
    size = float(np.ptp(model.initial_positions, axis=0).max())
    tension = max(rod.EA for rod in model.rods)
    bending = max(rod.EI for rod in model.rods)
    cell = min(float(np.diff(rod.line_arc_lengths).min()) for rod in model.rods)
    time = scene.get("time", {})
    instant = time["step"] if isinstance(time.get("step"), float) else time.get("duration", 1.0)
    natural = {
        "": 1.0,
        "m": size,
        "m/s": size / instant,
        "rad": 1.0,
        "1/m": 1.0 / cell,
        "rad/m": 1.0 / cell,
        "N": tension,
        "N m": bending / cell,
        "J": bending / size,
        "Hz": 1.0 / instant,
    }
    return {unit: ROUNDING * value for unit, value in natural.items()}


def unequal(found: Mapping[Name, Reading], expected: Mapping[Name, Reading]) -> list[str]:
    """The names of numbers that differ in any bit."""
    return [
        f"{name}"
        for name in sorted(expected, key=str)
        if name not in found
        or not np.array_equal(expected[name].values, found[name].values, equal_nan=True)
    ]


def _group(name: Name, reading: Reading) -> Any:
    """Numbers of one size: those of a unit, and of numbers without one those of a name."""
    return reading.unit or (name[0], name[-1])


def _scales(readings: Mapping[Name, Reading]) -> dict[Any, float]:
    scales: dict[Any, float] = {}
    for name, reading in readings.items():
        group = _group(name, reading)
        largest = float(np.max(np.abs(reading.values), initial=0.0))
        scales[group] = max(scales.get(group, 0.0), largest)
    return scales


def _difference(name: Name, one: Array, other: Array) -> float:
    if name[0] == "shapes":  # either sign is a shape
        both = [np.abs(one - other), np.abs(one + other)]
        return float(np.max(np.min([np.max(each, axis=(1, 2)) for each in both], axis=0)))
    if name[-1] == "slope" and name[0] != "arcs":  # whole turns count from where a rod begins
        return float(np.max(np.abs(np.exp(1j * one) - np.exp(1j * other))))
    return float(np.max(np.abs(one - other)))
