"""Whether the shapes of two meshes, or of two steps, belong to the same solution.

A column that buckles may do so to either side, and rounding decides. Values on different sides say
nothing about the error of either. A finer mesh is therefore led to the side of the coarser one,
where that can be done.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from der._core import Model, Scenario
from der.result import Result

Array = NDArray[np.float64]

#: Final shapes farther apart than this share of the size may be different solutions.
_FAR = 0.02
#: A shape is a mirror image if the mirror leaves less than this share of the distance.
_MIRRORED = 0.2


def shape_on(result: Result, scenario: Scenario) -> Array:
    """Return the final shape of a run on the nodes of a finer mesh [m], shape (nodes, dim).

    Cubic splines through the nodes of each rod.
    """
    from scipy.interpolate import CubicSpline  # here, because it takes long to load

    model = Model(scenario)
    shape = np.empty((model.num_nodes, result.positions.shape[2]))
    for coarse, fine in zip(result.rods, model.rods, strict=True):
        old = np.linspace(0.0, 1.0, len(coarse.line_nodes))
        new = np.linspace(0.0, 1.0, len(fine.line_nodes))
        line = result.positions[-1][coarse.line_nodes]
        ends = "periodic" if coarse.closed else "not-a-knot"
        shape[fine.line_nodes] = CubicSpline(old, line, bc_type=ends)(new)
    return shape


def distance(coarse: Result, fine: Result) -> float:
    """Return how far apart two final shapes are at most, at the nodes of the coarser mesh [m]."""
    here, there = _shared_nodes(coarse, fine)
    return float(np.max(np.linalg.norm(here - there, axis=1)))


def are_far_apart(coarse: Result, fine: Result) -> bool:
    """Whether two final shapes may be different solutions."""
    return distance(coarse, fine) > _FAR * max(rod.length for rod in coarse.rods)


def are_mirrored(coarse: Result, fine: Result) -> bool:
    """Whether the final shape of one run is the mirror image of that of the other.

    The mirror that fits best is found by W. Kabsch's method (Acta Cryst. A 32, 1976, 922), which
    takes the singular vectors of the covariance, with a determinant of -1 here. It has to leave the
    initial shape as it is, too: a straight rod that swings has a mirror between any two instants.
    """
    if not are_far_apart(coarse, fine):
        return False
    here, there = _shared_nodes(coarse, fine)
    middle, center = here.mean(axis=0), there.mean(axis=0)
    left, _, right = np.linalg.svd((there - center).T @ (here - middle))
    flip = np.ones(here.shape[1])
    flip[-1] = -np.sign(np.linalg.det(left @ right))
    mirror = (left * flip) @ right
    initial = Model(coarse.scenario).initial_positions
    left_over = [
        np.linalg.norm(shape - middle - (image - center) @ mirror, axis=1)
        for shape, image in ((here, there), (initial, initial))
    ]
    return bool(np.max(np.concatenate(left_over)) < _MIRRORED * distance(coarse, fine))


def _shared_nodes(coarse: Result, fine: Result) -> tuple[Array, Array]:
    """Return the final positions of both at the nodes of the coarser mesh, shape (nodes, dim)."""
    here, there = [], []
    for few, many in zip(coarse.rods, fine.rods, strict=True):
        every = (len(many.line_nodes) - 1) // (len(few.line_nodes) - 1)
        here.append(coarse.positions[-1][few.nodes])
        there.append(fine.positions[-1][many.nodes[::every]])
    return np.concatenate(here), np.concatenate(there)
