"""Runs as pictures show them: turned so that the picture's plane shows the shape best."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from der.actuated_stretches import ActuatedStretch, actuated_stretches
from der.film import mode_displacements
from der.plotting.lengths import label_positions
from der.plotting.supports import HeldPlace, SpringPlace
from der.scene_loads import ActingLoads, acting_loads
from der.sections import directors_along, sections_of, seen_half_widths

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from der._core import HeldNode, Rod, SpringSupport
    from der.run_data import RunData

Array = NDArray[np.float64]

#: A shape no thicker than this, against its size, lies in a coordinate plane.
_FLAT = 0.01
#: The view from the side shows a shape unless it spreads so many times less upwards than sideways.
_LOW = 0.25
#: A horizontal axis that is nearer to a coordinate axis than this [rad] is turned into it.
_NEARLY = 0.35
#: A shape whose least variance sideways is more than this share of the largest is round: x will do.
_ROUND = 0.5
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

    In space it is the plane that the shapes lie in at all frames, if there is one. Other shapes are
    seen from the side, z upwards and the direction of their widest spread to the right; those that
    are much wider than high are seen from above.
    """
    if positions.shape[-1] == 2:
        return PicturePlane(None, ("x", "y"))
    points = positions.reshape(-1, 3)
    extents = np.ptp(points, axis=0)
    flattest = 2 - int(np.argmin(extents[::-1]))  # z before y before x
    axes = np.eye(3)
    if extents[flattest] <= _FLAT * extents.max():
        right, up = np.delete(axes, flattest, axis=0)
        return _plane(right, up)
    variances, directions = np.linalg.eigh(np.cov(points.T))
    if variances[0] <= _FLAT**2 * variances[2]:
        return _plane_across(directions[:, 0])
    spread, directions = np.linalg.eigh(np.cov(points[:, :2].T))
    widest = np.array([1.0, 0.0]) if spread[0] > _ROUND * spread[1] else directions[:, 1]
    right = np.array([*_towards_an_axis(widest), 0.0])
    if np.var(points[:, 2]) >= _LOW**2 * spread[0]:
        return _plane(right, axes[2])
    return _plane(right, np.array([-right[1], right[0], 0.0]))


def named_plane(name: str) -> PicturePlane:
    """Return the plane of a view such as ``xz``: the axis to the right, and the one upwards.

    Raises
    ------
    ValueError
        If the name is not that of two different axes.
    """
    if len(name) != 2 or not set(name) <= set("xyz") or name[0] == name[1]:
        raise ValueError(f"a view is two of x, y and z, such as xz, not {name!r}")
    right, up = (np.eye(3)["xyz".index(axis)] for axis in name)
    return _plane(right, up)


def _plane(right: Array, up: Array) -> PicturePlane:
    return PicturePlane(np.vstack([right, up, np.cross(right, up)]), (_name(right), _name(up)))


def _plane_across(normal: Array) -> PicturePlane:
    """Return the plane across a vector: z rises in it, unless it is nearly horizontal."""
    up = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
    if np.linalg.norm(up) < np.sin(_NEARLY):
        up = np.array([0.0, 1.0, 0.0]) - normal[1] * normal
    up /= np.linalg.norm(up)
    right = np.cross(up, normal)
    return _plane(right * np.sign(right[int(np.argmax(np.abs(right)))]), up)


def _towards_an_axis(direction: Array) -> Array:
    """Return a horizontal direction, or the coordinate axis near it, along which x or y grow."""
    nearest = int(np.argmax(np.abs(direction)))
    if np.abs(direction[nearest]) > np.cos(_NEARLY):
        return np.asarray(np.eye(2)[nearest])
    return np.asarray(direction * np.sign(direction[nearest]))


def _name(axis: Array) -> str:
    largest = int(np.argmax(np.abs(axis)))
    if axis[largest] == 1.0:
        return "xyz"[largest]
    return f"along ({', '.join(f'{component + 0.0:.2f}' for component in axis)})"


class Picture:
    """A run turned into the plane of its pictures, where x is to the right and y upwards.

    In space the third component of vectors is the one towards the viewer.
    """

    def __init__(self, result: RunData, view: str | None = None) -> None:
        self.result = result
        if view is None:
            initial = result.model.initial_positions
            modes = result.positions[-1] + mode_displacements(result)
            self.plane = best_plane(np.concatenate([result.positions, initial[np.newaxis], modes]))
        elif result.model.dimension == 2:
            raise ValueError("a planar run is seen in its plane, and in no other view")
        else:
            self.plane = named_plane(view)

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
    def _sections(self) -> list[tuple[str, Array, Array]]:
        """Name, outline [m] and directors of each rod whose section has a shape and a place."""
        along = zip(self.rods, sections_of(self.result), directors_along(self.result), strict=True)
        return [
            (rod.name, section.outline, self.plane.turned(directors))
            for rod, section, directors in along
            if section is not None and directors is not None and self.plane.rotation is not None
        ]

    def half_widths(self, frame: int, positions: Array) -> dict[str, Array]:
        """Return how far rods reach to both sides of their lines [m], by name, shape (line nodes,).

        Parameters
        ----------
        frame
            The frame as whose sections they lie.
        positions
            Where the nodes are in the picture [m], shape (nodes, 3).

        Returns
        -------
        dict
            Rods with sections alone; the others reach as far as their radius.
        """
        nodes = {rod.name: rod.line_nodes for rod in self.rods}
        return {
            name: seen_half_widths(positions[nodes[name]], directors[frame], outline)
            for name, outline, directors in self._sections
        }

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

    @cached_property
    def actuated(self) -> list[ActuatedStretch]:
        """The actuated stretches of the scene, with their values at all frames."""
        return actuated_stretches(self.result)

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
