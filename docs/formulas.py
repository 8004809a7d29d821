"""Formulas of the pages, `$...$` and `$$...$$`, as MathML: a hook of MkDocs without a network.

They are kept from the markdown by a word each, and put in their places in the page that it makes.
"""

from __future__ import annotations

import re
from typing import Any

from latex2mathml.converter import convert

# Code is left alone. A formula neither begins nor ends with a space.
_PARTS = re.compile(
    r"(?P<code>^ *```.*?^ *```|`+[^`]+`+)"
    r"|\$\$(?P<block>.+?)\$\$|\$(?P<inline>[^\s$](?:[^$]*?[^\s$])?)\$",
    re.DOTALL | re.MULTILINE,
)


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Put a word in the place of each formula."""
    page.meta["formulas"] = found = []

    def word(match: re.Match[str]) -> str:
        if match["code"]:
            return match[0]
        display = "block" if match["block"] else "inline"
        found.append(convert((match["block"] or match["inline"]).strip(), display=display))
        return f"FORMULA{len(found) - 1}E"

    return _PARTS.sub(word, markdown)


def on_page_content(html: str, page: Any, **_: Any) -> str:
    """Put the formulas in the places of their words."""
    return re.sub(r"FORMULA(\d+)E", lambda match: page.meta["formulas"][int(match[1])], html)
