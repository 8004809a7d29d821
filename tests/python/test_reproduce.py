"""The parts of der reproduce: its content in HTML and Markdown, exact solutions, its folder.

The whole command is run by tests/validation/test_reproduction.py.
"""

import base64
import json
import math
import re
from pathlib import Path

import der
import matplotlib.pyplot as plt
import numpy as np
import pytest
from der.cli import main
from der.reproduce import reproducing
from der.reproduce.beam_exact import Tube, elastica_deflections, euler_bernoulli_deflection
from der.reproduce.content import Bullets, Document, Paragraph, Picture, Section, Table
from der.reproduce.falling_exact import FallingChain, fall
from der.reproduce.html import to_html
from der.reproduce.markdown import to_markdown
from der.reproduce.measurements import nodes_beside_the_load
from der.reproduce.numbers_as_text import digits_within, duration, number, percent, with_error_bar
from der.reproduce.report_claims import Claim
from der.reproduce.stages import Stages
from der.scene_files import scene_file

ROOT = Path(__file__).resolve().parents[2]
REFERENCES = json.loads((ROOT / "tests/validation/references/values.json").read_text())


def reference(problem, name):
    return REFERENCES[problem]["values"][name]["value"]


# Numbers as text.


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.0, 3, "0"),
        (0.005966, 4, "0.005966"),
        (-0.25, 3, "-0.250"),
        (4.7e-7, 2, "4.7 \u00d7 10⁻⁷"),
        (7.57e-5, 3, "7.57 \u00d7 10⁻⁵"),
        (338.4, 2, "340"),
        (20000.0, 1, "20000"),
        (0.09999, 2, "0.10"),
        (1.5e7, 2, "1.5 \u00d7 10⁷"),
    ],
)
def test_numbers(value, digits, text):
    assert number(value, digits).replace("\u00a0", " ") == text


def test_digits_follow_the_bar():
    assert with_error_bar(0.0377377, 3.0e-5) == "0.037738"
    assert with_error_bar(0.0, 1e-12) == "0"
    assert digits_within(1.0, 1e-20) == 12
    assert with_error_bar(2.0, 30.0) == "2"


def test_shares_and_times():
    assert percent(0.00664).replace("\u00a0", " ") == "0.66 %"
    assert duration(0.000889) == "0.89 ms"
    assert duration(12.3) == "12 s"


def test_claims_know_what_rounds_to_them():
    claim = Claim("0.037", "m")
    assert claim.is_met_by(0.0374)
    assert claim.is_met_by(0.036501)
    assert not claim.is_met_by(0.037714)
    assert claim.rounded(0.037714) == "0.038"


# One content, two ways to write it.


@pytest.fixture
def document():
    table = Table("Numbers", ["a|b", "c"], ["left", "right"], [["1 < 2", "3"], ["`x|y`", "-"]])
    picture = Picture("dot", "Figure 1", "A dot & more.", 'A "dot"', lambda: plt.figure())
    return Document(
        "A * title",
        [Paragraph("Use `der_run <scene>` at 10 s.")],
        [
            Section("One: first", [table, picture]),
            Section("Two", [Bullets(["a_b", "c"])]),
        ],
    )


def test_markdown(document):
    text = to_markdown(document)
    assert text.startswith("# A \\* title\n\nUse `der_run <scene>` at 10 s.\n")
    assert "- [One: first](#one-first)" in text
    assert "| a\\|b | c |\n| --- | ---: |\n| 1 \\< 2 | 3 |" in text
    assert '![A "dot"](figures/dot.png)\n\n**Figure 1.** A dot &amp; more.' in text
    assert "- a\\_b\n- c" in text


def test_html(document):
    text = to_html(document, {"dot": b"\x89PNG"})
    assert "<title>A * title</title>" in text
    assert "<code>der_run &lt;scene&gt;</code> at 10&nbsp;s." in text
    assert '<a href="#one-first">One: first</a>' in text
    assert '<section id="one-first">' in text
    assert '<td class="left">1 &lt; 2</td><td class="right">3</td>' in text
    assert '<th scope="col" class="left">a|b</th>' in text
    data = base64.b64encode(b"\x89PNG").decode()
    assert f'<img alt="A &quot;dot&quot;" src="data:image/png;base64,{data}">' in text
    assert "prefers-color-scheme: dark" in text


def test_both_say_the_same(document):
    plain = re.sub(r"<style>.*?</style>|<[^>]+>", " ", to_html(document, {"dot": b""}), flags=re.S)
    words = set(re.findall(r"[A-Za-z]{3,}", plain)) - {"nbsp", "amp"}
    assert words <= set(re.findall(r"[A-Za-z]{3,}", to_markdown(document))) | {"Contents"}


def test_stages_go_forward_only():
    seen = []
    stages = Stages({"one": 1.0, "two": 3.0}, seen.append)
    stages.of("one")(1.0)
    stages.of("two", 1, 2)(0.0)
    stages.of("two", 0, 2)(0.5)
    stages.of("two", 1, 2)(1.0)
    assert seen == pytest.approx([0.25, 0.625, 0.625, 1.0])
    Stages({"one": 1.0}, None).of("one")(1.0)


def test_stages_are_named_once():
    names = []
    stages = Stages({"one": 1.0, "two": 3.0}, None, names.append)
    for stage, share in (("one", 0.5), ("one", 1.0), ("two", 0.5), ("one", 1.0)):
        stages.of(stage)(share)
    assert names == ["one", "two"]


# Exact solutions, against the references of the validation tests and closed forms.


@pytest.mark.parametrize("density", [0.0, 1000.0])
@pytest.mark.parametrize("nodes", [3, 5, 21, 51])
def test_terminal_speed(nodes, density):
    kind = "buoyant" if density else "dry"
    exact = -reference("falling_spheres", f"terminal.n{nodes}.{kind}")
    assert FallingChain(nodes, density).terminal_speed == pytest.approx(exact, rel=1e-14)


def test_limits_of_the_terminal_speed():
    assert FallingChain(3, equal=True).terminal_speed == pytest.approx(
        2.0 / 9.0 * 6000.0 * 9.8 * 0.005**2 / 1000.0
    )
    many = FallingChain(10001)
    assert many.terminal_speed == pytest.approx(many.many_nodes_speed, rel=1e-4)
    assert many.many_nodes_speed < many.lone_sphere_speed


@pytest.mark.parametrize(("nodes", "density", "kind"), [(3, 1000.0, "buoyant"), (5, 0.0, "dry")])
def test_fall(nodes, density, kind):
    times = np.array([0.0, 1.0, 10.0])
    motion = fall(FallingChain(nodes, density), times)
    assert motion.fallen[0] == 0.0
    for i, time in ((1, "1"), (2, "10")):
        name = f"n{nodes}.{kind}.tangent.{{}}_mid.t{time}"
        fallen = -reference("falling_spheres", name.format("y"))
        speed = -reference("falling_spheres", name.format("vy"))
        assert motion.fallen[i] == pytest.approx(fallen, rel=1e-10)
        assert motion.speed[i] == pytest.approx(speed, rel=1e-9)


def test_forces_balance_and_have_a_potential():
    chain = FallingChain(5)
    shape = 0.02 * np.random.default_rng(1).standard_normal((5, 2))
    force = chain.elastic_force(shape)
    assert np.abs(force.sum(axis=0)).max() < 1e-9 * np.abs(force).max()
    stiffness = chain.stiffness(shape)
    assert stiffness == pytest.approx(stiffness.T, rel=1e-9, abs=1e-9 * np.abs(stiffness).max())
    step = 1e-7
    nudge = np.zeros((5, 2))
    nudge[2, 1] = step
    slope = (chain.elastic_force(shape - nudge) - chain.elastic_force(shape + nudge)) / (2 * step)
    assert stiffness[:, 5] == pytest.approx(slope.ravel(), abs=1e-6 * np.abs(stiffness).max())


def test_turning_angle_of_a_known_shape():
    chain = FallingChain(3)
    down = np.array([[[0.0, 0.0], [0.0, -chain.edge], [0.0, 0.0]]])
    motion = der.reproduce.falling_exact.Fall(np.zeros(1), down, down)
    assert motion.turning_angle(chain.edge) == pytest.approx([math.pi / 2])


def test_longest_stable_step_is_near_that_of_drag_alone():
    chain = FallingChain(3)
    drag_alone = 2.0 * float((chain.masses / chain.drag).min())
    assert 0.95 * drag_alone < chain.longest_stable_step() < drag_alone


@pytest.mark.parametrize("load", [20, 2000, 20000])
def test_deflections(load):
    exact = reference("extensible_beam", f"tube.{load}.deflection")
    assert elastica_deflections(Tube(), [load])[0].largest == pytest.approx(exact, rel=1e-10)
    linear = reference("extensible_beam", f"euler_bernoulli.{load}.deflection")
    assert euler_bernoulli_deflection(Tube(), load) == pytest.approx(linear, rel=1e-12)


def test_deflection_of_the_middle_under_a_small_load():
    """P b (3 L^2 - 4 b^2) / (48 EI), b being the distance of the load from the nearer support."""
    tube, load = Tube(), 1.0
    near = tube.length - tube.load_at
    linear = load * near * (3.0 * tube.length**2 - 4.0 * near**2) / (48 * tube.bending_stiffness)
    assert elastica_deflections(tube, [load])[0].middle == pytest.approx(linear, rel=1e-7)
    other_end = Tube(load_at=near)
    assert elastica_deflections(other_end, [load])[0].middle == pytest.approx(linear, rel=1e-7)


def test_nodes_beside_the_load():
    assert nodes_beside_the_load() == pytest.approx((0.74, 0.76))


# The parameters of the exact solutions are those of the scenes.


@pytest.mark.parametrize(
    ("scene", "chain"),
    [
        ("falling_beam_3", FallingChain(3)),
        ("falling_beam_3_equal", FallingChain(3, equal=True)),
        ("falling_beam_5", FallingChain(5, 0.0)),
        ("falling_beam_21", FallingChain(21, 0.0)),
        ("falling_beam_51", FallingChain(51, 0.0)),
    ],
)
def test_chains_are_those_of_the_scenes(scene, chain):
    simulation = der.Simulation(der.load(scene_file(scene)))
    rod = simulation.model.rods[0]
    assert simulation.node_masses == pytest.approx(chain.masses, rel=1e-12)
    assert rod.sphere_radii == pytest.approx(chain.radii)
    assert pytest.approx(chain.youngs_modulus * np.pi * chain.rod_radius**2) == rod.EA
    tree = simulation.scenario.to_dict()
    assert tree["loads"][1]["fluid"]["density"] == chain.fluid_density
    # Everything weighs on the nodes at the start.
    assert -simulation.gradient().reshape(-1, 2)[:, 1] == pytest.approx(-chain.weights, rel=1e-9)


def test_tube_is_that_of_the_scene():
    rod = der.Model(der.load(scene_file("simply_supported"))).rods[0]
    assert pytest.approx(Tube().stretching_stiffness) == rod.EA
    assert pytest.approx(Tube().bending_stiffness) == rod.EI


# Scenes that come with der.


def test_scene_files_are_found():
    assert scene_file("falling_beam_3").read_text().startswith("#")
    with pytest.raises(FileNotFoundError, match="nothing_like_it"):
        scene_file("nothing_like_it")


def test_there_is_one_source_of_the_scenes():
    """The package gets its copies from configs/ when it is installed."""
    assert not list((ROOT / "python").rglob("*.yaml"))
    assert "configs/" in (ROOT / "bindings/CMakeLists.txt").read_text()
    installed = Path(der.__file__).parent / "scenes"
    if installed.exists():  # not where the package is used from its checkout
        for scene in (ROOT / "configs").glob("*.yaml"):
            assert (installed / scene.name).read_bytes() == scene.read_bytes()


# The folder.


@pytest.fixture
def quick(monkeypatch, document):
    """Everything but the runs."""
    monkeypatch.setattr(reproducing, "measure", lambda *_: None)
    monkeypatch.setattr(reproducing, "quantities", lambda _: [])
    monkeypatch.setattr(reproducing, "write_story", lambda *_: document)
    for name in ("comparison_csv", "deflection_csv", "speeds_csv"):
        monkeypatch.setattr(reproducing, name, lambda _: "a,b\n")


def names(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@pytest.mark.usefixtures("quick")
def test_folder_and_its_replacement(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    written = [
        "data/comparison.csv",
        "data/deflection_by_load.csv",
        "data/terminal_speeds.csv",
        "figures/dot.png",
        "report.html",
        "report.md",
    ]
    for _ in range(2):
        assert main(["reproduce"]) == 0
        told = capsys.readouterr()
        assert Path(told.out.strip()) == Path("reproduction/report.html")
        assert told.err == "figures\n", "the stages, where no terminal shows a progress line"
        assert names(tmp_path / "reproduction") == written
        (tmp_path / "reproduction/figures/old.png").touch()
    assert [path.name for path in tmp_path.iterdir()] == ["reproduction"]
    assert (tmp_path / "reproduction").stat().st_mode & 0o777 == 0o755


@pytest.mark.usefixtures("quick")
def test_snippet_of_the_page(tmp_path, monkeypatch):
    page = (ROOT / "docs/reproduce.md").read_text(encoding="utf-8")
    names = {}
    monkeypatch.chdir(tmp_path)
    exec(re.findall(r"^```python\n(.*?)^```", page, re.S | re.M)[0], names)
    assert names["report"] == Path("reproduction/report.html")
    assert names["report"].exists()


@pytest.mark.usefixtures("quick")
def test_a_new_folder_may_be_deep_or_empty(tmp_path):
    (tmp_path / "empty").mkdir()
    for folder in (tmp_path / "a" / "b", tmp_path / "empty"):
        assert der.reproduce.reproduce(folder) == folder / "report.html"
        assert (folder / "report.html").exists()


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("files", [["thesis.txt"], ["report.html", "thesis.txt"], ["figures"]])
def test_a_folder_with_other_things_is_left_alone(tmp_path, files, capsys):
    for file in files:
        (tmp_path / file).touch()
    assert main(["reproduce", "--out", str(tmp_path)]) == 1
    message = capsys.readouterr().err
    assert "is left alone" in message
    assert f"'{files[-1]}'" in message
    assert names(tmp_path) == sorted(files)


@pytest.mark.usefixtures("quick")
def test_where_nothing_can_be_written(tmp_path, capsys):
    file = tmp_path / "file"
    file.touch()
    assert main(["reproduce", "--out", str(file)]) == 1
    assert "is a file" in capsys.readouterr().err
    for parent in (str(file), "/proc"):
        assert main(["reproduce", "--out", f"{parent}/folder"]) == 1
        assert f"cannot write to {parent}: " in capsys.readouterr().err


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("error", [der.DerError("no"), KeyboardInterrupt()])
def test_what_fails_midway_leaves_nothing(tmp_path, monkeypatch, error):
    earlier = tmp_path / "earlier"
    der.reproduce.reproduce(earlier)
    before = (earlier / "report.html").read_bytes()

    def fail(*_):
        raise error

    monkeypatch.setattr(reproducing, "to_html", fail)
    for folder in (tmp_path / "new", earlier):
        with pytest.raises(type(error)):
            der.reproduce.reproduce(folder)
    assert [path.name for path in tmp_path.iterdir()] == ["earlier"]
    assert (earlier / "report.html").read_bytes() == before


def test_wrong_number_of_jobs(tmp_path, capsys):
    assert main(["reproduce", "--out", str(tmp_path / "new"), "--jobs", "0"]) == 1
    assert "jobs" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
