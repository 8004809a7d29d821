"""A hard case: what is tried, the oracle that judges it, and the outcome that is expected."""

from __future__ import annotations

import dataclasses
import functools
import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import der

from .setting import MODELS, Setting

SOLVED = "solved"
WRONG = "wrong"
FLAGGED = "unreliable"
CRASH = "crash"


@dataclasses.dataclass(frozen=True)
class Reading:
    """The error that the oracle finds, and the largest that is expected of the method."""

    error: float
    allowed: float

    @property
    def right(self) -> bool:
        return self.error <= self.allowed  # False for NaN

    @property
    def share(self) -> float:
        return self.error / self.allowed


def worst(*readings: Reading) -> Reading:
    """The reading that is farthest beyond, or nearest to, what it is allowed."""
    return max(readings, key=lambda r: r.share if math.isfinite(r.share) else math.inf)


@dataclasses.dataclass(frozen=True)
class Limit:
    """Rows of a case that are known not to end as expected, why, and how they may end instead.

    Some of them may end as expected all the same, where rounding decides; once all do, the limit is
    lifted, and the suite fails until it is taken out.
    """

    why: str
    outcomes: tuple[str, ...]
    applies: Callable[[Setting], bool]


@dataclasses.dataclass(frozen=True)
class Case:
    """Something hard, tried in each model and, if it moves, with each stepper.

    `measure` runs the scene and lets the oracle judge; an error of der that it raises is the
    outcome, by its status. `expected` is the outcome that is right, ``solved`` or a status.
    """

    topic: str
    tried: str
    oracle: str
    measure: Callable[[Setting], Reading]
    motion: bool
    values: Mapping[str, Any]
    long_values: Mapping[str, Any]
    models: tuple[str, ...]
    applies: Callable[[Setting], bool]
    expected: Callable[[Setting], str]
    limits: tuple[Limit, ...]

    def settings(self, *, long: bool) -> Iterator[Setting]:
        """All that the case is tried in; `long` adds what takes minutes."""
        values = {**self.values, **(self.long_values if long else {})}
        for label, value in values.items():
            for model in self.models:
                for stepper in steppers_of(model) if self.motion else (None,):
                    setting = Setting(model, stepper, label, value, long)
                    if self.applies(setting):
                        yield setting


@functools.cache
def steppers_of(model: str) -> tuple[der.StepperInfo, ...]:
    """The registered steppers that there are for a model: der's own validator decides."""
    return tuple(stepper for stepper in der.steppers() if _fits(stepper.name, model))


def _fits(stepper: str, model: str) -> bool:
    try:
        der.Scenario.from_dict(_smallest(stepper, model))
    except der.SceneError as error:
        if all(d.path == "time.integrator" for d in error.diagnostics):
            return False
        raise
    return True


def _smallest(stepper: str, model: str) -> dict[str, Any]:
    stiffness = {"EA": 1, "EI": 1, "GJ": 1, "mass_per_length": 1}
    rod = {"name": "rod", "nodes": 2, "from": [0, 0], "to": [1, 0]}
    return {
        "model": model,
        "rods": [{**rod, "cross_section": {"stiffness": stiffness}}],
        "time": {"duration": 0.01, "step": 0.01, "integrator": stepper},
    }


CASES: list[Case] = []


def solved(setting: Setting) -> str:
    return SOLVED


def refused_if_explicit(setting: Setting) -> str:
    """Steps that are too long for explicit steppers are refused before the run."""
    return SOLVED if setting.implicit else "unstable_step"


def everywhere(setting: Setting) -> bool:
    return True


def hard(
    topic: str,
    tried: str,
    oracle: str,
    *,
    motion: bool = False,
    values: Mapping[str, Any] | None = None,
    long_values: Mapping[str, Any] | None = None,
    models: tuple[str, ...] = MODELS,
    applies: Callable[[Setting], bool] = everywhere,
    expected: Callable[[Setting], str] = solved,
    limits: tuple[Limit, ...] = (),
) -> Callable[[Callable[[Setting], Reading]], Callable[[Setting], Reading]]:
    """Enter a function that measures as a case."""

    def enter(measure: Callable[[Setting], Reading]) -> Callable[[Setting], Reading]:
        CASES.append(
            Case(
                topic,
                tried,
                oracle,
                measure,
                motion,
                {"": None} if values is None else values,
                long_values or {},
                models,
                applies,
                expected,
                limits,
            )
        )
        return measure

    return enter


@dataclasses.dataclass(frozen=True)
class Row:
    """The outcome of a case in one setting."""

    case: Case
    setting: Setting
    outcome: str
    reading: Reading | None
    message: str

    @property
    def limit(self) -> Limit | None:
        """The known limit that the row is under."""
        return next((limit for limit in self.case.limits if limit.applies(self.setting)), None)

    @property
    def expected(self) -> str:
        return self.case.expected(self.setting)

    @property
    def allowed(self) -> tuple[str, ...]:
        """The outcomes other than which the suite fails."""
        return (self.expected, *(self.limit.outcomes if self.limit else ()))

    @property
    def complaint(self) -> str:
        """Why the row fails the suite; empty if it does not."""
        if self.outcome in self.allowed:
            return ""
        measured = ""
        if self.reading is not None:
            measured = f": error {self.reading.error:.3g}, expected {self.reading.allowed:.3g}"
        wanted = " or ".join(repr(outcome) for outcome in self.allowed)
        return f"{self.name} ends as {self.outcome!r}, not as {wanted}{measured}{self.message}"

    @property
    def name(self) -> str:
        return f"{self.case.topic}: {self.case.measure.__name__} ({self.setting.name})"


def complaints(rows: Sequence[Row]) -> list[str]:
    """All that is not as expected: rows, and limits under which nothing fails any more."""
    found = [row.complaint for row in rows if row.complaint]
    limits = {id(row.limit): row for row in rows if row.limit is not None}
    for key, row in limits.items():
        under = [other for other in rows if id(other.limit) == key]
        if all(other.outcome == other.expected for other in under):
            found.append(
                f"{row.case.topic}: {row.case.measure.__name__}: all {len(under)} rows under this "
                f"known limit end as expected; take it out: {row.limit.why if row.limit else ''}"
            )
    return found


def play(case: Case, setting: Setting) -> Row:
    """Try a case in one setting."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            reading = case.measure(setting)
        except der.DerError as error:
            return Row(case, setting, error.status, None, f" ({str(error)[:300]})")
        except Exception as error:  # a crash is an outcome, too, and the other rows count as well
            return Row(case, setting, CRASH, None, f" ({type(error).__name__}: {error})")
    if reading.right:
        return Row(case, setting, SOLVED, reading, "")
    flagged = any(issubclass(note.category, der.UnreliableResultWarning) for note in told)
    return Row(case, setting, FLAGGED if flagged else WRONG, reading, "")
