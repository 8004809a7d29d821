"""Animations: true to time, to scale, and of the run."""

import subprocess
import sys
from dataclasses import replace

import der
import numpy as np
import pytest
from der.animation import _cut, _set_stage
from der.film import make_film, round_speed, speed_text
from der.plotting.picture import Picture
from matplotlib.colors import to_rgb
from PIL import Image

imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")


def gif_frames(path):
    """Pictures, shape (height, width, 3), and how long each is shown [s]."""
    with Image.open(path) as image:
        for number in range(image.n_frames):
            image.seek(number)
            yield np.asarray(image.convert("RGB")).astype(int), image.info["duration"] / 1000.0


def coloured(picture, colour):
    """Where a picture has nearly a colour."""
    return np.abs(picture - 255 * np.array(to_rgb(colour))).max(axis=2) < 25


def test_gif_is_true_to_time(swing, tmp_path):
    result = der.run(swing)  # 0.2 s
    told = []
    path = result.animate(tmp_path / "swing.gif", fps=20, speed=0.1, progress=told.append)
    frames = list(gif_frames(path))
    # 0.2 s at a tenth of the speed are 2 s: 40 intervals of 0.05 s and the last picture.
    assert len(frames) == 41
    assert sum(seconds for _, seconds in frames) == pytest.approx(41 * 0.05)
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert np.any(frames[0][0] != frames[20][0])
    assert [file.name for file in tmp_path.iterdir()] == ["swing.gif"]


def test_tip_is_drawn_where_it_is(swing, tmp_path):
    """The rod's pixels against positions, by the scale that its length sets when it is straight."""
    swing["time"]["duration"] = 0.3
    result = der.run(swing)
    frames = [picture for picture, _ in gif_frames(result.animate(tmp_path / "a.gif", speed=0.1))]
    first, last = (np.argwhere(coloured(picture, "#0072B2")) for picture in (frames[0], frames[-1]))
    pixels = np.ptp(first[:, 1])  # of the length, 1 m
    below = (last[:, 0].max() - np.median(first[:, 0])) / pixels
    assert below == pytest.approx(-result.positions[-1, :, 1].min(), abs=0.02)
    aside = (first[:, 1].max() - last[:, 1].max()) / pixels
    assert aside == pytest.approx(1.0 - result.positions[-1, :, 0].max(), abs=0.02)


@pytest.mark.parametrize("words", [3, 30, 300])
def test_long_titles_are_not_cut_off(swing, words):
    swing["title"] = "wonderful " * words
    result = der.run(swing)
    cut = _cut(result, make_film(result), 10.0, None)
    axes = _set_stage(Picture(result), cut)
    figure = axes.get_figure(root=True)
    figure.draw_without_rendering()
    box = figure._suptitle.get_window_extent()
    assert box.x1 < figure.bbox.width
    assert box.y0 > axes.get_window_extent().y1 + 15, "there is room for the time below it"
    assert figure.bbox.height % 2 == 0


def test_pictures_say_that_a_run_failed(unstable):
    with pytest.raises(der.DivergedError) as caught:
        der.run(unstable)
    result = caught.value.result
    axes = _set_stage(Picture(result), _cut(result, make_film(result), 10.0, None))
    title = axes.get_figure(root=True).get_suptitle()
    assert title == f"Three spheres in a fluid (diverged at t = {result.times[-1]:g} s)"


def test_axes_share_one_unit(swing):
    swing["rods"][0] |= {"to": [2e-3, 0], "cross_section": {"circle": {"radius": 1e-4}}}
    swing["time"] = {"duration": 1e-3, "step": 1e-5, "integrator": "implicit_euler"}
    swing["output"] = {"every": 1e-4}
    result = der.run(swing)
    axes = _set_stage(Picture(result), _cut(result, make_film(result), 10.0, None))
    axes.get_figure(root=True).draw_without_rendering()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [mm]", "y [mm]")
    labels = [label.get_text() for label in axes.get_xticklabels()]
    assert {"0.0", "2.0"} <= set(labels)
    assert [axis.get_offset_text().get_text() for axis in (axes.xaxis, axes.yaxis)] == ["", ""]


def test_springs_move_with_the_rod(swing, tmp_path, monkeypatch):
    swing["supports"].append({"rod": "arm", "at": "end", "spring": {"stiffness": 0.5}})
    result = der.run(swing)
    drawn = []

    def note(axes, rods, springs, positions):
        drawn.extend(spring.weights @ positions[spring.nodes] for spring in springs)

    monkeypatch.setattr("der.plotting.picture.draw_springs", note)
    path = result.animate(tmp_path / "swing.mp4", fps=20, speed=0.1)
    assert len(drawn) == imageio_ffmpeg.count_frames_and_secs(str(path))[0]
    assert drawn[0] == pytest.approx(result.positions[0, -1])
    assert drawn[-1] == pytest.approx(result.positions[-1, -1])
    assert drawn[-1][1] < drawn[0][1]


def test_mp4_has_its_pictures_and_duration(spheres, tmp_path):
    result = der.run(spheres)  # 1 s
    path = der.animate(result, tmp_path / "spheres.mp4", fps=30)
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert frames == 31
    assert seconds == pytest.approx(31 / 30, abs=0.01)
    reader = imageio_ffmpeg.read_frames(str(path))
    meta = next(reader)
    width, height = meta["size"]
    assert width % 2 == height % 2 == 0
    pictures = [np.frombuffer(data, np.uint8) for data in reader]
    assert np.abs(pictures[0].astype(int) - pictures[-1]).max() > 100


@pytest.mark.parametrize("fps", [30.0, 7.0])
def test_gif_takes_hundredths_of_a_second(swing, tmp_path, fps):
    result = der.run(swing)
    shown = list(gif_frames(result.animate(tmp_path / "a.gif", fps=fps, speed=0.2)))
    step = round(100 / fps) / 100
    assert len(shown) == int(np.ceil(1.0 / step - 1e-9)) + 1
    assert {seconds for _, seconds in shown} == {step}


def test_frames_are_resampled_in_time(swing):
    """Frames saved at uneven times are shown when they belong."""
    swing["output"]["every"] = 0.05
    result = der.run(swing)
    cut = _cut(result, make_film(result), 100.0, 1.0)
    assert len(cut.texts) == 21
    assert cut.texts[3] == "t = 0.03 s"
    expected = 0.4 * result.positions[0] + 0.6 * result.positions[1]
    assert cut.positions[3] == pytest.approx(expected)
    assert cut.positions[-1] == pytest.approx(result.positions[-1])
    slow = _cut(result, make_film(result), 100.0, 0.5)
    assert slow.texts[1] == "t = 0.005 s   (shown at 1/2 speed)"


@pytest.mark.parametrize(
    ("span", "speed"), [(1.0, 1.0), (20.0, 1.0), (50.0, 5.0), (0.01, 0.001), (3600.0, 500.0)]
)
def test_speed_that_suits_a_run(span, speed):
    assert round_speed(span) == speed
    assert 4.0 < span / speed <= 20.0 or speed == 1.0


def test_speeds_in_words():
    assert speed_text(5.0) == "5x speed"
    assert speed_text(0.02) == "1/50 speed"


def test_modes_swing_one_after_the_other(swing, tmp_path):
    del swing["time"], swing["output"]["every"]
    swing["analysis"] = {"modes": {"count": 2}}
    result = der.run(swing)
    cut = _cut(result, make_film(result), 10.0, None)
    names = [
        f"mode {n}: {f:.4g} Hz, not to scale" for n, f in enumerate(result.modes.frequencies, 1)
    ]
    assert cut.texts == [names[0]] * 20 + [names[1]] * 20
    moved = cut.positions[22] - result.positions[-1]
    shape = result.modes.shapes[1]
    assert moved / np.abs(moved).max() == pytest.approx(shape / np.abs(shape).max(), abs=1e-9)
    assert len(list(gif_frames(result.animate(tmp_path / "a.gif", fps=10)))) == 40


def test_paths_go_through_their_points(tube):
    path = der.continuation(tube)
    cut = _cut(path, make_film(path), 5.0, None)
    assert len(cut.texts) == 50
    assert cut.texts[0] == "load factor 0, stable"
    assert cut.texts[-1] == "load factor 1, stable"
    assert np.array_equal(cut.positions[-1], path.positions[-1])


@pytest.mark.parametrize(
    ("name", "arguments", "words"),
    [
        ("a.avi", {}, r"a\.avi.*\.gif or \.mp4"),
        ("a.gif", {"fps": 0}, "fps must be greater than 0 and at most 240"),
        ("a.gif", {"speed": -1}, "positive"),
        ("a.gif", {"speed": 1e-9}, r"limited to 20,000 frames.*2\.5e\+10: use a larger --speed"),
        ("a.gif", {"speed": 1e-320}, "would have inf"),
    ],
)
def test_mistakes(spheres, tmp_path, name, arguments, words):
    with pytest.raises(ValueError, match=words):
        der.run(spheres).animate(tmp_path / name, **arguments)
    assert list(tmp_path.iterdir()) == []


def test_what_does_not_move_is_an_error(tube, swing, tmp_path):
    with pytest.raises(ValueError, match="nothing that moves"):
        der.equilibrium(tube).animate(tmp_path / "a.gif")
    whole = der.run(swing)
    single = replace(whole, times=whole.times[:1], positions=whole.positions[:1])
    single = replace(single, velocities=whole.velocities[:1], turns=whole.turns[:1])
    with pytest.raises(ValueError, match="single frame"):
        single.animate(tmp_path / "a.gif")
    with pytest.raises(ValueError, match="continuation has no time"):
        der.continuation(tube).animate(tmp_path / "a.gif", speed=2.0)
    assert list(tmp_path.iterdir()) == []


def test_mp4_without_its_package(swing, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ModuleNotFoundError, match="pip install imageio-ffmpeg"):
        der.run(swing).animate(tmp_path / "a.mp4", speed=0.1)
    assert list(tmp_path.iterdir()) == []


def test_command(swing, tmp_path):
    der.run(swing, out=tmp_path / "run")
    command = [sys.executable, "-m", "der", "animate", str(tmp_path / "run"), "--fps", "10"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    path = tmp_path / "run" / "animation.gif"
    assert done.stdout == f"{path}\n"
    assert len(list(gif_frames(path))) == 101, "0.2 s at 1/50 speed are 10 s"
    wrong = subprocess.run(
        [*command, "--out", "a.avi"], capture_output=True, text=True, check=False
    )
    assert wrong.returncode == 1
    assert wrong.stderr.startswith("error: cannot write a.avi")
