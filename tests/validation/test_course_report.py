"""The course report of examples/course_report: every figure and number, as a user gets it.

The whole of it takes about half a minute on two cores, and is run once for all tests of this file.
"""

import base64
import csv
import json
import math
import os
import re
import shlex
import subprocess
import sys
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import course_report.__main__ as command
import der
import matplotlib.image
import numpy as np
import pytest
from course_report import exact
from course_report.comparison import Claim
from course_report.measurements import nodes_beside_the_load
from course_report.numbers_as_text import digits_within, duration, number, percent
from references.extensible_beam import REPORT_TUBE
from references.falling_spheres import Fall, FallingRod

ROOT = Path(__file__).resolve().parents[2]
DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))

PICTURES = {
    "figure_01_initial_configuration",
    "figure_02_shapes",
    "figure_03_displacement",
    "figure_04_velocity",
    "figure_05_equal_spheres_angle",
    "figure_06_unstable_angle",
    "figure_07_unstable_velocity",
    "figure_08_unstable_displacement",
    "figure_09_five_shapes",
    "figure_10_five_velocity",
    "figure_11_twenty_one_displacement",
    "figure_12_twenty_one_velocity",
    "figure_13_twenty_one_shapes",
    "figure_14_twenty_one_over_three",
    "figure_15_fifty_one_over_twenty_one",
    "figure_16_terminal_speed_by_step",
    "figure_17_loaded_beam",
    "figure_18_deflection_history",
    "extra_schemes",
    "extra_terminal_speed_by_nodes",
    "extra_deflection_by_load",
}
VERIFIED = {
    "speed_3",
    "terminal_3",
    "fall_3",
    "angle_equal",
    "fall_5_dry",
    "fall_5_buoyant",
    "terminal_5",
    "terminal_21_dry",
    "terminal_21_buoyant",
    "terminal_21_coarse",
    "middle_2kN",
    "middle_20kN",
    "deflection_2kN",
    "deflection_20kN",
}


# The whole report.


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the command writes to the folder that it names by itself."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("reproduce"))
        assert command.main([]) == 0
        return Path("reproduction").resolve()


@pytest.fixture(scope="module")
def text(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


def read(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def rows(folder):
    return {row["key"]: row for row in read(folder / "data/comparison.csv")}


def value(row, column="ours"):
    return float(row[column])


def plain(text):
    """The words of the page, or of a part of it, with single spaces between them."""
    body = re.sub(r"<style>.*?</style>|</?code>|`", "", text, flags=re.S)
    return " ".join(unescape(re.sub(r"<[^>]+>", " ", body)).split())


class Page(HTMLParser):
    """Collects pictures, links and ids, and sees that every tag is closed."""

    def __init__(self, text):
        super().__init__()
        self.images, self.links, self.ids, self.open = [], [], set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        known = dict(attributes)
        if tag == "img":
            self.images.append(known)
        if "href" in known:
            self.links.append(known["href"])
        if "id" in known:
            self.ids.add(known["id"])
        if tag not in ("img", "meta"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_every_figure_is_there_and_drawn(folder):
    assert {path.stem for path in (folder / "figures").iterdir()} == PICTURES
    for path in (folder / "figures").iterdir():
        picture = matplotlib.image.imread(path)
        assert min(picture.shape[:2]) > 250
        assert picture[..., :3].std() > 0.05, f"{path.name} is empty"


def test_html_needs_no_other_file(folder, text):
    page = Page(text)
    assert page.open == []
    assert {link.removeprefix("#") for link in page.links} <= page.ids
    assert not re.search(r"(src|href)=\"(?!data:|#)|url\(|@import|<script", text)
    pictures = [(folder / f"figures/{name}.png").read_bytes() for name in PICTURES]
    embedded = [base64.b64decode(image["src"].split(",", 1)[1]) for image in page.images]
    assert sorted(embedded) == sorted(pictures)
    assert all(len(image["alt"]) > 20 for image in page.images)


def test_page_shows_every_row(text, rows):
    """With our number, its error bar and the exact value beside it."""
    words = plain(text)
    for key, row in rows.items():
        cells = [row["quantity"], row["unit"], row["report"] or "-"]
        if key in VERIFIED:
            ours, error_bar = value(row), value(row, "error_bar")
            digits = digits_within(ours, error_bar)
            cells += [number(ours, digits), "±", number(error_bar, 2)]
            cells.append(number(value(row, "exact"), digits + 1))
            cells.append(row["remark"])
        assert f" {plain(' '.join(cells))} " in words, key
        assert f" {plain(row['remark'])} " in words, key
    assert not {"nan", "None", "inf"} & set(words.split())
    assert "$" not in words


def test_exact_values_are_within_the_error_bars(rows):
    assert {key for key, row in rows.items() if row["error_bar"]} == VERIFIED
    for key in VERIFIED:
        row = rows[key]
        error_bar = value(row, "error_bar")
        assert abs(value(row) - value(row, "exact")) <= error_bar, key
        # Bars that tell something: below a thousandth, or of rounding alone.
        assert error_bar < max(1e-3 * abs(value(row)), 1e-11), key


def arguments_of(command):
    """Return those of a `der run`, which is the program der_run."""
    program, subcommand, *arguments = shlex.split(command)
    assert (program, subcommand) == ("der", "run")
    return arguments


def test_ours_is_what_der_run_gives(rows, tmp_path):
    """The table names a command for each of its numbers: these, to the last bit."""
    runs = {}
    for key in VERIFIED:
        command, probe = rows[key]["command"], rows[key]["probe"]
        arguments = arguments_of(command)
        if command not in runs:
            out = tmp_path / str(len(runs))
            subprocess.run(
                [DER_RUN, *arguments, "--quiet", "--out", str(out)], cwd=ROOT, check=True
            )
            runs[command] = json.loads((out / "summary.json").read_text())["probes"]
        found = runs[command][probe]
        if key == "angle_equal":
            assert value(rows[key]) == max(abs(found["min"]), abs(found["max"]))
        else:
            assert value(rows[key]) == abs(found["final"])
    plain = {command for command in runs if "--set" not in command}
    assert {command.split("/")[-1] for command in plain} == {
        "falling_beam_3.yaml",
        "falling_beam_3_equal.yaml",
        "falling_beam_5.yaml",
        "falling_beam_21.yaml",
        "simply_supported.yaml",
        "simply_supported_20kN.yaml",
    }


def test_what_no_probe_gives_is_printed_by_its_command(rows, tmp_path):
    named = {key for key, row in rows.items() if row["command"] and not row["probe"]}
    assert named == {"explicit_seconds", "implicit_seconds", "blow_up"}
    arguments = arguments_of(rows["blow_up"]["command"])
    assert arguments[0].startswith("configs/falling_beam_3_explicit_unstable")
    failed = subprocess.run(
        [DER_RUN, *arguments, "--out", str(tmp_path / "run")],
        cwd=ROOT,
        check=False,
        capture_output=True,
        text=True,
    )
    assert failed.returncode != 0
    assert f"diverged at t = {value(rows['blow_up']):g} s" in failed.stderr
    without = {key for key, row in rows.items() if row["ours"] and not row["command"]}
    assert without == {"stable_step", "mass_5_to_3"}


@pytest.mark.parametrize(
    ("table", "column", "probe"),
    [
        ("deflection_by_load", "ours_m", "deflection"),
        ("terminal_speeds", "ours_m_s", "v_mid"),
    ],
)
def test_rows_of_tables_are_what_their_commands_give(folder, tmp_path, table, column, probe):
    """The first and the last, which is the longest fall with the longest step."""
    rows = read(folder / f"data/{table}.csv")
    for i, row in enumerate((rows[0], rows[-1])):
        arguments = arguments_of(row["command"])
        out = tmp_path / str(i)
        subprocess.run([DER_RUN, *arguments, "--quiet", "--out", str(out)], cwd=ROOT, check=True)
        found = json.loads((out / "summary.json").read_text())["probes"][probe]
        assert value(row, column) == abs(found["final"])


def test_exact_values_are_those_of_the_references(rows, reference):
    for key, problem, name in (
        ("speed_3", "falling_spheres", "n3.buoyant.tangent.vy_mid.t10"),
        ("terminal_3", "falling_spheres", "terminal.n3.buoyant"),
        ("fall_3", "falling_spheres", "n3.buoyant.tangent.y_mid.t10"),
        ("fall_5_dry", "falling_spheres", "n5.dry.tangent.y_mid.t10"),
        ("fall_5_buoyant", "falling_spheres", "n5.buoyant.tangent.y_mid.t10"),
        ("terminal_21_dry", "falling_spheres", "terminal.n21.dry"),
        ("terminal_21_buoyant", "falling_spheres", "terminal.n21.buoyant"),
        ("deflection_2kN", "extensible_beam", "tube.2000.deflection"),
        ("deflection_20kN", "extensible_beam", "tube.20000.deflection"),
        ("euler_bernoulli_2kN", "extensible_beam", "euler_bernoulli.2000.deflection"),
    ):
        exact = abs(reference(problem, name))
        assert value(rows[key], "exact") == pytest.approx(exact, rel=1e-9), key


def test_what_is_said_of_the_report(rows):
    """The cases in which it disagrees with its own parameters."""
    assert "0.66\u00a0%" in rows["terminal_3"]["remark"]
    assert "17\u00a0%" in rows["terminal_21_buoyant"]["remark"]
    for load in ("2kN", "20kN"):
        assert "centre node" in rows[f"middle_{load}"]["remark"]
        remark = rows[f"deflection_{load}"]["remark"]
        assert remark.index("centre node") < remark.index("0.76 m")
    assert "1.2\u00a0%" in rows["mass_5_to_3"]["remark"]
    assert "60\u00a0%" in rows["euler_bernoulli_20kN"]["remark"]
    assert rows["terminal_5"]["report"] == "", "its number is that of 21 nodes"
    assert "0.38\u00a0%" in rows["terminal_5"]["remark"]
    for key in ("speed_3", "terminal_21_dry", "middle_2kN", "middle_20kN", "euler_bernoulli_20kN"):
        row = rows[key]
        decimals = len(row["report"].partition(".")[2])
        assert f"{value(row, 'exact'):.{decimals}f}" == row["report"], key
    for key in ("terminal_3", "terminal_21_buoyant", "deflection_2kN", "deflection_20kN"):
        row = rows[key]
        decimals = len(row["report"].partition(".")[2])
        assert f"{value(row, 'exact'):.{decimals}f}" != row["report"], key


def test_the_centre_node_has_the_reports_deflections(rows):
    """To the digits of an outside audit, which ran the report's own mesh."""
    assert value(rows["middle_2kN"]) == pytest.approx(0.037126, abs=5e-7)
    assert value(rows["middle_20kN"]) == pytest.approx(0.23409, abs=5e-6)


def test_captions_and_parameters(text):
    words = plain(text)
    for figure, said in ((5, "names a velocity"), (15, "that of Figure 14"), (18, "centre node")):
        start = words.index(f"Figure {figure} of the report")
        assert said in words[start : start + 900], figure
    for row in (
        "Nodes 3 21 51 ",
        "Length of the rod m 0.1 0.1 1 ",
        "from inside to outside m 0.001 0.001 0.011 to 0.013 ",
        "Young's modulus Pa 1e+09 1e+09 7e+10 ",
        "Density of the rod kg/m^3 0 0 2700 ",
        "Radius of the small spheres m 0.005 0.0005 - ",
        "Radius of the middle sphere m 0.025 0.025 - ",
        "Density of the spheres kg/m^3 7000 7000 - ",
        "Gravity, downward m/s^2 9.8 9.8 - ",
        "Viscosity of the fluid Pa s 1000 1000 - ",
        "no buoyancy kg/m^3 1000 0 - ",
        "Force, downward N - - 2000 ",
        "Place of the force along the rod m - - 0.75 ",
        "Time step, implicit s 0.01 0.01 0.01 ",
        "Duration s 10 50 1 ",
    ):
        assert row in words


def test_stable_step_and_costs(rows):
    """The estimate is on the safe side, by less than a tenth."""
    ours, exact = value(rows["stable_step"]), value(rows["stable_step"], "exact")
    assert 0.9 * exact < ours <= exact
    assert 0.0 < value(rows["implicit_seconds"]) < value(rows["explicit_seconds"]) < 60.0
    assert value(rows["blow_up"]) < 0.1


def test_deflection_by_load(folder):
    rows = read(folder / "data/deflection_by_load.csv")
    assert [value(row, "load_N") for row in rows] == sorted(
        factor * 10**power for factor, power in _loads()
    )
    for row in rows:
        ours, exact = value(row, "ours_m"), value(row, "exact_m")
        assert abs(ours - exact) <= value(row, "error_bar_m") < 1e-3 * exact
        assert value(row, "euler_bernoulli_m") > exact


def _loads():
    tens = [(factor, power) for power in (1, 2, 3) for factor in (1, 2, 5)]
    return [*tens[1:], (1, 4), (2, 4)]


def test_terminal_speeds(folder):
    rows = read(folder / "data/terminal_speeds.csv")
    assert {value(row, "nodes") for row in rows} >= {3, 5, 21, 51, 101}
    steps = {value(row, "step_s") for row in rows if row["nodes"] == "21"}
    assert (min(steps), max(steps)) == (0.01, 10.0)
    assert {value(row, "fluid_density_kg_m3") for row in rows} == {0.0, 1000.0}
    for row in rows:
        off = 1e-8 if value(row, "step_s") <= 2.0 else 1e-5
        assert value(row, "ours_m_s") == pytest.approx(value(row, "terminal_m_s"), rel=off)


# Its folder.


@pytest.fixture
def quick(monkeypatch):
    """Everything but the runs and what is made of them."""
    monkeypatch.setattr(command, "measure", lambda _: None)
    monkeypatch.setattr(command, "comparison", lambda _: [])
    monkeypatch.setattr(command, "draw", lambda _: {"dot": b"PNG"})
    monkeypatch.setattr(command, "page", lambda *_: "page")
    monkeypatch.setattr(command, "data_files", lambda *_: {"table": [["a", "b"], [1, 2.5]]})


def names(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@pytest.mark.usefixtures("quick")
def test_folder_and_its_replacement(tmp_path, capsys):
    out = tmp_path / "a" / "b"
    for _ in range(2):
        assert command.main(["--out", str(out)]) == 0
        told = capsys.readouterr()
        assert told.out == f"{out / 'report.html'}\n"
        assert told.err == "figures\n"
        assert names(out) == ["data/table.csv", "figures/dot.png", "report.html"]
    assert (out / "data/table.csv").read_text() == "a,b\n1,2.5\n"


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("files", [["thesis.txt"], ["report.html", "thesis.txt"], ["figures"]])
def test_a_folder_with_other_things_is_left_alone(tmp_path, files, capsys):
    for file in files:
        (tmp_path / file).touch()
    assert command.main(["--out", str(tmp_path)]) == 1
    assert f"('{files[-1]}') and is left alone" in capsys.readouterr().err
    assert names(tmp_path) == sorted(files)


def test_where_nothing_can_be_written(tmp_path, capsys):
    file = tmp_path / "file"
    file.touch()
    for out in (file, file / "folder", Path("/proc/folder")):
        assert command.main(["--out", str(out)]) == 1
        assert f"cannot make the folder {out}" in capsys.readouterr().err


@pytest.mark.usefixtures("quick")
def test_what_fails_midway_changes_nothing(tmp_path, monkeypatch):
    command.main(["--out", str(tmp_path)])
    before = {name: (tmp_path / name).read_bytes() for name in names(tmp_path)}

    def fail(*_):
        raise der.DerError("no")

    monkeypatch.setattr(command, "draw", lambda _: {"dot": b"another"})
    monkeypatch.setattr(command, "page", fail)
    with pytest.raises(der.DerError):
        command.main(["--out", str(tmp_path)])
    assert {name: (tmp_path / name).read_bytes() for name in names(tmp_path)} == before


# What the exact solutions have beyond the references, and that both are of the scenes.


def test_limits_of_the_terminal_speed():
    many = FallingRod(10001)
    assert exact.terminal_speed(many) == pytest.approx(exact.many_nodes_speed(many), rel=1e-4)
    assert exact.many_nodes_speed(many) < exact.lone_sphere_speed(many)
    assert exact.lone_sphere_speed(many) == pytest.approx(
        2.0 / 9.0 * 6000.0 * 9.8 * 0.025**2 / 1000.0
    )


@pytest.mark.parametrize(("nodes", "density", "kind"), [(3, 1000.0, "buoyant"), (5, 0.0, "dry")])
def test_fall(nodes, density, kind, reference):
    """Also where it is interpolated between steps."""
    motion = exact.fall(FallingRod(nodes, density), np.array([0.0, 1.0, 10.0]))
    assert exact.fallen(motion)[0] == 0.0
    for i, time in ((1, "1"), (2, "10")):
        name = f"n{nodes}.{kind}.tangent.{{}}_mid.t{time}"
        fallen = -reference("falling_spheres", name.format("y"))
        speed = -reference("falling_spheres", name.format("vy"))
        assert exact.fallen(motion)[i] == pytest.approx(fallen, rel=1e-10)
        assert exact.speed(motion)[i] == pytest.approx(speed, rel=1e-9)


def test_forces_balance_and_have_a_potential():
    chain = FallingRod(5)
    shape = 0.02 * np.random.default_rng(1).standard_normal((5, 2))
    gradient = chain.elastic_gradient(shape)
    assert np.abs(gradient.sum(axis=0)).max() < 1e-9 * np.abs(gradient).max()
    stiffness = chain.elastic_hessian(shape)
    assert stiffness == pytest.approx(stiffness.T, rel=1e-9, abs=1e-9 * np.abs(stiffness).max())
    step = 1e-7
    nudge = np.zeros((5, 2))
    nudge[2, 1] = step
    difference = chain.elastic_gradient(shape + nudge) - chain.elastic_gradient(shape - nudge)
    slope = difference.ravel() / (2 * step)
    assert stiffness[:, 5] == pytest.approx(slope, abs=1e-6 * np.abs(stiffness).max())


def test_turning_angle_of_a_known_shape():
    edge = FallingRod(3).edge
    down = np.array([[[0.0, 0.0], [0.0, -edge], [0.0, 0.0]]])
    angle = exact.turning_angle(Fall(np.zeros(1), down, down), edge)
    assert angle == pytest.approx([math.pi / 2])


def test_longest_stable_step_is_near_that_of_drag_alone():
    chain = FallingRod(3)
    drag_alone = 2.0 * float((chain.masses() / chain.drag()).min())
    assert 0.95 * drag_alone < exact.longest_stable_step(chain) < drag_alone


def test_deflection_of_the_middle_under_a_small_load():
    """P b (3 L^2 - 4 b^2) / (48 EI), b being the distance of the load from the nearer support."""
    load, near = 1.0, 0.25
    linear = load * near * (3.0 - 4.0 * near**2) / (48.0 * REPORT_TUBE.bending)
    for place in (1.0 - near, near):
        middle = exact.deflections([load], place)[load].middle
        assert middle == pytest.approx(linear, rel=1e-7)


def test_nodes_beside_the_load():
    assert nodes_beside_the_load() == pytest.approx((0.74, 0.76))


@pytest.mark.parametrize(
    ("name", "chain"),
    [
        ("falling_beam_3", FallingRod(3)),
        ("falling_beam_3_equal", FallingRod(3, middle_radius=0.005)),
        ("falling_beam_5", FallingRod(5, 0.0)),
        ("falling_beam_21", FallingRod(21, 0.0)),
        ("falling_beam_51", FallingRod(51, 0.0)),
    ],
)
def test_chains_are_those_of_the_scenes(name, chain, scene):
    simulation = der.Simulation(scene(name))
    rod = simulation.model.rods[0]
    assert simulation.node_masses == pytest.approx(chain.masses(), rel=1e-12)
    assert rod.sphere_radii == pytest.approx(chain.radii())
    assert pytest.approx(chain.youngs_modulus * np.pi * chain.rod_radius**2) == rod.EA
    tree = simulation.scenario.to_dict()
    assert tree["loads"][1]["fluid"]["density"] == chain.fluid_density
    # Everything weighs on the nodes at the start.
    assert simulation.gradient().reshape(-1, 2)[:, 1] == pytest.approx(chain.weights(), rel=1e-9)


def test_tube_is_that_of_the_scene(scene):
    rod = der.Model(scene("simply_supported")).rods[0]
    assert pytest.approx(REPORT_TUBE.stretching) == rod.EA
    assert pytest.approx(REPORT_TUBE.bending) == rod.EI


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
    assert digits_within(0.0377377, 3.0e-5) == 5
    assert digits_within(0.0, 1e-12) == 1
    assert digits_within(1.0, 1e-20) == 12
    assert digits_within(2.0, 30.0) == 1


def test_shares_and_times():
    assert percent(0.00664).replace("\u00a0", " ") == "0.66 %"
    assert duration(0.000889) == "0.89 ms"
    assert duration(12.3) == "12 s"


def test_claims_know_what_rounds_to_them():
    claim = Claim("0.037")
    assert claim.is_met_by(0.0374)
    assert claim.is_met_by(0.036501)
    assert not claim.is_met_by(0.037714)
    assert claim.rounded(0.037714) == "0.038"
