"""A rod as a page shows it: its section as it lies, and its spheres."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from der._core import Rod
from der.plotting.style import PALETTE
from der.sections import at_nodes, section_of, swept

Array: TypeAlias = NDArray[np.float64]

_THINNEST = 0.025  # that the mouse finds, against the size of the structure [m], which is 1 here
_LIGHT = "#dcebf7"


class Tube:
    """A rod; in the model ``spatial`` its side along director 1 is light.

    The mouse can take hold of its `meshes`. It is `magnified` times as thick as it is.
    """

    def __init__(
        self, scene: Any, rod: Rod, cross_section: dict[str, Any], size: float, model: str
    ) -> None:
        self.rod, self._model = rod, model
        given = section_of(cross_section)
        section = given or section_of({"circle": {"radius": 0.5 * _THINNEST * size}})
        assert section is not None
        self.magnified = max(1.0, _THINNEST * size / max(section.width, section.height))
        self._outline = self.magnified / size * section.outline
        outwards = 0.5 * (self._outline + np.roll(self._outline, -1, axis=0))[:, 0]
        light = (model == "spatial") & (outwards > 0.9 * outwards.max())
        nodes, name = len(rod.line_nodes), f"/rods/{rod.name}"
        none = np.zeros((nodes * len(outwards), 3))
        self._skin = [
            scene.add_mesh_simple(
                f"{name}/{part}", none, _triangles(nodes, sides), color=rgb(colour), side="double"
            )
            for part, sides, colour in (("body", ~light, PALETTE[0]), ("light", light, _LIGHT))
            if sides.any()
        ]
        self._spheres = {
            number: scene.add_icosphere(f"{name}/{number}", radius / size, rgb(PALETTE[0]))
            for number, radius in enumerate(rod.sphere_radii.tolist())
            if radius > 0.0
        }
        self.meshes = [*self._skin, *self._spheres.values()]

    def show(self, line: Array, edge_directors: Array) -> None:
        """Show the rod along a line, shape (nodes, 3), with director 1 of the model ``spatial``."""
        directors = None
        if self._model == "planar":
            directors = np.array([[0.0, 0.0, 1.0]])
        elif self._model == "spatial":
            directors = at_nodes(edge_directors, self.rod.closed)
        vertices = swept(line, directors, self._outline).reshape(-1, 3)
        for mesh in self._skin:
            mesh.vertices = vertices.astype(np.float32)
        for number, sphere in self._spheres.items():
            sphere.position = line[number]


def rgb(colour: str) -> tuple[int, int, int]:
    """Return red, green and blue from 0 to 255 of a colour such as ``#0072B2``."""
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return red, green, blue


def _triangles(nodes: int, sides: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return triangles of some sides of a tube from node to node, and of its ends with the last."""
    corners, count = np.arange(len(sides)), len(sides)
    after = np.roll(corners, -1)
    here, there = corners[sides], after[sides]
    pairs = np.stack([here, there, there + count, here, there + count, here + count], axis=1)
    along = count * np.arange(nodes - 1)[:, None, None] + pairs
    first = np.column_stack([np.zeros_like(corners), after, corners])
    last = np.column_stack([np.zeros_like(corners), corners, after]) + count * (nodes - 1)
    ends = [first, last] if sides[count // 2] else []
    return np.concatenate([along.reshape(-1, 3), *ends])
