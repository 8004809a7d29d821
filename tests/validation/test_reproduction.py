"""The whole of der reproduce: every figure and number of the course report, as a user gets it.

It takes about half a minute on two cores, and is run once for all tests of this file.
"""

import base64
import csv
import json
import os
import re
import shlex
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import matplotlib.image
import pytest
from der.cli import main

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


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder that the command of docs/reproduce.md writes."""
    page = (ROOT / "docs/reproduce.md").read_text(encoding="utf-8")
    program, *arguments = shlex.split(re.findall(r"^```sh\n(.*?)^```", page, re.S | re.M)[0])
    assert program == "der"
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("reproduce"))
        assert main(arguments) == 0
        return Path("reproduction").resolve()


def read(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def rows(folder):
    return {row["key"]: row for row in read(folder / "data/comparison.csv")}


def value(row, column="ours"):
    return float(row[column])


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


def test_html_needs_no_other_file(folder):
    text = (folder / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert page.open == []
    assert {link.removeprefix("#") for link in page.links} <= page.ids
    assert not re.search(r"(src|href)=\"(?!data:|#)|url\(|@import|<script", text)
    pictures = [(folder / f"figures/{name}.png").read_bytes() for name in PICTURES]
    embedded = [base64.b64decode(image["src"].split(",", 1)[1]) for image in page.images]
    assert sorted(embedded) == sorted(pictures)
    assert all(len(image["alt"]) > 20 for image in page.images)


def test_markdown_shows_the_same(folder, rows):
    text = (folder / "report.md").read_text(encoding="utf-8")
    shown = re.findall(r"^!\[.+\]\((.+)\)$", text, flags=re.MULTILINE)
    assert {Path(path).stem for path in shown} == PICTURES
    assert all((folder / path).exists() for path in shown)
    for row in rows.values():
        assert f"| {row['quantity']} | {row['unit']} |" in text
    assert "nan" not in text.replace("\n", " ").split()
    assert "None" not in text


def test_exact_values_are_within_the_error_bars(rows):
    assert {key for key, row in rows.items() if row["error_bar"]} == VERIFIED
    for key in VERIFIED:
        row = rows[key]
        error_bar = value(row, "error_bar")
        assert abs(value(row) - value(row, "exact")) <= error_bar, key
        # Bars that tell something: below a thousandth, or of rounding alone.
        assert error_bar < max(1e-3 * abs(value(row)), 1e-11), key


def test_ours_is_what_der_run_gives(rows, tmp_path):
    """The table names a command for each of its numbers: these, to the last bit."""
    runs = {}
    for key in VERIFIED:
        command, probe = rows[key]["command"], rows[key]["probe"]
        program, *arguments = shlex.split(command)
        assert program == "der_run"
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
    assert rows["blow_up"]["command"].startswith("der_run configs/falling_beam_3_explicit_unstable")
    _, *arguments = shlex.split(rows["blow_up"]["command"])
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
    for number, row in enumerate((rows[0], rows[-1])):
        program, *arguments = shlex.split(row["command"])
        assert program == "der_run"
        out = tmp_path / str(number)
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


def test_captions_and_parameters(folder):
    text = (folder / "report.md").read_text(encoding="utf-8")
    for figure, said in ((5, "names a velocity"), (15, "that of Figure 14"), (18, "centre node")):
        start = text.index(f"Figure {figure} of the report")
        assert said in text[start : start + 900], figure
    for row in (
        "| Nodes |  | 3 | 21 | 51 |",
        "| Force, downward | N | - | - | 2000 |",
        "| Place of the force along the rod | m | - | - | 0.75 |",
    ):
        assert row in text


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
