"""The swing in PyElastica: a Cosserat rod, position Verlet, no damping.

Its clamp holds the first node and the direction of the first element, which so acts as a rigid
piece of half its length. The rod therefore starts half an element inside the wall; without that its
error is 20 to 40 times larger.

Its rod is another continuum than the reference: it shears, has rotary inertia, and its stiffness
falls as it stretches, since its volume is kept. That moves its limit by 2.5e-3 m (2.0e-3 m with a
shear modulus four times as large, at a shorter stable step), so it cannot come closer to the
reference. `limit` gives what it does converge to.
"""

from __future__ import annotations

from functools import cache

import elastica
import numpy as np

from swing import problem
from swing.problem import Config, Path2D


class _Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing):
    """The simulation as PyElastica needs it: systems, constraints and forces."""


def run(config: Config) -> tuple[float, Path2D]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip."""
    _compile()
    return _run(config)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried, each at its largest stable step."""
    elements = (10, 20, 30) if quick else (8, 10, 12, 16, 20, 24, 30, 40, 50, 60, 80, 120, 160, 200)
    return [{"elements": n, "steps": "fewest"} for n in elements]


def limit(quick: bool) -> Path2D:
    """Return the tip that its rod converges to, by extrapolation at its order, two."""
    fine, finest = (40, 80) if quick else (160, 320)
    coarser, finer = (run({"elements": n, "steps": 2 * n + 60})[1] for n in (fine, finest))
    return finer + (finer - coarser) / 3.0


@cache
def _compile() -> None:
    """Let Numba compile everything before anything is timed."""
    _run({"elements": 4, "steps": 200})


def _run(config: Config) -> tuple[float, Path2D]:
    elements, steps = int(config["elements"]), problem.steps_per_frame(config)
    rod, simulator = _model(elements)
    stepper, step = elastica.PositionVerlet(), np.float64(problem.time_step(config))
    time = np.float64(0.0)

    def advance() -> None:
        nonlocal time
        for _ in range(steps):
            time = stepper.step(simulator, time, step)

    with np.errstate(all="ignore"):  # an unstable run is found out by where the tip is
        return problem.march(advance, lambda: rod.position_collection[:, -1])


def _model(elements: int) -> tuple[elastica.CosseratRod, _Simulator]:
    edge = problem.LENGTH / (elements - 0.5)
    rod = elastica.CosseratRod.straight_rod(
        elements,
        start=np.array([-0.5 * edge, 0.0, 0.0]),
        direction=np.array([1.0, 0.0, 0.0]),
        normal=np.array([0.0, 1.0, 0.0]),
        base_length=elements * edge,
        base_radius=problem.RADIUS,
        density=problem.DENSITY,
        youngs_modulus=problem.YOUNGS_MODULUS,
        shear_modulus=problem.YOUNGS_MODULUS / 3.0,  # incompressible, as its stretching is
    )
    simulator = _Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(
        elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
    )
    simulator.add_forcing_to(rod).using(
        elastica.GravityForces, acc_gravity=np.array([0.0, -problem.GRAVITY, 0.0])
    )
    simulator.finalize()
    return rod, simulator
