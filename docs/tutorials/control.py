"""The tip of a soft arm follows a target: a PI controller turns the clamp in every step.

python control.py             # writes control.png
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import der
import matplotlib.pyplot as plt
import numpy as np
from der.plotting import PALETTE, style
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LENGTH = 0.5  # m
STEP = 0.005  # s: the controller's period too
PAYLOAD = 0.02  # kg, hung on the tip at PICKED_UP
PICKED_UP = 10.0  # s

ARM: dict[str, Any] = {
    "title": "A soft arm on a motor",
    "rods": [
        {
            "name": "arm",
            "nodes": 21,
            "from": [0, 0],
            "to": [LENGTH, 0],
            "cross_section": {"circle": {"radius": 0.01}},
            "material": {"youngs_modulus": 3e7, "density": 1000},
        }
    ],
    # The prescribed angle makes the clamp a motor: the program turns it.
    "supports": [
        {"rod": "arm", "at": "start", "clamp": True, "prescribe": {"angle": 0}},
    ],
    "loads": [{"gravity": [0, -9.81]}, {"damping": {"coefficient": 2.0}}],
    "start_from": "equilibrium",
    "time": {"duration": 16, "step": STEP},
}


def target(time: float) -> float:
    """Return the height at which the tip should be [m]."""
    return float(0.1 * np.sin(2.0 * np.pi * 0.1 * time))


def open_loop(time: float, height: float) -> float:
    """Return the motor's angle [rad] at which the tip of a rigid arm is at the target."""
    return float(np.arcsin(target(time) / LENGTH))


@dataclass
class PI:
    """A proportional-integral controller: it corrects the open loop by the tip's height [m]."""

    proportional: float = 0.5  # rad/m
    integral: float = 6.0  # rad/(m s)
    summed: float = 0.0  # m s

    def __call__(self, time: float, height: float) -> float:
        """Return the angle to turn to [rad]."""
        error = target(time) - height
        self.summed += error * STEP
        return open_loop(time, height) + self.proportional * error + self.integral * self.summed


@dataclass(frozen=True)
class Track:
    """The recorded motion of a run, one value for each step."""

    times: NDArray[np.float64]  # s
    heights: NDArray[np.float64]  # m
    angles: NDArray[np.float64]  # rad
    shapes: NDArray[np.float64]  # m, (steps, nodes, 2)

    def error(self, start: float, end: float) -> float:
        """Return the root mean square of the tracking error between two times [m]."""
        chosen = (self.times > start) & (self.times <= end)
        wanted = np.array([target(time) for time in self.times[chosen]])
        return float(np.sqrt(np.mean((self.heights[chosen] - wanted) ** 2)))


def run(controller: Callable[[float, float], float]) -> Track:
    """Step the arm, with the controller in the loop."""
    simulation = der.Simulation(der.Scenario.from_dict(ARM))
    times, heights, angles, shapes = [], [], [], []
    while not simulation.finished:
        if simulation.time >= PICKED_UP:
            simulation.extra_force[-1, 1] = -9.81 * PAYLOAD
        height = simulation.positions[-1, 1]
        simulation.prescribe(0, angle=controller(simulation.time, height))
        simulation.step()
        times.append(simulation.time)
        heights.append(simulation.positions[-1, 1])
        angles.append(simulation.prescribed(0)["angle"])
        shapes.append(simulation.positions.copy())
    return Track(np.array(times), np.array(heights), np.array(angles), np.array(shapes))


def figure(controlled: Track, uncontrolled: Track) -> Figure:
    """Draw the arm, its tip against the target, and what the motor does."""
    with style():
        figure = plt.figure(figsize=(9, 3.8), layout="constrained")
        left, right = figure.subfigures(1, 2, width_ratios=[1, 1.5], squeeze=False)[0]
        arm = left.subplots()
        arm.plot([], [], "_", color="0.3", markersize=14, label="target")
        # Other colours than on the right, where they tell with feedback from without.
        for time, colour in ((2.5, PALETTE[2]), (5.0, PALETTE[3]), (7.5, PALETTE[5])):
            shape = controlled.shapes[round(time / STEP) - 1]
            arm.plot(*shape.T, color=colour, linewidth=2.5, label=f"{time:g} s")
            arm.plot(LENGTH * 0.99, target(time), "_", color=colour, markersize=14)
        arm.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
        arm.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
        height, angle = right.subplots(2, 1, sharex=True, height_ratios=[1.6, 1])
        times = controlled.times
        height.plot(times, uncontrolled.heights, color=PALETTE[1], label="without feedback")
        height.plot(times, controlled.heights, color=PALETTE[0], label="with feedback")
        height.plot(times, [target(t) for t in times], "k--", linewidth=1, label="target")
        for axes in (height, angle):
            axes.axvline(PICKED_UP, color="0.7", linewidth=1)
        place = height.get_xaxis_transform()
        height.text(PICKED_UP + 0.15, 0.04, "payload on", transform=place, fontsize="small")
        height.set(ylabel="height of the tip [m]")
        height.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
        angle.plot(times, np.rad2deg(controlled.angles), color=PALETTE[0])
        angle.plot(times, np.rad2deg(uncontrolled.angles), color=PALETTE[1])
        angle.set(xlabel="time [s]", ylabel="motor [°]")
    return figure


def main() -> None:
    """Run with and without feedback; print the errors, draw the picture."""
    controlled, uncontrolled = run(PI()), run(open_loop)
    for name, track in (("with feedback", controlled), ("without", uncontrolled)):
        print(
            f"{name:14} error {1e3 * track.error(4, PICKED_UP):6.2f} mm, "
            f"with the payload {1e3 * track.error(PICKED_UP + 2, 16):6.2f} mm"
        )
    figure(controlled, uncontrolled).savefig("control.png")


if __name__ == "__main__":
    main()
