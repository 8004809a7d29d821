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
        return _every_nth(points, len(points) - 1, factor.denominator, corners)
    _demand_whole(factor, len(points) - 1)
    return _refine_between(points, corners, factor.numerator)


def resample_ring(points: Array, factor: Fraction) -> Array:
    """Put `factor` times as many elements on a closed line, as `resample_line` does on an open one.

    A ring without corners is one periodic spline.

    Parameters
    ----------
    points
        Nodes [m], shape (nodes, dim); the first is not repeated.
    factor
        As in `resample_line`.

    Raises
    ------
    ValueError
        As `resample_line`.
    """
    count = len(points)
    around = np.vstack([points[-2:], points, points[:2]])
    corners = [i - 2 for i in find_corners(around) if 2 <= i < count + 2]
    if factor.numerator == 1:
        return _every_nth(points, count, factor.denominator, corners)
    _demand_whole(factor, count)
    if not corners:
        line = np.vstack([points, points[:1]])
        return _refine_piece(line, factor.numerator, ends="periodic")[:-1]
    first = corners[0]
    rolled = np.roll(points, -first, axis=0)
    inner = [corner - first for corner in corners[1:]]
    line = _refine_between(np.vstack([rolled, rolled[:1]]), inner, factor.numerator)
    return np.roll(line[:-1], first * factor.numerator, axis=0)


def _demand_whole(factor: Fraction, elements: int) -> None:
    if factor.denominator != 1:
        raise ValueError(f"a rod drawn by points takes whole multiples of its {elements} elements")


def _refine_between(points: Array, corners: list[int], factor: int) -> Array:
    ends = [0, *corners, len(points) - 1]
    pieces = [_refine_piece(points[a : b + 1], factor) for a, b in itertools.pairwise(ends)]
    return np.vstack([*(piece[:-1] for piece in pieces), points[-1:]])


def _every_nth(points: Array, elements: int, step: int, corners: list[int]) -> Array:
    if elements % step or any(corner % step for corner in corners):
        raise ValueError(
            f"a rod drawn by {len(points)} points cannot do with 1/{step} of its elements"
        )
    return points[::step]


def _refine_piece(points: Array, factor: int, ends: str = "not-a-knot") -> Array:
    from scipy.interpolate import CubicSpline  # here, because it takes long to load

    chord = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    old = np.arange(len(points))
    new = np.arange(factor * (len(points) - 1) + 1) / factor
    refined: Array = CubicSpline(chord, points, bc_type=ends)(np.interp(new, old, chord))
    refined[::factor] = points
    return refined


def resample_list(values: Array, elements: int, *, closed: bool = False) -> Array:
    """Return the values at the nodes of another mesh of evenly divided elements.

    Piecewise cubic and monotone between the old nodes (PCHIP), so a jump does not overshoot.

    Parameters
    ----------
    values
        One value for each node, shape (nodes,) or (nodes, dim).
    elements
        Number of elements of the new mesh.
    closed
        Whether the first node follows the last one.
    """
    from scipy.interpolate import PchipInterpolator

    if closed:
        count = len(values)
        beside = 3  # nodes beyond either end that the interpolation sees
        around = np.concatenate([values[-beside:], values, values[: beside + 1]])
        places = np.arange(len(around), dtype=float) - beside
        ring: Array = PchipInterpolator(places, around)(np.arange(elements) * (count / elements))
        return ring
    old = np.arange(len(values), dtype=float)
    resampled: Array = PchipInterpolator(old, values)(np.linspace(0.0, old[-1], elements + 1))
    return resampled


def arc_lengths(points: Array, *, closed: bool = False) -> Array:
    """Return the arc length of each node [m], shape (nodes,); last that back at the first node."""
    if closed:
        points = np.vstack([points, points[:1]])
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
