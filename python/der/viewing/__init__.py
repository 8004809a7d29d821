"""Interactive 3D views of results: one HTML file that opens offline in a browser."""

from __future__ import annotations

import base64
import json
import os
import sys
import tempfile
import webbrowser
from pathlib import Path

from der.output_paths import written_whole
from der.run_data import RunData

_FOLDER = Path(__file__).parent
#: The npm package plotly.js-gl3d-dist-min 4.1.1, packed by `gzip -9n`: most of a view.
_PLOTLY = _FOLDER / "plotly-gl3d.min.js.gz"


def view(
    result: RunData, path: str | os.PathLike[str] | None = None, *, open: bool | None = None
) -> Path:
    """Write an interactive view of a result as one HTML file.

    Rods are drawn with their sections as they lie, coloured by a quantity along them; a slider and
    a play button go through the frames. Static runs have the undeformed shape and the equilibrium,
    paths of equilibria their points by branch, and modes vibrate. The file holds all it needs.

    Parameters
    ----------
    result
        A result of ``der.run`` or ``der.open_run``.
    path
        File to write; without it, a temporary one.
    open
        Whether to show it in a browser; unless given, a temporary file on a machine with a screen.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    ValueError
        If the run has nothing to show.
    """
    from der.viewing.payload import make_payload

    text = json.dumps(make_payload(result), separators=(",", ":"), allow_nan=False)
    parts = {
        "STYLE": (_FOLDER / "style.css").read_text(encoding="utf-8"),
        "SCRIPT": (_FOLDER / "view.js").read_text(encoding="utf-8"),
        "PLOTLY": base64.b64encode(_PLOTLY.read_bytes()).decode("ascii"),
        # Within a script element "</script" would end it, and "<!--" change how it ends.
        "DATA": text.replace("<", "\\u003c"),
    }
    page = (_FOLDER / "page.html").read_text(encoding="utf-8")
    for name, part in parts.items():
        page = page.replace("{{" + name + "}}", part, 1)
    file = Path(tempfile.mkdtemp(prefix="der-"), "view.html") if path is None else Path(path)
    with written_whole(file) as partial:
        partial.write_text(page, encoding="utf-8")
    if open or (open is None and path is None and _has_screen()):
        webbrowser.open(file.resolve().as_uri())
    return file


def _has_screen() -> bool:
    """Return whether a browser has a window: one in a terminal would take it away from Python."""
    screens = ("DISPLAY", "WAYLAND_DISPLAY")
    return sys.platform in ("darwin", "win32") or any(map(os.environ.get, screens))
