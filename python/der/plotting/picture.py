"""Runs as pictures show them: turned so that the picture's plane shows the shape best."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from der.plotting.lengths import label_positions
from der.plotting.supports import HeldPlace, SpringPlace
from der.scene_loads import ActingLoads, acting_loads

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from der._core import HeldNode, Rod, SpringSupport
    from der.run_data import RunData

Array = NDArray[np.float64]

#: A shape no thicker than this, against its size, lies in a coordinate plane.
_FLAT = 0.01
#: The tangent of a clamp that is nearer to the line of sight than this has no direction there.
_HEAD_ON = 1e-6


@dataclass(frozen=True, eq=False)
class PicturePlane:
    """The plane of a picture.

    Attributes
    ----------
    rotation
        Rows: unit vectors to the right, upwards and towards the viewer, shape (3, 3); None for a
        planar run, which is drawn as it is.
    names
        Titles of the two axes.
    """

    rotation: Array | None
    names: tuple[str, str]

    def turned(self, vectors: Array) -> Array:
        """Return vectors, shape (..., dim), with their components along the picture's axes."""
        return vectors if self.rotation is None else vectors @ self.rotation.T


def best_plane(positions: Array) -> PicturePlane:
    """Choose the plane of a picture for positions [m], shape (frames, nodes, dim).

    In space it is the coordinate plane that the shapes lie in at all frames, or else that of their
    first two principal axes.
    """
    if positions.shape[-1] == 2:
        return PicturePlane(None, ("x", "y"))
    points = positions.reshape(-1, 3)
    extents = np.ptp(points, axis=0)
    flattest = 2 - int(np.argmin(extents[::-1]))  # z before y before x
    if extents[flattest] <= _FLAT * extents.max():
        normal = np.eye(3)[flattest]
    else:
        centred = points - points.mean(axis=0)
        normal = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    nearest = np.eye(3)[int(np.argmin(np.abs(normal)))]  # the axis that is seen best
    right = nearest - (nearest @ normal) * normal
    right /= np.linalg.norm(right)
    up = np.cross(normal, right)
    if up[int(np.argmax(np.abs(up)))] < 0.0:
        up = -up
    return PicturePlane(np.vstack([right, up, np.cross(right, up)]), (_name(right), _name(up)))


def _name(axis: Array) -> str:
    largest = int(np.argmax(np.abs(axis)))
    if axis[largest] == 1.0:
        return "xyz"[largest]
    return f"along ({', '.join(f'{component + 0.0:.2f}' for component in axis)})"


class Picture:
    """A run turned into the plane of its pictures, where x is to the right and y upwards.

    In space the third component of vectors is the one towards the viewer.
    """

    def __init__(self, result: RunData) -> None:
        self.result = result
        initial = result.model.initial_positions
        self.plane = best_plane(np.concatenate([result.positions, initial[np.newaxis]]))

    @property
    def rods(self) -> list[Rod]:
        """The rods of the run."""
        return self.result.rods

    @cached_property
    def positions(self) -> Array:
        """Positions of all nodes [m], shape (frames, nodes, dim)."""
        return self.plane.turned(self.result.positions)

    @cached_property
    def initial_positions(self) -> Array:
        """Positions as drawn [m], shape (nodes, dim)."""
        return self.plane.turned(self.result.model.initial_positions)

    @cached_property
    def springs(self) -> list[SpringSupport] | list[SpringPlace]:
        """The spring supports of the scene."""
        from der._core import springs

        found = springs(self.result.scenario)
        if self.plane.rotation is None:
            return found
        return [
            SpringPlace(
                spring.rod,
                spring.nodes,
                spring.weights,
                self._seen_stiffness(np.array(spring.stiffness)).tolist(),
                spring.rotational_stiffness,
            )
            for spring in found
        ]

    def held_nodes(self, frame: int) -> list[HeldNode] | list[HeldPlace]:
        """Return the nodes that supports hold at a frame; those held towards the viewer only not.

        Raises `DerError` if there is no such frame.
        """
        held = self.result.held_nodes(frame)
        if self.plane.rotation is None:
            return held
        places = [self._turned_place(node) for node in held]
        return [place for place in places if place.components]

    def loads(self, frame: int) -> ActingLoads:
        """Return the loads at a frame."""
        loads = acting_loads(self.result, frame)
        if self.plane.rotation is None:
            return loads
        turned = self.plane.turned
        return ActingLoads(
            forces=[replace(load, value=turned(load.value)) for load in loads.forces],
            moments=[replace(load, value=turned(load.value)) for load in loads.moments],
            lines=[replace(load, value=turned(load.value)) for load in loads.lines],
            gravity=None if loads.gravity is None else turned(loads.gravity),
            foundations=[
                replace(part, stiffness=self._seen_stiffness(part.stiffness))
                for part in loads.foundations
            ],
        )

    def label(self, axes: Axes, low: Array, high: Array) -> None:
        """Title both axes in the unit that suits all between two corners [m], shape (2,)."""
        label_positions(axes, low, high, self.plane.names)

    def _seen_stiffness(self, stiffness: Array) -> Array:
        """Return stiffnesses along the scene's axes as those along the picture's axes."""
        assert self.plane.rotation is not None
        return np.asarray(self.plane.rotation**2 @ stiffness)

    def _turned_place(self, held: HeldNode) -> HeldPlace:
        assert self.plane.rotation is not None
        fixed = ["xyz".index(component) for component in held.components]
        components = [
            name
            for name, axis in zip("xy", self.plane.rotation[:2], strict=True)
            if np.linalg.norm(axis[fixed]) > 0.5
        ]
        angle = None
        if held.tangent is not None:
            along, up = self.plane.turned(held.tangent)[:2]
            if np.hypot(along, up) > _HEAD_ON:
                angle = float(np.arctan2(up, along))
        return HeldPlace(held.rod, held.node, components, angle)
