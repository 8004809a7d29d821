"""The scenes that come with the package, by name: those of the folder ``configs/``."""

from __future__ import annotations

from pathlib import Path

from der._core import Scenario

#: What the name of an example begins with where a scene file could stand.
PREFIX = "example:"

_FOLDER = Path(__file__).parent / "scenes"


def examples() -> dict[str, str]:
    """Return the title of each scene that comes with the package, by its name.

    ``der.load("example:NAME")`` loads one, and so does everything that takes the path of a scene
    file.

    Examples
    --------
    >>> der.examples()["finger"]
    'A soft finger closes and opens'
    """
    return {path.stem: Scenario.load(path).title for path in sorted(_FOLDER.glob("*.yaml"))}


def scene_path(text: str) -> str:
    """Return the path of the file of ``example:NAME``; any other text as it is.

    Raises
    ------
    FileNotFoundError
        If no example has that name.
    """
    if not text.startswith(PREFIX):
        return text
    name = text.removeprefix(PREFIX)
    path = _FOLDER / f"{name}.yaml"
    if not path.is_file():
        known = ", ".join(sorted(path.stem for path in _FOLDER.glob("*.yaml")))
        raise FileNotFoundError(f"there is no example {name!r}; there are {known}")
    return str(path)
