"""Equilibria of rods in space: straight ones, arcs, polylines with corners, and rings.

Clamps, springs of both kinds and bearings hold them; forces and moments load them, which keep their
direction or follow the rod. Some have round sections that nothing twists, for which the program
takes the model without twist. The reference is `space_rod.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
from references.bent_wire import Leg
from references.kirchhoff_rod import Equilibrium, constant, directors, refine

from .case import Case, Label, Truth, UnsolvedError
from .rod import Array
from .shapes import Random
from .space import Placed, place, probes, share
from .space_rod import Drawn, Place, Problem

QUANTITIES = (
    *("x", "y", "z", "x", "y", "z", "curvature_1", "curvature_2", "twist"),
    *("moment_1", "moment_2", "torque", "tension"),
)
#: Of a model without twist.
UNTWISTED = ("x", "y", "z", "curvature", "moment", "tension")
_SHAPES = ("straight", "straight", "untwisted", "arc", "corners", "ring")
_COARSE, _FINE = 8, 12  # degrees of the collocation
_STEPS = (4, 16)  # from the drawn shape; more of them where few miss the way
_SAME = 0.03  # of the length: farther apart, two shapes are two equilibria
_APART = 3  # elements between places that one mesh has to resolve
_BESIDE = 1e-9  # of the length: a quantity that differs on the two sides of a place jumps there


def space_static(rng: Random) -> Case:
    shape = str(rng.choice(_SHAPES))
    scene = _held_and_loaded(rng, _draw(rng, shape))
    length = scene.chords
    read = probes(rng, scene.edges + 1, length, QUANTITIES if scene.twists else UNTWISTED)
    if scene.drawn.closed:
        read = {name: probe for name, probe in read.items() if probe["at"] != "end"}
    read["energy"] = {"quantity": "elastic_energy"}
    entry = {
        "title": f"Audit: equilibrium in space, {shape}",
        "model": "spatial" if scene.twists else "auto",
        "rods": [scene.entry()],
        "supports": scene.supports,
        "loads": scene.loads,
        "analysis": "static",
        "output": {"probes": read},
    }

    def truths(final: dict[str, Any]) -> Mapping[Label, Truth]:
        problem, placed = scene.problem(), scene.placed
        rough, fine = _solutions(problem)
        at_nodes = fine.at(np.arange(len(final["positions"])) / scene.edges)[:3].T
        apart = placed.origin + placed.length * at_nodes - final["positions"]
        distance = float(np.abs(apart).max()) / placed.length
        if distance > _SAME + 0.5 / scene.edges:
            raise UnsolvedError(f"the nearest solution is {distance:.2g} L away")
        found: dict[Label, Truth] = {}
        for name, probe in read.items():
            quantity = probe["quantity"]
            size = _size(placed, fine, quantity)
            if quantity == "elastic_energy":
                a, b = (_energy(placed, problem, solved) for solved in (rough, fine))
            else:
                s = share(probe["at"], scene.edges + 1, length)
                sides = np.clip([s - _BESIDE, s + _BESIDE], 0.0, 1.0)
                before, after = (_read(placed, fine, quantity, float(side)) for side in sides)
                if abs(before - after) > 1e-6 * size:
                    continue
                a, b = (_read(placed, solved, quantity, s) for solved in (rough, fine))
            found[name, "final"] = Truth(b, 3 * abs(a - b) + 1e-9 * size, size, quantity)
        return found

    return Case("space_static", entry, truths)


def _solutions(problem: Problem) -> tuple[Equilibrium, Equilibrium]:
    """The equilibrium on a rough and on a fine mesh."""
    for steps in _STEPS:
        try:
            rough = problem.follow(steps, _COARSE)
            return rough, refine(rough, _FINE)
        except RuntimeError as error:
            reason = str(error)
    raise UnsolvedError(reason)


@dataclass
class _Scene:
    """A rod, what holds and what loads it: as the scene has it, and as the reference does."""

    rng: Random
    placed: Placed
    drawn: Drawn
    edges: int
    keys: dict[str, Any]  # of the rod, beside its shape and section
    twists: bool
    line: Array = field(default_factory=lambda: np.zeros(3))
    places: dict[float, Place] = field(default_factory=dict)
    supports: list[dict[str, Any]] = field(default_factory=list)
    loads: list[dict[str, Any]] = field(default_factory=list)

    @property
    def points(self) -> Array:
        return self.placed.origin + self.placed.length * self.drawn.points(self.edges)

    @property
    def chords(self) -> float:
        """The length of the polyline through the nodes, along which the scene counts."""
        points = self.points
        if self.drawn.closed:
            points = np.vstack([points, points[:1]])
        return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())

    @property
    def is_straight(self) -> bool:
        return len(self.drawn.legs) == 1 and not any(self.drawn.legs[0].bent)

    @property
    def strength(self) -> float:
        """Loads and stiffnesses are in units of EI/L^2, of which a ring needs more."""
        return 10.0 if self.drawn.closed else 1.0

    def entry(self) -> dict[str, Any]:
        """The rod in the scene."""
        points = self.points.tolist()
        shape: dict[str, Any] = {"points": points}
        if self.drawn.closed:
            shape["closed"] = True
        elif self.is_straight:
            shape = {"nodes": self.edges + 1, "from": points[0], "to": points[-1]}
        return {**self.placed.entry(), **shape, **self.keys}

    def problem(self) -> Problem:
        """The same for the reference. Its ends are places, free or not."""
        for s in (0.0, 1.0):
            self.at(s)
        places = sorted(self.places.values(), key=lambda place: place.s)
        return Problem(self.placed.rod, self.drawn, places, self.line)

    def at(self, s: float) -> Place:
        """The place at a share of the length."""
        return self.places.setdefault(s, Place(s))

    def random(self, size: float) -> Array:
        """A vector of such a size."""
        return np.asarray(self.rng.uniform(-size, size, 3))

    def clamp(self, at: Any, s: float) -> None:
        """A clamp that does not move."""
        self.supports.append({"rod": "rod", "at": at, "clamp": True})
        self.at(s).hold = "clamp"

    def moved_clamp(self, at: Any, s: float) -> None:
        """A clamp that moves, turns and twists."""
        rod, (_, section) = self.placed.rod, self.drawn.pose(s)
        here = self.at(s)
        here.hold = "clamp"
        if self.is_straight:
            # Apart along the rod, by a pull of up to 3, so that it does not buckle.
            pull = self.rng.uniform(0, 3) / rod.stretching
            here.shift = section @ [*self.rng.uniform(-0.01, 0.01, 2), pull]
        else:
            here.shift = self.random(0.05)
        axis = self.random(1.0)
        here.turn = (axis / np.linalg.norm(axis), float(self.rng.uniform(-0.3, 0.3)))
        here.twist = float(self.rng.uniform(-2, 2))
        shift = (self.placed.length * here.shift).tolist()
        moved: dict[str, Any] = dict(zip("xyz", shift, strict=True))
        moved["rotation"] = {"axis": axis.tolist(), "angle": here.turn[1]}
        moved["twist"] = here.twist
        self.supports.append({"rod": "rod", "at": at, "clamp": True, "prescribe": moved})

    def bearing(self, at: Any, s: float) -> None:
        """A clamp in which the section may turn about the tangent."""
        self.supports.append({"rod": "rod", "at": at, "clamp": "tangent"})
        self.at(s).hold = "bearing"

    def springs(self, at: Any, s: float, *, pulling: bool, turning: bool) -> None:
        """Springs along the axes, and against turning: three stiffnesses or one."""
        spring: dict[str, Any] = {}
        if pulling:
            k = self.strength**1.5 * 10.0 ** self.rng.uniform(1, 4, 3)
            self.at(s).spring = k
            spring["stiffness"] = (k * self.placed.force / self.placed.length).tolist()
        if turning:
            k = self.strength**0.5 * 10.0 ** self.rng.uniform(0, 2.5, 3)
            number = self.rng.random() < 0.3
            self.at(s).turning_spring = np.full(3, k[0]) if number else k
            k = k * self.placed.moment
            spring["rotational_stiffness"] = float(k[0]) if number else k.tolist()
        self.supports.append({"rod": "rod", "at": at, "spring": spring})

    def force(self, at: Any, s: float) -> None:
        """A point force."""
        force = self.random(3.0 * self.strength)
        follows = self.twists and bool(self.rng.random() < 0.4)
        if follows:
            self.at(s).following_force = force
        else:
            self.at(s).force = force
        entry = {"rod": "rod", "at": at, "force": (force * self.placed.force).tolist()}
        self.loads.append({"point_force": entry | ({"follower": True} if follows else {})})

    def moment(self, at: Any, s: float) -> None:
        """A moment."""
        moment, follows = self.random(1.5 * self.strength**0.5), bool(self.rng.random() < 0.4)
        if follows:
            self.at(s).following_moment = moment
        else:
            self.at(s).moment = moment
        entry = {"rod": "rod", "at": at, "moment": (moment * self.placed.moment).tolist()}
        self.loads.append({"moment": entry | ({"follower": True} if follows else {})})

    def distributed(self) -> None:
        """A force along the whole rod."""
        self.line = self.random(4.0 * self.strength)
        force = (self.line * self.placed.force / self.placed.length).tolist()
        self.loads.append({"distributed_force": {"rod": "rod", "force": force}})


def _draw(rng: Random, shape: str) -> _Scene:
    """A rod without supports and loads."""
    if shape == "corners":
        counts = rng.integers(6, 13, int(rng.integers(2, 4)))
        edges = int(counts.sum())
    else:
        edges = int(rng.choice([12, 16, 24, 36] if shape == "ring" else [8, 12, 20, 30, 40]))
        counts = np.array([edges])
    placed = place(rng, np.zeros(3), (2.5, 6))
    keys: dict[str, Any] = {}
    twist = 0.0
    straight = shape in ("straight", "untwisted")
    if not straight and rng.random() < 0.5:
        twist = float(rng.uniform(-3, 3))
        keys["initial_twist"] = twist / placed.length
    legs = _legs(rng, shape, counts / edges, placed.frame)
    drawn = Drawn(legs, placed.frame, twist, closed=shape == "ring")
    natural: Callable[[Array], Array] = drawn.turning
    if shape == "straight" and rng.random() < 0.6:
        rates = rng.uniform(-2, 2, 3)
        keys |= placed.natural(rates)
        natural = constant(*rates)
    elif not straight and rng.random() < 0.3:
        own = float(rng.uniform(-2, 2))
        keys["natural_twist"] = own / placed.length

        def natural(s: Array) -> Array:
            return np.vstack([drawn.turning(s)[:2], np.full(len(s), own)])

    placed = replace(placed, rod=replace(placed.rod, natural=natural))
    twists = shape != "untwisted"
    if not twists:
        placed = replace(placed, rod=replace(placed.rod, bending=(1.0, 1.0)))
    return _Scene(rng, placed, drawn, edges, keys, twists)


def _legs(rng: Random, shape: str, lengths: Array, frame: Array) -> list[Leg]:
    """The legs of a shape."""
    no_turn = ((1.0, 0.0, 0.0), 0.0)
    if shape in ("straight", "untwisted"):
        return [Leg(1.0, no_turn)]
    if shape in ("arc", "ring"):
        turn = 2 * np.pi if shape == "ring" else float(rng.uniform(0.5, 2.0))
        return [Leg(1.0, no_turn, tuple(turn * _across(rng, frame)))]
    legs = [Leg(float(lengths[0]), no_turn)]
    for length in lengths[1:]:
        corner = (tuple(_across(rng, frame)), float(rng.uniform(0.5, 1.6)))
        legs.append(Leg(float(length), corner))
        frame = Drawn([Leg(1.0, corner)], frame).pose(0.0)[1]
    return legs


def _across(rng: Random, frame: Array) -> Array:
    """A unit vector across the tangent."""
    angle = rng.uniform(0, 2 * np.pi)
    return np.asarray(np.cos(angle) * frame[:, 0] + np.sin(angle) * frame[:, 1])


def _held_and_loaded(rng: Random, scene: _Scene) -> _Scene:
    """Draw its supports and loads."""
    ring, twists = scene.drawn.closed, scene.twists
    if not twists or rng.random() < 0.7:
        scene.clamp("start", 0.0)
    else:
        scene.springs("start", 0.0, pulling=True, turning=True)
    ends = ["free", "free", "moved", "springs"] if twists else ["free", "springs"]
    end = "" if ring else str(rng.choice(ends))
    if end == "moved":
        scene.moved_clamp("end", 1.0)
    if end == "springs":
        _springs(rng, scene, "end", 1.0)
    if end in ("free", "springs"):
        scene.force("end", 1.0)
        if twists and rng.random() < 0.3:
            scene.moment("end", 1.0)
    if ring or rng.random() < 0.4:
        scene.distributed()
    for at, s in _inside(rng, scene):
        what = str(rng.choice(["load", "load", "bearing", "springs", "springs"]))
        if what == "bearing" and isinstance(at, dict):
            scene.bearing(at, s)
            continue
        if what == "springs":
            _springs(rng, scene, at, s)
        if what != "springs" or rng.random() < 0.3:
            load = scene.force if not twists or rng.random() < 0.5 else scene.moment
            load(at, s)
    return scene


def _springs(rng: Random, scene: _Scene, at: Any, s: float) -> None:
    """Springs of one kind or both."""
    pulling = not scene.twists or bool(rng.random() < 0.6)
    turning = scene.twists and (not pulling or bool(rng.random() < 0.5))
    scene.springs(at, s, pulling=pulling, turning=turning)


def _inside(rng: Random, scene: _Scene) -> list[tuple[Any, float]]:
    """Up to two places, at nodes and between, some elements from all that is there already."""
    taken = [*map(float, scene.drawn.starts)]
    found: list[tuple[Any, float]] = []
    for _ in range(int(rng.integers(0, 3))):
        gaps = [(a, b) for a, b in pairwise(sorted(taken)) if b - a >= 2 * _APART / scene.edges]
        if not gaps:
            break
        a, b = gaps[int(rng.integers(len(gaps)))]
        s = float(rng.uniform(a + _APART / scene.edges, b - _APART / scene.edges))
        at: Any = s * scene.chords
        if rng.random() < 0.6:
            node = round(s * scene.edges)
            at, s = {"node": node}, node / scene.edges
        taken.append(s)
        found.append((at, s))
    return found


def _energy(placed: Placed, problem: Problem, solved: Equilibrium) -> float:
    """The energy that the rod and the springs store."""
    points, weights = np.polynomial.legendre.leggauss(12)
    total = problem.spring_energy(solved)
    for a, b in pairwise(solved.solution.breaks):
        s = a + (b - a) * (0.5 + 0.5 * points)
        u = solved.strains(s)
        gap = u[:3] - placed.rod.natural(s)
        density = (placed.rod.stiffness[:, None] * gap**2).sum(axis=0)
        density += placed.rod.stretching * u[3] ** 2
        total += float(0.25 * (b - a) * (weights @ density))
    return total * placed.moment


def _read(placed: Placed, solved: Equilibrium, quantity: str, s: float) -> float:
    """A probe of the scene."""
    values = solved.at(np.array([s]))[:, 0]
    if quantity in ("x", "y", "z"):
        axis = "xyz".index(quantity)
        return float(placed.origin[axis] + placed.length * values[axis])
    d = directors(values[3:7])
    moments, tension = values[10:13] @ d, float(values[7:10] @ d[:, 2])
    u = solved.strains(np.array([s]))[:3, 0]
    # The scene's curvature_1 is the one towards d1, a turning about d2.
    return float(
        {
            "curvature": np.hypot(u[0], u[1]) / placed.length,
            "moment": np.hypot(moments[0], moments[1]) * placed.moment,
            "curvature_1": u[1] / placed.length,
            "curvature_2": -u[0] / placed.length,
            "twist": u[2] / placed.length,
            "moment_1": moments[1] * placed.moment,
            "moment_2": -moments[0] * placed.moment,
            "torque": moments[2] * placed.moment,
            "tension": tension * placed.force,
        }[quantity]
    )


def _size(placed: Placed, solved: Equilibrium, quantity: str) -> float:
    """The size that is natural for a quantity in this solution."""
    if quantity in ("x", "y", "z"):
        return placed.length + float(np.abs(placed.origin).max())
    values = solved.at(np.linspace(0, 1, 41))
    moment = float(np.abs(values[10:13]).max())
    if quantity == "elastic_energy":
        return moment**2 / float(placed.rod.stiffness.max()) * placed.moment
    if quantity == "tension":
        # An edge's length is rounded to 1e-16 of the coordinates.
        rounding = 1e-5 * placed.rod.stretching * (1 + np.abs(placed.origin).max() / placed.length)
        return float((np.abs(values[7:10]).max() + rounding) * placed.force)
    if quantity in ("moment", "moment_1", "moment_2", "torque"):
        return moment * placed.moment
    weakest = float(placed.rod.stiffness.min())
    natural: Array = placed.rod.natural(np.zeros(1))
    return (moment / weakest + float(np.abs(natural).max())) / placed.length
