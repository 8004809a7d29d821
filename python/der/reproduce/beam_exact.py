"""The simply supported tube of the report as a continuum, solved without the engine.

A rod that bends and stretches but does not shear, per length s at rest:

    x' = (1 + e) cos(t),   y' = (1 + e) sin(t),   t' = M / EI,   M' = -(1 + e) n cos(t)

with t the angle, M the moment, n the vertical internal force (nothing holds the roller, so that
there is no horizontal one) and e = n sin(t) / EA the strain (Antman, Nonlinear Problems of
Elasticity, ch. IV). n is minus the reaction R of the left support before the load P and P - R after
it. The two unknowns, R and the angle at the left support, are found by shooting: they make height
and moment vanish at the roller.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_TOLERANCE = 1e-12
_LARGEST_LOAD_STEP = 2.0  # in units of EI / L^2


@dataclass(frozen=True)
class Tube:
    """The report's tube; all in SI units, ``load_at`` from the pinned end."""

    length: float = 1.0
    inner_radius: float = 0.011
    outer_radius: float = 0.013
    youngs_modulus: float = 70e9
    load_at: float = 0.75

    @property
    def stretching_stiffness(self) -> float:
        """EA [N]."""
        return self.youngs_modulus * np.pi * (self.outer_radius**2 - self.inner_radius**2)

    @property
    def bending_stiffness(self) -> float:
        """EI [N m^2]."""
        return self.youngs_modulus * np.pi * (self.outer_radius**4 - self.inner_radius**4) / 4.0


def euler_bernoulli_deflection(tube: Tube, load: float) -> float:
    """Return the largest deflection [m] of linear theory, P b (L^2 - b^2)^(3/2) / (9 sqrt(3) EI L).

    b is the distance of the load from the nearer support.
    """
    near = min(tube.load_at, tube.length - tube.load_at)
    span = (tube.length**2 - near**2) ** 1.5
    stiffness = 9.0 * np.sqrt(3.0) * tube.bending_stiffness * tube.length
    return float(load * near * span / stiffness)


@dataclass(frozen=True)
class Deflection:
    """Deflections of the continuum [m], downward: the largest, and that at half the rest length."""

    largest: float
    middle: float


def elastica_deflections(tube: Tube, loads: Sequence[float]) -> list[Deflection]:
    """Return deflections of the extensible elastica under each load [N].

    Parameters
    ----------
    tube
        The beam.
    loads
        Positive, ascending: each solution is the start for the next.

    Raises
    ------
    RuntimeError
        If the shooting misses.
    """
    shooting = _Shooting(tube)
    unit = tube.bending_stiffness / tube.length**2
    deflections = []
    done = 0.0
    for load in loads:
        steps = int(np.ceil((load - done) / unit / _LARGEST_LOAD_STEP))
        for level in np.linspace(done, load, steps + 1)[1:]:
            shooting.solve(level / unit)
        deflections.append(
            Deflection(
                shooting.largest_deflection() * tube.length,
                shooting.middle_deflection() * tube.length,
            )
        )
        done = load
    return deflections


class _Shooting:
    """Solutions for a rising load, with lengths in L and forces in EI / L^2."""

    def __init__(self, tube: Tube) -> None:
        self._at = tube.load_at / tube.length
        self._slenderness = (
            tube.stretching_stiffness * tube.length**2 / tube.bending_stiffness
        )  # EA in the unit of force
        self._load = 0.0
        rest = 1.0 - self._at
        # Per load, by linear theory: angle at the left support, and its reaction.
        self._rate = np.array([-rest * (1.0 - rest**2) / 6.0, rest])
        self._unknowns = np.zeros(2)

    def solve(self, load: float) -> None:
        """Go on to a load."""
        from scipy.optimize import root  # here, because it takes long to load

        step = load - self._load
        found = root(
            lambda unknowns: self._misses(unknowns, load),
            self._unknowns + step * self._rate,
            method="hybr",
            options={"xtol": 1e-13},
        )
        if np.abs(found.fun).max() > 1e-9 * max(load, 1.0):
            raise RuntimeError(f"shooting misses at a load of {load:g} EI/L^2: {found.message}")
        self._rate = (found.x - self._unknowns) / step
        self._unknowns = found.x
        self._load = load

    def largest_deflection(self) -> float:
        """Return the depth of the point where the angle is zero."""
        depths = [
            -float(state[1])
            for piece in self._pieces(self._unknowns, self._load)
            for state in piece.y_events[0]
        ]
        return max(depths)

    def middle_deflection(self) -> float:
        """Return the depth at half the rest length."""
        before, behind = self._pieces(self._unknowns, self._load)
        piece = before if self._at >= 0.5 else behind
        return -float(piece.sol(0.5)[1])

    def _misses(self, unknowns: Array, load: float) -> Array:
        end = self._pieces(unknowns, load)[1].y[:, -1]
        return np.array([end[1] * load, end[3]])

    def _pieces(self, unknowns: Array, load: float) -> list[Any]:
        """Integrate from the pin to the load and on to the roller."""
        from scipy.integrate import solve_ivp

        angle, reaction = unknowns
        state = np.array([0.0, 0.0, angle, 0.0])
        pieces = []
        for span, force in (((0.0, self._at), -reaction), ((self._at, 1.0), load - reaction)):
            piece = solve_ivp(
                self._rates,
                span,
                state,
                method="DOP853",
                args=(force,),
                events=_angle,
                dense_output=True,
                rtol=_TOLERANCE,
                atol=_TOLERANCE,
            )
            state = piece.y[:, -1]
            pieces.append(piece)
        return pieces

    def _rates(self, _s: float, state: Array, force: float) -> Array:
        cosine, sine = np.cos(state[2]), np.sin(state[2])
        stretch = 1.0 + force * sine / self._slenderness
        return np.array([stretch * cosine, stretch * sine, state[3], -stretch * force * cosine])


def _angle(_s: float, state: Array, _force: float) -> float:
    return float(state[2])
