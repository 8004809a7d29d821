"""Recompute `values.json` and `spatial_values.json` and compare them with the quoted numbers.

    python -m references.generate                    all problems
    python -m references.generate elastica swing     only these, the rest of the file stays

A problem of `PACKAGES` needs one more package, and is left out of all problems without it.
Started in `tests/validation`. Ends with status 1 if a quoted number lies outside its own
error and ours. The rods in the plane are in one file, those in space in the other. Layout:

    {problem: {about, method, values: {key: {value, error, unit, quoted?, quoted_error?}}}}
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import json
import time
from pathlib import Path
from typing import Any

from .record import Problem, Reference

FILE = Path(__file__).with_name("values.json")
SPATIAL_FILE = Path(__file__).with_name("spatial_values.json")
PLANAR = (
    "falling_spheres",
    "elastica",
    "extensible_beam",
    "swing",
    "arch",
    "frequencies",
    "springs",
)
SPATIAL = (
    "bent_cantilever",
    "helix",
    "princeton_beam",
    "spatial_buckling",
    "helical_buckling",
    "hanging_coil",
    "spatial_frequencies",
    "curved_twisted_rod",
    "springs_in_space",
    "bearing",
    "writhe",
    "deployable_ring",
    "spatial_motion",
    "falling_strip",
    "elbow",
)
PROBLEMS = PLANAR + SPATIAL
PACKAGES = {"elbow": "exudyn"}  # not among those of the tests; the extra `peers` has them


def load_values(file: Path = FILE) -> dict[str, Any]:
    """The stored reference numbers; an empty dict when there is no file yet."""
    if not file.exists():
        return {}
    stored: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return stored


def compute(name: str) -> Problem:
    """Run `references()` of the module `name`."""
    problem: Problem = importlib.import_module(f".{name}", __package__).references()
    return problem


def _entry(reference: Reference) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "value": reference.value,
        "error": float(f"{reference.error:.2g}"),
        "unit": reference.unit,
    }
    if reference.quoted is not None:
        entry |= {"quoted": reference.quoted, "quoted_error": reference.quoted_error}
    return entry


def store(problem: Problem) -> None:
    """Put one problem into its file and leave the others as they are."""
    file = SPATIAL_FILE if problem.name in SPATIAL else FILE
    everything = load_values(file)
    everything[problem.name] = {
        "about": problem.about,
        "method": problem.method,
        "values": {key: _entry(value) for key, value in problem.values.items()},
    }
    ordered = {name: everything[name] for name in PROBLEMS if name in everything}
    file.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")


def table(problem: Problem) -> tuple[str, bool]:
    """Lines to print, and whether every quoted number agrees."""
    lines, good = [], True
    for key, item in problem.values.items():
        if isinstance(item.value, list):
            last = item.value[-1]
            lines.append(
                f"{key:46s} {len(item.value)} values, last {last: .12g} +- {item.error:.0e}"
            )
            continue
        line = f"{key:46s} {item.value: .14e} +- {item.error:.0e} {item.unit:8s}"
        if item.quoted is not None:
            gap = abs(item.value - item.quoted)
            agrees = gap <= item.quoted_error * (1.0 + 1e-9) + item.error
            good = good and agrees
            line += f" quoted {item.quoted:.8g}, off by {gap:.1e} {'ok' if agrees else 'DISAGREES'}"
        lines.append(line)
    return "\n".join(lines), good


def main() -> int:
    """Command line entry; returns the exit status."""
    parser = argparse.ArgumentParser(description="recompute the reference numbers")
    parser.add_argument("problems", nargs="*", metavar="problem", help=", ".join(PROBLEMS))
    named = parser.parse_args().problems
    chosen = named or list(PROBLEMS)
    unknown = sorted(set(chosen) - set(PROBLEMS))
    if unknown:
        parser.error(f"no problem called {', '.join(unknown)}; there are {', '.join(PROBLEMS)}")
    missing = {k: v for k, v in PACKAGES.items() if importlib.util.find_spec(v) is None}
    for name in set(named) & set(missing):
        parser.error(f"{name} needs the package {missing[name]}: pip install {missing[name]}")
    agree = True
    for name in chosen:
        if name in missing:
            print(f"== {name}: left out, it needs the package {missing[name]}\n", flush=True)
            continue
        begin = time.perf_counter()
        problem = compute(name)
        store(problem)
        text, good = table(problem)
        agree = agree and good
        print(
            f"== {name} ({time.perf_counter() - begin:.1f} s): {problem.method}\n{text}\n",
            flush=True,
        )
    return 0 if agree else 1


if __name__ == "__main__":
    raise SystemExit(main())
