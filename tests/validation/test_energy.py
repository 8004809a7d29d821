"""The energy ledger: what goes in, what goes out, and what the time stepping makes of it.

References: `CrossCheck` below, which integrates powers over recorded positions and velocities with
formulas of its own, independent of the steppers; exact works of constant forces.
"""

import copy

import der
import numpy as np
import pytest

SPEEDS = [0.2, 0.05]  # of the support before and after KINK [m/s]
KINK = 0.1
DRIVEN = {
    "title": "Driven rod",
    "rods": [
        {
            "name": "rod",
            "points": [[0, 0], [0.3, 0.05], [0.6, 0], [0.9, 0.1]],
            "cross_section": {"stiffness": {"EA": 20, "EI": 0.05, "mass_per_length": 0.2}},
            "spheres": [{"at": "all", "radius": 0.01, "density": 1000}],
        }
    ],
    "supports": [
        {
            "rod": "rod",
            "at": "start",
            "fix": ["x"],
            "prescribe": {"y": {"times": [0, KINK, 0.4], "values": [0, 0.02, 0.035]}},
        }
    ],
    "loads": [
        {"gravity": [0, -9.81]},
        {"damping": {"coefficient": 0.2}},
        {
            "point_force": {
                "rod": "rod",
                "at": "end",
                "force": {"times": [0, 1], "values": [[0, 0], [2, 4]]},
            }
        },
    ],
}
STEPPERS = pytest.mark.parametrize("info", der.steppers(), ids=lambda info: info.name)
SECOND_ORDER = pytest.mark.parametrize(
    "integrator", [info.name for info in der.steppers() if info.order == 2]
)
STEPS = [1e-3, 5e-4, 2.5e-4]


SWING = 5.0  # of gravity, where it swings [m/s^2]
SWING_RATE = 4 * np.pi  # [rad/s]


def driven(integrator, step, swing=0.0):
    time = {"duration": 0.4, "step": step, "integrator": integrator}
    scene = {**DRIVEN, "time": time, "output": {"every": step}}
    if swing:
        sine = {"amplitude": [0, -swing], "frequency": SWING_RATE / (2 * np.pi)}
        gravity = {"gravity": {"sine": {**sine, "offset": [0, -9.81]}}}
        scene["loads"] = [gravity, *DRIVEN["loads"][1:]]
    return der.run(der.Scenario.from_dict(scene))


class CrossCheck:
    """The energies and the ledger of DRIVEN, from positions and velocities alone."""

    def __init__(self, result, swing=0.0):
        self.times, self.x, self.v = result.times, result.positions, result.velocities
        self.gravity = 9.81 + swing * np.sin(SWING_RATE * self.times)
        self.gravity_rate = swing * SWING_RATE * np.cos(SWING_RATE * self.times)
        edges = np.diff(np.array(DRIVEN["rods"][0]["points"]), axis=0)
        self.rest = np.linalg.norm(edges, axis=1)
        self.voronoi = 0.5 * (np.append(self.rest, 0) + np.append(0, self.rest))
        self.rest_angles = self.angles(edges[:, None])[:, 0]
        self.mass = 0.2 * self.voronoi + 1000 * 4 / 3 * np.pi * 0.01**3
        energy = self.kinetic() + self.potential(self.x)
        works = {"loads": self.loads(), "drag": self.drag(), "supports": self.supports()}
        self.work = {name: np.append(0, np.cumsum(work)) for name, work in works.items()}
        came_in = self.work["loads"] + self.work["supports"] - self.work["drag"]
        self.work["numerical"] = came_in - (energy - energy[0])

    @staticmethod
    def angles(edges):
        """Turning angles, shape (2, times), of edges of shape (3, times, 2), complex or not."""
        a, b = edges[:-1], edges[1:]
        cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        return np.arctan(cross / np.sum(a * b, axis=-1))

    def kinetic(self):
        twice = np.sum(self.mass[:, None] * self.v**2, axis=(1, 2))
        # Edges without a held node have the mass of a rigid bar.
        coupling = 0.2 * self.rest[1:, None] / 6
        return 0.5 * (twice - np.sum(coupling * np.diff(self.v[:, 1:], axis=1) ** 2, axis=(1, 2)))

    def potential(self, x):
        edges = np.moveaxis(np.diff(x, axis=1), 1, 0)
        strain = np.sqrt(np.sum(edges**2, axis=-1)) / self.rest[:, None] - 1
        turned = self.angles(edges) - self.rest_angles[:, None]
        stretch = 0.5 * 20 * np.sum(strain**2 * self.rest[:, None], axis=0)
        bend = 0.5 * 0.05 * np.sum(turned**2 / self.voronoi[1:-1, None], axis=0)
        return stretch + bend + self.gravity * self.height(x)

    def height(self, x):
        """Mass times height [kg m]."""
        return np.sum(self.mass * x[..., 1], axis=1)

    def trapezoids(self, power):
        return 0.5 * np.diff(self.times) * (power[1:] + power[:-1])

    def loads(self):
        pull = np.column_stack([2 * self.times, 4 * self.times])
        power = np.sum(pull * self.v[:, -1], axis=1)
        return self.trapezoids(power + self.gravity_rate * self.height(self.x))

    def drag(self):
        free = 0.2 * np.sum(self.voronoi[1:, None] * self.v[:, 1:] ** 2, axis=(1, 2))
        return self.trapezoids(free) + self.held_drag()

    def held_drag(self):
        return 0.2 * self.voronoi[0] * self.speed() ** 2 * np.diff(self.times)

    def speed(self):
        return np.where(self.times[1:] < KINK + 1e-9, *SPEEDS)

    def supports(self):
        """Work of the supports on rod, drag and inertia, the gradient by a complex step."""
        moved = self.x.astype(complex)
        moved[:, 0, 1] += 1e-30j
        reaction = self.potential(moved).imag / 1e-30
        mean = 0.5 * (reaction[1:] + reaction[:-1])
        inertia = np.diff(0.5 * self.mass[0] * np.append(0, self.speed()) ** 2)
        return mean * self.speed() * np.diff(self.times) + self.held_drag() + inertia


@STEPPERS
def test_the_solver_leaves_little(info):
    result = driven(info.name, 1e-3)
    scale = max(np.ptp(values) for values in result.energies.values())
    assert np.abs(result.work["solver"]).max() < 1e-8 * scale


@STEPPERS
@pytest.mark.parametrize("swing", [0.0, SWING], ids=["weight", "swinging_gravity"])
def test_the_ledger_is_that_of_positions_and_velocities_alone(fitted_order, info, swing):
    """A work in the wrong account, and so a wrong loss, would not go away with the step."""
    runs = [driven(info.name, step, swing) for step in STEPS]
    checks = [CrossCheck(run, swing) for run in runs]
    total = sum(runs[0].energies.values())
    mine = checks[0].kinetic() + checks[0].potential(checks[0].x)
    assert np.abs(total - mine).max() < 1e-12 * np.ptp(mine)
    for name in ("loads", "drag", "supports", "numerical"):
        pairs = zip(runs, checks, strict=True)
        differences = [np.abs(run.work[name] - seen.work[name]).max() for run, seen in pairs]
        same = max(differences) < 1e-13 * np.ptp(mine)  # by trapezoids, too
        assert same or fitted_order(STEPS, differences) > min(info.order, 2) - 0.1, name


def is_nothing(losses, integrator):
    """Whether losses are the rounding that the energy-momentum method promises, of 0.1 J."""
    return integrator == "energy_momentum" and max(losses) < 1e-13


@SECOND_ORDER
def test_the_numerical_loss_vanishes_at_second_order(fitted_order, integrator):
    losses = [np.abs(driven(integrator, step).work["numerical"]).max() for step in STEPS]
    assert is_nothing(losses, integrator) or fitted_order(STEPS, losses) > 1.9


def constant_loads():
    """DRIVEN with nothing but constant forces, whose work is exact along any path."""
    scene = copy.deepcopy(DRIVEN)
    scene["supports"][0] = {"rod": "rod", "at": "start", "fix": ["x", "y"]}
    scene["loads"] = [scene["loads"][0], scene["loads"][2]]
    scene["loads"][1]["point_force"]["force"] = [0.5, 1]
    return scene


@STEPPERS
def test_the_numerical_loss_is_exact_where_all_forces_are_constant(info):
    time = {"duration": 0.4, "step": 1e-3, "integrator": info.name}
    result = der.run(der.Scenario.from_dict({**constant_loads(), "time": time}))
    check = CrossCheck(result)
    energy = check.kinetic() + check.potential(check.x)
    loads = (check.x[:, -1] - check.x[0, -1]) @ [0.5, 1]
    numerical = loads + result.work["solver"] - (energy - energy[0])
    assert np.abs(result.work["loads"] - loads).max() < 1e-12 * np.ptp(energy)
    assert np.abs(result.work["numerical"] - numerical).max() < 1e-12 * np.ptp(loads)


def test_the_midpoint_rule_keeps_a_quadratic_energy_exactly():
    """Axial waves in a straight cable: the energy is quadratic, so nothing is lost."""
    scene = {
        "title": "Axial waves",
        "rods": [
            {
                "name": "cable",
                "nodes": 21,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"stiffness": {"EA": 100, "EI": 0, "mass_per_length": 1}},
                "initial_velocity": [0.1, 0],
            }
        ],
        "supports": [{"rod": "cable", "at": "start", "fix": ["x", "y"]}],
        "time": {"duration": 2.0, "step": 0.01, "integrator": "implicit_midpoint"},
    }
    result = der.run(der.Scenario.from_dict(scene))
    total = sum(result.energies.values())
    assert np.abs(result.work["numerical"]).max() < 1e-9 * total[0]
    damped = der.run(der.Scenario.from_dict(scene).with_(**{"time.integrator": "implicit_euler"}))
    assert damped.work["numerical"][-1] > 0.5 * total[0]


@pytest.mark.parametrize(
    "info", [info for info in der.steppers() if info.order == 2], ids=lambda info: info.name
)
def test_only_a_stepper_without_damping_keeps_the_energy_for_good(info):
    """Eighty thousand steps of a gentle swing: the loss oscillates, and must not follow a line."""
    scene = {
        "title": "Gentle swing",
        "rods": [
            {
                "name": "arm",
                "nodes": 6,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"circle": {"radius": 0.02}},
                "material": {"youngs_modulus": 1e6, "density": 1000},
            }
        ],
        "supports": [{"rod": "arm", "at": "start", "clamp": True}],
        "loads": [{"gravity": [0, -0.3]}],
        "time": {"duration": 200, "step": 2.5e-3, "integrator": info.name},
        "output": {"every": 0.1},
    }
    result = der.run(der.Scenario.from_dict(scene))
    lost = result.work["numerical"]
    trend = np.polyfit(result.times, lost, 1)[0] * result.times[-1]
    bounded = abs(trend) < 0.02 * np.ptp(lost) or is_nothing(np.abs(lost), info.name)
    assert bounded == (info.damping == "none")


@pytest.mark.parametrize("moment", [0.05, {"times": [0, 1], "values": [0, 0.05]}])
@SECOND_ORDER
def test_a_clamp_that_turns_and_a_moment_do_work(fitted_order, integrator, moment):
    scene = {
        "title": "Turned",
        "rods": [
            {
                "name": "arm",
                "nodes": 11,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"stiffness": {"EA": 100, "EI": 0.1, "mass_per_length": 0.3}},
            }
        ],
        "supports": [
            {
                "rod": "arm",
                "at": "start",
                "clamp": True,
                "prescribe": {"angle": {"times": [0, 1], "values": [0, 1.0]}},
            }
        ],
        "loads": [{"moment": {"rod": "arm", "at": "end", "moment": moment}}],
    }
    losses = []
    for step in STEPS:
        time = {"duration": 1.0, "step": step, "integrator": integrator}
        result = der.run(der.Scenario.from_dict({**scene, "time": time}))
        losses.append(np.abs(result.work["numerical"]).max())
        assert result.work["supports"][-1] > 0.01
        assert abs(result.work["loads"][-1]) > 0.01
    assert is_nothing(losses, integrator) or fitted_order(STEPS, losses) > 1.9


@SECOND_ORDER
def test_a_moment_that_swings_loads_what_sdirk4_says(fitted_order, integrator):
    scene = {
        "title": "Swinging moment",
        "rods": [
            {
                "name": "arm",
                "nodes": 13,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"circle": {"radius": 0.02}},
                "material": {"youngs_modulus": 1e6, "density": 1000},
            }
        ],
        "supports": [{"rod": "arm", "at": "start", "clamp": True}],
        "loads": [
            {
                "moment": {
                    "rod": "arm",
                    "at": "end",
                    "moment": {
                        "times": [0, 0.1, 0.2, 0.3, 0.4],
                        "values": [0, 0.2, -0.2, 0.2, 0],
                    },
                }
            }
        ],
    }

    def loads(name, step):
        time = {"duration": 0.4, "step": step, "integrator": name}
        return der.run(der.Scenario.from_dict({**scene, "time": time})).work["loads"][-1]

    exact = loads("sdirk4", 2.5e-4)
    steps = [1e-3, 5e-4, 2.5e-4]
    errors = [abs(loads(integrator, step) - exact) for step in steps]
    assert fitted_order(steps, errors) > 1.9


def adaptively(scene, duration, tolerance, **output):
    time = {"duration": duration, "tolerance": tolerance}
    return der.run(der.Scenario.from_dict({**scene, "time": time, "output": output}))


def test_frames_between_adaptive_steps_have_the_exact_work_of_constant_forces():
    result = adaptively(constant_loads(), 0.4, tolerance=1e-2, every=1e-3)
    assert result.summary["steps"] < 0.25 * len(result.times)
    loads = (result.positions[:, -1] - result.positions[0, -1]) @ [0.5, 1]
    assert np.abs(result.work["loads"] - loads).max() < 1e-12 * np.ptp(loads)


MOVED = {
    "y": {"times": [0, 0.1, 0.2, 0.3], "values": [0, 0, 0.05, 0.05]},
    "angle": {"times": [0, 0.1, 0.2, 0.3], "values": [0, 0, 0.2, 0.2]},
}


@pytest.mark.parametrize("component", MOVED)
def test_frames_between_adaptive_steps_see_supports_that_stop_and_go(component):
    scene = {
        "title": "Moved clamp",
        "rods": [
            {
                "name": "arm",
                "nodes": 11,
                "from": [0, 0],
                "to": [1, 0],
                "cross_section": {"circle": {"radius": 0.02}},
                "material": {"youngs_modulus": 1e6, "density": 1000},
            }
        ],
        "supports": [
            {
                "rod": "arm",
                "at": "start",
                "clamp": True,
                "prescribe": {component: MOVED[component]},
            }
        ],
        "loads": [{"damping": {"coefficient": 2}}],
    }
    result = adaptively(scene, 0.3, tolerance=1e-4, every=4e-4)
    assert result.summary["steps"] < 0.25 * len(result.times)
    if component == "y":
        moves = (result.times > 0.1 + 1e-9) & (result.times < 0.2 + 1e-9)
        exact = np.where(moves, 0.5, 0.0)
        assert np.abs(result.velocities[:, 0, 1] - exact).max() < 1e-10
    time = {"duration": 0.3, "step": 1e-5, "integrator": "verlet"}
    fine = der.run(der.Scenario.from_dict({**scene, "time": time, "output": {"every": 4e-4}}))
    scale = np.ptp(fine.work["supports"])
    for name in ("supports", "drag", "numerical"):
        assert np.abs(result.work[name] - fine.work[name]).max() < 4e-4 * scale, name


def test_a_new_start_from_an_equilibrium_starts_a_new_ledger():
    time = {"duration": 0.1, "step": 1e-3}
    simulation = der.Simulation(der.Scenario.from_dict({**DRIVEN, "time": time}))
    simulation.equilibrium()
    result = simulation.run()
    assert result.work["numerical"][0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("place", [0.01, 0.03, 0.06])
@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_moments_beside_a_clamp_that_turns_do_their_own_work(model, place):
    """A constant moment works by what the tangent turns at its place, however much of that the
    clamp turns: places within half of the first edge, in it and in the next one."""
    size = 2 if model == "planar" else 3
    moment = 0.8
    turn = {"times": [0.0, 0.5, 1.0], "values": [0.0, 0.4, 0.6]}
    planar = {"EA": 1e3, "EI": 1.0, "mass_per_length": 1.0}
    spatial = {"EA": 1e3, "EI1": 1.0, "EI2": 1.0, "GJ": 0.7, "rotary_inertia": 1e-4}
    spatial["mass_per_length"] = 1.0
    rotation = {"rotation": {"axis": [0, 0, 1], "angle": turn}}
    scene = {
        "model": model,
        "rods": [
            {
                "name": "rod",
                "nodes": 21,
                "from": [0.0] * size,
                "to": [1.0, *[0.0] * (size - 1)],
                "cross_section": {"stiffness": planar if model == "planar" else spatial},
            }
        ],
        "supports": [
            {
                "rod": "rod",
                "at": "start",
                "clamp": True,
                "prescribe": {"angle": turn} if model == "planar" else rotation,
            }
        ],
        "loads": [
            {
                "moment": {
                    "rod": "rod",
                    "at": place,
                    "moment": moment if model == "planar" else [0.0, 0.0, moment],
                }
            }
        ],
        "time": {"duration": 1.0, "step": 0.001, "integrator": "generalized_alpha"},
        "output": {
            "every": 0.5,
            "probes": {
                name: {"rod": "rod", "quantity": name, "at": place} for name in ("tx", "ty")
            },
        },
    }
    result = der.run(der.Scenario.from_dict(scene))
    angle = np.arctan2(result.probes["ty"], result.probes["tx"])
    assert angle[-1] - angle[0] > 0.6
    done = moment * (angle[-1] - angle[0])
    assert result.work["loads"][-1] == pytest.approx(done, rel=1e-4)
