"""The page: the text of ``report.html`` with its numbers, tables and pictures."""

from __future__ import annotations

import base64
import io
import platform
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from html import escape
from pathlib import Path
from string import Template

import der
import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import scipy
from der.plotting import style
from matplotlib.figure import Figure
from references.falling_spheres import FallingRod

from . import beam_figures, exact, tables
from . import falling_figures as falling
from .comparison import Row
from .exact import LOAD_AT
from .measurements import NODES, WATER, Measurements
from .numbers_as_text import duration, number, percent

#: The pictures by name, in the order of the page.
FIGURES: Mapping[str, Callable[[Measurements], Figure]] = {
    "figure_01_initial_configuration": falling.initial_configuration,
    "figure_02_shapes": falling.shapes,
    "figure_03_displacement": partial(falling.over_time, probe="y_mid"),
    "figure_04_velocity": partial(falling.over_time, probe="v_mid"),
    "figure_05_equal_spheres_angle": falling.equal_spheres_angle,
    "extra_schemes": falling.schemes,
    "figure_06_unstable_angle": partial(falling.blow_up, probe="angle"),
    "figure_07_unstable_velocity": partial(falling.blow_up, probe="v_mid"),
    "figure_08_unstable_displacement": partial(falling.blow_up, probe="y_mid"),
    "figure_09_five_shapes": lambda m: falling.chain_shapes(m, "five", "5 nodes", (10.0,)),
    "figure_10_five_velocity": lambda m: falling.chain_velocity(m, "five", "5 nodes", "three"),
    "figure_11_twenty_one_displacement": partial(falling.both_densities, probe="y_mid"),
    "figure_12_twenty_one_velocity": partial(falling.both_densities, probe="v_mid"),
    "figure_13_twenty_one_shapes": (
        lambda m: falling.chain_shapes(m, "twenty_one", "21 nodes", (10.0, 50.0))
    ),
    "figure_14_twenty_one_over_three": (
        lambda m: falling.chain_velocity(m, "twenty_one", "21 nodes", "three_long")
    ),
    "figure_15_fifty_one_over_twenty_one": falling.fifty_one_over_twenty_one,
    "figure_16_terminal_speed_by_step": falling.terminal_by_step,
    "extra_terminal_speed_by_nodes": falling.terminal_by_nodes,
    "figure_17_loaded_beam": beam_figures.loaded_beam,
    "figure_18_deflection_history": beam_figures.deflection_history,
    "extra_deflection_by_load": beam_figures.deflection_by_load,
}
_TEXT = Path(__file__).with_name("report.html")
#: A number and its unit, which stay on one line.
_QUANTITY = re.compile(r"(?<=\d)\s(?=(?:m|s|ms|mm|m/s|N|kN|Pa|rad|nodes)\b)")


def draw(m: Measurements) -> dict[str, bytes]:
    """Return all pictures as PNG, by name."""
    pictures = {}
    for name, drawing in FIGURES.items():
        file = io.BytesIO()
        with style():
            figure = drawing(m)
            # Without the version of Matplotlib, so that the same picture is the same file.
            figure.savefig(file, metadata={"Software": None})
        plt.close(figure)
        pictures[name] = file.getvalue()
    return pictures


def page(m: Measurements, rows: Sequence[Row], pictures: Mapping[str, bytes]) -> str:
    """Return the page, which needs no other file."""
    text = Template(_TEXT.read_text(encoding="utf-8")).substitute(
        _falling(m),
        **_tube(m),
        comparison=_rows((tables.comparison_cells(row) for row in rows), "llrrrrl"),
        parameters=_rows(tables.parameters(), "llrrr"),
        deflections=_rows(tables.deflection_cells(m), "rrrrrrr"),
        commands=_commands(rows),
        versions=f"der {der.__version__}, Python {platform.python_version()}, "
        f"NumPy {np.__version__}, SciPy {scipy.__version__}, Matplotlib {mpl.__version__}",
        **{name: f"@{name}@" for name in pictures},
    )
    text = _QUANTITY.sub("\u00a0", text)
    for name, png in pictures.items():
        data = base64.b64encode(png).decode("ascii")
        text = text.replace(f"@{name}@", f"data:image/png;base64,{data}")
    return text


def _rows(rows: Iterable[Sequence[str]], sides: str) -> str:
    """Return rows of a table; numbers are flush right."""
    names = {"l": "left", "r": "right"}
    return "\n".join(
        "<tr>"
        + "".join(
            f'<td class="{names[side]}">{_text(cell)}</td>'
            for cell, side in zip(row, sides, strict=True)
        )
        + "</tr>"
        for row in rows
    )


def _commands(rows: Sequence[Row]) -> str:
    """Return the commands that print numbers of the comparison, as items of a list."""
    names: dict[str, list[str]] = {}
    for row in rows:
        if row.command:
            names.setdefault(row.command, []).append(row.quantity)
    items = (f"`{command}`: {'; '.join(of)}" for command, of in names.items())
    return "\n".join(f"<li>{_text(item)}</li>" for item in items)


def _text(text: str) -> str:
    """Return text, with `code` in backticks, as HTML."""
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", escape(text, quote=False))


def _falling(m: Measurements) -> dict[str, str]:
    """Return the numbers in the text of problems 1 and 2."""
    three, explicit = m.runs["three"], m.runs["three_explicit"]
    motion, fastest = m.exact_falls["three"], three.summary["probes"]["v_mid"]
    apart = {
        probe: float(np.abs(three.probes[probe] - explicit.probes[probe])[1:].max())
        for probe in ("y_mid", "angle")
    }
    unstable = m.runs["three_unstable"].summary
    dry, wet, chain = FallingRod(21, 0.0), FallingRod(21, WATER), FallingRod(3, WATER)
    finer, coarse = m.runs["fifty_one"].summary["probes"], m.runs["twenty_one"].summary["probes"]
    apart_51, apart_speed_51 = (
        abs(finer[probe]["final"] / coarse[probe]["final"] - 1.0) for probe in ("y_mid", "v_mid")
    )
    balance = exact.terminal_speed(dry)
    return {
        "speed_3_dry": number(-float(m.runs["three_dry"].probes["v_mid"][-1]), 4),
        "end_3": number(-float(exact.fallen(motion)[-1])),
        "end_speed_3": number(float(exact.speed(motion)[-1])),
        "fastest_3": number(-float(fastest["min"])),
        "fastest_at_3": number(float(fastest["t_min"]), 2),
        "terminal_3": number(exact.terminal_speed(chain), 5),
        "angle_equal": number(float(np.abs(m.runs["three_equal"].probes["angle"]).max()), 2),
        "explicit_steps": f"{int(explicit.summary['steps']):,}",
        "implicit_steps": f"{int(three.summary['steps']):,}",
        "explicit_seconds": duration(m.explicit_seconds),
        "implicit_seconds": duration(m.implicit_seconds),
        "apart_3": number(apart["y_mid"], 2),
        "apart_angle_3": number(apart["angle"], 2),
        "stable_step": number(m.stable_step),
        "unstable_steps": f"{int(unstable['steps'])}",
        "unstable_speed": number(float(unstable["probes"]["v_mid"]["max"]), 2),
        "terminal_21_dry": number(balance, 5),
        "terminal_21": number(exact.terminal_speed(wet), 5),
        "small_radius_21": number(1e3 * float(dry.radii()[0]), 2),
        "apart_51": percent(apart_51),
        "apart_speed_51": percent(apart_speed_51),
        "off_10s": percent(m.speeds_by_step[10.0, 0.0] / balance - 1.0),
        "fewest": str(NODES[0]),
        "few": str(NODES[2]),
        "most": str(NODES[-1]),
        "many_nodes_speed": number(exact.many_nodes_speed(chain), 5),
        "lone_sphere_speed": number(exact.lone_sphere_speed(chain), 5),
        "inside": str(next(n for n in NODES if FallingRod(n).edge < chain.middle_radius)),
    }


def _tube(m: Measurements) -> dict[str, str]:
    """Return the numbers in the text of problem 3."""
    true = m.exact_beams[LOAD_AT]
    peak = -float(m.runs["beam_swing"].summary["probes"]["middle"]["min"])
    good = max(
        load
        for load, ours, exactly, linear in tables.deflections_by_load(m)
        if linear - exactly < abs(ours.value - exactly)
    )
    gaps = (one.shooting_gap for beam in m.exact_beams.values() for one in beam.values())
    return {
        "middle_2kN": number(m.middles[2000.0].value, 5),
        "middle_20kN": number(m.middles[20000.0].value, 5),
        "largest_2kN": number(m.deflections[2000.0].value, 5),
        "swing": number(peak, 2),
        "swing_ratio": number(peak / true[2000.0].middle, 2),
        "good": number(good),
        "linear_20kN": percent(exact.linear_deflection(20000.0) / true[20000.0].largest - 1.0),
        "shooting_gap": number(max(gaps), 2),
    }
