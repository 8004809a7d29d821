"""The scenes of the laws have every key, and the laws know every vector; a law can be broken."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from laws.comparison import differences, roundings, unequal
from laws.laws import (
    ALONG_AXES,
    DIRECTIONS,
    OF_SECTIONS,
    POINTS,
    Law,
    in_space,
    in_units,
    moved,
    reversed_rods,
    shuffled,
)
from laws.readings import read
from laws.scenes import scenes
from laws.schema import ITEM, key_paths, mapped, paths_of, subject, vector_keys

#: Keys that no scene of a law needs.
OUTSIDE = {
    "analysis.continuation.points": "ends a path, wherever it is",
    "output.every": "set by the law: frames at the start and the end",
    "output.probes.side": "set by the law: probes from both sides",
    "rods.shape.helix.radius": "its side goes with the axes; tests/cpp/scenario/segments_test.cpp",
    "solver.linear": "how, not what; tests/cpp/solvers/linear_solvers_test.cpp",
    "solver.max_iterations": "how, not what",
    "time.allow_unstable": "a run that is wrong on purpose",
}


def test_every_key_is_in_a_scene() -> None:
    """A new key needs a thing in laws/scenes.py that has it, or a reason here."""
    found = set().union(*(paths_of(scene) for scene in scenes().values()))
    assert key_paths() - found - OUTSIDE.keys() == set()
    assert OUTSIDE.keys() <= key_paths()


def test_every_vector_is_known() -> None:
    """A new vector needs a word at the top of laws/laws.py: does it move or turn with the scene?"""
    assert vector_keys() == POINTS | DIRECTIONS | ALONG_AXES | OF_SECTIONS


def test_units_of_courses_are_those_of_their_keys() -> None:
    """Amplitudes and values have the units of what they are of."""
    units: dict[tuple[str, ...], str] = {}

    def note(path: tuple[str, ...], value: Any, unit: str) -> Any:
        units[path] = unit
        return value

    for name in ("swinging force-planar-motion", "finger", "spun_strip"):
        mapped(scenes()[name], note)
    sine = ("loads", ITEM, "distributed_force", "force", "sine")
    bent = ("actuation", ITEM, "natural_curvature")
    turned = ("supports", ITEM, "prescribe", "rotation", "angle")
    for path, key, unit in (
        (sine, "amplitude", "N/m"),
        (sine, "offset", "N/m"),
        (sine, "frequency", "Hz"),
        (bent, "values", "1/m"),
        (bent, "times", "s"),
        (turned, "values", "rad"),
    ):
        assert units[(*path, key)] == unit, (*path, key)


TURN = np.array([[0.8, -0.6], [0.6, 0.8]])
LAWS = {
    "moved": moved(TURN, np.array([0.3, -0.2])),
    "units": in_units(3.0, 0.7, 1.3),
    "reversed": reversed_rods(),
    "order": shuffled(),
    "in space": in_space("spatial"),
}


@pytest.mark.parametrize("key", ["force", "at", "EA", "points"])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_a_slip_breaks_a_law(law: Law, key: str) -> None:
    """A number that is not what the law makes of it changes what rounding never does."""

    def slip(path: tuple[str, ...], value: Any, unit: str) -> Any:
        return (1.0001 * np.asarray(value)).tolist() if subject(path) == key else value

    scene = scenes()["force between nodes-planar-static"]
    written = law.write(scene)
    expected = law.follow(scene, read(scene).numbers)
    floors = roundings(written)
    exactly = {key: value for key, value in expected.items() if key[0] in ("positions", "energy")}
    assert differences(read(written).numbers, exactly, lambda name: 1e-9, floors) == []
    wrong = read(mapped(written, slip)).numbers
    assert differences(wrong, exactly, lambda name: 1e-9, floors) != []
    assert unequal(wrong, expected) != []


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_a_wrong_reading_breaks_a_law(law: Law) -> None:
    """Every reading that is compared to rounding, one after the other, off by a millionth."""
    scene = scenes()["force between nodes-planar-static"]
    written = law.write(scene)
    found = read(written).numbers
    expected = law.follow(scene, read(scene).numbers)
    floors = roundings(written)
    for name, reading in expected.items():
        size = np.abs(reading.values).max(initial=0.0)
        if law.by_order(scene, name) or size < 1e6 * floors.get(reading.unit, 0.0):
            continue
        off = {**found, name: reading.with_values(reading.values + 1e-6 * size)}
        wrong = differences({name: off[name]}, {name: reading}, lambda name: 1e-9, floors)
        assert len(wrong) == 1, name
