"""The results of ``der verify`` for a case, value by value, against the true values."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Iterable
from typing import Any

import der
import numpy as np

from .case import Case, UnsolvedError
from .rod import NoSolutionError


@dataclasses.dataclass(frozen=True)
class Row:
    """One value with its error bar, and the truth."""

    kind: str
    name: str
    label: str
    quantity: str
    value: float
    error_bar: float
    verdict: str
    flagged: bool
    truth: float
    slack: float
    scale: float

    @property
    def in_space(self) -> bool:
        return self.kind.startswith("space_")

    @property
    def error(self) -> float:
        return abs(self.value - self.truth)

    @property
    def measured(self) -> bool:
        return math.isfinite(self.error_bar)

    @property
    def inside(self) -> bool:
        """Whether the truth is within the bar, but for the error of the reference and rounding."""
        return self.measured and self.error <= self.error_bar + self.slack

    @property
    def right(self) -> bool:
        """A value that deserves no flag: off by less than 1 %, and inside its bar if it has one."""
        return self.error <= 0.01 * self.scale and (self.inside or not self.measured)

    @property
    def quietly_wrong(self) -> bool:
        return self.measured and not self.inside and not self.flagged


@dataclasses.dataclass
class Outcome:
    """The outcome of one case."""

    name: str
    kind: str
    scene: str
    rows: list[Row]
    remark: str = ""
    refused: list[str] = dataclasses.field(default_factory=list)


#: A reference whose own error is larger, against the size of the quantity, tells nothing.
_KNOWN = 0.5


def judge(case: Case, name: str) -> Outcome:
    """Run ``der verify`` on a case and compare."""
    scene, refused = _accepted(case.scene)
    outcome = Outcome(name, case.kind, "", [], refused=refused)
    if scene is None:
        outcome.remark = "refused: " + "; ".join(refused)
        return outcome
    outcome.scene = scene.to_yaml()
    try:
        final = _final(scene)
        verification = der.verify(scene, jobs=1)
    except der.DerError as error:
        outcome.remark = f"{error.status}"
        return outcome
    try:
        truths = case.truths(final)
    except (UnsolvedError, NoSolutionError) as error:
        outcome.remark = f"unsolved: {error}"
        return outcome
    if any(truth.error > _KNOWN * truth.scale for truth in truths.values()):
        outcome.remark = "unsolved: the reference is not converged"
        return outcome
    alone = _events_of_this_mesh(verification)
    for value in verification.values:
        truth = truths.get((value.probe, _true_event(value.what, alone)))
        if truth is None or value.what in alone or not math.isfinite(value.value):
            continue
        outcome.rows.append(
            Row(
                case.kind,
                name,
                f"{value.probe} {value.what}",
                truth.quantity,
                float(value.value),
                math.nan if value.error_bar is None else float(value.error_bar),
                value.verdict,
                bool(value.flagged),
                truth.value,
                truth.error,
                truth.scale,
            )
        )
    return outcome


def _events_of_this_mesh(verification: der.Verification) -> set[str]:
    """The events that verify says only the scene's own mesh has: they have no true values."""
    return {
        value.what
        for value in verification.values
        if value.verdict.startswith("unmatched") and math.isfinite(value.value)
    }


def _true_event(what: str, alone: set[str]) -> str:
    """Name an event as the reference counts it, without those of the mesh alone."""
    kind, _, number = what.rpartition(" ")
    if not alone or not number.isdigit():
        return what
    before = sum(f"{kind} {n}" in alone for n in range(1, int(number)))
    return f"{kind} {int(number) - before}"


def _accepted(scene: dict[str, Any]) -> tuple[der.Scenario | None, list[str]]:
    """The scene without the probes that its validator refuses, and why it does."""
    scene = copy.deepcopy(scene)
    refused: list[str] = []
    try:
        return der.Scenario.from_dict(scene), refused
    except der.SceneError as error:
        for complaint in error.diagnostics:
            refused.append(f"{complaint.path}: {complaint.message}")
            parts = complaint.path.split(".")
            if parts[:2] == ["output", "probes"] and len(parts) > 2:
                scene["output"]["probes"].pop(parts[2], None)
    try:
        if scene.get("output", {}).get("probes") == {}:
            return None, refused
        return der.Scenario.from_dict(scene), refused
    except der.SceneError as error:
        return None, [*refused, str(error)]


def _final(scene: der.Scenario) -> dict[str, Any]:
    """The final shape and tension of a run, which show which of several solutions it reached."""
    if "time" in scene.to_dict():
        return {}
    result = der.equilibrium(scene)
    return {
        "positions": np.array(result.positions[-1]),
        "tension": tuple(np.array(part) for part in _tension(result)),
        "result": result,
    }


def _tension(result: Any) -> tuple[Any, Any]:
    places, values = result.along(result.rods[0].name, "tension")
    return places, values[-1]


# -- the report -----------------------------------------------------------------------------------

COLUMNS = (
    f"{'':22} {'values':>7} {'inside':>8} {'right':>7} {'flagged':>8} {'quietly':>8} {'no bar':>7}"
)


@dataclasses.dataclass(frozen=True)
class Summary:
    """Counts over some rows."""

    values: int
    measured: int
    inside: int
    right: int
    right_flagged: int
    quietly_wrong: int

    @property
    def coverage(self) -> float:
        return self.inside / max(self.measured, 1)

    @property
    def false_flags(self) -> float:
        return self.right_flagged / max(self.right, 1)


def summarise(rows: Iterable[Row]) -> Summary:
    rows = list(rows)
    right = [row for row in rows if row.right]
    return Summary(
        len(rows),
        sum(row.measured for row in rows),
        sum(row.inside for row in rows),
        len(right),
        sum(row.flagged for row in right),
        sum(row.quietly_wrong for row in rows),
    )


def report(outcomes: list[Outcome]) -> str:
    """The table: coverage, flags and what is quietly wrong, by kind of scene and by quantity."""
    rows = [row for outcome in outcomes for row in outcome.rows]
    lines = [COLUMNS]

    def line(title: str, some: list[Row]) -> None:
        s = summarise(some)
        lines.append(
            f"{title:22} {s.values:7d} {s.coverage:8.1%} {s.right:7d} {s.false_flags:8.1%} "
            f"{s.quietly_wrong:8d} {s.values - s.measured:7d}"
        )

    for kind in sorted({row.kind for row in rows}):
        line(kind, [row for row in rows if row.kind == kind])
    lines.append("")
    for quantity in sorted({row.quantity for row in rows}):
        line(quantity, [row for row in rows if row.quantity == quantity])
    lines.append("")
    planar = [row for row in rows if not row.in_space]
    spatial = [row for row in rows if row.in_space]
    if planar and spatial:
        line("in the plane", planar)
        line("in space", spatial)
    line("all", rows)
    scenes = sum(bool(outcome.rows) for outcome in outcomes)
    lines += ["", f"{scenes} of {len(outcomes)} scenes compared."]
    remarks: dict[str, list[str]] = {}
    for outcome in outcomes:
        if outcome.remark:
            remarks.setdefault(outcome.remark, []).append(outcome.name)
    for remark, names in sorted(remarks.items(), key=lambda item: -len(item[1])):
        lines.append(f"  {len(names)} x {remark} ({', '.join(names[:6])})")
    outside = [row for row in rows if row.measured and not row.inside]
    for title, some in (
        ("Outside and not flagged:", [row for row in outside if not row.flagged]),
        ("Outside and flagged:", [row for row in outside if row.flagged]),
    ):
        if some:
            lines += ["", title]
            some.sort(key=lambda row: -row.error / max(row.scale, 1e-300))
            lines += [_describe(row) for row in some]
    return "\n".join(lines)


def _describe(row: Row) -> str:
    times = row.error / row.error_bar if row.error_bar > 0 else math.inf
    return (
        f"  {row.name:14} {row.label:22} {row.quantity:15} {row.value:.9g} ± {row.error_bar:.2g}, "
        f"truth {row.truth:.9g} ({row.error / max(row.scale, 1e-300):.1e} of its size, "
        f"{times:.3g} bars; {row.verdict})"
    )
