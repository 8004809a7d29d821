"""The scenes, and the codes that can run them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from comparison.codes import DER, DISMECH, EXUDYN, MUJOCO, PYELASTICA, Code
from comparison.scene import Path
from comparison.strip import problem as strip
from comparison.swing import problem as swing


@dataclass(frozen=True)
class Scene:
    """A scene; its adapters are the modules ``comparison.KEY.code_*``."""

    key: str  # on the command line, and its folder
    codes: tuple[Code, ...]  # the first is the one that the others are compared with
    reference: Callable[[], Path]


SCENES = {
    scene.key: scene
    for scene in (
        Scene("swing", (DER, EXUDYN, MUJOCO, PYELASTICA), swing.reference),
        Scene("strip", (DER, EXUDYN, MUJOCO, PYELASTICA, DISMECH), strip.reference),
    )
}
