"""Rods drawn by points, and lists with one value for each node, on a finer or coarser mesh."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: A turn of more than this is a corner that was meant, whatever is beside it [rad]; a little more,
#: so that rounding does not tell the nodes of a regular hexagon apart.
_SHARP_TURN = np.pi / 3.0 + 1e-9
#: So is one that is this many times what the curve turns, the same way, at both nodes beside it ...
_ISOLATED_TURN = 3.0
#: ... and more than this [rad]: the last turn of a curve stands alone, too, behind an inflection.
_LEAST_CORNER = 0.1
#: A turn below this is rounding [rad].
_NO_TURN = 1e-6
#: A jump of the curvature is this many times all that is uncertain about it.
_CLEAR_JUMP = 2.0
#: Share of either side in the value of a list at a jump, at least.
_LEAST_SHARE = 0.15
#: Nodes on either side of a jump, of the same leg, from which it is known.
_BESIDE_JUMP = 2

#: Points leave a curvature open that is uncertain by more than this share of the largest.
_OPEN_CURVATURE = 0.25
#: Elements for one, on which that is seen.
_WITHIN_ELEMENT = 4

#: Degree of the splines through points: the error of their curvature is of fourth order in the
#: distance of the points, that of a mesh of second.
_DEGREE = 5
#: That of splines to compare them with, whose error is smaller by two orders more.
_OTHER_DEGREE = 7


def find_corners(points: Array, *, certain: bool = False) -> list[int]:
    """Return the inner nodes at which a line has a corner instead of being a sampled curve.

    A corner is a turn of more than 60 degrees, or one of more than 0.1 that stands alone: three
    times what the line turns the same way at the nodes before and after. In a curve that is sampled
    finely enough to be computed with, neighbouring turns are alike (`model/corner.hpp`).

    Beside an end of the line, one of these two nodes is missing. A turn may then stand alone
    because the curve has an inflection behind it. It is a `certain` corner if it is also three
    times what the next two turns lead to.
    """
    size, axes = _turns(points)
    turns = size[:, None] * axes
    padded = np.pad(turns, ((1, 1), (0, 0)))
    if certain and len(turns) > 2:
        padded[0], padded[-1] = 2.0 * turns[[1, -2]] - turns[[2, -3]]
    beside = np.maximum(np.sum(axes * padded[:-2], axis=1), np.sum(axes * padded[2:], axis=1))
    alone = (size > _LEAST_CORNER) & (size > _ISOLATED_TURN * np.maximum(beside, 0.0))
    return [int(i) + 1 for i in np.flatnonzero(alone | (size > _SHARP_TURN))]


def find_curvature_jumps(points: Array, *, certain: bool = False) -> list[int]:
    """Return the inner nodes, corners apart, at which the curvature of a line jumps.

    On either side of a node the curvature is that of the two nodes next to it, extrapolated. It
    jumps if the two values differ by more than twice what the extrapolations change and what the
    turn at the node differs from that of the two sides, all added (`model/curvature_jump.hpp`).

    The flanks of a narrow peak may look like this, too. A jump is `certain` if the curvature of
    the third node on either side, where there is one, is as that of the first two.
    """
    beside = _BESIDE_JUMP
    inner = len(points) - 2
    if inner <= 2 * beside:
        return []
    size, axes = _turns(points)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    cells = 0.5 * (lengths[:-1] + lengths[1:])
    curvature = size[:, None] * axes / cells[:, None]
    nodes = np.cumsum(lengths)[:-1]
    places = nodes + (lengths[1:] - lengths[:-1]) / 3.0
    here = np.arange(beside, inner - beside)

    def extrapolated(step: int) -> tuple[Array, Array]:
        near, far = here + step, here + 2 * step
        reach = (nodes[here] - places[near]) / (places[near] - places[far])
        change = reach[:, None] * (curvature[near] - curvature[far])
        size = np.linalg.norm(change, axis=1)
        if certain:
            third = np.clip(far + step, 0, inner - 1)
            size += np.linalg.norm(curvature[far] - curvature[third], axis=1)
        return curvature[near] + change, size

    before, change_before = extrapolated(-1)
    after, change_after = extrapolated(1)
    share = (0.5 * lengths[here] / cells[here])[:, None]
    between = share * before + (1.0 - share) * after
    uncertain = change_before + change_after + np.linalg.norm(curvature[here] - between, axis=1)
    jump = np.linalg.norm(after - before, axis=1)
    found = here[(jump > _CLEAR_JUMP * uncertain) & (jump * cells[here] > _NO_TURN)] + 1
    corners = find_corners(points)
    return [int(i) for i in found if all(abs(i - corner) > beside for corner in corners)]


def _turns(points: Array) -> tuple[Array, Array]:
    """Return the angle at each inner node [rad] and the unit vector about which the line turns."""
    edges = np.diff(np.pad(points, ((0, 0), (0, 3 - points.shape[1]))), axis=0)
    before, after = edges[:-1], edges[1:]
    cross = np.cross(before, after)
    sine = np.linalg.norm(cross, axis=1)
    axes = np.divide(cross, sine[:, None], out=np.zeros_like(cross), where=sine[:, None] > 0.0)
    return np.arctan2(sine, np.sum(before * after, axis=1)), axes


def resample(
    points: Array, factor: Fraction, *, closed: bool = False, other_curve: bool = False
) -> Array:
    """Put `factor` times as many elements on a line; its nodes and corners keep their place.

    Between corners the new nodes lie on a spline through the old ones, over chord length, so that a
    curve drawn by points becomes rounder with every refinement. Straight parts stay straight. Where
    the curvature of the points jumps, so does that of the spline. A ring without corners is one
    periodic spline.

    Parameters
    ----------
    points
        Nodes [m], shape (nodes, dim); the first is not repeated.
    factor
        A whole number, or one over a whole number that divides the number of elements.
    closed
        Whether the first node follows the last one.
    other_curve
        Whether to take splines of another degree, through corners and jumps of the curvature that
        are not certain. They differ from the usual ones about as much as these do from the smooth
        curve that the points sample.

    Raises
    ------
    ValueError
        For any other factor, and where coarsening would cut a corner off.
    """
    count = len(points)
    elements = count if closed else count - 1
    beyond = _BESIDE_JUMP + 1 if closed else 0  # nodes behind the ends of a ring that tell of them
    around = np.take(points, np.arange(-beyond, count + beyond), axis=0, mode="wrap")

    def places(find: Callable[..., list[int]]) -> list[int]:
        found = find(around, certain=other_curve)
        return [i - beyond for i in found if beyond <= i < count + beyond]

    corners = places(find_corners)
    step = factor.denominator
    if factor.numerator == 1:
        if elements % step or any(corner % step for corner in corners):
            raise ValueError(
                f"a rod drawn by {count} points cannot do with 1/{step} of its elements"
            )
        return points[::step]
    if step != 1:
        raise ValueError(f"a rod drawn by points takes whole multiples of its {elements} elements")
    jumps = places(find_curvature_jumps)
    first = min(corners or jumps or [0]) if closed else 0  # where the line of a ring begins
    line = np.roll(points, -first, axis=0)
    if closed:
        line = np.vstack([line, line[:1]])
    inner = sorted((jump - first) % count for jump in jumps if jump != first or not closed)
    ends = "free"
    if closed and not corners:
        ends = "jump" if jumps else "smooth"
    bounds = [0, *(corner - first for corner in corners if corner > first), len(line) - 1]
    legs = [
        _refine_leg(
            line[a : b + 1],
            [jump - a for jump in inner if a < jump < b],
            factor.numerator,
            other_curve,
            ends,
        )
        for a, b in itertools.pairwise(bounds)
    ]
    refined = np.vstack([*(leg[:-1] for leg in legs), line[-1:]])
    return np.roll(refined[:-1], first * factor.numerator, axis=0) if closed else refined


def unresolved_nodes(points: Array, *, closed: bool = False) -> list[int]:
    """Return the nodes beside which points do not tell how their curve bends.

    There the usual curve through them and the other one (`resample`) differ in curvature by more
    than a quarter of the largest. Certain corners do not count.
    """
    factor = _WITHIN_ELEMENT
    curvatures, turns = [], []
    for other in (False, True):
        line = resample(points, Fraction(factor), closed=closed, other_curve=other)
        if closed:
            line = np.vstack([line[-1:], line, line[:1]])
        size, axes = _turns(line)
        lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
        curvatures.append(2.0 * size[:, None] * axes / (lengths[:-1] + lengths[1:])[:, None])
        turns.append(size)
    nodes = np.arange(len(turns[0])) + (0 if closed else 1)
    corners = np.array(find_corners(points, certain=True), dtype=int)
    smooth = ~np.isin(nodes, factor * corners)
    apart = np.linalg.norm(curvatures[0] - curvatures[1], axis=1)
    largest = np.max(np.linalg.norm(curvatures[1], axis=1), where=smooth, initial=0.0)
    bends = np.maximum(*turns) > _NO_TURN
    found = np.flatnonzero(smooth & bends & (apart > _OPEN_CURVATURE * largest))
    return sorted({int(node) for node in np.rint(nodes[found] / factor) % len(points)})


def _refine_leg(
    points: Array, jumps: list[int], factor: int, other_curve: bool, ends: str
) -> Array:
    """Put new nodes on the splines of a leg, one from each jump of the curvature to the next.

    `ends` is "smooth" or "jump" for a ring whose two ends meet like this, "free" for other legs.
    """
    from scipy.interpolate import make_interp_spline  # here, because it takes long to load

    chord = arc_lengths(points)
    old = np.arange(len(points))
    new = np.interp(np.arange(factor * (len(points) - 1) + 1) / factor, old, chord)
    if ends == "smooth":
        degree = _OTHER_DEGREE if other_curve else _DEGREE
        refined: Array = make_interp_spline(chord, points, degree, bc_type="periodic")(new)
        refined[::factor] = points
        return refined
    bounds = list(itertools.pairwise([0, *jumps, len(points) - 1]))
    pieces = [(chord[a : b + 1], points[a : b + 1]) for a, b in bounds]
    splines = [_spline(*piece, other_curve) for piece in pieces]
    slopes: list[list[Array | None]] = [[None, None] for _ in pieces]
    for after in range(0 if ends == "jump" else 1, len(pieces)):
        slopes[after - 1][1], slopes[after][0] = _common_slopes(
            splines[after - 1], pieces[after - 1][0][-2:], splines[after], pieces[after][0][:2]
        )
    refined = np.empty((len(new), points.shape[1]))
    for (a, b), piece, slope in zip(bounds, pieces, slopes, strict=True):
        here = slice(factor * a, factor * b + 1)
        refined[here] = _spline(*piece, other_curve, *slope)(new[here])
    refined[::factor] = points
    return refined


def _spline(
    chord: Array,
    points: Array,
    other_curve: bool,
    first: Array | None = None,
    last: Array | None = None,
) -> Any:
    """Return a spline through points, with the slopes `first` and `last` at its ends if given.

    Without them, two edges beside an end have one polynomial ("not-a-knot"), three of degree 7.
    Splines of degree 5 and 7 have one of degree 4 and 6 there, since higher ones overshoot.
    """
    from scipy.interpolate import make_interp_spline

    degree = _degree(len(points) + (first is not None) + (last is not None), other_curve)
    if degree < 3:  # without the slopes
        return make_interp_spline(chord, points, min(degree, len(points) - 1))
    flat = [(degree, np.zeros(points.shape[1]))] if degree > 3 else []
    ends = [flat if slope is None else [(1, slope), *flat] for slope in (first, last)]
    merged = max(1, (degree - 3) // 2)
    start = 1 + merged - (first is not None)
    stop = len(chord) - 1 - merged + (last is not None)
    outer = np.ones(degree + 1)
    knots = np.concatenate([chord[0] * outer, chord[start:stop], chord[-1] * outer])
    return make_interp_spline(chord, points, degree, knots, tuple(end or None for end in ends))


def _degree(conditions: int, other_curve: bool) -> int:
    """Return the degree of a spline that meets a number of conditions, points for the most part.

    Where they are too few for a higher degree, the other spline has a lower one.
    """
    if not other_curve:
        return _DEGREE if conditions >= _DEGREE else min(conditions - 1, 3)
    return _OTHER_DEGREE if conditions >= _OTHER_DEGREE else max(1, min(conditions - 2, 3))


def _common_slopes(
    before: Any, last_edge: Array, after: Any, first_edge: Array
) -> tuple[Array, Array]:
    """Return the slopes at the end of a spline and the start of the next in one direction.

    An error in the direction of a spline's end is like the cube of what it turns along an edge, so
    that a straight leg gives the direction to the arc that it runs into. The edges, beside the node
    where the two meet, are chord lengths of their two ends.
    """
    end, start = last_edge[1], first_edge[0]
    slopes = before(end, 1), after(start, 1)
    turn_before = np.linalg.norm(before(end, 2)) * np.ptp(last_edge)
    turn_after = np.linalg.norm(after(start, 2)) * np.ptp(first_edge)
    sizes = [float(np.linalg.norm(slope)) for slope in slopes]
    mean = turn_after**3 * slopes[0] / sizes[0] + turn_before**3 * slopes[1] / sizes[1]
    mean /= np.linalg.norm(mean)
    return sizes[0] * mean, sizes[1] * mean


def resample_list(values: Array, elements: int, *, closed: bool = False) -> Array:
    """Return the values at the nodes of another mesh of evenly divided elements.

    Piecewise cubic and monotone between the old nodes (PCHIP), so that nothing overshoots. Where an
    open list jumps at a node, as a natural curvature does, each side has its own curve, up to the
    value of the node, which is the mean of both. In a closed list the first node follows the last.
    """
    from scipy.interpolate import PchipInterpolator

    if closed:
        count = len(values)
        beside = 3  # nodes beyond either end that the interpolation sees
        around = np.concatenate([values[-beside:], values, values[: beside + 1]])
        places = np.arange(len(around), dtype=float) - beside
        ring: Array = PchipInterpolator(places, around)(np.arange(elements) * (count / elements))
        return ring
    last = len(values) - 1
    new = np.linspace(0.0, last, elements + 1)
    jumps = _list_jumps(values)
    resampled = np.empty((elements + 1, *values.shape[1:]))
    for start, end in itertools.pairwise([0, *jumps, last]):
        side = values[start : end + 1].copy()
        if start in jumps:
            side[0] = _continued(values[start + 1], values[start + 2])
        if end in jumps:
            side[-1] = _continued(values[end - 1], values[end - 2])
        here = (start <= new) & (new <= end)
        resampled[here] = PchipInterpolator(np.arange(start, end + 1.0), side)(new[here])
    for node in jumps:
        resampled[np.abs(new - node) < 1e-9 * last] = values[node]
    return resampled


def _continued(near: Array, far: Array) -> Array:
    """Return the next value after two."""
    line: Array = near + (near - far)
    return line


def _list_jumps(values: Array) -> list[int]:
    """Return the inner nodes at which a list jumps, by the rule of `find_curvature_jumps`.

    Edges may differ in length: the value of such a node is any mean of those of its two sides.
    """
    flat = values.reshape(len(values), -1)
    found = []
    for node in range(_BESIDE_JUMP + 1, len(flat) - _BESIDE_JUMP - 1):
        near, far, after, beyond = flat[[node - 1, node - 2, node + 1, node + 2]]
        low, high = _continued(near, far), _continued(after, beyond)
        jump = high - low
        size = float(np.linalg.norm(jump))
        if size == 0.0:
            continue
        share = float((flat[node] - low) @ jump) / size**2
        beside = np.linalg.norm(flat[node] - low - share * jump)
        uncertain = np.linalg.norm(near - far) + np.linalg.norm(after - beyond) + beside
        if _LEAST_SHARE < share < 1.0 - _LEAST_SHARE and size > _CLEAR_JUMP * uncertain:
            found.append(node)
    return found


def arc_lengths(points: Array, *, closed: bool = False) -> Array:
    """Return the arc length of each node [m], shape (nodes,); last that back at the first node."""
    if closed:
        points = np.vstack([points, points[:1]])
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
