"""A simulation that is played: steps in time with a clock, values that are set, a hand that pulls.

Nothing here knows of a browser.
"""

from __future__ import annotations

import time
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from der.errors import DerError
from der.film import round_speed
from der.playing.controls import Control, controls_of, natural_force, with_names
from der.scenario import SceneLike, load
from der.simulation import Simulation

Array: TypeAlias = NDArray[np.float64]

#: How long a call of the engine takes about [s]: between two calls the clock is looked at.
_CALL = 0.004
#: Within which a value goes to where a slider is put [s of the clock].
_EASE = 0.1
#: A hand pulls with the force that is seen where it is away by so much of the longest rod's length.
_REACH = 0.2
#: Damping of the hand by its stiffness [s of the clock].
_CALM = 0.15
#: Most of the stiffness, and of the damping, of a node within a step that the hand has. The force
#: is constant in a step: with more it would drive oscillations.
_EXPLICIT = (0.25, 0.5)


class Player:
    """A scene that is played.

    Parameters
    ----------
    scene
        As `Simulation` takes it, with a ``time``. It goes on after its duration.

    Attributes
    ----------
    simulation
        The simulation; its supports that move and its loads have names.
    controls
        What can be set.
    speed
        Simulated seconds in a second of the clock, as asked for.
    share
        How much of that speed is reached, from 0 to 1.
    paused
        Whether it waits.
    failure
        Why it cannot go on before a `reset`; empty while it can.
    pulled
        Where a hand pulls: the node, and where to [m].

    Raises
    ------
    ValueError
        If the scene has no time.
    """

    def __init__(self, scene: SceneLike) -> None:
        scenario = load(scene)
        if scenario.is_static:
            raise ValueError(
                f"a scene with the analysis '{scenario.analysis}' does not move: to play it, give "
                "it 'time: {duration: 1, step: 0.001}' in place of 'analysis', and a load "
                "'damping: {coefficient: 0.1}' that lets it come to rest"
            )
        self.simulation = Simulation(with_names(scenario))
        self.controls = controls_of(self.simulation)
        self.speed = round_speed(scenario.duration)
        self.share = 1.0
        self.paused = False
        self.failure = ""
        self.pulled: tuple[int, Array] | None = None
        self._start = self.simulation.save_state()
        self._due = self.simulation.time
        self._steps_in_a_call = 1
        self._stiffness = self._damping = 0.0

    def advance(self, seconds: float, budget: float) -> None:
        """Let seconds of the clock go by.

        Parameters
        ----------
        seconds
            How many.
        budget
            For how long it may compute [s]. What it does not reach is not made up for.
        """
        if self.paused or self.failure:
            return
        asked = seconds * self.speed
        self._due += asked
        end = time.perf_counter() + budget
        try:
            while (steps := self._steps_due()) > 0 and (begun := time.perf_counter()) < end:
                steps = min(steps, self._steps_in_a_call)
                self.simulation.step(steps)
                each = (time.perf_counter() - begun) / steps
                self._steps_in_a_call = int(np.clip(_CALL / each, 1, 2 * steps))
        except DerError as error:
            self._fail(error)
        missing = max(self._due - self.simulation.time, 0.0) if self._steps_due() else 0.0
        self._due -= missing
        self.share += 0.1 * (1.0 - min(missing / asked, 1.0) - self.share)

    def step(self) -> None:
        """Take one step, and wait."""
        self.paused = True
        if self.failure:
            return
        try:
            self.simulation.step()
        except DerError as error:
            self._fail(error)
        self._due = self.simulation.time

    def reset(self) -> None:
        """Go back to the start, and to the values of the scene."""
        self.release()
        self.simulation.restore_state(self._start)
        self._due = self.simulation.time
        self.share, self.failure = 1.0, ""

    def set(self, control: Control, value: float) -> None:
        """Let what can be set go to a value within a moment."""
        ease = max(_EASE * self.speed, self.simulation.time_step)
        self.simulation.set(f"{control.name}.{control.component}", value, over=ease)

    def value(self, control: Control) -> float:
        """Return the present value of what can be set."""
        return float(self.simulation.value(f"{control.name}.{control.component}"))

    def grab(self, point: Array) -> None:
        """Take hold of the node nearest to a point [m] with a soft spring with damping."""
        self.release()
        simulation = self.simulation
        node = int(np.argmin(np.linalg.norm(simulation.positions - point, axis=1)))
        step = self._length_of_a_step()
        compliance = self._compliance(node, step)
        if compliance == 0.0:  # it is held
            return
        length = max(rod.length for rod in simulation.model.rods)
        wanted = natural_force(simulation) / (_REACH * length)
        self._stiffness = min(wanted, _EXPLICIT[0] / compliance)
        calm = _CALM * self.speed * self._stiffness
        self._damping = min(calm, _EXPLICIT[1] * step / compliance)
        self.pulled = node, simulation.positions[node].copy()
        simulation.add_force(self._force)

    def drag(self, point: Array) -> None:
        """Pull what is held to a point [m]."""
        if self.pulled is not None:
            self.pulled = self.pulled[0], np.array(point)

    def release(self) -> None:
        """Let go."""
        if self.pulled is not None:
            self.simulation.remove_force(self._force)
            self.pulled = None

    def _force(self, _time: float, positions: Array, velocities: Array) -> Array:
        force = np.zeros_like(positions)
        if self.pulled is not None:
            node, target = self.pulled
            stretch = target - positions[node]
            force[node] = self._stiffness * stretch - self._damping * velocities[node]
        return force

    def _compliance(self, node: int, duration: float) -> float:
        """Return by how much [m] a force of 1 N moves a node within a duration [s], at most."""
        simulation = self.simulation
        dofs, dimension = simulation.free_dofs, simulation.model.dimension
        free = np.flatnonzero((dofs < simulation.positions.size) & (dofs // dimension == node))
        if len(free) == 0:
            return 0.0
        units = np.zeros((len(dofs), len(free)))
        units[free, np.arange(len(free))] = 1.0
        matrix = simulation.hessian() + simulation.mass() / duration**2
        return float(np.abs(splu(matrix.tocsc()).solve(units)[free]).max())

    def _steps_due(self) -> int:
        left = self._due - self.simulation.time
        if self.simulation.time_step == 0.0:  # steps have no fixed length
            return int(left > 0.0)
        return int(left / self.simulation.time_step + 1e-9)

    def _length_of_a_step(self) -> float:
        simulation = self.simulation
        mean = simulation.time / max(simulation.step_count, 1)
        return simulation.time_step or mean or 1e-3 * simulation.scenario.duration

    def _fail(self, error: DerError) -> None:
        self.failure = str(error)
        self.release()
