"""Shared parts of the validation tests: reference numbers, scenes of configs/, fitted orders."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path

import der
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def reference() -> Callable[[str, str], float]:
    """A number of references/values.json, made by the independent solutions beside it."""
    problems = json.loads((ROOT / "tests/validation/references/values.json").read_text())

    def value(problem: str, name: str) -> float:
        return problems[problem]["values"][name]["value"]

    return value


@pytest.fixture(scope="session")
def spatial_reference() -> Callable[[str, str], float]:
    """A number of references/spatial_values.json, of rods in space."""
    file = ROOT / "tests/validation/references/spatial_values.json"
    problems = json.loads(file.read_text())

    def value(problem: str, name: str) -> float:
        return problems[problem]["values"][name]["value"]

    return value


@pytest.fixture(scope="session")
def scene() -> Callable[[str], der.Scenario]:
    """A scene of configs/ by its name."""
    return lambda name: der.load(ROOT / "configs" / f"{name}.yaml")


@pytest.fixture(scope="session")
def fitted_order() -> Callable[[Sequence[float], Sequence[float]], float]:
    """Slope of log(error) against log(size) by least squares."""

    def slope(sizes: Sequence[float], errors: Sequence[float]) -> float:
        return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])

    return slope
