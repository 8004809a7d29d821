"""The frames of a result, whatever the analysis, as animations and views show them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from der._core import Simulation, ended_as_asked
from der.fields import fields_of, is_motion, rod_fields
from der.run_data import RunData
from der.scene_loads import ActingLoads, acting_loads
from der.sections import directors_along

Array = NDArray[np.float64]

#: Largest displacement drawn of a mode, against the structure's size.
MODE_SIZE = 0.12
#: Frames of one swing of a mode.
_MODE_FRAMES = 24

#: Runs that last so long [s] are shown as fast as they are; others take about `_AIM` seconds.
_SHOWN_AS_THEY_ARE = (1.0, 20.0)
_AIM = 8.0


@dataclass(frozen=True)
class Chapter:
    """Frames that belong together, from `first` to `last` inclusive: a branch, a mode."""

    title: str
    first: int
    last: int
    loops: bool = False


@dataclass(frozen=True, eq=False)
class Film:
    """Frames to show one after the other.

    Attributes
    ----------
    positions
        Positions of all nodes [m], shape (frames, nodes, dim).
    captions
        The text beside each frame; empty if `times` are enough.
    chapters
        Parts of the film, in order, without gaps; at least one.
    times
        When each frame is [s], shape (frames,), ascending; None where time plays no role.
    source
        The frame of the result that each frame belongs to, shape (frames,): its loads and supports.
    fields
        For each quantity of ``der.fields.fields_of`` its values for each rod, of shape (frames,
        nodes of the rod); empty for modes, whose size means nothing.
    directors
        Director 1 at the nodes of each rod, along the width of its section, as
        ``der.sections.directors_along`` has it.
    """

    positions: Array
    captions: list[str]
    chapters: list[Chapter]
    times: Array | None
    source: NDArray[np.int64]
    fields: dict[str, list[Array]]
    directors: list[Array | None]

    def loads(self, result: RunData, frame: int) -> ActingLoads:
        """Return the loads of the scene at a frame."""
        return acting_loads(result, int(self.source[frame]))


def failure_text(result: RunData) -> str:
    """Return how a run failed, such as ``diverged at t = 0.0041 s``, or an empty text.

    A run that did not fail may still be unreliable: ``unreliable from t = 1.2 s on``.
    """
    if ended_as_asked(result.status):
        since = result.unreliable_from
        return "" if since is None else f"unreliable from t = {since:.4g} s on"
    words = result.status.replace("_", " ")
    if result.scenario.is_static or len(result.times) == 0:
        return words
    return f"{words} at t = {result.times[-1]:.4g} s"


def title_of(result: RunData) -> str:
    """Return the title of a picture of a run: the scene's, and what is wrong with the run."""
    failure = failure_text(result)
    return f"{result.scenario.title} ({failure})" if failure else result.scenario.title


def make_film(result: RunData) -> Film:
    """Return the frames of a result.

    A motion has its saved frames, a continuation its points, branch by branch. A static result has
    two frames, the undeformed shape and the equilibrium; modes vibrate, magnified, one after
    the other.

    Raises
    ------
    ValueError
        If the run has no frame at all, or has found no modes.
    """
    if len(result.times) == 0:
        raise ValueError(f"the run has no frame to show (status {result.status})")
    kind = result.scenario.analysis
    if kind in ("modes", "buckling"):
        return _modes(result)
    if kind == "continuation":
        return _path(result)
    if result.scenario.is_static:
        return _equilibrium(result)
    count = len(result.times)
    whole = Chapter(result.scenario.title, 0, count - 1)
    return Film(
        result.positions,
        [""] * count,
        [whole],
        result.times,
        np.arange(count),
        _fields(result, np.arange(count)),
        directors_along(result),
    )


def _fields(result: RunData, frames: NDArray[np.int64]) -> dict[str, list[Array]]:
    """Return the quantities along rods; without time, those that do not vanish with the motion."""
    rods = rod_fields(result)
    return {
        name: [rod.at_nodes[name][frames] for rod in rods]
        for name, quantity in fields_of(result.model).items()
        if not (result.scenario.is_static and is_motion(quantity))
    }


def _path(result: RunData) -> Film:
    path = result.path
    if path is None:
        raise ValueError("the run has found no path to show")
    captions = [
        f"load factor {factor:.4g}, {'stable' if stable else 'unstable'}"
        + (f", {event.replace('_', ' ')}" if event else "")
        for factor, stable, event in zip(path.factor, path.stable, path.events, strict=True)
    ]
    chapters = []
    for branch in np.unique(path.branch):
        rows = np.flatnonzero(path.branch == branch)
        chapters.append(Chapter(f"branch {branch}", int(rows[0]), int(rows[-1])))
    frames = np.arange(len(captions))
    fields = _fields(result, frames)
    directors = directors_along(result)
    return Film(result.positions, captions, chapters, None, frames, fields, directors)


def _equilibrium(result: RunData) -> Film:
    """Put the undeformed shape before the equilibrium; a failed search has its own frames only."""
    last = len(result.times) - 1
    positions = np.stack([result.model.initial_positions, result.positions[last]])
    fields = {
        name: [np.vstack([np.zeros_like(values), values]) for values in rods]
        for name, rods in _fields(result, np.array([last])).items()
    }
    chapter = Chapter(result.scenario.title, 0, 1)
    found = "equilibrium" if ended_as_asked(result.status) else result.status
    captions = ["undeformed", found]
    drawn = Simulation(result.scenario).directors if result.sections is not None else None
    directors = directors_along(
        result, None if drawn is None else np.stack([drawn, result.directors[last]])
    )
    return Film(positions, captions, [chapter], None, np.array([last, last]), fields, directors)


def _modes(result: RunData) -> Film:
    if not len(mode_shapes(result)):
        raise ValueError("the run has found no modes to show")
    names = [f"mode {number}: {value}" for number, value in enumerate(_mode_values(result), 1)]
    rest = result.positions[-1]
    swing = np.sin(np.linspace(0.0, 2.0 * np.pi, _MODE_FRAMES, endpoint=False))
    positions = [
        rest + amplitude * largest for largest in mode_displacements(result) for amplitude in swing
    ]
    captions = [f"{name}, not to scale" for name in names for _ in swing]
    chapters = [
        Chapter(name, number * _MODE_FRAMES, (number + 1) * _MODE_FRAMES - 1, loops=True)
        for number, name in enumerate(names)
    ]
    source = np.full(len(positions), len(result.times) - 1)
    # Sections are shown as they stand in the equilibrium: a mode is small.
    directors = [
        one if one is None or len(one[0]) == 1 else one[source] for one in directors_along(result)
    ]
    return Film(np.stack(positions), captions, chapters, None, source, {}, directors)


def mode_shapes(result: RunData) -> Array:
    """Return vibration or buckling modes, shape (modes, nodes, dim); of other runs none."""
    found = result.modes or result.buckling
    return found.shapes if found is not None else np.zeros((0, *result.positions.shape[1:]))


def mode_displacements(result: RunData) -> Array:
    """Return the largest displacements [m] with which modes are drawn, as `mode_shapes`."""
    shapes = mode_shapes(result)
    size = MODE_SIZE * float(np.ptp(result.positions[-1], axis=0).max())
    largest = np.abs(shapes).max(axis=(1, 2), keepdims=True)
    return np.asarray(size * shapes / largest)


def _mode_values(result: RunData) -> list[str]:
    if result.buckling is not None:
        return [f"load factor {factor:.5g}" for factor in result.buckling.load_factors]
    assert result.modes is not None
    return [
        f"grows at {growth:.4g} 1/s" if growth > 0.0 else f"{hertz:.4g} Hz"
        for hertz, growth in zip(result.modes.frequencies, result.modes.growth_rates, strict=True)
    ]


def round_speed(span: float) -> float:
    """Return 1 for spans [s] that can be watched as they are, else the 1, 2 or 5 that fits."""
    if _SHOWN_AS_THEY_ARE[0] <= span <= _SHOWN_AS_THEY_ARE[1]:
        return 1.0
    wanted = np.log10(span / _AIM)
    power = np.floor(wanted)
    digits = np.log10([1.0, 2.0, 5.0, 10.0])
    digit = (1.0, 2.0, 5.0, 10.0)[int(np.argmin(np.abs(digits - (wanted - power))))]
    return float(f"{digit * 10.0**power:.1g}")


def speed_text(speed: float) -> str:
    """Return a speed in words, such as ``5x speed`` or ``1/50 speed``."""
    return f"{speed:.4g}x speed" if speed >= 1.0 else f"1/{1.0 / speed:.4g} speed"
