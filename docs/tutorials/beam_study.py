"""Deflection of a cantilever against its load: linear theory, exact elastica, der with error bars.

python beam_study.py          # writes beam_study.png
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import der
import matplotlib.pyplot as plt
import numpy as np
from der.plotting import PALETTE, style
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LENGTH = 0.3  # m, a steel ruler
WIDTH, HEIGHT = 0.025, 0.0005  # m
MODULUS, DENSITY = 200e9, 7850.0  # Pa, kg/m^3
EI = MODULUS * WIDTH * HEIGHT**3 / 12.0
LOADS = np.array([0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0]) * EI / LENGTH**2  # N

RULER: dict[str, Any] = {
    "title": "Steel ruler, clamped, with a weight at its tip",
    "rods": [
        {
            "name": "ruler",
            "nodes": 21,
            "from": [0, 0],
            "to": [LENGTH, 0],
            "cross_section": {"rectangle": {"width": WIDTH, "height": HEIGHT}},
            "material": {"youngs_modulus": MODULUS, "density": DENSITY},
        }
    ],
    "supports": [{"rod": "ruler", "at": "start", "clamp": True}],
    "loads": [{"point_force": {"rod": "ruler", "at": "end", "force": [0, -1]}}],
    "analysis": "static",
    "output": {"probes": {"tip": {"rod": "ruler", "at": "end", "quantity": "y"}}},
}


@dataclass(frozen=True)
class Point:
    """Deflections of the tip under one load [m]."""

    load: float  # N
    found: float
    error_bar: float  # the truth is within found +- bar
    extrapolated: float
    verdict: str
    linear: float
    exact: float


def linear(load: float) -> float:
    """Return the deflection of Euler-Bernoulli's theory, P L^3 / (3 EI) [m]."""
    return load * LENGTH**3 / (3.0 * EI)


def elastica(load: float) -> float:
    """Return the deflection of the inextensible elastica [m], by elliptic integrals.

    The slope t of the tip solves a = K(m) - F(p | m) with a^2 = P L^2/EI, m = (1 + sin t)/2,
    sin p = 1/sqrt(2 m); the deflection is L (1 - 2 (E(m) - E(p | m))/a).
    """
    a = np.sqrt(load * LENGTH**2 / EI)

    def amplitude(m: float) -> float:
        return float(np.arcsin(1.0 / np.sqrt(2.0 * m)))

    def excess(m: float) -> float:
        return float(ellipk(m) - ellipkinc(amplitude(m), m) - a)

    m = brentq(excess, 0.5 + 1e-12, 1.0 - 1e-12, xtol=1e-15)
    return float(LENGTH * (1.0 - 2.0 * (ellipe(m) - ellipeinc(amplitude(m), m)) / a))


def study() -> list[Point]:
    """Return one point for each load, with its error bar."""
    scene = der.Scenario.from_dict(RULER)
    points = []
    for load in LOADS.tolist():
        loaded = scene.with_(**{"loads.0.point_force.force": [0, -load]})
        tip = der.verify(loaded)["tip"]
        points.append(
            Point(
                load,
                -tip.value,
                tip.error_bar,
                -tip.extrapolated,
                tip.verdict,
                linear(load),
                elastica(load),
            )
        )
    return points


def figure(points: list[Point]) -> Figure:
    """Draw deflection against load, and error beside error bar."""
    loads = [point.load for point in points]
    with style():
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
        smooth = np.linspace(1e-3, loads[-1], 200)
        left.plot(smooth, [elastica(p) for p in smooth], color="0.5", label="elastica")
        left.plot(smooth, [linear(p) for p in smooth], "--", color=PALETTE[1], label="linear")
        left.errorbar(
            loads,
            [point.found for point in points],
            [point.error_bar for point in points],
            fmt="o",
            capsize=3,
            color=PALETTE[0],
            label="der, 20 elements",
        )
        left.set(xlabel="load [N]", ylabel="deflection of the tip [m]", ylim=(0, LENGTH))
        left.legend(loc="lower right")

        right.loglog(
            loads,
            [p.error_bar for p in points],
            "_",
            color=PALETTE[0],
            markersize=14,
            label="error bar",
        )
        for values, marker, label in (
            ([p.found - p.exact for p in points], "o", "error"),
            ([p.extrapolated - p.exact for p in points], "^", "error when extrapolated"),
        ):
            right.loglog(loads, np.abs(values), marker, color=PALETTE[2], label=label)
        right.lines[-1].set_color(PALETTE[3])
        right.set(xlabel="load [N]", ylabel="error of the deflection [m]")
        right.legend(loc="lower right")
    return figure


def main() -> None:
    """Print the table, draw the picture."""
    points = study()
    print("load [N]  der [m]                 elastica [m]  linear [m]")
    for point in points:
        print(
            f"{point.load:8.4f}  {point.found:.7f} +- {point.error_bar:.1e}   "
            f"{point.exact:.7f}     {point.linear:.7f}"
        )
    figure(points).savefig("beam_study.png")


if __name__ == "__main__":
    main()
