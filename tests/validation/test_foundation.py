"""Beams on an elastic foundation against Hetenyi, Beams on Elastic Foundation (1946).

Loads are so small that the linear theory holds. The rod has length 1 and EI = 1, the foundation k
along each axis; the length of its waves is 1/beta, beta = (k/(4 EI))^(1/4).
"""

from itertools import pairwise

import der
import numpy as np
import pytest
from scenes import Scene, straight, tip_force
from scipy.linalg import expm

SIZES = [80, 160, 320]
STEPS = [1 / n for n in SIZES]
BETA = 20.0  # the ends are 10 wave lengths from the middle: they count by exp(-20)
STIFFNESS = 4 * BETA**4
P = 1e-3
TIGHT = {"residual_tolerance": 1e-13, "step_tolerance": 1e-13}


def foundation(*stiffness: float, **part: float) -> Scene:
    return {"foundation": {"rod": "rod", "stiffness": list(stiffness), **part}}


def force_at(place: object, *force: float) -> Scene:
    return {"point_force": {"rod": "rod", "at": place, "force": list(force)}}


def values(scene: Scene, quantity: str, places: list[float]) -> np.ndarray:
    """A quantity of the equilibrium at places of the rod; it has to be stable."""
    probes = {f"p{i}": {"rod": "rod", "at": s, "quantity": quantity} for i, s in enumerate(places)}
    result = der.run({**scene, "solver": TIGHT, "output": {"probes": probes}})
    assert result.summary["stability"] == "stable"
    return np.array([result.probes[name][-1] for name in probes])


def check_second_order(
    fitted_order, found: list[np.ndarray], exact: np.ndarray, sizes: list[int] = SIZES
) -> None:
    """Order 2 of the worst place.

    On an infinite beam a third of (beta l)^2 is expected below a load. Moments between nodes are
    on straight lines, which costs up to three quarters of it beside a loaded end.
    """
    errors = [np.abs(of_mesh - exact).max() / np.abs(exact).max() for of_mesh in found]
    assert errors[-1] < (BETA / sizes[-1]) ** 2
    assert fitted_order([1 / n for n in sizes], errors) > 1.9


DISTANCES = np.concatenate([np.linspace(0.0, 0.05, 41), [0.1, 0.2]])  # edges at many places


@pytest.mark.parametrize("quantity", ["y", "moment"])
@pytest.mark.parametrize("at", [0.5, 0.4871])
def test_a_point_load_on_a_long_beam(fitted_order, quantity, at):
    """w = P beta/(2 k) e^(-beta x) (cos + sin), M = P/(4 beta) e^(-beta x) (cos - sin)."""
    x = BETA * DISTANCES
    exact = {
        "y": -P * BETA / (2 * STIFFNESS) * np.exp(-x) * (np.cos(x) + np.sin(x)),
        "moment": P / (4 * BETA) * np.exp(-x) * (np.cos(x) - np.sin(x)),
    }[quantity]
    places = list(at + DISTANCES)
    found = [
        values(
            straight(
                n,
                "free-free",
                1e6,
                loads=[foundation(STIFFNESS, STIFFNESS), force_at(at, 0, -P)],
            ),
            quantity,
            places,
        )
        for n in SIZES
    ]
    check_second_order(fitted_order, found, exact)


@pytest.mark.parametrize("quantity", ["y", "moment"])
def test_a_load_at_the_end_of_a_long_beam(fitted_order, quantity):
    """w = 2 P beta/k e^(-beta x) cos, M = -P/beta e^(-beta x) sin."""
    x = BETA * DISTANCES
    exact = {
        "y": -2 * P * BETA / STIFFNESS * np.exp(-x) * np.cos(x),
        "moment": -P / BETA * np.exp(-x) * np.sin(x),
    }[quantity]
    loads = [foundation(STIFFNESS, STIFFNESS), *tip_force(0, -P)]
    found = [
        values(straight(n, "free-free", 1e6, loads=loads), quantity, list(1 - DISTANCES))
        for n in SIZES
    ]
    check_second_order(fitted_order, found, exact)


@pytest.mark.parametrize("quantity", ["y", "moment"])
def test_a_clamped_end_under_a_distributed_load(fitted_order, quantity):
    """w = q/k (1 - e^(-beta x) (cos + sin)), M = -q/(2 beta^2) e^(-beta x) (cos - sin)."""
    # The node at the clamp is on the curve, those around 0.02 l^2/12 kappa beside it: between them
    # the largest error would move from mesh to mesh.
    places = np.linspace(0.02, 0.3, 60)
    x = BETA * places
    exact = {
        "y": -P / STIFFNESS * (1 - np.exp(-x) * (np.cos(x) + np.sin(x))),
        "moment": -P / (2 * BETA**2) * np.exp(-x) * (np.cos(x) - np.sin(x)),
    }[quantity]
    loads = [
        foundation(STIFFNESS, STIFFNESS),
        {"distributed_force": {"rod": "rod", "force": [0, -P]}},
    ]
    found = [
        values(straight(n, "clamped-free", 1e6, loads=loads), quantity, list(places)) for n in SIZES
    ]
    check_second_order(fitted_order, found, exact)


def test_a_free_rod_sinks_evenly_under_its_weight():
    """The foundation alone holds it: g mu/k down everywhere, on any mesh, to rounding."""
    loads = [foundation(3.0, 50.0), {"gravity": [0.2, -9.81]}]
    result = der.run(straight(7, "free-free", loads=loads))
    assert result.summary["stability"] == "stable"
    moved = result.positions[-1] - result.model.initial_positions
    assert moved == pytest.approx(np.tile([0.2 / 3.0, -9.81 / 50.0], (8, 1)), abs=1e-9)
    energy = 0.5 * (0.2**2 / 3.0 + 9.81**2 / 50.0)
    assert der.run(straight(7, "free-free", loads=loads)).summary["energies"][
        "spring"
    ] == pytest.approx(energy, rel=1e-9)


def test_one_axis_alone_leaves_the_other_free():
    scene = straight(10, "free-free", loads=[foundation(0.0, 50.0), {"gravity": [1.0, -9.81]}])
    with pytest.raises(der.NotConvergedError, match="no support holds rod 'rod' in x"):
        der.run(scene)


# A factor of 9 keeps what lies at a quarter of an edge there: the cuts and the places.
CUT_SIZES = [28, 252]
PART = (6.25 / 28, 17.25 / 28)
PLACES = np.arange(1, 112) / 112


def beam_on_a_part(places: np.ndarray, k: float, q: float) -> tuple[np.ndarray, np.ndarray]:
    """Deflection and moment of a pinned beam under q, with a foundation on PART.

    z = (w, w', w'', w''', 1) obeys z' = A z with A constant on each of the three pieces.
    """

    def system(stiffness: float) -> np.ndarray:
        A = np.diag([1.0, 1.0, 1.0, 0.0], 1)
        A[3, 0], A[3, 4] = -stiffness, -q
        return A

    stops = np.unique([0.0, *PART, 1.0, *places])
    transfers = {0.0: np.eye(5)}
    for before, s in pairwise(stops):
        stiffness = k if PART[0] <= before < PART[1] else 0.0
        transfers[s] = expm(system(stiffness) * (s - before)) @ transfers[before]
    T = transfers[1.0]
    ends = np.linalg.solve(T[np.ix_([0, 2], [1, 3])], -T[[0, 2], 4])
    z = np.array([transfers[s] @ [0.0, ends[0], 0.0, ends[1], 1.0] for s in places])
    return z[:, 0], z[:, 2]


@pytest.mark.parametrize("quantity", ["y", "moment"])
def test_a_part_that_starts_and_ends_within_edges(fitted_order, quantity):
    k, q = 2e4, 1e-3
    exact = dict(zip(("y", "moment"), beam_on_a_part(PLACES, k, q), strict=True))[quantity]
    part = foundation(0.0, k, **dict(zip(("from", "to"), PART, strict=True)))
    loads = [part, {"distributed_force": {"rod": "rod", "force": [0, -q]}}]
    found = [
        values(straight(n, "pinned-pinned", 1e6, loads=loads), quantity, list(PLACES))
        for n in CUT_SIZES
    ]
    check_second_order(fitted_order, found, exact, CUT_SIZES)


@pytest.mark.parametrize("quantity", ["x", "tension"])
def test_a_bar_pulled_through_a_part(fitted_order, quantity):
    """EA u'' = k u on the part and 0 beside it; the far end is free, so its tension is 0."""
    k, EA, F = 5e3, 1e2, 1e-5
    a, b = PART
    r = np.sqrt(k / EA)

    def u(s: float) -> float:
        scale = F / (EA * r * np.sinh(r * (b - a)))
        inside = np.clip(s, a, b)
        return scale * np.cosh(r * (inside - a)) + F / EA * max(0.0, s - b)

    def tension(s: float) -> float:
        inside = np.clip(s, a, b)
        return F * np.sinh(r * (inside - a)) / np.sinh(r * (b - a))

    exact = np.array([{"x": u, "tension": tension}[quantity](s) for s in PLACES])
    loads = [foundation(k, k, **{"from": a, "to": b}), *tip_force(F, 0)]
    drawn = PLACES if quantity == "x" else 0.0
    found = [
        values(straight(n, "free-free", EA, loads=loads), quantity, list(PLACES)) - drawn
        for n in CUT_SIZES
    ]
    check_second_order(fitted_order, found, exact, CUT_SIZES)


def test_frequencies_of_a_pinned_beam(fitted_order):
    """omega_n^2 = (EI (n pi/L)^4 + k)/mu."""
    k = 1e3
    exact = np.sqrt((np.arange(1, 5) * np.pi) ** 4 + k)
    errors = []
    for n in SIZES:
        simulation = der.Simulation(straight(n, "pinned-pinned", loads=[foundation(0.0, k)]))
        simulation.equilibrium()
        errors.append(2 * np.pi * simulation.modes(4).frequencies / exact - 1)
    for of_mode in np.array(errors).T:
        assert fitted_order(STEPS, of_mode) > 1.9


def test_buckling_of_a_pinned_column(fitted_order):
    """P = (n pi/L)^2 EI + k (L/(n pi))^2; two waves buckle first here."""
    k = 1e3
    waves = (np.arange(1, 20) * np.pi) ** 2
    exact = np.sort(waves + k / waves)[:3]
    errors = []
    for n in SIZES:
        scene = straight(n, "pinned-pinned", loads=[*tip_force(-1, 0), foundation(0.0, k)])
        found = der.run({**scene, "analysis": {"buckling": {"count": 3}}}).buckling
        errors.append(found.load_factors / exact - 1)
    for of_mode in np.array(errors).T:
        assert fitted_order(STEPS, of_mode) > 1.9


def test_a_path_of_loads_leaves_it():
    """Twice the force sinks the rod twice as far: the foundation has its full stiffness."""
    loads = [foundation(10.0, 40.0), {"gravity": [0.0, -1.0]}]
    scene = straight(10, "free-free", loads=loads)
    result = der.run({**scene, "analysis": {"continuation": {"to": 2.0}}})
    sunk = result.positions[:, :, 1].mean(axis=1)
    assert sunk == pytest.approx(-np.array(result.path.factor) / 40.0, abs=1e-9)


def test_nothing_varies_with_a_foundation_alone():
    scene = straight(10, "pinned-pinned", loads=[foundation(0.0, 40.0)])
    with pytest.raises(der.SceneError, match="no force or moment that the load factor could"):
        der.Scenario.from_dict({**scene, "analysis": {"continuation": {"to": 2.0}}})


def moving(**time: object) -> Scene:
    """A curved free rod that moves over its foundation."""
    scene = straight(16, "free-free", 1e3, loads=[foundation(30.0, 80.0, **{"from": 0.23})])
    del scene["analysis"]
    scene["rods"][0]["initial_velocity"] = [0.7, -0.4]
    return {**scene, "time": {"duration": 0.5, **time}, "output": {"every": 0.05}}


def total_energy(result: der.Result) -> np.ndarray:
    return np.sum([np.asarray(energy) for energy in result.energies.values()], axis=0)


def test_energy_momentum_keeps_the_energy():
    """To the tolerance of the Newton iteration: the force at the middle is a discrete gradient."""
    result = der.run(moving(step=0.005, integrator="energy_momentum"))
    total = total_energy(result)
    assert np.ptp(result.energies["spring"]) > 0.1 * total[0]
    assert total == pytest.approx(np.full(len(total), total[0]), rel=1e-8)


def test_a_rigid_rod_bounces_with_the_frequency_of_its_foundation():
    """x = v/omega sin(omega t), omega^2 = k/mu, along each axis."""
    scene = moving(step=1e-3, integrator="implicit_midpoint")
    scene["loads"] = [foundation(30.0, 80.0)]
    result = der.run(scene)
    moved = result.positions - result.model.initial_positions
    omega = np.sqrt([30.0, 80.0])
    exact = [0.7, -0.4] * np.sin(omega * result.times[:, None]) / omega
    # Phases lag by (omega dt)^2/12 of themselves: 3e-5 rad of 4.5 at the end.
    assert moved == pytest.approx(np.repeat(exact[:, None], 17, axis=1), abs=5e-6)


@pytest.mark.parametrize("info", der.steppers(), ids=lambda info: info.name)
def test_every_stepper_counts_its_energy(info):
    """At small steps next to nothing is left to `numerical`: the foundation does no hidden work."""
    result = der.run(moving(step=2e-4, integrator=info.name))
    ledger = result.work["loads"] + result.work["solver"] - result.work["numerical"]
    total = total_energy(result)
    assert total - total[0] == pytest.approx(ledger, abs=1e-12)
    assert np.abs(result.work["loads"]).max() == 0.0
    assert np.abs(result.work["numerical"]).max() < (2e-2 if info.order == 1 else 1e-5) * total[0]


def test_the_stable_step_follows_it():
    """2/sqrt(k/mu) for a stiff foundation; the bound may be below by the square root of 3."""
    k = 1e8
    scene = moving(step="auto", integrator="verlet")
    scene["loads"] = [foundation(k, k)]
    scene["time"]["duration"] = 0.05
    result = der.run(scene)
    assert result.status == "completed"
    limit = 2.0 / np.sqrt(k)
    assert 0.5 * limit < result.summary["step"] <= limit


def test_adaptive_steps_follow_it():
    """The error that was asked for, 1e-4 of the size, over four oscillations."""
    scene = moving(tolerance=1e-4, duration=2.0, integrator="tr_bdf2")
    scene["loads"] = [foundation(30.0, 80.0)]
    result = der.run(scene)
    omega = np.sqrt([30.0, 80.0])
    exact = [0.7, -0.4] * np.sin(omega * 2.0) / omega
    moved = result.positions[-1] - result.model.initial_positions
    assert np.abs(moved - exact).max() < 1e-3
