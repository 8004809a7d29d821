"""Wide tables that narrow screens show row by row: a hook of MkDocs.

Each cell of a table with four columns or more gets the title of its column, `data-label`, which
assets/site.css writes before it where the row is a block.
"""

from __future__ import annotations

import re
from typing import Any

_TABLE = re.compile(r"<table>(.*?)</table>", re.DOTALL)
_TITLE = re.compile(r"<th[^>]*>(.*?)</th>", re.DOTALL)
_ROW = re.compile(r"<tr>(.*?)</tr>", re.DOTALL)
_TAG = re.compile(r"<[^>]+>")
_WIDE = 4  # columns


def on_page_content(html: str, **_: Any) -> str:
    """Put the titles of columns at the cells of wide tables."""
    return _TABLE.sub(_with_labels, html)


def _with_labels(table: re.Match[str]) -> str:
    titles = [_TAG.sub("", title) for title in _TITLE.findall(table[1])]
    if len(titles) < _WIDE:
        return table[0]

    def labelled(row: re.Match[str]) -> str:
        left = iter(titles)
        return re.sub(r"<td", lambda cell: f'{cell[0]} data-label="{next(left)}"', row[0])

    return f"<table data-wide>{_ROW.sub(labelled, table[1])}</table>"
