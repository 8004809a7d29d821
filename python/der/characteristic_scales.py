"""How large the quantities of a structure are by nature, to tell numbers from rounding."""

from __future__ import annotations

from collections.abc import Sequence

from der._core import Rod


def characteristic_scale(rods: Sequence[Rod], unit: str, time: float) -> float:
    """Return the natural size of quantities of a unit; 0 where there is none.

    Parameters
    ----------
    rods
        The longest gives the length L, the curvature and the twist 1/L; the stiffest the moment,
        and the energy, EI/L and the axial force EA. Angles and strains have the size 1.
    unit
        SI unit of the quantities.
    time
        Within which a length is travelled, for velocities [s].
    """
    length = max(rod.length for rod in rods)
    moment = max(rod.EI / rod.length for rod in rods)
    sizes = {
        "": 1.0,
        "rad": 1.0,
        "m": length,
        "1/m": 1.0 / length,
        "rad/m": 1.0 / length,
        "m/s": length / time if time > 0.0 else 0.0,
        "N": max(rod.EA for rod in rods),
        "N m": moment,
        "J": moment,
    }
    return sizes.get(unit, 0.0)
