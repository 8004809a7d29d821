"""A batch whose members play episodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from der.batch import Batch
from der.scenario import SceneLike

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Episodes(Batch):
    """A `Batch` whose members play episodes: what the functions of a `Task` read and set.

    Attributes
    ----------
    drawn
        What `Task.draw` has drawn for the present episode of each member, shape (members, ...);
        (members, 0) without it.
    played
        How many actions each member has taken in its episode, shape (members,).
    """

    drawn: NDArray[np.float64]
    played: NDArray[np.int64]

    def __init__(
        self,
        scene: SceneLike,
        members: int,
        threads: int | None = None,
        *,
        vary: Mapping[str, ArrayLike | Sequence[Any]] | None = None,
        drawn_shape: tuple[int, ...] = (0,),
    ) -> None:
        super().__init__(scene, members, threads, vary=vary)
        self.drawn = np.zeros((members, *drawn_shape))
        self.played = np.zeros(members, dtype=np.int64)
