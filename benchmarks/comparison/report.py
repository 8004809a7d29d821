"""The measurements as text: cheapest configurations, tables, CSV."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from comparison.measure import Point
from comparison.scene import Config

TARGETS = (1e-2, 1e-3, 1e-4, 1e-5)  # [m]


@dataclass(frozen=True)
class Run:
    """A point of a series: what it cost, and the error that the series is about."""

    seconds: float
    error: float
    config: Config


@dataclass(frozen=True)
class Series:
    """The runs of a code, with their errors against the reference or its own limit."""

    title: str
    code: str
    runs: tuple[Run, ...]
    own_limit: bool = False


def to_series(points: Iterable[Point]) -> list[Series]:
    """Sort points by code; a code with a limit of its own gives two series."""
    by_code: dict[str, list[Point]] = {}
    for point in points:
        by_code.setdefault(point.code, []).append(point)
    found = []
    for code, mine in by_code.items():
        done = [point for point in mine if not point.failure]
        runs = tuple(Run(p.seconds, p.error, p.config) for p in done)
        found.append(Series(code, code, runs))
        own = tuple(Run(p.seconds, p.own_error, p.config) for p in done if p.own_error is not None)
        if own:
            found.append(Series(f"{code}, own limit", code, own, own_limit=True))
    return found


def pareto_front(runs: Iterable[Run]) -> list[Run]:
    """Return the runs that no other beats in both cost and error, from the cheapest on."""
    front: list[Run] = []
    for run in sorted(runs, key=lambda r: (r.seconds, r.error)):
        if math.isfinite(run.error) and (not front or run.error < front[-1].error):
            front.append(run)
    return front


def cheapest(runs: Iterable[Run], target: float) -> Run | None:
    """Return the cheapest run with at most this error [m]; None if there is none."""
    good = [run for run in runs if run.error <= target]
    return min(good, key=lambda r: r.seconds) if good else None


def cost_table(series: Sequence[Series]) -> str:
    """Return a Markdown table of the cost of each target, with ratios to the first series."""
    rows = [["error at most", *(s.title for s in series)]]
    for target in TARGETS:
        best = [cheapest(s.runs, target) for s in series]
        rows.append([f"{_error(target)} m", *(_cost(run, best[0]) for run in best)])
    return _markdown(rows)


def configuration_table(series: Sequence[Series]) -> str:
    """Return a Markdown table of the cheapest configuration of each series for each target."""
    rows = [["error at most", "code", "CPU", "error", "configuration"]]
    for target in TARGETS:
        for s in series:
            run = cheapest(s.runs, target)
            if run is not None:
                cells = [time_text(run.seconds), f"{_error(run.error)} m", config_text(run.config)]
                rows.append([f"{_error(target)} m", s.title, *cells])
    return _markdown(rows)


def notes(limits: Mapping[str, float]) -> str:
    """Say of each code with a limit of its own how far that lies from the reference [m]."""
    return "\n".join(
        f"{code} converges to a continuum of its own, {_error(apart)} m from the reference; "
        f'"{code}, own limit" measures against that.'
        for code, apart in limits.items()
    )


def config_text(config: Config) -> str:
    """Return a configuration in words, the numbers of elements and steps first."""
    counts = f"{config['elements']} elements, {config['steps']} steps/frame"
    rest = [
        f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in config.items()
        if key not in ("elements", "steps")
    ]
    return ", ".join([counts, *rest])


def time_text(seconds: float) -> str:
    """Return a time with two digits, in ms below a second."""
    unit, scaled = ("ms", 1e3 * seconds) if seconds < 0.9995 else ("s", seconds)
    return f"{_two_digits(scaled)} {unit}"


def write_csv(path: Path, points: Iterable[Point]) -> None:
    """Write all points, the failed ones too."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            ["code", "cpu_seconds", "error_m", "own_limit_error_m", "configuration", "failure"]
        )
        for p in points:
            own = "" if p.own_error is None else f"{p.own_error:.4e}"
            numbers = [f"{p.seconds:.4e}", f"{p.error:.4e}", own]
            writer.writerow([p.code, *numbers, config_text(p.config), p.failure])


def _cost(run: Run | None, first: Run | None) -> str:
    if run is None:
        return "not reached"
    if first is None or run is first:
        return time_text(run.seconds)
    return f"{time_text(run.seconds)} ({_two_digits(run.seconds / first.seconds)} x)"


def _two_digits(value: float) -> str:
    """Return a number rounded to two digits, and to whole ones from 10 on."""
    if value == 0.0:
        return "0"
    rounded = float(f"{value:.1e}")  # 9.96 becomes 10, which has no more digits to show
    digits = max(0, 1 - math.floor(math.log10(rounded)))
    return f"{value:.{digits}f}"


def _error(error: float) -> str:
    mantissa, _, exponent = f"{error:.1e}".partition("e")
    return f"{mantissa.removesuffix('.0')}e{int(exponent)}"


def _markdown(rows: Sequence[Sequence[str]]) -> str:
    header, *body = rows
    lines = [header, ["---"] * len(header), *body]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
