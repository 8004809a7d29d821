"""One configuration of a study: what it costs, and how large the error of a probe is."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class StudyRow:
    """One probe of one configuration.

    Attributes
    ----------
    probe, unit
        The probe and its SI unit; of an analysis also ``frequency 1``, ``load factor 1``, or where
        on a path it is read: ``factor, fold 1``.
    nodes
        Nodes of the first rod whose mesh is varied.
    stepper, step
        Time integrator and step [s]; empty and 0 for a static scene.
    status
        As in ``summary.json``; ``skipped`` for a run that would take too long, ``unmatched`` where
        its mesh finds another number of folds, say, than the reference does.
    cpu_seconds
        CPU time of building the simulation and running it [s], the best of some runs; NaN if it did
        not run to its end, as are the errors.
    error
        Largest difference to the reference over the times of `interval`, in the unit of the probe.
    space_error
        The same of this mesh with time converged, over all times that the reference has.
    time_error
        Largest difference to this mesh with time converged.
    reference_error
        Estimated error of the reference: an `error` below it says only that much.
    interval
        Between the times at which the run is compared [s]: that between the frames of the scene, or
        the shortest multiple that the step reaches; 0 for a static scene.
    """

    probe: str
    unit: str
    nodes: int
    stepper: str
    step: float
    status: str
    cpu_seconds: float
    error: float
    space_error: float
    time_error: float
    reference_error: float
    interval: float = 0.0

    @property
    def completed(self) -> bool:
        """Whether the run was completed, so that there is an error and a cost."""
        return not math.isnan(self.error)

    @property
    def claimed_error(self) -> float:
        """The largest of the errors: of the whole, in space, in time, and of the reference.

        Where errors in space and in time cancel, the whole is smaller than its parts by luck, which
        another load or another moment would not have.
        """
        parts = (self.error, self.space_error, self.time_error, self.reference_error)
        return max(part for part in parts if not math.isnan(part))

    @property
    def configuration(self) -> str:
        """Return the configuration as people write it: ``41 nodes, tr_bdf2, 4 ms``."""
        mesh = f"{self.nodes} nodes"
        return f"{mesh}, {self.stepper}, {seconds_text(self.step)}" if self.stepper else mesh


def seconds_text(seconds: float) -> str:
    """Return a time in as few digits as tell it: ``4 ms``, ``1.5 s``."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= 0.9995 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.2g} s"
