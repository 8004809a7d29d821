"""An audit of ``der verify``: random scenes, independently solved, against the error bars."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from .buckling import buckling
from .case import Case
from .modes import modes
from .motions import fall, motion
from .paths import paths
from .score import Row, summarise
from .space_motion import space_motion
from .space_static import space_static
from .statics import static

KINDS: dict[str, Callable[[np.random.Generator], Case]] = {
    "buckling": buckling,
    "fall": fall,
    "modes": modes,
    "motion": motion,
    "paths": paths,
    "space_motion": space_motion,
    "space_static": space_static,
    "static": static,
}


def aims_missed(rows: Iterable[Row]) -> list[str]:
    """The aims that a run of the audit misses, in sentences: in the plane, and in space."""
    rows = list(rows)
    missed = []
    for where, some in (
        ("In the plane", [row for row in rows if not row.in_space]),
        ("In space", [row for row in rows if row.in_space]),
    ):
        summary = summarise(some)
        if some and summary.coverage < 0.98:
            missed.append(
                f"{where} only {summary.coverage:.1%} of the true values are inside; "
                "the aim is 98 %."
            )
        if summary.false_flags > 0.05:
            missed.append(
                f"{where} {summary.false_flags:.1%} of the right values are flagged; "
                "the aim is 5 %."
            )
        if summary.quietly_wrong:
            missed.append(
                f"{where} {summary.quietly_wrong} values outside their bars are not flagged."
            )
    return missed
