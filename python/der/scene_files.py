"""The scenes that come with der."""

from __future__ import annotations

from pathlib import Path


def scene_file(name: str) -> Path:
    """Return the file of a scene that comes with der, such as ``simply_supported``.

    There is one source, ``configs/`` of the checkout; installing der copies it beside the package.
    A package that is used from its checkout (an editable installation) reads ``configs/`` itself.

    Raises
    ------
    FileNotFoundError
        If there is no such scene.
    """
    here = Path(__file__)
    for folder in (here.parent / "scenes", here.resolve().parents[2] / "configs"):
        path = folder / f"{name}.yaml"
        if path.is_file():
            return path
    raise FileNotFoundError(
        f"the scene '{name}' is not among those that come with der: looked in "
        f"{here.parent / 'scenes'} and in configs/ of a checkout; install der again"
    )
