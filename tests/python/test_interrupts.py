"""Ctrl-C in long calls: it is answered at once, and leaves simulations as they were."""

import os
import signal
import subprocess
import sys
import time
from importlib.metadata import entry_points

import der
import numpy as np
import pytest
from der.sweeps.store import is_sweep

#: When Ctrl-C comes [s], and how soon it is to be answered.
DELAY, PATIENCE = 0.3, 1.0


def rod(nodes, force, analysis="static"):
    return {
        "title": "Rod",
        "rods": [
            {
                "name": "rod",
                "nodes": nodes,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"stiffness": {"EA": 1e6, "EI": 1, "mass_per_length": 1}},
            }
        ],
        "supports": [
            {"rod": "rod", "at": "start", "fix": ["x", "y"]},
            {"rod": "rod", "at": "end", "fix": ["y"]},
        ],
        "loads": [{"point_force": {"rod": "rod", "at": "end", "force": [force, 0]}}],
        "analysis": analysis,
    }


#: Its equilibrium takes seconds, far above its buckling load.
SEARCH = rod(8001, -1e5)


def assert_answered(call):
    """Interrupt a call as Ctrl-C does: by a signal that needs no other thread of Python."""
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    begun = time.monotonic()
    signal.setitimer(signal.ITIMER_REAL, DELAY)
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
        assert DELAY <= time.monotonic() - begun < DELAY + PATIENCE
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def test_ctrl_c_ends_the_search_for_an_equilibrium():
    simulation = der.Simulation(SEARCH)
    simulation.extra_force[7, 1] = 1e-3
    before = simulation.positions.copy()
    for call in (simulation.equilibrium, simulation.run):
        assert_answered(call)
        np.testing.assert_array_equal(simulation.positions, before)
        assert simulation.extra_force[7, 1] == 1e-3
    simulation.restore_state(simulation.save_state())  # it is not busy any more


def test_ctrl_c_ends_the_search_for_a_start():
    scene = rod(8001, -1e5) | {
        "start_from": "equilibrium",
        "time": {"duration": 1, "step": 0.1},
        "output": {"every": 0.1},
    }
    del scene["analysis"]
    assert_answered(lambda: der.Simulation(scene))
    assert_answered(lambda: der.Batch(scene, 2, 2))


@pytest.mark.parametrize(
    "scene",
    [
        rod(4001, -1, {"modes": {"count": 600}}),
        rod(1001, -30, {"continuation": {"branches": 1, "step": 0.0002, "points": 9000}}),
    ],
    ids=["modes", "continuation"],
)
def test_ctrl_c_ends_an_analysis(scene):
    assert_answered(lambda: der.run(scene))


def test_ctrl_c_ends_the_search_for_modes():
    simulation = der.Simulation(rod(4001, -1))
    simulation.equilibrium()
    before = simulation.positions.copy()
    assert_answered(lambda: simulation.modes(600))
    np.testing.assert_array_equal(simulation.positions, before)


def test_a_signal_handler_finds_the_simulation_busy():
    simulation = der.Simulation(rod(2001, -1))
    simulation.equilibrium()
    expected = simulation.modes(200).frequencies
    refusals = []

    def handle(*_):
        try:
            simulation.equilibrium()
        except RuntimeError as refusal:
            refusals.append(str(refusal))

    before = signal.signal(signal.SIGALRM, handle)
    signal.setitimer(signal.ITIMER_REAL, 0.02, 0.02)
    try:
        found = simulation.modes(200).frequencies
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert any("busy" in refusal for refusal in refusals)
    np.testing.assert_array_equal(found, expected)


def test_callbacks_and_forces_may_ask_for_modes():
    scene = rod(11, -1) | {"time": {"duration": 0.02, "step": 0.01}}
    del scene["analysis"]
    scene["loads"] = []
    simulation = der.Simulation(scene)
    expected = simulation.modes(2).frequencies
    found = []

    @simulation.add_force
    def force(time, positions, velocities):
        found.append(simulation.modes(2).frequencies)
        return np.zeros_like(positions)

    simulation.run(lambda now: found.append(now.modes(2).frequencies))
    simulation.step()
    assert len(found) == 5
    for frequencies in found:
        np.testing.assert_allclose(frequencies, expected, rtol=1e-6)


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_the_search_of_a_batch(threads):
    batch = der.Batch(SEARCH, 4, threads)
    before = batch.positions.copy()
    assert_answered(batch.equilibrium)
    assert not batch.failed.any()
    np.testing.assert_array_equal(batch.positions, before)
    assert_answered(batch.equilibrium)


def has_rows(folder):
    try:
        return is_sweep(folder) and len(der.load_sweep(folder)) > 0
    except ValueError:  # the file is there before its tables
        return False


def test_ctrl_c_ends_a_sweep_of_searches_in_processes(tmp_path):
    """As from a terminal, which sends it to all processes."""
    scene = der.Scenario.from_dict(rod(4001, -1, {"modes": {"count": 1}}))
    (tmp_path / "rod.yaml").write_text(scene.to_yaml())
    vary = "analysis.modes.count=1,600,601"
    line = [sys.executable, "-m", "der", "sweep", "rod.yaml", "--vary", vary, "--out", "s"]
    sweep = subprocess.Popen(
        [*line, "--processes", "--jobs", "1"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    # Its processes have begun when the first member has a row.
    deadline = time.monotonic() + 60.0
    while not has_rows(tmp_path / "s"):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    begun = time.monotonic()
    os.killpg(sweep.pid, signal.SIGINT)
    errors = sweep.communicate(timeout=60)[1]
    assert time.monotonic() - begun < PATIENCE + 2.0
    assert sweep.returncode == 130
    assert errors.startswith("interrupted: ")
    assert "Traceback" not in errors


@pytest.mark.parametrize("delay", [0.02, 0.05, 0.1])
def test_ctrl_c_while_the_command_loads_its_modules(delay):
    """It printed a traceback."""
    program = "import sys, der_command; print(flush=True); sys.exit(der_command.main())"
    command = subprocess.Popen(
        [sys.executable, "-c", program, "check"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    command.stdout.readline()
    time.sleep(delay)
    command.send_signal(signal.SIGINT)
    errors = command.communicate(timeout=60)[1]
    # Where it has loaded them, it misses the names of scenes.
    assert command.returncode == 2 or (command.returncode, errors) == (130, "interrupted\n")


def test_the_command_begins_where_ctrl_c_is_answered():
    commands = {c.value for c in entry_points(group="console_scripts") if c.name == "der"}
    assert commands == {"der_command:main"}


@pytest.mark.parametrize("delay", [0.05, 0.15, 0.3])
def test_ctrl_c_while_processes_start(tmp_path, delay):
    """They ended with tracebacks of their own while they loaded their modules."""
    (tmp_path / "rod.yaml").write_text(der.Scenario.from_dict(SEARCH).to_yaml())
    line = [sys.executable, "-m", "der", "sweep", "rod.yaml", "--out", "s", "--processes"]
    sweep = subprocess.Popen(
        [*line, "--vary", "loads.0.point_force.force.0=-1e5,-2e5,-3e5,-4e5", "--jobs", "2"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + 60.0
    while not is_sweep(tmp_path / "s"):  # processes are started after the file
        assert time.monotonic() < deadline
        time.sleep(0.01)
    time.sleep(delay)
    os.killpg(sweep.pid, signal.SIGINT)
    errors = sweep.communicate(timeout=60)[1]
    assert sweep.returncode == 130
    assert errors.startswith("interrupted: ")
    assert "Traceback" not in errors


def test_ctrl_c_ends_a_sweep_of_searches(tmp_path):
    assert_answered(
        lambda: der.sweep(SEARCH, {"loads.0.point_force.force.0": [-1e5, -2e5]}, out=tmp_path / "s")
    )
    assert len(der.load_sweep(tmp_path / "s").rows) == 0


@pytest.mark.parametrize("gap", [0.0, 0.01, 0.03])
def test_a_second_ctrl_c_changes_nothing(tmp_path, gap):
    """It came while threads of the engine were to end, which the process did not outlive."""
    scene = tmp_path / "search.yaml"
    scene.write_text(der.Scenario.from_dict(SEARCH).to_yaml())
    values = ",".join(str(-1e5 * k) for k in range(1, 9))
    out = tmp_path / "s"
    sweep = subprocess.Popen(
        [
            *(sys.executable, "-m", "der", "sweep", str(scene), "--jobs", "2"),
            *("--vary", f"loads.0.point_force.force.0={values}", "--out", str(out)),
        ],
        stderr=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 60.0
    while not is_sweep(out):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    time.sleep(0.5)
    for _ in range(2):
        sweep.send_signal(signal.SIGINT)
        time.sleep(gap)
    errors = sweep.communicate(timeout=60)[1]
    assert sweep.returncode == 130
    assert errors.startswith("interrupted: ")
    assert "Traceback" not in errors
