"""The solver ``der`` of the public score board ``cosseratbench``.

The board finds it by its entry point, and scores it beside the other solvers::

    pip install der[board]
    cosseratbench run --solver der

Each rod of a scenario becomes a scene of its own: without contact, rods do not feel one another.
Scenarios that need contact are not supported, and the board says so.

All of it is one module: the board takes a saved result for stale when the file of the solver's
class has changed. Requires the package cosseratbench (the extra ``board``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

try:
    from cosseratbench import (
        Capability,
        Diverged,
        End,
        EndCondition,
        Motion,
        Rod,
        Scenario,
        Trajectory,
    )
except ModuleNotFoundError:
    raise ModuleNotFoundError(
        "der.board requires the package cosseratbench: pip install cosseratbench"
    ) from None

from der._core import __version__
from der.errors import DivergedError, NotConvergedError
from der.result import Result
from der.simulation import Simulation

_Array: TypeAlias = NDArray[np.float64]

#: Of a motion that is the result: of order 4. Both damp the vibrations that steps do not resolve.
_OF_MOTIONS = "sdirk4"
#: Of a motion towards an equilibrium, or through equilibria.
_OF_EQUILIBRIA = "tr_bdf2"
#: The longest step, times the angular frequency of the slowest vibration.
_STEP = 0.3


class Solver:
    """Rods that stretch, bend and twist, without contact.

    A scenario whose result is the equilibrium under constant loads is solved as one: its first
    frame is the start, and all others are the equilibrium. Others are runs over time. Where the
    scenario leaves damping to the solver, it is critical for the slowest vibration.

    Parameters
    ----------
    time_step_scale
        Factor of the time step. No step is longer than a frame.
    """

    name = "der"
    backend_version = __version__
    capabilities = frozenset({Capability.STRETCH})

    def __init__(self, time_step_scale: float = 1.0) -> None:
        self._longest = time_step_scale * _STEP

    def settings(self, scenario: Scenario, *, n_elements: int, n_frames: int) -> dict[str, object]:
        """Return the numerical choices for a scenario, which the board saves with its result."""
        if _is_static(scenario):
            return {"method": "equilibrium"}
        step, _ = self._steps(scenario, n_frames)
        return {
            "method": "run over time",
            "integrator": _integrator(scenario),
            "time_step": step,
            "damping_rate": _damping_rate(scenario),
        }

    def run(self, scenario: Scenario, *, n_elements: int, n_frames: int) -> Trajectory:
        """Run a scenario with elements of equal length on each rod.

        Raises
        ------
        NotImplementedError
            For what `der` cannot say: contact, and some motions of clamps.
        Diverged
            If a run fails.
        """
        if scenario.obstacles:
            raise NotImplementedError("contact with obstacles")
        solved: dict[str, Any] = {"analysis": "static"}
        if not _is_static(scenario):
            step, steps = self._steps(scenario, n_frames)
            time = {"duration": scenario.duration, "integrator": _integrator(scenario)}
            solved = {"time": time | {"step": step}, "output": {"every": step * steps}}
        positions, directors = [], []
        for rod in scenario.rods:
            case = _Case(rod, scenario, n_elements)
            result = case.run(solved)
            nodes, turned = case.trajectory(result)
            if _is_static(scenario):
                nodes = np.stack([rod.nodes(n_elements), *[nodes[-1]] * (n_frames - 1)])
                turned = np.stack([rod.directors(n_elements), *[turned[-1]] * (n_frames - 1)])
            positions.append(nodes)
            directors.append(turned)
        times = np.linspace(0.0, scenario.duration, n_frames)
        return Trajectory(times, tuple(positions), tuple(directors))

    def _steps(self, scenario: Scenario, n_frames: int) -> tuple[float, int]:
        """Return the time step, and how many of them make a frame."""
        frame = scenario.duration / (n_frames - 1)
        steps = math.ceil(frame * scenario.slowest_frequency() / self._longest)
        return frame / steps, steps


def _is_static(scenario: Scenario) -> bool:
    moves = any(rod.motion(end) is not None for rod in scenario.rods for end in End)
    return scenario.quasi_static and not moves


def _integrator(scenario: Scenario) -> str:
    return _OF_EQUILIBRIA if scenario.quasi_static else _OF_MOTIONS


def _damping_rate(scenario: Scenario) -> float:
    """Return the damping [1/s] that is critical for the slowest vibration, where there may be."""
    return 2.0 * scenario.slowest_frequency() if scenario.quasi_static else 0.0


@dataclass(frozen=True)
class _Support:
    """How an end is held, and the force on it; `slides` is the axis along which it is free."""

    condition: EndCondition
    motion: Motion | None
    force: _Array
    slides: int | None = None


def _supports(rod: Rod) -> dict[End, _Support]:
    """Return how the ends are held."""
    return {
        end: _Support(
            rod.condition(end),
            rod.motion(end),
            sum((np.asarray(load.force) for load in rod.loads if load.at is end), np.zeros(3)),
            _sliding_axis(rod.motion(end)),
        )
        for end in End
    }


def _sliding_axis(motion: Motion | None) -> int | None:
    if motion is None or not motion.slides_along:
        return None
    along = np.abs(np.asarray(motion.slides_along, float))
    axis = int(np.argmax(along))
    if np.count_nonzero(along) > 1:
        raise NotImplementedError("a clamp that slides askew to the axes")
    return axis


def _end_tangents(rod: Rod) -> tuple[_Array, _Array]:
    """Return the directions of a centerline at its ends: those of circles through three points."""
    line = np.asarray(rod.centerline, float)
    return _first_tangent(line), -_first_tangent(line[::-1])


def _first_tangent(line: _Array) -> _Array:
    steps = np.diff(line[:3], axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    slopes = steps / lengths[:, None]
    tangent = slopes[0]
    if len(slopes) == 2:
        tangent = slopes[0] + (slopes[0] - slopes[1]) * lengths[0] / lengths.sum()
    return np.asarray(tangent / np.linalg.norm(tangent))


def _turning(motion: Motion) -> tuple[_Array, _Array]:
    """Return the axis about which a clamp turns, and its angles [rad]; the axis is 0 without."""
    vectors = np.asarray(motion.rotation, float)
    largest = vectors[np.argmax(np.linalg.norm(vectors, axis=1))]
    axis = largest / (np.linalg.norm(largest) or 1.0)
    angles = vectors @ axis
    if not np.allclose(np.outer(angles, axis), vectors, rtol=0.0, atol=1e-12):
        raise NotImplementedError("a clamp that turns about several axes")
    return axis, angles


def _scene_axes(nodes: _Array, supports: dict[End, _Support], gravity: _Array) -> list[int]:
    """Return the axes of space that are x, y (and z) of the scene.

    They are two if nothing happens along the third, and in cyclic order: a right-handed turn is
    counter-clockwise.
    """
    acting = [gravity]
    rotations = [np.zeros(3)]
    for one in supports.values():
        acting.append(one.force)
        if one.motion is not None:
            acting.extend(np.asarray(one.motion.displacement, float))
            rotations.append(_turning(one.motion)[0])
        if one.slides is not None:
            acting.append(np.eye(3)[one.slides])
    for axis in range(3):
        plane = [(axis + 1) % 3, (axis + 2) % 3]
        if (
            np.ptp(nodes[:, axis]) == 0.0
            and not np.any(np.array(acting)[:, axis])
            and not np.any(np.array(rotations)[:, plane])
        ):
            return plane
    return [0, 1, 2]


class _Case:
    """A rod of a scenario as a scene, and what its result is on the board."""

    def __init__(self, rod: Rod, scenario: Scenario, n_elements: int) -> None:
        self.nodes = rod.nodes(n_elements)
        self.directors = rod.directors(n_elements)
        self.supports = _supports(rod)
        gravity = np.asarray(scenario.gravity, float)
        self.axes = _scene_axes(self.nodes, self.supports, gravity)
        self.scene: dict[str, Any] = {
            "title": "A rod of the board",
            "model": "planar" if len(self.axes) == 2 else "spatial",
            "rods": [self._rod(rod)],
            "supports": list(self._held(rod)),
            "loads": [
                {"gravity": gravity[self.axes]},
                {
                    "damping": {
                        "coefficient": _damping_rate(scenario) * rod.material.density * rod.area
                    }
                },
                *(
                    {"point_force": {"rod": "rod", "at": end.value, "force": one.force[self.axes]}}
                    for end, one in self.supports.items()
                    if one.condition is EndCondition.FREE or one.slides is not None
                ),
            ],
        }

    def _drawn(self, rod: Rod) -> _Array:
        """Return the nodes of a shape with edges of one length, which tells where supports are.

        `run` writes the shape with which the rod starts.
        """
        share = np.linspace(0.0, 1.0, len(self.nodes))[:, None]
        start: _Array = np.asarray(rod.centerline[0], float)
        end: _Array = np.asarray(rod.centerline[-1], float)
        at_start, at_end = _end_tangents(rod)
        if self.supports[End.END].condition is EndCondition.FREE:
            return start + rod.length * share * at_start
        if self.supports[End.START].condition is EndCondition.FREE:
            return end - rod.length * (1.0 - share) * at_end
        chord = end - start
        span = float(np.linalg.norm(chord))
        clamped = [
            tangent
            for one, tangent in zip(self.supports.values(), (at_start, at_end), strict=True)
            if one.condition is EndCondition.CLAMPED
        ]
        if 2.0 * span > rod.length and all(chord @ one > span * (1.0 - 1e-12) for one in clamped):
            return start + share * chord
        edges = np.linalg.norm(np.diff(self.nodes, axis=0), axis=1)
        if np.ptp(edges) > 1e-4 * np.mean(edges):
            raise NotImplementedError(
                "a rod that starts bent and unevenly stretched, held at both ends"
            )
        return self.nodes

    def _rod(self, rod: Rod) -> dict[str, Any]:
        drawn: dict[str, Any] = {
            "name": "rod",
            "points": self._drawn(rod)[:, self.axes],
            "rest_length": rod.length,
            "cross_section": {"circle": {"radius": rod.radius}},
            "material": {
                "youngs_modulus": rod.material.youngs_modulus,
                "shear_modulus": rod.material.shear_modulus,
                "density": rod.material.density,
            },
            "natural_curvature": 0.0,
        }
        if len(self.axes) == 3:
            drawn["cross_section"]["director"] = self.directors[0]
            drawn |= {"natural_curvature": [0.0, 0.0], "natural_twist": 0.0}
        return drawn

    def _held(self, rod: Rod) -> Any:
        names = "xyz"
        for end, one in self.supports.items():
            support: dict[str, Any] = {"rod": "rod", "at": end.value}
            if one.condition is EndCondition.CLAMPED:
                support["clamp"] = True
                if one.slides is not None:
                    support["free"] = [names[self.axes.index(one.slides)]]
            elif one.condition is EndCondition.PINNED:
                support["fix"] = list(names[: len(self.axes)])
            else:
                continue
            if one.motion is not None:
                support["prescribe"] = self._moved(one.motion)
            yield support

    def _moved(self, motion: Motion) -> dict[str, Any]:
        times = list(motion.times)
        displacement = np.asarray(motion.displacement, float)
        moved: dict[str, Any] = {
            name: {"times": times, "values": displacement[:, axis]}
            for name, axis in zip("xyz", self.axes, strict=False)
            if np.any(displacement[:, axis])
        }
        axis, angles = _turning(motion)
        if np.any(axis):
            if len(self.axes) == 2:
                sign = axis[3 - sum(self.axes)]
                moved["angle"] = {"times": times, "values": sign * angles}
            else:
                moved["rotation"] = {"axis": axis, "angle": {"times": times, "values": angles}}
        return moved

    def run(self, solved: dict[str, Any]) -> Result:
        simulation = Simulation(self.scene | solved)
        simulation.positions[...] = self.nodes[:, self.axes]
        try:
            return simulation.run()
        except (DivergedError, NotConvergedError) as error:
            raise Diverged(str(error), simulation.time) from error

    def trajectory(self, result: Result) -> tuple[_Array, _Array]:
        """Return nodes and directors of a result as the board has them."""
        nodes = np.tile(self.nodes, (len(result.times), 1, 1))
        nodes[:, :, self.axes] = result.positions
        if len(self.axes) == 2:
            return nodes, self._turned_in_the_plane(result.positions)
        assert result.directors is not None
        assert result.sections is not None
        tangents = np.diff(nodes, axis=1)
        tangents /= np.linalg.norm(tangents, axis=2, keepdims=True)
        # Directors of the scene, carried from the frames of its edges, which begin at the pivots of
        # clamps, to the edges between nodes.
        framed = result.sections.frames[:, :, :3]
        along = np.sum(result.directors * tangents, axis=2) / (
            1.0 + np.sum(framed * tangents, axis=2)
        )
        own = result.directors - along[:, :, None] * (framed + tangents)
        # Those of the board stand at a constant angle to them.
        across = np.cross(tangents, own)
        cosine = np.sum(own[0] * self.directors, axis=1)[:, None]
        sine = np.sum(across[0] * self.directors, axis=1)[:, None]
        return nodes, cosine * own + sine * across

    def _turned_in_the_plane(self, positions: _Array) -> _Array:
        """Return the directors of a planar rod, which turn as its edges do."""
        first = np.diff(self.nodes[:, self.axes], axis=0)
        edges = np.diff(positions, axis=1)
        cosine = np.sum(first * edges, axis=2)
        sine = first[:, 0] * edges[:, :, 1] - first[:, 1] * edges[:, :, 0]
        length = np.hypot(cosine, sine)
        cosine, sine = cosine / length, sine / length
        x, y = self.directors[:, self.axes].T
        directors = np.tile(self.directors, (len(positions), 1, 1))
        directors[:, :, self.axes] = np.stack(
            [cosine * x - sine * y, sine * x + cosine * y], axis=2
        )
        return directors
