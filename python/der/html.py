"""How objects show themselves in notebooks: a title, facts, a picture and small tables.

Without scripts, style sheets and colours, so that it fits light and dark pages.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Sequence
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING

from der.tables import Rows, html_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DPI = 90


def card(
    title: str,
    facts: str,
    figure: Callable[[], Figure] | None = None,
    tables: Sequence[Rows] = (),
    text: str = "",
) -> str:
    """Return an object in HTML.

    Parameters
    ----------
    title, facts
        What it is, in a line each.
    figure
        Draws its picture with pyplot.
    tables
        Tables below the picture; those without a row under their header are left out.
    text
        A long text to be unfolded.
    """
    parts = [f"<strong>{escape(title)}</strong><br>{escape(facts)}"]
    if figure is not None:
        parts.append(_picture(figure()))
    parts += [html_table(rows) for rows in tables if len(rows) > 1]
    if text:
        parts.append(f"<details><summary>YAML</summary><pre>{escape(text)}</pre></details>")
    return f"<div>{''.join(f'<div>{part}</div>' for part in parts)}</div>"


def _picture(figure: Figure) -> str:
    import matplotlib.pyplot as plt  # here, because it takes long to load
    from PIL import Image

    drawn, small = BytesIO(), BytesIO()
    figure.savefig(drawn, dpi=_DPI)
    plt.close(figure)  # or the notebook would show it once more
    # In 256 colours, rare ones among them, lines and letters take half of the room.
    image = Image.open(drawn).convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=1)
    image.save(small, "png", optimize=True)
    data = b64encode(small.getvalue()).decode()
    return f'<img alt="" style="max-width:100%" src="data:image/png;base64,{data}">'
