"""The strip in DiSMech-Newton: discrete elastic rods on NVIDIA Newton, in single precision.

On one core of the CPU, by Newton's method (``exact``) and the midpoint rule (``theta`` 1/2);
implicit Euler is far off at any step that is affordable. Its clamp holds an edge, which straddles
the wall. It describes rods with round sections; the model's stiffnesses, directors, masses and
moments of inertia are replaced by those of the strip.
"""

from __future__ import annotations

from functools import cache
from itertools import chain, product

import numpy as np
import warp

from comparison import scene
from comparison.scene import Config, Path, RunFailedError
from comparison.strip import problem

warp.config.log_level = warp.LOG_ERROR  # it reports each kernel that it compiles


@warp.struct
class _AnyStruct:
    value: float


# Its annotations "Struct | None" are evaluated by Python before 3.14 and fail there.
if "__or__" not in vars(type(_AnyStruct)):
    type(_AnyStruct).__or__ = lambda self, other: self  # type: ignore[method-assign]

import dismech_newton  # noqa: E402
import newton  # noqa: E402


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip.

    Keys besides ``elements`` and ``steps``: ``iterations`` a step, and ``line_search``, the step
    lengths that each of them tries.
    """
    _compile()
    return _run(config)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried; one iteration a step is too few."""
    if quick:
        return [_config(n, m, 2, 1) for n, m in ((20, 1), (40, 1))]
    coarse = product((28, 36, 40, 44, 48, 56), (1, 2), (2, 3), (1, 4))
    middle = product((120, 136, 144, 152, 160, 176), (2, 3, 4), (2, 3), (1,))
    fine = product((160, 240, 320), (4, 8), (2,), (1,))
    return [_config(*parameters) for parameters in dict.fromkeys(chain(coarse, middle, fine))]


def _config(elements: int, steps: int, iterations: int, line_search: int) -> Config:
    return {
        "elements": elements,
        "steps": steps,
        "iterations": iterations,
        "line_search": line_search,
    }


@cache
def _compile() -> None:
    """Let Warp compile everything before anything is timed."""
    _run(_config(4, 1, 2, 4))


def _run(config: Config) -> tuple[float, Path]:
    elements, steps = int(config["elements"]), scene.steps_per_frame(config)
    model = _model(elements)
    solver = dismech_newton.DiSMechSolver(
        model,
        exact=True,
        theta=0.5,
        self_contact=False,
        iterations=int(config["iterations"]),
        linesearch=int(config["line_search"]),
    )
    now, after = model.state(), model.state()
    dismech_newton.flatten_state(now)
    last = slice(3 * elements, 3 * elements + 3)

    def advance() -> None:
        nonlocal now, after
        for _ in range(steps):
            solver.step(now, after, None, None, scene.time_step(config))
            now, after = after, now

    try:
        return scene.march(advance, lambda: now.dismech.q.numpy()[last])
    except RuntimeError as error:  # of the linear solver, at numbers that are none any more
        raise RunFailedError(str(error)) from error


def _model(elements: int) -> newton.Model:
    edge = problem.LENGTH / (elements - 0.5)
    places = np.zeros((elements + 1, 3))
    places[:, 0] = (np.arange(elements + 1) - 0.5) * edge
    builder = newton.ModelBuilder(gravity=problem.GRAVITY)
    dismech_newton.register_custom_attributes(builder)
    rod = newton.Rod(
        places,
        radius=0.5 * problem.THICKNESS,
        stretch_rigidity=problem.AXIAL_STIFFNESS,
        shear_rigidity=0.0,  # not used: its edges do not shear
        bend_rigidity=problem.STRONG_STIFFNESS,
        twist_rigidity=problem.TWISTING_STIFFNESS,
    )
    dismech_newton.add_rod(builder, rod, proxies=False)
    dismech_newton.fix_segment(builder, edge=0)
    model = builder.finalize(device="cpu")
    # A row for each joint: two stretches, bending towards its first and second director, twist.
    stiffness = model.dismech.triplet_params.numpy()
    stiffness[:, 3] = problem.WEAK_STIFFNESS / edge
    model.dismech.triplet_params.assign(stiffness)
    model.dismech.edge_d1_q.assign(np.tile(problem.ALONG_WIDTH, (elements, 1)).astype(np.float32))
    spin = np.full(elements, problem.DENSITY * problem.POLAR * edge, dtype=np.float32)
    model.dismech.edge_inertia.assign(spin)
    mass = np.full(elements + 1, problem.DENSITY * problem.AREA * edge, dtype=np.float32)
    mass[[0, -1]] *= 0.5
    model.particle_mass.assign(mass)
    model.particle_inv_mass.assign(1.0 / mass)
    return model
