"""The unit that positions are shown in: one for all axes, and from where they count."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import Formatter
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

#: Least size [m] of what is shown in a unit, its name, and its length [m].
_UNITS = ((1e4, "km", 1e3), (0.05, "m", 1.0), (5e-5, "mm", 1e-3), (5e-8, "µm", 1e-6))
_SMALLEST = ("nm", 1e-9)
#: Positions that are so many sizes away from zero count from a round number near them.
_FAR = 100.0


@dataclass(frozen=True, eq=False)
class LengthScale:
    """How positions become numbers at axes.

    Attributes
    ----------
    unit
        Name of the unit.
    metres
        Its length [m].
    origin
        The position that is shown as zero [m], shape (dim,).
    """

    unit: str
    metres: float
    origin: Array

    @classmethod
    def of(cls, low: Array, high: Array) -> LengthScale:
        """Choose the scale for all that lies between two corners [m], shape (dim,)."""
        size = float(np.max(high - low))
        unit, metres = next(((name, m) for least, name, m in _UNITS if size >= least), _SMALLEST)
        middle = 0.5 * (low + high)
        step = 10.0 ** np.ceil(np.log10(size)) if size > 0.0 else 1.0
        far = np.abs(middle) > _FAR * step
        return cls(unit, metres, np.where(far, step * np.round(middle / step), 0.0))

    def shown(self, positions: Array) -> Array:
        """Return positions [m], shape (..., dim), as they are shown, in the unit."""
        return (positions - self.origin) / self.metres

    def label(self, axis: int, names: Sequence[str] = "xyz") -> str:
        """Return the title of an axis by its number, such as ``x [mm]``."""
        start = float(self.origin[axis])
        if start == 0.0:
            return f"{names[axis]} [{self.unit}]"
        sign = "-" if start > 0.0 else "+"
        return f"{names[axis]} {sign} {abs(start) / self.metres:.16g} [{self.unit}]"


class _LengthFormatter(Formatter):
    """Writes ticks in the unit of a scale, all with as many decimals as they need."""

    def __init__(self, scale: LengthScale, axis: int) -> None:
        self._origin, self._metres = float(scale.origin[axis]), scale.metres

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{(x - self._origin) / self._metres:.6g}"

    def format_ticks(self, values: Sequence[float]) -> list[str]:
        return tick_texts((np.asarray(values, dtype=np.float64) - self._origin) / self._metres)


def tick_texts(shown: Array) -> list[str]:
    """Return evenly spaced numbers as texts, all with as many decimals as they need."""
    if len(shown) == 0:
        return []
    slack = max(1e-3 * np.ptp(shown) / max(len(shown) - 1, 1), 1e-9 * np.abs(shown).max())
    decimals = 0
    while decimals < 12 and np.any(np.abs(np.round(shown, decimals) - shown) > slack):
        decimals += 1
    rounded = np.round(shown, decimals) + 0.0  # no minus zero
    return [Formatter.fix_minus(f"{value:.{decimals}f}") for value in rounded]


def label_positions(axes: Axes, low: Array, high: Array, names: Sequence[str] = ("x", "y")) -> None:
    """Title both axes with their names in the unit that suits all between two corners [m].

    Ticks say all that there is to say: no power of ten stands beside an axis.
    """
    scale = LengthScale.of(low[:2], high[:2])
    for number, axis in enumerate((axes.xaxis, axes.yaxis)):
        axis.set_label_text(scale.label(number, names))
        axis.set_major_formatter(_LengthFormatter(scale, number))
