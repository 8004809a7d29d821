"""The rods of a player as a page shows them, and the mouse that pulls them.

On the stage lengths count against the size of the structure, from its middle.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from der._core import held_nodes
from der.playing.player import Player
from der.playing.tube import Tube, rgb
from der.plotting.style import LOAD
from der.scene_loads import value_at

Array: TypeAlias = NDArray[np.float64]
#: Takes what a visitor asks for; it is done between two frames.
Put: TypeAlias = Callable[[Callable[[], object]], None]

_SUPPORT, _HANDLE = 0.05, 0.015
_DISTANCE, _FIELD = 2.2, np.radians(40.0)  # of the camera, and what it sees in height
_BELOW, _BEHIND = 0.3, 0.1  # where the grid is, in space and in the plane
_GREY = "#9aa3ad"


class Stage:
    """The view of a player on a page, beside its panel."""

    def __init__(self, server: Any, player: Player, put: Put) -> None:
        self._player, self._put = player, put
        scene, simulation, rods = server.scene, player.simulation, player.simulation.model.rods
        points = _in_space(simulation.positions)
        reach = max(float(rod.sphere_radii.max(initial=rod.radius)) for rod in rods)
        low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
        self._size, self._middle = float(np.max(high - low)), 0.5 * (low + high)
        #: Length of a cell of the grid [m].
        self.cell = float(f"{10.0 ** np.floor(np.log10(0.6 * self._size)):.0e}")
        sections = [rod["cross_section"] for rod in simulation.scenario.to_dict()["rods"]]
        self._tubes = [
            Tube(scene, rod, section, self._size, simulation.model.name)
            for rod, section in zip(rods, sections, strict=True)
        ]
        #: How many times as thick as it is a rod is shown, at most.
        self.magnified = max(tube.magnified for tube in self._tubes)
        for mesh in (mesh for tube in self._tubes for mesh in tube.meshes):
            mesh.on_drag("left")(self._on_drag)
        self._held = {
            held.node: scene.add_box(f"/held/{held.node}", rgb(_GREY), (_SUPPORT,) * 3)
            for held in held_nodes(simulation.scenario)
        }
        self._hand = scene.add_icosphere("/hand", _HANDLE, rgb(LOAD))
        self._pull = scene.add_line_segments(
            "/pull", np.zeros((1, 2, 3)), rgb(LOAD), thickness=3.0, thickness_units="screen"
        )
        self._look(server, self._on_stage(low))

    def show(self) -> None:
        """Show the present state."""
        points = self._on_stage(_in_space(self._player.simulation.positions))
        directors, first = self._player.simulation.directors, 0
        for tube in self._tubes:
            line = points[tube.rod.line_nodes]
            tube.show(line, directors[first : first + len(line) - 1])
            first += len(line) - 1
        for node, box in self._held.items():
            box.position = points[node]
        pulled = self._player.pulled
        self._hand.visible = self._pull.visible = pulled is not None
        if pulled is not None:
            self._hand.position = target = self._on_stage(_in_space(pulled[1]))
            self._pull.points = np.array([[points[pulled[0]], target]])

    async def _on_drag(self, event: Any) -> None:  # async: what comes later is done later
        player, dimension = self._player, self._player.simulation.model.dimension
        ends = np.array([event.start_position, event.end_position]) * self._size + self._middle
        grabbed, to = ends[:, :dimension]
        if event.phase == "start":
            self._put(lambda: player.grab(grabbed))
        self._put(player.release if event.phase == "end" else lambda: player.drag(to))

    def _on_stage(self, points: Array) -> Array:
        return np.asarray((points - self._middle) / self._size)

    def _look(self, server: Any, low: Array) -> None:
        """Place the camera, and a grid: in the plane behind the rods, in space below them."""
        if self._player.simulation.model.dimension == 2:
            up, towards, plane = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), "xy"
            place = -_BEHIND * towards
        else:
            up = _upwards(self._player.simulation.scenario.to_dict())
            axis, upright = int(np.argmax(np.abs(up))), np.abs(up)
            towards = up + 2.5 * np.roll(upright, 2) + np.roll(upright, 1)
            plane, place = ("yz", "xz", "xy")[axis], low * upright - _BELOW * up
        server.scene.set_up_direction(up)
        # Light from surroundings takes seconds to load, and shadows are for graphics processors.
        server.scene.configure_environment_map(None)
        server.scene.configure_default_lights(cast_shadow=False)
        server.scene.add_light_ambient("/light", intensity=1.5)
        camera = server.initial_camera
        camera.up, camera.fov, camera.look_at = up, _FIELD, np.zeros(3)
        camera.position = _DISTANCE * towards / np.linalg.norm(towards)
        cell = self.cell / self._size
        lines = {"cell_size": cell, "section_size": 5.0 * cell, "fade_distance": 4.0 * _DISTANCE}
        server.scene.add_grid("/grid", plane=plane, infinite_grid=True, position=place, **lines)


def _in_space(points: Array) -> Array:
    """Return points with z; those in the plane have z = 0."""
    return np.concatenate([points, np.zeros((*points.shape[:-1], 3 - points.shape[-1]))], axis=-1)


def _upwards(scene: dict[str, Any]) -> Array:
    """Return the axis against gravity at the start, or z."""
    for load in scene.get("loads") or []:
        if "gravity" in load and np.any(gravity := value_at(load["gravity"], 0.0)):
            axis = int(np.argmax(np.abs(gravity)))
            return np.asarray(-np.sign(gravity[axis]) * np.eye(3)[axis])
    return np.array([0.0, 0.0, 1.0])
