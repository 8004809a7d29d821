"""Cross-sections as they lie along rods, and the surfaces that they sweep.

A section has its own axes: director 1, along its width, and director 2 = tangent x director 1,
along its height.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der.run_data import RunData

Array = NDArray[np.float64]

_SIDES = 16  # of the polygon in place of a circle or an ellipse
#: At a node the surfaces of two edges meet on the bisecting plane, no farther out than by this.
_MITRE = 2.0


@dataclass(frozen=True, eq=False)
class Section:
    """The outline of a cross-section of which the scene gives the shape.

    Attributes
    ----------
    width, height
        Sizes along directors 1 and 2 [m].
    outline
        Corners along directors 1 and 2 [m], shape (corners, 2), counter-clockwise as seen against
        the tangent. Where sides meet in an edge its corner stands twice, once for each side.
    """

    width: float
    height: float
    outline: Array

    @property
    def is_round(self) -> bool:
        """Whether it is a circle or an ellipse, not a rectangle."""
        return len(self.outline) == _SIDES


def section_of(cross_section: Mapping[str, Any]) -> Section | None:
    """Return the outline of a ``cross_section`` of a scene; None where it gives stiffnesses."""
    if "rectangle" in cross_section:
        shape = cross_section["rectangle"]
        width, height = float(shape["width"]), float(shape["height"])
        corners = 0.5 * np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
        return Section(width, height, np.repeat(corners, 2, axis=0) * (width, height))
    if "ellipse" in cross_section:
        width, height = (float(cross_section["ellipse"][key]) for key in ("width", "height"))
    elif "circle" in cross_section:
        width = height = 2.0 * float(cross_section["circle"]["radius"])
    elif "tube" in cross_section:
        width = height = 2.0 * float(cross_section["tube"]["outer_radius"])
    else:
        return None
    angle = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    outline = 0.5 * np.column_stack([width * np.cos(angle), height * np.sin(angle)])
    return Section(width, height, outline)


def sections_of(result: RunData) -> list[Section | None]:
    """Return the section of each rod, in the order of `RunData.rods`."""
    return [section_of(rod["cross_section"]) for rod in result.scenario.to_dict()["rods"]]


def at_nodes(edge_vectors: Array, closed: bool = False) -> Array:
    """Return unit vectors at the nodes of a rod from those of its edges.

    At an inner node it is the mean of the two edges there; two opposite vectors have no mean, and
    the node has that of the edge after it.

    Parameters
    ----------
    edge_vectors
        Shape (..., edges, dim).
    closed
        Whether the last edge leads back to the first. Both ends then have the mean of these two,
        unless they are more than a right angle apart, as directors are that were glued turned.

    Returns
    -------
    array
        Shape (..., edges + 1, dim).
    """
    first, last = edge_vectors[..., :1, :], edge_vectors[..., -1:, :]
    if closed:
        meets = np.sum(first * last, axis=-1, keepdims=True) > 0.0
        first, last = (np.where(meets, first + last, own) for own in (first, last))
    inner = edge_vectors[..., :-1, :] + edge_vectors[..., 1:, :]
    sums = np.concatenate([first, inner, last], axis=-2)
    sizes = np.linalg.norm(sums, axis=-1, keepdims=True)
    after = np.concatenate([edge_vectors, last], axis=-2)
    return np.where(sizes > 1e-9, sums / np.maximum(sizes, 1e-9), after)


def directors_along(result: RunData, edge_directors: Array | None = None) -> list[Array | None]:
    """Return director 1 at the nodes of each rod, shape (frames, nodes of the rod, 3).

    Rods in a plane have one for all frames and nodes, shape (1, 1, 3): along z, or None where the
    scene turns the width into the plane. The model ``spatial_bend`` does not tell how its round
    sections lie: None.

    Parameters
    ----------
    result
        The run.
    edge_directors
        In place of those of its frames, shape (frames, edges, 3).
    """
    if result.model.dimension == 2:
        upright = np.array([[[0.0, 0.0, 1.0]]])
        rods = result.scenario.to_dict()["rods"]
        return [None if _lies_in_the_plane(rod["cross_section"]) else upright for rod in rods]
    along = edge_directors
    if along is None and result.sections is not None:
        along = result.directors
    if along is None:
        return [None] * len(result.rods)
    found: list[Array | None] = []
    first = 0  # edge of the rod
    for rod in result.rods:
        edges = len(rod.line_nodes) - 1
        found.append(at_nodes(along[:, first : first + edges], rod.closed))
        first += edges
    return found


def _lies_in_the_plane(cross_section: Mapping[str, Any]) -> bool:
    """Return whether a planar scene has the width of a section in its plane."""
    director = cross_section.get("director")
    return director is not None and float(np.hypot(*director[:2])) > 0.0


def _is_closed(line: Array) -> bool:
    """Return whether a line comes back to its first node."""
    return bool(np.array_equal(line[0], line[-1]))


def _edge_directions(line: Array) -> Array:
    """Return unit vectors along the edges of a line, shape (nodes - 1, dim)."""
    edges = np.diff(line, axis=0)
    return np.asarray(edges / np.linalg.norm(edges, axis=1, keepdims=True))


def tangents_of(line: Array) -> Array:
    """Return unit vectors along a line at its nodes: at inner ones, along the bisector.

    A line that ends where it begins is closed.

    `line` has the shape (nodes, dim), and so has the result.
    """
    return at_nodes(_edge_directions(line), _is_closed(line))


def section_axes(line: Array, directors: Array | None) -> tuple[Array, Array]:
    """Return directors 1 and 2 at the nodes, unit vectors across the line.

    Parameters
    ----------
    line
        Centre line, shape (nodes, 3).
    directors
        Director 1, shape (nodes, 3) or (1, 3); None for round sections, which may lie in any way:
        then a vector that is carried along the line.
    """
    tangents = tangents_of(line)
    if directors is None:
        directors = _carried(tangents)
    first = directors - np.sum(directors * tangents, axis=1, keepdims=True) * tangents
    first = first / np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-12)
    return first, np.cross(tangents, first)


def _carried(tangents: Array) -> Array:
    """Return a vector across the first tangent, carried along without turning about them."""
    vector = np.eye(3)[int(np.argmin(np.abs(tangents[0])))]
    found = []
    for tangent in tangents:
        vector = vector - (vector @ tangent) * tangent
        vector = vector / np.linalg.norm(vector)
        found.append(vector)
    return np.array(found)


def swept(line: Array, directors: Array | None, outline: Array) -> Array:
    """Return the corners of a section at each node of a rod, shape (nodes, corners, 3).

    At a node the surfaces of two edges meet on the bisecting plane.

    Parameters
    ----------
    line
        Centre line [m], shape (nodes, 3).
    directors
        As in `section_axes`.
    outline
        Corners along directors 1 and 2 [m], shape (corners, 2).
    """
    axes = np.stack(section_axes(line, directors), axis=1)  # nodes, 2, 3
    offsets = outline @ axes
    edges = _edge_directions(line)
    outer = (edges[-1:], edges[:1]) if _is_closed(line) else (edges[:1], edges[-1:])
    before, after = np.vstack([outer[0], edges]), np.vstack([edges, outer[1]])
    turn = after - before
    turn = turn / np.maximum(np.linalg.norm(turn, axis=1, keepdims=True), 1e-12)
    cosine = np.sum(tangents_of(line) * after, axis=1)
    stretch = np.minimum(1.0 / np.maximum(cosine, 1.0 / _MITRE), _MITRE) - 1.0
    along = np.einsum("ncj,nj->nc", offsets, turn)
    offsets += (stretch[:, None] * along)[:, :, None] * turn[:, None, :]
    corners: Array = line[:, None, :] + offsets
    return corners
