"""Actions that no member can take, refused before anything is set."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.spaces import Discrete, MultiBinary, MultiDiscrete

if TYPE_CHECKING:
    from gymnasium import Space
    from numpy.typing import NDArray


def check_actions(space: Space[Any], actions: NDArray[Any]) -> None:
    """See that each action is one of a space of choices, or else of finite numbers.

    Those of a Box may lie outside of it.

    Parameters
    ----------
    space
        The space of one member.
    actions
        One action for each member, shape (members, ...).

    Raises
    ------
    ValueError
        If one is none; the message names the first.
    """
    if actions.dtype.kind not in "biuf":
        raise ValueError(f"actions are numbers, got an array of {actions.dtype}")
    choices = _choices(space)
    if choices is None:
        fits, wanted = np.isfinite(actions), "its numbers must be finite"
    else:
        if actions.dtype.kind == "f":
            raise ValueError(f"actions are whole numbers of {space}, got an array of floats")
        low, high = choices
        fits = (low <= actions) & (actions <= high)
        wanted = f"it must be one of {space}"
    of_member = fits.reshape(len(actions), -1).all(axis=1)
    if of_member.all():
        return
    member = int(np.argmin(of_member))
    whose = "an action" if len(actions) == 1 else f"the action of environment {member}"
    raise ValueError(f"{whose} is {actions[member]}: {wanted}")


def _choices(space: Space[Any]) -> tuple[Any, Any] | None:
    """Return the least and the largest whole numbers of a space; None if it has others."""
    if isinstance(space, Discrete):
        return space.start, space.start + space.n - 1
    if isinstance(space, MultiDiscrete):
        return space.start, space.start + space.nvec - 1
    if isinstance(space, MultiBinary):
        return 0, 1
    return None
