"""Stiffness against stretching over that against bending, from 1e2 to 1e14; unequal bending."""

from __future__ import annotations

import der
import numpy as np

from .case import Limit, Reading, hard, refused_if_explicit, worst
from .references import CANTILEVER, cantilever_mode, cantilever_tip
from .setting import Scene, Setting, final, line, tip_force

TOPIC = "EA L^2/EI from 1e2 to 1e14"
#: Why a ratio of 1e14 is beyond double precision in motion.
ROUNDING = (
    "An edge knows its tension to EA/l times the rounding of a coordinate. At 1e14 that is more "
    "than the force that bends the rod. A smaller EA gives the same motion: at 1e10 the rod has "
    "practically no stretch."
)


def stiffest(s: Setting) -> bool:
    return s.implicit and bool(s.value == 1e14)


RATIOS = {f"1e{n}": 10.0**n for n in range(2, 15, 2)}


def elastica_error(edges: int) -> float:
    """Expected error of the tip under P L^2/EI = 1, twice that of docs/validation.md."""
    return 2.2e-4 * (10.0 / edges) ** 2


@hard(
    TOPIC,
    "cantilever under P L^2/EI = 1, 40 elements",
    "extensible elastica by shooting",
    values=RATIOS,
)
def bent_by_a_force(s: Setting) -> Reading:
    scene = s.scene(s.rod(line(41), EA=s.value), [{"at": "start", **s.clamp}])
    scene["loads"] = [tip_force(s, 0.0, 1.0)]
    tip = final(der.run(scene), s)[-1]
    exact = np.array([*cantilever_tip(1.0, s.value), 0.0])
    return Reading(float(np.abs(tip - exact).max()), elastica_error(40))


@hard(
    TOPIC,
    "lowest frequency of a cantilever, 40 elements",
    "Euler-Bernoulli beam, order 2",
    values=RATIOS,
)
def lowest_frequency(s: Setting) -> Reading:
    scene = s.scene(s.rod(line(41), EA=s.value), [{"at": "start", **s.clamp}])
    scene["analysis"] = {"modes": {"count": 1}}
    rate = 2 * np.pi * der.run(scene).summary["frequencies_hz"][0]
    return Reading(abs(rate / CANTILEVER - 1.0), CANTILEVER / 40**2)


@hard(
    TOPIC,
    "buckling load of a cantilever, 40 elements",
    "Euler's load pi^2/4, order 2, and the strain at it",
    values=RATIOS,
    limits=(
        Limit(
            "The tension of the straight shape is rounded as every tension is; that is refused.",
            ("too_fine",),
            lambda s: s.value == 1e14,
        ),
    ),
)
def buckling_load(s: Setting) -> Reading:
    scene = s.scene(s.rod(line(41), EA=s.value), [{"at": "start", **s.clamp}])
    scene["loads"] = [tip_force(s, -1.0, 0.0)]
    scene["analysis"] = {"buckling": {"count": 1}}
    euler = np.pi**2 / 4
    factor = [*der.run(scene).summary["load_factors"], np.inf][0]
    return Reading(abs(factor / euler - 1.0), euler / 40**2 + 2 * euler / s.value)


def vibration(s: Setting, steps: int, rod: Scene, x: np.ndarray, y: int = 1) -> Scene:
    """A quarter of the first vibration of a cantilever, from its mean shape on."""
    quarter = np.pi / 2 / CANTILEVER
    velocity = np.zeros((len(x), 2))
    velocity[:, y] = AMPLITUDE * CANTILEVER * cantilever_mode(x)
    rod["initial_velocity"] = s.vectors(velocity)
    output = {"every": quarter}
    time = s.time(quarter, steps)
    return s.scene(rod, [{"at": "start", **s.clamp}], time=time, output=output)


AMPLITUDE = 0.02
STEPS = 60


def vibration_error(s: Setting, edges: int) -> float:
    """Expected share of the amplitude: of the steps, of the mesh, of the finite amplitude."""
    in_time = s.time_error(CANTILEVER, np.pi / 2 / CANTILEVER, STEPS)
    return in_time + 2 * CANTILEVER / edges**2 + 20 * AMPLITUDE**2


def steps_resolve_nothing(s: Setting) -> str:
    """Explicit steps of a bearable number do not resolve the waves of a rod so stiff."""
    return "solved" if s.value <= 1e6 else refused_if_explicit(s)


@hard(
    TOPIC,
    "first vibration of a cantilever, 8 elements, 60 steps in a quarter period",
    "Euler-Bernoulli beam; explicit steps refused before the run from 1e10 on",
    motion=True,
    values={f"1e{n}": 10.0**n for n in (2, 6, 10, 14)},
    expected=steps_resolve_nothing,
    limits=(
        Limit(ROUNDING, ("unstable_motion", "not_converged", "unreliable", "wrong"), stiffest),
    ),
)
def vibrates(s: Setting) -> Reading:
    points = line(9)
    scene = vibration(s, STEPS, s.rod(points, EA=s.value), points[:, 0])
    if steps_resolve_nothing(s) != "solved":
        scene["time"]["step"] = scene["time"]["duration"] / STEPS
    tip = final(der.run(scene), s)[-1, 1]
    # Waves along a rod as soft as 1e2 are as slow as the vibration, and mix with it.
    return Reading(abs(tip / AMPLITUDE - 1.0), vibration_error(s, 8) + 1.0 / s.value)


UNEQUAL = {"1e6": 1e6}


@hard(
    "Bending stiffnesses of a section 1e6 apart",
    "strip under forces toward both sides, 10 elements",
    "P L^3/(3 EI) of each; exact for small deflections",
    values=UNEQUAL,
    models=("spatial",),
)
def unequal_bending(s: Setting) -> Reading:
    across = s.in_plane(np.eye(3))[:, 2]  # the axis across the case's plane, in the scene
    rod = strip(s)
    scene = s.scene(rod, [{"at": "start", **s.clamp}])
    small = 1e-5
    push = np.array(s.vector(0.0, small)) + small * s.value * across
    scene["loads"] = [{"point_force": {"rod": "rod", "at": "end", "force": push.tolist()}}]
    tip = final(der.run(scene), s)[-1]
    exact = small / 3
    return Reading(float(np.abs(tip[1:] / exact - 1.0).max()), 1e-4)


def strip(s: Setting, nodes: int = 11) -> Scene:
    """A rod that is 1e6 times as stiff against bending out of the plane as in it."""
    rod = s.rod(line(nodes), EA=1e8)
    stiffness = rod["cross_section"]["stiffness"]
    del stiffness["EI"]
    stiffness |= {"EI1": s.value, "EI2": 1.0, "GJ": 1e6, "rotary_inertia": 1e-6}
    rod["cross_section"]["director"] = s.in_plane(np.eye(3))[:, 2].tolist()
    return rod


@hard(
    "Bending stiffnesses of a section 1e6 apart",
    "first vibration toward the weak side",
    "Euler-Bernoulli beam; explicit steps refused before the run",
    motion=True,
    values=UNEQUAL,
    models=("spatial",),
    expected=refused_if_explicit,
)
def unequal_vibration(s: Setting) -> Reading:
    scene = vibration(s, STEPS, strip(s, 9), line(9)[:, 0])
    scene["time"]["step"] = scene["time"]["duration"] / STEPS
    tip = final(der.run(scene), s)[-1]
    out = abs(tip[2]) / AMPLITUDE
    return worst(
        Reading(abs(tip[1] / AMPLITUDE - 1.0), vibration_error(s, 8)), Reading(float(out), 1e-6)
    )
