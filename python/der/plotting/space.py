"""Pictures of runs in space: shaded tubes, with supports, loads and actuation as solids."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.typing import ColorType
from numpy.typing import NDArray

from der._core import HeldNode, Rod, SpringSupport, springs
from der.actuated_stretches import ActuatedStretch
from der.film import mode_displacements
from der.plotting.camera import along_axes, perspective
from der.plotting.floor import Floor
from der.plotting.lengths import label_positions
from der.plotting.loads import add_gravity_to_legend, write_beside
from der.plotting.picture import Picture
from der.plotting.shapes import Shape
from der.plotting.solids import Faces, box, circle, draw_faces, sphere, tube, turned_profile
from der.plotting.style import LOAD, actuated_colour, quantity_text
from der.scene_loads import ActingLoads, ground_direction, place_on
from der.sections import Section, sections_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from der.run_data import RunData

Array = NDArray[np.float64]

# Sizes against that of the scene.
_THINNEST = 0.02  # of the larger side of a section
_PIECE = 0.04  # of the pieces that long edges are drawn in
_TURN = 0.35  # [rad] that a piece is twisted
_SUPPORT = 0.03
_FORCE, _LINE_FORCE, _MOMENT, _SHAFT = 0.14, 0.08, 0.055, 0.0045
_COIL = 0.06
_LINE_ARROWS = 9  # of a distributed force on a whole rod
_FOUNDATION_SPRINGS = 15  # of a foundation of a whole rod

_STRIPE = np.radians(24.0)  # half of the stripe on a round section
_EDGE = 0.7  # of half the width of a rectangle; what is beyond has the stripe
_GREY = "#9aa3ad"
_SLEEVE = (1.12, 1.75)  # thickness of an actuated stretch against the rod's: of value 0, and full


class SpatialPicture(Picture):
    """A run in space, in perspective above a floor, or flat along an axis."""

    def __init__(self, result: RunData, view: str, scale: float = 1.0) -> None:
        super().__init__(result, scale)
        if view == "3d":
            self.has_axes, self.instants = False, 4
        moved = self.positions[-1] + mode_displacements(result)
        points = np.concatenate([self.positions, moved]).reshape(-1, 3)
        self.reach = max(float(rod.sphere_radii.max(initial=rod.radius)) for rod in result.rods)
        around = np.vstack([points - self.reach, points + self.reach])
        self.size = max(float(np.ptp(around, axis=0).max()), 1e-300)
        gravity = self.loads(0).gravity
        up = _upwards(gravity)
        self.floor = Floor.below(around, up) if view == "3d" else None
        self.up = up
        self.camera = perspective(points, up) if view == "3d" else along_axes(view)

    @cached_property
    def _sections(self) -> list[Section]:
        """The section of each rod as it is drawn: at least as thick as can be seen."""
        found = []
        for rod, section in zip(self.rods, sections_of(self.result), strict=True):
            thickness = 2.0 * rod.radius
            drawn = section or Section(thickness, thickness, circle() * rod.radius)
            width = max(drawn.width, drawn.height)
            least = _THINNEST * self.size
            if width <= 0.0:
                drawn = Section(least, least, 0.5 * least * circle())
            elif width < least:
                share = least / width
                drawn = Section(share * drawn.width, share * drawn.height, share * drawn.outline)
            found.append(drawn)
        return found

    @property
    def magnified(self) -> float:
        """How many times as thick as it is a rod is drawn, at most; 1 where all are as they are."""
        shares = [
            drawn.width / own.width
            for drawn, own in zip(self._sections, sections_of(self.result), strict=True)
            if own is not None
        ]
        return max(shares, default=1.0)

    def corners(
        self, shapes: Sequence[Shape], loads: ActingLoads, room: tuple[float, float]
    ) -> tuple[Array, Array]:
        """Return the corners of what is seen, the floor and its numbers among it."""
        lines = np.concatenate([shape.positions for shape in shapes])
        seen = self.camera.project(lines)[:, :2]
        parts = [seen - self.reach, seen + self.reach]
        if self.floor is not None:
            parts.append(self.camera.project(self.floor.points(self.camera))[:, :2])
        symbols = self._symbols(shapes[-1], loads).corners.reshape(-1, 3)
        corners = np.vstack([*parts, self.camera.project(symbols)[:, :2]])
        low, high = corners.min(axis=0), corners.max(axis=0)
        if self.floor is not None:  # its numbers
            point = float(np.max((high - low) / (np.array(room) - [1.0, 0.6]))) / 72.0
            low = low - point * np.array([34.0, 24.0])
            high = high + point * np.array([20.0, 14.0])
        return low, high

    def seen(self, points: Array) -> Array:
        """Return where points [m], shape (points, 3), are in the picture, shape (points, 2)."""
        return self.camera.project(points)[:, :2]

    def look_as(self, other: Picture) -> None:
        """Look from where another picture of the scene does."""
        assert isinstance(other, SpatialPicture)
        self.camera, self.floor, self.size = other.camera, other.floor, other.size

    def draw(self, axes: Axes, shapes: Sequence[Shape], at: Shape, loads: ActingLoads) -> None:
        """Draw solids; shapes with another line than ``-`` are that line."""
        solid = [shape for shape in shapes if shape.linestyle == "-"]
        for shape in shapes:
            (drawn,) = axes.plot(
                [],
                [],
                color=shape.colour,
                label=shape.label,
                linestyle=shape.linestyle,
                linewidth=4.0 if shape in solid else 1.4,
                solid_capstyle="butt",
                zorder=1.0,
            )
            if shape not in solid:  # lines of all rods, with gaps; they do not stretch the axes
                gap = np.full((1, 3), np.nan)
                lines = [[shape.positions[rod.line_nodes], gap] for rod in self.rods]
                seen = self.camera.project(np.vstack([part for line in lines for part in line]))
                drawn.set_data(seen[:, 0], seen[:, 1])
        # Where shapes lie in one another, the later one is seen.
        layer = 0.5 * _THINNEST * self.size
        bodies = Faces.joined(
            [replace(self._rods(shape), nearer=n * layer) for n, shape in enumerate(solid)]
        )
        if self.floor is not None:
            self.floor.shadow(axes, self.camera, bodies)
        symbols = self._symbols(at, loads)
        symbols = replace(symbols, nearer=symbols.nearer + max(len(solid) - 1, 0) * layer)
        draw_faces(axes, self.camera, Faces.joined([bodies, symbols]))
        self._write_amounts(axes, at, loads)
        if loads.gravity is not None:
            self.add_gravity(axes, loads.gravity)

    def add_gravity(self, axes: Axes, gravity: Array) -> None:
        """Add gravity to the legend, with an arrow as it is seen."""
        add_gravity_to_legend(axes, gravity, self.camera.turned(gravity))

    def finish(self, axes: Axes, low: Array, high: Array, metres_per_point: float) -> None:
        """Title the axes, or draw the floor; say by how much thin rods are drawn thicker."""
        if self.floor is None:
            names = ["xyz"[int(np.argmax(row))] for row in self.camera.rotation[:2]]
            label_positions(axes, low, high, names)
        else:
            axes.set_axis_off()
            self.floor.draw(axes, self.camera, metres_per_point)
        if self.magnified > 1.05:
            text = f"sections drawn {self.magnified:.2g} times as thick"
            axes.annotate(
                text,
                (1.0, 0.0),
                (0.0, 2.0),
                "axes fraction",
                "offset points",
                ha="right",
                va="bottom",
                fontsize=7,
                color="#7a828c",
            )

    def _rods(self, shape: Shape) -> Faces:
        """Return rods and spheres at an instant."""
        parts = []
        for rod, section, directors in zip(self.rods, self._sections, shape.directors, strict=True):
            line, along = _finer(
                shape.positions[rod.line_nodes], directors, _PIECE * self.size, rod.closed
            )
            outline, stripe = _striped(section, self.size)
            colours = np.tile(to_rgb(shape.colour), (len(outline), 1))
            if directors is not None:
                colours[stripe] = _stripe_colour(shape.colour)
            parts.append(tube(line, along, outline, colours))
            nodes = shape.positions[rod.line_nodes]
            for at, radius in zip(nodes, rod.sphere_radii, strict=False):
                if radius > 0.0:
                    parts.append(sphere(at, float(radius), shape.colour))
        return Faces.joined(parts)

    def _symbols(self, at: Shape, loads: ActingLoads) -> Faces:
        """Return actuated stretches, supports and loads on a shape."""
        by_name = {rod.name: rod for rod in self.rods}
        held = self.result.held_nodes(at.frame)
        parts = [
            *(self._sleeve(n, one, at) for n, one in enumerate(self.actuated)),
            *(part for node in held for part in self._support(node, by_name[node.rod], at)),
            *(part for one in springs(self.result.scenario) for part in self._spring(one, at)),
            *(self._coil(*at.positions[ends]) for ends in self._axial_springs),
            *self._load_solids(by_name, loads, at.positions),
        ]
        return Faces.joined(parts)

    def _sleeve(self, number: int, stretch: ActuatedStretch, at: Shape) -> Faces:
        """Return an actuated stretch as a sleeve; those that overlap share the circumference."""
        index = next(k for k, rod in enumerate(self.rods) if rod.name == stretch.rod)
        rod, section, directors = self.rods[index], self._sections[index], at.directors[index]
        places = stretch.samples(rod)
        line = stretch.line(rod, at.positions)
        along = None
        if directors is not None:
            nodes = rod.line_arc_lengths
            along = np.column_stack([np.interp(places, nodes, one) for one in directors.T])
        outline, stripe = _striped(section, self.size)
        shares = np.abs(stretch.shares[at.frame]) * stretch.profile_at(places)
        widths = _SLEEVE[0] + (_SLEEVE[1] - _SLEEVE[0]) * shares
        colour = actuated_colour(number, bool(stretch.shares[at.frame] < 0.0))
        colours = np.tile(colour, (len(outline), 1))
        if directors is not None:
            colours[stripe] = _stripe_colour(colour)
        beside = [
            other
            for other in self.actuated
            if other.rod == stretch.rod and other.start < stretch.end and stretch.start < other.end
        ]
        sectors = 2 * len(beside) * np.arange(len(outline)) // len(outline)
        mine = sectors % len(beside) == beside.index(stretch)
        faces = tube(line, along, widths[:, None, None] * outline, colours)
        shown = np.tile(mine, len(faces.corners) // len(outline))
        return Faces(faces.corners[shown], faces.colours[shown], 0.25 * section.width)

    def _support(self, held: HeldNode, rod: Rod, at: Shape) -> Iterator[Faces]:
        """Return a wall for a clamp, and cones on the ground for what is held along axes."""
        place, size = at.positions[held.node], _SUPPORT * self.size
        if held.tangent is not None:
            along = held.tangent / np.linalg.norm(held.tangent)
            if self.has_axes and abs(along @ self.camera.rotation[2]) > 0.9:
                return  # a wall seen from behind hides the rod
            first = np.cross(along, self.up)
            if np.linalg.norm(first) < 0.1:
                first = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
            first /= np.linalg.norm(first)
            wall = np.vstack([size * first, size * np.cross(along, first), 0.18 * size * along])
            ends = {int(rod.nodes[0]): -1.0, int(rod.nodes[-1]): 1.0}
            side = 0.0 if rod.closed or held.slides else ends.get(held.node, 0.0)
            yield box(place + side * wall[2], wall, _GREY)
            return
        axes = [np.eye(3)["xyz".index(name)] for name in held.components]
        for axis in [self.up] if len(axes) == 3 else axes:
            foot = place - 1.5 * size * axis
            profile = np.array([(0.0, 0.0), (0.0, 0.6 * size), (0.9, 0.06 * size), (1.0, 0.0)])
            yield turned_profile(foot, place, profile, _GREY)
            plate = np.array([(0.0, 0.0), (0.0, 0.9 * size), (1.0, 0.9 * size), (1.0, 0.0)])
            yield turned_profile(foot - 0.2 * size * axis, foot, plate, _GREY)

    def _spring(self, spring: SpringSupport, at: Shape) -> Iterator[Faces]:
        place = spring.weights @ at.positions[spring.nodes]
        for axis, stiffness in zip(np.eye(3), spring.stiffness, strict=False):
            if stiffness > 0.0:
                yield from self._to_ground(place, -axis, _COIL * self.size)
        if spring.rotational_stiffness > 0.0:
            angles = np.linspace(0.0, 5.0 * np.pi, 60)
            radii = 0.4 * _COIL * self.size * angles / angles[-1]
            right, up, towards = self.camera.rotation
            line = place + radii[:, None] * (
                np.cos(angles)[:, None] * right + np.sin(angles)[:, None] * up
            )
            yield self._wire(line + 0.02 * self.size * towards, _GREY)

    def _to_ground(self, place: Array, direction: Array, length: float) -> Iterator[Faces]:
        """Return a spring from a place to the ground in a direction."""
        yield self._coil(place, place + length * direction)
        across = 0.3 * length * _across(direction)
        plate = np.vstack([across[0], across[1], 0.03 * length * direction])
        yield box(place + length * direction, plate, _GREY)

    def _coil(self, start: Array, end: Array) -> Faces:
        """Return a spring between two places."""
        length = max(float(np.linalg.norm(end - start)), 1e-9 * self.size)
        share = np.linspace(0.0, 1.0, 49)
        bulge = np.sin(np.pi * np.clip(1.4 * np.minimum(share, 1 - share), 0, 0.5))
        radius = 0.16 * min(length, _COIL * self.size) * bulge
        frame = _across((end - start) / length)
        turns = 2.0 * np.pi * 5.0 * share
        line = start + share[:, None] * (end - start)
        line = line + radius[:, None] * (
            np.cos(turns)[:, None] * frame[0] + np.sin(turns)[:, None] * frame[1]
        )
        return self._wire(line, _GREY)

    def _wire(self, line: Array, colour: ColorType) -> Faces:
        outline = _SHAFT * self.size * circle(8)
        return tube(line, None, outline, np.tile(to_rgb(colour), (8, 1)))

    def _load_solids(
        self, by_name: dict[str, Rod], loads: ActingLoads, positions: Array
    ) -> Iterator[Faces]:
        for force in loads.forces:
            tip, tail = self._arrow(by_name[force.rod], force.at, force.value, positions, _FORCE)
            yield self._arrow_solid(tail, tip)
        for line in loads.lines:
            rod = by_name[line.rod]
            count = max(3, round(_LINE_ARROWS * (line.end - line.start) / rod.length))
            for at in np.linspace(line.start, line.end, count).tolist():
                tip, tail = self._arrow(rod, at, line.value, positions, _LINE_FORCE)
                yield self._arrow_solid(tail, tip)
        for part in loads.foundations:
            rod = by_name[part.rod]
            ground = ground_direction(part, rod, positions)
            count = max(2, round(_FOUNDATION_SPRINGS * (part.end - part.start) / rod.length))
            for at in np.linspace(part.start, part.end, count).tolist():
                place = place_on(rod, positions, at)
                yield from self._to_ground(place, ground, 0.7 * _COIL * self.size)
        for moment in loads.moments:
            axis = moment.value / np.linalg.norm(moment.value)
            yield from self._arc(place_on(by_name[moment.rod], positions, moment.at), axis)

    def _arrow(
        self, rod: Rod, at: float, value: Array, positions: Array, length: float
    ) -> tuple[Array, Array]:
        """Return tip and tail of a force's arrow: one that pulls at an end begins there."""
        point = place_on(rod, positions, at)
        way = length * self.size * value / np.linalg.norm(value)
        gap = 0.6 * max(_THINNEST * self.size, 2.0 * rod.radius) * way / np.linalg.norm(way)
        line = positions[rod.line_nodes]
        outwards = np.zeros(3)
        if not rod.closed and at <= 1e-9 * rod.length:
            outwards = line[0] - line[1]
        elif not rod.closed and at >= (1.0 - 1e-9) * rod.length:
            outwards = line[-1] - line[-2]
        if way @ outwards > 0.5 * np.linalg.norm(way) * np.linalg.norm(outwards):
            return point + gap + way, point + gap
        return point - gap, point - gap - way

    def _arrow_solid(self, tail: Array, tip: Array) -> Faces:
        length = float(np.linalg.norm(tip - tail))
        shaft = _SHAFT * self.size
        head = min(7.0 * shaft / length, 0.5)
        profile = [(0.0, 0.0), (0.0, shaft), (1.0 - head, shaft), (1.0 - head, 2.9 * shaft)]
        return turned_profile(tail, tip, np.array([*profile, (1.0, 0.0)]), LOAD)

    def _arc(self, middle: Array, axis: Array) -> Iterator[Faces]:
        """Return an arc about the axis of a moment, with a head where it turns to."""
        frame = _across(axis)
        angles = np.linspace(0.0, 1.5 * np.pi, 40)
        radius = _MOMENT * self.size
        around = np.cos(angles)[:, None] * frame[0] + np.sin(angles)[:, None] * frame[1]
        yield self._wire(middle + radius * around, LOAD)
        shaft = _SHAFT * self.size
        start = middle + radius * around[-1]
        way = np.cross(axis, around[-1])
        cone = np.array([(0.0, 0.0), (0.0, 2.9 * shaft), (1.0, 0.0)])
        yield turned_profile(start, start + 7.0 * shaft * way, cone, LOAD)

    def _write_amounts(self, axes: Axes, at: Shape, loads: ActingLoads) -> None:
        """Write what loads amount to beside their arrows; many equal ones are written once."""
        by_name = {rod.name: rod for rod in self.rods}
        notes: dict[str, tuple[Array, Array]] = {}

        def note(value: Array, unit: str, tip: Array, tail: Array) -> None:
            text = quantity_text(float(np.linalg.norm(value)), unit)
            notes.setdefault(text, (tip, tail))

        for force in loads.forces:
            rod = by_name[force.rod]
            ends = self._arrow(rod, force.at, force.value, at.positions, _FORCE)
            place = place_on(rod, at.positions, force.at)
            tip, tail = sorted(ends, key=lambda end: float(np.linalg.norm(end - place)))
            note(force.value, "N", tip, tail)
        for line in loads.lines:
            middle = 0.5 * (line.start + line.end)
            ends = self._arrow(by_name[line.rod], middle, line.value, at.positions, _LINE_FORCE)
            note(line.value, "N/m", *ends)
        for moment in loads.moments:
            place = place_on(by_name[moment.rod], at.positions, moment.at)
            note(moment.value, "N m", place, place + _MOMENT * self.size * self.camera.rotation[1])
        for text, ends in notes.items():
            near, far = self.camera.project(np.array(ends))[:, :2]
            away = (far - near) / max(float(np.linalg.norm(far - near)), 1e-300)
            write_beside(axes, far, np.zeros(2), away, text)


def make_picture(result: RunData, view: str | None = None, scale: float = 1.0) -> Picture:
    """Return the picture of a run, with displacements `scale` times as large as they are.

    Raises
    ------
    ValueError
        If the view is none: ``3d``, the default in space, or two axes such as ``xz``.
    """
    if result.model.dimension == 3:
        return SpatialPicture(result, view or "3d", scale)
    if view is not None:
        raise ValueError("a planar run is seen in its plane, and in no other view")
    return Picture(result, scale)


def _upwards(gravity: Array | None) -> Array:
    """Return the unit vector against gravity if it is along an axis, else z."""
    if gravity is not None:
        up = -gravity / np.linalg.norm(gravity)
        axis = int(np.argmax(np.abs(up)))
        if abs(up[axis]) > 0.99:
            return np.asarray(np.sign(up[axis]) * np.eye(3)[axis])
    return np.array([0.0, 0.0, 1.0])


def _across(axis: Array) -> Array:
    """Return two unit vectors across another, shape (2, 3), a right-handed system with it."""
    first = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    first /= np.linalg.norm(first)
    return np.vstack([first, np.cross(axis, first)])


def _striped(section: Section, size: float) -> tuple[Array, NDArray[np.bool_]]:
    """Return the outline of a section, shape (sides, 2), and which sides have the stripe.

    The stripe is where director 1 leaves the section. A round section has the more sides the
    thicker it is against the `size` [m] of the scene.
    """
    if section.is_round:
        sides = int(np.clip(7.0 + 160.0 * max(section.width, section.height) / size, 10, 22))
        stripe = np.linspace(-_STRIPE, _STRIPE, 2 + sides // 8)
        angles = np.append(stripe, np.linspace(_STRIPE, 2.0 * np.pi - _STRIPE, sides)[1:-1])
        outline = np.column_stack([np.cos(angles), np.sin(angles)])
    else:
        outline = np.array([(1, -1), (1, 1), (_EDGE, 1), (-1, 1), (-1, -1), (_EDGE, -1)], float)
    after = np.roll(outline, -1, axis=0)
    least = np.cos(_STRIPE) if section.is_round else _EDGE
    marked = np.minimum(outline[:, 0], after[:, 0]) > least - 1e-9
    return 0.5 * outline * (section.width, section.height), marked


def _stripe_colour(colour: ColorType) -> Array:
    """Return a colour that is seen on another one: nearly white, or dark on a light one."""
    own = np.array(to_rgb(colour))
    light = float(own @ [0.2126, 0.7152, 0.0722]) > 0.66
    return 0.35 * own if light else 0.12 * own + 0.88


def _finer(
    line: Array, directors: Array | None, longest: float, closed: bool
) -> tuple[Array, Array | None]:
    """Return a line [m], shape (nodes, 3), and directors, with points on edges that are long.

    Edges that twist much have some, too. Where directors do not come back at the end of a ring, it
    was glued turned.
    """
    lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
    pieces = lengths / longest
    if directors is not None:
        turns = np.sum(directors[1:] * directors[:-1], axis=1)
        pieces = np.maximum(pieces, np.arccos(np.clip(turns, -1.0, 1.0)) / _TURN)
    counts = np.maximum(np.ceil(pieces), 1.0).astype(np.int64)
    places = np.append(
        np.repeat(np.arange(len(counts)), counts)
        + np.concatenate([np.arange(count) / count for count in counts]),
        len(counts),
    )
    nodes = np.arange(len(line))
    finer = np.column_stack([np.interp(places, nodes, one) for one in line.T])
    if closed:
        finer[-1] = finer[0]
    if directors is None:
        return finer, None
    return finer, np.column_stack([np.interp(places, nodes, one) for one in directors.T])
