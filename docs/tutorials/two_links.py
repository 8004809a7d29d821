"""A finger of two links with a motor: what holding a weight takes, and a motor that gives way.

python two_links.py           # writes two_links.png
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import der
import matplotlib.pyplot as plt
import numpy as np
from der.plotting import PALETTE, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCENE = Path(__file__).with_name("two_links.yaml")

CLOSED = np.deg2rad(-70.0)  # rad: where the motor goes
LIMIT = 0.03  # N m: what the motor may exert for long
GAIN = 300.0  # rad/(N m s): how fast it gives way
STEP = 0.0025  # s: the controller's period, the step of the scene
HEAVY = (1.0, 2.5)  # s: in between the weight is heavier


def balance(result: der.Result) -> float:
    """Return the moment of all weights about the servo at the end [N m]: what it has to hold."""
    simulation = der.Simulation(result.scenario)
    _, first, second = simulation.model.rods
    x = result.positions[-1, :, 0] - result.positions[-1, first.nodes[0], 0]
    links = np.union1d(first.nodes, second.nodes)
    masses = np.asarray(simulation.node_masses)
    return float(9.81 * masses[links] @ x[links] + 0.2 * x[second.nodes[-1]])


def run(limit: float) -> der.Result:
    """Close the finger, hang a heavier weight on it, and give way where that exceeds the limit."""
    simulation = der.Simulation(SCENE)
    recording = simulation.recording()
    angle = CLOSED
    while simulation.time < 4.0:
        if simulation.time >= HEAVY[0]:
            heavy = simulation.time < HEAVY[1]
            simulation.set("weight", [0.0, -0.3 if heavy else -0.2])
            over = simulation.probes["servo_moment"] - limit
            angle = min(CLOSED, angle - GAIN * over * STEP)
            simulation.set("servo", angle)
        simulation.step()
        recording.add()
    return recording.result()


def figure(yielding: der.Result, stiff: der.Result) -> Figure:
    """Draw the finger under the heavier weight, and what its motor does."""
    with style():
        figure = plt.figure(figsize=(9, 3.8), layout="constrained")
        left, right = figure.subfigures(1, 2, width_ratios=[1, 1.5], squeeze=False)[0]
        finger = left.subplots()
        for time, colour in ((0.0, PALETTE[5]), (0.9, PALETTE[2]), (2.4, PALETTE[0])):
            shape = yielding.positions[np.searchsorted(yielding.times, time - 1e-9)]
            for number, rod in enumerate(yielding.rods):
                label = f"{time:g} s" if number == 0 else None
                line = shape[rod.nodes]
                finger.plot(*line.T, color=colour, linewidth=2.5, label=label)
                finger.plot(*line[0], "o", color=colour, markerfacecolor="white", markersize=5)
        finger.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
        finger.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
        moment, angle = right.subplots(2, 1, sharex=True)
        for result, name, colour in (
            (stiff, "holds", PALETTE[1]),
            (yielding, "gives way", PALETTE[0]),
        ):
            probes = result.probes
            moment.plot(result.times, 1e3 * probes["servo_moment"], color=colour, label=name)
            angle.plot(result.times, np.rad2deg(probes["servo_angle"]), color=colour)
        moment.axhline(1e3 * LIMIT, color="k", linestyle="--", linewidth=1, label="limit")
        for axes in (moment, angle):
            axes.axvspan(*HEAVY, color="0.93", zorder=0)
        moment.set(ylabel="motor [mN m]")
        moment.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
        angle.set(xlabel="time [s]", ylabel="motor [°]")
    return figure


def main() -> None:
    """Compare the motor with the statics, let it give way, and draw that."""
    result = der.run(SCENE)
    print(f"motor:              {1e3 * result.probes['servo_moment'][-1]:.4f} mN m")
    print(f"moment of weights:  {1e3 * balance(result):.4f} mN m")
    yielding, stiff = run(LIMIT), run(np.inf)
    for name, track in (("gives way", yielding), ("holds", stiff)):
        k = np.searchsorted(track.times, HEAVY[1] - 1e-9)
        moment, angle = (track.probes[key][k] for key in ("servo_moment", "servo_angle"))
        print(f"{name:10} {1e3 * moment:6.2f} mN m at {np.rad2deg(angle):6.1f}°")
    figure(yielding, stiff).savefig("two_links.png")


if __name__ == "__main__":
    main()
