"""Rods to draw scenes from: straight ones, and smooth curves given by their nodes."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from .rod import Array, Rod, straight

Random = np.random.Generator


def power(rng: Random, low: float, high: float) -> float:
    """A number whose logarithm to the base of 10 is even between the two."""
    return float(10.0 ** rng.uniform(low, high))


@dataclasses.dataclass
class Drawing:
    """A rod as the scene has it and as the reference has it."""

    entry: dict[str, Any]
    rod: Rod
    node_u: Array
    node_s: Array
    straight: bool

    @property
    def nodes(self) -> int:
        return len(self.node_u)

    @property
    def length(self) -> float:
        return float(self.node_s[-1])

    def u(self, s: float) -> float:
        """The parameter of the place that the scene calls ``s``.

        On a drawn polyline ``s`` counts along its chords; on a finer mesh the place divides the
        curve between the same two nodes in the same proportion (docs/verify.md).
        """
        if self.straight:
            return s
        k = int(np.clip(np.searchsorted(self.node_s, s, side="right") - 1, 0, self.nodes - 2))
        share = (s - self.node_s[k]) / (self.node_s[k + 1] - self.node_s[k])
        a, b = float(self.node_u[k]), float(self.node_u[k + 1])
        if share <= 1e-12 or share >= 1 - 1e-12:
            return a if share < 0.5 else b
        points, weights = np.polynomial.legendre.leggauss(12)

        def arc(u: float) -> float:
            at = a + (u - a) * (points + 1) / 2
            return float((self.rod.curve(at)[3] * weights).sum() * (u - a) / 2)

        whole = arc(b)
        return float(brentq(lambda u: arc(u) - share * whole, a, b, xtol=1e-15 * (b - a)))


def draw(
    rng: Random,
    *,
    curved: float = 0.35,
    natural: float = 0.3,
    slender: tuple[float, float] = (2.5, 7.5),
    nodes: tuple[int, int] = (6, 80),
    scales: bool = True,
) -> Drawing:
    """A rod of any size between nanometres and kilometres."""
    L = power(rng, -8, 3) if scales and rng.random() < 0.6 else 1.0
    EI = power(rng, -3, 3) * L**4 * power(rng, 0, 6) if L != 1.0 else power(rng, -2, 2)
    EA = EI / L**2 * power(rng, *slender)
    mass = EI / L**3 * power(rng, -4, -1)
    count = round(power(rng, np.log10(nodes[0]), np.log10(nodes[1])))
    count += (count + 1) % 2  # so that there is a node in the middle
    entry: dict[str, Any] = {"name": "rod"}
    start = rng.uniform(-1, 1, 2) * L if rng.random() < 0.5 else np.zeros(2)
    is_straight = bool(rng.random() >= curved)
    if is_straight:
        angle = float(rng.choice([0.0, np.pi / 2, rng.uniform(-np.pi, np.pi)]))
        end = start + L * np.array([np.cos(angle), np.sin(angle)])
        knots, curve = straight(start, end)
        entry |= {"nodes": count, "from": start.tolist(), "to": end.tolist()}
        node_u = np.linspace(0.0, knots[-1], count)
        node_s = node_u
    else:
        count = max(count, 11)
        unit = _curve(rng)
        points = start + L * unit(np.linspace(0.0, 1.0, count))[0]
        entry["points"] = points.tolist()
        node_s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        last = node_s[-1]  # the parameter is about the arc length
        knots = node_u = np.linspace(0.0, last, count)

        def curve(u: Array) -> tuple[Array, Array, Array, Array]:
            position, d, dd = L * unit(np.asarray(u, float) / last)
            d, dd = d / last, dd / last**2
            speed = np.hypot(d[..., 0], d[..., 1])
            bend = (d[..., 0] * dd[..., 1] - d[..., 1] * dd[..., 0]) / speed**3
            return start + position, np.arctan2(d[..., 1], d[..., 0]), bend, speed

    rod = Rod(knots, curve, EA, EI, mass)
    if rng.random() < 0.15:
        _section(rng, entry, rod, L)
    else:
        entry["cross_section"] = {
            "stiffness": {"EA": rod.EA, "EI": rod.EI, "mass_per_length": rod.mass_per_length}
        }
    if rng.random() < natural:
        if rng.random() < 0.5 or not is_straight or count < 9:
            value = float(rng.uniform(-4, 4) / L)
            rod.natural = lambda u: np.full_like(u, value)
            entry["natural_curvature"] = value
        else:
            a, b = rng.uniform(-3, 3, 2) / L
            listed = a + b * np.cos(rng.uniform(1, 4) * node_u / L)
            pchip = PchipInterpolator(node_u, listed)
            rod.natural = lambda u: np.asarray(pchip(u), float)
            rod.knots = node_u
            entry["natural_curvature"] = listed.tolist()
    return Drawing(entry, rod, node_u, node_s, is_straight)


def _section(rng: Random, entry: dict[str, Any], rod: Rod, L: float) -> None:
    """A cross-section by its shape, with the formulas of docs/mechanics.md."""
    E, density = power(rng, 6, 11), power(rng, 2.5, 4)
    size = L * power(rng, -2.5, -1.3)
    kind = rng.choice(["circle", "tube", "rectangle"])
    if kind == "circle":
        entry["cross_section"] = {"circle": {"radius": size}}
        area, second = np.pi * size**2, np.pi * size**4 / 4
    elif kind == "tube":
        inner = size * float(rng.uniform(0.2, 0.9))
        entry["cross_section"] = {"tube": {"inner_radius": inner, "outer_radius": size}}
        area = np.pi * (size**2 - inner**2)
        second = np.pi * (size**4 - inner**4) / 4
    else:
        width = size * float(rng.uniform(0.5, 4))
        entry["cross_section"] = {"rectangle": {"width": width, "height": size}}
        area, second = width * size, width * size**3 / 12
    entry["material"] = {"youngs_modulus": E, "density": density}
    rod.EA, rod.EI, rod.mass_per_length = float(E * area), float(E * second), float(density * area)


def _curve(rng: Random) -> Callable[[Array], Array]:
    """A smooth curve of about unit length that starts at the origin.

    Its position and its first and second derivatives with respect to a parameter from 0 to 1.
    """
    kind = rng.choice(["arc", "sine", "parabola", "spiral"])
    if kind == "arc":
        of_parameter = _turning(rng.uniform(0.3, 4.5), 0.0)
    elif kind == "sine":
        height, wave = rng.uniform(0.03, 0.25), float(rng.choice([1, 2])) * np.pi
        of_parameter = lambda t: _graph(  # noqa: E731
            t,
            height * np.sin(wave * t),
            height * wave * np.cos(wave * t),
            -height * wave**2 * np.sin(wave * t),
        )
    elif kind == "parabola":
        rise = rng.uniform(-1, 1)
        of_parameter = lambda t: _graph(  # noqa: E731
            t, rise * t * (1 - t), rise * (1 - 2 * t), np.full_like(t, -2 * rise)
        )
    else:
        of_parameter = _turning(rng.uniform(0.5, 3), rng.uniform(-3, 3))
    turn = rng.uniform(-np.pi, np.pi) if rng.random() < 0.5 else 0.0
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[c, s], [-s, c]])
    return lambda t: of_parameter(t) @ rotation


def _graph(t: Array, y: Array, dy: Array, ddy: Array) -> Array:
    ones = np.ones_like(t)
    return np.stack([np.stack(pair, axis=-1) for pair in ((t, y), (ones, dy), (0 * t, ddy))])


def _turning(rate: float, growth: float) -> Callable[[Array], Array]:
    """A curve of unit speed that turns by rate t + growth t^2."""
    points, weights = np.polynomial.legendre.leggauss(40)

    def of_parameter(t: Array) -> Array:
        at = 0.5 * t[..., None] * (points + 1.0)
        angles = rate * at + growth * at**2
        heading = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        position = 0.5 * t[..., None] * np.einsum("...ij,i->...j", heading, weights)
        angle, bend = rate * t + growth * t**2, rate + 2.0 * growth * t
        d = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        dd = bend[..., None] * np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
        return np.stack([position, d, dd])

    return of_parameter
