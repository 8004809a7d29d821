"""The numbers of the report, ours beside them, and the exact ones; their texts are in rows.csv."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import NamedTuple

import der
from references.falling_spheres import FallingRod

from . import exact
from .exact import LOAD_AT
from .measurements import WATER, Measurements, command_of, nodes_beside_the_load
from .numbers_as_text import duration, number, percent

#: What the report says in words: over an hour, under a minute [s].
EXPLICIT_SECONDS, IMPLICIT_SECONDS = 3600.0, 60.0
_TEXTS = Path(__file__).with_name("rows.csv")
_LOADS = {2000.0: "2kN", 20000.0: "20kN"}


@dataclass(frozen=True)
class Claim:
    """A number of the report as it is printed, in SI units."""

    text: str

    @property
    def value(self) -> float:
        """The number."""
        return float(self.text)

    @property
    def decimals(self) -> int:
        """How many there are."""
        return len(self.text.partition(".")[2])

    @property
    def half_digit(self) -> float:
        """Half a unit of its last digit: what rounding may have taken."""
        return 0.5 * 10.0**-self.decimals

    def rounded(self, value: float) -> str:
        """Return a value with as many decimals."""
        return f"{value:.{self.decimals}f}"

    def is_met_by(self, value: float) -> bool:
        """Tell whether a value rounds to it."""
        return abs(value - self.value) <= self.half_digit * (1.0 + 1e-9)


class Row(NamedTuple):
    """A row of the comparison.

    Attributes
    ----------
    key
        Short and unique.
    quantity, unit
        Name of the quantity, and its SI unit.
    report
        What the report says.
    ours
        The value of der; None for a formula that the report evaluates.
    error_bar
        Error bar of `ours`; None where there is none, as for a wall time.
    exact
        By independent mathematics; None where there is no such thing.
    remark
        Where the report is wrong, and why.
    command
        Prints `ours`; empty where no single run does.
    probe
        The probe that `ours` is the final value of, but for its sign; empty where the command
        prints it elsewhere.
    digits
        To print of `ours` where there is no error bar.
    """

    key: str
    quantity: str
    unit: str
    report: str
    ours: float | None
    error_bar: float | None
    exact: float | None
    remark: str
    command: str
    probe: str
    digits: int


def comparison(m: Measurements) -> list[Row]:
    """Return all rows."""
    with _TEXTS.open(encoding="utf-8", newline="") as file:
        texts = list(csv.DictReader(file))
    ours, true = _ours(m), _exact(m)
    remarks = _remarks(m, {text["key"]: Claim(text["report"]) for text in texts})
    rows = []
    for text in texts:
        key, run, probe = text["key"], text["run"], text["probe"]
        value, error_bar = ours[key] if key in ours else _final(m, run, probe)
        rows.append(
            Row(
                key,
                text["quantity"],
                text["unit"],
                text["report"],
                value,
                error_bar,
                true.get(key),
                Template(text["remark"]).substitute(remarks),
                command_of(run) if run else "",
                probe,
                int(text["digits"] or 0),
            )
        )
    return rows


def _final(m: Measurements, run: str, probe: str) -> tuple[float, float]:
    """Return a probe's last value without its sign, and its error bar."""
    final = abs(float(m.runs[run].summary["probes"][probe]["final"]))
    return final, m.verifications[run][probe].error_bar


def _ours(m: Measurements) -> dict[str, tuple[float | None, float | None]]:
    """Return our values and their error bars by key, but for final values of verified probes."""
    three, five = (
        float(der.Simulation(m.runs[name].scenario).node_masses.sum()) for name in ("three", "five")
    )
    angle = m.runs["three_equal"].summary["probes"]["angle"]
    angle_bars = [m.verifications["three_equal"]["angle", end].error_bar for end in ("min", "max")]
    return {
        "angle_equal": (max(abs(angle["min"]), abs(angle["max"])), max(angle_bars)),
        "explicit_seconds": (m.explicit_seconds, None),
        "implicit_seconds": (m.implicit_seconds, None),
        "stable_step": (m.stable_step, None),
        "blow_up": (float(m.runs["three_unstable"].summary["time"]), None),
        "mass_5_to_3": (five / three, None),
        **{f"middle_{name}": m.middles[load] for load, name in _LOADS.items()},
        **{f"deflection_{name}": m.deflections[load] for load, name in _LOADS.items()},
        **{f"euler_bernoulli_{name}": (None, None) for name in _LOADS.values()},
    }


def _exact(m: Measurements) -> dict[str, float]:
    """Return the exact values by key."""
    three, five = FallingRod(3, WATER), FallingRod(5, 0.0)
    fallen = {name: float(exact.fallen(motion)[-1]) for name, motion in m.exact_falls.items()}
    dry, wet = (exact.terminal_speed(FallingRod(21, density)) for density in (0.0, WATER))
    beams = m.exact_beams[LOAD_AT]
    return {
        "speed_3": float(exact.speed(m.exact_falls["three"])[-1]),
        "terminal_3": exact.terminal_speed(three),
        "fall_3": fallen["three"],
        "angle_equal": 0.0,
        "stable_step": exact.longest_stable_step(three),
        "mass_5_to_3": float(five.masses().sum() / three.masses().sum()),
        "fall_5_dry": fallen["five"],
        "fall_5_buoyant": fallen["five_buoyant"],
        "terminal_5": exact.terminal_speed(five),
        "terminal_21_dry": dry,
        "terminal_21_buoyant": wet,
        "terminal_21_coarse": dry,
        **{f"middle_{name}": beams[load].middle for load, name in _LOADS.items()},
        **{f"deflection_{name}": beams[load].largest for load, name in _LOADS.items()},
        **{f"euler_bernoulli_{name}": exact.linear_deflection(p) for p, name in _LOADS.items()},
    }


def _remarks(m: Measurements, claims: dict[str, Claim]) -> dict[str, str]:
    """Return the numbers in the remarks, and the remarks that depend on what fits."""
    true = _exact(m)
    steps = int(m.runs["three_explicit"].summary["steps"])
    fallen, dry, wet = (_final(m, run, "y_mid")[0] for run in ("three", "five", "five_buoyant"))
    fallen_dry = abs(float(m.runs["three_dry"].probes["y_mid"][-1]))
    texts = {
        "late": percent(true["speed_3"] / true["terminal_3"] - 1.0),
        "explicit_steps": f"{steps:,}",
        "implicit_steps": f"{int(m.runs['three'].summary['steps']):,}",
        "unstable_steps": f"{int(m.runs['three_unstable'].summary['steps'])}",
        "step_time": f"{number(1e6 * m.explicit_seconds / steps, 2)} µs",
        "hour_step_time": duration(EXPLICIT_SECONDS / steps),
        "cost_ratio": number(m.explicit_seconds / m.implicit_seconds, 2),
        "least_ratio": number(EXPLICIT_SECONDS / IMPLICIT_SECONDS, 2),
        "lighter": percent(1.0 - true["mass_5_to_3"]),
        "fall_3": number(fallen, 4),
        "more_dry": percent(dry / fallen - 1.0),
        "less": percent(1.0 - wet / fallen),
        "less_dry": percent(1.0 - dry / fallen_dry),
        "above_21": percent(true["terminal_5"] / true["terminal_21_dry"] - 1.0),
        "too_high": percent(
            claims["terminal_21_buoyant"].value / true["terminal_21_buoyant"] - 1.0
        ),
    }
    for load, name in _LOADS.items():
        linear, largest = true[f"euler_bernoulli_{name}"], true[f"deflection_{name}"]
        texts |= {
            f"linear_{name}": percent(linear / largest - 1.0),
            f"middle_{name}": _what_is_drawn(m.middles[load].value, claims[f"middle_{name}"]),
            f"deflection_{name}": _where_the_load_is(m, load, claims[f"deflection_{name}"]),
        }
    return texts


def _what_is_drawn(middle: float, claim: Claim) -> str:
    """Say whether the report's number is that of the centre node, of which it draws the history."""
    if not claim.is_met_by(middle):
        return f"It rounds to {claim.rounded(middle)} m, which is not the report's number."
    return (
        "The report's number. Its Figure 18 follows the centre node, so this is what could be read "
        "there; its text calls it the largest deflection, which is the next row."
    )


def _where_the_load_is(m: Measurements, load: float, claim: Claim) -> str:
    """Say whether the report's number is the largest deflection, and what else would explain it."""
    true = m.exact_beams[LOAD_AT][load]
    if claim.is_met_by(true.largest):
        return "The report's number is the exact one, rounded."
    text = f"The exact value rounds to {claim.rounded(true.largest)} m."
    if claim.is_met_by(true.middle):
        text += " The report's is that of the centre node: see the row above."
    elsewhere = {place: m.exact_beams[place][load].largest for place in nodes_beside_the_load()}
    fitting = [
        f"a load at {number(place, 2)} m ({number(value, 4)} m), a node of the report's mesh, for "
        f"{number(LOAD_AT, 2)} m lies between two"
        for place, value in elsewhere.items()
        if claim.is_met_by(value)
    ]
    if claim.is_met_by(true.largest - claim.half_digit):
        fitting.append("digits that were cut off, not rounded")
    if fitting:
        text += f" Less likely, as Figure 18 names that node: {', or '.join(fitting)}."
    return text
