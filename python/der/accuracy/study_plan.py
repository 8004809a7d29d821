"""Which meshes, steppers and steps a study tries, and at which times it compares them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from numbers import Integral, Real
from typing import Any

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


def check_arguments(
    nodes: Sequence[int] | None,
    steps: Sequence[float] | None,
    steppers: Sequence[str] | None,
    max_seconds: float,
) -> None:
    """Refuse empty lists, and values that are none for any scene, before any work is done."""
    if nodes is not None:
        for count in _checked_list("nodes", nodes, "[21, 41]"):
            if isinstance(count, bool) or not isinstance(count, Integral):
                raise ValueError(f"nodes must be whole numbers, such as 21, got {count!r}")
    if steps is not None:
        _check_positive("steps", steps, "seconds", "[0.01, 0.005]")
    if steppers is not None:
        _checked_list("steppers", steppers, "['tr_bdf2']")
    if not _is_number(max_seconds) or not max_seconds > 0.0:
        raise ValueError(
            f"max_seconds must be a number greater than 0, such as 2, got {max_seconds!r}"
        )


def check_errors(errors: Sequence[float]) -> None:
    """Refuse errors that nobody can want advice for: they are finite and greater than 0."""
    _check_positive("errors", errors, "units of the probes", "[0.001, 0.0001]")


def _check_positive(name: str, values: Sequence[float], unit: str, example: str) -> None:
    for value in _checked_list(name, values, example):
        if not _is_number(value) or not 0.0 < value < math.inf:
            raise ValueError(
                f"{name} must be finite numbers greater than 0 in {unit}, such as {example}, got "
                f"{value!r}"
            )


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _checked_list(name: str, values: Any, example: str) -> list[Any]:
    try:
        found = [] if isinstance(values, str) else list(values)
    except TypeError:
        found = []
    if not found:
        raise ValueError(
            f"{name} must be a list with at least one entry, such as {example}, got {values!r}; "
            "leave it out for the default"
        )
    return found


@dataclass(frozen=True)
class Mesh:
    """The scene with a mesh, named by the nodes of the first rod whose mesh can be varied."""

    nodes: int
    scenario: Scenario

    @property
    def name(self) -> str:
        """What it is called: ``41 nodes``."""
        return f"{self.nodes} nodes"


def find_leading_rod(scenario: Scenario) -> str | None:
    """Return the first rod whose mesh can be varied; None if there is none."""
    fixed = rods_that_cannot_be_refined(scenario)
    return next((name for name in count_elements(scenario) if name not in fixed), None)


def why_one_mesh(scenario: Scenario) -> str:
    """Return why no rod's mesh can be varied."""
    return ", ".join(dict.fromkeys(rods_that_cannot_be_refined(scenario).values()))


def choose_meshes(scenario: Scenario, nodes: Sequence[int] | None) -> list[Mesh]:
    """Return the meshes to try, coarsest first.

    Those of the given numbers of nodes of the leading rod; the elements of other rods are varied in
    proportion; a `ValueError` says which of them the scene cannot take. Without them half, once,
    twice and four times the elements, as far as the scene allows.
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
    elements = count_elements(scenario)[rod]
    ends = count_nodes(scenario)[rod] - elements  # 1, and 0 of a ring
    meshes = []
    if nodes is None:
        for factor in _DEFAULT_MESHES:
            count = factor * elements
            if count.denominator != 1 or (factor < 1 and count < _FEWEST_ELEMENTS):
                continue
            try:
                meshes.append(Mesh(int(count) + ends, with_elements(scenario, factor)))
            except ValueError:
                continue  # a support in the middle, say, that has no node on this mesh
        return meshes
    for wanted in sorted(set(nodes)):
        if wanted < 2:
            raise ValueError(f"a rod has at least 2 nodes, got {wanted}")
        try:
            factor = Fraction(wanted - ends, elements)
            meshes.append(Mesh(wanted, with_elements(scenario, factor)))
        except ValueError as error:
            raise ValueError(f"the scene cannot take {wanted} nodes: {error}") from error
    return meshes


def with_finer_meshes(meshes: Sequence[Mesh]) -> list[Mesh]:
    """Return the meshes of a study, and after them two finer ones if there can be."""
    finest = meshes[-1].scenario
    rod = find_leading_rod(finest)
    if rod is None:
        return list(meshes)
    finer = [with_elements(finest, factor) for factor in (2, 4)]
    return [*meshes, *(Mesh(count_nodes(scenario)[rod], scenario) for scenario in finer)]


def choose_steppers(names: Sequence[str] | None, scenario: Scenario) -> list[str]:
    """Return the names of the steppers to try: those given, or all that the scene can have."""
    if names is not None:
        return [find_stepper(name).name for name in dict.fromkeys(names)]
    return [info.name for info in steppers() if _can_have(scenario, info.name)]


def _can_have(scenario: Scenario, stepper: str) -> bool:
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
    """
    duration = base.scenario.duration
    if steps is not None:
        for step in steps:
            if not 0.0 < step <= duration:
                raise ValueError(
                    f"a step must lie between 0 and the duration, {duration:g} s: {step}"
                )
        return sorted(set(steps), reverse=True)
    middle = fixed_step(base)
    if "tolerance" in base.scenario.to_dict()["time"] or not stepper_of(base).implicit:
        middle = duration / _FEWEST_STEPS_OF_RUN / _DEFAULT_STEPS[0]
    frames = frame_interval(base)
    fitted = (_fitting_step(factor * middle, frames) for factor in _DEFAULT_STEPS)
    around = list(dict.fromkeys(fitted))
    return [step for step in around if duration >= _FEWEST_STEPS * step] or around[-1:]


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

    It is a whole multiple of that between the frames of the scene as written. A step that misses
    all of these is a `ValueError`.
    """
    frames = frame_interval(base)
    return frames * math.gcd(*(_frames_apart(step, frames) for step in steps))


def common_interval(step: float, frames: float) -> float:
    """Return the shortest interval [s] that is a multiple of `step` and of `frames` [s].

    If there is none up to a thousand frames, that is a `ValueError`.
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
    changes: dict[str, object] = {"integrator": stepper, "step": step, "every": every}
    changes |= dict.fromkeys(("tolerance", "minimum_step", "allow_unstable"))
    if stepper != "generalized_alpha":
        changes["spectral_radius"] = None
    return with_time(scenario, **changes)
