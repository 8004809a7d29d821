"""Natural frequencies, free and under load, against `references/frequencies.py`."""

import re
from pathlib import Path

import der
import numpy as np
import pytest
from scenes import END, START, straight, tip_force
from scipy import linalg

SIZES = [20, 40, 80]
#: Where the edges that supports hold, which stay lumped, still show at 20: an error of order 3.
FINE = [80, 160, 320]


def frequencies(scene, count):
    """Angular frequencies [rad/s] about the equilibrium, and what was found of it."""
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    report = simulation.equilibrium()
    return 2 * np.pi * simulation.modes(count).frequencies, report


@pytest.mark.parametrize("ends", ["clamped-free", "free-free", "pinned-pinned", "clamped-clamped"])
def test_bending_frequencies(reference, fitted_order, ends):
    exact = np.array([reference("frequencies", f"bending.{ends}.{k}.omega") for k in range(1, 5)])
    errors = []
    for n in SIZES:
        omega, _ = frequencies(straight(n, ends), 7)
        rigid = np.count_nonzero(omega == 0.0)
        assert rigid == (3 if ends == "free-free" else 0)
        errors.append(omega[rigid:][:4] / exact - 1)
    # Order 4 with the consistent mass of the edges, less what held edges, which stay lumped, cost:
    # order 3.
    for of_mode in np.array(errors).T:
        assert fitted_order([1 / n for n in SIZES], of_mode) > 2.8


def test_a_free_rod_is_neutral_and_its_modes_have_unit_modal_mass():
    simulation = der.Simulation(der.Scenario.from_dict(straight(20, "free-free")))
    assert simulation.equilibrium().neutral_directions == 3
    modes = simulation.modes(5)
    shapes = modes.shapes.reshape(5, -1)
    gram = shapes @ simulation.mass() @ shapes.T
    assert gram == pytest.approx(np.eye(5), abs=1e-7)


@pytest.mark.parametrize("ends", ["fixed-free", "fixed-fixed"])
def test_axial_frequencies(reference, fitted_order, ends):
    exact = [reference("frequencies", f"axial.{ends}.{k}.omega") for k in (1, 2, 3, 4)]
    errors = []
    for n in FINE:
        scene = straight(n, "clamped-free", EA=1.0)
        fixed = [{"rod": "rod", "at": {"node": k}, "fix": ["y"]} for k in range(1, n)]
        held = {"fix": ["x", "y"]} if ends == "fixed-fixed" else {"fix": ["y"]}
        scene["supports"] = [{**START, "fix": ["x", "y"]}, *fixed, {**END, **held}]
        errors.append(frequencies(scene, 4)[0] / exact - 1)
    for of_mode in np.array(errors).T:
        assert fitted_order([1 / n for n in FINE], of_mode) > 1.9


@pytest.mark.parametrize("share", ["-1", "0.25", "0.5", "0.75", "0.95", "0.99"])
@pytest.mark.parametrize("ends", ["pinned-pinned", "clamped-free"])
def test_frequencies_under_an_axial_load(reference, ends, share):
    """Compression up to 0.99 of the critical load: the lowest frequency goes to zero."""
    critical = reference("frequencies", f"loaded.{ends}.critical")
    scene = straight(160, ends, EA=1e4, loads=tip_force(-float(share) * critical, 0))
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    assert simulation.equilibrium().stability == "stable"
    modes = simulation.modes(6)
    bending = np.abs(modes.shapes[:, :, 1]).max(axis=1) > np.abs(modes.shapes[:, :, 0]).max(axis=1)
    omega = 2 * np.pi * modes.frequencies[bending][:4]
    exact = [reference("frequencies", f"loaded.{ends}.{share}.{k}.omega") for k in (1, 2, 3, 4)]
    # Near the critical load the frequency's square, a small difference, is off by (h pi)^2 / 12.
    assert omega**2 == pytest.approx(np.square(exact), rel=2e-3, abs=1e-3 * critical)


def test_beyond_the_critical_load_the_straight_column_has_no_frequency_but_grows(reference):
    critical = reference("frequencies", "loaded.pinned-pinned.critical")
    scene = straight(40, "pinned-pinned", EA=1e4, loads=tip_force(-1.1 * critical, 0))
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    assert simulation.equilibrium(leave_saddles=False).unstable_directions == 1
    modes = simulation.modes(2)
    assert modes.frequencies[0] == 0.0
    assert modes.growth_rates[0] == pytest.approx(np.sqrt(0.1) * np.pi**2, rel=0.02)
    assert modes.growth_rates[1] == 0.0


def test_modes_need_an_equilibrium():
    scene = straight(10, "clamped-free", loads=tip_force(0, -1))
    with pytest.raises(der.DerError, match=r"call equilibrium\(\) first"):
        der.Simulation(der.Scenario.from_dict(scene)).modes(2)


def test_string_under_tension(reference, fitted_order):
    """EI = 0; 100 N, EA = 1e4 N, 0.01 kg/m: references/frequencies.py."""
    exact = [reference("frequencies", f"string.{k}.omega") for k in (1, 2, 3, 4)]
    errors = []
    for n in FINE:
        scene = straight(n, "pinned-pinned", EA=1e4, loads=tip_force(100, 0))
        scene["rods"][0]["cross_section"] = {
            "stiffness": {"EA": 1e4, "EI": 0, "mass_per_length": 0.01}
        }
        errors.append(frequencies(scene, 4)[0] / exact - 1)
    for of_mode in np.array(errors).T:
        assert fitted_order([1 / n for n in FINE], of_mode) > 1.9


def many(rods, edges):
    """Equal cantilevers beside one another, which know nothing of each other."""
    scene = straight(edges, "clamped-free", EA=1e6)
    rod, support = scene["rods"][0], scene["supports"][0]
    names = [f"rod{i}" for i in range(rods)]
    scene["rods"] = [
        {**rod, "name": name, "from": [0, i], "to": [1, i]} for i, name in enumerate(names)
    ]
    scene["supports"] = [{**support, "rod": name} for name in names]
    return scene


def dense_frequencies(scene):
    """All frequencies [Hz], of the full matrices."""
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    simulation.equilibrium()
    matrices = simulation.hessian().toarray(), simulation.mass().toarray()
    return np.sqrt(linalg.eigvalsh(*matrices)) / (2 * np.pi)


@pytest.mark.parametrize(("rods", "edges", "count"), [(20, 40, 25), (10, 20, 11), (20, 20, 22)])
def test_none_of_many_equal_frequencies_is_missed(rods, edges, count):
    simulation = der.Simulation(der.Scenario.from_dict(many(rods, edges)))
    simulation.equilibrium()
    modes = simulation.modes(count)
    exact = dense_frequencies(many(1, edges))
    expected = np.repeat(exact[:3], rods)[:count]
    assert modes.frequencies == pytest.approx(expected, rel=1e-6)
    shapes = modes.shapes.reshape(count, -1)[:, simulation.free_dofs]
    assert shapes @ simulation.mass() @ shapes.T == pytest.approx(np.eye(count), abs=1e-7)


def test_all_modes_there_are():
    scene = straight(100, "clamped-free", EA=1e6)
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    simulation.equilibrium()
    exact = dense_frequencies(scene)
    for count in (1, 7, 99, 100, 101, 199, 200, 1000):
        found = simulation.modes(count).frequencies
        assert found.shape == (min(count, 200),)
        assert found == pytest.approx(exact[:count], rel=1e-6)


STEEL = {
    "cross_section": {"rectangle": {"width": 0.05, "height": 0.05}},
    "material": {"youngs_modulus": 2e11, "density": 7850},
}


def steel_bar(edges, to, **more):
    """A bar of length 1, as good as rigid."""
    rod = {"name": "rod", "nodes": edges + 1, "from": [0, 0], "to": to, **STEEL}
    return {"rods": [rod], "analysis": "static", **more}


COUNTS = (1, 2, 3, 4, 10, 20, 30, 40)


def found_frequencies(scene):
    """Frequencies for each of COUNTS, and whatever grows."""
    simulation = der.Simulation(der.Scenario.from_dict(scene))
    simulation.equilibrium()
    for count in COUNTS:
        modes = simulation.modes(count)
        assert not modes.growth_rates.any()
        yield modes.frequencies


@pytest.mark.parametrize("edges", [20, 100, 1000])
def test_a_stiff_pendulum_swings_whatever_the_number_of_modes(edges):
    pin = {**START, "fix": ["x", "y"]}
    scene = steel_bar(edges, [0, -1], supports=[pin], loads=[{"gravity": [0, -9.81]}])
    for found in found_frequencies(scene):
        assert found[0] == pytest.approx(np.sqrt(1.5 * 9.81) / (2 * np.pi), rel=2e-4)
        assert (found[1:] > 1.0).all()


@pytest.mark.parametrize("edges", [20, 100, 1000])
@pytest.mark.parametrize("stiffness", [1e-2, 1e2])
def test_a_bar_on_a_soft_spring_is_told_from_a_free_one(stiffness, edges):
    """One spring along the bar: it swings in that direction, and is free in the other two."""
    along = np.array([np.cos(0.3), np.sin(0.3)])
    springs = [{"rod": "rod", "at": "middle", "spring": {"stiffness": [stiffness, 0]}}]
    held = np.sqrt(stiffness / (7850 * 0.05**2)) / (2 * np.pi)
    for direction in ([1.0, 0.0], along.tolist()):
        scene = steel_bar(edges, direction, supports=springs)
        for found in found_frequencies(scene):
            assert (found[:2] == 0.0).all()
            assert found[2:3] == pytest.approx(held, rel=1e-5)
            assert (found[3:] > 100.0).all()


@pytest.mark.parametrize("direction", [[1.0, 0.0], [np.cos(0.3), np.sin(0.3)]])
@pytest.mark.parametrize("edges", [20, 100, 1000])
def test_rigid_motions_have_no_frequency_whatever_the_number_of_modes(edges, direction):
    for found in found_frequencies(steel_bar(edges, direction)):
        assert (found[:3] == 0.0).all()
        assert (found[3:] > 100.0).all()


def test_comment_of_the_scene_says_what_comes_out(scene):
    """Numbers of Euler and Bernoulli to as many digits as it gives, and the last of `der`."""
    path = Path(__file__).resolve().parents[2] / "configs/beam_modes.yaml"
    comment = " ".join(path.read_text(encoding="utf-8").split("title:")[0].split())
    *stated, last = map(float, re.findall(r"\d+\.\d+", comment))
    rod = der.Model(scene("beam_modes")).rods[0]
    roots = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349])
    mass = 2700.0 * rod.EA / 70e9
    exact = roots**2 / (2 * np.pi) * np.sqrt(rod.EI / mass)
    assert stated == pytest.approx(exact, abs=6e-4)
    assert last == pytest.approx(der.run(scene("beam_modes")).modes.frequencies[-1], abs=6e-6)
    assert 1 - last / exact[-1] == pytest.approx(3e-7, abs=0.5e-7)
