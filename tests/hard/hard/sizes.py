"""Nanometres to kilometres, and far from the origin."""

from __future__ import annotations

import der
import numpy as np

from .case import Reading, hard
from .setting import Array, Scene, Setting, final, line, tip_force

SIZES = {"1 nm": 1e-9, "1 um": 1e-6, "1 km": 1e3}
TOPIC = "Nanometres to kilometres"
FAR = "1e8 m from the origin"


def of_size(s: Setting, length: float, *, time: Scene | None = None) -> Scene:
    """A cantilever of a given length, slenderness, density and load in units of its own."""
    modulus, density = 1e7, 1e3
    radius = 0.05 * length
    bending = modulus * np.pi * radius**4 / 4
    rod = {
        "name": "rod",
        "points": s.vectors(line(9) * length),
        "cross_section": {"circle": {"radius": radius}},
        "material": {"youngs_modulus": modulus, "density": density, "poissons_ratio": 0.3},
    }
    more: Scene = {"loads": [tip_force(s, 0.0, bending / length**2)]}
    if time is not None:
        unit = length**2 * np.sqrt(density * np.pi * radius**2 / bending)
        scaled = {key: unit * value for key, value in time.items() if key in ("duration", "step")}
        assert s.stepper is not None
        more |= {
            "time": {"integrator": s.stepper.name, **scaled},
            "output": {"every": scaled["duration"]},
        }
    return s.scene(rod, [{"at": "start", **s.clamp}], **more)


def _answer(s: Setting, length: float, time: Scene | None = None) -> Array:
    return final(der.run(of_size(s, length, time=time)), s) / length


@hard(TOPIC, "cantilever under P L^2/EI = 1", "the answer of 1 m, to 1e-9", values=SIZES)
def size_at_rest(s: Setting) -> Reading:
    return Reading(float(np.abs(_answer(s, s.value) - _answer(s, 1.0)).max()), 1e-9)


@hard(
    TOPIC,
    "the same suddenly loaded, 500 steps",
    "the answer of 1 m, to 1e-7",
    motion=True,
    values=SIZES,
)
def size_in_motion(s: Setting) -> Reading:
    time = {"duration": 0.5, "step": 1e-3}
    return Reading(float(np.abs(_answer(s, s.value, time) - _answer(s, 1.0, time)).max()), 1e-7)


def _far(scene: Scene, away: float) -> Scene:
    rod = scene["rods"][0]
    return {**scene, "rods": [{**rod, "points": (np.array(rod["points"]) + away).tolist()}]}


# The drawn rod is rounded to 1.5e-8 m there, and so are the lengths and directions of its edges.
ROUNDING = 1e8 * np.finfo(float).eps


@hard(
    FAR,
    "cantilever of 1 m under P L^2/EI = 1",
    "the answer at the origin, to ten times the rounding of a coordinate over an edge",
)
def far_at_rest(s: Setting) -> Reading:
    scene = of_size(s, 1.0)
    moved = final(der.run(scene), s)
    far = s.in_plane(der.run(_far(scene, 1e8)).positions[-1] - 1e8)
    return Reading(float(np.abs(far - moved).max()), 10 * 8 * ROUNDING)


@hard(
    FAR,
    "the same suddenly loaded, 500 steps",
    "the answer at the origin, to ten times the rounding of a coordinate over an edge",
    motion=True,
)
def far_in_motion(s: Setting) -> Reading:
    scene = of_size(s, 1.0, time={"duration": 0.5, "step": 1e-3})
    moved = final(der.run(scene), s)
    far = s.in_plane(der.run(_far(scene, 1e8)).positions[-1] - 1e8)
    return Reading(float(np.abs(far - moved).max()), 10 * 8 * ROUNDING)
