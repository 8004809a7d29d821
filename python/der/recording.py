"""Results of states that a program has kept, such as those of its own loop of steps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from der import _core
from der._core import RunRecording, Scenario, State
from der.probe_series import Probes, ProbeSeries
from der.result import Result, to_result
from der.run_data import Sections

#: What a summary tells of the work of a run; states do not tell it.
_COSTS = ("newton_iterations", "retried_steps", "rejected_steps", "shortest_step", "wall_seconds")


class Recording:
    """States of a simulation that are kept as frames while a program steps it.

    `Simulation.recording` makes one, with the present state as its first frame.

    Attributes
    ----------
    states
        The states kept so far.
    """

    def __init__(self, simulation: _core.Simulation) -> None:
        self._simulation = simulation
        self.states: list[State] = [simulation.save_state()]

    def add(self) -> None:
        """Keep the present state as the next frame."""
        self.states.append(self._simulation.save_state())

    def result(self) -> Result:
        """Return the frames as a result, to draw, save, view and export.

        Extremes of probes are those of the frames. Forces that a program adds, and supports that
        `Simulation.prescribe` moves, are not drawn.

        Raises
        ------
        ValueError
            If there are several frames of a static scene, whose result has one.
        """
        return result_of(self._simulation.scenario, self.states)

    def __repr__(self) -> str:
        """Return title and size in one line."""
        times = " to ".join(f"{state.time:g}" for state in (self.states[0], self.states[-1]))
        title, count = self._simulation.scenario.title, len(self.states)
        return f"<der.Recording of {title!r}: {count} frames, t = {times} s>"


def result_of(scenario: Scenario, states: Sequence[State]) -> Result:
    """Return states of simulations of a scene as the frames of a result.

    For a static scene this is the answer of its analysis, searched from the one state.

    Raises
    ------
    ValueError
        If there are several states of a static scene.
    DerError
        If a state has numbers that are not finite, or the analysis of a static scene fails.
    """
    if scenario.is_static:
        if len(states) > 1:
            raise ValueError(
                f"a {scenario.analysis} scene has one frame and no times; give it a 'time' in "
                "place of its 'analysis' to record several states"
            )
        recording = _recorded(_core.Simulation(scenario), states[0])
        return to_result(scenario, recording, list(recording.probes), recording.summary)
    # The twin ends at the first time after the start, so that it takes no step from any such state.
    ends = min((state.time for state in states if state.time > 0.0), default=scenario.duration)
    twin = _core.Simulation(scenario.with_({"time.duration": ends, "output.every": ends}))
    return _joined(scenario, [_recorded(twin, state) for state in states], states[-1])


def _recorded(twin: _core.Simulation, state: State) -> RunRecording:
    """Return a recording whose first frame is a state."""
    twin.restore_state(state)
    recording: RunRecording = twin.record(callback=lambda: False)
    if len(recording.times) == 0 and recording.error is not None:
        raise recording.error
    return recording


def _joined(scenario: Scenario, recordings: Sequence[RunRecording], last: State) -> Result:
    """Return the first frames of recordings as one result, which ends in a state."""
    first = recordings[0]

    def stacked(name: str) -> NDArray[Any]:
        return np.concatenate([getattr(each, name)[:1] for each in recordings])

    def by_name(name: str) -> dict[str, NDArray[np.float64]]:
        rows = [getattr(each, name) for each in recordings]
        return {key: np.array([row[key][0] for row in rows]) for key in rows[0]}

    times, energies, work, probes = stacked("times"), by_name("energies"), by_name("work"), {}
    for name, values in by_name("probes").items():
        least, most = int(values.argmin()), int(values.argmax())
        extremes = {"final": values[-1], "min": values[least], "max": values[most]}
        extremes |= {"t_min": times[least], "t_max": times[most]}
        unit = first.probe_units[name]
        summary: dict[str, Any] = {key: float(value) for key, value in extremes.items()}
        summary["unit"] = unit
        probes[name] = ProbeSeries(values, unit, summary)
    ended = {
        "status": "completed" if last.time >= scenario.duration * (1.0 - 1e-12) else "stopped",
        "time": last.time,
        "steps": last.step_count,
        "energies": {name: float(values[-1]) for name, values in energies.items()},
        "work": {name: float(values[-1]) for name, values in work.items()},
        "probes": {name: one.summary for name, one in probes.items()},
    }
    parts = zip(*(each.sections or () for each in recordings), strict=True)
    sections = [np.concatenate([part[:1] for part in own]) for own in parts]
    return Result(
        scenario=scenario,
        times=times,
        steps=stacked("steps"),
        positions=stacked("positions"),
        velocities=stacked("velocities"),
        energies=energies,
        work=work,
        probes=Probes(probes),
        summary={k: v for k, v in recordings[-1].summary.items() if k not in _COSTS} | ended,
        sections=Sections(*sections) if sections else None,
        turns=stacked("turns"),
    )
