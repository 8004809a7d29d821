"""Many simulations of one scene, stepped side by side by several threads."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from der import _core
from der._core import EquilibriumReport, State
from der.arguments import (
    MOST,
    NamedProbes,
    check_apart,
    check_value_list,
    check_varied,
    whole_number,
)
from der.errors import DerError, UnreliableResultWarning, warn
from der.html import card
from der.recording import result_of
from der.result import Result
from der.scenario import SceneLike, load

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

#: Numbers of members, a mask of all, the number of one, or None for all.
Members: TypeAlias = "Iterable[int] | NDArray[np.bool_] | int | None"


#: More threads than any machine runs at once are a slip.
MOST_THREADS = 4096
#: Members that are drawn unless they are named.
_DRAWN = 8


@dataclass(frozen=True)
class MemberFailure:
    """Why a member of a batch goes on no more.

    Attributes
    ----------
    member
        Its number, from 0.
    status
        Short machine-readable name, the same as ``status`` in ``summary.json``.
    time
        Time of its last good state [s].
    message
        The failure, its place, and the remedy to try.
    """

    member: int
    status: str
    time: float
    message: str
    _error: DerError = field(repr=False)

    def error(self) -> DerError:
        """Return the error that `Simulation` would have raised, with advice for a member."""
        return self._error


class Batch(_core.Batch):
    """Many simulations of one scene, its members, stepped side by side by several threads.

    Each member has to the last bit what `Simulation` gives for its scene, whatever the number of
    threads. A member that fails is masked, keeps its last good state, and stops nobody; `failures`
    tells why, and `reset` takes it in again.

    ``positions``, ``velocities`` and ``extra_force`` are live NumPy views of the engine's memory,
    shape (members, nodes, dim), in m, m/s and N. The engine works without the interpreter's lock,
    and Ctrl-C is answered. One thread at a time may use a batch.

    Parameters
    ----------
    scene
        A scenario, the path of a scene file, or a dict with the keys of a scene file.
    members
        How many.
    threads
        How many threads step them; as many as this process may use, unless given, but no more than
        there are members: ``threads`` tells. They live as long as the batch.
    vary
        Values that differ from member to member: by the key path that `Scenario.with_` takes, one
        for each member, such as ``{"rods.arm.cross_section.stiffness.EI": array}``. Numbers and
        vectors may differ, the structure may not: numbers of nodes, supports, elements.

    Raises
    ------
    SceneError, DerError
        Where a member cannot be simulated: the message names the first.
    ValueError
        Where `vary` has not one value for each member, in an order, or two paths to the same
        value.

    Warns
    -----
    DerWarning
        For each of the scenario's `warnings`.

    Examples
    --------
    >>> batch = der.Batch("configs/cantilever.yaml", 8, vary={"loads.0.gravity": gravities})
    >>> batch.step(100)
    >>> batch.positions[:, -1]  # the tips
    """

    def __init__(
        self,
        scene: SceneLike,
        members: int,
        threads: int | None = None,
        *,
        vary: Mapping[str, ArrayLike | Sequence[Any]] | None = None,
    ) -> None:
        scenario = load(scene)
        members = whole_number("members", members, 1, MOST)
        if threads is not None:
            threads = whole_number("threads", threads, 1, MOST_THREADS)
        check_varied(vary or {})
        check_apart(scenario.to_dict(), vary or ())
        lists = {path: _one_each(path, given, members) for path, given in (vary or {}).items()}
        super().__init__(scenario, members, threads or 0, lists)
        warn(scenario.warnings)

    def step(self, n: int = 1) -> NDArray[np.bool_]:
        """Advance every member that has not failed by `n` time steps of its scene.

        Returns
        -------
        NDArray[np.bool_]
            Which members have failed by now, shape (members,): the live view `failed`.

        Raises
        ------
        DerError
            If the scene is static.
        KeyboardInterrupt
            Of Ctrl-C: each member is then at the end of one of its steps, not all of the same.

        Warns
        -----
        UnreliableResultWarning
            Once, when the integrator of a member has created energy; `unreliable` says of which.
        """
        warning = self.advance(n)
        if warning is not None:
            warn([warning], UnreliableResultWarning)
        return self.failed

    def equilibrium(self, leave_saddles: bool | None = None) -> list[EquilibriumReport | None]:
        """Move every member that has not failed to the static equilibrium near its state.

        As `Simulation.equilibrium`. Members for which none is found have failed then.

        Parameters
        ----------
        leave_saddles
            Whether an unstable equilibrium is left for a stable one; None: as the scene says.

        Returns
        -------
        list of EquilibriumReport or None
            One for each member; None for those that have failed.

        Raises
        ------
        KeyboardInterrupt
            Of Ctrl-C: each member is then in its equilibrium, or where it was.
        """
        return self.settle(leave_saddles)

    def set(
        self,
        name: str,
        value: ArrayLike | Mapping[str, ArrayLike],
        over: float | None = None,
    ) -> None:
        """Set a load or the motion of a support that has a name, as `Simulation.set`.

        Parameters
        ----------
        name
            Its name, or that of a component, such as ``"wall.x"``; `names` has all of them.
        value
            A value for each member: shape (members,) for one component, else (members,
            components). Without the first axis it is for all members. Or a dict of such by
            component.
        over
            Time in which the values are reached [s]; None: in the next step.

        Raises
        ------
        DerError
            Where a value does not fit; the message names the member, and nothing is set.
        ValueError
            Where the shape does not fit.
        """
        parts = (
            {f"{name}.{component}": given for component, given in value.items()}
            if isinstance(value, Mapping)
            else {name: value}
        )
        self.set_rows([(part, self._rows(part, given)) for part, given in parts.items()], over)

    def value(self, name: str) -> NDArray[np.float64]:
        """Return the present values of what has a name.

        Returns
        -------
        NDArray[np.float64]
            Shape (members,) for one component, else (members, components).
        """
        rows = self.value_rows(name)
        return rows[:, 0] if rows.shape[1] == 1 else rows

    def prescribe(self, support: int, **components: ArrayLike) -> None:
        """Move a support, by its number in the scene, as `Simulation.prescribe`.

        Parameters
        ----------
        support
            Its number.
        **components
            ``x``, ``y``, ``z`` [m], ``angle``, ``twist`` [rad]: a number for all members, or an
            array with one for each.

        Raises
        ------
        DerError
            Where the scene has no such support or does not prescribe the component, or a value
            does not fit: nothing is then moved.
        """
        pairs = [
            (component, _broadcast(component, _as_numbers(component, given), (len(self),)))
            for component, given in components.items()
        ]
        self.prescribe_rows(support, pairs)

    def reset(self, members: Members = None, state: State | Sequence[State] | None = None) -> None:
        """Bring members to a state, bit for bit, and take in again those that had failed.

        Nothing is built anew; views stay valid. A member whose start (``start_from``) could not be
        reached stays failed unless it gets a state.

        Parameters
        ----------
        members
            Numbers of members, a mask of shape (members,), or one number; all, unless given.
        state
            A state of `save_state`, here or of a `Simulation`, for all of these members, or a
            list with one for each. None: each goes back to its own start.

        Raises
        ------
        IndexError
            If there is no such member.
        TypeError
            If the members are no whole numbers and no mask, or a state is none.
        ValueError
            If a mask has another shape, or a state does not fit.
        """
        numbers = self._numbers(members)
        if state is None or isinstance(state, State):
            self.reset_members(numbers, [] if state is None else [state])
            return
        states = list(state) if isinstance(state, Iterable) else [state]
        for given in states:
            if not isinstance(given, State):
                raise TypeError(f"a state that save_state has returned is needed, got {given!r}")
        if len(states) != len(numbers):
            raise ValueError(f"{len(states)} states for {len(numbers)} members: give one for each")
        self.reset_members(numbers, states)

    @property
    def probes(self) -> dict[str, NDArray[np.float64]]:
        """Values of the scene's probes, by name, each of shape (members,).

        They are live views, read-only. From the first time that they are asked for, every call
        evaluates them at its end.
        """
        return NamedProbes(super().probes)

    @property
    def failures(self) -> list[MemberFailure]:
        """Why members have failed, in the order of their numbers."""
        return [MemberFailure(*row) for row in self.failure_rows()]

    def result(self, member: int) -> Result:
        """Return the present state of a member as a result with one frame, to draw and save.

        For a static scene this is the answer of its analysis, searched from the member's state.

        Raises
        ------
        IndexError
            If there is no such member.
        DerError
            If its state has numbers that are not finite, or the analysis of a static scene fails.
        """
        (number,) = self._numbers([member])
        result = result_of(self.scenario(number), [self.save_state(number)])
        for failure in self.failures:
            if failure.member == number:
                told = {"message": failure.message, "time": failure.time}
                result.summary.update(status=failure.status, failure=told)
        return result

    def plot(self, members: Members = None) -> Figure:
        """Draw the present shapes of members.

        Parameters
        ----------
        members
            Numbers of members, a mask of shape (members,), or one number; without it, up to eight
            that are evenly chosen.

        Raises
        ------
        IndexError
            If there is no such member.
        ValueError
            If none is named.
        """
        from der.plotting import plot_states  # here, because matplotlib takes long to load

        count = len(self)
        if members is None:
            members = np.unique(np.linspace(0, count - 1, _DRAWN).astype(int))
        numbers = self._numbers(members)
        if not numbers:
            raise ValueError("no member to draw is named: name one, or leave members out")
        labels = [f"member {n}{' (failed)' if self.failed[n] else ''}" for n in numbers]
        first = self.scenario(numbers[0])
        title = f"{first.title}: {len(numbers)} of {count} members"
        directors = None
        if self.model.name == "spatial":
            simulation = _core.Simulation(first)
            found = []
            for number in numbers:
                simulation.restore_state(self.save_state(number))
                found.append(simulation.directors)
            directors = np.stack(found)
        return plot_states(
            first,
            self.positions[numbers],
            labels,
            directors=directors,
            time=float(self.time[numbers[-1]]),
            title=title,
        )

    def __repr__(self) -> str:
        """Return title, time and size in one line."""
        return f"<der.Batch of {self.scenario(0).title!r}: {self._facts()}>"

    def _repr_html_(self) -> str:
        shown = self.failures[:_DRAWN]
        rows = [(str(f.member), f.status, f"{f.time:.6g}", f.message) for f in shown]
        table = [("member", "failed", "time [s]", "message"), *rows]
        return card(self.scenario(0).title, self._facts(), self.plot, [table])

    def _facts(self) -> str:
        failed = int(self.failed.sum())
        times = " to ".join(f"{time:g}" for time in np.unique([self.time.min(), self.time.max()]))
        return (
            f"{len(self)} members of {self.model.num_nodes} nodes, {failed or 'none'} failed, "
            f"t = {times} s, lanes {self.lanes}, threads {self.threads}"
        )

    def _numbers(self, members: Members) -> list[int]:
        if members is None:
            return list(range(len(self)))
        given = np.atleast_1d(_as_array(members))
        if given.dtype == np.bool_:
            if given.shape != (len(self),):
                raise ValueError(
                    f"a mask of members is an array of {len(self)} truth values, one for each "
                    f"member, not one of the shape {given.shape}"
                )
            return [int(number) for number in np.flatnonzero(given)]
        if given.size == 0:
            return []
        if given.ndim != 1 or not np.issubdtype(given.dtype, np.integer):
            raise TypeError(
                f"members are whole numbers, such as [0, 2], or a mask of {len(self)} truth "
                f"values, got {members!r}"
            )
        for number in given.tolist():
            if not 0 <= number < len(self):
                raise IndexError(
                    f"there is no member {number}: they are counted from 0 to {len(self) - 1}"
                )
        return [int(number) for number in given]

    def _rows(self, name: str, given: ArrayLike) -> NDArray[np.float64]:
        components = self.value_rows(name).shape[1]
        values = _as_numbers(name, given)
        if components == 1 and values.ndim == 1 and values.shape != (1,):
            values = values[:, None]
        shape = (len(self), components)
        # A value of several components has all of them: one number is not broadcast to them.
        if components > 1 and values.shape[-1:] != (components,):
            raise _other_shape(name, values, shape)
        return _broadcast(name, values, shape)


def _as_array(members: Any) -> NDArray[Any]:
    """Return an array of what is one, of one number, or of anything that lists numbers."""
    is_list = isinstance(members, Iterable) and not isinstance(members, np.ndarray)
    return np.asarray(list(members) if is_list else members)


def _as_numbers(name: str, given: ArrayLike) -> NDArray[np.float64]:
    try:
        values = np.asarray(given)
    except ValueError:  # rows of different lengths
        values = np.asarray(None)
    if values.dtype.kind not in "biuf":
        raise TypeError(f"'{name}' takes numbers, or arrays of them, got {given!r}")
    try:
        check_value_list(given)
    except ValueError as error:
        raise ValueError(f"'{name}': {error}") from None
    return values.astype(float, copy=False)


def _broadcast(
    name: str, values: NDArray[np.float64], shape: tuple[int, ...]
) -> NDArray[np.float64]:
    try:
        return np.ascontiguousarray(np.broadcast_to(values, shape))
    except ValueError:
        raise _other_shape(name, values, shape) from None


def _other_shape(name: str, values: NDArray[np.float64], shape: tuple[int, ...]) -> ValueError:
    return ValueError(
        f"'{name}' takes values of shape {shape}, a row for each member, or those of one "
        f"row for all, but here is an array of shape {values.shape}"
    )


def _one_each(path: str, given: Any, members: int) -> list[Any]:
    """Return the values of a path as a list with one for each member."""
    try:
        check_value_list(given)
    except ValueError as error:
        raise ValueError(f"vary: '{path}': {error}") from None
    values = given.tolist() if isinstance(given, np.ndarray) else given
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise ValueError(
            f"vary: '{path}' takes one value for each of the {members} members, not {given!r}; a "
            "value for all of them belongs into the scene (Scenario.with_)"
        )
    values = list(values)
    if len(values) != members:
        raise ValueError(
            f"vary: '{path}' has {len(values)} values for {members} members: give one for each"
        )
    return values
