"""Running some members of a sweep, in a thread of this process or on another machine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter
from pathlib import Path
from typing import Any, TypeAlias

from der._core import RunRecording, Scenario, __version__
from der.accuracy.readings import Reading, read_run
from der.accuracy.verifier import verify
from der.errors import DerError
from der.parallel import attempt
from der.simulation import recorded_result
from der.sweeps.design import Member
from der.sweeps.table import (
    BROKEN,
    TOLD,
    WARNINGS,
    WHEN,
    Table,
    columns_of_probe,
    names_of_columns,
    row_of,
)

_told = itemgetter(*TOLD, *WHEN)
#: What a row has of the summary of a run: to ask for all of it takes as long as the rest of a row.
_OF_SUMMARY = (
    *("status", "unreliable_from", "stability", "out_of_plane", "warnings"),
    *("steps", "newton_iterations", "probes"),
)
#: Analyses that find more than probes. To make a result of a run takes a tenth of the time of an
#: equilibrium, which needs none.
_THAT_FIND = ("modes", "buckling", "continuation")
#: Run folders in a folder: file systems are slow with more.
_FOLDERS = 1000

#: What a row has of a run: values of ``summary.json``, None where a key is not in it, and what an
#: analysis finds besides probes.
_Reading: TypeAlias = tuple[dict[str, Any], list[Reading]]


@dataclass(frozen=True)
class Chunk:
    """Members that are run one after the other.

    Attributes
    ----------
    scene, source
        Text and name of the scene that is varied.
    paths
        The parameters.
    members
        Number and values of each member.
    verify
        Whether they get error bars.
    frames
        Folder for their run folders; empty for none.
    version
        Version of der that is to run them.
    """

    scene: str
    source: str
    paths: tuple[str, ...]
    members: tuple[tuple[int, Member], ...]
    verify: bool = False
    frames: str = ""
    version: str = __version__


def run_chunk(chunk: Chunk, tick: Callable[[], None] | None = None) -> Table:
    """Run the members of a chunk; one that fails is a row as well.

    Parameters
    ----------
    chunk
        What to run.
    tick
        Called now and then; what it raises ends the chunk.

    Raises
    ------
    DerError
        If this is another version of der.
    """
    if chunk.version != __version__:
        raise DerError(
            f"a worker has der {__version__}, and the sweep is run by der {chunk.version}: install "
            "the same version on all machines"
        )
    scene = _parse(chunk.scene, chunk.source)
    table = Table()
    for number, values in chunk.members:
        if tick is not None:
            tick()
        before = len(table.rows)
        try:
            _run_member(scene, chunk, number, values, tick, table)
        except Exception as error:  # the other members are not to suffer from it
            table.rows[before:] = [row_of(number, BROKEN, f"{type(error).__name__}: {error}")]
    return table


def run_folder(frames: str | Path, number: int) -> Path:
    """Return the run folder of a member."""
    return Path(frames) / f"{number // _FOLDERS:04d}" / f"{number:07d}"


@lru_cache(maxsize=4)
def _parse(text: str, source: str) -> Scenario:
    """Read a scene once, and not for each chunk."""
    return Scenario.parse(text, source)


def _run_member(
    scene: Scenario,
    chunk: Chunk,
    number: int,
    values: Member,
    tick: Callable[[], None] | None,
    table: Table,
) -> None:
    try:
        varied = scene.with_(**dict(zip(chunk.paths, values, strict=True)))
    except DerError as error:
        table.rows.append(row_of(number, error.status, str(error)))
        return
    out = run_folder(chunk.frames, number) if chunk.frames else None
    outcome = attempt(varied, _read, out=out, tick=tick)
    message, seconds, verification = None, outcome.cpu_seconds, None
    if chunk.verify and outcome.error is None:
        try:
            verification = verify(
                varied, jobs=1, progress=None if tick is None else lambda _: tick()
            )
            seconds += verification.cpu_seconds
        except DerError as error:
            message = f"not verified: {error}"
    if outcome.error is not None:
        table.rows.append(row_of(number, outcome.error.status, str(outcome.error), seconds))
    else:
        summary, found = outcome.value()
        table.rows.append(row_of(number, summary["status"], message, seconds))
        _add_findings(table, summary, found, varied.factor_range is not None)
    if outcome.result is None:
        return
    summary, _ = outcome.result  # a failed run has cost something, and may have warned
    for name in ("steps", "newton_iterations", "unreliable_from"):
        table.rows[-1][name] = summary[name]
    if warnings := summary["warnings"]:
        table.put(WARNINGS, "found", "", "\n".join(warnings))
    if verification is not None:
        for value in verification.values:
            of_probe = value.probe in summary["probes"] and value.what in TOLD
            column = f"{value.probe}.{value.what}" if of_probe else value.label
            table.put(f"{column}.error", "error", value.unit, value.error_bar)
        table.put("flagged", "error", "", len(verification.flagged))


def _read(scenario: Scenario, recording: RunRecording) -> _Reading:
    summary = {key: recording.summary_value(key) for key in _OF_SUMMARY}
    if scenario.analysis not in _THAT_FIND or recording.error is not None:
        return summary, []
    readings = read_run(recorded_result(scenario, recording))
    return summary, [found for label, found in readings.items() if label not in summary["probes"]]


def _add_findings(
    table: Table, summary: dict[str, Any], found: list[Reading], on_path: bool
) -> None:
    """Put what a run has found into the last row."""
    for name, probe in summary["probes"].items():
        names = names_of_columns(name)
        if names[0] not in table.columns:
            for column in columns_of_probe(name, probe["unit"], on_path):
                table.columns.setdefault(column.name, column)
        table.rows[-1].update(zip(names, _told(probe), strict=True))
    if summary["stability"] is not None:
        table.put("stability", "found", "", summary["stability"])
    out_of_plane = (summary["out_of_plane"] or {}).get("stability", "not_tested")
    if out_of_plane != "not_tested":
        table.put("stability out of plane", "found", "", out_of_plane)
    for reading in found:
        table.put(reading.label, "found", reading.unit, reading.value)
