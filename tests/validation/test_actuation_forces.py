"""Forces of actuations: moments, torques and forces that are conjugate to what they change.

References: closed forms of beams that are held at both ends; the change of the elastic energy along
a path of equilibria; the `actuation` line of the ledger, by trapezoids over the probes.
"""

import der
import numpy as np
import pytest
from actuated import PROFILES, bend, stretch
from scenes import END, START, straight
from scipy.integrate import cumulative_simpson, quad
from spatial_scenes import section, straight_rod

EI, EA = 1.0, 2e3  # of `straight`
BEAM = section([0, 1, 0], EA=1e5, EI1=3.0, EI2=1.3, GJ=0.8)
HELD = [{**START, "clamp": True}, {**END, "clamp": True}]
PINNED = [{**START, "fix": ["x", "y"]}, {**END, "fix": ["x", "y"]}]


def twist(value, start, end, name="twist", **more):
    actuation = {"name": name, "rod": "rod", "from": start, "to": end, "natural_twist": value}
    return actuation | more


def solved(scene, *actuations):
    """Return what the actuations exert in equilibrium, one after the other."""
    scene = scene | {"actuation": list(actuations), "analysis": "static"}
    return [each.force[-1] for each in der.run(scene).actuation_forces()]


# ---- closed forms


SIZES = [10, 20, 40]


def test_curvature_between_two_clamps_has_the_moment_that_would_bend_the_rod_so(fitted_order):
    """-EI k everywhere, of order 2: the cells beside clamps are shorter than half an edge."""
    errors = []
    for n in SIZES:
        (moment,) = solved(straight(n, "clamped-clamped"), bend(0.7, 0.0, 1.0))
        errors.append(moment / (0.7 * EI) - 1)
    assert fitted_order(SIZES, errors) < -1.9
    assert abs(errors[-1]) < 2e-4


def test_curvatures_and_twist_between_two_clamps_in_space(fitted_order):
    """-EI k likewise, towards each director; the torque is the same everywhere."""
    curved, twisted = bend([0.7, -0.4], 0.0, 1.0), twist(0.5, 0.2, 0.7)
    errors = []
    for n in SIZES:
        (moments,) = solved(straight_rod(n, BEAM, supports=HELD), curved)
        errors.append(np.abs(moments / [0.7 * 3.0, -0.4 * 1.3] - 1).max())
        (torque,) = solved(straight_rod(n, BEAM, supports=HELD), twisted)
        assert torque == pytest.approx(0.8 * 0.5 * 0.5, rel=1e-9)
    assert fitted_order(SIZES, errors) < -1.9
    assert errors[-1] < 2e-4


@pytest.mark.parametrize("profile", PROFILES)
def test_elongation_between_two_pins_pushes_with_a_force_that_is_the_same_everywhere(profile):
    shape = PROFILES[profile]
    mean = 0.4 * quad(shape, 0, 1)[0]
    longer = stretch(1e-3, 0.23, 0.63, profile=profile)
    (force,) = solved(straight(10, "free-free", EA=EA, supports=PINNED), longer)
    assert force == pytest.approx(EA * 1e-3 * mean, rel=1e-9)


@pytest.mark.parametrize("edges", [7, 10])
@pytest.mark.parametrize("profile", PROFILES)
def test_a_part_that_bends_between_two_clamps(profile, edges):
    """w'' = k p + M/EI with a moment M that is linear along the rod: -M/EI is the projection of k p
    on lines, as slope and deflection vanish at both ends. Small deflections are exact."""
    start, end, k = 0.23, 0.63, 1e-4

    def integral(f):
        inside = quad(lambda u: f(start + u * (end - start)) * PROFILES[profile](u), 0, 1)
        return (end - start) * inside[0]

    length = integral(lambda s: 1.0)
    slope = 12 * integral(lambda s: s - 0.5)
    exact = k * EI * integral(lambda s: length + slope * (s - 0.5)) / length
    scene = straight(edges, "clamped-clamped", EA=EA)
    assert solved(scene, bend(k, start, end, profile=profile)) == pytest.approx([exact], rel=1e-7)


def test_free_rods_resist_no_actuation():
    flat = solved(straight(10, "clamped-free"), bend(2.0, 0.3, 0.7), stretch(0.1, 0.2, 0.9))
    assert flat == pytest.approx([0, 0], abs=1e-8)
    parts = [bend([2.0, 1.0], 0.3, 0.7), twist(3.0, 0.1, 0.8), stretch(0.1, 0.2, 0.9)]
    curvatures, *others = solved(straight_rod(10, BEAM), *parts)
    assert [*curvatures, *others] == pytest.approx([0] * 4, abs=1e-6)


# ---- work


def test_energy_along_a_path_is_the_integral_of_the_moment():
    """No load does work: an arch that a growing natural curvature bends far between two pins."""
    scene = straight(16, "free-free", EA=EA) | {
        "supports": PINNED,
        "actuation": [bend(6.0, 0.1, 0.75, profile="smooth"), stretch(0.05, 0.0, 1.0)],
        "output": {
            "probes": {
                "moment": {"actuation": "bend", "quantity": "actuation_moment"},
                "force": {"actuation": "stretch", "quantity": "actuation_force"},
                "energy": {"quantity": "elastic_energy"},
            }
        },
    }
    path = {"continuation": {"vary": "actuation", "step": 0.01, "to": 1.0}}
    result = der.run(scene | {"analysis": path})
    factor = result.path.factor
    power = 6.0 * 0.325 * result.probes["moment"] + 0.05 * result.probes["force"]
    work = cumulative_simpson(power, x=factor, initial=0.0)
    energy = result.probes["energy"] - result.probes["energy"][0]
    assert np.abs(work - energy).max() < 1e-5 * np.ptp(energy)
    forces = result.actuation_forces()
    assert [each.name for each in forces] == ["bend", "stretch"]
    assert [each.length for each in forces] == pytest.approx([0.325, 1.0])
    np.testing.assert_allclose(forces[0].force, result.probes["moment"], rtol=1e-9, atol=1e-9)


def work_by_trapezoids(result, values):
    """Return the sum over actuations; `values` are theirs over time, shape (frames, values)."""
    work = 0.0
    for each, value in zip(result.actuation_forces(), values, strict=True):
        force, value = np.reshape(each.force, (len(value), -1)), np.reshape(value, (len(value), -1))
        work += each.length * np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(value, axis=0))
    return work


STEP, DURATION = 2e-3, 0.4


def over_time(factor):
    """Return a table with an entry for each step, and its values."""
    times = np.arange(round(DURATION / STEP) + 1) * STEP
    values = factor * np.sin(2.0 * times) ** 2
    return {"times": times.tolist(), "values": values.tolist()}, values


def recorded(scene, actuations, **more):
    scene = scene | {"actuation": actuations} | more
    del scene["analysis"]
    time = {"duration": DURATION, "step": STEP}
    return der.run(scene | {"time": time, "output": {"every": STEP}})


# The energy is of second degree in what actuations change, so that trapezoids over the steps are
# exact.


def test_work_of_the_ledger_in_the_plane():
    (curvature, turned), (growth, grown) = over_time(4.0), over_time(0.1)
    result = recorded(
        straight(8, "clamped-clamped", EA=EA),
        [
            bend(curvature, 0.13, 0.71, profile="linear"),
            stretch(growth, 0.2, 0.55, profile="smooth"),
        ],
        loads=[{"gravity": [0, -3]}, {"damping": {"coefficient": 1.0}}],
    )
    by_hand = work_by_trapezoids(result, [turned, grown])
    assert by_hand > 0.1
    assert result.work["actuation"][-1] == pytest.approx(by_hand, rel=1e-11)


def test_work_of_the_ledger_in_space():
    (first, k1), (second, k2) = over_time(4.0), over_time(-3.0)
    (turning, turned), (growth, grown) = over_time(5.0), over_time(0.05)
    soft = section([0, 1, 0], EA=EA, EI1=1.0, EI2=0.6, GJ=0.5, rotary_inertia=2e-2)
    result = recorded(
        straight_rod(8, soft, supports=HELD, loads=[{"damping": {"coefficient": 1.0}}]),
        [
            bend([first, second], 0.13, 0.71, profile="linear"),
            twist(turning, 0.1, 0.8),
            stretch(growth, 0.2, 0.55, profile="smooth"),
        ],
    )
    by_hand = work_by_trapezoids(result, [np.column_stack([k1, k2]), turned, grown])
    assert by_hand > 0.1
    assert result.work["actuation"][-1] == pytest.approx(by_hand, rel=1e-11)


# ---- in Python


def test_forces_of_a_run_are_those_of_the_simulation_and_of_probes():
    names = ["actuation_moment_1", "actuation_moment_2", "actuation_torque", "actuation_force"]
    owners = ["bend", "bend", "twist", "stretch"]
    pairs = zip(names, owners, strict=True)
    probes = {name: {"quantity": name, "actuation": owner} for name, owner in pairs}
    table = {"times": [0, 0.1], "values": [0, 1.0]}
    parts = [bend([table, 0.5], 0.13, 0.71), twist(table, 0.1, 0.8), stretch(0.01, 0.2, 0.55)]
    scene = straight_rod(8, BEAM, supports=HELD, actuation=parts)
    del scene["analysis"]
    scene |= {"time": {"duration": 0.1, "step": 0.01}, "output": {"every": 0.05, "probes": probes}}
    simulation = der.Simulation(scene)
    result = simulation.run()
    now = [each.force for each in simulation.actuation_forces()]
    saved = result.actuation_forces()
    assert [each.name for each in saved] == ["bend", "twist", "stretch"]
    assert {each.rod for each in saved} == {"rod"}
    assert saved[0].force.shape == (3, 2)
    assert saved[1].force.shape == (3,)
    probed = np.array([result.probes[name] for name in names]).T
    np.testing.assert_array_equal(np.hstack(now), probed[-1])
    found = np.column_stack([each.force for each in saved])
    np.testing.assert_allclose(found, probed, rtol=1e-9, atol=1e-9)


def test_what_a_program_sets_counts():
    scene = straight(6, "clamped-clamped")
    simulation = der.Simulation(scene | {"actuation": [bend(0.0, 0.1, 0.6)]})
    simulation.set("bend", 0.3)
    simulation.equilibrium()
    (found,) = simulation.actuation_forces()
    assert found.force > 0.0
    assert found.force == pytest.approx(solved(scene, bend(0.3, 0.1, 0.6))[0], rel=1e-9)


def test_quantities_of_the_plane_and_of_space():
    flat = straight(4, "clamped-free") | {"actuation": [bend(0.0, 0, 1)]}
    probe = {"actuation": "bend", "quantity": "actuation_moment_1"}
    with pytest.raises(der.DerError, match="in a plane take 'actuation_moment'"):
        _ = der.Simulation(flat | {"output": {"probes": {"p": probe}}}).probes
    spatial = straight_rod(4, BEAM, actuation=[bend([1.0, 0.0], 0, 1)])
    probe["quantity"] = "actuation_moment"
    with pytest.raises(der.DerError, match="take 'actuation_moment_1' and 'actuation_moment_2'"):
        _ = der.Simulation(spatial | {"output": {"probes": {"p": probe}}}).probes
