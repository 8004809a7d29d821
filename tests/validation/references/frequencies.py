"""Natural frequencies of straight Euler-Bernoulli rods without rotary inertia.

Bending (Timoshenko, Vibration Problems in Engineering, ch. V): omega = root^2 sqrt(EI/(m L^4)),

    clamped-free      cos b cosh b = -1
    free-free         cos b cosh b = 1 (and clamped-clamped; rigid modes left out)
    clamped-pinned    tan b = tanh b
    pinned-pinned     b = n pi

Axial: omega = root sqrt(EA/(m L^2)), root = (n - 1/2) pi fixed-free, n pi fixed-fixed and
free-free.

Under an axial force N (tension positive, dead) the straight rod stretches by e = N/EA. The
second variation of the energy of `extensible_beam.py` about this state, s the rest length,
m the rest mass a unit length, v the transverse displacement, gives

    m v_tt + EI/(1+e)^2 v_ssss - N/(1+e) v_ss = 0
    pinned-pinned   m omega^2 = EI k^2 k^2/(1+e)^2 + N k^2/(1+e),   k = n pi/L

so that the frequency is zero at -N (1 + N/EA) = Pcr, the buckling load of the extensible
column (Pcr Euler's: pi^2 EI/L^2 for pinned ends); EI = 0 is the string, omega =
k sqrt(N / (m (1+e))). A free end carries the dead load too: v_ss = 0 and EI/(1+e)^2 v_sss =
N/(1+e) v_s. Other ends than pinned: roots of the characteristic determinant.
"""

from __future__ import annotations

from typing import Literal

import mpmath as mp
import numpy as np
from scipy.optimize import brentq

from .record import Array, Problem, Reference, exact

Axial = Literal["fixed-free", "fixed-fixed"]
Ends = Literal["clamped-free", "free-free", "clamped-clamped", "clamped-pinned", "pinned-pinned"]
ENDS: tuple[Ends, ...] = (
    "clamped-free",
    "free-free",
    "clamped-clamped",
    "clamped-pinned",
    "pinned-pinned",
)
COLUMNS: tuple[Ends, ...] = ("pinned-pinned", "clamped-free", "clamped-clamped")
AXIAL: tuple[Axial, ...] = ("fixed-free", "fixed-fixed")
BEAM_UNIT = "sqrt(EI/(m L^4))"
AXIAL_UNIT = "sqrt(EA/(m L^2))"
SLENDERNESS = 1e4
_SCAN = 0.05  # step in omega: far below the distance of two frequencies


def bending_root(ends: Ends, mode: int) -> float:
    """Root b of mode 1, 2, ..; omega = b^2 sqrt(EI / (m L^4))."""
    if mode < 1:
        raise ValueError(f"modes count from 1, got {mode}")
    with mp.workdps(40):
        if ends == "pinned-pinned":
            return float(mode * mp.pi)
        if ends == "clamped-pinned":
            near = (mode + mp.mpf(1) / 4) * mp.pi
            return float(mp.findroot(lambda b: mp.sin(b) - mp.cos(b) * mp.tanh(b), near))
        sign, first = (1, mp.mpf(1) / 2) if ends == "clamped-free" else (-1, mp.mpf(3) / 2)
        near = (first + mode - 1) * mp.pi
        return float(mp.findroot(lambda b: mp.cos(b) + sign / mp.cosh(b), near))


def axial_root(ends: Axial, mode: int) -> float:
    """Root of mode 1, 2, ..; omega = root sqrt(EA / (m L^2))."""
    return float((mode - 0.5 if ends == "fixed-free" else mode) * np.pi)


def pinned_frequency(force: float, slenderness: float, mode: int) -> float:
    """Angular frequency, in sqrt(EI/(m L^4)), of a pinned rod under the axial force N L^2/EI =
    `force` (tension positive); `slenderness` EA L^2/EI may be infinite. Zero and below the
    buckling load: nan.
    """
    stretch = 1.0 + force / slenderness
    k2 = (mode * np.pi) ** 2
    square = k2 * k2 / stretch**2 + force * k2 / stretch
    return float(np.sqrt(square)) if square >= 0.0 else float("nan")


def buckling_load(ends: Ends, slenderness: float) -> float:
    """First buckling load, in EI/L^2, of the extensible column (compression positive)."""
    euler = {
        "pinned-pinned": np.pi**2,
        "clamped-free": 0.25 * np.pi**2,
        "clamped-clamped": 4.0 * np.pi**2,
    }[ends]
    return float(2.0 * euler / (1.0 + np.sqrt(1.0 - 4.0 * euler / slenderness)))


def string_frequency(force: float, stretching: float, mass: float, mode: int) -> float:
    """Angular frequency (rad/s) of a string of rest length 1 m under the tension `force` (N),
    EA = `stretching` (N), rest mass a metre `mass` (kg/m).
    """
    return float(mode * np.pi * np.sqrt(force / (mass * (1.0 + force / stretching))))


_CONDITIONS = {
    "clamped": ("value", "slope"),
    "pinned": ("value", "moment"),
    "free": ("moment", "shear"),
}


def _end_rows(at: float, force: float, grow: float, turn: float) -> dict[str, Array]:
    """Value, slope, moment and shear at an end, for the four solutions exp(-a s), exp(-a (1 - s)),
    cos b s and sin b s of v_ssss - force v_ss = omega^2 v; a = `grow`, b = `turn`.
    """
    left, right = np.exp(-grow * at), np.exp(-grow * (1.0 - at))
    c, s = np.cos(turn * at), np.sin(turn * at)
    slope = np.array([-grow * left, grow * right, -turn * s, turn * c])
    third = np.array([-(grow**3) * left, grow**3 * right, turn**3 * s, -(turn**3) * c])
    return {
        "value": np.array([left, right, c, s]),
        "slope": slope,
        "moment": np.array([grow**2 * left, grow**2 * right, -(turn**2) * c, -(turn**2) * s]),
        "shear": third - force * slope,
    }


def _determinant(ends: Ends, force: float, omega: float) -> float:
    """Characteristic determinant of v_ssss - force v_ss = omega^2 v on [0, 1], rows scaled."""
    root = float(np.hypot(0.5 * force, omega))
    grow, turn = float(np.sqrt(root + 0.5 * force)), float(np.sqrt(root - 0.5 * force))
    matrix = []
    for at, kind in zip((0.0, 1.0), ends.split("-"), strict=True):
        held = _end_rows(at, force, grow, turn)
        matrix += [held[name] / np.abs(held[name]).max() for name in _CONDITIONS[kind]]
    return float(np.linalg.det(np.array(matrix)))


def loaded_frequency(ends: Ends, force: float, slenderness: float, mode: int) -> float:
    """Angular frequency, in sqrt(EI/(m L^4)), under the axial force N L^2/EI = `force`
    (tension positive), any ends.
    """
    stretch = 1.0 + force / slenderness
    scaled = force * stretch  # v_ssss - scaled v_ss = (stretch omega)^2 v
    found, low = 0, 1e-6  # omega = 0 is a false root, of coinciding solutions
    before = _determinant(ends, scaled, low)
    while True:
        high = low + _SCAN
        after = _determinant(ends, scaled, high)
        if before * after < 0.0:
            found += 1
            if found == mode:
                break
        low, before = high, after
    root = brentq(lambda w: _determinant(ends, scaled, w), low, high, xtol=1e-14, rtol=1e-14)
    return float(root) / stretch


def references() -> Problem:
    """Roots and frequencies of the first four modes."""
    values: dict[str, Reference] = {}
    modes = (1, 2, 3, 4)
    for ends in ENDS:
        for mode in modes:
            root = bending_root(ends, mode)
            values[f"bending.{ends}.{mode}.root"] = exact(root, "1/L")
            values[f"bending.{ends}.{mode}.omega"] = exact(root**2, BEAM_UNIT)
    for mode in modes:
        for axial in AXIAL:
            values[f"axial.{axial}.{mode}.omega"] = exact(axial_root(axial, mode), AXIAL_UNIT)
        values[f"string.{mode}.omega"] = exact(string_frequency(100.0, 1e4, 0.01, mode), "rad/s")
    for ends in COLUMNS:
        critical = buckling_load(ends, SLENDERNESS)
        values[f"loaded.{ends}.critical"] = exact(critical, "EI/L^2")
        for share in (-1.0, 0.25, 0.5, 0.75, 0.95, 0.99):
            for mode in modes:
                omega = loaded_frequency(ends, -share * critical, SLENDERNESS, mode)
                # Rounding of the load moves omega^2, hence omega by 1/omega near buckling.
                error = 1e-12 * (omega + 1.0 / omega)
                label = f"loaded.{ends}.{share:g}.{mode}.omega"
                values[label] = Reference(omega, error, BEAM_UNIT)
    return Problem(
        "frequencies",
        "angular frequencies of modes 1 to 4; 'loaded' is under a dead axial compression of that "
        "share of the extensible buckling load ('critical'; negative: tension), slenderness "
        "EA L^2/EI = 1e4, m the rest mass and L the rest length; 'string' has rest length 1 m, "
        "tension 100 N, EA 1e4 N, rest mass 0.01 kg/m",
        "characteristic equations: 40 digits for the unloaded beams, determinants in double "
        "precision for the loaded ones",
        values,
    )
