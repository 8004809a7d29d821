"""Running scenes: step by step, or to the end with everything recorded."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from numbers import Real
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from der import _core
from der._core import RunRecording, Scenario
from der.actuation_forces import ActuationForce, make_actuation_forces
from der.analyses import Modes
from der.arguments import NamedProbes
from der.errors import UnreliableResultWarning, warn
from der.html import card
from der.progress import ProgressFunction, ProgressLine
from der.reactions import Reaction, make_reactions
from der.recording import Recording
from der.result import Result, to_result
from der.scenario import SceneLike, load
from der.scene_loads import follows_time, value_at

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

#: Called after every step; False stops the run, True and None let it go on.
StepCallback: TypeAlias = "Callable[[Simulation], bool | None]"


class Simulation(_core.Simulation):
    """A scenario's model, its state, and the time integrator that advances it.

    ``positions``, ``velocities`` and ``extra_force`` are live NumPy views of the engine's memory,
    shape (nodes, dim), in m, m/s and N; so are ``theta`` and ``spin``, the angles [rad] of the
    edges' sections and their rates, shape (edges,), in the model ``spatial``. One thread at a time
    may use a simulation.

    Parameters
    ----------
    scenario
        A scenario, the path of a scene file, or a dict with the keys of a scene file.

    Raises
    ------
    SceneError, DerError
        Where the scene cannot be simulated.

    Warns
    -----
    DerWarning
        For each of the scenario's `warnings`.
    """

    def __init__(self, scenario: SceneLike) -> None:
        super().__init__(load(scenario))
        warn(self.scenario.warnings)

    def run(
        self,
        callback: StepCallback | None = None,
        until: float | None = None,
        *,
        out: str | os.PathLike[str] | None = None,
        progress: bool | ProgressFunction = False,
        check: bool = True,
        warns: bool = True,
    ) -> Result:
        """Run from the present state to the end of the scene and record it.

        A static scene is brought to its equilibrium. Other Python threads run meanwhile, and Ctrl-C
        interrupts between two steps, or two iterations of a search.

        Parameters
        ----------
        callback
            Called with this simulation after every step; returning False stops the run, with the
            status ``stopped``; True or None lets it go on. It may read the state and write to the
            views, but not step.
        until
            Stop at this time [s] instead of at the scene's end, with the status ``stopped``.
        out
            Folder to write the run to while it goes on, with the same files as der_run.
        progress
            True for a progress line on stderr, or a function that is told now and then how much is
            done, from 0 to 1.
        check
            Whether a run that fails raises; otherwise `Result.status` tells.
        warns
            Whether the hints of the summary are issued as warnings.

        Returns
        -------
        Result
            The saved frames (every ``output.every`` seconds and the last), probes and summary.

        Raises
        ------
        NotConvergedError, DivergedError
            If the run fails; their ``result`` holds everything up to the last good step.
        ValueError
            If `until` lies before the present time or beyond the scene's end.
        TypeError
            If `until` is no number, or `callback` or `progress` no function.

        Warns
        -----
        DerWarning
            If a run with a tolerance takes very many steps: why, and what takes fewer. If an
            equilibrium, a path or a buckling load of a planar model would leave its plane.
        UnreliableResultWarning
            If the integrator has created energy, but not enough for the run to fail; if a rod
            passes through itself or another; if a strain is beyond what a linear law holds for.
        """
        end = self._end_time(until)
        if not (callback is None or callable(callback)):
            raise TypeError(f"callback must be a function, got {callback!r}")
        if not (isinstance(progress, bool) or callable(progress)):
            raise TypeError(f"progress must be True, False or a function, got {progress!r}")
        line = ProgressLine() if progress is True else None
        report = progress if callable(progress) else line
        try:
            recording = self.record(
                callback=None if callback is None else lambda: _goes_on(callback(self)),
                until=end,
                tick=None if report is None else lambda: report(self.share_done(end)),
                out=None if out is None else os.fspath(out),
            )
        finally:
            if line is not None:
                line.close()
        result = recorded_result(self.scenario, recording)
        error = recording.error
        if check and error is not None:
            error.result = result
            raise error
        if warns:
            warn(result.summary["hints"])
            warn(_leaving_the_plane(result))
            if error is None:
                warn(recording.doubts, UnreliableResultWarning)
        return result

    def recording(self) -> Recording:
        """Keep states of a loop of `step` as frames, to draw, save and view them; now the first.

        Examples
        --------
        >>> recording = simulation.recording()
        >>> while not simulation.finished:
        ...     simulation.step(10)
        ...     recording.add()
        >>> recording.result().plot()
        """
        return Recording(self)

    def modes(self, k: int = 6) -> Modes:
        """Return the `k` modes of lowest frequency about the present state.

        The state has to be an equilibrium: call `equilibrium` first. Tensions, moments and the
        curved shape count; damping does not.

        Raises
        ------
        DerError
            If forces are not in balance, or a free node has no mass.
        """
        return Modes(*self.vibration_modes(k))

    def hessian(self) -> csc_array:
        """Return the stiffness: the Hessian [N/m] of the potential at the present state.

        Sparse and symmetric, shape (free, free), over the degrees of freedom that no support holds;
        `free_dofs` says where they are in ``positions.ravel()`` and, behind its end, in ``theta``.
        The loads' part of it (that of moments) is included.
        """
        return _symmetric(*self.lower_hessian())

    def mass(self) -> csc_array:
        """Return the mass matrix [kg] over the free degrees of freedom.

        Sparse and symmetric, shape (free, free), ordered as `hessian`. Massive edges couple their
        two nodes.
        """
        return _symmetric(*self.lower_mass())

    def reactions(self) -> list[Reaction]:
        """Return what the supports bear at the present state, one for each place of each.

        Forces and moments are those that the supports exert on the rods: of components that are
        held or moved, of clamps and of springs. In a motion they hold the inertia of held nodes and
        the drag on them. See docs/mechanics.md, "Reactions".

        Examples
        --------
        >>> wall = simulation.reactions()[0]
        >>> wall.force, wall.moment
        """
        return make_reactions(*self.reaction_vectors(), self.model.dimension)

    def actuation_forces(self) -> list[ActuationForce]:
        """Return what the actuations exert on the rods at the present state.

        Each is the moment, torque or force whose work is the `actuation` line of the ledger: over
        the turning angle, twist or length that the actuation gives its stretch. See
        docs/actuation.md, "What an actuation bears".

        Examples
        --------
        >>> finger = simulation.actuation_forces()[0]
        >>> finger.name, finger.force
        """
        return make_actuation_forces(*self.actuation_values())

    @property
    def probes(self) -> dict[str, float]:
        """Present value of each probe of the scene, by name, in its SI unit."""
        return NamedProbes(super().probes)

    def __repr__(self) -> str:
        """Return title, time and size in one line."""
        return f"<der.Simulation of {self.scenario.title!r}: {self._facts()}>"

    def _repr_html_(self) -> str:
        from der.plotting import plot_states  # here, because matplotlib takes long to load

        def draw() -> Figure:
            shape = self.positions[np.newaxis].copy()
            directors = self.directors[np.newaxis] if self.model.name == "spatial" else None
            return plot_states(
                self.scenario, shape, ["now"], directors=directors, time=self.time, title=""
            )

        values = [(name, f"{value:.6g}") for name, value in self.probes.items()]
        return card(self.scenario.title, self._facts(), draw, [[("probe", "now"), *values]])

    def _facts(self) -> str:
        scenario, model = self.scenario, self.model
        kind = scenario.analysis
        when = kind if scenario.is_static else f"t = {self.time:g} s of {scenario.duration:g} s"
        return f"{when}, {model.num_nodes} nodes, model {model.name}"

    def share_done(self, end: float = math.inf) -> float:
        """Return how much of a run to its end, or to the time `end` [s], is done, from 0 to 1."""
        duration = min(end, self.scenario.duration)
        return self.time / duration if duration > 0.0 else 0.0

    def _end_time(self, until: float | None) -> float:
        if until is None:
            return math.inf
        if self.scenario.is_static:
            raise ValueError("a static scene has no time to run until")
        if not isinstance(until, Real):
            raise TypeError(f"until must be a time in s, got {until!r}")
        if not self.time <= until <= self.scenario.duration * (1.0 + 1e-12):
            raise ValueError(
                f"until = {until:g} s must lie between the present time, {self.time:g} s, and the "
                f"scene's end, {self.scenario.duration:g} s; for a longer run, vary the scenario "
                'with with_({"time.duration": ...})'
            )
        return until


def _symmetric(
    values: NDArray[np.float64], rows: NDArray[np.int32], starts: NDArray[np.int32]
) -> csc_array:
    from scipy.sparse import csc_array, diags_array  # here, because it takes long to load

    lower = csc_array((values, rows, starts), shape=(len(starts) - 1, len(starts) - 1))
    return csc_array(lower + lower.T - diags_array(lower.diagonal()))


def _leaving_the_plane(result: Result) -> list[str]:
    verdict = result.summary.get("out_of_plane", {})
    return [verdict["warning"]] if "warning" in verdict else []


def _goes_on(answer: bool | None) -> bool:
    # Not `is not False`: a comparison of NumPy numbers answers with NumPy's own False.
    return answer is None or bool(answer)


def run(
    scenario: SceneLike,
    overrides: Mapping[str, Any] | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    callback: StepCallback | None = None,
    progress: bool | ProgressFunction = False,
    check: bool = True,
) -> Result:
    """Run a scene from its start to its end and return what was recorded.

    Parameters
    ----------
    scenario
        A scenario, the path of a scene file, or a dict with the keys of a scene file.
    overrides
        Values by their key paths, in place of those of the scene; see `Scenario.with_`.
    out
        Folder to write the run to.
    callback
        Called after every step; returning False stops the run.
    progress
        Whether to show how far the run is, or a function to tell.
    check
        Whether a failed run raises.

    Returns
    -------
    Result
        The saved frames, probes and summary.

    Raises
    ------
    SceneError
        If the scene cannot be run as written.
    NotConvergedError, DivergedError
        If the run fails; their ``result`` holds everything up to the last good step.

    Examples
    --------
    >>> result = der.run("configs/simply_supported.yaml", {"rods.beam.nodes": 101})
    >>> result.summary["probes"]["deflection"]["final"]
    """
    return Simulation(load(scenario, overrides)).run(
        callback, out=out, progress=progress, check=check
    )


def equilibrium(scenario: SceneLike) -> Result:
    """Find the static equilibrium of a scene, whatever its `time` says.

    Parameters
    ----------
    scenario
        A scenario, the path of a scene file, or a dict with the keys of a scene file. Loads and
        prescribed motions are those at time 0.

    Returns
    -------
    Result
        With one frame.

    Raises
    ------
    NotConvergedError
        If no equilibrium is found.
    """
    scene = load(scenario)
    return run(scene if scene.analysis == "static" else as_static(scene))


def continuation(
    scenario: SceneLike,
    *,
    vary: str = "loads",
    start: float = 0.0,
    to: float = 1.0,
    step: float = 0.05,
    points: int = 500,
    branches: int = 0,
    out: str | os.PathLike[str] | None = None,
) -> Result:
    """Follow the equilibria of a scene while its loads change in proportion to a factor.

    Parameters
    ----------
    scenario
        A scenario, the path of a scene file, or a dict with the keys of a scene file; its `time` or
        `analysis` does not count. Tables over time have their value at time 0.
    vary
        ``loads``, ``supports`` (prescribed motions), ``actuation`` (changes of rest shapes), or one
        of them by number, as ``loads.0``; an actuation also by its name, as ``actuation.bend``.
    start, to
        First and last factor.
    step
        Largest distance of two points: change of the factor against ``to - start``, and of the
        shape in units of like size.
    points
        Largest number of points of a branch.
    branches
        How many bifurcations deep other branches are followed.
    out
        Folder to write the run to.

    Returns
    -------
    Result
        One frame for each point; ``result.path`` has factors, stability, folds and bifurcations.

    Raises
    ------
    NotConvergedError
        If there is no equilibrium at the first factor.
    """
    settings = {
        "vary": vary,
        "from": start,
        "to": to,
        "step": step,
        "points": points,
        "branches": branches,
    }
    return run(_with_analysis(load(scenario), {"continuation": settings}), out=out)


def as_static(scenario: Scenario) -> Scenario:
    """Return the scene whose answer is the equilibrium under the loads of a scene."""
    return _with_analysis(scenario, "static")


def _with_analysis(scenario: Scenario, analysis: Any) -> Scenario:
    """Return a scene with what belongs to a run over time taken out, tables at time 0."""
    scene = scenario.to_dict()
    for key in ("time", "analysis"):
        scene.pop(key, None)
    scene.get("output", {}).pop("every", None)
    if scene.get("start_from") == "equilibrium":
        del scene["start_from"]  # it is looked for anyway
    for key in ("loads", "supports", "joints", "springs", "actuation"):
        if key in scene:
            scene[key] = _at_time_0(scene[key])
    return Scenario.from_dict({**scene, "analysis": analysis})


def _at_time_0(part: Any) -> Any:
    if follows_time(part):
        return value_at(part, 0.0).tolist()
    if isinstance(part, Mapping):
        return {key: _at_time_0(value) for key, value in part.items()}
    if isinstance(part, list):
        return [_at_time_0(value) for value in part]
    return part


def recorded_result(scenario: Scenario, recording: RunRecording) -> Result:
    """Return what the engine recorded of a run as a result."""
    return to_result(scenario, recording, list(recording.probes), recording.summary)
