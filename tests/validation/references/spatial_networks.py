"""Networks of rods in space that stretch, bend and twist, by shooting from joint to joint.

Each rod of a scene is cut where anything acts at a point. Between two cuts it is an extensible
Kirchhoff rod: s the rest length, r the place, (d1, d2, t) the section, n and m the force and the
moment that the part beyond s exerts on the part before it,

    r' = (1 + n . t / EA) t,    n' = -q,    m' = -r' x n,    d_i' = w x d_i
    w = (m . d2 / EI1 + k1) d2 - (-m . d1 / EI2 + k2) d1 + (m . t / GJ + k3) t

with a dead load q, natural curvatures k1, k2 towards the directors and a natural twist k3. Unknown
are the place of each joint, the rotation of each group of rods that turn together, and (n, m) where
each piece begins. The equations say that each piece ends at its joint with the joint's rotation,
and that forces and moments of joints balance. Pieces are
integrated in equal steps of the method of order 8 of Dormand and Prince. Derivatives are complex
steps, and each iteration of Newton's method counts rotations from the last one.

A scene is read as far as it has rods that are straight or arcs of circles drawn by `points`, rigid
joints and balls, supports (components, clamps, constant motions, springs) and loads. Nothing is
shared with `der`.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.spatial.transform import Rotation

from .record import Array

Scene = dict[str, Any]
Complex = NDArray[np.complex128]
Key = tuple[str, float]  # a rod and the share of its length

_A, _B = DOP853.A[: DOP853.n_stages, : DOP853.n_stages], DOP853.B
_TINY = 1e-30


def _cross(a: Any, b: Any) -> Any:
    """Cross product along axis 1 of arrays of shape (lanes, 3, pieces)."""
    return np.stack(
        [
            a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1],
            a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2],
            a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
        ],
        axis=1,
    )


def _skew(v: Array) -> Array:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


class _Line:
    """A rod as drawn: straight, or an arc of a circle."""

    def __init__(self, rod: Scene) -> None:
        section = rod["cross_section"]
        director = np.asarray(section.get("director", [0.0, 0.0, 1.0]), dtype=float)
        if "points" in rod:
            points = np.asarray(rod["points"], dtype=float)
            a, b, c = points[0], points[len(points) // 2], points[-1]
            normal = np.cross(b - a, c - a)
            matrix = np.array([b - a, c - a, normal])
            right = np.array([(b - a) @ (b + a) / 2, (c - a) @ (c + a) / 2, normal @ a])
            centre = np.linalg.solve(matrix, right)
            self.start = a
            self.radius = float(np.linalg.norm(a - centre))
            out = (a - centre) / self.radius
            axis = normal / np.linalg.norm(normal)
            self.tangent = np.cross(axis, out)
            end = (c - centre) / self.radius
            self.length = self.radius * float(
                np.arctan2(end @ self.tangent, end @ out) % (2 * np.pi)
            )
            self.axis = axis
        else:
            self.start = np.asarray(rod["from"], dtype=float)
            along = np.asarray(rod["to"], dtype=float) - self.start
            self.length = float(np.linalg.norm(along))
            self.tangent = along / self.length
            self.radius = np.inf
            self.axis = np.zeros(3)
        if np.linalg.norm(np.cross(director, self.tangent)) < 1e-6:
            raise ValueError(f"rod {rod['name']} lies along its director: give another one")
        first = director - director @ self.tangent * self.tangent
        first /= np.linalg.norm(first)
        self.section = np.array([first, np.cross(self.tangent, first), self.tangent])

    def at(self, s: float) -> tuple[Array, Array]:
        """Place and section (d1, d2, t in rows)."""
        if np.isinf(self.radius):
            return self.start + s * self.tangent, self.section
        angle = s / self.radius
        inward = np.cross(self.axis, self.tangent)
        place = self.start + self.radius * (
            np.sin(angle) * self.tangent + (1 - np.cos(angle)) * inward
        )
        turn = Rotation.from_rotvec(angle * self.axis).as_matrix()
        return place, self.section @ turn.T

    def curvatures(self) -> tuple[float, float]:
        """Towards the two directors, which are transported without twist."""
        if np.isinf(self.radius):
            return 0.0, 0.0
        bend = np.cross(self.axis, self.tangent) / self.radius
        return float(bend @ self.section[0]), float(bend @ self.section[1])


def _spring_energy(stiffness: Array, section: Array, turn: Any) -> Any:
    """Of a rotational spring, by the strains between a section as drawn and as `turn` turns it.

    The strains are the turning angle towards the directors of half the twist, and the twist.
    """
    now = section @ turn.T
    d1, _, t = section
    across = np.cross(t, now[2])
    square, cosine = across @ across, t @ now[2]
    sine = np.sqrt(square)
    factor = 1 + square / 6 if abs(square) < 1e-8 else np.arctan(sine / cosine) / sine
    moved = cosine * d1 + np.cross(across, d1) + (across @ d1) / (1 + cosine) * across
    second = np.cross(now[2], moved)
    twist = np.arctan((now[0] @ second) / (now[0] @ moved))
    c, s = np.cos(twist / 2), np.sin(twist / 2)
    directors = c * d1 + s * section[1], c * section[1] - s * d1
    strains = np.array([factor * (m @ now[2]) for m in directors] + [twist])
    return 0.5 * stiffness @ strains**2


@dataclass
class _Piece:
    """A part of a rod between two cuts."""

    rod: str
    start: float
    end: float
    joints: tuple[int, int]
    rotations: tuple[int, int]
    sections: tuple[Array, Array]
    load: Array


@dataclass
class _Joint:
    """A point where pieces meet: what holds and loads it."""

    place: Array
    held: list[bool] = field(default_factory=lambda: [False] * 3)
    moved: Array = field(default_factory=lambda: np.zeros(3))
    spring: Array = field(default_factory=lambda: np.zeros(3))
    force: Array = field(default_factory=lambda: np.zeros(3))
    followers: list[tuple[int, Array]] = field(default_factory=list)  # with their rotations


@dataclass
class _Rotation:
    """The rotation of sections that turn together."""

    held: bool = False
    moved: Array = field(default_factory=lambda: np.zeros(3))
    moment: Array = field(default_factory=lambda: np.zeros(3))
    follower: Array = field(default_factory=lambda: np.zeros(3))
    springs: list[tuple[Array, Array]] = field(default_factory=list)  # stiffness, section

    def spring_moment(self, turn: Array) -> Array:
        """What its springs exert."""
        moment = np.zeros(3)
        for stiffness, section in self.springs:
            for c in range(3):
                nudged = turn + 1j * _TINY * _skew(np.eye(3)[c]) @ turn
                moment[c] -= _spring_energy(stiffness, section, nudged).imag / _TINY
        return moment

    def spring_slope(self, turn: Array) -> Array:
        """Its derivative by a further rotation, by differences."""
        if not self.springs:
            return np.zeros((3, 3))
        columns = []
        for c in range(3):
            steps = [Rotation.from_rotvec(h * np.eye(3)[c]).as_matrix() for h in (1e-5, -1e-5)]
            columns.append(np.subtract(*(self.spring_moment(each @ turn) for each in steps)) / 2e-5)
        return np.stack(columns, axis=1)


class SpatialNetwork:
    """The rods of a scene."""

    def __init__(self, scene: Scene, steps: int = 8) -> None:
        self.steps = steps
        self.rods = {rod["name"]: rod for rod in scene["rods"]}
        self.lines = {name: _Line(rod) for name, rod in self.rods.items()}
        self.joints: list[_Joint] = []
        self.rotations: list[_Rotation] = []
        self.pieces: list[_Piece] = []
        self.joint_at: dict[Key, int] = {}
        self.rotation_at: dict[Key, int] = {}
        self._members = {joint["name"]: joint["of"][0] for joint in scene.get("joints", [])}
        self._cut(scene)
        self._hold(scene)
        self._load(scene)
        self._parameters()
        self.x = np.array([joint.place for joint in self.joints])
        self.turns = np.repeat(np.eye(3)[np.newaxis], len(self.rotations), axis=0)
        self.forces = np.zeros((len(self.pieces), 6))

    def key(self, place: Scene) -> Key:
        """Key of a place, a mapping with `rod` and `at`, or with `joint`."""
        if "joint" in place:
            place = self._members[place["joint"]]
        rod, at = place["rod"], place["at"]
        length = self.lines[rod].length
        named = {"start": 0.0, "middle": 0.5 * length, "end": length}
        s = named[at] if isinstance(at, str) else float(at)
        return rod, round(s / length, 13)

    def _cut(self, scene: Scene) -> None:
        loads = [what for load in scene.get("loads", []) for what in load.values()]
        joints = scene.get("joints", [])
        places = [member for joint in joints for member in joint["of"]]
        places += scene.get("supports", [])
        places += [what for what in loads if isinstance(what, dict) and "rod" in what]
        keys = {self.key(place) for place in places if "at" in place}
        keys |= {(rod, end) for rod in self.rods for end in (0.0, 1.0)}
        for joint in joints:
            members = [self.key(member) for member in joint["of"]]
            self.joint_at |= dict.fromkeys(members, len(self.joints))
            self.joints.append(_Joint(self._drawn(members[0])))
            if joint.get("kind", "rigid") == "rigid":
                self.rotation_at |= dict.fromkeys(members, len(self.rotations))
                self.rotations.append(_Rotation())
        for key in sorted(keys):
            if key not in self.joint_at:
                self.joint_at[key] = len(self.joints)
                self.joints.append(_Joint(self._drawn(key)))
            if key not in self.rotation_at:
                self.rotation_at[key] = len(self.rotations)
                self.rotations.append(_Rotation())
        for name, line in self.lines.items():
            cuts = sorted(share for owner, share in keys if owner == name)
            for a, b in itertools.pairwise(cuts):
                ends = a * line.length, b * line.length
                self.pieces.append(
                    _Piece(
                        name,
                        *ends,
                        (self.joint_at[name, a], self.joint_at[name, b]),
                        (self.rotation_at[name, a], self.rotation_at[name, b]),
                        (line.at(ends[0])[1], line.at(ends[1])[1]),
                        np.zeros(3),
                    )
                )

    def _drawn(self, key: Key) -> Array:
        line = self.lines[key[0]]
        place: Array = line.at(key[1] * line.length)[0]
        return place

    def _hold(self, scene: Scene) -> None:
        self.supports = [self.key(each) for each in scene.get("supports", [])]
        for key, support in zip(self.supports, scene.get("supports", []), strict=True):
            joint, rotation = self.joints[self.joint_at[key]], self.rotations[self.rotation_at[key]]
            section = self.lines[key[0]].at(key[1] * self.lines[key[0]].length)[1]
            moved = support.get("prescribe", {})
            for c, axis in enumerate("xyz"):
                if support.get("clamp") or axis in support.get("fix", []) or axis in moved:
                    joint.held[c] = True
                    joint.moved[c] += moved.get(axis, 0.0)
            if support.get("clamp"):
                rotation.held = True
                if "rotation" in moved:
                    about = np.asarray(moved["rotation"]["axis"], dtype=float)
                    rotation.moved += moved["rotation"]["angle"] * about / np.linalg.norm(about)
                if "twist" in moved:
                    rotation.moved += moved["twist"] * section[2]
            spring = support.get("spring", {})
            stiffness = spring.get("stiffness", 0.0)
            joint.spring += np.full(3, stiffness) if np.isscalar(stiffness) else stiffness
            if "rotational_stiffness" in spring:
                turning = np.asarray(spring["rotational_stiffness"], dtype=float)
                rotation.springs.append((np.broadcast_to(turning, 3), section))

    def _load(self, scene: Scene) -> None:
        for load in scene.get("loads", []):
            kind, what = next(iter(load.items()))
            if kind == "point_force":
                key = self.key(what)
                joint = self.joints[self.joint_at[key]]
                if what.get("follower"):
                    joint.followers.append((self.rotation_at[key], np.asarray(what["force"])))
                else:
                    joint.force += what["force"]
            elif kind == "moment":
                rotation = self.rotations[self.rotation_at[self.key(what)]]
                if what.get("follower"):
                    rotation.follower += what["moment"]
                else:
                    rotation.moment += what["moment"]
            elif kind == "distributed_force":
                for piece in self.pieces:
                    if piece.rod == what["rod"]:
                        piece.load += what["force"]
            elif kind == "gravity":
                for piece in self.pieces:
                    section = self.rods[piece.rod]["cross_section"]["stiffness"]
                    piece.load += section["mass_per_length"] * np.asarray(what)
            else:
                raise ValueError(f"a network has no {kind}")

    def _parameters(self) -> None:
        def each(value: Any) -> Array:
            return np.array([value(piece) for piece in self.pieces])

        def stiffness(piece: _Piece) -> Scene:
            section: Scene = self.rods[piece.rod]["cross_section"]["stiffness"]
            return section

        self._EA = each(lambda p: stiffness(p)["EA"])
        self._EI_1 = each(lambda p: self.section_of(p.rod)[0])
        self._EI_2 = each(lambda p: self.section_of(p.rod)[1])
        self._GJ = each(lambda p: stiffness(p)["GJ"])
        self._twist = each(lambda p: self.rods[p.rod].get("natural_twist", 0.0))
        self._natural = each(lambda p: self.natural(p.rod)).T
        self._drawn_bend = each(lambda p: self.lines[p.rod].curvatures()).T
        self._q = each(lambda p: p.load).T
        self._span = each(lambda p: p.end - p.start)

    def section_of(self, rod: str) -> tuple[float, float]:
        """EI towards the two directors."""
        section = self.rods[rod]["cross_section"]["stiffness"]
        if "EI" in section:
            return section["EI"], section["EI"]
        return section["EI1"], section["EI2"]

    def natural(self, rod: str) -> tuple[float, float]:
        """Natural curvatures towards the two directors."""
        given = self.rods[rod].get("natural_curvature")
        return self.lines[rod].curvatures() if given is None else (given[0], given[1])

    def _rate(self, y: Complex, level: float, out: Complex) -> None:
        """Set `out` to the derivative by s of (r, d1, d2, t, n, m), shape (lanes, 18, pieces)."""
        d1, d2, t, n, m = (y[:, 3 * i : 3 * i + 3] for i in range(1, 6))
        along = (1 + (n * t).sum(axis=1, keepdims=True) / self._EA) * t
        # Natural curvatures grow from those of the drawn rod with the level.
        natural = self._drawn_bend + level * (self._natural - self._drawn_bend)
        bend_1 = (m * d2).sum(axis=1, keepdims=True) / self._EI_1 + natural[0]
        bend_2 = -(m * d1).sum(axis=1, keepdims=True) / self._EI_2 + natural[1]
        twist = (m * t).sum(axis=1, keepdims=True) / self._GJ + level * self._twist
        w = bend_1 * d2 - bend_2 * d1 + twist * t
        out[:, 0:3] = along
        out[:, 3:6] = _cross(w, d1)
        out[:, 6:9] = _cross(w, d2)
        out[:, 9:12] = _cross(w, t)
        out[:, 12:15] = -level * self._q
        out[:, 15:18] = -_cross(along, n)

    def _shoot(self, y: Complex, spans: Array, level: float) -> Complex:
        h = spans / self.steps
        stages = np.empty((len(_B), *y.shape), dtype=complex)
        for _ in range(self.steps):
            for i in range(len(_B)):
                here = y.copy()
                for j in range(i):
                    if _A[i, j] != 0.0:
                        here += (h * _A[i, j]) * stages[j]
                self._rate(here, level, stages[i])
            y = y + sum((h * _B[i]) * stages[i] for i in range(len(_B)))
        return y

    def _starts(self, lanes: int) -> Complex:
        """(r, d1, d2, t, n, m) where each piece begins, shape (lanes, 18, pieces)."""
        y = np.empty((18, len(self.pieces)))
        for k, piece in enumerate(self.pieces):
            y[:3, k] = self.x[piece.joints[0]]
            y[3:12, k] = (piece.sections[0] @ self.turns[piece.rotations[0]].T).ravel()
            y[12:, k] = self.forces[k]
        return np.repeat(y[np.newaxis].astype(complex), lanes, axis=0)

    def _system(self, level: float) -> tuple[Array, Array]:
        J, R, P = 3 * len(self.joints), 3 * len(self.rotations), len(self.pieces)
        y = self._starts(12)
        for c in range(3):
            y[c, c] += 1j * _TINY  # a place
            spin = _skew(np.eye(3)[c])
            for d in range(3):  # a rotation turns the directors
                rows = slice(3 + 3 * d, 6 + 3 * d)
                y[3 + c, rows] += 1j * _TINY * (spin @ y[3 + c, rows].real)
        for c in range(6):
            y[6 + c, 12 + c] += 1j * _TINY
        y = self._shoot(y, self._span, level)
        end, slope = y[0].real, y.imag / _TINY  # slope[by, of, piece]
        residual = np.zeros(J + R + 6 * P)
        matrix = np.zeros((len(residual), len(residual)))
        for i, joint in enumerate(self.joints):
            moved = self.x[i] - joint.place
            for c in range(3):
                row = 3 * i + c
                if joint.held[c]:
                    residual[row] = moved[c] - level * joint.moved[c]
                    matrix[row, row] = 1.0
                    continue
                residual[row] = level * joint.force[c] - joint.spring[c] * moved[c]
                matrix[row, row] = -joint.spring[c]
                for number, drawn in joint.followers:
                    force = level * self.turns[number] @ drawn
                    residual[row] += force[c]
                    matrix[row, J + 3 * number : J + 3 * number + 3] -= _skew(force)[c]
        for i, rotation in enumerate(self.rotations):
            rows = slice(J + 3 * i, J + 3 * i + 3)
            turn = self.turns[i]
            if rotation.held:
                goal = Rotation.from_rotvec(level * rotation.moved)
                residual[rows] = (Rotation.from_matrix(turn) * goal.inv()).as_rotvec()
                matrix[rows, rows] = np.eye(3)
            else:
                following = level * turn @ rotation.follower
                residual[rows] = level * rotation.moment + following + rotation.spring_moment(turn)
                matrix[rows, rows] = rotation.spring_slope(turn) - _skew(following)
        for k, piece in enumerate(self.pieces):
            own = J + R + 6 * k
            at_ends = []
            ends = list(zip(piece.joints, piece.rotations, strict=True))
            for a, b in ends:
                at_ends.append([*range(3 * a, 3 * a + 3), *range(J + 3 * b, J + 3 * b + 3)])
            of = at_ends[0] + list(range(own, own + 6))
            for side, (a, b) in enumerate(ends):
                held = [*self.joints[a].held, *[self.rotations[b].held] * 3]
                for c, row in enumerate(at_ends[side]):
                    if held[c]:
                        continue
                    if side == 0:
                        residual[row] += self.forces[k, c]
                        matrix[row, own + c] += 1.0
                    else:
                        residual[row] -= end[12 + c, k]
                        matrix[row, of] -= slope[:, 12 + c, k]
            residual[own : own + 3] = end[:3, k] - self.x[piece.joints[1]]
            matrix[own : own + 3, of] = slope[:, :3, k].T
            matrix[own : own + 3, at_ends[1][:3]] -= np.eye(3)
            goals = piece.sections[1] @ self.turns[piece.rotations[1]].T
            for d in range(3):
                rows = slice(3 + 3 * d, 6 + 3 * d)
                residual[own + 3 : own + 6] += 0.5 * np.cross(goals[d], end[rows, k])
                matrix[own + 3 : own + 6, of] += 0.5 * _skew(goals[d]) @ slope[:, rows, k].T
                # goals[d] turns by w x goals[d].
                matrix[own + 3 : own + 6, at_ends[1][3:]] += (
                    0.5 * _skew(end[rows, k]) @ _skew(goals[d])
                )
        return residual, matrix

    def solve(self, levels: int = 4) -> SpatialNetwork:
        """Find the equilibrium, with all loads and motions raised in equal parts."""
        J, R = 3 * len(self.joints), 3 * len(self.rotations)
        for level in np.arange(1, levels + 1) / levels:
            step = np.inf
            for _ in range(60):
                residual, matrix = self._system(level)
                scale = np.abs(matrix).max(axis=1)
                change = -np.linalg.solve(matrix / scale[:, np.newaxis], residual / scale)
                before, step = step, float(np.abs(change[: J + R]).max())
                share = min(1.0, 0.5 / max(step, 1e-300))
                self.x = self.x + share * change[:J].reshape(-1, 3)
                turns = Rotation.from_rotvec(share * change[J : J + R].reshape(-1, 3))
                self.turns = turns.as_matrix() @ self.turns
                self.forces = self.forces + share * change[J + R :].reshape(-1, 6)
                if step < 1e-10 and step >= 0.5 * before:
                    break
            else:
                raise RuntimeError(f"no convergence at the level {level}, last step {step}")
        return self

    def states(self, rod: str, places: Array, side: str = "after") -> Array:
        """(r, d1, d2, t, n, m) at arc lengths, n and m of the part beyond: (18, places)."""
        own = [k for k, piece in enumerate(self.pieces) if piece.rod == rod]
        tiny = 1e-9 * self.lines[rod].length * (1 if side == "after" else -1)
        ends = np.array([self.pieces[k].end for k in own[:-1]])
        piece = np.array(own)[np.searchsorted(ends, places + tiny)]
        spans = places - np.array([self.pieces[k].start for k in piece])
        lanes = np.arange(len(places))
        end = self._shoot(self._starts(len(places)), spans[:, np.newaxis, np.newaxis], 1.0)
        return np.asarray(end[lanes, :, piece].T.real, dtype=float)

    def along(self, quantity: str, rod: str, places: Array, side: str = "after") -> Array:
        """A quantity as `der` names it, at arc lengths."""
        y = self.states(rod, np.asarray(places, dtype=float), side)
        d1, d2, t, n, m = (y[3 * i : 3 * i + 3] for i in range(1, 6))
        moment_1, moment_2 = (m * d2).sum(axis=0), -(m * d1).sum(axis=0)
        torque, tension = (m * t).sum(axis=0), (n * t).sum(axis=0)
        EI_1, EI_2 = self.section_of(rod)
        natural = self.natural(rod)
        values: dict[str, Array] = dict(zip(["x", "y", "z"], y[:3], strict=True))
        values |= dict(zip(["tx", "ty", "tz"], t, strict=True))
        values |= {"moment_1": moment_1, "moment_2": moment_2, "torque": torque}
        values |= {"tension": tension, "moment": np.hypot(moment_1, moment_2)}
        values["curvature_1"] = moment_1 / EI_1 + natural[0]
        values["curvature_2"] = moment_2 / EI_2 + natural[1]
        values["twist"] = torque / self.rods[rod]["cross_section"]["stiffness"]["GJ"]
        values["twist"] += self.rods[rod].get("natural_twist", 0.0)
        return values[quantity]

    def read(self, quantity: str, rod: str, at: Any, side: str = "after") -> float:
        """A quantity at one place."""
        s = self.key({"rod": rod, "at": at})[1] * self.lines[rod].length
        return float(self.along(quantity, rod, np.array([s]), side)[0])

    def rotation(self, place: Scene) -> Array:
        """Rotation vector of a joint, of up to half a turn."""
        turn = Rotation.from_matrix(self.turns[self.rotation_at[self.key(place)]])
        return np.asarray(turn.as_rotvec())

    def exerted(self, joint: str, rod: str) -> Array:
        """Force and moment (6) that the pieces of a rod exert on a joint."""
        number = self.joint_at[self.key({"joint": joint})]
        of_rod = [k for k, piece in enumerate(self.pieces) if piece.rod == rod]
        return self._exerted("joints", number, of_rod)

    def _exerted(self, at: str, number: int, pieces: list[int]) -> Array:
        ends = self._shoot(self._starts(1), self._span, 1.0)[0].real
        total = np.zeros(6)
        for k in pieces:
            of = getattr(self.pieces[k], at)
            if of[0] == number:
                total += self.forces[k]
            if of[1] == number:
                total -= ends[12:, k]
        return total

    def reaction(self, support: int) -> Array:
        """Force and moment that a support exerts, where it is the only one at its place."""
        key = self.supports[support]
        number, turned = self.joint_at[key], self.rotation_at[key]
        joint, rotation = self.joints[number], self.rotations[turned]
        every = list(range(len(self.pieces)))
        force = -self._exerted("joints", number, every)[:3] - joint.force
        for group, drawn in joint.followers:
            force = force - self.turns[group] @ drawn
        exerted = np.zeros(6)
        exerted[:3] = -joint.spring * (self.x[number] - joint.place)
        held = np.array(joint.held)
        exerted[:3][held] = force[held]
        exerted[3:] = rotation.spring_moment(self.turns[turned])
        if rotation.held:
            total = self._exerted("rotations", turned, every)[3:]
            exerted[3:] = -total - rotation.moment - self.turns[turned] @ rotation.follower
        return exerted
