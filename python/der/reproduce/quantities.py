"""The numbers of the report, ours beside them, and the exact ones."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

from der.accuracy import VerifiedValue
from der.reproduce import report_claims as report
from der.reproduce.beam_exact import Tube, euler_bernoulli_deflection
from der.reproduce.content import Table
from der.reproduce.falling_exact import FallingChain
from der.reproduce.measurements import (
    LOADS,
    WATER,
    Deflection,
    Measurements,
    command_of,
    nodes_beside_the_load,
)
from der.reproduce.numbers_as_text import digits_within, duration, number, percent, with_error_bar
from der.reproduce.report_claims import Claim
from der.simulation import Simulation

_EXACT_DIGITS = 8  # where nothing says how many tell


@dataclass(frozen=True)
class Quantity:
    """A row of the comparison.

    Attributes
    ----------
    key
        Short and unique.
    name, unit
        Name of the quantity, and its SI unit.
    claim
        The value of the report; a text if that is not a number.
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
    name: str
    unit: str
    claim: Claim | str
    ours: float | None
    error_bar: float | None
    exact: float | None
    remark: str
    command: str = ""
    probe: str = ""
    digits: int = 4

    def cells(self) -> list[str]:
        """Return the row as it is printed."""
        claim = self.claim.text if isinstance(self.claim, Claim) else self.claim
        digits, exact_digits = self.digits, _EXACT_DIGITS
        if self.ours is not None and self.error_bar is not None:
            digits = digits_within(self.ours, self.error_bar)
            exact_digits = digits + 1  # so that it shows where in the bar the exact value is
        return [
            self.name,
            self.unit,
            claim or "-",
            "-" if self.ours is None else number(self.ours, digits),
            "-" if self.error_bar is None else f"±\u00a0{number(self.error_bar, 2)}",
            "-" if self.exact is None else number(self.exact, exact_digits),
            self.remark,
        ]


def quantities(m: Measurements) -> list[Quantity]:
    """Return all rows."""
    return [*_three_nodes(m), *_schemes(m), *_many_nodes(m), *_tube(m)]


def comparison_table(rows: Sequence[Quantity]) -> Table:
    """Return the rows as a table."""
    return Table(
        caption="The report's numbers. Error bars are those of `der verify`: the exact value is "
        "within ours plus or minus the bar.",
        columns=["Quantity", "Unit", "Report", "Ours", "Error bar", "Exact", "Remark"],
        align=["left", "left", "right", "right", "right", "right", "left"],
        rows=[row.cells() for row in rows],
    )


def comparison_csv(rows: Sequence[Quantity]) -> str:
    """Return the rows with all digits."""
    heads = ["key", "quantity", "unit", "report", "ours", "error_bar", "exact"]
    table: list[list[str]] = [[*heads, "remark", "command", "probe"]]
    for row in rows:
        claim = row.claim.text if isinstance(row.claim, Claim) else row.claim
        numbers = ["" if x is None else repr(x) for x in (row.ours, row.error_bar, row.exact)]
        table.append(
            [row.key, row.name, row.unit, claim, *numbers, row.remark, row.command, row.probe]
        )
    return to_csv(table)


def to_csv(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as comma-separated text."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def deflection_table(m: Measurements) -> Table:
    """Return deflection against load."""
    rows = []
    for load, ours, exact, linear in _deflections(m):
        rows.append(
            [
                number(load, 1 if load < 1e4 else 2),
                with_error_bar(ours.value, ours.error_bar),
                f"±\u00a0{number(ours.error_bar, 2)}",
                number(exact, _EXACT_DIGITS),
                number(linear, _EXACT_DIGITS),
                percent(ours.value / exact - 1.0),
                percent(linear / exact - 1.0),
            ]
        )
    return Table(
        caption="Largest deflection [m] of the tube against its load [N]: ours with 51 nodes, the "
        "exact extensible elastica, Euler-Bernoulli theory, and what both are off.",
        columns=[
            "Load",
            "Ours",
            "Error bar",
            "Exact",
            "Euler-Bernoulli",
            "Our error",
            "E.-B. error",
        ],
        align=["right"] * 7,
        rows=rows,
    )


def deflection_csv(m: Measurements) -> str:
    """Return deflection against load with all digits."""
    heads = ["load_N", "ours_m", "error_bar_m", "exact_m", "euler_bernoulli_m", "command"]
    rows = [
        [*map(repr, (load, ours.value, ours.error_bar, exact, linear)), command_of(("load", load))]
        for load, ours, exact, linear in _deflections(m)
    ]
    return to_csv([heads, *rows])


def speeds_csv(m: Measurements) -> str:
    """Return the speed after 50 s against nodes and against the step, with all digits."""
    rows = [["nodes", "step_s", "fluid_density_kg_m3", "ours_m_s", "terminal_m_s", "command"]]
    for (nodes, density), speed in m.speeds_by_nodes.items():
        balance = FallingChain(nodes, density).terminal_speed
        numbers = (nodes, 0.01, density, speed, balance)
        rows.append([*map(repr, numbers), command_of(("nodes", nodes, density))])
    for (step, density), speed in m.speeds_by_step.items():
        balance = FallingChain(21, density).terminal_speed
        numbers = (21, step, density, speed, balance)
        rows.append([*map(repr, numbers), command_of(("step", step, density))])
    return to_csv(rows)


def _final(m: Measurements, run: str, probe: str) -> tuple[float, float]:
    """Return a probe's last value without its sign, and its error bar."""
    found: VerifiedValue = m.verifications[run][probe]
    return abs(float(m.runs[run].summary["probes"][probe]["final"])), found.error_bar


def _three_nodes(m: Measurements) -> list[Quantity]:
    exact = m.exact_falls["three"]
    speed, speed_bar = _final(m, "three", "v_mid")
    terminal, terminal_bar = _final(m, "three_long", "v_mid")
    fallen, fallen_bar = _final(m, "three", "y_mid")
    balance = FallingChain(3, WATER).terminal_speed
    late = percent(float(exact.speed[-1]) / balance - 1.0)
    angle = m.runs["three_equal"].summary["probes"]["angle"]
    angle_error_bars = [
        m.verifications["three_equal"]["angle", what].error_bar for what in ("min", "max")
    ]
    return [
        Quantity(
            "speed_3",
            "3 nodes: speed of the middle sphere at 10 s",
            "m/s",
            report.TERMINAL_SPEED_3,
            speed,
            speed_bar,
            float(exact.speed[-1]),
            "The report's number, to its last digit. It is called the terminal speed there, but it "
            "is the speed at 10 s: see the next row.",
            command_of("three"),
            "v_mid",
        ),
        Quantity(
            "terminal_3",
            "3 nodes: terminal speed",
            "m/s",
            report.TERMINAL_SPEED_3,
            terminal,
            terminal_bar,
            balance,
            f"At 10 s the rod still bends, and the speed is {late} above the terminal one, at "
            "which drag and weight less buoyancy are equal. Ours is the speed at 50 s.",
            command_of("three_long"),
            "v_mid",
        ),
        Quantity(
            "fall_3",
            "3 nodes: fall of the middle sphere in 10 s",
            "m",
            "",
            fallen,
            fallen_bar,
            float(exact.fallen[-1]),
            "In the report only as a curve.",
            command_of("three"),
            "y_mid",
        ),
        Quantity(
            "angle_equal",
            "3 equal spheres: largest turning angle",
            "rad",
            "small fluctuations",
            max(abs(angle["min"]), abs(angle["max"])),
            max(angle_error_bars),
            0.0,
            "Equal spheres fall alike, so that the angle is zero. Fluctuations can only be "
            "rounding, or what Newton's method leaves; they are not a trait of implicit schemes.",
            command_of("three_equal"),
            "angle",
        ),
    ]


def _schemes(m: Measurements) -> list[Quantity]:
    explicit, implicit = m.runs["three_explicit"], m.runs["three"]
    steps = int(explicit.summary["steps"])
    unstable = m.runs["three_unstable"]
    least_ratio = report.EXPLICIT_SECONDS.value / report.IMPLICIT_SECONDS.value
    ours_ratio = m.explicit_seconds / m.implicit_seconds
    exact_step = FallingChain(3, WATER).longest_stable_step()
    return [
        Quantity(
            "explicit_seconds",
            "3 nodes: wall time of 10 s, explicit, steps of 0.00001 s",
            "s",
            "over an hour",
            m.explicit_seconds,
            None,
            None,
            f"{steps:,} steps at {number(1e6 * m.explicit_seconds / steps, 2)} \u00b5s "
            f"each. An hour would be {duration(report.EXPLICIT_SECONDS.value / steps)} each: the "
            "price of an interpreted loop, not of the scheme. Wall times depend on the machine.",
            command_of("three_explicit"),
            digits=2,
        ),
        Quantity(
            "implicit_seconds",
            "3 nodes: wall time of 10 s, implicit, steps of 0.01 s",
            "s",
            "under a minute",
            m.implicit_seconds,
            None,
            None,
            f"{int(implicit.summary['steps']):,} steps. The explicit scheme costs "
            f"{number(ours_ratio, 2)} times as much, in the report at least "
            f"{number(least_ratio, 2)} times.",
            command_of("three_implicit"),
            digits=2,
        ),
        Quantity(
            "stable_step",
            "3 nodes: longest stable explicit step",
            "s",
            f"{report.STABLE_STEP.text} to {report.UNSTABLE_STEP.text}",
            m.stable_step,
            None,
            exact_step,
            "Ours is the longest step that `der_run` takes, an estimate on the safe side. The drag "
            "of the small spheres sets it. Exact: eigenvalues of one step about the straight rod.",
        ),
        Quantity(
            "blow_up",
            "3 nodes: time that explicit steps of 0.0001 s reach",
            "s",
            "10, in 5 minutes",
            float(unstable.summary["time"]),
            None,
            None,
            f"After {int(unstable.summary['steps'])} steps an edge is a hundred times too long, "
            "and the run ends with an error. The motion from there on says nothing about the rod.",
            command_of("three_unstable"),
            digits=2,
        ),
    ]


def _many_nodes(m: Measurements) -> list[Quantity]:
    three, five = FallingChain(3, WATER), FallingChain(5, 0.0)
    masses = [
        float(Simulation(m.runs[name].scenario).node_masses.sum()) for name in ("three", "five")
    ]
    mass_ratio = float(five.masses.sum() / three.masses.sum())
    dry, dry_bar = _final(m, "five", "y_mid")
    wet, wet_bar = _final(m, "five_buoyant", "y_mid")
    fallen, _ = _final(m, "three", "y_mid")
    fallen_dry = abs(float(m.runs["three_dry"].probes["y_mid"][-1]))
    terminal_5, terminal_5_bar = _final(m, "five_long", "v_mid")
    rows = [
        Quantity(
            "mass_5_to_3",
            "5 nodes: mass, as a share of that with 3 nodes",
            "1",
            "the same",
            masses[1] / masses[0],
            None,
            mass_ratio,
            f"Not the same: the small spheres lose most of their volume, which makes the chain "
            f"{percent(1.0 - mass_ratio)} lighter.",
        ),
        Quantity(
            "fall_5_dry",
            "5 nodes, no buoyancy: fall of the middle sphere in 10 s",
            "m",
            "a little more than with 3",
            dry,
            dry_bar,
            float(m.exact_falls["five"].fallen[-1]),
            f"It is {percent(dry / fallen - 1.0)} more than the {number(fallen, 4)} m of 3 nodes, "
            "but only because buoyancy, which the 3 nodes had, was left out: see the next row.",
            command_of("five"),
            "y_mid",
        ),
        Quantity(
            "fall_5_buoyant",
            "5 nodes, with buoyancy: the same",
            "m",
            "",
            wet,
            wet_bar,
            float(m.exact_falls["five_buoyant"].fallen[-1]),
            f"Like with like, 5 nodes fall {percent(1.0 - wet / fallen)} less than 3; both without "
            f"buoyancy, {percent(1.0 - dry / fallen_dry)} less.",
            command_of("five_buoyant"),
            "y_mid",
        ),
        Quantity(
            "terminal_5",
            "5 nodes, no buoyancy: terminal speed",
            "m/s",
            "",
            terminal_5,
            terminal_5_bar,
            five.terminal_speed,
            "The report gives a number for 21 nodes only, and calls that of 5 overlapping; it is "
            f"{percent(five.terminal_speed / FallingChain(21, 0.0).terminal_speed - 1.0)} more.",
            command_of("five_long"),
            "v_mid",
        ),
    ]
    return rows + _twenty_one_nodes(m)


def _twenty_one_nodes(m: Measurements) -> list[Quantity]:
    dry, wet = FallingChain(21, 0.0), FallingChain(21, WATER)
    rows = []
    for key, run, name, chain, remark in (
        (
            "terminal_21_dry",
            "twenty_one",
            "21 nodes, no buoyancy: terminal speed",
            dry,
            "The report's number is the one without buoyancy, although its first problem has it.",
        ),
        (
            "terminal_21_buoyant",
            "twenty_one_buoyant",
            "21 nodes, with buoyancy: terminal speed",
            wet,
            "With the fluid of the first problem the report's number is "
            f"{percent(report.TERMINAL_SPEED_21.value / wet.terminal_speed - 1.0)} too high.",
        ),
        (
            "terminal_21_coarse",
            "twenty_one_coarse",
            "21 nodes, no buoyancy: speed at 50 s, steps of 10 s",
            dry,
            "As the report says, the step hardly matters for the end of a long fall. For the way "
            "there it does.",
        ),
    ):
        value, error_bar = _final(m, run, "v_mid")
        rows.append(
            Quantity(
                key,
                name,
                "m/s",
                report.TERMINAL_SPEED_21,
                value,
                error_bar,
                chain.terminal_speed,
                remark,
                command_of(run),
                "v_mid",
            )
        )
    return rows


def _tube(m: Measurements) -> list[Quantity]:
    rows = []
    for load, run, claim, linear_claim in (
        (2000.0, "beam", report.DEFLECTION_2_KN, report.LINEAR_DEFLECTION_2_KN),
        (20000.0, "beam_20kN", report.DEFLECTION_20_KN, report.LINEAR_DEFLECTION_20_KN),
    ):
        ours = m.deflections[load]
        exact = m.exact_deflections[Tube().load_at][load]
        linear = euler_bernoulli_deflection(Tube(), load)
        kilonewtons = number(1e-3 * load, 1 if load < 1e4 else 2)
        middle = m.middles[load]
        rows += [
            Quantity(
                f"middle_{kilonewtons}kN",
                f"Tube under {kilonewtons} kN: deflection of the centre node",
                "m",
                claim,
                middle.value,
                middle.error_bar,
                m.exact_middles[Tube().load_at][load],
                _what_is_drawn(middle.value, claim),
                command_of(run),
                "middle",
            ),
            Quantity(
                f"deflection_{kilonewtons}kN",
                f"Tube under {kilonewtons} kN: largest deflection",
                "m",
                claim,
                ours.value,
                ours.error_bar,
                exact,
                _where_the_load_is(m, load, claim),
                command_of(run),
                "deflection",
            ),
            Quantity(
                f"euler_bernoulli_{kilonewtons}kN",
                f"Tube under {kilonewtons} kN: the same by Euler-Bernoulli theory",
                "m",
                linear_claim,
                None,
                None,
                linear,
                f"The formula, evaluated. It is {percent(linear / exact - 1.0)} above the "
                "deflection of the tube.",
            ),
        ]
    return rows


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
    exact = m.exact_deflections[Tube().load_at][load]
    if claim.is_met_by(exact):
        return "The report's number is the exact one, rounded."
    text = f"The exact value rounds to {claim.rounded(exact)} m."
    middle = m.exact_middles[Tube().load_at][load]
    if claim.is_met_by(middle):
        text += " The report's is that of the centre node: see the row above."
    fitting = [
        f"a load at {number(place, 2)} m ({number(m.exact_deflections[place][load], 4)} m), a node "
        f"of the report's mesh, for {number(Tube().load_at, 2)} m lies between two"
        for place in nodes_beside_the_load()
        if claim.is_met_by(m.exact_deflections[place][load])
    ]
    if claim.is_met_by(exact - claim.half_digit):
        fitting.append("digits that were cut off, not rounded")
    if fitting:
        text += f" Less likely, as Figure 18 names that node: {', or '.join(fitting)}."
    return text


def _deflections(m: Measurements) -> list[tuple[float, Deflection, float, float]]:
    """Return load, ours, exact and linear deflection, row by row."""
    tube = Tube()
    exact = m.exact_deflections[tube.load_at]
    return [
        (load, m.deflections[load], exact[load], euler_bernoulli_deflection(tube, load))
        for load in LOADS
    ]
