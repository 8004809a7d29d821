"""Below which size a difference between two runs is rounding."""

from __future__ import annotations

from der._core import Model

#: Of the largest value that a probe takes in the run.
_OF_VALUE = 1e-10
#: Of a natural size, for probes that stay at zero but for rounding.
_OF_SIZE = 1e-12
#: The same for axial strain and force: a difference of two lengths, over one of them.
_OF_STRAIN = 1e-13


#: Rounding of a position; a velocity is a difference of two over a step.
_OF_POSITION = 16 * 2.2e-16


def noise_floor(model: Model, unit: str, step: float, largest: float) -> float:
    """Return the size of differences that say nothing, in the unit of the probe.

    Parameters
    ----------
    model
        Its rods give the natural sizes: length L, bending moment EI/L, and so on.
    unit
        Of the probe.
    step
        Shortest time step [s]; infinite for a static scene.
    largest
        Largest absolute value of the probe in the run.
    """
    length = max(rod.length for rod in model.rods)
    moment = max(rod.EI / rod.length for rod in model.rods)
    sizes = {
        "m": length,
        "1/m": 1.0 / length,
        "rad": 1.0,
        "N m": moment,
        "J": moment,
    }
    if unit == "m/s":
        smallest = _OF_POSITION * length / step
    elif unit == "N":
        smallest = _OF_STRAIN * max(rod.EA for rod in model.rods)
    elif unit in ("", "1"):
        smallest = _OF_STRAIN
    else:
        smallest = _OF_SIZE * sizes.get(unit, 0.0)
    return _OF_VALUE * largest + smallest
