"""Rods drawn by points, and lists with one value for each node, on a finer or coarser mesh."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: A turn of more than this is a corner that was meant, whatever is beside it [rad].
_SHARP_TURN = np.pi / 3.0
#: So is one that is this many times what the curve turns, the same way, at both nodes beside it.
_ISOLATED_TURN = 3.0
#: A turn below this is rounding [rad].
_NO_TURN = 1e-6


def find_corners(points: Array) -> list[int]:
    """Return the inner nodes at which a line has a corner instead of being a sampled curve.

    A corner is a turn of more than 60 degrees, or one that stands alone: three times what the line
    turns the same way at the nodes before and after. In a curve that is sampled finely enough to be
    computed with, neighbouring turns are alike.

    Parameters
    ----------
    points
        Nodes [m], shape (nodes, dim).

    Returns
    -------
    list of int
        Node numbers, ascending.
    """
    size, axes = _turns(points)
    padded = np.pad(size[:, None] * axes, ((1, 1), (0, 0)))
    beside = np.maximum(np.sum(axes * padded[:-2], axis=1), np.sum(axes * padded[2:], axis=1))
    alone = (size > _NO_TURN) & (size > _ISOLATED_TURN * np.maximum(beside, 0.0))
    return [int(i) + 1 for i in np.flatnonzero(alone | (size > _SHARP_TURN))]


def _turns(points: Array) -> tuple[Array, Array]:
    """Return the angle at each inner node [rad] and the unit vector about which the line turns."""
    edges = np.diff(np.pad(points, ((0, 0), (0, 3 - points.shape[1]))), axis=0)
    before, after = edges[:-1], edges[1:]
    cross = np.cross(before, after)
    sine = np.linalg.norm(cross, axis=1)
    axes = np.divide(cross, sine[:, None], out=np.zeros_like(cross), where=sine[:, None] > 0.0)
    return np.arctan2(sine, np.sum(before * after, axis=1)), axes


def resample_line(points: Array, factor: Fraction) -> Array:
    """Put `factor` times as many elements on a line; its nodes and corners keep their place.

    Between corners the new nodes lie on a cubic spline through the old ones, over chord length, so
    that a curve drawn by points becomes rounder with every refinement. Straight parts stay
    straight.

    Parameters
    ----------
    points
        Nodes [m], shape (nodes, dim).
    factor
        A whole number, or one over a whole number that divides the number of elements.

    Raises
    ------
    ValueError
        For any other factor, and where coarsening would cut a corner off.
    """
    corners = find_corners(points)
    if factor.numerator == 1:
        return _every_nth(points, factor.denominator, corners)
    if factor.denominator != 1:
        raise ValueError(
            f"a rod drawn by points takes whole multiples of its {len(points) - 1} elements"
        )
    ends = [0, *corners, len(points) - 1]
    pieces = [
        _refine_piece(points[a : b + 1], factor.numerator) for a, b in itertools.pairwise(ends)
    ]
    return np.vstack([*(piece[:-1] for piece in pieces), points[-1:]])


def _every_nth(points: Array, step: int, corners: list[int]) -> Array:
    elements = len(points) - 1
    if elements % step or any(corner % step for corner in corners):
        raise ValueError(
            f"a rod drawn by {len(points)} points cannot do with 1/{step} of its elements"
        )
    return points[::step]


def _refine_piece(points: Array, factor: int) -> Array:
    from scipy.interpolate import CubicSpline  # here, because it takes long to load

    chord = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    old = np.arange(len(points))
    new = np.arange(factor * (len(points) - 1) + 1) / factor
    refined: Array = CubicSpline(chord, points)(np.interp(new, old, chord))
    refined[::factor] = points
    return refined


def resample_list(values: Array, elements: int) -> Array:
    """Return the values at the nodes of another mesh of evenly divided elements.

    Piecewise cubic and monotone between the old nodes (PCHIP), so a jump does not overshoot.

    Parameters
    ----------
    values
        One value for each node, shape (nodes,) or (nodes, dim).
    elements
        Number of elements of the new mesh.
    """
    from scipy.interpolate import PchipInterpolator

    old = np.arange(len(values), dtype=float)
    resampled: Array = PchipInterpolator(old, values)(np.linspace(0.0, old[-1], elements + 1))
    return resampled


def arc_lengths(points: Array) -> Array:
    """Return the arc length of each node [m], shape (nodes,)."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
