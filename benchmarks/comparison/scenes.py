"""The scenes; each code can run all of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from comparison.scene import Path
from comparison.strip import problem as strip
from comparison.swing import problem as swing


@dataclass(frozen=True)
class Scene:
    """A scene; its adapters are the modules ``comparison.KEY.code_*``."""

    key: str  # on the command line, and its folder
    reference: Callable[[], Path]


SCENES = {
    scene.key: scene
    for scene in (
        Scene("swing", swing.reference),
        Scene("strip", strip.reference),
    )
}
