"""A report as one HTML file that needs no other: style and pictures are in it."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping
from html import escape
from importlib import resources

from der.reproduce.content import Block, Bullets, Document, Paragraph, Picture, Table

_CODE = re.compile(r"`([^`]*)`")
#: A number and its unit, which stay on one line.
_QUANTITY = re.compile(r"(?<=\d) (?=(?:m|s|ms|mm|m/s|N|kN|rad|nodes)\b)")


def to_html(document: Document, pictures: Mapping[str, bytes]) -> str:
    """Return a document as HTML.

    Parameters
    ----------
    document
        The document to write.
    pictures
        The PNG of each picture by `Picture.name`.
    """
    style = resources.files("der.reproduce").joinpath("report.css").read_text(encoding="utf-8")
    links = "".join(
        f'<li><a href="#{escape(part.anchor)}">{_text(part.title)}</a></li>'
        for part in document.sections
    )
    sections = "\n".join(
        f'<section id="{escape(part.anchor)}">\n<h2>{_text(part.title)}</h2>\n'
        + "\n".join(_block(block, pictures) for block in part.blocks)
        + "\n</section>"
        for part in document.sections
    )
    lead = "\n".join(_block(block, pictures) for block in document.lead)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{_text(document.title)}</title>
<style>
{style}</style>
</head>
<body>
<header>
<h1>{_text(document.title)}</h1>
{lead}
<nav aria-label="Contents">
<h2>Contents</h2>
<ol>{links}</ol>
</nav>
</header>
<main>
{sections}
</main>
</body>
</html>
"""


def _block(block: Block, pictures: Mapping[str, bytes]) -> str:
    if isinstance(block, Paragraph):
        return f"<p>{_text(block.text)}</p>"
    if isinstance(block, Bullets):
        return "<ul>" + "".join(f"<li>{_text(item)}</li>" for item in block.items) + "</ul>"
    if isinstance(block, Table):
        return _table(block)
    return _picture(block, pictures[block.name])


def _table(table: Table) -> str:
    heads = "".join(
        f'<th scope="col" class="{side}">{_text(cell)}</th>'
        for cell, side in zip(table.columns, table.align, strict=True)
    )
    rows = "\n".join(
        "<tr>"
        + "".join(
            f'<td class="{side}">{_text(cell)}</td>'
            for cell, side in zip(row, table.align, strict=True)
        )
        + "</tr>"
        for row in table.rows
    )
    return (
        f'<div class="table"><table>\n<caption>{_text(table.caption)}</caption>\n'
        f"<thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table></div>"
    )


def _picture(picture: Picture, png: bytes) -> str:
    data = base64.b64encode(png).decode("ascii")
    return (
        f'<figure id="{escape(picture.name)}">\n'
        f'<img alt="{escape(picture.alt)}" src="data:image/png;base64,{data}">\n'
        f"<figcaption><strong>{_text(picture.title)}.</strong> {_text(picture.caption)}"
        "</figcaption>\n</figure>"
    )


def _text(text: str) -> str:
    together = _QUANTITY.sub("&nbsp;", escape(text, quote=False))
    return _CODE.sub(r"<code>\1</code>", together)
