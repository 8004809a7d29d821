"""Pictures of runs in space: perspective, sections as they lie, symbols, floor."""

import copy
import itertools
from pathlib import Path

import der
import matplotlib.pyplot as plt
import numpy as np
import pytest
from der.animation import _cut, _set_stage
from der.film import make_film
from der.plotting.camera import along_axes, perspective
from der.plotting.floor import Floor
from der.plotting.shapes import Shape
from der.plotting.solids import Faces, draw_faces, sphere
from der.plotting.space import _stripe_colour, make_picture
from der.plotting.style import ACTUATED, LOAD
from der.scene_loads import ActingLoads
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from PIL import Image

CONFIGS = Path(der.__file__).parent / "scenes"
SCENES = ["helix_spring", "twisted_ring", "spun_strip", "hanging_coil", "bent_cantilever_45"]
UP = np.array([0.0, 0.0, 1.0])
ROD = {
    "name": "rod",
    "nodes": 21,
    "from": [0, 0, 0],
    "to": [1, 0, 0],
    "cross_section": {"circle": {"radius": 0.02}, "director": [0, 0, 1]},
    "material": {"youngs_modulus": 1e8, "poissons_ratio": 0.3, "density": 1000},
}


@pytest.fixture(autouse=True)
def close_figures():
    yield
    plt.close("all")


def scene(**parts):
    clamp = {"rod": "rod", "at": "start", "clamp": True}
    rod = copy.deepcopy(ROD) | parts.pop("rod", {})
    return {
        "model": "spatial",
        "rods": [rod],
        "supports": [clamp],
        "analysis": "static",
        **parts,
    }


def drawn_faces(axes):
    """Corners of the faces in the picture, shape (faces, 4, 2), and their colours."""
    (faces,) = (one for one in axes.collections if isinstance(one, PolyCollection))
    corners = np.array([path.vertices[:4] for path in faces.get_paths()])
    return corners, faces.get_facecolor()[:, :3]


def of_colour(faces, colour):
    return faces.corners[np.abs(faces.colours - to_rgb(colour)).max(axis=1) < 1e-9]


def test_nearer_things_are_larger_by_their_distance():
    """In a central projection sizes are as the inverse distances along the line of sight."""
    camera = perspective(np.array([[0.0, 0, 0], [1, 2, 1], [0, 1, 0.5]]), UP)
    right, _, towards = camera.rotation
    sizes, depths = [], (-0.3, 0.0, 0.8)
    for depth in depths:
        ends = camera.focus + depth * towards + np.outer([-0.05, 0.05], right)
        seen = camera.project(ends)
        assert seen[:, 2] == pytest.approx(depth)
        sizes.append(np.ptp(seen[:, 0]))
    assert sizes[1] == pytest.approx(0.1), "true to scale in the middle"
    assert sizes == pytest.approx([0.1 * camera.distance / (camera.distance - d) for d in depths])
    flat = along_axes("xz").project(np.array([[1.0, 2, 3], [1, 5, 3]]))
    assert flat[:, :2] == pytest.approx(np.array([[1, 3], [1, 3]]))


@pytest.mark.parametrize("angle", np.linspace(0.0, np.pi, 9))
def test_no_ring_is_seen_from_its_edge(angle):
    """A circle in a vertical plane: at least 0.35 of its diameter is seen across."""
    turn = np.linspace(0.0, 2.0 * np.pi, 50)
    level = np.array([np.cos(angle), np.sin(angle), 0.0])
    circle = np.outer(np.cos(turn), level) + np.outer(np.sin(turn), UP)
    camera = perspective(circle, UP)
    assert abs(np.cross(level, UP) @ camera.rotation[2]) > 0.35
    assert camera.rotation[0, 0] > 0.0, "x runs to the right"
    assert camera.rotation[2, 2] > 0.3, "seen from above"
    assert camera.rotation @ camera.rotation.T == pytest.approx(np.eye(3), abs=1e-12)


@pytest.mark.parametrize(("view", "height"), [("xz", 0.06), ("xy", 0.02)])
def test_a_tube_is_as_large_as_its_section_seen_from_there(view, height):
    """A bar of 0.06 by 0.02 m along x: its outline in both views."""
    bar = {"rectangle": {"width": 0.06, "height": 0.02}, "director": [0, 0, 1]}
    result = der.run(scene(rod={"cross_section": bar}, supports=[], analysis={"modes": {}}))
    picture = make_picture(result, view)
    _, axes = plt.subplots()
    shape = picture.shape(0, "red")
    picture.draw(axes, [shape], shape, ActingLoads())
    corners, _ = drawn_faces(axes)
    assert np.ptp(corners[..., 0]) == pytest.approx(1.0)
    assert np.ptp(corners[..., 1]) == pytest.approx(height)


@pytest.mark.parametrize("twist", [7.0, -12.0])
def test_the_stripe_turns_as_the_rod_is_twisted(twist):
    """A straight rod with a natural twist, clamped at one end, turns by twist times arc length."""
    result = der.run(scene(rod={"natural_twist": twist, "natural_curvature": [0, 0]}))
    picture = make_picture(result)
    faces = picture._rods(picture.shape(len(result.times) - 1, "#0072B2"))
    marked = np.abs(faces.colours - _stripe_colour("#0072B2")).max(axis=1) < 1e-9
    # The caps have triangles, with a corner twice.
    sides = np.any(faces.corners[:, 2] != faces.corners[:, 3], axis=1)
    middles = faces.corners[marked & sides].mean(axis=1)
    places = np.unique(np.round(middles[:, 0], 9))
    assert len(places) >= 20
    # The sections at the ends are those of the middles of their edges.
    for at in places[(places > 0.05) & (places < 0.95)]:
        _, y, z = middles[np.abs(middles[:, 0] - at) < 1e-6].mean(axis=0)
        # Director 1 begins along z and turns about x, from y to z.
        turned = np.array([y, z]) @ [-np.sin(twist * at), np.cos(twist * at)]
        assert turned == pytest.approx(np.hypot(y, z), rel=2e-3)
        assert np.hypot(y, z) == pytest.approx(0.02, rel=0.1)


def test_twist_is_seen_in_an_animation(tmp_path):
    """A straight round rod that is only twisted: nothing but its stripe moves."""
    spin = {"times": [0, 1], "values": [0, 3]}
    ends = [{"rod": "rod", "at": end, "clamp": True} for end in ("start", "end")]
    ends[1]["prescribe"] = {"twist": spin}
    run = scene(supports=ends, time={"duration": 1, "step": 0.1, "integrator": "bdf2"})
    del run["analysis"]
    result = der.run({**run, "output": {"every": 0.5}})
    assert np.abs(result.positions - result.positions[0]).max() < 1e-6
    with Image.open(result.animate(tmp_path / "twist.gif", fps=5)) as image:
        frames = []
        for number in (0, image.n_frames - 1):
            image.seek(number)
            frames.append(np.asarray(image.convert("RGB")).astype(int)[80:])
    assert np.sum(np.abs(frames[0] - frames[1]).max(axis=2) > 60) > 300
    corner = frames[0][:5, :5]
    assert np.all(corner == 255), "the ground of a GIF is white"


def test_without_directors_there_is_no_stripe():
    """The model without twist does not tell how a round section lies."""
    result = der.run(scene() | {"model": "spatial_bend"})
    picture = make_picture(result)
    colours = picture._rods(picture.shape(0, "red")).colours
    assert np.all(colours == to_rgb("red"))


def test_the_farthest_face_is_drawn_first_and_none_from_behind():
    square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    corners = np.array([square + UP, square, square[::-1] + 2.0 * UP])
    faces = Faces(corners, np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]))
    _, axes = plt.subplots()
    draw_faces(axes, along_axes("xy"), faces)
    _, colours = drawn_faces(axes)
    assert np.argmax(colours, axis=1).tolist() == [1, 0]
    axes.clear()
    draw_faces(axes, along_axes("xy"), Faces(corners, faces.colours, np.array([0.0, 1.5, 0.0])))
    assert np.argmax(drawn_faces(axes)[1], axis=1).tolist() == [0, 1]


def test_a_sphere_is_round_and_lit_from_above():
    _, axes = plt.subplots()
    draw_faces(axes, along_axes("xz"), sphere(np.array([1.0, 2, 3]), 0.5, "red"))
    corners, colours = drawn_faces(axes)
    offsets = np.linalg.norm(corners - [1, 3], axis=2)
    assert offsets.max() == pytest.approx(0.5)
    heights = corners.mean(axis=1)[:, 1]
    assert colours[np.argmax(heights), 0] > 1.3 * colours[np.argmin(heights), 0]


@pytest.mark.parametrize("name", SCENES)
def test_labels_do_not_collide(name):
    """Numbers, titles, amounts, legend: no two texts of a picture overlap, and none is cut off."""
    figure = der.run(CONFIGS / f"{name}.yaml").plot("shapes")
    figure.canvas.draw()
    axes = figure.axes[0]
    texts = [text for text in axes.texts if text.get_text()]
    assert {"x [m]", "y [m]", "z [m]"} <= {text.get_text() for text in texts}
    boxes = [text.get_window_extent() for text in texts]
    if axes.get_legend() is not None:
        boxes.append(axes.get_legend().get_window_extent())
    for number, box in enumerate(boxes):
        assert figure.bbox.padded(1.0).contains(*box.p0)
        assert figure.bbox.padded(1.0).contains(*box.p1)
        assert not any(box.overlaps(other) for other in boxes[:number]), texts[number]


def test_the_floor_is_below_and_has_round_numbers():
    points = np.array([[0.0, 0.02, 0.3], [0.5, 0.05, 0.9]])
    floor = Floor.below(points, UP)
    assert floor.step == 0.1
    assert floor.low[2] < 0.3
    assert np.all(floor.low[:2] < 0.02)
    assert np.all(floor.high[:2] > [0.5, 0.05])
    assert (floor.low[:2] / floor.step) == pytest.approx(np.round(floor.low[:2] / floor.step))


def test_up_is_against_gravity():
    loads = [{"gravity": [0, -9.81, 0]}]
    result = der.run(scene(loads=loads))
    picture = make_picture(result)
    assert picture.up == pytest.approx([0, 1, 0])
    low = result.positions[-1][:, 1].min()
    assert np.all(picture.floor.points(picture.camera)[:4, 1] < low)


def test_what_is_dashed_does_not_stretch_the_axes(tube):
    """The wire is drawn 0.5 m downwards, and coils up into 0.13 m."""
    figure = der.run(CONFIGS / "helix_spring.yaml").plot("shapes")
    figure.canvas.draw()
    axes = figure.axes[0]
    (dashed,) = (
        line for line in axes.lines if line.get_linestyle() == "--" and line.get_xydata().size
    )
    y = dashed.get_ydata()[:-1]
    assert np.ptp(y) > 1.3 * np.ptp(axes.get_ylim())
    rolled = der.run(der.load(CONFIGS / "roll_up.yaml")).plot("shapes").axes[0]
    assert rolled.get_xlim()[1] < 0.9, "drawn to x = 1"


def test_arrows_point_at_their_place_along_their_force():
    force = np.array([0.3, 0.0, -0.4])
    place = {"rod": "rod", "at": 0.5, "force": force.tolist()}
    result = der.run(scene(loads=[{"point_force": place}]))
    picture = make_picture(result)
    shape = picture.shape(len(result.times) - 1, "#0072B2")
    arrow = of_colour(picture._symbols(shape, picture.loads(shape.frame)), LOAD).reshape(-1, 3)
    offsets = arrow - result.positions[-1, 10]
    along = offsets @ (force / 0.5)
    assert along.max() < 0.0, "it ends before the middle of the rod"
    assert along.max() > -0.05
    tip = offsets[np.argmax(along)]
    assert np.linalg.norm(tip - along.max() * force / 0.5) < 1e-9
    axes = result.plot("shapes").axes[0]
    assert "500 mN" in [text.get_text() for text in axes.texts]


def test_an_arc_turns_about_the_axis_of_its_moment():
    moment = {"rod": "rod", "at": 0.5, "moment": [0, 0, 1e-6]}
    result = der.run(scene(loads=[{"moment": moment}]))
    picture = make_picture(result)
    shape = picture.shape(len(result.times) - 1, "#0072B2")
    arc = of_colour(picture._symbols(shape, picture.loads(shape.frame)), LOAD).reshape(-1, 3)
    offsets = arc - result.positions[-1, 10]
    assert np.abs(offsets[:, 2]).max() < 0.02
    assert np.hypot(*offsets[:, :2].T).min() > 0.03


def test_walls_stand_at_clamps_and_cones_at_pins():
    supports = [
        {"rod": "rod", "at": "start", "clamp": True},
        {"rod": "rod", "at": "end", "fix": ["x", "y", "z"]},
    ]
    result = der.run(scene(supports=supports))
    picture = make_picture(result)
    shape = picture.shape(0, "#0072B2")
    corners = picture._symbols(shape, ActingLoads()).corners.reshape(-1, 3)
    wall, cone = corners[corners[:, 0] < 0.5], corners[corners[:, 0] > 0.5]
    assert wall[:, 0].max() == pytest.approx(0.0, abs=1e-9), "it is behind the end"
    assert np.ptp(wall[:, 1]) > 3.0 * np.ptp(wall[:, 0])
    assert cone[:, 2].max() == pytest.approx(0.0, abs=1e-9), "its tip is at the end, it lies below"


def test_sleeves_are_as_thick_as_their_value_and_share_what_overlaps():
    table = {"times": [0, 1], "values": [0, -2]}
    part = {"rod": "rod", "from": 0.2, "to": 0.6, "natural_twist": table}
    run = scene(actuation=[{"name": "one", **part}], time={"duration": 1, "step": 0.1})
    del run["analysis"]

    def sleeve(frame, number=0):
        result = der.run({**run, "output": {"every": 0.5}})
        picture = make_picture(result)
        shape = picture.shape(frame, "#0072B2")
        return of_colour(picture._symbols(shape, ActingLoads()), ACTUATED[number])

    reach = [np.abs(sleeve(frame)[..., 1:]).max() for frame in (0, 1, 2)]
    assert reach[0] > 0.02, "a stretch is seen where its value is 0"
    assert reach[1] - reach[0] == pytest.approx(reach[2] - reach[1], rel=1e-3)
    alone = len(sleeve(2))
    run["actuation"].append({"name": "two", **part, "from": 0.3})
    assert 0.3 * alone < len(sleeve(2)) < 0.7 * alone
    assert len(sleeve(2, 1)) > 0


def test_thin_rods_are_drawn_thicker_and_the_picture_says_so():
    thin = {"circle": {"radius": 0.001}, "director": [0, 0, 1]}
    result = der.run(scene(rod={"cross_section": thin}))
    assert make_picture(result).magnified == pytest.approx(10.0, rel=0.02)
    axes = result.plot("shapes").axes[0]
    assert "sections drawn 10 times as thick" in [text.get_text() for text in axes.texts]
    assert make_picture(der.run(scene())).magnified == 1.0


def test_views_are_named_by_their_axes(helix, swing):
    result = der.run(helix)
    figure = result.plot("shapes", views=["3d", "xy", "zy"])
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes[1:]]
    assert labels == [("x [m]", "y [m]"), ("z [m]", "y [m]")]
    labels = [text.get_text() for text in figure.axes[2].get_legend().get_texts()]
    assert "gravity 9.81 m/s²" in labels
    labels = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert "gravity 9.81 m/s², away from you" in labels
    for wrong in ("xx", "z", "uv"):
        with pytest.raises(ValueError, match="a view is two of x, y and z"):
            result.plot(views=[wrong])
    with pytest.raises(ValueError, match="a planar run is seen in its plane"):
        der.run(swing).plot(views=["xy"])
    del helix["time"]
    with pytest.raises(ValueError, match="one view, not in 2"):
        der.run({**helix, "analysis": {"modes": {"count": 1}}}).plot(views=["xy", "xz"])


@pytest.mark.parametrize("analysis", [{"modes": {"count": 2}}, {"buckling": {"count": 2}}])
def test_modes_are_seen(analysis):
    """A flat strip in its plane x, y moves along z, to both sides of the equilibrium."""
    strip = {"rectangle": {"width": 0.1, "height": 0.01}, "director": [0, 1, 0]}
    push = {"point_force": {"rod": "rod", "at": "end", "force": [-1, 0, 0]}}
    result = der.run(scene(rod={"cross_section": strip}, loads=[push], analysis=analysis))
    figure = result.plot()
    assert len(figure.axes) == 2
    for axes in figure.axes:
        dotted, rest = (
            next(
                line
                for line in axes.lines
                if line.get_linestyle() == style and line.get_xydata().size
            )
            for style in (":", "--")
        )
        assert np.nanmax(np.abs(dotted.get_ydata() - rest.get_ydata())) > 0.05


def test_an_animation_of_a_planar_scene_in_space_is_written(swing, tmp_path):
    swing["rods"][0]["material"]["poissons_ratio"] = 0.4
    result = der.run(swing | {"model": "spatial"})
    assert result.animate(tmp_path / "run.mp4", fps=10, speed=0.2).stat().st_size > 1000


def test_shapes_between_frames_have_directors_between_theirs(helix):
    from der.animation import _cut
    from der.film import make_film

    result = der.run(helix)
    film = make_film(result)
    cut = _cut(result, film, 25.0, 0.004 / 2 * 25)  # two pictures for each saved frame
    mixed = 0.5 * (film.directors[0][3] + film.directors[0][4])
    assert cut.directors[0][7] == pytest.approx(mixed)
    shape = Shape(cut.positions[7], int(cut.frames[7]), "red", None, [cut.directors[0][7]])
    assert len(make_picture(result)._rods(shape).corners) > 0


def boxes(figure):
    """Where the texts of a figure are, by what they say, without those that are not drawn."""
    figure.canvas.draw()
    texts = [*figure.texts, *(text for axes in figure.axes for text in axes.texts)]
    for axes in figure.axes:
        if axes.axison:
            for axis in (axes.xaxis, axes.yaxis):
                low, high = sorted(axis.get_view_interval())
                ticks = zip(axis.get_ticklocs(), axis.get_ticklabels(), strict=True)
                texts += [label for place, label in ticks if low <= place <= high]
                texts.append(axis.label)
        if axes.get_legend() is not None:
            texts += axes.get_legend().get_texts()
    shown = [text for text in texts if text.get_visible() and text.get_text()]
    return [(text.get_text(), text.get_window_extent()) for text in shown]


def overlaps(figure):
    """Pairs of texts that lie on each other by more than a pixel."""
    return [
        (one, other)
        for (one, a), (other, b) in itertools.combinations(boxes(figure), 2)
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 1.0 and min(a.y1, b.y1) - max(a.y0, b.y0) > 1.0
    ]


EXAMPLES = ("helix_spring", "twisted_ring", "spun_strip", "hanging_coil", "helical_buckling")
EXAMPLES += ("bent_cantilever_45", "finger", "falling_beam_21", "lee_frame", "beam_on_foundation")
EXAMPLES += ("gridshell", "sagging_net", "four_bar_finger", "gripper")


@pytest.mark.parametrize("name", EXAMPLES)
def test_texts_of_pictures_do_not_lie_on_each_other(name):
    result = der.run(f"example:{name}")
    assert overlaps(result.plot("shapes")) == []
    if result.model.dimension == 3:
        assert overlaps(result.plot("shapes", views=["xz"])) == []


@pytest.mark.parametrize("view", ["3d", "xz"])
@pytest.mark.parametrize("name", ["twisted_ring", "spun_strip"])
def test_texts_of_animations_do_not_lie_on_each_other(name, view):
    result = der.run(f"example:{name}")
    cut = _cut(result, make_film(result), 10.0, 0.5)
    axes = _set_stage(make_picture(result, view), cut)
    axes.annotate(cut.texts[-1], (0.0, 1.0), (0.0, 6.0), "axes fraction", "offset points")
    assert overlaps(axes.get_figure(root=True)) == []


@pytest.mark.parametrize("size", [0.013, 0.047, 1.0, 1234.5])
@pytest.mark.parametrize("shape", [(1, 1, 1), (-1, 0.5, 2), (0.02, 1, 0.02), (0.3, 0.3, 1)])
def test_numbers_of_small_floors_do_not_lie_on_each_other(size, shape):
    """Four modes one below the other leave little room for each."""
    x, y, z = (size * part for part in shape)
    scene = {
        "rods": [
            {
                "name": "rod",
                "points": [[0, 0, 0], [x / 2, 0, 0], [x / 2, y, 0.3 * z], [x, y, z]],
                "cross_section": {"stiffness": {"EA": 1e3, "EI": 1, "GJ": 1, "mass_per_length": 1}},
            }
        ],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "analysis": {"modes": {"count": 4}},
    }
    figure = der.run(scene).plot("shapes")
    assert overlaps(figure) == []
    for axes in figure.axes:  # the titles are all there, and some numbers
        texts = [text.get_text() for text in axes.texts]
        assert all(any(text.startswith(name) for text in texts) for name in "xyz")
        assert len(texts) >= 6
