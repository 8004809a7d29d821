"""The tables of the report: as they are printed, and with all digits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from references.falling_spheres import FallingRod

from . import exact
from .comparison import Row
from .exact import LOAD_AT
from .measurements import LOADS, Deflection, Measurements, command_of, scene_of
from .numbers_as_text import digits_within, error_bar_text, number, percent

_EXACT_DIGITS = 8  # where nothing says how many tell

#: The parameters: what each is, its unit, and the path to it in the tree of a scene.
_PARAMETERS = (
    ("Nodes", "", "rods.0.nodes"),
    ("Length of the rod", "m", "rods.0.to.0"),
    (
        "Radius of the section, of the tube from inside to outside",
        "m",
        "rods.0.cross_section",
    ),
    ("Young's modulus", "Pa", "rods.0.material.youngs_modulus"),
    ("Density of the rod", "kg/m^3", "rods.0.material.density"),
    ("Radius of the small spheres", "m", "rods.0.spheres.0.radius"),
    ("Radius of the middle sphere", "m", "rods.0.spheres.1.radius"),
    ("Density of the spheres", "kg/m^3", "rods.0.spheres.0.density"),
    ("Gravity, downward", "m/s^2", "loads.gravity"),
    ("Viscosity of the fluid", "Pa s", "loads.fluid.viscosity"),
    ("Density of the fluid; 0: no buoyancy", "kg/m^3", "loads.fluid.density"),
    ("Force, downward", "N", "loads.point_force.force"),
    ("Place of the force along the rod", "m", "loads.point_force.at"),
    ("Time step, implicit", "s", "time.step"),
    ("Duration", "s", "time.duration"),
)


def parameters() -> list[list[str]]:
    """Return the rows of the parameters: name, unit, and a cell for each problem."""
    trees = [scene_of(name).to_dict() for name in ("three", "twenty_one", "beam")]
    for tree in trees:  # the rods start at 0, and no kind of load is there twice
        tree["loads"] = {kind: load for loads in tree["loads"] for kind, load in loads.items()}
    return [
        [name, unit, *(_cell(tree, path) for tree in trees)] for name, unit, path in _PARAMETERS
    ]


def _cell(tree: Any, path: str) -> str:
    for key in path.split("."):
        tree = tree[int(key)] if isinstance(tree, list) else tree.get(key)
        if tree is None:
            return "-"
    if isinstance(tree, list):  # a vector downward
        return f"{-tree[1]:g}"
    if isinstance(tree, dict):  # a section
        (section,) = tree.values()
        return " to ".join(f"{section[key]:g}" for key in sorted(section))
    return f"{tree:g}"


def comparison_cells(row: Row) -> list[str]:
    """Return a row of the comparison as it is printed."""
    digits, exact_digits = row.digits, _EXACT_DIGITS
    if row.ours is not None and row.error_bar is not None:
        digits = digits_within(row.ours, row.error_bar)
        exact_digits = digits + 1  # so that it shows where in the bar the exact value is
    return [
        row.quantity,
        row.unit,
        row.report or "-",
        "-" if row.ours is None else number(row.ours, digits),
        "-" if row.error_bar is None else error_bar_text(row.error_bar),
        "-" if row.exact is None else number(row.exact, exact_digits),
        row.remark,
    ]


def deflections_by_load(m: Measurements) -> list[tuple[float, Deflection, float, float]]:
    """Return load, ours, exact and linear deflection, row by row."""
    true = m.exact_beams[LOAD_AT]
    return [
        (load, m.deflections[load], true[load].largest, exact.linear_deflection(load))
        for load in LOADS
    ]


def deflection_cells(m: Measurements) -> list[list[str]]:
    """Return deflection against load, as it is printed."""
    return [
        [
            number(load, 1 if load < 1e4 else 2),
            number(ours.value, digits_within(ours.value, ours.error_bar)),
            error_bar_text(ours.error_bar),
            number(true, _EXACT_DIGITS),
            number(linear, _EXACT_DIGITS),
            percent(ours.value / true - 1.0),
            percent(linear / true - 1.0),
        ]
        for load, ours, true, linear in deflections_by_load(m)
    ]


def data_files(m: Measurements, rows: Sequence[Row]) -> dict[str, list[Sequence[object]]]:
    """Return the tables of ``data/`` by name, with all digits, heads first."""
    speeds = [
        *(("nodes", n, n, 0.01, d, v) for (n, d), v in m.speeds_by_nodes.items()),
        *(("step", s, 21, s, d, v) for (s, d), v in m.speeds_by_step.items()),
    ]
    return {
        "comparison": [
            Row._fields[:-1],  # all but the digits to print
            *(row[:-1] for row in rows),
        ],
        "deflection_by_load": [
            ["load_N", "ours_m", "error_bar_m", "exact_m", "euler_bernoulli_m", "command"],
            *(
                [load, *ours, true, linear, command_of(("load", load))]
                for load, ours, true, linear in deflections_by_load(m)
            ),
        ],
        "terminal_speeds": [
            ["nodes", "step_s", "fluid_density_kg_m3", "ours_m_s", "terminal_m_s", "command"],
            *(
                [nodes, step, density, speed, balance, command_of((varied, value, density))]
                for varied, value, nodes, step, density, speed in speeds
                for balance in (exact.terminal_speed(FallingRod(nodes, density)),)
            ),
        ],
    }
