"""Small tables: as lines of text, in HTML, and of pandas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

#: Rows of cells; the first one has the names of the columns.
Rows = Sequence[Sequence[str]]


def text_table(rows: Rows) -> list[str]:
    """Return the lines of a table whose columns are aligned."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def html_table(rows: Rows) -> str:
    """Return a table in HTML; the texts may hold anything."""
    lines = (
        "".join(f'<{tag} style="text-align:left">{escape(cell)}</{tag}>' for cell in row)
        for tag, row in zip(["th", *["td"] * len(rows)], rows, strict=False)
    )
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def data_frame(
    columns: Mapping[str, Any], index: Mapping[str, Any], units: Mapping[str, str]
) -> pd.DataFrame:
    """Return a table of pandas; ``attrs["units"]`` has the units of its columns.

    Raises
    ------
    ModuleNotFoundError
        Without pandas.
    """
    try:
        import pandas as pd
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            "to_pandas needs the package pandas: pip install 'der[tables]'"
        ) from error
    frame = pd.DataFrame({**index, **columns}).set_index(list(index))
    frame.attrs["units"] = dict(units)
    return frame
