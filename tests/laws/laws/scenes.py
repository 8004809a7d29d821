"""The scenes that the laws are tried on: those of configs/, and small ones with each thing in turn.

A small scene is a rod of one of the three models with one thing that holds it, loads it, or is part
of it. It is run as an equilibrium and as a motion, whichever the thing allows.
"""

from __future__ import annotations

import copy
import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import der
import numpy as np

from .schema import Scene

ROOT = Path(__file__).resolve().parents[3]
MODELS = ("planar", "spatial_bend", "spatial")
#: Newton's method goes on to rounding, so that laws hold to it.
SOLVER = {"residual_tolerance": 1e-13, "step_tolerance": 1e-13}
STEPS = 8

#: What scenes of configs/ are cut down by; besides, motions to a few steps.
CUT = {
    "beam_modes": {"rods.beam.nodes": 21},
    "beam_on_foundation": {"rods.rail.nodes": 41},
    "cantilever": {"rods.arm.nodes": 21},
    "elastica": {"rods.rod.nodes": 31},
    "euler_buckling": {"rods.column.nodes": 13},
    "hanging_coil": {"rods.rod.nodes": 31},
    "helical_buckling": {"rods.rod.nodes": 41},
    "helix_spring": {"rods.wire.nodes": 51},
    "natural_curvature": {"rods.strip.nodes": 31},
    "roll_up": {"rods.strip.nodes": 31},
    # The force is at a node: in the middle of an edge, tension is told by one side or the other.
    "simply_supported": {"rods.beam.nodes": 21},
    "simply_supported_20kN": {"rods.beam.nodes": 21},
}


@functools.cache
def scenes() -> dict[str, Scene]:
    """All scenes by name."""
    files = sorted((ROOT / "configs").glob("*.yaml"))
    return {file.stem: _cut(file) for file in files} | _small()


def _cut(file: Path) -> Scene:
    scene = der.load(file, **CUT.get(file.stem, {})).to_dict()
    if "time" in scene:
        scene["time"]["duration"] = STEPS * scene["time"]["step"]
        scene["output"].pop("every", None)
    return {**scene, "solver": SOLVER}


# ---- small scenes

CLAMP: list[Scene] = [{"rod": "rod", "at": "start", "clamp": True}]
NODES = 10
#: A place between two nodes.
BETWEEN = 0.537
MATERIAL = {"youngs_modulus": 1e7, "poissons_ratio": 0.3, "density": 1000}
TIMES = [0.0, 0.013, 0.05]

#: What a thing changes in the scene of a model: keys of the scene, and `rod`, keys of the rod.
Thing = Callable[[str], Scene]


def _base(model: str, nodes: int = NODES) -> Scene:
    """An arc in the plane, a straight wire, or a twisted strip in space, clamped at its start and
    loaded, so that nothing is straight or symmetric."""
    s = np.linspace(0.0, 1.0, nodes)
    stiffness = {"EA": 500.0, "EI": 0.5, "mass_per_length": 0.3}
    rod: Scene = {"name": "rod", "cross_section": {"stiffness": stiffness}}
    if model == "planar":
        rod["points"] = np.column_stack([s, 0.4 * s**2]).round(12).tolist()
    elif model == "spatial_bend":
        rod |= {"nodes": nodes, "from": [0.1, 0.0, -0.2], "to": [0.9, 0.3, 0.1]}
    else:
        points = np.column_stack([np.sin(s), 1.0 - np.cos(s), 0.4 * s + 0.1 * s**2])
        stiffness |= {"EI1": 0.7, "EI2": 0.3, "GJ": 0.4, "rotary_inertia": 2e-3}
        del stiffness["EI"]
        rod |= {"points": points.round(12).tolist(), "initial_twist": 1.5}
        rod["cross_section"]["director"] = [0.2, 1.0, 0.3]
    load = {"distributed_force": {"rod": "rod", "force": _vector(model, 0.2, -0.6, 0.4)}}
    return {"model": model, "rods": [rod], "supports": copy.deepcopy(CLAMP), "loads": [load]}


def small(model: str, thing: Thing, nodes: int = NODES) -> Scene:
    """The scene of a model with a thing; with other nodes for things that name none."""
    scene, change = _base(model, nodes), thing(model)
    rod = change.pop("rod", {})
    if "points" in rod or "shape" in rod:
        for key in ("nodes", "from", "to", "points"):
            scene["rods"][0].pop(key, None)
    if "cross_section" in rod and model == "spatial":
        rod["cross_section"].setdefault("director", [0.2, 1.0, 0.3])
    scene["rods"][0] |= rod
    scene["rods"] += change.pop("rods", [])
    scene["loads"] += change.pop("loads", [])
    return scene | change


AT_REST: Scene = {"analysis": "static"}
IN_MOTION: Scene = {
    "time": {"duration": STEPS * 0.01, "step": 0.01, "integrator": "implicit_midpoint"}
}


def _small() -> dict[str, Scene]:
    """Each thing in each model that has it, at rest, in motion, and analysed."""
    found: dict[str, Scene] = {}
    for things, kinds in KINDS:
        for name, (models, thing) in things.items():
            for model in models:
                for kind in kinds:
                    scene = {**kind, **small(model, thing), "solver": SOLVER}
                    word = "motion" if "time" in scene else "static"
                    found[f"{name}-{model}-{word}"] = scene
    return found


def _vector(model: str, *xyz: float) -> list[float]:
    return list(xyz[:2] if model == "planar" else xyz)


def _moment(model: str, size: float) -> Any:
    return size if model == "planar" else [0.4 * size, -0.3 * size, size]


def _load(kind: str, **given: Any) -> Scene:
    return {"loads": [{kind: {"rod": "rod", **given}}]}


def _held(*supports: Scene, clamp: bool = True) -> Scene:
    return {"supports": [*(CLAMP if clamp else []), *({"rod": "rod", **s} for s in supports)]}


def _actuated(*changes: Scene) -> Scene:
    named = [{"name": f"part{i}", "rod": "rod", **change} for i, change in enumerate(changes)]
    return {"actuation": named}


COURSE = (0.0, 0.3, 0.8)


def _over_time(*values: Any) -> Scene:
    return {"times": TIMES, "values": list(values)}


def _vectors_over_time(model: str) -> Scene:
    return _over_time(*((c * np.array(_v(model)) + 0.1 * c**2).tolist() for c in COURSE))


def _smooth(size: float) -> Scene:
    return {**_over_time(0.0, 0.3 * size, size), "smooth": True}


def _swinging(amplitude: Any, shift: float = 0.3) -> Scene:
    offset = (shift * np.array(amplitude)).tolist()
    return {"sine": {"amplitude": amplitude, "frequency": 7.0, "phase": shift, "offset": offset}}


def _velocities(model: str) -> list[list[float]]:
    return [_vector(model, 0.1 * i, 0.2 - 0.05 * i**2, 0.1 * i * (i - 4)) for i in range(NODES)]


def _time(stepper: der.StepperInfo) -> Scene:
    if not stepper.implicit:
        return {"duration": STEPS * 1e-4, "step": 1e-4, "integrator": stepper.name}
    damped = {"spectral_radius": 0.7} if stepper.name == "generalized_alpha" else {}
    step = {"step": 0.01, "minimum_step": 1e-4}
    return {"duration": STEPS * 0.01, **step, "integrator": stepper.name, **damped}


def _motion(model: str, x: Any, y: Any, z: Any, angle: Any) -> Scene:
    """How a clamp is moved and turned."""
    if model == "planar":
        return {"x": x, "y": y, "angle": angle}
    return {"x": x, "y": y, "z": z, "rotation": {"axis": [1, 2, -1], "angle": angle}}


def _about_axes(model: str) -> Any:
    return 2.0 if model == "planar" else [0.5, 2.0, 0.3]


def _probe(**given: Any) -> Scene:
    return {"output": {"probes": {"own": given}}}


def _curvature(model: str, size: float) -> Any:
    return size if model == "planar" else [size, -0.6 * size]


def _curves(model: str) -> list[Any]:
    return [_curvature(model, 0.02 * i**2 - 0.5) for i in range(NODES)]


def _in_model(model: str, plane: Any) -> list[list[float]]:
    """Points of the plane, out of it in space."""
    x, y = np.asarray(plane, float).T
    columns = [x, y] if model == "planar" else [x, y, 0.3 * x * y + 0.1 * x]
    return np.column_stack(columns).round(12).tolist()  # type: ignore[no-any-return]


def _elbow(model: str) -> list[list[float]]:
    legs = [(0.1 * i, 0.0) for i in range(6)] + [(0.5, 0.1 * i) for i in range(1, 5)]
    return _in_model("planar" if model == "planar" else model, legs)


def _ring(model: str) -> list[list[float]]:
    angle = 2 * np.pi * np.arange(12) / 12
    return _in_model(model, np.column_stack([np.cos(angle), 0.7 * np.sin(angle)]) / 5)


def _shape(model: str) -> Scene:
    if model == "planar":
        shape: list[Scene] = [
            {"line": [0.3, 0.05]},
            {"arc": {"to": [0.6, 0.2], "through": [0.46, 0.104]}},
            {"arc": {"to": [0.65, 0.6], "centre": [0.025, 0.475]}},
            {"arc": {"to": [0.5, 0.9], "radius": 0.7, "longer": False}},
            {"spline": [[0.41, 1.1], [0.2, 1.2], [0.0, 1.15]]},
        ]
        return {"nodes": 13, "subdivide": 2, "from": [0.0, 0.0], "shape": shape}
    helix = {"axis": [0.2, 1.0, 0.3], "centre": [0.4, 0.2, 0.75], "pitch": -0.9, "turns": 0.15}
    shape = [
        {"line": [0.2, 0.05, 0.1]},
        {"arc": {"to": [0.4, 0.2, 0.2], "through": [0.31, 0.11, 0.16]}},
        {"helix": helix},
        {"spline": [[-0.1, 0.2, 0.8], [-0.1, 0.3, 1.0], [0.0, 0.4, 1.1]]},
    ]
    return {"nodes": 26, "from": [0.0, 0.0, 0.0], "shape": shape}


def _round(model: str) -> Scene:
    if model == "planar":
        arc = {"to": [0.4, 0.0], "through": [0.2, -0.1]}
        shape: list[Scene] = [{"arc": arc}, {"line": [0.15, 0.3]}, {"line": [0.0, 0.0]}]
        return {"closed": True, "nodes": 20, "from": [0.0, 0.0], "shape": shape}
    helix = {"axis": [0.2, 1.0, 0.3], "centre": [0.0, 0.0, 0.3], "pitch": 0, "turns": 1}
    return {"closed": True, "nodes": 16, "from": [0.3, 0.0, 0.1], "shape": [{"helix": helix}]}


def _uneven(model: str) -> list[list[float]]:
    s = np.array([0.0, 0.13, 0.22, 0.37, 0.48, 0.57, 0.7, 0.83, 1.0])
    return _in_model(model, np.column_stack([s, 0.4 * s**2]))


def _other_rod(model: str) -> Scene:
    other = copy.deepcopy(_base(model)["rods"][0])
    shift = np.array(_vector(model, 0.2, 1.5, 0.7))
    for key in ("points", "from", "to"):
        if key in other:
            other[key] = (np.array(other[key]) + shift).tolist()
    stiffer = {key: 3.0 * value for key, value in other["cross_section"]["stiffness"].items()}
    return {
        **other,
        "name": "other",
        "cross_section": {**other["cross_section"], "stiffness": stiffer},
    }


def _joined(kind: str) -> Thing:
    """An arm that leaves the rod, with all that acts on a joint; its end meets a third rod."""

    def thing(model: str) -> Scene:
        rod = _base(model)["rods"][0]
        at = np.array(rod["points"][4])
        stiffness = {"EA": 400.0, "EI": 0.3, "mass_per_length": 0.2}
        knee = (at + np.array([0.3, -0.4])).round(12).tolist()

        def straight(name: str, start: list[float], end: list[float]) -> Scene:
            section = {"stiffness": dict(stiffness)}
            return {"name": name, "nodes": 7, "from": start, "to": end, "cross_section": section}

        arm = {**straight("arm", at.tolist(), knee), "subdivide": 2, "natural_curvature": 0.6}
        foot = straight("foot", knee, [knee[0] + 0.4, knee[1] + 0.1])
        hip = [{"rod": "rod", "at": {"node": 4}}, {"rod": "arm", "at": "start"}]
        ankle = [{"rod": "arm", "at": "end"}, {"rod": "foot", "at": "start"}]
        turnings: dict[str, Scene] = {
            "rigid": {"joint": "hip"},
            "hinge": {"rod": "arm", "at": "start"},
            "driven": {"rod": "rod", "at": {"node": 4}},
        }
        probed = {"quantity": "rotation", "joint": "ankle"}
        kinds: dict[str, Scene] = {
            "rigid": {},
            "hinge": {"kind": "hinge", "spring": {"rotational_stiffness": 0.6}, "damping": 0.02},
            "driven": {"kind": "hinge", "prescribe": {"angle": 0.4}},
        }
        between = [{"moment": {"joint": "hip", "moment": 0.1}}] if kind == "hinge" else []
        return {
            "rods": [arm, foot],
            "joints": [
                {"name": "hip", "of": hip, **kinds[kind]},
                {"name": "ankle", "of": ankle},
            ],
            "springs": [
                {"name": "tendon", "between": ["hip", "ankle"], "stiffness": 3.0, "damping": 0.05},
                {"name": "tie", "between": ["ankle", "hip"], "stiffness": 1.0, "rest_length": 0.3},
            ],
            "supports": [
                *CLAMP,
                {**turnings[kind], "spring": {"rotational_stiffness": 0.8}},
                {"rod": "foot", "at": "end", "fix": ["y"]},
                {"joint": "ankle", "spring": {"stiffness": 2.0}},
            ],
            "loads": [
                {"gravity": _v(model)},
                {"moment": {"joint": "ankle", "moment": 0.05}},
                {"point_force": {"joint": "hip", "force": _v(model)}},
                {"point_force": {"rod": "arm", "at": 0.21, "force": _v(model)}},
                *between,
            ],
            "output": {
                "probes": {
                    "own": probed,
                    "pull": {"quantity": "force_x", "joint": "ankle", "leg": "foot"},
                    "bend": {"quantity": "moment_z", "joint": "hip", "leg": "rod"},
                    "length": {"quantity": "spring_length", "spring": "tie"},
                    "tie": {"quantity": "spring_force", "spring": "tie"},
                }
            },
        }

    return thing


def _joined_in_space(kind: str) -> Thing:
    """The same in space: an arm that leaves the twisted strip, and a third rod at its end."""

    def thing(model: str) -> Scene:
        at = np.array(_base(model)["rods"][0]["points"][4])
        stiffness = {"EA": 400.0, "EI1": 0.3, "EI2": 0.5, "GJ": 0.2, "mass_per_length": 0.2}
        stiffness |= {"rotary_inertia": 1e-3}
        knee = (at + np.array([0.3, -0.4, 0.2])).round(12)

        def straight(name: str, start: np.ndarray, end: np.ndarray) -> Scene:
            section = {"stiffness": dict(stiffness), "director": [0.2, 0.3, 1.0]}
            ends = {"from": start.tolist(), "to": end.tolist()}
            return {"name": name, "nodes": 7, **ends, "cross_section": section}

        arm = {**straight("arm", at, knee), "natural_curvature": [0.6, -0.3], "initial_twist": 0.8}
        foot = straight("foot", knee, (knee + np.array([0.4, 0.1, -0.2])).round(12))
        hip = [{"rod": "rod", "at": {"node": 4}}, {"rod": "arm", "at": "start"}]
        ankle = [{"rod": "arm", "at": "end"}, {"rod": "foot", "at": "start"}]
        turning = {"rod": "arm", "at": "start"}
        return {
            "rods": [arm, foot],
            "joints": [
                {"name": "hip", "of": hip, "kind": kind},
                {"name": "ankle", "of": ankle},
            ],
            "springs": [
                {"name": "tie", "between": ["ankle", "hip"], "stiffness": 1.0, "rest_length": 0.3}
            ],
            "supports": [
                *CLAMP,
                {**turning, "spring": {"rotational_stiffness": [0.8, 0.8, 0.3]}},
                {"rod": "foot", "at": "end", "fix": ["x", "y", "z"]},
                {"joint": "ankle", "spring": {"stiffness": [2.0, 2.0, 2.0]}},
            ],
            "loads": [
                {"gravity": _v(model)},
                {"moment": {"joint": "ankle", "moment": [0.05, -0.02, 0.03]}},
                {"point_force": {"rod": "arm", "at": 0.21, "force": _v(model)}},
                {"point_force": {"rod": "foot", "at": 0.2, "force": _v(model), "follower": True}},
                {"moment": {"rod": "foot", "at": "end", "moment": [0.1, -0.2, 0.1]}},
            ],
            "output": {
                "probes": {
                    "own": {"quantity": "torque", "rod": "arm", "at": "end", "side": "before"},
                    "pull": {"quantity": "tension", "rod": "foot", "at": "start"},
                    "bend": {"quantity": "moment", "rod": "arm", "at": "start"},
                    "length": {"quantity": "spring_length", "spring": "tie"},
                    "tie": {"quantity": "spring_force", "spring": "tie"},
                }
            },
        }

    return thing


ALL, TWISTS, FLAT, STRIP = MODELS, ("planar", "spatial"), ("planar",), ("spatial",)
UNTWISTED = ("planar", "spatial_bend")


def _v(model: str) -> list[float]:
    return _vector(model, 0.7, -1.3, 0.9)


#: Things that stay the same over time, with the models that have them.
THINGS: dict[str, tuple[tuple[str, ...], Thing]] = {
    # Loads
    "gravity": (ALL, lambda m: {"loads": [{"gravity": _v(m)}]}),
    "force at the end": (ALL, lambda m: _load("point_force", at="end", force=_v(m))),
    "force at a node": (ALL, lambda m: _load("point_force", at={"node": 4}, force=_v(m))),
    "force between nodes": (ALL, lambda m: _load("point_force", at=BETWEEN, force=_v(m))),
    "forces at all nodes": (ALL, lambda m: _load("point_force", at="all", force=_v(m))),
    "follower force": (
        TWISTS,
        lambda m: _load("point_force", at="end", force=_v(m), follower=True),
    ),
    "follower force between nodes": (
        TWISTS,
        lambda m: _load("point_force", at=BETWEEN, force=_v(m), follower=True),
    ),
    "moment at the end": (TWISTS, lambda m: _load("moment", at="end", moment=_moment(m, 0.4))),
    "moment at a node": (TWISTS, lambda m: _load("moment", at="middle", moment=_moment(m, 0.4))),
    "moment between nodes": (TWISTS, lambda m: _load("moment", at=BETWEEN, moment=_moment(m, 0.4))),
    "follower moment": (
        TWISTS,
        lambda m: _load("moment", at={"node": -3}, moment=_moment(m, 0.4), follower=True),
    ),
    "distributed force": (ALL, lambda m: _load("distributed_force", force=_v(m))),
    "distributed force on a part": (
        ALL,
        lambda m: _load("distributed_force", force=_v(m), **{"from": 0.25, "to": 0.63}),
    ),
    "foundation": (ALL, lambda m: _load("foundation", stiffness=3.0)),
    "foundation of a part": (
        ALL,
        lambda m: _load(
            "foundation", stiffness=_vector(m, 2.0, 6.0, 4.0), **{"from": 0.15, "to": 0.65}
        ),
    ),
    "loads together": (
        TWISTS,
        lambda m: {
            "loads": [
                {"gravity": _v(m)},
                {"point_force": {"rod": "rod", "at": BETWEEN, "force": _v(m)}},
                {"point_force": {"rod": "rod", "at": "end", "force": _v(m), "follower": True}},
                {"moment": {"rod": "rod", "at": 0.3, "moment": _moment(m, 0.3)}},
                {
                    "moment": {
                        "rod": "rod",
                        "at": "end",
                        "moment": _moment(m, 0.2),
                        "follower": True,
                    }
                },
                {"foundation": {"rod": "rod", "stiffness": 3.0}},
            ]
        },
    ),
    # Supports
    "pins": (
        ALL,
        lambda m: _held(
            {"at": "start", "fix": list("xyz"[: len(_v(m))])},
            {"at": "end", "fix": list("xyz"[1 : len(_v(m))])},
            {"at": {"node": 3}, "fix": ["x"]},
            clamp=False,
        ),
    ),
    "clamps at both ends": (TWISTS, lambda m: _held({"at": "end", "clamp": True})),
    "clamp that slides": (
        TWISTS,
        lambda m: _held({"at": "end", "clamp": True, "free": ["x"]}),
    ),
    "guide": (TWISTS, lambda m: _held({"at": "end", "clamp": True, "free": ["x", "y"]})),
    "tangents held": (
        ALL,
        lambda m: _held(
            {"at": "start", "clamp": "tangent"}, {"at": "end", "clamp": "tangent"}, clamp=False
        ),
    ),
    "clamp inside": (TWISTS, lambda m: _held({"at": {"node": 4}, "clamp": True})),
    "bearing inside": (ALL, lambda m: _held({"at": {"node": 4}, "clamp": "tangent"})),
    "all nodes held": (
        ALL,
        lambda m: _held(
            {"at": "all", "fix": ["y"]},
            {"at": "start", "spring": {"stiffness": _vector(m, 40.0, 0.0, 30.0)}},
            clamp=False,
        ),
    ),
    "spring": (
        ALL,
        lambda m: _held(
            {"at": BETWEEN, "spring": {"stiffness": 7.0, "anchor": _vector(m, 0.5, 0.3, 0.1)}}
        ),
    ),
    "spring along axes": (
        ALL,
        lambda m: {
            **_held({"at": "end", "spring": {"stiffness": _vector(m, 7.0, 2.0, 0.0)}}),
            **_probe(quantity="reaction_x", support=1),
        },
    ),
    "springs alone": (
        TWISTS,
        lambda m: _held(
            {"at": "start", "spring": {"stiffness": 40.0, "rotational_stiffness": 2.0}},
            {"at": "end", "spring": {"stiffness": 30.0}},
            clamp=False,
        ),
    ),
    "rotational spring": (
        TWISTS,
        lambda m: _held({"at": BETWEEN, "spring": {"rotational_stiffness": 1.5}}),
    ),
    "rotational spring at the end": (
        TWISTS,
        lambda m: _held({"at": "end", "spring": {"rotational_stiffness": 1.5}}),
    ),
    "springs together": (
        TWISTS,
        lambda m: {
            **_load("foundation", stiffness=3.0, **{"from": 0.2}),
            **_held(
                {"at": "start", "fix": list("xyz"[: len(_v(m))])},
                {"at": "start", "spring": {"rotational_stiffness": _about_axes(m)}},
                {"at": 0.61, "spring": {"stiffness": 7.0}},
                {"at": "end", "spring": {"rotational_stiffness": 0.7}},
                clamp=False,
            ),
        },
    ),
    "rotational spring about three axes": (
        STRIP,
        lambda m: _held({"at": {"node": 5}, "spring": {"rotational_stiffness": [1.5, 0.7, 0.4]}}),
    ),
    # Actuations
    "curvature": (
        TWISTS,
        lambda m: _actuated({"from": 0.15, "to": 0.62, "natural_curvature": _curvature(m, 1.5)}),
    ),
    "smooth curvature": (
        TWISTS,
        lambda m: _actuated({"natural_curvature": _curvature(m, 1.5), "profile": "smooth"}),
    ),
    "linear curvature": (
        TWISTS,
        lambda m: _actuated(
            {"from": 0.2, "natural_curvature": _curvature(m, 1.5), "profile": "linear"}
        ),
    ),
    "elongation": (
        ALL,
        lambda m: {
            **_actuated(
                {"from": 0.15, "to": 0.62, "elongation": 0.05},
                {"from": 0.4, "elongation": 0.03, "profile": "smooth"},
            ),
            **_probe(quantity="actuation_force", actuation="part1"),
        },
    ),
    "twist": (
        STRIP,
        lambda m: _actuated(
            {"from": 0.15, "to": 0.62, "natural_twist": 1.2},
            {"natural_twist": -0.8, "profile": "smooth"},
        ),
    ),
    "actuations together": (
        TWISTS,
        lambda m: _actuated(
            {"from": 0.2, "to": 0.71, "natural_curvature": _curvature(m, 1.3)},
            {"from": 0.4, "natural_curvature": _curvature(m, -0.8), "profile": "linear"},
            {"from": 0.3, "to": 0.5, "elongation": 0.1},
            *([{"to": 0.6, "natural_twist": 2.1, "profile": "smooth"}] if m == "spatial" else []),
        ),
    ),
    # Joints
    "joint": (FLAT, _joined("rigid")),
    "hinge": (FLAT, _joined("hinge")),
    "joint in space": (STRIP, _joined_in_space("rigid")),
    "ball": (STRIP, _joined_in_space("ball")),
    "joint beside actuations": (
        FLAT,
        lambda m: {
            **_joined("rigid")(m),
            "actuation": [
                {"name": "a", "rod": "arm", "from": 0.1, "to": 0.33, "natural_curvature": 1.1},
                {"name": "b", "rod": "arm", "natural_curvature": 0.4, "profile": "smooth"},
                {"name": "c", "rod": "foot", "elongation": 0.05},
            ],
        },
    ),
    "joint beside a follower force": (
        FLAT,
        lambda m: {
            **_joined("rigid")(m),
            "loads": [
                {"point_force": {"rod": "arm", "at": 0.21, "force": _v(m), "follower": True}},
                {"point_force": {"joint": "ankle", "force": [0.3, 0.1], "follower": True}},
            ],
        },
    ),
    # Rods
    "natural curvature": (TWISTS, lambda m: {"rod": {"natural_curvature": _curvature(m, 0.8)}}),
    "natural curvatures": (TWISTS, lambda m: {"rod": {"natural_curvature": _curves(m)}}),
    "natural twist": (STRIP, lambda m: {"rod": {"natural_twist": 0.7}}),
    "natural twists": (
        STRIP,
        lambda m: {"rod": {"natural_twist": [0.1 * i**1.5 for i in range(NODES)]}},
    ),
    "straight without stress": (ALL, lambda m: {"rod": {"natural_curvature": 0}}),
    "tangent measure": (ALL, lambda m: {"rod": {"curvature": "tangent"}}),
    "corner": (TWISTS, lambda m: {"rod": {"points": _elbow(m)}}),
    "corner in the tangent measure": (
        TWISTS,
        lambda m: {"rod": {"points": _elbow(m), "curvature": "tangent"}},
    ),
    "ring": (TWISTS, lambda m: {"rod": {"points": _ring(m), "closed": True}}),
    "uneven edges": (TWISTS, lambda m: {"rod": {"points": _uneven(m)}}),
    "shape": (TWISTS, lambda m: {"rod": _shape(m)}),
    "round shape": (TWISTS, lambda m: {"rod": _round(m)}),
    "three nodes": (TWISTS, lambda m: {"rod": {"points": _uneven(m)[::4]}}),
    "cable": (
        UNTWISTED,
        lambda m: {
            "rod": {
                "cross_section": {"stiffness": {"EA": 500.0, "EI": 0.0, "mass_per_length": 0.3}}
            },
            "loads": [{"gravity": _v(m)}],
            **_held(
                {"at": "start", "fix": list("xyz"[: len(_v(m))])},
                {"at": "end", "fix": list("xyz"[: len(_v(m))])},
                clamp=False,
            ),
        },
    ),
    "circle": (
        ALL,
        lambda m: {"rod": {"cross_section": {"circle": {"radius": 0.02}}, "material": MATERIAL}},
    ),
    "tube": (
        ALL,
        lambda m: {
            "rod": {
                "cross_section": {"tube": {"inner_radius": 0.01, "outer_radius": 0.02}},
                "material": {"youngs_modulus": 1e7, "shear_modulus": 4e6, "density": 1000},
            }
        },
    ),
    "rectangle": (
        TWISTS,
        lambda m: {
            "rod": {
                "cross_section": {"rectangle": {"width": 0.05, "height": 0.02}},
                "material": MATERIAL,
            }
        },
    ),
    "ellipse": (
        TWISTS,
        lambda m: {
            "rod": {
                "cross_section": {"ellipse": {"width": 0.05, "height": 0.03}},
                "material": MATERIAL,
            }
        },
    ),
}

#: Things that a motion cannot begin with.
RESTS: dict[str, tuple[tuple[str, ...], Thing]] = {
    "turned clamp": (
        ALL,
        lambda m: _held(
            {"at": "start", "clamp": True, "prescribe": _motion(m, 0.05, -0.03, 0.02, 0.4)},
            clamp=False,
        ),
    ),
    "twisted end": (
        STRIP,
        lambda m: _held({"at": "end", "clamp": True, "prescribe": {"twist": 0.8, "x": -0.05}}),
    ),
    "driven hinge": (FLAT, _joined("driven")),
}


def _stepped(stepper: der.StepperInfo, *, turns: bool) -> Thing:
    """Forces of all kinds on a rod whose clamp stays, or moves, turns and spins."""

    def thing(model: str) -> Scene:
        # In the few steps of explicit steppers, what a force between nodes starts is a wave of the
        # length of an edge, which no neighbours resolve.
        at = BETWEEN if stepper.implicit else {"node": 4}
        loads = [
            {"gravity": _v(model)},
            {"damping": {"coefficient": 0.1}},
            {"point_force": {"rod": "rod", "at": at, "force": _v(model)}},
        ]
        scene: Scene = {"time": _time(stepper), "loads": loads}
        if not turns:
            return scene
        prescribed = _motion(model, _smooth(0.1), _smooth(-0.2), _smooth(0.15), _smooth(1.0))
        if model == "spatial":
            prescribed["twist"] = _smooth(1.5)
        clamp: Scene = {"at": "start", "clamp": "tangent" if model == "spatial_bend" else True}
        return {**scene, **_held({**clamp, "prescribe": prescribed}, clamp=False)}

    return thing


DAMPING_TIMES = {"bending": 0.02, "twisting": 0.03, "stretching": 0.001}


def _internal_damping(model: str) -> Scene:
    stiffness = _base(model)["rods"][0]["cross_section"]["stiffness"]
    section = {"stiffness": {**stiffness, "damping": DAMPING_TIMES}}
    return {"rod": {"cross_section": section}, "loads": [{"gravity": _v(model)}]}


#: Things that move, or need a motion.
MOTIONS: dict[str, tuple[tuple[str, ...], Thing]] = {
    "gravity over time": (
        ALL,
        lambda m: {"loads": [{"gravity": _vectors_over_time(m)}]},
    ),
    "fluid": (
        ALL,
        lambda m: {
            "rod": {
                "spheres": [
                    {"at": "all", "radius": 0.01, "density": 2000},
                    {"at": {"node": 3}, "radius": 0.03, "density": 1500},
                    {"at": "end", "radius": 0.02, "density": 1500},
                ]
            },
            "loads": [{"fluid": {"density": 500, "viscosity": 2}}, {"gravity": _v(m)}],
        },
    ),
    "damping": (ALL, lambda m: _load("damping", coefficient=1.5)),
    "internal damping": (("planar", "spatial"), _internal_damping),
    "internal damping beside a joint": (
        FLAT,
        lambda m: {**_joined("rigid")(m), **_internal_damping(m)},
    ),
    "internal damping of a material": (
        ("planar", "spatial"),
        lambda m: {
            "rod": {
                "cross_section": {"circle": {"radius": 0.02}},
                "material": {**MATERIAL, "damping": DAMPING_TIMES},
            },
            "loads": [{"gravity": _v(m)}],
        },
    ),
    "force over time": (
        ALL,
        lambda m: _load("point_force", at=BETWEEN, force={**_vectors_over_time(m), "smooth": True}),
    ),
    "swinging force": (
        ALL,
        lambda m: {
            "loads": [
                {
                    "name": "swing",
                    "distributed_force": {"rod": "rod", "force": _swinging(_v(m))},
                }
            ]
        },
    ),
    "moment over time": (
        TWISTS,
        lambda m: _load("moment", at=BETWEEN, moment=_over_time(*(_moment(m, c) for c in COURSE))),
    ),
    "swinging moment": (
        TWISTS,
        lambda m: _load("moment", at="end", moment=_swinging(_moment(m, 0.4))),
    ),
    "moving clamp": (
        ALL,
        lambda m: _held(
            {
                "name": "hand",
                "at": "start",
                "clamp": "tangent" if m == "spatial_bend" else True,
                "prescribe": _motion(
                    m, _smooth(0.1), _smooth(-0.2), _over_time(*COURSE), _smooth(1.0)
                ),
            },
            clamp=False,
        ),
    ),
    "swinging pin": (
        ALL,
        lambda m: _held({"at": "end", "prescribe": {"y": _swinging(0.03, shift=0.0)}}),
    ),
    "spun clamp": (
        STRIP,
        lambda m: _held(
            {"at": "start", "clamp": True, "prescribe": {"twist": _smooth(3.0)}}, clamp=False
        ),
    ),
    "curvature over time": (
        TWISTS,
        lambda m: _actuated(
            {
                "from": 0.15,
                "to": 0.62,
                "natural_curvature": _smooth(2.0)
                if m == "planar"
                else [_smooth(2.0), _over_time(*COURSE)],
            }
        ),
    ),
    "twist over time": (STRIP, lambda m: _actuated({"natural_twist": _over_time(*COURSE)})),
    "elongation over time": (ALL, lambda m: _actuated({"elongation": _swinging(0.05)})),
    "thrown": (ALL, lambda m: {"rod": {"initial_velocity": _v(m)}, "supports": []}),
    "tumbling": (ALL, lambda m: {"rod": {"initial_velocity": _velocities(m)}, "supports": []}),
    "from equilibrium": (
        ALL,
        lambda m: {
            **_load("point_force", at=BETWEEN, force=_vectors_over_time(m)),
            "start_from": "equilibrium",
        },
    ),
    "two rods": (
        ALL,
        lambda m: {
            "rods": [_other_rod(m)],
            "supports": [*CLAMP, {"rod": "other", "at": "end", "clamp": True}],
            "loads": [{"gravity": _v(m)}, {"damping": {"rod": "other", "coefficient": 0.7}}],
        },
    ),
    "adaptive": (ALL, lambda m: {"time": {"duration": 0.02, "tolerance": 1e-3}}),
    "largest stable step": (
        ALL,
        lambda m: {"time": {"duration": 0.01, "step": "auto", "integrator": "verlet"}},
    ),
    **{
        stepper.name + words: (
            ALL if stepper.name != "energy_momentum" else FLAT,
            _stepped(stepper, turns=turns),
        )
        for stepper in der.steppers()
        for words, turns in (("", False), (" and a clamp that turns", True))
    },
}

#: Analyses of the rod under its force.
ANALYSES: dict[str, tuple[tuple[str, ...], Thing]] = {
    "modes": (ALL, lambda m: {"analysis": {"modes": {"count": 5}}}),
    "buckling": (ALL, lambda m: {"analysis": {"buckling": {"count": 2}}}),
    "path of loads": (
        ALL,
        lambda m: {
            "loads": [{"gravity": _v(m)}],
            "analysis": {"continuation": {"vary": "loads", "to": 1.5, "step": 0.2}},
        },
    ),
    "path of a load": (
        ALL,
        lambda m: {
            "loads": [{"gravity": _v(m)}],
            "analysis": {"continuation": {"vary": "loads.0", "from": 0.2, "to": 1.0, "step": 0.2}},
        },
    ),
    "any equilibrium": (ALL, lambda m: {"analysis": {"static": {"stability": "any"}}}),
}

#: Which things are run how.
KINDS: tuple[tuple[dict[str, tuple[tuple[str, ...], Thing]], tuple[Scene, ...]], ...] = (
    (THINGS, (AT_REST, IN_MOTION)),
    (RESTS, (AT_REST,)),
    (MOTIONS, (IN_MOTION,)),
    (ANALYSES, ({},)),
)


def free_rods() -> dict[str, Scene]:
    """Rods that nothing holds or loads, thrown, spinning, and vibrating: without a time."""
    found: dict[str, Scene] = {}
    for name, (models, thing) in FREE.items():
        for model in models:
            scene = small(model, thing) | {"supports": [], "loads": []}
            points = der.Model(der.Scenario.from_dict({**scene, "analysis": "static"}))
            scene["rods"][0]["initial_velocity"] = _spinning(points.initial_positions)
            found[f"{name}-{model}"] = scene
    return found


def _spinning(points: Any) -> list[list[float]]:
    """Velocities of nodes that turn about all axes that they have, fly, and stretch."""
    flying = np.array([-0.4, 0.5, 0.3])[: points.shape[1]]
    arms = points - points.mean(axis=0)
    if points.shape[1] == 2:
        turning = 3.0 * arms @ [[0.0, 1.0], [-1.0, 0.0]]
    else:
        turning = np.cross([2.0, -1.0, 3.0], arms)
    return (flying + turning + 0.3 * arms).tolist()  # type: ignore[no-any-return]


#: Rods that are let go.
FREE: dict[str, tuple[tuple[str, ...], Thing]] = {
    "smooth": (ALL, lambda m: {}),
    "corner": (TWISTS, lambda m: {"rod": {"points": _elbow(m)}}),
    "ring": (TWISTS, lambda m: {"rod": {"points": _ring(m), "closed": True}}),
    "spheres": (
        ALL,
        lambda m: {"rod": {"spheres": [{"at": {"node": 3}, "radius": 0.03, "density": 1500}]}},
    ),
}
