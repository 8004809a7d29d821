"""Notes for the reader of a study."""

from __future__ import annotations

import math
from collections.abc import Sequence

from der._core import Scenario
from der.accuracy.refinement import count_nodes
from der.accuracy.study_plan import Mesh, common_interval, find_leading_rod, why_one_mesh
from der.accuracy.study_row import seconds_text
from der.accuracy.study_trial import SKIPPED, Trial

DEFAULT_PROBES = "the scene has no probes: free ends and extreme points are shown"


def one_mesh_note(scenario: Scenario) -> str:
    """Return why meshes are not varied."""
    return f"nodes are not varied: {why_one_mesh(scenario)}"


def angle_note(probe: str) -> str:
    """Return why a probe of a turning angle is left out."""
    return f"'{probe}' is left out: a turning angle belongs to its mesh; 'curvature' does not"


def costly_step_note(step: float) -> str:
    """Return that a step [s] is left out."""
    return f"steps of {seconds_text(step)} are left out, for their cost"


def interval_note(steps: Sequence[float], every: float, frames: float) -> str:
    """Return when errors are measured.

    Parameters
    ----------
    steps
        The steps of the study [s].
    every
        The interval [s] whose multiples the reference has.
    frames
        The interval between the frames of the scene [s].
    """
    note = f"errors are measured every {seconds_text(every)}"
    if math.isclose(every, frames):
        note += ", as the scene saves frames"
    intervals = [(step, common_interval(step, every)) for step in steps]
    rarer = [
        f"with {seconds_text(step)} every {seconds_text(interval)}"
        for step, interval in intervals
        if not math.isclose(interval, every)
    ]
    if rarer:
        note += ", or where a step does not reach all of these: " + ", ".join(rarer)
    return note


def mesh_name(scenario: Scenario) -> str:
    """Return what a mesh is called: ``41 nodes``."""
    rod = find_leading_rod(scenario)
    counts = count_nodes(scenario)
    return f"{counts[rod] if rod else next(iter(counts.values()))} nodes"


def missing_notes(trials: Sequence[Trial], meshes: Sequence[Mesh], max_seconds: float) -> list[str]:
    """Return which configurations did not run to their end, and why."""
    notes = []
    for i, mesh in enumerate(meshes):
        for stepper in dict.fromkeys(trial.stepper for trial in trials):
            tried = [t for t in trials if (t.mesh, t.stepper) == (i, stepper)]
            for status in dict.fromkeys(t.status for t in tried if t.result is None):
                steps = [t.step for t in tried if t.status == status]
                notes.append(_missing(mesh, stepper, status, steps, max_seconds))
    return notes


def _missing(
    mesh: Mesh, stepper: str, status: str, steps: Sequence[float], max_seconds: float
) -> str:
    what = f"{mesh.nodes} nodes, {stepper}" if stepper else f"{mesh.nodes} nodes"
    longest, shortest = seconds_text(max(steps)), seconds_text(min(steps))
    when = f" at {longest}" if longest == shortest else f" from {longest} to {shortest}"
    if status == SKIPPED:
        status = f"skipped, for more than {max_seconds:g} s of CPU time each"
    return f"{what}: {status}{when if stepper else ''}"
