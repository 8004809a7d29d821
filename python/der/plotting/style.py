"""The look that all pictures share."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.colors import to_rgb
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from matplotlib.typing import ColorType

#: Colours of Okabe and Ito, distinguishable with every common form of colour blindness.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")

#: Markers of lines that must be distinguishable by more than their colour.
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", "*", "h", ">", "p", "d")
_DARKER = 0.55  # of the colours, each time that the palette begins anew

#: Parts that are not the result itself: supports, zero lines, reference shapes.
MUTED = "#6b6b6b"

#: Loads: forces, moments, gravity.
LOAD = PALETTE[1]

#: Actuated stretches, one after the other: far from the colours of rods at all times, and of loads.
ACTUATED = (PALETTE[3], PALETTE[4], "#6F42F5", PALETTE[5])

#: Parts of a result that are not to be trusted.
WARNING = "#B00020"

#: Font sizes of titles and of labels of axes [points].
AXES_TITLE, FIGURE_TITLE, AXIS_LABEL = 11.0, 12.0, 10.0
_HARD_SPACE = "\u00a0"
_TITLE_LINES = 4  # what is longer ends with three dots

_SETTINGS: dict[Any, Any] = {
    "axes.axisbelow": True,
    "axes.edgecolor": "#8a8a8a",
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "axes.formatter.useoffset": False,
    "axes.grid": True,
    "axes.labelsize": AXIS_LABEL,
    "axes.prop_cycle": cycler(color=PALETTE),
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": AXES_TITLE,
    "figure.dpi": 110,
    "figure.titlesize": FIGURE_TITLE,
    "font.size": 9,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "savefig.dpi": 150,
    "xtick.color": "#8a8a8a",
    "xtick.labelcolor": "black",
    "ytick.color": "#8a8a8a",
    "ytick.labelcolor": "black",
}


def look(index: int) -> tuple[ColorType, str]:
    """Return a colour and a marker for number `index` of any number of things."""
    share = _DARKER ** (index // len(PALETTE))
    red, green, blue = to_rgb(PALETTE[index % len(PALETTE)])
    return (share * red, share * green, share * blue), MARKERS[index % len(MARKERS)]


def actuated_colour(number: int, negative: bool) -> tuple[float, float, float]:
    """Return the colour of actuation number `number`: dark where its value is negative."""
    depth = _DARKER if negative else 1.0
    red, green, blue = to_rgb(ACTUATED[number % len(ACTUATED)])
    return depth * red, depth * green, depth * blue


@contextmanager
def style() -> Iterator[None]:
    """Draw in the style of der within a ``with`` block; settings outside stay as they are."""
    with mpl.rc_context(_SETTINGS):
        yield


def wrapped(text: str, points: float, width: float) -> list[str]:
    """Return a title in lines no wider than `width` [inch] at a font size; at most four.

    Write them with ``parse_math=False``: a dollar sign in a title is a dollar sign.
    """
    font = FontProperties(size=points)

    def fits(line: str) -> bool:
        across, _, _ = text_to_path.get_text_width_height_descent(line, font, ismath=False)
        return bool(across <= 72.0 * width)

    # No letter of text is narrower than a quarter of its size, so no line holds more than these.
    most = int(4.0 * 72.0 * width / points)
    text = text[: (_TITLE_LINES + 1) * most]
    for letters in range(max(min(len(text), most), 2), 1, -1):
        lines = textwrap.wrap(text, letters, max_lines=_TITLE_LINES, placeholder="…")
        if all(fits(line) for line in lines):
            break
    return lines


def time_colours(count: int) -> list[ColorType]:
    """Return `count` colours that run from dark (early) to light (late).

    They are taken from viridis, whose lightness rises evenly, without its palest end, which does
    not show on white. A single instant gets the first colour of the palette.
    """
    if count == 1:
        return [PALETTE[0]]
    colour_map = mpl.colormaps["viridis"]
    return [colour_map(0.88 * i / (count - 1)) for i in range(count)]


def axis_label(name: str, unit: str, room: float | None = None) -> str:
    """Return ``name [unit]``, or the name alone for a quantity without a unit.

    Where the axis has a `room` [inch], in lines of at most that, parted after underscores.
    """
    label = f"{name} [{unit}]" if unit not in ("", "1") else name
    if room is None:
        return label
    # A unit stays in one line, with spaces that do not break while it is parted.
    parts = label.replace(unit, unit.replace(" ", _HARD_SPACE)).replace("_", "_ ")
    lines = "\n".join(wrapped(parts, AXIS_LABEL, room))
    return lines.replace("_ ", "_").replace(_HARD_SPACE, " ")


def time_text(seconds: float) -> str:
    """Return a time in as few digits as tell it, such as ``0.05 s``."""
    return f"{seconds:.4g} s"


def quantity_text(value: float, unit: str) -> str:
    """Return a value in three digits with its unit, such as ``2 kN`` or ``6.28 N m``.

    Forces and moments (units that begin with N) take the prefixes of the SI.
    """
    if value == 0.0 or not unit.startswith("N"):
        return f"{value:.3g} {unit}"
    power = int(np.clip(np.floor(np.log10(abs(float(f"{value:.2e}"))) / 3.0), -4, 3))
    prefix = ("p", "n", "µ", "m", "", "k", "M", "G")[power + 4]
    return f"{value / 1000.0**power:.3g} {prefix}{unit}"
