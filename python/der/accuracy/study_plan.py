"""Which meshes, steppers and steps a study tries, and at which times it compares them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from der._core import Scenario, steppers
from der.accuracy.refinement import (
    count_elements,
    count_nodes,
    rods_that_cannot_be_refined,
    with_elements,
    with_time,
)
from der.accuracy.time_levels import find_stepper, fixed_step, stepper_of
from der.errors import SceneError
from der.result import Result

_DEFAULT_MESHES = (Fraction(1, 2), Fraction(1), Fraction(2), Fraction(4))
_DEFAULT_STEPS = (4.0, 2.0, 1.0, 0.5, 0.25, 0.125)
#: Steps in the run for the longest step of a scene whose own step says nothing about accuracy: with
#: a tolerance it has none, and stability sets that of an explicit stepper.
_FEWEST_STEPS_OF_RUN = 50
_FEWEST_STEPS = 8
_FEWEST_ELEMENTS = 4
#: A step has to reach one of this many frames of the scene to be compared at all.
_MOST_FRAMES_APART = 1000


@dataclass(frozen=True)
class Mesh:
    """A mesh of a study.

    Attributes
    ----------
    nodes
        Nodes of the rod that gives meshes their name.
    scenario
        The scene with this mesh.
    """

    nodes: int
    scenario: Scenario


def find_leading_rod(scenario: Scenario) -> str | None:
    """Return the first rod whose mesh can be varied; None if there is none."""
    fixed = rods_that_cannot_be_refined(scenario)
    return next((name for name in count_elements(scenario) if name not in fixed), None)


def why_one_mesh(scenario: Scenario) -> str:
    """Return why no rod's mesh can be varied."""
    return ", ".join(dict.fromkeys(rods_that_cannot_be_refined(scenario).values()))


def choose_meshes(scenario: Scenario, nodes: Sequence[int] | None) -> list[Mesh]:
    """Return the meshes to try, coarsest first.

    Parameters
    ----------
    scenario
        The scene.
    nodes
        Nodes of the leading rod; the elements of other rods are varied in proportion. Without it,
        half, once, twice and four times the elements, as far as the scene allows.

    Raises
    ------
    ValueError
        If the scene cannot take one of `nodes`.
    """
    rod = find_leading_rod(scenario)
    if rod is None:
        own = next(iter(count_nodes(scenario).values()))
        if nodes is not None and set(nodes) != {own}:
            raise ValueError(
                f"this scene allows no other number of nodes than its own, {own}: "
                f"{why_one_mesh(scenario)}; leave nodes out"
            )
        return [Mesh(own, scenario)]
    if nodes is None:
        return _default_meshes(scenario, rod)
    return [_mesh(scenario, rod, count) for count in sorted(set(nodes))]


def _mesh(scenario: Scenario, rod: str, nodes: int) -> Mesh:
    if nodes < 2:
        raise ValueError(f"a rod has at least 2 nodes, got {nodes}")
    elements = count_elements(scenario)[rod]
    ends = count_nodes(scenario)[rod] - elements  # 1, and 0 of a ring
    factor = Fraction(nodes - ends, elements)
    try:
        return Mesh(nodes, with_elements(scenario, factor))
    except ValueError as error:
        raise ValueError(f"the scene cannot take {nodes} nodes: {error}") from error


def _default_meshes(scenario: Scenario, rod: str) -> list[Mesh]:
    meshes = []
    elements = count_elements(scenario)[rod]
    ends = count_nodes(scenario)[rod] - elements
    for factor in _DEFAULT_MESHES:
        count = factor * elements
        if count.denominator != 1 or (factor < 1 and count < _FEWEST_ELEMENTS):
            continue
        try:
            meshes.append(_mesh(scenario, rod, int(count) + ends))
        except ValueError:
            continue  # a support in the middle, say, that has no node on this mesh
    return meshes


def finer(mesh: Mesh, factor: int) -> Mesh:
    """Return a mesh with `factor` times the elements."""
    refined = with_elements(mesh.scenario, factor)
    counts = count_nodes(refined)
    rod = find_leading_rod(refined) or next(iter(counts))
    return Mesh(counts[rod], refined)


def reference_meshes(scenario: Scenario, meshes: Sequence[Mesh]) -> dict[int, Scenario]:
    """Return the meshes of a study by their place, and after them two finer ones if there can be.

    Parameters
    ----------
    scenario
        The scene.
    meshes
        Those of the study, coarsest first.
    """
    scenarios = [mesh.scenario for mesh in meshes]
    if find_leading_rod(scenario) is not None:
        scenarios += [finer(meshes[-1], factor).scenario for factor in (2, 4)]
    return dict(enumerate(scenarios))


def choose_steppers(names: Sequence[str] | None, scenario: Scenario) -> list[str]:
    """Return the names of the steppers to try: those given, or all that the scene can have.

    Raises
    ------
    ValueError
        For a name that no stepper has.
    """
    if names is None:
        return [info.name for info in steppers() if _can_have(scenario, info.name)]
    return [find_stepper(name).name for name in dict.fromkeys(names)]


def _can_have(scenario: Scenario, stepper: str) -> bool:
    if scenario.is_static:
        return True
    try:
        with_step(scenario, stepper, scenario.duration, scenario.duration)
    except SceneError:
        return False
    return True


def choose_steps(base: Result, steps: Sequence[float] | None) -> list[float]:
    """Return the steps to try [s], longest first: those given, or some that suit the scene.

    These are around the scene's own step; where that comes from a tolerance or from the stability
    of an explicit stepper, they are shares of the duration. They are whole parts or multiples of
    the interval between frames, so that runs have values at the frames that the scene saves.

    Raises
    ------
    ValueError
        For a step that is not positive or longer than the run.
    """
    duration = base.scenario.duration
    if steps is None:
        middle, frames = _middle_step(base), frame_interval(base)
        fitted = (_fitting_step(factor * middle, frames) for factor in _DEFAULT_STEPS)
        around = list(dict.fromkeys(fitted))
        return [step for step in around if duration >= _FEWEST_STEPS * step] or around[-1:]
    for step in steps:
        if not 0.0 < step <= duration:
            raise ValueError(f"a step must lie between 0 and the duration, {duration:g} s: {step}")
    return sorted(set(steps), reverse=True)


def _middle_step(base: Result) -> float:
    if "tolerance" in base.scenario.to_dict()["time"] or not stepper_of(base).implicit:
        return base.scenario.duration / _FEWEST_STEPS_OF_RUN / _DEFAULT_STEPS[0]
    return fixed_step(base)


def _fitting_step(step: float, frames: float) -> float:
    """Return the step nearest to `step` that is a whole part or a multiple of `frames` [s]."""
    if step >= frames:
        return frames * round(step / frames)
    return frames / round(frames / step)


def longest_of_halvings(step: float, frames: float) -> float:
    """Return the longest step up to `step` whose halvings all fit the interval `frames` [s]."""
    return float(frames * 2.0 ** math.floor(math.log2(step / frames) + 1e-9))


def frame_interval(base: Result) -> float:
    """Return the interval between the frames that a scene saves [s]."""
    return float(base.times[1] - base.times[0])


def reference_interval(base: Result, steps: Sequence[float]) -> float:
    """Return the interval [s] that contains the times at which any of these steps is compared.

    Parameters
    ----------
    base
        The scene as written; the interval is a whole multiple of that between its frames.
    steps
        All steps [s].

    Raises
    ------
    ValueError
        If a step misses all frames of the scene.
    """
    frames = frame_interval(base)
    return frames * math.gcd(*(_frames_apart(step, frames) for step in steps))


def common_interval(step: float, frames: float) -> float:
    """Return the shortest interval [s] that is a multiple of `step` and of `frames` [s].

    Raises
    ------
    ValueError
        If there is none up to a thousand frames.
    """
    return frames * _frames_apart(step, frames)


def _frames_apart(step: float, frames: float) -> int:
    """Return how many frames it is from one that the step reaches to the next."""
    for count in range(1, _MOST_FRAMES_APART + 1):
        steps = count * frames / step
        if steps > 0.5 and abs(steps - round(steps)) <= 1e-6:
            return count
    raise ValueError(
        f"a step of {step:g} s and the interval between frames, {frames:g} s, have no common "
        "multiple, and runs are compared at frames that they reach: choose a whole part or a "
        "multiple of that interval"
    )


def reference_step(shortest: float, interval: float) -> float:
    """Return the longest step up to `shortest` that reaches every multiple of `interval` [s]."""
    return interval / math.ceil(interval / shortest * (1.0 - 1e-9))


def with_step(scenario: Scenario, stepper: str, step: float, every: float) -> Scenario:
    """Return the scene with a stepper and a fixed step, frames `every` so many seconds."""
    changes: dict[str, object] = {
        "integrator": stepper,
        "step": step,
        "every": every,
        "tolerance": None,
        "minimum_step": None,
        "allow_unstable": None,
    }
    if stepper != "generalized_alpha":
        changes["spectral_radius"] = None
    return with_time(scenario, **changes)
