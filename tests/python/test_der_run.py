"""The program der_run from outside: exit codes, run folders, kills, Ctrl-C and resuming."""

from __future__ import annotations

import json
import os
import pty
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))
ROOT = Path(__file__).parents[2]

SPHERES = """\
title: Three spheres
rods:
  - name: rod
    nodes: 3
    from: [0, 0]
    to: [0.1, 0]
    cross_section: {circle: {radius: 0.001}}
    material: {youngs_modulus: 1e9, density: 0}
    curvature: tangent
    spheres:
      - {at: all, radius: 0.005, density: 7000}
      - {at: middle, radius: 0.025, density: 7000}
loads:
  - gravity: [0, -9.8]
  - fluid: {density: 1000, viscosity: 1000}
time: {duration: 10, step: 0.01, integrator: implicit_euler}
output:
  every: 0.01
  probes:
    v_mid: {rod: rod, at: middle, quantity: vy}
    y_mid: {rod: rod, at: middle, quantity: y}
"""

CANTILEVER = """\
title: Cantilever
rods:
  - name: arm
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e4, EI: 1, mass_per_length: 1}}
supports:
  - {rod: arm, at: start, clamp: true}
loads:
  - point_force: {rod: arm, at: end, force: [0, -1]}
analysis: static
output:
  probes:
    tip: {rod: arm, at: end, quantity: y}
"""

# Long enough to be interrupted, with frames all the way.
LONG = ["--set", "time.duration=1e5", "--set", "output.every=0.05"]
COLUMNS = [
    "time",
    "step",
    "positions",
    "velocities",
    "energies/kinetic",
    "energies/stretch",
    "energies/bend",
    "energies/gravity",
    "work/loads",
    "work/supports",
    "work/drag",
    "work/numerical",
    "work/solver",
    "probes/v_mid",
    "probes/y_mid",
]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "spheres.yaml"
    path.write_text(SPHERES)
    return path


def der_run(*arguments: str | Path, **options: Any) -> subprocess.CompletedProcess[str]:
    command = [DER_RUN, *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=120, check=False, **options
    )


def start(*arguments: str | Path) -> subprocess.Popen[str]:
    command = [DER_RUN, *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def wait_for_frames(results: Path, count: int) -> None:
    """Until the file of a run that goes on holds so many frames."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        try:
            with h5py.File(results, "r", locking=False) as file:
                if len(file["time"]) >= count:
                    return
        except (OSError, KeyError):
            pass  # not there yet, or caught in the middle of a write
        time.sleep(0.01)
    pytest.fail(f"{results} did not come to {count} frames")


def summary_of(folder: Path) -> dict[str, Any]:
    summary: dict[str, Any] = json.loads((folder / "summary.json").read_text())
    return summary


def assert_same_results(a: Path, b: Path) -> None:
    with h5py.File(a / "results.h5") as first, h5py.File(b / "results.h5") as second:
        for name in COLUMNS:
            assert np.array_equal(first[name][:], second[name][:]), name


def test_a_run_prints_a_summary_and_writes_its_folder(scene: Path, tmp_path: Path) -> None:
    done = der_run(scene, "--out", tmp_path / "out")
    assert done.returncode == 0
    assert done.stderr == ""
    for part in ("Three spheres", "completed", "planar", "implicit_euler", "banded", "v_mid"):
        assert part in done.stdout
    assert "\x1b" not in done.stdout, "colours belong on a terminal only"
    summary = summary_of(tmp_path / "out")
    assert summary["status"] == "completed"
    assert summary["steps"] == 1000
    assert summary["probes"]["v_mid"]["final"] == pytest.approx(-0.0059661, abs=5e-8)
    assert summary["probes"]["y_mid"]["final"] == pytest.approx(-0.066153, abs=5e-7)


def test_a_table_finer_than_the_steps_is_warned_of(scene: Path, tmp_path: Path) -> None:
    jump = "{times: [1, 1.001], values: [[0, 0], [0, 0.1]]}"
    push = f"  - point_force: {{rod: rod, at: start, force: {jump}}}\n"
    scene.write_text(SPHERES.replace("loads:\n", "loads:\n" + push))
    done = der_run(scene, "--out", tmp_path / "out")
    assert done.returncode == 0
    assert "warning" in done.stdout
    assert "loads.0.point_force.force" in done.stdout
    [warning] = summary_of(tmp_path / "out")["warnings"]
    assert "1 and 1.001 s" in warning


def test_rods_that_touch_are_warned_of(scene: Path, tmp_path: Path) -> None:
    ring = "points=[[0, 0], [0.1, 0], [0, 0.1], [0, 0]]"
    text = SPHERES.replace("    nodes: 3\n    from: [0, 0]\n    to: [0.1, 0]\n", "    points: []\n")
    scene.write_text(text.replace("at: middle", "at: {node: 1}"))
    out = tmp_path / "out"
    set_ring = (
        "--set",
        f"rods.rod.{ring}",
        "--set",
        "time.duration=0.02",
        "--set",
        "output.probes=",
    )
    checked = der_run(scene, *set_ring, "--check")
    done = der_run(scene, *set_ring, "--set", "output.every=0.01", "--out", out)
    [warning] = summary_of(out)["warnings"]
    assert warning.startswith("the last point of rod 'rod' is its first")
    assert warning in checked.stdout
    assert warning in done.stdout


def test_the_default_folder_is_named_after_the_scene(scene: Path, tmp_path: Path) -> None:
    assert der_run(scene.name, cwd=tmp_path).returncode == 0
    assert (tmp_path / "runs" / "spheres" / "summary.json").exists()


def test_results_are_laid_out_as_documented(scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    der_run(scene, "--out", out)
    with h5py.File(out / "results.h5") as file:
        assert file["positions"].shape == (1001, 3, 2)
        assert file["velocities"].shape == (1001, 3, 2)
        assert np.allclose(file["time"][:], 0.01 * np.arange(1001), rtol=1e-13, atol=0)
        assert np.array_equal(file["step"][:], np.arange(1001))
        assert np.array_equal(file["probes/y_mid"][:], file["positions"][:, 1, 1])
        assert file["probes/v_mid"].attrs["unit"] == b"m/s"
        assert file["rods/rod"].attrs["EI"] == pytest.approx(1e9 * np.pi * 0.001**4 / 4)
        assert file["rods/rod"].attrs["radius"] == 0.001
        assert list(file["rods/rod/sphere_radius"][:]) == [0.005, 0.025, 0.005]
        assert file.attrs["status"] == b"completed"
        assert file.attrs["dimension"] == 2
        assert file["scene"].asstr()[()] == (out / "scene.yaml").read_text()
        without_unit: list[str] = []

        def look_at(name: str, item: object) -> None:
            if isinstance(item, h5py.Dataset) and "unit" not in item.attrs:
                without_unit.append(name)

        file.visititems(look_at)
        assert without_unit == []
        for name in COLUMNS:
            assert np.all(np.isfinite(file[name][:])), name


def test_the_scene_is_saved_with_its_overrides(scene: Path, tmp_path: Path) -> None:
    first = tmp_path / "first"
    second = tmp_path / "second"
    assert der_run(scene, "--set", "rods.rod.nodes=5", "--quiet", "--out", first).returncode == 0
    assert der_run(first / "scene.yaml", "--quiet", "--out", second).returncode == 0
    assert summary_of(second)["nodes"] == 5
    assert_same_results(first, second)


def test_every_frame_has_the_checksum_of_the_results_page(scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    der_run(scene, "--quiet", "--out", out)
    with h5py.File(out / "results.h5") as file:
        columns = [file[name] for name in ("time", "step", "positions", "velocities")]
        for group in ("energies", "work", "probes"):
            columns += [file[group][name] for name in sorted(file[group])]
        words = np.hstack([column[:].view(np.uint64).reshape(1001, -1) for column in columns])
        factors = np.cumprod(np.full(words.shape[1], 0x9E3779B97F4A7C15, np.uint64))
        sums = ((words ^ (words >> np.uint64(32))) * factors).sum(axis=1, dtype=np.uint64)
        assert np.array_equal(file["checksum"][:], sums)
        arc = file["rods/rod/arc_length"]
        words = arc[:].view(np.uint64)
        sums = ((words ^ (words >> np.uint64(32))) * factors[:3]).sum(dtype=np.uint64)
        assert arc.attrs["checksum"] == sums


@pytest.mark.parametrize("locking", ["TRUE", "FALSE"])
def test_of_two_runs_at_once_one_wins_and_the_other_says_so(
    scene: Path, tmp_path: Path, locking: str
) -> None:
    environment = {**os.environ, "HDF5_USE_FILE_LOCKING": locking}
    for round_ in range(4):
        out = tmp_path / str(round_)
        runs = [
            subprocess.Popen(
                [DER_RUN, scene, "--quiet", *LONG, "--set", f"title={title}", "--out", out],
                stderr=subprocess.PIPE,
                text=True,
                env=environment,
            )
            for title in ("first", "second")
        ]
        while all(run.poll() is None for run in runs):
            time.sleep(0.002)
        [loser] = [run for run in runs if run.poll() is not None]
        [winner] = [run for run in runs if run is not loser]
        assert loser.returncode == 4
        assert "another run is writing" in loser.communicate()[1]
        wait_for_frames(out / "results.h5", 2)
        winner.send_signal(signal.SIGINT)
        assert winner.communicate(timeout=60)[1] == ""
        assert winner.returncode == 130
        assert summary_of(out)["title"] == ("first", "second")[runs.index(winner)]
        with h5py.File(out / "results.h5") as file:
            assert file.attrs["title"].decode() == summary_of(out)["title"]
        assert sorted(path.name for path in out.iterdir()) == [
            "results.h5",
            "scene.yaml",
            "summary.json",
        ]


def test_a_kill_at_the_start_leaves_nothing_or_a_readable_file(scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    for milliseconds in range(0, 24, 2):
        run = start(scene, *LONG, "--out", out)
        time.sleep(0.005 + 1e-3 * milliseconds)
        run.kill()
        run.communicate()
        if (out / "results.h5").exists():
            with h5py.File(out / "results.h5") as file:
                assert file.attrs["status"] == b"running"
    done = der_run(scene, "--out", out)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("arguments", [["SCENE"], ["SCENE", "--check"], ["--help"], ["--schema"]])
def test_a_full_standard_output_is_an_error(
    scene: Path, tmp_path: Path, arguments: list[str]
) -> None:
    words = [str(scene) if word == "SCENE" else word for word in arguments]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [DER_RUN, *words], stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path
        )
    assert done.returncode == 4
    assert "standard output" in done.stderr
    assert "No space left" in done.stderr


def test_a_title_that_is_not_utf_8_is_refused(scene: Path, tmp_path: Path) -> None:
    scene.write_bytes(SPHERES.encode().replace(b"Three spheres", b"Drei K\xfcgelchen"))
    done = der_run(scene, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith(f"{scene}:1:14: the byte 0xfc is not UTF-8")
    assert not (tmp_path / "runs").exists()


def test_an_edited_scene_in_the_run_folder_is_not_replaced(scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert der_run(scene, "--out", out).returncode == 0
    edited = "# my notes\n" + (out / "scene.yaml").read_text()
    (out / "scene.yaml").write_text(edited)
    done = der_run("scene.yaml", "--out", ".", cwd=out)
    assert done.returncode == 4
    assert "edited" in done.stderr
    assert (out / "scene.yaml").read_text() == edited
    assert summary_of(out)["status"] == "completed"


def test_check_says_how_large_the_results_will_be(scene: Path, tmp_path: Path) -> None:
    assert "1,001 frames, about 255 kB" in der_run(scene, "--check").stdout
    changes = ("time.duration=9e6", "output.every=0.01", "rods.0.nodes=10001")
    endless = [word for change in changes for word in ("--set", change)]
    assert "900,000,001 frames, about 288 TB" in der_run(scene, "--check", *endless).stdout
    out = tmp_path / "out"
    done = der_run(scene, *endless, "--out", out)
    assert done.returncode == 4
    assert "raise output.every" in done.stderr
    assert not (out / "results.h5").exists()


def test_quiet_prints_nothing_but_errors(scene: Path, tmp_path: Path) -> None:
    done = der_run(scene, "--quiet", "--out", tmp_path / "out")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    done = der_run(scene, "--quiet", "--set", "time.step=-1", "--out", tmp_path / "out")
    assert done.returncode == 1
    assert "time.step" in done.stderr


def test_check_says_what_would_run_and_writes_nothing(scene: Path, tmp_path: Path) -> None:
    done = der_run(scene, "--check", cwd=tmp_path)
    assert done.returncode == 0
    assert "scene is valid" in done.stdout
    assert "planar" in done.stdout
    assert "6 degrees of freedom" in done.stdout
    assert not (tmp_path / "runs").exists()


def test_every_mistake_of_a_scene_is_reported_with_its_place(tmp_path: Path) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(SPHERES.replace("duration", "durration").replace("youngs", "yuongs"))
    for option in ([], ["--check"]):
        done = der_run(path, *option, cwd=tmp_path)
        assert done.returncode == 1
        lines = done.stderr.splitlines()
        assert any(line.startswith(f"{path}:8:") and "youngs_modulus" in line for line in lines)
        assert any(line.startswith(f"{path}:16:") and "duration" in line for line in lines)
        assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["--no-such-option"],
        ["scene.yaml", "--set"],
        ["scene.yaml", "--set", "no_equals"],
        ["scene.yaml", "--set", "=1"],
        ["scene.yaml", "--check", "--resume"],
        ["a.yaml", "b.yaml"],
        ["scene.yaml", "--out", ""],
    ],
)
def test_usage_errors(arguments: list[str], tmp_path: Path) -> None:
    done = der_run(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr != ""


def test_help_version_and_schema() -> None:
    done = der_run("--help")
    assert done.returncode == 0
    for option in ("--out", "--set", "--check", "--resume", "--quiet", "--schema", "Exit codes"):
        assert option in done.stdout
    done = der_run("--version")
    assert done.returncode == 0
    assert done.stdout.startswith("der_run ")
    done = der_run("--schema")
    assert done.returncode == 0
    assert json.loads(done.stdout)["$schema"].endswith("2020-12/schema")


def test_files_that_cannot_be_read_or_written(scene: Path, tmp_path: Path) -> None:
    assert der_run(tmp_path / "none.yaml").returncode == 4
    assert der_run(scene, "--out", scene).returncode == 4
    folder = tmp_path / "thesis"
    folder.mkdir()
    (folder / "chapter.tex").write_text("do not delete")
    done = der_run(scene, "--out", folder)
    assert done.returncode == 4
    assert str(folder) in done.stderr
    assert [path.name for path in folder.iterdir()] == ["chapter.tex"]


def test_a_pipe_is_read_once(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    program = start(pipe, "--check")
    pipe.write_text("a: 1\n")
    _, errors = program.communicate(timeout=20)
    assert program.returncode == 1
    assert "a scene has no key 'a'" in errors


def test_nested_anchors_take_no_memory(tmp_path: Path) -> None:
    # 400 kB of text, in which 90 anchors stand for the same 100,000 values.
    opening = "".join(f"&a{i} [" for i in range(90))
    scene = tmp_path / "nested.yaml"
    scene.write_text("x: " + opening + "1, " * 100_000 + "]" * 90 + "\n")

    def limit_memory() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (1 << 28, 1 << 28))

    done = der_run(scene, "--check", preexec_fn=limit_memory)
    assert done.returncode == 1
    assert "a scene has no key 'x'" in done.stderr


def test_control_characters_do_not_reach_the_terminal(scene: Path, tmp_path: Path) -> None:
    done = der_run(scene, "--set", 'title="\\e]0;mine\\a"', "--out", tmp_path / "o")
    assert done.returncode == 1
    assert "control character 0x1b" in done.stderr
    folder = tmp_path / "a\x1b[31mb"
    done = der_run(scene, "--set", 'title="two\\nlines"', "--out", folder)
    assert done.stdout.startswith("two\\nlines\n")
    assert folder.is_dir()
    assert "\x1b" not in done.stdout
    assert "a\\x1b[31mb" in done.stdout
    done = der_run(folder / "scene.yaml", "--set", "no\x1b=1")
    assert "\x1b" not in done.stderr


def test_a_static_analysis_is_one_frame(tmp_path: Path) -> None:
    path = tmp_path / "cantilever.yaml"
    path.write_text(CANTILEVER)
    out = tmp_path / "out"
    done = der_run(path, "--out", out)
    assert done.returncode == 0
    assert "static_converged, stable" in done.stdout
    summary = summary_of(out)
    assert summary["status"] == "static_converged"
    assert summary["integrator"] == "none"
    assert summary["unstable_directions"] == 0
    # Exact tip deflection for P L^2 / EI = 1 is 0.30172 (extensible here by 1e-4).
    assert summary["probes"]["tip"]["final"] == pytest.approx(-0.3017, abs=1e-3)
    with h5py.File(out / "results.h5") as file:
        assert file["positions"].shape == (1, 21, 2)
    done = der_run(path, "--out", out, "--resume")
    assert done.returncode == 0
    assert "nothing to resume" in done.stdout


def test_failures_are_named_and_leave_no_old_summary(scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert der_run(scene, "--out", out).returncode == 0
    unstable = [
        "--set",
        "time.integrator=explicit_euler",
        "--set",
        "time.step=1e-4",
        "--set",
        "time.allow_unstable=true",
    ]
    done = der_run(scene, "--out", out, *unstable)
    assert done.returncode == 3
    assert "diverged" in done.stdout
    assert "error: " in done.stderr
    summary = summary_of(out)
    assert summary["status"] == "diverged"
    assert summary["failure"]["message"] in done.stderr
    assert 0 < summary["failure"]["time"] < 10
    # json.loads would take NaN and Infinity, which are no JSON.
    assert not any(word in (out / "summary.json").read_text() for word in ("NaN", "Inf"))
    with h5py.File(out / "results.h5") as file:
        assert file.attrs["status"] == b"diverged"
        for name in COLUMNS:
            assert np.all(np.isfinite(file[name][:])), name
    done = der_run(scene, "--out", out, *unstable, "--resume")
    assert done.returncode == 1
    assert "diverged" in done.stderr

    path = tmp_path / "free.yaml"
    path.write_text(CANTILEVER.replace("  - {rod: arm, at: start, clamp: true}", "  []"))
    assert der_run(path, "--out", out).returncode == 3
    assert summary_of(out)["status"] == "not_held"
    assert summary_of(out)["probes"] == {}


def test_a_killed_run_leaves_every_saved_step_and_can_be_resumed(
    scene: Path, tmp_path: Path
) -> None:
    reference = tmp_path / "reference"
    out = tmp_path / "killed"
    length = ["--set", "time.duration=20000", "--set", "output.every=0.1"]
    assert der_run(scene, *length, "--quiet", "--out", reference).returncode == 0
    for frames in (2, 3000, 20000):
        run = start(scene, *length, "--out", out)
        wait_for_frames(out / "results.h5", frames)
        run.kill()
        run.communicate()
        assert run.returncode == -signal.SIGKILL
        assert not (out / "summary.json").exists()
        with (
            h5py.File(out / "results.h5") as file,
            h5py.File(reference / "results.h5") as whole,
        ):
            assert file.attrs["status"] == b"running"
            n = len(file["time"])
            assert n >= frames
            assert np.array_equal(file["step"][:n], 10 * np.arange(n))
            for name in COLUMNS:
                assert np.array_equal(file[name][:n], whole[name][:n]), name
    assert n < len(h5py.File(reference / "results.h5")["time"]), "killed too late to tell"
    done = der_run(scene, *length, "--out", out, "--resume")
    assert done.returncode == 0
    assert_same_results(out, reference)


@pytest.mark.parametrize(
    ("signal_number", "exit_code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)]
)
def test_an_interrupted_and_resumed_run_is_the_uninterrupted_one(
    scene: Path, tmp_path: Path, signal_number: signal.Signals, exit_code: int
) -> None:
    reference = tmp_path / "reference"
    out = tmp_path / "interrupted"
    # Frames every 7 steps: the run is most likely stopped between two of them.
    length = ["--set", "time.duration=5000.1", "--set", "output.every=0.07"]
    assert der_run(scene, *length, "--quiet", "--out", reference).returncode == 0
    run = start(scene, *length, "--out", out)
    wait_for_frames(out / "results.h5", 50)
    run.send_signal(signal_number)
    stdout, stderr = run.communicate(timeout=60)
    assert run.returncode == exit_code
    assert "stopped" in stdout
    assert "--resume" in stdout
    assert stderr == ""
    part = summary_of(out)
    assert part["status"] == "stopped"
    assert 0 < part["steps"] < 500010

    done = der_run(scene, *length, "--out", out, "--resume")
    assert done.returncode == 0
    assert_same_results(out, reference)
    whole = summary_of(reference)
    resumed = summary_of(out)
    for key in ("status", "steps", "newton_iterations", "time", "probes", "energies"):
        assert resumed[key] == whole[key], key
    assert resumed["wall_seconds"] > part["wall_seconds"]

    done = der_run(scene, *length, "--out", out, "--resume")
    assert done.returncode == 0
    assert "nothing to resume" in done.stdout


COLUMN = """\
title: Column
rods:
  - name: rod
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e6, EI: 1, GJ: 0.8, mass_per_length: 1}}
supports:
  - {rod: rod, at: start, fix: [x, y]}
  - {rod: rod, at: end, fix: [y]}
loads:
  - point_force: {rod: rod, at: end, force: [-1, 0]}
"""

#: Analyses of many seconds. The eigenvalues of a full matrix, as of half of all modes, have no
#: iterations in which a signal could be seen.
LONG_ANALYSES = {
    "static": ("static", 8001, {"loads.0.point_force.force": "[-1e5, 0]"}),
    "out of the plane": ("static", 90001, {"rods.rod.cross_section.stiffness.GJ": "1e-3"}),
    "modes": ("{modes: {count: 600}}", 4001, {}),
    "all modes": ("{modes: {count: 3000}}", 2001, {}),
    "buckling": ("{buckling: {count: 600}}", 4001, {}),
    "continuation": (
        "{continuation: {branches: 1, step: 0.0002, points: 9000}}",
        1001,
        {"loads.0.point_force.force": "[-30, 0]"},
    ),
}


def end_by_signal(run: subprocess.Popen[str], number: signal.Signals) -> tuple[str, str]:
    """Send a signal to a run that goes on, and return what it prints; it ends in time."""
    assert run.poll() is None, run.communicate()
    run.send_signal(number)
    sent = time.monotonic()
    printed = run.communicate(timeout=60)
    assert time.monotonic() - sent < 2.5  # on a machine that is busy with other tests
    assert run.returncode == 128 + number
    return printed


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
def test_a_signal_ends_the_search_for_a_start(tmp_path: Path, number: signal.Signals) -> None:
    path = tmp_path / "column.yaml"
    path.write_text(COLUMN + "start_from: equilibrium\ntime: {duration: 1, step: 0.1}\n")
    changes = ["rods.rod.nodes=8001", "loads.0.point_force.force=[-1e5, 0]"]
    options = [word for change in changes for word in ("--set", change)]
    run = start(path, *options, "--out", tmp_path / "out")
    assert run.stdout is not None
    assert "Column" in run.stdout.readline()
    time.sleep(0.3)
    _, stderr = end_by_signal(run, number)
    assert "nothing was written" in stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("case", LONG_ANALYSES)
def test_a_signal_ends_an_analysis_within_a_second(
    tmp_path: Path, case: str, number: signal.Signals
) -> None:
    analysis, nodes, changes = LONG_ANALYSES[case]
    path = tmp_path / "column.yaml"
    path.write_text(COLUMN + f"analysis: {analysis}\n")
    out = tmp_path / "out"
    options = [f"{key}={value}" for key, value in {"rods.rod.nodes": nodes, **changes}.items()]
    scene = [path, *(word for option in options for word in ("--set", option)), "--out", out]
    run = start(*scene)
    deadline = time.monotonic() + 60
    while not (out / "scene.yaml").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    time.sleep(0.5)
    stdout, stderr = end_by_signal(run, number)
    assert stderr == ""
    with h5py.File(out / "results.h5") as file:
        assert len(file["time"]) == 0
        assert file.attrs["status"] in (b"stopped", b"running")
        assert ("stopped" in stdout) == (file.attrs["status"] == b"stopped")
    if (out / "summary.json").exists():
        summary = summary_of(out)
        assert summary["status"] == "stopped"
        assert summary["probes"] == {}
        assert "stability" not in summary
    done = der_run(*scene, "--resume")
    assert done.returncode == 1
    assert "run it again without --resume" in done.stderr


def test_too_many_nodes_are_said_at_once(tmp_path: Path) -> None:
    """A search took minutes to fail as `too_fine`; a check built the model first."""
    path = tmp_path / "column.yaml"
    path.write_text(COLUMN + "analysis: static\n")
    across = ["--set", "loads.0.point_force.force=[0, 1]"]
    many = ["--set", "rods.rod.nodes=100000"]

    def refused(*options: str, analysis: str = "static") -> str:
        begun = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = der_run(path, *options, "--set", f"analysis={analysis}", "--check")
        assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - begun < 1.0
        assert done.returncode == 1
        return done.stderr

    for error in (
        refused(*many, *across),
        refused(*many, analysis="modes"),
        refused(*many, analysis="buckling"),
        refused("--set", "rods.rod.nodes=1000000", "--set", "model=spatial"),
    ):
        assert re.search(r"0 nodes take [0-9.]+ GB of memory", error)
        assert "'too_fine': write fewer" in error
    # Where nothing bends, so many can be solved for.
    done = der_run(path, *many, "--check")
    assert done.returncode == 0
    assert "too fine" not in done.stdout


@pytest.mark.parametrize("options", [["--check"], ["--out", "{out}"]])
def test_many_nodes_are_doubted_at_once(tmp_path: Path, options: list[str]) -> None:
    """With 20,000 to 99,999 nodes a search may succeed, and often takes minutes or fails."""
    path = tmp_path / "column.yaml"
    path.write_text(COLUMN + "analysis: static\n")
    doubt = (
        "rod 'rod' may be too fine: 99999 nodes take 0.3 GB of memory or more, and rounding hides "
        "how a rod of so many bends. The search can take minutes and end as 'too_fine': write "
        "fewer, 200 resolve most shapes and 2000 nearly all"
    )
    push = "loads.0.point_force"
    across = ["--set", f"{push}.at=middle", "--set", f"{push}.force=[0, 1]"]
    options = [option.format(out=tmp_path / "out") for option in options]
    run = start(path, "--set", "rods.rod.nodes=99999", *across, *options)
    assert run.stdout is not None
    try:
        assert run.stdout.readline() == "Column\n"
        assert doubt in run.stdout.readline()
        assert run.poll() is None
    finally:
        run.kill()
        run.communicate()
    for analysis, nodes, says in [
        ("static", 20000, True),
        ("static", 19999, False),
        ("modes", 20000, True),
    ]:
        done = der_run(
            path,
            *("--set", f"rods.rod.nodes={nodes}", "--set", f"analysis={analysis}"),
            *across,
            "--check",
        )
        assert done.returncode == 0
        assert ("may be too fine" in done.stdout) == says
    # Nothing is searched for, and nothing bends.
    over_time = COLUMN.replace("nodes: 21", "nodes: 99999") + "time: {duration: 1, step: 0.01}\n"
    path.write_text(over_time)
    assert "too fine" not in der_run(path, "--check").stdout
    path.write_text(COLUMN.replace("nodes: 21", "nodes: 99999") + "analysis: static\n")
    assert "too fine" not in der_run(path, "--check").stdout


def test_a_check_says_what_is_doubtful_before_it_builds_the_model(tmp_path: Path) -> None:
    path = tmp_path / "column.yaml"
    path.write_text(COLUMN + "time: {duration: 1, step: 0.01}\n")
    run = start(path, "--set", "rods.rod.nodes=1000000", "--check")
    assert run.stdout is not None
    try:
        assert run.stdout.readline() == "Column\n"
        assert "1000000 nodes take 1.2 GB of memory" in run.stdout.readline()
        assert run.poll() is None
    finally:
        run.kill()
        run.communicate()


def test_a_run_that_was_killed_before_its_summary_gets_one(scene: Path, tmp_path: Path) -> None:
    """All its data were there, and `--resume` said that it was finished."""
    out, reference = tmp_path / "out", tmp_path / "reference"
    for folder in (out, reference):
        assert der_run(scene, "--quiet", "--out", folder).returncode == 0
    (out / "summary.json").unlink()
    assert der_run(scene, "--out", out, "--resume").returncode == 0
    assert_same_results(out, reference)
    for key in ("status", "steps", "newton_iterations", "time", "probes", "energies"):
        assert summary_of(out)[key] == summary_of(reference)[key], key


def test_hints_of_a_resumed_run_are_those_of_all_of_it(tmp_path: Path) -> None:
    """They count the steps of all parts, and the longest of them."""
    path = tmp_path / "swing.yaml"
    path.write_text(
        CANTILEVER.replace(
            "analysis: static", "time: {duration: 2, tolerance: 1e-6, integrator: tr_bdf2}"
        )
    )
    reference, out = tmp_path / "reference", tmp_path / "interrupted"
    assert der_run(path, "--quiet", "--out", reference).returncode == 0
    (hint,) = summary_of(reference)["hints"]
    run = start(path, "--out", out)
    wait_for_frames(out / "results.h5", 50)
    run.send_signal(signal.SIGTERM)
    run.communicate(timeout=60)
    assert summary_of(out)["status"] == "stopped"
    assert der_run(path, "--quiet", "--out", out, "--resume").returncode == 0
    assert summary_of(out)["hints"] == [hint]


def test_resuming_with_another_scene_or_without_a_run_is_refused(
    scene: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    done = der_run(scene, "--out", out, "--resume")
    assert done.returncode == 4
    run = start(scene, *LONG, "--out", out)
    wait_for_frames(out / "results.h5", 2)
    # The folder is in use: neither a new run nor a resumed one may touch it.
    assert der_run(scene, *LONG, "--out", out).returncode == 4
    assert der_run(scene, *LONG, "--out", out, "--resume").returncode == 4
    run.send_signal(signal.SIGINT)
    run.communicate(timeout=60)
    before = (out / "results.h5").read_bytes()
    done = der_run(scene, *LONG, "--out", out, "--resume", "--set", "time.step=0.005")
    assert done.returncode == 1
    assert "another scene" in done.stderr
    assert "0.005" in done.stderr
    assert (out / "results.h5").read_bytes() == before


@pytest.mark.parametrize("limit", [1_000, 5_400_000, 6_500_000, 8_000_000])
def test_a_full_disk_is_an_error_and_leaves_what_was_written(
    scene: Path, tmp_path: Path, limit: int
) -> None:
    reference = tmp_path / "reference"
    out = tmp_path / "out"
    length = ["--set", "time.duration=2000", "--set", "output.every=0.02", "--quiet"]

    def limit_files() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writing fails instead
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = der_run(scene, *length, "--out", out, preexec_fn=limit_files)
    assert done.returncode == 4
    assert "results.h5" in done.stderr
    assert "File too large" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (out / "summary.json").exists()
    if limit < 10_000:
        return  # not even the head could be written
    assert der_run(scene, *length, "--out", reference).returncode == 0
    with h5py.File(out / "results.h5") as file, h5py.File(reference / "results.h5") as whole:
        n = len(file["time"])
        assert 0 < n < len(whole["time"])
        for name in COLUMNS:
            assert np.array_equal(file[name][:n], whole[name][:n]), name


def on_terminal(*arguments: str | Path, **variables: str) -> str:
    """Run der_run with a terminal on stdout and stderr; what it wrote there."""
    parent, child = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "100"}
    environment.pop("NO_COLOR", None)
    environment.update(variables)
    process = subprocess.Popen(
        [DER_RUN, *map(str, arguments)], stdout=child, stderr=child, env=environment
    )
    os.close(child)
    written = b""
    while True:
        try:
            chunk = os.read(parent, 65536)
        except OSError:  # Linux says this when the other end is closed
            break
        if not chunk:
            break
        written += chunk
    os.close(parent)
    assert process.wait(timeout=60) == 0
    return written.decode()


def test_progress_and_colours_are_for_terminals(scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    length = ["--set", "time.duration=8000", "--set", "output.every=10", "--out", str(out)]
    begin = time.monotonic()
    text = on_terminal(scene, *length)
    seconds = time.monotonic() - begin
    updates = text.count(" steps/s") - 1  # the summary has one
    assert 1 <= updates <= 10 * seconds + 1
    assert " left" in text
    assert "\x1b[32mcompleted\x1b[0m" in text
    # The title stands before the line, which is gone when the summary comes.
    assert text.index("Three spheres") < text.index("\r\x1b[K")
    assert text.rindex("\r\x1b[K") < text.index("status")

    text = on_terminal(scene, *length, NO_COLOR="1")
    assert "[32m" not in text
    assert " left" in text
    assert on_terminal(scene, *length, "--quiet") == ""


def test_what_was_not_tested_is_said_when_asked_for(tmp_path: Path) -> None:
    """A rod whose torsional stiffness is not given is not tested out of its plane."""
    scene = tmp_path / "rod.yaml"
    scene.write_text(
        "rods: [{name: rod, nodes: 11, from: [0, 0], to: [1, 0], cross_section: {circle: {radius:"
        " 0.01}}, material: {youngs_modulus: 1e9, density: 0}}]\n"
        "supports: [{rod: rod, at: start, clamp: true}]\n"
        "loads: [{moment: {rod: rod, at: end, moment: 1}}]\n"
        "analysis: static\n"
    )
    usual = der_run(scene, "--out", tmp_path / "out").stdout
    verbose = der_run(scene, "--out", tmp_path / "out", "--verbose").stdout
    assert "not tested" not in usual
    line = "  plane    not tested out of it, because "
    assert [text for text in verbose.splitlines() if text.startswith(line)]
    assert der_run(scene, "--verbose", "--quiet", "--out", tmp_path / "out").returncode == 2
    # A test that was done is always reported: this force does not turn with the rod.
    force = ["--set", "loads=[{point_force: {rod: rod, at: end, force: [0, -1]}}]"]
    force += ["--set", "rods.rod.material.poissons_ratio=0.3"]
    tested = der_run(scene, *force, "--out", tmp_path / "out").stdout
    assert "\n  plane    stable out of it\n" in tested


def test_short_runs_take_well_under_a_tenth_of_a_second(scene: Path, tmp_path: Path) -> None:
    seconds = []
    for _ in range(5):
        assert der_run(scene, "--quiet", "--out", tmp_path / "out").returncode == 0
        seconds.append(summary_of(tmp_path / "out")["wall_seconds"])
    assert min(seconds) < 0.05


def test_the_snippets_of_the_results_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    root = Path(__file__).parents[2]
    monkeypatch.chdir(tmp_path)
    assert der_run(root / "configs" / "cantilever.yaml", "--quiet").returncode == 0
    snippet, checksums = re.findall(
        r"^```python\n(.*?)^```$",
        (root / "docs" / "results.md").read_text(),
        re.DOTALL | re.MULTILINE,
    )
    exec(checksums, {})
    exec(snippet, {})
    printed = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert float(printed["tip_y"].split()[0]) == pytest.approx(-0.301721, abs=1e-4)
    assert printed["root_moment"].endswith("N m")
