"""Meshes: two nodes to a million, lengths 1e3 apart, a fold through half a turn."""

from __future__ import annotations

import der
import numpy as np

from .case import Limit, Reading, hard, worst
from .references import cantilever_tip, pendulum_angle
from .setting import Array, Scene, Setting, final, line, tip_force
from .stiffness import AMPLITUDE, STEPS, elastica_error, vibration, vibration_error

RATIO = "Neighbouring edges 1e3 apart in length"


def uneven(edges: int) -> Array:
    """Long and short edges in turn along x, from 0 to 1."""
    lengths = np.tile([1.0, 1e-3], edges // 2)
    x = np.concatenate([[0.0], np.cumsum(lengths)])
    return np.column_stack([x / x[-1], np.zeros(edges + 1)])


@hard(RATIO, "cantilever under P L^2/EI = 1, 20 long and 20 short edges", "extensible elastica")
def uneven_bent(s: Setting) -> Reading:
    scene = s.scene(s.rod(uneven(40), EA=1e6), [{"at": "start", **s.clamp}])
    scene["loads"] = [tip_force(s, 0.0, 1.0)]
    tip = final(der.run(scene), s)[-1]
    exact = np.array([*cantilever_tip(1.0, 1e6), 0.0])
    return Reading(float(np.abs(tip - exact).max()), elastica_error(20))


@hard(
    RATIO,
    "first vibration of a cantilever, 4 long and 4 short edges",
    "Euler-Bernoulli beam (with explicit steppers in the long run only)",
    motion=True,
    applies=lambda s: s.implicit or s.long,
)
def uneven_vibration(s: Setting) -> Reading:
    points = uneven(8)
    scene = vibration(s, STEPS, s.rod(points), points[:, 0])
    tip = final(der.run(scene), s)[-1, 1]
    return Reading(abs(tip / AMPLITUDE - 1.0), vibration_error(s, 4))


FEW = "Few nodes"


@hard(
    FEW,
    "cantilever under a small tip force",
    "P L^3/(3 EI), exact on any mesh",
    values={"2 nodes": 2, "3 nodes": 3, "4 nodes": 4},
)
def few_bent(s: Setting) -> Reading:
    scene = s.scene(s.rod(line(s.value), EA=1e8), [{"at": "start", **s.clamp}])
    scene["loads"] = [tip_force(s, 0.0, 3e-4)]
    tip = final(der.run(scene), s)[-1]
    return worst(Reading(abs(tip[1] / 1e-4 - 1.0), 1e-6), Reading(abs(float(tip[2])), 1e-15))


SWINGS = 200
#: Half the mass over the moment of inertia about the pin: an edge that a support holds has its mass
#: at its ends, all others are uniform bars (docs/mechanics.md, "Mass").
INERTIA = {2: 0.5 / 0.5, 3: 0.5 / (0.25 * 0.25 + 0.5 * 1.75 / 3)}


@hard(
    FEW,
    "bar on a pin that swings from 1 rad for 0.5 s, 200 steps",
    "physical pendulum, a held edge with its mass at its ends, integrated independently",
    motion=True,
    values={"2 nodes (one edge)": 2, "3 nodes": 3},
)
def bar_swings(s: Setting) -> Reading:
    rate = 9.81 * INERTIA[s.value]
    stop = 0.5
    start = 1.0
    points = line(s.value)[:, :1] * np.array([np.sin(start), -np.cos(start)])
    # Stiff enough to be a rigid bar: it bends and stretches by 1e-4 of its length.
    scene = s.scene(
        s.rod(points, EA=1e5, EI=1e4),
        [{"at": "start", **s.pin}],
        loads=[{"gravity": s.vector(0.0, -9.81)}],
        time=s.time(stop, SWINGS),
        output={"every": stop},
    )
    tip = final(der.run(scene), s)[-1]
    angle = pendulum_angle(rate, start, stop)
    error = abs(np.arctan2(tip[0], -tip[1]) - angle)
    return Reading(float(error), s.time_error(np.sqrt(rate), stop, SWINGS) + 1e-3)


MANY = "Many nodes"


@hard(
    MANY,
    "rod pulled along itself",
    "F L/EA",
    values={"1e4": 10_000},
    long_values={"1e5": 100_000, "1e6": 1_000_000},
    limits=(
        Limit(
            "In space the directions across the rod have to be told as well, and rounding "
            "hides them from about 1e5 nodes on: refused before the search.",
            ("invalid_scene",),
            lambda s: not s.planar and s.value >= 100_000,
        ),
    ),
)
def many_pulled(s: Setting) -> Reading:
    rod = s.rod(line(2), EA=1e4)
    start, end = rod.pop("points")
    rod |= {"nodes": s.value, "from": start, "to": end}
    scene = s.scene(rod, [{"at": "start", **s.clamp}], loads=[tip_force(s, 1.0, 0.0)])
    tip = final(der.run(scene), s)[-1]
    # Edges know their length to the rounding of their ends.
    allowed = 1e-6 + s.value * 1e-12
    return Reading(float(np.abs(tip - [1.0 + 1e-4, 0, 0]).max() / 1e-4), allowed)


@hard(
    MANY,
    "cantilever under P L^2/EI = 1",
    "refused before the search: the stiffness matrix has lost the bending",
    values={},
    long_values={"2e5": 200_000},
    models=("planar",),
    expected=lambda s: "invalid_scene",
)
def too_many_bent(s: Setting) -> Reading:
    rod = s.rod(line(2), EA=1e6)
    start, end = rod.pop("points")
    rod |= {"nodes": s.value, "from": start, "to": end}
    scene = s.scene(rod, [{"at": "start", **s.clamp}], loads=[tip_force(s, 0.0, 1.0)])
    tip = final(der.run(scene), s)[-1]
    exact = np.array([*cantilever_tip(1.0, 1e6), 0.0])
    return Reading(float(np.abs(tip - exact).max()), 1e-6)


@hard(
    MANY,
    "free fall, 2 steps",
    "v = g t",
    motion=True,
    values={"1e3": 1_000},
    long_values={"1e5": 100_000, "1e6": 1_000_000},
)
def many_fall(s: Setting) -> Reading:
    rod = s.rod(line(2))
    start, end = rod.pop("points")
    rod |= {"nodes": s.value, "from": start, "to": end}
    # At 1e4 nodes a wave crosses an edge within 1e-6 s.
    step = 1e-12 if not s.implicit else 1e-2
    scene = s.scene(
        rod,
        loads=[{"gravity": s.vector(0.0, -10.0)}],
        time=s.time_in(step, 2),
        output={"every": step},
    )
    speed = s.in_plane(der.run(scene).velocities[-1])
    exact = -10.0 * 2 * step
    return Reading(float(np.abs(speed[:, 1] / exact - 1.0).max()), 1e-6)


FOLD = "A fold driven through half a turn"
EDGE = 0.5
FOLDS = 400


def folded(s: Setting, apart: float) -> Scene:
    """Two edges, hinged at both ends, which are 0.9 apart as drawn."""
    height = np.sqrt(EDGE**2 - 0.45**2)
    return s.rod([[0, 0], [0.45, height], [0.9, 0]], EA=1e4, EI=1e-2, GJ=1e-2, natural_curvature=0)


@hard(
    FOLD,
    "two edges whose ends are brought together",
    "apex over the ends by Pythagoras, to the strain of the edges",
    values={f"{d:g} apart": d for d in (0.5, 0.1, 1e-2, 1e-4)},
    limits=(
        Limit(
            "The answer is not found to the precision that is asked for; the fold is named.",
            ("folded",),
            lambda s: s.model == "spatial" and s.value == 1e-4,
        ),
    ),
)
def fold_at_rest(s: Setting) -> Reading:
    end = {"at": "end", "prescribe": s.moved(s.value - 0.9)}
    scene = s.scene(folded(s, s.value), [{"at": "start", **s.pin}, end])
    scene["analysis"] = {"static": {"stability": "any"}}
    apex = final(der.run(scene), s)[1]
    exact = np.sqrt(EDGE**2 - s.value**2 / 4)
    # The moment EI phi/l bends, and presses on the edges.
    return Reading(float(np.hypot(apex[0] - s.value / 2, apex[1] - exact)), 1e-4)


@hard(
    FOLD,
    "the same over 1 s, past each other; the node that folds over is named",
    "apex over the ends by Pythagoras; the run is marked as unreliable past half a turn",
    motion=True,
    values={"0.1 apart": 0.1, "-0.5 apart": -0.5},
)
def fold_over(s: Setting) -> Reading:
    table = {"times": [0, 1], "values": [0, s.value - 0.9], "smooth": True}
    scene = s.scene(
        folded(s, s.value),
        [{"at": "start", **s.pin}, {"at": "end", "prescribe": s.moved(table)}],
        time=s.time(1.0, FOLDS),
        output={"every": 1.0},
    )
    result = der.run(scene)
    apex = final(result, s)[1]
    exact = np.sqrt(EDGE**2 - s.value**2 / 4)
    marked = result.unreliable_from is not None
    reading = Reading(float(np.hypot(apex[0] - s.value / 2, apex[1] - exact)), 5e-3)
    return worst(reading, Reading(float(marked != (s.value < 0)), 0.5))
