"""The way a rod lies in space, and its stiffnesses: shared by all scenes in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from references.kirchhoff_rod import Rod, constant

from .rod import Array
from .shapes import Random, power


@dataclass(frozen=True)
class Placed:
    """A rod of length 1 and weaker bending stiffness 1, and what it is in the scene.

    ``rod`` bends about d1 and d2 of the references; ``frame`` has the columns d1, d2, d3 at the
    start, where the scene has the width along d1; ``length`` [m] and ``force`` [N] are the units.
    """

    rod: Rod
    origin: Array
    frame: Array
    length: float
    force: float
    mass: float  # a length [kg/m]
    spin: float  # its inertia a length, in units of mass * length^2

    @property
    def moment(self) -> float:
        """The unit of moments [N m]."""
        return self.force * self.length

    @property
    def period(self) -> float:
        """The unit of times [s]."""
        return float(np.sqrt(self.mass * self.length**2 / self.force))

    def entry(self) -> dict[str, Any]:
        """The rod in a scene, without its shape."""
        about_1, about_2 = self.rod.bending  # turning about d1 bends towards d2
        bend = self.force * self.length**2
        stiffness = {
            "EA": self.rod.stretching * self.force,
            "EI1": about_2 * bend,
            "EI2": about_1 * bend,
            "GJ": self.rod.twisting * bend,
            "mass_per_length": self.mass,
            "rotary_inertia": self.spin * self.mass * self.length**2,
        }
        section = {"stiffness": stiffness, "director": self.frame[:, 0].tolist()}
        return {"name": "rod", "cross_section": section}

    def natural(self, rates: Array) -> dict[str, Any]:
        """Keys of a natural shape with these rates of turning about d1, d2, d3."""
        u = (rates / self.length).tolist()
        return {"natural_curvature": [u[1], -u[0]], "natural_twist": u[2]}


def place(rng: Random, rates: Array, slender: tuple[float, float]) -> Placed:
    """A rod with these natural rates of turning, anywhere and of any size."""
    length = power(rng, -6, 2) if rng.random() < 0.5 else 1.0
    strong = power(rng, 0, 1)
    bending = (1.0, strong) if rng.random() < 0.5 else (strong, 1.0)
    if rng.random() < 0.25:
        bending = (1.0, 1.0)
    rod = Rod(1.0, bending, power(rng, -0.5, 0.3), power(rng, *slender), constant(*rates))
    frame = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    frame[:, 2] = np.cross(frame[:, 0], frame[:, 1])
    origin = rng.uniform(-1, 1, 3) * length if rng.random() < 0.3 else np.zeros(3)
    mass = power(rng, -2, 1) * length**2
    return Placed(
        rod, origin, frame, length, power(rng, -3, 3) * length**2, mass, power(rng, -6, -5)
    )


def probes(rng: Random, nodes: int, length: float, quantities: tuple[str, ...]) -> dict[str, Any]:
    """Some quantities at nodes, at any arc length and at the ends."""
    found: dict[str, Any] = {}
    for i in range(int(rng.integers(4, 8))):
        kind = rng.choice(["end", "node", "length"])
        at: Any = "end"
        if kind == "node":
            at = {"node": int(rng.integers(1, nodes - 1))}
        elif kind == "length":
            at = float(rng.uniform(0.02, 0.98) * length)
        found[f"p{i}"] = {"rod": "rod", "at": at, "quantity": str(rng.choice(quantities))}
    return found


def share(at: Any, nodes: int, length: float) -> float:
    """The place of a probe as a share of a rod whose nodes are even.

    ``length`` is that of the polyline through the nodes, along which the scene counts; on a finer
    mesh the place divides the curve between two nodes in the same proportion (docs/verify.md).
    """
    if isinstance(at, dict):
        return float(at["node"] / (nodes - 1))
    return 1.0 if at == "end" else float(at / length)
