"""A probe's values together with their unit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der.arguments import NamedProbes
from der.tables import html_table, text_table


class ProbeSeries(np.ndarray[Any, np.dtype[np.float64]]):
    """A probe at the saved times: an array, shape (frames,), with its unit.

    Slices keep the unit; whatever is computed from it is a plain array, since its unit is another.

    Attributes
    ----------
    unit
        The SI unit, such as ``m/s``.
    summary
        ``final``, ``min``, ``max`` (in `unit`), ``t_min`` and ``t_max`` [s] over every step of the
        run, saved or not.
    """

    unit: str
    summary: dict[str, float]

    def __new__(
        cls, values: NDArray[np.float64], unit: str, summary: Mapping[str, float]
    ) -> ProbeSeries:
        """Wrap an array, shape (frames,), without a copy."""
        series = np.asarray(values, dtype=np.float64).view(cls)
        series.unit = unit
        series.summary = dict(summary)
        return series

    def __array_finalize__(self, source: object) -> None:
        """Keep the unit in slices."""
        self.unit = getattr(source, "unit", "")
        self.summary = getattr(source, "summary", {})

    def __array_wrap__(
        self, array: NDArray[Any], context: Any = None, return_scalar: bool = False
    ) -> Any:
        """Return what is computed from a probe as a plain array or number."""
        plain = np.asarray(array)
        return plain if plain.ndim else plain[()]

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the unit and summary as well."""
        return ProbeSeries, (np.array(self), self.unit, self.summary)


class Probes(NamedProbes[ProbeSeries]):
    """The probes of a run by name; as text a table with unit, final value and extremes of each."""

    def table(self) -> list[list[str]]:
        """Return the table's rows, its header first; a run that is not over has no extremes."""
        values = ("final", "min", "max")
        rows = [["probe", "unit", *values]]
        for name, probe in self.items():
            known = (f"{probe.summary[key]:.6g}" if key in probe.summary else "" for key in values)
            rows.append([name, probe.unit, *known])
        return rows

    def __repr__(self) -> str:
        """Return the table in lines."""
        return "\n".join(text_table(self.table()) if self else ["no probes"])

    def _repr_html_(self) -> str:
        return html_table(self.table())


def make_probes(
    values: Mapping[str, NDArray[np.float64]], units: Mapping[str, str], summary: Mapping[str, Any]
) -> Probes:
    """Join values, units and the ``probes`` part of a run's summary, by name."""
    parts = summary.get("probes", {})
    return Probes(
        {name: ProbeSeries(values[name], units[name], parts.get(name, {})) for name in values}
    )
