"""The strip in MuJoCo: a chain of rigid links with springs at the joints.

MuJoCo's own rod, the 1D flex, has no twist. A link has three hinges: twist, and bending about the
width and about the thickness; ``stretch`` adds a sliding joint with the strip's axial stiffness.
Rotations about hinges in turn do not commute, which makes the chain an approximation of order 1
with an error of 0.04 m at 40 links. Two measures bring back order 2, and 2.4e-3 m: the order of the
two bends alternates from link to link, and the first twist, that of half a link outside the wall,
is twice as stiff.
"""

from __future__ import annotations

import math
from itertools import product

import mujoco

from comparison import run_mujoco
from comparison.scene import Config, Path
from comparison.strip import problem


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip.

    Keys besides ``elements`` and ``steps``: ``integrator`` and ``stretch``.
    """
    links = int(config["elements"])
    edge = _edge(links)
    return run_mujoco.run(_chain(config), config, tip_body=links, tip_offset=edge, dimension=3)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried, most at their largest stable step."""
    if quick:
        return [_config(20, "Euler", stretch) for stretch in (False, True)]
    integrators = ("Euler", "RK4", "implicitfast")
    return [
        *(
            _config(n, integrator, stretch)
            for n, integrator, stretch in product((10, 14, 20, 28, 40), integrators, (False, True))
        ),
        *(_config(n, "Euler", stretch) for n, stretch in product((50, 60, 65, 70), (False, True))),
        # Stable at large steps, which its damping forbids.
        *(
            _config(n, "discrete", False, steps)
            for n, steps in product((14, 20, 28, 40), (10, 20, 40, 80))
        ),
    ]


def _config(elements: int, integrator: str, stretch: bool, steps: int | str = "fewest") -> Config:
    return {"elements": elements, "integrator": integrator, "stretch": stretch, "steps": steps}


def _edge(links: int) -> float:
    """Return the length of a link [m]; half of another one sticks out of the wall."""
    return problem.LENGTH / (links + 0.5)


def _chain(config: Config) -> mujoco.MjModel:
    """Return the chain; x, y, z of a link are the tangent, the width and the thickness."""
    links = int(config["elements"])
    edge = _edge(links)
    mass = problem.DENSITY * problem.AREA * edge
    # The mass sits at the two ends of a link, as in other discrete rods.
    across = mass * edge**2 / 4.0
    inertia = f"{problem.DENSITY * problem.POLAR * edge!r} {across!r} {across!r}"
    weak = _joint("hinge", 1, problem.WEAK_STIFFNESS / edge)
    strong = _joint("hinge", 2, problem.STRONG_STIFFNESS / edge)
    twisting = problem.TWISTING_STIFFNESS / edge
    stretch = _joint("slide", 0, problem.AXIAL_STIFFNESS / edge)
    tilt = f'quat="{math.cos(0.5 * problem.TILT)!r} {math.sin(0.5 * problem.TILT)!r} 0 0"'
    bodies = []
    for link in range(links):
        bodies += [
            f'<body pos="{edge!r} 0 0">' if link else f'<body pos="{0.5 * edge!r} 0 0" {tilt}>',
            f'<inertial pos="{0.5 * edge!r} 0 0" mass="{mass!r}" diaginertia="{inertia}"/>',
            _joint("hinge", 0, twisting if link else 2.0 * twisting),
            weak + strong if link % 2 else strong + weak,
            stretch if config["stretch"] else "",
        ]
    return mujoco.MjModel.from_xml_string(
        f"<mujoco>{run_mujoco.option(config, problem.GRAVITY)}"
        f"<worldbody>{''.join(bodies)}{'</body>' * links}</worldbody></mujoco>"
    )


def _joint(kind: str, axis: int, stiffness: float) -> str:
    """Return a joint along or about one of the axes x, y, z (0, 1, 2)."""
    direction = " ".join("1" if k == axis else "0" for k in range(3))
    return f'<joint type="{kind}" axis="{direction}" stiffness="{stiffness!r}"/>'
