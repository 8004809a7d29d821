"""A short run of what tests/survival/run.py does for every stepper and analysis, 100 kills each."""

from pathlib import Path

import der
import numpy as np
import pytest
from survival import damage, fill_disk, kill, prepare, scenes, two_at_once

SHORT = 600  # steps


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("survival")


@pytest.mark.parametrize("name", ["bdf2", "verlet", "continuation"])
def test_killed_runs_lose_nothing_and_go_on(name: str, folder: Path) -> None:
    subject = prepare(name, scenes(SHORT)[name], folder)
    rng = np.random.default_rng(1)
    assert [fault for _ in range(3) for fault in kill(subject, rng, folder / "out")] == []


def test_full_disks_and_two_runs_in_a_folder(folder: Path) -> None:
    subject = prepare("tr_bdf2", scenes(SHORT)["tr_bdf2"], folder)
    for limit in (2000, 40_000, 100_000):
        assert fill_disk(subject, limit, folder / "full") == []
    assert two_at_once(subject, folder / "both") == []


def test_damaged_files_are_refused_or_have_the_same_data(folder: Path) -> None:
    subject = prepare("sdirk4", scenes(100)["sdirk4"], folder)
    refused, faults = damage(subject, np.random.default_rng(1), 40, folder / "damaged")
    assert faults == []
    assert refused > 10


def test_every_stepper_and_analysis_is_killed() -> None:
    assert {s.name for s in der.steppers()} < scenes().keys()
    assert {"static", "modes", "buckling", "continuation"} < scenes().keys()
