"""The parts of a written report; `html` and `markdown` define how they look.

Texts may hold `code` in backticks and are plain otherwise: what HTML or Markdown would take for a
sign of theirs is made safe by whoever writes it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from matplotlib.figure import Figure

Align: TypeAlias = Literal["left", "right"]


@dataclass(frozen=True)
class Paragraph:
    """One paragraph of text."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A list of short texts."""

    items: Sequence[str]


@dataclass(frozen=True)
class Table:
    """A table; every row has a text for each column.

    Attributes
    ----------
    caption
        A description of the table.
    columns
        Heads of the columns.
    align
        Side on which each column is flush: right for numbers.
    rows
        The cells.
    """

    caption: str
    columns: Sequence[str]
    align: Sequence[Align]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Picture:
    """A figure, drawn when the report is written.

    Attributes
    ----------
    name
        Name of the file, without its ending.
    title
        A few words, such as ``Figure 3``; what it answers may follow in brackets.
    caption
        A description of the picture.
    alt
        For those who cannot see it.
    draw
        Draws it.
    """

    name: str
    title: str
    caption: str
    alt: str
    draw: Callable[[], Figure]

    @property
    def path(self) -> str:
        """File of the picture, relative to the report."""
        return f"figures/{self.name}.png"


Block: TypeAlias = Paragraph | Bullets | Table | Picture


@dataclass(frozen=True)
class Section:
    """A heading and what stands below it."""

    title: str
    blocks: Sequence[Block]

    @property
    def anchor(self) -> str:
        """The anchor of links to the section, made from its title as GitHub makes it."""
        kept = "".join(c for c in self.title.lower() if c.isalnum() or c in " -_")
        return kept.replace(" ", "-")


@dataclass(frozen=True)
class Document:
    """A whole report."""

    title: str
    lead: Sequence[Block]
    sections: Sequence[Section] = field(default_factory=tuple)

    def pictures(self) -> Iterator[Picture]:
        """Go through all pictures in their order."""
        for block in [*self.lead, *(block for part in self.sections for block in part.blocks)]:
            if isinstance(block, Picture):
                yield block
