"""Many turns of twist, tangents turned by half a turn in a step, rings."""

from __future__ import annotations

import der
import numpy as np

from .case import Limit, Reading, hard, worst
from .setting import Array, Setting, final, line

TWIST = "Many turns of twist"
TURNS = {"1 turn": 1, "10 turns": 10}


@hard(
    TWIST,
    "clamped rod, one end turned about itself",
    "torque = GJ 2 pi n/L",
    values=TURNS,
    long_values={"50 turns": 50, "1000 turns": 1000},
    models=("spatial",),
)
def twisted(s: Setting) -> Reading:
    end = {"at": "end", "clamp": True, "prescribe": {"twist": 2 * np.pi * s.value}}
    # 1e-4 of the bending stiffness: the rod stays straight up to 14,000 turns.
    rod = s.rod(line(9), GJ=1e-4)
    result = der.run(s.scene(rod, [{"at": "start", "clamp": True}, end]))
    _, torque = result.along("rod", "torque")
    exact = 1e-4 * 2 * np.pi * s.value
    return Reading(float(np.abs(torque[-1] / exact - 1.0).max()), 1e-9)


@hard(
    TWIST,
    "the same over 1 s, 400 steps",
    "mean twist = 2 pi n/L, all turns counted; the rod straight",
    motion=True,
    values={"1 turn": 1, "50 turns": 50},
    models=("spatial",),
)
def twisted_in_time(s: Setting) -> Reading:
    table = {"times": [0, 1], "values": [0, 2 * np.pi * s.value], "smooth": True}
    end = {"at": "end", "clamp": True, "prescribe": {"twist": table}}
    scene = s.scene(
        s.rod(line(9), GJ=1e-2, rotary_inertia=1e-4),
        [{"at": "start", "clamp": True}, end],
        time=s.time(1.0, 400),
        output={"every": 1.0},
    )
    result = der.run(scene)
    places, twist = result.along("rod", "twist")
    mean = np.sum((twist[-1, 1:] + twist[-1, :-1]) / 2 * np.diff(places))
    exact = 2 * np.pi * s.value
    moved = np.abs(final(result, s)[:, :2] - line(9)).max()
    return worst(Reading(abs(float(mean) / exact - 1.0), 1e-3), Reading(float(moved), 1e-6))


HALF = "Tangents turned by half a turn in a step"


@hard(HALF, "clamp of a straight rod turned by pi", "the rod turned by pi")
def half_turn(s: Setting) -> Reading:
    clamp = {"at": "start", **s.clamp, "prescribe": s.turned(np.pi)}
    tip = final(der.run(s.scene(s.rod(line(7)), [clamp])), s)
    return Reading(float(np.abs(tip[:, :2] + line(7)).max()), 1e-9)


@hard(
    HALF,
    "the same within one step of 10 ms in a viscous medium, 400 steps",
    "the rod turned by pi",
    motion=True,
    limits=(
        Limit(
            "The jump excites motion that steps of 10 ms do not resolve. A stepper without damping "
            "creates energy there, and is stopped.",
            ("unstable_motion",),
            lambda s: s.stepper is not None and s.stepper.name == "implicit_midpoint",
        ),
    ),
)
def half_turn_in_a_step(s: Setting) -> Reading:
    table = {"times": [0, 0.01], "values": [0, np.pi]}
    scene = s.scene(
        s.rod(line(7), EI=10.0, GJ=10.0, EA=1e3, mass_per_length=0.1, rotary_inertia=1e-2),
        [{"at": "start", **s.clamp, "prescribe": s.turned(table)}],
        loads=[{"damping": {"coefficient": 20.0}}],
        time=s.time(4.0, 400),
        output={"every": 4.0},
    )
    tip = final(der.run(scene), s)
    return Reading(float(np.abs(tip[:, :2] + line(7)).max()), 1e-4)


RINGS = "Rings"
CORNERS = 12


def _ring() -> Array:
    angle = 2 * np.pi * np.arange(CORNERS) / CORNERS
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _side() -> float:
    return float(2 * np.sin(np.pi / CORNERS))


@hard(
    RINGS,
    "straight wire glued to a ring of 12 edges",
    "energy of a regular polygon; it stays round",
    models=("planar", "spatial"),
)
def glued(s: Setting) -> Reading:
    straight = 0.0 if s.planar else [0.0, 0.0]
    rod = s.rod(_ring(), EA=1e8, closed=True, natural_curvature=straight)
    result = der.run(s.scene(rod))
    turn = 2 * np.pi / CORNERS
    exact = CORNERS * 0.5 * turn**2 / _side()
    energy = float(result.energies["bend"][-1])
    moved = np.abs(final(result, s)[:, :2] - _ring()).max()
    return worst(Reading(abs(energy / exact - 1.0), 1e-6), Reading(float(moved), 1e-6))


@hard(
    RINGS,
    "free ring that turns by 10 rad in its plane, 500 steps",
    "hoop strain between 0 and twice rho (R w)^2/EA; angular momentum",
    motion=True,
    models=("planar", "spatial"),
)
def ring_spins(s: Setting) -> Reading:
    rate, steps, EA = 10.0, 500, 1e5
    ring = _ring()
    velocity = rate * np.column_stack([-ring[:, 1], ring[:, 0]])
    rod = s.rod(ring, EA=EA, EI=10.0, GJ=10.0, closed=True, initial_velocity=s.vectors(velocity))
    scene = s.scene(rod, time=s.time(1.0, steps), output={"every": 1.0})
    simulation = der.Simulation(scene)
    before = np.array(simulation.angular_momentum)
    shape = final(simulation.run(), s)
    radius = np.linalg.norm(shape - shape.mean(axis=0), axis=1)
    hoop = rate**2 / EA
    drift = float(np.abs(simulation.angular_momentum - before).max() / np.abs(before).max())
    assert s.stepper is not None
    in_time = s.time_error(rate, 1.0, steps)
    return worst(
        Reading(float(np.abs(radius - 1.0 - hoop).max()), 1.2 * hoop + in_time),
        Reading(drift, 1e-6 if s.stepper.keeps_angular_momentum else in_time),
    )
