"""Make the pictures of the README and of the documentation.

    python docs/make_figures.py [NAME...]

Writes docs/images/NAME.png for each NAME, or for all of them. finger_learned, finger_traces,
gripper and swinging are GIFs. What has been learned takes gymnasium, and view, play and
notebook, three screenshots, take Chromium and selenium, and play takes viser: without them these
pictures are left as they are.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import der
import matplotlib.pyplot as plt
import numpy as np
from der.plotting import PALETTE, style, time_colours
from der.plotting.space import make_picture
from der.plotting.style import MUTED, look
from matplotlib.patheffects import withStroke
from tutorials import beam_study, control, falling_rod, finger, fitting, two_links

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DOCS = Path(__file__).resolve().parent
CONFIGS = DOCS.parent / "configs"

SWING: dict[str, Any] = {
    "title": "A soft rod swings down from horizontal",
    "rods": [
        {
            "name": "rod",
            "nodes": 41,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"circle": {"radius": 0.01}},
            "material": {"youngs_modulus": 1e7, "density": 1000},
        }
    ],
    "supports": [{"rod": "rod", "at": "start", "clamp": True}],
    "loads": [{"gravity": [0, -9.81]}],
    "time": {"duration": 1, "step": 0.001, "integrator": "implicit_midpoint"},
    "output": {"every": 0.01, "probes": {"tip_y": {"rod": "rod", "at": "end", "quantity": "y"}}},
}

TUBE = ("simply_supported.yaml", "deflection", "loads.0.point_force.force.1")
ARM = ("cantilever.yaml", "tip_y", "loads.0.point_force.force.1")
# Name, scene, probe and path of the load, the load, and the value of the continuum: from
# tests/validation/references/values.json.
REFERENCES = [
    ("tube, 2 kN", *TUBE, -2000, -0.03771401492),
    ("tube, 20 kN", *TUBE, -20000, -0.2380055980),
    ("cantilever, PL²/EI = 1", *ARM, -1, -0.3017207738),
    ("cantilever, PL²/EI = 10", *ARM, -10, -0.8106090249),
]


def swing() -> Figure:
    """Draw the scene of the README and of the quick start."""
    return der.run(SWING).plot("shapes", times=np.linspace(0, 0.5, 6).tolist())


def falling_spheres() -> Figure:
    """Draw shapes of the three falling spheres."""
    return der.run(CONFIGS / "falling_beam_3.yaml").plot("shapes", times=[0, 4, 10])


def simply_supported_20kN() -> Figure:
    """Draw the tube under ten times the load that linear theory can take."""
    return der.run(CONFIGS / "simply_supported_20kN.yaml").plot()


def roll_up() -> Figure:
    """Draw equilibria of a cantilever under a growing end moment."""
    scene = der.load(CONFIGS / "roll_up.yaml")
    whole = scene.to_dict()["loads"][0]["moment"]["moment"]
    figure, axes = new_axes()
    for share, colour in zip((0.25, 0.5, 0.75, 1.0), PALETTE, strict=False):
        result = der.run(scene.with_(**{"loads.0.moment.moment": share * whole}))
        axes.plot(*result.positions[-1].T, color=colour, linewidth=2.5, label=f"{share:g}")
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.legend(title="moment / (2π EI/L)", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def convergence() -> Figure:
    """Draw, and print, errors of equilibria with 10 to 80 elements; order 2 beside them."""
    figure, axes = new_axes()
    nodes = np.array([11, 21, 41, 81])
    length = 1.0 / (nodes - 1)
    for (label, config, probe, path, load, exact), colour in zip(REFERENCES, PALETTE, strict=False):
        scene = der.load(CONFIGS / config, **{path: load})
        rod = scene.to_dict()["rods"][0]
        if "stiffness" in rod["cross_section"]:  # the reference does not stretch
            scene = scene.with_(**{f"rods.{rod['name']}.cross_section.stiffness.EA": 1e7})
        found = [
            der.equilibrium(scene.with_(**{f"rods.{rod['name']}.nodes": n})).probes[probe][0]
            for n in nodes.tolist()
        ]
        error = np.abs(np.array(found) - exact)
        print(label, *(f"{e:.3g}" for e in error))
        axes.loglog(length, error, "o-", color=colour, label=label)
        axes.loglog(length, error[-1] * (length / length[-1]) ** 2, "--", color="0.6", zorder=1)
    axes.plot([], [], "--", color="0.6", label="order 2")
    axes.set_xticks(length, [f"1/{n - 1}" for n in nodes], minor=False)
    axes.minorticks_off()
    axes.set(xlabel="element length / rod length", ylabel="error [m]")
    axes.legend()
    return figure


def study() -> Figure:
    """Draw what accuracy costs on the swinging rod."""
    found = der.study(
        SWING,
        nodes=[21, 41, 81],
        steps=[0.01, 0.005, 0.0025, 0.00125],
        steppers=["implicit_euler", "implicit_midpoint", "bdf2", "tr_bdf2"],
    )
    return found.plot()


def sweep() -> Figure:
    """Draw a cantilever under many loads and with many stiffnesses."""
    found = der.sweep(
        CONFIGS / "cantilever.yaml",
        {
            "loads.0.point_force.force.1": "-10:0:41",
            "rods.arm.cross_section.stiffness.EI": "0.1:10:31:log",
        },
    )
    return found.plot(["tip_y", "root_moment"])


def batch() -> Figure:
    """Draw members of a batch whose stiffness differs."""
    stiffness = np.geomspace(1e6, 1e8, 40)
    members = der.Batch(SWING, 40, vary={"rods.rod.material.youngs_modulus": stiffness})
    members.step(400)
    return members.plot()


def tolerance() -> Figure:
    """Draw the error in time against the requested tolerance."""
    asked = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]
    names = [info.name for info in der.steppers() if info.implicit]

    def tips(**time: float | str) -> np.ndarray:
        scene = {**SWING, "time": {"duration": 1, **time}, "output": {"every": 0.01}}
        if "step" in time:
            scene["solver"] = {"residual_tolerance": 1e-12, "step_tolerance": 1e-13}
        return der.run(der.Scenario.from_dict(scene)).positions[:, -1]

    exact = tips(step=5e-5, integrator="sdirk4")  # half the step moves it by 2e-10 m
    figure, axes = new_axes()
    axes.loglog(asked, asked, color="0.6", linestyle="--", label="requested tolerance")
    for index, name in enumerate(names):
        colour, marker = look(index)
        errors = {}
        # With a method of order 1, six digits would take a million steps.
        for value in asked[:3] if name == "implicit_euler" else asked:
            off = tips(tolerance=value, integrator=name) - exact
            errors[value] = np.linalg.norm(off, axis=1).max()
        axes.loglog(errors.keys(), errors.values(), marker=marker, color=colour, label=name)
    axes.set(xlabel="tolerance [-]", ylabel="largest error of the tip in time [m]")
    axes.invert_xaxis()
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def beam_modes() -> Figure:
    """Draw four vibration modes of a cantilever."""
    return der.run(CONFIGS / "beam_modes.yaml").plot()


def euler_buckling() -> Figure:
    """Draw the path of a column and its bent branches."""
    return der.run(CONFIGS / "euler_buckling.yaml").plot(probes=["aside", "end_x"])


def snap_through_arch() -> Figure:
    """Draw the path of a shallow arch and its skew branches."""
    return der.run(CONFIGS / "snap_through_arch.yaml").plot()


def actuated_finger() -> Figure:
    """Draw a soft finger as it closes: the chamber of the tip is behind that of the base."""
    return der.run(CONFIGS / "finger.yaml").plot("shapes", times=[0, 0.3, 0.7])


def helix_spring() -> Figure:
    """Draw a wire in space that coils up to its natural shape."""
    return der.run(CONFIGS / "helix_spring.yaml").plot()


def bent_cantilever_45() -> Figure:
    """Draw the arc from above and from the side under growing loads; published tips beside it."""
    scene = der.load(CONFIGS / "bent_cantilever_45.yaml", model="spatial")
    # Both views have one scale: the size [inches] of a unit of length, and the views' heights.
    scale, width, heights = 0.064, 79, (36, 62)
    size = (width * scale + 0.85, sum(heights) * scale + 1.4)
    figure = plt.figure(figsize=size)
    panels = []
    for low, height in ((heights[1] * scale + 1.05, heights[0]), (0.55, heights[1])):
        box = (0.7, low, width * scale, height * scale)
        panels.append(figure.add_axes([x / size[i % 2] for i, x in enumerate(box)]))
    loads = range(0, 601, 100)
    for load, colour in zip(loads, reversed(time_colours(len(loads))), strict=True):
        line = der.run(scene.with_(**{"loads.0.point_force.force": [0, 0, load]})).positions[-1]
        for axes, across in zip(panels, (1, 2), strict=True):
            axes.plot(line[:, 0], line[:, across], color=colour, linewidth=2.5, label=f"{load} N")
    # The rod without shear of tests/validation/references/bent_cantilever.py.
    for axes, tips in zip(panels, ((22.2453, 15.6854), (40.1894, 53.4718)), strict=True):
        axes.plot([0, 0], [-3, 3], color=MUTED, linewidth=4, zorder=3)  # the wall
        axes.scatter(
            [58.7802, 47.1522], tips, s=100, color="none", edgecolor=MUTED, label="published"
        )
        axes.set(xlim=(-3, width - 3), xlabel="x")
    panels[0].set(title="from above", ylabel="y", ylim=(-4, heights[0] - 4), xlabel="")
    panels[1].set(title="from the side", ylabel="z", ylim=(-4, heights[1] - 4))
    panels[1].legend(loc="upper left")
    return figure


def hanging_coil() -> Figure:
    """Draw coils of five lengths beside each other, seen along y and along x."""
    scene = der.load(CONFIGS / "hanging_coil.yaml")
    figure, panels = plt.subplots(1, 2, figsize=(9.6, 4.6), sharey=True, layout="constrained")
    for place, length in enumerate((0.08, 0.1, 0.2, 0.3, 0.4)):
        line = der.run(scene.with_(**{"rods.rod.to": [0, 2.5e-4 * length, -length]})).positions[-1]
        left = 0.06 * place
        colour = PALETTE[0] if np.ptp(line[:, 1]) < 1e-3 else PALETTE[1]  # in the plane, or not
        for axes, seen in zip(panels, (0, 1), strict=True):
            axes.plot(left + line[:, seen], line[:, 2], color=colour, linewidth=2.5)
            axes.plot([left - 0.008, left + 0.008], [0, 0], color=MUTED, linewidth=4, zorder=1)
            axes.text(left, 0.014, f"{100 * length:g} cm", ha="center", color=colour)
    for axes in panels:
        axes.set(aspect="equal", xlim=(-0.035, 0.29), ylim=(-0.29, 0.03), xticks=[])
        axes.spines.bottom.set_visible(False)
        axes.grid(axis="x", visible=False)
    panels[0].set(title="seen along y", ylabel="z [m]")
    panels[1].set(title="seen along x: the shortest hangs in its plane")
    return figure


def spun_strip() -> Figure:
    """Draw the strip at two instants: its section as it lies."""
    return der.run(CONFIGS / "spun_strip.yaml").plot("shapes", times=[1.0, 1.5])


def table() -> Figure:
    """Draw a table of four legs and four beams that a force at one corner twists."""
    corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.8], [0.0, 0.8]]
    section: dict[str, Any] = {"circle": {"radius": 0.01}}
    rods: list[dict[str, Any]] = []
    joints = []
    for k, (x, y) in enumerate(corners):
        other = corners[(k + 1) % 4]
        post = {"name": f"leg{k}", "nodes": 9, "from": [x, y, 0], "to": [x, y, 0.7]}
        beam = {"name": f"beam{k}", "nodes": 11, "from": [x, y, 0.7], "to": [*other, 0.7]}
        rods += [post | {"cross_section": section | {"director": [1, 0, 0]}}, beam]
        beam["cross_section"] = section
        ends = [(f"leg{k}", "end"), (f"beam{k}", "start"), (f"beam{(k - 1) % 4}", "end")]
        joints.append({"name": f"corner{k}", "of": [{"rod": rod, "at": at} for rod, at in ends]})
    for rod in rods:
        rod["material"] = {"youngs_modulus": "2 GPa", "poissons_ratio": 0.35, "density": 1000}
    force = {"joint": "corner2", "force": [-90, 75, -45]}
    scene = {
        "rods": rods,
        "joints": joints,
        "supports": [{"rod": f"leg{k}", "at": "start", "clamp": True} for k in range(4)],
        "loads": [{"point_force": force}],
        "analysis": "static",
    }
    return der.run(scene).plot()


def helical_buckling() -> Figure:
    """Draw the localised helix, and its envelope beside that of the infinite rod."""
    result = der.run(CONFIGS / "helical_buckling.yaml")
    line = result.positions[-1]
    along = line[2:] - line[:-2]
    angle = np.arccos(along[:, 0] / np.linalg.norm(along, axis=1))
    s = result.rods[0].arc_lengths[1:-1] - 50.0
    # The closed form of tests/validation/references/helical_buckling.py.
    cosine, width = np.cos(0.831675696), 4.596127046
    envelope = cosine + (1.0 - cosine) * np.tanh(s / width) ** 2
    figure, (shape, below) = plt.subplots(
        2, 1, figsize=(7.2, 4.4), height_ratios=(1, 2), layout="constrained"
    )
    shape.plot(line[:, 0] - line[100, 0], line[:, 2], color=PALETTE[0])
    shape.set(aspect="equal", xlabel="x - middle", ylabel="z", xlim=(-30, 30), ylim=(-3, 3))
    below.plot(s, np.arccos(envelope), color="0.6", linewidth=4, label="infinite rod")
    below.plot(s, angle, color=PALETTE[0], label="der, 200 edges")
    below.set(xlabel="arc length from the middle", ylabel="tangent to axis [rad]", xlim=(-30, 30))
    below.legend()
    return figure


def drawn_shapes() -> Figure:
    """Draw a hook of lines and arcs with its nodes, and a spring with two hooks in space."""
    hook = [
        {"line": [0, -6]},
        {"arc": {"to": [3, -9], "radius": 3}},
        {"arc": {"to": [6, -6], "radius": 3}},
        {"line": [7, -5.5]},
    ]
    coil = [
        {"arc": {"to": [1, 0, 1], "centre": [0, 0, 1]}},
        {"helix": {"axis": [0, 0, 1], "centre": [0, 0, 0], "pitch": 0.35, "turns": 8}},
        {"arc": {"to": [0, 0, 4.8], "centre": [0, 0, 3.8]}},
    ]
    section = {"stiffness": {"EA": 1, "EI": 1, "GJ": 1, "mass_per_length": 1}}

    def nodes(start: list[float], shape: list[dict[str, Any]], count: int) -> np.ndarray:
        rod = {"name": "rod", "from": start, "shape": shape, "nodes": count}
        scene = {"rods": [rod | {"cross_section": section}], "analysis": "static"}
        return der.Model(der.Scenario.from_dict(scene)).initial_positions

    figure = plt.figure(figsize=(7.2, 3.6), layout="constrained")
    flat = figure.add_subplot(1, 2, 1)
    x, y = nodes([0, 0], hook, 2001).T
    flat.plot(x, y, color=MUTED, linewidth=1)
    x, y = nodes([0, 0], hook, 25).T
    flat.plot(x, y, "o", color=PALETTE[0], markersize=4)
    flat.set(aspect="equal", xlabel="x", ylabel="y")
    space = figure.add_subplot(1, 2, 2, projection="3d")
    space.plot(*nodes([0, 0, 0], coil, 801).T, color=PALETTE[0])
    space.set(zlim=(0, 4.8))
    space.set_box_aspect((1, 1, 2.4), zoom=1.1)
    space.set_axis_off()
    return figure


def twisted_ring() -> Figure:
    """Draw a ring that leaves its plane."""
    return der.run(CONFIGS / "twisted_ring.yaml").plot(times=[0.0, 0.056, 0.07])


def tutorial_falling_rod() -> Figure:
    """Draw the rod with beads of the first tutorial."""
    return falling_rod.figure(der.run(falling_rod.SCENE))


def tutorial_beam_study() -> Figure:
    """Draw the study of the second tutorial."""
    return beam_study.figure(beam_study.study())


def tutorial_control() -> Figure:
    """Draw the arm of the third tutorial, with and without feedback."""
    return control.figure(control.run(control.PI()), control.run(control.open_loop))


def tutorial_two_links() -> Figure:
    """Draw the finger of two links under a heavy weight, and what its motor does."""
    return two_links.figure(two_links.run(two_links.LIMIT), two_links.run(np.inf))


def tutorial_finger() -> Figure:
    """Draw the finger's tip of the fifth tutorial, with and without feedback."""
    inverse = finger.Inverse()
    return finger.figure(
        inverse, finger.run(finger.Feedback(inverse)), finger.run(finger.OpenLoop(inverse))
    )


def tutorial_learning() -> Figure:
    """Draw what the finger of the sixth tutorial has learned."""
    from tutorials import learning

    learned = learning.load(DOCS / "tutorials" / "learning.json")
    track = learning.run(learned)
    return learning.figure(learned, track, learning.replay(track))


def tutorial_fitting() -> Figure:
    """Draw the strip of the seventh tutorial: its film, the fit, and the fits of other films."""
    exact = fitting.exact_trace()
    data = fitting.film(np.random.default_rng(0), exact)
    return fitting.figure(data, fitting.fit(data), fitting.repeated(exact, films=100))


def data_flow() -> Figure:
    """Draw what flows from where to where: the picture of docs/architecture.md."""
    boxes = {
        "scene": (0, 1, "scene.yaml or dict\nconfigs/"),
        "scenario": (1, 1, "Scenario\nscenario/"),
        "model": (2, 1, "Model (constant)\nmodel/, building/"),
        "kernels": (2, -0.35, "kernels: E, grad E, Hessian\nenergies/, kinematics/"),
        "state": (3, 2, "State\nmodel/state.hpp"),
        "assembler": (3.3, 0.3, "Assembler\nassembly/"),
        "newton": (4.6, -0.35, "Newton, LinearSolver\nsolvers/"),
        "stepper": (4.2, 1, "Stepper\nsteppers/"),
        "statics": (5.6, 0.3, "equilibria, paths, modes\nstatics/"),
        "recorder": (4.2, 2, "Recorder\noutput/"),
        "folder": (5.5, 1.35, "run folder\noutput/"),
        "result": (5.5, 2.3, "der.Result\npython/der/"),
        "plots": (6.7, 2.3, "plots, exports\npython/der/"),
    }
    arrows = [
        ("scene", "scenario"),
        ("scenario", "model"),
        ("model", "state"),
        ("model", "assembler"),
        ("kernels", "assembler"),
        ("assembler", "newton"),
        ("newton", "stepper"),
        ("newton", "statics"),
        ("statics", "recorder"),
        ("stepper", "state"),
        ("state", "recorder"),
        ("recorder", "folder"),
        ("recorder", "result"),
        ("folder", "result"),
        ("result", "plots"),
    ]
    figure, axes = plt.subplots(figsize=(11, 4.2), layout="constrained")
    drawn = {}
    for name, (x, y, label) in boxes.items():
        drawn[name] = axes.text(
            x,
            y,
            label,
            ha="center",
            va="center",
            bbox={"boxstyle": "round,pad=0.5", "facecolor": "#eaf2f8", "edgecolor": PALETTE[0]},
        )
    for start, end in arrows:
        axes.annotate(
            "",
            boxes[end][:2],
            boxes[start][:2],
            arrowprops={
                "arrowstyle": "-|>",
                "color": "#555555",
                "patchA": drawn[start].get_bbox_patch(),
                "patchB": drawn[end].get_bbox_patch(),
                "shrinkA": 2,
                "shrinkB": 3,
            },
        )
    axes.set(xlim=(-0.5, 7.2), ylim=(-0.95, 2.7))
    axes.axis("off")
    return figure


def symbols() -> Figure:
    """Draw the symbols of supports and loads."""
    tube = {
        "cross_section": {"circle": {"radius": 0.01}},
        "material": {"youngs_modulus": 1e9, "density": 1000},
    }
    scene = {
        "title": "Symbols of supports and loads",
        "rods": [
            {"name": "upper", "nodes": 31, "from": [0, 0], "to": [1, 0], **tube},
            {"name": "lower", "nodes": 31, "from": [0, -0.35], "to": [1, -0.35], **tube},
        ],
        "supports": [
            {"rod": "upper", "at": "start", "clamp": True},
            {"rod": "upper", "at": "end", "fix": ["y"]},
            {"rod": "lower", "at": "start", "fix": ["x", "y"]},
            {"rod": "lower", "at": "end", "fix": ["y"]},
        ],
        "loads": [
            {"gravity": [0, -9.81]},
            {"point_force": {"rod": "upper", "at": 0.35, "force": [0, -3]}},
            {"moment": {"rod": "upper", "at": 0.7, "moment": 1}},
            {"point_force": {"rod": "upper", "at": "end", "force": [20, 0]}},
            {"distributed_force": {"rod": "lower", "from": 0.3, "to": 0.9, "force": [0, -5]}},
            {"point_force": {"rod": "lower", "at": "end", "force": [-15, 0]}},
        ],
        "analysis": "static",
    }
    return der.run(scene).plot("shapes")


def symbols_in_space() -> Figure:
    """Draw the symbols of supports and loads of rods in space."""
    bar = {
        "nodes": 31,
        "cross_section": {
            "rectangle": {"width": 0.045, "height": 0.015},
            "director": [0, 1, 0],
        },
        "material": {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "density": 1000},
    }
    scene = {
        "title": "Symbols of supports and loads in space",
        "rods": [
            {"name": "near", "from": [0, 0, 0], "to": [1, 0, 0], **bar},
            {"name": "far", "from": [0, 0.5, 0], "to": [1, 0.5, 0.2], **bar},
        ],
        "supports": [
            {"rod": "near", "at": "start", "clamp": True},
            {"rod": "near", "at": "end", "spring": {"stiffness": [0, 0, 300]}},
            {"rod": "far", "at": "start", "fix": ["x", "y", "z"]},
            {"rod": "far", "at": "end", "fix": ["y", "z"]},
            {"rod": "far", "at": "middle", "spring": {"rotational_stiffness": 1}},
        ],
        "loads": [
            {"gravity": [0, 0, -9.81]},
            {"point_force": {"rod": "near", "at": 0.4, "force": [0, 10, -20]}},
            {"moment": {"rod": "near", "at": 0.7, "moment": [3, 0, 0]}},
            {
                "distributed_force": {
                    "rod": "far",
                    "from": 0.3,
                    "to": 0.7,
                    "force": [0, 0, -20],
                }
            },
            {"point_force": {"rod": "far", "at": "end", "force": [50, 0, 0]}},
        ],
        "analysis": "static",
    }
    return der.run(scene).plot("shapes")


def directors() -> Figure:
    """Draw a strip with its tangent, its two directors and the way in which it bends."""
    scene = {
        "title": "A strip and its directors",
        "rods": [
            {
                "name": "strip",
                "nodes": 31,
                "from": [0, 0, 0],
                "to": [1, 0, 0],
                "cross_section": {
                    "rectangle": {"width": 0.2, "height": 0.05},
                    "director": [0, 1, 0],
                },
                "material": {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "density": 1000},
            }
        ],
        "supports": [{"rod": "strip", "at": "start", "clamp": True}],
        "model": "spatial",
        "analysis": "static",
    }
    result = der.run(scene)
    figure = result.plot("shapes")
    axes = figure.axes[0]
    picture = make_picture(result)
    start = np.array([0.62, 0.0, 0.05])
    for way, text, offset in (
        (np.array([0.3, 0.0, 0.0]), "tangent t", (-48.0, -16.0)),
        (np.array([0.0, 0.3, 0.0]), "director 1, of the width: EI1, k1", (5.0, 4.0)),
        (np.array([0.0, 0.0, 0.3]), "director 2 = t x d1, of the height: EI2, k2", (5.0, 4.0)),
    ):
        tail, tip = picture.seen(np.array([start, start + way]))
        arrow = {"arrowstyle": "-|>", "color": PALETTE[1], "linewidth": 2.0}
        axes.annotate("", tip, tail, arrowprops=arrow, zorder=20)
        axes.annotate(
            text,
            tip,
            offset,
            textcoords="offset points",
            zorder=20,
            path_effects=[withStroke(linewidth=3.0, foreground="white")],
        )
    axes.get_legend().remove()
    return figure


def finger_traces(path: Path) -> None:
    """Write an animation of the finger of the fifth tutorial, with feedback."""
    controlled = finger.run(finger.Feedback(finger.Inverse()))
    finger.replay(controlled).animate(path, speed=2, fps=10)


def finger_learned(path: Path) -> None:
    """Write an animation of what the finger of the sixth tutorial has learned."""
    from tutorials import learning

    learned = learning.load(DOCS / "tutorials" / "learning.json")
    learning.replay(learning.run(learned)).animate(path, fps=10)


def gripper_scene() -> dict[str, Any]:
    """Return the scene of a gripper of four fingers, each with a chamber, that close and open."""
    fingers = []
    for angle in np.linspace(0.0, 2.0 * np.pi, 4, endpoint=False):
        fingers.append(np.array([np.cos(angle), np.sin(angle), 0.0]))  # the way out
    curvature = {"times": [0, 0.6, 1.2], "values": [0, 14, 0], "smooth": True}
    return {
        "title": "A gripper of four soft fingers closes and opens",
        "rods": [
            {
                "name": f"finger_{number}",
                "nodes": 25,
                "from": (0.03 * out + [0, 0, 0.1]).tolist(),
                "to": (0.05 * out).tolist(),
                "cross_section": {"circle": {"radius": 0.005}, "director": (-out).tolist()},
                "material": {"youngs_modulus": 1e6, "poissons_ratio": 0.45, "density": 1000},
            }
            for number, out in enumerate(fingers)
        ],
        "supports": [
            {"rod": f"finger_{number}", "at": "start", "clamp": True} for number in range(4)
        ],
        "actuation": [
            {
                "name": f"chamber_{number}",
                "rod": f"finger_{number}",
                "from": 0.02,
                "to": 0.08,
                "natural_curvature": [curvature, 0],
            }
            for number in range(4)
        ],
        "loads": [{"gravity": [0, 0, -9.81]}, {"damping": {"coefficient": 0.05}}],
        "start_from": "equilibrium",
        "time": {"duration": 1.2, "step": 0.005},
        "output": {"every": 0.02},
    }


def gripper(path: Path) -> None:
    """Write the animation of the start page: a gripper at half its speed."""
    der.run(gripper_scene()).animate(path, speed=0.5, fps=12.5)


def swinging(path: Path) -> None:
    """Write an animation of the swinging rod at half its speed."""
    der.run(SWING).animate(path, speed=0.5)


def view(path: Path) -> None:
    """Write a screenshot of an interactive view."""
    from selenium import webdriver
    from selenium.webdriver.support.ui import WebDriverWait

    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        raise ModuleNotFoundError("a screenshot takes the Debian packages of Chromium")
    scene = der.load(CONFIGS / "simply_supported_20kN.yaml", **{"time.integrator": "tr_bdf2"})
    with tempfile.TemporaryDirectory() as folder:
        page = der.run(scene).view(Path(folder) / "view.html")
        options = webdriver.ChromeOptions()
        options.binary_location = chromium
        for flag in (
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-unsafe-swiftshader",
            "--disable-background-networking",
            "--window-size=1000,640",
            f"--user-data-dir={folder}/chromium",
        ):
            options.add_argument(flag)
        browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
        try:
            browser.get(page.as_uri())
            wait = WebDriverWait(browser, 60)
            wait.until(lambda b: b.find_elements("css selector", "body.ready"))
            slider = "s = document.getElementById('slider')"
            move = f"{slider}; s.value = s.max; s.dispatchEvent(new Event('input'))"
            browser.execute_script(f"let {move}")
            wait.until(lambda b: b.find_element("id", "caption").text == "t = 1.00 s")
            browser.save_screenshot(str(path))
        finally:
            browser.quit()


def play(path: Path) -> None:
    """Write a screenshot of a scene that is played, while the mouse pulls."""
    import viser  # noqa: F401 - without it the picture is left as it is
    from screenshots import chromium, played, wait_until_played
    from selenium.webdriver.common.action_chains import ActionChains

    with chromium() as browser, played() as address:
        browser.set_window_size(1280, 760)
        browser.get(address)
        wait_until_played(browser)
        canvas = browser.find_element("css selector", "canvas")
        height = canvas.rect["height"]
        hand = ActionChains(browser)
        hand.move_to_element_with_offset(canvas, round(0.25 * height), round(0.07 * height))
        hand.click_and_hold().move_by_offset(0, -20).move_by_offset(0, -round(0.35 * height))
        hand.perform()
        time.sleep(3.0)
        browser.save_screenshot(str(path))


def notebook(path: Path) -> None:
    """Write a screenshot of a result as a notebook shows it."""
    chromium = shutil.which("chromium")
    if not chromium:
        raise ModuleNotFoundError("a screenshot takes the Debian package chromium")
    shown = der.run("example:finger")._repr_html_()
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "card.html"
        page.write_text(f'<meta charset="utf-8"><body style="font: 14px sans-serif">{shown}')
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
        line = [chromium, *flags, "--window-size=680,1084", f"--user-data-dir={folder}/chromium"]
        subprocess.run([*line, f"--screenshot={path}", page.as_uri()], check=True)


def new_axes() -> tuple[Figure, Axes]:
    """Return a figure with one set of axes."""
    return plt.subplots(figsize=(6, 4), layout="constrained")


FIGURES: dict[str, Callable[[], Figure]] = {
    make.__name__: make
    for make in (
        swing,
        falling_spheres,
        simply_supported_20kN,
        roll_up,
        convergence,
        study,
        sweep,
        batch,
        tolerance,
        beam_modes,
        euler_buckling,
        snap_through_arch,
        actuated_finger,
        helix_spring,
        bent_cantilever_45,
        hanging_coil,
        spun_strip,
        drawn_shapes,
        table,
        helical_buckling,
        twisted_ring,
        tutorial_falling_rod,
        tutorial_beam_study,
        tutorial_control,
        tutorial_two_links,
        tutorial_finger,
        tutorial_learning,
        tutorial_fitting,
        data_flow,
        symbols,
        symbols_in_space,
        directors,
    )
}
# Figures whose function writes the file itself, with the ending of the file.
FILES: dict[str, tuple[str, Callable[[Path], None]]] = {
    "finger_learned": (".gif", finger_learned),
    "finger_traces": (".gif", finger_traces),
    "gripper": (".gif", gripper),
    "swinging": (".gif", swinging),
    "view": (".png", view),
    "notebook": (".png", notebook),
    "play": (".png", play),
}


def main() -> None:
    """Write the pictures that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    known = [*FIGURES, *FILES]
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(known))
    names = parser.parse_args().names or known
    unknown = sorted(set(names) - set(known))
    if unknown:
        parser.error(f"no picture named {', '.join(unknown)}; there are {', '.join(known)}")
    plt.switch_backend("agg")  # files are written and no window opened
    (DOCS / "images").mkdir(exist_ok=True)
    for name in names:
        path = DOCS / "images" / f"{name}{FILES[name][0] if name in FILES else '.png'}"
        try:
            write(name, path)
        except ModuleNotFoundError as error:
            print(f"{path.relative_to(DOCS.parent)} is left as it is: {error}")
        else:
            print(path.relative_to(DOCS.parent))


def write(name: str, path: Path) -> None:
    """Make one picture."""
    if name in FILES:
        FILES[name][1](path)
        return
    with style():
        figure = FIGURES[name]()
        figure.savefig(path, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    main()
