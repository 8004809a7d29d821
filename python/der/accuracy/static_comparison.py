"""The numbers that a study compares for a scene without time."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from der.accuracy.static_readings import Readings, describe_difference, differing_kinds


class StaticComparison:
    """Picks the numbers that the finest meshes agree to have found.

    Parameters
    ----------
    meshes
        The results, by the name of the mesh, coarsest first; the reference is made of the last
        ones.
    reference_meshes
        How many these are.
    left_out
        Probes that are not to be compared.

    Attributes
    ----------
    units
        Units of the numbers that are compared, by their label.
    notes
        Remarks on numbers that differ between meshes.

    Raises
    ------
    ValueError
        If nothing is left.
    """

    def __init__(
        self, meshes: Mapping[str, Readings], reference_meshes: int, left_out: Collection[str]
    ) -> None:
        finest = list(meshes.values())[-reference_meshes:]
        apart = differing_kinds(finest)
        self._reference = finest[-1]
        self.units = {
            label: reading.unit
            for label, reading in self._reference.items()
            if reading.kind not in apart and reading.probe not in left_out
        }
        self.notes = [
            ("left out: " if kind in apart else "") + describe_difference(kind, meshes)
            for kind in differing_kinds(list(meshes.values()))
        ]
        if not self.units:
            raise ValueError(
                "nothing can be compared between meshes; add a probe under output.probes, or finer "
                "meshes: " + "; ".join(self.notes)
            )

    def series(self, readings: Readings) -> dict[str, NDArray[np.float64]]:
        """Return those of the numbers of a run that are compared, by label, each of shape (1,)."""
        apart = differing_kinds([readings, self._reference])
        return {
            label: np.array([readings[label].value])
            for label in self.units
            if self._reference[label].kind not in apart
        }
