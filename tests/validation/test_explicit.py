"""Explicit steps stay stable while the rod gets stiffer: compressed edges bend more stiffly.

Reference for the motion: the same mesh under `tr_bdf2`, an implicit method that no stable step
concerns, in steps whose own error is measured by halving them.
"""

import der
import numpy as np
import pytest

EXPLICIT = [info.name for info in der.steppers() if not info.implicit]


def soft_arm(nodes, modulus, radius=0.05, curvature="angle", **time):
    """An arm so soft that its own weight changes edges by tens of per cent as it whips."""
    arm = {
        "name": "arm",
        "nodes": nodes,
        "from": [0, 0],
        "to": [1, 0],
        "cross_section": {"circle": {"radius": radius}},
        "material": {"youngs_modulus": modulus, "density": 1000},
        "curvature": curvature,
    }
    return {
        "rods": [arm],
        "supports": [{"rod": "arm", "at": "start", "clamp": True}],
        "loads": [{"gravity": [0, -9.81]}],
        "time": {"duration": 2.0, "step": "auto", "integrator": "verlet"} | time,
        "output": {
            "every": 0.02,
            "probes": {"tip": {"rod": "arm", "at": "end", "quantity": "y"}},
        },
    }


def energy_made(result):
    """Energy that the scheme has made or taken, over what gravity has moved [-]."""
    return np.abs(result.work["numerical"]).max() / np.ptp(result.energies["gravity"])


SOFT_ARMS = [(21, 1e4, 0.05), (41, 1e4, 0.05), (41, 2e4, 0.025), (81, 5e4, 0.05)]


@pytest.mark.parametrize("curvature", ["angle", "tangent"])
@pytest.mark.parametrize("integrator", EXPLICIT)
@pytest.mark.parametrize(("nodes", "modulus", "radius"), SOFT_ARMS)
def test_automatic_steps_follow_the_stable_step(nodes, modulus, radius, integrator, curvature):
    """With the limit of the start alone, these create up to a thousand times their energy."""
    scene = soft_arm(nodes, modulus, radius, curvature, integrator=integrator)
    result = der.run(scene)
    assert energy_made(result) < (0.02 if integrator == "verlet" else 0.05)
    assert result.summary["retried_steps"] > 0
    assert result.times == pytest.approx(np.arange(101) * 0.02, abs=1e-12)
    assert result.summary["shortest_step"] < result.summary["step"]


@pytest.mark.parametrize(("nodes", "modulus", "radius"), SOFT_ARMS[:3])
def test_automatic_steps_stay_stable_for_long(nodes, modulus, radius):
    """Edges are crushed again and again; looks at fixed intervals miss some, and made up to a
    thousand times the energy."""
    result = der.run(soft_arm(nodes, modulus, radius, duration=12.0))
    assert energy_made(result) < 0.005


def test_a_push_within_one_frame_does_not_outrun_the_looks():
    """The push presses the rod to three fifths. Frames set the whole steps: they make a difference
    of the order of the larger one's error, not that of a run that blows up."""
    scene = soft_arm(21, 1e5, curvature="tangent", duration=1.0)
    force = {"times": [0, 0.5, 1], "values": [[0, 0], [-300, 5], [0, 0]]}
    scene["loads"] = [{"point_force": {"rod": "arm", "at": "end", "force": force}}]
    pushed = []
    for every in (0.02, 0.0002):
        scene["output"]["every"] = every
        result = der.run(scene)
        assert np.abs(result.work["numerical"]).max() < 0.002 * np.abs(result.work["loads"]).max()
        pushed.append(result.probes["tip"][-1])
    assert pushed[0] == pytest.approx(pushed[1], abs=5e-3)


def test_a_shape_that_a_program_writes_is_looked_at():
    simulation = der.Simulation(soft_arm(21, 1e5, duration=0.6))
    simulation.step(20)
    positions = np.array(simulation.positions)
    positions[:, 0] *= 0.8
    positions[:, 1] += 0.003 * np.linspace(0, 1, 21) ** 2

    def energy():
        now = simulation.energies
        return now.kinetic + now.stretch + now.bend + now.gravity

    simulation.positions[...] = positions
    before = energy()
    while not simulation.finished:
        simulation.step()
    assert energy() == pytest.approx(before, rel=0.01)


def test_a_smallest_step_that_is_not_stable_is_a_mistake_of_the_scene():
    with pytest.raises(der.DerError, match=r"time.minimum_step of 1 s leaves no stable step"):
        der.Simulation(soft_arm(21, 1e5, minimum_step=1.0))


def test_a_smallest_step_just_below_the_automatic_one_is_no_obstacle():
    plan = der.Simulation(soft_arm(21, 1e7)).time_step
    simulation = der.Simulation(soft_arm(21, 1e7, minimum_step=0.9 * plan))
    simulation.step(20)
    assert simulation.counters.most_pieces == 1


def test_the_stable_step_of_a_stiff_rod_needs_no_smallest_step_in_a_long_run():
    simulation = der.Simulation(soft_arm(21, 2e11, duration=1e6))
    simulation.step(100)
    assert simulation.time > 0


def test_automatic_steps_are_accurate_where_the_rod_gets_stiffer():
    automatic = der.run(soft_arm(81, 5e4)).probes["tip"]
    coarse, fine = (
        der.run(soft_arm(81, 5e4, integrator="tr_bdf2", step=step)).probes["tip"]
        for step in (2e-4, 1e-4)
    )
    own_error = np.abs(coarse - fine).max() / 3
    assert own_error < 2e-3
    assert automatic == pytest.approx(fine, abs=2e-3 + own_error)


@pytest.mark.parametrize("integrator", EXPLICIT)
def test_a_step_that_becomes_too_long_ends_the_run_by_name(integrator):
    step = 2.0 / 8900  # nine tenths of the limit at the start
    with pytest.raises(der.DivergedError) as error:
        der.run(soft_arm(81, 5e4, integrator=integrator, step=step, duration=8900 * step))
    message = str(error.value)
    assert f"stable step of {integrator}" in message
    assert "which bend at node" in message
    assert "from t = 1." in message  # long after the start
    assert "step: auto" in message
    assert "allow_unstable: true" in message


def test_verify_takes_steps_that_stay_stable():
    """Equal steps as short as the shortest automatic ones: longer ones fail with 81 nodes."""
    scenario = der.Scenario.from_dict(soft_arm(21, 1e4, duration=1.4))
    assert der.run(scenario).summary["shortest_step"] < der.Simulation(scenario).time_step
    verification = der.verify(scenario)
    assert not [note for note in verification.notes if "failed" in note]
    assert verification["tip"].time is not None


def test_what_the_scene_allows_is_not_stopped():
    step = 2.0 / 8900
    time = {"step": step, "duration": 8900 * step, "allow_unstable": True}
    with pytest.warns(der.UnreliableResultWarning):
        assert energy_made(der.run(soft_arm(81, 5e4, **time))) > 1.0


def test_restored_pieces_go_on_bit_for_bit():
    simulation = der.Simulation(soft_arm(41, 1e4))
    while simulation.counters.retried_steps < 5:
        simulation.step()
    assert simulation.counters.most_pieces > 1
    simulation.step(3)
    saved = simulation.save_state()
    simulation.step(50)
    there = simulation.positions.copy()
    simulation.restore_state(saved)
    simulation.step(50)
    assert np.array_equal(simulation.positions, there)


def squeezed(tmp_path, factor, **time):
    """A scene that starts from a run that has pressed a soft rod to a share of its length."""
    scene = soft_arm(21, 5e4)
    del scene["loads"]
    prescribe = {"x": {"times": [0, 1], "values": [0, factor - 1]}, "y": 0}
    scene["supports"].append({"rod": "arm", "at": "end", "prescribe": prescribe})
    press = {"integrator": "tr_bdf2", "step": 0.01, "duration": 1.0}
    der.run({**scene, "time": press, "output": {"every": 1.0}}, out=tmp_path / "pressed")
    scene["supports"][1]["prescribe"] = {"x": factor - 1, "y": 0}
    # The drawn end is at 1: held there by its displacement.
    return {
        **scene,
        "start_from": str(tmp_path / "pressed"),
        "time": {"duration": 0.5, "integrator": "verlet"} | time,
        "output": {"every": 0.05},
    }


def test_the_first_step_is_judged_where_the_run_starts(tmp_path):
    """A rod compressed to 0.6 of its length bends more stiffly than the undeformed one."""
    drawn = der.Simulation(soft_arm(21, 5e4)).time_step
    step = 0.05 / np.ceil(0.05 / drawn)
    with pytest.raises(der.DerError, match="above the stable step of verlet"):
        der.Simulation(squeezed(tmp_path, 0.6, step=step))
    result = der.run(squeezed(tmp_path, 0.6, step="auto"))
    assert np.abs(result.work["numerical"]).max() < 0.01 * result.energies["stretch"][0]


def test_a_rod_at_rest_far_away_does_not_shorten_the_steps():
    """Its first edge does not follow on the last one of the arm."""
    scene = soft_arm(21, 1e4)
    weight = -9.81 * 1000 * np.pi * 0.05**2
    scene["loads"] = [{"distributed_force": {"rod": "arm", "force": [0, weight]}}]
    alone = der.run(scene).summary
    scene["rods"].append({**scene["rods"][0], "name": "other", "from": [0, 9], "to": [1, 9]})
    scene["supports"].append({"rod": "other", "at": "start", "clamp": True})
    beside = der.run(scene).summary
    assert alone["shortest_step"] < alone["step"]
    for key in ("step", "shortest_step", "retried_steps"):
        assert beside[key] == alone[key]
