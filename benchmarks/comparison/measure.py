"""Running configurations: the largest stable step, and CPU times that other work disturbs least."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain, zip_longest
from typing import TypeAlias

from comparison.codes import Code
from comparison.scene import Config, Path, RunFailedError, distance
from comparison.scenes import Scene

Run: TypeAlias = Callable[[Config], tuple[float, Path]]
Progress: TypeAlias = Callable[[float], None]

#: ``steps`` of a configuration that is to take the largest stable step.
FEWEST = "fewest"

# An unstable run ends early, so the search comes from below, in small strides.
STRIDE = 1.08
MAX_STEPS = 20000

# Runs this much dearer than the cheapest of their accuracy are not repeated: more than a busy
# machine can account for.
HOPELESS = 2.0
# [s] Longer runs are not repeated either: what disturbs them averages out.
LONG = 2.0


@dataclass(frozen=True)
class Point:
    """The cost and the error of one configuration of a code."""

    code: str  # title of the code
    config: Config
    seconds: float  # CPU time of the time loop, the least of all repetitions
    error: float  # [m] distance of the tip from the reference's
    own_error: float | None = None  # [m] from the code's own limit, where that is another
    failure: str = ""  # why it did not get through; then the numbers are infinite


def run_stably(run: Run, config: Config) -> tuple[Config, float, Path]:
    """Run a configuration, with the fewest steps a frame that get through where it asks for them.

    Returns
    -------
    config, seconds, path
        The configuration with the steps that were taken, and what its run gave.
    """
    if config["steps"] != FEWEST:
        return config, *run(config)
    steps = max(1, int(config["elements"]) // 4)
    while steps <= MAX_STEPS:
        tried = {**config, "steps": steps}
        try:
            return tried, *run(tried)
        except RunFailedError:
            steps = math.ceil(STRIDE * steps)
    raise RunFailedError(f"unstable even with {MAX_STEPS} steps a frame")


def measure(
    scene: Scene,
    codes: Iterable[Code],
    quick: bool,
    repeats: int,
    progress: Progress | None = None,
) -> tuple[list[Point], dict[str, float]]:
    """Run all configurations of all codes.

    A first round runs all; the others repeat, code by code in turns, those that can still be the
    cheapest of their accuracy. A point whose repeat fails keeps the time that it has.

    Parameters
    ----------
    scene
        What they simulate.
    codes
        Installed ones that can run it.
    quick
        Whether to try a few configurations only.
    repeats
        Runs of each configuration that are worth it.
    progress
        Told the share that is done, from 0 to 1.

    Returns
    -------
    points
        One for each configuration.
    limits
        For each code that converges to something else than the reference, by its title, how far
        that lies from it [m].
    """
    codes = list(codes)
    reference = scene.reference()
    limits = {code.title: code.limit(scene.key, quick) for code in codes}
    runs: dict[str, Run] = {code.title: code.adapter(scene.key).run for code in codes}
    grids = [
        [(code.title, config) for config in code.adapter(scene.key).grid(quick)] for code in codes
    ]
    tasks = list(_in_turns(grids))
    points = []
    for done, (title, config) in enumerate(tasks):
        _report(progress, done / (len(tasks) * 2))
        points.append(_first(title, config, runs[title], reference, limits[title]))
    for repeat in range(1, repeats):
        chosen = set(map(id, worth_repeating(points)))
        for i, point in enumerate(points):
            share = (repeat - 1 + i / len(points)) / (repeats - 1)
            _report(progress, 0.5 + 0.5 * share)
            if id(point) in chosen:
                points[i] = _again(point, runs[point.code])
    apart = {
        title: distance(limit, reference) for title, limit in limits.items() if limit is not None
    }
    return points, apart


def worth_repeating(points: Iterable[Point]) -> list[Point]:
    """Return the points that another run could make the cheapest of their accuracy."""
    done = [point for point in points if not point.failure]
    return [point for point in done if point.seconds < LONG and _has_hope(point, done)]


def _has_hope(point: Point, others: list[Point]) -> bool:
    return all(
        point.seconds <= HOPELESS * other.seconds
        for other in others
        if other.code == point.code
        and other.error <= point.error
        and (other.own_error or 0.0) <= (point.own_error or 0.0)
    )


def _first(title: str, config: Config, run: Run, reference: Path, limit: Path | None) -> Point:
    try:
        config, seconds, path = run_stably(run, config)
    except RunFailedError as error:
        return Point(title, config, math.inf, math.inf, failure=str(error))
    own_error = None if limit is None else distance(path, limit)
    return Point(title, config, seconds, distance(path, reference), own_error)


def _again(point: Point, run: Run) -> Point:
    try:
        seconds, _ = run(point.config)
    except RunFailedError:
        return point
    return replace(point, seconds=min(point.seconds, seconds))


def _in_turns(grids: list[list[tuple[str, Config]]]) -> Iterator[tuple[str, Config]]:
    return (task for task in chain.from_iterable(zip_longest(*grids)) if task is not None)


def _report(progress: Progress | None, share: float) -> None:
    if progress is not None:
        progress(share)
