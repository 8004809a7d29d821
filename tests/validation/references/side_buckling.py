"""Buckling to the side of a beam between a spring against turning and a clamp."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def beam_on_a_spring(towards_weak: float, about_tangent: float) -> float:
    """Least factor of a force at the middle, for EI_weak = GJ = L = 1.

    The start is held by a spring, rigid in the plane of the load; `np.inf` and 0 make it a clamp of
    the tangent, in which the section spins. In its plane the beam has the moment m, of -P/8 at the
    ends and P/8 at the middle. A deflection w across it and a turn phi of the sections have the
    energy

      1/2 integral of w''^2 + phi'^2 + 2 m phi w''  and  1/2 (k w'^2 + kt phi^2 + m phi w')(0)

    (Timoshenko and Gere, Theory of Elastic Stability, 6.2, as a potential; the spring as a short
    beam along which both grow evenly). So w'' + m phi is linear in s, and phi'' = m w''.
    """

    def moment(s: float, load: float) -> float:
        return load * (4 * min(s, 1 - s) - 1) / 8

    def determinant(load: float) -> float:
        def rate(s: float, y: list[float]) -> list[float]:
            _, slope, phi, twist, start, rise = y
            bend = start + rise * s - moment(s, load) * phi
            return [slope, bend, twist, moment(s, load) * bend, 0, 0]

        at_start = moment(0, load)
        ends = []
        for borne, phi, rise in np.eye(3):
            slope = borne / towards_weak
            twist = about_tangent * phi + at_start / 2 * slope
            y = [0, slope, phi, twist, borne + at_start / 2 * phi, rise]
            for half in [(0, 0.5), (0.5, 1)]:
                y = solve_ivp(rate, half, y, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
            ends.append(y[:3])
        return float(np.linalg.det(ends))

    low = 1.0
    while determinant(low) * determinant(low + 2) > 0:
        low += 2
    return float(brentq(determinant, low, low + 2, xtol=1e-10))
