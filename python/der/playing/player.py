"""A simulation that goes with a clock, in which values are set and a hand pulls; without a page."""

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

#: Within which a value goes to where a slider is put [s of the clock].
_EASE = 0.1
#: A hand pulls with a force that is seen where it is away by this share of the longest rod.
_AWAY = 0.2
#: Damping of the hand by its stiffness [s of the clock].
_CALM = 0.15
#: Most of the stiffness, and of the damping, of a node within a step that the hand has. The force
#: is constant in a step: with more it would drive oscillations.
_MOST = (0.25, 0.5)


class Player:
    """A scene that is played; it goes on after its duration.

    Attributes
    ----------
    simulation
        The simulation; all that can be set in it has a name.
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
        The node that a hand pulls, and where to [m]; None where it pulls none.

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
                "it 'time: {duration: 1, step: 0.001}' in place of 'analysis', and with the load "
                "'damping: {coefficient: 0.1}' it comes to rest"
            )
        self.simulation = Simulation(with_names(scenario))
        self.controls = controls_of(self.simulation)
        self.speed = round_speed(scenario.duration)
        self.share, self.paused, self.failure = 1.0, False, ""
        self.pulled: tuple[int, Array] | None = None
        self._start = self.simulation.save_state()
        self._due = self.simulation.time
        self._stiffness = self._damping = 0.0

    def advance(self, seconds: float, budget: float) -> None:
        """Let seconds of the clock go by, and compute within a budget [s].

        What it does not reach is not made up for later.
        """
        if self.paused or self.failure:
            return
        simulation, asked = self.simulation, seconds * self.speed
        self._due += asked
        end = time.perf_counter() + budget
        while simulation.time + simulation.time_step <= self._due and time.perf_counter() < end:
            if not self._step():
                return
        late = max(self._due - simulation.time - simulation.time_step, 0.0)
        self._due -= late
        self.share += 0.1 * (1.0 - min(late / asked, 1.0) - self.share)

    def step(self) -> None:
        """Take one step, and wait."""
        self.paused = True
        if not self.failure and self._step():
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
        self.simulation.set(control.path, value, over=ease)

    def value(self, control: Control) -> float:
        """Return the present value of what can be set."""
        return float(self.simulation.value(control.path))

    def grab(self, point: Array) -> None:
        """Take hold of the node nearest to a point [m] with a soft spring that is damped."""
        self.release()
        simulation = self.simulation
        node = int(np.argmin(np.linalg.norm(simulation.positions - point, axis=1)))
        step = simulation.time_step or simulation.time / max(simulation.step_count, 1) or 1e-6
        compliance = self._compliance(node, step)
        if compliance == 0.0:  # it is held
            return
        away = _AWAY * max(rod.length for rod in simulation.model.rods)
        self._stiffness = min(natural_force(simulation) / away, _MOST[0] / compliance)
        calm = _CALM * self.speed * self._stiffness
        self._damping = min(calm, _MOST[1] * step / compliance)
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
            force[node] = self._stiffness * (target - positions[node])
            force[node] -= self._damping * velocities[node]
        return force

    def _compliance(self, node: int, duration: float) -> float:
        """Return by how much [m] a force of 1 N moves a node within a duration [s], at most."""
        simulation = self.simulation
        dofs, dimension = simulation.free_dofs, simulation.model.dimension
        own = np.flatnonzero((dofs < simulation.positions.size) & (dofs // dimension == node))
        if len(own) == 0:
            return 0.0
        units = np.zeros((len(dofs), len(own)))
        units[own, np.arange(len(own))] = 1.0
        matrix = simulation.hessian() + simulation.mass() / duration**2
        return float(np.abs(splu(matrix.tocsc()).solve(units)[own]).max())

    def _step(self) -> bool:
        try:
            self.simulation.step()
        except DerError as error:
            self.failure = str(error)
            self.release()
        return not self.failure
