"""Networks of planar rods that stretch and bend, by shooting from joint to joint.

Each rod of a scene is cut where anything acts at a point. Between two cuts it is an extensible
elastica (`extensible_beam.py`): s the rest length, theta the angle of the tangent, (H, V) the force
and M the moment that the part beyond s exerts on the part before it,

    e = (H cos theta + V sin theta) / EA
    x' = (1 + e) cos theta,    y' = (1 + e) sin theta,    theta' = M / EI + kappa
    H' = -q_x,   V' = -q_y,    M' = -(1 + e) (V cos theta - H sin theta)

with a dead load q and a natural curvature kappa. Unknown are the place of each joint, the rotation
of each group of rods that turn together, and (H, V, M) where each piece begins. The equations say
that each piece ends at its joint with the joint's rotation, and that forces and moments of joints
and rotations balance. Pieces are integrated in equal steps of the method of order 8 of Dormand and
Prince; derivatives are complex steps, so that Newton's method converges to rounding.

Vibrations about an equilibrium: the load of inertia m omega^2 times the displacement enters the
derivatives alone, and a natural frequency makes them singular.

A scene is read as far as it has straight rods with their stiffnesses, joints, hinges of two rods
with springs and moments between these, springs between joints, supports (components, clamps,
constant motions, springs), dead loads and follower forces. Nothing is shared with `der`.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

from .record import Array

Scene = dict[str, Any]
Complex = NDArray[np.complex128]
Key = tuple[str, float]  # a rod and an arc length of it

_A, _B = DOP853.A[: DOP853.n_stages, : DOP853.n_stages], DOP853.B
_TINY = 1e-30


@dataclass
class _Piece:
    """A part of a rod between two cuts."""

    rod: str
    start: float
    end: float
    joints: tuple[int, int]
    rotations: tuple[int, int]
    direction: float
    EA: float
    EI: float
    mass: float
    curvature: float
    load: Array


@dataclass
class _Joint:
    """A point where pieces meet: what holds and loads it."""

    place: Array
    held: list[bool] = field(default_factory=lambda: [False, False])
    moved: Array = field(default_factory=lambda: np.zeros(2))
    spring: Array = field(default_factory=lambda: np.zeros(2))
    force: Array = field(default_factory=lambda: np.zeros(2))
    followers: list[tuple[int, Array]] = field(default_factory=list)  # with their rotations


@dataclass
class _Rotation:
    """The rotation of sections that turn together."""

    held: bool = False
    moved: float = 0.0
    spring: float = 0.0
    moment: float = 0.0


@dataclass
class _Hinge:
    """What acts between the rotations of two rods: on the second, and the opposite on the first."""

    sides: tuple[int, int]
    spring: float = 0.0
    moment: float = 0.0


@dataclass
class _AxialSpring:
    """A spring along the line between two joints."""

    joints: tuple[int, int]
    stiffness: float
    drawn: float
    rest_length: float

    def pull(self, places: Array, level: float) -> tuple[Array, Array]:
        """The force on the first joint, and its derivative by the vector to the second."""
        vector = places[self.joints[1]] - places[self.joints[0]]
        length = float(np.hypot(*vector))
        rest = self.drawn + level * (self.rest_length - self.drawn)
        tangent = vector / length
        along = np.outer(tangent, tangent)
        across = self.stiffness * (1 - rest / length)
        stiffness: Array = self.stiffness * along + across * (np.eye(2) - along)
        return across * vector, stiffness


def _pair(value: Any) -> Array:
    return np.full(2, value, dtype=float)


class Network:
    """The rods of a scene."""

    def __init__(self, scene: Scene, steps: int = 12) -> None:
        self.steps = steps
        self.rods = {rod["name"]: rod for rod in scene["rods"]}
        self.joints: list[_Joint] = []
        self.rotations: list[_Rotation] = []
        self.hinges: dict[str, _Hinge] = {}
        self.springs: dict[str, _AxialSpring] = {}
        self.pieces: list[_Piece] = []
        self._joint_at: dict[Key, int] = {}
        self._rotation_at: dict[Key, int] = {}
        self._cut(scene)
        self._hold(scene)
        self._load(scene)
        self._parameters()

    def length(self, rod: str) -> float:
        """Length of a rod as drawn."""
        line = self.rods[rod]
        return float(np.hypot(*np.subtract(line["to"], line["from"])))

    def key(self, place: Scene) -> Key:
        """Key of a place, a mapping with `rod` and `at`."""
        rod, at = place["rod"], place["at"]
        length = self.length(rod)
        named = {"start": 0.0, "middle": 0.5 * length, "end": length}
        s = named[at] if isinstance(at, str) else float(at)
        return rod, round(s / length, 13)

    def _cut(self, scene: Scene) -> None:
        joints = scene.get("joints", [])
        loads = [what for load in scene.get("loads", []) for what in load.values()]
        places = [member for joint in joints for member in joint["of"]]
        places += scene.get("supports", [])
        places += [what for what in loads if isinstance(what, dict) and "at" in what]
        keys = {self.key(place) for place in places}
        keys |= {(rod, end) for rod in self.rods for end in (0.0, 1.0)}
        for joint in joints:
            members = [self.key(member) for member in joint["of"]]
            self._joint_at |= dict.fromkeys(members, len(self.joints))
            self.joints.append(_Joint(self._drawn(members[0])))
            if joint.get("kind", "rigid") == "rigid":
                self._rotation_at |= dict.fromkeys(members, len(self.rotations))
                self.rotations.append(_Rotation())
        for key in sorted(keys):
            if key not in self._joint_at:
                self._joint_at[key] = len(self.joints)
                self.joints.append(_Joint(self._drawn(key)))
            if key not in self._rotation_at:
                self._rotation_at[key] = len(self.rotations)
                self.rotations.append(_Rotation())
        for joint in joints:
            if joint.get("kind") == "hinge" and len(joint["of"]) == 2:
                first, second = (self._rotation_at[self.key(member)] for member in joint["of"])
                spring = joint.get("spring", {}).get("rotational_stiffness", 0.0)
                self.hinges[joint["name"]] = _Hinge((first, second), spring)
        of = {joint["name"]: self._joint_at[self.key(joint["of"][0])] for joint in joints}
        for spring in scene.get("springs", []):
            first, second = (of[name] for name in spring["between"])
            drawn = float(np.hypot(*(self.joints[second].place - self.joints[first].place)))
            rest = spring.get("rest_length", drawn)
            self.springs[spring["name"]] = _AxialSpring(
                (first, second), spring["stiffness"], drawn, rest
            )
        for name, rod in self.rods.items():
            cuts = sorted(share for owner, share in keys if owner == name)
            section = rod["cross_section"]["stiffness"]
            along = np.subtract(rod["to"], rod["from"])
            for a, b in itertools.pairwise(cuts):
                ends = (name, a), (name, b)
                self.pieces.append(
                    _Piece(
                        name,
                        a * self.length(name),
                        b * self.length(name),
                        (self._joint_at[ends[0]], self._joint_at[ends[1]]),
                        (self._rotation_at[ends[0]], self._rotation_at[ends[1]]),
                        float(np.arctan2(along[1], along[0])),
                        section["EA"],
                        section["EI"],
                        section["mass_per_length"],
                        rod.get("natural_curvature", 0.0),
                        np.zeros(2),
                    )
                )

    def _drawn(self, key: Key) -> Array:
        rod = self.rods[key[0]]
        start = np.asarray(rod["from"], dtype=float)
        place: Array = start + key[1] * (np.asarray(rod["to"], dtype=float) - start)
        return place

    def _hold(self, scene: Scene) -> None:
        self.supports = [self.key(support) for support in scene.get("supports", [])]
        for key, support in zip(self.supports, scene.get("supports", []), strict=True):
            joint, rotation = self._at(key)
            moved = support.get("prescribe", {})
            for c, axis in enumerate("xy"):
                if support.get("clamp") or axis in support.get("fix", []) or axis in moved:
                    joint.held[c] = True
                    joint.moved[c] += moved.get(axis, 0.0)
            if support.get("clamp"):
                rotation.held = True
                rotation.moved += moved.get("angle", 0.0)
            spring = support.get("spring", {})
            joint.spring += _pair(spring.get("stiffness", 0.0))
            rotation.spring += spring.get("rotational_stiffness", 0.0)

    def _load(self, scene: Scene) -> None:
        for load in scene.get("loads", []):
            if "point_force" in load:
                key = self.key(load["point_force"])
                force = np.asarray(load["point_force"]["force"], dtype=float)
                joint = self._at(key)[0]
                if load["point_force"].get("follower"):
                    joint.followers.append((self._rotation_at[key], force))
                else:
                    joint.force += force
            elif "joint" in load.get("moment", {}):
                self.hinges[load["moment"]["joint"]].moment += load["moment"]["moment"]
            elif "moment" in load:
                self._at(self.key(load["moment"]))[1].moment += load["moment"]["moment"]
            elif "distributed_force" in load:
                for piece in self.pieces:
                    if piece.rod == load["distributed_force"]["rod"]:
                        piece.load += load["distributed_force"]["force"]
            elif "gravity" in load:
                for piece in self.pieces:
                    piece.load += piece.mass * np.asarray(load["gravity"])
            else:
                raise ValueError(f"a network has no {next(iter(load))}")

    def _at(self, key: Key) -> tuple[_Joint, _Rotation]:
        return self.joints[self._joint_at[key]], self.rotations[self._rotation_at[key]]

    def _parameters(self) -> None:
        pieces = self.pieces
        self._EA, self._EI, self._mass, self._curvature, self._direction, self._span = (
            np.array(values)
            for values in (
                [p.EA for p in pieces],
                [p.EI for p in pieces],
                [p.mass for p in pieces],
                [p.curvature for p in pieces],
                [p.direction for p in pieces],
                [p.end - p.start for p in pieces],
            )
        )
        self._q = np.array([p.load for p in pieces])

    def _rate(self, y: Complex, level: float, square: float, out: Complex) -> None:
        """Set `out` to the derivative by s of (x, y, theta, H, V, M), shape (lanes, 6, pieces)."""
        x, z, theta, H, V, M = (y[:, i] for i in range(6))
        c, s = np.cos(theta), np.sin(theta)
        stretch = 1 + (H * c + V * s) / self._EA
        inertia = 1j * self._mass * square
        out[:, 0] = stretch * c
        out[:, 1] = stretch * s
        out[:, 2] = M / self._EI + level * self._curvature
        out[:, 3] = -level * self._q[:, 0] - inertia * x.imag
        out[:, 4] = -level * self._q[:, 1] - inertia * z.imag
        out[:, 5] = stretch * (H * s - V * c)

    def _shoot(self, y: Complex, spans: Array, level: float, square: float = 0.0) -> Complex:
        h = spans / self.steps
        stages = np.empty((*y.shape, len(_B)), dtype=complex)
        for _ in range(self.steps):
            for i in range(len(_B)):
                here = y + h * (_A[i, :i] * stages[..., :i]).sum(axis=-1)
                self._rate(here, level, square, stages[..., i])
            y = y + h * (_B * stages).sum(axis=-1)
        return y

    def _unpack(self, w: Array) -> tuple[Array, Array, Array]:
        j, r = 2 * len(self.joints), len(self.rotations)
        return w[:j].reshape(-1, 2), w[j : j + r], w[j + r :].reshape(-1, 3)

    def _starts(self, w: Array) -> Array:
        """(x, y, theta, H, V, M) where each piece begins, shape (6, pieces)."""
        places, turns, forces = self._unpack(w)
        first = [p.joints[0] for p in self.pieces]
        theta = self._direction + turns[[p.rotations[0] for p in self.pieces]]
        return np.vstack([places[first].T, theta, forces.T])

    def _system(self, w: Array, level: float, square: float = 0.0) -> tuple[Array, Array]:
        places, turns, forces = self._unpack(w)
        J, R, P = len(self.joints), len(self.rotations), len(self.pieces)
        y = np.repeat(self._starts(w)[np.newaxis].astype(complex), 6, axis=0)
        y[np.arange(6), np.arange(6)] += 1j * _TINY
        y = self._shoot(y, self._span, level, square)
        end, slope = y[0].real, y.imag / _TINY  # slope[by, of, piece]
        residual = np.zeros(2 * J + R + 3 * P)
        matrix = np.zeros((len(residual), len(residual)))
        for i, joint in enumerate(self.joints):
            for c in range(2):
                row = 2 * i + c
                moved = places[i, c] - joint.place[c]
                if joint.held[c]:
                    residual[row] = moved - level * joint.moved[c]
                    matrix[row, row] = 1.0
                else:
                    residual[row] = level * joint.force[c] - joint.spring[c] * moved
                    matrix[row, row] = -joint.spring[c]
                    for group, force in joint.followers:
                        cosine, sine = np.cos(turns[group]), np.sin(turns[group])
                        across = np.array([-force[1], force[0]])
                        residual[row] += level * (cosine * force + sine * across)[c]
                        matrix[row, 2 * J + group] += level * (cosine * across - sine * force)[c]
        for i, rotation in enumerate(self.rotations):
            row = 2 * J + i
            if rotation.held:
                residual[row] = turns[i] - level * rotation.moved
                matrix[row, row] = 1.0
            else:
                residual[row] = level * rotation.moment - rotation.spring * turns[i]
                matrix[row, row] = -rotation.spring
        for hinge in self.hinges.values():
            first, second = hinge.sides
            on_second = level * hinge.moment - hinge.spring * (turns[second] - turns[first])
            for side, sign in ((first, -1.0), (second, 1.0)):
                if self.rotations[side].held:
                    continue
                residual[2 * J + side] += sign * on_second
                matrix[2 * J + side, 2 * J + second] -= sign * hinge.spring
                matrix[2 * J + side, 2 * J + first] += sign * hinge.spring
        for spring in self.springs.values():
            pull, slope_of_pull = spring.pull(places, level)
            ends = 2 * np.array(spring.joints)
            for own, sign in zip(ends, (1.0, -1.0), strict=True):
                for c in range(2):
                    if self.joints[own // 2].held[c]:
                        continue
                    residual[own + c] += sign * pull[c]
                    matrix[own + c, ends[0] : ends[0] + 2] -= sign * slope_of_pull[c]
                    matrix[own + c, ends[1] : ends[1] + 2] += sign * slope_of_pull[c]
        for k, piece in enumerate(self.pieces):
            a, b = piece.joints
            ra, rb = 2 * J + piece.rotations[0], 2 * J + piece.rotations[1]
            own = 2 * J + R + 3 * k
            of = [2 * a, 2 * a + 1, ra, own, own + 1, own + 2]
            free_a = [not self.joints[a].held[c] for c in range(2)]
            free_a.append(not self.rotations[piece.rotations[0]].held)
            free_b = [not self.joints[b].held[c] for c in range(2)]
            free_b.append(not self.rotations[piece.rotations[1]].held)
            for c, row in enumerate((2 * a, 2 * a + 1, ra)):
                if free_a[c]:
                    residual[row] += forces[k, c]
                    matrix[row, own + c] += 1.0
            for c, row in enumerate((2 * b, 2 * b + 1, rb)):
                if free_b[c]:
                    residual[row] -= end[3 + c, k]
                    matrix[row, of] -= slope[:, 3 + c, k]
            goal = (*places[b], piece.direction + turns[piece.rotations[1]])
            for c, column in enumerate((2 * b, 2 * b + 1, rb)):
                residual[own + c] = end[c, k] - goal[c]
                matrix[own + c, of] += slope[:, c, k]
                matrix[own + c, column] -= 1.0
        return residual, matrix

    def solve(self, levels: int = 3) -> Network:
        """Find the equilibrium, with all loads and motions raised in equal parts."""
        w = np.concatenate(
            [
                np.concatenate([joint.place for joint in self.joints]),
                np.zeros(len(self.rotations) + 3 * len(self.pieces)),
            ]
        )
        for level in np.arange(1, levels + 1) / levels:
            step = np.inf
            for _ in range(60):
                residual, matrix = self._system(w, level)
                before, step = step, self._step(matrix, residual)
                w = w + self._last
                if step < 1e-10 and step >= 0.5 * before:
                    break
            else:
                raise RuntimeError(f"no convergence at the level {level}, last step {step}")
        self.w = w
        return self

    def _step(self, matrix: Array, residual: Array) -> float:
        scale = np.abs(matrix).max(axis=1)
        self._last = -np.linalg.solve(matrix / scale[:, np.newaxis], residual / scale)
        j = 2 * len(self.joints) + len(self.rotations)
        return float(np.abs(self._last[:j]).max())

    def states(self, rod: str, places: Array, side: str = "after") -> Array:
        """(x, y, theta, H, V, M) at arc lengths, the last three of the part beyond: (6, places)."""
        own = [k for k, piece in enumerate(self.pieces) if piece.rod == rod]
        tiny = 1e-9 * self.length(rod) * (1 if side == "after" else -1)
        ends = np.array([self.pieces[k].end for k in own[:-1]])
        piece = np.array(own)[np.searchsorted(ends, places + tiny)]
        spans = places - np.array([self.pieces[k].start for k in piece])
        start = np.repeat(self._starts(self.w)[np.newaxis].astype(complex), len(places), axis=0)
        lanes = np.arange(len(places))
        end = self._shoot(start, spans[:, np.newaxis, np.newaxis], 1.0)
        return np.asarray(end[lanes, :, piece].T.real, dtype=float)

    def along(self, quantity: str, rod: str, places: Array, side: str = "after") -> Array:
        """A quantity as `der` names it, at arc lengths."""
        x, y, theta, H, V, M = self.states(rod, np.asarray(places, dtype=float), side)
        section = self.rods[rod]["cross_section"]["stiffness"]
        tension = H * np.cos(theta) + V * np.sin(theta)
        curvature = M / section["EI"] + self.rods[rod].get("natural_curvature", 0.0)
        values: dict[str, Array] = {"x": x, "y": y, "slope": theta, "moment": M}
        values |= {"tension": tension, "strain": tension / section["EA"], "curvature": curvature}
        return values[quantity]

    def read(self, quantity: str, rod: str, at: Any, side: str = "after") -> float:
        """A quantity at one place."""
        s = self.key({"rod": rod, "at": at})[1] * self.length(rod)
        return float(self.along(quantity, rod, np.array([s]), side)[0])

    def spring(self, name: str) -> tuple[float, float]:
        """Length and force of a spring between joints."""
        spring = self.springs[name]
        places = self._unpack(self.w)[0]
        length = float(np.hypot(*(places[spring.joints[1]] - places[spring.joints[0]])))
        return length, spring.stiffness * (length - spring.rest_length)

    def reaction(self, support: int) -> Array:
        """Force and moment that a support exerts, where it is the only one at its place."""
        key = self.supports[support]
        number, group = self._joint_at[key], self._rotation_at[key]
        joint, rotation = self.joints[number], self.rotations[group]
        places, turns, forces = self._unpack(self.w)
        ends = self._shoot(self._starts(self.w)[np.newaxis].astype(complex), self._span, 1.0)[0]
        total = np.zeros(3)
        for k, piece in enumerate(self.pieces):
            if piece.joints[0] == number:
                total[:2] += forces[k, :2]
            if piece.joints[1] == number:
                total[:2] -= ends[3:5, k].real
            if piece.rotations[0] == group:
                total[2] += forces[k, 2]
            if piece.rotations[1] == group:
                total[2] -= ends[5, k].real
        for spring in self.springs.values():
            pull = spring.pull(places, 1.0)[0]
            for joint_there, sign in zip(spring.joints, (1.0, -1.0), strict=True):
                if joint_there == number:
                    total[:2] += sign * pull
        exerted = np.zeros(3)
        for c in range(2):
            moved = places[number, c] - joint.place[c]
            exerted[c] = -joint.spring[c] * moved
            if joint.held[c]:
                exerted[c] = -total[c] - joint.force[c]
        exerted[2] = -rotation.spring * turns[group]
        if rotation.held:
            exerted[2] = -total[2] - rotation.moment
        return exerted

    def _sign(self, omega: float) -> float:
        """Changes its sign at each natural frequency."""
        matrix = self._system(self.w, 1.0, omega**2)[1]
        scaled = matrix / np.abs(matrix).max(axis=1)[:, np.newaxis]
        scaled = scaled / np.abs(scaled).max(axis=0)
        direction, log = np.linalg.slogdet(scaled)
        return float(direction * np.exp(log / len(matrix)))

    def frequency_near(self, omega: float) -> float:
        """The natural angular frequency within 2 % of `omega`: the only one there."""
        return float(brentq(self._sign, 0.98 * omega, 1.02 * omega, xtol=1e-9 * omega))

    def frequencies(self, highest: float, step: float) -> Array:
        """Angular frequencies below `highest` that are at least `step` apart."""
        grid = np.arange(step / 7, highest, step)
        signs = [self._sign(omega) for omega in grid]
        return np.array(
            [
                brentq(self._sign, grid[i], grid[i + 1], xtol=1e-9 * highest)
                for i in range(len(grid) - 1)
                if signs[i] * signs[i + 1] < 0
            ]
        )
