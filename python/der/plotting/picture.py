"""Runs as pictures show them: planar ones as they are, runs in space by a camera."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from der._core import axial_springs, hinges, springs
from der.actuated_stretches import ActuatedStretch, actuated_stretches
from der.plotting.actuation import draw_actuation
from der.plotting.lengths import label_positions
from der.plotting.loads import add_gravity_to_legend, draw_loads, room_for_loads
from der.plotting.shapes import Shape, draw_shapes, limits
from der.plotting.supports import (
    draw_axial_springs,
    draw_hinges,
    draw_springs,
    draw_supports,
)
from der.scene_loads import ActingLoads, acting_loads
from der.sections import directors_along

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.typing import ColorType

    from der._core import Rod
    from der.run_data import RunData

Array = NDArray[np.float64]


class Picture:
    """A planar run in its plane; a run in space is a `der.plotting.space.SpatialPicture`."""

    #: Whether its axes have numbers; in perspective the floor has them.
    has_axes = True
    #: Shapes of a motion in one picture.
    instants = 6

    def __init__(self, result: RunData, scale: float = 1.0) -> None:
        self.result = result
        drawn = result.model.initial_positions if scale != 1.0 else 0.0
        #: Positions of all nodes [m] as they are shown: displacements from the shape as drawn are
        #: `scale` times as large.
        self.positions = drawn + scale * (result.positions - drawn)

    @property
    def rods(self) -> list[Rod]:
        """The rods of the run."""
        return self.result.rods

    @cached_property
    def actuated(self) -> list[ActuatedStretch]:
        """The actuated stretches of the scene, with their values at all frames."""
        return actuated_stretches(self.result)

    @cached_property
    def _directors(self) -> list[Array | None]:
        return directors_along(self.result)

    @cached_property
    def _axial_springs(self) -> list[list[int]]:
        return axial_springs(self.result.scenario)

    @cached_property
    def _hinges(self) -> list[int]:
        return hinges(self.result.scenario)

    def shape(self, frame: int, colour: ColorType, label: str | None = None) -> Shape:
        """Return the shape at a frame of the run."""
        directors = [one if one is None else one[frame % len(one)] for one in self._directors]
        return Shape(self.positions[frame], frame, colour, label, directors)

    def loads(self, frame: int) -> ActingLoads:
        """Return the loads at a frame."""
        return acting_loads(self.result, frame)

    def corners(
        self, shapes: Sequence[Shape], loads: ActingLoads, room: tuple[float, float]
    ) -> tuple[Array, Array]:
        """Return the lower left and upper right corner [m] of shapes and the loads on the last.

        `room` is the width and the height of the axes [inch] at most.
        """
        low, high = limits(self.rods, [shape.positions for shape in shapes])
        point = float(np.max((high - low) / np.array(room))) / 72.0
        more = room_for_loads(self.rods, loads, shapes[-1].positions, point)
        return np.vstack([low, more]).min(axis=0), np.vstack([high, more]).max(axis=0)

    def seen(self, points: Array) -> Array:
        """Return where points [m] are in the picture, shape (points, 2)."""
        return points

    def look_as(self, other: Picture) -> None:
        """Look from where another picture of the scene does."""

    def draw(self, axes: Axes, shapes: Sequence[Shape], at: Shape, loads: ActingLoads) -> None:
        """Draw shapes, and supports, actuation and these loads on the one `at`."""
        for shape in shapes:
            draw_shapes(
                axes, self.rods, shape.positions, shape.colour, shape.label, shape.linestyle
            )
        draw_actuation(axes, self.rods, self.actuated, at.frame, at.positions)
        draw_supports(axes, self.rods, self.result.held_nodes(at.frame), at.positions)
        draw_springs(axes, self.rods, springs(self.result.scenario), at.positions)
        draw_axial_springs(axes, (at.positions[ends] for ends in self._axial_springs))
        if self._hinges:
            draw_hinges(axes, at.positions[self._hinges])
        draw_loads(axes, self.rods, loads, at.positions)

    def add_gravity(self, axes: Axes, gravity: Array) -> None:
        """Add gravity [m/s^2] to the legend."""
        add_gravity_to_legend(axes, gravity, gravity)

    def finish(self, axes: Axes, low: Array, high: Array, metres_per_point: float) -> None:
        """Title the axes in the unit that suits all between two corners [m], shape (2,).

        A picture has so many metres in a point on paper.
        """
        label_positions(axes, low, high)
