"""Internal damping: the Kelvin-Voigt law for bending, twisting and stretching.

References: closed forms. A linear mode of frequency w has the equation
q'' + t w^2 q' + w^2 q = 0, so that it decays by exp(-t w^2 s/2) in a time s (Clough and Penzien,
Dynamics of Structures, ch. 2); massless rods obey M = EI (kappa + t kappa').
"""

from __future__ import annotations

from typing import Any

import der
import numpy as np
import pytest

Scene = dict[str, Any]

STEPPERS = pytest.mark.parametrize("info", der.steppers(), ids=lambda info: info.name)


def scene(nodes: int, section: Scene, *, dimension: int = 2, **more: Any) -> Scene:
    """A rod of length 1 along x, clamped at its start."""
    rod = {
        "name": "rod",
        "nodes": nodes,
        "from": [0.0] * dimension,
        "to": [1.0] + [0.0] * (dimension - 1),
        "cross_section": {"stiffness": section},
        **more.pop("rod", {}),
    }
    clamp = {"rod": "rod", "at": "start", "clamp": True}
    return {"rods": [rod], "supports": [clamp], **more}


def run(scene: Scene) -> der.Result:
    return der.run(der.Scenario.from_dict(scene))


def damped_mode(times, frequency, damping, start=0.0, speed=0.0):
    """A mode of frequency w with the damping ratio t w/2 < 1."""
    rate = 0.5 * damping * frequency**2
    ringing = np.sqrt(frequency**2 - rate**2)
    sine = (speed + rate * start) / ringing * np.sin(ringing * times)
    return np.exp(-rate * times) * (start * np.cos(ringing * times) + sine)


def along(mode, nodes, direction):
    """Velocities of the nodes in a mode of the rod."""
    s = np.linspace(0, 1, nodes)
    return [(mode(place) * np.asarray(direction, float)).tolist() for place in s]


def bending_mode(s):
    """The first mode of a cantilever, 1 at its end."""
    k, share = 1.8751040687119611, 0.7340955137589128

    def shape(s):
        return np.cosh(k * s) - np.cos(k * s) - share * (np.sinh(k * s) - np.sin(k * s))

    return shape(s) / shape(1.0)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_bending_vibration_decays(model):
    damping, speed = 0.02, 1e-3
    dimension = 2 if model == "planar" else 3
    direction = [0, 1] if model == "planar" else [0, 0.6, 0.8]
    section = {"EA": 1e5, "EI": 1.0, "mass_per_length": 1.0, "damping": {"bending": damping}}
    if model == "spatial":
        section |= {"GJ": 1.0, "rotary_inertia": 1e-3}
    nodes = 31
    velocity = along(lambda s: speed * bending_mode(s), nodes, direction)
    result = run(
        scene(
            nodes,
            section,
            dimension=dimension,
            model=model,
            rod={"initial_velocity": velocity},
            time={"duration": 6.0, "step": 5e-3, "integrator": "implicit_midpoint"},
            output={"every": 0.02},
        )
    )
    tip = result.positions[:, -1] @ direction
    exact = damped_mode(result.times, 1.8751040687119611**2, damping, speed=speed)
    assert np.abs(tip - exact).max() < 2e-3 * np.abs(exact).max()
    undamped = damped_mode(result.times, 1.8751040687119611**2, 0.0, speed=speed)
    assert np.abs(undamped - exact).max() > 0.5 * np.abs(exact).max()


@pytest.mark.parametrize("model", ["planar", "spatial_bend", "spatial"])
def test_longitudinal_vibration_decays(model):
    damping, speed = 0.05, 1e-3
    dimension = 2 if model == "planar" else 3
    section = {"EA": 4.0, "EI": 1.0, "mass_per_length": 1.0, "damping": {"stretching": damping}}
    if model == "spatial":
        section |= {"GJ": 1.0, "rotary_inertia": 1e-3}
    nodes = 31
    velocity = along(lambda s: speed * np.sin(0.5 * np.pi * s), nodes, [1, 0, 0][:dimension])
    tension = {"quantity": "tension", "rod": "rod", "at": "start"}
    reaction = {"quantity": "reaction_x", "support": 0}
    result = run(
        scene(
            nodes,
            section,
            dimension=dimension,
            model=model,
            rod={"initial_velocity": velocity},
            time={"duration": 5.0, "step": 5e-3, "integrator": "implicit_midpoint"},
            output={"every": 0.02, "probes": {"tension": tension, "reaction": reaction}},
        )
    )
    frequency = 2 * 0.5 * np.pi
    tip = result.positions[:, -1, 0] - 1
    exact = damped_mode(result.times, frequency, damping, speed=speed)
    assert np.abs(tip - exact).max() < 2e-3 * np.abs(exact).max()
    # The section's force is that of the strain and of its rate.
    rate = np.gradient(exact, result.times, edge_order=2)
    force = 4.0 * 0.5 * np.pi * (exact + damping * rate)
    scale = np.abs(force).max()
    assert np.abs(result.probes["tension"] - force)[5:-1].max() < 1e-2 * scale
    assert np.abs(result.probes["reaction"] + force)[5:-1].max() < 1e-2 * scale
    assert damping * np.abs(rate).max() > 0.1 * np.abs(exact).max()


def test_torsional_vibration_decays():
    """Of a rod that is let go with an even twist in it, after the higher modes are gone."""
    damping, twist, inertia = 0.1, 0.1, 0.5
    section = {"EA": 1e4, "EI": 1.0, "GJ": 2.0, "mass_per_length": 1.0}
    section |= {"rotary_inertia": inertia, "damping": {"twisting": damping}}
    probes = {
        "torque": {"quantity": "torque", "rod": "rod", "at": "start"},
        "twist": {"quantity": "twist", "rod": "rod", "at": "start"},
        "reaction": {"quantity": "reaction_moment_x", "support": 0},
    }
    result = run(
        scene(
            41,
            section,
            dimension=3,
            rod={"initial_twist": twist, "natural_twist": 0.0},
            time={"duration": 4.0, "step": 5e-3, "integrator": "implicit_midpoint"},
            output={"every": 0.02, "probes": probes},
        )
    )
    wave = 0.5 * np.pi
    frequency = wave * np.sqrt(2.0 / inertia)
    start = twist * 2 / wave  # of the twist at the clamp in the first mode
    exact = damped_mode(result.times, frequency, damping, start=start)
    late = result.times > 1.0
    scale = np.abs(exact[late]).max()
    assert np.abs(result.probes["twist"] - exact)[late].max() < 5e-3 * scale
    torque = 2.0 * (exact + damping * np.gradient(exact, result.times, edge_order=2))
    assert (
        np.abs(result.probes["torque"] - torque)[late][:-1].max()
        < 1e-2 * np.abs(torque[late]).max()
    )
    assert (
        np.abs(result.probes["reaction"] + torque)[late][:-1].max()
        < 1e-2 * np.abs(torque[late]).max()
    )


SPIN = """
title: A torque at the end of a clamped rod
rods:
  - name: b
    nodes: 21
    from: [0, 0, 0]
    to: [1, 0, 0]
    cross_section: {circle: {radius: 0.02}}
    material: {youngs_modulus: 1e5, poissons_ratio: 0.45, density: 1000, damping: {twisting: 0.1}}
supports:
  - {rod: b, at: start, clamp: true}
loads:
  - moment: {rod: b, at: end, moment: [0.001, 0, 0]}
  - damping: {coefficient: 1e3}
time: {duration: 40, step: 0.01, integrator: implicit_midpoint}
output:
  every: 0.1
  probes:
    torque: {quantity: torque, rod: b, at: start}
"""


def test_a_twisted_rod_comes_to_rest():
    """Drag acts on nodes alone, which a torque about a straight rod does not move."""
    result = der.run(der.Scenario.parse(SPIN))
    assert abs(result.probes["torque"][-1] - 1e-3) < 1e-9
    assert result.energies["kinetic"][-1] < 1e-12 * result.energies["kinetic"].max()


def rolled(model, curvature, step=0.02, integrator="sdirk4"):
    """A rod without noticeable inertia that a moment at its end rolls into a circle."""
    dimension = 2 if model == "planar" else 3
    section = {"EA": 1e4, "EI": 1.0, "mass_per_length": 1e-7, "damping": {"bending": 0.5}}
    if model == "spatial":
        section |= {"GJ": 1.0, "rotary_inertia": 1e-7}
    moment = np.pi if model == "planar" else [0, 0, np.pi]
    kappa, m = ("curvature", "moment") if model == "planar" else ("curvature_2", "moment_2")
    place = {"rod": "rod", "at": 0.35}
    probes = {
        "curvature": {"quantity": kappa, **place},
        "moment": {"quantity": m, **place},
        "reaction": {
            "quantity": "reaction_moment" if model == "planar" else "reaction_moment_z",
            "support": 0,
        },
    }
    return run(
        scene(
            21,
            section,
            dimension=dimension,
            model=model,
            rod={"curvature": curvature},
            loads=[{"moment": {"rod": "rod", "at": "end", "moment": moment}}],
            time={"duration": 2.0, "step": step, "integrator": integrator},
            output={"every": 0.1, "probes": probes},
        )
    )


@pytest.mark.parametrize("curvature", ["angle", "tangent"])
@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_rod_rolls_up_at_the_rate_of_its_damping(model, curvature):
    """Massless, kappa = M/EI (1 - exp(-s/t)), and the moment is M throughout."""
    result = rolled(model, curvature)
    exact = np.pi * (1 - np.exp(-result.times / 0.5))
    sign = 1 if model == "planar" else np.sign(result.probes["curvature"][-1])
    bound = 2e-3 if curvature == "angle" else 1e-2
    late = result.times > 0.05
    assert np.abs(sign * result.probes["curvature"] - exact).max() < bound * np.pi
    assert np.abs(sign * result.probes["moment"] - np.pi)[late].max() < bound * np.pi
    assert np.abs(result.probes["reaction"] + np.pi)[late].max() < bound * np.pi


def turning_clamp(model, integrator, step):
    """A damped rod that a clamp turns, with drag on nothing else."""
    dimension = 2 if model == "planar" else 3
    section = {"EA": 30.0, "EI": 1.0, "mass_per_length": 1.0, "damping": 0.05}
    if model == "spatial":
        section |= {"GJ": 0.8, "rotary_inertia": 0.05}
    turn = {"sine": {"amplitude": 0.4, "frequency": 0.5, "phase": -0.5 * np.pi, "offset": 0.4}}
    start = {"rod": "rod", "at": "start", "clamp": True}
    if model == "planar":
        start["prescribe"] = {"angle": turn}
    else:
        start["prescribe"] = {"rotation": {"axis": [0, 0.6, 0.8], "angle": turn}}
    loads = [{"gravity": [0, -3.0] if model == "planar" else [0, -2.0, 1.0]}]
    base = scene(
        9,
        section,
        dimension=dimension,
        model=model,
        loads=loads,
        start_from="equilibrium",
        time={"duration": 0.4, "step": step, "integrator": integrator},
        output={"every": 0.04},
    )
    base["supports"] = [start]
    return base


def models_of(info):
    return ["planar"] if info.name == "energy_momentum" else ["planar", "spatial"]


@STEPPERS
def test_order_in_time_with_strong_damping(fitted_order, info):
    """Bending, twisting and stretching are damped while a clamp turns."""
    for model in models_of(info):
        steps = [0.02, 0.01, 0.005] if info.implicit else [1.6e-4, 8e-5, 4e-5]
        exact = run(turning_clamp(model, "sdirk5", 2e-3)).positions
        errors = [
            np.abs(run(turning_clamp(model, info.name, step)).positions - exact).max()
            for step in steps
        ]
        expected = 0.9 if info.order == 1 else 1.85
        assert max(errors) < 1e-9 or fitted_order(steps, errors) > expected, (model, errors)


@STEPPERS
def test_the_ledger_closes(fitted_order, info):
    """What damping takes is in the account of drag; the rest vanishes with the step."""
    for model in models_of(info):
        steps = [0.01, 0.005, 0.0025] if info.implicit else [1.6e-4, 8e-5, 4e-5]
        runs = [run(turning_clamp(model, info.name, step)) for step in steps]
        taken = runs[-1].work["drag"]
        assert np.all(np.diff(taken) >= 0)
        assert taken[-1] > 0.02 * np.ptp(runs[-1].work["supports"])
        losses = [np.abs(each.work["numerical"]).max() for each in runs]
        expected = 0.9 if info.order == 1 else 1.85
        small = max(losses) < 1e-10 * taken[-1]
        assert small or fitted_order(steps, losses) > expected, (model, losses)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_supports_do_the_work_that_is_measured(model):
    """The work of the turning clamp is that of its recorded reaction moment."""
    base = turning_clamp(model, "implicit_midpoint", 1e-3)
    names = (
        {"m": "reaction_moment"}
        if model == "planar"
        else {f"m{c}": f"reaction_moment_{c}" for c in "xyz"}
    )
    base["output"] = {
        "every": 1e-3,
        "probes": {k: {"quantity": q, "support": 0} for k, q in names.items()},
    }
    result = run(base)
    axis = [1.0] if model == "planar" else [0, 0.6, 0.8]
    moment = sum(a * result.probes[k] for a, k in zip(axis, names, strict=True))
    rate = 0.4 * np.pi * np.sin(np.pi * result.times)
    power = moment * rate
    work = np.append(0, np.cumsum(0.5 * np.diff(result.times) * (power[1:] + power[:-1])))
    assert np.abs(work - result.work["supports"]).max() < 2e-3 * np.ptp(work)


@pytest.mark.parametrize(
    ("case", "integrator"),
    [
        ("planar", "implicit_midpoint"),
        ("planar", "energy_momentum"),
        ("spatial", "implicit_midpoint"),
        ("ring", "implicit_midpoint"),
    ],
)
def test_a_rigid_rotation_loses_nothing(case, integrator):
    """Arc and ring are stress-free as drawn. Their stretch by centrifugal forces is small, and at
    rest in the rod's own axes. Positions and velocities in the middle of such a step are those of a
    rigid motion; in stages of other steppers they are so to the error of the step."""
    n = 24
    angle = 2 * np.pi * np.arange(n) / n
    spin = 0.2
    if case == "ring":
        points = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    else:
        points = np.column_stack([np.cos(angle[:13]), np.sin(angle[:13]), 0 * angle[:13]])
    weights = np.ones(len(points))
    if case != "ring":
        weights[[0, -1]] = 0.5
    points -= np.average(points, axis=0, weights=weights)
    velocity = spin * np.cross([0, 0, 1.0], points)
    if case == "planar":
        points, velocity = points[:, :2], velocity[:, :2]
    section = {"EA": 1e4, "EI": 10.0, "mass_per_length": 1.0, "damping": 0.05}
    if case != "planar":
        section |= {"GJ": 10.0, "rotary_inertia": 0.01}
    rod = {
        "name": "rod",
        "points": points.tolist(),
        "closed": case == "ring",
        "initial_velocity": velocity.tolist(),
        "cross_section": {"stiffness": section},
    }
    result = run(
        {
            "rods": [rod],
            "model": "planar" if case == "planar" else "spatial",
            "time": {"duration": 20.0, "step": 0.05, "integrator": integrator},
            "output": {"every": 1.0},
        }
    )
    kinetic = result.energies["kinetic"]
    # The start sets off a vibration, which damping ends within the first half of 4 rad.
    drag, half = result.work["drag"], len(kinetic) // 2
    assert drag[-1] < 2e-3 * kinetic[0]
    assert drag[-1] - drag[half] < 1e-8 * kinetic[0]
    assert abs(kinetic[-1] / kinetic[half] - 1) < 1e-6
    x, v = result.positions, result.velocities
    speed = np.linalg.norm(v[-1], axis=1)
    radius = np.linalg.norm(x[-1] - np.average(x[-1], axis=0, weights=weights), axis=1)
    assert np.abs(speed / radius - spin).max() < 2e-3


def test_damping_that_is_not_there_changes_no_bit():
    zero = {"damping": {"bending": 0.0}}
    runs = []
    for more in ({}, zero):
        base = turning_clamp("planar", "implicit_midpoint", 0.01)
        section = base["rods"][0]["cross_section"]["stiffness"]
        del section["damping"]
        section |= more
        runs.append(run(base))
    assert np.array_equal(runs[0].positions, runs[1].positions)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_members_and_restored_states_have_the_same_bits(model):
    base = turning_clamp(model, "implicit_midpoint", 0.01)
    path = "rods.rod.cross_section.stiffness.damping"
    times = [0.02, 0.05, 0.1, 0.2]
    batch = der.Batch(base, 4, 2, vary={path: times})
    batch.step(20)
    for member, time in enumerate(times):
        own = der.Scenario.from_dict(base).with_(**{path: time})
        alone = der.Simulation(own)
        alone.step(8)
        saved = alone.save_state()
        alone.step(12)
        assert np.array_equal(batch.positions[member], alone.positions)
        again = der.Simulation(own)
        again.restore_state(saved)
        again.step(12)
        assert np.array_equal(again.positions, alone.positions)
    tips = batch.positions[:, -1]
    assert np.linalg.norm(np.diff(tips, axis=0), axis=1).min() > 1e-4


def test_statics_are_without_it():
    base = turning_clamp("planar", "implicit_midpoint", 0.01)
    for key in ("time", "output", "start_from"):
        del base[key]
    del base["supports"][0]["prescribe"]
    base["analysis"] = "static"
    damped = run(base).positions
    del base["rods"][0]["cross_section"]["stiffness"]["damping"]
    assert np.array_equal(damped, run(base).positions)


SHAKEN = {"EA": 4000, "EI": 1, "mass_per_length": 1, "damping": {"bending": 0.08}}
SCHEMES = [
    "implicit_midpoint",
    "tr_bdf2",
    "bdf2",
    "sdirk4",
    "sdirk5",
    "generalized_alpha",
    "energy_momentum",
]


@pytest.mark.parametrize("nodes", [21, 41])
@pytest.mark.parametrize("integrator", SCHEMES)
def test_reaction_of_a_shaken_clamp(integrator: str, nodes: int) -> None:
    """The reaction of a clamp that shakes a damped cantilever, by the closed form of
    EI (1 + i w t) d4y/ds4 = m w^2 y. It was the larger the finer the mesh, as a difference of two
    velocities of which one was exact."""
    frequency, periods = 0.7, 6
    w = 2 * np.pi * frequency
    stiffness = 1 + 1j * w * 0.08
    k = (w**2 / stiffness) ** 0.25 * np.array([1, 1j, -1, -1j])
    # y = sum c exp(k s): y and its slope at the clamp, moment and shear force at the end
    system = np.array([k**0, k, k**2 * np.exp(k), k**3 * np.exp(k)])
    c = np.linalg.solve(system, [0.01, 0, 0, 0])
    expected = abs(stiffness * (c @ k**3))
    sine = {"amplitude": 0.01, "frequency": frequency, "phase": -np.pi / 2, "offset": 0.01}
    rod = {"name": "rod", "nodes": nodes, "from": [0, 0], "to": [1, 0]}
    result = der.run(
        {
            "rods": [{**rod, "cross_section": {"stiffness": SHAKEN}}],
            "supports": [
                {"rod": "rod", "at": "start", "clamp": True, "prescribe": {"y": {"sine": sine}}}
            ],
            "time": {
                "duration": periods / frequency,
                "step": 1 / (160 * frequency),
                "integrator": integrator,
            },
            "output": {"probes": {"reaction": {"support": 0, "quantity": "reaction_y"}}},
        }
    )
    last = np.asarray(result.probes["reaction"])[-160:]
    amplitude = 0.5 * (last.max() - last.min())
    assert amplitude == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(("integrator", "warns"), [("tr_bdf2", True), ("sdirk4", False)])
def test_a_clamp_that_rotates_a_damped_rod_is_warned_of(integrator: str, warns: bool) -> None:
    turned = {"times": [0, 0.1], "values": [0, 0.1], "smooth": True}
    rod = {"name": "rod", "nodes": 9, "from": [0, 0], "to": [1, 0]}
    scene = der.Scenario.from_dict(
        {
            "rods": [{**rod, "cross_section": {"stiffness": SHAKEN}}],
            "supports": [
                {"rod": "rod", "at": "start", "clamp": True, "prescribe": {"angle": turned}}
            ],
            "time": {"duration": 0.1, "step": 0.01, "integrator": integrator},
        }
    )
    assert any("rotates rod 'rod', which has internal" in text for text in scene.warnings) == warns
