"""The errors that der raises on purpose."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from der.result import Result


@dataclass(frozen=True)
class Diagnostic:
    """One diagnostic of a scene.

    Attributes
    ----------
    line, column
        Where it stands in the text, counted from 1; 0 for a scene that is no text.
    path
        The key path, such as ``rods.beam.nodes``.
    message
        A sentence that says what is wrong and, if one is close, suggests the intended key.
    """

    line: int
    column: int
    path: str
    message: str


class DerError(RuntimeError):
    """Base of every error that der raises on purpose.

    Attributes
    ----------
    status
        Short machine-readable name, the same as ``status`` in ``summary.json``.
    result
        The data that a failed run recorded up to its last good step; None outside of runs.
    """

    def __init__(self, message: str, status: str = "error") -> None:
        super().__init__(message)
        self.status = status
        self.result: Result | None = None


class DerWarning(UserWarning):
    """A warning: der can run this, but it is probably not intended."""


class UnreliableResultWarning(DerWarning):
    """A run has left what the model can tell.

    The integrator has created energy that is not small against the energy exchanged, a rod has
    passed through itself or another, or is stretched to more than twice its rest length. The run
    goes on: the message says since when the result is unreliable, and what to try.
    """


def warn(messages: Iterable[str], category: type[DerWarning] = DerWarning) -> None:
    """Issue a warning for each message, at the line that called into der."""
    messages = tuple(messages)
    if not messages:  # as nearly always: the frames below take longer than an equilibrium's row
        return
    level = 2
    frame = inspect.currentframe()
    while (
        frame and (frame := frame.f_back) and frame.f_globals.get("__name__", "").startswith("der.")
    ):
        level += 1
    for message in messages:
        warnings.warn(message, category, stacklevel=level)


class SceneError(DerError, ValueError):
    """A scene that cannot be run as written.

    Attributes
    ----------
    diagnostics
        Every diagnostic, in the order of the text.
    """

    def __init__(self, message: str, diagnostics: Sequence[Diagnostic] = ()) -> None:
        super().__init__(message, "invalid_scene")
        self.diagnostics: tuple[Diagnostic, ...] = tuple(diagnostics)


class NotConvergedError(DerError):
    """Newton's method found no solution, even with the smallest allowed time step.

    In statics, no equilibrium was found; ``status`` says why: ``not_held`` (a load moves the
    structure as a rigid body), ``unbounded`` (it moves without end), ``collapsed`` (a part is
    compressed to zero length), ``folded`` (folded back on itself: too coarse a mesh), ``too_fine``
    (too many nodes for double precision) or ``not_converged``.
    """

    def __init__(self, message: str, status: str = "not_converged") -> None:
        super().__init__(message, status)


class DivergedError(DerError):
    """The motion grew without bound, or a value stopped being a number (``diverged``).

    Or the time stepping created as much as half of the energy that the run exchanges
    (``unstable_motion``).
    """

    def __init__(self, message: str, status: str = "diverged") -> None:
        super().__init__(message, status)
