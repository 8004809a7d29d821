"""Writhe and twist of closed curves.

Writhe of a smooth curve is the double integral (Gauss; Fuller, PNAS 68, 1971)

    Wr = 1/(4 pi) int int (r'(s) x r'(t)) . (r(s) - r(t)) / |r(s) - r(t)|^3 ds dt

over the closed curve. The ribbon that has one edge on the curve and reaches in the direction V,
across the tangent, has a whole linking number Lk = Tw + Wr (Calugareanu, White), and its twist is a
single integral of a smooth periodic function, which the trapezium rule has to rounding:

    Tw = 1/(2 pi) int (V x V') . t ds,  |V| = 1

so that Wr = Lk - Tw is exact; the double integral checks it and Lk.

Writhe of a polygon is the sum over pairs of edges of the signed solid angles of directions in which
they are seen to cross (Klenin and Langowski, Biopolymers 54, 2000, method 1a): exact. Polygons
inscribed in a curve converge to it with order 2.

A curve that is its own mirror image has writhe 0, as any curve in a plane or on a sphere. The link
of a ribbon about a plane ring whose edge goes n times around it is n, and so is its twist.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .record import Array, Problem, Reference

Curve = Callable[[Array], Array]


def figure_eight(height: float) -> Curve:
    """A figure of eight whose strands pass each other at the distance 2 height."""
    return lambda p: np.stack([np.sin(p), 0.5 * np.sin(2.0 * p), height * np.cos(p)])


def torus_knot(p: int, q: int) -> Curve:
    """p turns around the axis, q around the core; radii 2 and 1."""

    def curve(a: Array) -> Array:
        ring = 2.0 + np.cos(q * a)
        return np.stack([ring * np.cos(p * a), ring * np.sin(p * a), np.sin(q * a)])

    return curve


def slope(points: Array) -> Array:
    """Derivative by the parameter on [0, 2 pi) of periodic values, shape (3, n), by Fourier."""
    count = points.shape[1]
    waves = np.fft.fftfreq(count, 1.0 / count)
    waves[count // 2] = 0.0
    return np.asarray(np.fft.ifft(1j * waves * np.fft.fft(points, axis=1), axis=1).real)


def writhe(curve: Curve, count: int) -> float:
    """The double integral with `count` (even) points."""
    points = curve(2.0 * np.pi * np.arange(count) / count)
    rates = slope(points)
    total = 0.0
    for k in range(count):
        gap = points[:, k : k + 1] - points
        distance = np.sqrt((gap**2).sum(axis=0))
        distance[k] = 1.0
        triple = (np.cross(rates[:, k], rates, axis=0) * gap).sum(axis=0)
        total += float((triple / distance**3).sum())
    return total * (2.0 * np.pi / count) ** 2 / (4.0 * np.pi)


def polygon_writhe(points: Array) -> float:
    """Writhe of the closed polygon through `points`, shape (3, n)."""
    here, there = points.T, np.roll(points, -1, axis=1).T
    total = 0.0
    for k in range(len(here) - 2):
        other = slice(k + 2, len(here) - (1 if k == 0 else 0))
        total += float(_crossing(here[k], there[k], here[other], there[other]).sum())
    return total / (2.0 * np.pi)


def _crossing(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Signed solid angles of the edge (a, b) with the edges (c, d), shape (n,)."""
    sides = [c - a, d - a, d - b, c - b]
    normals = []
    for first, second in zip(sides, sides[1:] + sides[:1], strict=True):
        normal = np.cross(first, second)
        size = np.linalg.norm(normal, axis=1, keepdims=True)
        normals.append(normal / np.where(size > 0.0, size, 1.0))
    angle = np.zeros(len(c))
    for first, second in zip(normals, normals[1:] + normals[:1], strict=True):
        # The arc sine of the product, which it tells to all digits near a right angle too.
        size = np.linalg.norm(np.cross(first, second), axis=1)
        angle += np.arctan2((first * second).sum(axis=1), size)
    sign = np.sign((np.cross(d - c, b - a) * (c - a)).sum(axis=1))
    return np.asarray(angle * sign)


def torus_normal(p: int, q: int) -> Curve:
    """The normal of the torus along the knot."""
    return lambda a: np.stack(
        [np.cos(q * a) * np.cos(p * a), np.cos(q * a) * np.sin(p * a), np.sin(q * a)]
    )


def upward(a: Array) -> Array:
    """The direction z."""
    return np.repeat([[0.0], [0.0], [1.0]], len(a), axis=1)


def twist(curve: Curve, direction: Curve, count: int = 2048) -> float:
    """Twist, in turns, of the ribbon in this direction (made perpendicular to the tangent)."""
    a = 2.0 * np.pi * np.arange(count) / count
    rates = slope(curve(a))
    tangent = rates / np.linalg.norm(rates, axis=0)
    across = direction(a)
    across = across - (across * tangent).sum(axis=0) * tangent
    across = across / np.linalg.norm(across, axis=0)
    return float((np.cross(across, slope(across), axis=0) * tangent).sum(axis=0).mean())


def references() -> Problem:
    """Writhe of curves and of polygons on them."""
    values: dict[str, Reference] = {}
    # curve, direction of a ribbon, and its link: the signed crossings seen from above, or - P Q
    cases: dict[str, tuple[Curve, Curve, int]] = {
        f"figure_eight.{height:g}": (figure_eight(height), upward, 1) for height in (0.5, 0.1)
    }
    for p, q in ((2, 3), (3, 2), (1, 3), (1, 8)):
        cases[f"torus{p}.{q}"] = (torus_knot(p, q), torus_normal(p, q), -p * q)
    for label, (curve, direction, link) in cases.items():
        turns = twist(curve, direction)
        rounding = max(2.0 * abs(turns - twist(curve, direction, 1024)), 1e-13)
        if abs(writhe(curve, 400) - (link - turns)) > 1e-3:
            raise RuntimeError(f"writhe: the double integral of {label} disagrees")
        values[f"{label}.link"] = Reference(float(link), 1e-15, "turns")
        values[f"{label}.twist"] = Reference(turns, rounding, "turns")
        values[f"{label}.writhe"] = Reference(link - turns, rounding, "turns")
        for count in (20, 40, 80):
            points = curve(2.0 * np.pi * np.arange(count) / count)
            key = f"{label}.polygon{count}.writhe"
            values[key] = Reference(polygon_writhe(points), 1e-12, "turns")
    return Problem(
        "writhe",
        "writhe, twist and link, in turns: figure_eight.H: (sin a, sin(2 a)/2, H cos a), twist "
        "and link of the ribbon towards z; torusP.Q: ((2 + cos Q a) cos P a, (2 + cos Q a) sin P "
        "a, sin Q a), twist and link of the ribbon towards the torus' normal (cos Q a cos P a, "
        "cos Q a sin P a, sin Q a); polygonN: the closed polygon through N points of even "
        "parameter",
        "link minus a single integral by the trapezium rule; checked by the double integral to "
        "1e-3 (400 points) and by the polygons, whose writhe is a sum of solid angles",
        values,
    )
