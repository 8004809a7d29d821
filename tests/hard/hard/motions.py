"""Violent motion: snap-through, cables going taut, whips, nodes without mass, spinning rods."""

from __future__ import annotations

import functools

import der
import numpy as np

from .case import Limit, Reading, hard, refused_if_explicit, worst
from .setting import Array, Scene, Setting, final, line


def arch(nodes: int) -> Array:
    x = np.linspace(0.0, 1.0, nodes)
    return np.column_stack([x, 0.1 * np.sin(np.pi * x)])


@hard(
    "Snap-through",
    "straight rod held as an arch, pushed through, with damping",
    "the stable equilibrium on the other side, by statics",
    motion=True,
)
def snap_through(s: Setting) -> Reading:
    force = {"times": [0, 0.1], "values": s.vectors([[0, 0], [0, -80]])}
    scene = s.scene(
        s.rod(arch(9), natural_curvature=0),
        [{"at": "start", **s.pin}, {"at": "end", **s.pin}],
        loads=[
            {"point_force": {"rod": "rod", "at": "middle", "force": force}},
            {"damping": {"coefficient": 15.0}},
        ],
        time=s.time(2.0, 400),
        output={"every": 2.0},
    )
    mirrored = arch(9) * [1.0, -1.0]
    there = s.scene(
        s.rod(mirrored, natural_curvature=0),
        scene["supports"],
        loads=[{"point_force": {"rod": "rod", "at": "middle", "force": s.vector(0, -80)}}],
    )
    moved = final(der.run(scene), s)
    still = final(der.run(there), s)
    assert still[4, 1] < -0.05
    return Reading(float(np.abs(moved - still).max()), 1e-4)


@hard(
    "A slack cable going taut",
    "heavy cable without bending stiffness, its end pulled from 0.8 to 1.01 of its length",
    "EA times the strain of the chord, and the weight's part of it",
    motion=True,
)
def goes_taut(s: Setting) -> Reading:
    x = np.linspace(0, 1, 11)
    turn = 1.9  # half the angle of an arc of length 1
    drawn = np.column_stack([np.sin(turn * (x - 0.5)), -np.cos(turn * (x - 0.5))]) / turn
    drawn -= drawn[0]
    chord = float(drawn[-1, 0])
    edge = float(np.linalg.norm(np.diff(drawn, axis=0), axis=1).sum())
    table = {"times": [0, 1], "values": [0, 1.01 * edge - chord], "smooth": True}
    EA = 1e3
    scene = s.scene(
        s.rod(
            drawn,
            EA=EA,
            EI=0,
            natural_curvature=0,
            GJ=1e-3,
            rotary_inertia=1e-3,
            mass_per_length=0.02,
        ),
        [{"at": "start", **s.pin}, {"at": "end", "prescribe": s.moved(table)}],
        loads=[{"gravity": s.vector(0, -9.81)}, {"damping": {"coefficient": 1.0}}],
        time=s.time(3.0, 600),
        output={"every": 3.0},
    )
    result = der.run(scene)
    _, tension = result.along("rod", "tension")
    exact = 0.01 * EA
    weight = (0.02 * 9.81 / exact) ** 2 / 24 / 0.01  # of the strain, which the sag needs
    return Reading(float(np.abs(tension[-1] / exact - 1.0).max()), 2 * weight + 5e-3)


WHIP_STEP = 2e-3


@functools.cache
def _whip(model: str) -> Array:
    """The whip's shape by a stepper of order 5 in steps an eighth as long."""
    fine = next(info for info in der.steppers() if info.name == "sdirk5")
    s = Setting(model, fine, "", None, False)
    return final(
        der.run(whip(s, {"duration": 1.0, "step": WHIP_STEP / 8, "integrator": fine.name})), s
    )


def whip(s: Setting, time: Scene) -> Scene:
    """A soft rod falls from the horizontal; its free end cracks after 0.9 s."""
    section = {"circle": {"radius": 0.01}}
    rod = {
        "name": "rod",
        "points": s.vectors(line(11)),
        "cross_section": section,
        "material": {"youngs_modulus": 1e7, "density": 1000, "poissons_ratio": 0.3},
    }
    return s.scene(
        rod,
        [{"at": "start", **s.clamp}],
        loads=[{"gravity": s.vector(0, -9.81)}],
        time=time,
        output={"every": 1.0},
    )


@hard(
    "Whip cracking",
    "soft rod that swings down for 1 s, in steps of 2 ms",
    "steps of 0.25 ms by sdirk5; errors of docs/steppers.md, by the order",
    motion=True,
)
def whips(s: Setting) -> Reading:
    shape = final(der.run(whip(s, s.time(1.0, 500))), s)
    size = {1: 30.0 * WHIP_STEP, 2: 400.0 * WHIP_STEP**2}[s.order]
    return Reading(float(np.abs(shape - _whip(s.model)).max()), size)


def massless_expected(s: Setting) -> str:
    """Every free node needs a mass in a run over time."""
    return refused_if_explicit(s) if s.value else "invalid_scene"


@hard(
    "Nodes nearly without mass",
    "cantilever with a weight of 1 kg at its tip, 100 steps in a quarter period",
    "sqrt(3 EI/(m L^3)); explicit steps, and no mass at all, refused before the run",
    motion=True,
    values={"1e-12 kg/m": 1e-12, "no mass": 0.0},
    expected=massless_expected,
)
def massless(s: Setting) -> Reading:
    x = line(9)
    rate, amplitude, radius = np.sqrt(3.0), 1e-2, 0.01
    shape = (3 * x[:, 0] ** 2 - x[:, 0] ** 3) / 2
    velocity = np.column_stack([0 * shape, amplitude * rate * shape])
    rod = s.rod(
        x,
        EA=1e6,
        mass_per_length=s.value,
        rotary_inertia=1e-6,
        initial_velocity=s.vectors(velocity),
        spheres=[{"at": "end", "radius": radius, "density": 1 / (4 / 3 * np.pi * radius**3)}],
    )
    quarter = np.pi / 2 / rate
    scene = s.scene(
        rod,
        [{"at": "start", **s.clamp}],
        time=s.time_in(quarter / 100, 100),
        output={"every": quarter},
    )
    tip = final(der.run(scene), s)[-1, 1]
    allowed = s.time_error(rate, quarter, 100) + 20 * amplitude**2
    return Reading(abs(tip / amplitude - 1.0), allowed)


@hard(
    "Spinning rods",
    "free rod that turns by 10 rad in its plane, 500 steps",
    "rigid rotation; angular momentum to 1e-6 of the steppers that keep it",
    motion=True,
    values={"EA L^2/EI = 1e2": 1e4, "1e4": 1e6},
    limits=(
        Limit(
            "In a fast turn of a stiff rod its order is lower, and it creates angular momentum. "
            "Steps of half the length have a tenth of the error.",
            ("wrong",),
            lambda s: s.stepper is not None and s.stepper.name == "sdirk4" and s.value == 1e6,
        ),
    ),
)
def spins(s: Setting) -> Reading:
    rate, steps = 10.0, 500
    x = line(5)
    velocity = np.column_stack([np.zeros(5), rate * (x[:, 0] - 0.5)])
    rod = s.rod(x, EA=s.value, EI=1e2, GJ=1e2, initial_velocity=s.vectors(velocity))
    scene = s.scene(rod, time=s.time(1.0, steps), output={"every": 1.0})
    simulation = der.Simulation(scene)
    before = np.array(simulation.angular_momentum)
    shape = final(simulation.run(), s)
    along = shape[-1] - shape[0]
    turned = np.angle(np.exp(1j * (np.arctan2(along[1], along[0]) - rate)))
    drift = float(np.abs(simulation.angular_momentum - before).max() / np.abs(before).max())
    assert s.stepper is not None
    in_time = s.time_error(rate, 1.0, steps)
    return worst(
        # The rod stretches by rate^2/EA at most, and turns the slower for it.
        Reading(abs(float(turned)), rate * in_time + 0.25 * rate**3 / s.value),
        Reading(drift, 1e-6 if s.stepper.keeps_angular_momentum else in_time),
    )


@hard(
    "Spinning rods",
    "free rod that spins about itself by 1000 rad, 200 steps",
    "angle = rate times time, straight",
    motion=True,
    models=("spatial",),
)
def spins_about_itself(s: Setting) -> Reading:
    scene = s.scene(s.rod(line(5)), time=s.time(1.0, 200), output={"every": 1.0})
    simulation = der.Simulation(scene)
    simulation.spin[:] = 1000.0
    result = simulation.run()
    error = np.abs(np.asarray(simulation.theta) / 1000.0 - 1.0).max()
    moved = np.abs(result.positions[-1] - result.positions[0]).max()
    return worst(Reading(float(error), 1e-10), Reading(float(moved), 1e-10))
