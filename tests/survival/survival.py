"""Survival of kills, full disks, folders that two programs want, and damaged files.

Each function tries one thing and returns what went wrong, in sentences; none is the aim.
"""

from __future__ import annotations

import dataclasses
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import der
import h5py
import numpy as np

DER_RUN = os.environ.get("DER_RUN", str(Path(sys.executable).with_name("der_run")))
Random = np.random.Generator

_ROD: dict[str, Any] = {
    "name": "arm",
    "nodes": 9,
    "from": [0, 0],
    "to": [1, 0],
    "cross_section": {"stiffness": {"EA": 1e3, "EI": 1, "GJ": 1, "mass_per_length": 1}},
}


def motion(stepper: str, steps: int = 4000) -> dict[str, Any]:
    """A cantilever that is shaken, with a frame every twenty steps; in space if the stepper can."""
    in_space = stepper != "energy_momentum"
    table = {"sine": {"amplitude": [0, 1, 0.3] if in_space else [0, 1], "frequency": 3.0}}
    rod = dict(_ROD)
    if in_space:
        rod |= {"from": [0, 0, 0], "to": [1, 0, 0]}
        rod["cross_section"] = {"stiffness": {**_ROD["cross_section"]["stiffness"]}}
    return {
        "model": "spatial" if in_space else "planar",
        "rods": [rod],
        "supports": [{"rod": "arm", "at": "start", "clamp": True}],
        "loads": [{"point_force": {"rod": "arm", "at": "end", "force": table}}],
        "time": {"duration": 5e-4 * steps, "step": 5e-4, "integrator": stepper},
        "output": {
            "every": 0.01,
            "probes": {"tip": {"rod": "arm", "at": "end", "quantity": "y"}},
        },
    }


def analyses() -> dict[str, dict[str, Any]]:
    """A scene for each analysis without time."""
    held = {"rods": [{**_ROD, "nodes": 41}]}
    held["supports"] = [{"rod": "arm", "at": "start", "clamp": True}]  # type: ignore[list-item]
    held["loads"] = [{"point_force": {"rod": "arm", "at": "end", "force": [-1, 0.1]}}]  # type: ignore[list-item]
    path = {"continuation": {"to": 4, "step": 0.01, "points": 1000}}
    return {
        "static": {**held, "analysis": "static"},
        "modes": {**held, "analysis": "modes"},
        "buckling": {
            **held,
            "loads": [{"point_force": {"rod": "arm", "at": "end", "force": [-1, 0]}}],
            "analysis": "buckling",
        },
        "continuation": {**held, "analysis": path},
    }


def scenes(steps: int = 4000) -> dict[str, dict[str, Any]]:
    """All that is killed: a motion with every registered stepper, every analysis."""
    return {s.name: motion(s.name, steps) for s in der.steppers()} | analyses()


@dataclasses.dataclass
class Subject:
    """A scene file and its undisturbed run."""

    name: str
    scene: Path
    whole: Path
    seconds: float

    @property
    def moves(self) -> bool:
        return self.name not in analyses()


def prepare(name: str, scene: dict[str, Any], folder: Path) -> Subject:
    """Write the scene and run it to its end."""
    path = folder / f"{name}.json"
    path.write_text(json.dumps(scene), encoding="utf-8")
    begun = time.perf_counter()
    done = _run(path, folder / f"{name}-whole")
    seconds = time.perf_counter() - begun
    if done.returncode:
        raise RuntimeError(f"{name}: {done.stderr}")
    return Subject(name, path, folder / f"{name}-whole", seconds)


def _command(scene: Path, out: Path, *more: str) -> list[str]:
    return [DER_RUN, str(scene), "--out", str(out), "--quiet", *more]


def _run(
    scene: Path, out: Path, *more: str, before: Callable[[], None] | None = None
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        _command(scene, out, *more), capture_output=True, text=True, check=False, preexec_fn=before
    )


def kill(subject: Subject, rng: Random, out: Path) -> list[str]:
    """Kill a run at a random moment, read what is left, and go on from there."""
    shutil.rmtree(out, ignore_errors=True)
    process = subprocess.Popen(_command(subject.scene, out), stderr=subprocess.DEVNULL)
    time.sleep(float(rng.uniform(0.0, 1.05 * subject.seconds)))
    saved = _frames(out)
    process.send_signal(signal.SIGKILL)
    process.wait()
    results = out / "results.h5"
    faults = []
    resumable = False
    if results.exists():
        try:
            faults += _differences(out, subject.whole, part=True)
            if _frames(out) < saved:
                faults.append(f"{saved - _frames(out)} saved frames are lost")
        except Exception as error:  # whatever it raises, the file cannot be read
            faults.append(f"unreadable: {type(error).__name__}: {error}")
        resumable = subject.moves
    done = _run(subject.scene, out, *(["--resume"] if resumable else []))
    if resumable and done.returncode == 1 and "resume" in done.stderr:
        # Killed before the first checkpoint, and told so: it begins again.
        done = _run(subject.scene, out)
    if done.returncode:
        faults.append(f"does not go on: {done.stderr.strip()}")
    else:
        faults += _differences(out, subject.whole, part=False)
    return [f"{subject.name}: {fault}" for fault in faults]


def _frames(folder: Path) -> int:
    """How many frames the file of a run that may go on has; 0 while it cannot be read."""
    try:
        with h5py.File(folder / "results.h5", locking=False) as file:
            return len(file["time"])
    except (OSError, KeyError):
        return 0


def _differences(folder: Path, whole: Path, *, part: bool) -> list[str]:
    """The differences from the undisturbed run; only the first frames count for a `part`."""
    found, full = der.open_run(folder), der.open_run(whole)
    frames = len(found.times)
    if not part and frames != len(full.times):
        return [f"{frames} frames, not {len(full.times)}"]
    faults = []
    for name, one, other in [
        ("time", found.times, full.times),
        ("positions", found.positions, full.positions),
        ("velocities", found.velocities, full.velocities),
        *((key, found.energies[key], full.energies[key]) for key in full.energies),
        *((key, found.work[key], full.work[key]) for key in full.work),
        *(
            (key, np.asarray(found.probes[key]), np.asarray(full.probes[key]))
            for key in full.probes
        ),
    ]:
        if one.tobytes() != other[:frames].tobytes():
            faults.append(f"other {name} than without the kill")
    return faults


def fill_disk(subject: Subject, limit: int, out: Path) -> list[str]:
    """Run with files that cannot grow beyond a limit [bytes]."""
    shutil.rmtree(out, ignore_errors=True)

    def limit_files() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writing fails instead
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = _run(subject.scene, out, before=limit_files)
    faults = []
    if done.returncode == 0:
        return _differences(out, subject.whole, part=False)
    if done.returncode != 4 or "results.h5" not in done.stderr:
        faults.append(f"exit code {done.returncode}: {done.stderr.strip()}")
    if (out / "summary.json").exists():
        faults.append("there is a summary of a run that was not saved")
    if (out / "results.h5").exists():
        try:
            faults += _differences(out, subject.whole, part=True)
        except Exception as error:
            faults.append(f"unreadable: {type(error).__name__}: {error}")
    return [f"{subject.name}, {limit} bytes: {fault}" for fault in faults]


def two_at_once(subject: Subject, out: Path) -> list[str]:
    """Start two runs into one folder: one writes, the other is refused."""
    shutil.rmtree(out, ignore_errors=True)
    both = [
        subprocess.Popen(_command(subject.scene, out), stderr=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    said = [process.communicate()[1] for process in both]
    codes = [process.returncode for process in both]
    faults = _differences(out, subject.whole, part=False)
    if sorted(codes) == [0, 0]:
        return faults  # one was over before the other began
    if sorted(codes) != [0, 4] or "another run is writing" not in said[codes.index(4)]:
        faults.append(f"exit codes {codes}: {said}")
    return [f"{subject.name}: {fault}" for fault in faults]


def damage(subject: Subject, rng: Random, count: int, folder: Path) -> tuple[int, list[str]]:
    """Cut `count` copies of a file short, or flip a bit of it, and read them in a process apart.

    Returns how many of them are refused; the others must have the data of the whole file.
    """
    shutil.rmtree(folder, ignore_errors=True)
    whole = (subject.whole / "results.h5").read_bytes()
    for number in range(count):
        copy = folder / f"{number:05d}"
        copy.mkdir(parents=True)
        data = bytearray(whole)
        if rng.random() < 0.3:
            del data[int(rng.integers(len(data))) :]
        else:
            # Every other flip is in the head, where the structure of the file is.
            end = len(data) if rng.random() < 0.5 else min(len(data), 16384)
            place = int(rng.integers(end))
            data[place] ^= 1 << int(rng.integers(8))
        (copy / "results.h5").write_bytes(data)
    reader = [sys.executable, __file__, str(folder), str(subject.whole)]
    done = subprocess.run(reader, capture_output=True, text=True, check=False, timeout=600)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    faults = [line["fault"] for line in lines if line["fault"]]
    if done.returncode or len(lines) != count:
        last = f"{len(lines):05d}"
        faults.append(f"the reader died at {last}, code {done.returncode}: {done.stderr[-500:]}")
    return sum(line["refused"] for line in lines), [f"{subject.name}: {f}" for f in faults]


def _read_all(folder: Path, whole: Path) -> None:
    """Read every damaged copy; a line of JSON for each."""
    for copy in sorted(folder.iterdir()):
        refused, faults = False, []
        try:
            faults = _differences(copy, whole, part=False)
        except ValueError as error:
            refused = True
            if "results.h5" not in str(error):
                faults = [f"the message does not name the file: {error}"]
        except Exception as error:
            faults = [f"raises {type(error).__name__}: {error}"]
        fault = f"{copy.name}: {'; '.join(faults)}" if faults else ""
        print(json.dumps({"refused": refused, "fault": fault}), flush=True)


if __name__ == "__main__":
    _read_all(Path(sys.argv[1]), Path(sys.argv[2]))
