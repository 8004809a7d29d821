"""Supports that hold too little or too much."""

from __future__ import annotations

from collections.abc import Callable

import der
import numpy as np

from .case import Limit, Reading, hard
from .setting import Scene, Setting, final, line, tip_force

Make = Callable[[Setting], Scene]
LITTLE = "Under-constrained supports"
MUCH = "Over-constrained supports"


def _free_pushed(s: Setting) -> Scene:
    return s.scene(s.rod(line(9)), loads=[tip_force(s, 0.0, 1.0)])


def _pinned_pushed(s: Setting) -> Scene:
    pull = {"point_force": {"rod": "rod", "at": "end", "force": s.vector(-0.3, 0.7)}}
    return s.scene(s.rod(line(9)), [{"at": "start", **s.pin}], loads=[pull])


def _guided(s: Setting) -> Scene:
    """One component of each end is held, and the force acts along another one."""
    ends = [{"at": "start", "fix": ["y"]}, {"at": "end", "fix": ["y"]}]
    load = {"point_force": {"rod": "rod", "at": "end", "force": [1, 0] if s.planar else [1, 0, 0]}}
    rod = s.rod(line(9))
    rod["points"] = (line(9) if s.planar else np.pad(line(9), ((0, 0), (0, 1)))).tolist()
    return s.scene(rod, ends, loads=[load])


def _turned(s: Setting) -> Scene:
    moment = {"moment": {"rod": "rod", "at": "end", "moment": s.about_z(1.0)}}
    return s.scene(s.rod(line(9)), [{"at": "start", **s.pin}], loads=[moment])


def _crushed(s: Setting) -> Scene:
    return s.scene(
        s.rod(line(9), EA=1.0), [{"at": "start", **s.clamp}], loads=[tip_force(s, -3.0, 0.0)]
    )


REFUSED: dict[str, tuple[Make, str]] = {
    "free, pushed": (_free_pushed, "not_held"),
    "guided along a line, pushed along it": (_guided, "not_held"),
    "pressed with 3 EA on its clamp": (_crushed, "collapsed"),
}


@hard(
    LITTLE,
    "no equilibrium",
    "refused by name",
    values={name: make for name, (make, _) in REFUSED.items()},
    expected=lambda s: REFUSED[s.label][1],
)
def no_equilibrium(s: Setting) -> Reading:
    der.run(s.value(s))
    return Reading(1.0, 0.0)


@hard(
    LITTLE,
    "no equilibrium: rod on a pin under a moment",
    "refused by name",
    models=("planar", "spatial"),
    expected=lambda s: "unbounded",
    limits=(Limit("Refused by another name.", ("not_converged",), lambda s: s.model == "spatial"),),
)
def turns_without_end(s: Setting) -> Reading:
    der.run(_turned(s))
    return Reading(1.0, 0.0)


@hard(
    LITTLE,
    "rod on a pin pulled at its end",
    "it turns until it hangs in the direction of the force; tension = force",
)
def hangs_on_a_pin(s: Setting) -> Reading:
    tip = final(der.run(_pinned_pushed(s)), s)[-1]
    force = np.array([-0.3, 0.7, 0.0])
    size = float(np.linalg.norm(force))
    return Reading(float(np.abs(tip - force / size * (1 + size / 1e4)).max()), 1e-6)


@hard(LITTLE, "free rod without loads", "it stays as drawn")
def free(s: Setting) -> Reading:
    result = der.run(s.scene(s.rod(line(9))))
    return Reading(float(np.abs(final(result, s)[:, :2] - line(9)).max()), 1e-12)


def _all_held(s: Setting) -> list[Scene]:
    return [{"at": "all", **s.pin}]


def _thrice_clamped(s: Setting) -> list[Scene]:
    middle = {"at": "middle", **s.pin}
    return [{"at": "start", **s.clamp}, {"at": "end", **s.clamp}, middle]


@hard(
    MUCH,
    "weight on a rod that is held more than enough",
    "reactions = weight; refused where nothing is free to move",
    values={"every node held": _all_held, "both ends clamped, middle held": _thrice_clamped},
    expected=lambda s: (
        "solved" if s.value is not _all_held or s.model == "spatial" else "model_error"
    ),
)
def over_held(s: Setting) -> Reading:
    scene = s.scene(s.rod(line(9)), s.value(s), loads=[{"gravity": s.vector(0.0, -10.0)}])
    result = der.run(scene)
    total = sum(np.asarray(reaction.force[-1]) for reaction in result.reactions())
    return Reading(float(np.abs(s.in_plane(total) - [0, 10, 0]).max()), 1e-7)


@hard(
    MUCH,
    "one node told to be in two places",
    "refused as an invalid scene",
    expected=lambda s: "invalid_scene",
)
def contradiction(s: Setting) -> Reading:
    ends: list[Scene] = [
        {"at": "end", "prescribe": s.moved(0.1)},
        {"at": {"node": -1}, "prescribe": s.moved(0.2)},
    ]
    der.run(s.scene(s.rod(line(9)), [{"at": "start", **s.clamp}, *ends]))
    return Reading(1.0, 0.0)
