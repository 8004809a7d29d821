"""A report as Markdown; pictures stand in their own files."""

from __future__ import annotations

import re
from collections.abc import Sequence

from der.reproduce.content import Block, Bullets, Document, Paragraph, Picture, Table

_CODE = re.compile(r"(`[^`]*`)")
_SIGNS = re.compile(r"([\\*_<>\[\]|#])")


def to_markdown(document: Document) -> str:
    """Return a document as GitHub's Markdown."""
    contents = [f"- [{_text(part.title)}](#{part.anchor})" for part in document.sections]
    parts = [f"# {_text(document.title)}", *map(_block, document.lead), "\n".join(contents)]
    for section in document.sections:
        parts += [f"## {_text(section.title)}", *map(_block, section.blocks)]
    return "\n\n".join(parts) + "\n"


def _block(block: Block) -> str:
    if isinstance(block, Paragraph):
        return _text(block.text)
    if isinstance(block, Bullets):
        return "\n".join(f"- {_text(item)}" for item in block.items)
    if isinstance(block, Table):
        return _table(block)
    return _picture(block)


def _table(table: Table) -> str:
    rule = ["---:" if side == "right" else "---" for side in table.align]
    lines = [_row([_text(cell) for cell in table.columns]), _row(rule)]
    lines += [_row([_text(cell) for cell in row]) for row in table.rows]
    return f"**{_text(table.caption)}**\n\n" + "\n".join(lines)


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _picture(picture: Picture) -> str:
    image = f"![{_text(picture.alt)}]({picture.path})"
    return f"{image}\n\n**{_text(picture.title)}.** {_text(picture.caption)}"


def _text(text: str) -> str:
    """Escape what would be a sign of Markdown, outside of code."""
    parts = _CODE.split(text)
    return "".join(
        part if i % 2 else _SIGNS.sub(r"\\\1", part.replace("&", "&amp;"))
        for i, part in enumerate(parts)
    )
