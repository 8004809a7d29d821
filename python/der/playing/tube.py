"""A rod on the stage of a page: its section as it lies, and its spheres."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from der._core import Rod
from der.plotting.style import PALETTE
from der.sections import at_nodes, section_of, swept

Array: TypeAlias = NDArray[np.float64]

_THINNEST = 0.025  # a rod that the mouse finds, against the size of the structure
_LIGHT = "#dcebf7"


class Tube:
    """A rod; in the model ``spatial`` its side along director 1 is light.

    Parameters
    ----------
    scene
        The scene of viser.
    rod, cross_section
        The rod, and what the scene file says of its section.
    size
        A length on the stage is one in m by this.
    model
        Name of the model, which tells how sections lie.

    Attributes
    ----------
    meshes
        What the mouse can take hold of.
    magnified
        How many times as thick as it is the rod is shown.
    """

    def __init__(
        self, scene: Any, rod: Rod, cross_section: dict[str, Any], size: float, model: str
    ) -> None:
        self.rod, self._model = rod, model
        given = section_of(cross_section)
        section = given or section_of({"circle": {"radius": 0.5 * _THINNEST * size}})
        assert section is not None
        least = _THINNEST * size / max(section.width, section.height)
        self.magnified = max(1.0, least) if given else 1.0
        self._outline = max(1.0, least) / size * section.outline
        outwards = 0.5 * (self._outline + np.roll(self._outline, -1, axis=0))[:, 0]
        light = (model == "spatial") & (outwards > 0.9 * outwards.max())
        self._skin = [
            scene.add_mesh_simple(
                f"/rods/{rod.name}/{name}",
                np.zeros((len(rod.line_nodes) * len(self._outline), 3)),
                _triangles(len(rod.line_nodes), sides),
                color=rgb(colour),
                side="double",
            )
            for name, sides, colour in (("body", ~light, PALETTE[0]), ("light", light, _LIGHT))
            if sides.any()
        ]
        self._spheres = {
            number: scene.add_icosphere(
                f"/rods/{rod.name}/spheres/{number}", radius / size, rgb(PALETTE[0])
            )
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
        vertices = swept(line, directors, self._outline).reshape(-1, 3).astype(np.float32)
        for mesh in self._skin:
            mesh.vertices = vertices
        for number, sphere in self._spheres.items():
            sphere.position = line[number]


def rgb(colour: str) -> tuple[int, int, int]:
    """Return red, green and blue from 0 to 255 of a colour such as ``#0072B2``."""
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return red, green, blue


def _triangles(nodes: int, sides: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return triangles of some sides of a tube from node to node, and of its ends."""
    corners = np.arange(len(sides))
    after = np.roll(corners, -1)
    rings = len(sides) * np.arange(nodes - 1)[:, None, None]
    here, there = corners[sides], after[sides]
    next_here, next_there = here + len(sides), there + len(sides)
    pairs = np.stack([here, there, next_there, here, next_there, next_here], axis=1)
    first = np.column_stack([0 * corners, after, corners])
    last = np.column_stack([0 * corners, corners, after]) + len(sides) * (nodes - 1)
    ends = [first, last] if sides[len(sides) // 2] else []
    return np.concatenate([(rings + pairs).reshape(-1, 3), *ends])
