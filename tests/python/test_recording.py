"""Results of states that a program has kept: loops of steps, and members of batches."""

import der
import matplotlib.pyplot as plt
import numpy as np
import pytest

FIELDS = ("times", "steps", "positions", "velocities", "turns")


def test_a_loop_of_steps_is_the_run(swing):
    """Every number is that of the run which saves a frame at every step."""
    swing["output"]["every"] = swing["time"]["step"]
    simulation = der.Simulation(swing)
    recording = simulation.recording()
    while not simulation.finished:
        simulation.step()
        recording.add()
    found, run = recording.result(), der.run(swing)
    for name in FIELDS:
        np.testing.assert_array_equal(getattr(found, name), getattr(run, name))
    for name in ("energies", "work", "probes"):
        mine, its = getattr(found, name), getattr(run, name)
        assert list(mine) == list(its)
        for key in mine:
            np.testing.assert_array_equal(mine[key], its[key])
    assert found.probes["tip"].summary == run.probes["tip"].summary
    assert found.probes["tip"].unit == "m"
    for key in ("status", "time", "steps", "energies", "work", "probes", "model", "integrator"):
        assert found.summary[key] == run.summary[key]
    assert "newton_iterations" not in found.summary


@pytest.mark.parametrize("name", ["finger", "twisted_ring"])
def test_steps_that_follow_a_tolerance(name):
    """Between the saved frames of a run; sections and probes as the simulation has them."""
    simulation = der.Simulation(f"example:{name}")
    recording, probes, directors = simulation.recording(), [], []

    def keep():
        probes.append(list(simulation.probes.values()))
        directors.append(simulation.directors.copy())

    keep()
    for _ in range(8):
        simulation.step(2)
        recording.add()
        keep()
    result = recording.result()
    assert result.status == "stopped"
    assert result.times[-1] == simulation.time
    np.testing.assert_array_equal(np.transpose(list(result.probes.values())), probes)
    np.testing.assert_array_equal(result.positions[-1], simulation.positions)
    np.testing.assert_allclose(result.directors, directors, atol=1e-14)


def test_a_recording_goes_on_where_the_program_is(swing, tmp_path):
    """Later starts, forces of the program, saving, opening, drawing, viewing."""
    simulation = der.Simulation(swing)
    simulation.step(7)
    recording = simulation.recording()
    simulation.extra_force[-1, 1] = 0.3
    for _ in range(3):
        simulation.step(5)
        recording.add()
    result = recording.result()
    assert result.times == pytest.approx([0.014, 0.024, 0.034, 0.044])
    assert result.work["loads"][-1] != der.run(swing).work["loads"][4]
    np.testing.assert_array_equal(result.positions[-1], simulation.positions)
    read = der.open_run(result.save(tmp_path / "run"))
    np.testing.assert_array_equal(read.positions, result.positions)
    assert read.summary == result.summary
    assert len(result.plot("shapes", times=[0.014, 0.044]).axes[0].lines) >= 2
    plt.close("all")


def test_a_static_scene_has_one_frame(tube):
    tube["analysis"] = "static"
    del tube["time"], tube["output"]["every"]
    simulation = der.Simulation(tube)
    recording = simulation.recording()
    assert recording.result().status == "static_converged"
    simulation.equilibrium()
    recording.add()
    with pytest.raises(ValueError, match="a static scene has one frame and no times; give it"):
        recording.result()


def test_members_of_batches_as_results(swing):
    moduli = np.array([5e6, 1e7, 2e7])
    key = "rods.arm.material.youngs_modulus"
    batch = der.Batch(swing, 3, vary={key: moduli})
    batch.step(13)
    for member, modulus in enumerate(moduli):
        alone = der.Simulation(der.load(swing, {key: modulus}))
        alone.step(13)
        result = batch.result(member)
        assert result.positions.shape == (1, 11, 2)
        np.testing.assert_array_equal(result.positions[0], alone.positions)
        assert result.times == [alone.time]
        assert result.energies["bend"] == [alone.energies.bend]
        assert result.probes["tip"][0] == alone.probes["tip"]
        assert result.scenario.to_dict()["rods"][0]["material"]["youngs_modulus"] == modulus
    with pytest.raises(IndexError, match="there is no member 3"):
        batch.result(3)


def test_failed_members_as_results(swing):
    batch = der.Batch(swing, 3)
    batch.step(4)
    batch.extra_force[1, 5, 1] = 1e200
    batch.step(1)
    assert batch.failed.tolist() == [False, True, False]
    result = batch.result(1)
    assert result.status == batch.failures[0].status
    assert result.summary["failure"]["message"] == batch.failures[0].message
    assert batch.result(0).status == "stopped"
    assert "3 members of 11 nodes, 1 failed, t = 0.008 to 0.01 s" in repr(batch)
    html = batch._repr_html_()
    assert result.status in html
    assert "data:image/png" in html
    batch.positions[1, 5] = np.nan
    with pytest.raises(der.DivergedError, match="finite"):
        batch.result(1)


def test_batches_are_drawn(swing):
    batch = der.Batch(
        swing, 20, vary={"rods.arm.material.youngs_modulus": np.geomspace(1e6, 1e8, 20)}
    )
    batch.step(20)
    figure = batch.plot()
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert labels[:8] == [f"member {n}" for n in (0, 2, 5, 8, 10, 13, 16, 19)]
    lines = {line.get_label(): line.get_xydata() for line in figure.axes[0].lines}
    np.testing.assert_array_equal(lines["member 13"], batch.positions[13])
    assert "8 of 20 members" in figure.axes[0].get_title("left")
    chosen = batch.plot([4, 5]).axes[0].get_legend().get_texts()
    assert [text.get_text() for text in chosen][:2] == ["member 4", "member 5"]
    with pytest.raises(ValueError, match="no member to draw"):
        batch.plot([])
    plt.close("all")


def test_simulations_say_what_they_are(swing):
    simulation = der.Simulation(swing)
    simulation.step(10)
    assert repr(simulation) == (
        "<der.Simulation of 'Swinging rod': t = 0.02 s of 0.2 s, 11 nodes, model planar>"
    )
