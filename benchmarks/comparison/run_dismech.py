"""Runs of DiSMech-Newton: discrete elastic rods on NVIDIA Newton, in single precision.

On one core of the CPU, by Newton's method (``exact``) and the midpoint rule (``theta`` 1/2);
implicit Euler is far off at any step that is affordable. Its clamp holds an edge, which straddles
the wall. It describes rods with round sections; the model's stiffnesses, directors, masses and
moments of inertia are replaced by those of the rod at hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain, product

import numpy as np
import warp
from numpy.typing import NDArray

from comparison import scene
from comparison.scene import Config, Path, RunFailedError

warp.config.log_level = warp.LOG_ERROR  # it reports each kernel that it compiles


@warp.struct
class _AnyStruct:
    value: float


# Its annotations "Struct | None" are evaluated by Python before 3.14 and fail there.
if "__or__" not in vars(type(_AnyStruct)):
    type(_AnyStruct).__or__ = lambda self, other: self  # type: ignore[method-assign]

import dismech_newton  # noqa: E402
import newton  # noqa: E402


@dataclass(frozen=True)
class Rod:
    """A rod along x that is clamped at its start."""

    length: float  # [m]
    radius: float  # [m] of its description; nothing that counts follows from it
    axial_stiffness: float  # [N]
    bending_stiffness: float  # [N m^2] towards the first director
    second_bending_stiffness: float  # [N m^2] towards the second director
    twisting_stiffness: float  # [N m^2]
    mass_per_length: float  # [kg/m]
    spin_inertia: float  # [kg m] of a metre of the rod, about the tangent
    first_director: tuple[float, ...]
    gravity: tuple[float, float, float]  # [m/s^2]


def configuration(elements: int, steps: int, iterations: int, line_search: int) -> Config:
    """Return a configuration.

    Keys besides ``elements`` and ``steps``: ``iterations`` a step (one is too few), and
    ``line_search``, the step lengths that each of them tries.
    """
    return {
        "elements": elements,
        "steps": steps,
        "iterations": iterations,
        "line_search": line_search,
    }


def grid(quick: bool, coarse: Sequence[int], middle: Sequence[int]) -> list[Config]:
    """Return the configurations that are tried, with few elements and with more of them."""
    if quick:
        return [configuration(n, m, 2, 1) for n, m in ((20, 1), (40, 1))]
    every = chain(
        product(coarse, (1, 2), (2, 3), (1, 4)),
        product(middle, (2, 3, 4), (2, 3), (1,)),
        product((160, 240, 320), (4, 8), (2,), (1,)),
    )
    return [configuration(*parameters) for parameters in dict.fromkeys(every)]


def run(rod: Rod, config: Config, dimension: int) -> tuple[float, Path]:
    """Run a rod; return CPU seconds of the time loop and the first coordinates of the tip."""
    seconds, paths = march(rod, config, 1, dimension)
    return seconds, paths[0]


def march(rod: Rod, config: Config, members: int, dimension: int) -> tuple[float, list[Path]]:
    """Run so many rods in one model, whose steps solve one system of equations.

    Returns
    -------
    seconds, paths
        CPU seconds of the time loop, and the first `dimension` coordinates of the last node of each
        rod.
    """
    _compile(rod)
    return _march(rod, config, members, dimension)


@cache
def _compile(rod: Rod) -> None:
    """Let Warp compile everything before anything is timed."""
    _march(rod, configuration(4, 1, 2, 4), 1, 3)


def _march(rod: Rod, config: Config, members: int, dimension: int) -> tuple[float, list[Path]]:
    elements, steps = int(config["elements"]), scene.steps_per_frame(config)
    solver = dismech_newton.DiSMechSolver(
        model := _model(rod, elements, members),
        exact=True,
        theta=0.5,
        self_contact=False,
        iterations=int(config["iterations"]),
        linesearch=int(config["line_search"]),
    )
    now, after = model.state(), model.state()
    dismech_newton.flatten_state(now)

    def advance() -> None:
        nonlocal now, after
        for _ in range(steps):
            solver.step(now, after, None, None, scene.time_step(config))
            now, after = after, now

    def tips() -> NDArray[np.float64]:
        places = now.particle_q.numpy().reshape(members, elements + 1, 3)
        return np.asarray(places[:, -1, :dimension].ravel(), dtype=float)

    try:
        seconds, joined = scene.march(advance, tips)
    except RuntimeError as error:  # of the linear solver, at numbers that are none any more
        raise RunFailedError(str(error)) from error
    return seconds, np.split(joined, members, axis=1)


def _model(rod: Rod, elements: int, members: int) -> newton.Model:
    edge = rod.length / (elements - 0.5)
    places = np.zeros((elements + 1, 3))
    places[:, 0] = (np.arange(elements + 1) - 0.5) * edge
    builder = newton.ModelBuilder(gravity=rod.gravity)
    dismech_newton.register_custom_attributes(builder)
    description = newton.Rod(
        places,
        radius=rod.radius,
        stretch_rigidity=rod.axial_stiffness,
        shear_rigidity=0.0,  # not used: its edges do not shear
        bend_rigidity=rod.second_bending_stiffness,
        twist_rigidity=rod.twisting_stiffness,
    )
    for member in range(members):
        dismech_newton.add_rod(builder, description, proxies=False)
        dismech_newton.fix_segment(builder, edge=member * elements)
    model = builder.finalize(device="cpu")
    # A row for each joint: two stretches, bending towards its first and second director, twist.
    stiffness = model.dismech.triplet_params.numpy()
    stiffness[:, 3] = rod.bending_stiffness / edge
    model.dismech.triplet_params.assign(stiffness)
    edges = members * elements
    directors = np.tile(rod.first_director, (edges, 1)).astype(np.float32)
    model.dismech.edge_d1_q.assign(directors)
    model.dismech.edge_inertia.assign(np.full(edges, rod.spin_inertia * edge, dtype=np.float32))
    mass = np.full((members, elements + 1), rod.mass_per_length * edge, dtype=np.float32)
    mass[:, [0, -1]] *= 0.5
    model.particle_mass.assign(mass.ravel())
    model.particle_inv_mass.assign(1.0 / mass.ravel())
    return model
