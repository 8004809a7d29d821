"""Below which size a difference between two runs, or an error bar, is rounding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from der._core import Model
from der.characteristic_scales import characteristic_scale
from der.result import Result

#: Rounding error, as a fraction of the largest value of a probe in the run.
_OF_VALUE = 1e-10
#: Rounding error, as a fraction of a natural size, for probes that are zero but for rounding.
_OF_SIZE = 1e-12
#: The same for units with another rounding error: axial strain and force, a difference of two
#: lengths over one of them, and velocities, a difference of two positions over a step.
_OF_SIZES = {"": 1e-13, "N": 1e-13, "m/s": 16 * 2.2e-16}
#: A value is exact if its error bar is less than this share of its size.
_EXACT = 1e-9
#: Coordinates are known to this share of the largest: a few times the last digit.
_OF_COORDINATES = 8 * 2.2e-16


def noise_floor(model: Model, unit: str, step: float, largest: float) -> float:
    """Return the size of differences that are not significant, in the unit of the probe.

    The rods of the model give the natural sizes: length L, bending moment EI/L, and so on. The
    shortest `step` [s] is infinite for a static scene; `largest` is the largest absolute value of
    the probe in the run.
    """
    share = _OF_SIZES.get(unit, _OF_SIZE)
    return _OF_VALUE * largest + share * characteristic_scale(model.rods, unit, step)


@dataclass(frozen=True)
class ExactBelow:
    """The error bars of a value that are no more than rounding.

    Attributes
    ----------
    rounding
        Any error bar up to this is, in the unit of the value.
    nothing
        So is one up to this if the value is 0 within it.
    coordinates
        So is one up to this, which may take many digits of the value: the rounding of coordinates,
        times the stiffnesses that forces have of them.
    """

    rounding: float = 0.0
    nothing: float = 0.0
    coordinates: float = 0.0


#: No error bar is.
NOTHING = ExactBelow()


def exact_below(result: Result, unit: str, largest: float) -> ExactBelow:
    """Return below which error bars a value is exact.

    `result` is a run on the finest mesh, which has the largest errors by rounding; `largest` is the
    largest absolute value of the probe in the run of the scene.
    """
    rods = result.model.rods
    size = characteristic_scale(rods, unit, 0.0)
    if unit == "N":  # that of bending; rods that hardly stretch bear no force near EA
        size = max(rod.EI / rod.length**2 for rod in rods)
    # Far from the origin, a position is large by the choice of coordinates alone.
    scale = min(largest, size) if unit == "m" else largest
    error = _OF_COORDINATES * float(np.max(np.abs(result.positions[-1])))
    coordinates = 0.0
    for rod in rods:
        edge = float(np.min(np.diff(rod.line_arc_lengths)))
        angle, curvature = 2.0 * error / edge, 4.0 * error / edge**2
        errors = {
            "m": error,
            "": angle,
            "rad": angle,
            "1/m": curvature,
            "rad/m": curvature,
            "N": max(rod.EA * angle, rod.EI * curvature / edge),
            "N m": rod.EI * curvature,
        }
        coordinates = max(coordinates, errors.get(unit, 0.0))
    return ExactBelow(_EXACT * scale, _EXACT * size, coordinates)
