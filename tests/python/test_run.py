"""Whole runs: what is recorded, how they stop and fail, and the run folder."""

import dataclasses
import json
import os
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path

import der
import h5py
import numpy as np
import pytest


def test_result_holds_what_the_scene_asks_for(tube):
    result = der.run(der.Scenario.from_dict(tube))
    assert result.status == "completed"
    assert result.times == pytest.approx(np.arange(0.0, 0.501, 0.02))
    assert result.steps.tolist() == list(range(0, 51, 2))
    assert result.positions.shape == result.velocities.shape == (26, 21, 2)
    assert set(result.energies) == {"kinetic", "stretch", "bend", "spring", "gravity"}
    assert all(values.shape == (26,) for values in result.energies.values())
    assert set(result.work) == {"loads", "supports", "actuation", "drag", "numerical", "solver"}
    assert all(values.shape == (26,) for values in result.work.values())
    assert list(result.probes) == ["deflection", "roller"]
    assert result.probes["roller"] == pytest.approx(result.positions[:, -1, 0])
    assert [rod.name for rod in result.rods] == ["beam"]
    assert result.scenario.title == result.summary["title"]
    assert "26 frames of 21 nodes" in repr(result)


def test_summary_is_that_of_the_program(tube):
    tube["output"]["every"] = 0.05
    result = der.run(tube)
    summary = result.summary
    keys = {"status", "model", "integrator", "linear_solver", "steps", "newton_iterations"}
    assert keys | {"wall_seconds", "probes"} <= set(summary)
    assert summary["steps"] == 50
    deflection = summary["probes"]["deflection"]
    assert {"final", "min", "max", "t_min", "t_max"} <= set(deflection)
    assert deflection["final"] == result.probes["deflection"][-1]
    # Between the saved frames the beam swings further than in any of them.
    assert deflection["min"] < result.probes["deflection"].min()


@pytest.mark.parametrize("scene", ["cantilever", "beam_modes", "snap_through_arch"])
def test_summary_is_the_content_of_its_file(scene, tmp_path):
    """In its order, and with whole numbers, texts and truth values as they are there."""
    file = Path(__file__).resolve().parents[2] / f"configs/{scene}.yaml"
    result = der.run(file, out=tmp_path / "run")
    text = (tmp_path / "run/summary.json").read_text(encoding="utf-8")
    assert json.dumps(result.summary) == json.dumps(json.loads(text))


def test_equal_steps_over_close_entries_of_a_table_are_warned_of_by_name(swing):
    ramp = {
        "times": [0, 0.5, 0.5004, 7, 7.0001],
        "values": [[0, 0], [0, 0], [0, 1], [0, 1], [0, 0]],
    }
    slow = {"times": [0, 0.1], "values": [0, 0.01]}
    swing["supports"][0]["prescribe"] = {"x": slow}
    swing["loads"].append({"point_force": {"rod": "arm", "at": "end", "force": ramp}})
    swing["time"] = {"duration": 0.6, "step": 1e-3}
    [warning] = der.run(swing).summary["warnings"]
    assert "loads.1.point_force.force" in warning
    assert "0.5 and 0.5004 s" in warning
    assert "step of 0.001 s" in warning
    assert "time.tolerance" in warning
    swing["time"]["step"] = 2e-4
    assert der.run(swing).summary["warnings"] == []
    swing["time"] = {"duration": 0.6, "tolerance": 1e-2}
    assert der.run(swing).summary["warnings"] == []


def test_a_tolerance_that_takes_very_many_steps_says_why(swing):
    """The swing turns chaotic after 1.5 s and needs steps a hundred times shorter."""
    swing["time"] = {"duration": 3, "tolerance": 1e-3}
    swing["output"]["every"] = 0.5
    with pytest.warns(der.DerWarning, match="motion has grown rough") as caught:
        result = der.run(swing)
    assert caught[0].filename == __file__
    [hint] = result.summary["hints"]
    assert hint == str(caught[0].message)
    assert f"took {result.summary['steps']} steps" in hint
    assert "larger tolerance" in hint
    swing["time"]["duration"] = 0.5
    assert der.run(swing).summary["hints"] == []


def test_a_tolerance_that_is_small_throughout_says_so(swing):
    """Steps of order 1 fall in proportion to the tolerance, and all are alike."""
    swing["rods"][0]["nodes"] = 3
    swing["time"] = {"duration": 0.1, "tolerance": 3e-6, "integrator": "implicit_euler"}
    with pytest.warns(
        der.DerWarning, match=r"the whole duration of 0\.1 s .* 'integrator: sdirk5'"
    ):
        der.run(swing)


@pytest.mark.parametrize("course", ["kinked", "smooth", "sampled"])
def test_a_hint_names_the_kinks_of_supports_that_start_waves(swing, course):
    """Not a smooth table, nor straight pieces that sample a smooth motion."""
    times = [0, 0.05] if course != "sampled" else np.linspace(0, 0.05, 26).tolist()
    values = [0.02 * np.sin(10 * np.pi * t) ** 2 for t in times]
    table = {"times": times, "values": values, **({"smooth": True} if course == "smooth" else {})}
    swing["rods"][0]["nodes"] = 3
    swing["supports"][0]["prescribe"] = {"x": table}
    swing["time"] = {"duration": 0.1, "tolerance": 3e-6, "integrator": "implicit_euler"}
    with pytest.warns(der.DerWarning, match=r"time\.tolerance: 3e-06 took") as caught:
        der.run(swing)
    hint = str(caught[0].message)
    assert ("(supports.0.prescribe.x at 0 s)" in hint) == (course == "kinked")
    assert ("'smooth: true'" in hint) == (course == "kinked")
    assert ("equal steps (time.step) of tr_bdf2 or sdirk5" in hint) == (course == "kinked")
    if course == "kinked":
        assert "'integrator: sdirk5'" in hint


@pytest.mark.parametrize("smooth", [False, True])
def test_the_hint_of_kinks_comes_at_a_thousand_steps(swing, smooth):
    """The kinks start waves: fewer steps are all that a smooth table takes."""
    swing["rods"][0] |= {
        "nodes": 31,
        "cross_section": {"circle": {"radius": 0.01}},
        "material": {"youngs_modulus": 1e7, "density": 1100},
    }
    table = {"times": [0, 0.3, 0.6, 1], "values": [0, 0.1, 0.1, 0], "smooth": smooth}
    swing["supports"] = [
        {"rod": "arm", "at": "start", "clamp": True},
        {"rod": "arm", "at": "end", "clamp": True, "prescribe": {"y": table}},
    ]
    swing["loads"] = []
    swing["time"] = {"duration": 1, "tolerance": 1e-3}
    with warnings.catch_warnings(record=True):
        warnings.simplefilter("always")
        summary = der.run(swing).summary
    assert (summary["steps"] > 1000) == (not smooth)
    assert any("(supports.1.prescribe.y at" in hint for hint in summary["hints"]) == (not smooth)


def test_probes_know_their_unit_and_summary(spheres):
    result = der.run(spheres)
    speed = result.probes["v_mid"]
    assert speed.unit == "m/s"
    assert result.probes["angle"].unit == "rad"
    assert speed.summary == result.summary["probes"]["v_mid"]
    assert speed[10:].unit == "m/s"
    for computed in (2 * speed, speed.max(), np.mean(speed), speed**2):
        assert not hasattr(computed, "unit"), "the unit of what is computed is another"
    copy = pickle.loads(pickle.dumps(speed))
    assert (copy.unit, copy.summary) == (speed.unit, speed.summary)
    assert np.array_equal(copy, speed)


def test_result_can_be_pickled(tube):
    result = der.run(tube)
    copy = pickle.loads(pickle.dumps(result))
    assert np.array_equal(copy.positions, result.positions)
    assert copy.summary == result.summary
    assert copy.rods[0].name == "beam"


def test_callback_sees_every_step_and_can_stop(swing):
    scenario = der.Scenario.from_dict(swing)
    seen = []

    def watch(simulation):
        seen.append((simulation.step_count, simulation.positions[-1, 1]))
        return simulation.step_count < 33

    result = der.run(scenario, callback=watch)
    assert [step for step, _ in seen] == list(range(1, 34))
    assert result.status == "stopped"
    assert result.steps[-1] == 33, "the last instant is recorded"
    assert result.probes["tip"][-1] == seen[-1][1]


@pytest.mark.parametrize(
    ("answer", "status"),
    [
        (None, "completed"),
        (True, "completed"),
        (np.True_, "completed"),
        (False, "stopped"),
        (np.False_, "stopped"),
    ],
)
def test_what_a_callback_may_answer(swing, answer, status):
    assert der.run(swing, callback=lambda _: answer).status == status


def test_callback_can_control(swing):
    def hold_tip_up(simulation):
        simulation.extra_force[-1, 1] = 5.0 if simulation.positions[-1, 1] < 0.0 else 0.0

    free = der.run(swing)
    controlled = der.run(swing, callback=hold_tip_up)
    assert controlled.probes["tip"][-1] > free.probes["tip"][-1] + 0.1


def test_callback_errors_pass_through(swing):
    simulation = der.Simulation(der.Scenario.from_dict(swing))

    def fail(simulation):
        if simulation.step_count == 5:
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        simulation.run(fail)
    assert simulation.step_count == 5
    assert simulation.run().status == "completed", "and the simulation can go on"


def test_callback_must_not_step(swing):
    with pytest.raises(RuntimeError, match="busy"):
        der.run(swing, callback=lambda simulation: simulation.step())


def test_run_until_and_on(swing):
    scenario = der.Scenario.from_dict(swing)
    simulation = der.Simulation(scenario)
    first = simulation.run(until=0.1)
    assert first.status == "stopped"
    assert simulation.time == pytest.approx(0.1)
    assert first.times == pytest.approx(np.arange(0.0, 0.101, 0.01))
    second = simulation.run()
    assert second.status == "completed"
    assert second.times[0] == first.times[-1]
    whole = der.run(scenario)
    joined = np.concatenate([first.positions, second.positions[1:]])
    assert np.array_equal(joined, whole.positions)


@pytest.mark.parametrize("until", [-1.0, 0.05, 0.3, float("nan")])
def test_until_outside_of_the_scene(swing, until):
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    simulation.step(50)
    with pytest.raises(ValueError, match="until"):
        simulation.run(until=until)


def test_static_scene(tube):
    del tube["time"], tube["output"]["every"]
    result = der.run({**tube, "analysis": "static"})
    assert result.status == "static_converged"
    assert result.positions.shape == (1, 21, 2)
    assert np.all(result.velocities == 0.0)
    assert result.summary["unstable_directions"] == 0
    simulation = der.Simulation(result.scenario)
    with pytest.raises(ValueError, match="static"):
        simulation.run(until=1.0)


def test_equilibrium_of_static_and_of_moving_scenes(tube):
    of_moving = der.equilibrium(tube)
    assert of_moving.status == "static_converged"
    del tube["time"], tube["output"]["every"]
    of_static = der.equilibrium({**tube, "analysis": "static"})
    assert np.array_equal(of_moving.positions, of_static.positions)
    settled = der.run({**tube, "time": {"duration": 2, "step": 0.01}})
    assert settled.positions[-1] == pytest.approx(of_static.positions[-1], abs=1e-7)


def test_equilibrium_takes_tables_at_time_0(tube):
    tube["supports"][0] = {
        "rod": "beam",
        "at": "start",
        "clamp": True,
        "prescribe": {"angle": {"times": [-1, 1], "values": [0, 0.2]}},
    }
    load = tube["loads"][0]["point_force"]
    load["force"] = {"times": [0, 1], "values": [[0, -100], [0, -200]]}
    tube["start_from"] = "equilibrium"
    found = der.equilibrium(tube)
    started = der.Simulation(tube)  # which starts in the same equilibrium
    assert found.positions[0] == pytest.approx(started.positions, abs=1e-9)
    tube["supports"][0]["prescribe"]["angle"] = 0.1
    load["force"] = [0, -100]
    assert np.array_equal(found.positions, der.equilibrium(tube).positions)


def test_continuation_takes_tables_at_time_0(tube):
    tube["loads"][0]["point_force"]["force"] = {"times": [0, 1], "values": [[0, -100], [0, -200]]}
    tube["start_from"] = "equilibrium"
    last = der.continuation(tube, to=2).probes["deflection"][-1]
    tube["loads"][0]["point_force"]["force"] = [0, -200]
    assert last == pytest.approx(der.equilibrium(tube).probes["deflection"][-1], rel=1e-6)


def test_everything_takes_a_scenario_a_path_or_a_dict(tube, tmp_path):
    tube["time"] |= {"duration": 0.1}
    scenario = der.Scenario.from_dict(tube)
    path = tmp_path / "tube.yaml"
    path.write_text(scenario.to_yaml())
    for scene in (scenario, path, str(path), tube):
        simulation = der.Simulation(scene)
        simulation.step(10)
        assert np.array_equal(simulation.positions, der.run(scene).positions[-1])
        assert der.equilibrium(scene).status == "static_converged"
    with pytest.raises(TypeError):
        der.Simulation(3)


def test_a_failed_run_raises_with_what_it_recorded(unstable):
    with pytest.raises(der.DivergedError) as caught:
        der.run(unstable)
    result = caught.value.result
    assert result.status == caught.value.status == "diverged"
    assert len(result.times) > 1
    assert np.all(np.isfinite(result.positions))
    assert str(caught.value) == result.summary["failure"]["message"]
    unchecked = der.run(unstable, check=False)
    assert unchecked.status == "diverged"
    assert np.array_equal(unchecked.positions, result.positions)


@pytest.mark.parametrize("stiffness", ["EI", "EA"])
def test_a_stiffness_beyond_the_numbers_ends_the_search(stiffness):
    """Per edge 1e308 is infinite: no search for a start of another one goes on without end."""
    rod = {"name": "rod", "nodes": 9, "from": [0, 0], "to": [1, 0]}
    stiffnesses = {"EA": 3000, "EI": 0.08, "mass_per_length": 0.3, stiffness: 1e308}
    scene = {
        "rods": [{**rod, "cross_section": {"stiffness": stiffnesses}}],
        "supports": [{"rod": "rod", "at": "start", "clamp": True}],
        "loads": [{"gravity": [0, -1]}],
        "analysis": "static",
    }
    with pytest.raises(der.NotConvergedError, match="no stable equilibrium found"):
        der.run(scene)


def test_no_equilibrium_raises(swing):
    swing["supports"] = []
    with pytest.raises(der.NotConvergedError) as caught:
        der.equilibrium(swing)
    assert caught.value.result.positions.shape[0] == 0


def test_progress_is_told_as_it_goes(swing):
    told = []
    der.run(swing, callback=slowly, progress=told.append)
    assert len(told) >= 2
    assert told == sorted(told)
    assert told[0] >= 0.0
    assert told[-1] <= 1.0


def slowly(simulation):
    time.sleep(0.002)


def test_progress_line_is_wiped_out(swing, capsys, monkeypatch):
    monkeypatch.setattr("der.progress.ProgressLine.delay", 0.0)
    der.run(swing, callback=slowly, progress=True)
    lines = capsys.readouterr().err.split("\r")
    assert any(re.fullmatch(r"[ \d]{3} % \[#*-*\]  \d+ s left *", line) for line in lines)
    assert lines[-1] == ""
    assert lines[-2].strip() == ""


def test_short_runs_show_no_progress_line(swing, capsys):
    der.run(swing, progress=True)
    assert capsys.readouterr().err == ""


def assert_same(first, second):
    assert second.scenario.to_dict() == first.scenario.to_dict()
    assert second.summary == first.summary
    for name in ("times", "steps", "positions", "velocities"):
        one, other = getattr(first, name), getattr(second, name)
        assert np.array_equal(one, other)
        assert one.dtype == other.dtype
    assert second.energies.keys() == first.energies.keys()
    assert second.work.keys() == first.work.keys()
    for part in ("energies", "work"):
        for name, values in getattr(first, part).items():
            assert np.array_equal(getattr(second, part)[name], values), name
    assert list(second.probes) == list(first.probes)
    for name, probe in first.probes.items():
        assert np.array_equal(second.probes[name], probe)
        assert second.probes[name].unit == probe.unit
        assert second.probes[name].summary == probe.summary


def test_run_folder_reads_back(tube, tmp_path):
    result = der.run(tube, out=tmp_path / "run")
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == [
        "results.h5",
        "scene.yaml",
        "summary.json",
    ]
    assert_same(result, der.open_run(tmp_path / "run"))


def test_saved_result_reads_back(spheres, tmp_path):
    result = der.run(spheres)
    assert result.save(tmp_path / "saved") == tmp_path / "saved"
    assert_same(result, der.open_run(tmp_path / "saved"))
    der.open_run(tmp_path / "saved").save(tmp_path / "saved again")
    assert_same(result, der.open_run(tmp_path / "saved again"))


def layout(file):
    """Every item of a file but its checkpoint, with kind, shape and attributes."""
    items = {"/": {name: type(value).__name__ for name, value in file.attrs.items()}}

    def visit(name, item):
        if name.startswith("checkpoint"):
            return
        shape = item.shape if isinstance(item, h5py.Dataset) else None
        kind = item.dtype.kind if isinstance(item, h5py.Dataset) else None
        items[name] = (shape, kind, {n: str(v) for n, v in item.attrs.items()})

    file.visititems(visit)
    return items


def test_saved_result_has_the_layout_of_the_program(spheres, tmp_path):
    der.run(spheres, out=tmp_path / "run").save(tmp_path / "saved")
    with (
        h5py.File(tmp_path / "run" / "results.h5") as written,
        h5py.File(tmp_path / "saved" / "results.h5") as saved,
    ):
        assert layout(saved) == layout(written)
    for name in ("scene.yaml", "summary.json"):
        texts = [(tmp_path / folder / name).read_text() for folder in ("run", "saved")]
        loaded = [json.loads(text) for text in texts] if name.endswith("json") else texts
        assert loaded[0] == loaded[1]


def test_open_run_says_what_is_missing(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"results\.h5"):
        der.open_run(tmp_path)


@pytest.mark.parametrize(
    ("version", "advice"), [(99, "install a newer der"), (3, "run its scene again")]
)
def test_another_format_is_refused(tube, tmp_path, version, advice):
    der.run(tube, out=tmp_path / "run")
    with h5py.File(tmp_path / "run" / "results.h5", "r+") as file:
        file.attrs["format_version"] = np.int64(version)
    with pytest.raises(ValueError, match=f"format {version}.*{advice}"):
        der.open_run(tmp_path / "run")


def test_a_changed_number_is_seen(tube, tmp_path):
    der.run(tube, out=tmp_path / "run")
    with h5py.File(tmp_path / "run" / "results.h5", "r+") as file:
        file["positions"][7, 3, 1] += 1e-12
    with pytest.raises(ValueError, match=r"results\.h5' .* frame 7 is damaged"):
        der.open_run(tmp_path / "run")


def test_saving_replaces_runs_and_nothing_else(tube, tmp_path):
    result = der.run(tube)
    result.save(tmp_path / "run")
    killed = dataclasses.replace(result, summary={"status": "running"})
    for _ in range(2):
        killed.save(tmp_path / "run")
    assert der.open_run(tmp_path / "run").summary == killed.summary
    result.save(tmp_path / "run")
    (tmp_path / "run" / "results.h5").write_text("mine")
    with pytest.raises(der.DerError, match="would be replaced"):
        result.save(tmp_path / "run")
    assert (tmp_path / "run" / "results.h5").read_text() == "mine"


def test_arrays_that_do_not_fit_the_model_are_not_saved(tube, tmp_path):
    result = der.run(tube)
    for name in ("positions", "velocities", "steps"):
        wrong = dataclasses.replace(result, **{name: getattr(result, name)[1:]})
        with pytest.raises(ValueError, match=name):
            wrong.save(tmp_path / "run")
    wrong = dataclasses.replace(result, data={"modes/mine": np.zeros(3)})
    with pytest.raises(ValueError, match="run files have no array 'modes/mine'"):
        wrong.save(tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_folder_with_other_things_is_left_alone(tube, tmp_path):
    (tmp_path / "thesis.tex").write_text("important")
    with pytest.raises(der.DerError) as caught:
        der.run(tube, out=tmp_path)
    assert caught.value.status == "io_error"
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_other_threads_run_while_it_steps(swing):
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.002):
            ticks.append(time.monotonic())

    for act in (lambda: simulation.step(60_000), lambda: der.run(long_scene(swing))):
        thread = threading.Thread(target=tick)
        stop.clear()
        thread.start()
        start = time.monotonic()
        act()
        end = time.monotonic()
        stop.set()
        thread.join()
        during = [moment for moment in ticks if start < moment < end]
        assert len(during) > 0.1 * (end - start) / 0.002


def long_scene(swing, duration=120.0):
    return {**swing, "time": {"duration": duration, "step": 0.002}}


def test_two_threads_must_not_share_a_simulation(swing):
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    started = threading.Event()
    simulation.add_force(lambda t, x, v: (started.set(), np.zeros_like(x))[1])
    thread = threading.Thread(target=simulation.step, args=(20_000,))
    thread.start()
    started.wait()
    with pytest.raises(RuntimeError, match="two threads"):
        simulation.step()
    thread.join()
    assert simulation.step_count == 20_000


def test_two_simulations_step_at_the_same_time(swing):
    scenario = der.Scenario.from_dict(swing)
    simulations = [der.Simulation(scenario) for _ in range(4)]
    threads = [threading.Thread(target=s.step, args=(2000,)) for s in simulations]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for simulation in simulations[1:]:
        assert np.array_equal(simulation.positions, simulations[0].positions)


@pytest.mark.parametrize("way", ["step", "run"])
def test_ctrl_c_interrupts(swing, way):
    simulation = der.Simulation(der.Scenario.from_dict(long_scene(swing, 1e5)))
    # The deadline keeps a broken build from running for ever.
    total = 5_000_000
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    act = {"step": simulation.step, "run": lambda n: simulation.run(until=n * 0.002)}[way]
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        act(total)
    assert time.monotonic() - start < 5.0
    assert 0 < simulation.step_count < total
    before = simulation.step_count
    simulation.step()
    assert simulation.step_count == before + 1, "it can go on"


def test_an_interrupted_run_leaves_a_readable_folder(swing, tmp_path):
    scene = der.Scenario.from_dict(long_scene(swing, 1e4))
    scene_path = tmp_path / "scene.yaml"
    scene_path.write_text(scene.to_yaml())
    script = (
        "import sys, der\n"
        "print('ready', flush=True)\n"
        "der.run(sys.argv[1], out=sys.argv[2], callback=None)\n"
    )
    command = [sys.executable, "-c", script, str(scene_path), str(tmp_path / "run")]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as child:
        assert child.stdout.readline() == "ready\n"
        results = tmp_path / "run" / "results.h5"
        deadline = time.monotonic() + 30
        while time.monotonic() < deadline:
            if results.exists() and frames(tmp_path / "run") > 20:
                break
        child.send_signal(signal.SIGINT)
        _, errors = child.communicate(timeout=30)
    assert "KeyboardInterrupt" in errors
    result = der.open_run(tmp_path / "run")
    assert result.status == "running"
    assert len(result.times) > 20
    complete = der.Simulation(scene).run(until=float(result.times[-1]))
    assert np.array_equal(complete.positions[: len(result.times)], result.positions)


def frames(folder):
    """How many frames an unfinished run has saved by now."""
    try:
        return len(der.open_run(folder).times)
    except (FileNotFoundError, ValueError):
        return 0  # not there yet, or read in the middle of a write
