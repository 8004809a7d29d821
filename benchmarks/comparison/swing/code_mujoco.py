"""The swing in MuJoCo, in the two ways that it offers.

``links``: a chain of rigid links with springs at the joints, what MuJoCo's cable was before version
4 did away with it, here with hinges that leave out what does not happen in the plane. It is
inextensible; ``stretch`` adds sliding joints with the rod's axial stiffness.

``rod``: the 1D flex that has taken the cable's place, a discrete elastic rod in space, stretched by
the stiffness of its edges. Its inextensible form (edge constraints) is soft and damped: its error
is 0.17 m and more, and with it falls the ``discrete`` integrator, which knows no edge stiffness.
"""

from __future__ import annotations

from itertools import product

import mujoco

from comparison import run_mujoco
from comparison.scene import Config, Path
from comparison.swing import problem

GRAVITY = (*problem.GRAVITY, 0.0)
AXIAL = problem.YOUNGS_MODULUS * problem.AREA
BENDING = problem.YOUNGS_MODULUS * problem.SECOND_MOMENT


def run(config: Config) -> tuple[float, Path]:
    """Run one configuration; return CPU seconds of the time loop and the path of the tip.

    Keys besides ``elements`` and ``steps``: ``model`` and ``integrator``; for links also
    ``stretch``, and ``clamp``: the first link is held while it straddles the wall, or turns in the
    wall on a spring of the half cell there.
    """
    model, tip_body, tip_offset = links(config) if config["model"] == "links" else _rod(config)
    return run_mujoco.run(model, config, tip_body, tip_offset, dimension=2)


def grid(quick: bool) -> list[Config]:
    """Return the configurations that are tried, each at its largest stable step."""
    if quick:
        return [
            links_config(20, "Euler", "straddle", False),
            links_config(20, "Euler", "straddle", True),
            _rod_config(20, "Euler"),
        ]
    integrators = ("Euler", "RK4", "implicitfast", "discrete")
    return [
        *(
            links_config(n, integrator, clamp, False)
            for n, integrator, clamp in product(
                (10, 14, 20, 28, 40), integrators, ("straddle", "wall")
            )
        ),
        *(
            links_config(n, integrator, "straddle", True)
            for n, integrator in product((14, 20, 28, 40), integrators)
        ),
        *(links_config(n, "Euler", "straddle", True) for n in (48, 56, 64, 80, 160)),
        *(_rod_config(n, integrator) for n, integrator in product((20, 40, 60), ("Euler", "RK4"))),
        *(_rod_config(n, "Euler") for n in (80, 120, 140, 200)),
    ]


def links_config(elements: int, integrator: str, clamp: str, stretch: bool) -> Config:
    """Return the configuration of a chain of links, at its largest stable step."""
    return {
        "elements": elements,
        "model": "links",
        "integrator": integrator,
        "clamp": clamp,
        "stretch": stretch,
        "steps": "fewest",
    }


def _rod_config(elements: int, integrator: str) -> Config:
    return {"elements": elements, "model": "rod", "integrator": integrator, "steps": "fewest"}


def links(config: Config) -> tuple[mujoco.MjModel, int, float]:
    """Return a chain of links, its last body, and the distance of the tip from its origin [m]."""
    count = int(config["elements"])
    straddles = config["clamp"] == "straddle"
    edge = problem.LENGTH / (count + 0.5 if straddles else count)
    mass = problem.DENSITY * problem.AREA * edge
    # The mass sits at the two ends of a link, as in other discrete rods: more accurate here than
    # the inertia of a bar.
    inertia = f"{mass * edge**2 / 4.0!r}"
    slide = f'<joint type="slide" axis="1 0 0" stiffness="{AXIAL / edge!r}"/>'
    bodies = []
    for link in range(count):
        start = edge if link else (0.5 * edge if straddles else 0.0)
        stiffness = BENDING / (edge if link or straddles else 0.5 * edge)
        bodies.append(
            f'<body pos="{start!r} 0 0">'
            f'<inertial pos="{0.5 * edge!r} 0 0" mass="{mass!r}" '
            f'diaginertia="{inertia} {inertia} {inertia}"/>'
            f'<joint type="hinge" axis="0 0 1" stiffness="{stiffness!r}"/>'
            f"{slide if config['stretch'] else ''}"
        )
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco>{run_mujoco.option(config, GRAVITY)}"
        f"<worldbody>{''.join(bodies)}{'</body>' * count}</worldbody></mujoco>"
    )
    return model, count, edge


def _rod(config: Config) -> tuple[mujoco.MjModel, int, float]:
    """Return a 1D flex whose first edge straddles the wall, the body of its last vertex, and 0."""
    edges = int(config["elements"])
    edge = problem.LENGTH / (edges - 0.5)
    vertices = " ".join(f"{(i - 0.5) * edge!r} 0 0" for i in range(edges + 1))
    # All vertices get the same mass; the last one stands for half an edge only.
    mass = problem.DENSITY * problem.AREA * edge
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco>{run_mujoco.option(config, GRAVITY)}<worldbody>"
        f'<flexcomp name="rod" type="direct" dim="1" radius="{problem.RADIUS}" '
        f'mass="{mass * (edges + 1)!r}" point="{vertices}" '
        f'element="{" ".join(f"{i} {i + 1}" for i in range(edges))}">'
        f'<pin id="0 1"/><edge stiffness="{AXIAL / edge!r}"/>'
        f'<elasticity young="{problem.YOUNGS_MODULUS}"/></flexcomp></worldbody></mujoco>'
    )
    tip = model.body(f"rod_{edges}").id
    model.body_mass[tip] *= 0.5
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model, tip, 0.0
