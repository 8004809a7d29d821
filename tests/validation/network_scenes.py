"""Parts of scenes with joints, in the plane and in space, and what their runs end with."""

from __future__ import annotations

from typing import Any

import der

Scene = dict[str, Any]


def at(name: str, place: Any, **more: Any) -> Scene:
    return {"rod": name, "at": place, **more}


def joint(name: str, *members: Scene, **more: Any) -> Scene:
    return {"name": name, "of": list(members), **more}


def force(name: str, place: Any, *components: float, **more: Any) -> Scene:
    return {"point_force": at(name, place, force=list(components), **more)}


def clamp(name: str, place: Any, **more: Any) -> Scene:
    return at(name, place, clamp=True, **more)


def scene_of(
    rods: list[Scene], joints: list[Scene], supports: list[Scene], loads: list[Scene]
) -> Scene:
    return {"rods": rods, "joints": joints, "supports": supports, "loads": loads}


def final(scene: Scene, **changes: Any) -> dict[str, float]:
    """Return what the probes of a run over time end with."""
    result = der.run(der.Scenario.from_dict(scene).with_(**changes))
    assert result.status == "completed"
    return {name: float(values[-1]) for name, values in result.probes.items()}
