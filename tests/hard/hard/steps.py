"""Time steps far too long or short, forces that jump, stiff drag."""

from __future__ import annotations

import der
import numpy as np

from .case import Limit, Reading, hard, refused_if_explicit, worst
from .setting import Scene, Setting, final, line

HUGE = "Steps of 10 s on a time scale of 0.01 s"


def heavy(s: Setting) -> Scene:
    """A cantilever of a first period of 6 ms that sags by an eightieth of its length."""
    return s.scene(
        s.rod(line(9), EA=1e9, EI=1e5, GJ=1e5),
        [{"at": "start", **s.clamp}],
        loads=[{"gravity": s.vector(0.0, -1e4)}],
    )


def _named(s: Setting, *names: str) -> bool:
    return s.stepper is not None and s.stepper.name in names


def damps_fast_motion(s: Setting) -> bool:
    assert s.stepper is not None
    return s.stepper.stability.startswith("L-stable")


@hard(
    HUGE,
    "cantilever let go, 20 steps",
    "L-stable: at rest in the static equilibrium, to 1e-3 of the sag. Others: within twice the "
    "sag, as a swing without damping. Explicit: refused before the run",
    motion=True,
    expected=refused_if_explicit,
    limits=(
        Limit(
            "Its energy grows where a step is long against every period, and the run is stopped. "
            "Take an L-stable stepper.",
            ("unstable_motion",),
            lambda s: s.implicit and _named(s, "generalized_alpha"),
        ),
    ),
)
def huge_steps(s: Setting) -> Reading:
    scene = heavy(s)
    still = final(der.equilibrium(scene), s)[-1, 1]
    del scene["analysis"]
    scene |= {"time": s.time_in(10.0, 20), "output": {"every": 10.0}}
    tips = s.in_plane(der.run(scene).positions)[:, -1, 1]
    if damps_fast_motion(s):
        return Reading(abs(tips[-1] / still - 1.0), 1e-3)
    return worst(
        Reading(float(tips.min() / still), 2.1), Reading(float(max(tips.max(), 0.0) / -still), 0.1)
    )


@hard(
    "Steps of 1e-9 s",
    "free rod that falls, moves and turns, 200 steps",
    "velocities and positions of a rigid body, to 1e-6 of what it moved; angular momentum to 1e-9",
    motion=True,
)
def tiny_steps(s: Setting) -> Reading:
    step, steps, gravity, turning = 1e-9, 200, 1e5, 2.0
    x = line(9)
    velocity = np.column_stack([np.full(9, 1.0), 3.0 + turning * (x[:, 0] - 0.5)])
    scene = s.scene(
        s.rod(x, initial_velocity=s.vectors(velocity)),
        loads=[{"gravity": s.vector(0.0, -gravity)}],
        time=s.time_in(step, steps),
        output={"every": step * steps},
    )
    simulation = der.Simulation(scene)
    spun = _about_middle(simulation)
    simulation.run()
    time = step * steps
    moved = s.in_plane(simulation.positions)[:, :2] - x
    exact = velocity * time - [0.0, gravity * time**2 / 2]
    speed = s.in_plane(simulation.velocities)[:, :2] - velocity + [0.0, gravity * time]
    return worst(
        # An Euler step has the velocity of one end for the whole step.
        Reading(float(np.abs(moved - exact).max() / time), 1e-6 + gravity * step),
        Reading(float(np.abs(speed).max()), 1e-5),
        Reading(abs(_about_middle(simulation) / spun - 1.0), 1e-8),
    )


def _about_middle(simulation: der.Simulation) -> float:
    """The size of the angular momentum about the centre of mass."""
    masses = simulation.node_masses[:, None]
    centre = (masses * simulation.positions).sum(axis=0) / masses.sum()
    momentum = np.zeros(3)
    momentum[: len(centre)] = np.asarray(simulation.momentum)[: len(centre)]
    arm = np.zeros(3)
    arm[: len(centre)] = centre
    return float(np.linalg.norm(simulation.angular_momentum - np.cross(arm, momentum)))


@hard(
    "Strong loads over tables",
    "free rod hit by a force of 1e4 EI/L^2 that comes and goes within two steps",
    "momentum = integral of the force",
    motion=True,
)
def hit(s: Setting) -> Reading:
    step, force = 1e-3, 1e4
    times = [0.01, 0.01 + step, 0.01 + 2 * step]
    table = {"times": times, "values": s.vectors(np.outer([0, force, 0], [0, 1]))}
    scene = s.scene(
        s.rod(line(9), EI=10.0, GJ=10.0),
        loads=[{"point_force": {"rod": "rod", "at": "middle", "force": table}}],
        time=s.time(0.05, 50) if s.implicit else s.time_in(1e-4, 500),
        output={"every": 0.05},
    )
    simulation = der.Simulation(scene)
    simulation.run()
    dimensions = len(s.axes)
    momentum = s.in_plane(np.asarray(simulation.momentum)[:dimensions])
    impulse = force * step
    return Reading(float(np.abs(momentum / impulse - [0, 1, 0]).max()), 1e-6)


STIFF_DRAG = "Stiff drag"


@hard(
    STIFF_DRAG,
    "three spheres in a fluid whose drag settles in 1e-8 s, 40 steps of 0.1 s",
    "terminal velocity of Stokes; explicit steps refused before the run",
    motion=True,
    expected=refused_if_explicit,
    limits=(
        Limit(
            "Steppers that do not damp fast motion ring about the terminal velocity: each step "
            "overshoots it to the other side ([Steppers](steppers.md)). Take an L-stable one.",
            ("wrong", "unstable_motion"),
            lambda s: s.implicit and not damps_fast_motion(s),
        ),
    ),
)
def stiff_drag(s: Setting) -> Reading:
    radius, viscosity, excess = 0.005, 1e6, 6000.0
    rod = s.rod(line(3, 0.1), EA=1e3, EI=1e-2, GJ=1e-2, mass_per_length=0.0, rotary_inertia=1e-6)
    rod["spheres"] = [{"at": "all", "radius": radius, "density": 7000}]
    scene = s.scene(
        rod,
        loads=[
            {"gravity": s.vector(0.0, -9.8)},
            {"fluid": {"density": 7000 - excess, "viscosity": viscosity}},
        ],
        time=s.time_in(0.1, 40),
        output={"every": 4.0},
    )
    speed = s.in_plane(der.run(scene).velocities[-1])[:, 1]
    exact = -2.0 / 9.0 * excess * 9.8 * radius**2 / viscosity
    return Reading(float(np.abs(speed / exact - 1.0).max()), 1e-6)
