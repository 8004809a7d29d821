"""The actuated stretches of rods and their values at the frames of a result, for drawings."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der._core import Rod
from der.run_data import RunData
from der.scene_loads import place_on, value_at

Array = NDArray[np.float64]

#: What an actuation can change, with the word for it and its unit.
QUANTITIES = {
    "natural_curvature": ("curvature", "1/m"),
    "natural_twist": ("twist", "rad/m"),
    "elongation": ("elongation", ""),
}
#: Samples of a stretch between which a drawing is linear.
_SAMPLES = 33
#: A value that is smaller than this share of the largest is 0: a sine that ends at half a period.
_ROUNDING = 1e-12
#: An arc length is on the end of a stretch if it is off by less than this share of its length.
_SAME_PLACE = 1e-9


@dataclass(frozen=True, eq=False)
class ActuatedStretch:
    """A stretch of a rod whose rest shape an actuation changes.

    Attributes
    ----------
    name, rod
        Names of the actuation and of its rod.
    start, end
        Arc lengths [m].
    quantity
        The key of its value: one of `QUANTITIES`.
    profile
        ``constant``, ``linear`` or ``smooth``.
    values
        At each frame, shape (frames,), or (frames, 2) of two curvatures.
    level
        How many of the actuations before it overlap it on its rod.
    """

    name: str
    rod: str
    start: float
    end: float
    quantity: str
    profile: str
    values: Array
    level: int

    @property
    def unit(self) -> str:
        """Unit of the values."""
        return QUANTITIES[self.quantity][1]

    @cached_property
    def shares(self) -> Array:
        """Values against the largest of all frames, from -1 to 1, shape (frames,).

        Where none is positive they are turned round: negative are those against others. Those of
        two curvatures are from 0 to 1; they are 0 where none acts at any frame.
        """
        sizes = np.linalg.norm(self.values, axis=1) if self.values.ndim > 1 else self.values
        largest = float(np.abs(sizes).max(initial=0.0))
        largest = largest if np.any(sizes > 0.0) else -largest
        return np.asarray(sizes / largest if largest != 0.0 else 0.0 * sizes)

    def profile_at(self, arc_lengths: Array) -> Array:
        """Return the profile, from 0 to 1, at arc lengths [m]: 0 outside, and not at the ends."""
        along = (arc_lengths - self.start) / (self.end - self.start)
        covered = (along >= -_SAME_PLACE) & (along <= 1.0 + _SAME_PLACE)
        if self.profile == "constant":
            return covered.astype(np.float64)
        inside = along if self.profile == "linear" else np.sin(np.pi * along) ** 2
        return np.asarray(np.where(covered, inside, 0.0))

    def samples(self, rod: Rod) -> Array:
        """Return arc lengths [m] along the stretch, its ends and the nodes within among them."""
        places = rod.line_arc_lengths
        inside = places[(places > self.start) & (places < self.end)]
        return np.union1d(np.linspace(self.start, self.end, _SAMPLES), inside)

    def line(self, rod: Rod, positions: Array) -> Array:
        """Return the samples' points [m], shape (samples, dim), with the nodes at `positions`."""
        return np.array([place_on(rod, positions, at) for at in self.samples(rod).tolist()])

    def value_text(self, frame: int) -> str:
        """Return the value at a frame in words, such as ``curvature 2.5 1/m``."""
        word, unit = QUANTITIES[self.quantity]
        noise = _ROUNDING * float(np.abs(self.values).max())
        values = [value if abs(value) > noise else 0.0 for value in np.ravel(self.values[frame])]
        digits = ", ".join(f"{value:.3g}" for value in values)
        amount = f"({digits})" if self.values.ndim > 1 else digits
        return f"{word} {amount} {unit}".strip()


def actuated_stretches(result: RunData) -> list[ActuatedStretch]:
    """Return what the scene of a result actuates, in its order.

    Values are those of the scene, along a continuation times its factor where it varies them; what
    a program has set is not known to it.
    """
    lengths = {rod.name: rod.length for rod in result.rods}
    found: list[ActuatedStretch] = []
    for number, item in enumerate(result.scenario.to_dict().get("actuation") or []):
        start, end = float(item.get("from", 0.0)), float(item.get("to", lengths[item["rod"]]))
        overlapped = [
            other.level
            for other in found
            if other.rod == item["rod"] and other.start < end and start < other.end
        ]
        quantity = next(key for key in QUANTITIES if key in item)
        values = _values(item[quantity], result.times)
        factors = _factors(result, number, item["name"])
        found.append(
            ActuatedStretch(
                item["name"],
                item["rod"],
                start,
                end,
                quantity,
                item.get("profile", "constant"),
                (factors * values.T).T,
                max(overlapped, default=-1) + 1,
            )
        )
    return found


def _values(series: Any, times: Array) -> Array:
    """Return a value of the scene at times [s], shape (times,) or (times, 2)."""
    if isinstance(series, list):  # two curvatures, each a number or a table
        return np.column_stack([_values(one, times) for one in series])
    return np.array([value_at(series, time) for time in times.tolist()])


def _factors(result: RunData, number: int, name: str) -> Array:
    """Return what an actuation is multiplied by at each frame: by the factor of its path."""
    analysis = result.scenario.to_dict().get("analysis")
    if result.path is None or not isinstance(analysis, dict):
        return np.ones(len(result.times))
    vary = analysis["continuation"].get("vary", "loads")
    if vary not in ("actuation", f"actuation.{number}", f"actuation.{name}"):
        return np.ones(len(result.times))
    return result.path.factor
