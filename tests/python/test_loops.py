"""The innermost loops: what chooses them, and the same bits in every process and with all."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import yaml

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))


def environment(loops: str | None) -> dict[str, str]:
    others = {name: value for name, value in os.environ.items() if name != "DER_LOOPS"}
    return others if loops is None else {**others, "DER_LOOPS": loops}


def python(code: str, loops: str | None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code], env=environment(loops), capture_output=True, text=True
    )


def der_run(*arguments: object, loops: str | None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [DER_RUN, *map(str, arguments)], env=environment(loops), capture_output=True, text=True
    )


def loops_of(loops: str | None) -> str:
    done = python("import der; print(der.loops())", loops)
    assert done.stderr == ""
    return done.stdout.strip()


@pytest.fixture(scope="module")
def fastest() -> str:
    """The loops that run when nothing is asked for."""
    return loops_of(None)


@pytest.fixture
def scene(tmp_path: Path, swing: dict[str, Any]) -> Path:
    swing["rods"][0]["to"] = [1, 0, 0]
    swing["rods"][0]["from"] = [0, 0, 0]
    swing["rods"][0]["material"]["poissons_ratio"] = 0.3
    swing["loads"] = [{"gravity": [0, -9.81, 0]}]
    swing["model"] = "spatial"
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump(swing))
    return path


def arrays(folder: Path) -> dict[str, np.ndarray[Any, Any]]:
    found = {}
    with h5py.File(folder / "results.h5", "r") as file:
        file.visititems(
            lambda name, item: (
                found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None
            )
        )
    return {name: values for name, values in found.items() if not name.startswith("checkpoint")}


def run(scene: Path, folder: Path, loops: str | None) -> dict[str, np.ndarray[Any, Any]]:
    done = der_run(scene, "--out", folder, "--quiet", loops=loops)
    assert (done.returncode, done.stderr) == (0, "")
    return arrays(folder)


def test_the_environment_chooses_and_the_summary_says(scene, tmp_path, fastest):
    for loops, expected in [(None, fastest), ("", fastest), ("plain", "plain")]:
        run(scene, tmp_path / "run", loops)
        summary = json.loads((tmp_path / "run/summary.json").read_text())
        assert summary["loops"] == expected
        assert loops_of(loops) == expected


def test_the_same_bits_in_all_processes_and_with_all_loops(scene, tmp_path, fastest):
    first = run(scene, tmp_path / "default", None)
    for loops in ("plain", "plain", fastest):
        again = run(scene, tmp_path / loops, loops)
        assert first.keys() == again.keys()
        for name, values in first.items():
            assert values.tobytes() == again[name].tobytes(), name


def test_loops_that_nobody_knows_are_refused(scene, tmp_path):
    done = der_run(scene, "--out", tmp_path / "run", loops="avx")
    assert done.returncode == 2
    assert done.stderr == (
        "error: the environment variable DER_LOOPS is 'avx': unset it, or write one of "
        "'plain', 'avx2', 'avx512'\n"
    )
    assert not (tmp_path / "run").exists()
    # What needs no loops works.
    assert der_run("--version", loops="avx").returncode == 0
    assert python("import der", "avx").returncode == 0
    code = f"""
import der
for use in (der.loops, lambda: der.Simulation({str(scene)!r}), lambda: der.run({str(scene)!r})):
    try:
        use()
    except der.DerError as error:
        assert error.status == "environment_error"
        assert str(error).startswith("the environment variable DER_LOOPS is 'avx'")
    else:
        raise AssertionError
"""
    done = python(code, "avx")
    assert (done.returncode, done.stderr) == (0, "")


def test_loops_that_the_processor_does_not_have_are_refused(scene, tmp_path, fastest):
    if fastest == "avx512":
        pytest.skip("this processor has all that there are")
    done = der_run(scene, "--out", tmp_path / "run", loops="avx512")
    assert done.returncode == 2
    assert "'avx512', which this processor or this build does not have" in done.stderr
