"""Animations of results, GIF and MP4, true to time and to scale."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from der.film import Film, make_film, round_speed, speed_text, title_of
from der.output_paths import written_whole
from der.progress import ProgressFunction
from der.scene_loads import ActingLoads

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from PIL import Image

    from der.plotting.picture import Picture
    from der.plotting.shapes import Shape
    from der.run_data import RunData

Array = NDArray[np.float64]
Pixels = NDArray[np.uint8]

_MODE_SECONDS, _MODE_SWINGS = 2.0, 2  # how long each mode is shown, and how often it swings
_PATH_SECONDS = 10.0  # how long a path of equilibria is shown

_DPI = 110
_WIDTH = 7.2  # of the picture [inch]
_HEIGHT = (2.2, 7.0)  # least and most [inch]
_MARGINS = (0.75, 0.2, 0.68, 0.55)  # left, right, top, bottom [inch] with a title of one line
_NARROW_MARGINS = (0.1, 0.1, 0.68, 0.05)  # without numbers at the axes
_TITLE_LINE = 0.2  # that each further line takes [inch]
_ENTRIES = 4  # of the legend in a row
_MAX_FRAMES = 20_000
_CENTISECONDS = 100.0  # a GIF counts time in them ...
_SHORTEST = 2  # ... and viewers slow down what is shorter than so many
_GIF_SAMPLES = 5  # pictures of which it takes its colours


@dataclass(frozen=True, eq=False)
class _Cut:
    """The pictures to draw: shapes, the result's frame they belong to, and what is written."""

    positions: Array
    directors: list[Array | None]
    frames: NDArray[np.int64]
    texts: list[str]
    fps: float


def animate(
    result: RunData,
    path: str | os.PathLike[str],
    *,
    fps: float = 25.0,
    speed: float | None = None,
    view: str | None = None,
    progress: ProgressFunction | None = None,
) -> Path:
    """Write a result as an animation.

    A motion is shown true to time: between saved frames its nodes move in straight lines. A path of
    equilibria goes through its points, branch by branch; modes swing one after the other.

    Parameters
    ----------
    result
        A result of ``der.run`` or ``der.open_run``.
    path
        File to write; its ending tells the format: ``.gif``, or ``.mp4``, which requires the
        package imageio-ffmpeg.
    fps
        Frames per second. A GIF counts hundredths of a second between frames: the nearest possible
        rate is taken.
    speed
        Simulated seconds per second of the animation; a speed other than 1 is shown. The default is
        1 for runs of 1 to 20 s, and a round number that makes others last about 8 s.
    view
        In space: ``3d``, in perspective, the default, or the axes to the right and up, such as
        ``xz``.
    progress
        Told how much is done, from 0 to 1.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    ValueError
        For another ending, an fps or speed out of range, more than 20,000 frames, a run in which
        nothing moves (a static one, or one of a single frame), and a view that there is not.
    ModuleNotFoundError
        For an MP4 without imageio-ffmpeg.
    """
    path = Path(path)
    if path.suffix.lower() not in (".gif", ".mp4"):
        raise ValueError(f"cannot write {path.name}: an animation ends with .gif or .mp4")
    if not 0.0 < fps <= 240.0:
        raise ValueError(f"fps must be greater than 0 and at most 240, not {fps:g}")
    if speed is not None and not 0.0 < speed < np.inf:
        raise ValueError(f"speed must be a positive number, not {speed:g}")
    gif = path.suffix.lower() == ".gif"
    from der.plotting.space import make_picture  # here, because matplotlib takes long to load
    from der.plotting.style import style

    picture = make_picture(result, view)
    cut = _cut(result, make_film(result), _gif_rate(fps) if gif else fps, speed)
    with style():
        stage = _set_stage(picture, cut)
    pictures = _draw(stage, picture, cut, range(len(cut.texts)), progress)
    with written_whole(path) as partial:
        if gif:
            few = np.linspace(0, len(cut.texts) - 1, _GIF_SAMPLES).astype(np.int64)
            palette = _gif_palette(_draw(stage, picture, cut, few.tolist()))
            _write_gif(pictures, partial, cut.fps, palette)
        else:
            _write_mp4(pictures, partial, cut.fps)
    return path


def _gif_rate(fps: float) -> float:
    return _CENTISECONDS / max(round(_CENTISECONDS / fps), _SHORTEST)


def _cut(result: RunData, film: Film, fps: float, speed: float | None) -> _Cut:
    if film.times is not None:
        return _cut_motion(film, film.times, fps, speed)
    if speed is not None:
        raise ValueError(f"{result.scenario.analysis} has no time, and so no speed to show it at")
    if result.scenario.analysis == "static":
        raise ValueError(
            "a static run has nothing that moves: der plot draws it, der view shows it"
        )
    frames = _frames_without_time(film, fps)
    texts = [
        (f"{chapter.title}: " if len(film.chapters) > 1 and not chapter.loops else "")
        + film.captions[frame]
        for frame in frames
        for chapter in film.chapters
        if chapter.first <= frame <= chapter.last
    ]
    directors = [one if one is None else one[frames % len(one)] for one in film.directors]
    return _Cut(film.positions[frames], directors, film.source[frames], texts, fps)


def _frames_without_time(film: Film, fps: float) -> NDArray[np.int64]:
    if not film.chapters[0].loops:
        count = max(round(_PATH_SECONDS * fps), 2)
        return np.rint(np.linspace(0, len(film.positions) - 1, count)).astype(np.int64)
    count = max(round(_MODE_SECONDS * fps), 2)
    parts = []
    for chapter in film.chapters:
        length = chapter.last - chapter.first + 1
        swing = np.floor(np.arange(count) / count * _MODE_SWINGS * length).astype(np.int64)
        parts.append(chapter.first + swing % length)
    return np.concatenate(parts)


def _cut_motion(film: Film, times: Array, fps: float, speed: float | None) -> _Cut:
    span = float(times[-1] - times[0])
    if span <= 0.0:
        raise ValueError("the run has a single frame: nothing moves")
    speed = round_speed(span) if speed is None else speed
    step = speed / fps  # simulated seconds between pictures
    pictures = np.ceil(span / step * (1.0 - 1e-9)) + 1.0
    if not pictures <= _MAX_FRAMES:
        raise ValueError(
            f"animations are limited to {_MAX_FRAMES:,} frames, and this one would have "
            f"{pictures:.3g}: use a larger --speed"
        )
    count = int(pictures)
    instants = np.minimum(times[0] + step * np.arange(count), times[-1])
    right = np.clip(np.searchsorted(times, instants), 1, len(times) - 1)
    share = (instants - times[right - 1]) / (times[right] - times[right - 1])
    weight = share[:, np.newaxis, np.newaxis]

    def between(frames: Array) -> Array:
        if len(frames) == 1:  # the same at all times
            return np.broadcast_to(frames, (count, *frames.shape[1:]))
        mixed: Array = (1.0 - weight) * frames[right - 1] + weight * frames[right]
        return mixed

    directors = [one if one is None else between(one) for one in film.directors]
    frames = np.where(share < 0.5, right - 1, right)
    decimals = int(np.clip(np.ceil(-np.log10(step)), 0, 12))
    note = "" if speed == 1.0 else f"   (shown at {speed_text(speed)})"
    texts = [f"t = {instant:.{decimals}f} s{note}" for instant in instants]
    return _Cut(between(film.positions), directors, frames, texts, fps)


def _draw(
    axes: Axes,
    picture: Picture,
    cut: _Cut,
    numbers: Sequence[int],
    progress: ProgressFunction | None = None,
) -> Iterator[Pixels]:
    """Draw some of the pictures, RGB, shape (height, width, 3), with even sizes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from der.plotting.style import style

    with style():
        figure = axes.get_figure(root=True)
        assert figure is not None
        canvas: Any = FigureCanvasAgg(figure)  # matplotlib leaves its methods without types
        canvas.draw()
        # The parts that do not change are drawn once.
        background = canvas.copy_from_bbox(figure.bbox)
        fixed = set(axes.get_children())
        for done, number in enumerate(numbers, 1):
            canvas.restore_region(background)
            shape = _shape(cut, number)
            picture.draw(axes, [shape], shape, _loads(picture, shape))
            text = cut.texts[number]
            axes.annotate(
                text, (0.0, 1.0), (0.0, 6.0), "axes fraction", "offset points", fontsize=11
            )
            moving = [artist for artist in axes.get_children() if artist not in fixed]
            for artist in sorted(moving, key=lambda artist: artist.get_zorder()):
                axes.draw_artist(artist)
                artist.remove()
            yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
            if progress is not None:
                progress(done / len(numbers))


def _shape(cut: _Cut, number: int) -> Shape:
    from der.plotting.shapes import Shape
    from der.plotting.style import PALETTE

    directors = [one if one is None else one[number] for one in cut.directors]
    return Shape(cut.positions[number], int(cut.frames[number]), PALETTE[0], None, directors)


def _loads(picture: Picture, shape: Shape) -> ActingLoads:
    """Return the loads to draw at a shape: gravity stands in the legend, modes have no loads."""
    loads = picture.loads(shape.frame)
    if picture.result.scenario.analysis in ("modes", "buckling"):
        return ActingLoads(foundations=loads.foundations)
    return replace(loads, gravity=None)


def _set_stage(picture: Picture, cut: _Cut) -> Axes:
    """Make a figure with one set of axes: equal, with limits that hold the whole motion."""
    from matplotlib.figure import Figure

    from der.plotting.actuation import add_actuation_to_legend
    from der.plotting.style import FIGURE_TITLE, wrapped

    left, right, top, bottom = _MARGINS if picture.has_axes else _NARROW_MARGINS
    room = _WIDTH - left - right  # for the axes
    title = wrapped(title_of(picture.result), FIGURE_TITLE, room)
    gravity = picture.loads(0).gravity
    entries = len(picture.actuated) + (gravity is not None)
    rows = int(np.ceil(entries / _ENTRIES)) if entries > 1 else 0  # of the legend, above the time
    top += _TITLE_LINE * (len(title) - 1 + rows)
    low, high = _extent(picture, cut, (room, _HEIGHT[1] - top - bottom))
    size = high - low
    height = float(np.clip(room * size[1] / size[0] + top + bottom, *_HEIGHT))
    height = 2.0 * round(0.5 * height * _DPI) / _DPI  # MP4 takes even numbers of pixels
    figure = Figure(figsize=(_WIDTH, height), dpi=_DPI)
    share = (room / _WIDTH, (height - top - bottom) / height)
    axes = figure.add_axes((left / _WIDTH, bottom / height, *share))
    scale = max(size[0] / room, size[1] / (height - top - bottom))  # metres an inch
    half = 0.5 * scale * np.array([room, height - top - bottom])
    middle = 0.5 * (low + high)
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    picture.finish(axes, low, high, scale / 72.0)
    figure.suptitle(
        "\n".join(title),
        x=left / _WIDTH,
        y=1.0 - 0.12 / height,
        ha="left",
        va="top",
        parse_math=False,
    )
    if gravity is not None:
        picture.add_gravity(axes, gravity)
    add_actuation_to_legend(axes, picture.actuated)
    if entries:
        above = 1.0 + (_TITLE_LINE / (height - top - bottom) if rows else 0.0)
        axes.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, above),
            borderaxespad=0.1,
            ncols=int(np.ceil(entries / max(rows, 1))),  # rows of about the same length
        )
    return axes


def _extent(picture: Picture, cut: _Cut, room: tuple[float, float]) -> tuple[Array, Array]:
    """Return the corners [m] of all that is drawn, with some room around it."""
    shapes = [_shape(cut, number) for number in range(len(cut.texts))]
    some = np.unique(np.linspace(0, len(shapes) - 1, 20).astype(np.int64))
    found = [picture.corners(shapes, ActingLoads(), room)]
    found += [picture.corners([shapes[n]], _loads(picture, shapes[n]), room) for n in some]
    corners = np.array(found)
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    if picture.has_axes:  # for the symbols of supports
        size, point = float(np.max(high - low)), float(np.max((high - low) / room)) / 72.0
        more = max(0.05 * size, 20.0 * point)
        low, high = low - more, high + more
    return low, high


def _write_gif(pictures: Iterator[Pixels], path: Path, fps: float, palette: Image.Image) -> None:
    from PIL import Image

    # One palette for all, without dithering: quick, small, and colours that do not flicker.
    images = (
        Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)
        for picture in pictures
    )
    next(images).save(
        path,
        save_all=True,
        append_images=images,
        duration=round(1000.0 / fps),
        loop=0,
    )


def _gif_palette(pictures: Iterator[Pixels]) -> Image.Image:
    """Return the colours that some pictures are made of."""
    from matplotlib.colors import to_rgb
    from PIL import Image

    from der.plotting.style import ACTUATED, LOAD, MUTED, PALETTE

    drawn = np.concatenate(list(pictures))
    # Colours with a meaning count, however few pixels have them.
    meant = [to_rgb(colour) for colour in (PALETTE[0], LOAD, MUTED, "black", *ACTUATED)]
    few = np.rint(255.0 * np.array(meant)).astype(np.uint8)
    bands = np.repeat(few, len(drawn) // 100, axis=0)[:, None].repeat(drawn.shape[1], axis=1)
    together = Image.fromarray(np.concatenate([drawn, bands]))
    found = together.quantize(256, method=Image.Quantize.MEDIANCUT)
    tones = np.array(found.getpalette()).reshape(-1, 3)
    # Nothing but white is close to white, or Pillow would take one for the other.
    tones[tones.min(axis=1) > 246] = 255
    found.putpalette(tones.ravel().tolist())
    return found


def _write_mp4(pictures: Iterator[Pixels], path: Path, fps: float) -> None:
    try:
        import imageio_ffmpeg
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            "MP4 output requires the package imageio-ffmpeg: "
            "pip install imageio-ffmpeg, or write a .gif"
        ) from None
    first = next(pictures)
    writer = imageio_ffmpeg.write_frames(
        str(path),
        (first.shape[1], first.shape[0]),
        fps=fps,
        codec="libx264",
        quality=None,
        macro_block_size=2,
        output_params=["-crf", "20", "-movflags", "+faststart"],
    )
    writer.send(None)
    try:
        writer.send(np.ascontiguousarray(first))
        for picture in pictures:
            writer.send(np.ascontiguousarray(picture))
    finally:
        writer.close()
