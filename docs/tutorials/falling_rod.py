"""A soft rod with beads sinks: run falling_rod.yaml, draw it, and check its terminal velocity.

python falling_rod.py         # writes falling_rod.png
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import der
import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCENE = Path(__file__).with_name("falling_rod.yaml")


def terminal_velocity(scene: der.Scenario) -> float:
    """Return the velocity at which weight, buoyancy and drag of all beads balance [m/s]."""
    loads = {key: load for entry in scene.to_dict()["loads"] for key, load in entry.items()}
    beads = scene.to_dict()["rods"][0]["spheres"]
    radii = der.Model(scene).rods[0].sphere_radii
    lighter = beads[0]["density"] - loads["fluid"]["density"]
    gravity, viscosity = loads["gravity"][1], loads["fluid"]["viscosity"]
    return float(2 / 9 * lighter * gravity * np.sum(radii**3) / (viscosity * np.sum(radii)))


def figure(result: der.Result) -> Figure:
    """Draw how the rod bends as it sinks."""
    return result.plot("shapes", times=[0, 0.5, 1, 2, 3, 4, 5])


def main() -> None:
    """Run the scene, compare, draw."""
    result = der.run(SCENE)
    expected = terminal_velocity(result.scenario)
    print(f"velocity at the end:        {result.probes['v_mid'][-1]:.7f} m/s")
    print(f"where all forces balance:   {expected:.7f} m/s")
    figure(result).savefig("falling_rod.png")


if __name__ == "__main__":
    main()
