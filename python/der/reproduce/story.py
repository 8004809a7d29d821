"""The text of the reproduction: its sections, figures and captions."""

from __future__ import annotations

import platform
from collections.abc import Callable, Sequence
from functools import partial

import matplotlib as mpl
import numpy as np
import scipy
from matplotlib.figure import Figure

from der._core import __version__
from der.reproduce import beam_figures, falling_figures
from der.reproduce.beam_exact import Tube, euler_bernoulli_deflection
from der.reproduce.content import Bullets, Document, Paragraph, Picture, Section
from der.reproduce.falling_exact import FallingChain
from der.reproduce.measurements import LOADS, NODES, WATER, Measurements
from der.reproduce.numbers_as_text import duration, number, percent
from der.reproduce.parameters import parameters_table
from der.reproduce.quantities import Quantity, comparison_table, deflection_table


def write_story(m: Measurements, rows: Sequence[Quantity]) -> Document:
    """Return the document.

    Parameters
    ----------
    m
        The measured data.
    rows
        The comparison.
    """
    return Document(
        title="The course report, reproduced",
        lead=[
            Paragraph(
                "A course report on falling and loaded rods is where this project began. Here are "
                "its three problems once more: every figure, and every number beside ours and "
                "beside the exact one. Two things decide what a number is worth: whether it solves "
                "the problem as stated, and how far it is from the exact solution. Both are looked "
                "at here."
            ),
            Paragraph(
                "`der reproduce` ran all of this again, the exact solutions included. Nothing but "
                "the report's own numbers was written down beforehand."
            ),
        ],
        sections=[
            Section("The numbers", [comparison_table(rows)]),
            Section("The parameters", [parameters_table()]),
            _three_nodes(m),
            _many_nodes(m),
            _tube(m),
            _how(rows),
        ],
    )


def _picture(
    m: Measurements,
    figure: int | None,
    name: str,
    draw: Callable[[Measurements], Figure],
    caption: str,
    alt: str,
) -> Picture:
    """Return a picture that answers a figure of the report, or that the report has not."""
    title = f"Figure {figure} of the report, ours" if figure is not None else "Not in the report"
    prefix = f"figure_{figure:02d}_" if figure is not None else "extra_"
    return Picture(prefix + name, title, caption, alt, partial(draw, m))


def _three_nodes(m: Measurements) -> Section:
    three = m.runs["three"]
    exact = m.exact_falls["three"]
    fastest = -float(three.summary["probes"]["v_mid"]["min"])
    fastest_at = float(three.summary["probes"]["v_mid"]["t_min"])
    steps = {name: int(m.runs[name].summary["steps"]) for name in ("three", "three_explicit")}
    balance = FallingChain(3, WATER).terminal_speed
    apart = {
        probe: float(np.abs(three.probes[probe] - m.runs["three_explicit"].probes[probe])[1:].max())
        for probe in ("y_mid", "angle")
    }
    dry = -float(m.runs["three_dry"].probes["v_mid"][-1])
    unstable = m.runs["three_unstable"]
    blown = unstable.summary["probes"]
    start = "The same run as figure 6. "
    picture = partial(_picture, m)
    figures = falling_figures
    return Section(
        "Problem 1: three spheres on a soft rod",
        [
            Paragraph(
                "Two small spheres and a large one, threaded on a soft rod, sink through a very "
                "thick fluid: 1000 Pa s, where the report writes N s/m. Drag is Stokes's; buoyancy "
                "is that of a fluid as dense as water. The report does not name the density, but "
                f"its speed at 10 s does: without buoyancy it would be {number(dry, 4)} m/s."
            ),
            picture(
                1,
                "initial_configuration",
                figures.initial_configuration,
                "The start: spheres and rod to scale, at rest.",
                "Three spheres in a row on a thin horizontal rod, the middle one five times as "
                "large as the others.",
            ),
            picture(
                2,
                "shapes",
                figures.shapes,
                "Shapes at the report's six times. The large sphere runs ahead, the small ones are "
                "pulled after it, and the rod folds to a V.",
                "The rod with its spheres at 0, 0.01, 0.05, 0.1, 1 and 10 seconds; it sinks and "
                "bends into a V.",
            ),
            picture(
                3,
                "displacement",
                figures.displacement,
                "Displacement of the middle sphere. Not quite a straight line: the fall slows down "
                f"from {number(fastest, 3)} m/s to {number(float(exact.speed[-1]), 3)} m/s.",
                "Displacement against time over 10 s, slightly curved, ending at "
                f"{number(-float(exact.fallen[-1]), 3)} m; exact dots on our line.",
            ),
            picture(
                4,
                "velocity",
                figures.velocity,
                f"Velocity of the middle sphere. It is fastest at {number(fastest_at, 2)} s, "
                "before the rod has pulled the small spheres along, and then slows down "
                f"towards {number(balance, 5)} m/s (dashed), which it has not reached at 10 s.",
                "Velocity against time: a sudden start, then a slow decay towards the terminal "
                "velocity, nearly reached at 10 s.",
            ),
            picture(
                5,
                "equal_spheres_angle",
                figures.equal_spheres_angle,
                "Turning angle with three equal spheres, at the scale of rounding: the band is "
                "what the last digit of the positions is worth. Largest angle: "
                f"{_largest_angle(m)} rad. The report's caption names a velocity, but its text "
                "speaks of the angle here.",
                "The turning angle against time is a straight line at zero.",
            ),
            Paragraph(
                f"The explicit scheme takes {steps['three_explicit']:,} steps for what the "
                f"implicit one does in {steps['three']:,}. Ours took "
                f"{duration(m.explicit_seconds)} and {duration(m.implicit_seconds)} of wall time "
                "here, where the report speaks of an hour and a minute. Over the 10 s the two "
                f"differ by at most {number(apart['y_mid'], 2)} m in the displacement and "
                f"{number(apart['angle'], 2)} rad in the angle; nearly all of that is the error of "
                "the longer steps."
            ),
            picture(
                None,
                "schemes",
                figures.schemes,
                "Both schemes against the exact motion, and their cost. The report's times are "
                "what it says in words.",
                "Left: errors of the displacement over time, larger for the implicit "
                "scheme. Right: dots of wall times.",
            ),
            Paragraph(
                "With ten times the step the explicit scheme blows up. Its longest stable step is "
                f"{number(m.stable_step, 3)} s, so that der refuses the step of 0.0001 s unless "
                f"told otherwise. If told, it stops after {int(unstable.summary['steps'])} steps, "
                "when an edge is a hundred times its length. Figures 6 to 8 have logarithmic axes "
                "away from zero; dots are steps."
            ),
            picture(
                6,
                "unstable_angle",
                figures.unstable_angle,
                "Turning angle with explicit steps of 0.0001 s: it changes sign with every step "
                "and grows until the rod has folded over.",
                "A zigzag about zero that grows with every step until the rod is folded.",
            ),
            picture(
                7,
                "unstable_velocity",
                figures.unstable_velocity,
                f"{start}The velocity follows the exact one until the small spheres' zigzag "
                f"reaches the middle; then it grows to {number(float(blown['v_mid']['max']), 2)} "
                "m/s.",
                "The velocity follows the exact curve for most of the time, then zigzags with a "
                "growing amplitude.",
            ),
            picture(
                8,
                "unstable_displacement",
                figures.unstable_displacement,
                f"{start}The heavy middle sphere is the last to be thrown about.",
                "The displacement follows the exact curve for most of the time, then zigzags "
                "with a growing amplitude.",
            ),
        ],
    )


def _largest_angle(m: Measurements) -> str:
    return number(float(np.abs(m.runs["three_equal"].probes["angle"]).max()), 2)


def _many_nodes(m: Measurements) -> Section:
    dry, wet = FallingChain(21, 0.0), FallingChain(21, WATER)
    finer, coarse = m.runs["fifty_one"].summary["probes"], m.runs["twenty_one"].summary["probes"]
    inside = next(n for n in NODES if FallingChain(n).edge < FallingChain(n).middle_radius)
    picture = partial(_picture, m)
    figures = falling_figures
    return Section(
        "Problem 2: more nodes",
        [
            Paragraph(
                "The same rod with more nodes, a small sphere of a tenth of an edge on each and "
                "the large one in the middle. The report's speeds are those of a fall without "
                "buoyancy, which its first problem has. So each figure shows the fall twice, "
                "without buoyancy as in the report and with it, over the three nodes of problem 1."
            ),
            picture(
                9,
                "five_shapes",
                figures.five_shapes,
                "5 nodes over 3 nodes at 10 s. Without buoyancy 5 nodes are farther down, with it "
                "they are less far down than 3.",
                "Shapes at 10 s: 5 nodes without buoyancy lie lowest, 5 nodes with buoyancy "
                "highest.",
            ),
            picture(
                10,
                "five_velocity",
                figures.five_velocity,
                "Velocity with 5 nodes over that with 3.",
                "Velocities over 10 s: with 5 nodes and buoyancy close to that with 3 nodes at the "
                "end, without buoyancy clearly faster.",
            ),
            picture(
                11,
                "twenty_one_displacement",
                figures.twenty_one_displacement,
                "Displacement of the middle sphere with 21 nodes over 50 s.",
                "Two nearly straight lines, the one without buoyancy steeper.",
            ),
            picture(
                12,
                "twenty_one_velocity",
                figures.twenty_one_velocity,
                f"Its velocity. It ends at {number(dry.terminal_speed, 5)} m/s without buoyancy "
                f"and at {number(wet.terminal_speed, 5)} m/s with it.",
                "Two velocity curves that soon settle.",
            ),
            picture(
                13,
                "twenty_one_shapes",
                figures.twenty_one_shapes,
                "21 nodes over 3 nodes, at 10 s and at 50 s, at one scale. The small spheres of 21 "
                f"nodes have a radius of {number(1e3 * float(dry.radii[0]), 2)} mm.",
                "Two panels of shapes: with 21 nodes the rod is a smooth arc, with 3 nodes a V.",
            ),
            picture(
                14,
                "twenty_one_over_three",
                figures.twenty_one_over_three,
                "Velocity with 21 nodes over that with 3. The difference in the end comes from "
                "buoyancy, hardly from the number of nodes.",
                "Velocities over 50 s: 21 nodes with buoyancy end close to 3 nodes, without "
                "buoyancy faster.",
            ),
            picture(
                15,
                "fifty_one_over_twenty_one",
                figures.fifty_one_over_twenty_one,
                "51 nodes over 21 nodes, without buoyancy: "
                f"{percent(_off(finer, coarse, 'y_mid'))} apart in the displacement at 50 s and "
                f"{percent(_off(finer, coarse, 'v_mid'))} in the velocity. The report's caption is "
                "that of Figure 14 once more, but its text speaks of 51 nodes here.",
                "Displacement and velocity over 50 s; the curves of 51 and 21 nodes coincide.",
            ),
            picture(
                16,
                "terminal_speed_by_step",
                figures.terminal_by_step,
                "Speed at 50 s with 21 nodes against the step. It is the terminal one for any step "
                "of up to 1 s, to rounding; 10 s is off by "
                f"{percent(m.speeds_by_step[10.0, 0.0] / dry.terminal_speed - 1.0)}. An "
                "equilibrium does not know the step by which it was approached.",
                "Left: speeds against steps of 0.01 to 10 s, two level lines. Right: the relative "
                "distance to the terminal speed, near rounding up to 1 s, then rising steeply.",
            ),
            picture(
                None,
                "terminal_speed_by_nodes",
                figures.terminal_by_nodes,
                f"Speed at 50 s against the number of nodes, from {NODES[0]} to {NODES[-1]}.",
                "Speeds fall slightly from 3 to 7 nodes and are level from there on, with and "
                "without buoyancy, on the lines of the force balance.",
            ),
            Paragraph(
                "That the speed converges with the nodes says less than it seems. More nodes are "
                "another chain, not a finer picture of one. The small spheres' weight vanishes "
                "with their radius cubed, but their drag goes with the radius, and the radii "
                "always sum up to about a tenth of the rod's length. So the limit is "
                f"{number(FallingChain(3, WATER).many_nodes_speed, 5)} m/s with buoyancy, although "
                "the large sphere alone would sink at "
                f"{number(FallingChain(3, WATER).lone_sphere_speed, 5)} m/s. From {inside} nodes "
                "on some of the small spheres are inside the large one, and their drag is counted "
                "all the same. But nothing diverges with more nodes, of which the report warns: "
                f"{NODES[-1]} do as well as {NODES[2]}."
            ),
        ],
    )


def _off(a: dict[str, dict[str, float]], b: dict[str, dict[str, float]], probe: str) -> float:
    return abs(a[probe]["final"] / b[probe]["final"] - 1.0)


def _tube(m: Measurements) -> Section:
    tube = Tube()
    swing = m.runs["beam_swing"]
    peak = -float(swing.summary["probes"]["middle"]["min"])
    middle = m.exact_middles[tube.load_at][2000.0]
    exact = m.exact_deflections[tube.load_at]
    linear = {load: euler_bernoulli_deflection(tube, load) for load in LOADS}
    good = max(p for p in LOADS if linear[p] - exact[p] < abs(m.deflections[p].value - exact[p]))
    picture = partial(_picture, m)
    return Section(
        "Problem 3: a loaded tube",
        [
            Paragraph(
                "An aluminium tube on a pin and a roller, a force at three quarters of its length. "
                "The exact solution is that of a continuum that bends and stretches as far as it "
                "likes; Euler-Bernoulli theory holds for small slopes."
            ),
            picture(
                17,
                "loaded_beam",
                beam_figures.loaded_beam,
                "The tube at rest under 2 kN, to scale, with 51 nodes. The force acts at 0.75 m "
                "exactly, between two nodes.",
                "A slightly sagging beam on two supports with a force arrow at three quarters.",
            ),
            picture(
                18,
                "deflection_history",
                beam_figures.deflection_history,
                "Deflection of the centre node against time, as in the report. It comes to rest at "
                f"{number(m.middles[2000.0].value, 5)} m, and under 20 kN at "
                f"{number(m.middles[20000.0].value, 5)} m: rounded, both of the numbers that the "
                "report gives for the largest deflection. That one is "
                f"{number(m.deflections[2000.0].value, 5)} m, to the right of the centre. The "
                "steady state is reached quickly only because steps of 0.01 s, not much shorter "
                "than a vibration, with implicit Euler damp it away. Nothing in the problem does: "
                "a load that is put on at once "
                f"makes the centre swing to {number(peak, 2)} m, {number(peak / middle, 2)} "
                "times the deflection at rest, and back, for ever.",
                "With the report's scheme the deflection settles after a few steps; undamped it "
                "goes on swinging about the value at rest.",
            ),
            deflection_table(m),
            picture(
                None,
                "deflection_by_load",
                beam_figures.deflection_by_load,
                "Deflection against load, and the errors. Ours stays within its error bar. "
                f"Euler-Bernoulli theory is better than 51 nodes up to {number(good, 3)} N, and "
                f"{percent(linear[20000.0] / exact[20000.0] - 1.0)} too large at 20 kN: the roller "
                "comes in, which shortens the span.",
                "Left: deflection against load on logarithmic axes. Right: relative errors; that "
                "of Euler-Bernoulli theory rises with the square of the load, ours is nearly "
                "level.",
            ),
        ],
    )


def _how(rows: Sequence[Quantity]) -> Section:
    by_command: dict[str, list[str]] = {}
    for row in rows:
        if row.command:
            by_command.setdefault(row.command, []).append(row.name)
    return Section(
        "How the numbers were made",
        [
            Paragraph("These commands, in a checkout of der, print ours:"),
            Bullets([f"`{command}`: {'; '.join(names)}" for command, names in by_command.items()]),
            Paragraph("The rest:"),
            Bullets(
                [
                    "Error bars: `der verify` on the same scenes. For the spheres they are of time "
                    "and solver alone, since the number of nodes belongs to the model; for the "
                    "tube they are of the equilibrium's mesh, plus what the run is off from it.",
                    "Exact motion of the spheres: the equations of motion, written down apart from "
                    "the engine, and SciPy's Radau. Terminal speeds: weight less buoyancy over the "
                    "sum of the Stokes drags.",
                    "Exact deflections: the extensible elastica as a boundary value problem, by "
                    "shooting with SciPy's DOP853 to a relative tolerance of 10⁻¹².",
                    "Wall times: what stands under `cost`, the least of three runs, one at a time, "
                    "on the machine at hand. All else does not depend on the machine, but for "
                    "rounding.",
                    "The longest stable step: by bisection of the steps with which "
                    "`der.Simulation` takes the explicit scene. The command that blows up says it "
                    "in its error, with the time that it reaches.",
                    "The masses: the sums of `der.Simulation(scene).node_masses` for "
                    "`configs/falling_beam_3.yaml` and `configs/falling_beam_5.yaml`.",
                    "Deflection by load, and speeds by nodes and by step: the command stands in "
                    "each row of `data/deflection_by_load.csv` and `data/terminal_speeds.csv`.",
                    "The numbers with all their digits: `data/comparison.csv`, "
                    "`data/deflection_by_load.csv`, `data/terminal_speeds.csv`.",
                    f"Versions: der {__version__}, Python {platform.python_version()}, NumPy "
                    f"{np.__version__}, SciPy {scipy.__version__}, Matplotlib {mpl.__version__}.",
                ]
            ),
        ],
    )
