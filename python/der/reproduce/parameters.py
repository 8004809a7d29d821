"""The parameters of the report's three problems, as the scenes of `configs/` have them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from der._core import Scenario
from der.reproduce.content import Table
from der.scene_files import scene_file

Tree = dict[str, Any]

_SCENES = ("falling_beam_3", "falling_beam_21", "simply_supported")
_NONE = "-"


def parameters_table() -> Table:
    """Return the parameters, a column for each problem, read from its scene."""
    trees = [Scenario.load(scene_file(name)).to_dict() for name in _SCENES]
    return Table(
        caption="Parameters of the runs. Problem 2 is shown for 21 nodes; with another number the "
        "small spheres have a tenth of an edge for their radius. The explicit scheme takes steps "
        "of 0.00001 s, and 0.0001 s where it blows up.",
        columns=["Parameter", "Unit", "Problem 1", "Problem 2", "Problem 3"],
        align=["left", "left", "right", "right", "right"],
        rows=[[name, unit, *(read(tree) for tree in trees)] for name, unit, read in _ROWS],
    )


def _rod(tree: Tree) -> Tree:
    rod: Tree = tree["rods"][0]
    return rod


def _length(tree: Tree) -> str:
    return f"{_rod(tree)['to'][0] - _rod(tree)['from'][0]:g}"


def _radii(tree: Tree) -> str:
    section = _rod(tree)["cross_section"]
    if "tube" in section:
        return f"{section['tube']['inner_radius']:g} to {section['tube']['outer_radius']:g}"
    return f"{section['circle']['radius']:g}"


def _sphere(number: int, key: str) -> Callable[[Tree], str]:
    def read(tree: Tree) -> str:
        spheres = _rod(tree).get("spheres", [])
        return f"{spheres[number][key]:g}" if spheres else _NONE

    return read


def _material(key: str) -> Callable[[Tree], str]:
    return lambda tree: f"{_rod(tree)['material'][key]:g}"


def _load(kind: str, key: str | None = None) -> Callable[[Tree], str]:
    def read(tree: Tree) -> str:
        for load in tree["loads"]:
            if kind in load:
                value = load[kind] if key is None else load[kind][key]
                return f"{-value[1]:g}" if isinstance(value, list) else f"{value:g}"
        return _NONE

    return read


_ROWS: tuple[tuple[str, str, Callable[[Tree], str]], ...] = (
    ("Nodes", "", lambda tree: str(_rod(tree)["nodes"])),
    ("Length of the rod", "m", _length),
    ("Radius of the section, of the tube from inside to outside", "m", _radii),
    ("Young's modulus", "Pa", _material("youngs_modulus")),
    ("Density of the rod", "kg/m^3", _material("density")),
    ("Radius of the small spheres", "m", _sphere(0, "radius")),
    ("Radius of the middle sphere", "m", _sphere(1, "radius")),
    ("Density of the spheres", "kg/m^3", _sphere(0, "density")),
    ("Gravity, downward", "m/s^2", _load("gravity")),
    ("Viscosity of the fluid", "Pa s", _load("fluid", "viscosity")),
    ("Density of the fluid; 0: no buoyancy", "kg/m^3", _load("fluid", "density")),
    ("Force, downward", "N", _load("point_force", "force")),
    ("Place of the force along the rod", "m", _load("point_force", "at")),
    ("Time step, implicit", "s", lambda tree: f"{tree['time']['step']:g}"),
    ("Duration", "s", lambda tree: f"{tree['time']['duration']:g}"),
)
