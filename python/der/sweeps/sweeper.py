"""Sweeping: one scene with many values of its parameters, each member a row of a table."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, Future
from contextlib import closing, contextmanager
from dataclasses import replace
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np

from der._core import Scenario, __version__
from der.accuracy.default_probes import with_default_probes
from der.errors import DerError, warn
from der.output_paths import folder_path, make_folder
from der.parallel import as_they_finish, checked_jobs
from der.progress import ProgressFunction
from der.scenario import SceneLike, load
from der.sweeps.chunk import Chunk
from der.sweeps.design import Design, Member, make_design
from der.sweeps.design_checks import check_design
from der.sweeps.executors import AnyExecutor, Place, lost_its_worker, place_for
from der.sweeps.store import FILE, FRAMES, LOCK, Store, is_sweep, locked
from der.sweeps.sweep_result import Sweep, load_sweep, read_sweep
from der.sweeps.table import LOST, Table, columns_of_probe, row_of, units_of_probes
from der.sweeps.values import stored

#: What a chunk is to take [s]: a transaction and a journey are little against it.
_CHUNK_SECONDS = 0.5
#: Members of a chunk, at most.
_CHUNK_MEMBERS = 1000


def sweep(
    scenario: SceneLike,
    vary: Mapping[str, str | Iterable[Any]],
    *,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    zipped: bool = False,
    sample: str | None = None,
    seed: int = 0,
    frames: bool = False,
    verify: bool = False,
    jobs: int | None = None,
    executor: AnyExecutor | None = None,
    progress: ProgressFunction | None = None,
) -> Sweep:
    """Run a scene with many values of its parameters.

    Each member is what the scene asks for: a run over time, an equilibrium, modes, buckling loads
    or a path. One that fails is a row with its status and message. The members have the same
    numbers to the last bit wherever they are run.

    Parameters
    ----------
    scenario
        A scenario, the path of a scene file, or a dict with the keys of a scene file. A scene
        without probes is given some, as by `verify`.
    vary
        By key path, as `Scenario.with_` takes it, the values: a sequence, or a text as the command
        takes it, such as ``"0:1:11"``.
    out
        Folder for ``sweep.sqlite``. Members are added while they finish, so that a sweep that is
        killed loses none of them. None: in memory.
    resume
        Go on with the sweep in `out`, or with more values: members that it has are not run again.
        Without such a sweep, begin it.
    zipped
        Take the values side by side instead of each with each.
    sample
        ``sobol:N`` or ``lhs:N``: N points in the space of all parameters, of which each has a range
        such as ``"0:1"`` or ``"1e6:1e9:log"``, or a list.
    seed
        Where a sample starts.
    frames
        Keep the run folder of each member as well, in ``runs`` in `out`.
    verify
        Put error bars on each member, which takes some ten times as long.
    jobs
        Threads; as many as the machine has cores, unless given. Of an `executor`, the chunks that
        it runs at once.
    executor
        An executor of `concurrent.futures`, or a Dask client.
    progress
        Told now and then how much is done, from 0 to 1.

    Returns
    -------
    Sweep
        All rows, those of earlier calls included.

    Raises
    ------
    SceneError
        If the scene, or its first member, is not valid: a path that there is not, above all.
    ValueError
        For values that are not spelled right, two paths to the same value, a folder that is not
        empty, and a sweep there that is of another scene, other parameters or other options.
    TypeError
        If an argument is of another kind.
    DerError
        If another sweep is writing there, or a process of the executor died.

    Examples
    --------
    >>> tips = der.sweep("cantilever.yaml", {"loads.0.point_force.force.1": "-5:0:51"})
    >>> tips["tip_y"]
    """
    folder = None if out is None else folder_path("out", out)
    if not (progress is None or callable(progress)):
        raise TypeError(f"progress must be a function, got {progress!r}")
    for name, value in {
        "resume": resume,
        "zipped": zipped,
        "frames": frames,
        "verify": verify,
    }.items():
        if not isinstance(value, (bool, np.bool_)):
            raise TypeError(f"{name} must be True or False, got {value!r}")
    given = load(scenario)
    warn(given.warnings)
    scene = with_default_probes(given)
    design = make_design(vary, zipped=zipped, sample=sample, seed=seed)
    check_design(scene, design, verify)
    checked_jobs(jobs)
    if frames and folder is None:
        raise ValueError("run folders need a folder to be in: give out as well")
    description = {
        "title": scene.title,
        "source": scene.source,
        "scene": scene.to_yaml(),
        "analysis": scene.analysis,
        "verify": "yes" if verify else "no",
        "frames": "yes" if frames else "no",
        "version": __version__,
    }
    runs = str(folder.resolve() / FRAMES) if frames and folder is not None else ""
    blank = Chunk(description["scene"], scene.source, design.paths, (), bool(verify), runs)
    with _store(folder, resume) as store:
        _begin(store, scene, description, design, folder)
        with place_for(executor, jobs) as place:
            try:
                _Sweeper(store, design, blank, place, progress).run()
            except BrokenExecutor as error:
                raise DerError(
                    f"a process of the executor died ({error}); what was finished is kept: go on "
                    "with --resume (resume=True)"
                ) from error
        if folder is None:
            return read_sweep(store)
    return load_sweep(folder)


@contextmanager
def _store(folder: Path | None, resume: bool) -> Iterator[Store]:
    """Open the tables of a sweep for the time of a ``with`` block."""
    if folder is None:
        if resume:
            raise ValueError("a sweep in memory cannot be resumed: give out as well")
        with closing(Store()) as store:
            yield store
        return
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file, and a sweep goes to a folder: name another one")
    if not is_sweep(folder) and folder.exists():
        strangers = sorted(path.name for path in folder.iterdir() if path.name != LOCK)
        if strangers:
            needs = "a sweep needs an empty folder, and"
            what = "there is no sweep to resume in" if resume else needs
            holds = "which holds" if resume else "holds"
            raise ValueError(f"{what} {folder} {holds} {strangers[0]}: name another folder")
    make_folder(folder)
    with locked(folder), closing(Store(folder / FILE)) as store:
        if not resume and store.description():
            raise ValueError(
                f"{folder} holds a sweep already: go on with it by --resume (resume=True), or name "
                "another folder"
            )
        yield store


def _begin(
    store: Store,
    scene: Scenario,
    description: dict[str, str],
    design: Design,
    out: Path | None,
) -> None:
    """Make the tables, or see that they are those of this sweep."""
    kept = store.description()
    if not kept:
        # Probes may be varied; the first member is known to be valid.
        first = scene.with_(**dict(zip(design.paths, next(iter(design)), strict=True)))
        on_path = first.factor_range is not None
        probes = (columns_of_probe(*probe, on_path) for probe in units_of_probes(first).items())
        store.create(description, design.paths, chain.from_iterable(probes))
        return
    if kept["scene"] != description["scene"]:
        before, now = (
            Scenario.parse(text).to_dict() for text in (kept["scene"], description["scene"])
        )
        difference = _first_difference(before, now)
        raise ValueError(
            f"{out} holds a sweep of the scene '{kept['title']}' ({kept['source']}), not of "
            f"'{description['title']}' ({description['source']}): they differ in "
            f"{difference or 'the text'}; name another folder"
        )
    paths = [column.name for column in store.columns if column.kind == "parameter"]
    if sorted(paths) != sorted(design.paths):
        raise ValueError(
            f"{out} holds a sweep of {', '.join(paths)}, not of {', '.join(design.paths)}: name "
            "another folder"
        )
    for option in ("verify", "frames"):
        if kept[option] != description[option]:
            with_or_not = "with" if kept[option] == "yes" else "without"
            raise ValueError(
                f"{out} holds a sweep {with_or_not} --{option}: go on as it began, or name another "
                "folder"
            )
    if kept["version"] != description["version"]:
        warn(
            [
                f"{out} was begun by der {kept['version']}, and this is der "
                f"{description['version']}: the column 'version' tells which members are whose"
            ]
        )


def _first_difference(one: Any, other: Any, path: str = "") -> str | None:
    """Return the key path of the first difference of two scenes; None if there is none."""
    pairs: list[tuple[str, Any, Any]]
    if isinstance(one, dict) and isinstance(other, dict):
        pairs = [(key, one.get(key), other.get(key)) for key in (*one, *other)]
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = [(str(i), *both) for i, both in enumerate(zip(one, other, strict=True))]
    else:
        return path if one != other else None
    found = (_first_difference(a, b, f"{path}.{key}".lstrip(".")) for key, a, b in pairs)
    return next((path for path in found if path is not None), None)


def _unfinished(
    members: Iterable[tuple[int, Member]],
    done: set[tuple[Any, ...]],
    again: dict[tuple[Any, ...], int],
) -> Iterator[tuple[int, Member]]:
    """Yield the members that are not done; those that are run again keep their numbers.

    So a number, and the run folder that has it, never stands for other values.
    """
    if not (done or again):
        yield from members  # their values need not be looked up
        return
    for number, member in members:
        values = tuple(map(stored, member))
        if values not in done:
            yield again.get(values, number), member


class _Sweeper:
    """Cuts a sweep into chunks, has them run, and writes down what comes back."""

    def __init__(
        self,
        store: Store,
        design: Design,
        blank: Chunk,
        place: Place,
        progress: ProgressFunction | None,
    ) -> None:
        self._store = store
        self._place = place
        self._progress = progress
        self._blank = blank
        done, again = store.known(design.paths)
        first = store.request(design)
        self._left = _unfinished(enumerate(design, first), done, again)
        # Among `done` there may be rows of other requests.
        self._total = len(design) - (design.count_among(done) if done else 0)
        self._taken = self._finished = 0
        self._seconds = 0.0
        self._again: deque[Chunk] = deque()

    def run(self) -> None:
        """Run all members that have no row yet."""
        place = self._place
        for chunk, future in as_they_finish(
            place.executor, place.run, self._next_chunk, place.at_once
        ):
            table = self._table_of(chunk, future)
            if table is None:
                continue
            self._store.write(table, chunk.paths, dict(chunk.members))
            self._finished += len(table.rows)
            self._seconds += sum(row["seconds"] for row in table.rows)
            if self._progress is not None:
                self._progress(self._finished / self._total)

    def _next_chunk(self) -> Chunk | None:
        if self._again:
            return self._again.popleft()
        members = tuple(islice(self._left, self._chunk_size()))
        self._taken += len(members)
        return self._with(members) if members else None

    def _with(self, members: tuple[tuple[int, Member], ...]) -> Chunk:
        return replace(self._blank, members=members)

    def _chunk_size(self) -> int:
        """Return how many members take about the time of a chunk, fewer towards the end."""
        if not self._finished:
            return 1
        wanted = _CHUNK_SECONDS * self._finished / max(self._seconds, 1e-9)
        share = (self._total - self._taken) / (2 * self._place.workers())
        return max(1, min(int(wanted), int(share), _CHUNK_MEMBERS))

    def _table_of(self, chunk: Chunk, future: Future[Table]) -> Table | None:
        """Return the rows of a chunk; None if its parts are to be tried apart."""
        if future.cancelled():
            raise DerError(
                "the executor gave work up, as one does that is shut down or closed; what was "
                "finished is kept: go on with --resume (resume=True)"
            )
        error = future.exception()
        if error is None:
            return future.result()
        if not lost_its_worker(error):
            raise error
        if len(chunk.members) == 1:
            number, _ = chunk.members[0]
            return Table(rows=[row_of(number, LOST, f"every worker that ran it died: {error}")])
        half = len(chunk.members) // 2
        self._again += [self._with(chunk.members[:half]), self._with(chunk.members[half:])]
        return None
