"""Rods that act over time: forced vibrations, and the work that a changing rest shape does.

References: the closed form of the forced bar; `CrossCheck`, energies and powers from recorded
positions and velocities with formulas of its own; the moment times the rate of the rest turn, over
the frames.
"""

import der
import numpy as np
import pytest
from actuated import bend, stretch
from scenes import END, START, straight

STEPPERS = pytest.mark.parametrize("info", der.steppers(), ids=lambda info: info.name)
DAMPING, SMALL = 1.0, 1e-4


def tip_by_hand(omega):
    """Amplitude of the tip over that of the natural curvature, complex.

    EI w'''' + c w_t + m w_tt = 0 with EI = m = L = 1 and w = W(s) exp(i omega t): W is a sum of
    exp(b s) with the four roots b of b^4 = omega^2 - i c omega; w = w' = 0 at the clamp, and the
    moment w'' - k and the shear force w''' vanish at the free end.
    """
    roots = (omega**2 - 1j * DAMPING * omega) ** 0.25 * np.array([1, 1j, -1, -1j])
    end = np.exp(roots)
    conditions = [np.ones(4), roots, roots**2 * end, roots**3 * end]
    weights = np.linalg.solve(np.array(conditions, dtype=complex), [0, 0, 1, 0])
    return weights @ end


def steady_tip(omega, edges, steps, integrator):
    """The same of the rod, by least squares over the last period."""
    period = 2 * np.pi / omega
    rounds = int(np.ceil(26.0 / period))  # the slowest motion has lost all but exp(-13)
    step = period / steps
    times = step * np.arange(rounds * steps + 1)
    table = {"times": times.tolist(), "values": (SMALL * np.sin(omega * times)).tolist()}
    scene = straight(edges, "clamped-free", 1e6)
    del scene["analysis"]
    scene |= {
        "actuation": [bend(table, 0.0, 1.0)],
        "loads": [{"damping": {"coefficient": DAMPING}}],
        "time": {"duration": times[-1], "step": step, "integrator": integrator},
        "output": {"every": step, "probes": {"y": {**END, "quantity": "y"}}},
    }
    result = der.run(scene)
    last = slice(-steps, None)
    t, y = np.asarray(result.times)[last], np.asarray(result.probes["y"])[last]
    waves = np.column_stack([np.sin(omega * t), np.cos(omega * t)])
    sine, cosine = np.linalg.lstsq(waves, y, rcond=None)[0] / SMALL
    return sine + 1j * cosine


#: Below, at and above the first frequency, 3.516, and near the second, 22.03.
@pytest.mark.parametrize("omega", [1.5, 3.5, 9.0, 21.5])
@pytest.mark.parametrize("integrator", ["implicit_midpoint", "generalized_alpha"])
def test_amplitude_of_a_rod_whose_natural_curvature_oscillates(fitted_order, omega, integrator):
    exact = tip_by_hand(omega)
    sizes = [2, 4, 8]
    found = [steady_tip(omega, 5 * size, 30 * size, integrator) for size in sizes]
    errors = np.abs(np.array(found) / exact - 1)
    assert fitted_order([1 / size for size in sizes], errors) > 1.9
    assert errors[-1] < 1e-2


# ---- the ledger

STIFFNESS = {"EA": 20.0, "EI": 0.05, "mass_per_length": 0.2}
POINTS = np.array([[0, 0], [0.3, 0.05], [0.6, 0], [0.9, 0.1]])
REST = np.linalg.norm(np.diff(POINTS, axis=0), axis=1)
LENGTH = REST.sum()
DURATION = 0.4
#: Natural curvature over a stretch, with a kink in time; elongation over another.
BENDING = {"times": [0, 0.1, DURATION], "values": [0, 2.0, -3.0]}
GROWING = {"times": [0, 0.25, DURATION], "values": [0, 0.2, 0.05]}
BENT, GROWN = (0.13, 0.71), (0.2, 0.55)
ACTUATION = [bend(BENDING, *BENT, profile="linear"), stretch(GROWING, *GROWN)]
STEPS = [1e-3, 5e-4, 2.5e-4]


def driven(integrator, step, **more):
    """A rod that hangs from its start."""
    rod = {"name": "rod", "points": POINTS.tolist()}
    scene = {
        "rods": [rod | {"cross_section": {"stiffness": STIFFNESS}}],
        "supports": [{**START, "fix": ["x", "y"]}],
        "loads": [{"damping": {"coefficient": 0.2}}],
        "actuation": ACTUATION,
        "time": {"duration": DURATION, "step": step, "integrator": integrator},
        "output": {"every": step},
    }
    return der.run(der.Scenario.from_dict(scene | more))


class CrossCheck:
    """Energies and works of `driven`, from positions and velocities alone."""

    def __init__(self, result):
        self.times, self.x, self.v = result.times, result.positions, result.velocities
        self.voronoi = 0.5 * (np.append(REST, 0) + np.append(0, REST))
        drawn = self.angles(np.diff(POINTS, axis=0)[:, None])
        bending = np.interp(self.times, BENDING["times"], BENDING["values"])
        growing = np.interp(self.times, GROWING["times"], GROWING["values"])
        self.rest_angles = drawn + self.turns()[:, None] * bending
        self.growth = self.lengths()[:, None] * growing
        edges = np.moveaxis(np.diff(self.x, axis=1), 1, 0)
        self.longer = np.sqrt(np.sum(edges**2, axis=-1)) - REST[:, None] - self.growth
        self.turned = self.angles(edges) - self.rest_angles
        self.tension = STIFFNESS["EA"] * self.longer / REST[:, None]
        self.moment = STIFFNESS["EI"] * self.turned / self.voronoi[1:-1, None]

    @staticmethod
    def angles(edges):
        a, b = edges[:-1], edges[1:]
        cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        return np.arctan2(cross, np.sum(a * b, axis=-1))

    @staticmethod
    def turns():
        """Rest angles of the inner nodes at an actuation of 1.

        An edge has the mean direction of the curve over it, so that the turn between two is the
        integral of the curvature with the hat function of the node between them.
        """
        nodes = np.append(0, np.cumsum(REST))
        borders = np.unique([*nodes, *BENT])
        s = np.linspace(borders[:-1], borders[1:], 201)
        hats = [np.interp(s, nodes, np.eye(len(nodes))[i]) for i in range(1, len(nodes) - 1)]
        inside = (s.mean(axis=0) > BENT[0]) & (s.mean(axis=0) < BENT[1])
        curvature = (s - BENT[0]) / (BENT[1] - BENT[0]) * inside
        simpson = np.tile([2.0, 4.0], 101)[:201]
        simpson[[0, -1]] = 1.0
        weights = simpson[:, None] * np.diff(borders) / 600
        return np.array([np.sum(weights * curvature * hat) for hat in hats])

    @staticmethod
    def lengths():
        """How much longer edges are without stress at an elongation of 1."""
        nodes = np.append(0, np.cumsum(REST))
        return np.diff(np.clip(nodes, *GROWN))

    def energy(self):
        mass = STIFFNESS["mass_per_length"] * self.voronoi
        twice = np.sum(mass[:, None] * self.v**2, axis=(1, 2))
        # Edges without a held node have the mass of a rigid bar.
        coupling = STIFFNESS["mass_per_length"] * REST[1:, None] / 6
        kinetic = twice - np.sum(coupling * np.diff(self.v[:, 1:], axis=1) ** 2, axis=(1, 2))
        elastic = np.sum(self.tension * self.longer, axis=0)
        return 0.5 * (kinetic + elastic + np.sum(self.moment * self.turned, axis=0))

    def work(self):
        """Work of the actuations: the forces of the rest shape over its way, by trapezoids."""

        def over(force, way):
            return np.sum(-0.5 * (force[:, 1:] + force[:, :-1]) * np.diff(way, axis=1), axis=0)

        steps = over(self.moment, self.rest_angles) + over(self.tension, self.growth)
        return np.append(0, np.cumsum(steps))


@STEPPERS
def test_the_ledger_of_an_actuated_rod_is_that_of_positions_and_velocities(fitted_order, info):
    runs = [driven(info.name, step) for step in STEPS]
    checks = [CrossCheck(run) for run in runs]
    mine = checks[0].energy()
    scale = np.ptp(mine)
    assert np.abs(sum(runs[0].energies.values()) - mine).max() < 1e-12 * scale
    for run, check in zip(runs, checks, strict=True):
        work = run.work
        assert not work["loads"].any()
        assert not work["supports"].any()
        assert np.abs(work["solver"]).max() < 1e-8 * scale
        energy = check.energy()
        gone = work["drag"] + work["numerical"]
        left = energy - energy[0] - (work["actuation"] + work["solver"] - gone)
        assert np.abs(left).max() < 1e-12 * scale
        # By trapezoids, too, so that not even the step makes a difference.
        assert np.abs(work["actuation"] - check.work()).max() < 1e-12 * scale
    check_losses(fitted_order, info, runs, scale)


def check_losses(fitted_order, info, runs, scale):
    """The loss of the time stepping vanishes with the step."""
    losses = [np.abs(run.work["numerical"]).max() for run in runs]
    if info.name == "energy_momentum":
        assert max(losses) < 1e-12 * scale
    else:
        assert fitted_order(STEPS, losses) > min(info.order, 2) - 0.1


def turning_clamp(info, step):
    """A clamp that turns and moves while curvature and length change, both beside the clamp."""
    scene = straight(8, "clamped-free", 20.0)
    del scene["analysis"]
    scene["rods"][0]["cross_section"] = {"stiffness": STIFFNESS}
    moved = {"times": [0, 0.15, DURATION], "values": [0, 0.4, -0.2]}
    scene["supports"] = [{**START, "clamp": True, "prescribe": {"angle": moved, "y": moved}}]
    scene["actuation"] = [
        bend(BENDING, 0.0, BENT[1], profile="smooth"),
        bend(GROWING, 0.03, 1.0, "other"),
        stretch(GROWING, 0.0, GROWN[1], profile="linear"),
    ]
    scene["loads"] = [{"damping": {"coefficient": 0.2}}]
    scene["time"] = {"duration": DURATION, "step": step, "integrator": info.name}
    scene["output"] = {"every": step}
    return der.run(scene)


@STEPPERS
def test_the_ledger_closes_where_a_clamp_turns_too(fitted_order, info):
    runs = [turning_clamp(info, step) for step in STEPS]
    for run in runs:
        total = sum(run.energies.values())
        scale = np.ptp(total)
        work = run.work
        came_in = work["supports"] + work["actuation"] + work["solver"] - work["drag"]
        left = total - total[0] - (came_in - work["numerical"])
        assert np.abs(left).max() < 1e-12 * scale
        assert np.abs(work["solver"]).max() < 1e-8 * scale
        assert np.abs(work["actuation"]).max() > 1e-3
        assert np.abs(work["supports"]).max() > 1e-3
        assert run.summary["work"]["actuation"] == work["actuation"][-1]
    if info.order > 1:
        check_losses(fitted_order, info, runs, scale)


def frames_of(edges, step):
    """A clamped rod, a part of which bends and another part of which grows, smoothly in time."""
    times = np.linspace(0.0, 1.0, 401)  # an entry for each step of the finest run
    ramp = {"times": times.tolist(), "values": (np.sin(np.pi * times / 2) ** 4).tolist()}

    def scaled(factor):
        return {"times": ramp["times"], "values": [factor * v for v in ramp["values"]]}

    scene = straight(edges, "clamped-free", 200.0)
    del scene["analysis"]
    return scene | {
        "actuation": [bend(scaled(2.0), 0.3, 0.7), stretch(scaled(0.1), 0.25, 0.9)],
        "loads": [
            {"damping": {"coefficient": 2.0}},
            {"point_force": {**END, "force": [20.0, 3.0]}},
        ],
        "time": {"duration": 1.0, "step": step, "integrator": "generalized_alpha"},
        "output": {"every": step},
    }, np.sin(np.pi * np.arange(0.0, 1.0 + step / 2, step) / 2) ** 4


def over_the_rod(places, values, start, end):
    """Integral from `start` to `end` of lines through samples that do not jump; of each frame."""
    s = np.unique([start, *places[(places > start) & (places < end)], end])
    lines = np.array([np.interp(s, places, frame) for frame in values])
    return np.trapezoid(lines, s, axis=1)


def test_work_is_the_moment_over_the_rest_turn(fitted_order):
    """And the tension over the growth: from samples along the rod at the frames alone.

    The mesh does not resolve waves along the rod: where the curvature jumps the tension, continued
    from both sides, has more of them than in the middles of edges."""
    sizes = [1, 2, 4]
    errors = []
    for size in sizes:
        scene, ramp = frames_of(20 * size, 0.01 / size)
        result = der.run(scene)
        moment = over_the_rod(*result.along("rod", "moment"), 0.3, 0.7)
        places, tensions = result.along("rod", "tension")
        smooth = [not np.isclose(s, (0.3, 0.7)).any() for s in places]
        tension = over_the_rod(places[smooth], tensions[:, smooth], 0.25, 0.9)
        power = -(2.0 * moment + 0.1 * tension)
        by_hand = np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(ramp))
        errors.append(result.work["actuation"][-1] / by_hand - 1)
    assert fitted_order([1 / size for size in sizes], errors) > 1.9
    assert abs(errors[-1]) < 1e-5


def test_adaptive_steps_see_the_kinks_of_actuations():
    """Frames between the steps have the ledger that small steps have."""
    more = {"output": {"every": 4e-4}}
    time = {"duration": DURATION, "tolerance": 1e-5}
    result = driven("", 1e-3, time=time, **more)
    time = {"duration": DURATION, "step": 1e-5, "integrator": "verlet"}
    fine = driven("", 1e-3, time=time, **more)
    assert result.summary["steps"] < 0.5 * len(result.times)
    scale = np.ptp(fine.work["actuation"])
    for name in ("actuation", "drag", "numerical"):
        assert np.abs(result.work[name] - fine.work[name]).max() < 5e-5 * scale, name


def test_stable_step_of_a_rod_that_becomes_shorter():
    """`step: auto`: its edges are shorter, and bend more stiffly, than those that are drawn."""
    scene = straight(20, "clamped-free", 1e3)
    del scene["analysis"]
    table = {"times": [0.0, 0.2], "values": [0.0, -0.6]}
    scene["actuation"] = [stretch(table, 0.0, 1.0)]
    scene["loads"] = [{"damping": {"coefficient": 20.0}}]
    scene["time"] = {"duration": 0.3, "step": "auto", "integrator": "verlet"}
    result = der.run(scene)
    assert result.status == "completed"
    assert not result.summary["warnings"]
    reference = scene["time"] | {"step": 1e-3, "integrator": "generalized_alpha"}
    fine = der.run(scene | {"time": reference})
    assert result.positions[-1, -1] == pytest.approx(fine.positions[-1, -1], abs=1e-4)
