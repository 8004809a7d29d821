"""The floor under a picture in perspective: a grid with numbers, a ruler of height, shadows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from numpy.typing import NDArray

from der.plotting.camera import Camera, upright
from der.plotting.lengths import LengthScale, tick_texts
from der.plotting.solids import Faces

Array = NDArray[np.float64]

_GRID, _RIM, _SHADOW, _NUMBERS = "#dfe3e8", "#b4bbc4", "#e3e6ea", "#4a4f57"
_CELLS = 6  # along the longer side
_NARROWEST = 0.3  # of the floor, against its longer side
_AWAY = 7.0  # of numbers from the rim [points]
_LETTER, _LINE = 5.0, 15.0  # what a letter and a line of numbers take [points]
_HEIGHT = 9.0  # of a number [points]


@dataclass(frozen=True, eq=False)
class Floor:
    """A level rectangle with round numbers at its rims, and a ruler.

    Attributes
    ----------
    frame
        Rows: two directions along its sides and the vertical, shape (3, 3).
    low, high
        Its corners along them [m], shape (3,); the third is the range of the ruler.
    step
        Side of a cell [m].
    """

    frame: Array
    low: Array
    high: Array
    step: float

    @classmethod
    def below(cls, points: Array, up: Array) -> Floor:
        """Return the floor below all points [m], shape (points, 3); `up` is along an axis."""
        frame = upright(up)
        local = points @ frame.T
        low, high = local.min(axis=0), local.max(axis=0)
        size = max(float(np.max(high - low)), 1e-300)
        step = _round(size / _CELLS)
        half = np.maximum(0.5 * (high - low) + 0.06 * size, 0.5 * _NARROWEST * size)[:2]
        middle = 0.5 * (low + high)[:2]
        below, above = low[2] - 0.04 * size, high[2]
        rim = step * np.array([np.floor((middle - half) / step), np.ceil((middle + half) / step)])
        return cls(frame, np.append(rim[0], below), np.append(rim[1], above), step)

    def points(self, camera: Camera) -> Array:
        """Return the corners of the floor and the end of the ruler [m], shape (5, 3)."""
        feet = self._feet()
        ruler = feet[int(np.argmin(camera.project(feet @ self.frame)[:, 0]))]
        return np.vstack([feet, [*ruler[:2], self.high[2]]]) @ self.frame

    def _feet(self) -> Array:
        """Return the corners of the floor along the rows of the frame."""
        sides = [(x, y) for x in (self.low[0], self.high[0]) for y in (self.low[1], self.high[1])]
        return np.array([[x, y, self.low[2]] for x, y in sides])

    def draw(self, axes: Axes, camera: Camera, metres_per_point: float) -> None:
        """Draw grid, numbers and ruler; a picture has so many metres in a point on paper."""
        grid = [self._line(camera, k, at) for k in (0, 1) for at in self._ticks(k)]
        axes.add_collection(
            LineCollection(grid, colors=_GRID, linewidths=0.6, zorder=0.5), autolim=False
        )
        ends = self.points(camera)
        scale = LengthScale.of(ends.min(axis=0), ends.max(axis=0))
        rims = list(self._rims(camera))
        axes.add_collection(
            LineCollection(
                [camera.project(rim.ends @ self.frame)[:, :2] for rim in rims],
                colors=_RIM,
                linewidths=0.9,
                zorder=0.6,
            ),
            autolim=False,
        )
        labels = [
            label for rim in rims for label in self._labels(camera, rim, scale, metres_per_point)
        ]
        taken: list[tuple[Array, Array]] = []
        for label in sorted(labels, key=lambda label: not label.is_title):
            low, high = label.box(metres_per_point)
            # A number that would lie on another one, as in corners of small pictures, is left out.
            if any(np.all(low < above) and np.all(below < high) for below, above in taken):
                continue
            taken.append((low, high))
            label.write(axes)

    def shadow(self, axes: Axes, camera: Camera, faces: Faces) -> None:
        """Draw what the light from above leaves out."""
        local = faces.corners @ self.frame.T
        across, along = (local[:, k + 2, :2] - local[:, k, :2] for k in (0, 1))
        upper = across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0] > 0.0
        local = local[upper]
        local[..., 2] = self.low[2]
        seen = camera.project(local @ self.frame)[..., :2]
        # One path of all faces: they turn in one sense, so that its inside is their union.
        path = Path(
            np.concatenate([seen, seen[:, :1]], axis=1).reshape(-1, 2),
            np.tile([Path.MOVETO, *[Path.LINETO] * 3, Path.CLOSEPOLY], len(seen)),
        )
        axes.add_artist(
            PathPatch(path, facecolor=_SHADOW, edgecolor=_SHADOW, linewidth=0.4, zorder=0.7)
        )

    def _ticks(self, k: int) -> Array:
        first, last = np.ceil(self.low[k] / self.step - 1e-9), self.high[k] / self.step + 1e-9
        return self.step * np.arange(first, np.floor(last) + 1.0)

    def _line(self, camera: Camera, k: int, at: float) -> Array:
        """Return the line of the grid at a place along direction k, in the picture."""
        ends = np.array([self.low, self.high])
        ends[:, 2] = self.low[2]
        ends[:, k] = at
        return camera.project(ends @ self.frame)[:, :2]

    def _rims(self, camera: Camera) -> Iterator[_Rim]:
        """Return the two rims of the floor that are near, and the ruler on its left."""
        towards = camera.rotation[2] @ self.frame.T
        near = np.where(towards[:2] > 0.0, self.high[:2], self.low[:2])
        for k in (0, 1):
            ends = np.array([[near[0], near[1], self.low[2]]] * 2)
            ends[:, k] = self.low[k], self.high[k]
            outwards = np.zeros(3)
            outwards[1 - k] = np.sign(towards[1 - k])
            yield _Rim(k, ends, camera.turned(outwards @ self.frame)[:2])
        feet = self._feet()
        left = feet[int(np.argmin(camera.project(feet @ self.frame)[:, 0]))]
        yield _Rim(2, np.array([left, [*left[:2], self.high[2]]]), np.array([-1.0, 0.0]))

    def _labels(
        self, camera: Camera, rim: _Rim, scale: LengthScale, metres_per_point: float
    ) -> Iterator[_Label]:
        """Return the numbers beside a rim, as far apart as they are wide, and its title."""
        axis = int(np.argmax(np.abs(self.frame[rim.k])))
        sign = float(self.frame[rim.k, axis])
        outwards = rim.outwards / max(float(np.linalg.norm(rim.outwards)), 1e-12)
        ends = camera.project(rim.ends @ self.frame)[:, :2]
        ticks = self._ticks(rim.k)
        texts = tick_texts((sign * ticks - scale.origin[axis]) / scale.metres)
        widest = _LETTER * max((len(text) for text in texts), default=0)
        places = np.repeat(rim.ends[:1], len(ticks), axis=0)
        places[:, rim.k] = ticks
        points = camera.project(places @ self.frame)[:, :2]
        # The shortest: those far away are nearer to each other.
        step = np.abs(np.diff(points, axis=0)).min(axis=0, initial=np.inf) / metres_per_point
        apart = max(step[0] / (1.3 * widest + 1.0), step[1] / (1.2 * _LINE))
        fits = [n for n in (1, 2, 5, 10, 20) if n * apart > 1.0]
        shown = np.round(ticks / self.step) % (fits[0] if fits else 50) == 0
        # The corner where two rims meet has none.
        shown &= ticks > rim.ends[0, rim.k] + 0.2 * self.step
        shown &= ticks < rim.ends[1, rim.k] - (0.2 * self.step if rim.k < 2 else -1e-9)
        for n in np.flatnonzero(shown):
            yield _Label(texts[n], points[n], _AWAY, outwards)
        if rim.k == 2:
            top = ends[1] + [0.0, _LINE * metres_per_point]
            yield _Label(scale.label(axis), top, _AWAY, outwards, is_title=True)
        else:  # beyond the numbers
            past = min(widest / max(abs(outwards[0]), 0.1), _LINE / max(abs(outwards[1]), 0.1))
            middle = 0.5 * (ends[0] + ends[1])
            yield _Label(scale.label(axis), middle, _AWAY + 4.0 + past, outwards, is_title=True)


@dataclass(frozen=True, eq=False)
class _Label:
    """A text that is so many points away from a point of the picture, in a direction."""

    text: str
    point: Array
    away: float
    outwards: Array
    is_title: bool = False

    def box(self, metres_per_point: float) -> tuple[Array, Array]:
        """Return about where the lower left and upper right corner are [points]."""
        size = np.array([_LETTER * len(self.text), _HEIGHT])
        anchor = self.point / metres_per_point + self.away * self.outwards
        shares = {"right": 1.0, "left": 0.0, "center": 0.5, "top": 1.0}
        low = anchor - size * [shares[self._across], shares[self._upright]]
        return low, low + size

    def write(self, axes: Axes) -> None:
        """Write it."""
        axes.annotate(
            self.text,
            tuple(self.point),
            tuple(self.away * self.outwards),
            textcoords="offset points",
            ha=self._across,
            va=self._upright,
            color=_NUMBERS,
            fontsize=8,
            annotation_clip=False,
        )

    @property
    def _across(self) -> Literal["left", "center", "right"]:
        if abs(self.outwards[0]) <= 0.4:
            return "center"
        return "left" if self.outwards[0] > 0.0 else "right"

    @property
    def _upright(self) -> Literal["top", "center"]:
        return "top" if self.outwards[1] < -0.4 else "center"


@dataclass(frozen=True, eq=False)
class _Rim:
    """A line with numbers: along direction `k`, with its ends and the way out in the picture."""

    k: int
    ends: Array
    outwards: Array


def _round(length: float) -> float:
    """Return the nearest of 1, 2 and 5 times a power of ten."""
    power = np.floor(np.log10(length))
    digit = min((1.0, 2.0, 5.0, 10.0), key=lambda d: abs(np.log10(d) - np.log10(length) + power))
    return float(digit * 10.0**power)
