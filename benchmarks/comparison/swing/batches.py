"""The swing many times over, as each code runs a batch: members for a second of one core.

`der` has `Batch`, MuJoCo `mujoco.rollout`, each on one thread here. PyElastica and DiSMech-Newton
have no batch, but step all rods of a simulation together, which spares most of the cost of Python.
Exudyn runs one after the other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import der

from comparison import run_der
from comparison.codes import DER, DISMECH, EXUDYN, MUJOCO, PYELASTICA, Code
from comparison.run_der import controls, implicit
from comparison.scene import FRAMES, Config, Path, distance, steps_per_frame
from comparison.swing import code_der, problem


@dataclass(frozen=True)
class Way:
    """A code with what it needs for a certain error.

    Attributes
    ----------
    code
        The code.
    text
        How it runs the members.
    members
        How many; of some codes, each takes much memory or time.
    run
        Runs so many; returns CPU seconds and the paths of their tips.
    """

    code: Code
    text: str
    members: int
    run: Callable[[int], tuple[float, Sequence[Path]]]


@dataclass(frozen=True)
class Cost:
    """What a way costs.

    Attributes
    ----------
    way
        The way.
    rate
        Members for a second of one core, the most of all repeats.
    error
        The largest distance of a tip from that of the continuum at all frames [m].
    own_error
        That from what the code itself converges to [m]; None where that is the continuum.
    """

    way: Way
    rate: float
    error: float
    own_error: float | None


def ways() -> list[Way]:
    """Return the ways of all codes that are installed.

    First is what a code needs for 1e-3 m, by benchmarks/peers.py, or of PyElastica for as much from
    its own limit; then the 24 elements that are enough for `der`. Explicit ones take their largest
    stable steps.
    """
    every = [
        Way(DER, "`Batch`, 24 elements, 300 steps", 100, _der(implicit(24, 3, "implicit_midpoint")))
    ]
    if MUJOCO.is_installed():
        for links, slides, steps in ((48, True, 51), (24, True, 25), (24, False, 7)):
            kind = "links with slides" if slides else "links"
            text = f"`rollout`, {links} {kind}, {FRAMES * steps} steps"
            every.append(Way(MUJOCO, text, 8, _mujoco(links, slides, steps)))
    if EXUDYN.is_installed():
        every.append(Way(EXUDYN, "22 cable elements, 300 steps", 8, _exudyn(22, 3)))
    if DISMECH.is_installed():
        every.append(Way(DISMECH, "one model, 144 edges, 300 steps", 8, _dismech(144, 3)))
    if PYELASTICA.is_installed():
        for elements, steps in ((50, 85), (24, 66)):
            text = f"one block, {elements} elements, {FRAMES * steps} steps"
            run = _pyelastica({"elements": elements, "steps": steps})
            every.append(Way(PYELASTICA, text, 16, run))
    return every


def measure(repeats: int, quick: bool) -> list[Cost]:
    """Run all ways in turns."""
    every = ways()
    least = [float("inf")] * len(every)
    errors = [0.0] * len(every)
    own_errors: list[float | None] = [None] * len(every)
    for _ in range(repeats):
        for i, way in enumerate(every):
            members = 2 if quick else way.members
            seconds, tips = way.run(members)
            least[i] = min(least[i], seconds / members)
            errors[i] = max(distance(tip, problem.reference()) for tip in tips)
            limit = _limit(way.code, quick)
            if limit is not None:
                own_errors[i] = max(distance(tip, limit) for tip in tips)
    return [
        Cost(way, 1.0 / seconds, error, own)
        for way, seconds, error, own in zip(every, least, errors, own_errors, strict=True)
    ]


@cache
def _limit(code: Code, quick: bool) -> Path | None:
    return code.limit("swing", quick)


def _der(config: Config) -> Callable[[int], tuple[float, Sequence[Path]]]:
    scene = der.Scenario.from_dict({**code_der.scene(int(config["elements"])), **controls(config)})

    def run(members: int) -> tuple[float, Sequence[Path]]:
        return run_der.run_batch(der.Batch(scene, members, 1), steps_per_frame(config))

    return run


def _mujoco(links: int, slides: bool, steps: int) -> Callable[[int], tuple[float, Sequence[Path]]]:
    from comparison import run_mujoco  # not before: it may not be installed
    from comparison.swing import code_mujoco

    config = {**code_mujoco.links_config(links, "Euler", "straddle", slides), "steps": steps}
    model, body, offset = code_mujoco.links(config)
    return lambda members: run_mujoco.roll_out(model, config, body, offset, 2, members)


def _exudyn(elements: int, steps: int) -> Callable[[int], tuple[float, Sequence[Path]]]:
    from comparison.swing import code_exudyn  # not before: it may not be installed

    config = code_exudyn.configuration(elements, steps, 1e-2, 0.5, 1.0, 2)

    def run(members: int) -> tuple[float, Sequence[Path]]:
        seconds, tips = zip(*(code_exudyn.run(config) for _ in range(members)), strict=True)
        return sum(seconds), tips

    return run


def _dismech(elements: int, steps: int) -> Callable[[int], tuple[float, Sequence[Path]]]:
    from comparison import run_dismech  # not before: it may not be installed
    from comparison.swing import code_dismech

    config = run_dismech.configuration(elements, steps, iterations=2, line_search=1)
    return lambda members: run_dismech.march(code_dismech.ROD, config, members, dimension=2)


def _pyelastica(config: Config) -> Callable[[int], tuple[float, Sequence[Path]]]:
    from comparison import run_pyelastica  # not before: it may not be installed
    from comparison.swing import code_pyelastica

    def run(members: int) -> tuple[float, Sequence[Path]]:
        run_pyelastica.compile_kernels()
        rods = [code_pyelastica.rod(int(config["elements"])) for _ in range(members)]
        return run_pyelastica.march(rods, config, code_pyelastica.GRAVITY, 2)

    return run


def table(costs: Sequence[Cost]) -> str:
    """Return a table of costs in Markdown; the first is the one that others are compared with."""
    lines = [
        "| code | a member | error | from its own limit | members a second | der over it |",
        "|---|---|---|---|---|---|",
    ]
    for cost in costs:
        own = "" if cost.own_error is None else f"{cost.own_error:.1e} m"
        lines.append(
            f"| {cost.way.code.title} | {cost.way.text} | {cost.error:.1e} m | {own} | "
            f"{cost.rate:.3g} | {costs[0].rate / cost.rate:.3g} |"
        )
    return "\n".join(lines)
