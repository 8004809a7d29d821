"""Below which size a difference between two runs is rounding."""

from __future__ import annotations

from der._core import Model
from der.natural_sizes import natural_size

#: Rounding error, as a fraction of the largest value of a probe in the run.
_OF_VALUE = 1e-10
#: Rounding error, as a fraction of a natural size, for probes that are zero but for rounding.
_OF_SIZE = 1e-12
#: The same for units with another rounding error: axial strain and force, a difference of two
#: lengths over one of them, and velocities, a difference of two positions over a step.
_OF_SIZES = {"": 1e-13, "N": 1e-13, "m/s": 16 * 2.2e-16}


def noise_floor(model: Model, unit: str, step: float, largest: float) -> float:
    """Return the size of differences that are not significant, in the unit of the probe.

    Parameters
    ----------
    model
        Its rods give the natural sizes: length L, bending moment EI/L, and so on.
    unit
        Unit of the probe.
    step
        Shortest time step [s]; infinite for a static scene.
    largest
        Largest absolute value of the probe in the run.
    """
    share = _OF_SIZES.get(unit, _OF_SIZE)
    return _OF_VALUE * largest + share * natural_size(model.rods, unit, step)
