"""Reproducing the course report: measure, draw, and write it all to a folder."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import matplotlib.pyplot as plt

from der.plotting import style
from der.progress import ProgressFunction
from der.reproduce.content import Document
from der.reproduce.html import to_html
from der.reproduce.markdown import to_markdown
from der.reproduce.measurements import STAGES, measure
from der.reproduce.quantities import (
    comparison_csv,
    deflection_csv,
    quantities,
    speeds_csv,
)
from der.reproduce.stages import Stages
from der.reproduce.story import write_story

_REPORT = "report.html"
#: All that is ever written to the folder.
_OWN = {_REPORT, "report.md", "figures", "data"}


def reproduce(
    folder: str | os.PathLike[str] = "reproduction",
    *,
    jobs: int | None = None,
    progress: ProgressFunction | None = None,
    begun: Callable[[str], None] | None = None,
) -> Path:
    """Run the course report's three problems and write what came out beside what it says.

    Nothing is in the folder before everything is there. It holds ``report.html``, which needs no
    other file, ``report.md``, ``figures/*.png`` and ``data/*.csv``.

    Parameters
    ----------
    folder
        Where to write. It must not exist, be empty, or hold an earlier reproduction, which is then
        replaced.
    jobs
        Runs at once; as many as the machine has cores, unless given.
    progress
        Told now and then how much is done, from 0 to 1.
    begun
        Told the name of each stage of the work, such as ``error bars``.

    Returns
    -------
    Path
        That of ``report.html``.

    Raises
    ------
    FileExistsError, NotADirectoryError
        If the folder holds other things, or is none.
    OSError
        If it cannot be written.
    """
    folder = Path(folder)
    with _prepared(folder) as draft:
        stages = Stages(STAGES, progress, begun)
        m = measure(jobs, stages)
        rows = quantities(m)
        document = write_story(m, rows)
        data = {
            "comparison": comparison_csv(rows),
            "deflection_by_load": deflection_csv(m),
            "terminal_speeds": speeds_csv(m),
        }
        _write(draft, document, data, stages.of("figures"))
    return folder / _REPORT


def _write(
    draft: Path, document: Document, data: Mapping[str, str], progress: ProgressFunction
) -> None:
    pictures = {}
    (draft / "figures").mkdir()
    (draft / "data").mkdir()
    wanted = list(document.pictures())
    for i, picture in enumerate(wanted):
        path = draft / picture.path
        with style():
            figure = picture.draw()
            # Without the version of Matplotlib, so that the same picture is the same file.
            figure.savefig(path, metadata={"Software": None})
        plt.close(figure)
        pictures[picture.name] = path.read_bytes()
        progress((i + 1) / len(wanted))
    for name, text in data.items():
        (draft / "data" / f"{name}.csv").write_text(text, encoding="utf-8")
    (draft / "report.md").write_text(to_markdown(document), encoding="utf-8")
    (draft / _REPORT).write_text(to_html(document, pictures), encoding="utf-8")


@contextmanager
def _prepared(folder: Path) -> Iterator[Path]:
    """Give a draft folder that becomes `folder` if the block succeeds and vanishes if not."""
    _check_is_free(folder)
    target = folder.resolve()
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        # Beside it, for only within one file system is a folder moved at once.
        draft = Path(tempfile.mkdtemp(prefix=f".{target.name}-", dir=target.parent))
    except OSError as error:
        raise OSError(
            f"cannot write to {target.parent}: {error.strerror}; name another folder with --out"
        ) from error
    try:
        draft.chmod(0o755)
        yield draft
        _check_is_free(folder)
        _move_into_place(draft, target)
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise


def _move_into_place(draft: Path, target: Path) -> None:
    """Rename a draft; what it replaces is whole until then, and deleted after."""
    if not target.exists():
        draft.rename(target)
        return
    earlier = draft.with_name(f"{draft.name}-earlier")
    target.rename(earlier)
    try:
        draft.rename(target)
    except BaseException:
        earlier.rename(target)
        raise
    shutil.rmtree(earlier)


def _check_is_free(folder: Path) -> None:
    """Raise an error unless a folder may be written, or replaced."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise NotADirectoryError(f"{folder} is a file; name a folder with --out")
    found = {path.name for path in folder.iterdir()}
    if found and not (_REPORT in found and found <= _OWN):
        other = min(found - _OWN, default=min(found))
        raise FileExistsError(
            f"{folder} holds other things ('{other}') and is left alone; name another folder with "
            "--out, or empty it"
        )
