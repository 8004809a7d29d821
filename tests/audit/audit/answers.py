"""Whether an answer is right: the same problem in other units, and an independent verdict.

An equilibrium is right if the forces balance, the eigenvalues of the dense stiffness confirm what
it says of its stability, and the same problem, turned and in other units, has the same answer, or
another one that is verified in the same way (many problems have several stable equilibria). A
motion is right if it is within its tolerance of the same problem, turned and in other units, by
another stepper with a tenth of the tolerance. All else that claims to be an answer is wrong, except
in motions that amplify the errors of steps more than tenfold: a tolerance limits the sum of these
errors, not what becomes of them (docs/steppers.md). Such motions are counted apart.
"""

from __future__ import annotations

import collections
import dataclasses
import traceback
import warnings

import der
import numpy as np

from .extremes import Drawn, Units, extremes, units
from .rod import Array

SOLVED, WRONG, FLAGGED, AMPLIFIED = "solved", "wrong", "flagged", "amplified"

#: The outcomes of problems that were not refused; der itself flags doubtful answers.
_ANSWERED = (SOLVED, WRONG, FLAGGED, AMPLIFIED)

#: Times the tolerance that an error may be; docs/steppers.md says why more with implicit Euler.
_MARGIN = {"implicit_euler": 6.0}


@dataclasses.dataclass(frozen=True)
class Answer:
    """The outcome of a problem: one of `_ANSWERED`, or the status by which der refused it."""

    name: str
    kind: str
    outcome: str
    detail: str = ""


def answer(seed: int, number: int) -> Answer:
    """Draw and judge one problem; the same numbers give the same one."""
    rng = np.random.default_rng([seed, number, 7])
    drawn = extremes(rng)
    first, second = units(rng, drawn), units(rng, drawn)
    kind = f"{'at rest' if drawn.time is None else 'in motion'}, {drawn.dimension}D"
    name = f"{seed}:{number}"
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            judge = _at_rest if drawn.time is None else _in_motion
            outcome, detail = judge(drawn, first, second)
        except der.DerError as error:
            return Answer(name, kind, error.status, str(error)[:200])
        except Exception as error:  # a crash is a finding, and the other problems count as well
            where = traceback.extract_tb(error.__traceback__)[-1]
            return Answer(name, kind, WRONG, f"{type(error).__name__} in {where.name}: {error}")
    flagged = any(issubclass(note.category, der.UnreliableResultWarning) for note in told)
    return Answer(name, kind, FLAGGED if flagged and outcome == WRONG else outcome, detail)


def _at_rest(drawn: Drawn, first: Units, second: Units) -> tuple[str, str]:
    simulation = der.Simulation(drawn.written(first))
    report = simulation.equilibrium()
    if report.stability == "unknown":
        return FLAGGED, "stability unknown"
    fault = _fault(simulation, report)
    if fault:
        return WRONG, fault
    there = drawn.read(np.array(simulation.positions), first)
    twin = der.Simulation(drawn.written(second))
    try:
        twin_report = twin.equilibrium()
    except der.DerError:
        return SOLVED, "the twin was refused"
    apart = float(np.abs(drawn.read(np.array(twin.positions), second) - there).max())
    # An edge knows its tension to EA times the rounding of its ends over its length.
    far = 1.0 + max(np.abs(u.origin).max() for u in (first, second))
    edges = np.linalg.norm(np.diff(drawn.points, axis=0), axis=1)
    rounding = 20 * np.finfo(float).eps * far * drawn.ratio / edges.min()
    if apart > 1e-5 + rounding:
        fault = _fault(twin, twin_report)
        return (WRONG, f"twin: {fault}") if fault else (SOLVED, "the twin is another equilibrium")
    return SOLVED, ""


def _fault(simulation: der.Simulation, report: der.EquilibriumReport) -> str:
    """The faults of an equilibrium, by its forces and the eigenvalues of its stiffness."""
    if simulation.free_dofs.size == 0:
        return ""
    stiffness = simulation.hessian().toarray()
    coordinates = np.abs(simulation.positions).max()
    rounding = 8 * np.finfo(float).eps * np.abs(stiffness).max()
    unbalanced = np.abs(simulation.gradient()).max()
    if not unbalanced <= max(1e-8 * report.force_scale, 4 * rounding * coordinates):
        return f"unbalanced force {unbalanced:.2g} N of {report.force_scale:.2g} N"
    # Coordinates and angles in units of like stiffness, so that neither hides the other.
    scale = 1.0 / np.sqrt(np.abs(stiffness.diagonal()))
    least = np.linalg.eigvalsh(stiffness * np.outer(scale, scale)).min()
    if report.stability in ("stable", "neutral") and least < -1e-11 * len(scale):
        return f"told as {report.stability}, with an eigenvalue of {least:.2g}"
    return ""


def _in_motion(drawn: Drawn, first: Units, second: Units) -> tuple[str, str]:
    assert drawn.time is not None
    stepper, tolerance = drawn.time["integrator"], drawn.time["tolerance"]
    there = _final(drawn, first)
    others = ["tr_bdf2", "bdf2"] if stepper.startswith("sdirk") else ["sdirk5", "tr_bdf2"]
    closer = {**drawn.time, "tolerance": tolerance / 10, "integrator": others[0]}
    reference = dataclasses.replace(drawn, time=closer)
    try:
        exact = _final(reference, second)
    except der.DerError:
        closer["integrator"] = next(other for other in others if other not in (others[0], stepper))
        exact = _final(reference, second)
    error = float(np.abs(there - exact).max())
    allowed = _MARGIN.get(stepper, 1.0) * tolerance * 1.1
    if error <= allowed:
        return SOLVED, ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        growth = _growth(reference, second)
    detail = f"{stepper}: off by {error / tolerance:.2g} tolerances of {tolerance:.1e}"
    return (AMPLIFIED if growth > 10 else WRONG), f"{detail}; errors grow {growth:.2g} times"


def _growth(drawn: Drawn, given: Units) -> float:
    """How many times the error of a step grows until the end, at most; 0 if that is not found."""
    for steps in (1000, 20_000):
        try:
            return _growth_in(steps, drawn, given)
        except der.DerError:  # steps that are too long for this motion
            continue
    return 0.0


def _growth_in(steps: int, drawn: Drawn, given: Units) -> float:
    """The same, in so many equal steps.

    The error is the difference of one long step and its two halves, scaled to a millionth of the
    size, so that it grows linearly. It is put into the motion at a quarter, a half and three
    quarters of the duration. Equal steps have no noise of a step control.
    """
    scene = drawn.written(given)
    duration = scene["time"]["duration"]
    step = duration / steps
    small = 1e-6 * given.length

    def in_steps(length: float, integrator: str) -> der.Simulation:
        time = {"duration": duration, "step": length, "integrator": integrator}
        return der.Simulation({**scene, "time": {**time, "allow_unstable": True}})

    long, halves = in_steps(step, "tr_bdf2"), in_steps(step / 2, "tr_bdf2")
    motion = in_steps(step, "sdirk5")
    starts = []
    for _ in range(3):
        motion.step(steps // 4)
        starts.append(motion.save_state())
    motion.step(steps // 4)
    end = motion.positions.copy()
    growths: list[float] = []
    for start in starts:
        for simulation, count in ((long, 1), (halves, 2)):
            simulation.restore_state(start)
            simulation.step(count)
        moved = long.positions - halves.positions
        speed = long.velocities - halves.velocities
        largest = max(np.abs(moved).max(), step * np.abs(speed).max())
        if largest == 0.0:  # a step that fails is repeated in halves
            continue
        scale = small / largest
        motion.restore_state(start)
        motion.positions[:] += scale * moved
        motion.velocities[:] += scale * speed
        while not motion.finished:
            motion.step()
        growths.append(float(np.abs(motion.positions - end).max()) / small)
    return max(growths, default=0.0)


def _final(drawn: Drawn, given: Units) -> Array:
    return drawn.read(der.run(drawn.written(given)).positions[-1], given)


def table(answers: list[Answer]) -> str:
    """Counts by kind in Markdown, and everything that is not solved."""
    lines = ["| scenes | number | solved | refused by name | flagged | amplified | wrong |"]
    lines.append("|---|---:|---:|---:|---:|---:|---:|")
    kinds = sorted({found.kind for found in answers})
    for kind in [*kinds, "all"]:
        some = [found for found in answers if kind in (found.kind, "all")]
        counts = collections.Counter(found.outcome for found in some)
        refused = sum(count for outcome, count in counts.items() if outcome not in _ANSWERED)
        lines.append(
            f"| {kind} | {len(some)} | {counts[SOLVED] / len(some):.2%} | {refused} | "
            f"{counts[FLAGGED]} | {counts[AMPLIFIED]} | {counts[WRONG]} |"
        )
    names = collections.Counter(
        found.outcome for found in answers if found.outcome not in _ANSWERED
    )
    refusals = ", ".join(f"{count} `{name}`" for name, count in names.most_common())
    return "\n".join([*lines, "", f"Refused: {refusals or 'none'}."])


def aims_of_answers_missed(answers: list[Answer]) -> list[str]:
    """None is wrong, and 99 of 100 are solved."""
    missed = [
        f"{found.name} ({found.kind}) is wrong: {found.detail}"
        for found in answers
        if found.outcome == WRONG
    ]
    share = sum(found.outcome == SOLVED for found in answers) / max(len(answers), 1)
    if share < 0.99:
        missed.append(f"Only {share:.2%} of the scenes are solved; the aim is 99 %.")
    return missed
