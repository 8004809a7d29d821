"""The data of a run, which everything that draws, writes or compares runs reads."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from der._core import HeldNode, Model, Replay, Rod, Scenario
from der.actuation_forces import ActuationForce, make_actuation_forces
from der.analyses import (
    BucklingModes,
    Modes,
    Path,
    make_buckling_modes,
    make_modes,
    make_path,
)
from der.probe_series import Probes
from der.reactions import Reaction, make_reactions


@dataclass(frozen=True, eq=False)
class Sections:
    """How the sections of the edges stand at the saved frames of a run of the model ``spatial``.

    Attributes
    ----------
    theta
        Angles [rad], shape (frames, edges), in the order of the rods and their edges.
    spin
        Their rates [rad/s], shape (frames, edges).
    frames
        The frames that the angles count from, shape (frames, edges, 8): tangent, reference
        director, and the reference twists [rad] of the vertices at the start and the end of the
        edge.
    """

    theta: NDArray[np.float64]
    spin: NDArray[np.float64]
    frames: NDArray[np.float64]


#: Positions, velocities, angles and frames of sections, turns.
_Frames: TypeAlias = tuple[
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
]


@dataclass(frozen=True, eq=False)
class RunData:
    """The recorded data of a run: its saved frames, probes and summary.

    Whatever reads a run takes this: drawings, exports, the run folder. `Result` adds ways to call
    these.

    Attributes
    ----------
    scenario
        The scenario that was run.
    times
        Times of the saved frames [s], shape (frames,).
    steps
        Time steps done at the saved frames, shape (frames,).
    positions
        Node positions [m], shape (frames, nodes, dim).
    velocities
        Node velocities [m/s], shape (frames, nodes, dim).
    energies
        Energies [J] by name (``kinetic``, ``stretch``, ``bend``, ``spring``, ``gravity``), each of
        shape (frames,).
    work
        Works done and energy lost since the start [J] by name, each of shape (frames,):
        work of the ``loads`` (but for weight), of moving ``supports``, of ``actuation`` and of the
        ``solver``'s residual went in; ``drag`` and the ``numerical`` loss of the time stepping went
        out.
    probes
        Probes by name, each an array of shape (frames,) with its ``unit`` and ``summary``. Printed,
        they are a table of final values and extremes.
    summary
        The content of ``summary.json`` of a run folder: status, model, solver, costs, probes.
    data
        Arrays that an analysis found besides, by name, as in ``results.h5``; `modes`, `buckling`
        and `path` make objects of them.
    sections
        Angles and frames of the edges' sections, of the model ``spatial``; None of others. `theta`
        and `directors` are what one wants of them.
    turns
        Angles [rad] by which edges of planar rods have turned, whole turns included, shape
        (frames, edges): of the edges beside springs against turning and clamps that turn, and those
        that probes of the slope count from. None: the replay follows them from frame to frame.
    """

    scenario: Scenario
    times: NDArray[np.float64]
    steps: NDArray[np.int64]
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    energies: dict[str, NDArray[np.float64]]
    work: dict[str, NDArray[np.float64]]
    probes: Probes
    summary: dict[str, Any]
    data: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    sections: Sections | None = None
    turns: NDArray[np.float64] | None = None

    @property
    def status(self) -> str:
        """``completed``, ``static_converged``, ``stopped``, or the name of a failure."""
        return str(self.summary["status"])

    @property
    def unreliable_from(self) -> float | None:
        """Time [s] from which on the integrator had created too much energy; None: never."""
        since = self.summary.get("unreliable_from")
        return None if since is None else float(since)

    @property
    def modes(self) -> Modes | None:
        """Vibration modes, of ``analysis: modes``."""
        return make_modes(self.data)

    @property
    def buckling(self) -> BucklingModes | None:
        """Buckling modes, of ``analysis: buckling``; None also where nothing buckles."""
        return make_buckling_modes(self.data)

    @property
    def path(self) -> Path | None:
        """The path of equilibria, of ``analysis: continuation``; its points are the frames."""
        return make_path(self.data)

    @cached_property
    def model(self) -> Model:
        """The data that stay constant in the run."""
        return Model(self.scenario)

    @property
    def rods(self) -> list[Rod]:
        """The rods: which nodes are theirs, arc lengths, radii."""
        return self.model.rods

    @cached_property
    def _replay(self) -> Replay:
        path = self.path
        instants = self.times if path is None else path.factor
        return Replay(self.scenario, instants, path is not None)

    @property
    def theta(self) -> NDArray[np.float64]:
        """Angles of the edges' sections [rad], shape (frames, edges).

        Each counts about the tangent from a reference director that moves with the edge. Without
        sections there are 0 edges.
        """
        return self._frames[2]

    @cached_property
    def directors(self) -> NDArray[np.float64]:
        """Director 1 of each edge's section, shape (frames, edges, 3): along its width.

        The edges are in the order of the rods and along each rod; without sections there are none.
        """
        return self._replay.directors(*self._frames)

    @property
    def _frames(self) -> _Frames:
        """The frames as the replay takes them."""
        count = len(self.positions)
        sections = self.sections
        theta = np.empty((count, 0)) if sections is None else sections.theta
        frames = np.empty((count, 0, 8)) if sections is None else sections.frames
        turns = np.empty((count, 0)) if self.turns is None else self.turns
        return self.positions, self.velocities, theta, frames, turns

    def along(self, rod: str, quantity: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return a quantity along a rod at every frame, where the discrete rod has it.

        Parameters
        ----------
        rod
            Name of the rod.
        quantity
            Any quantity of probes but the energies, such as ``moment``, whether the scene has a
            probe of it or not.

        Returns
        -------
        arc_lengths
            Places [m], shape (places,), ascending: the nodes; for a turning angle those that bend;
            for strain and tension the middles of the edges and the ends of the rod. Curvature,
            moment, strain and tension also have the places at which a load or a support makes a
            kink. Where they jump, and at every such place of strain and tension, the place stands
            twice, with the values before and after it: between any two places in a row they are
            linear.
        values
            In the SI unit of the quantity, shape (frames, places).

        Raises
        ------
        DerError
            If there is no such rod or quantity, or the model has not that quantity.

        Notes
        -----
        Clamps that `Simulation.prescribe` turned are taken to stand as the scene has them, since
        frames do not tell; this concerns the values at the clamp and at the node or edge beside it.
        """
        return self._replay.along(rod, quantity, *self._frames)

    def reactions(self) -> list[Reaction]:
        """Return what the supports bear at every frame, one for each place of each.

        Forces and moments are those that the supports exert on the rods, as
        `Simulation.reactions` gives them.

        Notes
        -----
        Frames do not tell of forces that a program added, nor of supports that
        `Simulation.prescribe` moved: these stand as the scene has them.
        """
        count = len(self.positions)
        spin = np.empty((count, 0)) if self.sections is None else self.sections.spin
        vectors = self._replay.reactions(*self._frames, spin)
        return make_reactions(*vectors, self.model.dimension)

    def actuation_forces(self) -> list[ActuationForce]:
        """Return what the actuations exert on the rods at every frame.

        They are those of `Simulation.actuation_forces`, with the values that the scene has: frames
        do not tell what a program has set. A run in which a program sets actuations records them
        with probes.
        """
        return make_actuation_forces(*self._replay.actuation_forces(*self._frames))

    def held_nodes(self, frame: int) -> list[HeldNode]:
        """Return every node that a support of the scene holds, clamps turned as at a frame.

        Those that `Simulation.prescribe` turned stand as the scene has them. Raises `DerError` if
        there is no such frame.
        """
        return self._replay.held_nodes(frame)

    def load_arc_lengths(self, number: int) -> list[float]:
        """Return the arc lengths [m] of a load of the scene, counted from 0.

        They are those of its places, or the two ends of its part; a load without a place has none.
        Raises `IndexError` if there is no such load.
        """
        return self._replay.load_arc_lengths(number)
