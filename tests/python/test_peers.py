"""benchmarks/peers.py: what needs no other code than der."""

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))

from comparison import codes, measure, report  # noqa: E402
from comparison.codes import CODES, DER, Code  # noqa: E402
from comparison.measure import Point  # noqa: E402
from comparison.report import Run, Series  # noqa: E402
from comparison.scene import FRAMES, RunFailedError, distance, march  # noqa: E402
from comparison.scenes import SCENES  # noqa: E402

MISSING = Code("none", "None", "no_such_package_of_rods", "none")
SWING = SCENES["swing"]


def run(seconds, error):
    return Run(seconds, error, {"elements": 10, "steps": 2})


def series(title, *costs_and_errors):
    return Series(title, title, tuple(run(*pair) for pair in costs_and_errors))


def peers(*arguments, cwd):
    return subprocess.run(
        [sys.executable, str(BENCHMARKS / "peers.py"), *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        timeout=120,
    )


def cells(table):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]


def test_the_front_keeps_only_runs_that_none_beats():
    runs = [run(3.0, 1e-4), run(1.0, 1e-2), run(2.0, 2e-2), run(4.0, 1e-4), run(2.0, 1e-3)]
    assert [(r.seconds, r.error) for r in report.pareto_front(runs)] == [
        (1.0, 1e-2),
        (2.0, 1e-3),
        (3.0, 1e-4),
    ]


def test_the_front_leaves_out_what_is_not_a_number():
    assert report.pareto_front([run(1.0, float("nan")), run(2.0, float("inf"))]) == []


def test_the_cheapest_run_need_not_be_the_least_accurate():
    runs = [run(1.0, 2e-2), run(3.0, 9e-3), run(2.0, 1e-5)]
    assert report.cheapest(runs, 1e-2) == runs[2]
    assert report.cheapest(runs, 1e-6) is None


def test_the_cost_table_has_ratios_to_the_first_series():
    table = cells(
        report.cost_table(
            [
                series("ours", (0.002, 9e-3), (0.0125, 5e-4)),
                series("theirs", (0.0249, 1e-4), (1.5, 2e-5)),
            ]
        )
    )
    assert table[0] == ["error at most", "ours", "theirs"]
    assert table[2] == ["1e-2 m", "2.0 ms", "25 ms (12 x)"]
    assert table[3] == ["1e-3 m", "12 ms", "25 ms (2.0 x)"]
    assert table[4] == ["1e-4 m", "not reached", "25 ms"]
    assert table[5] == ["1e-5 m", "not reached", "not reached"]


def test_the_configuration_table_says_how_each_target_was_reached():
    table = cells(report.configuration_table([series("ours", (0.0125, 1.23e-3))]))
    assert table[2:] == [["1e-2 m", "ours", "12 ms", "1.2e-3 m", "10 elements, 2 steps/frame"]]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.00012345, "0.12 ms"), (0.0987, "99 ms"), (0.9999, "1.0 s"), (12.34, "12 s")],
)
def test_times_have_two_digits(seconds, text):
    assert report.time_text(seconds) == text


def test_a_code_with_a_limit_of_its_own_gives_a_second_series():
    config = {"elements": 10, "steps": 2}
    points = [
        Point("ours", config, 1.0, 1e-3),
        Point("theirs", config, 2.0, 2e-3, own_error=1e-4),
        Point("theirs", config, np.inf, np.inf, failure="unstable"),
    ]
    ours, theirs, own = report.to_series(points)
    assert (ours.title, ours.own_limit) == ("ours", False)
    assert [r.error for r in theirs.runs] == [2e-3]
    assert (own.code, own.own_limit, own.runs[0].error) == ("theirs", True, 1e-4)


def test_the_notes_say_how_far_a_limit_lies_from_the_reference():
    text = report.notes({"theirs": 2.51e-3})
    assert text.startswith("theirs converges to a continuum of its own, 2.5e-3 m from")
    assert report.notes({}) == ""


def test_the_fewest_steps_are_found_from_below():
    tried = []

    def needs_41(config):
        tried.append(config["steps"])
        if config["steps"] < 41:
            raise RunFailedError("unstable")
        return 0.5, "path"

    config = {"elements": 40, "steps": measure.FEWEST}
    found, seconds, path = measure.run_stably(needs_41, config)
    assert (seconds, path) == (0.5, "path")
    assert 41 <= found["steps"] <= np.ceil(41 * measure.STRIDE)
    assert found["elements"] == 40
    assert tried == sorted(tried)
    assert tried[-1] == found["steps"]


def test_given_steps_are_left_alone():
    config = {"elements": 40, "steps": 3}
    assert measure.run_stably(lambda _: (0.5, "path"), config) == (config, 0.5, "path")


def test_only_runs_that_can_still_win_are_repeated():
    config = {"elements": 10, "steps": 2}
    dear = 1.1 * measure.HOPELESS
    best = Point("a", config, 0.1, 1e-3)
    near = Point("a", config, 0.09 * measure.HOPELESS, 2e-3)
    beaten = Point("a", config, 0.1 * dear, 2e-3)
    accurate = Point("a", config, 0.1 * dear, 1e-4)
    other_code = Point("b", config, 0.9 * measure.LONG, 1e-1)
    long = Point("b", config, 2.0 * measure.LONG, 1e-5)
    failed = Point("b", config, np.inf, np.inf, failure="unstable")
    points = [best, near, beaten, accurate, other_code, long, failed]
    assert measure.worth_repeating(points) == [best, near, accurate, other_code]


def test_a_run_that_leaves_the_reach_of_the_rod_has_failed():
    for place in ((2.0, 0.0), (np.nan, 0.0)):
        with pytest.raises(RunFailedError, match=r"unstable after 0\.01 s"):
            march(lambda: None, lambda place=place: place)


def test_the_path_holds_the_start_and_all_frames():
    state = {"frame": 0}

    def advance():
        state["frame"] += 1

    _, path = march(advance, lambda: (1.0, -0.01 * state["frame"]))
    np.testing.assert_allclose(path, [(1.0, -0.01 * k) for k in range(101)], atol=1e-15)


@pytest.mark.parametrize(
    ("key", "end", "accuracy"),
    [
        ("swing", [-0.31392, -0.52705], 1e-5),
        # der with 640 and 1280 elements and 2000 steps of sdirk5, extrapolated at order 2
        ("strip", [-0.430977, 0.185279, -0.340290], 2e-6),
    ],
)
def test_the_reference_is_the_one_of_the_validation(key, end, accuracy):
    reference = SCENES[key].reference()
    assert reference.shape == (FRAMES + 1, len(end))
    np.testing.assert_allclose(reference[0], np.eye(len(end))[0], atol=1e-15)
    np.testing.assert_allclose(reference[-1], end, atol=accuracy)


@pytest.mark.parametrize("key", SCENES)
def test_der_runs_the_scenes_and_converges(key):
    ours = DER.adapter(key)
    errors = []
    for elements in (40, 80):
        config = {"elements": elements, "steps": 10, "integrator": "implicit_midpoint"}
        seconds, path = ours.run(config)
        assert seconds > 0.0
        errors.append(distance(path, SCENES[key].reference()))
    assert errors[0] < 1e-2
    assert errors[1] < 0.5 * errors[0]


def test_a_run_of_der_that_diverges_is_reported_as_failed():
    config = {"elements": 40, "steps": 2, "integrator": "verlet"}
    with pytest.raises(RunFailedError):
        DER.adapter("swing").run(config)


INSTALLED = [(key, code) for key in SCENES for code in CODES if code.is_installed()]


@pytest.mark.parametrize(
    ("key", "code"), INSTALLED, ids=[f"{key}-{code.key}" for key, code in INSTALLED]
)
def test_the_grids_name_elements_and_steps(key, code):
    for quick in (True, False):
        for config in code.adapter(key).grid(quick):
            assert config["elements"] > 0
            assert config["steps"] == measure.FEWEST or config["steps"] > 0


def test_a_missing_peer_is_named_with_what_to_do():
    assert not MISSING.is_installed()
    assert codes.missing_text(MISSING) == "None: not installed: pip install der[peers]"


@pytest.mark.parametrize("scene", SCENES.values(), ids=lambda s: s.key)
def test_the_program_skips_missing_peers_and_writes_what_is_asked(scene, tmp_path):
    missing = [code for code in CODES if not code.is_installed()]
    keys = ["der", *(code.key for code in missing)]
    files = ["--csv", "out.csv", "--plot", "out.png"]
    done = peers("--scene", scene.key, "--quick", *files, "--peers", *keys, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for code in missing:
        assert codes.missing_text(code) in done.stdout
    table = cells(done.stdout[done.stdout.index("| error at most") :])
    assert table[0] == ["error at most", "der"]
    assert table[2][0] == "1e-2 m"
    assert "ms" in table[2][1]
    with (tmp_path / "out.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {row["code"] for row in rows} == {"der"}
    assert all(float(row["cpu_seconds"]) > 0.0 for row in rows)
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")


def test_the_program_fails_without_anything_to_measure(tmp_path):
    missing = [code.key for code in CODES if not code.is_installed()]
    if not missing:
        pytest.skip("all peers are installed")
    done = peers("--peers", *missing, "--quick", cwd=tmp_path)
    assert done.returncode == 1
    assert "nothing to measure" in done.stderr


@pytest.mark.parametrize(
    ("option", "name", "words"),
    [
        ("--csv", "nodir/out.csv", "there is no folder nodir"),
        ("--plot", ".", "it is a folder"),
        ("--plot", "out.jpg", "a picture ends with .png, .svg or .pdf"),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_work(option, name, words, tmp_path):
    done = peers("--quick", "--peers", "der", option, name, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert words in done.stderr


def test_a_repeat_that_fails_leaves_the_first_time(monkeypatch):
    """An unstable run may get through once and not again."""
    times = iter([0.25, None, 0.125])

    class Adapter:
        @staticmethod
        def grid(quick):
            return [{"elements": 10, "steps": 2}]

        @staticmethod
        def run(config):
            seconds = next(times)
            if seconds is None:
                raise RunFailedError("unstable")
            return seconds, SWING.reference()

    code = Code("ours", "Ours", "der", "")
    monkeypatch.setattr(Code, "adapter", lambda self, scene: Adapter)
    (point,), _ = measure.measure(SWING, [code], quick=True, repeats=3)
    assert (point.seconds, point.error, point.failure) == (0.125, 0.0, "")
    assert next(times, "none left") == "none left"


def test_an_unknown_peer_is_refused(tmp_path):
    done = peers("--peers", "elastica3000", cwd=tmp_path)
    assert done.returncode == 2
    assert "invalid choice" in done.stderr
