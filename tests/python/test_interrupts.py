"""Ctrl-C in long calls: it is answered at once, and leaves simulations as they were.

The command `der` answers SIGTERM likewise."""

import os
import pty
import re
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


#: Signals that end the command, its exit codes, and what it says.
ENDS = pytest.mark.parametrize(
    ("number", "code", "word"),
    [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")],
    ids=["SIGINT", "SIGTERM"],
)


@ENDS
def test_a_signal_ends_a_sweep_of_searches_in_processes(tmp_path, number, code, word):
    """As from a terminal or a batch system, which send it to all processes."""
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
    os.killpg(sweep.pid, number)
    # The pipe is at its end once the workers have ended, too.
    errors = sweep.communicate(timeout=60)[1]
    assert time.monotonic() - begun < PATIENCE + 2.0
    assert sweep.returncode == code
    assert errors.startswith(word)
    assert "Traceback" not in errors
    assert len(der.load_sweep(tmp_path / "s")) == 1


def motion(duration, every):
    scene = rod(41, -1) | {
        "time": {"duration": duration, "step": 0.01},
        "output": {"every": every, "probes": {"y": {"quantity": "y", "rod": "rod", "at": "end"}}},
    }
    del scene["analysis"]
    return scene


def run_until(text, line, folder):
    """Start a command with a terminal for its messages, and return it when `text` stands there."""
    terminal, end = pty.openpty()
    command = subprocess.Popen(
        [sys.executable, *line], cwd=folder, stdout=subprocess.PIPE, stderr=end, text=True
    )
    os.close(end)
    seen = ""
    while text not in seen:
        seen += os.read(terminal, 1000).decode()
    return command, terminal


def rest_of(terminal):
    """Return what comes until the other end is closed."""
    text = ""
    try:
        while piece := os.read(terminal, 1000):
            text += piece.decode()
    except OSError:  # as Linux says that it is closed
        pass
    os.close(terminal)
    return text


def assert_ended(command, terminal, number, code, word):
    begun = time.monotonic()
    command.send_signal(number)
    printed, said = command.communicate(timeout=60)[0], rest_of(terminal)
    assert time.monotonic() - begun < PATIENCE + 2.0  # on a machine that is busy with other tests
    assert (command.returncode, printed) == (code, "")
    assert re.fullmatch(f"{word}(: .* kept in found; .*)?", said.strip().splitlines()[-1].strip())


@ENDS
@pytest.mark.parametrize("name", ["verify", "study", "animate", "export", "sweep"])
def test_a_signal_ends_a_command(tmp_path, name, number, code, word):
    """SIGTERM ended them by itself, without a word."""
    scene, run = tmp_path / "rod.yaml", tmp_path / "run"
    if name in ("animate", "export"):
        der.run(motion(100, 0.01), out=run)
    else:
        scene.write_text(der.Scenario.from_dict(motion(10_000, 1)).to_yaml())
    results = {
        "verify": ([scene, "--json", "found.json"], ["found.json"]),
        "study": ([scene, "--max-seconds", "60", "--out", "found"], ["found"]),
        "animate": ([run, "--fps", "60", "--speed", "1"], ["run/animation.gif"]),
        "export": ([run, "--format", "csv"], ["run/csv/nodes.csv", "run/csv/probes.csv"]),
        "sweep": ([scene, "--vary", "time.step=0.01,0.02", "--out", "found"], []),
    }
    arguments, names = results[name]
    line = ["-m", "der", name, *map(str, arguments)]
    command, terminal = run_until("%", line, tmp_path)
    assert_ended(command, terminal, number, code, word)
    assert not [name for name in names if (tmp_path / name).exists()]
    assert not list(tmp_path.rglob("*partial*"))


@ENDS
@pytest.mark.parametrize("blocked", [False, True])
def test_a_signal_leaves_no_half_written_picture(tmp_path, number, code, word, blocked):
    """Also where the interpreter does not get to answer it."""
    run = tmp_path / "run"
    der.run(motion(1, 0.1), out=run)
    program = f"""
import sys, time
from pathlib import Path
from matplotlib.figure import Figure

def write_half(figure, path):
    Path(path).write_bytes(b"half")
    print("half written", file=sys.stderr, flush=True)
    {"sum(range(10**15))" if blocked else "time.sleep(60)"}

Figure.savefig = write_half
sys.argv = ["der", "plot", "run"]
import der_command
sys.exit(der_command.main())
"""
    command, terminal = run_until("half written", ["-c", program], tmp_path)
    time.sleep(0.3)  # until it is in the next line
    assert_ended(command, terminal, number, code, word)
    assert not (run / "plot.png").exists()
    assert list(run.glob(".plot.partial.png")) == [run / ".plot.partial.png"] * blocked


def test_other_programs_keep_their_own_answer_to_sigterm(tmp_path):
    program = """
import signal, sys, time, der, der.cli
der.run(sys.argv[1])
der.sweep(sys.argv[1], {"time.step": [0.01]}, out="s")
der.verify(sys.argv[1])
assert der.cli.main(["check", sys.argv[1]]) == 0
assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
print("ready", file=sys.stderr, flush=True)
der.run(der.load(sys.argv[1], **{"time.duration": 1e6}))
"""
    scene = tmp_path / "rod.yaml"
    scene.write_text(der.Scenario.from_dict(motion(1, 0.1)).to_yaml())
    command, terminal = run_until("ready", ["-c", program, str(scene)], tmp_path)
    command.send_signal(signal.SIGTERM)
    command.communicate(timeout=60)
    rest_of(terminal)
    assert command.returncode == -signal.SIGTERM


@ENDS
@pytest.mark.parametrize("delay", [0.02, 0.05, 0.1])
def test_a_signal_while_the_command_loads_its_modules(delay, number, code, word):
    """Ctrl-C printed a traceback."""
    program = "import sys, der_command; print(flush=True); sys.exit(der_command.main())"
    command = subprocess.Popen(
        [sys.executable, "-c", program, "check"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    command.stdout.readline()
    time.sleep(delay)
    command.send_signal(number)
    errors = command.communicate(timeout=60)[1]
    # Where it has loaded them, it misses the names of scenes.
    assert command.returncode == 2 or (command.returncode, errors) == (code, f"{word}\n")


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
