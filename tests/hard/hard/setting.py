"""The model, the stepper and the value that a case is tried with, and scenes written for them."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import der
import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Scene = dict[str, Any]

MODELS = ("planar", "spatial_bend", "spatial")

#: How the plane of a case lies in space: no axis of it is one of the scene's.
_POSE, _ = np.linalg.qr(np.array([[2.0, 1.0, -1.0], [1.0, -2.0, 1.0], [1.0, 2.0, 2.0]]))
_POSE[:, 2] = np.cross(_POSE[:, 0], _POSE[:, 1])
_TURN = np.array([[0.8, -0.6], [0.6, 0.8]])  # and in a planar scene


@dataclasses.dataclass(frozen=True)
class Setting:
    """The setting that a case is tried in.

    Cases are thought in a plane with the coordinates x and y. In the scene their axes are inclined,
    and so is the plane in the models of space, so that nothing is 0 or exact by chance: `vector`
    and its like lead there, `in_plane` back.
    """

    model: str
    stepper: der.StepperInfo | None
    label: str
    value: Any
    long: bool

    @property
    def planar(self) -> bool:
        return self.model == "planar"

    @property
    def implicit(self) -> bool:
        return self.stepper is not None and self.stepper.implicit

    @property
    def order(self) -> int:
        """Order of the stepper; 2 where it has more, since stiff parts reduce it to that."""
        assert self.stepper is not None
        return min(self.stepper.order, 2)

    @property
    def name(self) -> str:
        parts = [self.label, self.model, self.stepper.name if self.stepper else ""]
        return ", ".join(part for part in parts if part)

    # -- where things are -------------------------------------------------------------------------

    def vector(self, x: float, y: float) -> list[float]:
        return self.vectors([[x, y]])[0]

    def vectors(self, plane: ArrayLike) -> list[list[float]]:
        """Vectors of the case's plane, shape (n, 2), as the scene has them."""
        given = np.asarray(plane, float)
        return (given @ self._columns.T).tolist()  # type: ignore[no-any-return]

    def in_plane(self, vectors: ArrayLike) -> Array:
        """Vectors of the scene, shape (..., dim), in the case's axes, shape (..., 3)."""
        given = np.asarray(vectors, float)
        if self.planar:
            turned = given @ _TURN
            return np.concatenate([turned, np.zeros((*given.shape[:-1], 1))], axis=-1)
        return np.asarray(given @ _POSE)

    @property
    def _columns(self) -> Array:
        """The case's axes x and y in those of the scene, shape (dim, 2)."""
        return _TURN if self.planar else _POSE[:, :2]

    def about_z(self, size: float) -> Any:
        """A moment about the axis across the case's plane."""
        return size if self.planar else (size * _POSE[:, 2]).tolist()

    @property
    def axes(self) -> list[str]:
        return ["x", "y"] if self.planar else ["x", "y", "z"]

    # -- supports ---------------------------------------------------------------------------------

    @property
    def clamp(self) -> Scene:
        """A clamp; without its grip on the section where the model does not have it."""
        return {"clamp": "tangent" if self.model == "spatial_bend" else True}

    @property
    def pin(self) -> Scene:
        return {"fix": self.axes}

    def moved(self, x: Any) -> Scene:
        """A displacement of a support, a number or a table, along the case's x axis."""
        along = self._columns[:, 0]
        return {axis: _scaled(x, part) for axis, part in zip("xyz", along, strict=False)}

    def turned(self, angle: Any) -> Scene:
        """A rotation of a clamp in the case's plane."""
        if self.planar:
            return {"angle": angle}
        return {"rotation": {"axis": _POSE[:, 2].tolist(), "angle": angle}}

    # -- rods and runs ----------------------------------------------------------------------------

    def rod(self, points: ArrayLike, **more: Any) -> Scene:
        """A rod through these places of the plane, EA = 1e4, all else 1; stiffnesses in `more`."""
        stiffness = {"EA": 1e4, "EI": 1.0, "GJ": 1.0, "mass_per_length": 1.0}
        stiffness |= {key: more.pop(key) for key in tuple(stiffness) if key in more}
        spin = more.pop("rotary_inertia", None)
        if spin is not None and self.model == "spatial":
            stiffness["rotary_inertia"] = spin
        return {
            "name": "rod",
            "points": self.vectors(points),
            "cross_section": {"stiffness": stiffness},
            **more,
        }

    def scene(self, rod: Scene, supports: Sequence[Scene] = (), **more: Any) -> Scene:
        """A scene of the model; `supports` without the name of the rod."""
        return {
            "model": self.model,
            "rods": [rod],
            "supports": [{"rod": rod["name"], **support} for support in supports],
            **({"analysis": "static"} if "time" not in more else {}),
            **more,
        }

    def time(self, duration: float, steps: int) -> Scene:
        """Equal steps; with an explicit stepper the longest stable ones."""
        assert self.stepper is not None
        step: float | str = duration / steps if self.stepper.implicit else "auto"
        return {"duration": duration, "step": step, "integrator": self.stepper.name}

    def time_in(self, step: float, steps: int) -> Scene:
        """Equal steps with every stepper."""
        assert self.stepper is not None
        return {"duration": step * steps, "step": step, "integrator": self.stepper.name}

    def time_error(self, rate: float, duration: float, steps: int) -> float:
        """Relative error of a motion of this rate [rad/s] in equal steps, by the order."""
        turn = rate * duration
        return float((turn / steps) ** self.order * turn)


def _scaled(value: Any, factor: float) -> Any:
    """A number, or a table, times a factor."""
    if isinstance(value, dict):
        return {**value, "values": [float(factor) * v for v in value["values"]]}
    return float(factor) * value


#: Why a rod at rest may be said to be unstable.


def tip_force(setting: Setting, x: float, y: float) -> Scene:
    return {"point_force": {"rod": "rod", "at": "end", "force": setting.vector(x, y)}}


def line(nodes: int, length: float = 1.0) -> Array:
    """Nodes evenly along x."""
    return np.column_stack([np.linspace(0.0, length, nodes), np.zeros(nodes)])


def final(result: der.Result, setting: Setting) -> Array:
    """The last shape in the case's axes, shape (nodes, 3)."""
    return setting.in_plane(result.positions[-1])
