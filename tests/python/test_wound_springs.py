"""Whole turns of springs against turning, which positions do not tell."""

from __future__ import annotations

from typing import Any

import der
import numpy as np
import pytest

STIFFNESS = 0.01  # [N m/rad]


def wound(moment: float, *springs: Any, **more: Any) -> der.Scenario:
    """A planar rod, held at its start, that a moment at its end winds up."""
    rod = {
        "name": "rod",
        "nodes": 41,
        "from": [0, 0],
        "to": [1, 0],
        "cross_section": {"stiffness": {"EA": 1000.0, "EI": 0.05, "mass_per_length": 0.1}},
    }
    holds = {"rod": "rod", "at": "start", "fix": ["x", "y"]}
    supports = [{**holds, "spring": {"rotational_stiffness": STIFFNESS}}, *springs]
    load = {"moment": {"rod": "rod", "at": "end", "moment": moment}}
    scene = {"rods": [rod], "supports": supports, "loads": [load], **more}
    if "time" not in scene:
        scene.setdefault("analysis", "static")
    return der.Scenario.from_dict(scene)


@pytest.mark.parametrize("moment", [0.08, -0.15, 0.02])
def test_reactions_and_moments_of_wound_springs(moment, tmp_path):
    """The spring has wound by 8, -15 and 2 rad; it bears the moment all the same."""
    result = der.run(wound(moment))
    result.save(tmp_path / "run")
    for run in (result, der.open_run(tmp_path / "run")):
        assert run.reactions()[0].moment[-1] == pytest.approx(-moment, rel=1e-6)
        assert run.along("rod", "moment")[1][-1] == pytest.approx(moment, rel=1e-6)


def test_two_wound_springs_side_by_side():
    """Each bears its part of the moment: the second one turns with the rod between them."""
    beside = {"rod": "rod", "at": 0.1, "spring": {"rotational_stiffness": 2 * STIFFNESS}}
    probes = {f"m{i}": {"support": i, "quantity": "reaction_moment"} for i in (0, 1)}
    result = der.run(wound(0.5, beside, output={"probes": probes}))
    found = [reaction.moment[-1] for reaction in result.reactions()]
    assert found == pytest.approx([result.probes[f"m{i}"][-1] for i in (0, 1)], rel=1e-6)
    assert sum(found) == pytest.approx(-0.5, rel=1e-6)
    assert abs(found[0]) / STIFFNESS > 4 * np.pi


def test_a_path_that_winds_a_spring():
    """Every point of the path, from no moment on to three turns."""
    path = {"continuation": {"vary": "loads", "from": 0.0, "to": 1.0}}
    result = der.run(wound(0.2, analysis=path))
    factors = result.path.factor
    moments = result.reactions()[0].moment
    assert moments == pytest.approx(-0.2 * np.asarray(factors), abs=1e-6)


#: A run that lets the moment wind the spring by a turn and a half, in steps that frames skip.
OVER_TIME = {
    "loads": [
        {"moment": {"rod": "rod", "at": "end", "moment": {"times": [0, 1], "values": [0, 0.1]}}},
        {"damping": {"coefficient": 0.02}},
    ],
    "time": {"duration": 4.0, "step": 0.01},
    "output": {"every": 4.0, "probes": {"m": {"support": 0, "quantity": "reaction_moment"}}},
}


def test_readings_of_a_motion(tmp_path):
    """Each reading of the frames finds the same, however far the edge turns between two of them."""
    result = der.run(wound(0.1, **OVER_TIME))
    result.save(tmp_path / "run")
    moment = result.probes["m"]
    assert abs(moment[-1]) / STIFFNESS > 2 * np.pi
    for run in (result, der.open_run(tmp_path / "run")):
        slopes = run.along("rod", "slope")[1]
        for _ in range(2):
            assert run.reactions()[0].moment == pytest.approx(moment, abs=1e-12)
            assert run.along("rod", "slope")[1] == pytest.approx(slopes, abs=0.0)
        assert slopes[-1, 0] * STIFFNESS == pytest.approx(-moment[-1], rel=1e-3)


@pytest.mark.parametrize("start", ["equilibrium", "folder", "second run", "restored"])
def test_runs_that_begin_wound(start, tmp_path):
    """The turns of the first frame are those of the state, not of the shape as drawn."""
    held = {
        **OVER_TIME,
        "loads": [{"moment": {"rod": "rod", "at": "end", "moment": 0.1}}],
        "time": {"duration": 0.04, "step": 0.01},
        "output": {**OVER_TIME["output"], "every": 0.01},
    }
    equilibrium = wound(0.1)
    if start == "folder":
        der.run(equilibrium).save(tmp_path / "before")
        result = der.run(wound(0.1, **held, start_from=str(tmp_path / "before")))
    else:
        simulation = der.Simulation(wound(0.1, **held, start_from="equilibrium"))
        if start == "second run":
            simulation.run(until=0.02)
        if start == "restored":
            state = simulation.save_state()
            simulation = der.Simulation(wound(0.1, **held))
            simulation.restore_state(state)
        result = simulation.run()
    assert result.probes["m"] == pytest.approx(-0.1, rel=1e-6)
    assert result.reactions()[0].moment == pytest.approx(-0.1, rel=1e-6)
