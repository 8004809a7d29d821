"""Scenes as Python takes them: by path, by the name of an example, as mappings, with other values.

`Scenario` is a class of the engine; its methods that take such things are written here.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np

from der._core import Model, Scenario, Simulation
from der.examples import scene_path
from der.html import card

#: A scenario, the path of a scene file or ``example:NAME``, or a mapping with the keys of a file.
SceneLike: TypeAlias = "Scenario | str | os.PathLike[str] | Mapping[str, Any]"

_load_file, _with_values = Scenario.load, Scenario.with_


def load(scene: SceneLike, overrides: Mapping[str, Any] | None = None, /, **more: Any) -> Scenario:
    """Read and validate a scene, with some values replaced or added.

    Parameters
    ----------
    scene
        The path of a scene file, ``"example:NAME"`` for one of `der.examples`, a mapping with the
        keys of a scene file, or a scenario.
    overrides
        Values by their key paths, as `Scenario.with_` takes them.
    **more
        The same as keyword arguments.

    Returns
    -------
    Scenario
        The validated scene.

    Raises
    ------
    SceneError
        If the scene is not valid, with every diagnostic.
    FileNotFoundError
        If no example has that name.
    TypeError
        If it is no scene.

    Examples
    --------
    >>> der.load("configs/cantilever.yaml", {"rods.arm.nodes": 101})
    >>> der.load("example:finger")
    """
    values = _values(overrides, more)
    if isinstance(scene, (str, os.PathLike)):
        return _load_file(scene_path(os.fspath(scene)), **values)
    if isinstance(scene, Mapping):
        scene = Scenario.from_dict(dict(scene))
    if not isinstance(scene, Scenario):
        raise TypeError(
            "expected a Scenario, the path of a scene file, or a dict with its keys, got "
            f"{scene!r} ({type(scene).__name__})"
        )
    return _with_values(scene, **values) if values else scene


def with_(self: Scenario, overrides: Mapping[str, Any] | None = None, /, **more: Any) -> Scenario:
    """Return the same scene with some values replaced or added, validated again.

    Parameters
    ----------
    overrides
        Values by their key paths, which name mappings by key, and list items by `name` or number.
        Values are numbers, texts, lists, dicts, NumPy scalars and arrays.
    **more
        The same as keyword arguments.

    Raises
    ------
    SceneError
        If a path leads nowhere, or the scene is not valid any more.

    Examples
    --------
    >>> scenario.with_({"rods.beam.nodes": 101, "loads.0.gravity": [0, -1.6]})
    """
    return _with_values(self, **_values(overrides, more))


def _values(overrides: Mapping[str, Any] | None, more: dict[str, Any]) -> dict[str, Any]:
    if overrides is None:
        return more
    if not isinstance(overrides, Mapping):
        raise TypeError(
            'values are given by their key paths, such as {"rods.beam.nodes": 101}, not by '
            f"{overrides!r}"
        )
    return dict(**overrides, **more)


def _repr_html_(self: Scenario) -> str:
    from der.plotting import plot_states  # here, because matplotlib takes long to load

    model = Model(self)
    asked = self.analysis if self.is_static else f"motion of {self.duration:g} s"
    facts = f"{asked}, {model.num_nodes} nodes, model {model.name}: {model.reason}"
    rods = [(rod.name, str(len(rod.nodes)), f"{rod.length:.6g}") for rod in model.rods]
    return card(
        self.title,
        facts,
        lambda: plot_states(
            self,
            model.initial_positions[np.newaxis],
            ["as drawn"],
            directors=Simulation(self).directors[np.newaxis] if model.name == "spatial" else None,
            title="",
        ),
        [[("rod", "nodes", "length [m]"), *rods]],
        self.to_yaml(),
    )


Scenario.load = staticmethod(load)  # type: ignore[method-assign]
Scenario.with_ = with_  # type: ignore[method-assign]
Scenario._repr_html_ = _repr_html_  # type: ignore[attr-defined]
