"""Members of a batch, in lanes and out of them: the bits of simulations of their own."""

from __future__ import annotations

import pickle
from typing import Any

import der
import numpy as np
import pytest
from laws.scenes import scenes

MEMBERS = 5  # more than the lanes of a register, so that one member is left over
STEPS = 3
MOVING = [name for name, scene in scenes().items() if "step" in scene.get("time", {})]
RESTING = [name for name, scene in scenes().items() if scene.get("analysis") == "static"]


def varied(scene: dict[str, Any]) -> dict[str, Any]:
    """Stiffnesses of the first rod that differ from member to member."""
    rod = scene["rods"][0]
    key = "cross_section.stiffness.EA" if "material" not in rod else "material.youngs_modulus"
    value = rod
    for part in key.split("."):
        value = value[part]
    return {f"rods.{rod['name']}.{key}": float(value) * np.linspace(0.9, 1.3, MEMBERS)}


def state(thing: Any, *member: int) -> bytes:
    return pickle.dumps(thing.save_state(*member))


@pytest.mark.filterwarnings("ignore::der.DerWarning")
@pytest.mark.parametrize("name", MOVING)
def test_steps(name: str) -> None:
    scene = scenes()[name]
    vary = varied(scene)
    batch = der.Batch(scene, MEMBERS, 1, vary=vary)
    batch.step(STEPS)
    assert not batch.failed.any()
    ((path, values),) = vary.items()
    for member, value in enumerate(values):
        alone = der.Simulation(der.Scenario.from_dict(scene).with_(**{path: value}))
        alone.step(STEPS)
        assert state(batch, member) == state(alone), member


@pytest.mark.filterwarnings("ignore::der.DerWarning")
@pytest.mark.parametrize("name", RESTING)
def test_equilibria(name: str) -> None:
    scene = scenes()[name]
    vary = varied(scene)
    batch = der.Batch(scene, MEMBERS, 1, vary=vary)
    batch.equilibrium()
    assert not batch.failed.any()
    ((path, values),) = vary.items()
    for member in (0, MEMBERS - 1):
        alone = der.Simulation(der.Scenario.from_dict(scene).with_(**{path: values[member]}))
        alone.equilibrium()
        assert state(batch, member) == state(alone), member


def test_most_motions_go_in_lanes() -> None:
    """So that the bits above are those of lanes."""
    in_lanes = [der.Batch(scenes()[name], MEMBERS, 1).lanes > 1 for name in MOVING]
    assert np.mean(in_lanes) > 0.5
