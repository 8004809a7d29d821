"""Results of analyses besides shapes: vibration modes, buckling modes, paths of equilibria."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from der._core import path_events

Array = NDArray[np.float64]

#: How many values of modes stand in a line.
_SHOWN = 4


@dataclass(frozen=True, eq=False)
class Modes:
    """Free vibrations about an equilibrium, in the order of their squared frequency.

    Attributes
    ----------
    frequencies
        Natural frequencies [Hz], shape (modes,); 0 for a rigid motion that nothing holds, and for a
        motion that grows.
    growth_rates
        How fast a motion grows from an unstable equilibrium [1/s], shape (modes,); else 0.
    shapes
        Displacements of the nodes, shape (modes, nodes, dim), of modal mass 1 kg: ``v @ M @ v``
        is 1 with the mass matrix M, in which massive edges couple their two nodes.
    """

    frequencies: Array
    growth_rates: Array
    shapes: Array

    def __repr__(self) -> str:
        """Return the first values in one line."""
        return f"<der.Modes: {len(self.frequencies)} modes, {_first(self.frequencies)} Hz>"


@dataclass(frozen=True, eq=False)
class BucklingModes:
    """Linear buckling, with measures of whether it applies.

    Attributes
    ----------
    load_factors
        Critical factors of the scene's loads, shape (modes,), ascending.
    shapes
        Displacements of the nodes, shape (modes, nodes, dim), the largest component 1.
    rotations
        Largest rotation [rad] of an edge that the loads have caused at each factor, by linear
        theory, shape (modes,). Where it is not small, the structure bends before it buckles and
        the factor may be inaccurate: follow the path with `der.continuation`.
    strains
        Largest strain of an edge likewise, shape (modes,).
    """

    load_factors: Array
    shapes: Array
    rotations: Array
    strains: Array

    def __repr__(self) -> str:
        """Return the first values in one line."""
        factors = self.load_factors
        return f"<der.BucklingModes: {len(factors)} modes, load factors {_first(factors)}>"


@dataclass(frozen=True, eq=False)
class Path:
    """Equilibria along a load, branch by branch; one row for each frame of the result.

    Attributes
    ----------
    branch
        Number of the branch, shape (points,); 0 is the one that starts at the first factor.
    factor
        Factor of the loads (or prescribed motions), shape (points,).
    arc
        Length of the branch so far, in units of its own, shape (points,).
    unstable_directions
        Independent directions in which the equilibrium is unstable, shape (points,).
    events
        ``fold``, ``bifurcation``, ``out_of_plane`` (directions out of the plane of a planar model
        lose or regain their stability) or nothing, shape (points,); each event is at the branch
        that meets it first.
    unstable_out_of_plane
        Independent directions out of the plane in which the equilibrium of a planar model is
        unstable, shape (points,); None in space, and where that is not tested.
    """

    branch: NDArray[np.int64]
    factor: Array
    arc: Array
    unstable_directions: NDArray[np.int64]
    events: NDArray[np.str_]
    unstable_out_of_plane: NDArray[np.int64] | None = None

    def __repr__(self) -> str:
        """Return size, range and events in one line."""
        low, high = self.factor.min(initial=np.inf), self.factor.max(initial=-np.inf)
        kinds, counts = np.unique(self.events[self.events != ""], return_counts=True)
        events = ", ".join(f"{kind} {count}" for kind, count in zip(kinds, counts, strict=True))
        return (
            f"<der.Path: {len(self.factor)} points on {len(np.unique(self.branch))} branches, "
            f"load factors {low:.6g} to {high:.6g}, events: {events or 'none'}>"
        )

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether each point is stable, in its plane if the model is planar, shape (points,)."""
        return np.asarray(self.unstable_directions == 0)

    def rows(self, event: str, branch: int = 0) -> NDArray[np.int64]:
        """Return the rows of the events of one kind on a branch, in the order of the path."""
        return np.flatnonzero((self.events == event) & (self.branch == branch))


def _first(values: Array) -> str:
    shown = [f"{value:.6g}" for value in values[:_SHOWN]] + ["..."] * (len(values) > _SHOWN)
    return ", ".join(shown) or "none"


def make_modes(data: Mapping[str, Array]) -> Modes | None:
    """Collect vibration modes from the arrays of a run; None without any."""
    if "modes/frequencies" not in data:
        return None
    return Modes(data["modes/frequencies"], data["modes/growth_rates"], data["modes/shapes"])


def make_buckling_modes(data: Mapping[str, Array]) -> BucklingModes | None:
    """Collect buckling modes from the arrays of a run; None without any."""
    if "buckling/load_factors" not in data:
        return None
    return BucklingModes(
        *(data[f"buckling/{name}"] for name in ("load_factors", "shapes", "rotations", "strains"))
    )


def make_path(data: Mapping[str, Array]) -> Path | None:
    """Collect a path from the arrays of a run; None without one."""
    if "path/factor" not in data:
        return None
    out_of_plane = data.get("path/unstable_out_of_plane")
    return Path(
        data["path/branch"].astype(np.int64),
        data["path/factor"],
        data["path/arc"],
        data["path/unstable_directions"].astype(np.int64),
        np.array(path_events())[data["path/event"].astype(np.int64)],
        None if out_of_plane is None else out_of_plane.astype(np.int64),
    )
