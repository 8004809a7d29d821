"""A curved, twisted rod that passes through a bearing, which holds its tangent and lets it spin.

The rod of `curved_twisted_rod.py`, clamped at its start, with loads at its end. The bearing is at
half the length, where the rod is drawn: it holds the node and the tangent. What it lets through is
the spin about the tangent and the torque. Therefore the part beyond it is a rod that is clamped at
a section spun by an angle, and the part before it one whose end is held but for its spin, under the
torque of the part beyond. The angle is that at which both parts have it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from .curved_twisted_rod import NATURAL, START, rest_position, twisted
from .kirchhoff_rod import Checked, Held, HeldTangent, Loaded, checked, directors, follow, rotation
from .record import Array, Problem, Reference

PLACE = 0.5
FORCE, MOMENT = np.array([0.6, -0.9, 0.5]), np.array([0.5, 0.8, 0.6])
SIDES = {"before": 0.25, "beyond": 0.75}


def _frame(spin: float) -> Array:
    """The section in the bearing."""
    rate = float(np.linalg.norm(NATURAL))
    drawn = rotation(NATURAL / rate, rate * PLACE)
    return np.asarray(drawn @ rotation((0.0, 0.0, 1.0), spin), dtype=float)


def _part(length: float, start: Held, end: HeldTangent | Loaded) -> Checked:
    """A part of the rod: the natural curvatures and the twist are the same all along it."""

    def loaded(share: float) -> HeldTangent | Loaded:
        if isinstance(end, HeldTangent):
            return replace(end, torque=share * end.torque)
        return Loaded(share * np.asarray(end.force), share * np.asarray(end.moment))

    return checked(follow(replace(twisted(), length=length), start, loaded, steps=4))


@dataclass(frozen=True)
class Parts:
    """The rod on the two sides of the bearing, and the spin of its section (rad)."""

    before: Checked
    beyond: Checked
    spin: float

    def bears(self) -> tuple[Array, Array]:
        """Force and moment of the bearing on the rod."""
        last = self.before.equilibrium.at(np.array([PLACE]))[7:, 0]
        first = self.beyond.equilibrium.at(np.zeros(1))[7:, 0]
        wrench = last - first
        return wrench[:3], wrench[3:]


def solve() -> Parts:
    """Both parts with the same section in the bearing, and the same torque."""
    position, tangent = rest_position(NATURAL, PLACE), _frame(0.0)[:, 2]

    def parts(spin: float) -> tuple[Checked, Checked, float]:
        beyond = _part(1.0 - PLACE, Held(position, _frame(spin)), Loaded(FORCE, MOMENT))
        torque = float(tangent @ beyond.equilibrium.at(np.zeros(1))[10:, 0])
        before = _part(PLACE, START, HeldTangent(position, tangent, torque))
        turned = _frame(spin).T @ before.equilibrium.tip_frame
        return before, beyond, float(np.arctan2(turned[1, 0], turned[0, 0]))

    spin = float(brentq(lambda angle: parts(angle)[2], -1.0, 1.0, xtol=1e-13))
    before, beyond, _ = parts(spin)
    return Parts(before, beyond, spin)


def references() -> Problem:
    """Points, strains, what the bearing and the clamp bear."""
    parts = solve()
    error = max(parts.before.error, parts.beyond.error, 1e-11)
    values: dict[str, Reference] = {}

    def add(name: str, numbers: Array, names: tuple[str, ...], bar: float, unit: str) -> None:
        for key, value in zip(names, numbers, strict=True):
            values[f"{name}.{key}"] = Reference(float(value), bar, unit)

    values["spin"] = Reference(parts.spin, error, "1")
    add("end", parts.beyond.equilibrium.tip, ("x", "y", "z"), error, "L")
    for side, place in SIDES.items():
        found = (parts.before if side == "before" else parts.beyond).equilibrium
        s = np.array([place if side == "before" else place - PLACE])
        add(side, found.at(s)[:3, 0], ("x", "y", "z"), error, "L")
        strains = found.strains(s)[:3, 0]
        add(side, strains, ("curvature_1", "curvature_2", "twist"), 10.0 * error, "1/L")
    force, moment = parts.bears()
    add("bearing.force", force, ("x", "y", "z"), 100.0 * error, "EI1/L^2")
    add("bearing.moment", moment, ("x", "y", "z"), 100.0 * error, "EI1/L")
    clamp = -parts.before.equilibrium.at(np.zeros(1))[7:, 0]
    add("clamp.force", clamp[:3], ("x", "y", "z"), 100.0 * error, "EI1/L^2")
    add("clamp.moment", clamp[3:], ("x", "y", "z"), 100.0 * error, "EI1/L")
    assert np.allclose(
        directors(parts.before.equilibrium.solution.values[-1, 3:7, -1])[:, 2],
        _frame(0.0)[:, 2],
        atol=1e-10,
    )
    return Problem(
        "bearing",
        "the rod of curved_twisted_rod (EI1 = 1, EI2 = 3, GJ = 0.8, EA = 1e4, natural curvatures "
        "1, 2 and twist 3), clamped at the start, in a bearing at half its length that holds the "
        f"point and the tangent, under the dead force {FORCE.tolist()} and the dead moment "
        f"{MOMENT.tolist()} at the end; force and moment: of clamp and bearing on the rod",
        "two rods, each by collocation with quaternions, joined by the spin of the section between "
        "them; error: the larger of those of both parts",
        values,
    )
