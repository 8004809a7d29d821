"""The columns that tell of the probes of a scene."""

from __future__ import annotations

from functools import lru_cache

from der._core import Scenario, quantities
from der.sweeps.table import Column

#: What is told of each probe.
TOLD, WHEN = ("final", "min", "max"), ("t_min", "t_max")
#: How many columns a probe has, and how many error bars.
COLUMNS_OF_PROBE, BARS_OF_PROBE = len(TOLD) + len(WHEN), len(TOLD)


def probe_columns(scene: Scenario) -> list[Column]:
    """Return the columns of all probes of a scene."""
    unit_of = {quantity.name: quantity.unit for quantity in quantities()}
    probes = (scene.to_dict().get("output") or {}).get("probes") or {}
    on_path = scene.factor_range is not None
    return [
        column
        for name, probe in probes.items()
        for column in columns_of_probe(name, unit_of[probe["quantity"]], on_path)
    ]


def columns_of_probe(name: str, unit: str, on_path: bool) -> tuple[Column, ...]:
    """Return the columns of a probe.

    Parameters
    ----------
    name, unit
        Its own.
    on_path
        Whether the run is a path of equilibria, on which an extreme has the number of a point, and
        no time.
    """
    units = (unit,) * len(TOLD) + ("" if on_path else "s",) * len(WHEN)
    names = names_of_columns(name)
    return tuple(Column(own, "probe", its) for own, its in zip(names, units, strict=True))


@lru_cache(maxsize=1024)
def names_of_columns(probe: str) -> tuple[str, ...]:
    """Return the names of the columns of a probe, made once and not for each member."""
    return tuple(f"{probe}.{what}" for what in (*TOLD, *WHEN))
