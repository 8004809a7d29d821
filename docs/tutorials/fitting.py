"""A modulus and a damping coefficient from a noisy film of a tip, with confidence intervals.

python fitting.py             # writes fitting.png
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import der
import matplotlib.pyplot as plt
import numpy as np
from der.plotting import PALETTE, style
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import chi2, t

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

FRAME = 0.01  # s: between two pictures of the film
FRAMES = 100
NOISE = 2e-3  # m: standard deviation of a height in the film
TRUTH = np.array([1.5e6, 0.3])  # Pa, N s/m^2: what the fit is to find
GUESS = np.array([3e6, 0.1])  # where it begins

STRIP: dict[str, Any] = {
    "title": "A strip of silicone, let go",
    "rods": [
        {
            "name": "strip",
            "nodes": 17,
            "from": [0, 0],
            "to": [0.2, 0],
            "cross_section": {"rectangle": {"width": 0.02, "height": 0.01}},
            "material": {"youngs_modulus": 1e6, "density": 1100},
        }
    ],
    "supports": [{"rod": "strip", "at": "start", "clamp": True}],
    "loads": [{"gravity": [0, -9.81]}, {"damping": {"coefficient": 0.2}}],
    "time": {"duration": FRAME * FRAMES, "step": 0.005, "integrator": "tr_bdf2"},
}
PATHS = ("rods.strip.material.youngs_modulus", "loads.1.damping.coefficient")


def traces(parameters: Array, scene: dict[str, Any] = STRIP) -> Array:
    """Return the tip's height [m] in each picture: a row for each row of `parameters`."""
    members = len(parameters)
    vary = dict(zip(PATHS, np.transpose(parameters), strict=True))
    batch = der.Batch(scene, members, threads=1, vary=vary)
    heights = np.empty((members, FRAMES))
    for frame in range(FRAMES):
        batch.step(round(FRAME / scene["time"]["step"]))
        heights[:, frame] = batch.positions[:, -1, 1]
    for failure in batch.failures:
        raise failure.error()
    return heights


@lru_cache(maxsize=2)
def side_by_side(logarithms: tuple[float, ...]) -> tuple[Array, Array]:
    """Return the trace of parameters, and its slopes by their logarithms: one batch of five.

    The slopes are central differences, with errors of 1e-6 and less of the largest one.
    """
    change = 1e-4
    moved = change * np.vstack([np.zeros(2), np.eye(2), -np.eye(2)])
    here, *around = traces(np.exp(np.array(logarithms) + moved))
    up, down = np.array(around[:2]), np.array(around[2:])
    return here, ((up - down) / (2.0 * change)).T


@dataclass(frozen=True)
class Fit:
    """Parameters that fit data best, and how well the data tell them."""

    parameters: Array  # Pa, N s/m^2
    covariance: Array  # of their logarithms, (2, 2)
    noise: float  # m, as the residuals tell it
    trace: Array  # m, with these parameters

    def interval(self, level: float = 0.95) -> Array:
        """Return the lower and upper ends of the confidence intervals, shape (2, 2)."""
        factor = t.ppf(0.5 + 0.5 * level, FRAMES - 2) * np.sqrt(np.diag(self.covariance))
        return self.parameters * np.exp([-factor, factor])


def fit(data: Array, guess: Array = GUESS) -> Fit:
    """Find the parameters whose trace is closest to the data [m]."""
    found = least_squares(
        lambda x: side_by_side(tuple(x))[0] - data,
        np.log(guess),
        jac=lambda x: side_by_side(tuple(x))[1],
        x_scale=0.1,
        ftol=1e-6,
    )
    variance = 2.0 * found.cost / (FRAMES - 2)
    covariance = variance * np.linalg.inv(found.jac.T @ found.jac)
    return Fit(np.exp(found.x), covariance, float(np.sqrt(variance)), data + found.fun)


def film(generator: np.random.Generator, exact: Array) -> Array:
    """Return heights [m] with the noise of a film."""
    return np.asarray(exact + NOISE * generator.standard_normal(FRAMES))


def exact_trace() -> Array:
    """Return what nature does [m]: the truth on a mesh and with steps four times as fine."""
    (rod,), time = STRIP["rods"], STRIP["time"]
    fine = {
        **STRIP,
        "rods": [{**rod, "nodes": 4 * (rod["nodes"] - 1) + 1}],
        "time": {**time, "step": time["step"] / 4},
    }
    return np.asarray(traces(TRUTH[np.newaxis], fine)[0])


def repeated(exact: Array, films: int, seed: int = 1) -> list[Fit]:
    """Fit many films that differ by their noise."""
    generator = np.random.default_rng(seed)
    return [fit(film(generator, exact), TRUTH) for _ in range(films)]


def coverage(fits: list[Fit]) -> Array:
    """Return the share of the 95 % intervals in which the truth is, for each parameter."""
    inside = [(low <= TRUTH) & (high >= TRUTH) for low, high in (one.interval() for one in fits)]
    return np.asarray(np.mean(inside, axis=0))


def figure(data: Array, found: Fit, fits: list[Fit]) -> Figure:
    """Draw film and fit, what is left, and the parameters of many films in the ellipse of one."""
    times = FRAME * np.arange(1, FRAMES + 1)
    with style():
        figure = plt.figure(figsize=(9, 3.8), layout="constrained")
        left, right = figure.subfigures(1, 2, width_ratios=[1.5, 1], squeeze=False)[0]
        height, rest = left.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
        guessed = traces(GUESS[np.newaxis])[0]
        height.plot(times, 100 * guessed, "--", color="0.6", label="first guess")
        height.plot(times, 100 * data, ".", color=PALETTE[1], markersize=3, label="film")
        height.plot(times, 100 * found.trace, color=PALETTE[0], label="fit")
        height.set(ylabel="height of the tip [cm]")
        height.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
        rest.plot(times, 1e3 * (data - found.trace), ".", color=PALETTE[1], markersize=3)
        rest.axhline(0.0, color="0.7", linewidth=1)
        rest.set(xlabel="time [s]", ylabel="rest [mm]")
        plane = right.subplots()
        cloud = np.array([one.parameters for one in fits])
        plane.plot(1e-6 * cloud[:, 0], cloud[:, 1], ".", color="0.6", markersize=3)
        turn = np.linspace(0.0, 2.0 * np.pi, 200)
        circle = np.sqrt(chi2.ppf(0.95, 2)) * np.array([np.cos(turn), np.sin(turn)])
        ellipse = TRUTH[:, np.newaxis] * np.exp(np.linalg.cholesky(found.covariance) @ circle)
        plane.plot(1e-6 * ellipse[0], ellipse[1], color=PALETTE[0], label="95 % by the slopes")
        plane.plot(1e-6 * TRUTH[0], TRUTH[1], "k+", markersize=10, label="truth")
        plane.set(xlabel="modulus [MPa]", ylabel="damping [N s/m²]")
        plane.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure


def main() -> None:
    """Fit one film, and many; print the intervals and how often they hold; draw the picture."""
    exact = exact_trace()
    data = film(np.random.default_rng(0), exact)
    found = fit(data)
    low, high = found.interval()
    print(f"modulus {1e-6 * found.parameters[0]:.4f} MPa ({1e-6 * low[0]:.4f} to ", end="")
    print(f"{1e-6 * high[0]:.4f}), truth {1e-6 * TRUTH[0]:.4f}")
    print(f"damping {found.parameters[1]:.4f} N s/m^2 ({low[1]:.4f} to {high[1]:.4f}), ", end="")
    print(f"truth {TRUTH[1]:.4f}")
    print(f"noise {1e3 * found.noise:.2f} mm, truth {1e3 * NOISE:.2f} mm")
    fits = repeated(exact, films=100)
    shares = 100 * coverage(fits)
    print(f"{len(fits)} films: the truth is in {shares[0]:.1f} and {shares[1]:.1f} %", end=" ")
    print("of the 95 % intervals")
    figure(data, found, fits).savefig("fitting.png")


if __name__ == "__main__":
    main()
