"""Run the course report's three problems again, and put every number beside ours and the exact one.

Writes report.html, which needs no other file, every figure as PNG and the numbers as CSV. Takes
about half a minute.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from der.output_paths import make_folder, output_folder

from .comparison import comparison
from .measurements import measure
from .page import draw, page
from .tables import data_files

_REPORT = "report.html"
_OWN = {_REPORT, "figures", "data"}


def reproduce(folder: Path) -> Path:
    """Write the report, once everything is known, and return its path.

    Parameters
    ----------
    folder
        Where to write: new, empty, or that of an earlier report, which is then replaced.

    Raises
    ------
    OSError
        If the folder holds other things or cannot be written.
    """
    make_folder(folder)
    found = {path.name for path in folder.iterdir()}
    if found and not (_REPORT in found and found <= _OWN):
        raise FileExistsError(
            f"{folder} holds other things ('{min(found - _OWN, default=min(found))}') and is left "
            "alone; name another folder with --out, or empty it"
        )
    m = measure(_tell)
    _tell("figures")
    rows, pictures = comparison(m), draw(m)
    text = page(m, rows, pictures)
    for name in ("figures", "data"):
        (folder / name).mkdir(exist_ok=True)
    for name, png in pictures.items():
        (folder / "figures" / f"{name}.png").write_bytes(png)
    for name, table in data_files(m, rows).items():
        with (folder / "data" / f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(table)
    (folder / _REPORT).write_text(text, encoding="utf-8")
    return folder / _REPORT


def main(arguments: Sequence[str] | None = None) -> int:
    """Read the command line, write the report and print its path."""
    parser = argparse.ArgumentParser(prog="scripts/reproduce", description=__doc__)
    parser.add_argument(
        "--out",
        type=output_folder,
        default=Path("reproduction"),
        metavar="DIR",
        help="where to write; an earlier report there is replaced (default: %(default)s)",
    )
    out = parser.parse_args(arguments).out
    mpl.use("agg")  # files are written and no window opened, on a screen or without
    try:
        print(reproduce(out))
    except OSError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


def _tell(stage: str) -> None:
    """Tell on the error stream, where the path of the report does not go."""
    print(stage, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
