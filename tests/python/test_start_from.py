"""Runs that start from an equilibrium, or from the end of another run."""

import der
import numpy as np
import pytest


def test_a_dynamic_run_from_its_equilibrium_stays_there(swing):
    swing["start_from"] = "equilibrium"
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    start = simulation.positions.copy()
    assert np.abs(simulation.gradient()).max() < 1e-6
    assert not np.array_equal(start, simulation.model.initial_positions)
    simulation.step(20)
    assert simulation.positions == pytest.approx(start, abs=1e-7)


def test_a_run_goes_on_from_the_last_frame_of_another(swing, tmp_path):
    first = der.run(swing, out=tmp_path / "first")
    swing["start_from"] = str(tmp_path / "first")
    simulation = der.Simulation(der.Scenario.from_dict(swing))
    assert np.array_equal(simulation.positions, first.positions[-1])
    assert np.array_equal(simulation.velocities, first.velocities[-1])
    assert simulation.time == 0.0


def test_a_static_run_from_a_saved_state(swing, tmp_path):
    der.run(swing, out=tmp_path / "first")
    settled = {key: value for key, value in swing.items() if key not in ("time", "output")}
    settled |= {"analysis": "static", "start_from": str(tmp_path / "first")}
    assert der.run(settled).status == "static_converged"


def test_a_run_of_other_rods_is_refused(swing, tmp_path):
    der.run(swing, out=tmp_path / "first")
    swing["rods"][0]["nodes"] += 1
    swing["start_from"] = str(tmp_path / "first")
    with pytest.raises(der.DerError, match="needs a run of the same rods"):
        der.Simulation(der.Scenario.from_dict(swing))


def test_a_folder_without_a_run_is_refused(swing, tmp_path):
    swing["start_from"] = str(tmp_path)
    with pytest.raises(der.DerError, match="cannot open"):
        der.Simulation(der.Scenario.from_dict(swing))
