"""Sweeps: members, rows, resuming, and the same bits wherever they are run."""

import json
import signal
import sqlite3
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from multiprocessing import get_context

import der
import numpy as np
import pytest
from der.cli import main
from der.errors import DerError
from der.parallel import Threads, as_they_finish
from der.progress import ProgressLine
from der.sweeps.chunk import BROKEN, Chunk, run_chunk
from der.sweeps.design import make_design
from der.sweeps.store import FILE, Store, locked
from der.sweeps.table import Column, Table
from der.sweeps.values import Range, parse_values, stored
from sweep_scenes import FORCE, STIFFNESS, STRIP, bits, cantilever, of_each_kind


class Here(Executor):
    """Does at once what it is asked for."""

    _max_workers = 1

    def submit(self, function, *arguments):
        future = Future()
        try:
            future.set_result(function(*arguments))
        except Exception as error:
            future.set_exception(error)
        return future


def command(*arguments):
    return [sys.executable, "-m", "der", "sweep", *map(str, arguments)]


@pytest.fixture(name="cantilever")
def fresh_cantilever():
    return cantilever()


@pytest.fixture
def scene(cantilever, tmp_path):
    path = tmp_path / "cantilever.yaml"
    path.write_text(der.Scenario.from_dict(cantilever).to_yaml())
    return path


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("1,2.5,-3e2", (1, 2.5, -300.0)),
        ("tr_bdf2", ("tr_bdf2",)),
        ("[0,-1],[0, -2]", ([0, -1], [0, -2])),
        ('true,null,"a,b:c"', (True, None, "a,b:c")),
        ("0:1:5", (0.0, 0.25, 0.5, 0.75, 1.0)),
        ("11:41:4", (11, 21, 31, 41)),
        ("4:16:3:log", (4, 8, 16)),
        ("1:10000000:8:log", tuple(10**k for k in range(8))),
        ("2:4:3:log", tuple(np.geomspace(2, 4, 3))),
        ("1e6:1e9:4:log", tuple(np.geomspace(1e6, 1e9, 4))),
        ("0:1", Range(0.0, 1.0)),
        ("1:100:log", Range(1.0, 100.0, log=True)),
        ("+5,5.,.5,0e1,0", (5, 5.0, 0.5, 0.0, 0)),
        ("1d3,0x1,1-2", ("1d3", "0x1", "1-2")),
    ],
)
def test_spelling_of_values(text, values):
    read = parse_values(text)
    assert read == values
    if isinstance(read, tuple):
        assert list(map(type, read)) == [
            type(v.item() if isinstance(v, np.generic) else v) for v in values
        ]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("1,,2", "a value is empty"),
        ("0:1:2:3", "is no range"),
        ("0:x:3", "is no range"),
        ("0:1:1", "at least 2"),
        ("0:1:3:log", "greater than 0"),
        ("[1", "is no value"),
        ("0:1:2.5", "is no range"),
        (":", "is no range"),
        ("::log", "is no range"),
        ("0:1:2:log:log", "is no range"),
        ("0:1:log:3", "is no range"),
        ("0:log", "is no range"),
        # Python reads these, and scenes do not.
        ("0:inf:3", "'inf': infinities and nan are out of range"),
        ("1,nan", "'nan': infinities and nan are out of range; a word stands in double quotes"),
        ("1,-.Inf", "'-.Inf': infinities and nan are out of range"),
        ("010", r"'010': a leading zero is ambiguous \(octal\): write 10 or 8"),
        ("-010,1", "write -10 or -8"),
        ("089", "'089': numbers have no leading zero: write 89"),
        ("00.5", "numbers have no leading zero: write 0.5"),
        ("1_0", "'1_0': numbers have the digits 0 to 9 and no separators: 10"),
        ("0:1_0.5:3", r"'1_0\.5': numbers have the digits 0 to 9 and no separators: 10\.5"),
        ("0_1:1_0:3", "no separators: 1$"),
        ("\u0663", "the digits 0 to 9 and no separators: 3"),
        ("1e400", "'1e400': it is out of the range of double-precision numbers"),
        ("1e-400", "'1e-400': it is out of the range of double-precision numbers"),
        ("[1,0],[NaN,1]", r"the value \[nan, 1\] has nan, which is no number of a scene"),
        ('{"a":[1,Infinity]}', "has inf, which is no number of a scene"),
    ],
)
def test_values_that_are_none(text, says):
    with pytest.raises(ValueError, match=says):
        parse_values(text)


def test_designs():
    product = make_design({"a": [1, 2, 2], "b": "0:1:3"})
    assert len(product) == 6
    assert list(product) == [(1, 0.0), (1, 0.5), (1, 1.0), (2, 0.0), (2, 0.5), (2, 1.0)]
    zipped = make_design({"a": [1, 1, 1], "b": [3, 4, 3]}, zipped=True)
    assert (len(zipped), list(zipped)) == (2, [(1, 3), (1, 4)])
    whole = np.ma.array([3, 4], mask=False)
    assert list(make_design({"a": whole, "b": range(1)})) == [(3, 0), (4, 0)]
    arrays = make_design({"a": np.array([[0.0, 1.0]]), "b": np.arange(2)})
    assert list(arrays) == [([0.0, 1.0], 0), ([0.0, 1.0], 1)]
    rows = {(1, 0), (1.0, 0.5), (2, 1.0), (3, 0.0), (1, 3), (1, 4)}
    assert (product.count_among(rows), zipped.count_among(rows)) == (3, 2)
    assert arrays.count_among({(json.dumps([0.0, 1.0]), 1), (1, 1)}) == 1


def test_samples_are_those_of_scipy():
    """Reference: scipy.stats.qmc, whose points are scaled here once more."""
    from scipy.stats import qmc

    vary = {"a": "2:6", "b": "1:100:log", "c": ["x", "y"]}
    design = make_design(vary, sample="sobol:16", seed=7)
    points = qmc.Sobol(3, seed=np.random.default_rng(7)).random(16)
    for member, (a, b, c) in zip(design, points, strict=True):
        assert member[0] == pytest.approx(2.0 + 4.0 * a, rel=1e-14)
        assert member[1] == pytest.approx(10.0 ** (2.0 * b), rel=1e-13)
        assert member[2] == ("x" if c < 0.5 else "y")
    longer = make_design(vary, sample="sobol:32", seed=7)
    assert list(longer)[:16] == list(design)
    assert list(make_design(vary, sample="sobol:16", seed=8)) != list(design)
    cube = np.array([m[0] for m in make_design({"a": "0:1"}, sample="lhs:10")])
    assert sorted(np.floor(10.0 * cube)) == list(range(10))  # one in each tenth


@pytest.mark.parametrize(
    ("vary", "options", "says"),
    [
        ({}, {}, "nothing is varied"),
        ({"a": []}, {}, "a: there is no value"),
        ({"a": 3}, {}, r"a: expected a sequence of values, got 3: write \[3\]"),
        ({"a": np.array(3.0)}, {}, r"a: expected a sequence of values, got 3.0: write \[3.0\]"),
        ({"a": {1, 2}}, {}, "a: a set has no order: write a list of values"),
        ({"a": {"x": 1}}, {}, "a: a dict is one value and no list of them"),
        ({"a": b"12"}, {}, r"a: bytes are no list of values: write \[1, 2\]"),
        ({"a": np.ma.array([1, 2], mask=[0, 1])}, {}, "a: some values are masked"),
        ({"a": [1.0, np.ma.masked]}, {}, "a: some values are masked"),
        ({"a": "0:1"}, {}, "0:1:11"),
        ({"a": "-1e308:1e308:3"}, {}, "a: the difference of the ends of a range, -1e.308 and"),
        ({"a": "-1e308:1e308"}, {"sample": "lhs:3"}, "a: the difference of the ends of a range"),
        ({"a": "1e-160:1e160:log"}, {"sample": "lhs:3"}, "a: the ratio of the ends of a range"),
        ({"a": [1, 2], "b": [1]}, {"zipped": True}, "a has 2, b has 1"),
        ({"a": [1]}, {"sample": "grid:3"}, "write sobol:256"),
        ({"a": [1]}, {"sample": "lhs:0"}, "write sobol:256"),
        ({"a": [1]}, {"sample": "lhs:3", "zipped": True}, "leave out zip or sample"),
    ],
)
def test_designs_that_are_none(vary, options, says):
    with pytest.raises(ValueError, match=says):
        make_design(vary, **options)


def test_products_that_nobody_waits_for(scene, tmp_path, capsys):
    """One of more than 64 bits was an error of Python, and left a folder."""
    vary = {FORCE: "-2:-1:100000", STIFFNESS: "1:2:100000"}
    says = "are 10000000000 members, and a sweep has at most 1000000000: give fewer values, or take"
    with pytest.raises(ValueError, match=says):
        der.sweep(scene, vary, out=tmp_path / "s")
    line = ["sweep", str(scene), "--out", str(tmp_path / "s")]
    paths = (FORCE, STIFFNESS, "rods.arm.to.0", "rods.arm.from.0")
    for path in paths:
        line += ["--vary", f"{path}=1:2:1000000"]
    assert main(line) == 1
    assert f"are {10**24} members" in capsys.readouterr().err
    assert not (tmp_path / "s").exists()


def test_a_large_product_begins_at_once(scene, tmp_path):
    """Also where texts have to be looked at: the unit of a probe must not depend on them.

    And where it goes on from a row: its 2e8 members are not counted one by one, which took minutes.
    """

    class Begun(Exception):
        pass

    class Begins(Here):
        def submit(self, function, *arguments):
            raise Begun

    probe = "output.probes.tip_y.quantity"
    vary = {FORCE: "-2:-1:100000", STIFFNESS: "1:2:1000", probe: ["x", "y"]}
    begun = time.monotonic()
    with pytest.raises(Begun):
        der.sweep(scene, vary, executor=Begins())
    out = tmp_path / "s"
    assert len(der.sweep(scene, {FORCE: [-2.0], STIFFNESS: [1.0], probe: ["x"]}, out=out)) == 1
    with pytest.raises(Begun):
        der.sweep(scene, vary, executor=Begins(), out=out, resume=True)
    assert time.monotonic() - begun < 20.0


def test_what_buckling_does_not_find_is_no_failure(cantilever):
    """Without a load, and without EI, there is no load factor out of the plane either."""
    cantilever["analysis"] = "buckling"
    force = {FORCE: [0.0]}
    assert der.sweep(cantilever, {**force, STIFFNESS: [1.0, 0.0]}).statuses == {"completed": 2}


def test_the_cost_of_a_path_is_that_of_all_its_points(cantilever):
    cantilever["analysis"] = {"continuation": {}}
    sweep = der.sweep(cantilever, {FORCE: [-1.0]})
    alone = der.run(cantilever)
    assert sweep.rows[0]["newton_iterations"] == alone.summary["newton_iterations"]
    assert alone.summary["newton_iterations"] > len(alone.times)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ("11:12:4", r"its values are 11\.0, 11\.3333, 11\.6667, 12\.0: take a range with a whole"),
        ([11.0, 21.5], r"its values are 11\.0, 21\.5: take"),
        (np.linspace(11, 61, 6), r"its values are 11\.0, 21\.0, 31\.0, 41\.0, \.\.\.: take"),
    ],
)
def test_values_that_are_no_whole_numbers(cantilever, values, says):
    with pytest.raises(ValueError, match=rf"rods\.arm\.nodes: a whole number belongs.*{says}"):
        der.sweep(cantilever, {"rods.arm.nodes": values})


@pytest.mark.parametrize("sample", ["lhs:5", "sobol:8"])
def test_samples_of_whole_numbers(cantilever, sample):
    says = r"rods\.arm\.nodes: a whole number belongs.*a sample of 11:41 has others"
    with pytest.raises(ValueError, match=says):
        der.sweep(cantilever, {"rods.arm.nodes": "11:41"}, sample=sample)


@pytest.mark.parametrize(
    ("path", "values", "says"),
    [
        ("quantity", ["y", "slope"], "in m in some members and in rad in others"),
        (
            "",
            [
                {"quantity": "x", "rod": "arm", "at": "end"},
                {"quantity": "tx", "rod": "arm", "at": "end"},
            ],
            "in m in some members and in 1 in others",
        ),
    ],
)
def test_a_probe_has_one_unit(cantilever, path, values, says):
    """The table said that of the member that finished first."""
    vary = {f"output.probes.tip_y.{path}".rstrip("."): values, FORCE: [-1.0, -2.0]}
    with pytest.raises(ValueError, match=f"the probe 'tip_y' has values {says}"):
        der.sweep(cantilever, vary)
    # Two quantities of one unit are one column.
    sweep = der.sweep(cantilever, {"output.probes.tip_y.quantity": ["x", "y"]})
    assert sweep.column("tip_y").unit == "m"


def test_times_of_extremes_are_no_points_of_a_path(cantilever):
    with pytest.raises(
        ValueError, match=r"tip_y\.t_min' has values in s in some members and in poi"
    ):
        der.sweep(cantilever, {"analysis": ["static", {"continuation": {}}]})


def test_an_executor_that_gives_up(cantilever, tmp_path):
    class GivesUp(Here):
        def submit(self, function, *arguments):
            if arguments[0].members[0][0] < 1:
                return super().submit(function, *arguments)
            future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    with pytest.raises(DerError, match=r"the executor gave work up.*go on with --resume"):
        der.sweep(cantilever, {FORCE: "-5:0:6"}, executor=GivesUp(), out=tmp_path)
    assert len(der.load_sweep(tmp_path)) <= 1
    assert len(der.sweep(cantilever, {FORCE: "-5:0:6"}, out=tmp_path, resume=True)) == 6


def test_a_full_disk_says_how_to_go_on(cantilever, tmp_path, monkeypatch):
    connect = sqlite3.connect

    def small(*arguments, **options):
        base = connect(*arguments, **options)
        base.execute("PRAGMA max_page_count = 40")  # SQLite then says what it says of a full disk
        return base

    vary = {FORCE: np.linspace(-1.0, 0.0, 3000)}
    with monkeypatch.context() as patched:
        patched.setattr(sqlite3, "connect", small)
        with pytest.raises(
            OSError, match=r"disk is full.*are kept: make room, then go on with --r"
        ):
            der.sweep(cantilever, vary, out=tmp_path)
    assert 0 < len(der.load_sweep(tmp_path)) < 3000
    assert len(der.sweep(cantilever, vary, out=tmp_path, resume=True)) == 3000


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"vary": 5}, TypeError, "vary must be a dict of key paths and their values"),
        ({"vary": [("a", 1)]}, TypeError, "vary must be a dict of key paths and their values"),
        ({"vary": {FORCE: [1j]}}, ValueError, "1j is no value of a scene: use numbers"),
        (
            {"vary": {FORCE: "0:1:100000000000"}},
            ValueError,
            "at least 2 values and at most 10000000",
        ),
        ({"sample": "lhs:100000000000"}, ValueError, "a sample has at most 10000000 points"),
        ({"seed": -1}, ValueError, "seed must be a whole number of at least 0, got -1"),
        ({"seed": 1.5}, TypeError, "seed must be a whole number of at least 0, got 1.5"),
        ({"sample": "lhs:1_0"}, ValueError, "no separators: 10"),
        ({"sample": "lhs:1.5"}, ValueError, "'lhs:1.5' is no sample: write sobol:256 or lhs:100"),
        ({"sample": 5}, ValueError, "'5' is no sample: write sobol:256 or lhs:100"),
        ({"out": 3}, TypeError, "out must be the path of a folder, got 3"),
        ({"out": b"s"}, TypeError, "out must be the path of a folder, got b's'"),
        ({"progress": 3}, TypeError, "progress must be a function, got 3"),
        ({"zipped": "no"}, TypeError, "zipped must be True or False, got 'no'"),
        ({"resume": "false"}, TypeError, "resume must be True or False, got 'false'"),
        ({"verify": 1}, TypeError, "verify must be True or False, got 1"),
        ({"frames": None}, TypeError, "frames must be True or False, got None"),
        ({"jobs": 1.5}, TypeError, "jobs must be a whole number of at least 1, got 1.5"),
    ],
)
def test_arguments_that_are_none(cantilever, arguments, error, says):
    with pytest.raises(error, match=says):
        der.sweep(cantilever, **{"vary": {FORCE: [-1.0]}} | arguments)


def test_rows_are_those_of_single_runs(cantilever):
    sweep = der.sweep(cantilever, {FORCE: "-2:0:3", STIFFNESS: [1.0, 2.0]}, jobs=2)
    assert sweep.parameters == [FORCE, STIFFNESS]
    assert [(row[FORCE], row[STIFFNESS]) for row in sweep.rows] == [
        (f, s) for f in (-2.0, -1.0, 0.0) for s in (1.0, 2.0)
    ]
    scene = der.Scenario.from_dict(cantilever)
    for row in sweep.rows:
        alone = der.run(scene.with_(**{FORCE: row[FORCE], STIFFNESS: row[STIFFNESS]}))
        assert row["tip_y.final"] == alone.probes["tip_y"].summary["final"]
        assert row["newton_iterations"] == alone.summary["newton_iterations"]
        assert (row["status"], row["stability"]) == ("static_converged", "stable")
        assert (row["version"], row["message"]) == (der.__version__, None)
    assert sweep.column("tip_y").unit == "m"
    assert len(sweep) == 6
    assert not sweep.failed.any()


def test_a_run_over_time_tells_extremes_and_their_times(swing):
    sweep = der.sweep(swing, {"rods.arm.material.youngs_modulus": [1e6, 1e7]})
    for row in sweep.rows:
        modulus = row["rods.arm.material.youngs_modulus"]
        scene = der.Scenario.from_dict(swing)
        alone = der.run(scene.with_(**{"rods.arm.material.youngs_modulus": modulus}))
        told = {key: row[f"tip.{key}"] for key in ("final", "min", "max", "t_min", "t_max")}
        assert told == {key: alone.probes["tip"].summary[key] for key in told}
        assert row["steps"] == alone.summary["steps"]
    assert sweep.column("tip.t_min").unit == "s"


def test_analyses_tell_what_they_find(cantilever):
    cantilever["analysis"] = {"modes": {"count": 2}}
    modes = der.sweep(cantilever, {FORCE: [0, -1]})
    alone = der.run(cantilever).modes
    assert [modes.rows[1][f"frequency {n}"] for n in (1, 2)] == alone.frequencies.tolist()
    assert modes.column("frequency 1").unit == "Hz"
    cantilever["loads"][0]["point_force"]["force"] = [-1, 0]
    cantilever["analysis"] = {"buckling": {"count": 1}}
    buckling = der.sweep(cantilever, {STIFFNESS: [1.0, 2.0]})
    factors = buckling["load factor 1"]
    # Euler's column: in proportion to EI, which the mesh does not change.
    assert factors[1] == pytest.approx(2.0 * factors[0], rel=1e-5)
    assert factors[0] == pytest.approx(np.pi**2 / 4.0, rel=1e-2)


def test_a_path_tells_its_events():
    arch = der.load("configs/snap_through_arch.yaml", **{"analysis.continuation.branches": 0})
    stiffness = "rods.arch.cross_section.stiffness.EA"
    (row,) = der.sweep(arch, {stiffness: [2e4]}, verify=True).rows
    alone = der.run(arch.with_(**{stiffness: 2e4}))
    event = alone.path.rows("bifurcation")[0]
    assert row["factor, bifurcation 1"] == alone.path.factor[event]
    assert row["top, bifurcation 1"] == alone.probes["top"][event]
    verified = der.verify(arch.with_(**{stiffness: 2e4}), jobs=1)
    for name in ("factor, bifurcation 1", "top, bifurcation 1"):
        probe, _, event = name.partition(", ")
        assert row[f"{name}.error"] == verified[probe, event].error_bar


def test_failed_members_are_rows(cantilever):
    vary = {STIFFNESS: [1.0, -1.0], "rods.arm.nodes": [11, 21]}
    sweep = der.sweep(cantilever, vary)
    assert sweep.statuses == {"invalid_scene": 2, "static_converged": 2}
    assert sweep.failed.tolist() == [False, False, True, True]
    assert "must be at least 0" in sweep.rows[2]["message"]
    assert sweep.rows[2]["tip_y.final"] is None
    assert np.isnan(sweep["tip_y"][2:]).all()
    assert "4 members, 2 failed (invalid_scene 2)" in sweep.summary()


@pytest.mark.parametrize(
    ("analysis", "when"), [("static", "s"), ({"continuation": {}}, "")], ids=["static", "path"]
)
def test_probes_have_columns_if_every_member_fails(cantilever, analysis, when):
    """A program asked for the values of a probe, and met a KeyError."""
    cantilever |= {"analysis": analysis, "start_from": "/nowhere"}
    sweep = der.sweep(cantilever, {FORCE: [-1.0, -2.0]})
    assert sweep.all_failed
    assert np.isnan(sweep["tip_y"]).tolist() == [True, True]
    names = [f"tip_y.{what}" for what in ("final", "min", "max", "t_min", "t_max")]
    assert [sweep.column(name).unit for name in names] == ["m", "m", "m", when, when]


def test_a_run_that_fails_has_a_cost_and_no_values(swing):
    swing["time"] |= {"integrator": "verlet", "step": 1e-4}
    steps = [1e-4, 5e-3]
    sweep = der.sweep(swing, {"time.step": steps})
    good, bad = sweep.rows
    assert good["status"] == "completed"
    assert bad["status"] not in ("completed", BROKEN)
    assert bad["message"]
    assert bad["tip.final"] is None


def test_a_run_that_fails_tells_since_when_it_was_unreliable(swing):
    swing["time"] = {"duration": 6, "step": 0.005, "integrator": "implicit_midpoint"}
    integrators = ["implicit_midpoint", "implicit_euler"]
    failed, good = der.sweep(swing, {"time.integrator": integrators}).rows
    alone = der.run(swing, check=False)
    assert failed["status"] == alone.status == "unstable_motion"
    assert failed["unreliable_from"] == alone.unreliable_from > 0.0
    assert (good["status"], good["unreliable_from"]) == ("completed", None)


def test_errors_that_are_not_ders_are_rows_too(cantilever, monkeypatch):
    from der.sweeps import chunk

    original = chunk.attempt

    def forgetful(scenario, *rest, **options):
        if "-1" in scenario.to_yaml():
            raise MemoryError("no more")
        return original(scenario, *rest, **options)

    monkeypatch.setattr(chunk, "attempt", forgetful)
    sweep = der.sweep(cantilever, {FORCE: [0.0, -1.0]})
    assert [row["status"] for row in sweep.rows] == ["static_converged", BROKEN]
    assert sweep.rows[1]["message"] == "MemoryError: no more"


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("loads.0.force", "it belongs under 'point_force'"),
        ("rods.amr.nodes", "did you mean 'arm'"),
        ("loads.7.point_force", "no item 7"),
    ],
)
def test_a_wrong_path_is_an_error_before_anything_runs(cantilever, tmp_path, path, says):
    with pytest.raises(der.SceneError, match=says):
        der.sweep(cantilever, {path: [1.0]}, out=tmp_path / "sweep")
    assert not (tmp_path / "sweep").exists()


@pytest.mark.parametrize(
    ("first", "second", "value", "says"),
    [
        (STIFFNESS, STIFFNESS.replace(".arm.", ".0."), 2.0, "are the same value"),
        (STIFFNESS, STIFFNESS.rpartition(".")[0], {"EA": 1e6, "EI": 2.0}, "overlap"),
        (FORCE, FORCE.rpartition(".")[0], [0, -2], "overlap"),
    ],
)
def test_two_paths_to_one_value_are_refused(cantilever, first, second, value, says):
    """The later one won, and rows told values that were not used."""
    vary = {first: [1.0], second: [value]}
    with pytest.raises(ValueError, match=says):
        der.sweep(cantilever, vary)
    with pytest.raises(ValueError, match=says):
        der.Batch(cantilever, 1, vary=vary)


@pytest.mark.parametrize("name", ["seconds", "status", "stability"])
def test_a_probe_named_like_a_column_of_each_sweep_is_refused(cantilever, name):
    """Its name would give the cost, or the status, for the probe's final values."""
    probes = cantilever["output"]["probes"]
    probes[name] = probes.pop("tip_y")
    with pytest.raises(ValueError, match=f"the probe '{name}' has the name of a column"):
        der.sweep(cantilever, {FORCE: [-1.0]})


def test_numbers_that_a_table_holds_otherwise(cantilever, tmp_path):
    """Whole numbers of more than 64 bits, nan, and a number given both as 7 and as 7.0."""
    nodes = "rods.arm.nodes"
    for _ in range(2):
        sweep = der.sweep(cantilever, {nodes: [5, 10**20, 7]}, out=tmp_path / "s", resume=True)
        assert sweep.values["status"] == ["static_converged", "invalid_scene", "static_converged"]
    for value in (np.nan, np.inf, [1, [np.nan]], (np.inf, 2), {"a": np.inf}):
        with pytest.raises(ValueError, match=r"(nan|inf), which is no number"):
            der.sweep(cantilever, {nodes: [5, value]})
    for values in ([5, 7, 7.0], [5, 7.0, 7]):
        assert der.sweep(cantilever, {nodes: values}).values[nodes] == [5, 7]


def test_processes_end_with_a_driver_that_is_killed(scene, tmp_path):
    """They hold its output, for which another program would wait."""
    arguments = ("--vary", f"{FORCE}=-5:0:20000", "--out", tmp_path / "s", "--processes")
    driver = subprocess.Popen(
        command(scene, *arguments), stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not rows_in(tmp_path / "s"):
        time.sleep(0.1)
    driver.kill()
    driver.communicate(timeout=60)  # until nobody has the pipe any more


def test_names_that_sqlite_takes_for_one(cantilever):
    cantilever["output"]["probes"]["TIP_y"] = cantilever["output"]["probes"]["tip_y"]
    with pytest.raises(ValueError, match="'tip_y' and 'TIP_y' differ in the case"):
        der.sweep(cantilever, {FORCE: [1.0]})


def test_a_scene_without_probes_is_given_some(cantilever):
    del cantilever["output"]
    sweep = der.sweep(cantilever, {FORCE: [-1.0]})
    assert sweep["arm_end_y"] < 0.0


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("static", {"tip_y.final": "tip_y"}),
        ("over time", {f"tip_y.{what}": ("tip_y", what) for what in ("final", "min", "max")}),
        (
            "modes",
            {"tip_y.final": "tip_y", "frequency 1": "frequency 1", "frequency 2": "frequency 2"},
        ),
        (
            "buckling",
            {
                "tip_y.final": "tip_y",
                "load factor 1": "load factor 1",
                "load factor 2": "load factor 2",
            },
        ),
        ("path", {"tip_y, end": ("tip_y", "end")}),
    ],
)
def test_verify_adds_error_bars(kind, values):
    scene = of_each_kind()[kind]
    sweep = der.sweep(scene, {STIFFNESS: [1.0, -1.0]}, verify=True)
    alone = der.verify(der.Scenario.from_dict(scene), jobs=1)
    row, failed = sweep.rows
    bars = {name: bar for name, bar in row.items() if name.endswith(".error")}
    assert bars == {f"{name}.error": alone[value].error_bar for name, value in values.items()}
    assert all(0.0 < bar < np.inf for bar in bars.values())
    for name in values:
        assert sweep.column(f"{name}.error").unit == sweep.column(name).unit
    assert row["flagged"] == len(alone.flagged)
    assert [failed[name] for name in bars] == [None] * len(bars)


def test_frames_are_run_folders(cantilever, tmp_path):
    sweep = der.sweep(cantilever, {FORCE: [-1.0, -2.0]}, out=tmp_path / "s", frames=True)
    for row in sweep.rows:
        run = der.open_run(tmp_path / "s/runs/0000" / f"{row['member']:07d}")
        assert run.probes["tip_y"].summary["final"] == row["tip_y.final"]
    with pytest.raises(ValueError, match="run folders need a folder"):
        der.sweep(cantilever, {FORCE: [-1.0]}, frames=True)


@pytest.fixture(scope="module")
def processes():
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        yield pool


@pytest.mark.parametrize("kind", of_each_kind())
def test_the_same_bits_in_threads_and_processes(kind, processes, tmp_path):
    scene, vary = of_each_kind()[kind], {STIFFNESS: [*np.linspace(0.2, 2.0, 36), -1.0]}
    reference = bits(der.sweep(scene, vary, jobs=1))
    assert [row["message"] == "None" for row in reference] == [True] * 36 + [False]
    assert bits(der.sweep(scene, vary, executor=Here())) == reference
    for jobs in (2, 3):
        assert bits(der.sweep(scene, vary, jobs=jobs)) == reference
    assert bits(der.sweep(scene, vary, executor=processes, out=tmp_path / "s")) == reference


def test_more_values_run_the_new_ones_alone(cantilever, tmp_path):
    out = tmp_path / "s"
    first = der.sweep(cantilever, {FORCE: [-1, -2]}, out=out, resume=True)  # it never began
    more = der.sweep(cantilever, {FORCE: "-3:0:4"}, out=out, resume=True)
    assert [row[FORCE] for row in more.rows] == [-1, -2, -3, 0]
    # Not run again: the very same cost.
    assert more.rows[:2] == first.rows
    again = der.sweep(cantilever, {FORCE: "-3:0:4"}, out=out, resume=True)
    assert again.rows == more.rows
    assert [request["values"] for request in again.requests] == [[[-1, -2]], [[-3, -2, -1, 0]]]
    assert again.rows == der.load_sweep(out).rows
    assert len(first) == len(first.rows) == 2  # the members of its time


def test_what_is_refused_by_name(cantilever, tmp_path):
    out = tmp_path / "s"
    der.sweep(cantilever, {FORCE: [-1]}, out=out)

    def again(scene=cantilever, vary=None, resume=True, **options):
        der.sweep(scene, vary or {FORCE: [-2]}, out=out, resume=resume, **options)

    with pytest.raises(ValueError, match="holds a sweep already: go on with it by --resume"):
        again(resume=False)
    other = json.loads(json.dumps(cantilever))
    other["rods"][0]["to"] = [2, 0]
    with pytest.raises(ValueError, match=r"of the scene 'Cantilever'.* differ in rods\.0\.to\.0"):
        again(other)
    with pytest.raises(ValueError, match=f"holds a sweep of {FORCE}, not of {STIFFNESS}"):
        again(vary={STIFFNESS: [1.0]})
    with pytest.raises(ValueError, match="a sweep without --verify"):
        again(verify=True)
    with locked(out), pytest.raises(DerError, match="another sweep is writing"):
        again()
    (tmp_path / "full").mkdir()
    (tmp_path / "full/notes.txt").touch()
    for resume in (False, True):
        with pytest.raises(ValueError, match=r"holds notes\.txt"):
            der.sweep(cantilever, {FORCE: [-1]}, out=tmp_path / "full", resume=resume)
    with pytest.raises(ValueError, match="is a file"):
        der.sweep(cantilever, {FORCE: [-1]}, out=tmp_path / "full/notes.txt")
    with pytest.raises(TypeError, match="executor must be"):
        der.sweep(cantilever, {FORCE: [-1]}, executor="dask")
    with pytest.raises(FileNotFoundError, match="no sweep in"):
        der.load_sweep(tmp_path)
    with pytest.raises(TypeError, match="folder must be the path of a folder, got 3"):
        der.load_sweep(3)
    assert len(der.load_sweep(out)) == 1


def test_another_version_of_a_worker_is_refused(cantilever):
    chunk = Chunk(der.Scenario.from_dict(cantilever).to_yaml(), "x", (FORCE,), ((0, (1.0,)),))
    assert len(run_chunk(chunk).rows) == 1
    with pytest.raises(DerError, match=f"a worker has der {der.__version__}"):
        run_chunk(Chunk(chunk.scene, "x", (FORCE,), chunk.members, version="0.0.1"))


def test_a_chunk_whose_worker_dies_is_tried_in_parts(cantilever):
    """Dask gives a chunk up after some workers died of it: the member that kills is a row."""

    class KilledWorker(Exception):
        pass

    class Deadly(Here):
        def submit(self, function, chunk):
            def run(chunk):
                if any(values == (-2.0,) for _, values in chunk.members):
                    raise KilledWorker("died")
                return function(chunk)

            return super().submit(run, chunk)

    vary = {FORCE: np.linspace(-4.0, 0.0, 41)}
    sweep = der.sweep(cantilever, vary, executor=Deadly())
    assert len(sweep) == 41
    assert [r[FORCE] for r in sweep.rows if r["status"] == "worker_lost"] == [-2.0]


def test_a_broken_pool_keeps_what_was_finished(cantilever, tmp_path):
    class Breaking(Here):
        def submit(self, function, chunk):
            if chunk.members[0][0] == 3:
                raise BrokenProcessPool("a process died")
            return super().submit(function, chunk)

    vary = {FORCE: [-1.0, -2.0, -3.0, -4.0]}
    with pytest.raises(DerError, match=r"a process died.*go on with --resume"):
        der.sweep(cantilever, vary, out=tmp_path / "s", executor=Breaking())
    assert len(der.load_sweep(tmp_path / "s")) > 0
    assert len(der.sweep(cantilever, vary, out=tmp_path / "s", resume=True)) == 4


def test_no_more_work_is_out_than_wanted():
    """Memory stays bounded: a piece is taken when there is room for it."""
    pieces = iter(range(1000))
    taken = []

    def take():
        piece = next(pieces, None)
        if piece is not None:
            taken.append(piece)
        return piece

    finished = []
    with Threads(2) as threads:
        for piece, future in as_they_finish(threads, lambda piece: -piece, take, lambda: 4):
            assert future.result() == -piece
            assert len(taken) - len(finished) <= 4
            finished.append(piece)
    assert sorted(finished) == taken == list(range(1000))


def test_an_interrupt_keeps_what_was_finished(cantilever, tmp_path):
    """Ctrl-C ends the sweep at once; the rest is run when it is resumed."""
    seen = []

    def interrupt(share):
        seen.append(share)
        if share > 0.3:
            raise KeyboardInterrupt

    vary = {FORCE: np.linspace(-5.0, 0.0, 200)}
    with pytest.raises(KeyboardInterrupt):
        der.sweep(cantilever, vary, out=tmp_path / "s", jobs=2, progress=interrupt)
    kept = der.load_sweep(tmp_path / "s")
    assert 0.3 * 200 <= len(kept) < 200 or seen[-1] == 1.0
    whole = der.sweep(cantilever, vary, out=tmp_path / "s", resume=True, progress=seen.append)
    assert bits(whole) == bits(der.sweep(cantilever, vary))
    assert seen[-1] == 1.0


def test_a_driver_killed_at_any_moment_loses_no_row(scene, tmp_path):
    """SIGKILL when some rows are there; each is kept, to its very cost, and none is twice.

    benchmarks/sweep_kills.py does this many times, at random moments.
    """
    out = tmp_path / "s"
    vary = {FORCE: "-5:0:300", "rods.arm.nodes": [401]}
    line = command(scene, "--vary", f"{FORCE}=-5:0:300", "--vary", "rods.arm.nodes=401")
    line += ["--out", str(out), "--jobs", "1", "--resume"]
    process = subprocess.Popen(line)
    deadline = time.monotonic() + 120.0
    while process.poll() is None and rows_in(out) < 3 and time.monotonic() < deadline:
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    kept = der.load_sweep(out).rows
    assert 3 <= len(kept) < 300
    whole = der.sweep(scene, vary, out=out, resume=True)
    assert whole.rows[: len(kept)] == kept
    assert bits(whole) == bits(der.sweep(scene, vary))


def rows_in(out):
    if not (out / FILE).exists():
        return 0
    base = sqlite3.connect(f"file:{out / FILE}?mode=ro", uri=True)
    try:
        return base.execute("SELECT COUNT(*) FROM runs").fetchone()[0]
    except sqlite3.OperationalError:  # no table yet, or one is being written
        return 0
    finally:
        base.close()


def test_the_command(scene, tmp_path, capsys):
    out = tmp_path / "s"
    line = ["sweep", str(scene), "--vary", f"{FORCE}=-2:0:3", "--vary", f"{STIFFNESS}=1,-1,2"]
    assert main([*line, "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert "Cantilever: 9 members, 3 failed (invalid_scene 3)" in printed.out
    assert printed.out.endswith(f"{out / FILE}\n")
    assert printed.err == ""
    assert main([*line, "--out", str(out)]) == 1
    assert "--resume" in capsys.readouterr().err
    sample = ["sweep", str(scene), "--vary", f"{FORCE}=-2:0", "--sample", "lhs:5", "--seed", "3"]
    assert main([*sample, "--out", str(tmp_path / "t"), "--jobs", "1"]) == 0
    assert der.load_sweep(tmp_path / "t").requests[0]["seed"] == 3
    twice = ["sweep", str(scene), "--vary", f"{FORCE}=1", "--vary", f"{FORCE}=2", "--out", str(out)]
    assert main(twice) == 1
    assert "given twice" in capsys.readouterr().err
    assert main(["sweep", str(scene), "--vary", "nothing", "--out", str(out)]) == 1
    assert "write PATH=1,2,5" in capsys.readouterr().err
    for option in (["--seed", "x"], ["--jobs", "1_0"], ["--jobs", "1.5"], ["--jobs", "010"]):
        with pytest.raises(SystemExit) as caught:
            main(["sweep", str(scene), "--vary", f"{FORCE}=1", "--out", str(out), *option])
        assert caught.value.code == 2
        assert f"argument {option[0]}: '{option[1]}'" in capsys.readouterr().err


@pytest.mark.parametrize("options", [["--frames"], ["--verify"], ["--processes", "--jobs", "2"]])
def test_the_command_with_options(options, scene, cantilever, tmp_path, capsys):
    out = tmp_path / "s"
    line = ["sweep", str(scene), "--vary", f"{FORCE}=-1,-2", "--out", str(out), *options]
    assert main(line) == 0
    assert "Cantilever: 2 members, none failed" in capsys.readouterr().out
    swept = der.load_sweep(out)
    alone = der.sweep(cantilever, {FORCE: [-1, -2]}, verify="--verify" in options)
    assert bits(swept) == bits(alone)
    assert ("tip_y.final.error" in swept.values) == ("--verify" in options)
    folders = sorted(str(path.relative_to(out)) for path in out.glob("runs/*/*"))
    kept = ["runs/0000/0000000", "runs/0000/0000001"] if "--frames" in options else []
    assert folders == kept
    for folder, row in zip(kept, swept.rows, strict=False):
        run = der.open_run(out / folder)
        assert run.probes["tip_y"].summary["final"] == row["tip_y.final"]
    assert main([*line, "--resume"]) == 0


@pytest.mark.parametrize(
    ("line", "says", "members"),
    [
        (["--vary", f"{FORCE}=-1,-2,-1.0"], f"{FORCE}: 3 values, 2 distinct", 2),
        (
            ["--vary", f"{FORCE}=-1,-2,-1", "--vary", f"{STIFFNESS}=1,2,1.0", "--zip"],
            "3 values side by side, 2 distinct",
            2,
        ),
        (
            ["--vary", f"{FORCE}=-1,-2", "--sample", "lhs:5"],
            "5 points of the sample, 2 distinct",
            2,
        ),
        (["--vary", f"{FORCE}=-1,-2", "--vary", f"{STIFFNESS}=1:2:3"], None, 6),
    ],
)
def test_the_command_says_what_is_given_twice(scene, tmp_path, capsys, line, says, members):
    assert main(["sweep", str(scene), *line, "--out", str(tmp_path / "s")]) == 0
    first, *_ = printed = capsys.readouterr().out.splitlines()
    assert f"Cantilever: {members} members" in printed[-2]
    assert len(printed) == 2 + (says is not None)
    if says is not None:
        assert first == f"{says}: each is taken once"


def test_ctrl_c_of_the_command_says_what_is_kept(scene, tmp_path, capsys, monkeypatch):
    write = Store.write

    def write_and_interrupt(*arguments):
        write(*arguments)
        raise KeyboardInterrupt

    line = ["sweep", str(scene), "--vary", f"{FORCE}=-2:0:30", "--out", str(tmp_path / "s")]
    monkeypatch.setattr(Store, "write", write_and_interrupt)
    assert main([*line, "--jobs", "1"]) == 130
    assert "interrupted: 1 member is kept in" in capsys.readouterr().err
    assert main([*line, "--resume", "--jobs", "1"]) == 130
    assert "interrupted: 2 members are kept in" in (said := capsys.readouterr().err)
    assert "with --resume goes on from there" in said
    monkeypatch.undo()
    assert main([*line, "--resume"]) == 0


def test_ctrl_c_before_the_first_member(scene, tmp_path, capsys, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("der.sweeps.sweep", interrupt)
    line = ["sweep", str(scene), "--vary", f"{FORCE}=-2:0:30", "--out", str(tmp_path / "s")]
    assert main(line) == 130
    assert "interrupted: no member is kept in" in capsys.readouterr().err


def test_a_folder_where_nobody_may_write(cantilever, tmp_path, monkeypatch):
    with pytest.raises(OSError, match=r"cannot make the folder /proc/no/s: .*; name a folder"):
        der.sweep(cantilever, {FORCE: [-1.0]}, out="/proc/no/s")
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(PermissionError, match=r"cannot write to .*s: name a folder"):
        der.sweep(cantilever, {FORCE: [-1.0]}, out=tmp_path / "s")


def test_more_probes_than_a_table_has_columns(cantilever):
    def with_probes(count):
        probe = cantilever["output"]["probes"]["tip_y"]
        return cantilever | {"output": {"probes": {f"p{i}": probe for i in range(count)}}}

    sweep = der.sweep(with_probes(397), {FORCE: [-1.0]})
    assert sweep.failed.sum() == 0
    with pytest.raises(ValueError, match=r"398 probes of 5 columns .* has room for 397 of them"):
        der.sweep(with_probes(398), {FORCE: [-1.0]})
    with pytest.raises(ValueError, match=r"8 columns each, .* has room for 248 of them"):
        der.sweep(with_probes(249), {FORCE: [-1.0]}, verify=True)


def test_varied_probes_that_have_no_room(cantilever):
    probe = cantilever["output"]["probes"]["tip_y"]
    many = {f"p{i}": probe for i in range(400)}
    sweep = der.sweep(cantilever, {"output.probes": [many, {"q": probe}]})
    assert sweep.values["status"] == ["too_many_columns", "static_converged"]


def test_a_file_that_is_no_sweep(cantilever, tmp_path):
    (tmp_path / FILE).write_text("garbage")
    with pytest.raises(OSError, match=r"is damaged, or no file of a sweep .*: name another folder"):
        der.sweep(cantilever, {FORCE: [-1.0]}, out=tmp_path, resume=True)


@pytest.mark.parametrize("table", ["mine", "runs", "sweep"])
def test_the_database_of_another_program_is_left_alone(table, cantilever, tmp_path):
    with closing(sqlite3.connect(tmp_path / FILE)) as base:
        base.execute(f"CREATE TABLE {table} (x)")
    before = (tmp_path / FILE).read_bytes()
    with pytest.raises(OSError, match=r"no(ne| file) of a sweep.*: name another folder"):
        der.sweep(cantilever, {FORCE: [-1.0]}, out=tmp_path, resume=True)
    assert (tmp_path / FILE).read_bytes() == before


def test_findings_that_have_no_columns_left():
    """The member that has them is a failure, and the others are kept."""

    def finds(member, count):
        found = {f"x{i}": float(i) for i in range(count)}
        return {"member": member, "status": "completed", "seconds": 0.5, "version": "0", **found}

    store = Store()
    store.create({}, [FORCE])
    columns = {f"x{i}": Column(f"x{i}", "found") for i in range(2000)}
    rows = [finds(0, 3), finds(1, 2000), finds(2, 4)]
    store.write(Table(columns, rows), [FORCE], dict.fromkeys(range(3), (-1.0,)))
    found = store.read([Column("status", "run"), Column("x2", "found")], store.last())
    assert found == [("completed", 2.0), ("too_many_columns", None), ("completed", 2.0)]
    (message,) = store.read([Column("message", "run")], store.last())[1]
    assert message == (
        "it finds 1997 columns more, and a table has 2000 at most: ask for fewer probes, modes or "
        "bifurcations"
    )
    assert "x4" not in {column.name for column in store.columns}
    store.close()


@pytest.mark.parametrize(
    ("analysis", "column", "of_run"),
    [
        ("static", "stability out of plane", lambda run: run.summary["out_of_plane"]["stability"]),
        (
            {"modes": {"count": 2}},
            "growth rate out of plane",
            lambda run: run.summary["out_of_plane"]["growth_rate"],
        ),
        (
            {"buckling": {"count": 1}},
            "load factor out of plane",
            lambda run: run.summary["out_of_plane"]["load_factor"],
        ),
        (
            {"continuation": {"to": 1.0}},
            "factor, out_of_plane 1",
            lambda run: run.path.factor[run.path.rows("out_of_plane")[0]],
        ),
    ],
    ids=["static", "modes", "buckling", "continuation"],
)
def test_rows_tell_what_a_run_warns_of(analysis, column, of_run):
    scene = der.Scenario.from_dict({**STRIP, "analysis": analysis})
    run = der.run(scene)
    assert run.summary["warnings"]
    sweep = der.sweep(scene, {FORCE: [-20.0]})
    (row,) = sweep.rows
    assert row[column] == of_run(run)
    assert row["warnings"].splitlines() == run.summary["warnings"]
    assert "1 member, none failed, 1 with warnings (column warnings)" in sweep.summary()


def test_members_without_warnings(cantilever):
    sweep = der.sweep({**STRIP, "analysis": "static"}, {FORCE: [-0.1, -20.0]})
    assert [row["stability out of plane"] for row in sweep.rows] == ["stable", "unstable"]
    assert sweep.rows[0]["warnings"] is None
    assert sweep.warned == 1
    assert "warnings" not in der.sweep(cantilever, {FORCE: [-1.0]}).values


def test_warnings_of_a_scene_are_issued_once(cantilever):
    """The rows have them, too."""
    cantilever["loads"].append({"point_force": {"rod": "arm", "at": "start", "force": [0, -1]}})
    with pytest.warns(der.DerWarning, match="the support takes it up") as issued:
        sweep = der.sweep(cantilever, {FORCE: [-1.0, -2.0, -3.0]})
    assert len(issued) == 1
    assert sweep.warned == 3


def test_failures_of_the_surroundings_are_tried_again(cantilever, tmp_path):
    """As a disk that was full, or a folder that was not there; others are not."""
    cantilever["start_from"] = str(tmp_path / "straight")
    vary = {"rods.0.cross_section.stiffness.EI": [1.0, -1.0]}
    first = der.sweep(cantilever, vary, out=tmp_path / "s")
    assert [row["status"] for row in first.rows] == ["io_error", "invalid_scene"]
    start = {key: value for key, value in cantilever.items() if key != "start_from"}
    der.run(start, out=tmp_path / "straight")
    again = der.sweep(cantilever, vary, out=tmp_path / "s", resume=True)
    assert [row["status"] for row in again.rows] == ["static_converged", "invalid_scene"]
    assert [row["member"] for row in again.rows] == [0, 1]


def test_a_member_that_is_tried_again_keeps_its_number(cantilever, tmp_path):
    """Rows that are not asked for stay; they went, and came back with another number or never."""
    out, name = tmp_path / "s", "start_from"
    there, new, missing, never = (
        str(tmp_path / folder) for folder in ("there", "new", "missing", "never")
    )
    for folder in (there, new):
        der.run(cantilever, out=folder)

    def swept(*values):
        return der.sweep(cantilever, {name: values}, out=out, frames=True, resume=True)

    first = swept(there, missing, never)
    assert first.values["status"] == ["static_converged", "io_error", "io_error"]
    other = swept(there)
    assert other.rows == first.rows
    der.run(cantilever, out=missing)
    last = swept(new, missing)
    assert last.values["status"] == ["static_converged"] * 2 + ["io_error", "static_converged"]
    assert last.values[name] == [there, missing, never, new]
    assert last.rows[2] == first.rows[2]
    assert last.rows[1]["message"] is None
    run = der.open_run(out / "runs/0000/0000001")
    assert run.probes["tip_y"].summary["final"] == last.rows[1]["tip_y.final"]
    assert run.scenario.to_dict()[name] == missing


def test_an_interrupt_loses_no_row_that_was_to_be_tried_again(cantilever, tmp_path):
    vary = {"start_from": [str(tmp_path / "a"), str(tmp_path / "b")]}
    first = der.sweep(cantilever, vary, out=tmp_path / "s").rows

    class Interrupted(Here):
        def submit(self, function, *arguments):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        der.sweep(cantilever, vary, out=tmp_path / "s", resume=True, executor=Interrupted())
    assert der.load_sweep(tmp_path / "s").rows == first


def test_a_sweep_that_another_version_began_says_so(cantilever, tmp_path):
    der.sweep(cantilever, {FORCE: [-1.0]}, out=tmp_path)
    base = sqlite3.connect(tmp_path / FILE)
    with base:
        base.execute("UPDATE sweep SET value = '0.0.9' WHERE key = 'version'")
    base.close()
    with pytest.warns(der.DerWarning, match=r"was begun by der 0\.0\.9, and this is der"):
        der.sweep(cantilever, {FORCE: [-1.0, -2.0]}, out=tmp_path, resume=True)


def test_a_wrong_number_of_jobs_begins_nothing(cantilever, tmp_path):
    with pytest.raises(ValueError, match="jobs must be"):
        der.sweep(cantilever, {FORCE: [-1.0]}, out=tmp_path / "s", jobs=0)
    assert not (tmp_path / "s").exists()


def test_a_seed_needs_a_sample(cantilever):
    with pytest.raises(ValueError, match="a seed is where a sample starts"):
        der.sweep(cantilever, {FORCE: [-1.0]}, seed=3)


def test_exit_code_if_every_member_fails(cantilever, tmp_path, capsys):
    del cantilever["supports"]
    path = tmp_path / "free.yaml"
    path.write_text(der.Scenario.from_dict(cantilever).to_yaml())
    code = main(["sweep", str(path), "--vary", f"{FORCE}=-1,-2", "--out", str(tmp_path / "s")])
    assert code == 3
    assert "2 members, 2 failed (not_held 2)" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("spelled", "numbers"),
    [
        ("5 mm, 1 cm", [5e-3, 1e-2]),
        ("4 mm:8 mm:3", [4e-3, 6e-3, 8e-3]),
        ("1 mm:100 mm:3:log", [1e-3, 1e-2, 1e-1]),
        (["5 mm", 0.005, 0.01], [5e-3, 1e-2]),
    ],
)
def test_values_with_units_are_numbers_in_the_table(cantilever, tmp_path, spelled, numbers):
    path = f"rods.{cantilever['rods'][0]['name']}.cross_section.circle.radius"
    cantilever["rods"][0]["cross_section"] = {"circle": {"radius": 0.01}}
    cantilever["rods"][0]["material"] = {"youngs_modulus": 1e9, "density": 1000}
    swept = der.sweep(cantilever, {path: spelled}, out=tmp_path / "units")
    assert swept[path].tolist() == pytest.approx(numbers, rel=1e-15)
    plain = der.sweep(cantilever, {path: swept[path].tolist()}, out=tmp_path / "plain")
    assert swept["tip_y"].tolist() == plain["tip_y"].tolist()


def test_ranges_to_sample_have_units(cantilever, tmp_path):
    with_units = make_design({"a": "1 mm:5 mm", "b": "2:3"}, sample="sobol:8")
    plain = make_design({"a": "1:5", "b": "2:3"}, sample="sobol:8")
    for (a, b), (c, d) in zip(with_units, plain, strict=True):
        assert stored(a) == pytest.approx(1e-3 * c, rel=1e-15)
        assert b == d
    assert with_units.to_json() != plain.to_json()
    with pytest.raises(ValueError, match=r"a: 1 mm:5 mm is a range to sample from.*1 mm:5 mm:11"):
        make_design({"a": "1 mm:5 mm"})
    with pytest.raises(ValueError, match="both ends of a range have the same unit"):
        make_design({"a": "1 mm:5 cm:3"})


def test_a_unit_of_another_kind_fails_before_anything_runs(cantilever, tmp_path):
    with pytest.raises(der.SceneError, match="'kg' is not a unit of this kind"):
        der.sweep(cantilever, {FORCE: "5 kg"}, out=tmp_path / "s")
    assert not (tmp_path / "s").exists()


def test_progress_on_a_terminal_tells_the_time_left(cantilever, tmp_path, monkeypatch):
    import io

    stream = io.StringIO()
    line = ProgressLine(stream)
    line.delay = 0.0
    der.sweep(cantilever, {FORCE: "-2:0:30"}, jobs=1, progress=line)
    assert "left" in stream.getvalue()
    assert "100 % [##############################]  0 s left" in stream.getvalue()
