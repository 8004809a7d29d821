"""A finger of three chambers traces a circle with its tip: inverse, feedback, a disturbance.

python finger.py              # writes finger.png and finger.gif
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import der
import matplotlib.pyplot as plt
import numpy as np
from der.plotting import PALETTE, style
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

ANGLES = np.deg2rad([90.0, 210.0, 330.0])  # towards which each chamber bends
BENDS = 0.25  # 1/(m kPa): curvature by the pressure in one chamber
STRETCHES = 0.001  # 1/kPa: elongation by the pressure in one chamber

RADIUS, DEPTH = 0.03, 0.127  # m: of the circle, and how far it is below the base
PERIOD = 4.0  # s: once around
STEP = 0.005  # s: the controller's period too
PUSH = [0.015, 0.0, 0.0]  # N: the disturbance at the tip, during the second round

FINGER: dict[str, Any] = {
    "title": "A finger of three chambers",
    "rods": [
        {
            "name": "finger",
            "nodes": 21,
            "from": [0, 0, 0],
            "to": [0, 0, -0.12],
            "cross_section": {"circle": {"radius": 0.008}, "director": [1, 0, 0]},
            "material": {"youngs_modulus": 3e5, "poissons_ratio": 0.49, "density": 1100},
        }
    ],
    "supports": [{"rod": "finger", "at": "start", "clamp": True}],
    "actuation": [
        {"name": "bend", "rod": "finger", "natural_curvature": [0, 0]},
        {"name": "grow", "rod": "finger", "elongation": 0},
    ],
    "loads": [
        {"gravity": [0, 0, -9.81]},
        {"damping": {"coefficient": 2.0}},
        {"name": "push", "point_force": {"rod": "finger", "at": "end", "force": [0, 0, 0]}},
    ],
    "start_from": "equilibrium",
    "time": {"duration": 3 * PERIOD, "step": STEP, "integrator": "tr_bdf2"},
    "output": {"every": 0.05},
}


def target(time: float) -> Array:
    """Return where the tip should be [m]."""
    angle = 2.0 * np.pi * time / PERIOD
    return np.array([RADIUS * np.cos(angle), RADIUS * np.sin(angle), -DEPTH])


def rest_shape(pressures: Array) -> tuple[Array, float]:
    """Return the two curvatures [1/m] and the elongation that three pressures [kPa] make."""
    across = np.array([np.cos(ANGLES), np.sin(ANGLES)])
    return BENDS * across @ pressures, STRETCHES * float(np.sum(pressures))


def inflate(simulation: der.Simulation, pressures: Array) -> None:
    """Set the chambers' pressures [kPa]."""
    curvatures, elongation = rest_shape(pressures)
    simulation.set("bend", curvatures)
    simulation.set("grow", elongation)


class Inverse:
    """The pressures [kPa] at which the tip of the equilibrium is on the circle, found at points.

    Attributes
    ----------
    times
        When the target is at these points [s], shape (points,).
    pressures
        The pressures of the three chambers [kPa], shape (points, 3).
    slopes
        How the tip [m] changes with the pressures [kPa], shape (points, 3, 3).
    error
        The largest distance [m] from tip to target.
    """

    def __init__(self, points: int = 24) -> None:
        simulation = der.Simulation(der.Scenario.from_dict(FINGER))

        def miss(pressures: Array, time: float) -> Array:
            inflate(simulation, pressures)
            simulation.equilibrium()
            return np.asarray(1e3 * (simulation.positions[-1] - target(time)))  # mm

        self.times = PERIOD * np.arange(points) / points
        guess = np.full(3, 20.0)
        found = []
        for time in self.times.tolist():
            found.append(least_squares(miss, guess, bounds=(0.0, 200.0), args=(time,)))
            guess = np.clip(found[-1].x, 1.0, 199.0)
        self.pressures = np.array([one.x for one in found])
        self.slopes = np.array([1e-3 * one.jac for one in found])
        self.error = float(np.max([1e-3 * np.linalg.norm(one.fun) for one in found]))

    def pressures_at(self, time: float) -> Array:
        """Return the pressures [kPa] at a time."""
        return np.asarray(self._pressures(time % PERIOD))

    def correction(self, time: float, error: Array) -> Array:
        """Return the change of the pressures [kPa] that moves the tip by `error` [m]."""
        return np.asarray(self._inverses(time % PERIOD) @ error)

    @cached_property
    def _pressures(self) -> CubicSpline:
        return self._around(self.pressures)

    @cached_property
    def _inverses(self) -> CubicSpline:
        return self._around(np.linalg.inv(self.slopes))

    def _around(self, values: Array) -> CubicSpline:
        times = np.append(self.times, PERIOD)
        return CubicSpline(times, np.concatenate([values, values[:1]]), bc_type="periodic")


@dataclass
class Feedback:
    """An integral controller of the tip's place, on top of the inverse."""

    inverse: Inverse
    integral: float = 4.0  # 1/s
    summed: Array | float = 0.0  # m s

    def __call__(self, time: float, tip: Array) -> Array:
        """Return the pressures [kPa] to go to in the next step."""
        self.summed = self.summed + STEP * (target(time) - tip)
        ahead = time + STEP
        change = self.inverse.correction(ahead, self.integral * self.summed)
        pressures = self.inverse.pressures_at(ahead) + change
        return np.maximum(pressures, 0.0)  # chambers cannot pull


@dataclass
class OpenLoop:
    """The inverse alone."""

    inverse: Inverse

    def __call__(self, time: float, tip: Array) -> Array:
        """Return the pressures [kPa] to go to in the next step."""
        return self.inverse.pressures_at(time + STEP)


@dataclass(frozen=True)
class Track:
    """What a run recorded, at its start and after every step."""

    times: Array  # s
    tips: Array  # m, (steps + 1, 3)
    pressures: Array  # kPa, (steps + 1, 3)
    pushes: Array  # N, (steps + 1, 3)

    @cached_property
    def errors(self) -> Array:
        """Distance of the tip from the target [m]."""
        wanted = np.array([target(time) for time in self.times.tolist()])
        return np.asarray(np.linalg.norm(self.tips - wanted, axis=1))

    def error(self, lap: int) -> float:
        """Return the root mean square of the distance in the last three quarters of a round [m]."""
        laps = self.times / PERIOD - lap
        return float(np.sqrt(np.mean(self.errors[(laps > 0.25) & (laps <= 1.0)] ** 2)))


def run(controller: Feedback | OpenLoop) -> Track:
    """Step the finger three times around, pushed during the second round."""
    simulation = der.Simulation(der.Scenario.from_dict(FINGER))
    pressures = controller.inverse.pressures_at(0.0)
    inflate(simulation, pressures)
    simulation.equilibrium()
    rows = [(0.0, simulation.positions[-1].copy(), pressures, simulation.value("push"))]
    while not simulation.finished:
        pressures = controller(simulation.time, simulation.positions[-1])
        inflate(simulation, pressures)
        pushed = PERIOD <= simulation.time + 0.5 * STEP < 2.0 * PERIOD
        simulation.set("push", PUSH if pushed else [0, 0, 0])
        simulation.step()
        tip = simulation.positions[-1].copy()
        rows.append((simulation.time, tip, pressures, simulation.value("push")))
    times, tips, pressed, pushes = (np.array(column) for column in zip(*rows, strict=True))
    return Track(times, tips, pressed, pushes)


def replay(track: Track) -> der.Result:
    """Run the scene with what the controller did as tables: a result to draw and to keep."""
    shapes = [rest_shape(pressures) for pressures in track.pressures]
    times = track.times.tolist()

    def table(values: Any) -> dict[str, Any]:
        return {"times": times, "values": np.asarray(values).tolist()}

    bend, grow = FINGER["actuation"]
    *others, push = FINGER["loads"]
    curvatures = np.array([curvature for curvature, _ in shapes]).T
    scene = {
        **FINGER,
        "actuation": [
            {**bend, "natural_curvature": [table(values) for values in curvatures]},
            {**grow, "elongation": table([elongation for _, elongation in shapes])},
        ],
        "loads": [
            *others,
            {**push, "point_force": {**push["point_force"], "force": table(track.pushes)}},
        ],
    }
    return der.run(scene)


def figure(inverse: Inverse, controlled: Track, uncontrolled: Track) -> Figure:
    """Draw the tips from above, their errors, and the pressures."""
    with style():
        figure = plt.figure(figsize=(9, 4.2), layout="constrained")
        left, right = figure.subfigures(1, 2, width_ratios=[1, 1.3], squeeze=False)[0]
        above = left.subplots()
        wanted = np.array([target(time) for time in inverse.times.tolist()])
        looks = [(uncontrolled, PALETTE[1], "without"), (controlled, PALETTE[0], "with feedback")]
        for track, colour, label in looks:
            above.plot(*1e3 * track.tips[:, :2].T, color=colour, label=label)
        above.plot(*1e3 * wanted[:, :2].T, "k.", markersize=5, label="targets of the inverse")
        above.set(aspect="equal", xlabel="x of the tip [mm]", ylabel="y of the tip [mm]")
        above.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0))
        error, pressure = right.subplots(2, 1, sharex=True)
        for track, colour, label in looks:
            error.semilogy(track.times[1:], 1e3 * track.errors[1:], color=colour, label=label)
        for chamber, values in enumerate(controlled.pressures.T):
            colour = PALETTE[2 + chamber]
            pressure.plot(controlled.times, values, color=colour, label=f"chamber {chamber + 1}")
        for axes in (error, pressure):
            axes.axvspan(PERIOD, 2.0 * PERIOD, color="0.93", zorder=0)
        place = error.get_xaxis_transform()
        error.text(PERIOD + 0.1, 0.04, "pushed", transform=place, fontsize="small")
        error.set(ylabel="error [mm]")
        error.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
        pressure.set(xlabel="time [s]", ylabel="pressure [kPa]")
        pressure.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    return figure


def main() -> None:
    """Find the inverse, run with and without feedback; print the errors, draw the pictures."""
    inverse = Inverse()
    print(
        f"{len(inverse.times)} points: {inverse.pressures.min():.1f} to "
        f"{inverse.pressures.max():.1f} kPa, off by {1e3 * inverse.error:.0e} mm at most"
    )
    controlled, uncontrolled = run(Feedback(inverse)), run(OpenLoop(inverse))
    for name, track in (("with feedback", controlled), ("without", uncontrolled)):
        first, pushed, last = (1e3 * track.error(lap) for lap in range(3))
        print(f"{name:14} error {first:5.2f} mm, pushed {pushed:5.2f} mm, after it {last:5.2f} mm")
    result = replay(controlled)
    off = np.linalg.norm(result.positions[-1, -1] - controlled.tips[-1])
    print(f"replayed from tables: the tip ends {off:.0e} m from where it was")
    figure(inverse, controlled, uncontrolled).savefig("finger.png")
    result.animate("finger.gif", speed=2, fps=10)


if __name__ == "__main__":
    main()
