"""der.study and der study: cost against error."""

import copy
import csv
import dataclasses
import math

import der
import numpy as np
import pytest
from der.accuracy.study_comparison import Reference, converge_in_space
from der.accuracy.study_plan import (
    choose_meshes,
    choose_steps,
    common_interval,
    reference_interval,
    reference_step,
)
from der.accuracy.study_result import Study
from der.accuracy.study_row import StudyRow, seconds_text
from der.cli import main
from der.parallel import Task, Workers, attempt
from matplotlib.image import imread

SAGGING = {
    "title": "Beam that falls into a sag",
    "rods": [
        {
            "name": "arm",
            "nodes": 11,
            "from": [0, 0],
            "to": [1, 0],
            "cross_section": {"circle": {"radius": 0.01}},
            "material": {"youngs_modulus": 1e7, "density": 1000},
        }
    ],
    "supports": [
        {"rod": "arm", "at": "start", "fix": ["x", "y"]},
        {"rod": "arm", "at": "end", "fix": ["y"]},
    ],
    "loads": [{"gravity": [0, -9.81]}],
    "time": {"duration": 0.3, "step": 0.005, "integrator": "implicit_midpoint"},
    "output": {
        "every": 0.005,
        "probes": {"sag": {"rod": "arm", "at": "middle", "quantity": "y"}},
    },
}


@pytest.fixture
def sagging():
    return copy.deepcopy(SAGGING)


@pytest.fixture(scope="module")
def found():
    return der.study(
        copy.deepcopy(SAGGING),
        nodes=[11, 21, 41],
        steps=[0.01, 0.005, 0.0025],
        steppers=["implicit_euler", "tr_bdf2", "explicit_euler"],
    )


def rows_of(found, **wanted):
    return [
        row
        for row in found.rows
        if all(getattr(row, name) == value for name, value in wanted.items())
    ]


def test_every_configuration_has_a_row(found):
    configurations = {(row.nodes, row.stepper, row.step) for row in found.rows}
    assert len(configurations) == len(found.rows) == 3 * 3 * 3
    assert found.probes == ["sag"]


def test_errors_against_an_independent_run(found, sagging):
    """A run on a far finer mesh with far smaller steps of another stepper."""
    exact = der.Scenario.from_dict(sagging).with_(
        **{"rods.arm.nodes": 321, "time.step": 2.5e-4, "output.every": 0.005}
    )
    exact = np.asarray(der.run(exact).probes["sag"])
    for row in rows_of(found, status="completed"):
        scenario = der.Scenario.from_dict(sagging).with_(
            **{
                "rods.arm.nodes": row.nodes,
                "time.step": row.step,
                "time.integrator": row.stepper,
                "output.every": row.interval,
            }
        )
        at_frames = exact[:: round(row.interval / 0.005)]
        error = np.max(np.abs(np.asarray(der.run(scenario).probes["sag"]) - at_frames))
        assert row.error == pytest.approx(error, rel=0.1, abs=2e-5)


def test_a_strip_that_leaves_its_plane_and_twists():
    """Errors that differ from those against a far finer run by no more than the study says."""
    strip = {"rectangle": {"width": 0.02, "height": 0.01}, "director": [0, 1, 1]}
    rod = {
        **{"name": "strip", "nodes": 11, "from": [0, 0, 0], "to": [1, 0, 0]},
        "cross_section": strip,
        "material": {"youngs_modulus": 2e7, "poissons_ratio": 0.45, "density": 1000},
    }
    scene = der.Scenario.from_dict(
        {
            "rods": [rod],
            "supports": [{"rod": "strip", "at": "start", "clamp": True}],
            "loads": [{"gravity": [0, 0, -9.81]}],
            "time": {"duration": 0.3, "step": 0.01, "integrator": "implicit_midpoint"},
            "output": {
                "every": 0.01,
                "probes": {"aside": {"rod": "strip", "at": "end", "quantity": "y"}},
            },
        }
    )

    def aside(nodes, step, stepper):
        finer = {"rods.strip.nodes": nodes, "time.step": step, "time.integrator": stepper}
        result = der.run(scene.with_(**finer))
        assert result.summary["model"] == "spatial"
        return np.asarray(result.probes["aside"])

    found = der.study(
        scene, nodes=[11, 21, 41], steps=[0.01, 0.005], steppers=["implicit_midpoint", "sdirk5"]
    )
    assert len(found.rows) == 3 * 2 * 2
    exact = aside(321, 1e-3, "sdirk5")
    assert np.abs(exact).max() > 0.04
    for row in found.rows:
        error = np.abs(aside(row.nodes, row.step, row.stepper) - exact).max()
        assert row.error == pytest.approx(error, abs=row.reference_error)
    assert max(row.reference_error for row in found.rows) < 1e-4
    errors = [rows_of(found, nodes=n)[0].space_error for n in (11, 21, 41)]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.4)


def test_space_errors_are_of_second_order_and_do_not_hang_on_the_step(found):
    errors = [rows_of(found, nodes=n)[0].space_error for n in (11, 21, 41)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.4)
    for nodes, error in zip((11, 21, 41), errors, strict=True):
        assert {row.space_error for row in rows_of(found, nodes=nodes)} == {error}


@pytest.mark.parametrize(("stepper", "order"), [("implicit_euler", 1), ("tr_bdf2", 2)])
def test_time_errors_have_the_order_of_the_stepper(found, stepper, order):
    errors = [
        rows_of(found, nodes=11, stepper=stepper, step=step)[0].time_error
        for step in (0.01, 0.005, 0.0025)
    ]
    assert np.log2(errors[0] / errors[2]) / 2 == pytest.approx(order, abs=0.4)


def test_unstable_steps_are_rows_with_a_status_and_a_note(found):
    for row in rows_of(found, stepper="explicit_euler", nodes=41):
        assert row.status == "unstable"
        assert math.isnan(row.error)
        assert math.isnan(row.cpu_seconds)
    assert any("41 nodes, explicit_euler: unstable" in note for note in found.notes)


def test_reference_states_an_error_below_those_that_it_judges(found):
    for row in rows_of(found, status="completed"):
        assert 0.0 < row.reference_error < 0.5 * row.error


def test_explicit_steppers_find_their_stable_step(sagging):
    explicit = der.study(sagging, nodes=[11, 21], steppers=["verlet"])
    for nodes in (11, 21):
        rows = rows_of(explicit, nodes=nodes)
        assert [row.status for row in rows][-2:] == ["completed", "completed"]
        assert rows[0].status == "unstable"
        assert rows[-1].step == pytest.approx(rows[-2].step / 2)


@pytest.mark.parametrize("step", [1e-5, "auto"])
def test_implicit_steps_of_an_explicit_scene_are_not_bound_by_its_stability(sagging, step):
    sagging["time"] |= {"step": step, "integrator": "verlet"}
    found = der.study(sagging, nodes=[11], steppers=["tr_bdf2", "verlet"])
    steps = [row.step for row in rows_of(found, stepper="tr_bdf2")]
    assert max(steps) == pytest.approx(0.3 / 50, rel=0.5)
    assert min(steps) < 0.3 / 500
    assert len(rows_of(found, stepper="verlet", status="completed")) == 2
    good = [row for row in rows_of(found, stepper="tr_bdf2") if row.claimed_error <= 1e-2]
    assert max(row.step for row in good) > 10 * max(
        row.step for row in rows_of(found, stepper="verlet", status="completed")
    )


def test_static_scene_varies_the_mesh(sagging):
    sagging["analysis"] = "static"
    del sagging["time"], sagging["output"]["every"]
    found = der.study(sagging)
    assert [row.nodes for row in found.rows] == [6, 11, 21, 41]
    orders = np.log2([a.error / b.error for a, b in zip(found.rows, found.rows[1:], strict=False)])
    assert orders[1:] == pytest.approx([2.0, 2.0], abs=0.3)
    assert found.rows[0].configuration == "6 nodes"
    with pytest.raises(ValueError, match="static"):
        der.study(sagging, steps=[0.1])


@pytest.fixture
def column(sagging):
    """A pinned column; buckles at (k pi)^2 N: with 10 elements at 9.79 and 38.2 N, with 20 at 9.849
    and 39.15, with 40 at 9.8646 and 39.40."""
    sagging["rods"][0]["cross_section"] = {
        "stiffness": {"EA": 1e8, "EI": 1, "mass_per_length": 0.1}
    }
    del sagging["rods"][0]["material"], sagging["time"], sagging["output"]["every"]
    sagging["loads"] = [{"point_force": {"rod": "arm", "at": "end", "force": [-1, 0]}}]
    sagging["output"]["probes"] = {"end_x": {"rod": "arm", "at": "end", "quantity": "x"}}
    return sagging


def test_a_path_is_compared_by_its_events(column):
    column["analysis"] = {"continuation": {"to": 20, "branches": 1, "points": 40}}
    found = der.study(column, nodes=[11, 21, 41])
    assert found.probes == ["factor, bifurcation 1", "end_x, bifurcation 1", "end_x, end"]
    for row in found.of("factor, bifurcation 1"):
        exact = np.pi**2
        with_nodes = der.Scenario.from_dict(column).with_(**{"rods.arm.nodes": row.nodes})
        path = der.run(with_nodes).path
        error = exact - path.factor[path.rows("bifurcation")[0]]
        assert row.error == pytest.approx(error, rel=0.01)
        assert row.reference_error < 0.01 * row.error
    assert found.notes == ()
    assert "end_x, end: exact in every configuration" in found.advice()
    found.plot()


def test_a_mesh_with_other_events_is_told_apart(column):
    column["analysis"] = {"continuation": {"to": 39}}
    found = der.study(column, nodes=[11, 21])
    rows = found.of("factor, bifurcation 1")
    assert [(row.nodes, row.status) for row in rows] == [(11, "unmatched"), (21, "completed")]
    assert math.isnan(rows[0].error)
    assert not math.isnan(rows[0].cpu_seconds)
    assert found.notes == (
        "bifurcation: 2 with 11 nodes, 1 with 21 nodes, 1 with 41 nodes, 1 with 81 nodes; "
        "which are the same is not known",
    )
    assert {row.status for row in found.of("end_x, end")} == {"completed"}


def test_events_that_the_reference_does_not_agree_on_are_left_out(column):
    column["analysis"] = {"continuation": {"to": 9.86}}
    found = der.study(column, nodes=[11, 21])
    assert found.probes == ["end_x, end"]
    assert found.notes[0].startswith("left out: bifurcation: 1 with 11 nodes, 1 with 21 nodes, 0")
    column["analysis"]["continuation"]["points"] = 2
    with pytest.raises(ValueError, match="nothing can be compared"):
        der.study(column, nodes=[11, 21])


@pytest.mark.parametrize("analysis", ["modes", "buckling"])
def test_frequencies_and_buckling_loads_are_compared(column, analysis):
    column["analysis"] = {analysis: {"count": 2}}
    del column["output"]
    found = der.study(column, nodes=[11, 21, 41])
    name = {"modes": "frequency", "buckling": "load factor"}[analysis]
    assert found.probes == [f"{name} 1", f"{name} 2"]
    bending = np.pi * np.array([1, 2])
    exact = {
        "modes": np.sqrt((bending**4 - bending**2) / 0.1) / (2 * np.pi),
        "buckling": bending**2,
    }[analysis]
    for probe, value in zip(found.probes, exact, strict=True):
        for row in found.of(probe):
            with_nodes = der.Scenario.from_dict(column).with_(**{"rods.arm.nodes": row.nodes})
            result = der.run(with_nodes)
            ours = {
                "modes": lambda r: r.modes.frequencies,
                "buckling": lambda r: r.buckling.load_factors,
            }[analysis](result)[int(probe[-1]) - 1]
            assert row.error == pytest.approx(abs(ours - value), rel=0.05, abs=1e-6)


def test_mesh_that_is_part_of_the_model(spheres):
    spheres["time"]["duration"] = 0.2
    found = der.study(spheres, steppers=["implicit_euler"], steps=[0.02, 0.01])
    assert {row.nodes for row in found.rows} == {3}
    assert "angle" in found.probes  # comparable, with a single mesh
    assert all(row.space_error == 0.0 for row in found.rows)
    with pytest.raises(ValueError, match="no other number of nodes"):
        der.study(spheres, nodes=[5])


def test_a_scene_that_starts_from_a_run_keeps_its_mesh(sagging, tmp_path):
    der.run(sagging, out=tmp_path / "first")
    sagging["start_from"] = str(tmp_path / "first")
    found = der.study(sagging, nodes=[11], steppers=["tr_bdf2"], steps=[0.01, 0.005])
    assert [(row.nodes, row.status) for row in found.rows] == [(11, "completed")] * 2
    assert found.notes[0].startswith("nodes are not varied: it starts from ")
    with pytest.raises(ValueError, match=r"than its own, 11: it starts from .*first.*leave nodes"):
        der.study(sagging, nodes=[21])


def test_turning_angles_are_left_out_of_several_meshes(sagging):
    sagging["output"]["probes"]["angle"] = {
        "rod": "arm",
        "at": "middle",
        "quantity": "turning_angle",
    }
    found = der.study(sagging, nodes=[11, 21], steps=[0.01], steppers=["tr_bdf2"])
    assert found.probes == ["sag"]
    assert any("'angle' is left out" in note for note in found.notes)
    del sagging["output"]["probes"]["sag"]
    with pytest.raises(ValueError, match="no probe"):
        der.study(sagging)


def test_runs_that_would_take_too_long_are_skipped_by_name(sagging):
    found = der.study(sagging, nodes=[11], steps=[0.01], steppers=["tr_bdf2"], max_seconds=1e-9)
    assert [row.status for row in found.rows] == ["skipped"]
    assert any("tr_bdf2: skipped" in note for note in found.notes)
    assert found.advice() == ["sag: no configuration of this study is close enough: refine more"]
    found.plot()  # with nothing to draw


def test_every_stepper_has_a_colour_and_a_marker_of_its_own(found):
    names = [info.name for info in der.steppers()]
    rows = rows_of(found, stepper="tr_bdf2")
    pretended = [dataclasses.replace(row, stepper=name) for name in names for row in rows]
    figure = dataclasses.replace(found, rows=tuple(pretended)).plot()
    lines = {line.get_label(): line for line in figure.axes[0].get_lines()}
    assert set(names) <= set(lines)
    assert len({lines[name].get_color() for name in names}) == len(names)
    assert len({lines[name].get_marker() for name in names}) == len(names)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"steppers": ["rk4"]}, "rk4"),
        ({"steps": [0.0]}, "step"),
        ({"steps": [1.0]}, "duration"),
        ({"steps": [0.01, 0.00912345]}, "common multiple"),
        ({"nodes": [1]}, "2 nodes"),
        ({"nodes": []}, "nodes must be a list with at least one entry"),
        ({"nodes": 11}, "nodes must be a list"),
        ({"nodes": [11.5]}, "whole numbers, such as 21, got 11.5"),
        ({"steps": []}, "steps must be a list with at least one entry"),
        ({"steps": [math.nan]}, "steps must be finite numbers greater than 0"),
        ({"steppers": []}, "steppers must be a list with at least one entry"),
        ({"steppers": "tr_bdf2"}, r"such as \['tr_bdf2'\], got 'tr_bdf2'"),
        ({"max_seconds": 0}, "max_seconds must be a number greater than 0, such as 2, got 0"),
        ({"max_seconds": -1.0}, "max_seconds"),
        ({"max_seconds": math.nan}, "max_seconds"),
        ({"jobs": 1.5}, "jobs must be a whole number of at least 1, got 1.5"),
    ],
)
def test_wrong_arguments(sagging, options, words):
    with pytest.raises((ValueError, TypeError), match=words):
        der.study(sagging, **options)


def test_intervals_at_which_runs_are_compared(sagging):
    base = der.run(sagging)  # frames every 5 ms
    assert common_interval(0.002, 0.005) == pytest.approx(0.01)
    assert common_interval(0.001, 0.005) == pytest.approx(0.005)
    assert common_interval(0.02, 0.005) == pytest.approx(0.02)
    assert reference_interval(base, [0.01, 0.005, 0.002]) == pytest.approx(0.005)
    assert reference_interval(base, [0.02, 0.01]) == pytest.approx(0.01)
    assert reference_step(0.02, 0.01) == pytest.approx(0.01)
    assert reference_step(0.003, 0.005) == pytest.approx(0.0025)
    assert reference_step(0.001, 0.005) == pytest.approx(0.001)


def test_default_steps_reach_the_frames_of_the_scene(sagging):
    """Frames every 20 ms and a step of 4 ms: four times that reaches every fourth of them only."""
    sagging["time"]["step"] = 0.004
    sagging["output"]["every"] = 0.02
    assert choose_steps(der.run(sagging), None) == pytest.approx(
        [0.02, 0.01, 0.004, 0.002, 0.001, 0.0005]
    )
    sagging["output"]["every"] = 0.004
    assert choose_steps(der.run(sagging), None) == pytest.approx(
        [0.016, 0.008, 0.004, 0.002, 0.001, 0.0005]
    )


def test_errors_are_those_at_the_frames_of_an_advised_run(sagging):
    """The claimed errors hold at every frame that a run of the configuration can save."""
    sagging["time"] |= {"duration": 0.31, "step": 0.004}  # 0.31 s is not a multiple of 20 ms
    sagging["output"]["every"] = 0.02
    steps = [0.02, 0.015, 0.01, 0.005]
    found = der.study(sagging, nodes=[11, 21], steps=steps, steppers=["tr_bdf2"])
    exact = der.Scenario.from_dict(sagging).with_(
        **{"rods.arm.nodes": 321, "time.step": 2.5e-4, "output.every": 0.02}
    )
    exact = der.run(exact)
    for row in found.rows:
        assert row.interval == pytest.approx(0.06 if row.step == 0.015 else 0.02)
        changed = der.Scenario.from_dict(sagging).with_(
            **{
                "rods.arm.nodes": row.nodes,
                "time.step": row.step,
                "time.integrator": row.stepper,
                "output.every": row.interval,
            }
        )
        run = der.run(changed)
        right = np.interp(run.times, exact.times, np.asarray(exact.probes["sag"]))
        worst = np.max(np.abs(np.asarray(run.probes["sag"]) - right))
        assert row.error == pytest.approx(worst, rel=0.1, abs=2e-5)
    assert found.notes[0] == (
        "errors are measured every 20 ms, as the scene saves frames, or where a step does not "
        "reach all of these: with 15 ms every 60 ms"
    )


def test_default_meshes_leave_out_what_the_scene_cannot_take(tube):
    tube["supports"].append({"rod": "beam", "at": {"node": 5}, "fix": ["y"]})
    meshes = choose_meshes(der.Scenario.from_dict(tube), None)
    assert [mesh.nodes for mesh in meshes] == [21, 41, 81]


# Conclusions from the numbers.


def row(nodes, cpu_seconds, error, space=0.0, time=0.0, reference=1e-9):
    return StudyRow(
        "sag", "m", nodes, "tr_bdf2", 4e-3, "completed", cpu_seconds, error, space, time, reference
    )


@pytest.fixture
def made(sagging):
    rows = (
        row(11, 0.001, 3e-2),
        row(21, 0.004, 2e-3),
        row(41, 0.012, 4e-4),
        row(81, 0.002, 1e-4, space=5e-3, time=5.1e-3),  # good by luck
        row(161, 0.1, 1e-7, reference=2e-6),  # better than anyone can tell
    )
    return Study(der.Scenario.from_dict(sagging), rows, {"sag": 0.5}, ())


def test_cheapest_does_not_count_on_luck(made):
    assert made.cheapest("sag", 1e-3).nodes == 41
    assert made.cheapest("sag", 1e-2).nodes == 81


def test_errors_below_the_reference_are_not_claimed(made):
    assert made.cheapest("sag", 2e-6).nodes == 161
    assert made.cheapest("sag", 1e-6) is None


def test_advice(made):
    lines = made.advice()
    assert "sag: for 0.001 m (0.2 %): 41 nodes, tr_bdf2, 4 ms: 12 ms" in lines
    assert [line.split()[2] for line in lines] == ["0.1", "0.01", "0.001", "0.0001", "1e-05"]
    assert made.advice([1e-7]) == ["sag: for 1e-07 m (2e-05 %): no configuration of this study"]


def test_errors_of_a_probe_that_hardly_moves_are_set_against_its_magnitude(sagging):
    """From its equilibrium the sag moves by rounding; meshes still tell it differently."""
    sagging["start_from"] = "equilibrium"
    found = der.study(sagging, nodes=[11, 21], steps=[0.01, 0.005], steppers=["tr_bdf2"])
    sag = der.run(sagging).probes["sag"].summary["final"]
    assert found.sizes["sag"] == pytest.approx(abs(sag), rel=0.05)
    lines = found.advice()
    assert lines[0].startswith("sag: for ")
    assert " nodes, tr_bdf2, " in lines[0]  # of which mesh depends on times
    assert not any("no configuration" in line for line in lines)
    share = float(found.advice([0.01])[0].split("(")[1].split(" %")[0])
    assert share == pytest.approx(100 * 0.01 / found.sizes["sag"], rel=0.1)


def test_a_probe_that_is_off_by_rounding_counts_as_exact(spheres):
    """Equal spheres fall alike: the rod stays straight, its turning angle zero but for rounding."""
    for sphere in spheres["rods"][0]["spheres"]:
        sphere["at"] = "all"
    spheres["time"]["duration"] = 0.5
    found = der.study(spheres, steppers=["tr_bdf2"], steps=[0.05, 0.025])
    rows = found.of("angle")
    assert 0.0 < max(row.claimed_error for row in rows) < 1e-13
    assert "angle: exact in every configuration" in found.advice()
    assert "%" not in found.advice([0.01])[found.probes.index("angle")]


def test_no_advice_below_rounding(made):
    noisy = dataclasses.replace(made, noise={"sag": 1e-4})
    assert [line.split()[2] for line in noisy.advice()] == ["0.1", "0.01", "0.001"]


def test_seconds_text():
    assert [seconds_text(s) for s in (1.5, 0.012, 4e-6)] == ["1.5 s", "12 ms", "4 µs"]


def test_extrapolation_in_space_knows_its_error():
    """Values 1 + h^2 + 10 h^4 at h = 1/8, 1/16, 1/32."""
    meshes = [
        Reference({"p": np.array([1.0 + h**2 + 10 * h**4])}, {"p": 0.0})
        for h in (1 / 8, 1 / 16, 1 / 32)
    ]
    found = converge_in_space(meshes)
    error = abs(found.probes["p"][0] - 1.0)
    assert 0.0 < error <= found.errors["p"] < 1e-2 * (1 / 32) ** 2 * 100


# Running many.


def test_workers_keep_failures_and_try_the_next_scenario(sagging, unstable):
    good, bad = der.Scenario.from_dict(sagging), der.Scenario.from_dict(unstable)
    outcomes = Workers(2).run(
        {"bad": Task([bad]), "rescued": Task([bad, good]), "slim": Task([good], keep_motion=False)}
    )
    assert isinstance(outcomes["bad"].error, der.DerError)
    with pytest.raises(der.DerError):
        outcomes["bad"].value()
    assert outcomes["rescued"].error is None
    assert outcomes["slim"].value().positions.shape == (0, 11, 2)
    assert outcomes["slim"].cpu_seconds > 0.0


def test_a_run_that_takes_too_long_is_broken_off(sagging):
    sagging["time"] |= {"duration": 1e6, "step": 1e-3}
    sagging["output"]["every"] = 1e6
    task = Task([der.Scenario.from_dict(sagging)], max_seconds=0.05)
    outcome = Workers(1).run({0: task})[0]
    assert outcome.error.status == "too_long"
    assert 0.05 < outcome.cpu_seconds < 1.0


def test_an_interrupt_stops_the_other_runs(sagging, monkeypatch):
    """One run ends with Ctrl-C; the other, endless one stops at its next tick."""
    sagging["time"] |= {"duration": 1e6, "step": 1e-3}
    sagging["output"]["every"] = 1e6
    endless = der.Scenario.from_dict(sagging)

    def interrupted(scenario, *rest, **options):
        if scenario is not endless:
            raise KeyboardInterrupt
        return attempt(scenario, *rest, **options)

    monkeypatch.setattr("der.parallel.attempt", interrupted)
    with pytest.raises(KeyboardInterrupt):
        Workers(2).run({0: Task([der.Scenario.from_dict(SAGGING)], weight=1), 1: Task([endless])})


def test_progress_counts_what_is_guessed_to_come(sagging):
    seen = []
    workers = Workers(1, seen.append)
    task = Task([der.Scenario.from_dict(sagging)], weight=1.0, repeats=2)
    workers.expect(1.0, later=3.0)
    workers.run({0: task})
    assert 0.0 < seen[0] < 0.125 < seen[-1] == pytest.approx(0.25)  # two equal halves
    workers.expect(1.0)
    workers.run({0: task})
    assert seen[-1] == pytest.approx(1.0)


def study_of_few(scene, progress):
    der.study(scene, nodes=[11, 21], steppers=["tr_bdf2", "verlet"], progress=progress)


def verify_implicit(scene, progress):
    der.verify(scene, jobs=1, progress=progress)


def verify_explicit(scene, progress):
    scene["time"] |= {"integrator": "verlet", "step": 2.5e-4}
    der.verify(scene, jobs=1, progress=progress)


def study_of_static(scene, progress):
    del scene["time"], scene["output"]["every"]
    der.study(scene | {"analysis": "static"}, nodes=[11, 21], progress=progress)


@pytest.mark.parametrize(
    "measure", [study_of_few, verify_implicit, verify_explicit, study_of_static]
)
def test_progress_is_told_from_the_start_and_full_only_at_the_end(sagging, monkeypatch, measure):
    seen, after = [], []
    original = Workers.run

    def run(self, *arguments, **options):
        outcomes = original(self, *arguments, **options)
        after.append(seen[-1] if seen else None)
        return outcomes

    monkeypatch.setattr(Workers, "run", run)
    measure(sagging, seen.append)
    assert 0.0 < after[0] < 0.2  # the scene as written, of which all other runs are multiples
    assert max(after[:-1]) < 0.95
    assert after[-1] == pytest.approx(1.0)


# The command.


def test_command_writes_table_and_picture(sagging, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.yaml").write_text(der.Scenario.from_dict(sagging).to_yaml())
    options = ["--nodes", "11", "21", "--steps", "0.01", "0.005", "--errors", "0.1"]
    assert main(["study", "arm.yaml", *options, "--steppers", "tr_bdf2", "implicit_euler"]) == 0
    printed = capsys.readouterr()
    assert printed.out.splitlines()[-2:] == ["arm_study/study.csv", "arm_study/study.png"]
    assert "sag: for 0.1 m" in printed.out
    assert printed.err == ""
    with (tmp_path / "arm_study" / "study.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 8
    assert float(rows[0]["error"]) > 0.0
    assert rows[0]["unit"] == "m"
    picture = imread(tmp_path / "arm_study" / "study.png")
    assert len({tuple(pixel) for pixel in picture.reshape(-1, 4)}) > 50


def test_command_with_a_wrong_argument(sagging, tmp_path, capsys):
    path = tmp_path / "arm.yaml"
    path.write_text(der.Scenario.from_dict(sagging).to_yaml())
    assert main(["study", str(path), "--steppers", "rk4"]) == 1
    assert "rk4" in capsys.readouterr().err


@pytest.mark.parametrize("errors", [[], [-1.0], [0.0], [math.nan], [math.inf], 0.1])
def test_errors_without_meaning_are_refused(made, errors):
    with pytest.raises(ValueError, match="errors must be"):
        made.advice(errors)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--errors", "nan"], "errors must be finite numbers greater than 0"),
        (["--max-seconds", "0"], "max_seconds must be a number greater than 0"),
        (["--out", "taken"], "'taken' is a file, and results go to a folder"),
        (["--out", "taken/study"], "'taken' is a file"),
    ],
)
def test_command_refuses_before_any_run(sagging, tmp_path, capsys, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Workers, "run", lambda *_, **__: pytest.fail("it ran"))
    (tmp_path / "taken").write_text("")
    (tmp_path / "arm.yaml").write_text(der.Scenario.from_dict(sagging).to_yaml())
    assert main(["study", "arm.yaml", *options]) == 1
    assert words in capsys.readouterr().err
